//! The discrete field inside one cell, and the points at which it is compared with an exact one.
//!
//! The rules that integrate the stiffness are exact for the discrete functions only. An exact field with a crack tip near
//! varies faster: here every triangle or tetrahedron is halved until no tip is closer than its diameter, and a cell that
//! holds the tip itself is a fan with the tip as apex.

use crate::cut::is_split;
use crate::cut::partition::Partition;
use crate::cut::placement::reference_position;
use crate::enrichment::basis::{CellFunction, Region};
use crate::geometry::clip::Side;
use crate::geometry::polygon::{self, segment_distance};
use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, add_scaled, cross, norm, sub};
use crate::mesh::cell::CellKind;
use crate::quadrature::{WeightedPoint, gauss_cell, tip_triangle, triangle_collapsed};
use crate::stiffness::cell_matrix::{CellError, CellIntegrator, SidedPoint};
use crate::stiffness::near_front::{Effort, NearFront};

/// A point of comparison.
#[derive(Debug, Clone, Copy)]
pub struct ComparisonPoint {
    /// The point, with the region whose functions count there.
    pub point: SidedPoint,
    /// Side of the crack that cuts the cell, or ends in it; `None` elsewhere.
    pub side: Option<Side>,
}

/// The functions of one cell with room for their values.
pub struct CellField<'a> {
    integrator: &'a CellIntegrator<'a>,
    cell: usize,
    corners: [Point; 8],
    functions: Vec<CellFunction>,
    values: Vec<f64>,
    gradients: Vec<Point>,
}

impl<'a> CellField<'a> {
    /// Functions of a cell.
    pub fn new(integrator: &'a CellIntegrator<'a>, cell: usize) -> Self {
        let functions = integrator.enrichment.cell_basis(integrator.mesh, cell);
        CellField {
            integrator,
            cell,
            corners: integrator.mesh.corners(cell),
            values: vec![0.0; functions.len()],
            gradients: vec![[0.0; 3]; functions.len()],
            functions,
        }
    }

    fn evaluate(&mut self, xi: &Point, x: &Point, region: Region) {
        let kind = self.integrator.mesh.kind;
        self.integrator
            .basis(self.cell, &self.corners[..kind.nodes()], &self.functions)
            .evaluate(xi, x, region, &mut self.values, &mut self.gradients);
    }

    /// Displacement at ξ (position x) in a region, from all unknowns [m].
    pub fn displacement(&mut self, xi: &Point, x: &Point, region: Region, u: &[f64]) -> Point {
        self.at(xi, x, region, u).0
    }

    /// Displacement [m] and its gradient ∂u_a/∂x_b at ξ (position x) in a region, from all unknowns.
    pub fn at(&mut self, xi: &Point, x: &Point, region: Region, u: &[f64]) -> (Point, [Point; 3]) {
        self.evaluate(xi, x, region);
        let dim = self.integrator.mesh.dim();
        let (mut v, mut h) = ([0.0; 3], [[0.0; 3]; 3]);
        let functions = self.integrator.enrichment.cell(self.cell);
        for ((&f, value), g) in functions.iter().zip(&self.values).zip(&self.gradients) {
            for a in 0..dim {
                let amount = u[f as usize * dim + a];
                v[a] += value * amount;
                for b in 0..dim {
                    h[a][b] += amount * g[b];
                }
            }
        }
        (v, h)
    }
}

/// Quadrature points of a cell for the difference between the discrete and an exact field.
///
/// `fronts`: where the exact field is singular, whether the crack carries branch functions there or not. `n`: points per
/// direction, 4 for errors; doubling it shows what the rule leaves out. The weights sum to the cell's measure.
pub fn comparison_points(
    integrator: &CellIntegrator<'_>,
    cell: usize,
    fronts: &[TipFrame],
    n: usize,
) -> Result<Vec<ComparisonPoint>, CellError> {
    let mesh = integrator.mesh;
    let kind = mesh.kind;
    let corners = mesh.corners(cell);
    let corners = &corners[..kind.nodes()];
    let diameter = diameter(corners);
    let near = |x: &Point, size: f64| fronts.iter().any(|f| f.distance(x) < size);
    let partition = integrator.enrichment.partition(cell);
    // The centre is at most half a diameter from any point of the cell.
    if partition.is_none() && !near(&mesh.centre(cell), 2.0 * diameter) {
        return Ok(gauss_cell(kind.dim(), n)
            .into_iter()
            .map(|(xi, w)| ComparisonPoint {
                point: SidedPoint {
                    xi,
                    x: kind.map(corners, &xi),
                    weight: w * kind.gradients(corners, &xi).1,
                    region: 0,
                },
                side: None,
            })
            .collect());
    }
    // A crack without tip functions ends in a cell that it does not split; the exact field jumps there all the same.
    let ending = fronts.iter().map(|f| f.crack).find(|&index| {
        let crack = &integrator.cracks[index];
        partition.is_none()
            && is_split(kind, &crack.cell_phi(mesh, cell))
            && fronts.iter().any(|f| {
                let at = |x: &Point| reference_position(mesh, cell, x, 1e-9).is_some();
                f.crack == index
                    && (at(&f.position)
                        || f.shape_is_ellipse() && near(&mesh.centre(cell), diameter))
            })
    });
    let divided = match ending {
        Some(index) => Partition::new(mesh, cell, integrator.cracks, &[index]).ok(),
        None => None,
    };
    let whole = Partition::whole(kind, corners);
    let parts = &partition.or(divided.as_ref()).unwrap_or(&whole).parts;
    // The region of a part, and its side.
    let region = |number: usize| if partition.is_some() { number } else { 0 };
    let side = |number: usize| parts[number].sides.first().map(|s| s.1);
    let rule: Vec<(WeightedPoint, usize)> = match kind {
        CellKind::Quad4 => (parts.iter().enumerate())
            .flat_map(|(number, part)| {
                let points = flat_points(&part.polygon, fronts, n, kind.is_affine(corners));
                points.into_iter().map(move |p| (p, number))
            })
            .collect(),
        CellKind::Hex8 => {
            let effort = if n > 4 {
                Effort::REFERENCE
            } else {
                Effort::WORKING
            };
            let near = NearFront {
                corners,
                parts,
                fronts,
                chord: None,
            };
            near.points(
                |crack| integrator.cracks[crack].cell_phi(mesh, cell),
                effort,
            )
        }
    };
    let located = |(WeightedPoint { x, weight }, number)| {
        let xi = kind.inverse_map(corners, &x).ok_or_else(|| CellError {
            at: x,
            reason: "a point of a sub-cell has no reference position".into(),
        })?;
        let point = SidedPoint {
            xi,
            x,
            weight,
            region: region(number),
        };
        Ok(ComparisonPoint {
            point,
            side: side(number),
        })
    };
    rule.into_iter().map(located).collect()
}

/// Points of a polygon: a fan about the tip in its closure, or triangles halved towards the tips outside.
fn flat_points(
    polygon: &[Point],
    fronts: &[TipFrame],
    n: usize,
    affine: bool,
) -> Vec<WeightedPoint> {
    let triangles = polygon::triangles(polygon);
    let size = diameter(polygon);
    let inside = fronts.iter().find(|f| {
        triangles.iter().any(|t| {
            let area = |a: &Point, b: &Point, c: &Point| {
                0.5 * norm(&crate::geometry::cross(&sub(b, a), &sub(c, a)))
            };
            let whole = area(&t[0], &t[1], &t[2]);
            let sum: f64 = (0..3)
                .map(|i| area(&f.position, &t[i], &t[(i + 1) % 3]))
                .sum();
            sum <= whole + 1e-10 * size * size
        })
    });
    if let Some(tip) = inside {
        // Each outer edge in n/4 parts: doubling n doubles the angular points of the fan, too.
        let parts = n.div_ceil(4);
        let mut points = Vec::new();
        for i in 0..polygon.len() {
            let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let edge = sub(&b, &a);
            let divided = (0..=parts).map(|k| add_scaled(&a, k as f64 / parts as f64, &edge));
            let ends: Vec<Point> = divided.collect();
            for w in ends.windows(2) {
                // Negative where the outline of a bent part turns its back on the tip.
                let fan = cross(&sub(&w[0], &tip.position), &sub(&w[1], &tip.position));
                let sign = 1.0f64.copysign(fan[2]);
                let triangle = tip_triangle(&tip.position, &w[0], &w[1], affine && n <= 4);
                points.extend(triangle.into_iter().map(|p| WeightedPoint {
                    weight: sign * p.weight,
                    ..p
                }));
            }
        }
        return points;
    }
    /// Halvings; a tip 1e-9 edges away needs 30.
    const DEPTH: usize = 40;
    let mut stack: Vec<([Point; 3], usize)> = triangles.iter().map(|t| (*t, 0)).collect();
    let mut points = Vec::new();
    while let Some((t, depth)) = stack.pop() {
        let size = diameter(&t);
        let near = fronts
            .iter()
            .any(|f| (0..3).any(|i| segment_distance(&f.position, &t[i], &t[(i + 1) % 3]) < size));
        if !near || depth == DEPTH {
            points.extend(triangle_collapsed(&t, n));
            continue;
        }
        let mid = |i: usize, j: usize| add_scaled(&t[i], 0.5, &sub(&t[j], &t[i]));
        let (a, b, c) = (mid(0, 1), mid(1, 2), mid(2, 0));
        for part in [[t[0], a, c], [a, t[1], b], [c, b, t[2]], [a, b, c]] {
            stack.push((part, depth + 1));
        }
    }
    points
}

/// Largest distance of two points [m].
fn diameter(points: &[Point]) -> f64 {
    let mut largest: f64 = 0.0;
    for (i, p) in points.iter().enumerate() {
        for q in &points[..i] {
            largest = largest.max(norm(&sub(p, q)));
        }
    }
    largest
}
