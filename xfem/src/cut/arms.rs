//! Arms: the parts of cracks between the places where they meet others, or bend.
//!
//! Where cracks meet, all of them are cut, at one point that they share to the last bit: a crossing has four arms, a
//! junction three. A bend sharper than ten degrees parts a crack too: the faces beside it have normals of their own, and so
//! have the forces on them. In a solid a crack that crosses an earlier plane is parted by it.

use crate::geometry::boxes::{Boxes, around};
use crate::geometry::polygon::segment_foot;
use crate::geometry::{Point, add_scaled, cross, norm, sub, unit};
use crate::mesh::Mesh;

use super::crack::{Crack, End, Geometry, Parent, PathVertex};
use super::is_split;

/// Bends sharper than this part a crack [rad]: ten degrees.
const BEND: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Closer than this to a crack is on it, in units of the shortest edge: nobody gives a point on a slanted crack to all
/// digits.
const ON_OTHER: f64 = 1e-4;

/// Places where one crack meets others closer than this are one, in the same units; no arm between them is shorter.
const SAME_PLACE: f64 = 10.0 * ON_OTHER;

/// Cracks closer than this run along each other, in the same units: what lies between them is lost in rounding.
const ALONG: f64 = 1e-6;

/// Two cracks in one place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("cracks {} and {} run along each other, near {at:?}: nothing parts them", cracks[0] + 1, cracks[1] + 1)]
pub struct Overlap {
    /// Their numbers in the case file, from 0.
    pub cracks: [usize; 2],
    /// Where [m].
    pub at: Point,
}

/// Cuts cracks where they meet and bend; arms of a crack follow each other. `cracks`: whole ones.
///
/// # Errors
/// Two cracks of a plane body that run along each other.
pub fn arms(cracks: Vec<Crack>, mesh: &Mesh) -> Result<Vec<Crack>, Overlap> {
    if mesh.dim() == 3 {
        let mut done: Vec<Crack> = Vec::new();
        for crack in cracks {
            done.extend(plane_arms(&crack, &done, mesh));
        }
        return Ok(done);
    }
    let size = mesh.smallest_edge();
    let mut places = Places {
        size,
        points: Vec::new(),
        cuts: vec![Vec::new(); cracks.len()],
    };
    let extents = |crack: &Crack| around(&crack.extents(), size);
    let boxes = Boxes::new(cracks.iter().map(extents));
    for (later, crack) in cracks.iter().enumerate() {
        let near = boxes.meeting(&extents(crack)).into_iter();
        for earlier in near.take_while(|&k| k < later) {
            places.meet(&cracks, [earlier, later])?;
        }
    }
    let parts = cracks.iter().zip(places.cuts);
    Ok(parts
        .flat_map(|(crack, cuts)| parted(crack, cuts, SAME_PLACE * size))
        .collect())
}

/// Where cracks meet.
struct Places {
    /// The shortest edge [m].
    size: f64,
    /// All places.
    points: Vec<Point>,
    /// By crack: abscissa [m] and place.
    cuts: Vec<Vec<PathVertex>>,
}

impl Places {
    /// Adds where two cracks meet.
    fn meet(&mut self, cracks: &[Crack], pair: [usize; 2]) -> Result<(), Overlap> {
        let [one, two] = pair.map(|k| &cracks[k]);
        let slack = ON_OTHER * self.size;
        // Where one ends on the other, or beside it.
        for (k, l) in [(0, 1), (1, 0)] {
            let (ending, other) = (&cracks[pair[k]], &cracks[pair[l]]);
            let ends = [ending.path.first(), ending.path.last()];
            for end in ends.into_iter().flatten().filter(|_| !is_closed(ending)) {
                let near = other.path.windows(2).map(|w| {
                    let foot = segment_foot(&end.x, &w[0].x, &w[1].x);
                    let share = distance(&w[0].x, &foot) / distance(&w[0].x, &w[1].x);
                    (
                        distance(&end.x, &foot),
                        w[0].s + share * (w[1].s - w[0].s),
                        foot,
                    )
                });
                let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
                if let Some((away, s, foot)) = nearest.filter(|n| n.0 <= slack) {
                    // Followed to where it really crosses, if that is next to it: both keep their directions.
                    let crossing = crossings(ending, other, 100.0 * slack)
                        .into_iter()
                        .filter(|c| (c[0].s - end.s).abs() <= 100.0 * slack)
                        .min_by(|a, b| (a[0].s - end.s).abs().total_cmp(&(b[0].s - end.s).abs()));
                    let (s, x) = match crossing {
                        Some(c) => (c[1].s, c[1].x),
                        // It runs beside the other.
                        None if away > ALONG * self.size => continue,
                        None => (s, foot),
                    };
                    self.add([pair[k], pair[l]], [end.s, s], x);
                }
            }
        }
        for [a, b] in crossings(one, two, 0.0) {
            self.add(pair, [a.s, b.s], a.x);
        }
        self.overlap([one, two])
    }

    /// Adds a place of two cracks at their abscissas; close to another, it is that one.
    fn add(&mut self, cracks: [usize; 2], s: [f64; 2], x: Point) {
        let same = SAME_PLACE * self.size;
        let known = self.points.iter().find(|p| distance(p, &x) <= same);
        let x = known.copied().unwrap_or_else(|| {
            self.points.push(x);
            x
        });
        for (crack, s) in cracks.into_iter().zip(s) {
            let cuts = &mut self.cuts[crack];
            if !cuts.iter().any(|c| (c.s - s).abs() <= same && c.x == x) {
                cuts.push(PathVertex { s, x });
            }
        }
    }

    /// Refuses two cracks of which a piece of one lies on the other.
    fn overlap(&self, cracks: [&Crack; 2]) -> Result<(), Overlap> {
        let [one, two] = cracks;
        let along = ALONG * self.size;
        for p in one.path.windows(2) {
            for q in two.path.windows(2) {
                let shared: Vec<Point> = [
                    (&q[0].x, &p[0].x, &p[1].x),
                    (&q[1].x, &p[0].x, &p[1].x),
                    (&p[0].x, &q[0].x, &q[1].x),
                    (&p[1].x, &q[0].x, &q[1].x),
                ]
                .into_iter()
                .filter(|(x, a, b)| distance(x, &segment_foot(x, a, b)) <= along)
                .map(|(x, ..)| *x)
                .collect();
                for x in &shared {
                    if distance(x, &shared[0]) > SAME_PLACE * self.size {
                        return Err(Overlap {
                            cracks: [one.number, two.number],
                            at: add_scaled(&shared[0], 0.5, &sub(x, &shared[0])),
                        });
                    }
                }
            }
        }
        Ok(())
    }
}

fn distance(a: &Point, b: &Point) -> f64 {
    norm(&sub(a, b))
}

/// Whether a whole crack ends where it begins.
fn is_closed(crack: &Crack) -> bool {
    matches!(&crack.geometry, Geometry::Curve(curve) if curve.is_closed())
}

/// Where the paths of two cracks cross, as vertices of the one and the other; their first and last segments longer by
/// `beyond` [m].
fn crossings(one: &Crack, two: &Crack, beyond: f64) -> Vec<[PathVertex; 2]> {
    /// Segments more parallel than this, as sine of their angle, do not cross.
    const PARALLEL: f64 = 1e-9;
    /// What two neighbouring segments may leave open between them, in their length.
    const GAP: f64 = 1e-12;
    let reach = |crack: &Crack, i: usize, length: f64| {
        let at_end = |end: bool| {
            if end && !is_closed(crack) {
                beyond
            } else {
                GAP * length
            }
        };
        [at_end(i == 0), at_end(i + 2 == crack.path.len())]
    };
    let mut found = Vec::new();
    for (i, p) in one.path.windows(2).enumerate() {
        for (j, q) in two.path.windows(2).enumerate() {
            let (d, e, from) = (
                sub(&p[1].x, &p[0].x),
                sub(&q[1].x, &q[0].x),
                sub(&q[0].x, &p[0].x),
            );
            let (length, other) = (norm(&d), norm(&e));
            let turn = cross(&d, &e)[2];
            if turn.abs() <= PARALLEL * length * other {
                continue;
            }
            let along = [
                cross(&from, &e)[2] / turn * length,
                cross(&from, &d)[2] / turn * other,
            ];
            let within =
                |t: f64, length: f64, [low, high]: [f64; 2]| t >= -low && t <= length + high;
            if within(along[0], length, reach(one, i, length))
                && within(along[1], other, reach(two, j, other))
            {
                // On the second, between its ends.
                let share = along[1].clamp(0.0, other) / other;
                let x = add_scaled(&q[0].x, share, &e);
                // A chord is shorter than its arc.
                let s = |w: &[PathVertex], share: f64| w[0].s + share * (w[1].s - w[0].s);
                let own = along[0].clamp(0.0, length) / length;
                found.push([
                    PathVertex { s: s(p, own), x },
                    PathVertex { s: s(q, share), x },
                ]);
            }
        }
    }
    found
}

/// The arms of a 2D crack between given places; `shortest` [m].
fn parted(crack: &Crack, mut cuts: Vec<PathVertex>, shortest: f64) -> Vec<Crack> {
    let (Some(first), Some(last)) = (crack.path.first(), crack.path.last()) else {
        return vec![crack.clone()];
    };
    cuts.sort_by(|a, b| a.s.total_cmp(&b.s));
    cuts.dedup_by(|b, a| b.s - a.s <= shortest);
    let mut bounds: Vec<(PathVertex, End)> = cuts.into_iter().map(|c| (c, End::Meeting)).collect();
    // Vertices closer than this are one.
    let small = 1e-6 * shortest;
    let far = |bounds: &[(PathVertex, End)], s: f64, least: f64| {
        bounds.iter().all(|(b, _)| (b.s - s).abs() > least)
    };
    for (end, vertex) in crack.ends.into_iter().zip([first, last]) {
        if far(&bounds, vertex.s, shortest) {
            bounds.push((*vertex, end));
        }
    }
    for w in crack.path.windows(3) {
        let [a, b] = [0, 1].map(|i| unit(&sub(&w[i + 1].x, &w[i].x)));
        let sine = cross(&a, &b)[2];
        let turn = sine.atan2(crate::geometry::dot(&a, &b));
        // However short: the faces between a bend and a crossing have a normal of their own.
        if turn.abs() > BEND && far(&bounds, w[1].s, small) {
            bounds.push((w[1], End::Bend));
        }
    }
    bounds.sort_by(|a, b| a.0.s.total_cmp(&b.0.s));
    let arm = |w: &[(PathVertex, End)]| {
        let (from, to) = (w[0].0, w[1].0);
        let inner = crack.path.iter().copied();
        let inner = inner.filter(|v| v.s > from.s + small && v.s < to.s - small);
        Crack {
            range: [from.s, to.s],
            ends: [w[0].1, w[1].1],
            path: std::iter::once(from).chain(inner).chain([to]).collect(),
            ..crack.clone()
        }
    };
    bounds.windows(2).map(arm).collect()
}

/// Arms of a plane or ellipse: its parts on both sides of the earlier planes that it crosses inside the body.
fn plane_arms(crack: &Crack, earlier: &[Crack], mesh: &Mesh) -> Vec<Crack> {
    let mut parts = vec![crack.clone()];
    for (index, other) in earlier.iter().enumerate() {
        if !matches!(other.geometry, Geometry::Plane { .. }) || !meet(crack, other, mesh) {
            continue;
        }
        parts = parts
            .into_iter()
            .flat_map(|part| {
                [1.0, -1.0].map(|side| {
                    let mut arm = part.clone();
                    arm.parents.push(Parent { crack: index, side });
                    arm
                })
            })
            .collect();
    }
    parts
}

/// True if some cell is cut by both planes.
fn meet(crack: &Crack, other: &Crack, mesh: &Mesh) -> bool {
    crack.cells().iter().any(|&cell| {
        let inside = |c: &Crack| is_split(&c.cell_phi(mesh, cell));
        let map = mesh.map(cell);
        inside(crack) && inside(other) && crack.jumps_at(&map.centre(), -map.diagonal())
    })
}
