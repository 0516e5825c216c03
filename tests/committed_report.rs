//! The committed report against a fresh run of the main job.
//!
//! Source: `reports/`, written by `stickslip paper`. Goal: whoever opens the repository sees numbers that this source
//! still produces. Tables without times are compared cell by cell; text must be equal, numbers within 1e-6 of their
//! size (the exact methods stop at a natural map of 1e-9, and another processor rounds differently), residuals and
//! differences, which are rounding themselves, within 1e-6 absolutely. Orders, error bars and limits are printed with few
//! digits: they may differ by one in the last that either prints.

use std::path::Path;

use stickslip::harness::run::{Fields, Quiet, Settings};
use stickslip::paper;
use stickslip::report::Provenance;
use stickslip::report::converged::{agreements, summary};

/// Tables without times.
const TABLES: [&str; 7] = [
    "table1.csv",
    "table2.csv",
    "penalty.csv",
    "refinement.csv",
    "limits.csv",
    "converged.csv",
    "converged_meshes.csv",
];

/// Tables whose numbers are held to the digits they print.
const PRINTED: [&str; 2] = ["converged.csv", "converged_meshes.csv"];

fn rows(bytes: &[u8]) -> Vec<Vec<String>> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(bytes)
        .records()
        .map(|row| {
            row.expect("a report is valid CSV")
                .iter()
                .map(str::to_owned)
                .collect()
        })
        .collect()
}

fn same(table: &str, committed: &str, fresh: &str) -> bool {
    match (committed.parse::<f64>(), fresh.parse::<f64>()) {
        // No value: an order on the first two meshes.
        (Ok(a), Ok(b)) if a.is_nan() || b.is_nan() => a.is_nan() && b.is_nan(),
        (Ok(a), Ok(b)) => {
            let unit = match PRINTED.contains(&table) {
                true => last_unit(committed).min(last_unit(fresh)),
                false => 0.0,
            };
            // The difference of two decimal numbers is rounded too.
            (a - b).abs() <= (1e-6 * a.abs().max(1.0)).max(1.001 * unit)
        }
        _ => committed == fresh,
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
    let printed = |a, b| same("converged.csv", a, b);
    assert!(printed("1.58", "1.59") && printed("1.6", "1.59") && printed("-0.0124", "-0.0123"));
    assert!(!printed("1.58", "1.6") && !printed("1.58", "NaN") && !printed("71300", "71301"));
    assert!(!printed("solved", "gave-up") && printed("NaN", "NaN"));
    assert!(!same("limits.csv", "1.58", "1.59"));
}

#[test]
fn the_committed_tables_are_those_of_this_source() {
    let settings = Settings {
        tier: None,
        jobs: 1,
        fields: Fields::None,
    };
    let paper = paper::run(settings, &Quiet).expect("the main job runs");
    assert!(
        paper::as_expected(&paper.results),
        "{}",
        paper::summary(&paper.results)
    );
    assert!(
        paper.beam_models_mm < 1e-9,
        "Models I and II differ by {} mm",
        paper.beam_models_mm
    );
    let meshes = agreements(&paper.converged);
    assert_eq!(meshes.len(), 3);
    assert!(
        meshes.iter().all(|m| m.meshes == 3 && m.holds()),
        "{}",
        summary(&paper.converged)
    );
    let bundle = paper
        .bundle(&Provenance::collect(1))
        .expect("the report can be written");
    for table in TABLES {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("reports")
            .join(table);
        let committed =
            rows(&std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())));
        let fresh = rows(
            bundle
                .get(table)
                .unwrap_or_else(|| panic!("{table} is not written")),
        );
        assert_eq!(committed.len(), fresh.len(), "{table}");
        for (line, (committed, fresh)) in committed.iter().zip(&fresh).enumerate() {
            assert_eq!(committed.len(), fresh.len(), "{table}:{}", line + 1);
            for (a, b) in committed.iter().zip(fresh) {
                assert!(
                    same(table, a, b),
                    "{table}:{}: committed {a}, found {b}",
                    line + 1
                );
            }
        }
    }
}
