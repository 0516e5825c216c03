//! Newton methods on the contact points.

// Contact equations, solved by one loop (`iteration`) that differs in H and H' (`scheme`).
pub mod b_newton;
pub mod gnm;
pub mod ncp_newton;
pub mod newton_ac;
pub mod pdas;

// Along the central path of the cones.
pub mod interior_point;
pub mod ipm_anm;

pub(crate) mod central_path;
pub(crate) mod contact_point;
pub(crate) mod iteration;
pub(crate) mod line_search;
pub(crate) mod path_equations;
pub(crate) mod reuse;
pub(crate) mod scheme;
pub(crate) mod springs;
pub(crate) mod step;
