//! `stickslip list` and `stickslip show`: methods, cases and closed forms.

use std::path::Path;

use stickslip_xfem::exact::SOLUTIONS;

use super::error::CliError;
use super::method_manual;
use super::output::say;
use crate::case::{self, shipped};
use crate::report::schema;
use crate::run::registry::{method, methods};

/// Arguments of `stickslip show`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Method or case; `methods` and `schema` print the manuals of the methods and of the output files
    name: String,
}

/// Prints all names.
pub fn run_list() -> Result<bool, CliError> {
    say(format_args!("{}", list_text().trim_end()));
    Ok(true)
}

/// Prints one method or case, or a manual.
pub fn run(Arguments { name }: Arguments) -> Result<bool, CliError> {
    say(format_args!("{}", show_text(&name)?.trim_end()));
    Ok(true)
}

fn list_text() -> String {
    let mut text = String::from("Methods\n");
    for method in methods() {
        text += &format!("  {:<22} {}\n", method.name, method.summary);
    }
    text += "\nCases\n";
    for (name, _) in shipped::CASES {
        let title = match shipped::find(name) {
            Some(Ok(case)) => case.title,
            _ => "does not parse".into(),
        };
        text += &format!("  {name:<32} {title}\n");
    }
    text += "\nClosed forms for [exact]\n";
    for solution in SOLUTIONS {
        text += &format!("  {:<22} {}\n", solution.name, solution.summary);
        for parameter in solution.parameters {
            let default = parameter
                .default
                .map_or_else(String::new, |v| format!(" (default {v})"));
            text += &format!(
                "  {:<22}   {}: {}{default}\n",
                "", parameter.name, parameter.summary
            );
        }
    }
    text
}

fn show_text(name: &str) -> Result<String, CliError> {
    match name {
        "methods" => return Ok(method_manual::all()),
        "schema" => return Ok(schema::manual()),
        _ => {}
    }
    if let Some((_, text)) = shipped::CASES.iter().find(|(own, _)| *own == name) {
        return Ok((*text).to_owned());
    }
    if Path::new(name).exists() {
        return Ok(case::read(name)?.source);
    }
    let method = method(name).ok_or_else(|| CliError::Unknown {
        what: "method or case",
        name: name.into(),
        known: methods()
            .iter()
            .map(|m| m.name)
            .chain(shipped::CASES.iter().map(|c| c.0))
            .collect::<Vec<_>>()
            .join(", "),
    })?;
    Ok(method_manual::page(method))
}
