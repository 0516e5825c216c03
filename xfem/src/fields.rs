//! Integrals of fields over the body: points at which solutions are compared.

pub mod sampling;

#[cfg(test)]
mod tests;
