//! Convergence study: one exact method on a sequence of meshes, for several contact spaces and tip enrichments.
//!
//! Every combination is the case with another contact space and tip enrichment, run over its whole load path. Only honest
//! verdicts are measured, at the end of the path: against the closed form where the case names one, otherwise by their
//! quantities of interest on the finest mesh, whose error bars come from the meshes before it.

pub mod error_bar;
pub mod orders;
mod power_law;
mod sample;
mod tips;

pub use error_bar::NoBar;
pub use power_law::slope;
pub use sample::{Measured, Sample, Seconds, Value, Variant};
pub use tips::{Regularity, regularity};

use std::collections::BTreeSet;

use crate::case::{Case, ContactSpace, Tip};
use crate::model::body::{Body, BodyError};
use crate::model::errors::{Deviation, errors};
use crate::model::loading::Loading;
use crate::model::quantities::{Quantity, Snapshot, quantities};
use crate::run::choice::Choice;
use crate::run::load_path::Posed;
use crate::run::run_case::{Progress, RunError, friction_values, needs, warm_up};
use crate::run::verdict::Accuracy;

/// Refinement factors where neither the study nor the case names several.
const REFINE: [usize; 4] = [1, 2, 4, 8];

/// Quantities of interest that are followed under refinement where there is no closed form.
const FOLLOWED: [&str; 7] = [
    "reaction",
    "contact_force",
    "strain_energy",
    "dissipation",
    "mean_slip",
    "max_slip",
    "max_gap",
];

/// What to run. `None`: what the case says, see [`ConvergencePlan::meshes`], [`ConvergencePlan::spaces`], [`ConvergencePlan::tips`].
#[derive(Debug, Clone)]
pub struct ConvergencePlan {
    /// Refinement factors, increasing.
    pub refine: Option<Vec<usize>>,
    /// Contact spaces of all cracks.
    pub spaces: Option<Vec<ContactSpace>>,
    /// Enrichments of all tips.
    pub tips: Option<Vec<Tip>>,
    /// Method.
    pub choice: Choice,
}

impl ConvergencePlan {
    /// Refinement factors: those asked for, or those of the case if it has several, or 1, 2, 4, 8.
    pub fn meshes(&self, case: &Case) -> Vec<usize> {
        match &self.refine {
            Some(given) => given.clone(),
            None if case.sweep.refine.len() > 1 => {
                let mut own = case.sweep.refine.clone();
                own.sort_unstable();
                own
            }
            None => REFINE.to_vec(),
        }
    }

    /// Contact spaces: those asked for, or `star` and those of the case, where `None` leaves every crack its own.
    pub fn spaces(&self, case: &Case) -> Vec<Option<ContactSpace>> {
        match &self.spaces {
            Some(given) => given.iter().copied().map(Some).collect(),
            None if case.cracks.iter().all(|c| c.contact == ContactSpace::Star) => vec![None],
            None => vec![Some(ContactSpace::Star), None],
        }
    }

    /// Tip enrichments: those asked for, or those of the case, where `None` leaves every crack its own.
    pub fn tips(&self, case: &Case) -> Vec<Option<Tip>> {
        match &self.tips {
            // Where nothing ends inside the body there is nothing to enrich.
            Some(given) if regularity(case) != Regularity::Smooth => {
                given.iter().copied().map(Some).collect()
            }
            _ => vec![None],
        }
    }
}

/// Measures the end of a path. `None`: no closed form.
pub type ClosedForm<'a> =
    dyn Fn(&Loading<'_>, &Snapshot) -> Result<Option<Vec<Deviation>>, RunError> + Sync + 'a;

/// Errors against the closed form that the case names; `None`: it names none.
///
/// # Errors
/// Cells that cannot be integrated.
pub fn closed_form(
    loading: &Loading<'_>,
    now: &Snapshot,
) -> Result<Option<Vec<Deviation>>, RunError> {
    let body = loading.body();
    let Some(field) = loading.exact(loading.increments()) else {
        return Ok(None);
    };
    let found = errors(body, &body.surface.quadrature, field, now).map_err(BodyError::from)?;
    Ok(Some(found))
}

/// Runs the study on one case: samples by contact space, tip enrichment, mesh and friction. One after the other, so that
/// times mean something.
///
/// # Errors
/// Of the case or its discretisation; what the method does wrong is a verdict.
pub fn run(
    case: &Case,
    plan: &ConvergencePlan,
    closed_form: &ClosedForm<'_>,
    progress: &dyn Progress,
) -> Result<Vec<Sample>, RunError> {
    let (meshes, tips) = (plan.meshes(case), plan.tips(case));
    let frictions = friction_values(case);
    let spaces = plan.spaces(case);
    let combinations = spaces
        .iter()
        .flat_map(|&space| tips.iter().map(move |&tip| (space, tip)));
    let variants: Vec<Case> = combinations
        .map(|(space, tip)| variant(case, space, tip))
        .collect();
    let needs = needs(&frictions, std::slice::from_ref(&plan.choice));
    progress.plan(variants.len() * meshes.len() * frictions.len());
    warm_up(case.model.dim());
    let mut samples = Vec::new();
    // A crack along cell facets has the same pairs in every space.
    let mut seen = BTreeSet::new();
    for variant in &variants {
        let tip = tips::label(variant);
        for &refine in &meshes {
            // Goes before the next one comes: two would raise the peak of memory.
            let body = Body::new(variant, refine, needs)?;
            let new = seen.insert((body.space.clone(), tip.clone(), refine));
            for per_crack in &frictions {
                if new {
                    let sample =
                        run_one(variant, &body, refine, per_crack, &plan.choice, closed_form)?;
                    samples.push(sample);
                }
                let mu = per_crack.first().copied().unwrap_or(0.0);
                let Body { label, space, .. } = &body;
                progress.done(&format!("{} {label} {space} {tip} mu={mu}", case.name));
            }
        }
    }
    Ok(samples)
}

/// The case with another contact space and tip enrichment.
fn variant(case: &Case, space: Option<ContactSpace>, tip: Option<Tip>) -> Case {
    let mut variant = case.clone();
    for crack in &mut variant.cracks {
        crack.contact = space.unwrap_or(crack.contact);
        crack.tip = tip.unwrap_or(crack.tip);
    }
    variant
}

/// One mesh and friction coefficient.
fn run_one(
    case: &Case,
    body: &Body,
    refine: usize,
    per_crack: &[f64],
    choice: &Choice,
    closed_form: &ClosedForm<'_>,
) -> Result<Sample, RunError> {
    let posed = Posed::new(body, case, per_crack)?;
    let path = posed.run(choice, Accuracy::of(case, case.tier));
    let mut rows = Vec::new();
    let end = path.follow(&mut |key, increment, now| rows.push(path.row(key, increment, now)));
    let key = end.key;
    let measured = match &end.now {
        None => Measured::Nothing,
        Some(now) => match closed_form(&posed.loading, now)? {
            Some(deviations) => Measured::Exact(deviations),
            None => Measured::Values(followed(case, body, now)),
        },
    };
    Ok(Sample {
        variant: Variant {
            case: key.case,
            space: key.space,
            tip: tips::label(case),
            method: key.method,
            friction: key.friction,
        },
        regularity: regularity(case),
        mesh: key.mesh,
        refine,
        h: case.mesh.grid.refined(refine).cell_size(),
        dim: body.mesh.dim(),
        dofs: body.elastic.unknowns(),
        points: body.points.len(),
        seconds: if end.now.is_some() {
            Seconds::of(&rows)
        } else {
            Seconds::NONE
        },
        verdict: end.verdict,
        measured,
    })
}

/// The quantities of interest that are followed under refinement.
pub(crate) fn followed(case: &Case, body: &Body, now: &Snapshot) -> Vec<Value> {
    let rows = quantities(case, body, now);
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |m: f64, x| m.max(x.abs()));
    let displacement = largest(&mut now.u.iter().copied());
    let is_force = |row: &&Quantity| ["reaction", "contact_force"].contains(&row.name.as_str());
    let force = largest(&mut rows.iter().filter(is_force).map(|row| row.value));
    // With one crack what is its own is that of all.
    let total = |name: &str| rows.iter().any(|row| row.name == name && row.at.is_empty());
    let followed = rows
        .iter()
        .filter(|row| FOLLOWED.contains(&row.name.as_str()))
        .filter(|row| case.cracks.len() > 1 || row.at.is_empty() || !total(&row.name));
    followed
        .map(|row| {
            let vector = rows
                .iter()
                .filter(|other| (&other.name, &other.at) == (&row.name, &row.at));
            let norm = vector.map(|r| r.value.powi(2)).sum::<f64>().sqrt();
            let scale = match row.name.as_str() {
                "reaction" | "contact_force" => force,
                "mean_slip" | "max_slip" | "max_gap" => displacement,
                _ => now.strain_energy,
            };
            Value {
                at: format!("{} {}", row.at, row.component).trim().to_owned(),
                quantity: row.name.clone(),
                value: row.value,
                norm,
                scale,
            }
        })
        .collect()
}
