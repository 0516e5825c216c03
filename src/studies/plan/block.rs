//! One `[[cells]]` of a sweep file.

use std::collections::BTreeMap;
use std::path::Path;

use stickslip_methods::Tier;

use super::options::settings;
use crate::case::ContactSpace;
use crate::case::error::CaseError;
use crate::case::reader::{Table, Value};
use crate::run::choice::{Choice, seen_from};
use crate::run::verdict::Accuracy;
use crate::studies::axes::{Axes, named, space_name};
use crate::studies::sources::{Problem, SOURCES, Source, entries};
use crate::studies::task::{Looks, Task};

/// Largest number of tasks of a sweep; each is a line in the tables.
const MAX_TASKS: usize = 500_000;

/// Most parts that an increment of a case is divided in.
const MAX_PARTS: usize = 1000;

/// Where methods begin an increment, and whether it is a cold start.
const STARTS: [(&str, bool); 2] = [("warm", false), ("cold", true)];

/// Asks for something else to be looked at.
type Look = fn(&mut Looks);

/// Further looks that there are.
const LOOKS: [(&str, Look); 2] = [
    ("why", |looks| (looks.why, looks.remedy) = (true, true)),
    ("stops", |looks| looks.stops = true),
];

/// The rest that further blocks may still ask for.
pub(super) struct Quota {
    tasks: usize,
    /// Programs so far, by label.
    programs: BTreeMap<String, String>,
}

impl Default for Quota {
    fn default() -> Self {
        Self {
            tasks: MAX_TASKS,
            programs: BTreeMap::new(),
        }
    }
}

/// Axes that a sweep file gives; none: those of each problem.
struct Given {
    refine: Option<Vec<usize>>,
    contact: Option<Vec<ContactSpace>>,
    friction: Option<Vec<f64>>,
    increments: Option<Vec<usize>>,
    cold: Option<Vec<bool>>,
}

impl Given {
    fn read(table: &Table<'_>) -> Result<Self, CaseError> {
        let named = ContactSpace::ALL.map(|space| (space.name(), space));
        Ok(Self {
            refine: table.optional("refine", |v| entries(v, |v| v.integer(1..=1024)))?,
            contact: table.optional("contact", |v| entries(v, |v| v.one_of(&named)))?,
            friction: table.optional("friction", |v| {
                entries(v, |v| v.number_if("numbers >= 0", |mu| mu >= 0.0))
            })?,
            increments: table
                .optional("increments", |v| entries(v, |v| v.integer(1..=MAX_PARTS)))?,
            cold: table.optional("start", |v| entries(v, |v| v.one_of(&STARTS)))?,
        })
    }

    /// The axes of a problem.
    fn on(&self, problem: &Problem, cracks: usize) -> Axes {
        let own = problem.axes.clone();
        let spaces = |all: &Vec<ContactSpace>| all.iter().map(|s| space_name(Some(*s))).collect();
        let friction = |all: &Vec<f64>| all.iter().map(|&mu| vec![mu; cracks]).collect();
        Axes {
            refine: self.refine.clone().unwrap_or(own.refine),
            spaces: self.contact.as_ref().map_or(own.spaces, spaces),
            tips: own.tips,
            friction: self.friction.as_ref().map_or(own.friction, friction),
            increments: self.increments.clone().unwrap_or(own.increments),
            cold: self.cold.clone().unwrap_or(own.cold),
        }
    }
}

/// The tasks of a block.
pub(super) fn block(
    value: Value<'_>,
    folder: &Path,
    quota: &mut Quota,
) -> Result<Vec<Task>, CaseError> {
    let axes = ["refine", "contact", "friction", "increments", "start"];
    let others = ["methods", "options", "tolerances", "looks"];
    let sources = SOURCES.map(|(key, _)| key);
    let table = value.table(&[&sources[..], &axes, &others].concat())?;
    let (source, asked) = table.exactly_one(&sources)?;
    let given = Given::read(&table)?;
    let methods = named(&methods(&table, folder, &mut quota.programs)?);
    let bounded =
        |v: Value<'_>| v.number_if("1e-14 <= tolerance < 1", |t| (1e-14..1.0).contains(&t));
    let tolerances = table.optional("tolerances", |v| entries(v, bounded))?;
    let tolerances = tolerances.unwrap_or_else(|| Tier::ALL.map(Tier::tolerance).to_vec());
    let accuracies: Vec<Accuracy> = tolerances.into_iter().map(Accuracy::exactly).collect();
    let mut looks = Looks {
        truth: true,
        error: true,
        output: true,
        ..Looks::default()
    };
    let more = table.optional("looks", |v| {
        v.list()?.into_iter().map(|v| v.one_of(&LOOKS)).collect()
    });
    let more: Option<Vec<Look>> = more?;
    more.into_iter().flatten().for_each(|look| look(&mut looks));
    let read: Option<Source> = SOURCES.iter().find(|own| own.0 == source).map(|own| own.1);
    let problems = read.map_or(Ok(Vec::new()), |read| read(asked, folder))?;
    let mut tasks = Vec::new();
    for problem in &problems {
        let axes = match problem.cracks {
            Some(cracks) => given.on(problem, cracks),
            None => {
                if let Some((key, value)) = axes.iter().find_map(|k| Some((k, table.get(k)?))) {
                    let allowed = format!(
                        "no such key beside `{source}`: its problems are one increment from rest"
                    );
                    return Err(value.refuse(&allowed, key));
                }
                problem.axes.clone()
            }
        };
        let own = [axes.combinations(), methods.len(), accuracies.len()];
        let count = own.into_iter().fold(1, usize::saturating_mul);
        let Some(rest) = quota.tasks.checked_sub(count) else {
            let allowed = format!("at most {MAX_TASKS} cells in all blocks");
            return Err(value.refuse(allowed, "too many cells"));
        };
        quota.tasks = rest;
        tasks.extend(problem.subject.tasks(&axes, &methods, &accuracies, looks));
    }
    Ok(tasks)
}

/// The methods of a block, each with its settings.
fn methods(
    table: &Table<'_>,
    folder: &Path,
    programs: &mut BTreeMap<String, String>,
) -> Result<Vec<Choice>, CaseError> {
    let named = table.optional("methods", |v| {
        entries(v, |v| Ok((v, method(v, folder, programs)?)))
    })?;
    let all = Choice::all();
    let all = all.map_err(|e| table.missing(&e.to_string()))?;
    Ok(match (table.get("options"), named) {
        (Some(options), named) => settings(options, named, &all)?,
        (None, Some(named)) => named.into_iter().map(|(_, choice)| choice).collect(),
        (None, None) => all,
    })
}

fn method(
    value: Value<'_>,
    folder: &Path,
    programs: &mut BTreeMap<String, String>,
) -> Result<Choice, CaseError> {
    let text = seen_from(folder, value.string()?);
    let allowed =
        "name or name:option=value,option=value, as `stickslip show` names them, or exec:PROGRAM";
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
