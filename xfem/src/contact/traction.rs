//! Traction operator S: the contact force that the stress in the cells implies at each contact point.
//!
//! ```text
//!   S u = τ = −w {σ(u)} n      force on side 1 in the local frame (n, a[, b]), τ_n > 0 in compression
//!
//!            Σ V_c^s σ_c^s(x)
//!   {σ}  =  ——————————————————     over the parts (cell c, side s) of the body whose closure contains x
//!              Σ V_c^s
//! ```
//!
//! Weights by volume V between the sides of a cut cell: Annavarapu, Hautefeuille & Dolbow, Comput. Meth. Appl. Mech. Engng
//! 225-228 (2012) 44. A sliver has a large stress for a small energy; with its volume as weight it cannot spoil the trace
//! inequality |{σ} n|² w <= C u·K u on which Nitsche's method rests. The same rule averages the cells along the crack.

use std::collections::BTreeSet;
use std::collections::btree_map::{BTreeMap, Entry};

use rayon::prelude::*;

use crate::cut::crack::ON_CRACK;
use crate::cut::part::Place;
use crate::cut::placement::reference_position;
use crate::geometry::{Point, dot};
use crate::quadrature;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};
use crate::stiffness::stress::CellStress;

use super::pairs::ContactPoint;
use super::surface_point::{Side, SurfacePoint};

/// A cell touches a point within this, in units of its diagonal: above rounding, below the shortest distance of a crossed
/// edge's point from a node that the crack does not run through.
const TOUCHES: f64 = 0.1 * ON_CRACK;

/// A part of the body at a contact point: a whole cell, or one side of a cut cell.
struct Part {
    side: Side,
    /// Volume [m³] or area [m²].
    measure: f64,
}

/// Rows of S over all unknowns, point by point (n, a[, b]), as (unknown, coefficient): N/m, in 2D N/m².
pub fn traction_rows(
    integrator: &CellIntegrator<'_>,
    points: &[ContactPoint],
) -> Result<Vec<Vec<(usize, f64)>>, CellError> {
    let users = integrator.enrichment.users();
    let rows: Vec<Vec<Vec<(usize, f64)>>> = points
        .par_iter()
        .map(|point| point_rows(integrator, point, &parts(integrator, &users, point)?))
        .collect::<Result<_, _>>()?;
    Ok(rows.concat())
}

/// Rows of S for an integrated space: S_k u = −∫ φ_k F {σ(u)} n dΓ.
pub fn integrated_rows(
    integrator: &CellIntegrator<'_>,
    count: usize,
    quadrature: &[SurfacePoint],
) -> Result<Vec<Vec<(usize, f64)>>, CellError> {
    let dim = integrator.mesh.dim();
    let mut measures: BTreeMap<Place, f64> = BTreeMap::new();
    let mut known: BTreeMap<usize, CellStress<'_>> = BTreeMap::new();
    let mut rows = vec![BTreeMap::new(); count * dim];
    for q in quadrature {
        let [m1, m2] = q.places().map(|side| {
            let known = measures.entry(side);
            *known.or_insert_with(|| measure(integrator, side))
        });
        for (side, share) in q.sides.iter().zip([m1 / (m1 + m2), m2 / (m1 + m2)]) {
            let stress = match known.entry(side.cell) {
                Entry::Occupied(own) => own.into_mut(),
                Entry::Vacant(place) => place.insert(integrator.stress(side.cell)?),
            };
            for &(k, value) in &q.shares {
                let own = &mut rows[k as usize * dim..(k as usize + 1) * dim];
                let factor = -q.weight * value * share;
                add_stress(stress, side, &q.x, &q.frame, factor, own);
            }
        }
    }
    Ok(rows
        .into_iter()
        .map(|row| row.into_iter().collect())
        .collect())
}

/// The parts at a point. All of them touch the nodes of the functions that jump there.
fn parts(
    integrator: &CellIntegrator<'_>,
    users: &[Vec<u32>],
    point: &ContactPoint,
) -> Result<Vec<Part>, CellError> {
    let CellIntegrator {
        mesh,
        cracks,
        enrichment,
        ..
    } = integrator;
    let nodes = point.terms.iter().map(|&(f, _)| {
        let function = enrichment.functions[f as usize];
        function.node as usize
    });
    let cells: BTreeSet<u32> = nodes.flat_map(|n| users[n].iter().copied()).collect();
    let mut parts = Vec::new();
    for cell in cells.into_iter().map(|c| c as usize) {
        let Some(xi) = reference_position(mesh, cell, &point.x, TOUCHES) else {
            continue;
        };
        for region in 0..enrichment.regions(cell) {
            // A region touches the point unless another crack keeps them apart.
            let apart = enrichment.partition(cell).is_some_and(|p| {
                let sides = &p.parts[region].sides;
                sides.iter().any(|&(c, side)| {
                    cracks[c].number != point.crack && cracks[c].distance(&point.x) * side < 0.0
                })
            });
            if !apart {
                parts.push(Part {
                    side: Side { cell, xi, region },
                    measure: measure(integrator, (cell, region)),
                });
            }
        }
    }
    if parts.is_empty() {
        return Err(CellError::new(point.x, "a contact point lies in no cell"));
    }
    Ok(parts)
}

/// Measure of a whole cell, or of one region of a cut one.
fn measure(integrator: &CellIntegrator<'_>, (cell, region): Place) -> f64 {
    match integrator.enrichment.partition(cell) {
        Some(partition) => {
            let points = partition.parts[region].points();
            points.iter().map(|p| p.weight).sum()
        }
        None => quadrature::measure(&integrator.mesh.map(cell)),
    }
}

/// Rows (n, a[, b]) of one point.
fn point_rows(
    integrator: &CellIntegrator<'_>,
    point: &ContactPoint,
    parts: &[Part],
) -> Result<Vec<Vec<(usize, f64)>>, CellError> {
    let total: f64 = parts.iter().map(|p| p.measure).sum();
    let mut rows = vec![BTreeMap::<usize, f64>::new(); integrator.mesh.dim()];
    for part in parts.iter().filter(|p| p.measure > 0.0) {
        let factor = -point.weight * part.measure / total;
        let mut stress = integrator.stress(part.side.cell)?;
        let (x, frame) = (&point.x, &point.frame);
        add_stress(&mut stress, &part.side, x, frame, factor, &mut rows);
    }
    Ok(rows
        .into_iter()
        .map(|row| row.into_iter().collect())
        .collect())
}

/// rows += factor · F σ n at x.
fn add_stress(
    stress: &mut CellStress<'_>,
    side: &Side,
    x: &Point,
    frame: &[Point; 3],
    factor: f64,
    rows: &mut [BTreeMap<usize, f64>],
) {
    for (unknown, t) in stress.tractions(&side.xi, x, side.region, &frame[0]) {
        for (row, e) in rows.iter_mut().zip(frame) {
            let value = dot(e, &t);
            if value != 0.0 {
                *row.entry(unknown).or_default() += factor * value;
            }
        }
    }
}
