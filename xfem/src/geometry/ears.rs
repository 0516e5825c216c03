//! Ears of a simple polygon: triangles of three corners in a row with no other corner inside, cut off one by one.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::boxes::{Boxes, Extents};
use super::polygon::{doubled_area, right_of};
use super::{Point, norm, sub};

/// An ear as far as its three corners tell.
struct Candidate {
    /// Area over squared perimeter.
    shape: f64,
    /// Its middle corner.
    corner: usize,
    /// How often that had got another neighbour.
    round: u32,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let shape = self.shape.total_cmp(&other.shape);
        shape.then(Reverse(self.corner).cmp(&Reverse(other.corner)))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}

/// A polygon of which ears were cut off.
struct Rest<'a> {
    polygon: &'a [Point],
    /// By corner: the ones before and behind it that are left.
    neighbours: Vec<[usize; 2]>,
    /// By corner: how often it got another neighbour; `None`: it was cut off.
    rounds: Vec<Option<u32>>,
    /// The corners that are left, by place.
    corners: Boxes,
}

impl Rest<'_> {
    fn triangle(&self, corner: usize) -> [Point; 3] {
        let [before, behind] = self.neighbours[corner];
        [before, corner, behind].map(|k| self.polygon[k])
    }

    /// The ear at a corner, if it does not turn right.
    fn candidate(&self, corner: usize) -> Option<Candidate> {
        let [a, b, c] = self.triangle(corner);
        let size = doubled_area(&a, &b, &c);
        let perimeter = norm(&sub(&b, &a)) + norm(&sub(&c, &b)) + norm(&sub(&a, &c));
        (size > 0.0).then_some(Candidate {
            shape: size / (perimeter * perimeter),
            corner,
            round: self.rounds[corner]?,
        })
    }

    /// Another corner inside the triangle at one, or on its outline.
    fn inside(&self, corner: usize) -> Option<usize> {
        let triangle = self.triangle(corner);
        let [a, b, c] = &triangle;
        let edges = [[a, b], [b, c], [c, a]];
        let may = |extents: &Extents| !edges.iter().any(|edge| right_of(*edge, extents));
        let mut found = None;
        self.corners.any(may, |k| {
            let x = &self.polygon[k];
            let outside = edges.iter().any(|[p, q]| doubled_area(p, q, x) < 0.0);
            let other = self.rounds[k].is_some() && !triangle.contains(x);
            found = (other && !outside).then_some(k);
            found.is_some()
        });
        found
    }

    /// Cuts off the ear at a corner.
    fn cut(&mut self, corner: usize) {
        let [before, behind] = self.neighbours[corner];
        self.neighbours[before][1] = behind;
        self.neighbours[behind][0] = before;
        for k in [before, behind] {
            self.rounds[k] = self.rounds[k].map(|round| round + 1);
        }
        self.rounds[corner] = None;
        self.corners.remove(corner, &[self.polygon[corner]; 2]);
    }
}

/// Triangles that fill a polygon, the ear with the best shape first. What waits for a corner inside of it is an ear as soon as
/// that is cut off.
pub(super) fn ears(polygon: &[Point]) -> Vec<[Point; 3]> {
    let count = polygon.len();
    let mut found = Vec::with_capacity(count.saturating_sub(2));
    let mut rest = Rest {
        polygon,
        neighbours: (0..count)
            .map(|k| [(k + count - 1) % count, (k + 1) % count])
            .collect(),
        rounds: vec![Some(0); count],
        corners: Boxes::new(polygon.iter().map(|x| [*x; 2])),
    };
    let mut waiting: Vec<Vec<Candidate>> = (0..count).map(|_| Vec::new()).collect();
    let mut best: BinaryHeap<Candidate> = (0..count).filter_map(|k| rest.candidate(k)).collect();
    while found.len() + 3 < count {
        // Without any, only corners in line are left: they enclose nothing.
        let Some(candidate) = best.pop() else {
            return found;
        };
        let corner = candidate.corner;
        if rest.rounds[corner] != Some(candidate.round) {
            continue;
        }
        if let Some(other) = rest.inside(corner) {
            waiting[other].push(candidate);
            continue;
        }
        found.push(rest.triangle(corner));
        let beside = rest.neighbours[corner];
        rest.cut(corner);
        best.extend(beside.into_iter().filter_map(|k| rest.candidate(k)));
        best.append(&mut std::mem::take(&mut waiting[corner]).into());
    }
    let left = (0..count).filter(|&k| rest.rounds[k].is_some());
    let left: Vec<Point> = left.map(|k| polygon[k]).collect();
    found.extend(<[Point; 3]>::try_from(left));
    found
}

#[cfg(test)]
mod tests {
    use super::super::polygon::area;
    use super::*;

    /// Source: ears sought among all corners, one after the other. Goal: the same triangles in the same order.
    #[test]
    fn the_best_ears_are_those_of_a_search_through_all_corners() {
        let naive = |polygon: &[Point]| {
            let mut rest = polygon.to_vec();
            let mut found = Vec::new();
            while rest.len() > 3 {
                let n = rest.len();
                let ear = |i: usize| {
                    let (a, b, c) = (rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]);
                    let size = doubled_area(&a, &b, &c);
                    let edges = [[a, b], [b, c], [c, a]];
                    let others = rest.iter().filter(|x| ![a, b, c].contains(x));
                    let outside =
                        |x: &Point| edges.iter().any(|[p, q]| doubled_area(p, q, x) < 0.0);
                    let length: f64 = edges.iter().map(|[p, q]| norm(&sub(q, p))).sum();
                    let free = size > 0.0 && others.into_iter().all(outside);
                    free.then_some(size / (length * length))
                };
                let ears = (0..n).filter_map(|i| Some((i, ear(i)?)));
                let best = ears.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
                let Some((i, _)) = best else {
                    return found;
                };
                found.push([rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]]);
                rest.remove(i);
            }
            found.extend(<[Point; 3]>::try_from(rest));
            found
        };
        let comb = |k: u32| [f64::from(k), f64::from(k % 2 * (2 + k % 5)), 0.0];
        let arc = |k: u32| {
            let (s, c) = (0.01 * f64::from(k)).sin_cos();
            [30.0 * s, 10.0 * (1.0 - c), 0.0]
        };
        let line = |k: u32| [0.1 * f64::from(k), 0.01 * f64::from(k * k), 0.0];
        let shapes: [&dyn Fn(u32) -> Point; 3] = [&comb, &arc, &line];
        for (shape, count) in shapes.iter().flat_map(|s| [4, 15, 150].map(|n| (s, n))) {
            // Above the chain, and below it.
            let chain: Vec<Point> = (0..count).map(shape).collect();
            let (from, to) = (chain[0][0], chain[chain.len() - 1][0]);
            let mut above = chain.clone();
            above.extend([[to, 500.0, 0.0], [from, 500.0, 0.0]]);
            let mut below: Vec<Point> = chain.into_iter().rev().collect();
            below.extend([[from, -50.0, 0.0], [to, -50.0, 0.0]]);
            for polygon in [above, below] {
                let found = ears(&polygon);
                assert_eq!(found, naive(&polygon), "{count}");
                let filled: f64 = found.iter().map(|t| area(t)).sum();
                assert!((filled / area(&polygon) - 1.0).abs() < 1e-12);
            }
        }
    }
}
