//! The cells next to cracks: their edges by place, and how close is there.

use std::collections::{BTreeMap, BTreeSet};

use crate::geometry::boxes::{Boxes, around};
use crate::geometry::curve::turned;
use crate::geometry::{Point, dot, norm, sub, unit};
use crate::mesh::Mesh;

use super::crack::{Crack, on_crack};

/// A free end this close to a mesh edge along its crack, in units of the shortest edge at hand, lies on it.
pub const TIP_ON_EDGE: f64 = 1e-9;

/// The cells next to a crack.
pub struct Near<'a> {
    pub mesh: &'a Mesh,
    /// By node: cells next to a crack, ascending.
    pub cells_of: BTreeMap<u32, Vec<usize>>,
    /// Edges of these cells, lower node first.
    pub edges: BTreeSet<[u32; 2]>,
    /// The same by place.
    boxes: Boxes,
    /// The same by number there.
    numbered: Vec<[u32; 2]>,
    /// No place is taken for another one farther away [m].
    slack: f64,
    /// Shortest edge at each of their nodes [m].
    pub sizes: BTreeMap<u32, f64>,
    /// Rounding of coordinates [m].
    rounding: f64,
}

impl<'a> Near<'a> {
    /// Cells that one of the cracks may touch.
    pub fn new(mesh: &'a Mesh, cracks: &[Crack]) -> Self {
        let mut near = Near {
            mesh,
            cells_of: BTreeMap::new(),
            edges: BTreeSet::new(),
            boxes: Boxes::default(),
            numbered: Vec::new(),
            slack: 0.0,
            sizes: BTreeMap::new(),
            rounding: mesh.rounding(),
        };
        // All arms of a crack have its level set.
        let whole = cracks
            .chunk_by(|a, b| a.number == b.number)
            .map(|arms| &arms[0]);
        let touched = whole.flat_map(|crack| {
            crack.cells().iter().copied().filter(|&cell| {
                let phi = mesh.cell(cell).iter().map(|&n| crack.phi(mesh, n).abs());
                // The two most distant corners are at most two longest edges apart.
                phi.fold(f64::INFINITY, f64::min) <= 2.0 * mesh.map(cell).longest_edge()
            })
        });
        let touched: BTreeSet<usize> = touched.collect();
        for cell in touched {
            let nodes = mesh.cell(cell);
            for &node in nodes {
                near.cells_of.entry(node).or_default().push(cell);
            }
            for &[i, j] in mesh.kind.edges() {
                let (a, b) = (nodes[i].min(nodes[j]), nodes[i].max(nodes[j]));
                near.edges.insert([a, b]);
                let length = norm(&sub(&mesh.nodes[a as usize], &mesh.nodes[b as usize]));
                for node in [a, b] {
                    let size = near.sizes.entry(node).or_insert(length);
                    *size = size.min(length);
                }
            }
        }
        near.numbered = near.edges.iter().copied().collect();
        let ends = |edge: &[u32; 2]| edge.map(|n| mesh.nodes[n as usize]);
        near.boxes = Boxes::new(near.edges.iter().map(|edge| around(&ends(edge), 0.0)));
        let longest = near.sizes.values().copied().fold(0.0, f64::max);
        near.slack = (TIP_ON_EDGE * longest).max(4.0 * near.rounding);
        near
    }

    /// The edges in a box or on its border, in order.
    pub fn edges_in(&self, low: [f64; 2], high: [f64; 2]) -> Vec<[u32; 2]> {
        let corners = [low, high].map(|x| [x[0], x[1], 0.0]);
        let found = self.boxes.meeting(&around(&corners, self.slack));
        found.into_iter().map(|k| self.numbered[k]).collect()
    }

    /// Cells at a node or edge.
    pub fn cells(&self, nodes: [u32; 2]) -> Vec<usize> {
        let [one, two] = nodes.map(|n| self.cells_of.get(&n).map_or(&[][..], Vec::as_slice));
        one.iter().copied().filter(|c| two.contains(c)).collect()
    }

    /// Distance from a node below which a place lies on it [m].
    pub fn tolerance(&self, node: u32) -> f64 {
        on_crack(self.sizes[&node], self.rounding)
    }

    pub fn edge_tolerance(&self, [i, j]: [u32; 2]) -> f64 {
        self.tolerance(i).min(self.tolerance(j))
    }

    pub fn at(&self, node: u32) -> &Point {
        &self.mesh.nodes[node as usize]
    }

    /// How deep a point lies in a cell: its distance from the nearest edge, negative outside [m].
    pub fn depth(&self, cell: usize, x: &Point) -> f64 {
        let map = self.mesh.map(cell);
        let edges = (0..map.len()).map(|i| {
            let (p, q) = (&map[i], &map[(i + 1) % map.len()]);
            dot(&turned(&unit(&sub(q, p))), &sub(x, p))
        });
        edges.fold(f64::INFINITY, f64::min)
    }

    /// Whether an edge or node lies on the border of the body.
    pub fn is_on_border(&self, [i, j]: [u32; 2]) -> bool {
        if i != j {
            return self.cells([i, j]).len() < 2;
        }
        let mut edges = self.edges.iter().filter(|edge| edge.contains(&i));
        edges.any(|&edge| self.cells(edge).len() < 2)
    }
}
