//! A friction spring: one elastic degree of freedom that slides while its force is at a bound.
//!
//! ```text
//!   force F = k (u − s),  lo <= F <= hi;   the slip s follows as soon as F would leave its range
//!   work of an increment ½ (F* + F) Δs,    F* the bound where slip starts: u and the bounds change linearly
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
    /// lo and hi.
    pub bounds: [f64; 2],
    /// ∫ F ds along the path.
    pub dissipation: f64,
}

impl FrictionSpring {
    /// State after an increment that ends at displacement `u`, with force in `[lo, hi]`: backward Euler.
    pub fn step(self, stiffness: f64, u: f64, bounds: [f64; 2]) -> Self {
        let trial = stiffness * (u - self.slip);
        let force = trial.max(bounds[0]).min(bounds[1]);
        let now = FrictionSpring {
            force,
            bounds,
            ..self
        };
        if force == trial {
            return now;
        }
        let slip = u - force / stiffness;
        // Room to the bound at the start, and what a force without slip exceeds it by at the end.
        let bound = self.bounds[usize::from(trial > force)];
        let (room, excess) = ((bound - self.force).abs(), (trial - force).abs());
        let onset = bound + room / (room + excess) * (force - bound);
        FrictionSpring {
            slip,
            dissipation: self.dissipation + 0.5 * (onset + force) * (slip - self.slip),
            ..now
        }
    }

    /// The same state, work counted from here on.
    pub fn rest(self) -> Self {
        FrictionSpring {
            dissipation: 0.0,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bounds ±(¼ + ¼ u): slip starts at u = 1/11 under 3/11 and goes on with 2.75 per u. One increment or many.
    #[test]
    fn the_bound_grows_while_the_spring_slides() {
        let loss = (2.75 / 3.0) * (10.0 / 11.0) * 0.5 * (3.0 / 11.0 + 0.5);
        for parts in [1, 2, 7] {
            let path = (0..=parts).map(|k| f64::from(k) / f64::from(parts));
            let last = path.fold(FrictionSpring::default(), |state, u| {
                let bound = 0.25 + 0.25 * u;
                state.step(3.0, u, [-bound, bound])
            });
            assert!((last.dissipation - loss).abs() < 1e-15, "{parts}");
        }
    }
}
