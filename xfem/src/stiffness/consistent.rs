//! Gradients that satisfy the divergence theorem on every cell, whatever the rule.
//!
//! ```text
//!   Σ_q w_q ∇φ_f  =  b_f  =  ∮_cell φ_f n ds − ∫_Γ [[φ_f]] n dΓ        for every function f of the cell
//!
//!   ∇φ_f ← ∇φ_f + (b_f − Σ_q w_q ∇φ_f) / V_f     on the part of the cell, of measure V_f, where f lives
//! ```
//!
//! Border integrals cancel between neighbours, for both take the same points; those over the crack are the rows of the jump
//! operator. So a uniform stress is in equilibrium with its tractions to rounding, on any cell: branch functions, arcs and
//! distorted cells cost as many points as their energy needs, no more. Variationally consistent integration: Chen, Hillman &
//! Rüter, Int. J. Numer. Meth. Engng 95 (2013) 387.

use std::collections::BTreeSet;

use crate::enrichment::cell_facets::pieces;
use crate::enrichment::cell_functions::CellFunctions;
use crate::enrichment::facet_rule::facet_points;
use crate::enrichment::facets::CrackFacets;
use crate::geometry::clip::fan;
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub, unit};
use crate::quadrature::{WeightedPoint, segment, triangle, triangle_collapsed};

use super::cell_matrix::{CellError, CellIntegrator, SidedPoint};

/// A quadrature point with the values and gradients of all functions of its cell.
pub struct EvaluatedPoint {
    /// The point.
    pub at: SidedPoint,
    /// Gradients [1/m].
    pub gradients: Vec<Point>,
}

/// Points on an edge of a cell with branch functions; the same as loads on it take.
pub const BRANCH_EDGE: usize = 24;

/// Points per direction on the triangles of a face of a cell with branch functions.
const BRANCH_FACE: usize = 6;

impl CellIntegrator<'_> {
    /// Points of a cell with the gradients of its functions, which satisfy the divergence theorem.
    ///
    /// # Errors
    /// A cell that cannot be integrated.
    pub fn evaluated(&self, cell: usize) -> Result<Vec<EvaluatedPoint>, CellError> {
        let mut functions = self.functions(cell);
        let mut points: Vec<EvaluatedPoint> = self
            .points(cell)?
            .into_iter()
            .map(|at| {
                functions.evaluate(&at.xi, &at.x, at.region);
                EvaluatedPoint {
                    at,
                    gradients: functions.gradients.clone(),
                }
            })
            .collect();
        if self.is_corrected(cell, &functions) {
            let flux = self.flux(cell, &mut functions)?;
            correct(&functions, &flux, &mut points);
        }
        Ok(points)
    }

    /// Whether the rule of a cell leaves something to correct.
    fn is_corrected(&self, cell: usize, functions: &CellFunctions<'_>) -> bool {
        use crate::quadrature::Quadrature;
        self.quadrature == Quadrature::SubCells
            && !self.enrichment.is_plain(self.mesh, cell)
            && (self.enrichment.has_branch(cell) || !functions.map.is_affine())
    }

    /// b_f of all functions of a cell.
    fn flux(&self, cell: usize, functions: &mut CellFunctions<'_>) -> Result<Vec<Point>, CellError> {
        let mesh = self.mesh;
        let mut flux = vec![[0.0; 3]; functions.numbers.len()];
        let lost = |x: &Point| CellError::new(*x, "a point of a cell has no reference position");
        for local in mesh.kind.facets() {
            let normal = outward(&functions.map, local);
            for (p, region) in self.border_points(cell, local) {
                let xi = functions.map.inverse(&p.x).ok_or_else(|| lost(&p.x))?;
                functions.evaluate(&xi, &p.x, region);
                for (sum, value) in flux.iter_mut().zip(&functions.values) {
                    *sum = add_scaled(sum, p.weight * value, &normal);
                }
            }
        }
        let faces = self.enrichment.partition(cell).map_or(&[][..], |p| p.faces.as_slice());
        let cracks: BTreeSet<usize> = faces.iter().map(|face| face.crack).collect();
        for index in cracks {
            let crack = &self.cracks[index];
            let facets = CrackFacets::of_cell(mesh, cell, index, crack, self.enrichment);
            for facet in &facets.facets {
                for p in facet_points(mesh, crack, self.enrichment, &facets, facet) {
                    let xi = functions.map.inverse(&p.x).ok_or_else(|| lost(&p.x))?;
                    for (region, sign) in facet.regions.into_iter().zip([-1.0, 1.0]) {
                        functions.evaluate(&xi, &p.x, region);
                        for (sum, value) in flux.iter_mut().zip(&functions.values) {
                            *sum = add_scaled(sum, sign * p.weight * value, &facet.frame[0]);
                        }
                    }
                }
            }
        }
        Ok(flux)
    }

    /// Points on an edge (2D) or face of a cell with their regions: the same from both cells beside it.
    fn border_points(&self, cell: usize, local: &[usize]) -> Vec<(WeightedPoint, usize)> {
        let mesh = self.mesh;
        let nodes = mesh.cell(cell);
        let branch = self.enrichment.has_branch(cell);
        // From the lowest node towards its lower neighbour.
        let count = local.len();
        let first = (0..count).min_by_key(|&i| nodes[local[i]]).unwrap_or(0);
        let at = |i: usize| local[i % count];
        let forward = nodes[at(first + 1)] < nodes[at(first + count - 1)] || count == 2;
        let order: Vec<usize> = (0..count)
            .map(|k| if forward { at(first + k) } else { at(first + count - k) })
            .collect();
        let pieces = pieces(mesh, self.cracks, self.enrichment, cell, &order);
        let mut points = Vec::new();
        if mesh.dim() == 2 {
            // A continuation that ends on the edge is none of the neighbour's concern.
            let partition = self.enrichment.partition(cell);
            let is_hit = |x: &Point| partition.is_some_and(|p| p.hits.contains(x));
            let n = if branch { BRANCH_EDGE } else { 2 };
            let mut rest = pieces.as_slice();
            while let Some((piece, _)) = rest.first() {
                let from = piece[0];
                let parts = 1 + rest.iter().take_while(|(piece, _)| is_hit(&piece[1])).count();
                let (own, others) = rest.split_at(parts.min(rest.len()));
                let to = own[own.len() - 1].0[1];
                for p in segment(&from, &to, n) {
                    let away = norm(&sub(&p.x, &from));
                    let region = own.iter().find(|(piece, _)| away <= norm(&sub(&piece[1], &from)));
                    points.push((p, region.unwrap_or(&own[own.len() - 1]).1));
                }
                rest = others;
            }
            return points;
        }
        for (polygon, region) in pieces {
            for t in fan(&polygon) {
                let rule = match branch {
                    true => triangle_collapsed(&t, BRANCH_FACE),
                    false => triangle(&t),
                };
                points.extend(rule.into_iter().map(|p| (p, region)));
            }
        }
        points
    }
}

/// Outward unit normal of a facet of a cell.
fn outward(map: &crate::mesh::cell::CellMap, local: &[usize]) -> Point {
    if let &[i, j] = local {
        let d = unit(&sub(&map[j], &map[i]));
        return [d[1], -d[0], 0.0];
    }
    let diagonals = [[2, 0], [3, 1]].map(|[i, j]: [usize; 2]| sub(&map[local[i]], &map[local[j]]));
    let normal = unit(&cross(&diagonals[0], &diagonals[1]));
    // Whatever the order of its corners.
    let sign = dot(&normal, &sub(&map[local[0]], &map.centre())).signum();
    normal.map(|v| sign * v)
}

/// Adds what the gradients lack, evenly over the regions where each function lives.
fn correct(functions: &CellFunctions<'_>, flux: &[Point], points: &mut [EvaluatedPoint]) {
    let lives: Vec<Vec<bool>> = (0..=points.iter().map(|p| p.at.region).max().unwrap_or(0))
        .map(|region| functions.lives(region))
        .collect();
    for (f, flux) in flux.iter().enumerate() {
        let own = |p: &&mut EvaluatedPoint| lives[p.at.region][f];
        let (mut missing, mut measure) = (*flux, 0.0);
        for p in points.iter_mut().filter(own) {
            missing = add_scaled(&missing, -p.at.weight, &p.gradients[f]);
            measure += p.at.weight;
        }
        if measure > 0.0 {
            for p in points.iter_mut().filter(own) {
                p.gradients[f] = add_scaled(&p.gradients[f], 1.0 / measure, &missing);
            }
        }
    }
}
