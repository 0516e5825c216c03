//! Arms: the parts of cracks between the places where they meet others, or bend.
//!
//! Where cracks meet, all of them are cut, at one point that they share to the last bit: a crossing has four arms, a
//! junction three. A bend sharper than ten degrees parts a crack too: the faces beside it have normals of their own, and so
//! have the forces on them. In a solid a crack that crosses an earlier plane is parted by it.

use crate::geometry::boxes::{Boxes, around};
use crate::geometry::curve::Curve;
use crate::geometry::polygon::{segment_distance, segment_foot};
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub, unit};
use crate::mesh::{Lengths, Mesh};

use super::crack::{Crack, End, Geometry, Parent, PathVertex};
use super::is_split;
use super::placement::cells_at;

/// Bends sharper than this part a crack [rad]: ten degrees.
const BEND: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// An end closer than this to another crack, to another end or to a side of the body is joined with it, in units of the
/// shortest edge: nobody gives a point on a slanted crack to all digits. Farther away what lies between stays a ligament.
const JOINED: f64 = 1e-2;

/// How far an end is followed to where it really crosses, in the same units: so it keeps its direction.
const FOLLOWED: f64 = 10.0 * JOINED;

/// A crack that another's end is nearer to than this, in the same units, is parted at the foot of that end.
const BESIDE: f64 = 1.0;

/// Places where one crack meets others closer than this are one, in the same units; no arm between them is shorter.
const SAME_PLACE: f64 = 1e-3;

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

/// An end that was joined with what it nearly touches.
#[derive(Debug, Clone, PartialEq)]
pub struct Joined {
    /// Number of the crack, from 0.
    pub crack: usize,
    /// Where it ends as it was given [m].
    pub from: Point,
    /// Where it ends now [m].
    pub to: Point,
}

/// Cuts cracks where they meet and bend; arms of a crack follow each other. `cracks`: whole ones. Ends that nearly touch
/// something are joined with it.
///
/// # Errors
/// Two cracks of a plane body that run along each other.
pub fn arms(
    mut cracks: Vec<Crack>,
    mesh: &Mesh,
    lengths: &Lengths,
) -> Result<(Vec<Crack>, Vec<Joined>), Overlap> {
    if mesh.dim() == 3 {
        let mut done: Vec<Crack> = Vec::new();
        for crack in cracks {
            done.extend(plane_arms(&crack, &done, mesh));
        }
        return Ok((done, Vec::new()));
    }
    let size = lengths.smallest;
    let mut places = Places {
        size,
        points: Vec::new(),
        cuts: vec![Vec::new(); cracks.len()],
        joined: Vec::new(),
    };
    let extents = |crack: &Crack| around(&crack.extents(), size);
    let boxes = Boxes::new(cracks.iter().map(extents));
    let near: Vec<Vec<usize>> = cracks
        .iter()
        .map(|crack| boxes.meeting(&extents(crack)))
        .collect();
    let inside = |x: &Point| !cells_at(mesh, x).is_empty();
    for k in 0..cracks.len() {
        for end in 0..if is_closed(&cracks[k]) { 0 } else { 2 } {
            if !places.join(&cracks, (k, end), &near[k], inside) {
                places.lead_out(&mut cracks[k], end, mesh);
            }
        }
    }
    for (later, near) in near.iter().enumerate() {
        for &earlier in near.iter().take_while(|&&k| k < later) {
            places.meet(&cracks, [earlier, later])?;
        }
    }
    places.part_at_feet(&cracks, &near, inside);
    let parts = cracks.iter().zip(places.cuts);
    let arms = parts.flat_map(|(crack, cuts)| parted(crack, cuts, SAME_PLACE * size));
    Ok((arms.collect(), places.joined))
}

/// Where cracks meet.
struct Places {
    /// The shortest edge [m].
    size: f64,
    /// All places.
    points: Vec<Point>,
    /// By crack: abscissa [m] and place.
    cuts: Vec<Vec<PathVertex>>,
    /// Ends that were moved.
    joined: Vec<Joined>,
}

/// The last vertex of a whole crack at one of its ends, and the unit direction out of it.
fn ending(crack: &Crack, end: usize) -> Option<(PathVertex, Point)> {
    let [last, before] = match crack.path.as_slice() {
        [first, next, ..] if end == 0 => [first, next],
        [.., next, last] => [last, next],
        _ => return None,
    };
    Some((*last, unit(&sub(&last.x, &before.x))))
}

impl Places {
    /// Joins an end with the cracks it nearly touches, at the first place behind or before it; whether there are any.
    fn join(
        &mut self,
        cracks: &[Crack],
        (k, end): (usize, usize),
        near: &[usize],
        inside: impl Fn(&Point) -> bool,
    ) -> bool {
        let Some((last, ahead)) = ending(&cracks[k], end) else {
            return false;
        };
        let (joined, followed) = (JOINED * self.size, FOLLOWED * self.size);
        // The place on another crack, its abscissa there.
        let place = |l: usize| {
            let (away, s, foot) = foot(&cracks[l], &last.x)?;
            if away > joined {
                return None;
            }
            let away_from_end = |c: &[PathVertex; 2]| (c[0].s - last.s).abs();
            let crossing = crossings(&cracks[k], &cracks[l], followed)
                .into_iter()
                .filter(|c| away_from_end(c) <= followed && distance(&c[0].x, &last.x) <= followed)
                .min_by(|a, b| away_from_end(a).total_cmp(&away_from_end(b)));
            // It runs beside the other, or on to an end of it: that of the earlier stays.
            let ends = [cracks[l].path.first(), cracks[l].path.last()];
            let at_end = ends.into_iter().flatten().any(|v| v.x == foot);
            match crossing {
                Some(c) => Some((l, c[1].s, c[1].x)),
                None if away <= ALONG * self.size || at_end && l < k => Some((l, s, foot)),
                None => None,
            }
        };
        let found: Vec<(usize, f64, Point)> = near
            .iter()
            .filter(|&&l| l != k)
            .filter_map(|&l| place(l))
            .collect();
        let along = |x: &Point| dot(&sub(x, &last.x), &ahead);
        let Some(first) = found
            .iter()
            .min_by(|a, b| along(&a.2).total_cmp(&along(&b.2)))
        else {
            return false;
        };
        // Outside of the body nothing has to meet.
        if !inside(&last.x) {
            return false;
        }
        let x = first.2;
        for (l, s, at) in found {
            if distance(&at, &x) <= SAME_PLACE * self.size {
                self.add([k, l], [last.s, s], at);
            }
        }
        self.note(&cracks[k], &last.x, &x);
        true
    }

    /// Parts straight cracks at the feet of ends that stop beside them: what they carry is singular there, too. The nearest come
    /// first, however the cracks are ordered.
    fn part_at_feet(
        &mut self,
        cracks: &[Crack],
        near: &[Vec<usize>],
        inside: impl Fn(&Point) -> bool,
    ) {
        let straight = |crack: &Crack| matches!(crack.geometry, Geometry::Curve(Curve::Chain(_)));
        let mut feet = Vec::new();
        for k in 0..cracks.len() {
            let ends = (0..2).filter_map(|end| Some(ending(&cracks[k], end)?.0.x));
            for x in ends.filter(&inside) {
                let others = near[k].iter().filter(|&&l| l != k && straight(&cracks[l]));
                let on = others.filter_map(|&l| Some((l, foot(&cracks[l], &x)?)));
                feet.extend(on.filter(|(_, (away, ..))| *away <= BESIDE * self.size));
            }
        }
        feet.sort_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        for (l, (_, s, x)) in feet {
            let near = |known: &[PathVertex], by: f64| known.iter().any(|v| (v.s - s).abs() <= by);
            // Within a cell one corner does.
            let [bent, met] = [FOLLOWED, BESIDE].map(|by| by * self.size);
            if !near(&cracks[l].path, bent) && !near(&self.cuts[l], met) {
                self.cuts[l].push(PathVertex { s, x });
            }
        }
    }

    /// Leads an end that nearly touches a side of the body through it.
    fn lead_out(&mut self, crack: &mut Crack, end: usize, mesh: &Mesh) {
        let Some((last, ahead)) = ending(crack, end) else {
            return;
        };
        let facets = mesh.sides.values().flatten();
        let before = facets.filter_map(|&facet| {
            let ends: Vec<usize> = mesh.facet_nodes(facet).collect();
            let [p, q] = [0, 1].map(|i| &mesh.nodes[ends[i]]);
            let (d, from) = (sub(q, p), sub(p, &last.x));
            let turn = cross(&ahead, &d)[2];
            let [t, share] = [cross(&from, &d)[2] / turn, cross(&from, &ahead)[2] / turn];
            let close = segment_distance(&last.x, p, q) <= JOINED * self.size;
            (close && (0.0..=1.0).contains(&share) && t > 0.0).then_some(t)
        });
        let nearest = before.fold(f64::INFINITY, f64::min);
        if nearest > FOLLOWED * self.size {
            return;
        }
        self.note(crack, &last.x, &add_scaled(&last.x, nearest, &ahead));
        let by = nearest + JOINED * self.size;
        let moved = PathVertex {
            s: last.s + if end == 0 { -by } else { by },
            x: add_scaled(&last.x, by, &ahead),
        };
        crack.range[end] = moved.s;
        let vertex = if end == 0 {
            crack.path.first_mut()
        } else {
            crack.path.last_mut()
        };
        if let Some(vertex) = vertex {
            *vertex = moved;
        }
    }

    fn note(&mut self, crack: &Crack, from: &Point, to: &Point) {
        if distance(from, to) > ALONG * self.size {
            self.joined.push(Joined {
                crack: crack.number,
                from: *from,
                to: *to,
            });
        }
    }

    /// Adds where two cracks cross.
    fn meet(&mut self, cracks: &[Crack], pair: [usize; 2]) -> Result<(), Overlap> {
        let [one, two] = pair.map(|k| &cracks[k]);
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
            // An arm that crosses beside its own end ends there.
            if !cuts
                .iter()
                .any(|c| (c.s - s).abs() <= FOLLOWED * self.size && c.x == x)
            {
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

/// The nearest place of a crack: its distance, its abscissa, itself [m].
fn foot(crack: &Crack, x: &Point) -> Option<(f64, f64, Point)> {
    let feet = crack.path.windows(2).map(|w| {
        let foot = segment_foot(x, &w[0].x, &w[1].x);
        let share = distance(&w[0].x, &foot) / distance(&w[0].x, &w[1].x);
        (distance(x, &foot), w[0].s + share * (w[1].s - w[0].s), foot)
    });
    feet.min_by(|a, b| a.0.total_cmp(&b.0))
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
    /// Gap that two neighbouring segments may leave open between them, in their length.
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
        let turn = sine.atan2(dot(&a, &b));
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
