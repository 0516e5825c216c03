//! Integrals of fields over the body: points at which solutions are compared, mass.

pub mod mass;
pub mod sampling;

#[cfg(test)]
mod tests;
