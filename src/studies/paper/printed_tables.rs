//! The two tables of the founding paper, our values beside the printed ones.
//!
//! Table 1: vertical reaction at the top of the plate. Table 2: displacement of seven points of the beam. Lines with the
//! method [`PRINTED`] carry the printed numbers.

use crate::run::registry::methods;
use crate::run::verdict::Verdict;
use crate::studies::paper::lookup::{PaperError, REACTION, Run, as_printed};
use crate::studies::results::Results;
use crate::studies::statistics::larger;

/// Printed numbers.
const TABLE1: &str = include_str!("../../../cases/reference/plate_table1.csv");
const TABLE2: &str = include_str!("../../../cases/reference/beam_table2.csv");

/// Cases of the paper: (case, model or mesh of the paper).
const PLATES: [(&str, &str); 2] = [("plate_mesh1", "I"), ("plate_mesh2", "II")];
const BEAMS: [(&str, &str); 2] = [("beam_model1_gauss6", "I"), ("beam_model2", "II")];
/// Model I with exact sub-cells: the same discrete problem as Model II.
const EXACT_BEAM: &str = "beam_model1";
/// Variants of Table 2 by friction coefficient.
const VARIANTS: [(&str, f64); 2] = [("as-printed", 0.0), ("as-stated", 0.1)];
/// Methods of Tables 1 and 2: the founding paper's own field. All others stand in `comparison.csv`.
pub const PAPER_METHODS: [&str; 4] = ["b-newton", "penalty", "augmented-lagrangian", "latin"];
/// Method name of lines that repeat the published numbers.
pub const PRINTED: &str = "printed";

/// One line of Table 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Table1Row {
    /// Mesh of the paper: `I` or `II`.
    pub mesh: String,
    /// Friction coefficient [-].
    pub friction: f64,
    /// Method label.
    pub method: String,
    /// Computed reaction [MN/m]; none where the method gave no solution.
    pub reaction_mn_per_m: Option<f64>,
    /// Printed reaction [MN/m]; none where the paper has none.
    pub printed_mn_per_m: Option<f64>,
    /// (computed − printed) / printed [-].
    pub relative_difference: Option<f64>,
    /// Claim × check; none where there is no such run.
    pub verdict: Option<Verdict>,
}

impl Table1Row {
    /// A line with its relative difference computed.
    pub fn new(
        mesh: impl Into<String>,
        friction: f64,
        method: impl Into<String>,
        reaction_mn_per_m: Option<f64>,
        printed_mn_per_m: Option<f64>,
        verdict: Option<Verdict>,
    ) -> Self {
        let relative_difference = match (reaction_mn_per_m, printed_mn_per_m) {
            (Some(ours), Some(theirs)) => Some((ours - theirs) / theirs),
            _ => None,
        };
        Self {
            mesh: mesh.into(),
            friction,
            method: method.into(),
            reaction_mn_per_m,
            printed_mn_per_m,
            relative_difference,
            verdict,
        }
    }
}

/// One line of Table 2: the displacement component of the seven points.
#[derive(Debug, Clone, PartialEq)]
pub struct Table2Row {
    /// Model of the paper: `I` or `II`.
    pub model: String,
    /// `as-printed` (μ = 0) or `as-stated` (μ = 0.1).
    pub variant: String,
    /// `x`, `y` or `z`.
    pub component: String,
    /// Method label, or [`PRINTED`].
    pub method: String,
    /// Displacement of P1 … P7 (mm); NaN where the method gave no solution.
    pub p_mm: [f64; 7],
    /// Printed displacement of P1 … P7 (mm).
    pub printed_mm: [f64; 7],
    /// Largest |computed − printed| over the seven points (mm); none for the printed line itself.
    pub max_difference_mm: Option<f64>,
    /// Claim × check; none where there is no such run, as for the printed line.
    pub verdict: Option<Verdict>,
}

impl Table2Row {
    /// The line that repeats the published numbers.
    pub fn printed(
        model: impl Into<String>,
        variant: impl Into<String>,
        component: impl Into<String>,
        p_mm: [f64; 7],
    ) -> Self {
        Self {
            model: model.into(),
            variant: variant.into(),
            component: component.into(),
            method: PRINTED.into(),
            p_mm,
            printed_mm: p_mm,
            max_difference_mm: None,
            verdict: None,
        }
    }

    /// The printed displacement of largest size (mm).
    pub fn largest_printed_mm(&self) -> f64 {
        let printed = self.printed_mm.into_iter();
        printed.fold(
            0.0,
            |most: f64, p| if p.abs() > most.abs() { p } else { most },
        )
    }

    /// A computed line to stand below the printed line `reference`.
    pub fn computed(
        reference: &Self,
        method: impl Into<String>,
        p_mm: [f64; 7],
        verdict: Option<Verdict>,
    ) -> Self {
        // `f64::max` would swallow the NaN of a run without a solution.
        let solved = p_mm.iter().all(|p| p.is_finite());
        let difference = || {
            p_mm.iter()
                .zip(reference.p_mm)
                .map(|(ours, theirs)| (ours - theirs).abs())
                .fold(0.0, f64::max)
        };
        Self {
            method: method.into(),
            p_mm,
            max_difference_mm: solved.then(difference),
            verdict,
            ..reference.clone()
        }
    }
}

/// Lines of Table 1 from the runs of the plates.
///
/// # Errors
/// Printed numbers that cannot be read.
pub fn plate_rows(results: &Results) -> Result<Vec<Table1Row>, PaperError> {
    let mut rows = Vec::new();
    for record in csv::Reader::from_reader(TABLE1.as_bytes()).deserialize() {
        let (mesh, friction, printed): (String, f64, f64) = record?;
        for (name, _) in PLATES.iter().filter(|(_, own)| *own == mesh) {
            for method in PAPER_METHODS {
                let run = Run::of(results, name, friction, method);
                let (found, verdict) = (run.value(REACTION).map(as_printed), run.verdict());
                let row = Table1Row::new(&mesh, friction, method, found, Some(printed), verdict);
                rows.push(row);
            }
        }
    }
    Ok(rows)
}

/// Lines of Table 2 from the runs of the beams.
///
/// # Errors
/// Printed numbers that cannot be read.
pub fn beam_rows(results: &Results) -> Result<Vec<Table2Row>, PaperError> {
    let mut rows = Vec::new();
    for record in csv::Reader::from_reader(TABLE2.as_bytes()).deserialize() {
        let (model, component, printed): (String, String, [f64; 7]) = record?;
        for (variant, friction) in VARIANTS {
            let reference = Table2Row::printed(&model, variant, &component, printed);
            for (name, _) in BEAMS.iter().filter(|(_, own)| *own == model) {
                for method in PAPER_METHODS {
                    let run = Run::of(results, name, friction, method);
                    let p_mm = probe_row(run, &component);
                    rows.push(Table2Row::computed(&reference, method, p_mm, run.verdict()));
                }
            }
            rows.push(reference);
        }
    }
    Ok(rows)
}

/// One component of P1 … P7 [mm]; NaN where the run has no solution.
fn probe_row(run: Run<'_>, component: &str) -> [f64; 7] {
    std::array::from_fn(|i| {
        let probe = format!("P{}", i + 1);
        let found = run.value(["displacement", &probe, component]);
        found.map_or(f64::NAN, |u| u * 1e3)
    })
}

/// Largest difference between the two models of the beam over points, components, friction values and exact methods.
pub fn beam_difference(results: &Results) -> f64 {
    let mut largest: f64 = 0.0;
    for method in methods().iter().filter(|m| m.exact) {
        for (_, friction) in VARIANTS {
            for component in ["x", "y", "z"] {
                let of = |case| {
                    let run = Run::of(results, case, friction, method.name);
                    probe_row(run, component)
                };
                for (one, two) in of(EXACT_BEAM).iter().zip(of(BEAMS[1].0)) {
                    // A missing run must show.
                    largest = larger(largest, (one - two).abs());
                }
            }
        }
    }
    largest
}
