//! Quadrature points of the crack surface: where they lie, what jumps there, how far the faces overlap.

use crate::cut::partition::Face;
use crate::cut::placement::cells_at;
use crate::enrichment::basis::Region;
use crate::fields::sampling::CellField;
use crate::geometry::{Point, add_scaled, dot, norm, sub};
use crate::stiffness::cell_matrix::CellIntegrator;

use super::pairs::ContactPoint;

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
    /// Regions of the cell that meet here: that on side 1, that on side 2.
    pub regions: [Region; 2],
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
            .regions
            .map(|region| field.displacement(&self.xi, &self.x, region, u));
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
    if !shape.jumps_at(x, 0.0) {
        return None;
    }
    cells_at(mesh, x).into_iter().find_map(|cell| {
        let corners = mesh.corners(cell);
        let near = 1e-6 * norm(&sub(&corners[0], &corners[2]));
        if shape.distance(x).abs() > near {
            return None;
        }
        // The piece of the crack in this cell that is nearest to the point.
        let faces = enrichment
            .partition(cell)?
            .faces
            .iter()
            .filter(|f| f.crack == crack);
        let middle = |face: &Face| {
            let scale = 1.0 / face.corners.len() as f64;
            face.corners
                .iter()
                .fold([0.0; 3], |sum, c| add_scaled(&sum, scale, &c.0))
        };
        let away = |face: &Face| norm(&sub(&middle(face), x));
        let face = faces.min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let xi = mesh.kind.inverse_map(&corners[..mesh.kind.nodes()], x)?;
        let mut field = CellField::new(integrator, cell);
        let [one, two] = face
            .parts
            .map(|region| field.displacement(&xi, x, region, u));
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
