//! Quadrature of functions of the reference position on straight lines and triangles inside distorted quads.
//!
//! A straight line is curved in the reference cell, and shape functions are not polynomial along it. The number of points
//! follows from where they stop being smooth. Measured on patch tests of uniform stress with grid points moved by up to
//! 25 % (largest traction error over angles and distances of the crack; n: points per direction on every triangle):
//!
//! ```text
//!   n = 5    8      12     16     20     this rule
//!   5e-4     5e-5   3e-6   2e-7   1e-8   below 1e-10
//! ```

use crate::geometry::clip::halve_triangle;
use crate::geometry::{Point, add_scaled, sub};
use crate::mesh::cell::CellMap;

use super::{WeightedPoint, triangle_collapsed};

/// Gauss points for functions of the reference position on the segment p q in a distorted quad.
///
/// ```text
///   ξ(x) = (linear + √D)/constant, det J = √D, D quadratic in x (the quadratic formula for a bilinear map)
///   Gauss's rule on [−1, 1] converges like r^−2n,  r + 1/r = |z − 1| + |z + 1|,  z the root of D nearest by r
/// ```
///
/// The rate is Bernstein's (Trefethen, SIAM Review 50 (2008) 67, theorem 4.5).
pub fn rational_order(map: &CellMap, [p, q]: [&Point; 2]) -> usize {
    const ERROR: f64 = 1e-14;
    /// Points that cells close to parallelograms need.
    const LEAST: usize = 5;
    /// A fold on the segment itself: no rule converges, and no mesh with convex cells has one.
    const MOST: usize = 200;
    let discriminant = |t: f64| {
        let x = add_scaled(p, 0.5 * (1.0 + t), &sub(q, p));
        map.inverse(&x)
            .map_or(0.0, |xi| map.determinant(&xi).powi(2))
    };
    let [low, middle, high] = [-1.0, 0.0, 1.0].map(discriminant);
    // D = a t² + b t + c; in 1/z the roots stay finite when a vanishes.
    let (a, b, c) = (0.5 * (low + high) - middle, 0.5 * (high - low), middle);
    let square = b * b - 4.0 * a * c;
    let root = square.abs().sqrt();
    let reach = |[re, im]: [f64; 2]| {
        // w = 1/z, |z ∓ 1| = |1 ∓ w|/|w|
        let half = 0.5 * ((1.0 - re).hypot(im) + (1.0 + re).hypot(im)) / re.hypot(im);
        half + (half * half - 1.0).max(0.0).sqrt()
    };
    let inverse = |v: f64| v / (2.0 * c);
    let rate = if square >= 0.0 {
        reach([inverse(-b + root), 0.0]).min(reach([inverse(-b - root), 0.0]))
    } else {
        reach([inverse(-b), inverse(root)])
    };
    let points = (-ERROR.ln() / (2.0 * rate.ln())).ceil();
    // NaN, or a rate of 1: a fold.
    if points >= 0.0 {
        (points as usize).clamp(LEAST, MOST)
    } else {
        MOST
    }
}

/// Points for functions of the reference position on a triangle in a distorted quad: the triangle is quartered until the
/// rule of [`rational_order`] along its edges and medians is affordable.
pub fn rational_points(map: &CellMap, t: &[Point; 3], points: &mut Vec<WeightedPoint>) {
    quartered(map, t, 0, points);
}

fn quartered(map: &CellMap, t: &[Point; 3], depth: usize, points: &mut Vec<WeightedPoint>) {
    /// Above this four smaller triangles cost less.
    const AFFORDABLE: usize = 16;
    /// Quarterings: what a fold next to the cell asks beyond them, the correction of the gradients gives.
    const DEPTH: usize = 3;
    let quarters = halve_triangle(t);
    let [ab, bc, ca] = quarters[3];
    let lines = [
        [&t[0], &t[1]],
        [&t[1], &t[2]],
        [&t[2], &t[0]],
        [&t[0], &bc],
        [&t[1], &ca],
        [&t[2], &ab],
    ];
    let order = lines
        .into_iter()
        .map(|line| rational_order(map, line))
        .fold(0, usize::max);
    if order <= AFFORDABLE || depth == DEPTH {
        points.extend(triangle_collapsed(t, order.min(AFFORDABLE)));
        return;
    }
    for part in &quarters {
        quartered(map, part, depth + 1, points);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::clip::{clip, fan};
    use crate::mesh::cell::CellKind;
    use crate::quadrature::gauss_map;

    /// The gradients of the shape functions are rational in space; over the whole cell their integrals are polynomial.
    #[test]
    fn rational_functions_of_distorted_cells_are_integrated_to_rounding() {
        // Corners moved by up to 25 %; the last cell is nearly a triangle.
        let cells = [
            [[0.1, -0.2], [1.2, 0.1], [0.8, 0.9], [-0.2, 1.1]],
            [[0.2, 0.2], [0.8, -0.2], [1.1, 1.2], [-0.2, 0.8]],
            [[0.25, 0.2], [0.9, -0.25], [1.2, 1.2], [-0.25, 0.9]],
        ];
        for cell in cells {
            let map = CellMap::new(CellKind::Quad4, |i| [cell[i][0], cell[i][1], 0.0]);
            let gradient = |xi: &Point| map.gradients(xi).0[0][0];
            let points = gauss_map(&map, 2);
            let exact: f64 = points.map(|(xi, p)| p.weight * gradient(&xi)).sum();
            let phi: Vec<f64> = map.iter().map(|x| x[1] - 0.3 * x[0] - 0.21).collect();
            let found: f64 = [1.0, -1.0]
                .iter()
                .flat_map(|&side| {
                    let mut points = Vec::new();
                    for t in fan(&clip(&map, &phi, side)) {
                        rational_points(&map, &t, &mut points);
                    }
                    points
                })
                .map(|p| p.weight * gradient(&map.inverse(&p.x).unwrap()))
                .sum();
            assert!((found - exact).abs() < 1e-13, "{cell:?}: {found} {exact}");
        }
    }

    #[test]
    fn affine_cells_take_the_fewest_points_and_distorted_ones_more_towards_their_fold() {
        let kind = CellKind::Quad4;
        let square = CellMap::new(kind, |i| kind.corner(i));
        let order = |map: &CellMap, p: [f64; 2], q: [f64; 2]| {
            rational_order(map, [&[p[0], p[1], 0.0], &[q[0], q[1], 0.0]])
        };
        assert_eq!(order(&square, [-0.5, -0.2], [0.7, 0.6]), 5);
        // det J falls from (−1, −1) to the third corner, which is pulled in.
        let third = [0.1, 0.1, 0.0];
        let pulled = CellMap::new(kind, |i| if i == 2 { third } else { kind.corner(i) });
        let (far, near) = (
            order(&pulled, [-0.9, -0.9], [-0.5, -0.5]),
            order(&pulled, [-0.5, -0.5], [0.09, 0.09]),
        );
        assert!(5 < far && far < near && near < 60, "{far} {near}");
    }
}
