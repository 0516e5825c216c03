//! Quadrature points of the crack surface: where they lie, what jumps there, how far the faces overlap.

use crate::fem::{Point, dot, norm, sub};

use super::cut::Side;
use super::enrichment::cells_at;
use super::sampling::CellField;
use super::{cell_matrix::CellIntegrator, pairs::ContactPoint};

/// A quadrature point of the crack surface.
#[derive(Debug, Clone)]
pub struct SurfacePoint {
    /// Crack number, from 0, in the case file.
    pub crack: usize,
    /// Cell the point lies in.
    pub cell: usize,
    /// Position [m].
    pub x: Point,
    /// Reference position in the cell.
    pub xi: Point,
    /// Share of the crack surface: length [m] or area [m²].
    pub weight: f64,
    /// Side of the cell's functions on the two faces: that of side 1, that of side 2.
    pub sides: [Side; 2],
    /// Local frame n, a, b.
    pub frame: [Point; 3],
    /// Contact points and the value of their multiplier basis functions here: λ_h = Σ share · P/w of the contact point,
    /// component by component in local frames.
    pub shares: Vec<(u32, f64)>,
}

impl SurfacePoint {
    /// Jump u₁ − u₂ in space [m], from all unknowns.
    pub fn jump(&self, integrator: &CellIntegrator<'_>, u: &[f64]) -> Point {
        let mut field = CellField::new(integrator, self.cell);
        let [one, two] = self
            .sides
            .map(|side| field.displacement(&self.xi, &self.x, side, u));
        sub(&one, &two)
    }

    /// A vector in the local frame (n, a, b).
    pub fn local(&self, v: &Point) -> [f64; 3] {
        [0, 1, 2].map(|k| dot(v, &self.frame[k]))
    }

    /// Contact traction λ_h on side 1 in the local frame [Pa]; `p`: contact forces, `dim` per point.
    pub fn traction(&self, dim: usize, points: &[ContactPoint], p: &[f64]) -> [f64; 3] {
        let mut traction = [0.0; 3];
        for &(point, share) in &self.shares {
            let i = point as usize;
            for (t, force) in traction.iter_mut().zip(&p[i * dim..(i + 1) * dim]) {
                *t += share * force / points[i].weight;
            }
        }
        traction
    }
}

/// Jump u₁ − u₂ in space [m] at a point of a crack of the enrichment, from all unknowns; `None` if no cell that this crack
/// splits holds the point, or it lies off the crack by more than 1e-6 of such a cell, or beyond an end.
pub fn jump_at(
    integrator: &CellIntegrator<'_>,
    crack: usize,
    x: &Point,
    u: &[f64],
) -> Option<Point> {
    let CellIntegrator {
        mesh, enrichment, ..
    } = integrator;
    let shape = &integrator.cracks[crack];
    let s = shape.abscissa(x);
    if shape.length.is_finite() && !(0.0..=shape.length).contains(&s) {
        return None;
    }
    cells_at(mesh, x).into_iter().find_map(|cell| {
        let corners = mesh.corners(cell);
        let near = 1e-6 * norm(&sub(&corners[0], &corners[2]));
        if enrichment.split[cell] != Some(crack as u32) || shape.distance(x).abs() > near {
            return None;
        }
        let xi = mesh.kind.inverse_map(&corners[..mesh.kind.nodes()], x)?;
        let mut field = CellField::new(integrator, cell);
        let [one, two] = [1.0, -1.0].map(|side| field.displacement(&xi, x, side, u));
        Some(sub(&one, &two))
    })
}

/// Deepest overlap of the two faces over sample points, max(0, −gap) [m]; only position, cell, sides and frame of a sample
/// count. Between contact points nothing keeps the faces apart, so the samples should lie much closer than those, ten per
/// facet.
pub fn max_penetration<'a>(
    integrator: &CellIntegrator<'_>,
    samples: impl IntoIterator<Item = &'a SurfacePoint>,
    u: &[f64],
) -> f64 {
    samples
        .into_iter()
        .map(|sample| -sample.local(&sample.jump(integrator, u))[0])
        .fold(0.0, f64::max)
}
