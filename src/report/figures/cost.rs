//! What the methods cost: time of every method on every case, relative to the fastest.

use super::{Bundle, Kind, ReportError};
use crate::report::number::significant;
use crate::report::plot::{Cell, HeatMap, plain, rank};
use crate::run::verdict::{Verdict, VerdictKind};
use crate::studies::paper::comparison::ComparisonRow;

/// What it is.
pub static KIND: Kind = Kind {
    file: "cost.svg",
    question: "Which method is fastest on which case, by how much, and who fails?",
    shows: "Solve time of every method on every case, all meshes, friction coefficients and increments together, as a multiple \
            of the fastest method that solved them (iterations where no times are known). ≈: solved laws of its own; –: \
            declined; ×: any other verdict.",
};

/// Multiple with the full tint.
const FULL: f64 = 1000.0;

/// The figure of all cases.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[ComparisonRow]) -> Result<(), ReportError> {
    let mut cases: Vec<&str> = rows.iter().map(|row| row.case.as_str()).collect();
    cases.sort_unstable();
    cases.dedup();
    let mut names: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
    names.sort_by_key(|name| (rank(name), *name));
    names.dedup();
    // Where nothing did what it claims there is nothing to draw.
    if !rows.iter().any(|row| row.verdict.is_honest()) {
        return Ok(());
    }
    let timed = rows.iter().any(|row| row.solve_s > 0.0);
    let cost = |row: &ComparisonRow| match (&row.verdict, timed) {
        (Verdict::Solved, true) => row.solve_s,
        (Verdict::Solved, false) => row.iterations.max(1) as f64,
        _ => f64::NAN,
    };
    let mut first = vec![0; names.len()];
    let mut table = Vec::new();
    for case in &cases {
        let of = |name: &str| {
            rows.iter()
                .find(|row| row.case == *case && row.method == name)
        };
        let costs: Vec<f64> = names
            .iter()
            .map(|name| of(name).map_or(f64::NAN, cost))
            .collect();
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        let cells = names
            .iter()
            .zip(&costs)
            .enumerate()
            .map(|(column, (name, cost))| {
                let ratio = cost / least;
                first[column] += usize::from(ratio == 1.0);
                let text = match of(name).map(|row| row.verdict.kind()) {
                    _ if ratio.is_finite() => significant(
                        ratio,
                        if ratio < 9.95 { 2 } else { 3 }.min(if ratio < 99.5 { 2 } else { 3 }),
                    ),
                    None => String::new(),
                    Some(VerdictKind::Approximate) => "≈".into(),
                    Some(VerdictKind::Refused) => "–".into(),
                    Some(_) => "×".into(),
                };
                Cell {
                    tint: ratio.ln() / FULL.ln(),
                    text,
                    below: String::new(),
                }
            });
        table.push((plain(case), cells.collect()));
    }
    let what = if timed { "solve time" } else { "iterations" };
    let best = names.iter().zip(&first).max_by_key(|(_, count)| **count);
    let title = best.map_or(String::new(), |(name, count)| {
        let most = if timed { "fastest" } else { "shortest" };
        format!(
            "{} is {most} on {count} of {} cases",
            plain(name),
            cases.len()
        )
    });
    let caption = format!(
        "{what} as a multiple of the least on the case, all meshes, friction coefficients and increments together; ≈: solved \
         laws of its own, –: declined, ×: did not solve all of them"
    );
    let columns = names.iter().map(|name| plain(name)).collect();
    let map = HeatMap {
        title,
        caption,
        groups: Vec::new(),
        columns,
        rows: table,
    };
    KIND.add(bundle, "", map.svg()?)
}
