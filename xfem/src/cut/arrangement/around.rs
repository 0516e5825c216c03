//! The mesh next to cracks: its nodes, edges and cells by place, and how close two features are one.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::placement::reference_position;
use crate::geometry::boxes::{Boxes, around};
use crate::geometry::polygon::segment_foot;
use crate::geometry::{Point, add_scaled, dot, norm, sub};
use crate::mesh::{Lengths, Mesh};

use super::{DELTA, LINE, On, Vertex};

/// Nodes, edges and cells of a plane mesh that cracks may touch.
pub(super) struct Around<'a> {
    pub mesh: &'a Mesh,
    pub lengths: &'a Lengths,
    /// Edges, lower node first, ascending.
    edges: Vec<[u32; 2]>,
    edge_boxes: Boxes,
    nodes: Vec<u32>,
    node_boxes: Boxes,
    /// Cells by node, ascending.
    cells_of: BTreeMap<u32, Vec<usize>>,
    /// The largest distance at which two features are one [m].
    pub reach: f64,
}

impl<'a> Around<'a> {
    /// Next to some polylines [m].
    pub fn new(mesh: &'a Mesh, lengths: &'a Lengths, polylines: &[Vec<Point>]) -> Self {
        let mut cells: BTreeSet<usize> = BTreeSet::new();
        for w in polylines.iter().flat_map(|points| points.windows(2)) {
            let near = mesh.surroundings().meeting(&around(w, 0.0)).into_iter();
            cells.extend(near.filter(|&cell| {
                let map = mesh.map(cell);
                let centre = map.centre();
                // Snapping moves a crack by much less than the tenth.
                norm(&sub(&segment_foot(&centre, &w[0], &w[1]), &centre)) <= 1.1 * map.diagonal()
            }));
        }
        let mut edges: BTreeSet<[u32; 2]> = BTreeSet::new();
        let mut cells_of: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for &cell in &cells {
            let nodes = mesh.cell(cell);
            let own = mesh.kind.edges().iter();
            edges.extend(own.map(|&[i, j]| [nodes[i].min(nodes[j]), nodes[i].max(nodes[j])]));
            (nodes.iter()).for_each(|&node| cells_of.entry(node).or_default().push(cell));
        }
        let edges: Vec<[u32; 2]> = edges.into_iter().collect();
        let nodes: Vec<u32> = cells_of.keys().copied().collect();
        let at = |node: u32| mesh.nodes[node as usize];
        let sizes = nodes.iter().map(|&node| lengths.of_nodes[node as usize]);
        Around {
            edge_boxes: Boxes::new(edges.iter().map(|edge| around(&edge.map(at), 0.0))),
            node_boxes: Boxes::new(nodes.iter().map(|&node| [at(node); 2])),
            reach: DELTA * sizes.fold(lengths.smallest, f64::max),
            edges,
            nodes,
            cells_of,
            mesh,
            lengths,
        }
    }

    /// Position of a node [m].
    pub fn at(&self, node: u32) -> &'a Point {
        &self.mesh.nodes[node as usize]
    }

    /// Shortest edge at a node [m].
    pub fn size(&self, node: u32) -> f64 {
        self.lengths.of_nodes[node as usize]
    }

    fn edge_size(&self, [i, j]: [u32; 2]) -> f64 {
        self.size(i).min(self.size(j))
    }

    /// Edges that meet the box of some points, larger by `margin` [m].
    pub fn edges_near(
        &self,
        points: &[Point],
        margin: f64,
    ) -> impl Iterator<Item = [u32; 2]> + use<'_, 'a> {
        let found = self.edge_boxes.meeting(&around(points, margin));
        found.into_iter().map(|k| self.edges[k])
    }

    /// Those of them on the border of the body.
    pub fn sides_near(
        &self,
        points: &[Point],
        margin: f64,
    ) -> impl Iterator<Item = [u32; 2]> + use<'_, 'a> {
        let edges = self.edges_near(points, margin);
        edges.filter(|edge| self.is_side(edge))
    }

    /// Whether an edge lies on the border of the body.
    fn is_side(&self, edge: &[u32; 2]) -> bool {
        self.cells_with(edge).len() < 2
    }

    /// Nodes in that box.
    pub fn nodes_near(
        &self,
        points: &[Point],
        margin: f64,
    ) -> impl Iterator<Item = u32> + use<'_, 'a> {
        let found = self.node_boxes.meeting(&around(points, margin));
        found.into_iter().map(|k| self.nodes[k])
    }

    /// Cells with all of some nodes.
    pub fn cells_with(&self, nodes: &[u32]) -> Vec<usize> {
        let of = |node: &u32| self.cells_of.get(node).map_or(&[][..], Vec::as_slice);
        let Some((first, others)) = nodes.split_first() else {
            return Vec::new();
        };
        let all = |cell: &usize| others.iter().all(|node| of(node).contains(cell));
        of(first).iter().copied().filter(all).collect()
    }

    /// Whether an edge, lower node first, is one of the mesh.
    pub fn has_edge(&self, edge: &[u32; 2]) -> bool {
        self.edges.binary_search(edge).is_ok()
    }

    /// The vertex at a place: the node or on the edge that is that close.
    pub fn vertex(&self, x: &Point) -> Vertex {
        let away = |y: &Point| norm(&sub(x, y));
        let nodes = self.nodes_near(&[*x], self.reach);
        let nodes = nodes.filter(|&node| away(self.at(node)) <= DELTA * self.size(node));
        if let Some(node) = nodes.min_by(|a, b| away(self.at(*a)).total_cmp(&away(self.at(*b)))) {
            return self.node(node);
        }
        let feet = self.edges_near(&[*x], self.reach).map(|edge| {
            let [p, q] = edge.map(|node| self.at(node));
            (edge, segment_foot(x, p, q))
        });
        let feet = feet.filter(|(edge, foot)| away(foot) <= DELTA * self.edge_size(*edge));
        if let Some((edge, foot)) = feet.min_by(|a, b| away(&a.1).total_cmp(&away(&b.1))) {
            // A place that was put there keeps its digits.
            let x = if away(&foot) <= self.lengths.rounding {
                *x
            } else {
                foot
            };
            return self.on_edge(edge, x);
        }
        let cell = (self.mesh.surroundings().meeting(&[*x; 2]).into_iter())
            .find(|&cell| reference_position(self.mesh, cell, x, 0.0).is_some());
        let sizes = cell.map(|cell| self.mesh.cell(cell).iter().map(|&node| self.size(node)));
        let size = sizes.map(|sizes| sizes.fold(f64::INFINITY, f64::min));
        Vertex {
            x: *x,
            on: cell.map_or(On::Outside, On::Cell),
            size: size.unwrap_or(self.lengths.smallest),
        }
    }

    /// The vertex on a node.
    pub fn node(&self, node: u32) -> Vertex {
        Vertex {
            x: *self.at(node),
            on: On::Node(node),
            size: self.size(node),
        }
    }

    /// A vertex on an edge.
    pub fn on_edge(&self, edge: [u32; 2], x: Point) -> Vertex {
        Vertex {
            x,
            on: On::Edge(edge),
            size: self.edge_size(edge),
        }
    }

    /// Cells whose closure holds a vertex.
    pub fn cells(&self, on: On) -> Vec<usize> {
        match on {
            On::Node(node) => self.cells_with(&[node]),
            On::Edge(edge) => self.cells_with(&edge),
            On::Cell(cell) => vec![cell],
            On::Outside => Vec::new(),
        }
    }

    /// Whether a vertex lies on the border of the body or beyond it.
    pub fn is_outer(&self, on: On) -> bool {
        match on {
            On::Node(node) => {
                let cells = self.cells_with(&[node]);
                let edges = cells.iter().flat_map(|&cell| self.edges_of(cell));
                let mut own = edges.filter(|edge| edge.contains(&node));
                own.any(|edge| self.is_side(&edge))
            }
            On::Edge(edge) => self.is_side(&edge),
            On::Cell(_) => false,
            On::Outside => true,
        }
    }

    fn edges_of(&self, cell: usize) -> impl Iterator<Item = [u32; 2]> {
        let nodes = self.mesh.cell(cell);
        let edges = self.mesh.kind.edges().iter();
        edges.map(|&[i, j]| [nodes[i].min(nodes[j]), nodes[i].max(nodes[j])])
    }

    /// How far along a segment p q a place lies that the segment runs through, in parts of it; `size`: shortest edge there [m].
    pub fn runs_through([p, q]: [&Point; 2], x: &Point, size: f64) -> Option<f64> {
        let d = sub(q, p);
        let t = dot(&sub(x, p), &d) / dot(&d, &d);
        let foot = add_scaled(p, t, &d);
        (t > 0.0 && t < 1.0 && norm(&sub(x, &foot)) <= LINE * DELTA * size).then_some(t)
    }
}
