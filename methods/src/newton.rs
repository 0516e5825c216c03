//! Newton methods on the contact points.

pub(crate) mod b_equations;
pub mod b_newton;
pub(crate) mod central_path;
pub mod hybrid;
pub mod interior_point;
pub(crate) mod iteration;
pub(crate) mod line_search;
pub mod newton_ac;
pub mod pdas;
pub(crate) mod springs;
pub(crate) mod step;
