//! What became of a scene: the record of the suite.

use std::fmt;

use serde::{Deserialize, Serialize};
#[cfg(doc)]
use stickslip_methods::SWAYING;

use super::scene::Family;
use crate::run::verdict::Verdict;

/// Why a scene, or a method on a scene, did not end as it should; by severity, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The program panicked.
    Panic,
    /// It ran out of memory.
    Memory,
    /// It ran out of time.
    Time,
    /// Solved, and not as the closed form says.
    WrongPatch,
    /// Solved, and the energy of the body is not the work done on it less what friction took.
    WrongEnergy,
    /// A method claimed what the judge refuted.
    FalseClaim,
    /// The answer changes with units, place, names of sides, faces or axes.
    NotInvariant,
    /// The program failed with an error that names no place in the file.
    NoPlace,
    /// The factorisation found the stiffness not positive definite, or failed otherwise.
    Factorisation,
    /// The judge of the mesh doubts the body.
    SuspectMesh,
    /// The case was refused at a place in its file.
    Refused,
    /// Refused, and by construction more than a mesh of such cells can carry.
    Beyond,
    /// No contact force within the cones of friction balances the load on a floating piece, as a certificate proves.
    NoEquilibrium,
    /// No method found an answer, and nine tenths of the friction prove to have none: what friction can bear ends here.
    FrictionLimit,
    /// Two exact methods found different answers that both hold: there are several.
    SeveralSolutions,
    /// A matrix of the method cannot be factored: its tangent is singular.
    SingularTangent,
    /// The iterates repeat.
    Cycling,
    /// The numbers grew without bound.
    Diverged,
    /// Violation of the contact laws came to rest within a thousand times the tolerance, which is near rounding.
    Floor,
    /// It converges, too slowly for the limit of iterations.
    Slow,
    /// It stopped on a body whose slender parts sway more than [`SWAYING`] times as far as cells deform: W is as badly
    /// conditioned, and answers are held to within 100 times of the stiffest unknowns.
    Swaying,
    /// Its iterates neither settle nor repeat.
    Wandering,
    /// It came to rest far from a solution, without any of the causes above.
    Stalled,
    /// The method declines such a system.
    Declined,
}

impl Cause {
    /// As tables name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Panic => "panic",
            Self::Memory => "memory",
            Self::Time => "time",
            Self::WrongPatch => "wrong patch",
            Self::WrongEnergy => "wrong energy",
            Self::FalseClaim => "false claim",
            Self::NotInvariant => "not invariant",
            Self::NoPlace => "error without a place",
            Self::Factorisation => "factorisation",
            Self::SuspectMesh => "suspect mesh",
            Self::Refused => "refused",
            Self::Beyond => "beyond the mesh",
            Self::NoEquilibrium => "no equilibrium",
            Self::FrictionLimit => "limit of friction",
            Self::SeveralSolutions => "several solutions",
            Self::SingularTangent => "singular tangent",
            Self::Cycling => "cycling",
            Self::Diverged => "diverged",
            Self::Floor => "floor of the arithmetic",
            Self::Slow => "slow",
            Self::Swaying => "swaying",
            Self::Wandering => "wandering",
            Self::Stalled => "stalled",
            Self::Declined => "declined",
        }
    }

    /// Whether the program is wrong: never to be seen.
    pub fn is_fault(self) -> bool {
        self <= Self::Factorisation
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One method on a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Label.
    pub method: String,
    /// Whether the method's limit are the contact laws.
    pub exact: bool,
    /// Claim × check.
    pub verdict: Verdict,
    /// Iterations.
    pub iterations: usize,
    /// Largest violation of the contact laws [-]; none without an answer.
    pub violation: Option<f64>,
    /// Why it did not do what it is for; none if it did.
    pub cause: Option<Cause>,
}

/// What a transformation changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Which one.
    pub transformation: String,
    /// Whether it rounds nothing and gives nothing another name.
    pub exact: bool,
    /// The verdict or error it ends with, where that is not `solved`.
    pub verdict: Option<String>,
    /// Largest change of contact forces, over the largest force [-]; none where the contact points are others.
    pub force: Option<f64>,
    /// Change of strain energy and dissipation, over their sum [-]; 1 where the verdict is another.
    pub energy: f64,
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.verdict, self.force) {
            (Some(verdict), _) => f.write_str(verdict),
            (None, Some(force)) => write!(f, "forces {force:.1e}, energy {:.1e}", self.energy),
            (None, None) => write!(f, "other points, energy {:.1e}", self.energy),
        }
    }
}

/// A scene and what was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Family of the scene.
    pub family: Family,
    /// Number in the family.
    pub number: u64,
    /// How its cracks lie; of a ladder its name.
    pub category: String,
    /// Space dimension.
    pub dimension: usize,
    /// The worst that was found; none if all is right.
    pub cause: Option<Cause>,
    /// In one line.
    pub reason: String,
    /// Largest error of the default method against the closed form, or of the energy identity where there is none [-].
    pub error: Option<f64>,
    /// Cells.
    pub cells: usize,
    /// Contact points.
    pub points: usize,
    /// Largest μ.
    pub friction: f64,
    /// Condition: see `runs.csv`.
    pub sway: Option<f64>,
    /// Residual of uniform stress on the mesh [-].
    pub uniform_stress: Option<f64>,
    /// Deepest overlap over the largest jump or displacement [-].
    pub overlap: Option<f64>,
    /// Largest difference of contact forces between exact methods, over the largest force [-].
    pub disagreement: Option<f64>,
    /// Transformations that leave the answer as it is, and what they changed.
    pub invariance: Vec<Change>,
    /// All methods.
    pub trials: Vec<Trial>,
    /// Time of all [s].
    pub seconds: f64,
    /// Smallest case found with the same cause; none where nothing is wrong.
    pub minimal: Option<String>,
}
