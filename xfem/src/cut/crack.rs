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

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::geometry::boxes::{Extents, around};
use crate::geometry::clip::{Side, crossing, snapped};
use crate::geometry::crack_shape::CrackShape;
use crate::geometry::crack_shape::plane_frame;
use crate::geometry::curve::Curve;
use crate::geometry::ellipse::Ellipse;
use crate::geometry::{Point, dot, norm, sub};
use crate::mesh::cell::{CellMap, Nodal};
use crate::mesh::{Lengths, Mesh};

use super::arrangement::DELTA;

/// What is nearer to a line than this, in shortest edges, is on it but for rounding of coordinates: 1e-16 of the body, about 1e-14 h.
pub const ON_CRACK: f64 = 1e-12;

/// Distance from a line that is rounding [m]; `size`: shortest edge, `rounding`: of coordinates [m].
pub fn on_crack(size: f64, rounding: f64) -> f64 {
    (ON_CRACK * size).max(rounding)
}

/// Tip enrichment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tip {
    /// No tip functions: the crack ends at the last cell edge it crosses.
    None,
    /// Four branch functions on all nodes within a radius that the program chooses: a fixed part of the room around the tip.
    Auto,
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

/// End of a 2D arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// A tip: the crack's own end, in a plane body inside of it once it is arranged.
    Free,
    /// The crack's own end on the border of the body, or outside.
    Mouth,
    /// A bend, or the seam of a closed crack: the next arm goes on.
    Bend,
    /// Another crack.
    Meeting,
}

/// A vertex of the polyline that stands for a 2D arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathVertex {
    /// Abscissa along the crack [m].
    pub s: f64,
    /// Position [m].
    pub x: Point,
}

/// The side of a plane on which an arm in a solid lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parent {
    /// First arm of the crack it ends on.
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
    /// Ends at the first and last abscissa.
    pub ends: [End; 2],
    /// 2D: the polyline through the cells, from the first to the last abscissa; an arc is a chain of chords.
    pub path: Vec<PathVertex>,
    /// 3D: planes at which it ends.
    pub parents: Vec<Parent>,
    /// Enrichment of tips inside the body.
    pub tip: Tip,
    /// φ next to it, the same for all its arms.
    pub(super) near: Arc<LevelSet>,
}

/// φ at the nodes next to a crack.
#[derive(Debug, Default)]
pub(super) struct LevelSet {
    /// Cells that the crack may touch, and their neighbours.
    cells: Vec<usize>,
    /// Their nodes, ascending.
    nodes: Vec<u32>,
    /// φ there, 0 on the crack [m].
    phi: Vec<f64>,
    /// Nodes on it, ascending.
    on: Vec<u32>,
    /// Of a solid: what lies this near to its plane or front is on it [m].
    slack: [f64; 2],
}

impl Crack {
    /// Whether a tip or front of `other` is this arm's: all arms of an ellipse have one front, one in a plane body has the
    /// ends of its own.
    pub fn shares_tips(&self, other: &Crack) -> bool {
        let solid = matches!(self.geometry, Geometry::Ellipse(_));
        self.number == other.number && (solid || self.range == other.range)
    }

    /// Places a crack in a mesh of these lengths, alone.
    pub fn new(
        number: usize,
        shape: &CrackShape,
        tip: Tip,
        mesh: &Mesh,
        lengths: &Lengths,
    ) -> Self {
        let geometry = match shape {
            CrackShape::Polyline(points) => Geometry::Curve(Curve::chain(points)),
            &CrackShape::Arc {
                centre,
                radius,
                from,
                to,
            } => Geometry::Curve(Curve::arc(centre, radius, [from, to])),
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
            range,
            ends: match &geometry {
                Geometry::Curve(curve) if curve.is_closed() => [End::Bend; 2],
                _ => [End::Free; 2],
            },
            path: match &geometry {
                Geometry::Curve(curve) => path(curve, lengths.smallest),
                _ => Vec::new(),
            },
            geometry,
            parents: Vec::new(),
            tip,
            near: Arc::default(),
        };
        crack.place(mesh, lengths, None);
        crack
    }

    /// Finds the mesh next to it. `on`: nodes on it; otherwise those that are but for rounding.
    pub(super) fn place(&mut self, mesh: &Mesh, lengths: &Lengths, on: Option<BTreeSet<u32>>) {
        let cells = mesh.surroundings().meeting(&self.extents());
        let nodes: Vec<u32> = mesh.nodes_of(cells.iter().copied()).into_iter().collect();
        // Flat faces are those that tetrahedra have, too: no node but those it runs through is on it.
        let slack = on_crack(lengths.smallest, lengths.rounding);
        let delta = (DELTA * lengths.smallest).max(lengths.rounding);
        let phi = nodes.iter().map(|node| {
            let size = lengths.of_nodes[*node as usize];
            let distance = self.distance(&mesh.nodes[*node as usize]);
            match &on {
                Some(on) if on.contains(node) => 0.0,
                Some(_) => snapped(distance, on_crack(size, lengths.rounding)),
                None => snapped(distance, slack),
            }
        });
        let phi: Vec<f64> = phi.collect();
        let on = match on {
            Some(on) => on.into_iter().collect(),
            None => {
                let zero = nodes.iter().zip(&phi).filter(|n| *n.1 == 0.0);
                zero.map(|n| *n.0).collect()
            }
        };
        self.near = Arc::new(LevelSet {
            cells,
            nodes,
            phi,
            on,
            slack: [slack, delta],
        });
    }

    /// A box around it [m].
    pub fn extents(&self) -> Extents {
        /// Of its chords, by which an arc may reach out of theirs.
        const BULGE: f64 = 0.01;
        match &self.geometry {
            Geometry::Curve(_) => {
                let [low, high] = around(self.path.iter().map(|v| &v.x), 0.0);
                around(&[low, high], BULGE * norm(&sub(&high, &low)))
            }
            Geometry::Plane { .. } => [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]],
            Geometry::Ellipse(e) => around([&e.centre], e.half_axes[0].max(e.half_axes[1])),
        }
    }

    /// A place of it halfway along, of an ellipse its centre, a point of a plane [m].
    pub fn middle(&self) -> Point {
        match &self.geometry {
            Geometry::Curve(_) => self.path[self.path.len() / 2].x,
            Geometry::Ellipse(ellipse) => ellipse.centre,
            Geometry::Plane { origin, .. } => *origin,
        }
    }

    /// Cells that it may touch, and their neighbours, ascending.
    pub fn cells(&self) -> &[usize] {
        &self.near.cells
    }

    /// φ at a node, as it is away from the crack [m].
    pub fn phi(&self, mesh: &Mesh, node: u32) -> f64 {
        match self.near.nodes.binary_search(&node) {
            Ok(place) => self.near.phi[place],
            Err(_) => self.distance(&mesh.nodes[node as usize]),
        }
    }

    /// Nodes next to it that are no farther from its curve or plane [m].
    pub fn nodes_within(&self, mesh: &Mesh, reach: f64) -> Vec<Point> {
        let nodes = self.near.nodes.iter().zip(&self.near.phi);
        let near = nodes.filter(|node| node.1.abs() <= reach);
        near.map(|node| mesh.nodes[*node.0 as usize]).collect()
    }

    /// Nodes on it, in a solid on its plane, ascending.
    pub fn nodes_on(&self) -> &[u32] {
        &self.near.on
    }

    /// Whether a node lies on it.
    pub fn holds(&self, node: u32) -> bool {
        self.near.on.binary_search(&node).is_ok()
    }

    /// φ(x), signed distance to the crack's curve or plane [m].
    pub fn distance(&self, x: &Point) -> f64 {
        match &self.geometry {
            Geometry::Curve(curve) => curve.nearest(x).phi,
            Geometry::Plane { origin, frame } => dot(&frame[0], &sub(x, origin)),
            Geometry::Ellipse(e) => dot(&e.normal, &sub(x, &e.centre)),
        }
    }

    /// φ of a place of a solid, 0 but for rounding: the same for all cells [m].
    pub fn level(&self, x: &Point) -> f64 {
        snapped(self.distance(x), self.near.slack[0])
    }

    /// ψ of a place of a solid, 0 or at least [`DELTA`] of the smallest edge; of a plane without a front −∞ [m].
    pub fn beyond(&self, x: &Point) -> f64 {
        match &self.geometry {
            Geometry::Ellipse(e) => snapped(e.nearest(x).psi, self.near.slack[1]),
            _ => f64::NEG_INFINITY,
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
            Geometry::Curve(curve) => curve.frame(x),
            Geometry::Plane { frame, .. } => *frame,
            Geometry::Ellipse(e) => e.frame(),
        }
    }

    /// Level set at the nodes of a cell.
    pub fn cell_phi(&self, mesh: &Mesh, cell: usize) -> Nodal<f64> {
        let nodes = mesh.cell(cell);
        Nodal::new(nodes.len(), |i| self.phi(mesh, nodes[i]))
    }

    /// Side of a node: +1 on side 1 and on the crack, −1 on side 2.
    pub fn side_of(&self, mesh: &Mesh, node: usize) -> Side {
        if self.phi(mesh, node as u32) >= 0.0 {
            1.0
        } else {
            -1.0
        }
    }

    /// True if the displacement jumps at a point of the crack's curve or plane: between the ends, by more than `slack` [m].
    pub fn jumps_at(&self, x: &Point, slack: f64) -> bool {
        match &self.geometry {
            Geometry::Curve(curve) => {
                // Where another crack takes over, both sides still part.
                let margin = self.ends.map(|end| match end {
                    End::Free => slack,
                    End::Mouth | End::Bend | End::Meeting => -slack.abs(),
                });
                let s = curve.nearest(x).s;
                curve.is_closed()
                    || (s > self.range[0] + margin[0] && s < self.range[1] - margin[1])
            }
            Geometry::Plane { .. } => true,
            Geometry::Ellipse(e) => e.nearest(x).psi < -slack,
        }
    }

    /// The free ends of a 2D arm, those that no other crack takes: which, position and unit direction pointing out of the
    /// crack.
    pub fn tips(&self) -> Vec<(usize, Point, Point)> {
        let Geometry::Curve(curve) = &self.geometry else {
            return Vec::new();
        };
        let tip = |k: usize| {
            let (x, a) = curve.at(self.range[k]);
            (k, x, if k == 0 { a.map(|v| -v) } else { a })
        };
        (0..2)
            .filter(|&k| self.ends[k] == End::Free)
            .map(tip)
            .collect()
    }
}

/// Nodes on the crack and crossed edges of a cell with levels φ, linear in between: the place, and the local nodes it lies
/// between (equal at a node).
pub fn crossings(map: &CellMap, phi: &[f64]) -> Vec<(Point, [usize; 2])> {
    let nodes = (0..map.len()).filter(|&i| phi[i] == 0.0);
    let edges = map.kind.edges().iter().copied();
    let crossed = edges.filter(|&[i, j]| phi[i] * phi[j] < 0.0);
    nodes
        .map(|i| (map[i], [i, i]))
        .chain(crossed.map(|[i, j]| (crossing(&map[i], phi[i], &map[j], phi[j]), [i, j])))
        .collect()
}

/// The first crack on which a node lies, by node.
pub fn first_on(cracks: &[Crack]) -> BTreeMap<u32, usize> {
    let later_first = cracks.iter().enumerate().rev();
    let nodes =
        later_first.flat_map(|(k, crack)| crack.nodes_on().iter().map(move |&node| (node, k)));
    nodes.collect()
}

/// The polyline that stands for a curve: its own vertices, or chords of an arc no longer than a quarter of a cell.
fn path(curve: &Curve, cell: f64) -> Vec<PathVertex> {
    /// Chords of an arc: with the least, they leave the circle by 3e-3 of the radius; the most bound the work.
    const CHORDS: [f64; 2] = [40.0, 4096.0];
    let length = curve.length();
    match curve {
        Curve::Chain(points) => {
            let mut s = 0.0;
            let vertex = |(k, &x): (usize, &Point)| {
                s += k
                    .checked_sub(1)
                    .map_or(0.0, |before| norm(&sub(&x, &points[before])));
                PathVertex { s, x }
            };
            points.iter().enumerate().map(vertex).collect()
        }
        Curve::Arc { .. } => {
            let count = (4.0 * length / cell).ceil().clamp(CHORDS[0], CHORDS[1]);
            let mut vertices: Vec<PathVertex> = (0..=count as usize)
                .map(|k| length * k as f64 / count)
                .map(|s| PathVertex {
                    s,
                    x: curve.at(s).0,
                })
                .collect();
            if curve.is_closed()
                && let Some(last) = vertices.len().checked_sub(1)
            {
                vertices[last].x = vertices[0].x;
            }
            vertices
        }
    }
}
