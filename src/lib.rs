//! Compares methods of enforcing frictional contact on crack faces, on one XFEM discretisation.
//!
//! ```text
//! case.toml -> Case -> Mesh + cracks -> Enrichment -> unknowns -> ContactSystem
//!           -> per increment: Enforcement::solve -> Outcome -> residuals() -> Verdict -> tables, figures, fields
//! ```
//!
//! The discretisation is the package `stickslip-xfem`, the algebraic half (the contact problem, its judge and the methods)
//! the package `stickslip-methods`.

pub mod cli;
pub mod harness;
pub mod interchange;
pub mod pages;
pub mod paper;
pub mod report;
pub mod sweep;
