//! Quadrature points of the crack surface.

use crate::fem::Point;

use super::cut::Side;

/// A quadrature point of the crack surface.
#[derive(Debug, Clone)]
pub struct SurfacePoint {
    /// Crack number, from 0, in the case file.
    pub crack: usize,
    /// Cell that the crack cuts here.
    pub cell: usize,
    /// Position [m].
    pub x: Point,
    /// Reference position in the cell.
    pub xi: Point,
    /// Length [m] or area [m²].
    pub weight: f64,
    /// Sides of the cell that meet here: that of side 1, that of side 2.
    pub sides: [Side; 2],
    /// Local frame n, a, b.
    pub frame: [Point; 3],
    /// Contact points and the values of their multiplier basis functions here, which sum to one:
    /// λ_h = Σ share · P_point / weight_point.
    pub shares: Vec<(u32, f64)>,
}
