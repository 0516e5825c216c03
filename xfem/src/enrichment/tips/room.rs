//! The nodes around a tip or corner of a plane body that can carry its branch functions.

use std::collections::BTreeSet;

use crate::cut::arrangement::{TracedTip, WITHIN};
use crate::cut::crack::Tip;
use crate::cut::part::Place;
use crate::cut::partition::Partition;
use crate::geometry::Point;
use crate::geometry::boxes::around;
use crate::geometry::polygon;
use crate::geometry::segments::Segments;
use crate::geometry::tip_frame::FrontShape;

use super::super::zone::Zone;
use super::ends::Ending;
use super::pairs::Pair;
use super::{GRAZING, LONGER, SHARE, Search};

/// The smallest ramp around a tip, in the longest edges of its cells: with the cells around these it spans one to two of square ones.
const RAMP: f64 = 1.5;

/// Nodes around a ramp are no farther away than this, in lengths of the arm: seen from there a short arm, or one in long cells, is
/// nothing, and its functions become dependent.
const FAR: f64 = 4.0;

impl Search<'_> {
    /// Cells that hold a place or lie beside it: their nodes carry its functions, so nothing changes where it leaves a cell.
    pub(super) fn cells_beside(&self, x: &Point) -> Vec<usize> {
        let reach = WITHIN * self.lengths.smallest;
        let mut near = self.mesh.surroundings().meeting(&around([x], reach));
        near.retain(|&cell| {
            let map = self.mesh.map(cell);
            polygon::contains(&map, x) || polygon::border_distance(&map, x) <= reach
        });
        near
    }

    /// Parts of the cells of some nodes that others than the arms along which the functions of an end jump part from it.
    pub(super) fn cut_off(&self, end: &Ending, nodes: &BTreeSet<u32>) -> BTreeSet<Place> {
        let cells = self.near.cells_around(nodes);
        self.joiner()
            .parted_from(&end.arms, (&end.frame.position, &end.cells), &cells)
    }

    /// Whether a cell of some nodes holds, where it is not cut off, a part of the line behind a tip beyond its room.
    pub(super) fn is_blocked(
        &self,
        end: &Ending,
        nodes: &BTreeSet<u32>,
        cut_off: &BTreeSet<Place>,
    ) -> bool {
        let (size, _) = self.lengths.extent;
        let line = Segments::new(vec![end.frame.behind(end.room, size)]);
        let mut cells = self.near.cells_around(nodes).into_iter();
        cells.any(|cell| {
            let map = self.mesh.map(cell);
            let slack = GRAZING * map.diagonal();
            let enters = |outline: &[Point]| line.enter(outline, slack, LONGER * map.diagonal());
            let whole = cut_off.range((cell, 0)..(cell + 1, 0)).next().is_none();
            match self.partitions.get(&cell) {
                Some(partition) if !whole => {
                    let mut parts = partition.parts.iter().enumerate();
                    parts.any(|(region, part)| {
                        let mut triangles = part.triangles().into_iter();
                        !cut_off.contains(&(cell, region)) && triangles.any(|t| enters(&t))
                    })
                }
                _ => whole && enters(&map),
            }
        })
    }

    /// The nodes around a tip: within the largest radius that leaves it alone.
    pub(super) fn zone(&self, tip: &TracedTip, end: &Ending) -> Zone {
        let (arms, room) = ([end.clone()], end.room);
        let clear = self.clearance(&tip.x, &[tip.arm], room);
        let radius = self.radius(tip.arm, &tip.cells, room, clear);
        let nodes = self.mesh.nodes_of(self.cells_beside(&tip.x));
        let mut zone = match radius {
            Some(radius) => self.within(radius, &arms, nodes, true),
            None => Zone::plain(nodes),
        };
        if zone.core.is_empty() {
            zone.cut_off = self.cut_off(end, &zone.nodes);
        } else if matches!(end.frame.shape, FrontShape::Straight | FrontShape::Bent(_))
            && zone.surplus.is_empty()
        {
            // Around a bend the relations between the functions hold nearly.
            zone.surplus = self.deepest(&arms, &zone.core, 0.0).unwrap_or_default();
        }
        zone.arms.clone_from(&end.arms);
        // Where all of a node's cells are cut off it carries nothing.
        zone.nodes.retain(|&node| self.lives(node, &zone.cut_off));
        zone
    }

    /// Whether some region around a node is not cut off.
    pub(super) fn lives(&self, node: u32, cut_off: &BTreeSet<Place>) -> bool {
        let mut cells = self.near.cells_around(&BTreeSet::from([node])).into_iter();
        cells.any(|cell| {
            let parts = self.partitions.get(&cell).map_or(1, |p| p.parts.len());
            (0..parts).any(|region| !cut_off.contains(&(cell, region)))
        })
    }

    /// The radius that an arm asks for, if any, at a tip in some cells: no shorter than these, or the ramp would be as flat as they
    /// are. `clear`: the distance from other arms and the border [m].
    pub(super) fn radius(&self, arm: usize, cells: &[usize], room: f64, clear: f64) -> Option<f64> {
        match self.arms[arm].tip {
            Tip::Radius(radius) => Some(radius.min(room)),
            Tip::Auto => Some(self.least_radius(cells).max(SHARE * room.min(clear))),
            Tip::Branch | Tip::None => None,
        }
    }

    /// The smallest radius around a tip in some cells [m].
    pub(super) fn least_radius(&self, cells: &[usize]) -> f64 {
        let edges = cells.iter().map(|&cell| self.mesh.map(cell).longest_edge());
        RAMP * edges.fold(0.0, f64::max)
    }

    /// The nodes within the largest radius around a place, its cells given, that no crack enters but the arms that end there; `cut`:
    /// of the smallest others may cut off a part. `arms`: their frames with the lengths that these know.
    pub(super) fn within(
        &self,
        radius: f64,
        arms: &[Ending],
        at_tip: BTreeSet<u32>,
        cut: bool,
    ) -> Zone {
        let (near, frame) = (&self.near, &arms[0].frame);
        let own: Vec<usize> = arms.iter().map(|arm| arm.frame.crack).collect();
        let rooms = arms.iter().map(|arm| arm.room);
        let room = rooms.fold(f64::INFINITY, f64::min);
        let inside = own.iter().map(|&arm| self.inside(arm)).fold(room, f64::min);
        let at_tip = (at_tip, WITHIN * self.lengths.smallest);
        let free = |cells: &BTreeSet<usize>, nodes: &BTreeSet<u32>, last| {
            let alone = self.holds_only(&own, cells);
            if !(alone || cut && last) {
                return None;
            }
            // Beyond a crossing an arm goes on, but not its functions.
            let far = FAR * if alone { room } else { inside };
            let close = |&node: &u32| frame.distance(&self.mesh.nodes[node as usize]) <= far;
            let cut_off = match alone {
                true => BTreeSet::new(),
                false => self.cut_off(&arms[0], nodes),
            };
            let blocked = self.any_blocked(arms, nodes, &cut_off);
            (nodes.iter().all(close) && !blocked).then_some(cut_off)
        };
        Zone::widest(self.mesh, near, frame, radius, at_tip, free)
    }

    /// The nodes within the largest radius around both ends of a crack that no other crack enters, or the smallest around their `own`
    /// less what others part from both.
    pub(super) fn pair_ramp(
        &self,
        end: &Ending,
        pair: &Pair,
        radius: f64,
        own: BTreeSet<u32>,
    ) -> Zone {
        let own = (own, WITHIN * self.lengths.smallest);
        let frame = &end.frame;
        Zone::widest(
            self.mesh,
            &self.near,
            frame,
            radius,
            own,
            |cells, nodes, last| match self.holds_only(&pair.run, cells) {
                true => Some(BTreeSet::new()),
                false => last.then(|| self.cut_off_from(pair, nodes)),
            },
        )
    }

    /// Whether none but some arms run through some cells.
    pub(super) fn holds_only(&self, arms: &[usize], cells: &BTreeSet<usize>) -> bool {
        let parted = cells.iter().filter_map(|cell| self.partitions.get(cell));
        let mut own = parted.flat_map(Partition::arms);
        own.all(|arm| arms.contains(&arm))
    }

    /// The functions of the nodes at a tip on what other cracks part from it, with unknowns of their own: what carries the load
    /// of a narrow ligament feels its end, too.
    pub(super) fn beyond(&self, tip: &TracedTip, end: &Ending, zone: &Zone) -> Option<Zone> {
        let nodes = self.mesh.nodes_of(self.cells_beside(&tip.x));
        let places = self.near.cells_around(&nodes).into_iter().flat_map(|cell| {
            let parts = self.partitions.get(&cell).map_or(1, |p| p.parts.len());
            (0..parts).map(move |region| (cell, region))
        });
        let (beyond, cut_off): (BTreeSet<Place>, BTreeSet<Place>) =
            places.partition(|place| zone.cut_off.contains(place));
        let nodes: BTreeSet<u32> = nodes
            .into_iter()
            .filter(|&node| self.lives(node, &cut_off))
            .collect();
        // Behind the end of the crack they would jump where nothing does.
        let lives = !beyond.is_empty() && !self.is_blocked(end, &nodes, &cut_off);
        lives.then(|| Zone {
            cut_off,
            arms: end.arms.clone(),
            ..Zone::plain(nodes)
        })
    }

    /// Whether a cell of some nodes holds, where it is not cut off, a part of the line of one of some arms beyond what its functions
    /// know.
    pub(super) fn any_blocked(
        &self,
        arms: &[Ending],
        nodes: &BTreeSet<u32>,
        cut_off: &BTreeSet<Place>,
    ) -> bool {
        arms.iter().any(|arm| self.is_blocked(arm, nodes, cut_off))
    }

    /// Distance of a place from arms other than its own and from the border of the body, at most `room` [m].
    pub(super) fn clearance(&self, x: &Point, own: &[usize], room: f64) -> f64 {
        let others = self.extents.meeting(&around([x], room)).into_iter();
        let others = others.filter(|arm| !own.contains(arm));
        self.border.distance(x, self.away_from(x, others, room))
    }

    /// Distance of a place from some arms, at most `most` [m].
    pub(super) fn away_from(&self, x: &Point, arms: impl Iterator<Item = usize>, most: f64) -> f64 {
        arms.fold(most, |most, arm| self.paths[arm].distance(x, most))
    }
}
