//! Reports say what the documentation says, read back as what was written, and appear as a whole or not at all.

use crate::report_data::{METHODS, key, results};
use stickslip::report::table::{add, readable};
use stickslip::report::{Bundle, Provenance, standard};
use stickslip::run::verdict::Verdict;
use stickslip::studies::paper::printed_tables::{Table1Row, Table2Row};
use stickslip_methods::Status;

fn text(bundle: &Bundle, path: &str) -> String {
    let bytes = bundle
        .get(path)
        .unwrap_or_else(|| panic!("{path} is missing"));
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn csv_bundle() -> Bundle {
    let mut bundle = Bundle::new();
    standard::add_tables(&mut bundle, &results()).expect("tables");
    add(&mut bundle, &table1_rows(), "").expect("Table 1");
    add(&mut bundle, &table2_rows(), "").expect("Table 2");
    bundle
}

fn table1_rows() -> Vec<Table1Row> {
    vec![
        Table1Row::new(
            "II",
            0.8,
            "b-newton",
            Some(1_108.412_345),
            Some(1108.8),
            Some(Verdict::Solved),
        ),
        Table1Row::new(
            "I",
            1.2,
            "penalty",
            None,
            Some(1137.5),
            Some(Verdict::GaveUp(Status::MaxIterations)),
        ),
        Table1Row::new(
            "I",
            0.1,
            "b-newton",
            Some(973.543_21),
            Some(973.3),
            Some(Verdict::Solved),
        ),
    ]
}

fn table2_rows() -> Vec<Table2Row> {
    let p = [
        -0.2448591, -0.0981012, 0.0265221, 0.1475015, 0.2680483, 0.3910484, 0.5294690,
    ];
    let printed = Table2Row::printed("I", "as-printed", "y", p);
    let mut ours = p;
    ours[3] += 4.2e-7;
    let computed = |method, p, verdict| Table2Row::computed(&printed, method, p, Some(verdict));
    let solved = computed("b-newton", ours, Verdict::Solved);
    let diverged = Verdict::GaveUp(Status::Diverged);
    let failed = computed("a-fails", [f64::NAN; 7], diverged);
    vec![solved, failed, printed]
}

#[test]
fn rows_are_sorted_whatever_the_order_they_came_in() {
    let forward = results();
    let mut backward = forward.clone();
    backward.answers.reverse();
    for own in &mut backward.answers {
        own.record.found.increments[0].quantities.reverse();
        own.points[0].reverse();
    }
    backward.expectations.reverse();
    let (mut a, mut b) = (Bundle::new(), Bundle::new());
    standard::add_tables(&mut a, &forward).expect("tables");
    standard::add_tables(&mut b, &backward).expect("tables");
    for path in [
        "runs.csv",
        "increments.csv",
        "quantities.csv",
        "history.csv",
        "points.csv",
        "expectations.csv",
    ] {
        assert_eq!(text(&a, path), text(&b, path), "{path}");
    }
    let mut reader = csv::Reader::from_reader(a.get("history.csv").expect("history.csv"));
    let keys: Vec<(String, f64, usize)> = reader
        .records()
        .map(|row| row.expect("a record"))
        .map(|row| {
            let number = |i: usize| row[i].parse::<f64>().expect("a number");
            (row[3].to_owned(), number(4), number(6) as usize)
        })
        .collect();
    assert!(
        keys.windows(2).all(|pair| pair[0] < pair[1]),
        "method, friction, iteration ascend"
    );
    assert!(
        keys.iter().any(|k| k.2 > 9),
        "iterations beyond 9 prove that the order is numeric"
    );
}

#[test]
fn points_read_back_to_ten_digits() {
    let bundle = csv_bundle();
    let mut reader = csv::Reader::from_reader(bundle.get("points.csv").expect("points.csv"));
    let header = reader.headers().expect("a header").clone();
    let column = |name: &str| header.iter().position(|h| h == name).expect("a column");
    let made = results();
    let mut expected = made.points();
    expected.sort_by(|a, b| {
        let points = a.point.number.cmp(&b.point.number);
        a.key.order(&b.key).then(points)
    });
    let rows: Vec<csv::StringRecord> = reader.records().map(|r| r.expect("a record")).collect();
    assert_eq!(rows.len(), expected.len());
    for (row, point) in rows.iter().zip(&expected) {
        assert_eq!(row[column("method")], point.key.method);
        assert_eq!(row[column("status")], point.point.status);
        for (name, value) in [
            ("p_n", point.point.p_n),
            ("p_a", point.point.p_a),
            ("slip_a_m", point.point.slip_a_m),
            ("x_m", point.point.x_m),
        ] {
            let found: f64 = row[column(name)].parse().expect("a number");
            assert!(
                (found - value).abs() <= 5.1e-10 * value.abs(),
                "{name}: {found} and {value}"
            );
        }
    }
}

#[test]
fn quotes_and_commas_survive_the_csv() {
    let bundle = csv_bundle();
    let mut reader = csv::Reader::from_reader(bundle.get("expectations.csv").expect("a file"));
    let row = reader.records().next().expect("a row").expect("a record");
    assert_eq!(row[15], results().expectations[0].source);
}

#[test]
fn negative_zero_and_round_off_residuals_print_as_zero() {
    let bundle = csv_bundle();
    assert!(text(&bundle, "quantities.csv").contains(",reaction,top,x,0,N/m,NaN,\n"));
    let mut reader = csv::Reader::from_reader(bundle.get("increments.csv").expect("a file"));
    let header = reader.headers().expect("a header").clone();
    let column = header.iter().position(|name| name == "equilibrium");
    let column = column.expect("documented");
    let rows: Vec<_> = reader.records().map(|row| row.expect("a row")).collect();
    assert!(!rows.is_empty());
    assert!(
        rows.iter().all(|row| &row[column] == "0"),
        "equilibrium 3.2e-14 is 0"
    );
}

#[test]
fn paper_tables_show_printed_values_beside_ours() {
    let bundle = csv_bundle();
    let expected = "mesh,friction,method,reaction_mn_per_m,printed_mn_per_m,relative_difference,verdict\n\
                    I,0.1,b-newton,973.54321,973.3,0.00025,solved\n\
                    I,1.2,penalty,,1137.5,,gave-up: max-iterations\n\
                    II,0.8,b-newton,1108.412345,1108.8,-0.00035,solved\n";
    assert_eq!(text(&bundle, "table1.csv"), expected);
    let table2 = text(&bundle, "table2.csv");
    let methods: Vec<&str> = table2
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(3))
        .collect();
    assert_eq!(
        methods,
        ["printed", "a-fails", "b-newton"],
        "the printed line comes first"
    );
    assert!(table2.contains(",0.14750192,"), "{table2}");
    assert!(table2.contains(",4.2e-7,solved"), "{table2}");
    assert!(
        table2.contains(",NaN,,gave-up: diverged"),
        "no solution has no difference: {table2}"
    );

    let markdown = text(&bundle, "table1.md");
    assert!(
        markdown.contains("| I | 0.1 | 973.3 | 973.543 |  |")
            && markdown.contains("| penalty, gave-up: max-iterations |"),
        "{markdown}"
    );
    let latex = text(&bundle, "table2.tex");
    for part in [
        "{largest printed {[}\\unit{mm}]}",
        " & 0.529469 & ",
        "\\num{4.2e-7}",
    ] {
        assert!(latex.contains(part), "{part}: {latex}");
    }
    let terminal = readable(&table2_rows(), "").terminal();
    assert!(
        terminal.lines().all(|line| line.chars().count() < 160),
        "{terminal}"
    );
}

#[test]
fn wrong_answers_have_no_profile_and_no_time() {
    let mut results = results();
    for found in results.answers.iter_mut().map(|own| &mut own.record.found) {
        if found.method == "latin" {
            found.verdict = Verdict::FalseClaim;
            found.increments[0].verdict = Verdict::FalseClaim;
        }
    }
    let bundle = standard::bundle(&results, &Provenance::collect(1)).expect("a bundle");
    let profile = text(
        &bundle,
        "figures/plate_mesh1.22x22.edge-pairs.mu-0.1.crack-1.profile.svg",
    );
    assert!(profile.contains("2 exact methods agree") && !profile.contains("latin"));
    let history = text(
        &bundle,
        "figures/plate_mesh1.22x22.edge-pairs.mu-0.1.residual.svg",
    );
    assert!(
        history.contains("latin"),
        "a failure is shown where it is one"
    );
    // In the form for reading; the file of rows holds what was measured.
    let table = readable(&standard::runs(&results), "");
    let verdict = table.columns.iter().position(|c| c.name == "verdict");
    let time = table.columns.iter().position(|c| c.name == "solve");
    let (verdict, time) = (verdict.expect("a verdict"), time.expect("a time"));
    let (wrong, right): (Vec<_>, Vec<_>) =
        (table.rows.iter()).partition(|row| row[verdict] == "false-claim");
    assert_eq!((wrong.len(), right.len()), (3, 9));
    assert!(wrong.iter().all(|row| row[time] == "–"));
    assert!(right.iter().all(|row| row[time].parse::<f64>().is_ok()));
}

#[test]
fn provenance_is_in_its_own_file_only() {
    let provenance = Provenance::collect(3).with_option("tier", "high");
    let bundle = standard::bundle(&results(), &provenance).expect("a bundle");
    let parsed: toml::Table = text(&bundle, "provenance.toml").parse().expect("TOML");
    assert_eq!(parsed["version"].as_str(), Some(env!("CARGO_PKG_VERSION")));
    assert_eq!(parsed["threads"].as_integer(), Some(3));
    assert_eq!(parsed["options"]["tier"].as_str(), Some("high"));
    for name in [
        "command", "commit", "dirty", "rustc", "target", "profile", "os", "cpu",
    ] {
        assert!(
            parsed[name].as_str().is_some_and(|text| !text.is_empty()),
            "{name}"
        );
    }
    for path in bundle.paths().filter(|path| *path != "provenance.toml") {
        let contents = text(&bundle, path);
        assert!(!contents.contains(&provenance.rustc), "{path}");
        assert!(
            provenance.commit == "unknown" || !contents.contains(&provenance.commit),
            "{path}"
        );
    }
}

#[test]
fn file_names_hold_no_separators() {
    let mut odd = key(METHODS[0], 0.1);
    (odd.space, odd.method) = ("edge-pairs/gauss-6".into(), "penalty[k=1e12, μ]".into());
    let stem = stickslip::report::names::stem(&odd);
    assert_eq!(
        stem,
        "plate_mesh1.22x22.edge-pairs-gauss-6.penalty-k=1e12----.mu-0.1"
    );
}
