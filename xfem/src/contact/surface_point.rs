//! Quadrature points of the crack surface: where they lie, what jumps there, how far the faces overlap.

use crate::cut::part::Face;
use crate::cut::placement::cells_at;
use crate::enrichment::basis::Region;
use crate::enrichment::facets::Facet;
use crate::geometry::{Point, norm, resolve, sub};
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

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
    /// A point of a facet of the `index`-th crack that stands for a place only: no weight, no shares.
    ///
    /// # Errors
    /// A point without a reference position in the cell.
    pub fn on_facet(
        integrator: &CellIntegrator<'_>,
        index: usize,
        facet: &Facet,
        x: Point,
    ) -> Result<Self, CellError> {
        let none = || CellError::new(x, "a point of the crack has no reference position");
        Ok(SurfacePoint {
            crack: integrator.cracks[index].number,
            cell: facet.cell,
            x,
            xi: integrator
                .mesh
                .map(facet.cell)
                .inverse(&x)
                .ok_or_else(none)?,
            weight: 0.0,
            regions: facet.regions,
            frame: facet.frame,
            shares: Vec::new(),
        })
    }

    /// Jump u₁ − u₂ in space [m], from all unknowns.
    pub fn jump(&self, integrator: &CellIntegrator<'_>, u: &[f64]) -> Point {
        let mut functions = integrator.functions(self.cell);
        functions.jump(&self.xi, &self.x, self.regions, u)
    }

    /// [[φ_f]] of the functions that jump here.
    pub fn jump_terms(&self, integrator: &CellIntegrator<'_>) -> Vec<(u32, f64)> {
        let mut functions = integrator.functions(self.cell);
        let [one, two] = self.regions.map(|region| {
            functions.evaluate(&self.xi, &self.x, region);
            functions.values.clone()
        });
        let numbers = functions.numbers.iter();
        let jumps = numbers.zip(one.iter().zip(&two));
        jumps
            .map(|(&f, (one, two))| (f, one - two))
            .filter(|(_, jump)| *jump != 0.0)
            .collect()
    }

    /// A vector in the local frame (n, a, b).
    pub fn local(&self, v: &Point) -> [f64; 3] {
        resolve(&self.frame, v)
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
        let mut functions = integrator.functions(cell);
        if shape.distance(x).abs() > 1e-6 * functions.map.diagonal() {
            return None;
        }
        // The piece of the crack in this cell that is nearest to the point.
        let faces = enrichment.partition(cell)?.faces.iter();
        let away = |face: &Face| norm(&sub(&face.middle(), x));
        let face = faces
            .filter(|face| face.crack == crack)
            .min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let xi = functions.map.inverse(x)?;
        Some(functions.jump(&xi, x, face.parts, u))
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
