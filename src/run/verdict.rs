//! Verdict = claim × check. Methods claim, [`residuals`](stickslip_methods::residuals) checks, nobody else judges.

use std::fmt;

use stickslip_methods::{Claim, Outcome, Residuals, Status, Tier};

use crate::case::Case;

/// Largest backward error of equilibrium after a direct solve; above it the natural map does not measure contact alone.
pub const EQUILIBRIUM: f64 = 1e-12;

/// Accuracy of a run, as bounds on the natural map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Asked of the method.
    pub asked: f64,
    /// Accepted by the judge; not below what was asked.
    pub accepted: f64,
}

impl Accuracy {
    /// What is asked for is what is accepted.
    pub fn exactly(tolerance: f64) -> Self {
        Self {
            asked: tolerance,
            accepted: tolerance,
        }
    }

    /// A tier on a case: its own tier asks for its own tolerance, any other replaces that.
    pub fn of(case: &Case, tier: Tier) -> Self {
        let asked = if tier == case.tier {
            case.tolerance
        } else {
            tier.tolerance()
        };
        Self {
            asked,
            accepted: tier.tolerance(),
        }
    }
}

impl fmt::Display for Accuracy {
    /// The name of a tier, or the bound.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tiers = Tier::ALL.into_iter();
        match tiers.into_iter().find(|t| t.tolerance() == self.accepted) {
            Some(tier) => write!(f, "{tier}"),
            None => write!(f, "{:e}", self.accepted),
        }
    }
}

/// What a run is worth.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Claimed the contact laws and the judge agrees.
    Solved,
    /// Solved its own laws, as the judge agrees; it found the contact laws held to this tier, or to none.
    Approximate(Option<Tier>),
    /// Claimed the contact laws and the judge disagrees.
    FalseClaim,
    /// Ended without a claim.
    GaveUp(Status),
    /// Declined the system, with the reason.
    Refused(String),
    /// Failed with an error.
    Crashed(String),
    /// Stopped from outside at the time limit.
    TimedOut,
    /// Ended at the memory limit.
    OutOfMemory,
}

impl Verdict {
    /// Judges an outcome against the natural map accepted.
    pub fn of(outcome: &Outcome, found: &Residuals, accepted: f64) -> Self {
        // NaN passes no comparison.
        let as_claimed = found.claimed_equilibrium <= EQUILIBRIUM && found.claimed <= accepted;
        let solved = found.equilibrium <= EQUILIBRIUM && found.natural_map <= accepted;
        // Own laws may leave a residual in equilibrium too; it counts like that of the contact laws.
        let holds = |tier: &Tier| {
            let tolerance = tier.tolerance();
            found.equilibrium <= tolerance && found.natural_map <= tolerance
        };
        match (outcome.status, outcome.claim) {
            (Status::Converged, _) if as_claimed && solved => Verdict::Solved,
            (Status::Converged, Claim::Exact) => Verdict::FalseClaim,
            (Status::Converged, _) if as_claimed => {
                Verdict::Approximate(Tier::ALL.into_iter().rev().find(holds))
            }
            (Status::Converged, _) => Verdict::FalseClaim,
            (status, _) => Verdict::GaveUp(status),
        }
    }

    /// An error, or that it ran out of memory, which libraries tell in words only: "memory allocation of … failed" (the
    /// runtime), "out of memory" and `OutOfMemory` (the sparse factorisation).
    pub fn failed(error: String) -> Self {
        let words = ["memory allocation of", "out of memory", "OutOfMemory"];
        if words.iter().any(|words| error.contains(words)) {
            Verdict::OutOfMemory
        } else {
            Verdict::Crashed(error)
        }
    }

    /// True if the run did what it said: its times may be published.
    pub fn is_honest(&self) -> bool {
        matches!(self, Verdict::Solved | Verdict::Approximate(_))
    }

    /// True if the command must report failure.
    pub fn is_failure(&self) -> bool {
        matches!(
            self,
            Verdict::FalseClaim
                | Verdict::GaveUp(_)
                | Verdict::Crashed(_)
                | Verdict::TimedOut
                | Verdict::OutOfMemory
        )
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Solved => write!(f, "solved"),
            Verdict::Approximate(Some(tier)) => write!(f, "approximate: {tier}"),
            Verdict::Approximate(None) => write!(f, "approximate: none"),
            Verdict::FalseClaim => write!(f, "false-claim"),
            Verdict::GaveUp(status) => write!(f, "gave-up: {status}"),
            Verdict::Refused(reason) => write!(f, "refused: {reason}"),
            Verdict::Crashed(error) => write!(f, "crashed: {error}"),
            Verdict::TimedOut => write!(f, "timed-out"),
            Verdict::OutOfMemory => write!(f, "out-of-memory"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_methods::{ContactState, Counters};

    fn outcome(status: Status, claim: Claim) -> Outcome {
        Outcome {
            status,
            claim,
            state: ContactState {
                u: vec![],
                p: vec![],
            },
            history: vec![],
            counters: Counters::default(),
        }
    }

    fn found(natural_map: f64, equilibrium: f64) -> Residuals {
        Residuals {
            equilibrium,
            claimed_equilibrium: equilibrium,
            claimed: natural_map,
            penetration: 0.0,
            adhesion: 0.0,
            complementarity: 0.0,
            cone: 0.0,
            slip_direction: 0.0,
            natural_map,
        }
    }

    #[test]
    fn a_claim_counts_only_if_the_judge_agrees() {
        let converged = outcome(Status::Converged, Claim::Exact);
        assert_eq!(
            Verdict::of(&converged, &found(1e-10, 1e-14), 1e-9),
            Verdict::Solved
        );
        for (map, equilibrium) in [
            (1e-8, 1e-14),
            (1e-10, 1e-9),
            (f64::NAN, 1e-14),
            (1e-10, f64::NAN),
        ] {
            let verdict = Verdict::of(&converged, &found(map, equilibrium), 1e-9);
            assert_eq!(verdict, Verdict::FalseClaim);
            assert!(!verdict.is_honest() && verdict.is_failure());
        }
        let stalled = outcome(Status::Stalled, Claim::Exact);
        assert_eq!(
            Verdict::of(&stalled, &found(1e-15, 0.0), 1e-3),
            Verdict::GaveUp(Status::Stalled)
        );
    }

    #[test]
    fn an_approximate_claim_is_held_to_its_own_laws_and_graded_by_the_tier_it_reaches() {
        let claim = Claim::Penalised {
            normal: 1.0,
            tangential: 1.0,
        };
        let converged = outcome(Status::Converged, claim);
        let held = |map, equilibrium| Residuals {
            claimed: 1e-10,
            claimed_equilibrium: 1e-14,
            ..found(map, equilibrium)
        };
        let grade = |map| Verdict::of(&converged, &held(map, 1e-14), 1e-9);
        // A consistency term that equilibrium does not know is graded like a violated law, and never solved.
        let of =
            |map, equilibrium, accepted| Verdict::of(&converged, &held(map, equilibrium), accepted);
        assert_eq!(of(1e-10, 1e-5, 1e-3), Verdict::Approximate(Some(Tier::Low)));
        assert_eq!(of(1e-5, 1e-2, 1e-3), Verdict::Approximate(None));
        assert_eq!(grade(1e-4), Verdict::Approximate(Some(Tier::Low)));
        assert_eq!(grade(1e-2), Verdict::Approximate(None));
        assert_eq!(grade(1e-10), Verdict::Solved);
        for (own_law, equilibrium) in [(1e-10, 1e-3), (1e-8, 1e-14), (f64::NAN, 1e-14)] {
            let broken = Residuals {
                claimed: own_law,
                claimed_equilibrium: equilibrium,
                ..found(1e-4, equilibrium)
            };
            let verdict = Verdict::of(&converged, &broken, 1e-9);
            assert_eq!(verdict, Verdict::FalseClaim);
        }
    }
}
