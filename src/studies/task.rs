//! The question: a problem, a method and an accuracy.
//!
//! A problem is a case on one mesh, with one contact space, tip enrichment, friction, number of increments and start; or that of an
//! FCLIB file.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::case::Case;
use crate::files::bundle::file_name;
use crate::files::digest::sha256;
use crate::run::choice::Choice;
use crate::run::verdict::Accuracy;
use crate::studies::stress::transform::Transform;

/// Longest id: with the ending of a file that is being written it is the name of a file.
const MAX_ID: usize = 200;

/// Description of a problem.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Matter {
    /// A case file.
    Case {
        /// Its name, as errors tell it.
        file: PathBuf,
        /// Its text.
        text: String,
    },
    /// A case as it is, whatever the text that it was read from says. It cannot be told to a worker.
    #[serde(skip)]
    Given(Box<Case>),
    /// An FCLIB file by its path.
    File(PathBuf),
    /// An FCLIB file by its bytes.
    Bytes(Vec<u8>),
}

/// The question. Everything that decides about what is found is in here, and nothing else.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// Name of the case, or of the problem of a file.
    pub case: String,
    /// SHA-256 of the case file or problem file, the first 16 hexadecimal digits.
    pub digest: String,
    /// Refinement factor of the mesh, from 1.
    pub refine: usize,
    /// Contact space of all cracks; `None`: the case's own; `fclib` of a problem file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub space: Option<String>,
    /// Enrichment of all tips; `None`: the case's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<String>,
    /// Friction coefficient of every crack.
    pub friction: Vec<f64>,
    /// Equal increments that each of the case's is divided in, from 1.
    pub increments: usize,
    /// Whether methods begin every increment from no contact forces in place of those in which the one before ended. Slip is
    /// measured from there all the same.
    pub cold: bool,
    /// Method as on the command line: `name` or `name:option=value,…`.
    pub method: String,
    /// Violation of the contact laws accepted by the judge.
    pub tolerance: f64,
    /// That asked of the method, where it is another one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finer: Option<f64>,
    /// The same case seen another way: in other units, elsewhere, with other names of sides and faces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<Transform>,
    /// Digest of the file where the method is a [`Program`](crate::run::outside::Program). No part of the id: a program that
    /// changed is measured again, in place of what it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub program: Option<String>,
}

/// Contact space of problems from files, in place of that of a case.
pub const FROM_FILE: &str = "fclib";

impl Asked {
    /// Whether its problem comes from a problem file.
    pub fn is_from_file(&self) -> bool {
        self.space.as_deref() == Some(FROM_FILE)
    }

    /// Friction coefficient of the first crack; 0 without cracks.
    pub fn mu(&self) -> f64 {
        self.friction.first().copied().unwrap_or(0.0)
    }

    /// Friction coefficients by crack, in the order in which the view has them.
    pub fn friction_by_crack(&self) -> Vec<f64> {
        let count = self.friction.len();
        let place = |k: usize| self.view.map_or(k, |view| view.crack(k + 1, count) - 1);
        (0..count).map(|k| self.friction[place(k)]).collect()
    }

    /// Stable name, also of the record's file: what a reader wants to know, then 8 hexadecimal digits of the SHA-256 of
    /// the cell, which tell apart what the readable part does not (the case file, the coefficients of further cracks).
    pub fn id(&self) -> String {
        let space = self.space.as_deref().unwrap_or("own");
        let (case, mu) = (&self.case, self.mu());
        let how = format!("{}.tol-{:e}", self.method, self.tolerance);
        let path = self.path_name();
        let readable = format!("{case}.r{}.{space}.mu-{mu}{path}.{how}", self.refine);
        let mut exact = format!("{readable} {} {:?}", self.digest, self.friction);
        // An axis that is as the case says stands in no id, so that ids stay when something new can be asked.
        if self.tip.is_some() || self.finer.is_some() || self.view.is_some() {
            exact += &format!(" {:?}", (&self.tip, self.finer, &self.view));
        }
        // The digest tells apart what is cut off.
        let name: String = file_name(&[&readable]).chars().take(MAX_ID - 9).collect();
        format!("{name}.{}", &sha256(exact.as_bytes())[..8])
    }

    /// Name of the file with the records of its problem.
    pub fn file(&self) -> String {
        let Self { case, refine, .. } = self;
        let exact = format!("{:?}", self.problem());
        let name: String = file_name(&[case]).chars().take(MAX_ID / 2).collect();
        format!("{name}.r{refine}.{}.jsonl", &sha256(exact.as_bytes())[..8])
    }

    /// The problem that methods are given alike: the same without method and accuracy.
    pub fn problem(&self) -> Problem {
        Self {
            method: String::new(),
            tolerance: 0.0,
            finer: None,
            program: None,
            ..self.clone()
        }
    }

    /// Whether methods are given the same: [`Asked::problem`] of both, compared where they stand.
    pub fn is_same_problem(&self, other: &Self) -> bool {
        fn key(own: &Asked) -> impl PartialEq + '_ {
            let path = (&own.friction, own.increments, own.cold, own.view);
            (
                &own.case,
                &own.digest,
                own.refine,
                &own.space,
                &own.tip,
                path,
            )
        }
        key(self) == key(other)
    }

    /// The same whatever the mesh.
    pub fn without_mesh(&self) -> Self {
        Self {
            refine: 0,
            ..self.clone()
        }
    }

    /// How the path is followed, as a part of names: nothing where it is followed as the case says, from warm starts.
    pub fn path_name(&self) -> String {
        let mut name = match self.increments {
            1 => String::new(),
            many => format!(".increments-{many}"),
        };
        if self.cold {
            name += ".cold";
        }
        name
    }

    /// Common part of tasks on one body.
    pub fn body(&self) -> Body {
        Body {
            case: self.case.clone(),
            digest: self.digest.clone(),
            refine: self.refine,
            space: self.space.clone(),
            tip: self.tip.clone(),
            view: self.view.map(|view| view.name()),
        }
    }

    /// Asked of the method, and accepted by the judge.
    pub fn accuracy(&self) -> Accuracy {
        Accuracy {
            asked: self.finer.unwrap_or(self.tolerance),
            accepted: self.tolerance,
        }
    }
}

/// Further looks on the way; they decide nothing about what is found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Looks {
    /// Quantities of every increment.
    pub quantities: bool,
    /// Histories of the iterations and states of the contact points.
    pub curves: bool,
    /// Fields, for pictures.
    pub fields: bool,
    /// The distance from the closed form at the end of the path, or the quantities of interest where there is none.
    pub truth: bool,
    /// The quantities of interest at the end of the path beside a closed form too.
    pub values: bool,
    /// The distance from the converged solution.
    pub error: bool,
    /// The time that tables and fields take.
    pub output: bool,
    /// Why it gave up.
    pub why: bool,
    /// The remedy that solves the problem instead.
    pub remedy: bool,
    /// Where published stopping tests would have ended it.
    pub stops: bool,
    /// The independent check of a first increment: uniform stress, or the energy.
    pub check: bool,
    /// Further starts from which an exact method looks for other answers.
    pub starts: usize,
}

impl Looks {
    /// The closed form, or the quantities of interest where there is none.
    pub fn truth() -> Self {
        Self {
            truth: true,
            ..Self::default()
        }
    }

    /// Whether all that others ask for was looked at.
    pub fn cover(&self, asked: Self) -> bool {
        let has = |own: bool, asked: bool| own || !asked;
        has(self.quantities, asked.quantities)
            && has(self.curves, asked.curves)
            && has(self.fields, asked.fields)
            && has(self.truth, asked.truth)
            && has(self.values, asked.values)
            && has(self.error, asked.error)
            && has(self.output, asked.output)
            && has(self.why, asked.why)
            && has(self.remedy, asked.remedy)
            && has(self.stops, asked.stops)
            && has(self.check, asked.check)
            && self.starts >= asked.starts
    }
}

/// The task to be measured.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Task {
    /// The question.
    pub asked: Asked,
    /// Its group, for statistics; empty: none.
    pub class: String,
    /// Where the problem is described.
    #[serde(skip, default = "nothing")]
    pub matter: Arc<Matter>,
    /// Further looks.
    pub looks: Looks,
    /// Whether its body has the traction operator, because a task beside it on the same body needs it.
    pub traction: bool,
}

/// The problem of a task that came without: workers are told it beside the tasks.
fn nothing() -> Arc<Matter> {
    Arc::new(Matter::Bytes(Vec::new()))
}

impl Task {
    /// A task of no class that looks at nothing else.
    pub fn new(asked: Asked, matter: Arc<Matter>) -> Self {
        Self {
            asked,
            class: String::new(),
            matter,
            looks: Looks::default(),
            traction: false,
        }
    }

    /// [`Asked::id`].
    pub fn id(&self) -> String {
        self.asked.id()
    }
}

/// Gives neighbouring tasks on one body the traction operator where one of them needs it.
pub fn share_traction(tasks: &mut [Task], needs: impl Fn(&Task) -> bool) {
    for of_body in tasks.chunk_by_mut(|a, b| a.asked.body() == b.asked.body()) {
        let traction = of_body.iter().any(&needs);
        of_body.iter_mut().for_each(|task| task.traction = traction);
    }
}

impl Matter {
    /// That of a case.
    pub fn of(case: &Case) -> Arc<Self> {
        Arc::new(Self::Case {
            file: case.file.clone(),
            text: case.source.clone(),
        })
    }
}

/// A method as tasks name it.
pub struct Named {
    /// As in [`Asked::method`].
    pub argument: String,
    /// As in [`Asked::program`].
    pub program: Option<String>,
}

impl Named {
    /// Of a method.
    pub fn of(choice: &Choice) -> Self {
        Self {
            argument: choice.argument(),
            program: choice.program().map(|own| own.digest().to_owned()),
        }
    }
}

/// Common part of tasks on one body, as in [`Asked`]; in the order in which they are measured.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "as in `Asked`")]
pub struct Body {
    pub case: String,
    pub digest: String,
    pub refine: usize,
    pub space: Option<String>,
    pub tip: Option<String>,
    pub view: Option<String>,
}

/// The problem that several methods are given alike, as [`Asked::problem`] makes it. Methods are compared from the same start and in the same
/// increments, so other ones make it another problem.
pub type Problem = Asked;

/// Digest of a case file, as in [`Asked::digest`].
pub fn digest(text: &str) -> String {
    digest_of_bytes(text.as_bytes())
}

/// The same of a file of any kind.
pub fn digest_of_bytes(bytes: &[u8]) -> String {
    sha256(bytes)[..16].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked() -> Asked {
        Asked {
            case: "plate".into(),
            digest: digest("text"),
            refine: 2,
            space: None,
            tip: None,
            friction: vec![0.1, 0.2],
            increments: 1,
            cold: false,
            method: "penalty:normal=1e2".into(),
            tolerance: 1e-6,
            finer: None,
            view: None,
            program: None,
        }
    }

    #[test]
    fn the_digest_is_sha_256() {
        // FIPS 180-2, appendix B.1: SHA-256 of "abc".
        assert_eq!(digest("abc"), "ba7816bf8f01cfea");
    }

    #[test]
    fn an_id_can_be_read_and_is_a_file_name() {
        let id = asked().id();
        let readable = "plate.r2.own.mu-0.1.penalty-normal=1e2.tol-1e-6.";
        assert!(id.starts_with(readable), "{id}");
        assert_eq!(id.len(), readable.len() + 8);
        let path = Asked {
            increments: 10,
            cold: true,
            ..asked()
        };
        assert!(path.id().contains(".mu-0.1.increments-10.cold.penalty"));
        let long = |end: &str| Asked {
            case: "ü".repeat(249) + end,
            ..asked()
        };
        let [one, other] = ["a", "b"].map(|end| long(end).id());
        assert!(one.len() <= MAX_ID && one != other, "{one}");
    }

    #[test]
    fn whatever_changes_what_is_asked_changes_its_id() {
        let changes: [fn(&mut Asked); 13] = [
            |c| c.case.push('x'),
            |c| c.digest = digest("other"),
            |c| c.refine = 3,
            |c| c.space = Some("star".into()),
            |c| c.tip = Some("branch".into()),
            |c| c.finer = Some(1e-12),
            |c| c.view = Some(Transform::Mirror),
            |c| c.friction[1] = 0.3,
            |c| c.friction[0] = 0.3,
            |c| c.increments = 10,
            |c| c.cold = true,
            |c| c.method = "penalty,normal=1e2".into(),
            |c| c.tolerance = 1e-7,
        ];
        let mut ids = vec![asked().id()];
        for change in changes {
            let mut changed = asked();
            change(&mut changed);
            let same = changed.problem() == asked().problem();
            assert_eq!(changed.is_same_problem(&asked()), same, "{changed:?}");
            ids.push(changed.id());
        }
        ids.sort();
        ids.dedup();
        assert_eq!(ids.len(), 14);
        assert_eq!(asked().id(), asked().id());
    }
}
