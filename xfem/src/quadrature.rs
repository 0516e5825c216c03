//! Quadrature rules: Gauss on the line and on cells, triangles and tetrahedra in space, the crack-tip fan.

#[cfg(test)]
pub(crate) mod check;
pub mod front;
pub mod front_facet;
pub mod graded;
pub mod rational;
pub mod slice;

use std::sync::OnceLock;

use crate::geometry::clip::tetrahedron_volume;
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub};
use crate::mesh::cell::{CellKind, CellMap};

/// Quadrature of cut cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quadrature {
    /// Sub-cells on both sides of the crack: exact for the cut integrand on affine cells.
    SubCells,
    /// `gauss-N`: N points per direction on the whole cut cell, sides told apart point by point. Inexact; only to
    /// reproduce published numbers, and marked so in every report.
    Gauss(usize),
}

/// A quadrature point in space with its weight [m^dim].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedPoint {
    /// Position [m].
    pub x: Point,
    /// Weight: length, area or volume.
    pub weight: f64,
}

impl WeightedPoint {
    /// A point with its weight.
    pub fn new(x: Point, weight: f64) -> Self {
        WeightedPoint { x, weight }
    }
}

/// Gauss–Legendre points and weights on [−1, 1], exact to degree 2n − 1.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    /// Rules asked for again and again are found once.
    const KEPT: usize = 64;
    static RULES: [OnceLock<Vec<(f64, f64)>>; KEPT] = [const { OnceLock::new() }; KEPT];
    match RULES.get(n) {
        Some(rule) => rule.get_or_init(|| gauss_rule(n)).clone(),
        None => gauss_rule(n),
    }
}

/// The same by Newton's method on P_n.
fn gauss_rule(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            // Chebyshev-like start; Newton converges quadratically from it for every n.
            let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                // P_{k+1} = ((2k + 1) x P_k − k P_{k−1}) / (k + 1)
                let (mut previous, mut p) = (1.0, x);
                for k in 1..n {
                    let k = k as f64;
                    (previous, p) = (p, ((2.0 * k + 1.0) * x * p - k * previous) / (k + 1.0));
                }
                slope = n as f64 * (x * p - previous) / (x * x - 1.0);
                let step = p / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Gauss points of the reference cell with their weights, n per direction.
pub fn gauss_cell(kind: CellKind, n: usize) -> Vec<(Point, f64)> {
    let line = gauss(n);
    let across = match kind {
        CellKind::Quad4 => vec![(0.0, 1.0)],
        CellKind::Hex8 => line.clone(),
    };
    let mut points = Vec::with_capacity(across.len() * n * n);
    for &(z, wz) in &across {
        for &(y, wy) in &line {
            for &(x, wx) in &line {
                points.push(([x, y, z], wx * wy * wz));
            }
        }
    }
    points
}

/// Gauss points of a cell, n per direction: reference position, and position with weight.
pub fn gauss_map(map: &CellMap, n: usize) -> impl Iterator<Item = (Point, WeightedPoint)> + '_ {
    gauss_cell(map.kind, n).into_iter().map(|(xi, w)| {
        (
            xi,
            WeightedPoint::new(map.at(&xi), w * map.determinant(&xi)),
        )
    })
}

/// Length, area or volume of a cell, exact for the maps of all kinds.
pub fn measure(map: &CellMap) -> f64 {
    gauss_map(map, 2).map(|(_, p)| p.weight).sum()
}

/// Gauss points on the segment a b.
pub fn segment(a: &Point, b: &Point, n: usize) -> Vec<WeightedPoint> {
    let d = sub(b, a);
    let half = 0.5 * norm(&d);
    gauss(n)
        .into_iter()
        .map(|(s, w)| WeightedPoint::new(add_scaled(a, 0.5 * (1.0 + s), &d), w * half))
        .collect()
}

/// Six points, degree 4, positive (Dunavant 1985): (barycentric pair value, weight) of two orbits.
const TRIANGLE_4: [(f64, f64); 2] = [
    (0.445_948_490_915_965, 0.223_381_589_678_011),
    (0.091_576_213_509_771, 0.109_951_743_655_322),
];

/// Degree-4 rule on the triangle a b c in space (2D or 3D).
pub fn triangle(t: &[Point; 3]) -> Vec<WeightedPoint> {
    let area = 0.5 * norm(&cross(&sub(&t[1], &t[0]), &sub(&t[2], &t[0])));
    let mut points = Vec::with_capacity(6);
    for (a, w) in TRIANGLE_4 {
        for apex in 0..3 {
            let mut x = [0.0; 3];
            for (i, vertex) in t.iter().enumerate() {
                x = add_scaled(&x, if i == apex { 1.0 - 2.0 * a } else { a }, vertex);
            }
            points.push(WeightedPoint::new(x, w * area));
        }
    }
    points
}

/// Collapsed Gauss rule on a triangle, n × n points, exact to degree 2n − 2; for smooth functions beyond polynomials.
pub fn triangle_collapsed(t: &[Point; 3], n: usize) -> Vec<WeightedPoint> {
    let area2 = norm(&cross(&sub(&t[1], &t[0]), &sub(&t[2], &t[0])));
    let line = gauss(n);
    let mut points = Vec::with_capacity(n * n);
    for &(r, wr) in &line {
        let r = 0.5 * (1.0 + r);
        for &(s, ws) in &line {
            let s = 0.5 * (1.0 + s);
            // x = t0 + r ((t1 − t0) + s (t2 − t1)), dA = 2|t| r dr ds
            let x = add_scaled(&t[0], r, &sub(&t[1], &t[0]));
            let x = add_scaled(&x, r * s, &sub(&t[2], &t[1]));
            points.push(WeightedPoint::new(x, area2 * r * 0.25 * wr * ws));
        }
    }
    points
}

/// Fourteen points, degree 5, positive (Walkington 2000).
pub fn tetrahedron(t: &[Point; 4]) -> Vec<WeightedPoint> {
    const CORNER: [(f64, f64); 2] = [
        (0.310_885_919_263_300_6, 0.112_687_925_718_015_85),
        (0.092_735_250_310_891_23, 0.073_493_043_116_361_95),
    ];
    const EDGE: (f64, f64) = (0.045_503_704_125_649_65, 0.042_546_020_777_081_47);
    let volume = tetrahedron_volume(t);
    let mut points = Vec::with_capacity(14);
    let mut push = |barycentric: [f64; 4], w: f64| {
        let mut x = [0.0; 3];
        for (b, vertex) in barycentric.iter().zip(t) {
            x = add_scaled(&x, *b, vertex);
        }
        points.push(WeightedPoint::new(x, w * volume));
    };
    for (a, w) in CORNER {
        for i in 0..4 {
            let mut b = [a; 4];
            b[i] = 1.0 - 3.0 * a;
            push(b, w);
        }
    }
    for i in 0..4 {
        for j in i + 1..4 {
            let mut b = [EDGE.0; 4];
            b[i] = 0.5 - EDGE.0;
            b[j] = 0.5 - EDGE.0;
            push(b, EDGE.1);
        }
    }
    points
}

/// Points of a crack-tip fan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FanRule {
    /// Points in ρ = √r; five are exact on affine cells.
    pub radial: usize,
    /// Points in angle on every interval of the sinh map's variable that is no longer than [`FanRule::INTERVAL`].
    pub angular: usize,
}

impl FanRule {
    /// The angular factor has its poles at ±i π/2 of the sinh map's variable m: n points on an interval of this length err by
    /// 2.66^−2n, 14 by 1e-12, wherever the tip lies.
    pub const INTERVAL: f64 = 2.75;

    /// Errors of 1e-12, of functions with a polynomial factor that is no ramp if `affine`.
    pub const fn fine(affine: bool) -> Self {
        FanRule {
            radial: if affine { 5 } else { 10 },
            angular: 14,
        }
    }
}

/// Crack-tip rule on the triangle (tip, a, b): x = tip + ρ² (y − tip) with y on the edge a b, placed by the sinh map.
///
/// ```text
///   dA = t h dt ds,   t = ρ², s = h sinh m       (h: distance from the tip to the line a b, s: from the foot along it)
/// ```
///
/// ρ² removes the half powers of r from the integrand (r dr = 2 ρ³ dρ makes entries in r⁻¹, r^−½ polynomial), the sinh
/// map follows the nearly singular angular factor (Johnston and Elliott 2005). Five radial points are exact on affine
/// cells. Degenerate triangles return no points.
pub fn fan_triangle(tip: &Point, a: &Point, b: &Point, rule: FanRule) -> Vec<WeightedPoint> {
    let edge = sub(b, a);
    let length = norm(&edge);
    let along = [edge[0] / length, edge[1] / length, edge[2] / length];
    let (s0, s1) = (dot(&sub(a, tip), &along), dot(&sub(b, tip), &along));
    let foot = add_scaled(a, -s0, &along);
    let h = norm(&sub(&foot, tip));
    if !h.is_finite() || h <= 1e-12 * length {
        return Vec::new();
    }
    let (m0, m1) = ((s0 / h).asinh(), (s1 / h).asinh());
    let intervals = ((m1 - m0).abs() / FanRule::INTERVAL).ceil().max(1.0);
    let half = 0.5 * (m1 - m0) / intervals;
    let (radial, angular) = (gauss(rule.radial), gauss(rule.angular));
    let mut points = Vec::with_capacity(intervals as usize * radial.len() * angular.len());
    for interval in 0..intervals as usize {
        let centre = m0 + (2 * interval + 1) as f64 * half;
        for &(m, wm) in &angular {
            let m = centre + half * m;
            let y = add_scaled(&foot, h * m.sinh(), &along);
            let ds = half * wm * h * m.cosh();
            for &(rho, wr) in &radial {
                let rho = 0.5 * (1.0 + rho);
                let t = rho * rho;
                let weight = t * h * ds * rho * wr; // dt = 2 ρ dρ, dρ = wr/2
                let x = add_scaled(tip, t, &sub(&y, tip));
                points.push(WeightedPoint::new(x, weight));
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::check::{integral, inverse_distance};
    use super::*;
    use crate::geometry::polygon::edges;

    #[test]
    fn gauss_is_exact_to_degree_2n_minus_1() {
        for n in 1..=40 {
            for degree in [0, 1, 2 * n - 2, 2 * n - 1] {
                let found: f64 = gauss(n)
                    .iter()
                    .map(|(x, w)| w * x.powi(degree as i32))
                    .sum();
                let exact = if degree % 2 == 0 {
                    2.0 / (degree as f64 + 1.0)
                } else {
                    0.0
                };
                let error = (found - exact).abs();
                assert!(error < 1e-14, "n = {n}, degree {degree}: {found} {exact}");
            }
        }
    }

    /// ∫ x^i y^j z^k over the unit simplex of dimension d: i! j! k! / (i + j + k + d)!
    fn simplex_moment(i: u32, j: u32, k: u32, dim: u32) -> f64 {
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + dim)
    }

    #[test]
    fn simplex_rules_are_exact_to_their_degree() {
        let t = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let flat = [t[0], t[1], t[2]];
        for (points, dim, degree) in [
            (triangle(&flat), 2, 4),
            (triangle_collapsed(&flat, 5), 2, 8),
            (tetrahedron(&t), 3, 5),
        ] {
            let powers = (0..=degree).flat_map(|i| (0..=degree).map(move |j| [i, j]));
            let powers = powers.flat_map(|[i, j]| (0..=degree).map(move |k| [i, j, k]));
            for [i, j, k] in powers.filter(|p| p.iter().sum::<u32>() <= degree) {
                if dim == 2 && k > 0 {
                    continue;
                }
                let f = |x: &Point| x[0].powi(i as i32) * x[1].powi(j as i32) * x[2].powi(k as i32);
                assert!((integral(&points, f) - simplex_moment(i, j, k, dim)).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn tip_fan_integrates_the_singular_powers_of_r() {
        let square: [Point; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]: [f64; 2]| [x, y, 0.0]);
        let hair = |d: f64| [0.3, 1.0 - d, 0.0];
        let places = [
            [0.0, 0.0, 0.0],
            [0.35, -0.6, 0.0],
            hair(1e-3),
            hair(1e-6),
            hair(1e-9),
        ];
        for tip in places {
            let triangles =
                edges(&square).map(|(a, b)| fan_triangle(&tip, &a, &b, FanRule::fine(true)));
            let fan: Vec<WeightedPoint> = triangles.flatten().collect();
            assert!((integral(&fan, |_| 1.0) - 4.0).abs() < 1e-10);
            let found = integral(&fan, |x| 1.0 / norm(&sub(x, &tip)));
            assert!((found - inverse_distance(&square, &tip)).abs() < 1e-9);
        }
    }
}
