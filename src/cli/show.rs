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
    let text = name.map_or_else(|| Ok(list_text()), |name| show_text(&name))?;
    say(format_args!("{}", text.trim_end()));
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

/// Meaning of a name; names come before files and folders, so that `./methods` is a folder.
fn show_text(name: &str) -> Result<String, CliError> {
    let path = Path::new(name);
    if name == "methods" {
        Ok(method_manual::all())
    } else if name == "schema" {
        Ok(schema::manual())
    } else if let Some((_, text)) = shipped::CASES.iter().find(|(own, _)| *own == name) {
        Ok((*text).to_owned())
    } else if let Some(method) = method(name) {
        Ok(method_manual::page(method))
    } else if path.is_dir() {
        let megabytes = page::write(path)? as f64 / 1e6;
        Ok(format!(
            "{}: {megabytes:.1} MB",
            path.join(page::FILE).display()
        ))
    } else if path.exists() {
        Ok(case::read(name)?.source)
    } else {
        let methods = methods().iter().map(|own| own.name);
        let known: Vec<&str> = methods
            .chain(shipped::CASES.iter().map(|own| own.0))
            .collect();
        Err(CliError::Unknown {
            what: "method or case",
            name: name.into(),
            known: known.join(", "),
        })
    }
}
