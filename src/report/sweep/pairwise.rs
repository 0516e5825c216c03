//! Methods two by two: counts, and profiles of the best method against each other one.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::records::SweepRecords;
use crate::report::csv::{self, Row};
use crate::report::number::significant;
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::compare_methods;
use crate::studies::sweep::analysis::costs::{Costs, Measure};
use crate::studies::sweep::analysis::pairwise::{Duel, Pair, duels, pairs};
use crate::studies::sweep::analysis::profile::Curve;
use crate::studies::sweep::analysis::ranking::ranking;

/// Digits of bounds and fractions.
const DIGITS: usize = 6;

/// Adds `pairwise.csv`, `pairwise_profiles.csv`, of times.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let (mut rows, mut duel_rows) = (Vec::new(), Vec::new());
    for set in &sweep.sets {
        let costs = Costs::new(set, Measure::Time);
        let own = pairs(&costs);
        if costs.problems() == 0 || own.is_empty() {
            continue;
        }
        let tier = set.tier;
        rows.extend(own.into_iter().map(|pair| PairRow { tier, pair }));
        let best = ranking(&costs).and_then(|ranking| {
            let best = ranking.standings.first()?.method;
            costs.methods.iter().position(|method| *method == best)
        });
        let Some(best) = best else { continue };
        let duels = duels(&costs, best);
        duel_rows.extend(duels.iter().flat_map(|duel| DuelRow::all(duel, tier)));
    }
    bundle.add(PairRow::FILE, csv::file(&rows)?)?;
    Ok(bundle.add(DuelRow::FILE, csv::file(&duel_rows)?)?)
}

struct PairRow<'a> {
    tier: Tier,
    pair: Pair<'a>,
}

impl Row for PairRow<'_> {
    const FILE: &'static str = "pairwise.csv";
    const COLUMNS: &'static [&'static str] = &[
        "tier", "method", "other", "problems", "wins", "ties", "losses", "neither",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let Pair {
            method,
            other,
            problems,
            wins,
            ties,
            losses,
            neither,
        } = &self.pair;
        let mut cells = vec![
            self.tier.to_string(),
            (*method).to_owned(),
            (*other).to_owned(),
        ];
        cells.extend([problems, wins, ties, losses, neither].map(usize::to_string));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_tiers(self.tier, other.tier)
            .then_with(|| compare_methods(self.pair.method, other.pair.method))
            .then_with(|| compare_methods(self.pair.other, other.pair.other))
    }
}

fn compare_tiers(a: Tier, b: Tier) -> Ordering {
    b.tolerance().total_cmp(&a.tolerance())
}

#[derive(Clone)]
struct DuelRow {
    tier: Tier,
    first: String,
    other: String,
    method: String,
    step: [f64; 2],
}

impl DuelRow {
    fn all(duel: &Duel<'_>, tier: Tier) -> Vec<Self> {
        let of = |curve: &Curve<'_>| -> Vec<Self> {
            let steps = curve.steps.iter();
            steps
                .map(|step| Self {
                    tier,
                    first: duel.first.method.to_owned(),
                    other: duel.second.method.to_owned(),
                    method: curve.method.to_owned(),
                    step: *step,
                })
                .collect()
        };
        [of(&duel.first), of(&duel.second)].concat()
    }
}

impl Row for DuelRow {
    const FILE: &'static str = "pairwise_profiles.csv";
    const COLUMNS: &'static [&'static str] =
        &["tier", "first", "other", "method", "tau", "fraction"];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let [tau, fraction] = self.step.map(|x| significant(x, DIGITS));
        vec![
            self.tier.to_string(),
            self.first.clone(),
            self.other.clone(),
            self.method.clone(),
            tau,
            fraction,
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_tiers(self.tier, other.tier)
            .then_with(|| compare_methods(&self.other, &other.other))
            .then_with(|| compare_methods(&self.method, &other.method))
            .then(self.step[0].total_cmp(&other.step[0]))
    }
}
