//! Findings on a scene.

use std::fmt;

use super::scene::Scene;
use crate::run::verdict::Verdict;
use crate::studies::record::Record;
use crate::studies::stress::twin::Change;

/// Why a scene did not end as it should; by severity, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
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
    /// It changes where a feature of the cracks hardly moves.
    Jump,
    /// It is not that in cells of another size.
    OtherCells,
    /// The program failed with an error that names no place in the file.
    NoPlace,
    /// The factorisation found the stiffness not positive definite, or failed otherwise.
    Factorisation,
    /// The judge of the mesh doubts the body.
    SuspectMesh,
    /// The default method found no answer where there is one.
    Missed,
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
    /// Solved, with an error that is the rounding of the arithmetic.
    Floor,
    /// A jump of a contact space or an enrichment that may step where a tip leaves a cell.
    Step,
}

impl Fault {
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
            Self::Jump => "jump",
            Self::OtherCells => "other cells",
            Self::NoPlace => "error without a place",
            Self::Factorisation => "factorisation",
            Self::SuspectMesh => "suspect mesh",
            Self::Missed => "missed",
            Self::Refused => "refused",
            Self::Beyond => "beyond the mesh",
            Self::NoEquilibrium => "no equilibrium",
            Self::FrictionLimit => "limit of friction",
            Self::SeveralSolutions => "several solutions",
            Self::Floor => "floor of the arithmetic",
            Self::Step => "step",
        }
    }

    /// Whether the program is wrong: never to be seen.
    pub fn is_wrong(self) -> bool {
        self <= Self::Factorisation
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Change by seeing a scene another way.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Which way.
    pub transformation: String,
    /// Whether it rounds nothing and gives nothing another name.
    pub exact: bool,
    /// The verdict that it ends with.
    pub verdict: Verdict,
    /// The change; none where that is not `solved`.
    pub change: Option<Change>,
}

impl Seen {
    /// Change of energy; another verdict is the largest change there is.
    pub fn energy(&self) -> f64 {
        self.change.map_or(1.0, |change| change.energy)
    }
}

impl fmt::Display for Seen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.change {
            None => self.verdict.fmt(f),
            Some(Change { force, energy }) => match force {
                Some(force) => write!(f, "forces {force:.1e}, energy {energy:.1e}"),
                None => write!(f, "other points, energy {energy:.1e}"),
            },
        }
    }
}

/// A scene and what was found.
#[derive(Debug, Clone)]
pub struct Finding {
    /// The scene.
    pub scene: Scene,
    /// The worst that was found; none if all is right.
    pub fault: Option<Fault>,
    /// In one line.
    pub reason: String,
    /// Largest difference of contact forces between exact methods, over the largest force [-].
    pub disagreement: Option<f64>,
    /// In a ladder of places the difference from the rung beside, or from other cells [-]; NaN: not compared.
    pub apart: f64,
    /// Ways to see it that leave the answer as it is.
    pub seen: Vec<Seen>,
    /// All methods, the default one first; none where the case cannot be read.
    pub records: Vec<Record>,
    /// Smallest case found with the same fault; none where nothing is wrong.
    pub minimal: Option<String>,
}

impl Finding {
    /// A scene without an answer.
    pub fn ended(scene: &Scene, fault: Fault, reason: &str) -> Self {
        let line = reason.lines().next().unwrap_or_default();
        Self {
            scene: scene.clone(),
            fault: Some(fault),
            reason: line.chars().take(300).collect(),
            disagreement: None,
            apart: f64::NAN,
            seen: Vec::new(),
            records: Vec::new(),
            minimal: None,
        }
    }

    /// Largest error of the default method against the closed form, or of the energy identity where there is none; NaN without
    /// an answer.
    pub fn error(&self) -> f64 {
        let main = self.records.first();
        let check = main.and_then(|main| main.found.check.as_ref());
        check.map_or(f64::NAN, |check| check.error)
    }
}

/// Whether a method did what it is for: an exact one the contact laws, another one the laws it claims.
pub fn is_done(record: &Record) -> bool {
    match &record.found.verdict {
        Verdict::Solved | Verdict::Several | Verdict::Suspect(_) => true,
        Verdict::Approximate(_) => !record.found.exact,
        _ => false,
    }
}
