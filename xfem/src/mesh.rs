//! Meshes: nodes, cells, boundary facets with the names of their sides.

pub mod box_mesh;
pub mod cell;
pub mod grid_motion;
pub mod inverter;
pub mod neighbours;
pub mod ordering;
pub mod stream;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use crate::geometry::boxes::{Boxes, around};
use crate::geometry::{Point, norm, sub};

use self::cell::{CellKind, CellMap};

/// A facet (edge in 2D, face in 3D) of one cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Facet {
    /// Cell number.
    pub cell: usize,
    /// Position in [`CellKind::facets`].
    pub local: usize,
}

/// A mesh of one kind of cell.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Kind of every cell.
    pub kind: CellKind,
    /// Node positions [m].
    pub nodes: Vec<Point>,
    /// Grid position of every node: equal for the two nodes of a pair on a crack. Orders the elimination.
    pub grid: Vec<[u32; 3]>,
    /// Cells, `kind.nodes()` node numbers each.
    cells: Vec<u32>,
    /// Boundary facets by the name of their side.
    pub sides: BTreeMap<String, Vec<Facet>>,
    /// Where x = 0 lies in the coordinates that places were stated in: they were rounded there [m].
    pub origin: Point,
    /// See [`surroundings`](Self::surroundings); once it is asked for, nodes stay where they are.
    surroundings: OnceLock<Boxes>,
}

/// Lengths of a mesh as it is.
#[derive(Debug, Clone)]
pub struct Lengths {
    /// Shortest edge at every node [m].
    pub of_nodes: Vec<f64>,
    /// Shortest edge [m].
    pub smallest: f64,
    /// See [`Mesh::extent`] [m].
    pub extent: (f64, Point),
    /// See [`Mesh::rounding`] [m].
    pub rounding: f64,
}

impl Lengths {
    /// Distance of two places in 1e-9 of the body's size: in the order of such distances what depends on an order is the same however
    /// cracks are named and read, and the body is turned.
    pub fn apart(&self, x: &Point, y: &Point) -> i64 {
        (norm(&sub(x, y)) / self.extent.0 * 1e9).round() as i64
    }

    /// The same from the middle of the body.
    pub fn from_middle(&self, x: &Point) -> i64 {
        self.apart(x, &self.extent.1)
    }
}

impl Mesh {
    /// A mesh from its parts; `cells` is flat, `kind.nodes()` entries per cell.
    pub fn new(
        kind: CellKind,
        nodes: Vec<Point>,
        grid: Vec<[u32; 3]>,
        cells: Vec<u32>,
        sides: BTreeMap<String, Vec<Facet>>,
    ) -> Self {
        Mesh {
            kind,
            nodes,
            grid,
            cells,
            sides,
            origin: [0.0; 3],
            surroundings: OnceLock::new(),
        }
    }

    /// Space dimension.
    pub fn dim(&self) -> usize {
        self.kind.dim()
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len() / self.kind.nodes()
    }

    /// Node numbers of a cell.
    pub fn cell(&self, cell: usize) -> &[u32] {
        let n = self.kind.nodes();
        &self.cells[n * cell..n * (cell + 1)]
    }

    /// Node numbers of a cell, to be renumbered when a crack doubles nodes.
    pub fn cell_mut(&mut self, cell: usize) -> &mut [u32] {
        let n = self.kind.nodes();
        &mut self.cells[n * cell..n * (cell + 1)]
    }

    /// Nodes of some cells.
    pub fn nodes_of(&self, cells: impl IntoIterator<Item = usize>) -> BTreeSet<u32> {
        let nodes = cells.into_iter().flat_map(|cell| self.cell(cell));
        nodes.copied().collect()
    }

    /// The map from the reference cell to a cell.
    pub fn map(&self, cell: usize) -> CellMap {
        let nodes = self.cell(cell);
        CellMap::new(self.kind, |i| self.nodes[nodes[i] as usize])
    }

    /// Mean of the node positions of a cell.
    pub fn centre(&self, cell: usize) -> Point {
        self.map(cell).centre()
    }

    /// Node numbers of a facet.
    pub fn facet_nodes(&self, facet: Facet) -> impl Iterator<Item = usize> + '_ {
        let cell = self.cell(facet.cell);
        self.kind.facets()[facet.local]
            .iter()
            .map(move |&i| cell[i] as usize)
    }

    /// Sorted numbers of the nodes on a side; includes both nodes of a pair where a crack leaves through the side.
    pub fn side_nodes(&self, side: &str) -> Vec<usize> {
        let mut nodes: Vec<usize> = self
            .sides
            .get(side)
            .into_iter()
            .flatten()
            .flat_map(|&facet| self.facet_nodes(facet))
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// The node at a point, within 1e-9 of the body's size; of a pair on a crack the one on side 2.
    pub fn node_at(&self, x: &Point) -> Option<usize> {
        let (size, _) = self.extent();
        self.nodes
            .iter()
            .position(|node| (0..3).all(|a| (node[a] - x[a]).abs() <= 1e-9 * size))
    }

    /// Shortest cell edge at every node [m]: the local length to which distances are compared.
    pub fn node_sizes(&self) -> Vec<f64> {
        let mut size = vec![f64::INFINITY; self.nodes.len()];
        for cell in 0..self.cell_count() {
            let nodes = self.cell(cell);
            for &[i, j] in self.kind.edges() {
                let (a, b) = (nodes[i] as usize, nodes[j] as usize);
                let length = norm(&sub(&self.nodes[a], &self.nodes[b]));
                size[a] = size[a].min(length);
                size[b] = size[b].min(length);
            }
        }
        size
    }

    /// Shortest cell edge [m].
    pub fn smallest_edge(&self) -> f64 {
        self.node_sizes().into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Its lengths, gathered from all cells.
    pub fn lengths(&self) -> Lengths {
        let of_nodes = self.node_sizes();
        Lengths {
            smallest: of_nodes.iter().copied().fold(f64::INFINITY, f64::min),
            of_nodes,
            extent: self.extent(),
            rounding: self.rounding(),
        }
    }

    /// Boxes of the cells, larger by three of their longest edges: what may touch a cell or its neighbours.
    pub fn surroundings(&self) -> &Boxes {
        self.surroundings.get_or_init(|| {
            let maps = (0..self.cell_count()).map(|cell| self.map(cell));
            Boxes::new(maps.map(|map| around(map.iter(), 3.0 * map.longest_edge())))
        })
    }

    /// Rounding of positions: what differences of the coordinates they were stated in carry [m].
    pub fn rounding(&self) -> f64 {
        /// Units in the last place: of a grid line, of a point of a crack, of their difference.
        const UNITS: f64 = 8.0;
        let stated = |x: &Point| [0, 1, 2].map(|a| (x[a] + self.origin[a]).abs());
        let all = self.nodes.iter().flat_map(stated);
        UNITS * f64::EPSILON * all.fold(0.0, f64::max)
    }

    /// Lowest and highest coordinates [m].
    pub fn extents(&self) -> [Point; 2] {
        around(&self.nodes, 0.0)
    }

    /// Half the diagonal of the bounding box [m], and its centre.
    pub fn extent(&self) -> (f64, Point) {
        let [low, high] = self.extents();
        let half = |sign: f64| [0, 1, 2].map(|a| 0.5 * (high[a] + sign * low[a]));
        (norm(&half(-1.0)), half(1.0))
    }
}
