//! Corners: where straight arms of a plane body bend or end on each other, and their branch functions.
//!
//! n arms part the body around their common end into n wedges. The displacement in each is singular there in a way of its
//! own, by what sticks, slides and opens; the functions of a tip stand for all of it. Those of arm k,
//!
//! ```text
//!   g⁽ᵏ⁾ = √r { sin θ/2, cos θ/2, sin θ/2 sin θ, cos θ/2 sin θ },     θ from the line ahead of arm k
//! ```
//!
//! are those of any other arm, turned, with a sign that changes across arm k: n sets span four functions on every wedge. Near
//! a node beside which m < n arms run m + 1 of them do, and the others would be the same functions once more.
//!
//! With a ramp two relations tie the functions of every wedge, as at a tip (`stiffness::orthonormal`): g₃ and g₄ are left out at
//! the node that lies deepest in it. Without a node deep enough there is no ramp. Two or three arms: at crossings, where
//! nothing ends, the pieces of the supports suffice.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use crate::cut::crack::{End, Geometry, Tip};
use crate::cut::placement::cells_at;
use crate::geometry::curve::{Curve, turned};
use crate::geometry::polygon::{meets, segment_distance};
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, add_scaled, norm, sub, unit};

use super::{SHARE, SHORTEST, SLENDER, SLENDEREST, Search, Zone};

/// A node nearer to an arm than this, in edges, is not deep in a wedge: what is left out there is missed elsewhere.
const DEEP: f64 = 0.7;

/// A place where arms with branch functions bend or meet.
#[derive(Debug, Clone)]
pub struct Corner {
    /// Position [m].
    pub x: Point,
    /// Its arms.
    pub arms: Vec<usize>,
    /// Shortest edge of the mesh around it [m].
    pub size: f64,
}

/// The branch functions of a corner.
pub(super) struct CornerFunctions {
    pub corner: Corner,
    /// By arm.
    pub frames: Vec<TipFrame>,
    /// Cells around it.
    pub cells: Vec<usize>,
    /// Its nodes.
    pub zone: Zone,
    /// Node, arm in the order of the frames, and how many of the functions.
    pub functions: Vec<(u32, usize, u8)>,
}

impl Search<'_> {
    /// The corners that can carry functions.
    pub(super) fn corners(&self) -> Vec<CornerFunctions> {
        let mut at: BTreeMap<[u64; 3], Vec<(usize, usize)>> = BTreeMap::new();
        for (index, arm) in self.arms.iter().enumerate() {
            let ends = [arm.path.first(), arm.path.last()];
            for (end, vertex) in ends.into_iter().enumerate() {
                if let (End::Bend | End::Meeting, Some(vertex)) = (arm.ends[end], vertex) {
                    let place = at.entry(vertex.x.map(f64::to_bits)).or_default();
                    place.push((index, end));
                }
            }
        }
        let length = |arm: usize| self.arms[arm].range[1] - self.arms[arm].range[0];
        let mut places: Vec<Vec<(usize, usize)>> = at.into_values().collect();
        // The same order however the cracks are read, and wherever they lie.
        for ends in &mut places {
            ends.sort_by(|a, b| length(a.0).total_cmp(&length(b.0)));
        }
        let total = |ends: &[(usize, usize)]| ends.iter().map(|end| length(end.0)).sum::<f64>();
        places.sort_by(|a, b| total(a).total_cmp(&total(b)));
        let places = places.iter().filter(|ends| (2..=3).contains(&ends.len()));
        places.filter_map(|ends| self.corner(ends)).collect()
    }

    /// The functions of the arms with these ends in one place, if there is room for them.
    fn corner(&self, ends: &[(usize, usize)]) -> Option<CornerFunctions> {
        let arms: Vec<(TipFrame, f64)> = ends
            .iter()
            .map(|&(arm, end)| self.ending(arm, end))
            .collect::<Option<_>>()?;
        let x = arms[0].0.position;
        let cells = cells_at(self.mesh, &x);
        let diagonal = self.mesh.map(*cells.first()?).diagonal();
        let at_corner = self.mesh.nodes_of(cells.iter().copied());
        let own: Vec<usize> = ends.iter().map(|end| end.0).collect();
        let rooms = arms.iter().map(|arm| arm.1);
        let room = rooms.fold(f64::INFINITY, f64::min);
        let room = self.clearance(&x, &own, room);
        let tips = || own.iter().map(|&arm| self.arms[arm].tip);
        let longest = match tips().all(|tip| tip == Tip::Auto) {
            true => SLENDER,
            false => SLENDEREST,
        };
        let slender = |&cell: &usize| self.mesh.map(cell).aspect() > longest;
        if room <= SHORTEST * diagonal || cells.iter().any(slender) {
            return None;
        }
        let edges = cells.iter().map(|&cell| {
            let map = self.mesh.map(cell);
            let edge = |[i, j]: &[usize; 2]| norm(&sub(&map[*i], &map[*j]));
            map.kind
                .edges()
                .iter()
                .map(edge)
                .fold(f64::INFINITY, f64::min)
        });
        let size = edges.fold(f64::INFINITY, f64::min);
        let radii = tips().map(|tip| match tip {
            Tip::Radius(radius) => radius.min(room),
            Tip::Auto => SHARE * room,
            Tip::Branch | Tip::None => 0.0,
        });
        let radius = radii.fold(f64::INFINITY, f64::min);
        let mut surplus = Vec::new();
        let ramped = (radius > 0.0).then(|| self.within(radius, &arms, at_corner.clone()));
        let ramped = ramped.filter(|zone| zone.radius > 0.0);
        let deep = ramped.filter(|zone| match self.deepest(&arms, &zone.core, DEEP * size) {
            Some(nodes) => {
                surplus = nodes;
                true
            }
            None => false,
        });
        let around = || (radius > 0.0).then(|| self.near.nodes_around(&at_corner));
        let plain = |nodes: BTreeSet<u32>| {
            let cut_off = self.cut_off(&arms, &nodes);
            let blocked = self.any_blocked(&arms, &nodes, &cut_off);
            (!blocked).then(|| Zone {
                cut_off,
                ..Zone::plain(nodes)
            })
        };
        let zone = deep
            .or_else(|| around().and_then(plain))
            .or_else(|| plain(at_corner.clone()))?;
        let functions = self.sets(&arms, &zone.nodes, &surplus);
        Some(CornerFunctions {
            corner: Corner { x, arms: own, size },
            frames: arms.into_iter().map(|arm| arm.0).collect(),
            cells,
            functions,
            zone,
        })
    }

    /// Frame of a straight arm at an end that parts the cells there, and the length of the arm behind it [m].
    fn ending(&self, arm: usize, end: usize) -> Option<(TipFrame, f64)> {
        let crack = &self.arms[arm];
        let (range, path) = (self.range(arm), &crack.path);
        let straight = matches!(crack.geometry, Geometry::Curve(Curve::Chain(_)));
        let parted = range[end] == crack.range[end] && range[0] < range[1];
        if crack.tip == Tip::None || !straight || !parted {
            return None;
        }
        let (x, next) = match end {
            0 => (path.first()?.x, path.get(1)?.x),
            _ => (path.last()?.x, path.get(path.len() - 2)?.x),
        };
        let ahead = unit(&sub(&x, &next));
        let along = if end == 0 { ahead.map(|v| -v) } else { ahead };
        let mut frame = TipFrame::straight(arm, x, ahead, turned(&along));
        frame.shape = FrontShape::Corner;
        Some((frame, norm(&sub(&x, &next)).min(range[1] - range[0])))
    }

    /// The node of the ramp that lies deepest in each wedge; `None` where one has none farther than `least` from the arms.
    fn deepest(
        &self,
        arms: &[(TipFrame, f64)],
        core: &BTreeSet<u32>,
        least: f64,
    ) -> Option<Vec<u32>> {
        let x = arms[0].0.position;
        let angle = |v: &Point| v[1].atan2(v[0]).rem_euclid(TAU);
        let angles: Vec<f64> = arms
            .iter()
            .map(|(f, _)| angle(&f.ahead.map(|v| -v)))
            .collect();
        let mut found = vec![(least, None); arms.len()];
        for &node in core {
            let place = &self.mesh.nodes[node as usize];
            let own = angle(&sub(place, &x));
            let wedge = angles.iter().filter(|a| **a <= own).count() % arms.len();
            let far = |(f, room): &(TipFrame, f64)| {
                segment_distance(place, &x, &add_scaled(&x, -room, &f.ahead))
            };
            let depth = arms.iter().map(far).fold(f64::INFINITY, f64::min);
            if depth > found[wedge].0 {
                found[wedge] = (depth, Some(node));
            }
        }
        found.into_iter().map(|(_, node)| node).collect()
    }

    /// The functions of every node: those of the arms beside it, and of one more.
    fn sets(
        &self,
        arms: &[(TipFrame, f64)],
        nodes: &BTreeSet<u32>,
        surplus: &[u32],
    ) -> Vec<(u32, usize, u8)> {
        let beside = |node: u32, (frame, room): &(TipFrame, f64)| {
            let [p, q] = [0.0, -room].map(|s| add_scaled(&frame.position, s, &frame.ahead));
            let cells = self.near.cells_around(&BTreeSet::from([node]));
            cells.into_iter().any(|cell| {
                let map = self.mesh.map(cell);
                meets(&map, &p, &q, 1e-9 * map.diagonal())
            })
        };
        let mut functions = Vec::new();
        for &node in nodes {
            let count = if surplus.contains(&node) { 2 } else { 4 };
            let (mut own, others): (Vec<usize>, Vec<usize>) =
                (0..arms.len()).partition(|&arm| beside(node, &arms[arm]));
            own.extend(others.first());
            functions.extend(own.into_iter().map(|arm| (node, arm, count)));
        }
        functions
    }
}
