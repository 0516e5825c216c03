//! The files of the random robustness study.

use super::plot::success_rates;
use super::{Bundle, Provenance, ReportError, table};
use crate::studies::stress::robustness::{RobustnessRow, failures};
use crate::studies::stress::{StressPlan, Trial};

/// `robustness.*`, `failures.csv`, the figure, provenance.
///
/// # Errors
/// Those of [`table::add`] and of the figure.
pub fn bundle(
    plan: &StressPlan,
    trials: &[Trial],
    rows: &[RobustnessRow],
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    table::add(&mut bundle, rows, "")?;
    table::add(&mut bundle, &failures(plan, trials), "")?;
    // Where every method declines every problem there is nothing to draw.
    if rows.iter().any(|row| row.success[0].is_finite()) {
        bundle.add("figures/robustness.svg", success_rates(rows)?)?;
    }
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
