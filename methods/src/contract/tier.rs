//! Accuracy tiers: the bounds on the violation of the contact laws a run may be asked for.

use std::fmt;
use std::str::FromStr;

/// Accuracy a run is asked for, as a bound on [`Residuals::violation`](crate::Residuals::violation).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tier {
    /// 1e-3.
    Low,
    /// 1e-6.
    Mid,
    /// 1e-9.
    High,
}

impl Tier {
    /// All tiers, coarsest first.
    pub const ALL: [Tier; 3] = [Tier::Low, Tier::Mid, Tier::High];

    /// Largest violation that passes.
    pub fn tolerance(self) -> f64 {
        match self {
            Tier::Low => 1e-3,
            Tier::Mid => 1e-6,
            Tier::High => 1e-9,
        }
    }

    /// Name in case files, on the command line and in tables.
    pub const fn as_str(self) -> &'static str {
        match self {
            Tier::Low => "low",
            Tier::Mid => "mid",
            Tier::High => "high",
        }
    }
}

impl fmt::Display for Tier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// A name that is no tier.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown tier `{0}` (known: low, mid, high)")]
pub struct UnknownTier(pub String);

impl FromStr for Tier {
    type Err = UnknownTier;

    fn from_str(name: &str) -> Result<Self, UnknownTier> {
        Tier::ALL
            .into_iter()
            .find(|t| t.as_str() == name)
            .ok_or_else(|| UnknownTier(name.to_string()))
    }
}
