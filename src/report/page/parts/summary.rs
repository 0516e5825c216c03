//! At a glance: what ran, what it claims, whether the expected numbers were found.

use super::blocks::{Tally, largest, made};
use crate::report::number::significant;
use crate::report::page::{Block, Budget, Fact, Folder, PageError, Section};
use crate::run::verdict::{Verdict, VerdictKind};

/// What a kind of verdict says.
fn meaning(kind: VerdictKind) -> &'static str {
    match kind {
        VerdictKind::Solved => {
            "claims the contact laws, and the judge finds them kept to the tier asked for"
        }
        VerdictKind::Approximate => {
            "solved its own regularised or consistent laws, checked as such; the contact laws hold to the tier named, or to none"
        }
        VerdictKind::FalseClaim => "claims the contact laws, and the judge disagrees",
        VerdictKind::GaveUp => "ended without a claim, with the reason",
        VerdictKind::Refused => "cannot treat this problem, with the reason",
        VerdictKind::Crashed => "failed with an error",
        VerdictKind::TimedOut => "stopped at a time limit",
        VerdictKind::OutOfMemory => "was denied memory",
    }
}

/// The section.
pub fn section(folder: &Folder, _: &mut Budget) -> Result<Option<Section>, PageError> {
    let (mut facts, mut found) = (Vec::new(), Vec::new());
    let mut fact = |value: String, label: &str, section: &'static str| {
        facts.push(Fact {
            value,
            label: label.into(),
            section,
        });
    };
    if folder.has("runs.csv") {
        let sheet = folder.sheet("runs.csv")?;
        let verdicts = sheet.verdicts()?;
        let mut tally = Tally::default();
        for verdict in &verdicts {
            tally.add(verdict.kind());
            found.push(verdict.kind());
        }
        let section = match folder.has("comparison.csv") {
            true => "methods",
            false => "runs",
        };
        fact(verdicts.len().to_string(), "increments run", section);
        for (place, name) in Tally::shown(&[tally]) {
            let label = match name {
                "approximate" => "approximate: own laws solved",
                other => other,
            };
            fact(tally.0[place].to_string(), label, section);
        }
    }
    if folder.has("expectations.csv") {
        let sheet = folder.sheet("expectations.csv")?;
        let verdicts = sheet.texts("verdict")?;
        let met = verdicts.iter().filter(|v| **v == "met").count();
        let label = "expected numbers met";
        fact(format!("{met} of {}", verdicts.len()), label, "expected");
    }
    if folder.has("table1.csv") {
        let sheet = folder.sheet("table1.csv")?;
        let verdicts = sheet.texts("verdict")?;
        let differences = sheet.numbers("relative_difference")?;
        let solved = |text: &str| text.parse() == Ok(Verdict::Solved);
        let own = differences.iter().zip(verdicts).filter(|(_, v)| solved(v));
        let worst = 100.0 * largest(own.map(|(d, _)| d.abs()));
        let label = "largest distance of a solved run from the printed Table 1";
        if worst.is_finite() {
            fact(format!("{} %", significant(worst, 2)), label, "paper");
        }
    }
    if facts.is_empty() {
        return Ok(None);
    }
    // Limits are not known to those who set none.
    let shown = VerdictKind::ALL
        .iter()
        .filter(|kind| !kind.is_limit() || found.contains(kind));
    let terms = shown.map(|kind| (kind.name().to_owned(), meaning(*kind).to_owned()));
    let lead = "Accuracy is one number for every method, the natural map: the residual of all contact laws, recomputed by \
                one judge from what the method returned. Tiers: low 10⁻³, mid 10⁻⁶, high 10⁻⁹. Times stand beside right \
                answers only.";
    let blocks = vec![
        Block::Facts(facts),
        Block::Heading("Verdicts".into()),
        Block::Terms(terms.collect()),
    ];
    Ok(made("summary", "At a glance", lead, blocks))
}
