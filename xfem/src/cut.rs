//! Cracks in the cells of a mesh: one arrangement in the plane, level sets in solids, the regions of cut cells.

pub mod arrangement;
pub mod crack;
pub mod part;
pub mod partition;
pub mod placement;
pub mod regions;
pub mod sheets;
pub mod solid_arms;

/// True if a cell has nodes strictly on both sides of the level φ.
pub fn is_split(phi: &[f64]) -> bool {
    phi.iter().any(|&f| f > 0.0) && phi.iter().any(|&f| f < 0.0)
}
