//! Cracks in the cells of a mesh: level sets, parts of cut cells, where cracks end.

pub mod arms;
pub mod crack;
pub mod flat;
mod near;
pub mod off_facets;
pub mod part;
pub mod partition;
pub mod placement;
pub mod trace;

/// True if a cell has nodes strictly on both sides of the level φ.
pub fn is_split(phi: &[f64]) -> bool {
    phi.iter().any(|&f| f > 0.0) && phi.iter().any(|&f| f < 0.0)
}
