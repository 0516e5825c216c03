//! Common arguments of verbs: cases and methods by name, no two of one name.

use std::any::TypeId;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::error::CliError;
use crate::case::{self, Case, shipped};
use crate::files::claim::COMMAND;
use crate::files::regular;
use crate::files::visible::visible;
use crate::report::names::file_name;
use crate::report::table::Description;
use crate::report::tables::catalogue;
use crate::report::{Claim, Plan, page};
use crate::run::choice::{Choice, ChoiceError};
use crate::run::outside::{OUTSIDE, SECONDS};
use crate::run::provenance::Provenance;
use crate::studies::cases::Settings;
use crate::studies::task::digest_of_bytes;

/// A case by file, or by the name of a shipped one.
pub fn find_case(name: &str) -> Result<Case, CliError> {
    if !Path::new(name).exists() {
        if let Some(case) = shipped::find(name) {
            return Ok(case?);
        }
        if !name.ends_with(".toml") {
            return Err(CliError::Unknown {
                what: "case",
                name: name.into(),
                known: shipped::CASES
                    .iter()
                    .map(|c| c.0)
                    .collect::<Vec<_>>()
                    .join(", "),
            });
        }
    }
    Ok(case::read(name)?)
}

/// Cases as [`find_case`] finds them, no two of one name.
pub fn find_cases(names: &[String]) -> Result<Vec<Case>, CliError> {
    let cases = names.iter().map(|name| find_case(name));
    let cases = cases.collect::<Result<Vec<_>, _>>()?;
    refuse_twins("case", cases.iter().map(|case| case.name.as_str()))?;
    Ok(cases)
}

/// The file that starts this program, or why it is not known.
pub static PROGRAM: OnceLock<Result<PathBuf, String>> = OnceLock::new();

/// That file.
pub fn program_file() -> Result<&'static PathBuf, CliError> {
    let unknown = || CliError::Program("it is not known");
    let file = PROGRAM.get().ok_or_else(unknown)?;
    file.as_ref().map_err(|why| CliError::Program(why))
}

/// Where a command writes.
#[derive(Debug, clap::Args)]
pub struct Output {
    /// Folder for the results; by default results/NAME, of the one case or sweep, else of the verb
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Replace results of another plan, and those that were changed since; files that this program did not write stay
    #[arg(long)]
    pub force: bool,
}

/// Sub-folders of results, and a name in each.
const BELOW: [&str; 5] = [
    "figures/a",
    "fields/a",
    "cases/a",
    "records/a",
    "solutions/a",
];

impl Output {
    /// The folder.
    pub fn folder(&self, name: &str) -> PathBuf {
        // A name of dots would be another folder.
        let name = file_name(&[name]);
        let name = Some(name.trim_start_matches('.')).filter(|name| !name.is_empty());
        let usual = || Path::new("results").join(name.unwrap_or("unnamed"));
        self.out.clone().unwrap_or_else(usual)
    }

    /// The right to write there. Whatever has the name of a table or page and is not this program's is in the way, so that
    /// nobody takes it for one of the results.
    pub fn claim(&self, name: &str, plan: Plan) -> Result<Claim, CliError> {
        let claim = Claim::new(&self.folder(name), plan, self.force)?;
        let ends = ["csv", "md", "tex"];
        let forms = |(_, table): (_, Description)| ends.map(|end| format!("{}.{end}", table.name));
        let tables: Vec<String> = catalogue().into_iter().flat_map(forms).collect();
        let others = ["provenance.toml", page::FILE].into_iter().chain(BELOW);
        claim.expect(tables.iter().map(String::as_str).chain(others))?;
        Ok(claim)
    }
}

/// The name of the only one, else that of the verb.
pub fn only<'a>(mut names: impl Iterator<Item = &'a str>, verb: &'a str) -> &'a str {
    match (names.next(), names.next()) {
        (Some(name), None) => name,
        _ => verb,
    }
}

/// Options that say where and how something is done, not what.
const HOW: [&str; 6] = ["out", "force", "jobs", "repeats", "quiet", "json"];

/// Largest file whose contents stand in a plan [bytes]: of larger ones there is the name alone.
const DIGESTED: u64 = 64 << 20;

/// Requests of a command line, by the names of its options, those by default too; files with digests of their contents.
pub fn plan(command: &clap::Command, matches: &clap::ArgMatches) -> Plan {
    let below = matches.subcommand();
    if let Some((own, matches)) = below.and_then(|(n, m)| Some((command.find_subcommand(n)?, m))) {
        let mut plan = plan(own, matches);
        let verb = plan.entry(COMMAND.into()).or_default();
        *verb = format!("{} {verb}", own.get_name()).trim_end().to_owned();
        return plan;
    }
    let asked = (command.get_arguments()).filter(|own| !HOW.contains(&own.get_id().as_str()));
    let given = asked.filter_map(|own| {
        let id = own.get_id().as_str();
        let is_file = own.get_value_parser().type_id() == TypeId::of::<PathBuf>();
        let values = matches
            .try_get_raw(id)
            .ok()??
            .map(|value| match value.to_str() {
                Some(name) if id == "method" => told(name, name.strip_prefix(OUTSIDE)),
                Some(name) => told(name, (is_file || id == "cases").then_some(name)),
                None => told(&value.to_string_lossy(), None),
            });
        // In which order they are given does not matter.
        let mut values: Vec<String> = values.collect();
        values.sort();
        Some((id.to_owned(), values.join(", ")))
    });
    given.collect()
}

/// A value, of a file that can be read its name and the digest of its contents.
pub fn told(value: &str, file: Option<&str>) -> String {
    let read = file.and_then(|file| Some((file, regular::read(file.as_ref(), DIGESTED).ok()?)));
    visible(&read.map_or(value.to_owned(), |(file, bytes)| {
        let name = Path::new(file).file_name().unwrap_or_default();
        format!("{} {}", name.display(), digest_of_bytes(&bytes))
    }))
}

/// A limit on methods.
#[derive(Debug, clap::Args)]
pub struct TimeLimit {
    /// Time limit for an increment by a method, in s
    #[arg(long, default_value_t = SECONDS, value_parser = positive)]
    time_limit: f64,
}

impl TimeLimit {
    /// A method as on the command line, limited.
    pub fn parse(&self, argument: &str) -> Result<Choice, ChoiceError> {
        Ok(Choice::parse(argument)?.limited(self.time_limit, None))
    }
}

/// A number of seconds.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 1e9 => Ok(seconds),
        _ => Err("a number > 0 and at most 1e9".into()),
    }
}

/// The methods named, or all of them with their defaults.
pub fn methods_or_all(named: &[String], limit: &TimeLimit) -> Result<Vec<Choice>, CliError> {
    if named.is_empty() {
        return Ok(Choice::all()?);
    }
    let chosen = named.iter().map(|argument| limit.parse(argument));
    let chosen = chosen.collect::<Result<Vec<_>, _>>()?;
    refuse_twins("method", chosen.iter().map(|choice| choice.label.as_str()))?;
    Ok(chosen)
}

/// Two runs of one name would write the same files, also where they differ in what file names leave out.
pub fn refuse_twins<'a>(
    what: &'static str,
    names: impl Iterator<Item = &'a str>,
) -> Result<(), CliError> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(file_name(&[name])) {
            return Err(CliError::Twice {
                what,
                name: name.into(),
            });
        }
    }
    Ok(())
}

/// The program, this machine, these settings, and the digests of programs from outside.
pub fn provenance_with(settings: Settings, choices: &[Choice]) -> Provenance {
    let programs = choices.iter().filter_map(|c| Some((c, c.program()?)));
    programs.fold(provenance(settings), |all, (choice, program)| {
        all.with_option(&choice.label, format!("SHA-256 {}", program.digest()))
    })
}

/// The program, this machine and these settings.
pub fn provenance(settings: Settings) -> Provenance {
    let tier = settings
        .tier
        .map_or_else(|| "of each case".to_owned(), |t| t.to_string());
    Provenance::collect(settings.jobs.max(rayon::current_num_threads()))
        .with_option("jobs", settings.jobs.to_string())
        .with_option("tier", tier)
}
