//! What several verbs ask of their arguments: cases and methods by name, no two of one name.

use std::collections::BTreeSet;
use std::path::Path;

use super::error::CliError;
use crate::case::{self, Case, shipped};
use crate::report::names::file_name;
use crate::run::choice::{Choice, ChoiceError};
use crate::run::outside::SECONDS;
use crate::run::provenance::Provenance;
use crate::run::registry::methods;
use crate::run::run_case::Settings;

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

/// A limit on programs from outside.
#[derive(Debug, clap::Args)]
pub struct ProgramLimit {
    /// Time limit for an increment of a program from outside (exec:PROGRAM), in s
    #[arg(long, default_value_t = SECONDS, value_parser = positive)]
    time_limit: f64,
}

impl ProgramLimit {
    /// A method as on the command line, limited if it is a program.
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
pub fn methods_or_all(named: &[String], limit: &ProgramLimit) -> Result<Vec<Choice>, CliError> {
    if named.is_empty() {
        let all = methods().iter().map(|method| Choice::parse(method.name));
        return Ok(all.collect::<Result<_, _>>()?);
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
