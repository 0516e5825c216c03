//! One arrangement of cracks and mesh in the plane: what touches what is decided here, once, by identity.
//!
//! ```text
//!   vertex      a place of cracks: on a node, on an edge, in a cell, outside of the body
//!   line        a crack as a list of vertices; between two of them it lies in one cell, along one edge, or outside
//!   δ           1e-6 h, h the shortest edge there: closer vertices are one, and lie on the node or edge that close;
//!               a segment closer than δ/30 to a node or vertex runs through it, so it turns by no more than 1/30
//! ```
//!
//! The mesh stays where it is. Snapping is repeated until nothing moves, by no order of names (J. D. Hobby, Comput. Geom. 13
//! (1999) 199; L. J. Guibas & D. H. Marimont, Int. J. Comput. Geom. Appl. 8 (1998) 157). Then any two features are the same or
//! at least δ/30 apart: whoever reads the arrangement asks what a vertex lies on and compares no length.
//!
//! Modelling lengths come before: ends within 0.01 h of a crack, an end or a side are joined with it.

mod around;
mod ends;
mod snap;
mod walk;

use std::collections::BTreeMap;

use crate::geometry::Point;
use crate::geometry::curve::Curve;
use crate::geometry::polygon::bends;
use crate::mesh::{Lengths, Mesh};

use self::around::Around;
use self::snap::Net;
pub use self::walk::{Chain, TracedTip};
use super::crack::{Crack, Geometry, on_crack};

/// Vertices closer than this are one, and lie on a node or edge that close, in shortest edges there: far above rounding, far below
/// what an answer tells.
pub const DELTA: f64 = 1e-6;

/// Distance from a segment at which it runs through a place, in parts of that: it turns by no more. With 1 a segment that ends just
/// beside a node is drawn through it at any angle.
const LINE: f64 = 1.0 / 30.0;

/// What is this near to a cell, or to a radius around a place, counts as within, in shortest edges: beyond a thousandth, and between
/// the places where coordinates of few digits put a tip that is meant to be on a node, so that rounding decides nothing.
pub const WITHIN: f64 = 2.36e-3;

/// Bends sharper than this part a crack [rad]: ten degrees.
pub const BEND: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// What a vertex lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum On {
    /// A node.
    Node(u32),
    /// An edge, lower node first.
    Edge([u32; 2]),
    /// The inside of a cell.
    Cell(usize),
    /// Nothing of the mesh.
    Outside,
}

/// A place of cracks.
#[derive(Debug, Clone, Copy)]
pub struct Vertex {
    /// Position [m].
    pub x: Point,
    /// What it lies on.
    pub on: On,
    /// Shortest edge there [m].
    pub size: f64,
}

/// A place of a crack that is not where it was put: an end that was joined with what it nearly touched, or what was moved farthest.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Number of the crack, from 0.
    pub crack: usize,
    /// Where it was put [m].
    pub from: Point,
    /// Where it is now [m].
    pub to: Point,
    /// Whether it is an end that was joined.
    pub joined: bool,
}

/// Cracks that cannot be arranged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ArrangementError {
    /// Two cracks in one place.
    #[error("cracks {} and {} run along each other, near {at:?}: nothing parts them", cracks[0] + 1, cracks[1] + 1)]
    Overlap {
        /// Their numbers in the case file, from 0.
        cracks: [usize; 2],
        /// Where [m].
        at: Point,
    },
    /// A crack shorter than what is told apart.
    #[error("crack {} is shorter than 1e-6 of a cell, near {at:?}", crack + 1)]
    Point {
        /// Its number, from 0.
        crack: usize,
        /// Where [m].
        at: Point,
    },
}

/// Plane cracks in a mesh.
#[derive(Debug, Clone, Default)]
pub struct Arrangement {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Vertices on mesh edges (lower node first), from the lower node on.
    pub on_edges: BTreeMap<[u32; 2], Vec<usize>>,
    /// The ways of arms through cells, by cell; along an edge by the cell on side 1.
    pub chains: BTreeMap<usize, Vec<Chain>>,
    /// Free ends inside the body.
    pub tips: Vec<TracedTip>,
    /// What is not where it was put.
    pub moved: Vec<Moved>,
}

/// A vertex of a line.
#[derive(Debug, Clone, Copy)]
struct Link {
    vertex: usize,
    /// A point of the crack as it was given.
    given: bool,
    /// Beside it another crack ends.
    foot: bool,
    /// Abscissa along the crack [m].
    s: f64,
}

/// A crack as it is arranged.
#[derive(Debug, Clone)]
struct Line {
    /// Its place among the cracks.
    crack: usize,
    links: Vec<Link>,
}

impl Arrangement {
    /// Arranges whole cracks and parts them where they meet others, and bend: the arms of one follow each other. Cracks of a body
    /// that is not plane stay as they are.
    ///
    /// # Errors
    /// Two cracks that run along each other, or one that is a point.
    pub fn new(
        mesh: &Mesh,
        lengths: &Lengths,
        cracks: &[Crack],
    ) -> Result<(Self, Vec<Crack>), ArrangementError> {
        let mut polylines: Vec<Vec<Point>> = (cracks.iter())
            .map(|crack| {
                let points: Vec<Point> = crack.path.iter().map(|v| v.x).collect();
                match crack.geometry {
                    Geometry::Curve(Curve::Chain(_)) => {
                        let slack = on_crack(lengths.smallest, lengths.rounding);
                        let kept = bends(&points, slack).into_iter();
                        kept.map(|k| points[k]).collect()
                    }
                    _ => points,
                }
            })
            .collect();
        let around = Around::new(mesh, lengths, &polylines);
        let joined = ends::join(&around, &mut polylines);
        let mut net = Net::new(&around, cracks, &polylines);
        net.snap();
        net.part_at_feet(cracks);
        net.snap();
        net.check(cracks)?;
        net.measure(cracks);
        let told = |&(line, from, to): &(usize, Point, Point)| Moved {
            crack: cracks[line].number,
            from,
            to,
            joined: true,
        };
        let mut found = Arrangement {
            moved: joined.iter().map(told).collect(),
            ..Arrangement::default()
        };
        // Points on straight lines count, too.
        let put = cracks.iter().zip(&polylines).map(|(crack, ends)| {
            let mut points: Vec<Point> = crack.path.iter().map(|v| v.x).collect();
            let last = points.len() - 1;
            (points[0], points[last]) = (ends[0], ends[ends.len() - 1]);
            points
        });
        found
            .moved
            .extend(net.moved(cracks, &put.collect::<Vec<_>>()));
        let arms = walk::arms(&mut net, cracks, &mut found);
        found.vertices = net.vertices;
        Ok((found, arms))
    }

    /// Places of cracks on a mesh edge, from its lower node on [m].
    pub fn on_edge(
        &self,
        [i, j]: [u32; 2],
    ) -> impl DoubleEndedIterator<Item = (usize, Point)> + Clone {
        let own = self.on_edges.get(&[i.min(j), i.max(j)]);
        let own = own.map_or(&[][..], Vec::as_slice);
        own.iter().map(|&vertex| (vertex, self.vertices[vertex].x))
    }
}
