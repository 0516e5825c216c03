//! Anderson acceleration of a fixed point a = G(a) (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715).
//! ```text
//! f = G(a) − a,   γ = argmin |f − ΔF γ|,   a <- max(G(a) − ΔG γ, least)
//! ```
//! The columns of ΔF and ΔG are the last differences of f and G(a). Along a difference with Δf·Δa >= 0 the map expands and
//! the secant would lead back to where the iteration flees from: then all differences are dropped and the plain step is taken.

use faer::Mat;

use crate::algebra::dense::{dot, minus, norm, solve_dense};

/// Ridge on the normal equations, relative to their trace: differences may depend on each other.
const RIDGE: f64 = 1e-12;
/// Growth of |f| after which all differences are dropped: they belong to another piece of G.
const GROWTH: f64 = 2.0;

/// What a fixed-point iteration has learnt.
#[derive(Debug)]
pub(crate) struct Anderson {
    /// Differences kept; 0 leaves the iteration as it is.
    depth: usize,
    /// Least entry of a.
    least: f64,
    /// a whose image comes next; none before the first.
    a: Option<Vec<f64>>,
    /// (f, G(a)) of the image before.
    last: Option<(Vec<f64>, Vec<f64>)>,
    /// (Δf, ΔG), oldest first.
    differences: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Anderson {
    /// Keeps `depth` differences of an iteration on numbers that are not negative.
    pub fn new(depth: usize) -> Self {
        Self::above(0.0, depth)
    }

    /// The same for an iteration on any numbers.
    pub fn unbounded(depth: usize) -> Self {
        Self::above(f64::NEG_INFINITY, depth)
    }

    fn above(least: f64, depth: usize) -> Self {
        Self {
            depth,
            least,
            a: None,
            last: None,
            differences: Vec::new(),
        }
    }

    /// The next a, from the image of the one returned before; the first image is the start itself.
    pub fn next(&mut self, image: Vec<f64>) -> Vec<f64> {
        let mut next = image.clone();
        if let Some(a) = &self.a {
            let f = minus(&image, a);
            self.learn(&f, &image);
            let gamma = self.coefficients(&f).unwrap_or_default();
            for ((_, dg), gamma) in self.differences.iter().zip(gamma) {
                next.iter_mut().zip(dg).for_each(|(a, dg)| *a -= gamma * dg);
            }
            next.iter_mut().for_each(|a| *a = a.max(self.least));
            self.last = Some((f, image));
        }
        self.a = Some(next.clone());
        next
    }

    fn learn(&mut self, f: &[f64], image: &[f64]) {
        let Some((f_before, image_before)) = &self.last else {
            return;
        };
        let (df, dg) = (minus(f, f_before), minus(image, image_before));
        let expands = dot(&df, &minus(&dg, &df)) >= 0.0;
        if expands || norm(f) > GROWTH * norm(f_before) {
            self.differences.clear();
            return;
        }
        self.differences.push((df, dg));
        if self.differences.len() > self.depth {
            self.differences.remove(0);
        }
    }

    /// γ; `None` if the differences vanish.
    fn coefficients(&self, f: &[f64]) -> Option<Vec<f64>> {
        let d = &self.differences;
        let trace: f64 = d.iter().map(|(df, _)| dot(df, df)).sum();
        let normal = Mat::from_fn(d.len(), d.len(), |i, j| {
            dot(&d[i].0, &d[j].0) + if i == j { RIDGE * trace } else { 0.0 }
        });
        let right: Vec<f64> = d.iter().map(|(df, _)| dot(df, f)).collect();
        solve_dense(normal, &right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// G(a) = b + M a with eigenvalues of M up to 0.95.
    fn image(a: &[f64]) -> Vec<f64> {
        let b = [3.0, 1.0, 2.0];
        let m = [[0.6, 0.3, 0.05], [0.2, 0.5, 0.2], [0.1, 0.3, 0.5]];
        (0..3)
            .map(|i| b[i] + (0..3).map(|j| m[i][j] * a[j]).sum::<f64>())
            .collect()
    }

    fn error_after(depth: usize, steps: usize) -> f64 {
        let mut anderson = Anderson::new(depth);
        let mut a = anderson.next(vec![0.0; 3]);
        for _ in 0..steps {
            a = anderson.next(image(&a));
        }
        norm(&minus(&image(&a), &a)) / norm(&a)
    }

    #[test]
    fn a_linear_fixed_point_is_found_after_as_many_steps_as_it_has_unknowns() {
        assert!(error_after(5, 5) < 1e-6, "{:e}", error_after(5, 5));
        assert!(error_after(0, 5) > 1e-2, "{:e}", error_after(0, 5));
    }

    /// G(a) = min(1.3 a + 1, 10): from 0 the iteration climbs faster and faster up to 10, away from −10/3.
    #[test]
    fn an_expanding_map_is_followed_and_not_fled() {
        let mut anderson = Anderson::new(5);
        let mut a = anderson.next(vec![0.0]);
        for _ in 0..12 {
            a = anderson.next(vec![(1.3 * a[0] + 1.0).min(10.0)]);
        }
        assert!((a[0] - 10.0).abs() < 1e-12, "{a:?}");
    }

    #[test]
    fn depth_0_is_the_plain_iteration_and_a_stays_non_negative() {
        let mut plain = Anderson::new(0);
        plain.next(vec![1.0, 2.0]);
        assert_eq!(plain.next(vec![4.0, 3.0]), [4.0, 3.0]);
        assert_eq!(plain.next(vec![2.0, 5.0]), [2.0, 5.0]);
        let mut deep = Anderson::new(2);
        deep.next(vec![1.0]);
        deep.next(vec![0.5]);
        // f halves and the secant leads to −1.
        assert_eq!(deep.next(vec![0.2]), [0.0]);
    }
}
