//! Which method to use when, as rows for reading and for the page.

use std::cmp::Ordering;

use super::Study;
use crate::report::csv::{self, Row};
use crate::report::number::significant;
use crate::report::paper::add_readable;
use crate::report::tables::{Align, Column, Table};
use crate::report::{Bundle, ReportError};
use crate::sweep::analysis::recommendation::{Recommendation, recommendations};

/// What stands for "anything".
const ANY: &str = "any";

/// Adds `recommendations.csv`, `.md` and `.tex`.
pub fn add(bundle: &mut Bundle, study: &Study<'_>) -> Result<(), ReportError> {
    let rows = recommendations(study.records);
    bundle.add(Recommendation::FILE, csv::file(&rows)?)?;
    add_readable(bundle, "recommendations", &table(&rows, &study.caveat())?)
}

/// The class in words.
fn class_cells(row: &Recommendation) -> [String; 4] {
    let class = &row.class;
    let any = || ANY.to_owned();
    [
        class.dim.map_or_else(any, |dim| dim.to_string()),
        class
            .friction
            .map_or_else(any, |friction| friction.to_string()),
        class.path.map_or_else(any, |path| {
            if path { "path" } else { "single increment" }.to_owned()
        }),
        class.size.map_or_else(any, |size| size.to_string()),
    ]
}

impl Row for Recommendation {
    const FILE: &'static str = "recommendations.csv";
    const COLUMNS: &'static [&'static str] = &[
        "tier",
        "dimension",
        "friction",
        "loading",
        "unknowns",
        "problems",
        "timed",
        "fastest",
        "among",
        "alone",
        "evidence",
        "confidence",
        "reliable",
        "correct",
        "correct_rate",
        "correct_low",
        "correct_high",
    ];
    const KEYED: bool = false;

    fn cells(&self) -> Vec<String> {
        let mut cells = vec![self.tier.to_string()];
        cells.extend(class_cells(self));
        cells.extend([self.problems, self.timed].map(|n| n.to_string()));
        cells.push(names(self).join("; "));
        let first = self.fastest.first();
        let counts = first.map_or([0, 0], |first| [first.among, first.alone]);
        cells.extend(counts.map(|n| n.to_string()));
        cells.push(self.evidence());
        cells.push(self.confidence.to_string());
        cells.push(self.reliable.join("; "));
        cells.push(self.correct.to_string());
        cells.extend(self.rate().map(|x| significant(x, 4)));
        cells
    }

    fn order(&self, _: &Self) -> Ordering {
        // They come in an order of their own, which the stable sort keeps.
        Ordering::Equal
    }
}

/// The fastest methods.
fn names(row: &Recommendation) -> Vec<&str> {
    row.fastest.iter().map(|f| f.method.as_str()).collect()
}

fn table(rows: &[Recommendation], caveat: &str) -> Result<Table, ReportError> {
    let column = |name: &str| Column::new(name, "", Align::Left);
    let mut table = Table::new(
        format!(
            "Fastest methods among those that are right most often: none is faster than the named ones beyond the intervals, first who is among the fastest on most problems{caveat}"
        ),
        vec![
            column("tier"),
            column("dimension"),
            column("friction"),
            column("loading"),
            column("unknowns"),
            Column::new("problems", "", Align::Right),
            column("fastest"),
            column("evidence"),
            column("confidence"),
            column("most reliable"),
            column("right"),
        ],
    );
    for row in rows {
        let mut cells = vec![row.tier.to_string()];
        cells.extend(class_cells(row));
        // A list of all methods would say less than their number.
        let reliable = match row.reliable.len() {
            0..=4 => row.reliable.join(", "),
            count => format!("{count} methods"),
        };
        cells.extend([
            row.problems.to_string(),
            names(row).join(", "),
            row.evidence(),
            row.confidence.to_string(),
            reliable,
            format!("{} of {}", row.correct, row.problems),
        ]);
        table.push(cells)?;
    }
    Ok(table)
}
