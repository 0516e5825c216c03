//! Grid lines that cracks are placed by, and how numbers are drawn and written.

use stickslip_xfem::mesh::stream::Stream;

/// Grid lines of a box, as far as cracks are placed by them.
pub struct Grid {
    pub dim: usize,
    pub lines: Vec<Vec<f64>>,
}

impl Grid {
    pub fn min(&self, a: usize) -> f64 {
        self.lines[a][0]
    }

    pub fn max(&self, a: usize) -> f64 {
        self.lines[a][self.lines[a].len() - 1]
    }

    pub fn size(&self, a: usize) -> f64 {
        self.max(a) - self.min(a)
    }

    /// Shortest interval along an axis [m].
    fn step(&self, a: usize) -> f64 {
        let steps = self.lines[a].windows(2).map(|w| w[1] - w[0]);
        steps.fold(f64::MAX, f64::min)
    }

    /// Shortest cell edge [m].
    pub fn h(&self) -> f64 {
        (0..self.dim).map(|a| self.step(a)).fold(f64::MAX, f64::min)
    }

    /// Shortest side of the box [m].
    pub fn least(&self) -> f64 {
        (0..self.dim).map(|a| self.size(a)).fold(f64::MAX, f64::min)
    }

    /// Diagonal of the box [m].
    pub fn diagonal(&self) -> f64 {
        (0..self.dim)
            .map(|a| self.size(a).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// The place at fractions of the box between two bounds.
    pub fn place(&self, low: f64, high: f64, s: &mut Stream) -> Vec<f64> {
        let at = |a| self.min(a) + s.between(low, high) * self.size(a);
        (0..self.dim).map(at).collect()
    }

    /// Number of a grid line inside the body.
    pub fn inner(&self, a: usize, s: &mut Stream) -> usize {
        s.whole(1, self.lines[a].len() - 2)
    }

    /// Diagonal of the largest cell [m].
    pub fn cell(&self) -> f64 {
        let longest = |a: usize| {
            let steps = self.lines[a].windows(2).map(|w| w[1] - w[0]);
            steps.fold(0.0, f64::max)
        };
        (0..self.dim)
            .map(|a| longest(a).powi(2))
            .sum::<f64>()
            .sqrt()
    }
}

/// Log-uniform between two powers of ten.
pub fn decades(s: &mut Stream, low: f64, high: f64) -> f64 {
    10f64.powf(s.between(low, high))
}

/// 0 in one draw of seven, otherwise ± log-uniform.
pub fn offset(s: &mut Stream, low: f64, high: f64) -> f64 {
    let (none, size, negative) = (s.chance(1.0 / 7.0), decades(s, low, high), s.chance(0.5));
    match (none, negative) {
        (true, _) => 0.0,
        (_, true) => -size,
        _ => size,
    }
}

/// Numbers as TOML: Rust's shortest form that is read back to the same bits.
pub fn list(values: &[f64]) -> String {
    format!("{values:?}")
}
