//! An increment after its judgement: the outcome, what the judge found, the work and the seconds it took.

use serde::{Deserialize, Serialize};
use stickslip_methods::{Outcome, PointStatus, Residuals};

use crate::run::verdict::Verdict;

/// Result of an increment.
pub struct JudgedIncrement {
    /// Claim × check.
    pub verdict: Verdict,
    /// Work up to its end; `None` if the method never started.
    pub work: Option<Work>,
    /// The judged answer; `None` if the method never started or failed with an error.
    pub judged: Option<Judged>,
    /// `[[u]]` by contact row [m] of an answer that is solved at tier high: what lower tiers leave open is as large as what tells
    /// two answers apart.
    pub jump: Option<Vec<f64>>,
}

/// Work that led to an answer. The first three are shared by all runs on a body.
#[derive(Debug, Clone, Copy)]
pub struct Work {
    /// Factorisations of K so far.
    pub factorisations: usize,
    /// Analysis and factorisation of K [s].
    pub factorisation_s: f64,
    /// Condensation, for methods that need it with that of the traction operator [s].
    pub condensation_s: f64,
    /// Preparation of the method, counted with the first increment [s].
    pub prepare_s: f64,
    /// Time of the method, without what it shares with others [s].
    pub solve: Seconds,
    /// Whether the traction operator was needed.
    pub traction: bool,
}

/// Seconds of a call, without the factorisation and condensation that all runs on a body share.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// All.
    pub total_s: f64,
    /// Enforcement: all but load solves, recovery of displacements and checks of equilibrium, which cost the same whatever
    /// the method.
    pub enforcement_s: f64,
    /// The same by the method's own account, where it runs outside and gives one.
    pub reported_s: Option<f64>,
}

/// An outcome with what the judge found.
pub struct Judged {
    /// As the method returned it.
    pub outcome: Outcome,
    /// Residuals of equilibrium, of the contact laws, and of the laws claimed.
    pub found: Residuals,
    /// Open, stick or slip, by point.
    pub status: Vec<PointStatus>,
    /// See [`consistency`].
    pub consistency: Option<Vec<f64>>,
}

impl JudgedIncrement {
    /// The method declined the system or could not be prepared.
    pub fn not_started(verdict: Verdict) -> Self {
        Self {
            verdict,
            work: None,
            judged: None,
            jump: None,
        }
    }

    /// The answer, if it is what the method claims.
    pub fn honest(&self) -> Option<&Judged> {
        self.judged.as_ref().filter(|_| self.verdict.is_honest())
    }
}
