//! The discrete field inside one cell, and the points at which it is compared with an exact one.
//!
//! The rules that integrate the stiffness are exact for the discrete functions only. An exact field with a crack tip near
//! varies faster: here every triangle or tetrahedron is halved until no tip is closer than its diameter, and a cell that
//! holds the tip itself is a fan with the tip as apex.

use crate::fem::cell::CellKind;
use crate::fem::elasticity::Lame;
use crate::fem::quadrature::{WeightedPoint, gauss_cell, tip_triangle, triangle_collapsed};
use crate::fem::{Point, add_scaled, cross, dot, norm, sub};

use super::basis::{CellFunction, Region, TipFrame};
use super::cell_matrix::{CellError, CellIntegrator, SidedPoint};
use super::cut::{self, Side};
use super::near_front::{Effort, NearFront};
use super::partition::Partition;
use super::placement::reference_position;
use super::polygon::{self, segment_distance};

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

/// σ = λ tr ε I + 2 μ ε from the displacement gradient [Pa]; 2D: the in-plane part.
pub fn stress(lame: Lame, dim: usize, h: &[Point; 3]) -> [Point; 3] {
    let trace: f64 = (0..dim).map(|a| h[a][a]).sum();
    let mut s = [[0.0; 3]; 3];
    for a in 0..dim {
        for b in 0..dim {
            s[a][b] = lame.mu * (h[a][b] + h[b][a]);
        }
        s[a][a] += lame.lambda * trace;
    }
    s
}

/// ε = (σ − λ/(d λ + 2 μ) tr σ I) / (2 μ), d the dimension; in 2D the out-of-plane stress of plane strain and the effective
/// λ of plane stress are in it.
pub fn strain(lame: Lame, dim: usize, s: &[Point; 3]) -> [Point; 3] {
    let trace: f64 = (0..dim).map(|a| s[a][a]).sum();
    let part = lame.lambda / (dim as f64 * lame.lambda + 2.0 * lame.mu) * trace;
    let mut e = [[0.0; 3]; 3];
    for a in 0..dim {
        for b in 0..dim {
            e[a][b] = s[a][b] / (2.0 * lame.mu);
        }
        e[a][a] -= part / (2.0 * lame.mu);
    }
    e
}

/// a : b
pub fn double_dot(a: &[Point; 3], b: &[Point; 3]) -> f64 {
    (0..3).map(|k| dot(&a[k], &b[k])).sum()
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
            && cut::is_split(kind, &crack.cell_phi(mesh, cell))
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
                0.5 * norm(&crate::fem::cross(&sub(b, a), &sub(c, a)))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::body::{Body, Needs};
    use crate::harness::case;
    use crate::xfem::basis::FrontShape;

    fn body(model: &str, mesh: &str, rest: &str) -> Body {
        let text = format!(
            "title = \"t\"\nmodel = \"{model}\"\nmaterial = {{ young_pa = 1, poisson = 0.3 }}\nmesh = {{ box = {mesh} }}\n{rest}"
        );
        let case = case::parse("t.toml", text.as_str()).unwrap();
        Body::new(&case, 1, Needs::default()).unwrap()
    }

    fn square(tip: &str) -> Body {
        body(
            "plane-strain",
            "{ min_m = [0, 0], max_m = [6, 6], cells = [6, 6] }",
            &format!(
                "[[crack]]\npoints_m = [[1.2, 2.1], [4.3, 3.7]]\nfriction = 0.3\ntip = \"{tip}\"\n\
                 [[support]]\non = \"bottom\"\ndisplacement_m = [0, 0]\n"
            ),
        )
    }

    /// ∫ 1/r over a triangle fan about a point: Σ h (asinh(s1/h) − asinh(s0/h)) over the edges of the square [0, 6]².
    fn inverse_distance(tip: &Point) -> f64 {
        let c: [Point; 4] = [[0.0; 3], [6.0, 0.0, 0.0], [6.0, 6.0, 0.0], [0.0, 6.0, 0.0]];
        (0..4)
            .map(|i| {
                let (a, b) = (c[i], c[(i + 1) % 4]);
                let along = crate::fem::unit(&sub(&b, &a));
                let (s0, s1) = (dot(&sub(&a, tip), &along), dot(&sub(&b, tip), &along));
                let h = norm(&sub(&add_scaled(&a, -s0, &along), tip));
                h * ((s1 / h).asinh() - (s0 / h).asinh())
            })
            .sum()
    }

    /// Source: ∫ 1/r dA of a square in closed form; strain energy near a tip is of this kind. Goal: the rule fills the body and
    /// finds the integral to 1e-6 with 4 points per direction, 1e-10 with 8, for cracks with and without tip functions; every
    /// point of a split cell lies on its side.
    #[test]
    fn the_rule_fills_the_body_and_resolves_both_tips() {
        for tip in ["branch", "none"] {
            let body = square(tip);
            let integrator = body.integrator();
            let crack = &body.cracks[0];
            let fronts = crate::harness::errors::fronts(&body);
            let ends: Vec<Point> = fronts.iter().map(|f| f.position).collect();
            for (n, tolerance) in [(4, 1e-6), (8, 1e-9)] {
                let (mut area, mut found) = (0.0, [0.0; 2]);
                for cell in 0..body.mesh.cell_count() {
                    for p in comparison_points(&integrator, cell, &fronts, n).unwrap() {
                        let ComparisonPoint { point: p, side } = p;
                        area += p.weight;
                        for (sum, end) in found.iter_mut().zip(&ends) {
                            *sum += p.weight / norm(&sub(&p.x, end));
                        }
                        if let Some(side) = side {
                            assert!(crack.distance(&p.x) * side > -1e-12);
                        }
                    }
                }
                assert!((area / 36.0 - 1.0).abs() < tolerance, "{tip} {n}: {area}");
                for (sum, end) in found.iter().zip(&ends) {
                    let error = (sum / inverse_distance(end) - 1.0).abs();
                    println!("{tip} n = {n}: {error:.1e}");
                    assert!(error < tolerance, "{tip} {n}: {error:e}");
                }
            }
        }
    }

    /// Source: ∫ 1/ρ dV of a block about its axis is its height times the integral over the square. Goal: the halved
    /// tetrahedra find it to 2e-3, with one more halving to 1e-3. What is left comes from the tetrahedra that the front runs
    /// through, with signs that depend on how it does, so it need not fall by half each time.
    #[test]
    fn halved_tetrahedra_resolve_a_front() {
        let body = body(
            "solid",
            "{ min_m = [0, 0, 0], max_m = [6, 6, 2], cells = [3, 3, 1] }",
            "[[crack]]\nplane = { point_m = [0, 2.8, 0], normal = [0, 1, 0] }\nfriction = 0.3\n\
             [[support]]\non = \"bottom\"\ndisplacement_m = [0, 0, 0]\n",
        );
        let integrator = body.integrator();
        // The line x = 3.2, y = 2.8.
        let front = TipFrame {
            crack: 0,
            position: [3.2, 2.8, 0.0],
            ahead: [1.0, 0.0, 0.0],
            normal: [0.0, 1.0, 0.0],
            shape: FrontShape::Straight,
        };
        let exact = 2.0 * inverse_distance(&front.position);
        let error = |n: usize| {
            let found: f64 = (0..body.mesh.cell_count())
                .flat_map(|cell| {
                    let fronts = std::slice::from_ref(&front);
                    comparison_points(&integrator, cell, fronts, n).unwrap()
                })
                .map(|p| p.point.weight / front.distance(&p.point.x))
                .sum();
            (found / exact - 1.0).abs()
        };
        let [coarse, fine] = [error(4), error(8)];
        println!("1/r about a front: {coarse:.1e}, {fine:.1e}");
        assert!(coarse < 2e-3 && fine < 1e-3, "{coarse:e} {fine:e}");
    }
}
