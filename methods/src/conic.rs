//! Friction as the fixed point of convex problems, solved by clarabel, Tresca's also by gradients.

pub(crate) mod balance;
pub(crate) mod cone_program;
pub(crate) mod fixed_point;
pub(crate) mod mprgp;
pub mod socp;
pub mod tresca;

pub use balance::no_equilibrium;
