//! Verdict = claim × check of the algebra × check of the mesh. Methods claim, [`residuals`](stickslip_methods::residuals) checks, nobody else judges.

mod text;

pub use text::NoVerdict;

use std::cmp::Reverse;
use std::fmt;

use serde::{Deserialize, Serialize};
use stickslip_methods::{Claim, MethodError, Outcome, Residuals, Status, Tier};

use crate::case::Case;

/// Largest backward error of equilibrium after a direct solve; above it a violation does not measure contact alone.
pub const EQUILIBRIUM: f64 = 1e-12;

/// Violations up to this multiple of the rounding of W P may be nothing else.
const DROWNED: f64 = 10.0;

/// Accuracy of a run, as bounds on [`Residuals::violation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Asked of the method.
    pub asked: f64,
    /// Accepted by the judge; not below what was asked.
    pub accepted: f64,
}

impl Accuracy {
    /// Accepts what is asked for.
    pub fn exactly(tolerance: f64) -> Self {
        Self {
            asked: tolerance,
            accepted: tolerance,
        }
    }

    /// That of the case.
    pub fn own(case: &Case) -> Self {
        Self::of(case, case.target.tier())
    }

    /// A tier on a case: its own tier asks for its own tolerance, any other replaces that.
    pub fn of(case: &Case, tier: Tier) -> Self {
        let asked = if tier == case.target.tier() {
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

/// Worth of a run. Files hold it as the text that `Display` writes and `FromStr` reads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Verdict {
    /// Claimed the contact laws and the judge agrees.
    Solved,
    /// The same, and another answer to the same problem holds as well: see [`mark_several`](crate::studies::several::mark_several).
    Several,
    /// Solved its own laws, as the judge agrees; it found the contact laws held to this tier, or to none.
    Approximate(Option<Tier>),
    /// Claimed the contact laws and the judge disagrees.
    FalseClaim,
    /// Ended without a claim, with one of [`GIVE_UPS`].
    GaveUp(Status),
    /// Solved what the mesh holds of the case, as the judge of the algebra agrees; the judge of the mesh says what is wrong
    /// with that.
    Suspect(String),
    /// Declined the system, with the reason.
    Refused(String),
    /// Failed with an error.
    Crashed(String),
    /// Stopped from outside at the time limit.
    TimedOut,
    /// Was denied memory, by the system or by a limit.
    OutOfMemory,
}

/// Meaning of a kind of verdict for a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// The run did what it said.
    Honest,
    /// The method ended with a claim, right or wrong.
    Claims,
    /// A method that was to solve a case did not.
    Failure,
    /// The method or the program is wrong.
    Wrong,
    /// Time or memory ended the run.
    Limit,
}

/// Declares [`VerdictKind`] with names and marks, so that no list of all kinds can lack one.
macro_rules! verdict_kinds {
    ($($kind:ident = $name:literal: $($mark:ident)*,)*) => {
        /// A [`Verdict`] without its details.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs, reason = "as in `Verdict`")]
        pub enum VerdictKind { $($kind,)* }

        impl VerdictKind {
            /// All kinds, as a reader meets them.
            pub const ALL: &'static [Self] = &[$(Self::$kind,)*];

            /// The text of a verdict up to its details.
            pub fn name(self) -> &'static str {
                match self { $(Self::$kind => $name,)* }
            }

            fn has(self, mark: Mark) -> bool {
                let marks: &[Mark] = match self { $(Self::$kind => &[$(Mark::$mark),*],)* };
                marks.contains(&mark)
            }
        }
    };
}

verdict_kinds! {
    Solved = "solved": Honest Claims,
    Approximate = "approximate": Honest Claims,
    FalseClaim = "false-claim": Claims Failure Wrong,
    GaveUp = "gave-up": Failure,
    Suspect = "suspect mesh": Failure Wrong,
    Refused = "refused": ,
    Crashed = "crashed": Failure Wrong,
    TimedOut = "timed-out": Failure Limit,
    OutOfMemory = "out-of-memory": Failure Limit,
}

/// How a method ends without a claim: every status but the first, which is that of a claim.
pub const GIVE_UPS: &[Status] = match Status::ALL {
    [Status::Converged, rest @ ..] => rest,
    all => all,
};

/// Words of tables in place of a verdict where there is no such run.
pub const NOT_RUN: &str = "not run";

impl Verdict {
    /// Judges an outcome against the violation accepted.
    pub fn of(outcome: &Outcome, found: &Residuals, accepted: f64) -> Self {
        // NaN passes no comparison.
        let as_claimed = found.claimed_equilibrium <= EQUILIBRIUM && found.claimed <= accepted;
        let solved = found.equilibrium <= EQUILIBRIUM && found.violation <= accepted;
        // Own laws may leave a residual in equilibrium too; it counts like that of the contact laws.
        let holds = |tier: &Tier| {
            let tolerance = tier.tolerance();
            found.equilibrium <= tolerance && found.violation <= tolerance
        };
        // No tier where rounding may hide as much, nor a false claim where it may be all there is.
        let drowned = found.rounding > accepted && found.violation <= DROWNED * found.rounding;
        match (outcome.status, outcome.claim) {
            (Status::Converged, Claim::Exact) if drowned => Verdict::GaveUp(Status::Rounding),
            (Status::Converged | Status::Rounding, _) if as_claimed && solved => Verdict::Solved,
            (Status::Converged, Claim::Exact) => Verdict::FalseClaim,
            (Status::Converged, _) if as_claimed => {
                Verdict::Approximate(Tier::ALL.into_iter().rev().find(holds))
            }
            (Status::Converged, _) => Verdict::FalseClaim,
            (status, _) => Verdict::GaveUp(status),
        }
    }

    /// The text in a table that has rows for missing runs too.
    pub fn or_not_run(verdict: Option<&Self>) -> String {
        verdict.map_or_else(|| NOT_RUN.to_owned(), Self::to_string)
    }

    /// Without details.
    pub fn kind(&self) -> VerdictKind {
        match self {
            Verdict::Solved | Verdict::Several => VerdictKind::Solved,
            Verdict::Approximate(_) => VerdictKind::Approximate,
            Verdict::FalseClaim => VerdictKind::FalseClaim,
            Verdict::GaveUp(_) => VerdictKind::GaveUp,
            Verdict::Suspect(_) => VerdictKind::Suspect,
            Verdict::Refused(_) => VerdictKind::Refused,
            Verdict::Crashed(_) => VerdictKind::Crashed,
            Verdict::TimedOut => VerdictKind::TimedOut,
            Verdict::OutOfMemory => VerdictKind::OutOfMemory,
        }
    }

    /// Place from best to worst; verdicts that differ in words alone share one.
    pub fn rank(&self) -> (usize, Reverse<Option<Tier>>) {
        let (place, held) = match self {
            Verdict::Solved | Verdict::Several => (0, None),
            Verdict::Approximate(tier) => (1, *tier),
            Verdict::Refused(_) => (2, None),
            Verdict::GaveUp(_) => (3, None),
            Verdict::TimedOut => (4, None),
            Verdict::OutOfMemory => (5, None),
            Verdict::Crashed(_) => (6, None),
            Verdict::Suspect(_) => (7, None),
            // The only one that deceives.
            Verdict::FalseClaim => (8, None),
        };
        (place, Reverse(held))
    }

    /// True if the contact laws hold as claimed.
    pub fn is_solved(&self) -> bool {
        self.kind() == VerdictKind::Solved
    }

    /// True if the run did what it said: its times may be published.
    pub fn is_honest(&self) -> bool {
        self.kind().has(Mark::Honest)
    }

    /// True if the method ended with a claim, right or wrong.
    pub fn claims(&self) -> bool {
        self.kind().has(Mark::Claims)
    }

    /// True if the laws claimed hold as claimed, and the contact laws to that tier as far as a verdict tells: that of a
    /// solved run was asked for.
    pub fn holds_to(&self, tier: Tier) -> bool {
        match self {
            Verdict::Approximate(reached) => reached.is_some_and(|reached| reached >= tier),
            other => other.is_honest(),
        }
    }

    /// True if the command must report failure where all methods were asked to solve a case.
    pub fn is_failure(&self) -> bool {
        self.kind().has(Mark::Failure)
    }

    /// True if the method or the program is wrong. Giving up is not, nor is a limit: where methods are compared both are
    /// results.
    pub fn is_wrong(&self) -> bool {
        self.kind().has(Mark::Wrong)
    }
}

impl VerdictKind {
    /// True if time or memory ended the run: it says something about these alone.
    pub fn is_limit(self) -> bool {
        self.has(Mark::Limit)
    }
}

impl From<MethodError> for Verdict {
    fn from(error: MethodError) -> Self {
        match error {
            MethodError::OutOfMemory { .. } => Verdict::OutOfMemory,
            MethodError::TimeLimit => Verdict::TimedOut,
            MethodError::Refused { reason } => Verdict::Refused(reason),
            // A problem without a scale, or too large for a full W, by the fault of no method.
            MethodError::RigidContact | MethodError::TooManyRows { .. } => {
                Verdict::Refused(error.to_string())
            }
            other => Verdict::Crashed(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_methods::{ContactState, Counters};

    #[test]
    fn verdicts_have_an_order() {
        let order = [
            "solved",
            "approximate: high",
            "approximate: mid",
            "approximate: low",
            "approximate: none",
            "refused: no friction",
            "gave-up: stalled",
            "timed-out",
            "out-of-memory",
            "crashed: why",
            "suspect mesh: why",
            "false-claim",
        ]
        .map(|text| text.parse::<Verdict>().unwrap().rank());
        assert!(order.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn an_error_of_memory_is_no_crash() {
        let what = "sparse factorisation";
        let denied = MethodError::OutOfMemory { what };
        assert_eq!(Verdict::from(denied), Verdict::OutOfMemory);
        // Words do not make one.
        let reason = "out of memory".to_owned();
        let words = MethodError::Kernel { what, reason };
        let crashed = "crashed: sparse factorisation failed: out of memory";
        assert_eq!(Verdict::from(words).to_string(), crashed);
    }

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

    fn found(violation: f64, equilibrium: f64) -> Residuals {
        Residuals {
            equilibrium,
            claimed_equilibrium: equilibrium,
            claimed: violation,
            violation,
            ..Default::default()
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
        // A small natural map excuses nothing.
        let overlap = Residuals {
            natural_map: 1e-10,
            ..found(1e-6, 1e-14)
        };
        let verdict = Verdict::of(&converged, &overlap, 1e-9);
        assert_eq!(verdict, Verdict::FalseClaim);
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
