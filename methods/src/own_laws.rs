//! Methods that solve laws of their own: their distance from the contact laws is a modelling error, and reported.

pub mod barrier;
pub(crate) mod confirm;
pub mod nitsche;
pub mod penalty;
pub(crate) mod stabilisation;
