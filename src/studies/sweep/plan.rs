//! The sweep file: which cells there are.
//!
//! ```toml
//! title = "Methods on two cases"
//! repeats = { least = 7, most = 200, seconds = 0.05, patience_s = 2.0 }   # the default
//!
//! [[cells]]                                    # every combination of what follows; blocks are joined
//! cases = ["plate_mesh1", "my_case.toml"]      # shipped cases, or files beside this one
//! # random = { dimension = 2, seed = 1, problems = 20 }     instead: problems of `stickslip stress methods`
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
//! ```

use std::path::Path;

use stickslip_methods::Tier;

use super::block::{Block, Random, Room, block};
use super::bodies::FRICTION;
use super::cell::{Named, Task};
use super::files::FileProblem;
use super::measure::Repeats;
use super::record::SCHEMA;
use super::store::Contents;
use crate::case::error::CaseError;
use crate::case::parse::{document, read_text};
use crate::case::reader::Value;
use crate::case::{self, Case};
use crate::model::body::Needs;
use crate::run::registry::methods;
use crate::studies::exchange::collection::CollectionError;
use crate::studies::exchange::problem_file::file_name;
use crate::studies::robustness::{RobustnessError, case_numbered};

/// A sweep: its cells, sorted by id.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Title.
    pub title: String,
    /// How often cells are repeated for their times.
    pub repeats: Repeats,
    /// The cells.
    pub tasks: Vec<Task>,
}

/// Why a sweep file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The file, or a case it names.
    #[error(transparent)]
    File(#[from] CaseError),
    /// Random problems.
    #[error(transparent)]
    Random(#[from] RobustnessError),
}

/// A sweep file as read: what is left to do is to draw the random problems it asks for.
pub struct Outline {
    title: String,
    repeats: Repeats,
    blocks: Vec<(Block, Option<Random>)>,
}

impl Outline {
    /// Reads a sweep file.
    ///
    /// # Errors
    /// The first fault, with its place.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        Self::parse(path, &read_text(path)?)
    }

    /// The text of a sweep file; cases are looked for beside `file`.
    ///
    /// # Errors
    /// The first fault, with its place.
    pub fn parse(file: &Path, text: &str) -> Result<Self, CaseError> {
        let keys = ["title", "repeats", "cells"];
        let folder = file.parent().unwrap_or(Path::new(""));
        document(file, text, &keys, |root| {
            let title = root.required("title")?.label()?;
            let repeats = root.get("repeats").map_or(Ok(Repeats::DEFAULT), repeats)?;
            let blocks = root.tables("cells")?;
            if blocks.is_empty() {
                return Err(root.missing("`[[cells]]`"));
            }
            let mut room = Room::default();
            let blocks = blocks
                .into_iter()
                .map(|value| block(value, folder, &mut room));
            Ok(Self {
                title,
                repeats,
                blocks: blocks.collect::<Result<_, _>>()?,
            })
        })
    }

    /// How many random problems are to be drawn.
    pub fn problems(&self) -> usize {
        let drawn = self.blocks.iter().filter_map(|(_, drawn)| drawn.as_ref());
        drawn.map(|random| random.problems).sum()
    }

    /// Draws the random problems.
    ///
    /// # Errors
    /// Those of the random problems.
    pub fn draw(self) -> Result<Plan, PlanError> {
        let mut tasks = Vec::new();
        for (mut block, drawn) in self.blocks {
            if let Some(random) = drawn {
                block.cases = drawn_cases(&random, block.friction.as_deref())?;
            }
            let own = block.cases.iter();
            tasks.extend(own.flat_map(|(name, case)| block.tasks_of(name, case)));
            let files = block.files.iter();
            tasks.extend(files.flat_map(|file| file.tasks(&block.methods, &block.tolerances)));
        }
        tasks.sort_by(|a: &Task, b: &Task| a.id.cmp(&b.id));
        // Blocks may overlap.
        tasks.dedup_by(|a, b| a.id == b.id);
        Ok(Plan {
            title: self.title,
            repeats: self.repeats,
            tasks,
        })
    }
}

impl Plan {
    /// Reads a sweep file and draws its random problems.
    ///
    /// # Errors
    /// The first fault, with its place.
    pub fn read(path: &Path) -> Result<Self, PlanError> {
        Outline::read(path)?.draw()
    }

    /// The same for the text of a sweep file; cases are looked for beside `file`.
    ///
    /// # Errors
    /// The first fault, with its place.
    pub fn parse(file: &Path, text: &str) -> Result<Self, PlanError> {
        Outline::parse(file, text)?.draw()
    }

    /// Every method with its defaults at every tier on the problem files of a folder.
    ///
    /// # Errors
    /// A folder that cannot be listed.
    pub fn of_folder(folder: &Path) -> Result<Self, CollectionError> {
        let files = FileProblem::all(&[folder.into()])?;
        let methods: Vec<Named> = methods()
            .iter()
            .map(|m| Named {
                argument: m.name.to_owned(),
                program: None,
            })
            .collect();
        let tolerances = Tier::ALL.map(Tier::tolerance);
        let of_file = |file: &FileProblem| file.tasks(&methods, &tolerances);
        let mut tasks: Vec<Task> = files.iter().flat_map(of_file).collect();
        tasks.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(Self {
            title: format!("Problems of {}", file_name(folder)),
            repeats: Repeats::DEFAULT,
            tasks,
        })
    }

    /// What a folder with the records of the sweep holds.
    pub fn contents(&self) -> Contents {
        Contents {
            schema: SCHEMA,
            title: self.title.clone(),
            repeats: self.repeats,
            cells: self.tasks.iter().map(|task| task.id.clone()).collect(),
        }
    }
}

/// The random problems of a block.
fn drawn_cases(
    random: &Random,
    friction: Option<&[f64]>,
) -> Result<Vec<(String, Case)>, PlanError> {
    // The same bodies for all methods, also those that need the stress at the crack.
    let needs = Needs {
        frictionless: false,
        traction: true,
    };
    let friction = friction.unwrap_or(&[FRICTION]);
    let case = |problem| {
        let Random { dim, seed, .. } = *random;
        let text = case_numbered(seed, dim, problem, friction, needs)?;
        let name = format!("random-{dim}d-seed-{seed}-{problem:03}");
        Ok((name.clone(), case::parse(format!("{name}.toml"), text)?))
    };
    (0..random.problems).map(case).collect()
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
