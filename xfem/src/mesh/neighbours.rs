//! Which cells lie around a node.

use std::collections::BTreeSet;

use super::Mesh;
use crate::geometry::boxes::Extents;

/// The cells of every node, ascending.
#[derive(Debug)]
pub struct Neighbours<'a> {
    mesh: &'a Mesh,
    /// Where the cells of every node start.
    ptr: Vec<usize>,
    cells: Vec<usize>,
}

impl<'a> Neighbours<'a> {
    /// Gathers them.
    pub fn new(mesh: &'a Mesh) -> Self {
        let mut ptr = vec![0; mesh.nodes.len() + 1];
        let nodes = |cell: usize| mesh.cell(cell).iter().map(|&n| n as usize);
        for node in (0..mesh.cell_count()).flat_map(nodes) {
            ptr[node + 1] += 1;
        }
        for node in 0..mesh.nodes.len() {
            ptr[node + 1] += ptr[node];
        }
        let mut cells = vec![0; ptr[mesh.nodes.len()]];
        let mut next = ptr.clone();
        for cell in 0..mesh.cell_count() {
            for node in nodes(cell) {
                cells[next[node]] = cell;
                next[node] += 1;
            }
        }
        Neighbours { mesh, ptr, cells }
    }

    /// Cells with one of some nodes.
    pub fn cells_around(&self, nodes: &BTreeSet<u32>) -> BTreeSet<usize> {
        let own = |&node: &u32| &self.cells[self.ptr[node as usize]..self.ptr[node as usize + 1]];
        nodes.iter().flat_map(own).copied().collect()
    }

    /// All nodes in a box, and some beside it.
    pub fn nodes_in(&self, extents: &Extents) -> BTreeSet<u32> {
        self.mesh
            .nodes_of(self.mesh.surroundings().meeting(extents))
    }

    /// Nodes of all cells with one of some nodes.
    pub fn nodes_around(&self, nodes: &BTreeSet<u32>) -> BTreeSet<u32> {
        self.mesh.nodes_of(self.cells_around(nodes))
    }
}
