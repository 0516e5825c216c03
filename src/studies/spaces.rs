//! Tests of the contact spaces: the numerical inf-sup condition, and the contact patch test.

pub mod infsup;
pub mod patch;
