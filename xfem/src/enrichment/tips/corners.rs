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
//! With a ramp the shape functions sum to one over all cells of a wedge, that around a straight tip too, and its functions
//! become exactly dependent: with x, y ahead and across, Σ N_k x_k = x, Σ N_k y_k = y and
//!
//! ```text
//!   y (g₂ − g₃) − x g₄ = 0,     y (g₁ − g₄) + x g₃ = 0
//! ```
//!
//! Both relations are resolved by leaving out g₃ and g₄ at the node deepest in the wedge; without one deep enough there is no
//! ramp. One to four arms, others that end within their cells aside. A crack beside which another ends is parted at the foot of
//! that end: it is as singular there.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use crate::cut::arrangement::{BEND, On, TracedTip, WITHIN};
use crate::cut::crack::{End, Geometry, Tip};
use crate::geometry::boxes::around;
use crate::geometry::curve::{Curve, turned};
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, dot, norm, sub, unit};

use super::ends::Ending;
use super::{SHORTEST, SLENDER, Search, Tips, Zone, branches};

/// A node nearer to an arm than this, in edges, is not deep in a wedge: what is left out there is missed elsewhere.
const DEEP: f64 = 0.7;

/// Most arms with functions of a corner.
const MOST: usize = 4;

/// An arm shorter than this, in edges, may go without functions of the corner where those would jump beyond its tip.
const SHORT: f64 = 2.0;

/// One shorter than this, in edges, has no multipliers of its own there: the displacement could not balance them.
const LONG: f64 = 0.3;

/// A place where arms with branch functions bend or meet.
#[derive(Debug, Clone)]
pub struct Corner {
    /// Position [m].
    pub x: Point,
    /// Its arms that are long enough for multipliers of their own.
    pub long: Vec<usize>,
    /// Shortest edge of the mesh around it [m].
    pub size: f64,
}

impl Corner {
    /// Distance of the second multipliers of its arms [m].
    pub fn second(&self) -> f64 {
        /// In edges of the mesh: answers are alike from 0.05 to 0.15, at 0.3 the faces overlap.
        const SECOND: f64 = 0.1;
        SECOND * self.size
    }
}

/// An arm and which of its ends, 0 or 1.
type ArmEnd = (usize, usize);

impl Search<'_> {
    /// Adds the functions of the corners that have room for them.
    pub(super) fn add_corners(&self, tips: &mut Tips) {
        for (x, ends) in self.meetings() {
            let cells = ends
                .iter()
                .find_map(|&end| self.cells_at(end))
                .unwrap_or_default();
            let beside = self.cells_beside(&x);
            let nodes = self.mesh.nodes_of(beside.iter().copied());
            let sizes = nodes.iter();
            let sizes = sizes.map(|&node| self.lengths.of_nodes[node as usize]);
            let size = sizes.fold(f64::INFINITY, f64::min);
            let long = ends.iter().filter(|&&(arm, end)| {
                let range = self.range(arm);
                let parted = range[end] == self.arms[arm].range[end];
                parted && range[1] - range[0] >= LONG * size
            });
            let long = long.map(|end| end.0).collect();
            let Some((arms, others)) = self.corner_arms((&x, ends), &nodes, size) else {
                continue;
            };
            let Some(zone) = self.corner_zone(&arms, &others, &beside, DEEP * size) else {
                continue;
            };
            let first = tips.frames.len();
            for (node, arm) in self.sets(&arms, &zone.nodes) {
                let count = if zone.surplus.contains(&node) { 2 } else { 4 };
                tips.functions.extend(branches(node, first + arm, count));
            }
            tips.cells.extend(cells.iter().map(|&cell| (cell, first)));
            let corner = Corner { x, long, size };
            tips.corners.push(corner);
            tips.zones.extend(arms.iter().map(|arm| Zone {
                arms: arm.arms.clone(),
                ..zone.clone()
            }));
            tips.frames.extend(arms.into_iter().map(|arm| arm.frame));
        }
    }

    /// Cells whose closure holds an end of an arm; `None` outside of the body.
    fn cells_at(&self, (arm, end): ArmEnd) -> Option<Vec<usize>> {
        let mut chains = self.chains_of[arm].iter().map(|own| own.1);
        let last = chains.find(|chain| chain.range[end] == self.arms[arm].range[end])?;
        let vertex = match end {
            0 => last.vertices.first(),
            _ => last.vertices.last(),
        };
        let around = |node: u32| self.near.cells_around(&BTreeSet::from([node]));
        Some(match self.arrangement.vertices[vertex?.vertex].on {
            On::Node(node) => around(node).into_iter().collect(),
            On::Edge([i, j]) => around(i).intersection(&around(j)).copied().collect(),
            On::Cell(cell) => vec![cell],
            On::Outside => Vec::new(),
        })
    }

    /// Two or more ends of arms in one place, in the order of their distances from the middle of the body.
    fn meetings(&self) -> Vec<(Point, Vec<ArmEnd>)> {
        let mut at: BTreeMap<(i64, [u64; 3]), (Point, Vec<ArmEnd>)> = BTreeMap::new();
        for (index, arm) in self.arms.iter().enumerate() {
            let ends = [arm.path.first(), arm.path.last()];
            for (end, vertex) in ends.into_iter().enumerate() {
                if let (End::Bend | End::Meeting, Some(vertex)) = (arm.ends[end], vertex) {
                    let place = (
                        self.lengths.from_middle(&vertex.x),
                        vertex.x.map(f64::to_bits),
                    );
                    let found = at.entry(place).or_insert_with(|| (vertex.x, Vec::new()));
                    found.1.push((index, end));
                }
            }
        }
        let mut found: Vec<_> = at.into_values().collect();
        found.retain(|(_, ends)| ends.len() > 1);
        for (_, ends) in &mut found {
            ends.sort_by_key(|&(arm, end)| {
                let path = &self.arms[arm].path;
                let other = if end == 0 { path.last() } else { path.first() };
                other.map(|v| self.lengths.from_middle(&v.x))
            });
        }
        found
    }

    /// The arms that a corner gives functions and others in its cells: those too short for functions that reach over all of the
    /// cells, which have those of their own tips, and an arm that ends just beside a straight crack. `None`: it is no corner.
    fn corner_arms(
        &self,
        (x, ends): (&Point, Vec<ArmEnd>),
        nodes: &BTreeSet<u32>,
        size: f64,
    ) -> Option<(Vec<Ending>, Vec<usize>)> {
        let mut arms = Vec::new();
        let mut others = Vec::new();
        for (arm, end) in ends {
            match self.ending(arm, end) {
                Some(own) if !self.is_blocked(&own, nodes, &BTreeSet::new()) => arms.push(own),
                _ if self.carries(arm) && self.inside(arm) <= SHORT * size => others.push(arm),
                _ => return None,
            }
        }
        // Parted by a meeting alone, two arms of a crack are one.
        if let [one, two] = arms.as_slice()
            && self.goes_on(one.frame.crack, two.frame.crack)
        {
            let beside = self.tips_by_place.meeting(&around([x], size)).into_iter();
            let beside = beside.map(|number| &self.arrangement.tips[number]);
            let near = |tip: &&TracedTip| self.carries(tip.arm) && norm(&sub(&tip.x, x)) <= size;
            others.extend(beside.filter(near).map(|tip| tip.arm));
            if others.is_empty() {
                return None;
            }
        }
        (1..=MOST).contains(&arms.len()).then_some((arms, others))
    }

    /// Whether a crack goes on from one of two arms to the other, without a bend that parts it.
    pub(super) fn goes_on(&self, one: usize, two: usize) -> bool {
        let [first, second] = [one.min(two), one.max(two)].map(|arm| &self.arms[arm]);
        let follows = one.abs_diff(two) == 1 && first.number == second.number;
        let [Some(to), Some(from)] = [first.path.windows(2).last(), second.path.windows(2).next()]
        else {
            return false;
        };
        let [a, b] = [to, from].map(|w| unit(&sub(&w[1].x, &w[0].x)));
        follows && first.ends[1] == End::Meeting && dot(&a, &b) > BEND.cos()
    }

    /// Whether an arm is straight and asks for branch functions.
    fn carries(&self, arm: usize) -> bool {
        self.arms[arm].tip != Tip::None && self.is_chain(arm)
    }

    /// Whether an arm is no arc.
    pub(super) fn is_chain(&self, arm: usize) -> bool {
        matches!(self.arms[arm].geometry, Geometry::Curve(Curve::Chain(_)))
    }

    /// The nodes around a corner with the cells given; `others`: arms that may run through them, too. `deep`: see [`DEEP`] [m].
    fn corner_zone(
        &self,
        arms: &[Ending],
        others: &[usize],
        cells: &[usize],
        deep: f64,
    ) -> Option<Zone> {
        let own: Vec<usize> = arms.iter().map(|arm| arm.frame.crack).collect();
        let all = [&own[..], others].concat();
        let rooms = arms.iter().map(|arm| arm.room);
        let room = rooms.fold(f64::INFINITY, f64::min);
        let room = self.clearance(&arms[0].frame.position, &all, room);
        let least = SHORTEST * self.mesh.map(*cells.first()?).diagonal();
        if self.is_slender(cells, SLENDER) || room <= least {
            return None;
        }
        let radii = own.iter().map(|&arm| self.radius(arm, cells, room, room));
        let radius = radii.reduce(|a, b| Some(a?.min(b?))).flatten();
        let nodes = self.mesh.nodes_of(cells.iter().copied());
        let ramped = |radius: f64| {
            let mut zone = self.within(radius, arms, nodes.clone(), false);
            if zone.core.is_empty() {
                return None;
            }
            zone.surplus = self.deepest(arms, &zone.core, deep)?;
            Some(zone)
        };
        let plain = |core: BTreeSet<usize>| {
            let nodes = self.mesh.nodes_of(core.iter().copied());
            let alone = self.holds_only(&all, &core);
            let alone = alone && !self.any_blocked(arms, &nodes, &BTreeSet::new());
            alone.then(|| Zone::plain(nodes))
        };
        let around = |_| plain(self.near.cells_around(&nodes));
        let zone = radius.and_then(ramped).or_else(|| radius.and_then(around));
        zone.or_else(|| plain(cells.iter().copied().collect()))
    }

    /// Frame of a straight arm at an end that parts the cells there, and the length of the arm behind it [m].
    fn ending(&self, arm: usize, end: usize) -> Option<Ending> {
        let crack = &self.arms[arm];
        let (range, path) = (self.range(arm), &crack.path);
        let parted = range[end] == crack.range[end] && range[0] < range[1];
        if !self.carries(arm) || !parted {
            return None;
        }
        // Where it was traced to: on a node or an edge, if it is that close.
        let mut chains = self.chains_of[arm].iter().map(|own| own.1);
        let last = chains.find(|c| c.range[end] == crack.range[end])?;
        let (x, next) = match end {
            0 => (last.vertices.first()?.x, path.get(1)?.x),
            _ => (last.vertices.last()?.x, path.get(path.len() - 2)?.x),
        };
        let ahead = unit(&sub(&x, &next));
        let along = if end == 0 { ahead.map(|v| -v) } else { ahead };
        let mut frame = TipFrame::straight(arm, x, ahead, turned(&along));
        frame.shape = FrontShape::Corner;
        Some(Ending {
            frame,
            room: norm(&sub(&x, &next)).min(range[1] - range[0]),
            arms: vec![arm],
            cells: self.cells_at((arm, end))?,
        })
    }

    /// The node of the ramp that lies deepest in each wedge; `None` where one has none farther than `least` from the arms.
    pub(super) fn deepest(
        &self,
        arms: &[Ending],
        core: &BTreeSet<u32>,
        least: f64,
    ) -> Option<Vec<u32>> {
        let x = arms[0].frame.position;
        let angle = |v: &Point| v[1].atan2(v[0]).rem_euclid(TAU);
        let angles = arms.iter().map(|arm| angle(&arm.frame.ahead.map(|v| -v)));
        let angles: Vec<f64> = angles.collect();
        let mut found = vec![(least, None); arms.len()];
        for &node in core {
            let place = &self.mesh.nodes[node as usize];
            let own = angle(&sub(place, &x));
            let wedge = angles.iter().filter(|a| **a <= own).count() % arms.len();
            let arms = arms.iter().map(|arm| arm.frame.crack);
            let depth = self.away_from(place, arms, f64::INFINITY);
            if depth > found[wedge].0 {
                found[wedge] = (depth, Some(node));
            }
        }
        found.into_iter().map(|(_, node)| node).collect()
    }

    /// The arms whose functions every node carries: those beside it, and one more.
    fn sets(&self, arms: &[Ending], nodes: &BTreeSet<u32>) -> Vec<(u32, usize)> {
        // What an arm only touches is not beside it.
        let least = WITHIN * self.lengths.smallest;
        let cells = arms.iter().map(|arm| self.cells_of(arm.frame.crack, least));
        let cells: Vec<BTreeSet<usize>> = cells.map(|own| own.into_iter().collect()).collect();
        let beside = |node: u32, arm: usize| {
            let around = self.near.cells_around(&BTreeSet::from([node]));
            !around.is_disjoint(&cells[arm])
        };
        let of_node = |&node: &u32| {
            let (mut own, others): (Vec<usize>, Vec<usize>) =
                (0..arms.len()).partition(|&arm| beside(node, arm));
            own.extend(others.first());
            own.into_iter().map(move |arm| (node, arm))
        };
        nodes.iter().flat_map(of_node).collect()
    }
}
