//! Contact rows in use: one (normal) or `dim` per contact point.

/// Which rows of the jump operator a set of contact points uses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowSet {
    /// First row of each point; one more entry for the end.
    start: Vec<usize>,
    /// Row of B behind each row.
    pub(crate) source: Vec<usize>,
}

impl RowSet {
    /// `components[i]` rows for point i of a body with `dim` rows of B per point.
    pub(crate) fn new(dim: usize, components: &[usize]) -> Self {
        let (mut start, mut source) = (vec![0], Vec::new());
        for (i, &c) in components.iter().enumerate() {
            source.extend((0..c).map(|k| dim * i + k));
            start.push(source.len());
        }
        Self { start, source }
    }

    /// All `dim` rows of every point.
    pub(crate) fn all(dim: usize, points: usize) -> Self {
        Self::new(dim, &vec![dim; points])
    }

    /// Number of rows.
    #[expect(clippy::len_without_is_empty, reason = "a body has contact points")]
    pub fn len(&self) -> usize {
        self.source.len()
    }

    /// Rows of point `i`: the normal one first.
    pub fn of(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i]..self.start[i + 1]
    }

    /// Rows of the point that has row `k`.
    pub(crate) fn around(&self, k: usize) -> std::ops::Range<usize> {
        self.of(self.start.partition_point(|&first| first <= k) - 1)
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.start.len() - 1
    }

    /// Normal row of every point.
    pub fn normal(&self) -> &[usize] {
        &self.start[..self.points()]
    }

    /// Rows of the points, one range after the other.
    pub fn iter(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        self.start.windows(2).map(|ends| ends[0]..ends[1])
    }

    /// Where each row stands among the rows of a larger set.
    pub(crate) fn positions_in(&self, larger: &RowSet) -> Vec<usize> {
        let last = larger.source.last().map_or(0, |last| last + 1);
        let mut position = vec![0; last];
        for (k, &i) in larger.source.iter().enumerate() {
            position[i] = k;
        }
        self.source.iter().map(|&i| position[i]).collect()
    }

    /// Entries of a vector with all `dim` rows per point.
    pub fn restrict(&self, all: &[f64]) -> Vec<f64> {
        self.source.iter().map(|&i| all[i]).collect()
    }

    /// A vector with all `dim` rows per point, 0 on those not in use.
    pub(crate) fn extend(&self, values: &[f64], all: usize) -> Vec<f64> {
        let mut extended = vec![0.0; all];
        for (&row, &value) in self.source.iter().zip(values) {
            extended[row] = value;
        }
        extended
    }
}
