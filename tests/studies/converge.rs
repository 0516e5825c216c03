//! The convergence study: what is run, what it is measured against, what is written, and how it fails.

use std::path::Path;
use std::process::Output;

use crate::common::*;
use assert_cmd::Command;
use stickslip::case::{Case, ContactSpace, Tip};
use stickslip::model::errors::Deviation;
use stickslip::report::{Provenance, table};
use stickslip::run::choice::Choice;
use stickslip::run::run_case::Quiet;
use stickslip::run::verdict::Verdict;
use stickslip::studies::convergence;
use stickslip::studies::convergence::orders::{ErrorRow, Kind, OrderRow};
use stickslip::studies::convergence::{ConvergencePlan, Measured, Regularity, Sample, orders};
use stickslip_methods::Status;

/// Files that are written beside the figures.
const FILES: [&str; 7] = [
    "convergence.csv",
    "convergence.md",
    "convergence.tex",
    "orders.csv",
    "orders.md",
    "orders.tex",
    "provenance.toml",
];

fn stickslip(arguments: &[&str], dir: &Path) -> Output {
    let mut program = Command::cargo_bin("stickslip").unwrap();
    program.args(arguments).current_dir(dir).output().unwrap()
}

/// A plate pressed on its bottom; the crack starts at the left side and ends inside or on the right side.
fn plate(right: f64, tip: &str) -> Case {
    let rest = crack([0.0, 0.5], [right, 0.5], 0.3, tip)
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[1e-3, -1e-3]");
    parse(&plane([0.0, 0.0], [1.0, 1.0], [5, 5], &rest))
}

fn study(method: &str, tips: Option<Vec<Tip>>) -> ConvergencePlan {
    let method = stickslip::run::registry::method(method).unwrap();
    ConvergencePlan {
        refine: Some(vec![1, 3, 5]),
        spaces: Some(vec![ContactSpace::EdgePairs]),
        tips,
        choice: Choice::new(method, &[]).unwrap(),
    }
}

/// Error of a given order in h, in an energy norm and a traction.
fn power_law(case: &Case, body: &stickslip::model::body::Body) -> Vec<Deviation> {
    let cells = (body.mesh.cell_count() as f64).sqrt();
    let order = match convergence::regularity(case) {
        Regularity::Tip => 0.5,
        _ => 1.0,
    };
    let deviation = |quantity: &str, at: &str, error| Deviation {
        quantity: quantity.into(),
        at: at.into(),
        found: 2.0 + error,
        exact: 2.0,
        error,
    };
    vec![
        deviation("energy", "", 3.0 / cells.powf(order)),
        deviation("traction", "crack-1", 5.0 / cells.powf(1.5)),
    ]
}

fn samples(case: &Case, study: &ConvergencePlan) -> Vec<Sample> {
    let exact: &convergence::ClosedForm<'_> =
        &|loading, _| Ok(Some(power_law(case, loading.body())));
    convergence::run(case, study, exact, &Quiet).unwrap()
}

/// Goal: errors against a closed form arrive as measured, with their orders beside the theoretical ones, for every tip option.
#[test]
fn closed_forms_give_observed_beside_theoretical_orders() {
    let case = plate(0.53, "none");
    let samples = samples(
        &case,
        &study("hybrid", Some(vec![Tip::None, Tip::Branch, Tip::None])),
    );
    // Twice the same option is once the same problem.
    assert_eq!(samples.len(), 2 * 3);
    assert!(samples.iter().all(|s| s.verdict.is_honest()));
    let (errors, orders) = orders::rows(&samples);
    assert_eq!((errors.len(), orders.len()), (2 * 3 * 2, 2 * 2));
    for row in &orders {
        let (order, theory) = match row.quantity.as_str() {
            "energy" => (0.5, Some(0.5)),
            _ => (1.5, None),
        };
        assert!((row.order - order).abs() < 1e-9, "{row:?}");
        assert_eq!((row.theory, row.kind, row.meshes), (theory, Kind::Exact, 3));
        assert!(["none", "branch"].contains(&row.variant.tip.as_str()));
    }
    let total = |row: &ErrorRow| row.seconds.total();
    assert!(errors.iter().all(|r| total(r) > 0.0 && total(r) < 60.0));

    let bundle = stickslip::report::convergence::bundle(&errors, &orders, &Provenance::collect(1));
    let bundle = bundle.unwrap();
    for what in ["energy", "traction-crack-1"] {
        let name = format!("figures/test.hybrid.mu-0.3.{what}.error.svg");
        let svg = std::str::from_utf8(bundle.get(&name).expect(&name)).unwrap();
        // Measured against a closed form, not relative to anything.
        assert!(
            svg.contains("error: ") && !svg.contains("relative error"),
            "{name}"
        );
    }
    let svg = bundle
        .get("figures/test.hybrid.mu-0.3.energy.error.svg")
        .unwrap();
    let svg = std::str::from_utf8(svg).unwrap();
    for text in [
        "tips not enriched",
        "tip cells enriched",
        ">edge-pairs: 0.50<",
    ] {
        assert!(svg.contains(text), "{text}: {svg}");
    }
    // Both panels have the same orders: one legend is enough.
    assert_eq!(svg.matches(">theory: 0.5<").count(), 1, "{svg}");
}

/// Goal: without a tip inside there is nothing to enrich, and the smooth orders hold.
#[test]
fn cracks_through_the_body_are_smooth_whatever_the_tip_option() {
    let case = plate(1.0, "none");
    let samples = samples(&case, &study("hybrid", Some(vec![Tip::None, Tip::Branch])));
    assert_eq!(samples.len(), 3);
    assert!(samples.iter().all(|s| s.variant.tip == "no-tips"));
    let (_, orders) = orders::rows(&samples);
    let theory: Vec<Option<f64>> = orders.iter().map(|o| o.theory).collect();
    assert_eq!(theory, [Some(1.0), Some(1.0)]);
}

/// Goal: what the method did not solve is never measured.
#[test]
fn verdicts_that_are_not_honest_have_no_error() {
    let case = plate(0.53, "none");
    let mut study = study("nsgs", None);
    let one = [("max_iterations".to_owned(), 1.0)];
    study.choice = Choice::new(study.choice.method, &one).unwrap();
    let samples = samples(&case, &study);
    assert!(samples.iter().all(|s| s.measured == Measured::Nothing));
    let (errors, orders) = orders::rows(&samples);
    assert_eq!((errors.len(), orders.len()), (3, 0));
    for row in &errors {
        assert_eq!(row.verdict, Verdict::GaveUp(Status::MaxIterations));
        assert!(row.error.is_nan() && row.kind.is_none() && row.seconds.total().is_nan());
    }
    let bundle = stickslip::report::convergence::bundle(&errors, &orders, &Provenance::collect(1));
    let names: Vec<String> = bundle.unwrap().paths().map(str::to_owned).collect();
    assert_eq!(names, FILES);
}

#[test]
fn meshes_spaces_and_tips_come_from_the_case_unless_asked_for() {
    let mut case = plate(0.53, "branch");
    let own = ConvergencePlan {
        refine: None,
        spaces: None,
        tips: None,
        ..study("hybrid", None)
    };
    assert_eq!(own.meshes(&case), [1, 2, 4, 8]);
    assert_eq!(own.spaces(&case), [Some(ContactSpace::Star), None]);
    assert_eq!(own.tips(&case), [None]);
    case.sweep.refine = vec![3, 1];
    case.cracks[0].contact = ContactSpace::Star;
    assert_eq!(own.meshes(&case), [1, 3]);
    assert_eq!(own.spaces(&case), [None]);
    let given = study("hybrid", Some(vec![Tip::Radius(0.2)]));
    assert_eq!(given.meshes(&case), [1, 3, 5]);
    assert_eq!(given.spaces(&case), [Some(ContactSpace::EdgePairs)]);
    assert_eq!(given.tips(&case), [Some(Tip::Radius(0.2))]);
    case.cracks[0].tip = Tip::Radius(0.2);
    assert_eq!(convergence::regularity(&case), Regularity::FixedRadius);
}

/// Source: for h → 0 Mesh I tends to −1121.3 MN/m at μ = 0.8, by extrapolation from finer meshes. Goal: the verb writes
/// what it says, the limit holds the truth within its error bar, and the same again apart from times.
#[test]
fn the_verb_extrapolates_the_reaction_of_the_plate() {
    let dir = tempfile::tempdir().unwrap();
    let verb = |out: &str| {
        let arguments = [
            "converge",
            "plate_mesh1",
            "--refine",
            "4,1,2",
            "--spaces",
            "edge-pairs",
            "--out",
            out,
        ];
        let output = stickslip(&arguments, dir.path());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert!(output.stderr.is_empty());
        let shown = String::from_utf8(output.stdout).unwrap();
        assert!(shown.contains("9 runs: 9 solved, 0 not"), "{shown}");
        assert!(
            shown.contains("whose errors are correlated with it"),
            "{shown}"
        );
    };
    verb("one");
    verb("two");
    let read = |out: &str, file: &str| {
        std::fs::read_to_string(dir.path().join(out).join(file))
            .unwrap_or_else(|e| panic!("{out}/{file}: {e}"))
    };
    for file in FILES {
        assert!(!read("one", file).is_empty());
    }
    for file in [
        "orders.csv",
        "orders.md",
        "orders.tex",
        "figures/plate_mesh1.hybrid.mu-0.8.reaction-top-y.error.svg",
    ] {
        assert_eq!(read("one", file), read("two", file), "{file}");
    }

    let table = |file: &str| -> Vec<csv_row::Row> { csv_row::rows(&read("one", file)) };
    let order = table("orders.csv").into_iter().find(|row| {
        row["friction"] == "0.8" && row["quantity"] == "reaction" && row["at"] == "top y"
    });
    let order = order.unwrap();
    let number = |row: &csv_row::Row, column: &str| row[column].parse::<f64>().unwrap();
    assert_eq!(
        (order["kind"].as_str(), order["tip"].as_str()),
        ("richardson", "branch")
    );
    let off = (number(&order, "reference") + 1121.3e6).abs();
    assert!(off < number(&order, "error_bar"), "{order:?}");
    let rows = table("convergence.csv");
    let own: Vec<&csv_row::Row> = rows
        .iter()
        .filter(|row| row["friction"] == "0.8" && row["at"] == "top y")
        .collect();
    assert_eq!(
        own.iter().map(|r| r["refine"].as_str()).collect::<Vec<_>>(),
        ["1", "2", "4"]
    );
    assert_eq!(own[2]["order"], order["order"]);
    assert!(
        own.windows(2)
            .all(|pair| number(pair[0], "error") > number(pair[1], "error"))
    );
    for row in own {
        let parts = [
            "setup_s",
            "assembly_s",
            "factorisation_s",
            "condensation_s",
            "prepare_s",
            "solve_s",
        ];
        let sum: f64 = parts.iter().map(|part| number(row, part)).sum();
        assert!((number(row, "total_s") - sum).abs() < 1e-3 * sum, "{row:?}");
    }
}

mod csv_row {
    use std::collections::BTreeMap;

    pub type Row = BTreeMap<String, String>;

    pub fn rows(text: &str) -> Vec<Row> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().unwrap().clone();
        let own = |r: csv::StringRecord| {
            let pairs = header.iter().zip(r.iter());
            pairs.map(|(k, v)| (k.to_owned(), v.to_owned())).collect()
        };
        reader.records().map(|r| own(r.unwrap())).collect()
    }
}

#[test]
fn a_run_that_is_not_solved_ends_with_1_and_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let arguments = [
        "converge",
        "plate_mesh1",
        "--refine",
        "1",
        "--spaces",
        "edge-pairs",
        "--method",
        "nsgs:max_iterations=1",
    ];
    let output = stickslip(&arguments, dir.path());
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let named = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        named
            .matches("gave-up: max-iterations: plate_mesh1 22x22 edge-pairs branch")
            .count(),
        3
    );
    let table = std::fs::read_to_string(dir.path().join("results/convergence.csv")).unwrap();
    assert_eq!(csv_row::rows(&table).len(), 3);
}

#[test]
fn bad_arguments_are_refused_and_leave_nothing_behind() {
    let dir = tempfile::tempdir().unwrap();
    for bad in [
        &["nobody"][..],
        &["missing.toml"],
        &[],
        &["cyclic", "cyclic"],
        &["cyclic", "--spaces", "mortar"],
        &["cyclic", "--spaces", ""],
        &["cyclic", "--tips", "-1"],
        &["cyclic", "--tips", "inf"],
        &["cyclic", "--tips", "sharp"],
        &["cyclic", "--refine", "0"],
        &["cyclic", "--refine", "1.5"],
        &["cyclic", "--method", "nobody"],
        &["cyclic", "--method", "hybrid:nothing=1"],
        // Its modelling error would be taken for that of the mesh.
        &["cyclic", "--method", "penalty"],
        &["cyclic", "--method", "hybrid", "--method", "b-newton"],
    ] {
        let arguments: Vec<&str> = std::iter::once("converge")
            .chain(bad.iter().copied())
            .collect();
        let output = stickslip(&arguments, dir.path());
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(
            output.stdout.is_empty() && !output.stderr.is_empty(),
            "{bad:?}"
        );
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}

/// Source: the block slides rigidly, whatever the mesh. Goal: round-off is neither printed nor drawn, nor given an order.
#[test]
fn round_off_is_no_error() {
    let dir = tempfile::tempdir().unwrap();
    let arguments = [
        "converge",
        "sliding_block_conforming",
        "--refine",
        "1,2,3",
        "--spaces",
        "edge-pairs",
    ];
    let output = stickslip(&arguments, dir.path());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let read = |file: &str| std::fs::read_to_string(dir.path().join("results").join(file)).unwrap();
    let rows = csv_row::rows(&read("orders.csv"));
    let slip = rows.iter().filter(|row| row["quantity"] == "max_slip");
    let slip: Vec<_> = slip
        .map(|row| [&row["kind"], &row["error"], &row["order"]].map(String::as_str))
        .collect();
    assert_eq!(slip, [["finest", "0", "NaN"]; 2]);
    let figure = "results/figures/sliding_block_conforming.hybrid.mu-0.1.max_slip.error.svg";
    assert!(!dir.path().join(figure).exists());
}

/// Goal: rows come in the order of their table, whatever the order of the runs.
#[test]
fn rows_are_sorted() {
    let case = plate(0.53, "none");
    let mut samples = samples(&case, &study("hybrid", Some(vec![Tip::None, Tip::Branch])));
    let files = |samples: &[Sample]| {
        let (errors, orders) = orders::rows(samples);
        let errors = table::csv::<ErrorRow>(&errors).unwrap();
        [errors, table::csv::<OrderRow>(&orders).unwrap()]
    };
    let before = files(&samples);
    samples.reverse();
    assert_eq!(before, files(&samples));
}
