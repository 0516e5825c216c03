//! The crack behind a tip: how far it leads away from it, and the frame of its functions.

use crate::cut::arrangement::{BEND, TracedTip};
use crate::cut::crack::{Crack, End, Geometry, on_crack};
use crate::cut::placement;
use crate::geometry::curve::turned;
use crate::geometry::polygon::bends;
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, dot, norm, sub, unit};

use super::Search;

/// The end of a crack as branch functions see it.
#[derive(Debug, Clone)]
pub(super) struct Ending {
    /// Coordinates of the functions.
    pub frame: TipFrame,
    /// Length of the crack behind it that they know [m].
    pub room: f64,
    /// Arms over which they jump.
    pub arms: Vec<usize>,
    /// Cells whose closure holds it.
    pub cells: Vec<usize>,
}

/// A crack from a tip on, as long as it leads away from there.
struct Run {
    /// Its vertices [m].
    path: Vec<Point>,
    arms: Vec<usize>,
    /// How far the tip's own arm leads away [m].
    own: f64,
}

impl Search<'_> {
    /// From where to where an arm parts the cells [m].
    pub(super) fn range(&self, arm: usize) -> [f64; 2] {
        let mut range = self.arms[arm].range;
        for &number in self.tips_of[arm].iter().filter(|&&t| !self.kept[t]) {
            let tip = &self.arrangement.tips[number];
            range[tip.end] = tip.entry;
        }
        for (cell, chain) in self.chains_of[arm].iter().filter(|c| self.divides(c.1)) {
            let partition = self.partitions.get(cell);
            if partition.is_none_or(|p| p.dropped.contains(&arm)) {
                // At the end that it is nearer to.
                let [low, high] = chain.range;
                if low - range[0] < range[1] - high {
                    range[0] = range[0].max(high);
                } else {
                    range[1] = range[1].min(low);
                }
            }
        }
        range
    }

    /// The end at a tip: along its arm, and on where the crack goes straight on through meetings, which the functions must not
    /// tell from the arm; where the arm is too short for its cells, along the crack around bends, too.
    pub(super) fn end(&self, number: usize) -> Ending {
        let tip = &self.arrangement.tips[number];
        let frame = placement::tip_frame(tip.arm, &self.arms[tip.arm], tip.end, &tip.x);
        let gentle = self.run(tip, BEND.cos());
        let own = gentle.own;
        let end = self.ending_of(tip, &frame, gentle, own);
        let mut nodes = self.mesh.nodes_of(self.cells_beside(&tip.x));
        if self.asks(tip.arm) {
            nodes = self.near.nodes_around(&self.near.nodes_around(&nodes));
        }
        if !self.is_blocked(&end, &nodes, &self.cut_off(&end, &nodes)) {
            return end;
        }
        let whole = self.run(tip, -1.0);
        let room = whole.path.last().map_or(0.0, |x| norm(&sub(x, &tip.x)));
        let bent = self.ending_of(tip, &frame, whole, room);
        if bent.room > end.room { bent } else { end }
    }

    fn ending_of(&self, tip: &TracedTip, frame: &TipFrame, run: Run, room: f64) -> Ending {
        let slack = on_crack(self.lengths.smallest, self.lengths.rounding);
        let mut frame = frame.clone();
        let bent = bends(&run.path, slack);
        if bent.len() > 2 {
            // Along the first chord of an arc, not its tangent: as the cells are cut.
            frame.ahead = unit(&sub(&tip.x, &run.path[bent[1]]));
            frame.normal = turned(&frame.ahead).map(|v| if tip.end == 0 { -v } else { v });
            frame.shape = FrontShape::Bent(bent.into_iter().map(|k| run.path[k]).collect());
        }
        Ending {
            frame,
            room,
            arms: run.arms,
            cells: tip.cells.clone(),
        }
    }

    /// The crack behind a tip, as long as it leads away from there and turns from arm to arm by no more than an angle of a given
    /// cosine.
    fn run(&self, tip: &TracedTip, least: f64) -> Run {
        /// Least cosine of its angle with the radius, 75 degrees: θ turns with the crack by the tangent of that, at every radius.
        const LEADING: f64 = 0.25;
        let (mut arm, end) = (tip.arm, tip.end);
        let mut run = Run {
            path: vec![tip.x],
            arms: vec![arm],
            own: 0.0,
        };
        let mut before: Option<Point> = None;
        loop {
            let (own, range) = (&self.arms[arm], self.range(arm));
            let Geometry::Curve(curve) = &own.geometry else {
                return run;
            };
            let whole = range[1 - end] == own.range[1 - end];
            let inner = own.path.iter().filter(|v| v.s > range[0] && v.s < range[1]);
            let mut next: Vec<Point> = inner.map(|v| v.x).collect();
            if end == 1 {
                next.reverse();
            }
            let last = if end == 1 {
                own.path.first()
            } else {
                own.path.last()
            };
            let last = last.filter(|_| whole).map(|v| v.x);
            next.push(last.unwrap_or_else(|| curve.at(range[1 - end]).0));
            for (k, x) in next.into_iter().enumerate() {
                let from = run.path[run.path.len() - 1];
                let (back, on) = (sub(&from, &tip.x), sub(&x, &from));
                let turns = |before: Point| dot(&before, &on) < least * norm(&before) * norm(&on);
                if dot(&back, &on) < LEADING * norm(&back) * norm(&on)
                    || k == 0 && before.is_some_and(turns)
                {
                    return run;
                }
                if k == 0 && arm != tip.arm {
                    run.arms.push(arm);
                }
                run.path.push(x);
                before = Some(on);
                if arm == tip.arm {
                    run.own = norm(&sub(&x, &tip.x));
                }
            }
            let other = if end == 1 {
                arm.wrapping_sub(1)
            } else {
                arm + 1
            };
            let follows = |next: &&Crack| {
                let range = self.range(other);
                let begins = next.range[end] == own.range[1 - end] && range[end] == next.range[end];
                whole && next.number == own.number && begins && range[0] < range[1]
            };
            let free = [End::Free, End::Mouth].contains(&own.ends[1 - end]);
            if free || self.arms.get(other).filter(follows).is_none() {
                return run;
            }
            arm = other;
        }
    }
}
