//! The part of a table that is read: the columns marked so, or a table of two ways where the file has a row for each of its cells.

use super::About;

/// A table of two ways: rows that agree in `rows` become one, with a column for every value of `across` that holds `cell`.
///
/// A verdict other than `solved` stands in the heading of a column that has no other, else behind its cell.
#[derive(Debug, Clone, Copy)]
pub struct Pivot {
    /// Names of the columns that stay.
    pub rows: &'static [&'static str],
    /// Name of the column whose values become headings.
    pub across: &'static str,
    /// Name of the column whose values stand below them.
    pub cell: &'static str,
}

/// A column for reading.
#[derive(Debug)]
pub struct Shown {
    /// Number of the column that its cells come from.
    pub from: usize,
    /// Heading.
    pub heading: String,
    /// Unit behind it; empty for none.
    pub unit: &'static str,
}

impl Shown {
    fn of(columns: &[About], from: usize) -> Self {
        Self {
            from,
            heading: columns[from].heading(),
            unit: columns[from].shown_unit(),
        }
    }
}

/// Columns and cells for reading.
#[derive(Debug)]
pub struct View {
    /// Columns.
    pub columns: Vec<Shown>,
    /// Cells.
    pub rows: Vec<Vec<String>>,
    /// Contents below the headings that were values, for the caption; may be empty.
    pub note: String,
}

/// Name of the column with the verdict.
const VERDICT: &str = "verdict";

impl View {
    /// Of rows with a cell for each of the columns.
    pub fn of(pivot: Option<Pivot>, columns: &[About], rows: &[Vec<String>]) -> Self {
        pivot
            .and_then(|pivot| pivot.turn(columns, rows))
            .unwrap_or_else(|| {
                let shown = (0..columns.len()).filter(|&k| columns[k].shown);
                let shown: Vec<usize> = shown.collect();
                let line = |row: &Vec<String>| shown.iter().map(|&k| row[k].clone()).collect();
                Self {
                    columns: shown.iter().map(|&k| Shown::of(columns, k)).collect(),
                    rows: rows.iter().map(line).collect(),
                    note: String::new(),
                }
            })
    }
}

impl Pivot {
    /// None where a column is missing.
    fn turn(&self, columns: &[About], rows: &[Vec<String>]) -> Option<View> {
        let place = |name: &str| columns.iter().position(|column| column.name == name);
        let keys: Vec<usize> = self
            .rows
            .iter()
            .map(|name| place(name))
            .collect::<Option<_>>()?;
        let (across, cell, verdict) = (place(self.across)?, place(self.cell)?, place(VERDICT)?);
        let mark = |row: &Vec<String>| match row[verdict].as_str() {
            "solved" => String::new(),
            other => other.to_owned(),
        };
        let key = |row: &Vec<String>| keys.iter().map(|&k| row[k].clone()).collect::<Vec<_>>();
        let mut heads: Vec<&str> = Vec::new();
        let mut lines: Vec<Vec<String>> = Vec::new();
        // A row without verdict repeats what is compared with.
        for row in rows.iter().filter(|row| !row[verdict].is_empty()) {
            if !heads.contains(&row[across].as_str()) {
                heads.push(&row[across]);
            }
            if !lines.contains(&key(row)) {
                lines.push(key(row));
            }
        }
        let mut shown: Vec<Shown> = keys.iter().map(|&k| Shown::of(columns, k)).collect();
        let about = &columns[cell];
        for head in heads {
            let own = || rows.iter().filter(|row| row[across] == head);
            let first = own().map(mark).next()?;
            let alike = own().all(|row| mark(row) == first);
            shown.push(Shown {
                from: cell,
                heading: match first.as_str() {
                    told if alike && !told.is_empty() => format!("{head}, {told}"),
                    _ => head.to_owned(),
                },
                unit: "",
            });
            for line in &mut lines {
                let found = own().find(|row| key(row)[..] == line[..keys.len()]);
                line.push(found.map_or_else(String::new, |row| match mark(row) {
                    told if alike || told.is_empty() => row[cell].clone(),
                    told => {
                        let number = row[cell].parse().unwrap_or(f64::NAN);
                        format!("{} ({told})", about.read(number))
                    }
                }));
            }
        }
        let note = format!(
            "; {} [{}] by {}",
            about.heading(),
            about.shown_unit(),
            self.across
        );
        Some(View {
            columns: shown,
            rows: lines,
            note,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a row a place and a column a method; who did not solve all says so, and no failure is left out.
    #[test]
    fn a_long_table_is_turned_and_verdicts_stay() {
        let columns = ["mesh", "method", "force_n", "verdict"];
        let columns =
            columns.map(|name| About::new(name, if name == "force_n" { "N" } else { "" }, ""));
        let pivot = Pivot {
            rows: &["mesh"],
            across: "method",
            cell: "force_n",
        };
        let rows: Vec<Vec<String>> = [
            ["I", "printed", "9", ""],
            ["I", "latin", "1", "solved"],
            ["II", "latin", "–", "gave-up: stalled"],
            ["I", "penalty", "3", "approximate: low"],
            ["II", "penalty", "4", "approximate: low"],
        ]
        .map(|row| row.map(str::to_owned).to_vec())
        .to_vec();
        let View {
            columns: shown,
            rows: lines,
            note,
        } = View::of(Some(pivot), &columns, &rows);
        let heads: Vec<&str> = shown.iter().map(|own| own.heading.as_str()).collect();
        assert_eq!(heads, ["mesh", "latin", "penalty, approximate: low"]);
        assert_eq!(
            lines,
            [["I", "1", "3"], ["II", "– (gave-up: stalled)", "4"]]
        );
        assert_eq!(note, "; force [N] by method");
    }
}
