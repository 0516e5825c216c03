//! The sweep file: which cells there are.
//!
//! ```toml
//! title = "Methods on two cases"
//! repeats = { least = 7, most = 200, seconds = 0.05, patience_s = 2.0 }   # the default
//!
//! [[cells]]                                    # every combination of what follows; blocks are joined
//! cases = ["plate_mesh1", "my_case.toml"]      # shipped cases, or files beside this one
//! # random = { dimension = 2, seed = 1, problems = 20 }     instead: random problems with one crack
//! # files = ["collection", "problem.hdf5"]     or: FCLIB files and folders of them, beside this file
//! # bodies = { dimension = 3, seed = 1, points = [100, 1000], of_each = 5 }     or: bodies of about so many contact points
//! refine = [1, 2]                              # the case's own by default
//! contact = ["star", "edge-pairs"]             # of all cracks; the case's own by default
//! friction = [0.1, 0.8]                        # of all cracks; the case's own by default
//! increments = [1, 10]                         # equal parts of every increment of the case; 1 by default
//! start = ["warm", "cold"]                     # contact forces of the last increment to begin from, or none; warm by default
//! methods = ["hybrid", "penalty:normal=1e2,tangential=1e2", "exec:mine.py"]      # all of the registry by default; programs beside this file
//! # options.r = { from = 1e-3, to = 1e3, per_decade = 1 }   values of an option of the methods, also as a list; see `options`
//! tolerances = [1e-3, 1e-6, 1e-9]              # bounds on the violation; the default
//! looks = ["why", "stops"]                     # why runs gave up and what would have solved it; where published stopping tests stop
//! ```

mod block;
mod options;

use std::collections::BTreeMap;
use std::path::Path;

use stickslip_methods::Tier;

use crate::case::error::CaseError;
use crate::case::parse::{document, fault, faultless, read_text};
use crate::case::reader::Value;
use crate::run::choice::Choice;
use crate::run::verdict::Accuracy;
use crate::studies::axes::named;
use crate::studies::measure::Repeats;
use crate::studies::sources::{Problem, Size};
use crate::studies::task::{Looks, Task};
use block::{Quota, block};

/// A sweep: its tasks, sorted by id.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Title.
    pub title: String,
    /// How often tasks are repeated for their times.
    pub repeats: Repeats,
    /// Sources: texts by file name.
    pub input: Vec<(String, String)>,
    /// The tasks.
    pub tasks: Vec<Task>,
    /// Predicted time on one core, where that is known [s].
    pub seconds: Option<f64>,
}

/// Finer meshes for time against total error, as far as they have not more cells in 2D and in 3D.
const FINER: [[usize; 2]; 2] = [[2, 4], [2, 3]];
const MOST_CELLS: [f64; 2] = [1e5, 1.5e4];
/// Times from studies of shipped cases [s]: of a task with its repetitions, of a cell of a body in 2D, in 3D and in 3D with a
/// front inside, whose cells have branch functions; part of the latter that is spent on the errors of an answer. Of a cell and
/// increment, and how often a path is followed for repetitions and the converged solution.
const TASK_S: f64 = 0.08;
const STEP_S: f64 = 1.2e-6;
const PASSES: f64 = 10.0;
const CELL_S: [f64; 3] = [3e-5, 1e-4, 4e-3];
const OF_ERRORS: f64 = 0.25;

impl Plan {
    /// Reads a sweep file.
    ///
    /// # Errors
    /// All faults, of a table the first, with their places.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        Self::parse(path, &read_text(path)?)
    }

    /// The same for the text of a sweep file; cases are looked for beside `file`.
    ///
    /// # Errors
    /// All faults, of a table the first, with their places.
    pub fn parse(file: &Path, text: &str) -> Result<Self, CaseError> {
        let keys = ["title", "repeats", "cells"];
        let folder = file.parent().unwrap_or(Path::new(""));
        document(file, text, &keys, |root| {
            let title = root.required("title").and_then(|v| v.label());
            let repeats = root.get("repeats").map_or(Ok(Repeats::DEFAULT), repeats);
            let blocks = root.tables("cells")?;
            if blocks.is_empty() {
                return Err(root.missing("`[[cells]]`"));
            }
            let mut quota = Quota::default();
            let own = blocks
                .into_iter()
                .map(|value| block(value, folder, &mut quota));
            let own = faultless(own);
            let faults = [fault(&title), fault(&repeats), fault(&own)];
            CaseError::all(faults.into_iter().flatten())?;
            let (title, repeats) = (title?, repeats?);
            let tasks = own?.into_iter().flatten().collect();
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let input = vec![(name.into_owned(), text.to_owned())];
            Ok(Self::of(title, repeats, input, tasks))
        })
    }

    /// Time against error: problems as they say themselves by some methods, asked for one decade after the other, and on finer
    /// meshes for tier high; those of files at every tier.
    pub fn of_problems(title: String, problems: &[Problem], choices: &[Choice]) -> Self {
        let high = Accuracy::exactly(Tier::High.tolerance());
        let decades = (2..=10).map(|d| Accuracy::exactly(10f64.powi(-d)));
        let decades: Vec<Accuracy> = decades.filter(|own| *own != high).collect();
        let tiers = Tier::ALL.map(|tier| Accuracy::exactly(tier.tolerance()));
        let truth = Looks {
            truth: true,
            error: true,
            output: true,
            ..Looks::default()
        };
        // The errors of the mesh are those of the best answer.
        let looks = Looks {
            truth: false,
            ..truth
        };
        let methods = named(choices);
        let of = |own: &Problem| {
            let Some(Size { dim, cells, .. }) = own.size else {
                return own.subject.tasks(&own.axes, &methods, &tiers, truth);
            };
            let mut meshes = own.axes.clone();
            let fits = |factor: &usize| {
                cells * (*factor as f64).powi(dim as i32) <= MOST_CELLS[usize::from(dim == 3)]
            };
            let factors = FINER[usize::from(dim == 3)];
            let all = own.axes.refine.iter().flat_map(|r| factors.map(|f| r * f));
            meshes.refine.extend(all.filter(fits));
            let mut tasks = own.subject.tasks(&own.axes, &methods, &decades, looks);
            tasks.extend(own.subject.tasks(&meshes, &methods, &[high], truth));
            tasks
        };
        let tasks = problems.iter().flat_map(of).collect();
        let input = problems.iter().filter_map(|own| own.subject.text());
        let mut plan = Self::of(title, Repeats::DEFAULT, input.collect(), tasks);
        plan.seconds = Some(plan.predicted(problems));
        plan
    }

    /// Time on one core [s], from the cells of the meshes: within a factor of three where methods converge.
    fn predicted(&self, problems: &[Problem]) -> f64 {
        let sizes = problems
            .iter()
            .filter_map(|own| Some((&own.subject.digest, own.size?)));
        let sizes: BTreeMap<&String, Size> = sizes.collect();
        let cells = |task: &Task| {
            let size = *sizes.get(&task.asked.digest)?;
            Some((
                size,
                size.cells * (task.asked.refine as f64).powi(size.dim as i32),
            ))
        };
        let body_s = |task: &Task| {
            cells(task).map_or(0.0, |(size, cells)| {
                CELL_S[usize::from(size.dim == 3) * (1 + usize::from(size.ends))] * cells
            })
        };
        let task_s = |task: &Task| {
            let path_s = cells(task).map_or(0.0, |(size, cells)| {
                STEP_S * cells * (size.increments * task.asked.increments) as f64
            });
            // Repetitions end when patience does.
            let repeated_s = (PASSES * path_s).min(self.repeats.patience_s + 3.0 * path_s);
            let errors_s = if task.looks.truth {
                OF_ERRORS * body_s(task)
            } else {
                0.0
            };
            TASK_S + repeated_s + errors_s
        };
        let mut bodies: Vec<&Task> = self.tasks.iter().collect();
        bodies.sort_by_key(|task| task.asked.body());
        bodies.dedup_by_key(|task| task.asked.body());
        let bodies: f64 = bodies.into_iter().map(body_s).sum();
        bodies + self.tasks.iter().map(task_s).sum::<f64>()
    }

    /// Blocks may overlap.
    fn of(title: String, repeats: Repeats, input: Vec<(String, String)>, tasks: Vec<Task>) -> Self {
        let mut named: Vec<(String, Task)> = tasks.into_iter().map(|own| (own.id(), own)).collect();
        named.sort_by(|a, b| a.0.cmp(&b.0));
        named.dedup_by(|a, b| a.0 == b.0);
        Self {
            title,
            repeats,
            input,
            tasks: named.into_iter().map(|own| own.1).collect(),
            seconds: None,
        }
    }
}

fn repeats(value: Value<'_>) -> Result<Repeats, CaseError> {
    let table = value.table(&["least", "most", "seconds", "patience_s"])?;
    let count = |key: &str, default: usize, least: usize| {
        let given = table.get(key);
        given.map_or(Ok(default), |v| v.integer(least..=1_000_000))
    };
    let seconds = |key: &str, default: f64| {
        let given = table.get(key);
        given.map_or(Ok(default), |v| v.number_if("numbers >= 0", |s| s >= 0.0))
    };
    let default = Repeats::DEFAULT;
    let least = count("least", default.least, 1)?;
    Ok(Repeats {
        least,
        most: count("most", default.most.max(least), least)?,
        seconds: seconds("seconds", default.seconds)?,
        patience_s: seconds("patience_s", default.patience_s)?,
    })
}
