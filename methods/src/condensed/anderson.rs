//! Anderson acceleration of a fixed point a = G(a) (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715).
//! ```text
//! f = G(a) − a,   γ = argmin |f − ΔF γ|,   a <- max(G(a) − ΔG γ, least)
//! ```
//! The columns of ΔF and ΔG are the last differences of f and G(a). Along a difference with Δf·Δa >= 0 the map expands and
//! the secant would lead back to where the iteration flees from: then all differences are dropped and the plain step is taken.

use crate::algebra::dense::{DenseLu, norm, refill};

/// Ridge on the normal equations, relative to their trace: differences may depend on each other.
const RIDGE: f64 = 1e-12;
/// Growth of |f| after which all differences are dropped: they belong to another piece of G.
const GROWTH: f64 = 2.0;

/// One image of the iteration.
#[derive(Clone)]
struct Image {
    f: Vec<f64>,
    /// G(a).
    g: Vec<f64>,
}

impl Image {
    /// Δf by entry.
    fn df<'a>(&'a self, before: &'a Image) -> impl Iterator<Item = f64> {
        self.f.iter().zip(&before.f).map(|(new, old)| new - old)
    }

    /// ΔG by entry.
    fn dg<'a>(&'a self, before: &'a Image) -> impl Iterator<Item = f64> {
        self.g.iter().zip(&before.g).map(|(new, old)| new - old)
    }
}

/// Memory of a fixed-point iteration, which is asked for at its start.
pub(crate) struct Anderson {
    /// Differences kept; 0 leaves the iteration as it is.
    depth: usize,
    /// Least entry of a.
    least: f64,
    /// a whose image comes next; empty before the first.
    a: Vec<f64>,
    /// The last images, the newest at the end, and how many count: one more than there are differences.
    images: Vec<Image>,
    count: usize,
    /// Normal equations of γ.
    normal: DenseLu,
    right: Vec<f64>,
    /// γ; empty if the differences vanish.
    gamma: Vec<f64>,
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
            a: Vec::new(),
            images: Vec::new(),
            count: 0,
            normal: DenseLu::with_room(depth),
            right: Vec::with_capacity(depth),
            gamma: Vec::with_capacity(depth),
        }
    }

    /// The next a in place of the image of the one before; the first image is the start itself.
    pub fn next(&mut self, a: &mut [f64]) {
        if self.a.is_empty() {
            self.a = a.to_vec();
            let (f, g) = (vec![0.0; a.len()], vec![0.0; a.len()]);
            self.images = vec![Image { f, g }; self.depth + 1];
            return;
        }
        self.learn(a);
        self.fit();
        for (pair, gamma) in self.counted().windows(2).zip(&self.gamma) {
            let entries = a.iter_mut().zip(pair[1].dg(&pair[0]));
            entries.for_each(|(a, dg)| *a -= gamma * dg);
        }
        a.iter_mut().for_each(|a| *a = a.max(self.least));
        self.a.copy_from_slice(a);
    }

    /// The images that count.
    fn counted(&self) -> &[Image] {
        &self.images[self.images.len() - self.count..]
    }

    fn learn(&mut self, image: &[f64]) {
        self.images.rotate_left(1);
        self.count = (self.count + 1).min(self.images.len());
        if let Some(new) = self.images.last_mut() {
            new.g.copy_from_slice(image);
            refill(&mut new.f, image.iter().zip(&self.a).map(|(g, a)| g - a));
        }
        if let [.., before, new] = self.counted() {
            let both = new.df(before).zip(new.dg(before));
            let expands = both.map(|(df, dg)| df * (dg - df)).sum::<f64>() >= 0.0;
            if expands || norm(&new.f) > GROWTH * norm(&before.f) {
                self.count = 1;
            }
        }
    }

    /// γ, from the normal equations.
    fn fit(&mut self) {
        let images = &self.images[self.images.len() - self.count..];
        let differences = self.count - 1;
        let df = |i: usize| images[i + 1].df(&images[i]);
        let product = |i: usize, j: usize| df(i).zip(df(j)).map(|(a, b)| a * b).sum::<f64>();
        let trace: f64 = (0..differences).map(|i| product(i, i)).sum();
        let normal = self.normal.zeros(differences);
        for i in 0..differences {
            for j in 0..differences {
                normal[(i, j)] = product(i, j) + if i == j { RIDGE * trace } else { 0.0 };
            }
        }
        let f = &images[differences].f;
        let right = |i: usize| df(i).zip(f).map(|(df, f)| df * f).sum::<f64>();
        refill(&mut self.right, (0..differences).map(right));
        if !self.normal.factor() || !self.normal.solve_into(&self.right, &mut self.gamma) {
            self.gamma.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::dense::minus;

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
        let mut a = vec![0.0; 3];
        anderson.next(&mut a);
        for _ in 0..steps {
            a = image(&a);
            anderson.next(&mut a);
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
        let mut a = [0.0];
        anderson.next(&mut a);
        for _ in 0..12 {
            a[0] = (1.3 * a[0] + 1.0_f64).min(10.0);
            anderson.next(&mut a);
        }
        assert!((a[0] - 10.0).abs() < 1e-12, "{a:?}");
    }

    #[test]
    fn depth_0_is_the_plain_iteration_and_a_stays_non_negative() {
        let next = |anderson: &mut Anderson, mut a: Vec<f64>| {
            anderson.next(&mut a);
            a
        };
        let mut plain = Anderson::new(0);
        next(&mut plain, vec![1.0, 2.0]);
        assert_eq!(next(&mut plain, vec![4.0, 3.0]), [4.0, 3.0]);
        assert_eq!(next(&mut plain, vec![2.0, 5.0]), [2.0, 5.0]);
        let mut deep = Anderson::new(2);
        next(&mut deep, vec![1.0]);
        next(&mut deep, vec![0.5]);
        // f halves and the secant leads to −1.
        assert_eq!(next(&mut deep, vec![0.2]), [0.0]);
    }
}
