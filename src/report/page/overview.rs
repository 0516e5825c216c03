//! At a glance: what ran, what it claims, and the figures that say most.

use super::html::{Block, Fact, Section};
use super::{Budget, Folder, PageError};
use crate::report::figures::distinct;
use crate::report::number::significant;
use crate::run::verdict::{Verdict, VerdictKind};
use crate::studies::rows::MISSED_AS_DOCUMENTED;

/// Meaning of a kind of verdict.
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
        VerdictKind::Suspect => "right on a wrong mesh",
        VerdictKind::Crashed => "failed with an error",
        VerdictKind::TimedOut => "stopped at a time limit",
        VerdictKind::OutOfMemory => "was denied memory",
    }
}

/// The section; nothing where there are neither runs nor headlines.
pub fn section(folder: &Folder, budget: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut blocks = Vec::new();
    let facts = facts(folder)?;
    if !facts.is_empty() {
        blocks.push(Block::Facts(facts));
    }
    for path in folder.headlines() {
        blocks.extend(folder.figure(path, budget)?.map(Block::Figure));
    }
    if blocks.is_empty() {
        return Ok(None);
    }
    let terms = VerdictKind::ALL.iter();
    let terms = terms.map(|kind| (kind.name().to_owned(), meaning(*kind).to_owned()));
    blocks.push(Block::Terms {
        title: "What the verdicts mean",
        terms: terms.collect(),
    });
    Ok(Some(Section {
        id: "glance",
        title: "At a glance",
        lead: "Accuracy is one number for every method, the largest violation of the contact laws: natural map, overlap, tension, \
               gap times pressure and excess over the friction bound, recomputed by one judge from what the method returned. Tiers: low 10⁻³, mid 10⁻⁶, high 10⁻⁹. Times stand beside honest verdicts only.",
        blocks,
    }))
}

/// Answers: how near the printed tables are, whether known numbers are met, who failed.
fn facts(folder: &Folder) -> Result<Vec<Fact>, PageError> {
    let mut facts = Vec::new();
    let mut fact = |value: String, label: String, section: &'static str| {
        facts.push(Fact {
            value,
            label,
            section,
        });
    };
    let solved = |verdict: &str| verdict.parse().is_ok_and(|v: Verdict| v.is_solved());
    if folder.has("table1.csv") {
        let sheet = folder.sheet("table1.csv")?;
        let (meshes, verdicts) = (sheet.texts("mesh")?, sheet.texts("verdict")?);
        let off = sheet.texts("relative_difference")?;
        let rows = || meshes.iter().zip(&verdicts).zip(&off);
        for mesh in distinct(meshes.iter()) {
            let own = rows().filter(|((own, verdict), _)| *own == mesh && solved(verdict));
            let off = own.filter_map(|(_, off)| off.parse::<f64>().ok());
            let worst = off.map(f64::abs).fold(f64::NAN, f64::max);
            if worst.is_finite() {
                let label = format!("Table 1, Mesh {mesh}: largest distance from the print");
                fact(
                    format!("{} %", significant(100.0 * worst, 2)),
                    label,
                    "paper",
                );
            }
        }
    }
    if folder.has("table2.csv") {
        let sheet = folder.sheet("table2.csv")?;
        let (variants, verdicts) = (sheet.texts("variant")?, sheet.texts("verdict")?);
        let rows = variants.iter().zip(&verdicts);
        let rows = rows.zip(sheet.texts("max_difference_mm")?);
        let own =
            rows.filter(|((variant, verdict), _)| **variant == "as-printed" && solved(verdict));
        let worst = own.filter_map(|(_, off)| off.parse::<f64>().ok());
        let worst = worst.fold(f64::NAN, f64::max);
        if worst.is_finite() {
            let label = "Table 2, frictionless as printed: largest distance from the print";
            fact(
                format!("{} mm", significant(worst, 1)),
                label.into(),
                "paper",
            );
        }
    }
    if folder.has("expectations.csv") {
        let sheet = folder.sheet("expectations.csv")?;
        let off: Vec<usize> = sheet.parsed("not_as_stated")?;
        let stated = off.iter().filter(|&&runs| runs == 0).count();
        let missed = |verdict: &&&str| **verdict == MISSED_AS_DOCUMENTED;
        let label = match sheet.texts("verdict")?.iter().filter(missed).count() {
            0 => "expected numbers as stated, by all exact methods".to_owned(),
            count => format!(
                "expected numbers as stated, by all exact methods; {count} of them documented misses"
            ),
        };
        fact(format!("{stated} of {}", off.len()), label, "expected");
    }
    if folder.has("runs.csv") {
        let verdicts: Vec<Verdict> = folder.sheet("runs.csv")?.parsed("verdict")?;
        let section = if folder.has("comparison.csv") {
            "methods"
        } else {
            "runs"
        };
        let count = |wanted: fn(&Verdict) -> bool| {
            let found = verdicts.iter().filter(|verdict| wanted(verdict));
            found.count().to_string()
        };
        let solved = count(|v| v.kind() == VerdictKind::Solved);
        let label = format!("solved, of {} runs: the contact laws hold", verdicts.len());
        fact(solved, label, section);
        let own = count(|v| v.kind() == VerdictKind::Approximate);
        fact(own, "approximate: own laws solved".into(), section);
        fact(count(Verdict::is_failure), "failed".into(), section);
    }
    Ok(facts)
}
