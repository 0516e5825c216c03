//! The files of the convergence study.

use super::{Bundle, Provenance, ReportError, figures, table};
use crate::studies::convergence::orders::{ErrorRow, OrderRow};

/// `convergence.csv`, `orders.*`, figures, provenance.
///
/// # Errors
/// Those of [`table::add`] and of the figures.
pub fn bundle(
    errors: &[ErrorRow],
    orders: &[OrderRow],
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    table::add(&mut bundle, errors, "")?;
    table::add(&mut bundle, orders, "")?;
    figures::error::add(&mut bundle, errors, orders)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
