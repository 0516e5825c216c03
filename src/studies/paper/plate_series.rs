//! The plate over one parameter: reaction against the penalty stiffness, and against the cell width on both meshes.

use crate::run::record::{Results, RunKey};
use crate::run::run_case::{Progress, Settings, run_case};
use crate::run::verdict::Verdict;
use crate::studies::paper::lookup::{PaperError, REFERENCE_METHOD, case, choice, value};

/// Multiples of the natural scale that the penalty stiffness is swept over.
const PENALTIES: [f64; 7] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];
/// Refinement factors: even ones would put the crack of Mesh II on a grid line.
const REFINEMENTS: [(&str, &str, &[usize]); 2] = [
    ("plate_mesh1", "I", &[1, 2, 4, 8]),
    ("plate_mesh2", "II", &[1, 3, 5, 7]),
];

/// Error of the penalty method for one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct PenaltyRow {
    /// Friction coefficient [-].
    pub friction: f64,
    /// k_n/ρ = k_t/ρ, stiffness in multiples of the natural scale [-].
    pub parameter: f64,
    /// Reaction at the top [MN/m].
    pub reaction_mn_per_m: f64,
    /// |reaction − exact| / |exact|, exact by the reference method on the same mesh [-].
    pub relative_error: f64,
    /// Largest penetration [m].
    pub max_penetration_m: f64,
    /// Natural map found by the judge [-].
    pub natural_map: f64,
    /// Claim × check; none where there is no such run.
    pub verdict: Option<Verdict>,
}

/// Reaction of the plate on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct RefinementRow {
    /// Mesh of the paper: `I` or `II`.
    pub family: String,
    /// Mesh label.
    pub mesh: String,
    /// Cell width [m].
    pub h_m: f64,
    /// Friction coefficient [-].
    pub friction: f64,
    /// Free unknowns.
    pub dofs: usize,
    /// Reaction at the top [MN/m].
    pub reaction_mn_per_m: f64,
    /// Claim × check.
    pub verdict: Verdict,
}

/// Limits of the reaction for h → 0.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitRow {
    /// Friction coefficient [-].
    pub friction: f64,
    /// Limit of Mesh I [MN/m].
    pub mesh_1_mn_per_m: f64,
    /// Limit of Mesh II [MN/m].
    pub mesh_2_mn_per_m: f64,
    /// |difference| / mean [-].
    pub relative_gap: f64,
}

impl LimitRow {
    /// A line with its gap computed.
    pub fn new(friction: f64, mesh_1_mn_per_m: f64, mesh_2_mn_per_m: f64) -> Self {
        let mean = 0.5 * (mesh_1_mn_per_m + mesh_2_mn_per_m);
        LimitRow {
            friction,
            mesh_1_mn_per_m,
            mesh_2_mn_per_m,
            relative_gap: ((mesh_1_mn_per_m - mesh_2_mn_per_m) / mean).abs(),
        }
    }
}

/// The penalty method on Mesh I: reaction against that of the reference method.
pub fn penalty_rows(
    results: &Results,
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Vec<PenaltyRow>, PaperError> {
    let plate = case(REFINEMENTS[0].0)?;
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

/// Both meshes under refinement by the reference method.
///
/// # Errors
/// Of the cases or their discretisation.
pub fn refinement_rows(
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
        let width = plate.mesh.grid.lines[0].last().unwrap_or(&0.0) - plate.mesh.grid.lines[0][0];
        let columns = plate.mesh.grid.lines[0].len() - 1;
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
pub fn limit_rows(rows: &[RefinementRow]) -> Vec<LimitRow> {
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
