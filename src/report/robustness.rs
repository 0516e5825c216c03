//! The files of the random robustness study.

use super::{Bundle, Provenance, ReportError, figures, table};
use crate::studies::robustness::summary::{RobustnessRow, failures};
use crate::studies::robustness::{RobustnessPlan, Trial};

/// `robustness.*`, `failures.csv`, the figure, provenance.
///
/// # Errors
/// Those of [`table::add`] and of the figure.
pub fn bundle(
    plan: &RobustnessPlan,
    trials: &[Trial],
    rows: &[RobustnessRow],
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    table::add(&mut bundle, rows, "")?;
    table::add(&mut bundle, &failures(plan, trials), "")?;
    figures::robustness::add(&mut bundle, rows)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
