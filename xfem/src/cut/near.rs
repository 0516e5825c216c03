//! The cells next to cracks: their edges by place, and how close is there.

use std::collections::{BTreeMap, BTreeSet};

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
    /// The same by their least x, in which they are sorted [m].
    by_x: Vec<(f64, [u32; 2])>,
    /// Largest extent of an edge along x [m].
    widest: f64,
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
            by_x: Vec::new(),
            widest: 0.0,
            slack: 0.0,
            sizes: BTreeMap::new(),
            rounding: mesh.rounding(),
        };
        for cell in 0..mesh.cell_count() {
            let nodes = mesh.cell(cell);
            let distance = |crack: &Crack| {
                let phi = nodes.iter().map(|&n| crack.phi[n as usize].abs());
                phi.fold(f64::INFINITY, f64::min)
            };
            let closest = cracks.iter().map(distance).fold(f64::INFINITY, f64::min);
            // The two most distant corners are at most two longest edges apart.
            if closest > 2.0 * mesh.map(cell).longest_edge() {
                continue;
            }
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
        let along_x = |edge: &[u32; 2]| edge.map(|n| mesh.nodes[n as usize][0]);
        for edge in &near.edges {
            let [a, b] = along_x(edge);
            near.by_x.push((a.min(b), *edge));
            near.widest = near.widest.max((b - a).abs());
        }
        near.by_x.sort_by(|a, b| a.0.total_cmp(&b.0));
        let longest = near.sizes.values().copied().fold(0.0, f64::max);
        near.slack = (TIP_ON_EDGE * longest).max(4.0 * near.rounding);
        near
    }

    /// The edges in a box or on its border, in order.
    pub fn edges_in(&self, mut low: [f64; 2], mut high: [f64; 2]) -> Vec<[u32; 2]> {
        for a in 0..2 {
            (low[a], high[a]) = (low[a] - self.slack, high[a] + self.slack);
        }
        let from = low[0] - self.widest;
        let begin = self.by_x.partition_point(|edge| edge.0 < from);
        let end = self.by_x.partition_point(|edge| edge.0 <= high[0]);
        let inside = |[i, j]: [u32; 2]| {
            let [p, q] = [i, j].map(|n| self.at(n));
            (0..2).all(|c| p[c].max(q[c]) >= low[c] && p[c].min(q[c]) <= high[c])
        };
        let own = self.by_x[begin..end.max(begin)].iter().map(|edge| edge.1);
        let mut found: Vec<[u32; 2]> = own.filter(|edge| inside(*edge)).collect();
        found.sort_unstable();
        found
    }

    /// Cells at a node or edge.
    pub fn cells(&self, nodes: [u32; 2]) -> Vec<usize> {
        let [one, two] = nodes.map(|n| self.cells_of.get(&n).map_or(&[][..], Vec::as_slice));
        one.iter().copied().filter(|c| two.contains(c)).collect()
    }

    /// What is closer than this to a node lies on it [m].
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
