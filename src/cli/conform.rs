//! `stickslip conform`: does a method, or a program as one, do what methods are to do?

use stickslip_methods::{MethodError, Tier};

use super::arguments::{ProgramLimit, methods_or_all};
use super::error::CliError;
use super::output::{say, show};
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::conformance::{Attempt, Mark, attempt, exercises};

/// Arguments of `conform`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// exec:PROGRAM, or a method with options, NAME or NAME:key=value,key=value
    #[arg(required = true)]
    methods: Vec<String>,
    /// Accuracy: low, mid or high (contact laws violated by at most 1e-3, 1e-6, 1e-9)
    #[arg(long, default_value = "high")]
    tier: Tier,
    #[command(flatten)]
    limit: ProgramLimit,
}

/// Runs the exercises; false if one failed, or a method solved none.
pub fn run(arguments: &Arguments) -> Result<bool, CliError> {
    let choices = methods_or_all(&arguments.methods, &arguments.limit)?;
    let mut all_pass = true;
    for choice in &choices {
        let attempts = exercises()
            .iter()
            .map(|exercise| attempt(exercise, choice, arguments.tier.tolerance()))
            .collect::<Result<Vec<_>, MethodError>>()?;
        let note = format!(" of {}", choice.label);
        show(&attempts, &note);
        let count = |mark| attempts.iter().filter(|own| own.mark == mark).count();
        let [passed, declined, failed] = [Mark::Passed, Mark::Declined, Mark::Failed].map(count);
        say(format_args!(
            "{}: {passed} of {} passed, {declined} declined, {failed} failed",
            choice.label,
            attempts.len()
        ));
        all_pass &= failed == 0 && passed > 0;
    }
    Ok(all_pass)
}

impl Row for Attempt {
    const NAME: &'static str = "conformance";
    const TITLE: &'static str = "Conformance";
    const QUESTION: &'static str =
        "Does a method solve what has a known answer, and claim nothing else?";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "exercise" "" .shown() = r.exercise, "what is to be solved";
            "passed" "" .shown() = r.mark.as_str(), "whether the verdict is the expected one and the reactions are the known ones";
            "expected" "" .shown() = r.expected, "verdict that passes";
            "verdict" "" .shown() = &r.verdict, "what the method claims, checked";
            "violation" "–" .residual().shown() = r.violation, "largest violation of the contact laws, found by the judge";
            "distance" "–" .residual().shown() = r.distance, "distance of the reactions from the known ones";
            "iterations" "" .shown() = r.iterations, "iterations of the method";
        }
    }
}
