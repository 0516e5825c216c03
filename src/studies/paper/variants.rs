//! Variants of the methods on the paper's plate and beam: they stand beside the defaults in the comparison.

use super::lookup::{PaperError, case, choice};
use crate::run::choice::Choice;
use crate::run::progress::Progress;
use crate::run::registry::methods;
use crate::studies::cases::{Settings, run_case};
use crate::studies::record::Record;

/// Cases that variants are run on.
const CASES: [&str; 2] = ["plate_mesh1", "beam_model1"];

/// Variants beside the monolithic ones: one option changed.
const VARIANTS: [(&str, &str, f64); 4] = [
    ("socp", "polish", 0.0),
    ("tresca", "polish", 0.0),
    ("nitsche", "theta", 0.0),
    ("nitsche", "theta", -1.0),
];

/// The option of methods that can work on the matrix over all unknowns.
const MONOLITHIC: &str = "monolithic";

/// Runs of all variants.
///
/// # Errors
/// Of the cases or their discretisation.
pub fn variant_runs(
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Vec<Record>, PaperError> {
    let choices = variants()?;
    let mut runs = Vec::new();
    for name in CASES {
        let found = run_case(&case(name)?, &choices, settings, progress)?;
        runs.extend(found.answers.into_iter().map(|own| own.record));
    }
    Ok(runs)
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
}
