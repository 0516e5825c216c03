//! The committed report against a fresh run of the main job.
//!
//! Source: `reports/`, written by `stickslip paper --full`. Goal: whoever opens the repository sees numbers that this source
//! still produces, in every CSV file kept of the main job, times excepted. Text must be equal, numbers within 1e-6 of the size
//! of their kind in the case (the exact methods stop at a natural map of 1e-9, and another processor rounds differently).
//! Columns of few digits, residuals and differences among them, may differ by one in the last digit that either prints, or by
//! 1e-6 absolutely: below that they are rounding themselves.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use stickslip::case::shipped;
use stickslip::report::tables::catalogue;
use stickslip::report::tables::details::ExpectedNumber;
use stickslip::report::{standard, table};
use stickslip::run::progress::Quiet;
use stickslip::run::registry::method;
use stickslip::studies::cases::{Settings, run_case};
use stickslip::studies::paper::comparison::comparison;
use stickslip::studies::results::Results;

/// Columns printed with two to four digits.
const FEW_DIGITS: [&str; 14] = [
    "natural_map",
    "equilibrium",
    "claimed_equilibrium",
    "claimed",
    "deviation",
    "relative_difference",
    "relative_error",
    "relative_gap",
    "max_difference_mm",
    "max_penetration_m",
    "order",
    "error_bar_mn_per_m",
    "printed_difference",
    "allowed",
];

/// Columns of one kind: what is zero but for rounding is small beside the others.
const KINDS: [&[&str]; 3] = [
    &["p_n", "p_a", "p_b"],
    &["gap_m", "slip_a_m", "slip_b_m"],
    &["expected", "found", "value"],
];

/// Columns that tell rows apart.
const NAMES: [&str; 9] = [
    "case",
    "family",
    "mesh",
    "model",
    "variant",
    "component",
    "friction",
    "method",
    "parameter",
];

/// A table with what its numbers are compared by.
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Largest magnitude by case, unit and kind of column.
    sizes: BTreeMap<(String, String, String), f64>,
}

impl Table {
    fn read(bytes: &[u8]) -> Self {
        let mut reader = csv::Reader::from_reader(bytes);
        let texts = |row: &csv::StringRecord| row.iter().map(str::to_owned).collect();
        let header: Vec<String> = texts(reader.headers().expect("a header"));
        let rows = reader.records();
        let rows: Vec<Vec<String>> = rows
            .map(|row| texts(&row.expect("a report is valid CSV")))
            .collect();
        let mut table = Self {
            header,
            rows,
            sizes: BTreeMap::new(),
        };
        for row in &table.rows {
            for (column, cell) in table.header.iter().zip(row) {
                let size = cell.parse::<f64>().map_or(0.0, f64::abs);
                if size.is_finite() {
                    let own = table.sizes.entry(table.kind(row, column)).or_default();
                    *own = size.max(*own);
                }
            }
        }
        table
    }

    /// Drops the rows of methods that are registered and not among these.
    fn keep_methods(&mut self, methods: &BTreeSet<String>) {
        if let Some(at) = self.header.iter().position(|column| column == "method") {
            let printed = |row: &[String]| method(name(&row[at])).is_none();
            self.rows
                .retain(|row| methods.contains(name(&row[at])) || printed(row));
        }
    }

    fn cell(&self, row: &[String], column: &str) -> String {
        let at = self.header.iter().position(|name| name == column);
        at.map_or_else(String::new, |at| row[at].clone())
    }

    fn kind(&self, row: &[String], column: &str) -> (String, String, String) {
        let kind = KINDS.iter().find(|kind| kind.contains(&column));
        let kind = kind.map_or(column, |kind| kind[0]);
        (self.cell(row, "case"), self.cell(row, "unit"), kind.into())
    }
}

/// Name of a method without its options.
fn name(label: &str) -> &str {
    label.split('[').next().unwrap_or(label)
}

/// Whether two cells of a column are the same but for rounding; `size` is that of their kind.
fn same(column: &str, size: f64, committed: &str, fresh: &str) -> bool {
    if committed == fresh {
        return true;
    }
    match (committed.parse::<f64>(), fresh.parse::<f64>()) {
        (Ok(a), Ok(b)) if FEW_DIGITS.contains(&column) => {
            let unit = last_unit(committed).min(last_unit(fresh));
            // The difference of two decimal numbers is rounded too.
            (a - b).abs() <= 1e-6_f64.max(1.001 * unit)
        }
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-6 * size,
        _ => false,
    }
}

/// One in the last decimal of a number; 0 of a whole number, which is exact.
fn last_unit(number: &str) -> f64 {
    let (mantissa, exponent) = number.split_once('e').unwrap_or((number, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len() as i32);
    let exponent: i32 = exponent.parse().expect("a number");
    if decimals == 0 {
        0.0
    } else {
        10f64.powi(exponent - decimals)
    }
}

#[test]
fn numbers_are_held_to_the_digits_they_print() {
    let printed = |a, b| same("order", 1.0, a, b);
    assert!(printed("1.58", "1.59") && printed("1.6", "1.59") && printed("-0.0124", "-0.0123"));
    assert!(!printed("1.58", "1.6") && !printed("1.58", "NaN") && !printed("71300", "71301"));
    assert!(!printed("solved", "gave-up") && printed("NaN", "NaN"));
    assert!(printed("3.5e-10", "0") && !printed("0.0021", "0.0023"));
    assert!(!same("reaction_mn_per_m", 1.6, "1.58", "1.59"));
    assert!(same("value", 2e6, "1e-9", "-1e-9") && !same("value", 2e6, "1", "4"));
    assert!(!same("iterations", 8183.0, "11", "12"));
}

#[test]
fn sizes_are_those_of_a_kind_in_its_case() {
    let table = Table::read(
        b"case,quantity,value,unit\na,force,-30,N\na,force,1e-9,N\na,gap,0.5,m\nb,force,NaN,N\n",
    );
    let size = |line: usize| {
        table
            .sizes
            .get(&table.kind(&table.rows[line], "value"))
            .copied()
    };
    assert_eq!(
        [size(0), size(1), size(2), size(3)],
        [Some(30.0), Some(30.0), Some(0.5), None]
    );
}

/// Cases that every method runs in a second altogether: friction, none, an open crack, load cycles, the plate of Table 1.
const QUICK: [&str; 6] = [
    "cyclic",
    "frictionless",
    "plate_mesh1",
    "sliding_block_cycle",
    "sliding_block_embedded",
    "tension_open",
];

/// Tables made now: those of the folder that the environment names, where a main job has just written them; else what the
/// quick cases add to them.
fn fresh_tables() -> BTreeMap<String, Vec<u8>> {
    let names = catalogue().into_iter().map(|(_, table)| table.file());
    if let Some(folder) = std::env::var_os("STICKSLIP_REPORT") {
        let read = |name: String| {
            Some((
                name.clone(),
                std::fs::read(Path::new(&folder).join(name)).ok()?,
            ))
        };
        return names.filter_map(read).collect();
    }
    let settings = Settings::PLAIN;
    let mut results = Results::default();
    for name in QUICK {
        let case = shipped::find(name).expect("a case").expect("shipped");
        results.append(run_case(&case, &[], settings, &Quiet).expect("it runs"));
    }
    assert!(results.as_expected(), "{}", standard::summary(&results));
    let expected = ExpectedNumber::of(&results.expectations);
    let tables = [
        ("comparison.csv", table::csv(&comparison(results.records()))),
        ("expectations.csv", table::csv(&expected)),
    ];
    tables
        .map(|(name, bytes)| (name.into(), bytes.expect("CSV")))
        .into()
}

#[test]
fn the_committed_tables_are_those_of_this_source() {
    let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    let read = |dir: &Path, table: &str| {
        let path = dir.join(table);
        std::fs::read(&path).ok().map(|bytes| Table::read(&bytes))
    };
    let known = read(&reports, "comparison.csv").expect("comparison.csv");
    // Rows of methods registered since the report was written have nothing to be compared with.
    let methods: BTreeSet<String> = (known.rows.iter())
        .map(|row| name(&known.cell(row, "method")).to_owned())
        .collect();
    let mut compared = 0;
    for (table, bytes) in fresh_tables() {
        // Large tables are not committed.
        let Some(committed) = read(&reports, &table) else {
            continue;
        };
        let mut fresh = Table::read(&bytes);
        assert_eq!(committed.header, fresh.header, "{table}");
        fresh.keep_methods(&methods);
        // The quick job leaves out cases: its rows are found among the committed ones, in their order.
        let mut old = committed.rows.iter().enumerate();
        for new in &fresh.rows {
            let names = |row: &[String]| -> Vec<String> {
                NAMES.map(|column| fresh.cell(row, column)).into()
            };
            let found = old.find(|(_, old)| names(old) == names(new));
            let (line, old) = found.unwrap_or_else(|| panic!("{table}: no {new:?}"));
            for (column, (a, b)) in fresh.header.iter().zip(old.iter().zip(new)) {
                if column.ends_with("_s") {
                    continue;
                }
                let size = fresh.sizes.get(&fresh.kind(new, column)).copied();
                assert!(
                    same(column, size.unwrap_or(0.0), a, b),
                    "{table}:{}: {column}: committed {a}, found {b}",
                    line + 2
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 500, "only {compared} cells");
}

/// Source: `orders.csv`, by `stickslip paper --full`. Goal: the reactions on the finest of three kinds of meshes agree within the
/// smallest error bar, for each friction coefficient.
#[test]
fn the_converged_reactions_agree_whatever_the_mesh() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/orders.csv");
    let table = Table::read(&std::fs::read(path).expect("orders.csv"));
    let number = |row: &[String], column| -> f64 { table.cell(row, column).parse().expect(column) };
    let mut groups: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for row in (table.rows.iter()).filter(|row| table.cell(row, "space") == "star") {
        let found = ["reference", "error_bar"].map(|column| number(row, column));
        groups
            .entry(table.cell(row, "friction"))
            .or_default()
            .push(found);
    }
    assert_eq!(groups.len(), 3);
    for (friction, found) in groups {
        assert_eq!(found.len(), 3, "three meshes");
        let [low, high] = [f64::min, f64::max].map(|f| found.iter().map(|x| x[0]).reduce(f));
        let bar = found.iter().map(|x| x[1]).reduce(f64::min);
        let spread = high.expect("a reaction") - low.expect("a reaction");
        assert!(spread <= bar.expect("a bar"), "μ = {friction}: {found:?}");
    }
}
