//! Which method to use when, as rows for reading and for the page.

use std::cmp::Ordering;

use super::records::SweepRecords;
use crate::report::csv::{self, Row};
use crate::report::number::significant;
use crate::report::tables::add_readable;
use crate::report::tables::{Align, Column, Table};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::recommendation::{Recommendation, recommendations};

/// What stands for "anything".
const ANY: &str = "any";

/// Adds `recommendations.csv`, `.md` and `.tex`.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let rows = recommendations(sweep.records);
    bundle.add(Recommendation::FILE, csv::file(&rows)?)?;
    add_readable(bundle, "recommendations", &table(&rows, &sweep.caveat())?)
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
    const LEADING: &'static [&'static str] = &[];

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

/// The first of some names, and how many more.
fn some(names: &[&str]) -> String {
    const SHOWN: usize = 3;
    match names.len().saturating_sub(SHOWN) {
        // Another name takes no more room than its number.
        0 | 1 => names.join(", "),
        more => format!("{} and {more} more", names[..SHOWN].join(", ")),
    }
}

/// The class in a few words.
fn class(row: &Recommendation) -> String {
    let [dim, friction, loading, unknowns] = class_cells(row);
    let dim = match dim.as_str() {
        ANY => dim,
        _ => format!("{dim}D"),
    };
    let unknowns = match unknowns.as_str() {
        ANY => unknowns,
        _ => format!("{unknowns} unknowns"),
    };
    let parts = [dim, friction, loading, unknowns];
    let told: Vec<String> = parts.into_iter().filter(|part| part != ANY).collect();
    if told.is_empty() {
        "all".into()
    } else {
        told.join(", ")
    }
}

fn table(rows: &[Recommendation], caveat: &str) -> Result<Table, ReportError> {
    let column = |name: &str| Column::new(name, "", Align::Left);
    let mut table = Table::new(
        format!(
            "Fastest methods among those that are right most often: none is faster than the named ones beyond the intervals, first who is among the fastest on most problems{caveat}"
        ),
        vec![
            column("tier"),
            column("problems"),
            Column::new("count", "", Align::Right),
            column("fastest"),
            column("first among the fastest on"),
            column("confidence"),
            column("most often right"),
            column("right on"),
        ],
    );
    for row in rows {
        let first = row.fastest.first();
        let among = first.map_or_else(
            || "no times".to_owned(),
            |first| format!("{} of {}", first.among, row.timed),
        );
        let reliable: Vec<&str> = row.reliable.iter().map(String::as_str).collect();
        let cells = vec![
            row.tier.to_string(),
            class(row),
            row.problems.to_string(),
            some(&names(row)),
            among,
            row.confidence.to_string(),
            some(&reliable),
            format!("{} of {}", row.correct, row.problems),
        ];
        table.push(cells)?;
    }
    Ok(table)
}
