//! Verdict = claim × check. Methods claim, [`residuals`](stickslip_methods::residuals) checks, nobody else judges.

use std::fmt;

use stickslip_methods::{Claim, Outcome, Residuals, Status, Tier};

/// Largest backward error of equilibrium after a direct solve; above it the natural map does not measure contact alone.
pub const EQUILIBRIUM: f64 = 1e-12;

/// What a run is worth.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Claimed the contact laws and the judge agrees.
    Solved(Tier),
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
}

impl Verdict {
    /// Judges an outcome against the tier asked for.
    pub fn of(outcome: &Outcome, found: &Residuals, tier: Tier) -> Self {
        // NaN passes no comparison.
        let as_claimed =
            found.claimed_equilibrium <= EQUILIBRIUM && found.claimed <= tier.tolerance();
        let solved = found.equilibrium <= EQUILIBRIUM && found.natural_map <= tier.tolerance();
        // Own laws may leave a residual in equilibrium too; it counts like that of the contact laws.
        let holds = |tier: &Tier| {
            let tolerance = tier.tolerance();
            found.equilibrium <= tolerance && found.natural_map <= tolerance
        };
        match (outcome.status, outcome.claim) {
            (Status::Converged, _) if as_claimed && solved => Verdict::Solved(tier),
            (Status::Converged, Claim::Exact) => Verdict::FalseClaim,
            (Status::Converged, _) if as_claimed => {
                Verdict::Approximate(Tier::ALL.into_iter().rev().find(holds))
            }
            (Status::Converged, _) => Verdict::FalseClaim,
            (status, _) => Verdict::GaveUp(status),
        }
    }

    /// True if the run did what it said: its times may be published.
    pub fn is_honest(&self) -> bool {
        matches!(self, Verdict::Solved(_) | Verdict::Approximate(_))
    }

    /// True if the command must report failure.
    pub fn is_failure(&self) -> bool {
        matches!(
            self,
            Verdict::FalseClaim | Verdict::GaveUp(_) | Verdict::Crashed(_)
        )
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Solved(_) => write!(f, "solved"),
            Verdict::Approximate(Some(tier)) => write!(f, "approximate: {tier}"),
            Verdict::Approximate(None) => write!(f, "approximate: none"),
            Verdict::FalseClaim => write!(f, "false-claim"),
            Verdict::GaveUp(status) => write!(f, "gave-up: {status}"),
            Verdict::Refused(reason) => write!(f, "refused: {reason}"),
            Verdict::Crashed(error) => write!(f, "crashed: {error}"),
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
            Verdict::of(&converged, &found(1e-10, 1e-14), Tier::High),
            Verdict::Solved(Tier::High)
        );
        for (map, equilibrium) in [
            (1e-8, 1e-14),
            (1e-10, 1e-9),
            (f64::NAN, 1e-14),
            (1e-10, f64::NAN),
        ] {
            let verdict = Verdict::of(&converged, &found(map, equilibrium), Tier::High);
            assert_eq!(verdict, Verdict::FalseClaim);
            assert!(!verdict.is_honest() && verdict.is_failure());
        }
        let stalled = outcome(Status::Stalled, Claim::Exact);
        assert_eq!(
            Verdict::of(&stalled, &found(1e-15, 0.0), Tier::Low),
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
        let grade = |map| Verdict::of(&converged, &held(map, 1e-14), Tier::High);
        // A consistency term that equilibrium does not know is graded like a violated law, and never solved.
        let of = |map, equilibrium, tier| Verdict::of(&converged, &held(map, equilibrium), tier);
        assert_eq!(
            of(1e-10, 1e-5, Tier::Low),
            Verdict::Approximate(Some(Tier::Low))
        );
        assert_eq!(of(1e-5, 1e-2, Tier::Low), Verdict::Approximate(None));
        assert_eq!(grade(1e-4), Verdict::Approximate(Some(Tier::Low)));
        assert_eq!(grade(1e-2), Verdict::Approximate(None));
        assert_eq!(grade(1e-10), Verdict::Solved(Tier::High));
        for (own_law, equilibrium) in [(1e-10, 1e-3), (1e-8, 1e-14), (f64::NAN, 1e-14)] {
            let broken = Residuals {
                claimed: own_law,
                claimed_equilibrium: equilibrium,
                ..found(1e-4, equilibrium)
            };
            let verdict = Verdict::of(&converged, &broken, Tier::High);
            assert_eq!(verdict, Verdict::FalseClaim);
        }
    }
}
