//! Answer of a method: a state, a status, a history and counters.

use crate::error::{MethodError, check_finite, check_positive};

/// Displacements and contact forces at the end of an increment. They are the whole history: slip is measured from
/// the jump of the state an increment starts from.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactState {
    /// Unknowns u, n entries, in m.
    pub u: Vec<f64>,
    /// Contact forces on side 1, `dim` per point `(n, a[, b])`, compression positive; tangential entries are exactly 0
    /// where friction is 0. In N, in 2D N/m.
    pub p: Vec<f64>,
}

/// The enum with the list of its values and their names, so that neither can forget one.
macro_rules! statuses {
    ($($(#[$doc:meta])* $status:ident = $name:literal,)*) => {
        /// How a method ended. Only [`Converged`](Status::Converged) claims a solution.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Status {
            $($(#[$doc])* $status,)*
        }

        impl Status {
            /// All of them.
            pub const ALL: &'static [Status] = &[$(Status::$status),*];

            /// Name in tables.
            pub fn as_str(self) -> &'static str {
                match self {
                    $(Status::$status => $name,)*
                }
            }
        }
    };
}

statuses! {
    /// The method's own equations hold to the tolerance asked for (see [`Claim`]).
    Converged = "converged",
    /// The iteration limit was reached first.
    MaxIterations = "max-iterations",
    /// The residual stopped falling well before the iteration limit.
    Stalled = "stalled",
    /// The tangent of the contact equations is singular at an iterate.
    SingularTangent = "singular-tangent",
    /// A floating piece is not held by the contact: it can move rigidly, or its load cannot be balanced.
    Mechanism = "mechanism",
    /// Proved: no contact force within the cones of friction balances the load on floating pieces, or none opens all gaps; see
    /// [`no_equilibrium`](crate::conic::no_equilibrium). Said by the judge, in place of what a method ended with.
    NoEquilibrium = "no-equilibrium",
    /// Numbers left the finite range.
    Diverged = "diverged",
    /// The monitor asked to stop.
    Stopped = "stopped",
    /// The violation no longer falls, and the rounding of W P is as large: no claim, but what is reached may be what was accepted, as the
    /// judge says. Said by the judge too where contact forces are so large beside what they move that rounding decides.
    Rounding = "rounding",
    /// The method says that it has no solution, and nothing else.
    Unexplained = "unexplained",
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Which equations a converged method claims to have solved. [`residuals_of`](super::residuals_of) holds it to them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Claim {
    /// The contact laws themselves: their violation is at or below the tolerance asked for.
    Exact,
    /// Penalised laws, whose distance from the contact laws is a modelling error: the natural map is reported, not
    /// promised. P_n = k_n max(−g, 0), and |P_t| <= μ P_n with the elastic slip P_t/k_t.
    Penalised {
        /// Normal stiffness k_n, in N/m.
        normal: f64,
        /// Tangential stiffness k_t, in N/m.
        tangential: f64,
    },
    /// Barrier and smoothed friction: P_n = −B'(g) with B = −κ (g − ĝ)² ln(g/ĝ) for 0 < g < ĝ and 0 beyond, and
    /// P_t = −μ P_n f(|d|/ε) d/|d| with f(y) = 2 y − y² for y < 1 and 1 beyond.
    Barrier {
        /// ĝ in m.
        gap: f64,
        /// ε in m.
        slip: f64,
        /// κ in N/m.
        stiffness: f64,
    },
    /// Nitsche's laws: P is the return mapping of S u − γ w v, S u the contact force that the stress of the bulk
    /// implies, and equilibrium has the consistency term θ Sᵀ (S u − P)/(γ w). Consistent with the contact laws of the
    /// continuum, it differs from those of the contact points by the error of the discretisation.
    Nitsche {
        /// 1: symmetric, 0: incomplete, −1: skew-symmetric.
        theta: f64,
        /// γ in N/m³, w the weight of a point.
        gamma: f64,
    },
}

impl Claim {
    /// Refuses parameters with which the laws would say nothing: a spring of no stiffness fulfils any law.
    pub(crate) fn check(&self) -> Result<(), MethodError> {
        match *self {
            Claim::Exact => Ok(()),
            Claim::Penalised { normal, tangential } => check_positive(
                "penalty stiffness of the claim",
                [normal, tangential].into_iter(),
            ),
            Claim::Barrier {
                gap,
                slip,
                stiffness,
            } => check_positive(
                "barrier parameter of the claim",
                [gap, slip, stiffness].into_iter(),
            ),
            Claim::Nitsche { theta, gamma } => {
                check_finite("theta of the claim", &[theta])?;
                check_positive("gamma of the claim", [gamma].into_iter())
            }
        }
    }
}

/// One entry of the iteration history; the first describes the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration {
    /// Largest violation of the contact laws \[-\], see [`Residuals::violation`](crate::Residuals::violation); of an
    /// approximate method it ends at the modelling error.
    pub violation: f64,
    /// Points that changed between open, stick and slip since the entry before.
    pub changes: usize,
}

/// Work done within one increment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Iterations as the published algorithm counts them (one history entry each, not counting the start).
    pub iterations: usize,
    /// Dense factorisations of condensed matrices.
    pub factorisations: usize,
    /// Sparse factorisations of matrices over all unknowns, as monolithic variants need them.
    pub global_factorisations: usize,
    /// Solves with the factor of K.
    pub solves: usize,
    /// Evaluations of the contact law at one point.
    pub local_solves: usize,
}

/// Result of one increment.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// How the method ended.
    pub status: Status,
    /// Meaning of `Converged`.
    pub claim: Claim,
    /// Last state, whatever the status.
    pub state: ContactState,
    /// Residual per iteration.
    pub history: Vec<Iteration>,
    /// Work done.
    pub counters: Counters,
}

/// Watches a running method and may stop it, e.g. at a time limit.
pub trait Monitor {
    /// Called once per iteration; `false` ends the method with [`Status::Stopped`].
    fn step(&mut self, iteration: usize, violation: f64) -> bool;

    /// Shows every iterate that the history has an entry of, the last one included, before [`step`](Self::step): asked, it
    /// gives P and v = (g, d) on the rows in use, as the violation is computed from them. Who does not ask makes nothing be
    /// computed.
    fn iterate(&mut self, _at: &dyn Fn() -> (Vec<f64>, Vec<f64>)) {}
}

/// A monitor that never stops anything.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Monitor for Silent {
    fn step(&mut self, _iteration: usize, _violation: f64) -> bool {
        true
    }
}
