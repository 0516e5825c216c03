//! Splitting methods, multiplier methods and sweeps.

// All points at once, along search directions.
pub mod augmented_lagrangian;
pub mod latin;

// The same with projections on the cone.
pub mod admm;

// Point by point, or by projections alone.
pub mod accelerated_gradient;
pub mod nsgs;
pub mod projection;
