//! The plate over one parameter: reaction against the penalty stiffness, and against the cell width on both meshes.

use crate::run::record::Results;
use crate::run::run_case::{Progress, Settings, run_case};
use crate::run::verdict::Verdict;
use crate::studies::convergence::linear_limit;
use crate::studies::paper::lookup::{
    PaperError, REACTION, REFERENCE_METHOD, Run, as_printed, case, choice,
};

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
    let stiffness = |c| choice("penalty", &[("normal".into(), c), ("tangential".into(), c)]);
    let choices: Vec<_> = PENALTIES
        .into_iter()
        .map(stiffness)
        .collect::<Result<_, _>>()?;
    let swept = run_case(&plate, &choices, settings, progress)?;
    let mut rows = Vec::new();
    for &friction in &plate.sweep.friction {
        let run = |results, method| Run::of(results, &plate.name, friction, method);
        let exact = run(results, REFERENCE_METHOD).value(REACTION);
        for (c, choice) in PENALTIES.iter().zip(&choices) {
            let run = run(&swept, &choice.label);
            let (found, row) = (run.value(REACTION), run.last());
            let deepest = run.value(["max_penetration", "crack-1", ""]);
            rows.push(PenaltyRow {
                friction,
                parameter: *c,
                reaction_mn_per_m: found.map_or(f64::NAN, as_printed),
                relative_error: match (found, exact) {
                    (Some(found), Some(exact)) => ((found - exact) / exact).abs(),
                    _ => f64::NAN,
                },
                max_penetration_m: deepest.unwrap_or(f64::NAN),
                natural_map: row.map_or(f64::NAN, |r| r.natural_map),
                verdict: run.verdict(),
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
        plate.expects.clear();
        let lines = &plate.mesh.grid.lines[0];
        let (columns, width) = (lines.len() - 1, lines.last().unwrap_or(&0.0) - lines[0]);
        for &factor in factors {
            plate.sweep.refine = vec![factor];
            let results = run_case(&plate, std::slice::from_ref(&method), settings, progress)?;
            rows.extend(results.runs.iter().map(|row| {
                let run = Run::of(&results, name, row.key.friction, &method.label);
                RefinementRow {
                    family: family.into(),
                    mesh: row.key.mesh.clone(),
                    h_m: width / (factor * columns) as f64,
                    friction: row.key.friction,
                    dofs: row.dofs,
                    reaction_mn_per_m: run.value(REACTION).map_or(f64::NAN, as_printed),
                    verdict: row.verdict.clone(),
                }
            }));
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
                let own = rows
                    .iter()
                    .filter(|r| r.family == family && r.friction == friction);
                let mut own: Vec<_> = own.map(|r| [r.h_m, r.reaction_mn_per_m]).collect();
                own.sort_by(|a, b| a[0].total_cmp(&b[0]));
                match own[..] {
                    [fine, next, ..] => linear_limit([next, fine]),
                    _ => f64::NAN,
                }
            };
            LimitRow::new(friction, limit("I"), limit("II"))
        })
        .collect()
}
