//! The paper's plate and beam by every method and its variants: one table.

use crate::run::registry::methods;

use crate::run::choice::Choice;
use crate::run::progress::Progress;
use crate::run::verdict::Verdict;
use crate::studies::cases::{Settings, run_case};
use crate::studies::paper::lookup::{
    Compared, PaperError, REACTION, REFERENCE_METHOD, Run, case, choice,
};
use crate::studies::rows::{Results, RunRow};

/// Case, friction coefficients, and what is compared: (quantity, at, component).
const PROBLEMS: [(&str, &[f64], Compared); 2] = [
    ("plate_mesh1", &[0.1, 0.8, 1.2], REACTION),
    ("beam_model1", &[0.1], ["displacement", "P4", "z"]),
];

/// Variants beside the defaults and the monolithic ones: one option changed.
const VARIANTS: [(&str, &str, f64); 4] = [
    ("socp", "polish", 0.0),
    ("tresca", "polish", 0.0),
    ("nitsche", "theta", 0.0),
    ("nitsche", "theta", -1.0),
];

/// The option of methods that can work on the matrix over all unknowns.
const MONOLITHIC: &str = "monolithic";

/// One of the paper's problems by one method or variant.
#[derive(Debug, Clone, PartialEq)]
pub struct VariantRow {
    /// Case.
    pub case: String,
    /// Friction coefficient [-].
    pub friction: f64,
    /// Method, options other than the default in brackets.
    pub method: String,
    /// Claim × check; none where there is no such run.
    pub verdict: Option<Verdict>,
    /// What is compared: `reaction top y` of the plate [N/m], `displacement P4 z` of the beam [m].
    pub quantity: String,
    /// Its value; NaN where the run has no answer.
    pub value: f64,
    /// Deviation from the reference method on the same mesh, relative [-].
    pub deviation: f64,
    /// Natural map found by the judge [-].
    pub natural_map: f64,
    /// Iterations.
    pub iterations: usize,
    /// Dense factorisations of condensed matrices.
    pub tangent_factorisations: usize,
    /// Sparse factorisations over all unknowns.
    pub global_factorisations: usize,
    /// Solve time [s].
    pub solve_s: f64,
}

/// All rows; the defaults come from the runs of all cases, the variants are run here.
pub fn variant_rows(
    results: &Results,
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Vec<VariantRow>, PaperError> {
    let choices = variants()?;
    let mut rows = Vec::new();
    for (name, frictions, compared) in PROBLEMS {
        let mut problem = case(name)?;
        problem.sweep.friction = frictions.to_vec();
        problem.expects.clear();
        let swept = run_case(&problem, &choices, settings, progress)?;
        for &friction in frictions {
            let run = |results, method| Run::of(results, name, friction, method);
            let reference = run(results, REFERENCE_METHOD).value(compared);
            let row = |run| row(run, compared, reference.unwrap_or(f64::NAN));
            rows.extend(methods().iter().map(|m| row(run(results, m.name))));
            rows.extend(choices.iter().map(|c| row(run(&swept, &c.label))));
        }
    }
    Ok(rows)
}

/// Every method that has a monolithic variant by it, then `VARIANTS`.
fn variants() -> Result<Vec<Choice>, PaperError> {
    let whole = methods()
        .iter()
        .filter(|m| m.options.iter().any(|o| o.name() == MONOLITHIC))
        .map(|m| (m.name, MONOLITHIC, 1.0));
    whole
        .chain(VARIANTS)
        .map(|(method, option, value)| choice(method, &[(option.into(), value)]))
        .collect()
}

/// One row. A run that is missing must show.
fn row(run: Run<'_>, compared: Compared, reference: f64) -> VariantRow {
    let last = run.last();
    let value = run.value(compared).unwrap_or(f64::NAN);
    let count = |of: fn(&RunRow) -> usize| last.map_or(0, of);
    VariantRow {
        case: run.case.into(),
        friction: run.friction,
        method: run.method.into(),
        verdict: run.verdict(),
        quantity: compared.join(" "),
        value,
        deviation: ((value - reference) / reference).abs(),
        natural_map: last.map_or(f64::NAN, |r| r.step.judge.natural_map),
        iterations: count(|r| r.step.iterations),
        tangent_factorisations: count(|r| r.step.tangent_factorisations),
        global_factorisations: count(|r| r.step.global_factorisations),
        solve_s: last.map_or(f64::NAN, |r| r.solve_s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_with_a_monolithic_variant_is_run_by_it() {
        let labels: Vec<String> = (variants().unwrap().into_iter()).map(|c| c.label).collect();
        for method in methods() {
            let has = method.options.iter().any(|o| o.name() == "monolithic");
            let label = format!("{}[monolithic=1e0]", method.name);
            assert_eq!(labels.contains(&label), has, "{label}: {labels:?}");
        }
    }

    #[test]
    fn a_missing_run_has_a_row_that_says_so() {
        let nothing = Results::default();
        let run = Run::of(&nothing, "plate_mesh1", 0.1, "latin");
        let row = row(run, REACTION, 1.0);
        assert_eq!((&row.verdict, row.method.as_str()), (&None, "latin"));
        let numbers = [row.value, row.deviation, row.natural_map, row.solve_s];
        assert!(numbers.iter().all(|x| x.is_nan()), "{row:?}");
    }
}
