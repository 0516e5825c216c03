//! The committed report against a fresh one: of some cases that take a second, or, where the environment names the folder
//! that `stickslip paper` has just written, of the whole main job. `.ci/run` does that with the folder of the release.
//!
//! Source: `reports/`, written by `stickslip paper`. Goal: whoever opens the repository sees numbers that this source
//! still produces, in every CSV file of the main job, times excepted. Text must be equal, numbers within 1e-6 of the size
//! of their kind in the case (the exact methods stop at a natural map of 1e-9, and another processor rounds differently).
//! Columns of few digits, residuals and differences among them, may differ by one in the last digit that either prints, or by
//! 1e-6 absolutely: below that they are rounding themselves.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use stickslip::case::shipped;
use stickslip::report::paper::converged_reactions::summary;
use stickslip::report::{Bundle, csv as table, standard};
use stickslip::run::record::Results;
use stickslip::run::registry::method;
use stickslip::run::run_case::{Fields, Quiet, Settings, run_case};
use stickslip::studies::paper::converged_reactions::{ConvergedRow, agreements};

/// Columns printed with two to four digits.
const FEW_DIGITS: [&str; 15] = [
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
    "limit_mn_per_m",
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

/// Names the folder of a fresh report.
const FOLDER: &str = "STICKSLIP_REPORT";

/// Cases that every method runs in a second altogether: friction, none, an open crack, load cycles, the plate of Table 1.
const QUICK: [&str; 6] = [
    "cyclic",
    "frictionless",
    "plate_mesh1",
    "sliding_block_cycle",
    "sliding_block_embedded",
    "tension_open",
];

/// Tables of the quick cases.
fn quick() -> BTreeMap<String, Vec<u8>> {
    let settings = Settings {
        tier: None,
        jobs: 1,
        fields: Fields::None,
    };
    let mut results = Results::default();
    for name in QUICK {
        let case = shipped::find(name).expect("a case").expect("shipped");
        results.append(run_case(&case, &[], settings, &Quiet).expect("it runs"));
    }
    assert!(results.as_expected(), "{}", standard::summary(&results));
    let mut bundle = Bundle::new();
    table::add_to(&mut bundle, &results).expect("tables");
    let bytes = |path: &str| bundle.get(path).expect("a table").to_vec();
    bundle
        .paths()
        .map(|path| (path.to_owned(), bytes(path)))
        .collect()
}

/// Tables of a folder.
fn tables(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path());
    let tables = files.filter(|path| path.extension().is_some_and(|end| end == "csv"));
    let named = |path: std::path::PathBuf| {
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        (name, std::fs::read(&path).expect("a table"))
    };
    tables.map(named).collect()
}

#[test]
fn the_committed_tables_are_those_of_this_source() {
    let committed = tables(&Path::new(env!("CARGO_MANIFEST_DIR")).join("reports"));
    let folder = std::env::var_os(FOLDER);
    let fresh = match &folder {
        Some(folder) => tables(Path::new(folder)),
        None => quick(),
    };
    if folder.is_some() {
        let same = committed.keys().eq(fresh.keys());
        assert!(
            same,
            "the main job writes what is committed: {:?}",
            fresh.keys()
        );
    }
    // Rows of methods registered since the report was written have nothing to be compared with.
    let runs = Table::read(&committed["runs.csv"]);
    let methods: BTreeSet<String> = (runs.rows.iter())
        .map(|row| name(&runs.cell(row, "method")).to_owned())
        .collect();
    let mut compared = 0;
    for (table, bytes) in fresh {
        let mut committed = Table::read(&committed[&table]);
        let mut fresh = Table::read(&bytes);
        assert_eq!(committed.header, fresh.header, "{table}");
        fresh.keep_methods(&methods);
        if folder.is_none() {
            let case = committed.header.iter().position(|column| column == "case");
            let case = case.expect("a case in every row");
            committed.rows.retain(|row| QUICK.contains(&&*row[case]));
        }
        assert_eq!(committed.rows.len(), fresh.rows.len(), "{table}");
        for (line, (old, new)) in committed.rows.iter().zip(&fresh.rows).enumerate() {
            for (column, (a, b)) in fresh.header.iter().zip(old.iter().zip(new)) {
                if column.ends_with("_s") {
                    continue;
                }
                let size = fresh.sizes.get(&fresh.kind(new, column)).copied();
                assert!(
                    same(column, size.unwrap_or(0.0), a, b),
                    "{table}, row {line}: {column}: committed {a}, found {b}"
                );
                compared += 1;
            }
        }
    }
    let least = if folder.is_some() { 100_000 } else { 10_000 };
    assert!(compared > least, "only {compared} cells");
}

/// Goal: every limit of the plate lies within the error bar of every other mesh's.
#[test]
fn the_committed_limits_of_three_meshes_agree() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/converged.csv");
    let table = Table::read(&std::fs::read(path).expect("converged.csv"));
    let row = |row: &Vec<String>| {
        let number = |column: &str| table.cell(row, column).parse().unwrap_or(f64::NAN);
        ConvergedRow {
            friction: number("friction"),
            mesh: table.cell(row, "mesh"),
            finest_h_m: number("finest_h_m"),
            order: number("order"),
            limit_mn_per_m: number("limit_mn_per_m"),
            error_bar_mn_per_m: number("error_bar_mn_per_m"),
            printed_mn_per_m: None,
        }
    };
    let rows: Vec<ConvergedRow> = table.rows.iter().map(row).collect();
    let meshes = agreements(&rows);
    assert_eq!(meshes.len(), 3);
    let agree = meshes.iter().all(|m| m.meshes == 3 && m.holds());
    assert!(agree, "{}", summary(&rows));
}
