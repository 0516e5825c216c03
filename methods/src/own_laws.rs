//! Methods that solve laws of their own: their distance from the contact laws is a modelling error, and reported.

// Springs.
pub mod penalty;

// A barrier energy; the stress of the body.
pub mod barrier;
pub mod nitsche;

pub(crate) mod confirm;
pub(crate) mod stabilisation;
pub(crate) mod unloaded;
