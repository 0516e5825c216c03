//! Compares methods of enforcing frictional contact on crack faces, on one XFEM discretisation.
//!
//! ```text
//! case.toml -> Case -> Mesh + cracks -> Enrichment -> unknowns -> ContactSystem
//!           -> per increment: Enforcement::solve -> Outcome -> residuals() -> Verdict -> tables, figures, fields
//! ```
//!
//! The discretisation is the package `stickslip-xfem`, the algebraic half (the contact problem, its judge and the methods)
//! the package `stickslip-methods`. The modules below stand in their order: each imports only those above it.

pub mod case;
pub mod model;

pub mod files;

pub mod run;
pub mod studies;

pub mod report;

pub mod cli;
