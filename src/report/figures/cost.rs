//! What the methods cost: time of every method on every case, relative to the fastest.

use super::kind::Kind;
use super::runs::distinct;
use crate::report::number::significant;
use crate::report::plot::{Cell, HeatMap, plain, rank};
use crate::report::{Bundle, ReportError};
use crate::run::verdict::VerdictKind;
use crate::studies::paper::comparison::ComparisonRow;

/// What it is.
pub static KIND: Kind = Kind {
    file: "cost.svg",
    question: "Which method is fastest on which case, by how much, and who fails?",
    shows: "Solve time of every method on every case as a multiple of the fastest one that solved it (iterations \
            where no times are known). ≈: solved laws of its own; –: declined; ×: any other verdict.",
};

/// Multiple with the full tint.
const FULL: f64 = 1000.0;

/// The figure of all cases.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[ComparisonRow]) -> Result<(), ReportError> {
    // Where nothing did what it claims there is nothing to draw.
    if !rows.iter().any(|row| row.verdict.is_honest()) {
        return Ok(());
    }
    let mut cases = distinct(rows.iter().map(|row| row.case.as_str()));
    cases.sort_unstable();
    let mut names = distinct(rows.iter().map(|row| row.method.as_str()));
    names.sort_by_key(|name| (rank(name), *name));
    let timed = rows.iter().any(|row| row.solve_s > 0.0);
    let cost = |row: &ComparisonRow| match (row.verdict.is_solved(), timed) {
        (true, true) => row.solve_s,
        (true, false) => row.iterations.max(1) as f64,
        _ => f64::NAN,
    };
    let mut wins = vec![0; names.len()];
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
            wins[column] += usize::from(ratio == 1.0);
            let text = match of(name).map(|row| row.verdict.kind()) {
                _ if ratio.is_finite() => significant(ratio, if ratio < 99.5 { 2 } else { 3 }),
                None => String::new(),
                Some(VerdictKind::Approximate) => "≈".into(),
                Some(VerdictKind::Refused) => "–".into(),
                Some(_) => "×".into(),
            };
            let (tint, below) = (ratio.ln() / FULL.ln(), String::new());
            cells.push(Cell { tint, text, below });
        }
        table.push((plain(case), cells));
    }
    let (what, best) = match timed {
        true => ("solve time", "fastest"),
        false => ("iterations", "done in the fewest iterations"),
    };
    let most = wins.iter().copied().max().unwrap_or(0);
    let leader = names.iter().zip(&wins).find(|(_, count)| **count == most);
    let leader = plain(leader.map_or("", |(name, _)| *name));
    let title = format!("{leader} is {best} on {most} of {} cases", cases.len());
    let caption = format!(
        "{what} as a multiple of the least on the case, all meshes, friction coefficients and increments \
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
