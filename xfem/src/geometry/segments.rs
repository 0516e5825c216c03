//! Many segments in the plane, found by place.

use super::Point;
use super::boxes::{Boxes, Extents, around, no_nearer};
use super::polygon::{edges, meets, right_of, segment_distance};

/// Segments by place.
#[derive(Debug)]
pub struct Segments {
    ends: Vec<[Point; 2]>,
    boxes: Boxes,
}

impl Segments {
    /// From their ends [m].
    pub fn new(ends: Vec<[Point; 2]>) -> Self {
        let boxes = Boxes::new(ends.iter().map(|own| around(own, 0.0)));
        Segments { ends, boxes }
    }

    /// Of a path through points [m].
    pub fn path(points: impl Iterator<Item = Point>) -> Self {
        let points: Vec<Point> = points.collect();
        Self::new(points.windows(2).map(|w| [w[0], w[1]]).collect())
    }

    /// Distance of a place from the nearest, at most `most` [m].
    pub fn distance(&self, x: &Point, most: f64) -> f64 {
        let away = |k: usize| segment_distance(x, &self.ends[k][0], &self.ends[k][1]);
        let bound = |extents: &Extents| no_nearer(x, extents);
        self.boxes.least(bound, away, (most, usize::MAX)).0
    }

    /// Whether one has a longer part than `least` in a convex counter-clockwise polygon, or no farther than `slack` from it [m]; see
    /// [`meets`].
    pub fn enter(&self, polygon: &[Point], slack: f64, least: f64) -> bool {
        let outside = |extents: &Extents| {
            let grown = around(extents, slack);
            edges(polygon).any(|(p, q)| right_of([&p, &q], &grown))
        };
        let enters = |k: usize| meets(polygon, self.ends[k].each_ref(), slack, least);
        self.boxes.any(|extents| !outside(extents), enters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: all segments one by one. Goal: the same bits, and the same answer beside borders.
    #[test]
    fn what_is_found_by_place_is_what_is_found_among_all() {
        let spiral = |k: u32| {
            let (s, c) = (0.3 * f64::from(k)).sin_cos();
            [0.1 * f64::from(k) * c, 0.1 * f64::from(k) * s, 0.0]
        };
        let points: Vec<Point> = (0..200).map(spiral).collect();
        let segments = Segments::path(points.iter().copied());
        let all = || points.windows(2);
        let mut entered = 0;
        for k in 0..400 {
            let x = [f64::from(k % 20) * 1.5 - 15.0, f64::from(k / 20) - 9.0, 0.0];
            let away = all().map(|w| segment_distance(&x, &w[0], &w[1]));
            let least = away.fold(3.0, f64::min);
            assert_eq!(segments.distance(&x, 3.0), least);
            let corner = |dx: f64, dy: f64| [x[0] + dx, x[1] + dy, 0.0];
            let square = [
                corner(0.0, 0.0),
                corner(0.3, 0.0),
                corner(0.3, 0.3),
                corner(0.0, 0.3),
            ];
            let enters = all().any(|w| meets(&square, [&w[0], &w[1]], 1e-12, 1e-6));
            assert_eq!(segments.enter(&square, 1e-12, 1e-6), enters);
            entered += usize::from(enters);
        }
        assert!((20..380).contains(&entered));
    }
}
