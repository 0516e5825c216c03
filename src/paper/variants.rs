//! The paper's plate and beam by every method and its variants: one table.

use stickslip_methods::METHODS;

use super::{PaperError, REFERENCE_METHOD, case, choice, value};
use crate::harness::record::{Results, RunRow};
use crate::harness::run::{Progress, Settings, run_case};
use crate::report::comparison::VariantRow;

/// Case, friction coefficients, and what is compared: (quantity, at, component).
const PROBLEMS: [(&str, &[f64], [&str; 3]); 2] = [
    ("plate_mesh1", &[0.1, 0.8, 1.2], ["reaction", "top", "y"]),
    ("beam_model1", &[0.1], ["displacement", "P4", "z"]),
];

/// Variants beside the defaults: one option changed.
const VARIANTS: [(&str, &str, f64); 9] = [
    ("b-newton", "monolithic", 1.0),
    ("newton-ac", "monolithic", 1.0),
    ("penalty", "monolithic", 1.0),
    ("augmented-lagrangian", "monolithic", 1.0),
    ("socp", "polish", 0.0),
    ("tresca", "polish", 0.0),
    ("projection", "variant", 1.0),
    ("nitsche", "theta", 0.0),
    ("nitsche", "theta", -1.0),
];

/// All rows; the defaults come from the runs of all cases, the variants are run here.
pub fn rows(
    results: &Results,
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Vec<VariantRow>, PaperError> {
    let mut choices = Vec::new();
    for (method, option, value) in VARIANTS {
        choices.push(choice(method, &[(option.into(), value)])?);
    }
    let mut rows = Vec::new();
    for (name, frictions, quantity) in PROBLEMS {
        let mut problem = case(name)?;
        problem.sweep.friction = frictions.to_vec();
        problem.expects.clear();
        let swept = run_case(&problem, &choices, settings, progress)?;
        for &friction in frictions {
            let reference = value_of(results, name, friction, REFERENCE_METHOD, quantity);
            let mut push = |of: &Results, method: &str| {
                let found = value_of(of, name, friction, method, quantity);
                rows.extend(run_of(of, name, friction, method).map(|run| VariantRow {
                    case: name.into(),
                    friction,
                    method: method.into(),
                    verdict: run.verdict.clone(),
                    quantity: quantity.join(" "),
                    value: found,
                    deviation: ((found - reference) / reference).abs(),
                    natural_map: run.natural_map,
                    iterations: run.iterations,
                    tangent_factorisations: run.tangent_factorisations,
                    global_factorisations: run.global_factorisations,
                    solve_s: run.solve_s,
                }));
            };
            METHODS.iter().for_each(|m| push(results, m.name));
            choices.iter().for_each(|c| push(&swept, &c.label));
        }
    }
    Ok(rows)
}

fn value_of(
    results: &Results,
    case: &str,
    friction: f64,
    method: &str,
    [quantity, at, component]: [&str; 3],
) -> f64 {
    let key = |k: &crate::harness::record::RunKey| {
        k.case == case && k.friction == friction && k.method == method
    };
    value(results, key, quantity, at, component).unwrap_or(f64::NAN)
}

fn run_of<'a>(results: &'a Results, case: &str, friction: f64, method: &str) -> Option<&'a RunRow> {
    let own =
        |r: &&RunRow| r.key.case == case && r.key.friction == friction && r.key.method == method;
    results.runs.iter().rfind(own)
}
