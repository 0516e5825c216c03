//! Turns the rows and fields of a run into files: CSV, tables, figures, ParaView files, provenance.
//!
//! One output kind per module. Every module returns text or bytes; a [`Bundle`] collects them and writes them all or
//! none. Nothing here computes mechanics and nothing reads the clock: the same [`Results`](crate::studies::results::Results)
//! give the same bytes. Columns, digits and file names are documented by `stickslip show schema`.

pub mod convergence;
mod error;
pub mod figures;
pub mod names;
pub mod number;
pub mod page;
pub mod paper;
pub mod plot;
pub mod schema;
pub mod standard;
pub mod stress;
pub mod sweep;
pub mod table;
pub mod tables;
pub mod vtu;

pub use crate::files::bundle::Bundle;
pub use crate::files::claim::Claim;
pub use crate::files::claim::{Plan, plan};
pub use crate::run::provenance::Provenance;
pub use error::ReportError;

/// Adds what was read, by file name, below `input/`: a folder can be made again from itself.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_input(
    bundle: &mut Bundle,
    texts: impl IntoIterator<Item = (String, String)>,
) -> Result<(), ReportError> {
    for (name, text) in texts {
        bundle.add(format!("input/{name}"), text)?;
    }
    Ok(())
}

/// Adds `provenance.toml`.
///
/// # Errors
/// Those of [`Provenance::to_toml`] and [`Bundle::add`].
pub fn add_provenance(bundle: &mut Bundle, provenance: &Provenance) -> Result<(), ReportError> {
    Ok(bundle.add("provenance.toml", provenance.to_toml()?)?)
}
