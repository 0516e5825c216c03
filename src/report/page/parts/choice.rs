//! Which method to use when, and how sure that is: the recommendations of the study, first in words.

use std::collections::BTreeMap;

use super::blocks::{largest, made};
use crate::report::number::significant;
use crate::report::page::{Block, Budget, Folder, Kind, PageError, Section, Sheet, Show};

const SHOWN: [Show; 11] = [
    Show::new("tier", Kind::Text),
    Show::new("dimension", Kind::Text),
    Show::new("friction", Kind::Text),
    Show::new("loading", Kind::Text),
    Show::new("unknowns", Kind::Text),
    Show::new("problems", Kind::Number),
    Show::new("fastest", Kind::Text).titled("fastest of the most reliable"),
    Show::new("evidence", Kind::Text),
    Show::new("confidence", Kind::Text),
    Show::new("correct_rate", Kind::Percent(0)).titled("right answers"),
    Show::new("correct_low", Kind::Percent(0)).titled("at least (95 %)"),
];

const CONFIDENCE: [(&str, &str); 3] = [
    (
        "sure",
        "the first method named is among the fastest on more than half of such problems: Wilson's 95 % interval of its share \
         lies above one half",
    ),
    (
        "likely",
        "its share lies above one half, the interval does not",
    ),
    (
        "open",
        "the problems measured do not decide, or are too few",
    ),
];

/// The section.
pub fn section(folder: &Folder, _: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut blocks = Vec::new();
    for path in folder.named("recommendations.csv") {
        let sheet = folder.sheet(path)?;
        let mut sentences = advice(&sheet)?;
        for path in folder.named("robustness.csv") {
            sentences.extend(fallback(&folder.sheet(path)?)?);
        }
        blocks.push(Block::List(sentences));
        let terms = CONFIDENCE.map(|(word, meaning)| (word.to_owned(), meaning.to_owned()));
        blocks.push(Block::Terms(terms.to_vec()));
        let title = "By accuracy and class of problems";
        blocks.push(Block::Table(folder.grid(path, title, &SHOWN)?));
    }
    let lead = "From the study below. In a class only methods that give the right answer as often as any other may be named; of \
                these all are named that none is faster than beyond the intervals of the times. What friction does and how large \
                a problem is, its owner mostly knows beforehand; the rest of the table says what was measured, on the machine \
                named at the end of this page.";
    Ok(made("choice", "Which method, and how sure", lead, blocks))
}

/// A sentence per accuracy on all problems together, and one per dimension where friction matters.
fn advice(sheet: &Sheet) -> Result<Vec<String>, PageError> {
    let column = |name: &str| sheet.texts(name);
    let (tiers, dimensions) = (column("tier")?, column("dimension")?);
    let (friction, loading) = (column("friction")?, column("loading")?);
    let (fastest, evidence) = (column("fastest")?, column("evidence")?);
    let (confidence, problems) = (column("confidence")?, sheet.numbers("problems")?);
    let (rate, low) = (
        sheet.numbers("correct_rate")?,
        sheet.numbers("correct_low")?,
    );
    let mut sentences = Vec::new();
    for k in 0..tiers.len() {
        let wide = loading[k] == "any" && (dimensions[k] == "any" || friction[k] == "slip");
        if !wide || fastest[k].is_empty() {
            continue;
        }
        let class = match dimensions[k] {
            "any" => "all problems".to_owned(),
            dimension => format!("{dimension}D with slip"),
        };
        sentences.push(format!(
            "Accuracy {}, {class}: take {}. {}: {} ({} problems; right on {} % of them, at least {} % with 95 % confidence).",
            tiers[k],
            fastest[k].replace(';', " or"),
            capital(confidence[k]),
            evidence[k],
            significant(problems[k], 6),
            significant(100.0 * rate[k], 3),
            significant((100.0 * low[k]).floor(), 3),
        ));
    }
    Ok(sentences)
}

/// The methods that lose least on random problems, whatever the friction: what to take where a failure costs more than time.
fn fallback(sheet: &Sheet) -> Result<Option<String>, PageError> {
    let (methods, counted) = (sheet.texts("method")?, sheet.texts("success")?);
    let (rate, low) = (
        sheet.numbers("success_rate")?,
        sheet.numbers("success_low")?,
    );
    let (friction, problems) = (sheet.numbers("friction")?, sheet.numbers("problems")?);
    let mut lost: BTreeMap<&str, (f64, f64, f64)> = BTreeMap::new();
    for k in 0..methods.len() {
        if counted[k] != "solved" || !rate[k].is_finite() {
            continue;
        }
        let (all, failed, least) = lost.entry(methods[k]).or_insert((0.0, 0.0, f64::INFINITY));
        *all += problems[k];
        *failed += (1.0 - rate[k]) * problems[k];
        *least = least.min(low[k]);
    }
    let fewest = lost.values().map(|(_, failed, _)| *failed);
    let fewest = fewest.fold(f64::INFINITY, f64::min);
    // Rates are printed with few digits: half a problem is none.
    let best: Vec<_> = lost
        .iter()
        .filter(|(_, own)| own.1 < fewest + 0.5)
        .collect();
    let Some((_, (all, _, least))) = best.first() else {
        return Ok(None);
    };
    let names: Vec<&str> = best.iter().map(|(name, _)| **name).collect();
    Ok(Some(format!(
        "Where a failure costs more than time: {}, which of {} random problems with friction up to {} lost {} (at every friction \
         coefficient and dimension right on at least {} % with 95 % confidence).",
        names.join(", "),
        significant(*all, 6),
        significant(largest(friction.into_iter()), 3),
        significant(fewest.round(), 6),
        significant((100.0 * least).floor(), 3),
    )))
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    let first = letters.next().map(|c| c.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}
