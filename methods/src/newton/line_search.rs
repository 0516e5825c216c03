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
