//! From a point in space back to the reference cell.

use crate::geometry::{Point, dot, sub};

use super::cell::CellMap;

/// The inverse of a map, on distorted cells by Newton's method.
pub struct Inverter {
    /// The map seen from its first corner.
    local: CellMap,
    origin: Point,
    /// x(0) from there, and ∂ξ/∂x of an affine cell.
    centre: Point,
    constant: Option<[Point; 3]>,
}

impl Inverter {
    /// Of a map.
    pub fn new(map: &CellMap) -> Self {
        // From the first corner: far from the origin the coordinates themselves hold too few digits of the difference.
        let origin = map[0];
        let local = CellMap::new(map.kind, |i| sub(&map[i], &origin));
        Inverter {
            constant: local.constant_inverse(),
            centre: local.at(&[0.0; 3]),
            local,
            origin,
        }
    }

    /// ξ of a point in space; `None` if it does not converge (point far outside a distorted cell). On affine cells one step
    /// is enough.
    pub fn at(&self, x: &Point) -> Option<Point> {
        /// Newton steps; bilinear maps need 3 to 6 inside the cell.
        const STEPS: usize = 30;
        /// In reference units, well above rounding and far below any quadrature error.
        const TOLERANCE: f64 = 1e-14;
        let (local, kind) = (&self.local, self.local.kind);
        let x = sub(x, &self.origin);
        if let Some(inverse) = &self.constant {
            let from_centre = sub(&x, &self.centre);
            let mut xi = [0.0; 3];
            for b in 0..kind.dim() {
                xi[b] = dot(&inverse[b], &from_centre);
            }
            return xi.iter().all(|x| x.is_finite()).then_some(xi);
        }
        let mut xi = [0.0; 3];
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let residual = sub(&x, &local.at(&xi));
            let inverse = local.inverse_jacobian(&kind.reference_gradients(&xi)).0;
            let mut step: f64 = 0.0;
            for b in 0..kind.dim() {
                let delta = dot(&inverse[b], &residual);
                xi[b] += delta;
                step = step.max(delta.abs());
            }
            // A cell without measure has no inverse.
            if !xi.iter().all(|x| x.is_finite()) {
                return None;
            }
            // Converged, or the step has sunk into rounding and no longer shrinks.
            if step <= TOLERANCE || (step < 1e-12 && step >= last) {
                return Some(xi);
            }
            last = step;
        }
        None
    }
}
