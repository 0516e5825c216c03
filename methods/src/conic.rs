//! Friction as the fixed point of convex problems, each solved by clarabel.

pub(crate) mod anderson;
pub(crate) mod balance;
pub(crate) mod cone_program;
pub(crate) mod fixed_point;
pub mod socp;
pub mod tresca;

pub use balance::unbalanced;
