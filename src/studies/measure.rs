//! A task, measured: the load path once, for what is found. Times for comparison come from [`in_turn`].

mod answer;
mod bench;
mod looks;
mod reference;
mod rounds;

pub use answer::Answer;
pub use bench::{Bench, MeasureError, RunError, Scene, warm_up};
pub use rounds::{Repeats, in_turn};

use rayon::prelude::*;
use stickslip_methods::PointStatus;

use crate::model::errors::errors;
use crate::model::resolution::{Sliding, too_coarse};
use crate::run::choice::Choice;
use crate::run::path::{Guess, Moment, Run};
use crate::run::progress::Progress;
use crate::run::verdict::Verdict;
use crate::studies::followed::followed;
use crate::studies::memory;
use crate::studies::record::{Found, Record, Spent, Step};
use crate::studies::stress::check::check;
use crate::studies::stress::twin::change;
use crate::studies::task::{Asked, Matter, Task, share_traction};
use answer::AsItIs;
use looks::{Seen, ask};
use reference::solver_error;

/// Measures a task; its times are those of one pass.
///
/// # Errors
/// [`MeasureError`].
pub fn measure(scene: &Scene<'_>, task: &Task, choice: &Choice) -> Result<Answer, MeasureError> {
    let run = Run {
        posed: scene.posed(),
        choice,
        accuracy: task.asked.accuracy(),
        guess: if task.asked.cold {
            Guess::Cold
        } else {
            Guess::Before
        },
    };
    let verdict = Verdict::Crashed("a load path without increments".into());
    let mut looking = task.clone();
    if task.looks.check {
        let all = (true, true, true);
        let looks = &mut looking.looks;
        (looks.quantities, looks.curves, looks.fields) = all;
    }
    let mut found = Found {
        problem: Some(scene.size(task)),
        ..Found::only(verdict, choice.label.clone(), choice.exact())
    };
    let (mut answer, mut work) = (Seen::default(), Vec::new());
    let mut status: Option<Vec<PointStatus>> = None;
    let (mut failed, mut sliding) = (Ok(()), Sliding::default());
    let end = run.follow(&mut |moment| {
        let Moment { solved, now, .. } = moment;
        let mut step = Step::of(moment.number, solved, status.as_deref(), now);
        work.extend(solved.work);
        status = solved.judged.as_ref().map(|judged| judged.status.clone());
        if let (Some((_, loading)), Some(status)) = (scene.body(), &status) {
            sliding.see(loading.body(), status);
        }
        answer.look(scene, &looking, &moment, &mut step);
        if let Err(error) = ask(scene, task, choice, moment, &mut found) {
            failed = Err(error);
        }
        found.increments.push(step);
    });
    failed?;
    found.verdict = end.verdict;
    if let Some((_, loading)) = scene.body() {
        found.coarse = too_coarse(loading.body());
        found.coarse.extend(sliding.too_coarse());
    }
    let mut output_s = f64::NAN;
    if let (Some((case, loading)), Some(now)) = (scene.body(), &end.now) {
        let body = loading.body();
        if task.looks.output {
            output_s = scene.output(now);
        }
        if task.looks.truth {
            match loading.exact(loading.increments()) {
                Some(field) => {
                    found.deviations = errors(body, &body.surface.quadrature, field, now)?;
                }
                None => found.values = followed(case, loading, now),
            }
        }
        if task.looks.values && found.values.is_empty() {
            found.values = followed(case, loading, now);
        }
    }
    if let Some([reactions, _]) = answer.solution.as_ref().filter(|_| task.looks.truth) {
        found.deviations = scene.deviations(reactions);
    }
    // Before the reference, which is no part of the task.
    let peaks = [scene.peak_mb, memory::peak_mb()].into_iter().flatten();
    let peak_mb = peaks.reduce(f64::max);
    if task.looks.error && found.verdict.is_honest() {
        found.solver_error = solver_error(scene, &answer.snapshots, choice.name());
    }
    for start in (0..task.looks.starts).filter(|_| choice.exact()) {
        let guess = Guess::Further(start);
        Run { guess, ..run }.follow(&mut |moment| answer.keep_jump(&moment));
    }
    let traction = work.iter().any(|work| work.traction);
    let spent = Spent::of(scene.setup(traction), &work).map(|spent| Spent {
        output_s,
        peak_mb,
        ..spent
    });
    let mut answer = answer.with(Record::here(task, found, spent));
    // From rest: a later increment has a past that is not looked at.
    let first = answer.record.found.increments.len() == 1;
    if let Some((case, _)) = scene.body().filter(|_| task.looks.check && first) {
        let honest = answer.record.found.verdict.is_solved();
        answer.record.found.check = honest.then(|| check(case, answer.last())).flatten();
    }
    answer.record.keep(task.looks);
    Ok(answer)
}

/// Measures tasks in this process, in their order, some of one problem at the same time; `each` is shown every new scene. With
/// `repeats` honest answers are found again for their times, all methods of a problem in turn.
///
/// # Errors
/// The first problem that cannot be discretised or read; what a method does wrong is a verdict.
pub fn here(
    bench: &mut Bench,
    tasks: &[Task],
    choices: &[Choice],
    jobs: usize,
    repeats: Option<Repeats>,
    progress: &dyn Progress,
    each: &mut dyn FnMut(&Scene<'_>, &Task),
) -> Result<Vec<Answer>, RunError> {
    progress.plan(tasks.len());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build()?;
    let mut answers = Vec::new();
    let by_name = |name: &str| choices.iter().find(|choice| choice.argument() == name);
    let method = |task: &Task| by_name(&task.asked.method);
    let mut tasks = tasks.to_vec();
    share_traction(&mut tasks, |task| {
        method(task).is_some_and(Choice::needs_traction)
    });
    for alike in tasks.chunk_by(|a, b| a.asked.is_same_problem(&b.asked)) {
        let first = &alike[0];
        let scene = bench.scene(first)?;
        each(&scene, first);
        let run = |task: &Task| {
            let Some(choice) = method(task) else {
                return Err(MeasureError::Method(task.asked.method.clone()));
            };
            let answer = measure(&scene, task, choice);
            progress.done(&told(&task.asked, &choice.label));
            answer
        };
        // One after the other unless asked otherwise, so that times mean something.
        let own: Result<Vec<Answer>, MeasureError> = match jobs {
            1 => alike.iter().map(run).collect(),
            _ => pool.install(|| alike.par_iter().map(run).collect()),
        };
        let mut own = own?;
        if let Some(repeats) = repeats {
            let honest = (0..own.len()).filter(|&k| own[k].record.is_honest());
            let honest: Vec<usize> = honest.collect();
            let asked = honest.iter().map(|&k| &own[k].record.asked);
            let tasks = asked.filter_map(|asked| Some((asked, by_name(&asked.method)?)));
            let times = in_turn(&scene, &tasks.collect::<Vec<_>>(), repeats);
            for (k, times) in honest.into_iter().zip(times) {
                own[k].record = own[k].record.clone().retimed(times);
            }
        }
        answers.extend(own);
    }
    Ok(answers)
}

/// A task in words.
fn told(asked: &Asked, label: &str) -> String {
    format!("{} r{} mu={} {label}", asked.case, asked.refine, asked.mu())
}

impl Bench {
    /// Measures a task for its record; one that sees a case another way is held to the answer to the case as it is.
    ///
    /// # Errors
    /// [`MeasureError`].
    pub fn record(&mut self, task: &Task, choice: &Choice) -> Result<Record, MeasureError> {
        let (Some(view), Matter::Case { text, .. }) = (task.asked.view, &*task.matter) else {
            return Ok(measure(&self.scene(task)?, task, choice)?.record);
        };
        let mut looking = task.clone();
        (looking.looks.quantities, looking.looks.curves) = (true, true);
        let mut plain = looking.clone();
        plain.asked.view = None;
        let id = plain.id();
        if self.as_it_is.as_ref().is_none_or(|known| known.id != id) {
            let scene = self.scene(&plain)?;
            let answer = measure(&scene, &plain, choice)?;
            let case = scene.body().map(|(case, _)| case.clone());
            self.as_it_is = case.map(|case| AsItIs { id, case, answer });
        }
        let mut answer = measure(&self.scene(&looking)?, &looking, choice)?;
        let solved = |own: &Answer| own.record.found.verdict.is_solved();
        let both = self
            .as_it_is
            .as_ref()
            .filter(|base| solved(&base.answer) && solved(&answer));
        let change =
            both.map(|base| change(&view, &base.case, text, base.answer.last(), answer.last()));
        answer.record.found.change = change;
        answer.record.keep(task.looks);
        Ok(answer.record)
    }
}
