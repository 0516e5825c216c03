//! The sweep file: which cells there are.
//!
//! ```toml
//! title = "Methods on two cases"
//! repeats = { least = 7, most = 200, seconds = 0.05, patience_s = 2.0 }   # the default
//!
//! [[cells]]                                    # every combination of what follows; blocks are joined
//! cases = ["plate_mesh1", "my_case.toml"]      # shipped cases, or files beside this one
//! # random = { dimension = 2, seed = 1, problems = 20 }     instead: problems of `stickslip stress methods`
//! # bodies = { dimension = 3, seed = 1, points = [100, 1000], of_each = 5 }     or: bodies of about so many contact points
//! refine = [1, 2]                              # the case's own by default
//! contact = ["star", "edge-pairs"]             # of all cracks; the case's own by default
//! friction = [0.1, 0.8]                        # of all cracks; the case's own by default
//! methods = ["hybrid", "penalty:normal=1e2,tangential=1e2"]      # all by default, with their default options
//! tolerances = [1e-3, 1e-6, 1e-9]              # bounds on the violation; the default
//! ```

use std::path::Path;
use std::sync::Arc;

use crate::run::registry::methods;
use stickslip_methods::Tier;

use super::bodies::{FRICTION, POINTS, Sized};
use super::cell::{Cell, digest};
use super::measure::Repeats;
use super::record::SCHEMA;
use super::store::Contents;
use crate::case::error::CaseError;
use crate::case::parse::{document, read_text};
use crate::case::reader::Value;
use crate::case::shipped;
use crate::case::{self, Case, ContactSpace};
use crate::model::body::Needs;
use crate::run::choice::Choice;
use crate::run::run_case::friction_values;
use crate::studies::robustness::{RobustnessError, case_numbered};

/// Largest number of cells of a sweep; each is a file, and a line in the tables.
const MAX_CELLS: usize = 100_000;

/// Largest number of cases that a sweep names; all are read before anything is measured.
const MAX_CASES: usize = 1000;

/// Largest number of random problems of a block; all are drawn before anything is measured.
const MAX_PROBLEMS: usize = 10_000;

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

/// A cell with what it takes to measure it anywhere.
#[derive(Debug, Clone)]
pub struct Task {
    /// [`Cell::id`].
    pub id: String,
    /// The cell.
    pub cell: Cell,
    /// Its case file.
    pub text: Arc<str>,
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
            let mut room = Room {
                cells: MAX_CELLS,
                cases: MAX_CASES,
            };
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
                block.cases = random.cases(block.friction.as_deref())?;
            }
            let own = block.cases.iter();
            tasks.extend(own.flat_map(|(name, case)| block.tasks_of(name, case)));
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

/// One `[[cells]]`: cases by name, and what is combined with each.
struct Block {
    cases: Vec<(String, Case)>,
    refine: Option<Vec<usize>>,
    contact: Vec<Option<ContactSpace>>,
    friction: Option<Vec<f64>>,
    methods: Vec<String>,
    tolerances: Vec<f64>,
}

/// What further blocks may still ask for.
struct Room {
    cells: usize,
    cases: usize,
}

/// Takes from what is left, or refuses the value that asks for more.
fn take(
    left: &mut usize,
    count: usize,
    most: usize,
    value: Value<'_>,
    what: &str,
) -> Result<(), CaseError> {
    let Some(rest) = left.checked_sub(count) else {
        let asked = (most - *left).saturating_add(count);
        let allowed = format!("at most {most} {what} in all blocks");
        return Err(value.refuse(allowed, format_args!("{asked} {what} so far")));
    };
    *left = rest;
    Ok(())
}

/// Random problems that a block asks for.
struct Random {
    dim: usize,
    seed: u64,
    problems: usize,
}

impl Random {
    fn cases(&self, friction: Option<&[f64]>) -> Result<Vec<(String, Case)>, PlanError> {
        // The same bodies for all methods, also those that need the stress at the crack.
        let needs = Needs {
            frictionless: false,
            traction: true,
        };
        let friction = friction.unwrap_or(&[FRICTION]);
        let case = |problem| {
            let Self { dim, seed, .. } = *self;
            let text = case_numbered(seed, dim, problem, friction, needs)?;
            let name = format!("random-{dim}d-seed-{seed}-{problem:03}");
            Ok((name.clone(), case::parse(format!("{name}.toml"), text)?))
        };
        (0..self.problems).map(case).collect()
    }
}

impl Block {
    /// Cells of one case, or of some random problems.
    fn count(&self, case: Option<&Case>, problems: usize) -> usize {
        let own = |list: fn(&Case) -> usize| case.map_or(1, list);
        let refine = (self.refine.as_ref()).map_or_else(|| own(|c| c.sweep.refine.len()), Vec::len);
        let friction =
            (self.friction.as_ref()).map_or_else(|| own(|c| friction_values(c).len()), Vec::len);
        let lists = [
            refine,
            friction,
            self.contact.len(),
            self.methods.len(),
            self.tolerances.len(),
        ];
        lists.into_iter().fold(problems, usize::saturating_mul)
    }

    fn tasks_of(&self, name: &str, case: &Case) -> Vec<Task> {
        let text: Arc<str> = Arc::from(case.source.as_str());
        let digest = digest(&case.source);
        let friction = match &self.friction {
            Some(given) => given
                .iter()
                .map(|&mu| vec![mu; case.cracks.len()])
                .collect(),
            None => friction_values(case),
        };
        let mut tasks = Vec::new();
        for &refine in self.refine.as_ref().unwrap_or(&case.sweep.refine) {
            for (contact, friction) in product(&self.contact, &friction) {
                for (method, tolerance) in product(&self.methods, &self.tolerances) {
                    let cell = Cell {
                        case: name.to_owned(),
                        digest: digest.clone(),
                        refine,
                        space: contact.map(|space| space.name().to_owned()),
                        friction: friction.clone(),
                        method: method.clone(),
                        tolerance: *tolerance,
                    };
                    tasks.push(Task {
                        id: cell.id(),
                        cell,
                        text: text.clone(),
                    });
                }
            }
        }
        tasks
    }
}

/// Every entry of one list with every entry of another.
fn product<'a, A, B>(a: &'a [A], b: &'a [B]) -> impl Iterator<Item = (&'a A, &'a B)> {
    a.iter().flat_map(move |a| b.iter().map(move |b| (a, b)))
}

/// A block, with the random problems that are still to be drawn.
fn block(
    value: Value<'_>,
    folder: &Path,
    room: &mut Room,
) -> Result<(Block, Option<Random>), CaseError> {
    let table = value.table(&[
        "cases",
        "random",
        "bodies",
        "refine",
        "contact",
        "friction",
        "methods",
        "tolerances",
    ])?;
    let (mut cases, mut drawn) = (Vec::new(), None);
    match table.exactly_one(&["cases", "random", "bodies"])? {
        ("cases", list) => {
            let count = list.list()?.len();
            take(&mut room.cases, count, MAX_CASES, list, "cases")?;
            let found = entries(list, |v| find_case(v, folder))?;
            cases.extend(found.into_iter().map(|case| (case.name.clone(), case)));
        }
        ("bodies", sizes) => cases.extend(bodies(sizes, room)?),
        (_, random) => {
            let table = random.table(&["dimension", "seed", "problems"])?;
            let seed = table.get("seed");
            drawn = Some(Random {
                dim: table.required("dimension")?.integer(2..=3)?,
                seed: seed.map_or(Ok(1), |v| v.integer(0..=usize::MAX))? as u64,
                problems: table.required("problems")?.integer(1..=MAX_PROBLEMS)?,
            });
        }
    }
    let named = ContactSpace::ALL.map(|space| (space.name(), Some(space)));
    let bounded =
        |v: Value<'_>| v.number_if("1e-14 <= tolerance < 1", |t| (1e-14..1.0).contains(&t));
    let tolerances = table.optional("tolerances", |v| entries(v, bounded))?;
    let methods = || methods().iter().map(|m| m.name.to_owned()).collect();
    let block = Block {
        cases,
        refine: table.optional("refine", |v| entries(v, |v| v.integer(1..=1024)))?,
        contact: table
            .optional("contact", |v| entries(v, |v| v.one_of(&named)))?
            .unwrap_or(vec![None]),
        friction: table.optional("friction", |v| {
            entries(v, |v| v.number_if("numbers >= 0", |mu| mu >= 0.0))
        })?,
        methods: table
            .optional("methods", |v| entries(v, method))?
            .unwrap_or_else(methods),
        tolerances: tolerances.unwrap_or_else(|| Tier::ALL.map(Tier::tolerance).to_vec()),
    };
    let drawn_cells = drawn
        .as_ref()
        .map(|random| block.count(None, random.problems));
    let own = block
        .cases
        .iter()
        .map(|(_, case)| block.count(Some(case), 1));
    let cells = own.chain(drawn_cells).fold(0, usize::saturating_add);
    take(&mut room.cells, cells, MAX_CELLS, value, "cells")?;
    Ok((block, drawn))
}

/// Bodies of some sizes.
fn bodies(value: Value<'_>, room: &mut Room) -> Result<Vec<(String, Case)>, CaseError> {
    let table = value.table(&["dimension", "seed", "points", "of_each"])?;
    let dim = table.required("dimension")?.integer(2..=3)?;
    let seed = table.get("seed");
    let seed = seed.map_or(Ok(1), |v| v.integer(0..=usize::MAX))? as u64;
    let sizes = entries(table.required("points")?, |v| v.integer(POINTS))?;
    let of_each = table.required("of_each")?.integer(1..=MAX_CASES)?;
    let count = sizes.len().saturating_mul(of_each);
    take(&mut room.cases, count, MAX_CASES, value, "cases")?;
    let all = sizes.iter().flat_map(|&points| {
        (0..of_each).map(move |number| Sized {
            dim,
            points,
            seed,
            number,
        })
    });
    all.map(|body| {
        let name = body.name();
        Ok((
            name.clone(),
            case::parse(format!("{name}.toml"), body.text())?,
        ))
    })
    .collect()
}

/// A list with at least one entry.
fn entries<T>(
    list: Value<'_>,
    mut read: impl FnMut(Value<'_>) -> Result<T, CaseError>,
) -> Result<Vec<T>, CaseError> {
    let values = list.list()?;
    if values.is_empty() {
        return Err(list.refuse("at least one entry", "empty list"));
    }
    values.into_iter().map(&mut read).collect()
}

fn find_case(value: Value<'_>, folder: &Path) -> Result<Case, CaseError> {
    let name = value.string()?;
    if let Some(case) = shipped::find(name) {
        return case;
    }
    if !name.ends_with(".toml") {
        let known: Vec<&str> = shipped::CASES.iter().map(|c| c.0).collect();
        let allowed = format!("a file.toml, or one of {}", known.join(", "));
        return Err(value.refuse(allowed, "unknown case"));
    }
    // What is wrong in the case stands there; that there is none is wrong here.
    case::read(folder.join(name)).map_err(|e| match e.line() {
        0 => value.refuse(e.allowed(), format_args!("{}: {}", e.message(), e.value())),
        _ => e,
    })
}

fn method(value: Value<'_>) -> Result<String, CaseError> {
    let text = value.string()?;
    let allowed =
        "name or name:option=value,option=value, as `stickslip list` and `show` name them";
    let choice = Choice::parse(text).map_err(|e| value.refuse(allowed, e))?;
    Ok(choice.argument())
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
