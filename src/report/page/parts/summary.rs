//! At a glance: what ran, what it claims, whether the expected numbers were found.

use super::{largest, made};
use crate::report::number::significant;
use crate::report::page::{Block, Budget, Fact, Folder, PageError, Section};
use crate::report::standard::solved;

const VERDICTS: [(&str, &str); 6] = [
    (
        "solved",
        "claims the contact laws, and the judge finds them kept to the tier asked for",
    ),
    (
        "approximate",
        "solved its own regularised or consistent laws, checked as such; the contact laws hold to the tier named, or to none",
    ),
    (
        "false-claim",
        "claims the contact laws, and the judge disagrees",
    ),
    ("gave-up", "ended without a claim, with the reason"),
    ("refused", "cannot treat this problem, with the reason"),
    ("crashed", "failed with an error"),
];

/// The section.
pub fn section(folder: &Folder, _: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut facts = Vec::new();
    let mut fact = |value: String, label: &str, section: &'static str| {
        facts.push(Fact {
            value,
            label: label.into(),
            section,
        });
    };
    if folder.has("runs.csv") {
        let sheet = folder.sheet("runs.csv")?;
        let verdicts = sheet.texts("verdict")?;
        let count = |word: &str| verdicts.iter().filter(|v| v.starts_with(word)).count();
        let section = match folder.has("comparison.csv") {
            true => "methods",
            false => "runs",
        };
        let failed = count("gave-up") + count("crashed");
        fact(verdicts.len().to_string(), "increments run", section);
        fact(count("solved").to_string(), "solved", section);
        fact(
            count("approximate").to_string(),
            "approximate: own laws solved",
            section,
        );
        fact(count("refused").to_string(), "refused", section);
        fact(failed.to_string(), "gave up or crashed", section);
        fact(count("false-claim").to_string(), "false claims", section);
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
    let terms = VERDICTS.map(|(term, meaning)| (term.to_owned(), meaning.to_owned()));
    let lead = "Accuracy is one number for every method, the natural map: the residual of all contact laws, recomputed by \
                one judge from what the method returned. Tiers: low 10⁻³, mid 10⁻⁶, high 10⁻⁹. Times stand beside right \
                answers only.";
    let blocks = vec![
        Block::Facts(facts),
        Block::Heading("Verdicts".into()),
        Block::Terms(terms.to_vec()),
    ];
    Ok(made("summary", "At a glance", lead, blocks))
}
