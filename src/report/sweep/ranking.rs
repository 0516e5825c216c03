//! Order of the methods by shifted geometric mean of their time, ties shown as ties.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::records::SweepRecords;
use crate::report::csv::{self, Row};
use crate::report::number::{fixed, significant, time};
use crate::report::tables::add_readable;
use crate::report::tables::{Align, Column, Table};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::compare_methods;
use crate::studies::sweep::analysis::costs::Costs;
use crate::studies::sweep::analysis::ranking::{PENALTY, Ranking, Standing, ranking};

/// Adds `ranking.csv`, `.md` and `.tex`.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let mut rows = Vec::new();
    for set in &sweep.sets {
        if let Some(own) = ranking(&Costs::new(set)) {
            rows.extend(RankingRow::all(set.tier, &own));
        }
    }
    bundle.add(RankingRow::FILE, csv::file(&rows)?)?;
    add_readable(bundle, "ranking", &table(&rows, &sweep.caveat())?)
}

struct RankingRow {
    tier: Tier,
    method: String,
    rank: [usize; 2],
    /// Mean, lower and upper end [s].
    mean: [f64; 3],
    problems: usize,
    correct: usize,
    unsolved: usize,
    width: f64,
    shift: f64,
}

impl RankingRow {
    fn all(tier: Tier, ranking: &Ranking<'_>) -> Vec<Self> {
        let of = |s: &Standing<'_>| Self {
            tier,
            method: s.method.to_owned(),
            rank: s.rank,
            mean: [s.mean.value, s.mean.low, s.mean.high],
            problems: ranking.problems,
            correct: s.correct,
            unsolved: ranking.unsolved,
            width: s.width,
            shift: ranking.shift,
        };
        ranking.standings.iter().map(of).collect()
    }

    fn rank(&self) -> String {
        match self.rank {
            [first, last] if first == last => first.to_string(),
            [first, last] => format!("{first}–{last}"),
        }
    }
}

impl Row for RankingRow {
    const FILE: &'static str = "ranking.csv";
    const COLUMNS: &'static [&'static str] = &[
        "tier",
        "method",
        "rank_first",
        "rank_last",
        "mean_s",
        "low_s",
        "high_s",
        "problems",
        "correct",
        "unsolved",
        "interval_width",
        "shift_s",
        "penalty",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let mut cells = vec![self.tier.to_string(), self.method.clone()];
        cells.extend(self.rank.map(|rank| rank.to_string()));
        cells.extend(self.mean.map(time));
        cells.extend([self.problems, self.correct, self.unsolved].map(|n| n.to_string()));
        cells.push(significant(self.width, 3));
        cells.push(time(self.shift));
        cells.push(significant(PENALTY, 3));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        let tolerance = |row: &Self| row.tier.tolerance();
        tolerance(other)
            .total_cmp(&tolerance(self))
            .then(self.mean[0].total_cmp(&other.mean[0]))
            .then_with(|| compare_methods(&self.method, &other.method))
    }
}

/// All tiers for reading.
fn table(rows: &[RankingRow], caveat: &str) -> Result<Table, ReportError> {
    let shifts = Tier::ALL.into_iter().filter_map(|tier| {
        let row = rows.iter().find(|row| row.tier == tier)?;
        Some(format!("{} s at tier {tier}", significant(row.shift, 1)))
    });
    let shifts: Vec<String> = shifts.collect();
    let title = format!(
        "Shifted geometric mean of the time of the method, shift {}; a problem without right answer counts {} times the slowest right one; methods whose intervals overlap share a rank{caveat}",
        shifts.join(", "),
        significant(PENALTY, 3),
    );
    let mut table = Table::new(
        title,
        vec![
            Column::new("tier", "", Align::Left),
            Column::new("rank", "", Align::Left),
            Column::new("method", "", Align::Left),
            Column::new("mean", "ms", Align::Right),
            Column::new("interval", "ms", Align::Left),
            Column::new("right", "", Align::Right),
            Column::new("problems", "", Align::Right),
            Column::new("median interval", "%", Align::Right),
        ],
    );
    for row in rows {
        let [mean, low, high] = row.mean.map(|s| significant(1e3 * s, 3));
        let width = match row.width.is_finite() {
            true => fixed(100.0 * row.width, 0),
            false => "–".into(),
        };
        table.push(vec![
            row.tier.to_string(),
            row.rank(),
            row.method.clone(),
            mean,
            format!("{low} to {high}"),
            row.correct.to_string(),
            row.problems.to_string(),
            width,
        ])?;
    }
    Ok(table)
}
