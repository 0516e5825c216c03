//! The discrete field inside one cell, and the points at which it is compared with an exact one.
//!
//! The rules that integrate the stiffness are exact for the discrete functions only. An exact field with a crack tip near
//! varies faster: here every triangle or tetrahedron is halved until no tip is closer than its diameter, and a cell that
//! holds the tip itself is a fan with the tip as apex.

use crate::fem::cell::CellKind;
use crate::fem::elasticity::Lame;
use crate::fem::quadrature::{
    WeightedPoint, gauss_cell, tetrahedron, tip_triangle, triangle_collapsed,
};
use crate::fem::{Point, add_scaled, dot, norm, sub};

use super::basis::CellFunction;
use super::cell_matrix::{CellError, CellIntegrator, SidedPoint};
use super::cut::{self, Side, SubCells};
use super::enrichment::reference_position;

/// A crack front: a tip in 2D (both ends equal), a straight piece of the front in 3D [m].
pub type Front = [Point; 2];

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

    fn evaluate(&mut self, xi: &Point, x: &Point, side: Side) {
        self.integrator
            .basis(self.cell, &self.corners, &self.functions)
            .evaluate(xi, x, side, &mut self.values, &mut self.gradients);
    }

    /// Displacement at ξ (position x) on a side, from all unknowns [m].
    pub fn displacement(&mut self, xi: &Point, x: &Point, side: Side, u: &[f64]) -> Point {
        self.at(xi, x, side, u).0
    }

    /// Displacement [m] and its gradient ∂u_a/∂x_b at ξ (position x) on a side, from all unknowns.
    pub fn at(&mut self, xi: &Point, x: &Point, side: Side, u: &[f64]) -> (Point, [Point; 3]) {
        self.evaluate(xi, x, side);
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
    fronts: &[Front],
    n: usize,
) -> Result<Vec<SidedPoint>, CellError> {
    let mesh = integrator.mesh;
    let kind = mesh.kind;
    let corners = mesh.corners(cell);
    let corners = &corners[..kind.nodes()];
    let diameter = diameter(corners);
    let near = |x: &Point, size: f64| fronts.iter().any(|f| segment_distance(x, f) < size);
    let split = integrator.enrichment.split[cell].map(|c| &integrator.cracks[c as usize]);
    // The centre is at most half a diameter from any point of the cell.
    if split.is_none() && !near(&mesh.centre(cell), 2.0 * diameter) {
        return Ok(gauss_cell(kind.dim(), n)
            .into_iter()
            .map(|(xi, w)| SidedPoint {
                xi,
                x: kind.map(corners, &xi),
                weight: w * kind.gradients(corners, &xi).1,
                side: 1.0,
            })
            .collect());
    }
    // A crack without tip functions ends in a cell that it does not split; the exact field jumps there all the same.
    let crack = split.or_else(|| {
        integrator.cracks.iter().find(|crack| {
            cut::is_split(kind, &crack.cell_phi(mesh, cell))
                && fronts.iter().any(|f| {
                    crack.distance(&f[0]).abs() <= 1e-9 * diameter
                        && reference_position(mesh, cell, &f[0], 1e-9).is_some()
                })
        })
    });
    let phi = crack.map_or([1.0; 8], |crack| crack.cell_phi(mesh, cell));
    let mut points = Vec::new();
    for side in [1.0, -1.0] {
        let part = match kind {
            CellKind::Quad4 => {
                let polygon = cut::polygon_part(corners, &phi[..4], side);
                flat_points(&polygon, fronts, n, kind.is_affine(corners))
            }
            CellKind::Hex8 => SubCells::of(kind, corners, &phi, side)
                .tetrahedra
                .iter()
                .flat_map(|t| solid_points(t, fronts, n))
                .collect(),
        };
        for WeightedPoint { x, weight } in part {
            let Some(xi) = kind.inverse_map(corners, &x) else {
                return Err(CellError {
                    at: x,
                    reason: "a point of a sub-cell has no reference position".into(),
                });
            };
            points.push(SidedPoint {
                xi,
                x,
                weight,
                side,
            });
        }
    }
    Ok(points)
}

/// Points of a convex polygon: a fan about the tip in its closure, or triangles halved towards the tips outside.
fn flat_points(polygon: &[Point], fronts: &[Front], n: usize, affine: bool) -> Vec<WeightedPoint> {
    let triangles = cut::fan(polygon);
    let size = diameter(polygon);
    let inside = fronts.iter().find(|f| {
        triangles.iter().any(|t| {
            let area = |a: &Point, b: &Point, c: &Point| {
                0.5 * norm(&crate::fem::cross(&sub(b, a), &sub(c, a)))
            };
            let whole = area(&t[0], &t[1], &t[2]);
            let sum: f64 = (0..3).map(|i| area(&f[0], &t[i], &t[(i + 1) % 3])).sum();
            sum <= whole + 1e-10 * size * size
        })
    });
    if let Some(tip) = inside {
        // Each outer edge in n/4 parts: doubling n doubles the angular points of the fan, too.
        let parts = n.div_ceil(4);
        return (0..polygon.len())
            .flat_map(|i| {
                let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                let edge = sub(&b, &a);
                (0..parts).flat_map(move |k| {
                    let [p, q] = [k, k + 1].map(|k| add_scaled(&a, k as f64 / parts as f64, &edge));
                    tip_triangle(&tip[0], &p, &q, affine && n <= 4)
                })
            })
            .collect();
    }
    /// Halvings; a tip 1e-9 edges away needs 30.
    const DEPTH: usize = 40;
    let mut stack: Vec<([Point; 3], usize)> = triangles.iter().map(|t| (*t, 0)).collect();
    let mut points = Vec::new();
    while let Some((t, depth)) = stack.pop() {
        let size = diameter(&t);
        let near = fronts
            .iter()
            .any(|f| (0..3).any(|i| segment_distance(&f[0], &[t[i], t[(i + 1) % 3]]) < size));
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

/// Points of a tetrahedron, halved towards the fronts; more than 4 points per direction asked for: halved once more.
///
/// Three halvings leave an eighth of the neighbourhood of a front unresolved, where the rule still finds most of the energy.
fn solid_points(t: &[Point; 4], fronts: &[Front], n: usize) -> Vec<WeightedPoint> {
    let depth = if n > 4 { 4 } else { 3 };
    let mut stack = vec![(*t, 0)];
    let mut points = Vec::new();
    while let Some((t, level)) = stack.pop() {
        let mut centre = [0.0; 3];
        for x in &t {
            centre = add_scaled(&centre, 0.25, x);
        }
        let size = diameter(&t);
        let near = fronts.iter().any(|f| segment_distance(&centre, f) < size);
        if (near && level < depth) || (n > 4 && level == 0) {
            stack.extend(
                cut::halve_tetrahedron(&t)
                    .into_iter()
                    .map(|t| (t, level + 1)),
            );
        } else {
            points.extend(tetrahedron(&t));
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

/// Distance of a point from a segment whose ends may coincide [m].
pub fn segment_distance(x: &Point, [p, q]: &[Point; 2]) -> f64 {
    let d = sub(q, p);
    let length2 = dot(&d, &d);
    let t = if length2 > 0.0 {
        (dot(&sub(x, p), &d) / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    norm(&sub(x, &add_scaled(p, t, &d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::body::{Body, Needs};
    use crate::harness::case;

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
            let ends = crack.ends().map(|(x, _)| x);
            let fronts = ends.map(|x| [x, x]);
            for (n, tolerance) in [(4, 1e-6), (8, 1e-9)] {
                let (mut area, mut found) = (0.0, [0.0; 2]);
                for cell in 0..body.mesh.cell_count() {
                    for p in comparison_points(&integrator, cell, &fronts, n).unwrap() {
                        area += p.weight;
                        for (sum, end) in found.iter_mut().zip(&ends) {
                            *sum += p.weight / norm(&sub(&p.x, end));
                        }
                        if body.enrichment.split[cell].is_some() {
                            assert!(crack.distance(&p.x) * p.side > -1e-12);
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
        let front = [[3.2, 2.8, 0.0], [3.2, 2.8, 2.0]];
        let exact = 2.0 * inverse_distance(&front[0]);
        let error = |n: usize| {
            let found: f64 = (0..body.mesh.cell_count())
                .flat_map(|cell| comparison_points(&integrator, cell, &[front], n).unwrap())
                .map(|p| p.weight / segment_distance(&p.x, &front))
                .sum();
            (found / exact - 1.0).abs()
        };
        let [coarse, fine] = [error(4), error(8)];
        println!("1/r about a front: {coarse:.1e}, {fine:.1e}");
        assert!(coarse < 2e-3 && fine < 1e-3, "{coarse:e} {fine:e}");
    }
}
