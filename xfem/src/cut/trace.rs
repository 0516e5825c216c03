//! Where the arms of 2D cracks cross the edges and nodes of a mesh, and their chains through the cells.
//!
//! Every place on a mesh edge is decided once and shared, to the last bit, by all cells and arms that meet there. What is
//! closer to a node, an edge or another place than rounding lies on it.

use std::collections::{BTreeMap, BTreeSet};

use crate::geometry::clip::{crossing, snapped};
use crate::geometry::curve::turned;
use crate::geometry::polygon::segment_foot;
use crate::geometry::{Point, add_scaled, dot, norm, sub, unit};
use crate::mesh::Mesh;

use super::crack::{Crack, End, PathVertex};
use super::near::{Near, TIP_ON_EDGE};

/// A vertex of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainVertex {
    /// Position [m].
    pub x: Point,
    /// Ends of the mesh edge it lies on, lower number first; equal at a node; `None` inside a cell.
    pub nodes: Option<[u32; 2]>,
}

/// The way of an arm through one cell.
#[derive(Debug, Clone)]
pub struct Chain {
    /// Arm.
    pub arm: usize,
    /// Its vertices, in the direction of the arm.
    pub vertices: Vec<ChainVertex>,
    /// Whether the first and the last vertex are free ends inside the cell.
    pub tip: [bool; 2],
    /// First and last abscissa [m].
    pub range: [f64; 2],
}

/// A free end inside the body.
#[derive(Debug, Clone)]
pub struct TracedTip {
    /// Arm.
    pub arm: usize,
    /// Which of its ends: 0 or 1.
    pub end: usize,
    /// Position [m].
    pub x: Point,
    /// Cells whose closure holds it.
    pub cells: Vec<usize>,
    /// Abscissa at which the arm crosses the border of the tip's cell; the tip's own on a mesh edge [m].
    pub entry: f64,
}

/// An arm that runs along a mesh edge, or whose way is lost.
#[derive(Debug, Clone, PartialEq)]
pub enum TraceError {
    /// Along an edge, near a place [m].
    AlongEdge(usize, Point),
    /// No cell joins two places [m] of an arm.
    Lost(usize, Point),
}

/// The arms of all 2D cracks in a mesh.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// Chains by cell.
    pub chains: BTreeMap<usize, Vec<Chain>>,
    /// Places on mesh edges (lower node first), from the lower node on.
    pub on_edges: BTreeMap<[u32; 2], Vec<Point>>,
    /// Free ends inside the body.
    pub tips: Vec<TracedTip>,
}

/// A place of an arm on its way.
#[derive(Debug, Clone, Copy)]
struct Stop {
    s: f64,
    vertex: ChainVertex,
}

impl Trace {
    /// Traces 2D arms.
    ///
    /// # Errors
    /// An arm along a mesh edge.
    pub fn new(mesh: &Mesh, arms: &[Crack]) -> Result<Self, TraceError> {
        let mut trace = Trace::default();
        if mesh.dim() != 2 || arms.is_empty() {
            return Ok(trace);
        }
        let near = Near::new(mesh, arms);
        // Where arms meet comes first: all of them take that place.
        for arm in arms {
            for (end, vertex) in arm.ends.iter().zip([arm.path.first(), arm.path.last()]) {
                if let (End::Meeting | End::Bend, Some(vertex)) = (end, vertex) {
                    trace.place(&near, &vertex.x);
                }
            }
        }
        for (index, arm) in arms.iter().enumerate() {
            trace.follow(&near, index, arm)?;
        }
        for (edge, places) in &mut trace.on_edges {
            let away = |x: &Point| norm(&sub(x, near.at(edge[0])));
            places.sort_by(|a, b| away(a).total_cmp(&away(b)));
        }
        Ok(trace)
    }

    /// The vertex at a place: on a node or an edge, if it is that close.
    fn place(&mut self, near: &Near<'_>, x: &Point) -> ChainVertex {
        let edges = near.edges_in([x[0], x[1]], [x[0], x[1]]);
        let nodes: BTreeSet<u32> = edges.iter().flatten().copied().collect();
        for node in nodes {
            if norm(&sub(x, near.at(node))) <= 4.0 * near.tolerance(node) {
                return self.vertex(near, [node, node], x);
            }
        }
        for edge in edges {
            let foot = segment_foot(x, near.at(edge[0]), near.at(edge[1]));
            if norm(&sub(x, &foot)) <= 4.0 * near.edge_tolerance(edge) {
                return self.vertex(near, edge, x);
            }
        }
        ChainVertex { x: *x, nodes: None }
    }

    /// The place on an edge, or the node: the known one if there is one that close.
    fn vertex(&mut self, near: &Near<'_>, nodes: [u32; 2], x: &Point) -> ChainVertex {
        if nodes[0] == nodes[1] {
            let x = *near.at(nodes[0]);
            return ChainVertex {
                x,
                nodes: Some(nodes),
            };
        }
        let known = self.on_edges.entry(nodes).or_default();
        let same = |p: &&Point| norm(&sub(p, x)) <= 4.0 * near.edge_tolerance(nodes);
        let x = known.iter().find(same).copied().unwrap_or_else(|| {
            known.push(*x);
            *x
        });
        ChainVertex {
            x,
            nodes: Some(nodes),
        }
    }

    /// Adds the chains of one arm.
    fn follow(&mut self, near: &Near<'_>, index: usize, arm: &Crack) -> Result<(), TraceError> {
        let (Some(first), Some(last)) = (arm.path.first(), arm.path.last()) else {
            return Ok(());
        };
        let mut stops = self.stops(near, arm);
        // The ends: on the nearest stop, or vertices of their own.
        let mut free = [false; 2];
        for (k, vertex) in [first, last].into_iter().enumerate() {
            let at = |stop: &Stop| (stop.s - vertex.s).abs();
            let nearest = stops.iter().copied().min_by(|a, b| at(a).total_cmp(&at(b)));
            if arm.ends[k] == End::Free {
                let size = |stop: &Stop| stop.vertex.nodes.map_or(0.0, |[i, _]| near.sizes[&i]);
                let here = nearest.filter(|stop| at(stop) <= TIP_ON_EDGE * size(stop));
                free[k] = here.is_none();
                let end = here.unwrap_or(Stop {
                    s: vertex.s,
                    vertex: ChainVertex {
                        x: vertex.x,
                        nodes: None,
                    },
                });
                stops.retain(|stop| {
                    if k == 0 {
                        stop.s >= end.s
                    } else {
                        stop.s <= end.s
                    }
                });
                if free[k] {
                    stops.push(end);
                } else {
                    self.add_tip(near, [index, k], &end, end.s);
                }
                continue;
            }
            let end = self.place(near, &vertex.x);
            if let Some(nodes) = end.nodes {
                // One place on this edge or node, however flat the arm crosses it.
                stops.retain(|stop| {
                    let same = stop.vertex.nodes.is_some_and(|own| {
                        own == nodes
                            || own.iter().all(|n| nodes.contains(n))
                            || nodes.iter().all(|n| own.contains(n))
                    });
                    at(stop) > 8.0 * near.edge_tolerance(nodes)
                        && !(same && at(stop) <= 1e-6 * near.sizes[&nodes[0]])
                });
            }
            stops.push(Stop {
                s: vertex.s,
                vertex: end,
            });
        }
        stops.sort_by(|a, b| a.s.total_cmp(&b.s));
        for pair in stops.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let tip = [
                free[0] && from.s == first.s && from.vertex.nodes.is_none(),
                free[1] && to.s == last.s && to.vertex.nodes.is_none(),
            ];
            if from.vertex == to.vertex {
                continue;
            }
            let Some(cell) = host(near, index, arm, [&from, &to])? else {
                continue;
            };
            let inner = arm.path.iter().filter(|v| {
                let small = 1e-9 * (to.s - from.s);
                v.s > from.s + small && v.s < to.s - small
            });
            let inner = inner.map(|v| ChainVertex {
                x: v.x,
                nodes: None,
            });
            let vertices = std::iter::once(from.vertex).chain(inner).chain([to.vertex]);
            let chain = Chain {
                arm: index,
                vertices: vertices.collect(),
                tip,
                range: [from.s, to.s],
            };
            self.chains.entry(cell).or_default().push(chain);
            for k in 0..2 {
                if tip[k] {
                    let (end, other) = if k == 0 { (from, to) } else { (to, from) };
                    let entry = match tip {
                        // Wholly inside the cell.
                        [true, true] => 0.5 * (from.s + to.s),
                        _ => other.s,
                    };
                    self.tips.push(TracedTip {
                        arm: index,
                        end: k,
                        x: end.vertex.x,
                        cells: vec![cell],
                        entry,
                    });
                }
            }
        }
        Ok(())
    }

    /// A tip on an edge or a node inside the body.
    fn add_tip(&mut self, near: &Near<'_>, [arm, end]: [usize; 2], stop: &Stop, entry: f64) {
        let Some(nodes) = stop.vertex.nodes else {
            return;
        };
        let cells = near.cells(nodes);
        if !near.is_on_border(nodes) {
            self.tips.push(TracedTip {
                arm,
                end,
                x: stop.vertex.x,
                cells,
                entry,
            });
        }
    }

    /// Where an arm crosses edges and nodes, each place once.
    fn stops(&mut self, near: &Near<'_>, arm: &Crack) -> Vec<Stop> {
        let mut stops: Vec<Stop> = Vec::new();
        let (Some(first), Some(last)) = (arm.path.first(), arm.path.last()) else {
            return stops;
        };
        for w in arm.path.windows(2) {
            let [a, b]: [PathVertex; 2] = [w[0], w[1]];
            let tangent = unit(&sub(&b.x, &a.x));
            let (normal, length) = (turned(&tangent), norm(&sub(&b.x, &a.x)));
            let level = |node: u32| {
                let phi = dot(&normal, &sub(near.at(node), &a.x));
                snapped(phi, near.tolerance(node))
            };
            let along = |x: &Point| dot(&tangent, &sub(x, &a.x));
            // Beyond a free end too: what lies that close before an edge lies on it, as behind it.
            let reach = |nodes: [u32; 2], end: bool, kind: End| match kind {
                End::Free if end => TIP_ON_EDGE * near.sizes[&nodes[0]],
                _ => near.edge_tolerance(nodes),
            };
            let mut push = |trace: &mut Self, nodes: [u32; 2], x: &Point| {
                let t = along(x);
                let before = reach(nodes, a.s == first.s, arm.ends[0]);
                let beyond = reach(nodes, b.s == last.s, arm.ends[1]);
                if t >= -before && t <= length + beyond {
                    let vertex = trace.vertex(near, nodes, x);
                    // A chord is shorter than its arc.
                    let s = a.s + t / length * (b.s - a.s);
                    stops.push(Stop { s, vertex });
                }
            };
            let [low, high] = [0, 1].map(|k| {
                let pick = [f64::min, f64::max][k];
                [0, 1].map(|c| pick(a.x[c], b.x[c]))
            });
            for [i, j] in near.edges_in(low, high) {
                let (p, q) = (near.at(i), near.at(j));
                let (f, g) = (level(i), level(j));
                if f * g < 0.0 {
                    push(self, [i, j], &crossing(p, f, q, g));
                }
                for (node, f) in [(i, f), (j, g)] {
                    if f == 0.0 {
                        push(self, [node, node], near.at(node));
                    }
                }
            }
        }
        // One place found twice: on the same edge, or at a node and on an edge that ends there, where the node stays.
        let same = |a: &Stop, b: &Stop| {
            let (Some(one), Some(two)) = (a.vertex.nodes, b.vertex.nodes) else {
                return false;
            };
            let meet = one.iter().all(|n| two.contains(n)) || two.iter().all(|n| one.contains(n));
            meet && b.s - a.s <= 8.0 * near.edge_tolerance(one)
        };
        let is_edge = |stop: &Stop| stop.vertex.nodes.is_none_or(|[i, j]| i != j);
        stops.sort_by(|a, b| a.s.total_cmp(&b.s));
        stops.dedup_by(|b, a| {
            let twice = same(a, b);
            if twice && is_edge(a) && !is_edge(b) {
                a.vertex = b.vertex;
            }
            twice
        });
        stops
    }
}

/// The cell in which an arm runs from one stop to the next; `None` outside of the body.
fn host(
    near: &Near<'_>,
    index: usize,
    arm: &Crack,
    stops: [&Stop; 2],
) -> Result<Option<usize>, TraceError> {
    let s = 0.5 * (stops[0].s + stops[1].s);
    let middle = at(&arm.path, s);
    let keys: Vec<[u32; 2]> = stops.iter().filter_map(|stop| stop.vertex.nodes).collect();
    let candidates: Vec<usize> = match keys.as_slice() {
        [] => near.cells_of.values().flatten().copied().collect(),
        [one] => near.cells(*one),
        [one, two, ..] => {
            let others = near.cells(*two);
            let both = near.cells(*one).into_iter().filter(|c| others.contains(c));
            both.collect()
        }
    };
    let deep = candidates
        .into_iter()
        .map(|cell| (near.depth(cell, &middle), cell));
    let best = deep.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    // Between two places of one edge, without a bend.
    let nodes: BTreeSet<u32> = keys.iter().flatten().copied().collect();
    let along_edge = keys.len() == 2
        && match nodes.into_iter().collect::<Vec<u32>>()[..] {
            [_] => true,
            [i, j] => near.edges.contains(&[i, j]),
            _ => false,
        };
    let mut path = arm.path.iter();
    let straight = !path.any(|v| v.s > stops[0].s && v.s < stops[1].s);
    match best {
        Some((depth, cell)) => {
            let size = near.mesh.map(cell).longest_edge();
            if depth < -1e-9 * size {
                Ok(None)
            } else if straight && along_edge {
                Err(TraceError::AlongEdge(index, middle))
            } else {
                Ok(Some(cell))
            }
        }
        // Out of the body and in again, or the way is lost.
        None => {
            let inside = near.cells_of.values().flatten();
            let mut inside = inside.map(|&cell| near.depth(cell, &middle));
            if inside.any(|depth| depth > 0.0) {
                return Err(TraceError::Lost(index, middle));
            }
            Ok(None)
        }
    }
}

/// Point of a path at an abscissa.
fn at(path: &[PathVertex], s: f64) -> Point {
    let last = path.len().saturating_sub(2);
    let i = path
        .partition_point(|v| v.s <= s)
        .saturating_sub(1)
        .min(last);
    let (a, b) = (&path[i], &path[i + 1]);
    add_scaled(&a.x, (s - a.s) / (b.s - a.s), &sub(&b.x, &a.x))
}
