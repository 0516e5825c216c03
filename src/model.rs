//! A case as a discrete body: unknowns, what acts on it, the quantities read from a solution and their errors.

pub mod body;
pub mod boundary;
pub mod cost;
pub mod errors;
pub mod extent;
pub mod field_mesh;
pub mod fixed_loads;
pub mod intensities;
pub mod loading;
pub mod memory;
pub mod nodal_forces;
pub mod quantities;
pub mod refusals;
pub mod resolution;
pub mod snapshot;
