//! The plate over the penalty stiffness.

use crate::run::progress::Progress;
use crate::run::verdict::Verdict;
use crate::studies::cases::{Settings, run_case};
use crate::studies::paper::lookup::{
    PaperError, REACTION, REFERENCE_METHOD, Run, as_printed, case, choice,
};
use crate::studies::results::Results;

/// Multiples of the natural scale that the penalty stiffness is swept over.
const PENALTIES: [f64; 7] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];

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

/// The penalty method on Mesh I: reaction against that of the reference method.
pub fn penalty_rows(
    results: &Results,
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Vec<PenaltyRow>, PaperError> {
    let plate = case("plate_mesh1")?;
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
            let found = run.value(REACTION);
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
                natural_map: run.record().map_or(f64::NAN, |r| r.found.natural_map()),
                verdict: run.verdict(),
            });
        }
    }
    Ok(rows)
}
