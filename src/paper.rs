//! The main job: the founding paper's plate and beam by every method, beside the printed tables.
//!
//! Also the penalty error against its parameter, both plate meshes under refinement, the converged reactions of the plate, and every other shipped case
//! against its expected numbers.

mod converged;
mod variants;

use std::path::Path;

use stickslip_methods::METHODS;

use crate::harness::case::{Case, CaseError};
use crate::harness::record::{Results, RunKey};
use crate::harness::run::{Choice, Fields, Progress, RunError, Settings, run_case};
use crate::harness::shipped;
use crate::harness::verdict::Verdict;
use crate::report::comparison::{VariantRow, variant_table};
use crate::report::converged::{self as converged_report, ConvergedRow, SequenceRow};
use crate::report::paper::{Digits, Table1Row, Table2Row, table1, table2};
use crate::report::study::{
    LimitRow, PenaltyRow, RefinementRow, limit_table, penalty_table, refinement_table,
};
use crate::report::{
    Bundle, Provenance, ReportError, comparison, paper as tables, standard, study,
};

/// Printed numbers.
const TABLE1: &str = include_str!("../cases/reference/plate_table1.csv");
const TABLE2: &str = include_str!("../cases/reference/beam_table2.csv");

/// Cases of the paper: (case, model or mesh of the paper).
const PLATES: [(&str, &str); 2] = [("plate_mesh1", "I"), ("plate_mesh2", "II")];
const BEAMS: [(&str, &str); 2] = [("beam_model1_gauss6", "I"), ("beam_model2", "II")];
/// Model I with exact sub-cells: the same discrete problem as Model II.
const EXACT_BEAM: &str = "beam_model1";
/// Variants of Table 2 by friction coefficient.
const VARIANTS: [(&str, f64); 2] = [("as-printed", 0.0), ("as-stated", 0.1)];
/// Multiples of the natural scale that the penalty stiffness is swept over.
const PENALTIES: [f64; 7] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];
/// Refinement factors: even ones would put the crack of Mesh II on a grid line.
const REFINEMENTS: [(&str, &str, &[usize]); 2] = [
    ("plate_mesh1", "I", &[1, 2, 4, 8]),
    ("plate_mesh2", "II", &[1, 3, 5, 7]),
];
/// Methods of Tables 1 and 2: the founding paper's own field. All others stand in `variants.csv`.
const PAPER_METHODS: [&str; 4] = ["b-newton", "penalty", "augmented-lagrangian", "latin"];
/// Method of the refinement study.
const REFERENCE_METHOD: &str = "b-newton";

/// Everything the main job found.
#[derive(Debug, Default)]
pub struct Paper {
    /// Runs of all shipped cases.
    pub results: Results,
    /// Table 1.
    pub table1: Vec<Table1Row>,
    /// Table 2.
    pub table2: Vec<Table2Row>,
    /// Error of the penalty method against its parameter.
    pub penalty: Vec<PenaltyRow>,
    /// Reactions of both plate meshes under refinement.
    pub refinement: Vec<RefinementRow>,
    /// Their limits.
    pub limits: Vec<LimitRow>,
    /// Reactions of the plate by star multipliers with a fixed tip radius, on three meshes under refinement.
    pub converged_meshes: Vec<SequenceRow>,
    /// Their limits beside the printed numbers.
    pub converged: Vec<ConvergedRow>,
    /// Plate and beam by every method and variant.
    pub variants: Vec<VariantRow>,
    /// Largest difference of the seven points between Model I with exact sub-cells and Model II [mm].
    pub beam_models_mm: f64,
}

/// Why the main job stopped.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// A run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A report.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The printed numbers.
    #[error("cases/reference: {0}")]
    Reference(#[from] csv::Error),
    /// A case or method that this program was built without.
    #[error("this program was built without {0}")]
    Missing(String),
}

impl From<CaseError> for PaperError {
    fn from(error: CaseError) -> Self {
        PaperError::Run(error.into())
    }
}

/// Runs everything.
pub fn run(settings: Settings, progress: &dyn Progress) -> Result<Paper, PaperError> {
    let mut paper = Paper::default();
    let numbers_only = Settings {
        fields: Fields::None,
        ..settings
    };
    for (name, _) in shipped::CASES {
        let results = run_case(&case(name)?, &[], settings, progress)?;
        paper.results.append(results);
    }
    paper.table1 = plate_rows(&paper.results)?;
    paper.table2 = beam_rows(&paper.results)?;
    paper.beam_models_mm = beam_difference(&paper.results);
    paper.penalty = penalty_rows(&paper.results, numbers_only, progress)?;
    paper.refinement = refinement_rows(numbers_only, progress)?;
    paper.limits = limit_rows(&paper.refinement);
    (paper.converged_meshes, paper.converged) = converged::rows(&paper.table1, progress)?;
    paper.variants = variants::rows(&paper.results, numbers_only, progress)?;
    Ok(paper)
}

impl Paper {
    /// All files of the report.
    pub fn bundle(&self, provenance: &Provenance) -> Result<Bundle, ReportError> {
        let mut bundle = standard::bundle(&self.results, provenance)?;
        tables::add_table1(&mut bundle, &self.table1)?;
        tables::add_table2(&mut bundle, &self.table2)?;
        study::add_penalty(&mut bundle, &self.penalty)?;
        study::add_refinement(&mut bundle, &self.refinement, &self.limits)?;
        converged_report::add(
            &mut bundle,
            &self.converged_meshes,
            &self.converged,
            &self.refinement,
        )?;
        comparison::add(&mut bundle, &self.results.runs, &self.variants)?;
        Ok(bundle)
    }

    /// Writes all files, or none.
    pub fn write(&self, dir: &Path, provenance: &Provenance) -> Result<(), ReportError> {
        self.bundle(provenance)?.commit(dir)
    }

    /// What the terminal shows.
    pub fn text(&self) -> Result<String, ReportError> {
        let mut text = String::new();
        for table in [
            table1(&self.table1)?,
            table2(&self.table2, Digits::Printed)?,
            penalty_table(&self.penalty)?,
            refinement_table(&self.refinement)?,
            limit_table(&self.limits)?,
            converged_report::converged_table(&self.converged)?,
            variant_table(&self.variants)?,
            standard::expectation_summary(&self.results.expectations)?,
        ] {
            text.push_str(&table.terminal());
            text.push('\n');
        }
        text.push_str(&format!(
            "{}\n\nModel I with exact sub-cells against Model II: {:.1e} mm\n{}\n",
            converged_report::summary(&self.converged),
            self.beam_models_mm,
            standard::summary(&self.results)
        ));
        Ok(text)
    }
}

fn case(name: &str) -> Result<Case, PaperError> {
    match shipped::find(name) {
        Some(case) => Ok(case?),
        None => Err(PaperError::Missing(format!("cases/{name}.toml"))),
    }
}

fn choice(name: &str, options: &[(String, f64)]) -> Result<Choice, PaperError> {
    let missing = || PaperError::Missing(format!("method {name}"));
    let method = stickslip_methods::method(name).ok_or_else(missing)?;
    Choice::new(method, options).map_err(|e| PaperError::Missing(format!("{name}: {e}")))
}

/// Value of a quantity of a run; `None` where the run has none.
fn value(
    results: &Results,
    key: impl Fn(&RunKey) -> bool,
    quantity: &str,
    at: &str,
    component: &str,
) -> Option<f64> {
    results
        .quantities
        .iter()
        .find(|q| key(&q.key) && q.quantity == quantity && q.at == at && q.component == component)
        .map(|q| q.value)
}

/// Verdict of the last increment of a run.
fn verdict(results: &Results, key: impl Fn(&RunKey) -> bool) -> Option<Verdict> {
    let last = results.runs.iter().rfind(|r| key(&r.key));
    last.map(|r| r.verdict.clone())
}

fn plate_rows(results: &Results) -> Result<Vec<Table1Row>, PaperError> {
    let mut rows = Vec::new();
    for record in csv::Reader::from_reader(TABLE1.as_bytes()).deserialize() {
        let (mesh, friction, printed): (String, f64, f64) = record?;
        for (name, _) in PLATES.iter().filter(|(_, own)| *own == mesh) {
            for method in PAPER_METHODS {
                let key =
                    |k: &RunKey| k.case == *name && k.friction == friction && k.method == method;
                // The support pushes down on the body; the paper prints the magnitude.
                let reaction = value(results, key, "reaction", "top", "y").map(|r| -r / 1e6);
                let verdict = verdict(results, key);
                rows.push(Table1Row::new(
                    &mesh,
                    friction,
                    method,
                    reaction,
                    Some(printed),
                    verdict,
                ));
            }
        }
    }
    Ok(rows)
}

fn beam_rows(results: &Results) -> Result<Vec<Table2Row>, PaperError> {
    let mut rows = Vec::new();
    for record in csv::Reader::from_reader(TABLE2.as_bytes()).deserialize() {
        let (model, component, printed): (String, String, [f64; 7]) = record?;
        for (variant, friction) in VARIANTS {
            let reference = Table2Row::printed(&model, variant, &component, printed);
            for (name, _) in BEAMS.iter().filter(|(_, own)| *own == model) {
                for method in PAPER_METHODS {
                    let key = |k: &RunKey| {
                        k.case == *name && k.friction == friction && k.method == method
                    };
                    let row = probe_row(results, key, &component);
                    rows.push(Table2Row::computed(
                        &reference,
                        method,
                        row,
                        verdict(results, key),
                    ));
                }
            }
            rows.push(reference);
        }
    }
    Ok(rows)
}

/// One component of P1 … P7 [mm]; NaN where the run has no solution.
fn probe_row(results: &Results, key: impl Fn(&RunKey) -> bool, component: &str) -> [f64; 7] {
    std::array::from_fn(|i| {
        let probe = format!("P{}", i + 1);
        value(results, &key, "displacement", &probe, component).map_or(f64::NAN, |u| u * 1e3)
    })
}

/// Largest difference between the two models of the beam over points, components, friction values and exact methods.
fn beam_difference(results: &Results) -> f64 {
    let mut largest: f64 = 0.0;
    for method in METHODS.iter().filter(|m| m.exact) {
        for (_, friction) in VARIANTS {
            for component in ["x", "y", "z"] {
                let of = |case: &str| {
                    let key = |k: &RunKey| {
                        k.case == case && k.friction == friction && k.method == method.name
                    };
                    probe_row(results, key, component)
                };
                for (one, two) in of(EXACT_BEAM).iter().zip(of(BEAMS[1].0)) {
                    let difference = (one - two).abs();
                    // `max` would drop a NaN, and a missing run must show.
                    largest = if difference.is_nan() {
                        f64::NAN
                    } else {
                        largest.max(difference)
                    };
                }
            }
        }
    }
    largest
}

/// The penalty method on Mesh I: reaction against that of the reference method.
fn penalty_rows(
    results: &Results,
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Vec<PenaltyRow>, PaperError> {
    let plate = case(PLATES[0].0)?;
    let mut choices = Vec::new();
    for c in PENALTIES {
        choices.push(choice(
            "penalty",
            &[("normal".into(), c), ("tangential".into(), c)],
        )?);
    }
    let swept = run_case(&plate, &choices, settings, progress)?;
    let mut rows = Vec::new();
    for &friction in &plate.sweep.friction {
        let exact = value(
            results,
            |k| k.case == plate.name && k.friction == friction && k.method == REFERENCE_METHOD,
            "reaction",
            "top",
            "y",
        );
        for (c, choice) in PENALTIES.iter().zip(&choices) {
            let key = |k: &RunKey| k.friction == friction && k.method == choice.label;
            let found = value(&swept, key, "reaction", "top", "y");
            let run = swept.runs.iter().find(|r| key(&r.key));
            rows.push(PenaltyRow {
                friction,
                parameter: *c,
                reaction_mn_per_m: found.map_or(f64::NAN, |r| -r / 1e6),
                relative_error: match (found, exact) {
                    (Some(found), Some(exact)) => ((found - exact) / exact).abs(),
                    _ => f64::NAN,
                },
                max_penetration_m: value(&swept, key, "max_penetration", "crack-1", "")
                    .unwrap_or(f64::NAN),
                natural_map: run.map_or(f64::NAN, |r| r.natural_map),
                verdict: run.map(|r| r.verdict.clone()),
            });
        }
    }
    Ok(rows)
}

fn refinement_rows(
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Vec<RefinementRow>, PaperError> {
    let method = choice(REFERENCE_METHOD, &[])?;
    let mut rows = Vec::new();
    for (name, family, factors) in REFINEMENTS {
        let mut plate = case(name)?;
        plate.sweep.refine = factors.to_vec();
        plate.expects.clear();
        let results = run_case(&plate, std::slice::from_ref(&method), settings, progress)?;
        let width = plate.mesh.lines[0].last().unwrap_or(&0.0) - plate.mesh.lines[0][0];
        let columns = plate.mesh.lines[0].len() - 1;
        for run in &results.runs {
            // The label begins with the number of columns.
            let found: usize = run
                .key
                .mesh
                .split('x')
                .next()
                .and_then(|n| n.parse().ok())
                .unwrap_or(columns);
            rows.push(RefinementRow {
                family: family.into(),
                mesh: run.key.mesh.clone(),
                h_m: width / found as f64,
                friction: run.key.friction,
                dofs: run.dofs,
                reaction_mn_per_m: value(&results, |k| *k == run.key, "reaction", "top", "y")
                    .map_or(f64::NAN, |r| -r / 1e6),
                verdict: run.verdict.clone(),
            });
        }
    }
    Ok(rows)
}

/// Limits for h → 0 from the two finest meshes of each family, R(h) = R + C h: the tips leave a √r field, edge pairs
/// leave the jump free between them, and both cost one power of h in the energy.
fn limit_rows(rows: &[RefinementRow]) -> Vec<LimitRow> {
    let mut frictions: Vec<f64> = rows.iter().map(|r| r.friction).collect();
    frictions.sort_by(f64::total_cmp);
    frictions.dedup();
    frictions
        .into_iter()
        .map(|friction| {
            let limit = |family: &str| {
                let mut own: Vec<&RefinementRow> = rows
                    .iter()
                    .filter(|r| r.family == family && r.friction == friction)
                    .collect();
                own.sort_by(|a, b| a.h_m.total_cmp(&b.h_m));
                match own.as_slice() {
                    [fine, next, ..] => {
                        let slope = (next.reaction_mn_per_m - fine.reaction_mn_per_m)
                            / (next.h_m - fine.h_m);
                        fine.reaction_mn_per_m - slope * fine.h_m
                    }
                    _ => f64::NAN,
                }
            };
            LimitRow::new(friction, limit("I"), limit("II"))
        })
        .collect()
}
