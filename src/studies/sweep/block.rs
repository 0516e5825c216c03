//! One `[[cells]]` of a sweep file.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use stickslip_methods::Tier;

use super::bodies::{POINTS, Sized};
use super::cell::{Cell, Named, Source, Task, digest};
use super::files::FileProblem;
use super::options::settings;
use crate::case::error::CaseError;
use crate::case::reader::{Table, Value};
use crate::case::shipped;
use crate::case::{self, Case, ContactSpace};
use crate::run::choice::{Choice, seen_from};
use crate::run::run_case::friction_values;

/// Largest number of cells of a sweep; each is a file, and a line in the tables.
const MAX_CELLS: usize = 100_000;

/// Largest number of cases that a sweep names; all are read before anything is measured.
const MAX_CASES: usize = 1000;

/// Largest number of random problems of a block; all are drawn before anything is measured.
const MAX_PROBLEMS: usize = 10_000;

/// Most parts that an increment of a case is divided in.
const MAX_PARTS: usize = 1000;

/// Where methods begin an increment, and whether it is a cold start.
const STARTS: [(&str, bool); 2] = [("warm", false), ("cold", true)];

/// One `[[cells]]`: cases by name, and what is combined with each.
pub(super) struct Block {
    pub cases: Vec<(String, Case)>,
    pub files: Vec<FileProblem>,
    refine: Option<Vec<usize>>,
    contact: Vec<Option<ContactSpace>>,
    pub friction: Option<Vec<f64>>,
    increments: Vec<usize>,
    /// Whether cold, by start.
    start: Vec<bool>,
    pub methods: Vec<Named>,
    pub tolerances: Vec<f64>,
}

/// Random problems that a block asks for.
pub(super) struct Random {
    pub dim: usize,
    pub seed: u64,
    pub problems: usize,
}

/// What further blocks may still ask for.
pub(super) struct Room {
    cells: usize,
    cases: usize,
    /// Programs so far, by label.
    programs: BTreeMap<String, String>,
}

impl Default for Room {
    fn default() -> Self {
        Self {
            cells: MAX_CELLS,
            cases: MAX_CASES,
            programs: BTreeMap::new(),
        }
    }
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
            self.increments.len(),
            self.start.len(),
            self.methods.len(),
            self.tolerances.len(),
        ];
        lists.into_iter().fold(problems, usize::saturating_mul)
    }

    pub fn tasks_of(&self, name: &str, case: &Case) -> Vec<Task> {
        let source = Arc::new(Source::Case(case.source.clone()));
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
                for (&increments, &cold) in product(&self.increments, &self.start) {
                    for (method, &tolerance) in product(&self.methods, &self.tolerances) {
                        let cell = Cell {
                            case: name.to_owned(),
                            digest: digest.clone(),
                            refine,
                            space: contact.map(|space| space.name().to_owned()),
                            friction: friction.clone(),
                            increments,
                            cold,
                            method: method.argument.clone(),
                            tolerance,
                            program: method.program.clone(),
                        };
                        tasks.push(Task::new(cell, source.clone()));
                    }
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
pub(super) fn block(
    value: Value<'_>,
    folder: &Path,
    room: &mut Room,
) -> Result<(Block, Option<Random>), CaseError> {
    let table = value.table(&[
        "cases",
        "random",
        "files",
        "bodies",
        "refine",
        "contact",
        "friction",
        "increments",
        "start",
        "methods",
        "options",
        "tolerances",
    ])?;
    let (mut cases, mut drawn) = (Vec::new(), None);
    let mut files = Vec::new();
    match table.exactly_one(&["cases", "random", "bodies", "files"])? {
        ("cases", list) => {
            let count = list.list()?.len();
            take(&mut room.cases, count, MAX_CASES, list, "cases")?;
            let found = entries(list, |v| find_case(v, folder))?;
            cases.extend(found.into_iter().map(|case| (case.name.clone(), case)));
        }
        ("bodies", sizes) => cases.extend(bodies(sizes, room)?),
        ("files", list) => {
            for key in ["refine", "contact", "friction", "increments", "start"] {
                if let Some(value) = table.get(key) {
                    let allowed =
                        "no such key beside `files`: a problem file is one increment from rest";
                    return Err(value.refuse(allowed, key));
                }
            }
            let named = entries(list, |v| Ok(folder.join(v.string()?)))?;
            let allowed = "files, and folders that hold some";
            files = FileProblem::all(&named).map_err(|e| list.refuse(allowed, e))?;
        }
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
    let block = Block {
        cases,
        files,
        refine: table.optional("refine", |v| entries(v, |v| v.integer(1..=1024)))?,
        contact: table
            .optional("contact", |v| entries(v, |v| v.one_of(&named)))?
            .unwrap_or(vec![None]),
        friction: table.optional("friction", |v| {
            entries(v, |v| v.number_if("numbers >= 0", |mu| mu >= 0.0))
        })?,
        increments: table
            .optional("increments", |v| entries(v, |v| v.integer(1..=MAX_PARTS)))?
            .unwrap_or(vec![1]),
        start: table
            .optional("start", |v| entries(v, |v| v.one_of(&STARTS)))?
            .unwrap_or(vec![false]),
        methods: methods(&table, folder, &mut room.programs)?,
        tolerances: tolerances.unwrap_or_else(|| Tier::ALL.map(Tier::tolerance).to_vec()),
    };
    let drawn_cells = drawn
        .as_ref()
        .map(|random| block.count(None, random.problems));
    let own = block
        .cases
        .iter()
        .map(|(_, case)| block.count(Some(case), 1));
    let of_files = [
        &block.files.len(),
        &block.methods.len(),
        &block.tolerances.len(),
    ];
    let of_files = of_files
        .into_iter()
        .fold(1, |n: usize, k| n.saturating_mul(*k));
    let cells = own.chain(drawn_cells).fold(of_files, usize::saturating_add);
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
fn entries<'a, T>(
    list: Value<'a>,
    mut read: impl FnMut(Value<'a>) -> Result<T, CaseError>,
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

/// The methods of a block, each with its settings.
fn methods(
    table: &Table<'_>,
    folder: &Path,
    programs: &mut BTreeMap<String, String>,
) -> Result<Vec<Named>, CaseError> {
    let named = table.optional("methods", |v| {
        entries(v, |v| Ok((v, method(v, folder, programs)?)))
    })?;
    let all = Choice::all();
    let all = all.map_err(|e| table.missing(&e.to_string()))?;
    let chosen = match (table.get("options"), named) {
        (Some(options), named) => settings(options, named, &all)?,
        (None, Some(named)) => named.into_iter().map(|(_, choice)| choice).collect(),
        (None, None) => all,
    };
    Ok(chosen.iter().map(Named::of).collect())
}

fn method(
    value: Value<'_>,
    folder: &Path,
    programs: &mut BTreeMap<String, String>,
) -> Result<Choice, CaseError> {
    let text = seen_from(folder, value.string()?);
    let allowed = "name or name:option=value,option=value, as `stickslip list` and `show` name them, or exec:PROGRAM";
    let choice = Choice::parse(&text).map_err(|e| value.refuse(allowed, e))?;
    if choice.program().is_some() {
        let first = programs.entry(choice.label.clone());
        let argument = choice.argument();
        if *first.or_insert(argument.clone()) != argument {
            return Err(value.refuse("files of different names", "two programs of one name"));
        }
    }
    Ok(choice)
}
