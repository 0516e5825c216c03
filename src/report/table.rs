//! One table, five forms: CSV, Markdown, LaTeX, terminal, page; and its chapter of `stickslip show schema`.
//!
//! A row type says once what its columns are ([`Row::columns`]: name, unit, meaning, contents, digits) and which question
//! the table answers; everything else follows from that.

mod column;
mod latex;
mod readable;
mod schema;
mod view;

use std::cmp::Ordering;

pub(crate) use column::columns;
pub use column::{About, Column, Digits, Value};
pub use readable::{Align, Heading, Readable};
pub use schema::Description;
pub use view::{Pivot, Shown, View};

use super::{Bundle, ReportError};

/// Order of the rows of a table.
pub enum Order<R> {
    /// By the columns marked as keys: text as text, numbers as numbers.
    Keys,
    /// As they come.
    Given,
    /// By a comparison of its own.
    By(fn(&R, &R) -> Ordering),
}

/// A row type with the table it makes.
pub trait Row: Sized {
    /// Name of the files without ending.
    const NAME: &'static str;
    /// Caption of the table.
    const TITLE: &'static str;
    /// The reader's question that it answers.
    const QUESTION: &'static str;
    /// Further text of its chapter in `stickslip show schema`; may be empty.
    const NOTES: &'static str = "";
    /// Whether it is written as Markdown too, for reading.
    const READABLE: bool = true;
    /// Whether it is written as LaTeX too, for printing.
    const PRINTED: bool = false;
    /// Number of rows beyond which nobody reads it.
    const MOST_READ: usize = usize::MAX;
    /// Order of the rows.
    const ORDER: Order<Self> = Order::Keys;
    /// How it is turned for reading, where its file is long.
    const PIVOT: Option<Pivot> = None;

    /// The columns, in order.
    fn columns() -> Vec<Column<Self>>;

    /// Whether its times may be read: beside what did what it claims.
    fn is_honest(&self) -> bool {
        true
    }
}

/// Rows in the order of their table.
pub fn sorted<R: Row>(rows: &[R]) -> Vec<&R> {
    let order = match R::ORDER {
        Order::Given => return rows.iter().collect(),
        Order::By(compare) => ordered(rows.len(), &|a, b| compare(&rows[a], &rows[b])),
        Order::Keys => {
            let keys: Vec<fn(&R) -> Value> = R::columns()
                .into_iter()
                .filter_map(|column| column.about.key.then_some(column.get))
                .collect();
            let of = |row| keys.iter().map(|get| get(row)).collect();
            let keys: Vec<Vec<Value>> = rows.iter().map(of).collect();
            ordered(rows.len(), &|a, b| compare_keys(&keys[a], &keys[b]))
        }
    };
    order.into_iter().map(|k| &rows[k]).collect()
}

/// Places of so many rows in their order. Not generic: a sort is compiled once, not for every table.
fn ordered(count: usize, compare: &dyn Fn(usize, usize) -> Ordering) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| compare(*a, *b));
    order
}

/// Order of values that rows are sorted by.
fn compare_keys(a: &[Value], b: &[Value]) -> Ordering {
    a.iter().zip(b).fold(Ordering::Equal, |order, pair| {
        order.then_with(|| match pair {
            (Value::Text(a), Value::Text(b)) => a.cmp(b),
            (Value::Whole(a), Value::Whole(b)) => a.cmp(b),
            (Value::Real(a), Value::Real(b)) => a.total_cmp(b),
            (a, b) => (*a != Value::Empty).cmp(&(*b != Value::Empty)),
        })
    })
}

/// The contents of the CSV file, rows sorted.
///
/// # Errors
/// [`ReportError::Csv`] from the writer.
pub fn csv<R: Row>(rows: &[R]) -> Result<Vec<u8>, ReportError> {
    let (columns, rows) = (R::columns(), sorted(rows));
    let names = columns.iter().map(|column| column.about.name.to_owned());
    write(names.collect(), rows.len(), &|k, line| {
        line.extend(columns.iter().map(|column| column.csv(rows[k])));
    })
}

/// The rows as JSON objects with the columns of the CSV file, sorted; what is no number, `null`.
pub fn objects<R: Row>(rows: &[R]) -> Vec<serde_json::Map<String, serde_json::Value>> {
    let (columns, rows) = (R::columns(), sorted(rows));
    let of = |row: &&R| {
        let cell = |column: &Column<R>| (column.about.name.to_owned(), column.json(row));
        columns.iter().map(cell).collect()
    };
    rows.iter().map(of).collect()
}

/// A header and so many lines, each filled in when its turn comes; compiled once, like [`ordered`].
fn write(
    header: Vec<String>,
    lines: usize,
    fill: &dyn Fn(usize, &mut Vec<String>),
) -> Result<Vec<u8>, ReportError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    writer.write_record(&header)?;
    let mut line = header;
    for k in 0..lines {
        line.clear();
        fill(k, &mut line);
        writer.write_record(&line)?;
    }
    let written = writer.into_inner();
    written.map_err(|e| ReportError::Csv(e.into_error().into()))
}

/// The columns for reading, rows sorted; `note` goes behind the title.
pub fn readable<R: Row>(rows: &[R], note: &str) -> Readable {
    let (rows, columns) = (sorted(rows), R::columns());
    let cell = |row: &R, column: &Column<R>| match column.about.unit {
        "s" if !row.is_honest() => "–".to_owned(),
        _ => column.read(row),
    };
    let line = |row: &&R| columns.iter().map(|column| cell(row, column)).collect();
    let cells: Vec<Vec<String>> = rows.iter().map(line).collect();
    let about: Vec<About> = columns.iter().map(|column| column.about).collect();
    let view = View::of(R::PIVOT, &about, &cells);
    let heading = |shown: &Shown| {
        let Column { about, get } = &columns[shown.from];
        Heading {
            name: shown.heading.clone(),
            unit: shown.unit.to_owned(),
            align: Align::of(about.shown_digits, rows.iter().map(|row| get(row))),
        }
    };
    Readable {
        title: format!("{}{}{note}", R::TITLE, view.note),
        columns: view.columns.iter().map(heading).collect(),
        rows: view.rows,
    }
}

/// Adds a table in its forms as files; of nothing there is none.
///
/// # Errors
/// Those of [`csv`] and [`Bundle::add`].
pub fn add<R: Row>(bundle: &mut Bundle, rows: &[R], note: &str) -> Result<(), ReportError> {
    if rows.is_empty() {
        return Ok(());
    }
    let is_read = R::READABLE && rows.len() <= R::MOST_READ;
    let read = is_read.then(|| readable(rows, note));
    add_forms(bundle, R::NAME, csv(rows)?, read, R::PRINTED)
}

fn add_forms(
    bundle: &mut Bundle,
    name: &str,
    csv: Vec<u8>,
    read: Option<Readable>,
    printed: bool,
) -> Result<(), ReportError> {
    bundle.add(format!("{name}.csv"), csv)?;
    if let Some(table) = read {
        bundle.add(format!("{name}.md"), table.markdown())?;
        if printed {
            bundle.add(format!("{name}.tex"), table.latex(&format!("tab:{name}")))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sample {
        name: &'static str,
        h: f64,
        error: Option<f64>,
        time: f64,
        honest: bool,
    }

    impl Row for Sample {
        const NAME: &'static str = "samples";
        const TITLE: &'static str = "Samples";
        const QUESTION: &'static str = "Which?";

        fn columns() -> Vec<Column<Self>> {
            columns! { r: Self,
                "name" "" .key() = r.name, "name";
                "h_m" "m" .key().named("h").fixed(2) = r.h, "size";
                "error" "–" .significant(3).percent(1) = r.error, "error";
                "hidden" "" = r.name.len() + 6, "not for reading";
                "solve_s" "s" .time().digits(2) = r.time, "time";
            }
        }

        fn is_honest(&self) -> bool {
            self.honest
        }
    }

    fn samples() -> [Sample; 3] {
        let sample = |name, h, error, time, honest| Sample {
            name,
            h,
            error,
            time,
            honest,
        };
        [
            sample("b_1", 10.0, None, 0.123_456, false),
            sample("a", 10.0, Some(0.123_456), 0.123_456, true),
            sample("a", 9.0, Some(f64::NAN), 2e-7, true),
        ]
    }

    /// Goal: rows by their keys, numbers as numbers; missing, undefined and shortened cells each as its form wants them.
    #[test]
    fn one_description_makes_every_form() {
        let text = String::from_utf8(csv(&samples()).unwrap()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let expected = [
            "name,h_m,error,hidden,solve_s",
            "a,9,NaN,7,2e-7",
            "a,10,0.123,7,0.1235",
            "b_1,10,,9,0.1235",
        ];
        assert_eq!(lines, expected);

        let table = readable(&samples(), "; incomplete");
        let headings: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(headings, ["name", "h", "error", "solve"]);
        assert_eq!(table.rows[0], ["a", "9.00", "–", "2e-7"]);
        assert_eq!(table.rows[1], ["a", "10.00", "12.3", "0.12"]);
        // A run that did not do what it claims shows no time.
        assert_eq!(table.rows[2], ["b_1", "10.00", "–", "–"]);
        assert!(
            table
                .markdown()
                .starts_with("### Samples; incomplete\n\n| name | h [m] | error [%] |")
        );
        assert!(table.terminal().contains("\na      9.00"));

        let latex = table.latex("tab:samples");
        for part in [
            "S[table-format=2.2]",
            "\\num{2e-7}",
            "{error {[}\\unit{\\percent}]}",
            "b\\_1 & 10.00 & {--}",
        ] {
            assert!(latex.contains(part), "{part}: {latex}");
        }
        let chapter = Description::of::<Sample>().chapter();
        assert!(
            chapter.contains("### `samples.csv`\n\n*Which?*")
                && chapter.contains("| `h_m` | m | size |")
        );
    }
}
