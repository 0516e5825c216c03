//! Compares methods of enforcing frictional contact on crack faces, on one XFEM discretisation.
//!
//! ```text
//! case.toml -> Case -> Mesh + cracks -> Enrichment -> unknowns -> ContactSystem
//!           -> per increment: Enforcement::solve -> Outcome -> residuals() -> Verdict -> tables, figures, fields
//! ```
//!
//! The algebraic half (the contact problem, its judge and the methods) is the package `stickslip-methods`.

pub mod analytic;
pub mod cli;
pub mod fem;
pub mod harness;
pub mod interchange;
pub mod pages;
pub mod paper;
pub mod report;
pub mod sweep;
pub mod xfem;
