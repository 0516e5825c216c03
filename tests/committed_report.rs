//! The committed report against a fresh run of the main job.
//!
//! Source: `reports/`, written by `stickslip paper`. Goal: whoever opens the repository sees numbers that this source
//! still produces. Tables without times are compared cell by cell; text must be equal, numbers within 1e-6 of their
//! size (the exact methods stop at a natural map of 1e-9, and another processor rounds differently), residuals and
//! differences, which are rounding themselves, within 1e-6 absolutely.

use std::path::Path;

use stickslip::harness::run::{Fields, Quiet, Settings};
use stickslip::paper;
use stickslip::report::Provenance;

/// Tables without times.
const TABLES: [&str; 5] = [
    "table1.csv",
    "table2.csv",
    "penalty.csv",
    "refinement.csv",
    "limits.csv",
];

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

fn same(committed: &str, fresh: &str) -> bool {
    match (committed.parse::<f64>(), fresh.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-6 * a.abs().max(1.0),
        _ => committed == fresh,
    }
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
                assert!(same(a, b), "{table}:{}: committed {a}, found {b}", line + 1);
            }
        }
    }
}
