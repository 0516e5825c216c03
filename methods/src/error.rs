//! Faults of the input of a method.

/// Everything that keeps a method from starting. Failure to converge is not among it: that is a [`Status`](super::Status).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MethodError {
    /// An array has the wrong length.
    #[error("{what}: {found} entries, expected {expected}")]
    Size {
        /// Which array.
        what: &'static str,
        /// Required length.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// A sparse matrix or a permutation is malformed.
    #[error("{what} is malformed at index {index}: {reason}")]
    Pattern {
        /// Which object.
        what: &'static str,
        /// Where.
        index: usize,
        /// The fault there.
        reason: &'static str,
    },
    /// A number is NaN, infinite or outside its range.
    #[error("{what}[{index}] = {value}, allowed: {allowed}")]
    Range {
        /// Which array.
        what: &'static str,
        /// Entry.
        index: usize,
        /// Value found.
        value: f64,
        /// Allowed range, in words.
        allowed: &'static str,
    },
    /// The stiffness is not positive definite although all its rigid motions were given: a support is missing, or a
    /// piece of the body is free.
    #[error(
        "the stiffness is not positive definite: elimination breaks down at unknown {unknown} of {size}"
    )]
    NotPositiveDefinite {
        /// Unknown whose pivot is not positive.
        unknown: usize,
        /// Number of unknowns.
        size: usize,
    },
    /// A vector given as rigid motion costs energy.
    #[error("floating mode {mode} is no rigid motion: |K r| is {relative:.1e} of |diag(K)| |r|")]
    NotRigid {
        /// Which mode.
        mode: usize,
        /// Unknown with the largest part of K r.
        unknown: usize,
        /// Relative size of K r.
        relative: f64,
    },
    /// The rigid motions given are linearly dependent.
    #[error("floating mode {mode} depends linearly on the others")]
    DependentModes {
        /// Which mode.
        mode: usize,
    },
    /// A rigid motion opens or shifts no contact point: no contact law can hold it.
    #[error(
        "{modes} rigid motion(s) move no contact point: the piece needs a support or a contact point"
    )]
    FreeRigidMotion {
        /// Dimension of the space of such motions.
        modes: usize,
    },
    /// The stiffness is not symmetric.
    #[error("the stiffness is not symmetric")]
    UnsymmetricStiffness,
    /// Friction was asked of an [`Elastic`](super::Elastic) built for frictionless contact only.
    #[error(
        "point {point} has friction {friction}, but the elastic body was set up for frictionless contact only"
    )]
    FrictionlessBody {
        /// First point with friction.
        point: usize,
        /// Its coefficient.
        friction: f64,
    },
    /// The stiffness is needed where only the Delassus operator is known.
    #[error("only the Delassus operator of the body is known, not its stiffness")]
    NoStiffness,
    /// Laws that need the stress at the contact points were asked of a body without traction operator.
    #[error("the body has no traction operator: the stress at its contact points is unknown")]
    NoTraction,
    /// The tangential rows of a body set up for frictionless contact were asked for.
    #[error("the elastic body was set up for frictionless contact only: it has no tangential rows")]
    NoTangentialRows,
    /// No contact row responds to a contact force: the scale of the natural map is undefined.
    #[error("the contact forces move no contact point: the jump operator is zero")]
    RigidContact,
    /// The Delassus operator would not fit.
    #[error(
        "{rows} contact rows: the Delassus operator and a tangent take {needed_gb:.1} GB, {free_gb:.1} of this machine's memory \
         are left; methods with monolithic=1 form neither"
    )]
    TooManyRows {
        /// Contact rows.
        rows: usize,
        /// Memory for W and a full matrix of its size.
        needed_gb: f64,
        /// Memory of the machine that this process does not hold yet.
        free_gb: f64,
    },
    /// A factorisation, or its solve, was denied memory.
    #[error("{what} failed: out of memory")]
    OutOfMemory {
        /// Which one.
        what: &'static str,
    },
    /// A dense or sparse kernel overflowed its index, or stopped for a reason of its own.
    #[error("{what} failed: {reason}")]
    Kernel {
        /// Which kernel.
        what: &'static str,
        /// Its own words.
        reason: String,
    },
    /// A method found out on the way that it cannot treat the system: what
    /// [`Enforcement::refuses`](super::Enforcement::refuses) would have said.
    #[error("{reason}")]
    Refused {
        /// Why, in its own words.
        reason: String,
    },
    /// A method failed, for a reason of its own.
    #[error("{reason}")]
    Failed {
        /// Its own words.
        reason: String,
    },
    /// A method did not end in the time it was given.
    #[error("not ended in the time given")]
    TimeLimit,
}

impl MethodError {
    /// [`Range`](Self::Range).
    pub(crate) fn range(
        what: &'static str,
        index: usize,
        value: f64,
        allowed: &'static str,
    ) -> Self {
        Self::Range {
            what,
            index,
            value,
            allowed,
        }
    }

    /// [`Pattern`](Self::Pattern).
    pub(crate) fn pattern(what: &'static str, index: usize, reason: &'static str) -> Self {
        Self::Pattern {
            what,
            index,
            reason,
        }
    }
}

/// Refuses arrays of the wrong length.
pub(crate) fn check_len(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), MethodError> {
    let wrong = MethodError::Size {
        what,
        expected,
        found,
    };
    (found == expected).then_some(()).ok_or(wrong)
}

/// Refuses the first entry that is not allowed.
fn check_entries(
    what: &'static str,
    values: impl Iterator<Item = f64>,
    allowed: &'static str,
    holds: fn(f64) -> bool,
) -> Result<(), MethodError> {
    match values.enumerate().find(|(_, value)| !holds(*value)) {
        None => Ok(()),
        Some((index, value)) => Err(MethodError::range(what, index, value, allowed)),
    }
}

/// Refuses NaN and infinite entries.
pub(crate) fn check_finite(what: &'static str, values: &[f64]) -> Result<(), MethodError> {
    check_entries(what, values.iter().copied(), "finite", f64::is_finite)
}

/// Refuses entries that are not positive and finite.
pub(crate) fn check_positive(
    what: &'static str,
    values: impl Iterator<Item = f64>,
) -> Result<(), MethodError> {
    let holds = |value: f64| value > 0.0 && value.is_finite();
    check_entries(what, values, "positive and finite", holds)
}
