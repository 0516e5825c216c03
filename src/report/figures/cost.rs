//! Costs of the methods: time of every method on every case, relative to the fastest.

use super::kind::Kind;
use super::runs::distinct;
use crate::report::number::significant;
use crate::report::plot::{Cell, HeatMap, plain, rank};
use crate::report::{Bundle, ReportError};
use crate::run::verdict::VerdictKind;
use crate::studies::paper::comparison::ComparisonRow;

/// The kind.
pub static KIND: Kind = Kind {
    file: "cost.svg",
    question: "Which method is far from the fastest on which case, by how much, and who fails?",
    shows: "Solve time of every method on every case as a multiple of the fastest one that solved it, from twice on: a \
            single run tells no less apart. ≈: solved laws of its own; –: declined; ×: any other verdict.",
};

/// Multiple with the full tint.
const FULL: f64 = 1000.0;

/// Multiple of the least time below which single runs are not told apart.
const NEAR: f64 = 2.0;

/// Most methods that the title names.
const NAMED: usize = 6;

/// The figure of all cases.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[ComparisonRow]) -> Result<(), ReportError> {
    // Without times there is nothing to draw: iterations of different methods are no common measure.
    if !rows.iter().any(|row| row.solve_s > 0.0) {
        return Ok(());
    }
    let mut cases = distinct(rows.iter().map(|row| row.case.as_str()));
    cases.sort_unstable();
    let mut names = distinct(rows.iter().map(|row| row.method.as_str()));
    names.sort_by_key(|name| (rank(name), *name));
    let cost = |row: &ComparisonRow| {
        if row.verdict.is_solved() {
            row.solve_s
        } else {
            f64::NAN
        }
    };
    let mut near = vec![0; names.len()];
    let mut table = Vec::new();
    for case in &cases {
        let of = |name: &&str| {
            rows.iter()
                .find(|row| row.case == *case && row.method == **name)
        };
        let costs: Vec<f64> = names
            .iter()
            .map(|name| of(name).map_or(f64::NAN, cost))
            .collect();
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        let mut cells = Vec::new();
        for (column, name) in names.iter().enumerate() {
            let ratio = costs[column] / least;
            near[column] += usize::from(ratio <= NEAR);
            let text = match of(name).map(|row| row.verdict.kind()) {
                _ if ratio <= NEAR => String::new(),
                _ if ratio.is_finite() => significant(ratio, if ratio < 99.5 { 2 } else { 3 }),
                None => String::new(),
                Some(VerdictKind::Approximate) => "≈".into(),
                Some(VerdictKind::Refused) => "–".into(),
                Some(_) => "×".into(),
            };
            let tint = if ratio <= NEAR {
                0.0
            } else {
                ratio.ln() / FULL.ln()
            };
            let below = String::new();
            cells.push(Cell { tint, text, below });
        }
        table.push((plain(case), cells));
    }
    let most = near.iter().copied().max().unwrap_or(0);
    let first = names.iter().zip(&near).filter(|(_, count)| **count == most);
    let first: Vec<String> = first.map(|(name, _)| plain(name)).collect();
    let first = match first.len() {
        ..=NAMED => first.join(", "),
        count => format!("{count} methods"),
    };
    let title = format!(
        "Within twice the least time on {most} of {} cases: {first}",
        cases.len()
    );
    let caption = format!(
        "solve time as a multiple of the least on the case, from {NEAR} on (white: less), all meshes, friction coefficients and increments \
         together; ≈: solved laws of its own, –: declined, ×: did not solve all of them"
    );
    let columns = names.iter().map(|name| plain(name)).collect();
    let groups = Vec::new();
    let map = HeatMap {
        title,
        caption,
        groups,
        columns,
        rows: table,
    };
    KIND.add(bundle, "", map.svg()?)
}
