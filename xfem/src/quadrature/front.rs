//! Quadrature of a cell and of a crack facet that hold a piece of the crack front.
//!
//! ```text
//!   ∫ f dV = ∫ ds ∫_S(s) f dA      s: abscissa along the chord A B of the front in the cell
//!   S(s):  slice of the cell's part by the plane at s perpendicular to the chord, a convex polygon
//! ```
//!
//! In a slice the front is one point, and the rules of [`super::slice`] remove the half powers of the distance from it.
//! A curved front is followed: with r⁻¹ at the front, a rule around the chord is several per cent off in a cell half as
//! large as the radius. Along the chord the integrand is smooth between the abscissae of the part's vertices. Where the
//! front leaves the cell through a face, the slice's integral behaves like h ln h in the distance h of the face: the
//! abscissa is stretched there by τ².

use crate::geometry::clip::{Side, clip, crossing};
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub, unit};
use crate::mesh::cell::CellMap;

use super::slice::slice_points;
use super::{FanRule, WeightedPoint, gauss};

/// A piece of crack front inside a cell.
#[derive(Debug, Clone, Copy)]
pub struct FrontPiece<F> {
    /// Where the front enters the cell and where it leaves it, two different points of the crack plane [m].
    pub chord: [Point; 2],
    /// Unit normal of the crack plane.
    pub normal: Point,
    /// The front's point in the plane through a point of the chord's line and perpendicular to it; `None` if that plane
    /// misses the front. For a straight front the argument itself.
    pub at: F,
}

/// How finely a front cell is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrontRule {
    /// Gauss points along the chord between two vertices. 5: relative error 1e-6 for r^−1 and r^−½ times polynomials,
    /// 5e-6 where the front cuts off a corner; 3: 1e-4; a straight front perpendicular to two faces needs 2 or 3.
    pub along: usize,
    /// Points in the slices.
    pub fan: FanRule,
}

/// Points along the chord, n between neighbouring `breaks` (abscissae of vertices) and `ends` of the chord.
///
/// Towards an end s = end ± length τ² with more points, unless the part ends there in a face: a slice's integral is then
/// smooth.
pub(super) fn abscissae(mut breaks: Vec<f64>, ends: [f64; 2], n: usize) -> Vec<(f64, f64)> {
    /// Points more on stretched intervals.
    const MORE: usize = 3;
    breaks.sort_by(f64::total_cmp);
    let (first, last) = (breaks[0], breaks[breaks.len() - 1]);
    let small = 1e-12 * (last - first);
    let near = |s: f64, t: f64| (s - t).abs() <= small;
    let is_face = |s: f64| {
        (near(s, first) || near(s, last)) && breaks.iter().filter(|&&t| near(s, t)).count() > 2
    };
    let singular: Vec<f64> = ends.into_iter().filter(|&s| !is_face(s)).collect();
    breaks.extend(ends.iter().filter(|&&s| s > first && s < last));
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|next, kept| near(*next, *kept));
    let is_singular = |s: f64| singular.iter().any(|&t| near(s, t));
    let mut points = Vec::new();
    let mut push = |from: f64, to: f64, stretched: bool| {
        // s = from + (to − from) τ^q, τ in [0, 1]
        let (q, n) = if stretched { (2, n + MORE) } else { (1, n) };
        for (t, w) in gauss(n) {
            let t = 0.5 * (1.0 + t);
            let slope = f64::from(q) * t.powi(q - 1);
            points.push((
                from + (to - from) * t.powi(q),
                (to - from).abs() * slope * 0.5 * w,
            ));
        }
    };
    for pair in breaks.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        match (is_singular(from), is_singular(to)) {
            (true, true) => {
                let middle = 0.5 * (from + to);
                push(from, middle, true);
                push(to, middle, true);
            }
            (false, true) => push(to, from, true),
            (start, false) => push(from, to, start),
        }
    }
    points
}

/// A point and the unit outward normal of every face of a 3D cell with planar faces.
fn walls(map: &CellMap) -> Vec<(Point, Point)> {
    let wall = |f: &&[usize]| {
        let diagonals = [[2, 0], [3, 1]].map(|[i, j]: [usize; 2]| sub(&map[f[i]], &map[f[j]]));
        (map[f[0]], unit(&cross(&diagonals[0], &diagonals[1])))
    };
    map.kind.facets().iter().map(wall).collect()
}

/// Points of the part of a 3D cell with planar faces on one side of the crack plane; `phi`: signed distances of the
/// corners to it [m]. Empty if the part is.
pub fn front_cell_points<F: Fn(&Point) -> Option<Point>>(
    map: &CellMap,
    phi: &[f64],
    side: Side,
    piece: &FrontPiece<F>,
    rule: FrontRule,
) -> Vec<WeightedPoint> {
    if !phi.iter().any(|f| f * side > 0.0) {
        return Vec::new();
    }
    // Vertices of the part.
    let inside = (0..map.len()).filter(|&i| phi[i] * side >= 0.0);
    let mut vertices: Vec<Point> = inside.map(|i| map[i]).collect();
    for &[i, j] in map.kind.edges() {
        if phi[i] * phi[j] < 0.0 {
            vertices.push(crossing(&map[i], phi[i], &map[j], phi[j]));
        }
    }
    let crack = (piece.chord[0], piece.normal.map(|n| -side * n));
    front_part_points(map, &[crack], &vertices, piece, rule)
}

/// Points of the part of a 3D cell with planar faces inside further walls, each a point of it and its outward normal;
/// `vertices`: those of the part [m].
pub fn front_part_points<F: Fn(&Point) -> Option<Point>>(
    map: &CellMap,
    cracks: &[(Point, Point)],
    vertices: &[Point],
    piece: &FrontPiece<F>,
    rule: FrontRule,
) -> Vec<WeightedPoint> {
    let [a, b] = piece.chord;
    let along = unit(&sub(&b, &a));
    let ahead = cross(&piece.normal, &along);
    // Half spaces n · (x − p) <= 0 of the part: the faces and the cracks.
    let mut walls = walls(map);
    walls.extend(cracks);
    let from_front = map.iter().map(|x| norm(&sub(x, &a)));
    let size = from_front.fold(0.0, f64::max);

    let abscissa = |x: &Point| dot(&sub(x, &a), &along);
    let breaks: Vec<f64> = vertices.iter().map(abscissa).collect();
    let mut points = Vec::new();
    for (s, ds) in abscissae(breaks, [0.0, norm(&sub(&b, &a))], rule.along) {
        let on_chord = add_scaled(&a, s, &along);
        // A square that holds the cell, cut by every wall.
        let corner = |p: f64, q: f64| {
            let x = add_scaled(&on_chord, 2.0 * size * p, &ahead);
            add_scaled(&x, 2.0 * size * q, &piece.normal)
        };
        let mut slice = vec![
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ];
        for (p, n) in &walls {
            let levels: Vec<f64> = slice.iter().map(|x| -dot(n, &sub(x, p))).collect();
            slice = clip(&slice, &levels, 1.0);
        }
        let slice = tidy(slice, 1e-13 * size);
        if slice.len() < 3 {
            continue;
        }
        let in_slice = slice_points(&slice, &along, (piece.at)(&on_chord), size, rule.fan);
        points.extend(
            in_slice
                .into_iter()
                .map(|p| WeightedPoint::new(p.x, p.weight * ds)),
        );
    }
    points
}

/// A polygon without repeated vertices.
fn tidy(polygon: Vec<Point>, small: f64) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::with_capacity(polygon.len());
    for x in polygon {
        if kept.last().is_none_or(|y| norm(&sub(&x, y)) > small) {
            kept.push(x);
        }
    }
    while kept.len() > 1 && norm(&sub(&kept[0], &kept[kept.len() - 1])) <= small {
        kept.pop();
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::clip::{clip_tetrahedron, fan, tetrahedron_volume};
    use crate::geometry::ellipse::Ellipse;
    use crate::mesh::cell::CellKind;
    use crate::quadrature::graded::graded_triangles;

    fn cell(shear: f64) -> CellMap {
        CellMap::new(CellKind::Hex8, |i| {
            let [x, y, z] = CellKind::Hex8.corner(i);
            [x + shear * y, 1.2 * y - 0.3 * shear * z, z + shear * x]
        })
    }

    /// Where the line x + t d enters and leaves the cell.
    fn chord(map: &CellMap, x: &Point, d: &Point) -> [Point; 2] {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (p, n) in walls(map) {
            let (gap, rate) = (dot(&n, &sub(x, &p)), dot(&n, d));
            if rate > 0.0 {
                high = high.min(-gap / rate);
            } else if rate < 0.0 {
                low = low.max(-gap / rate);
            }
        }
        [add_scaled(x, low, d), add_scaled(x, high, d)]
    }

    /// ∮ over the part's surface of r^α z^k (p·e)^m times the distance of the face's plane from the line, by
    /// div(x⊥ h) = (2 + α + m) h for h homogeneous of degree α + m in x⊥: only integrals over faces, by the 2D rules.
    fn by_faces(
        map: &CellMap,
        phi: &[f64],
        side: f64,
        [a, z, n]: [&Point; 3],
        (alpha, m, k): (f64, i32, i32),
    ) -> f64 {
        let e = unit(&add_scaled(&cross(n, z), 0.4, n));
        let h = |x: &Point| {
            let d = sub(x, a);
            let s = dot(&d, z);
            let p = add_scaled(&d, -s, z);
            (norm(&p).powf(alpha) * s.powi(k) * dot(&p, &e).powi(m), p)
        };
        let facets = map.kind.facets().iter().zip(walls(map));
        let mut faces: Vec<(Vec<Point>, Point)> = facets
            .map(|(f, (_, normal))| {
                let polygon: Vec<Point> = f.iter().map(|&i| map[i]).collect();
                let levels: Vec<f64> = f.iter().map(|&i| phi[i]).collect();
                (clip(&polygon, &levels, side), normal)
            })
            .collect();
        // The crack's facet: x⊥ · n = 0 there, nothing to add.
        faces.retain(|(part, _)| part.len() > 2);
        let mut sum = 0.0;
        for (part, normal) in faces {
            let rate = dot(z, &normal);
            let pierce = (rate.abs() > 1e-9)
                .then(|| add_scaled(a, dot(&sub(&part[0], a), &normal) / rate, z));
            let size = part
                .iter()
                .map(|x| norm(&sub(x, &part[0])))
                .fold(0.0, f64::max);
            let distance = |x: &Point| {
                let d = sub(x, a);
                norm(&add_scaled(&d, -dot(&d, z), z))
            };
            let rule = FanRule {
                radial: 10,
                angular: 40,
            };
            let points = match pierce {
                Some(t) => slice_points(&part, &normal, Some(t), size, rule),
                None => graded_triangles(&fan(&part), distance, 9, 30),
            };
            for p in points {
                let (value, perpendicular) = h(&p.x);
                sum += p.weight * value * dot(&perpendicular, &normal);
            }
        }
        sum / (2.0 + alpha + f64::from(m))
    }

    /// Largest error of the part's volume and of singular integrals over it.
    fn check(map: &CellMap, x: &Point, along: &Point, normal: &Point, along_points: usize) -> f64 {
        let share = -dot(normal, along) / dot(along, along);
        let normal = unit(&add_scaled(normal, share, along));
        let z = unit(along);
        let chord = chord(map, x, &z);
        let phi: Vec<f64> = map.iter().map(|y| dot(&normal, &sub(y, x))).collect();
        let piece = FrontPiece {
            chord,
            normal,
            at: |x: &Point| Some(*x),
        };
        let mut worst: f64 = 0.0;
        for side in [1.0, -1.0] {
            let rule = FrontRule {
                along: along_points,
                fan: FanRule::fine(true),
            };
            let points = front_cell_points(map, &phi, side, &piece, rule);
            let mut parts = Vec::new();
            for t in map.kind.tetrahedra() {
                clip_tetrahedron(&t.map(|i| map[i]), &t.map(|i| phi[i]), side, &mut parts);
            }
            let volume: f64 = parts.iter().map(tetrahedron_volume).sum();
            let found: f64 = points.iter().map(|p| p.weight).sum();
            worst = worst.max((found - volume).abs() / volume.max(1.0));
            assert!(points.iter().all(|p| p.weight >= 0.0));
            let e = unit(&add_scaled(&cross(&normal, &z), 0.4, &normal));
            for (alpha, m, k) in [
                (-1.0, 0, 0),
                (-1.0, 1, 1),
                (-1.0, 2, 0),
                (-0.5, 0, 0),
                (-0.5, 0, 2),
                (-0.5, 2, 1),
                (0.0, 2, 2),
            ] {
                let exact = by_faces(map, &phi, side, [x, &z, &normal], (alpha, m, k));
                let found: f64 = points
                    .iter()
                    .map(|p| {
                        let d = sub(&p.x, x);
                        let s = dot(&d, &z);
                        let q = add_scaled(&d, -s, &z);
                        p.weight * norm(&q).powf(alpha) * s.powi(k) * dot(&q, &e).powi(m)
                    })
                    .sum();
                let scale: f64 = points.iter().map(|p| p.weight).sum::<f64>().max(1e-3);
                worst = worst.max((found - exact).abs() / scale);
            }
        }
        worst
    }

    /// Name, shear of the cell, a point of the front, its direction, the normal of the crack.
    #[rustfmt::skip]
    const FRONTS: [(&str, f64, Point, Point, Point); 7] = [
        ("parallel to an edge", 0.0, [0.1, 0.2, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ("parallel, near a face", 0.0, [0.99, 0.2, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ("in a plane of the grid", 0.0, [0.1, 0.2, 0.3], [0.4, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ("oblique", 0.0, [0.1, 0.2, -0.1], [0.5, 0.3, 1.0], [0.3, 1.0, 0.0]),
        ("sheared cell", 0.3, [0.1, 0.2, -0.1], [0.5, -0.7, 1.0], [0.3, 1.0, 0.0]),
        ("across an edge", 0.0, [0.9, 0.1, 0.8], [1.0, 0.2, -1.0], [0.0, 1.0, 0.2]),
        ("near a corner", 0.0, [0.9, 1.1, 0.9], [1.0, -0.7, -0.9], [0.3, 1.0, 0.2]),
    ];

    #[test]
    fn singular_integrals_over_front_cells_are_good_to_1e_6() {
        for (name, shear, x, along, normal) in FRONTS {
            for (n, allowed) in [(3, 2e-4), (5, 5e-6), (7, 1e-6)] {
                let error = check(&cell(shear), &x, &along, &normal, n);
                assert!(error < allowed, "{name}, {n} points: {error:.1e}");
            }
        }
    }

    #[test]
    fn the_rule_follows_a_curved_front() {
        let map = cell(0.0);
        let normal = [0.0, 1.0, 0.0];
        let disc = Ellipse {
            centre: [-3.6, 0.1, 0.4],
            normal,
            axis: [1.0, 0.0, 0.0],
            half_axes: [4.0, 3.0],
        };
        let phi: Vec<f64> = map.iter().map(|x| x[1] - 0.1).collect();
        // Where the front crosses the faces z = ±1.
        let chord = [-1.0, 1.0].map(|z: f64| {
            [
                -3.6 + 4.0 * (1.0 - ((z - 0.4) / 3.0).powi(2)).sqrt(),
                0.1,
                z,
            ]
        });
        let integral = |n: usize, affine: bool, curved: bool| -> f64 {
            let along = unit(&sub(&chord[1], &chord[0]));
            let across = cross(&normal, &along);
            let at = |x: &Point| {
                if curved {
                    disc.meet(x, &across)
                } else {
                    Some(*x)
                }
            };
            let piece = FrontPiece { chord, normal, at };
            let fan = FanRule::fine(affine);
            front_cell_points(&map, &phi, 1.0, &piece, FrontRule { along: n, fan })
                .iter()
                .map(|p| {
                    let r = disc.nearest(&p.x).psi.hypot(p.x[1] - 0.1);
                    p.weight * (1.0 + p.x[0] * p.x[2]) / r
                })
                .sum()
        };
        let exact = integral(12, false, true);
        for (n, allowed) in [(3, 1e-4), (5, 1e-6)] {
            let error = integral(n, true, true) / exact - 1.0;
            assert!(error.abs() < allowed, "{n} points: {error:e}");
        }
        // The chord in its place is 1e-2 off whatever the number of points: the reason for following the front.
        assert!((integral(9, false, false) / exact - 1.0).abs() > 1e-3);
    }
}
