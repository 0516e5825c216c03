//! Quadrature points of the crack surface: where they lie, what jumps there, how far the faces overlap.

use std::collections::BTreeMap;

use crate::cut::part::{Face, Place, Region};
use crate::cut::placement::cells_at;
use crate::enrichment::cell_functions::CellFunctions;
use crate::enrichment::facets::Facet;
use crate::geometry::{Point, norm, resolve, sub};
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

/// A point of the crack surface as one of its sides has it.
#[derive(Debug, Clone, Copy)]
pub struct Side {
    /// Cell.
    pub cell: usize,
    /// Reference position in the cell.
    pub xi: Point,
    /// Region of the cell.
    pub region: Region,
}

/// A quadrature point of the crack surface.
#[derive(Debug, Clone)]
pub struct SurfacePoint {
    /// Crack number, from 0, in the case file.
    pub crack: usize,
    /// Position [m].
    pub x: Point,
    /// Share of the crack surface: length [m] or area [m²].
    pub weight: f64,
    /// The same point on side 1 and side 2.
    pub sides: [Side; 2],
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
    /// A point without a reference position in its cells.
    pub fn on_facet(
        integrator: &CellIntegrator<'_>,
        index: usize,
        facet: &Facet,
        x: Point,
    ) -> Result<Self, CellError> {
        let none = || CellError::new(x, "a point of the crack has no reference position");
        Ok(SurfacePoint {
            crack: integrator.cracks[index].number,
            sides: sides(integrator, facet.sides, &x).ok_or_else(none)?,
            x,
            weight: 0.0,
            frame: facet.frame,
            shares: Vec::new(),
        })
    }

    /// Jump u₁ − u₂ in space [m], from all unknowns.
    pub fn jump(&self, integrator: &CellIntegrator<'_>, u: &[f64]) -> Point {
        jump(integrator, &self.sides, &self.x, u)
    }

    /// Places on side 1 and side 2.
    pub fn places(&self) -> [Place; 2] {
        self.sides.map(|side| (side.cell, side.region))
    }

    /// [[φ_f]] of the functions that jump here.
    pub fn jump_terms(&self, integrator: &CellIntegrator<'_>) -> Vec<(u32, f64)> {
        let [one, two] = on_both(integrator, &self.sides, |functions, side| {
            functions.evaluate(&side.xi, &self.x, side.region);
            let values = functions.values.iter().copied();
            functions.numbers.iter().copied().zip(values).collect()
        });
        let mut jumps: BTreeMap<u32, f64> = one;
        for (f, value) in two {
            *jumps.entry(f).or_default() -= value;
        }
        // In one cell what does not jump cancels to the bit, in two to rounding.
        let ([one, two], enrichment) = (self.places(), integrator.enrichment);
        let across = |f: u32| enrichment.step_across([one, two], f as usize);
        jumps.retain(|&f, jump| *jump != 0.0 && (one.0 == two.0 || across(f).is_some()));
        jumps.into_iter().collect()
    }

    /// A vector in the local frame (n, a, b).
    pub fn local(&self, v: &Point) -> [f64; 3] {
        resolve(&self.frame, v)
    }
}

/// The sides of a point between two places; `None` without a reference position.
fn sides(integrator: &CellIntegrator<'_>, places: [Place; 2], x: &Point) -> Option<[Side; 2]> {
    let side = |(cell, region)| {
        let xi = integrator.mesh.map(cell).inverse(x)?;
        Some(Side { cell, xi, region })
    };
    Some([side(places[0])?, side(places[1])?])
}

/// A value of side 1 and of side 2, each by the functions of its cell.
fn on_both<T>(
    integrator: &CellIntegrator<'_>,
    [one, two]: &[Side; 2],
    mut of: impl FnMut(&mut CellFunctions<'_>, &Side) -> T,
) -> [T; 2] {
    let mut functions = integrator.functions(one.cell);
    let first = of(&mut functions, one);
    if two.cell != one.cell {
        functions = integrator.functions(two.cell);
    }
    [first, of(&mut functions, two)]
}

/// Jump u₁ − u₂ in space [m] at a point.
fn jump(integrator: &CellIntegrator<'_>, sides: &[Side; 2], x: &Point, u: &[f64]) -> Point {
    let [one, two] = on_both(integrator, sides, |functions, side| {
        functions.field(&side.xi, x, side.region, u).0
    });
    sub(&one, &two)
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
        if shape.distance(x).abs() > 1e-6 * mesh.map(cell).diagonal() {
            return None;
        }
        // The piece of the crack in this cell that is nearest to the point.
        let faces = enrichment.partition(cell)?.faces.iter();
        let away = |face: &Face| norm(&sub(&face.middle(), x));
        let face = faces
            .filter(|face| face.crack == crack)
            .min_by(|a, b| away(a).total_cmp(&away(b)))?;
        Some(jump(integrator, &sides(integrator, face.sides, x)?, x, u))
    })
}

/// Deepest overlap of the two faces, max(0, −gap), and largest slip over sample points [m]; only position, sides and frame of a
/// sample count. Between contact points nothing keeps the faces apart, and a mean over one is less than the largest slip there, so
/// the samples should lie much closer than those, ten per facet.
pub fn extremes<'a>(
    integrator: &CellIntegrator<'_>,
    samples: impl IntoIterator<Item = &'a SurfacePoint>,
    u: &[f64],
) -> [f64; 2] {
    let jumps = samples.into_iter().map(|sample| {
        let [gap, a, b] = sample.local(&sample.jump(integrator, u));
        [-gap, a.hypot(b)]
    });
    jumps.fold([0.0; 2], |most, jump| [0, 1].map(|i| most[i].max(jump[i])))
}
