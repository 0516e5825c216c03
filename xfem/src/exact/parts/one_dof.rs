//! A friction spring: one elastic degree of freedom that slides while its force is at a bound.
//!
//! ```text
//!   force F = k (u − s),  lo <= F <= hi;   the slip s follows as soon as F would leave its range
//! ```
//!
//! Whole problems reduce to it when stress and slip keep their shape: a block that slides rigidly, a crack that slips under
//! uniform stress. For a friction clamp ±μN and an amplitude u₀ of the displacement, a cycle dissipates
//! 4 μN (u₀ − μN/k) if u₀ > μN/k, otherwise nothing.

/// State of a friction spring.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrictionSpring {
    /// Slip s.
    pub slip: f64,
    /// Force F.
    pub force: f64,
    /// Σ F Δs over the increments.
    pub dissipation: f64,
}

impl FrictionSpring {
    /// State after an increment that ends at displacement `u`, with force in `[lo, hi]`: backward Euler.
    pub fn step(self, stiffness: f64, u: f64, [lo, hi]: [f64; 2]) -> Self {
        let trial = stiffness * (u - self.slip);
        let force = trial.max(lo).min(hi);
        let slip = if force == trial {
            self.slip
        } else {
            u - force / stiffness
        };
        FrictionSpring {
            slip,
            force,
            dissipation: self.dissipation + force * (slip - self.slip),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_dissipates_the_area_of_its_loop() {
        let (k, clamp) = (3.0, 0.6);
        for (amplitude, loss) in [
            (0.15, 0.0),
            (0.2, 0.0),
            (0.5, 4.0 * clamp * (0.5 - clamp / k)),
        ] {
            let mut state = FrictionSpring::default();
            let mut cycle = |targets: &[f64]| {
                let before = state.dissipation;
                for u in targets {
                    state = state.step(k, u * amplitude, [-clamp, clamp]);
                    assert!(state.force.abs() <= clamp);
                }
                state.dissipation - before
            };
            cycle(&[1.0]);
            let coarse = cycle(&[-1.0, 1.0]);
            let fine = cycle(&[0.7, 0.1, -0.4, -1.0, -0.9, -0.2, 0.6, 1.0]);
            assert!((coarse - loss).abs() < 1e-15 && (fine - loss).abs() < 1e-15);
        }
    }
}
