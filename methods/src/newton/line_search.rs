//! Non-monotone acceptance of Newton steps (Grippo, Lampariello & Lucidi 1986).

/// A step may raise the merit as long as it stays below the largest of this many values before it.
const MEMORY: usize = 5;
/// Sufficient decrease asked of a shortened step (Armijo).
const DECREASE: f64 = 1e-4;
/// Halvings before the full step is taken after all: at a kink no short step may descend, and full steps leave it.
const HALVINGS: usize = 8;

/// Merits of the last accepted iterates.
#[derive(Debug, Default)]
pub(crate) struct LineSearch {
    /// The last one first; 0 where there is none, which bounds nothing.
    recent: [f64; MEMORY],
}

impl LineSearch {
    /// Notes the merit of the current iterate.
    pub fn record(&mut self, merit: f64) {
        self.recent.rotate_right(1);
        self.recent[0] = merit;
    }

    /// Length of the step to take; `merit(t)` evaluates a trial. The full step is tried first, and shortened only if
    /// it raises the merit above all recent ones.
    pub fn length(&self, mut merit: impl FnMut(f64) -> f64) -> f64 {
        let mut t = 1.0;
        for _ in 0..=HALVINGS {
            if self.accepts(t, merit(t)) {
                return t;
            }
            t *= 0.5;
        }
        1.0
    }

    fn accepts(&self, t: f64, merit: f64) -> bool {
        let bound = self.recent.into_iter().fold(0.0, f64::max);
        // Strictly below: a cycle of full steps between equal merits must not pass for ever.
        merit <= (1.0 - 2.0 * DECREASE * t) * bound
    }

    /// The same, but a step that is shortened ends at the least merit on its way: between two of the `kinks`, given in
    /// increasing order, that is the vertex of a parabola.
    pub fn exact(&self, kinks: &[f64], mut merit: impl FnMut(f64) -> f64) -> f64 {
        let full = merit(1.0);
        let now = self.recent[0];
        if self.accepts(1.0, full) {
            return 1.0;
        }
        let (mut left, mut best) = ((0.0, now), (1.0, full));
        for &t in kinks.iter().chain(&[1.0]) {
            let (middle, half) = (0.5 * (left.0 + t), 0.5 * (t - left.0));
            let right = (t, merit(t));
            let curvature = left.1 - 2.0 * merit(middle) + right.1;
            let vertex = -0.5 * (right.1 - left.1) / curvature;
            let mut candidates = vec![right];
            if curvature > 0.0 && vertex.abs() < 1.0 {
                let t = middle + vertex * half;
                candidates.push((t, merit(t)));
            }
            best = candidates
                .into_iter()
                .fold(best, |best, at| if at.1 < best.1 { at } else { best });
            left = right;
        }
        match best.1 <= (1.0 - 2.0 * DECREASE * best.0) * now {
            true => best.0,
            false => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_shortened_only_after_a_rise_above_all_recent_merits() {
        let mut search = LineSearch::default();
        [4.0, 1.0].iter().for_each(|m| search.record(*m));
        assert_eq!(
            search.length(|_| 3.0),
            1.0,
            "a rise below the largest recent merit is accepted"
        );
        assert_eq!(
            search.length(|t| 16.0 * t * t),
            0.25,
            "first sufficient decrease"
        );
        assert_eq!(search.length(|_| 9.0), 1.0, "no descent at all: full step");
        [1.0; 4].iter().for_each(|m| search.record(*m));
        assert_eq!(search.length(|t| 3.0 * t), 0.25, "old merits are forgotten");
    }
}
