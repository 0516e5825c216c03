//! Errors of the values on one mesh, estimated from a second one: with cells twice as wide where the refinement factor is even,
//! otherwise half as wide.
//!
//! ```text
//!   bar of the finer value       see error_bar
//!   bar of the coarser value     4/3 of it: 2 max(|v₂ − v₁|, m) on halved cells
//! ```
//!
//! The relative error in the energy norm is that of [`orders`] on such a pair of meshes.
//!
//! The mesh alone is measured, by one exact method. With friction the energy is no minimum: an estimate, no bound. A case with a
//! closed form has it for the quantities that it gives.

use std::collections::BTreeMap;

use super::error_bar::NoBar;
use super::orders::{self, Kind};
use super::{Measured, Sample, records};
use crate::case::Case;
use crate::model::intensities::MODES;
use crate::model::quantities::{ESTIMATE, EXACT, Quantity};
use crate::run::choice::Choice;
use crate::run::progress::Progress;
use crate::studies::axes::Axes;
use crate::studies::measure::{Bench, MeasureError, RunError};
use crate::studies::record::Record;
use crate::studies::task::{Asked, Looks};

/// Bar of a coarser value, in that of the finer one.
const OF_COARSER: f64 = 4.0 / 3.0;

/// Errors of the quantities of one problem at the end of its path; quantity and place as in `quantities.csv`.
#[derive(Debug, Default)]
pub struct Errors {
    /// Bars by quantity and place.
    pub bars: BTreeMap<[String; 2], Result<f64, NoBar>>,
    /// Values of the closed form by quantity and place.
    pub exact: BTreeMap<[String; 2], f64>,
    /// Relative error in the energy norm, of a closed form or estimated.
    pub energy: Option<(f64, &'static str)>,
    /// Values on the mesh.
    pub found: BTreeMap<[String; 2], f64>,
}

/// Method that errors of meshes are estimated by.
const REFERENCE: &str = "hybrid";

/// Errors of the meshes of a case by refinement factor and the bits of the friction coefficient.
pub type OfMeshes = BTreeMap<usize, BTreeMap<u64, Errors>>;

/// Errors of all meshes of a case.
///
/// # Errors
/// Of the case or its discretisation on the second mesh; what the method does wrong there leaves no estimate.
pub fn estimate(case: &Case, progress: &dyn Progress) -> Result<OfMeshes, RunError> {
    let choice = Choice::parse(REFERENCE).map_err(MeasureError::from)?;
    let mut meshes: Vec<usize> = case.sweep.refine.clone();
    meshes.sort_unstable();
    meshes.dedup();
    let of = |refine| Ok((refine, errors_of_mesh(case, refine, &choice, progress)?));
    meshes.into_iter().map(of).collect()
}

/// Those of a problem.
pub fn of_problem<'a>(errors: &'a OfMeshes, asked: &Asked) -> Option<&'a Errors> {
    errors.get(&asked.refine)?.get(&asked.mu().to_bits())
}

/// Puts the errors of the mesh beside the quantities of an honest run, at the end of its path.
pub fn put(errors: &OfMeshes, record: &mut Record) {
    let own = of_problem(errors, &record.asked);
    let found = &mut record.found;
    if let Some(errors) = own.filter(|_| found.verdict.is_honest()) {
        found.energy_error = errors.energy.map(|(error, kind)| (error, kind.into()));
        let last = found.increments.last_mut();
        let quantities = last.into_iter().flat_map(|step| &mut step.quantities);
        quantities.for_each(|quantity| errors.put(quantity));
    }
}

/// Errors on a mesh by the bits of the friction coefficient.
///
/// # Errors
/// As [`estimate`].
pub fn errors_of_mesh(
    case: &Case,
    refine: usize,
    choice: &Choice,
    progress: &dyn Progress,
) -> Result<BTreeMap<u64, Errors>, RunError> {
    let (pair, part) = match refine % 2 {
        0 => ([refine / 2, refine], 1.0),
        _ => ([refine, 2 * refine], OF_COARSER),
    };
    let axes = Axes {
        refine: pair.to_vec(),
        ..Axes::of(case)
    };
    let looks = Looks {
        values: true,
        ..Looks::truth()
    };
    let (choices, mut bench) = (std::slice::from_ref(choice), Bench::default());
    let records = records(&mut bench, case, &axes, choices, looks, progress)?;
    let (mut samples, mut all) = (Vec::new(), BTreeMap::<u64, Errors>::new());
    for record in records {
        let own = all.entry(record.asked.mu().to_bits()).or_default();
        if record.asked.refine == refine {
            for value in &record.found.values {
                let place = [value.quantity.clone(), value.at.clone()];
                own.found.insert(place, value.value);
            }
            for deviation in &record.found.deviations {
                let [name, at] = [&deviation.quantity, &deviation.at];
                if name == "energy" && at.is_empty() {
                    own.energy = Some((deviation.error, EXACT));
                } else if let Some(place) =
                    place(name, at, record.found.problem.as_ref().map(|p| p.dim))
                {
                    own.exact.insert(place, deviation.exact);
                }
            }
        }
        if let Some(mut sample) = Sample::of(&record, case).filter(|_| record.is_honest()) {
            sample.measured = Measured::Values(record.found.values);
            samples.push(sample);
        }
    }
    let (errors, _) = orders::rows(&samples);
    for row in &errors {
        let own = all.entry(row.variant.friction.to_bits()).or_default();
        if row.kind == Some(Kind::Estimate) {
            if row.refine == refine {
                own.energy.get_or_insert((row.error, ESTIMATE));
            }
        } else if row.refine == pair[1] {
            let bar = row.no_bar.map_or(Ok(part * row.error_bar), Err);
            let place = [row.quantity.clone(), row.at.clone()];
            own.bars.insert(place, bar);
        }
    }
    Ok(all)
}

/// Name and place in `quantities.csv` of what a closed form gives; none of what stands there otherwise.
fn place(name: &str, at: &str, dim: Option<usize>) -> Option<[String; 2]> {
    let modes = match dim {
        Some(2) => ["k1_interaction", "k2_interaction", ""],
        _ => ["k1_jump", "k2_jump", "k3_jump"],
    };
    let mode = modes.iter().position(|mode| *mode == name);
    match (name, mode) {
        ("dissipation", _) => Some([name.into(), at.into()]),
        (_, Some(mode)) => Some(["stress_intensity".into(), format!("{at} {}", MODES[mode])]),
        _ => None,
    }
}

impl Errors {
    fn put(&self, quantity: &mut Quantity) {
        let place = [quantity.name.clone(), quantity.place()];
        if let Some(exact) = self.exact.get(&place) {
            quantity.error = (quantity.value - exact).abs();
            quantity.error_kind = EXACT.into();
            return;
        }
        match self.bars.get(&place) {
            Some(Ok(bar)) => {
                quantity.error = *bar;
                quantity.error_kind = ESTIMATE.into();
            }
            // Paths around a tip that agree say nothing of the mesh.
            Some(Err(reason)) if quantity.value.is_finite() => {
                quantity.error = f64::NAN;
                quantity.error_kind = format!("no estimate: {reason}");
            }
            _ => {}
        }
    }
}
