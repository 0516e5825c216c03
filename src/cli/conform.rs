//! `stickslip conform`: does a method, or a program as one, do what methods are to do?

use stickslip_methods::Tier;

use super::arguments::{TimeLimit, methods_or_all};
use super::error::CliError;
use super::output::{say, show};
use super::progress::Bar;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::conformance::{self, Mark, distance, expected, mark};
use crate::studies::record::Record;

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
    limit: TimeLimit,
}

/// Runs the exercises; false if one failed, or a method solved none.
pub fn run(arguments: &Arguments) -> Result<bool, CliError> {
    let choices = methods_or_all(&arguments.methods, &arguments.limit)?;
    let bar = Bar::new();
    let records = conformance::run(&choices, arguments.tier.tolerance(), &bar)?;
    bar.finish();
    let mut all_pass = true;
    for choice in &choices {
        let own = records
            .iter()
            .filter(|own| own.found.method == choice.label);
        let own: Vec<Attempt> = own.map(|record| Attempt(record.clone())).collect();
        let note = format!(" of {}", choice.label);
        show(&own, &note);
        let count = |as_marked| own.iter().filter(|own| mark(&own.0) == as_marked).count();
        let [passed, declined, failed] = [Mark::Passed, Mark::Declined, Mark::Failed].map(count);
        say(format_args!(
            "{}: {passed} of {} passed, {declined} declined, {failed} failed",
            choice.label,
            own.len()
        ));
        all_pass &= failed == 0 && passed > 0;
    }
    Ok(all_pass)
}

/// A record of an exercise, as a row.
struct Attempt(Record);

impl Row for Attempt {
    const NAME: &'static str = "conformance";
    const TITLE: &'static str = "Conformance";
    const QUESTION: &'static str =
        "Does a method solve what has a known answer, and claim nothing else?";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "exercise" "" .shown() = r.0.asked.case.clone(), "what is to be solved";
            "passed" "" .shown() = mark(&r.0).as_str(), "whether the verdict is the expected one and the reactions are the known ones";
            "expected" "" .shown() = expected(&r.0), "verdict that passes";
            "verdict" "" .shown() = &r.0.found.verdict, "what the method claims, checked";
            "violation" "–" .residual().shown() = r.0.found.violation(), "largest violation of the contact laws, found by the judge";
            "distance" "–" .residual().shown() = distance(&r.0), "distance of the reactions from the known ones";
            "iterations" "" .shown() = r.0.found.sum(|step| step.iterations), "iterations of the method";
        }
    }
}
