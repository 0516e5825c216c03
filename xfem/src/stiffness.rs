//! Stiffness of enriched cells and of the body: integration, matrices, assembly.

pub mod assembly;
pub mod assumed_stress;
pub mod block_matrix;
pub mod border;
pub mod cell_matrices;
pub mod cell_matrix;
pub mod consistent;
pub mod dilatation;
pub mod elasticity;
pub(crate) mod inverse_iteration;
pub mod lanes;
pub mod near_front;
pub mod orthonormal;
pub mod stress;
