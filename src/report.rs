//! Turns the rows and fields of a run into files: CSV, tables, figures, ParaView files, provenance.
//!
//! One output kind per module. Every module returns text or bytes; a [`Bundle`] collects them and writes them all or
//! none. Nothing here computes mechanics and nothing reads the clock: the same [`Results`](crate::harness::record::Results)
//! give the same bytes. Columns, digits and file names are documented in `docs/schema.md`.

pub mod bundle;
pub mod comparison;
pub mod converge;
pub mod converged;
pub mod csv;
mod error;
mod error_figures;
pub mod infsup;
mod loops;
pub mod number;
pub mod page;
pub mod paper;
pub mod patch;
pub mod plot;
pub mod provenance;
mod quantity_name;
pub mod robustness;
pub mod standard;
pub mod study;
pub mod sweep;
pub mod tables;
pub mod timings;
pub mod vtu;

pub use bundle::{Bundle, prepare_output};
pub use error::ReportError;
pub use provenance::Provenance;
