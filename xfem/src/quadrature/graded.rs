//! Quadrature of simplices and cells near a crack front: graded towards it by repeated halving.
//!
//! A simplex no larger than its distance to the singular line carries a function that is analytic well beyond it, where
//! a Gauss rule converges geometrically. Simplices closer than that are halved. One that touches the line is halved to
//! the depth limit; what stays unresolved has the diameter d = 2^−depth of the first, and of ∫ r^α over it (a tube of
//! radius d around the line) the rule gets the leading digits only: error about d^(2+α) in 3D, d^(1+α) for a triangle
//! that ends at the line.

use crate::geometry::clip::{clip, halve_tetrahedron, halve_triangle};
use crate::geometry::polygon::{Polygon, border_distance, edges, segment_distance};
use crate::geometry::{Point, add_scaled, diameter, dot, mean, norm, sub};
use crate::mesh::cell::{CellKind, CellMap};

use super::slice::slice_points;
use super::{
    FanRule, WeightedPoint, gauss_cell, gauss_map, segment, tetrahedron, triangle_collapsed,
};

/// From so many of the longest edge of a piece on a tip is far.
pub const FAR: f64 = 4.0;

/// True if no point of the simplex is nearer to the singularity than the simplex is long.
fn is_far(vertices: &[Point], distance: &impl Fn(&Point) -> f64) -> bool {
    let centre = mean(vertices);
    let radius = vertices.iter().map(|x| norm(&sub(x, &centre)));
    distance(&centre) - radius.fold(0.0, f64::max) >= diameter(vertices)
}

/// The parts of some simplices, those that are not far halved up to `depth` times.
fn parts<S: Copy, const N: usize>(
    simplices: &[S],
    depth: usize,
    far: impl Fn(&S) -> bool,
    halve: fn(&S) -> [S; N],
) -> Vec<S> {
    /// Most parts of one simplex: flat ones would be halved on and on.
    const MOST: usize = 65_536;
    let mut stack: Vec<(S, usize)> = simplices.iter().map(|s| (*s, 0)).collect();
    let mut parts = Vec::new();
    while let Some((simplex, level)) = stack.pop() {
        let full = parts.len() + stack.len() > MOST * simplices.len();
        if level == depth || full || far(&simplex) {
            parts.push(simplex);
        } else {
            stack.extend(halve(&simplex).map(|part| (part, level + 1)));
        }
    }
    parts
}

/// Points of tetrahedra near a front; `distance` is that of a point to the front [m], exact or a lower bound.
///
/// The degree-5 rule on parts no longer than their distance: relative error below 1e-6 for r^−1 and r^−½ times
/// polynomials (of all rules tried the cheapest at that error). `depth`: most halvings.
pub fn graded_tetrahedra(
    tetrahedra: &[[Point; 4]],
    distance: impl Fn(&Point) -> f64,
    depth: usize,
) -> Vec<WeightedPoint> {
    let parts = parts(
        tetrahedra,
        depth,
        |t| is_far(t, &distance),
        halve_tetrahedron,
    );
    parts.iter().flat_map(tetrahedron).collect()
}

/// Points of a whole hex8 cell near a front; `distance` as for tetrahedra.
///
/// Boxes of the reference cell, halved until the front is no nearer than a quarter of their longest edge, with n points per
/// direction so that (1 + 2d + √((1 + 2d)² − 1))^−2n, d the distance in edges, is below 2e-5, and one point more for the ramp,
/// which raises the degree in every direction. `depth`: most halvings.
pub fn graded_cell(
    map: &CellMap,
    distance: impl Fn(&Point) -> f64,
    depth: usize,
) -> Vec<WeightedPoint> {
    let longest = map.longest_edge();
    let rules = [4, 5, 6, 7].map(|n| gauss_cell(map.kind, n));
    let mut stack = vec![([0.0; 3], 0)];
    let mut points = Vec::new();
    while let Some((centre, level)) = stack.pop() {
        let half = 0.5f64.powi(level as i32);
        let nearest = nearest_in_box(map, &centre, half, &distance).1 / (half * longest);
        if nearest < 0.25 && level < depth {
            for (corner, _) in gauss_cell(map.kind, 2) {
                let sign = corner.map(f64::signum);
                stack.push((add_scaled(&centre, 0.5 * half, &sign), level + 1));
            }
            continue;
        }
        let rule = match nearest {
            d if d >= 2.0 => &rules[0],
            d if d >= 1.0 => &rules[1],
            d if d >= 0.5 => &rules[2],
            _ => &rules[3],
        };
        points.extend(rule.iter().map(|(xi, weight)| {
            let xi = add_scaled(&centre, half, xi);
            let weight = weight * half.powi(3) * map.determinant(&xi);
            WeightedPoint::new(map.at(&xi), weight)
        }));
    }
    points
}

/// Which of 5 × 5 × 5 points of a box of the reference cell is nearest, and its distance [m]: at most a tenth of an edge too large where
/// it is a quarter of an edge, and below that wherever the front enters the box.
pub fn nearest_in_box(
    map: &CellMap,
    centre: &Point,
    half: f64,
    distance: impl Fn(&Point) -> f64,
) -> (Point, f64) {
    let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let mut nearest = (*centre, f64::INFINITY);
    for x in steps {
        for y in steps {
            for z in steps {
                let xi = add_scaled(centre, half, &[x, y, z]);
                let x = map.at(&xi);
                let d = distance(&x);
                if d < nearest.1 {
                    nearest = (x, d);
                }
            }
        }
    }
    nearest
}

/// Points of triangles near a tip or front; `distance` as for tetrahedra, n × n points on each part.
///
/// Relative error (3 + √8)^−2n for functions with a singularity at that distance; `depth`: most halvings.
pub fn graded_triangles(
    triangles: &[[Point; 3]],
    distance: impl Fn(&Point) -> f64,
    n: usize,
    depth: usize,
) -> Vec<WeightedPoint> {
    let parts = parts(triangles, depth, |t| is_far(t, &distance), halve_triangle);
    parts
        .iter()
        .flat_map(|t| triangle_collapsed(t, n))
        .collect()
}

/// Points of a segment near tips: n on every part no longer than twice its distance from the nearest; `depth`: most halvings.
pub fn graded_segment(
    p: &Point,
    q: &Point,
    tips: &[Point],
    n: usize,
    depth: usize,
) -> Vec<WeightedPoint> {
    let far = |[p, q]: &[Point; 2]| {
        let length = norm(&sub(q, p));
        let nearest = tips.iter().map(|tip| segment_distance(tip, p, q));
        nearest.fold(f64::INFINITY, f64::min) >= 0.5 * length
    };
    let halve = |[p, q]: &[Point; 2]| {
        let middle = mean([p, q]);
        [[*p, middle], [middle, *q]]
    };
    let parts = parts(&[[*p, *q]], depth, far, halve);
    parts.iter().flat_map(|[p, q]| segment(p, q, n)).collect()
}

/// Points of triangles and convex quadrilaterals near tips, in polar coordinates around every tip closer than the longest edge, on
/// what lies nearer to it than to another; n × n points where there is none, `far` × `far` where there is none at four times the
/// distance. A singularity at that distance leaves a relative error of (3 + √8)^−2n and (9 + √80)^−2far.
pub fn graded_points(
    pieces: &[Polygon],
    tips: &[Point],
    [n, far]: [usize; 2],
) -> Vec<WeightedPoint> {
    // Errors of 3e-12 where the tip lies at that distance (24: 3e-15).
    let rule = FanRule {
        radial: n.max(6),
        angular: 20,
    };
    let mut points = Vec::new();
    for piece in pieces {
        let lengths = edges(piece).map(|(p, q)| norm(&sub(&q, &p)));
        let longest = lengths.fold(0.0, f64::max);
        let within = |reach: f64| {
            tips.iter()
                .filter(move |tip| border_distance(piece, tip) < reach * longest)
        };
        let near: Vec<&Point> = within(1.0).collect();
        if near.is_empty() {
            let order = if within(FAR).next().is_none() { far } else { n };
            points.extend(smooth_points(piece, order));
        }
        for tip in &near {
            let mut own = piece.clone();
            for other in near.iter().filter(|other| *other != tip) {
                let (middle, apart) = (mean([*tip, *other]), sub(tip, other));
                let levels: Vec<f64> = own.iter().map(|x| dot(&apart, &sub(x, &middle))).collect();
                own = clip(&own, &levels, 1.0);
            }
            if own.len() > 2 {
                let up = [0.0, 0.0, 1.0];
                points.extend(slice_points(&own, &up, Some(**tip), longest, rule));
            }
        }
    }
    points
}

/// Points of a smooth function on a triangle or a convex quadrilateral, n × n.
fn smooth_points(piece: &[Point], n: usize) -> Vec<WeightedPoint> {
    if let Ok(triangle) = piece.try_into() {
        return triangle_collapsed(triangle, n);
    }
    let map = CellMap::new(CellKind::Quad4, |i| piece[i]);
    gauss_map(&map, n).map(|(_, p)| p).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::cell::CellKind;
    use crate::quadrature::check::{integral, inverse_distance};

    /// Distance from the z axis.
    fn axis(x: &Point) -> f64 {
        x[0].hypot(x[1])
    }

    /// Functions singular at the axis agree between a rule and a finer one.
    fn check(found: &[WeightedPoint], fine: &[WeightedPoint], tolerance: f64, gap: f64) {
        for f in [
            (|x: &Point| 1.0 / axis(x)) as fn(&Point) -> f64,
            |x| axis(x).powf(-0.5),
            |x| axis(x).powf(-0.5) * (1.0 + x[2] + x[0] * x[1]),
            |x| (1.0 + x[0].powi(2) * x[2]) / axis(x) * (x[1].atan2(x[0])).cos(),
        ] {
            let (a, b) = (integral(found, f), integral(fine, f));
            assert!((a - b).abs() < tolerance * b.abs(), "gap {gap}: {a} {b}");
        }
    }

    #[test]
    fn tetrahedra_and_whole_cells_beside_a_line_are_integrated_to_the_stated_error() {
        for gap in [2.0, 0.5, 0.1, 0.02] {
            let t = [
                [gap, 0.0, -0.5],
                [gap, 0.3, 0.6],
                [gap + 1.0, -0.2, 0.1],
                [gap + 0.3, 0.9, 0.0],
            ];
            // The same on parts of a quarter of the size: the error falls by 4⁻⁶.
            let fine = graded_tetrahedra(&halve_tetrahedron(&t), |x| 0.25 * axis(x), 20);
            check(&graded_tetrahedra(&[t], axis, 20), &fine, 1e-6, gap);
        }
        for gap in [2.0, 0.8, 0.4, 0.2, 0.1] {
            let map = CellMap::new(CellKind::Hex8, |i| {
                let [x, y, z] = CellKind::Hex8.corner(i);
                [gap + 0.5 + 0.5 * x, 0.1 + 0.5 * y, 0.5 * z + 0.1 * x]
            });
            let fine = graded_cell(&map, |x| 0.2 * axis(x), 20);
            check(&graded_cell(&map, axis, 20), &fine, 2e-5, gap);
        }
    }

    #[test]
    fn triangles_that_end_at_the_front_are_integrated_to_the_depth() {
        // Edge on the z axis: ∫ √x over the triangle (0, 0), (0, 1), (1, 0) is 2/3 − 2/5.
        let t = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
        for depth in [3, 6] {
            let points = graded_triangles(&[t], axis, 5, depth);
            let error = (integral(&points, |x| axis(x).sqrt()) - 4.0 / 15.0).abs();
            assert!(error < 0.05 * f64::powf(0.5, 1.5 * depth as f64), "{error}");
            assert!((integral(&points, |_| 1.0) - 0.5).abs() < 1e-13);
        }
    }

    #[test]
    fn graded_points_integrate_a_singularity_at_every_distance() {
        let square = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        for (count, distance) in [3, 4].into_iter().flat_map(|n| {
            let distances = [1e-6, 1e-3, 0.1, 0.5, 0.99, 1.01, 2.0, 3.99, 4.01];
            distances.map(|distance| (n, distance))
        }) {
            let (piece, tip) = (square[..count].to_vec(), [0.4, -distance, 0.0]);
            let exact = inverse_distance(&piece, &tip);
            let points = graded_points(&[piece], &[tip], [10, 6]);
            let error = integral(&points, |x| 1.0 / norm(&sub(x, &tip))) / exact - 1.0;
            assert!(error.abs() < 1e-11, "{count}, {distance}: {error:e}");
        }
    }
}
