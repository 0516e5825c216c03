//! A 2D cell divided by the chains of the arms that run through it.
//!
//! Polygons are cut along chains whose ends are corners of theirs; a chain that ends on another waits until that is in its
//! place. A chain with a free end goes on straight to the border of its polygon, one inside the cell to both sides: the two
//! parts beside such an extension are one. What leads nowhere divides nothing.

mod pending;

use crate::geometry::clip::Side;
use crate::geometry::polygon::{self, Polygon};
use crate::geometry::{Point, add_scaled, cross, dot, sub, unit};
use crate::mesh::Mesh;
use crate::mesh::cell::CellMap;

use self::pending::Pending;
use super::crack::Crack;
use super::part::{Face, FaceCorner, Part};
use super::partition::{Partition, PartitionError};
use super::trace::{Chain, Trace};

/// Points closer than this are one, in sizes of the cell.
const HERE: f64 = 1e-12;

/// Free ends shorter than this divide nothing, in sizes of the cell: √r jumps by 1e-4 of what it does on a whole cell, over
/// 1e-8 of its length.
const SHORT: f64 = 1e-8;

/// A segment between two polygons, side 1 to its left.
struct Segment {
    arm: usize,
    ends: [Point; 2],
    /// Beyond the free end of its arm.
    extension: bool,
}

/// A polygon with the sides it lies on.
struct Region {
    polygon: Polygon,
    sides: Vec<(usize, Side)>,
}

/// A cell on its way to being divided.
struct Division {
    regions: Vec<Region>,
    segments: Vec<Segment>,
    /// Points of the border with the local nodes they lie between.
    border: Vec<FaceCorner>,
    /// Where extensions meet the border.
    hits: Vec<Point>,
    /// Size of the cell [m].
    size: f64,
}

/// Divides a cell by chains.
///
/// # Errors
/// Pieces that do not fit together.
pub fn divide(
    mesh: &Mesh,
    cell: usize,
    arms: &[Crack],
    trace: &Trace,
    chains: &[&Chain],
) -> Result<Partition, PartitionError> {
    let mut division = Division::new(mesh, cell, trace);
    let mut pending: Vec<Pending> = chains.iter().map(|chain| Pending::new(chain)).collect();
    let mut dropped: Vec<Pending> = Vec::new();
    loop {
        while division.insert(&mut pending)? || division.join(arms, &mut pending) {}
        // Free ends one by one: others may wait for their chains.
        let short = |chain: &Pending| chain.length() <= SHORT * division.size;
        let leads = |chain: &Pending| {
            if chain.loose {
                chain.vertices.len() == 2
            } else {
                chain.free && division.is_corner(chain.first())
            }
        };
        let next = pending
            .iter()
            .position(|chain| short(chain) || leads(chain));
        let Some(mut chain) = next.map(|i| pending.remove(i)) else {
            break;
        };
        if short(&chain) {
            dropped.push(chain);
        } else if division.part_at_extensions(&mut chain) {
            pending.push(chain);
        } else if chain.loose {
            let begun = division.begun(chain)?;
            division.extend(begun)?;
        } else {
            division.extend(chain)?;
        }
    }
    let mut partition = division.finish(cell, &mesh.map(cell))?;
    let lost = dropped.iter().chain(&pending).flat_map(|chain| &chain.arms);
    partition.dropped = lost.map(|arm| arm.0).collect();
    Ok(partition)
}

impl Division {
    fn new(mesh: &Mesh, cell: usize, trace: &Trace) -> Self {
        let (map, nodes) = (mesh.map(cell), mesh.cell(cell));
        let mut border: Vec<FaceCorner> = Vec::new();
        for i in 0..map.len() {
            let j = (i + 1) % map.len();
            border.push((map[i], Some([i, i])));
            let key = [nodes[i].min(nodes[j]), nodes[i].max(nodes[j])];
            let mut on: Vec<Point> = trace.on_edges.get(&key).cloned().unwrap_or_default();
            if nodes[i] > nodes[j] {
                on.reverse();
            }
            border.extend(on.into_iter().map(|x| (x, Some([i, j]))));
        }
        Division {
            regions: vec![Region {
                polygon: border.iter().map(|c| c.0).collect(),
                sides: Vec::new(),
            }],
            segments: Vec::new(),
            hits: Vec::new(),
            border,
            size: map.diagonal(),
        }
    }

    /// Local nodes that a point of the border lies between.
    fn local(&self, x: &Point) -> Option<[usize; 2]> {
        self.border.iter().find(|c| c.0 == *x)?.1
    }

    fn is_corner(&self, x: &Point) -> bool {
        self.regions.iter().any(|r| r.polygon.contains(x))
    }

    /// Joins two chains that wait for each other inside the cell, those of one crack first.
    fn join(&self, arms: &[Crack], pending: &mut Vec<Pending>) -> bool {
        // The ends that wait: place, crack.
        let ends = |chain: &Pending| {
            let number = |arm: &(usize, Side)| arms[arm.0].number;
            let first = (*chain.first(), chain.arms.first().map(number), false);
            let last = (*chain.last(), chain.arms.last().map(number), true);
            if chain.loose {
                Vec::new()
            } else if chain.free {
                vec![first]
            } else {
                vec![first, last]
            }
        };
        let mut best: Option<(bool, [(usize, bool); 2])> = None;
        for (i, one) in pending.iter().enumerate() {
            for (j, two) in pending.iter().enumerate().take(i) {
                for a in ends(one) {
                    for b in ends(two)
                        .into_iter()
                        .filter(|b| b.0 == a.0 && !self.is_corner(&b.0))
                    {
                        let same = a.1 == b.1;
                        if best.is_none_or(|(known, _)| same && !known) {
                            best = Some((same, [(i, a.2), (j, b.2)]));
                        }
                    }
                }
            }
        }
        let Some((_, [(i, at_last), (j, other_last)])) = best else {
            return false;
        };
        let mut one = pending.remove(i);
        let mut two = pending.remove(j);
        // A free end comes last, the common vertex in between.
        if !at_last {
            one.reverse();
        }
        if other_last {
            two.reverse();
        }
        if one.free {
            (one, two) = (two, one);
            one.reverse();
            two.reverse();
        }
        two.free |= one.free;
        one.vertices.extend(&two.vertices[1..]);
        one.arms.extend(two.arms);
        one.free = two.free;
        pending.push(one);
        true
    }

    /// Cuts along the chains that are ready; whether there were any.
    fn insert(&mut self, pending: &mut Vec<Pending>) -> Result<bool, PartitionError> {
        let mut progress = false;
        for chain in std::mem::take(pending) {
            // Where it touches what is there it falls into pieces.
            let end = chain.vertices.len() - 1;
            let inner = (1..end).filter(|&i| self.is_corner(&chain.vertices[i]));
            let bounds: Vec<usize> = std::iter::once(0).chain(inner).chain([end]).collect();
            for w in bounds.windows(2) {
                let piece = chain.piece(w[0], w[1]);
                if bounds.len() > 2 && piece.length() <= HERE * self.size {
                    continue;
                }
                if !piece.free && self.is_corner(piece.first()) && self.is_corner(piece.last()) {
                    self.cut(&piece, piece.vertices.len())?;
                    progress = true;
                } else {
                    pending.push(piece);
                }
            }
        }
        Ok(progress)
    }

    /// Cuts the polygon that a chain runs through; its segments from vertex `beyond` on are no faces, nor is the first of a
    /// loose one.
    fn cut(&mut self, chain: &Pending, beyond: usize) -> Result<(), PartitionError> {
        let (first, last) = (chain.first(), chain.last());
        let middle = add_scaled(first, 0.5, &sub(&chain.vertices[1], first));
        let hosts: Vec<usize> = (0..self.regions.len())
            .filter(|&r| {
                let polygon = &self.regions[r].polygon;
                polygon.contains(first) && polygon.contains(last)
            })
            .collect();
        let inside = |r: &&usize| polygon::contains(&self.regions[**r].polygon, &middle);
        let host = match hosts.as_slice() {
            [only] => Some(*only),
            several => several.iter().find(inside).copied(),
        };
        let host = host.ok_or(PartitionError::Muddle)?;
        let [left, right] = polygon::split(&self.regions[host].polygon, &chain.vertices)
            .ok_or(PartitionError::Muddle)?;
        let small = -1e-13 * self.size * self.size;
        if polygon::area(&left) < small || polygon::area(&right) < small {
            return Err(PartitionError::Muddle);
        }
        let sides = |sign: Side| {
            let mut sides = self.regions[host].sides.clone();
            for &(arm, side) in &chain.arms {
                if !sides.iter().any(|s| s.0 == arm) {
                    sides.push((arm, sign * side));
                }
            }
            sides
        };
        let [above, below] = [1.0, -1.0].map(sides);
        self.regions[host] = Region {
            polygon: left,
            sides: above,
        };
        self.regions.push(Region {
            polygon: right,
            sides: below,
        });
        for (i, (w, &(arm, side))) in chain.vertices.windows(2).zip(&chain.arms).enumerate() {
            let ends = if side > 0.0 {
                [w[0], w[1]]
            } else {
                [w[1], w[0]]
            };
            self.segments.push(Segment {
                arm,
                ends,
                extension: i + 1 >= beyond || chain.loose && i == 0,
            });
        }
        Ok(())
    }

    /// Gives a chain the places as vertices where it crosses what lies beyond free ends of others; whether there are any.
    fn part_at_extensions(&mut self, chain: &mut Pending) -> bool {
        let mut found = false;
        let mut i = 0;
        while i + 1 < chain.vertices.len() {
            let [p, q] = [chain.vertices[i], chain.vertices[i + 1]];
            let beyond = self.segments.iter().filter(|s| s.extension);
            let places = beyond.filter_map(|s| {
                Some((
                    polygon::crossed([&p, &q], [&s.ends[0], &s.ends[1]], HERE)?,
                    s.ends,
                ))
            });
            let nearest = places.min_by(|a, b| a.0.0.total_cmp(&b.0.0));
            if let Some(((_, x), ends)) = nearest {
                self.add_corner(ends, x);
                chain.vertices.insert(i + 1, x);
                chain.arms.insert(i, chain.arms[i]);
                found = true;
            }
            i += 1;
        }
        found
    }

    /// A loose chain from the border of its polygon on.
    fn begun(&mut self, mut chain: Pending) -> Result<Pending, PartitionError> {
        let first = *chain.first();
        let behind = unit(&sub(&first, &chain.vertices[1]));
        let hit = self.reached(&[first, *chain.last()], &first, &behind)?;
        chain.vertices.insert(0, hit);
        chain.arms.insert(0, chain.arms[0]);
        Ok(chain)
    }

    /// Cuts along a chain with a free end and straight on to the border of its polygon.
    fn extend(&mut self, mut chain: Pending) -> Result<(), PartitionError> {
        let tip = *chain.last();
        let ahead = unit(&sub(&tip, &chain.vertices[chain.vertices.len() - 2]));
        let hit = self.reached(&[*chain.first(), tip], &tip, &ahead)?;
        if hit == *chain.first() {
            return Err(PartitionError::Muddle);
        }
        let beyond = chain.vertices.len();
        if let Some(&(arm, side)) = chain.arms.last() {
            chain.arms.push((arm, side));
        }
        chain.vertices.push(hit);
        self.cut(&chain, beyond)
    }

    /// Where the ray from a point leaves the polygon that holds some points: a corner of it then.
    fn reached(
        &mut self,
        held: &[Point],
        from: &Point,
        ahead: &Point,
    ) -> Result<Point, PartitionError> {
        let holds =
            |r: &Region, x: &Point| r.polygon.contains(x) || polygon::contains(&r.polygon, x);
        let inside = |r: &&Region| held.iter().all(|x| holds(r, x));
        let host = (self.regions.iter().find(inside)).ok_or(PartitionError::Muddle)?;
        // Where the ray meets an edge p q: the nearest.
        let hits = polygon::edges(&host.polygon).filter_map(|(p, q)| {
            let [f, g] = [&p, &q].map(|x| cross(ahead, &sub(x, from))[2]);
            if f * g > 0.0 || f == g {
                return None;
            }
            let share = f / (f - g);
            let x = add_scaled(&p, share, &sub(&q, &p));
            let t = dot(&sub(&x, from), ahead);
            (t >= -HERE * self.size).then_some((t, share, x, [p, q]))
        });
        // Its own place only if it lies on the border and leads out.
        let here = |t: f64| t <= HERE * self.size;
        let nearest = hits.min_by(|a, b| here(a.0).cmp(&here(b.0)).then(a.0.total_cmp(&b.0)));
        let (_, share, x, [p, q]) = nearest.ok_or(PartitionError::Muddle)?;
        /// A hit this close to a corner, in parts of the edge, is the corner.
        const AT_CORNER: f64 = 1e-9;
        if share < AT_CORNER {
            return Ok(p);
        }
        if share > 1.0 - AT_CORNER {
            return Ok(q);
        }
        self.add_corner([p, q], x);
        Ok(x)
    }

    /// Makes a point on the edge p q a corner of the polygons on both sides of it.
    fn add_corner(&mut self, [p, q]: [Point; 2], x: Point) {
        for region in &mut self.regions {
            let count = region.polygon.len();
            let edge = (0..count).find(|&i| {
                let (a, b) = (region.polygon[i], region.polygon[(i + 1) % count]);
                (a, b) == (p, q) || (a, b) == (q, p)
            });
            if let Some(i) = edge {
                region.polygon.insert(i + 1, x);
            }
        }
        let parted = |ends: &[Point; 2]| *ends == [p, q] || *ends == [q, p];
        if let Some(segment) = self.segments.iter_mut().find(|s| parted(&s.ends)) {
            let last = segment.ends[1];
            segment.ends[1] = x;
            let rest = Segment {
                ends: [x, last],
                ..*segment
            };
            self.segments.push(rest);
        }
        if let (Some([a, b]), Some([c, d])) = (self.local(&p), self.local(&q)) {
            // Both on one edge of the cell: the point too.
            let edge = if a != b {
                [a, b]
            } else if c != d {
                [c, d]
            } else {
                [a, c]
            };
            // A chain that runs through the cell ends on two of them.
            if [a, b, c, d].iter().all(|node| edge.contains(node)) {
                self.border.push((x, Some(edge)));
                self.hits.push(x);
            }
        }
    }

    /// The parts and faces.
    fn finish(self, cell: usize, map: &CellMap) -> Result<Partition, PartitionError> {
        // A polygon lies to the left of its edges.
        let left_of = |from: &Point, to: &Point| {
            let runs = |r: &Region| polygon::edges(&r.polygon).any(|(p, q)| p == *from && q == *to);
            self.regions.iter().position(runs)
        };
        let (mut faces, mut joined, mut beyond) = (Vec::new(), Vec::new(), Vec::new());
        for segment in &self.segments {
            let [a, b] = &segment.ends;
            let (one, two) = (left_of(a, b), left_of(b, a));
            let (Some(one), Some(two)) = (one, two) else {
                return Err(PartitionError::Muddle);
            };
            if segment.extension {
                joined.push([one, two]);
                beyond.push(segment.ends);
            } else {
                faces.push(Face {
                    crack: segment.arm,
                    corners: vec![(*a, self.local(a)), (*b, self.local(b))],
                    sides: [(cell, one), (cell, two)],
                });
            }
        }
        let area: f64 = self.regions.iter().map(|r| polygon::area(&r.polygon)).sum();
        let whole = polygon::area(map);
        if (area - whole).abs() > 1e-11 * whole {
            return Err(PartitionError::Muddle);
        }
        let part = |r: Region| Part {
            sides: r.sides,
            polygon: r.polygon,
            tetrahedra: Vec::new(),
        };
        Ok(Partition {
            parts: self.regions.into_iter().map(part).collect(),
            faces,
            joined,
            beyond,
            border: self.border,
            hits: self.hits,
            dropped: Vec::new(),
        })
    }
}
