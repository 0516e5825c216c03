//! Compares methods of enforcing frictional contact on crack faces on one XFEM discretisation.

pub mod harness;
pub mod report;
