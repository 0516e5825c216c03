//! The verb `show`: methods, cases, closed forms, and folders of reports.

use std::path::Path;

use stickslip_xfem::exact::SOLUTIONS;

use super::error::CliError;
use super::method_manual;
use super::output::say;
use crate::case::{self, shipped};
use crate::report::{page, schema};
use crate::run::registry::{method, methods};

/// Arguments of `stickslip show`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Method or case; `methods` and `schema` print the manuals of the methods and of the output files; a folder of reports is
    /// shown as one page, index.html. All names by default
    name: Option<String>,
}

/// Prints one method or case, a manual, or all names; writes the page of a folder.
pub fn run(Arguments { name }: Arguments) -> Result<bool, CliError> {
    match name {
        None => say(format_args!("{}", list_text().trim_end())),
        // Names come first: `./methods` is the folder.
        Some(name) if Path::new(&name).is_dir() && !is_name(&name) => {
            let bytes = page::write(Path::new(&name))?;
            let page = Path::new(&name).join(page::FILE);
            say(format_args!(
                "{}: {:.1} MB",
                page.display(),
                bytes as f64 / 1e6
            ));
        }
        Some(name) => say(format_args!("{}", show_text(&name)?.trim_end())),
    }
    Ok(true)
}

/// Whether this is the name of a manual, a method or a case.
fn is_name(name: &str) -> bool {
    let is_case = shipped::CASES.iter().any(|case| case.0 == name);
    ["methods", "schema"].contains(&name) || is_case || method(name).is_some()
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
