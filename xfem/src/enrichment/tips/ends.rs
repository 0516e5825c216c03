//! The crack behind a tip: how far it leads away from it, and the frame of its functions.

use crate::cut::crack::{Crack, Geometry};
use crate::cut::placement;
use crate::cut::trace::TracedTip;
use crate::geometry::curve::Curve;
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, dot, norm, sub};

use super::Search;

impl Search<'_> {
    /// From where to where an arm parts the cells [m].
    pub(super) fn range(&self, arm: usize) -> [f64; 2] {
        let mut range = self.arms[arm].range;
        for &number in self.tips_of[arm].iter().filter(|&&t| !self.kept[t]) {
            let tip = &self.trace.tips[number];
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

    /// Length of the crack behind a tip that its branch functions know [m].
    pub(super) fn room(&self, number: usize) -> f64 {
        let tip = &self.trace.tips[number];
        let arm = &self.arms[tip.arm];
        let from = arm.range[tip.end];
        let other = (self.range(tip.arm)[1 - tip.end] - from).abs();
        let Geometry::Curve(Curve::Chain(_)) = &arm.geometry else {
            return other;
        };
        let vertices = arm.path.iter().map(|vertex| vertex.s);
        let kinks = vertices.filter(|s| *s > arm.range[0] && *s < arm.range[1]);
        kinks.map(|s| (s - from).abs()).fold(other, f64::min)
    }

    /// Frame of a tip and the length behind it that its functions know [m]: along its arm; where that is too short for its cells,
    /// along the crack around bends and through meetings.
    pub(super) fn end(&self, number: usize) -> (TipFrame, f64) {
        let tip = &self.trace.tips[number];
        let frame = placement::tip_frame(tip.arm, &self.arms[tip.arm], tip.end, &tip.x);
        let arm = (frame, self.room(number));
        let nodes = self.mesh.nodes_of(tip.cells.iter().copied());
        if !self.is_blocked(&arm, &nodes, &self.cut_off(&arm, &nodes)) {
            return arm;
        }
        let path = self.leading_away(tip);
        if path.len() < 3 {
            return arm;
        }
        let mut bent = arm.clone();
        bent.1 = path.last().map_or(0.0, |x| norm(&sub(x, &tip.x)));
        bent.0.shape = FrontShape::Bent(path);
        if bent.1 > arm.1 { bent } else { arm }
    }

    /// The vertices of a crack from a tip on, as long as it leads away from there.
    fn leading_away(&self, tip: &TracedTip) -> Vec<Point> {
        /// Least cosine of its angle with the radius, 75 degrees: θ turns with the crack by the tangent of that, at every radius.
        const LEADING: f64 = 0.25;
        let mut path = vec![tip.x];
        let (mut arm, end) = (tip.arm, tip.end);
        loop {
            let (own, range) = (&self.arms[arm], self.range(arm));
            let Geometry::Curve(curve @ Curve::Chain(_)) = &own.geometry else {
                return path;
            };
            let whole = range[1 - end] == own.range[1 - end];
            let inner = own.path.iter().filter(|v| v.s > range[0] && v.s < range[1]);
            let mut next: Vec<Point> = inner.map(|v| v.x).collect();
            if end == 1 {
                next.reverse();
            }
            // Where it meets others the path was moved there, the curve was not.
            let last = if end == 1 {
                own.path.first()
            } else {
                own.path.last()
            };
            let last = last.filter(|_| whole).map(|v| v.x);
            next.push(last.unwrap_or_else(|| curve.at(range[1 - end]).0));
            for x in next {
                let from = path[path.len() - 1];
                let (back, on) = (sub(&from, &tip.x), sub(&x, &from));
                if dot(&back, &on) < LEADING * norm(&back) * norm(&on) {
                    return path;
                }
                path.push(x);
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
            if self.arms.get(other).filter(follows).is_none() {
                return path;
            }
            arm = other;
        }
    }
}
