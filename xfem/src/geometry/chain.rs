//! Chains of straight segments, continued by their end segments.

use std::ops::Deref;

use super::boxes::{Boxes, Extents, around, no_nearer};
use super::curve::{Nearest, turned};
use super::{Point, add_scaled, dot, norm, sub, unit};

/// Straight segments through two or more points [m].
#[derive(Debug)]
pub struct Chain {
    points: Vec<Point>,
    /// Abscissas of the points [m].
    abscissas: Vec<f64>,
    /// The segments by place.
    segments: Boxes,
}

impl PartialEq for Chain {
    fn eq(&self, other: &Self) -> bool {
        self.points == other.points
    }
}

impl Deref for Chain {
    type Target = [Point];

    fn deref(&self) -> &[Point] {
        &self.points
    }
}

impl Chain {
    /// Straight segments through points.
    pub fn new(points: Vec<Point>) -> Self {
        let lengths = points.windows(2).map(|w| norm(&sub(&w[1], &w[0])));
        let further = lengths.scan(0.0, |s, length| {
            *s += length;
            Some(*s)
        });
        Chain {
            abscissas: std::iter::once(0.0).chain(further).collect(),
            segments: Boxes::new(points.windows(2).map(|w| around(w, 0.0))),
            points,
        }
    }

    /// Length [m].
    pub fn length(&self) -> f64 {
        self.abscissas.last().copied().unwrap_or(0.0)
    }

    /// Point and unit tangent at an abscissa [m]; at a kink the tangent of the segment that ends.
    pub fn at(&self, s: f64) -> (Point, Point) {
        let inner = &self.abscissas[1..self.points.len() - 1];
        let segment = inner.partition_point(|end| *end < s);
        let [p, q] = [0, 1].map(|k| &self.points[segment + k]);
        let d = sub(q, p);
        let share = (s - self.abscissas[segment]) / norm(&d);
        (add_scaled(p, share, &d), unit(&d))
    }

    /// The nearest point of the chain or its continuation; of equally near ones the first.
    pub fn nearest(&self, x: &Point) -> Nearest {
        let last = self.points.len() - 2;
        if last == 0 {
            return self.nearest_on(0, x).1;
        }
        let away = |segment: usize| self.nearest_on(segment, x).0;
        // What lies beyond an end is in no box.
        let ends = [0, last].map(|end| (away(end), end));
        let best = if ends[1].0 < ends[0].0 {
            ends[1]
        } else {
            ends[0]
        };
        let bound = |extents: &Extents| no_nearer(x, extents);
        let (_, segment) = self.segments.least(bound, away, best);
        self.nearest_on(segment, x).1
    }

    /// The point of a segment nearest to a place, with its distance [m].
    fn nearest_on(&self, segment: usize, x: &Point) -> (f64, Nearest) {
        let [p, q] = [0, 1].map(|k| &self.points[segment + k]);
        let d = sub(q, p);
        let tangent = unit(&d);
        let from = sub(x, p);
        let along = dot(&from, &tangent);
        let low = if segment == 0 { f64::NEG_INFINITY } else { 0.0 };
        let high = if segment + 2 == self.points.len() {
            f64::INFINITY
        } else {
            norm(&d)
        };
        let foot = along.clamp(low, high);
        let phi = dot(&from, &turned(&tangent));
        let (distance, signed) = if foot == along {
            (phi.abs(), phi)
        } else {
            // Nearest to a kink: the side of the mean normal there.
            let (kink, other) = if foot == high {
                (q, segment + 1)
            } else {
                (p, segment - 1)
            };
            let neighbour = unit(&sub(&self.points[other + 1], &self.points[other]));
            let mean = turned(&add_scaled(&tangent, 1.0, &neighbour));
            let gap = sub(x, kink);
            (norm(&gap), norm(&gap).copysign(dot(&gap, &mean)))
        };
        let nearest = Nearest {
            s: self.abscissas[segment] + foot,
            phi: signed,
            tangent,
        };
        (distance, nearest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: all segments one by one. Goal: the same bits, ties at kinks and on axes of symmetry included.
    #[test]
    fn the_search_by_boxes_finds_what_a_search_through_all_finds() {
        let zigzag = |k: u32| [f64::from(k), f64::from(k % 2 * (1 + k % 7)), 0.0];
        let spiral = |k: u32| {
            let (s, c) = (0.3 * f64::from(k)).sin_cos();
            [f64::from(k) * c, f64::from(k) * s, 0.0]
        };
        let straight = |k: u32| [0.1 * f64::from(k), 0.1 * f64::from(k), 0.0];
        let shapes: [&dyn Fn(u32) -> Point; 3] = [&zigzag, &spiral, &straight];
        for (shape, count) in shapes.iter().flat_map(|s| [2, 3, 9, 100].map(|n| (s, n))) {
            let chain = Chain::new((0..count).map(shape).collect());
            let places =
                (0..900).map(|k| [f64::from(k % 30) * 0.75 - 3.0, f64::from(k / 30) - 9.0, 0.0]);
            for x in places.chain(chain.to_vec()) {
                let mut all = (0..chain.len() - 1).map(|i| chain.nearest_on(i, &x));
                let first = all.next().unwrap();
                let best = all.fold(first, |best, own| if own.0 < best.0 { own } else { best });
                assert_eq!(chain.nearest(&x), best.1, "{count} {x:?}");
            }
        }
    }

    /// Source: sums of lengths. Goal: ends, kinks and continuations belong to the segment that ends there.
    #[test]
    fn places_by_abscissa_lie_on_their_segments() {
        let chain = Chain::new(vec![
            [0.0; 3],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [5.0, 1.0, 0.0],
        ]);
        let right = [1.0, 0.0, 0.0];
        let up = [0.0, 1.0, 0.0];
        let expected = [
            (-1.0, [-1.0, 0.0, 0.0], right),
            (2.0, [2.0, 0.0, 0.0], right),
            (2.5, [2.0, 0.5, 0.0], up),
            (3.0, [2.0, 1.0, 0.0], up),
            (7.0, [6.0, 1.0, 0.0], right),
        ];
        for (s, x, tangent) in expected {
            assert_eq!(chain.at(s), (x, tangent));
        }
        assert_eq!(chain.length(), 6.0);
    }
}
