//! Boxes found by place: which of many meet a given one.

use super::Point;

/// A box: lowest and highest coordinates [m].
pub type Extents = [Point; 2];

/// The box of some points, larger by `margin` on all sides [m].
pub fn around<'a>(points: impl IntoIterator<Item = &'a Point>, margin: f64) -> Extents {
    let nothing = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let grown = |[low, high]: Extents, x: &Point| {
        let low = [0, 1, 2].map(|a| low[a].min(x[a] - margin));
        [low, [0, 1, 2].map(|a| high[a].max(x[a] + margin))]
    };
    points.into_iter().fold(nothing, grown)
}

/// Many boxes, sorted by their least x.
#[derive(Debug, Clone, Default)]
pub struct Boxes {
    by_x: Vec<(Extents, u32)>,
    /// Largest extent along x [m].
    widest: f64,
}

impl Boxes {
    /// Sorts them.
    pub fn new(boxes: impl Iterator<Item = Extents>) -> Self {
        let mut by_x: Vec<(Extents, u32)> = boxes.zip(0..).collect();
        by_x.sort_by(|a, b| a.0[0][0].total_cmp(&b.0[0][0]));
        let widths = by_x.iter().map(|([low, high], _)| high[0] - low[0]);
        let widest = widths.fold(0.0, f64::max);
        Boxes { by_x, widest }
    }

    /// Numbers of those that meet a box or its border, ascending.
    pub fn meeting(&self, [low, high]: &Extents) -> Vec<usize> {
        let from = low[0] - self.widest;
        let begin = self.by_x.partition_point(|b| b.0[0][0] < from);
        let end = self.by_x.partition_point(|b| b.0[0][0] <= high[0]);
        let meets = |b: &Extents| (0..3).all(|a| b[1][a] >= low[a] && b[0][a] <= high[a]);
        let near = self.by_x[begin..end.max(begin)].iter();
        let mut found: Vec<usize> = near.filter(|b| meets(&b.0)).map(|b| b.1 as usize).collect();
        found.sort_unstable();
        found
    }
}
