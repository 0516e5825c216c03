//! Has scenes measured by every method, and tells what became of each.
//!
//! First every method on every scene as it is. What comes back decides what is asked next: other units where an error may be
//! rounding, a little less friction where no method finds an answer, other ways to see what is right, and a finer mesh where
//! these change it.

use super::finding::{Fault, Finding, Seen, is_done};
use super::scene::{Family, Scene};
use super::transform::Transform;
use crate::case::{self, Case};
use crate::run::choice::Choice;
use crate::run::registry::methods;
use crate::run::verdict::{Accuracy, Verdict};
use crate::studies::axes::{Axes, Subject};
use crate::studies::lab::{Ask, LabError};
use crate::studies::record::Record;
use crate::studies::several::DIFFERENT;
use crate::studies::task::{Looks, Named, Task};
use stickslip_methods::Status;

/// Name of the file, as errors tell it.
pub const FILE: &str = "scene.toml";

/// The method that is to solve every scene with one solution.
pub const DEFAULT: &str = "hybrid";

/// The one whose certificate proves that there is no answer.
const PROVES: &str = "interior-point";

/// Change of contact forces by a transformation that is rounding; the table counts digits by it.
pub const INVARIANT: f64 = 1e-9;

/// Change of energy by other contact points that is nothing beside the error of any mesh; a larger one is compared with
/// what a mesh twice as fine changes.
const CHOSEN: f64 = 0.02;

/// How many transformations a scene is put through, in 2D and in 3D: other scenes take the next ones.
const TRANSFORMED: [usize; 2] = [4, 2];

/// By so much less friction: a body of three planes has forces from 0.96 of its friction on, and answers from 1.03.
///
/// The certificate is that of limit analysis: no force at all within the cones of friction balances the load. Slip that does
/// not open asks for more than such forces (Coulomb's law is not associated), so answers end above the friction at which the
/// forces do.
const LESS: f64 = 0.9;

/// Units of length in which an error that is rounding is another one.
const UNITS: [f64; 3] = [39.37, 0.3048, 7.0];

/// How much is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Every method and the transformations.
    All,
    /// The default method on the scene as it is.
    Default,
}

/// A scene with its case, and what is known so far.
struct Open<'a> {
    scene: &'a Scene,
    case: Case,
    finding: Finding,
    /// Findings by severity.
    faults: Vec<(Fault, String)>,
    /// Tasks asked next, and their records.
    next: Vec<Task>,
    answers: Vec<Record>,
}

/// Findings on some scenes, in their order; fewer where it was told to stop.
///
/// # Errors
/// [`LabError`].
pub fn find(ask: &mut dyn Ask, scenes: &[Scene], effort: Effort) -> Result<Vec<Finding>, LabError> {
    let (mut open, mut closed) = (Vec::new(), Vec::new());
    for (place, scene) in scenes.iter().enumerate() {
        match case::parse(FILE, scene.text.as_str()) {
            Ok(case) => open.push((place, Open::new(scene, case, effort))),
            Err(refusal) => closed.push((place, refused(scene, &refusal.to_string()))),
        }
    }
    if !answer(ask, &mut open)? {
        return Ok(Vec::new());
    }
    open.iter_mut().for_each(|(_, own)| own.judge());
    if !answer(ask, &mut open)? {
        return Ok(Vec::new());
    }
    for (_, own) in &mut open {
        own.judge_friction();
        own.judge_rounding();
        own.see(effort);
    }
    if !answer(ask, &mut open)? {
        return Ok(Vec::new());
    }
    open.iter_mut().for_each(|(_, own)| own.judge_views());
    if !answer(ask, &mut open)? {
        return Ok(Vec::new());
    }
    closed.extend(open.into_iter().map(|(place, own)| (place, own.close())));
    closed.sort_by_key(|own| own.0);
    Ok(closed.into_iter().map(|own| own.1).collect())
}

/// Asks what all scenes want to know next; false if it was told to stop.
fn answer(ask: &mut dyn Ask, open: &mut [(usize, Open<'_>)]) -> Result<bool, LabError> {
    let tasks: Vec<Task> = open.iter().flat_map(|(_, own)| own.next.clone()).collect();
    let records = ask.ask(&tasks)?;
    if records.len() < tasks.len() {
        return Ok(false);
    }
    let mut records = records.into_iter();
    for (_, own) in open {
        let count = own.next.drain(..).count();
        own.answers = records.by_ref().take(count).collect();
    }
    Ok(true)
}

/// A case without runs: refused at a place in its file, or an error.
fn refused(scene: &Scene, error: &str) -> Finding {
    let fault = match (has_place(error), scene.beyond) {
        (true, true) => Fault::Beyond,
        (true, false) => Fault::Refused,
        (false, _) => Fault::NoPlace,
    };
    Finding::ended(scene, fault, error)
}

/// Whether an error says `file:line:column:`.
fn has_place(error: &str) -> bool {
    let mut parts = error.split(':').map(str::trim);
    let number = |part: Option<&str>| part.is_some_and(|p| p.parse::<usize>().is_ok_and(|n| n > 0));
    parts.next() == Some(FILE) && number(parts.next()) && number(parts.next())
}

impl<'a> Open<'a> {
    fn new(scene: &'a Scene, case: Case, effort: Effort) -> Self {
        let mut own = Self {
            scene,
            case,
            finding: Finding::ended(scene, Fault::Panic, ""),
            faults: Vec::new(),
            next: Vec::new(),
            answers: Vec::new(),
        };
        let look = Looks {
            check: true,
            why: true,
            quantities: scene.family == Family::Ladder,
            ..Looks::default()
        };
        own.next = own.tasks(DEFAULT, &own.axes(), look);
        let others = Looks {
            error: true,
            ..Looks::default()
        };
        let names = methods().iter().map(|method| method.name);
        for name in names.filter(|name| effort == Effort::All && *name != DEFAULT) {
            let tasks = own.tasks(name, &own.axes(), others);
            own.next.extend(tasks);
        }
        own
    }

    fn axes(&self) -> Axes {
        Axes::of(&self.case)
    }

    /// The tasks of a method.
    fn tasks(&self, method: &str, axes: &Axes, looks: Looks) -> Vec<Task> {
        let Ok(choice) = Choice::parse(method) else {
            return Vec::new();
        };
        let Scene {
            family,
            number,
            category,
            ..
        } = self.scene;
        let subject = Subject {
            name: format!("{}-{number}", family.name()),
            class: category.clone(),
            ..Subject::of(&self.case)
        };
        let accuracy = Accuracy::own(&self.case);
        subject.tasks(axes, &[Named::of(&choice)], &[accuracy], looks)
    }

    /// The default method on the case seen another way.
    fn view(&self, view: Transform, looks: Looks) -> Option<Task> {
        view.apply(&self.scene.text)?;
        let mut task = self.tasks(DEFAULT, &self.axes(), looks).pop()?;
        task.asked.view = Some(view);
        Some(task)
    }

    fn main(&self) -> Option<&Record> {
        self.finding.records.first()
    }

    /// Whether a method found no answer where there may be one.
    fn missed(record: &Record) -> bool {
        let none = Verdict::GaveUp(Status::NoEquilibrium);
        let refused = matches!(record.found.verdict, Verdict::Refused(_));
        !is_done(record) && record.found.verdict != none && !refused
    }

    /// Verdict of the runs of all methods.
    fn judge(&mut self) {
        self.finding.records = std::mem::take(&mut self.answers);
        self.finding.fault = None;
        let Some(main) = self.main().cloned() else {
            self.faults
                .push((Fault::NoPlace, "no run of the default method".into()));
            return;
        };
        let found = &main.found;
        match &found.verdict {
            Verdict::Refused(reason) | Verdict::Crashed(reason) if found.problem.is_none() => {
                let panic =
                    matches!(found.verdict, Verdict::Crashed(_)) && reason.contains("panic");
                let own = if panic {
                    Finding::ended(self.scene, Fault::Panic, reason)
                } else {
                    refused(self.scene, reason)
                };
                self.faults
                    .extend(own.fault.map(|fault| (fault, own.reason)));
                self.finding.records.clear();
                return;
            }
            Verdict::TimedOut => self.faults.push((Fault::Time, "no answer in time".into())),
            Verdict::OutOfMemory => self.faults.push((Fault::Memory, "denied memory".into())),
            Verdict::Suspect(reason) => self.faults.push((Fault::SuspectMesh, reason.clone())),
            Verdict::Crashed(reason) => self.faults.push((Fault::Factorisation, reason.clone())),
            _ => {}
        }
        for own in self.finding.records.iter().skip(1) {
            let method = &own.found.method;
            self.faults.extend(match &own.found.verdict {
                Verdict::FalseClaim => Some((Fault::FalseClaim, method.clone())),
                Verdict::Crashed(reason) if reason.contains("panic") => {
                    Some((Fault::Panic, format!("{method}: {reason}")))
                }
                _ => None,
            });
        }
        if found.verdict == Verdict::FalseClaim {
            self.faults.push((Fault::FalseClaim, DEFAULT.into()));
        }
        let exact = || self.finding.records.iter().filter(|own| own.found.exact);
        let apart = exact().skip(1).filter(|own| own.found.verdict.is_solved());
        let apart = apart.filter_map(|own| Some(own.found.solver_error.as_ref()?.force));
        self.finding.disagreement = apart.reduce(f64::max);
        let several = self.finding.disagreement.is_some_and(|d| d > DIFFERENT);
        let reason = format!("{DEFAULT}: {} {}", found.verdict, found.cause());
        if found.verdict == Verdict::GaveUp(Status::NoEquilibrium) {
            self.faults.push((Fault::NoEquilibrium, reason));
        } else if Self::missed(&main) && several {
            self.faults.push((Fault::SeveralSolutions, reason));
        } else if Self::missed(&main) {
            // Nobody finds an answer: whether there is one is asked next.
            if exact().all(Self::missed) {
                let mut axes = self.axes();
                axes.friction
                    .iter_mut()
                    .flatten()
                    .for_each(|mu| *mu *= LESS);
                self.next = self.tasks(PROVES, &axes, Looks::default());
            }
            self.faults.push((Fault::Missed, reason));
        }
        if let Some(check) = found.check.as_ref() {
            self.finding.reason = check.remark.clone();
            if !check.faults.is_empty() {
                let fault = if check.uniform {
                    Fault::WrongPatch
                } else {
                    Fault::WrongEnergy
                };
                self.faults.push((fault, check.faults.join("; ")));
                let look = Looks {
                    check: true,
                    ..Looks::default()
                };
                let units = UNITS.into_iter().filter(|_| check.uniform);
                let views = units.filter_map(|unit| self.view(Transform::Length(unit), look));
                self.next = views.collect();
            }
        }
    }

    /// Where no method finds an answer and nine tenths of the friction prove to have none, friction ends there.
    fn judge_friction(&mut self) {
        let none = Verdict::GaveUp(Status::NoEquilibrium);
        let proved = self.answers.iter().any(|own| own.found.verdict == none);
        for (fault, _) in self.faults.iter_mut().filter(|_| proved) {
            if *fault == Fault::Missed {
                *fault = Fault::FrictionLimit;
            }
        }
    }

    /// An error is rounding that the body amplifies where it is small, and another one in other units. One of the program stays
    /// as it is, whatever the last digits of the case.
    fn judge_rounding(&mut self) {
        /// Largest error of answers that hold six digits.
        const SMALL: f64 = 1e-6;
        /// Part of an error by which it differs if it is rounding.
        const APART: f64 = 0.1;
        let own = self
            .faults
            .iter_mut()
            .find(|own| own.0 == Fault::WrongPatch);
        let Some((fault, _)) = own else {
            return;
        };
        let error = |own: &Record| own.found.check.as_ref().map_or(f64::NAN, |own| own.error);
        let mut errors: Vec<f64> = self.answers.iter().map(error).collect();
        errors.push(self.finding.error());
        errors.sort_by(f64::total_cmp);
        let (least, largest) = (errors[0], errors[errors.len() - 1]);
        let rounds = largest <= SMALL && largest - least > APART * largest;
        if errors.len() > UNITS.len() && rounds {
            *fault = Fault::Floor;
        }
    }

    /// Asks for other ways to see what is right.
    fn see(&mut self, effort: Effort) {
        self.answers.clear();
        let solved = self
            .main()
            .is_some_and(|main| main.found.verdict.is_solved());
        // A different answer of several is no change by the transformation.
        let one = self.finding.disagreement.is_none_or(|d| d <= DIFFERENT);
        let right = solved && one && self.faults.is_empty();
        if effort == Effort::All && self.scene.family.is_random() && right {
            let many = TRANSFORMED[self.scene.dim - 2];
            let first = self.scene.number as usize * many;
            let all = (0..many).map(|k| Transform::ALL[(first + k) % Transform::ALL.len()]);
            self.next = all
                .filter_map(|view| self.view(view, Looks::default()))
                .collect();
        }
    }

    /// Changes by other ways to see the scene; asks for the error of the mesh where that matters.
    fn judge_views(&mut self) {
        for record in std::mem::take(&mut self.answers) {
            let Some(view) = record.asked.view else {
                continue;
            };
            let verdict = record.found.verdict;
            let refused = record.found.problem.is_none() && matches!(verdict, Verdict::Refused(_));
            let doubted = matches!(verdict, Verdict::Suspect(_));
            // Other contact points may be too few of them; and where the judge has doubts nothing is claimed.
            if refused && !view.is_exact() || doubted {
                continue;
            }
            self.finding.seen.push(Seen {
                transformation: view.name(),
                exact: view.is_exact(),
                verdict,
                change: record.found.change,
            });
        }
        let chosen = |own: &Seen| own.exact || own.energy() <= CHOSEN;
        if !self.finding.seen.iter().all(chosen) {
            let finer = Axes {
                refine: self.axes().refine.iter().map(|factor| 2 * factor).collect(),
                ..self.axes()
            };
            let look = Looks {
                quantities: true,
                ..Looks::default()
            };
            self.next = self.tasks(DEFAULT, &finer, look);
            self.next.extend(self.tasks(DEFAULT, &self.axes(), look));
        }
    }

    /// Change of energy by a mesh twice as fine; 0 where that has no answer.
    fn error_of_mesh(&self) -> f64 {
        let [finer, own] = &self.answers[..] else {
            return 0.0;
        };
        let energy = |record: &Record, name: &str| {
            let mut own = record
                .found
                .increments
                .iter()
                .flat_map(|step| &step.quantities);
            let own = own.find(|q| q.name == name && q.at.is_empty());
            own.map_or(f64::NAN, |q| q.value)
        };
        let both = ["strain_energy", "dissipation"];
        let size: f64 = both.iter().map(|name| energy(own, name).abs()).sum();
        let away = both
            .iter()
            .map(|name| (energy(finer, name) - energy(own, name)).abs());
        let change = away.sum::<f64>() / size;
        if change.is_finite() { change } else { 0.0 }
    }

    /// The first change that is neither rounding nor, where names and last digits changed, below the error of the mesh: at
    /// first order twice what a mesh twice as fine changes.
    fn close(mut self) -> Finding {
        let error = CHOSEN.max(2.0 * self.error_of_mesh());
        let kept = |own: &&Seen| match own.change.filter(|_| own.exact) {
            Some(change) => {
                change.force.is_some_and(|f| f <= INVARIANT) && change.energy <= INVARIANT
            }
            None => !own.exact && own.energy() <= error,
        };
        if let Some(lost) = self.finding.seen.iter().find(|own| !kept(own)) {
            let reason = format!("{}: {lost}", lost.transformation);
            self.faults.push((Fault::NotInvariant, reason));
        }
        if let Some((fault, reason)) = self.faults.into_iter().min_by_key(|own| own.0) {
            (self.finding.fault, self.finding.reason) = (Some(fault), reason);
        }
        self.finding
    }
}
