//! A plane cell divided by the chains of the arms that run through it: the rings of a planar graph.
//!
//! Corners of the cell, places of cracks and the segments between them are a graph; its rings are the regions. A free end goes on
//! straight to the first thing it meets, one inside the cell to both sides: the two regions beside such an extension are one. What
//! leads nowhere divides nothing.

use std::collections::BTreeMap;

use crate::geometry::clip::Side;
use crate::geometry::curve::turned;
use crate::geometry::polygon::{self, Polygon};
use crate::geometry::{Point, add_scaled, cross, dot, norm, root, sub, unite};
use crate::mesh::Mesh;

use super::arrangement::{Arrangement, Chain, DELTA, On};
use super::part::{Face, FaceCorner, Part};
use super::partition::{BorderPiece, Partition, PartitionError};

/// What an edge of the graph is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// Part of a local edge of the cell, which lies to its left.
    Border(usize),
    /// Part of an arm with the direction of that, and its side to the left.
    Face(usize, Point, Side),
    /// Beyond the free end of an arm, whose side this is to the left.
    Beyond(usize, Side),
}

#[derive(Debug, Clone, Copy)]
struct Edge {
    ends: [usize; 2],
    kind: Kind,
}

/// The graph of a cell.
struct Graph {
    points: Vec<Point>,
    /// Local nodes that a point of the border lies between, equal at a node.
    on: Vec<Option<[usize; 2]>>,
    edges: Vec<Edge>,
    /// Corners of the cell and places of cracks on its border, counter-clockwise, with the local edge that begins there.
    border: Vec<(usize, usize)>,
    /// Size of the cell [m].
    size: f64,
}

/// A free end: its arm, the side of that to the left of what lies ahead, where it is and where it points.
struct Free {
    arm: usize,
    left: Side,
    place: usize,
    ahead: Point,
}

/// Divides a cell by chains; `straight`: one number for the arms that make one line.
///
/// # Errors
/// Pieces that do not fit together.
pub fn divide(
    mesh: &Mesh,
    cell: usize,
    arrangement: &Arrangement,
    chains: &[&Chain],
    straight: impl Fn(usize) -> usize,
) -> Result<Partition, PartitionError> {
    let (mut graph, mut free) = Graph::new(mesh, cell, arrangement, chains);
    // The nearest first, then by place: by no order of names.
    let key = |graph: &Graph, end: &Free| graph.ahead(end).map_or(f64::INFINITY, |hit| hit.0);
    free.sort_by(|a, b| {
        let [x, y] = [a, b].map(|end| graph.points[end.place]);
        let by_place = x[0].total_cmp(&y[0]).then(x[1].total_cmp(&y[1]));
        key(&graph, a).total_cmp(&key(&graph, b)).then(by_place)
    });
    for end in &free {
        graph.extend(end)?;
    }
    let dropped = graph.prune();
    let mut partition = graph.rings(cell, straight)?;
    let areas = partition
        .parts
        .iter()
        .map(|part| polygon::area(&part.polygon));
    let area: f64 = areas.sum();
    let whole = polygon::area(&mesh.map(cell));
    if (area - whole).abs() > 1e-11 * whole {
        return Err(PartitionError::Muddle);
    }
    partition.dropped = dropped;
    Ok(partition)
}

/// A node of the cell, or a vertex of the arrangement elsewhere.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Node(u32),
    Vertex(usize),
}

impl Graph {
    fn new(
        mesh: &Mesh,
        cell: usize,
        arrangement: &Arrangement,
        chains: &[&Chain],
    ) -> (Self, Vec<Free>) {
        let (map, nodes) = (mesh.map(cell), mesh.cell(cell));
        let mut graph = Graph {
            points: Vec::new(),
            on: Vec::new(),
            edges: Vec::new(),
            border: Vec::new(),
            size: map.diagonal(),
        };
        let mut known: BTreeMap<Key, usize> = BTreeMap::new();
        for i in 0..map.len() {
            let j = (i + 1) % map.len();
            let mut put = |key: Key, x: Point, on: [usize; 2]| {
                known.insert(key, graph.points.len());
                graph.border.push((graph.points.len(), i));
                graph.points.push(x);
                graph.on.push(Some(on));
            };
            put(Key::Node(nodes[i]), map[i], [i, i]);
            let on = arrangement.on_edge([nodes[i], nodes[j]]);
            let mut put_on = |(vertex, x)| put(Key::Vertex(vertex), x, [i, j]);
            if nodes[i] > nodes[j] {
                on.rev().for_each(&mut put_on);
            } else {
                on.for_each(&mut put_on);
            }
        }
        for (k, &(from, edge)) in graph.border.iter().enumerate() {
            let to = graph.border[(k + 1) % graph.border.len()].0;
            graph.edges.push(Edge {
                ends: [from, to],
                kind: Kind::Border(edge),
            });
        }
        let mut free = Vec::new();
        for chain in chains {
            let places: Vec<usize> = (chain.vertices.iter())
                .map(|v| {
                    let key = match arrangement.vertices[v.vertex].on {
                        On::Node(node) => Key::Node(node),
                        _ => Key::Vertex(v.vertex),
                    };
                    *known.entry(key).or_insert_with(|| {
                        graph.points.push(v.x);
                        graph.on.push(None);
                        graph.points.len() - 1
                    })
                })
                .collect();
            // From the border to a free end.
            let back = chain.tip == [true, false];
            let mut own: Vec<Edge> = (places.windows(2).zip(&chain.directions))
                .map(|(w, direction)| match back {
                    true => ([w[1], w[0]], -1.0, direction),
                    false => ([w[0], w[1]], 1.0, direction),
                })
                .map(|(ends, left, direction)| Edge {
                    ends,
                    kind: Kind::Face(chain.arm, *direction, left),
                })
                .collect();
            if back {
                own.reverse();
            }
            graph.edges.extend(own);
            let last = places.len() - 1;
            let directions = [
                chain.directions[0].map(|v| -v),
                chain.directions[chain.directions.len() - 1],
            ];
            for end in (0..2).filter(|&end| chain.tip[end]) {
                free.push(Free {
                    arm: chain.arm,
                    left: [-1.0, 1.0][end],
                    place: places[[0, last][end]],
                    ahead: directions[end],
                });
            }
        }
        (graph, free)
    }

    /// What lies straight ahead of a free end: how far, in which edge, where.
    fn ahead(
        &self,
        &Free {
            place: from, ahead, ..
        }: &Free,
    ) -> Option<(f64, usize, Point)> {
        let x = &self.points[from];
        let hit = |(k, edge): (usize, &Edge)| {
            let [p, q] = edge.ends.map(|i| &self.points[i]);
            let [f, g] = [p, q].map(|y| cross(&ahead, &sub(y, x))[2]);
            if edge.ends.contains(&from) || f * g > 0.0 || f == g {
                return None;
            }
            let place = add_scaled(p, f / (f - g), &sub(q, p));
            let t = dot(&sub(&place, x), &ahead);
            (t > 0.0).then_some((t, k, place))
        };
        let hits = self.edges.iter().enumerate().filter_map(hit);
        hits.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Leads a free end to what lies ahead.
    fn extend(&mut self, end: &Free) -> Result<(), PartitionError> {
        let (_, k, x) = self.ahead(end).ok_or(PartitionError::Muddle)?;
        let Edge { ends: [p, q], kind } = self.edges[k];
        let there = |i: &&usize| norm(&sub(&self.points[**i], &x)) <= DELTA * self.size;
        let place = match [p, q].iter().find(there) {
            Some(&place) => place,
            None => {
                let place = self.points.len();
                self.points.push(x);
                self.on.push(match kind {
                    Kind::Border(edge) => Some([edge, (edge + 1) % 4]),
                    _ => None,
                });
                self.edges[k].ends = [p, place];
                self.edges.push(Edge {
                    ends: [place, q],
                    kind,
                });
                place
            }
        };
        self.edges.push(Edge {
            ends: [end.place, place],
            kind: Kind::Beyond(end.arm, end.left),
        });
        Ok(())
    }

    /// Takes out what leads nowhere; the arms it belongs to.
    fn prune(&mut self) -> Vec<usize> {
        let mut dropped = Vec::new();
        loop {
            let mut degree = vec![0; self.points.len()];
            let mut parent: Vec<usize> = (0..self.points.len()).collect();
            for edge in &self.edges {
                edge.ends.iter().for_each(|&i| degree[i] += 1);
                unite(&mut parent, edge.ends[0], edge.ends[1]);
            }
            let border = root(&mut parent, 0);
            let count = self.edges.len();
            self.edges.retain(|edge| {
                let loose = edge.ends.iter().any(|&i| degree[i] < 2);
                let kept = !loose && root(&mut parent, edge.ends[0]) == border;
                if let (false, Kind::Face(arm, ..)) = (kept, edge.kind) {
                    dropped.push(arm);
                }
                kept
            });
            if self.edges.len() == count {
                dropped.sort_unstable();
                dropped.dedup();
                return dropped;
            }
        }
    }

    /// The regions to the left of all edges, and what lies between them.
    fn rings(
        &self,
        cell: usize,
        straight: impl Fn(usize) -> usize,
    ) -> Result<Partition, PartitionError> {
        // Halves 2k and 2k + 1 of edge k, along it and back.
        let ends = |half: usize| {
            let [from, to] = self.edges[half / 2].ends;
            if half.is_multiple_of(2) {
                [from, to]
            } else {
                [to, from]
            }
        };
        let angle = |half: usize| {
            let [from, to] = ends(half);
            let d = sub(&self.points[to], &self.points[from]);
            d[1].atan2(d[0])
        };
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); self.points.len()];
        for half in 0..2 * self.edges.len() {
            around[ends(half)[0]].push(half);
        }
        for halves in &mut around {
            halves.sort_by(|a, b| angle(*a).total_cmp(&angle(*b)));
        }
        // The next half of a ring to the left: the one just clockwise of the way back.
        let next = |half: usize| {
            let halves = &around[ends(half)[1]];
            let back = halves.iter().position(|&other| other == half ^ 1)?;
            Some(halves[(back + halves.len() - 1) % halves.len()])
        };
        const NONE: usize = usize::MAX;
        let mut ring_of = vec![NONE; 2 * self.edges.len()];
        let mut parts: Vec<Part> = Vec::new();
        // Those to the left of arms first, then those to the right, then a cell that nothing divides.
        let halves = |side: usize| (0..self.edges.len()).map(move |k| 2 * k + side);
        let is_face = |half: &usize| matches!(self.edges[half / 2].kind, Kind::Face(..));
        let is_outer =
            |half: &usize| half % 2 == 1 && matches!(self.edges[half / 2].kind, Kind::Border(_));
        let faces = [0, 1]
            .into_iter()
            .flat_map(|side| halves(side).filter(is_face));
        let others = (0..ring_of.len()).filter(|half| !is_outer(half));
        for first in faces.chain(others) {
            if ring_of[first] != NONE {
                continue;
            }
            let mut ring = Vec::new();
            let mut half = first;
            loop {
                ring_of[half] = parts.len();
                ring.push(half);
                half = next(half).ok_or(PartitionError::Muddle)?;
                if half == first {
                    break;
                }
                if ring_of[half] != NONE {
                    return Err(PartitionError::Muddle);
                }
            }
            parts.push(Part {
                polygon: self.polygon(&ring, |half| ends(half)[0]),
                ..Part::default()
            });
        }
        let mut partition = Partition::default();
        let mut beside = Vec::new();
        for (k, edge) in self.edges.iter().enumerate() {
            let regions = [ring_of[2 * k], ring_of[2 * k + 1]];
            if let Kind::Border(_) = edge.kind {
                continue;
            }
            if regions.contains(&NONE) {
                return Err(PartitionError::Muddle);
            }
            match edge.kind {
                Kind::Face(arm, along, left) => {
                    let corner = |i: usize| -> FaceCorner { (self.points[i], self.on[i]) };
                    let (mut corners, mut regions) = (edge.ends.map(corner), regions);
                    if left < 0.0 {
                        corners.reverse();
                        regions.reverse();
                    }
                    partition.faces.push(Face {
                        crack: arm,
                        corners: corners.to_vec(),
                        sides: regions.map(|region| (cell, region)),
                        frame: [turned(&along), along, [0.0, 0.0, 1.0]],
                    });
                    beside.push((arm, regions));
                }
                Kind::Beyond(arm, side) => {
                    partition.joined.push(regions);
                    partition.beyond.push(edge.ends.map(|i| self.points[i]));
                    let [left, right] = regions;
                    beside.push((
                        arm,
                        if side > 0.0 {
                            [left, right]
                        } else {
                            [right, left]
                        },
                    ));
                }
                Kind::Border(_) => {}
            }
        }
        let starts: BTreeMap<usize, usize> = (self.edges.iter().enumerate())
            .filter(|(_, edge)| matches!(edge.kind, Kind::Border(_)))
            .map(|(k, edge)| (edge.ends[0], k))
            .collect();
        for &(place, edge) in &self.border {
            let (mut from, mut at_place) = (place, true);
            loop {
                let k = starts[&from];
                let to = self.edges[k].ends[1];
                partition.border.push(BorderPiece {
                    edge,
                    ends: [from, to].map(|i| self.points[i]),
                    region: ring_of[2 * k],
                    at_place,
                });
                // On to the next place.
                if self.border.iter().any(|other| other.0 == to) {
                    break;
                }
                (from, at_place) = (to, false);
            }
        }
        tell_sides(&mut parts, &beside, straight);
        partition.parts = parts;
        Ok(partition)
    }

    /// The corners of a ring: first those that follow a crack on the longest part of the border. Collapsed rules crowd at the first
    /// corner, where nothing should be singular.
    fn polygon(&self, ring: &[usize], start: impl Fn(usize) -> usize) -> Polygon {
        let count = ring.len();
        let on_border = |k: usize| matches!(self.edges[ring[k % count] / 2].kind, Kind::Border(_));
        let run = |&k: &usize| (k..k + count).take_while(|&i| on_border(i)).count();
        let after_crack = (0..count).filter(|&k| on_border(k) && !on_border(k + count - 1));
        let first = after_crack
            .max_by_key(|k| (run(k), count - k))
            .map_or(0, |k| k + 1);
        (first..first + count)
            .map(|k| self.points[start(ring[k % count])])
            .collect()
    }
}

/// Tells every region its side of the arms of the cell: of those that it borders on first, then of the others whose line keeps it from the
/// other side.
fn tell_sides(
    parts: &mut [Part],
    beside: &[(usize, [usize; 2])],
    straight: impl Fn(usize) -> usize,
) {
    let arms = beside.iter().map(|(arm, _)| (*arm, straight(*arm)));
    let arms: BTreeMap<usize, usize> = arms.collect();
    for &(arm, regions) in beside {
        for (region, side) in regions.into_iter().zip([1.0, -1.0]) {
            if parts[region].side(arm).is_none() {
                parts[region].sides.push((arm, side));
            }
        }
    }
    for part in parts.iter_mut() {
        part.sides.sort_by_key(|side| side.0);
    }
    for (&arm, &line) in &arms {
        let reached = |first: usize| {
            let own = beside.iter().filter(|(arm, _)| arms[arm] == line);
            let mut reached: Vec<bool> = vec![false; parts.len()];
            own.for_each(|(_, regions)| reached[regions[first]] = true);
            loop {
                let others = beside.iter().filter(|(arm, _)| arms[arm] != line);
                let open = others.map(|(_, regions)| regions);
                let fresh = open
                    .flat_map(|&[a, b]| [(a, b), (b, a)])
                    .find(|&(a, b)| reached[a] && !reached[b]);
                match fresh {
                    Some((_, b)) => reached[b] = true,
                    None => return reached,
                }
            }
        };
        let [one, two] = [reached(0), reached(1)];
        for (region, part) in parts.iter_mut().enumerate() {
            if part.side(arm).is_none() && one[region] != two[region] {
                part.sides.push((arm, if one[region] { 1.0 } else { -1.0 }));
            }
        }
    }
}
