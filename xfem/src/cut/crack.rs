//! Cracks in a mesh: geometry, level sets at the nodes, what ends them.
//!
//! ```text
//!   φ(x)   signed distance to the crack's curve or plane, side 1 is φ >= 0 (H = +1)
//!   2D: the crack is the part s₀ <= s <= s₁ of a curve, a = tangent, n = a turned by +90°
//!   3D: a plane, or the part ψ <= 0 inside an ellipse; (n, a, b) right-handed, a from the axis least along n
//! ```
//!
//! A crack that meets an earlier one ends there: it is an arm whose step is 0 beyond its parent (Daux, Moës, Dolbow,
//! Sukumar & Belytschko, Int. J. Numer. Meth. Engng 48 (2000) 1741). A crack that crosses another is two arms.

use crate::geometry::clip::{Side, bent_crossing, crossing, snapped};
use crate::geometry::crack_shape::CrackShape;
use crate::geometry::crack_shape::plane_frame;
use crate::geometry::curve::{Curve, turned};
use crate::geometry::ellipse::Ellipse;
use crate::geometry::{Point, bisect, dot, sub};
use crate::mesh::Mesh;
use crate::mesh::cell::{CellMap, Nodal};

use super::is_split;

/// A node closer to the crack than this, in units of its shortest edge, lies on it: φ = 0 exactly.
///
/// Above rounding of coordinates (1e-16 of the body, about 1e-14 h). The crack is bent by so much at the node, and the contact
/// traction of a uniform stress is in error by some ten times as much (a crack that leaves the node at 10°).
pub const ON_CRACK: f64 = 1e-12;

/// Tip enrichment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tip {
    /// No tip functions: the crack ends at the last cell edge it crosses.
    None,
    /// Four branch functions on the nodes of the cells with the tip (topological enrichment).
    Branch,
    /// Four branch functions on all nodes within a radius of the tip [m] (geometric enrichment).
    Radius(f64),
}

/// Geometry of a crack.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// 2D.
    Curve(Curve),
    /// Plane through the whole solid.
    Plane {
        /// A point [m].
        origin: Point,
        /// n, a, b.
        frame: [Point; 3],
    },
    /// Flat ellipse in a solid.
    Ellipse(Ellipse),
}

/// What an arm ends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parent {
    /// Index of the crack it ends on.
    pub crack: usize,
    /// Side of that crack on which the arm lies.
    pub side: Side,
}

/// A crack, or the part of one between the cracks it meets, with its level set at the nodes.
#[derive(Debug, Clone)]
pub struct Crack {
    /// Number in the case file, from 0.
    pub number: usize,
    /// Place and shape.
    pub geometry: Geometry,
    /// First and last abscissa of a 2D arm [m]; infinite in 3D.
    pub range: [f64; 2],
    /// Whether the first and last abscissa are the crack's own ends, not a meeting with another crack.
    pub free: [bool; 2],
    /// Cracks at which it ends; its step is 0 on their other side.
    pub parents: Vec<Parent>,
    /// Enrichment of tips inside the body.
    pub tip: Tip,
    /// φ at the nodes, snapped to 0 within [`ON_CRACK`] [m].
    pub phi: Vec<f64>,
}

impl Crack {
    /// Places a crack in a mesh, alone.
    pub fn new(number: usize, shape: &CrackShape, tip: Tip, mesh: &Mesh) -> Self {
        let flat = |p: &[f64; 2]| [p[0], p[1], 0.0];
        let geometry = match shape {
            CrackShape::Polyline(points) => {
                Geometry::Curve(Curve::Chain(points.iter().map(flat).collect()))
            }
            CrackShape::Arc {
                centre,
                radius,
                from,
                to,
            } => Geometry::Curve(Curve::Arc {
                centre: flat(centre),
                radius: *radius,
                from: *from,
                to: *to,
            }),
            CrackShape::Plane { point, normal } => Geometry::Plane {
                origin: *point,
                frame: plane_frame(normal),
            },
            CrackShape::Ellipse(ellipse) => Geometry::Ellipse(*ellipse),
        };
        let range = match &geometry {
            Geometry::Curve(curve) => [0.0, curve.length()],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        };
        let mut crack = Crack {
            number,
            geometry,
            range,
            free: [true; 2],
            parents: Vec::new(),
            tip,
            phi: Vec::new(),
        };
        crack.phi = mesh
            .nodes
            .iter()
            .zip(mesh.node_sizes())
            .map(|(x, h)| snapped(crack.distance(x), ON_CRACK * h))
            .collect();
        crack
    }

    /// φ(x), signed distance to the crack's curve or plane [m].
    pub fn distance(&self, x: &Point) -> f64 {
        match &self.geometry {
            Geometry::Curve(curve) => curve.nearest(x).phi,
            Geometry::Plane { origin, frame } => dot(&frame[0], &sub(x, origin)),
            Geometry::Ellipse(e) => dot(&e.normal, &sub(x, &e.centre)),
        }
    }

    /// s(x), abscissa along a 2D crack; 0 in 3D [m].
    pub fn abscissa(&self, x: &Point) -> f64 {
        match &self.geometry {
            Geometry::Curve(curve) => curve.nearest(x).s,
            _ => 0.0,
        }
    }

    /// Local frame n, a, b at a point of the crack.
    pub fn frame(&self, x: &Point) -> [Point; 3] {
        match &self.geometry {
            Geometry::Curve(curve) => {
                let a = curve.nearest(x).tangent;
                [turned(&a), a, [0.0, 0.0, 1.0]]
            }
            Geometry::Plane { frame, .. } => *frame,
            Geometry::Ellipse(e) => e.frame(),
        }
    }

    /// Level set at the nodes of a cell.
    pub fn cell_phi(&self, mesh: &Mesh, cell: usize) -> Nodal<f64> {
        let nodes = mesh.cell(cell);
        Nodal::new(nodes.len(), |i| self.phi[nodes[i] as usize])
    }

    /// Nodes on the crack and crossed edges of a cell with levels φ: the place, and the local nodes it lies between
    /// (equal at a node).
    pub fn crossings(&self, map: &CellMap, phi: &[f64]) -> Vec<(Point, [usize; 2])> {
        let nodes = (0..map.len()).filter(|&i| phi[i] == 0.0);
        let mut found: Vec<_> = nodes.map(|i| (map[i], [i, i])).collect();
        for &[i, j] in map.kind.edges() {
            if phi[i] * phi[j] < 0.0 {
                let x = match &self.geometry {
                    // φ is monotone enough for bisection.
                    Geometry::Curve(curve) if !curve.is_straight() => {
                        bent_crossing(&map[i], phi[i], &map[j], |x| self.distance(x))
                    }
                    _ => crossing(&map[i], phi[i], &map[j], phi[j]),
                };
                found.push((x, [i, j]));
            }
        }
        found
    }

    /// Side of a node: +1 on side 1 and on the crack, −1 on side 2.
    pub fn side_of(&self, node: usize) -> Side {
        if self.phi[node] >= 0.0 { 1.0 } else { -1.0 }
    }

    /// True if the displacement jumps at a point of the crack's curve or plane: between the ends, by more than `slack` [m].
    pub fn jumps_at(&self, x: &Point, slack: f64) -> bool {
        match &self.geometry {
            Geometry::Curve(curve) => {
                // Where another crack takes over, both sides still part.
                let margin = [0, 1].map(|k| if self.free[k] { slack } else { -slack.abs() });
                let s = curve.nearest(x).s;
                curve.is_closed()
                    || (s > self.range[0] + margin[0] && s < self.range[1] - margin[1])
            }
            Geometry::Plane { .. } => true,
            Geometry::Ellipse(e) => e.nearest(x).psi < -slack,
        }
    }

    /// The free ends of a 2D arm, those that no other crack takes: position and unit direction pointing out of the crack.
    pub fn ends(&self) -> Vec<(Point, Point)> {
        let Geometry::Curve(curve) = &self.geometry else {
            return Vec::new();
        };
        if curve.is_closed() {
            return Vec::new();
        }
        let mut ends = Vec::new();
        if self.free[0] {
            let (x, a) = curve.at(0.0);
            ends.push((x, a.map(|v| -v)));
        }
        if self.free[1] {
            ends.push(curve.at(self.range[1]));
        }
        ends
    }
}

/// Cuts cracks at the earlier ones they meet. A crack keeps its index if nothing crosses it; arms follow in order.
pub fn arms(cracks: Vec<Crack>, mesh: &Mesh) -> Vec<Crack> {
    let mut done: Vec<Crack> = Vec::new();
    for crack in cracks {
        let next = match &crack.geometry {
            Geometry::Curve(curve) => curve_arms(&crack, curve, &done, mesh),
            _ => plane_arms(&crack, &done, mesh),
        };
        done.extend(next);
    }
    done
}

/// Arms of a 2D crack: its parts between the earlier cracks it meets.
fn curve_arms(crack: &Crack, curve: &Curve, earlier: &[Crack], mesh: &Mesh) -> Vec<Crack> {
    let length = curve.length();
    let size = mesh.smallest_edge();
    // Closer than this to a crack is on it: nobody gives a point on a slanted crack to all digits.
    let slack = 1e-4 * size;
    let mut cuts: Vec<(f64, usize)> = Vec::new();
    for (index, other) in earlier.iter().enumerate() {
        for s in meetings(curve, other, 0.25 * size, slack) {
            if !cuts.iter().any(|c| (c.0 - s).abs() < 10.0 * slack) {
                cuts.push((s, index));
            }
        }
    }
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut bounds: Vec<(f64, Option<usize>)> = vec![(0.0, None)];
    bounds.extend(cuts.into_iter().map(|(s, index)| (s, Some(index))));
    bounds.push((length, None));
    // An end on another crack is no tip.
    bounds.dedup_by(|b, a| {
        let same = b.0 - a.0 <= 10.0 * slack;
        if same && a.1.is_none() {
            *a = *b;
        }
        same
    });
    bounds
        .windows(2)
        .map(|w| {
            let middle =
                |from: f64, to: f64| curve.at(from + 0.01 * (to - from).clamp(-size, size)).0;
            let parent = |end: (f64, Option<usize>), inner: f64| {
                end.1.map(|index| Parent {
                    crack: index,
                    side: earlier[index].distance(&middle(end.0, inner)).signum(),
                })
            };
            Crack {
                range: [w[0].0, w[1].0],
                free: [w[0].1.is_none(), w[1].1.is_none()],
                parents: [parent(w[0], w[1].0), parent(w[1], w[0].0)]
                    .into_iter()
                    .flatten()
                    .collect(),
                ..crack.clone()
            }
        })
        .collect()
}

/// Abscissas of a curve at which it meets another 2D crack between that one's ends.
fn meetings(curve: &Curve, other: &Crack, step: f64, slack: f64) -> Vec<f64> {
    let length = curve.length();
    let count = (length / step).ceil().max(1.0) as usize;
    let distance = |s: f64| other.distance(&curve.at(s).0);
    let on = |s: f64| {
        let x = curve.at(s).0;
        distance(s).abs() <= slack && {
            let along = other.abscissa(&x);
            along >= other.range[0] - slack && along <= other.range[1] + slack
        }
    };
    // Zero is a side too: a meeting at a sample must not fall between two intervals.
    let above = |s: f64| distance(s) >= 0.0;
    let root = |low: f64, high: f64| {
        let start = above(low);
        bisect(low, high, |s| above(s) == start)
    };
    // An end on the other crack, whichever side rounding puts it on: the curve is followed to where they meet.
    let ends = [0.0, length].into_iter().filter(|&s| on(s)).map(|s| {
        let (before, after) = (s - 100.0 * slack, s + 100.0 * slack);
        let crosses = distance(before) * distance(after) < 0.0;
        if crosses { root(before, after) } else { s }
    });
    let mut found: Vec<f64> = ends.collect();
    for k in 0..count {
        let [low, high] = [k, k + 1].map(|k| length * k as f64 / count as f64);
        if above(low) != above(high) {
            found.extend(Some(root(low, high)).filter(|&s| on(s)));
        }
    }
    found
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
    (0..mesh.cell_count()).any(|cell| {
        let inside = |c: &Crack| is_split(&c.cell_phi(mesh, cell));
        let map = mesh.map(cell);
        inside(crack) && inside(other) && crack.jumps_at(&map.centre(), -map.diagonal())
    })
}
