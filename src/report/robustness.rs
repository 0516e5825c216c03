//! The files of the random robustness study.

use super::{Bundle, Provenance, ReportError, figures, table};
use crate::studies::robustness::atlas::{atlas, stopping};
use crate::studies::robustness::summary::{RobustnessRow, failures};
use crate::studies::robustness::{RobustnessPlan, Trial};

/// `robustness.*`, `failures.csv`, `atlas.*`, `stopping.*`, the figure, provenance.
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
    table::add(&mut bundle, &atlas(trials), "")?;
    table::add(&mut bundle, &stopping(trials), "")?;
    figures::robustness::add(&mut bundle, rows)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
