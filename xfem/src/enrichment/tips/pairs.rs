//! Short cracks: functions of both ends at once.
//!
//! The functions of a tip jump along the whole line behind it. On a crack of few cells they would do so beyond its other end: there
//! is no room for a ramp, in the end none for the functions, and the crack then ends at a cell edge. Functions of both ends jump on
//! the path between them alone, bent and crossed as it is. Where the smallest ramps around them share a cell, or neither has room, a
//! crack takes these, at the nodes of all its cells and around them.
//!
//! A crack with one end inside, the other on a side of the body or on another crack, is half of one: its mirror image in the place
//! where it starts goes on beyond.

use std::collections::BTreeSet;

use crate::cut::crack::{End, Tip};
use crate::cut::part::Place;
use crate::geometry::boxes::around;
use crate::geometry::polygon::bends;
use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, dot, norm, sub};

use super::super::zone::Zone;
use super::ends::Ending;
use super::{SHORTEST, SLENDER, Search};

/// Least cosine of the angle of a crack with the line between its ends, 75 degrees: one that winds has ends that are farther from
/// each other than they seem.
const LEADING: f64 = 0.25;

/// A short crack.
#[derive(Debug)]
pub(super) struct Pair {
    /// Arms over which its functions jump, one after the other.
    pub arms: Vec<usize>,
    /// All arms of the crack.
    pub run: Vec<usize>,
    /// Its tips; one, if it starts at a side or on another crack.
    pub tips: Vec<usize>,
    /// Where it is bent and ends, mirrored if it has one tip [m].
    path: Vec<Point>,
}

impl Search<'_> {
    /// Finds the cracks that take functions of both ends; whether there are any.
    pub(super) fn add_pairs(&mut self) -> bool {
        for arms in self.runs() {
            let asks = self.arms[arms[0]].tip != Tip::None;
            let long_enough = self.length(&arms) > SHORTEST * self.lengths.smallest;
            let pair = self.pair(arms).filter(|_| asks && long_enough);
            // Of both ends and of every leg: in cells 13 times as long as wide their rounding leaves 5e-8 of the energy.
            let of_tip = |&tip: &usize| &self.arrangement.tips[tip].cells;
            let slender = |cells: &Vec<usize>| self.is_slender(cells, 2.0 * SLENDER);
            let dense =
                |pair: &Pair| pair.arms.len() > 1 && pair.tips.iter().map(of_tip).any(slender);
            let pair = pair.filter(|pair| !dense(pair));
            if let Some(pair) = pair.filter(|pair| self.is_short(pair) && self.lacks_room(pair)) {
                self.paired.extend(&pair.arms);
                let legs = self.legs(&pair);
                self.pairs.push(pair);
                self.pairs.extend(legs);
            }
        }
        for &tip in self.pairs.iter().flat_map(|pair| &pair.tips) {
            self.kept[tip] = false;
        }
        !self.pairs.is_empty()
    }

    /// Arms of cracks from end to end.
    fn runs(&self) -> Vec<Vec<usize>> {
        let mut runs: Vec<Vec<usize>> = Vec::new();
        for (arm, crack) in self.arms.iter().enumerate() {
            let goes_on = arm > 0 && {
                let before = &self.arms[arm - 1];
                before.number == crack.number && before.range[1] == crack.range[0]
            };
            match runs.last_mut() {
                Some(run) if goes_on => run.push(arm),
                _ => runs.push(vec![arm]),
            }
        }
        runs
    }

    /// The path of a run with a free end or two; `None`: it has none, is curved or winds.
    fn pair(&self, arms: Vec<usize>) -> Option<Pair> {
        let [first, last] = [arms[0], arms[arms.len() - 1]];
        let ends = [self.arms[first].ends[0], self.arms[last].ends[1]];
        if !arms.iter().all(|&arm| self.is_chain(arm)) || !ends.contains(&End::Free) {
            return None;
        }
        let mut tips = Vec::new();
        let mut path: Vec<Point> = Vec::new();
        for (arm, end) in [(first, 0), (last, 1)] {
            if ends[end] == End::Free {
                tips.push(self.tip_at(arm, end)?);
            }
        }
        path.push(self.at_end(first, 0)?);
        let inner = |&arm: &usize| self.arms[arm].path.iter().skip(1).map(|v| v.x);
        path.extend(arms.iter().flat_map(inner));
        let count = path.len();
        path[count - 1] = self.at_end(last, 1)?;
        let bent = bends(&path, self.lengths.rounding);
        let mut path: Vec<Point> = bent.into_iter().map(|k| path[k]).collect();
        if tips.len() == 1 {
            // From the mirror image of the tip through the start to the tip.
            if ends[0] == End::Free {
                path.reverse();
            }
            let base = path[0];
            let image = |x: &Point| [0, 1, 2].map(|a| 2.0 * base[a] - x[a]);
            let mut whole: Vec<Point> = path.iter().skip(1).rev().map(image).collect();
            whole.extend(path);
            if ends[0] == End::Free {
                whole.reverse();
            }
            path = whole;
        }
        let chord = sub(&path[path.len() - 1], &path[0]);
        let leads = path.windows(2).all(|w| {
            let d = sub(&w[1], &w[0]);
            dot(&d, &chord) >= LEADING * norm(&d) * norm(&chord)
        });
        leads.then_some(Pair {
            run: arms.clone(),
            arms,
            tips,
            path,
        })
    }

    /// The straight legs of a bent crack, each with functions of its own: on either side of a bend the faces slide another way.
    fn legs(&self, pair: &Pair) -> Vec<Pair> {
        let legs = pair
            .arms
            .chunk_by(|one, two| self.straight[*one] == self.straight[*two]);
        let of = |arms: &[usize]| {
            let path = vec![
                self.at_end(arms[0], 0)?,
                self.at_end(arms[arms.len() - 1], 1)?,
            ];
            Some(Pair {
                arms: arms.to_vec(),
                run: pair.run.clone(),
                tips: pair.tips.clone(),
                path,
            })
        };
        let legs: Vec<Pair> = legs.filter_map(of).collect();
        if legs.len() > 1 { legs } else { Vec::new() }
    }

    /// The tip at an end of an arm.
    fn tip_at(&self, arm: usize, end: usize) -> Option<usize> {
        let mut own = self.tips_of[arm].iter().copied();
        own.find(|&t| self.arrangement.tips[t].end == end)
    }

    /// Where an arm ends inside the body [m].
    fn at_end(&self, arm: usize, end: usize) -> Option<Point> {
        if let Some(tip) = self.tip_at(arm, end) {
            return Some(self.arrangement.tips[tip].x);
        }
        let chains = self.chains_of[arm].iter().map(|own| own.1);
        let at = |range: &[f64; 2]| [range[0], -range[1]][end];
        let chain = chains.min_by(|a, b| at(&a.range).total_cmp(&at(&b.range)))?;
        let vertex = [chain.vertices.first(), chain.vertices.last()][end];
        vertex.map(|v| v.x)
    }

    /// Length of some arms inside the body [m].
    fn length(&self, arms: &[usize]) -> f64 {
        arms.iter().map(|&arm| self.inside(arm)).sum()
    }

    /// Whether its ends are nearer to each other than what they ask for, a ramp or functions on their own cells: the smallest ones
    /// share a cell; or it is one arm with room for functions at neither.
    fn is_short(&self, pair: &Pair) -> bool {
        let ramp = |&tip: &usize| {
            let tip = &self.arrangement.tips[tip];
            let own = self.mesh.nodes_of(self.cells_beside(&tip.x));
            if !self.asks(tip.arm) {
                return self.near.cells_around(&own);
            }
            let size = self.least_radius(&tip.cells);
            let mut nodes = self.near.nodes_in(&around([&tip.x], size));
            nodes.retain(|&n| norm(&sub(&self.mesh.nodes[n as usize], &tip.x)) <= size);
            (self.near).cells_around(&(&nodes | &self.near.nodes_around(&own)))
        };
        let ramps: Vec<BTreeSet<usize>> = pair.tips.iter().map(ramp).collect();
        // Of a crack with one tip the start takes the place of the other.
        let start = (pair.tips.len() == 1).then(|| pair.path[pair.path.len() / 2]);
        let beside = start.iter().flat_map(|x| self.cells_beside(x)).collect();
        let meet = match ramps.as_slice() {
            [one, two] => !one.is_disjoint(two),
            ramps => ramps.iter().any(|ramp| !ramp.is_disjoint(&beside)),
        };
        let roomless = pair.tips.len() == 2 && pair.tips.iter().all(|&tip| !self.kept[tip]);
        meet || roomless && pair.arms.len() == 1
    }

    /// Whether a tip goes without the ramp that it asks for, or without functions. That of a crack which starts on a side or another
    /// crack within its ramp always does: the ramp falls to zero there.
    fn lacks_room(&self, pair: &Pair) -> bool {
        pair.tips.len() == 1
            || pair.tips.iter().any(|&number| {
                let tip = &self.arrangement.tips[number];
                let ramped = || !self.zone(tip, &self.end(number)).core.is_empty();
                !self.kept[number] || self.asks(tip.arm) && !ramped()
            })
    }

    /// Frame of the functions of both ends of a crack, the cells of its ends, and the nodes that carry them.
    pub(super) fn pair_zone(&self, pair: &Pair) -> (TipFrame, Vec<usize>, Zone) {
        let end = self.pair_ending(pair);
        let cells = pair.arms.iter().flat_map(|&arm| self.cells_of(arm, 0.0));
        let nodes = self.mesh.nodes_of(cells);
        let places = pair.tips.iter().map(|&tip| self.arrangement.tips[tip].x);
        let clear = places.map(|x| self.clearance(&x, &pair.run, end.room));
        let radius = self.radius(
            pair.arms[0],
            &end.cells,
            end.room,
            clear.fold(end.room, f64::min),
        );
        let mut zone = match radius {
            Some(radius) => self.pair_ramp(&end, pair, radius, nodes),
            None => Zone::plain(nodes),
        };
        if zone.core.is_empty() {
            zone.cut_off = self.cut_off_from(pair, &zone.nodes);
        }
        zone.nodes.retain(|&node| self.lives(node, &zone.cut_off));
        zone.arms.clone_from(&pair.arms);
        (end.frame, end.cells, zone)
    }

    /// Parts of the cells of some nodes that other cracks part from all of its tips.
    pub(super) fn cut_off_from(&self, pair: &Pair, nodes: &BTreeSet<u32>) -> BTreeSet<Place> {
        let cells = self.near.cells_around(nodes);
        let from = |&tip: &usize| {
            let tip = &self.arrangement.tips[tip];
            self.joiner()
                .parted_from(&pair.run, (&tip.x, &tip.cells), &cells)
        };
        let parted = pair.tips.iter().map(from);
        parted.reduce(|one, two| &one & &two).unwrap_or_default()
    }

    /// The functions of both ends, between the places that these were traced to.
    fn pair_ending(&self, pair: &Pair) -> Ending {
        let tips = pair.tips.iter().map(|&tip| &self.arrangement.tips[tip]);
        Ending {
            frame: TipFrame::of_both_ends(pair.arms[0], &pair.path),
            room: self.length(&pair.arms),
            arms: pair.arms.clone(),
            cells: tips.flat_map(|tip| tip.cells.clone()).collect(),
        }
    }
}
