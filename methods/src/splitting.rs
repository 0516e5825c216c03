//! Splitting methods, multiplier methods and sweeps.

pub mod admm;
pub mod augmented_lagrangian;
pub mod latin;
pub mod nsgs;
pub mod projection;
