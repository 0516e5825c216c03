//! Reports say what the documentation says, read back as what was written, and appear as a whole or not at all.

mod report_data;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use report_data::{METHODS, beam, crack_line, key, plate, points, results};
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::Path;
use stickslip::harness::record::*;
use stickslip::report::paper::{self, Digits, Table1Row, Table2Row};
use stickslip::report::plot::{self, Axis3, Curve, CurvePlot, Magnification, Tier};
use stickslip::report::tables::{Align, Column, Table};
use stickslip::report::{Bundle, Provenance, ReportError, csv, prepare_output, standard, vtu};

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn text(bundle: &Bundle, path: &str) -> String {
    let bytes = bundle
        .get(path)
        .unwrap_or_else(|| panic!("{path} is missing"));
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn csv_bundle() -> Bundle {
    let mut bundle = Bundle::new();
    csv::add_to(&mut bundle, &results()).expect("CSV");
    paper::add_table1(&mut bundle, &table1_rows()).expect("Table 1");
    paper::add_table2(&mut bundle, &table2_rows()).expect("Table 2");
    bundle
}

fn table1_rows() -> Vec<Table1Row> {
    vec![
        Table1Row::new(
            "II",
            0.8,
            "b-newton",
            Some(1108.412_345),
            Some(1108.8),
            "solved",
        ),
        Table1Row::new(
            "I",
            1.2,
            "penalty",
            None,
            Some(1137.5),
            "gave-up: max-iterations",
        ),
        Table1Row::new(
            "I",
            0.1,
            "b-newton",
            Some(973.543_21),
            Some(973.3),
            "solved",
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
    let computed = Table2Row::computed(&printed, "b-newton", ours, "solved");
    let failed = Table2Row::computed(&printed, "a-fails", [f64::NAN; 7], "gave-up: diverged");
    vec![computed, failed, printed]
}

/// Columns that docs/schema.md lists, by file.
fn documented_columns() -> BTreeMap<String, Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/schema.md");
    let page = fs::read_to_string(path).expect("docs/schema.md");
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut file = None;
    for line in page.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            file = heading
                .strip_prefix('`')
                .and_then(|h| h.strip_suffix('`'))
                .map(str::to_owned);
        } else if let (Some(file), Some(row)) = (&file, line.strip_prefix("| `")) {
            let name = row.split('`').next().unwrap_or_default();
            columns
                .entry(file.clone())
                .or_default()
                .push(name.to_owned());
        }
    }
    columns
}

#[test]
fn headers_are_exactly_those_of_the_documentation() {
    let bundle = csv_bundle();
    let documented = documented_columns();
    let files: Vec<&str> = bundle
        .paths()
        .filter(|path| path.ends_with(".csv"))
        .collect();
    assert_eq!(
        files,
        documented.keys().map(String::as_str).collect::<Vec<_>>()
    );
    for (file, columns) in &documented {
        let header = text(&bundle, file)
            .lines()
            .next()
            .unwrap_or_default()
            .to_owned();
        assert_eq!(header, columns.join(","), "{file}");
    }
}

#[test]
fn headers_are_the_field_names_of_the_rows() {
    // The row types are serialisable; their own names are the reference.
    let run = toml::Value::try_from(&results().runs[0]).expect("a serialisable row");
    let names: Vec<&String> = run.as_table().expect("a table").keys().collect();
    let mut header = csv::header::<RunRow>();
    header.sort_unstable();
    let mut names: Vec<&str> = names.into_iter().map(String::as_str).collect();
    names.sort_unstable();
    assert_eq!(header, names);
}

#[test]
fn rows_are_sorted_whatever_the_order_they_came_in() {
    let forward = results();
    let mut backward = forward.clone();
    backward.runs.reverse();
    backward.quantities.reverse();
    backward.history.reverse();
    backward.points.reverse();
    backward.expectations.reverse();
    let (mut a, mut b) = (Bundle::new(), Bundle::new());
    csv::add_to(&mut a, &forward).expect("CSV");
    csv::add_to(&mut b, &backward).expect("CSV");
    for path in [
        "runs.csv",
        "quantities.csv",
        "history.csv",
        "points.csv",
        "expectations.csv",
    ] {
        assert_eq!(text(&a, path), text(&b, path), "{path}");
    }
    let mut reader = ::csv::Reader::from_reader(a.get("history.csv").expect("history.csv"));
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
    let mut reader = ::csv::Reader::from_reader(bundle.get("points.csv").expect("points.csv"));
    let header = reader.headers().expect("a header").clone();
    let column = |name: &str| header.iter().position(|h| h == name).expect("a column");
    let mut expected = results().points;
    expected.sort_by(|a, b| csv::compare_keys(&a.key, &b.key).then(a.point.cmp(&b.point)));
    let rows: Vec<::csv::StringRecord> = reader.records().map(|r| r.expect("a record")).collect();
    assert_eq!(rows.len(), expected.len());
    for (row, point) in rows.iter().zip(&expected) {
        assert_eq!(row[column("method")], point.key.method);
        assert_eq!(row[column("status")], point.status);
        for (name, value) in [
            ("p_n", point.p_n),
            ("p_a", point.p_a),
            ("slip_a_m", point.slip_a_m),
            ("x_m", point.x_m),
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
    let mut reader = ::csv::Reader::from_reader(bundle.get("expectations.csv").expect("a file"));
    let row = reader.records().next().expect("a row").expect("a record");
    assert_eq!(row[14], results().expectations[0].source);
}

#[test]
fn negative_zero_and_round_off_residuals_print_as_zero() {
    let bundle = csv_bundle();
    assert!(text(&bundle, "quantities.csv").contains(",reaction,top,x,0,N/m\n"));
    let runs = text(&bundle, "runs.csv");
    assert!(
        runs.lines().skip(1).all(|line| line.ends_with(",0,1")),
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
        markdown.contains("| I | 0.1 | b-newton | 973.543 | 973.3 | 2.5e-4 | solved |"),
        "{markdown}"
    );
    // Seven printed decimals, nine of ours, the points below each other.
    let latex = text(&bundle, "table2.tex");
    assert!(latex.contains("$0.1475015$\\phantom{00} &"), "{latex}");
    assert!(latex.contains("$0.147501920$ &"), "{latex}");
    let terminal = paper::table2(&table2_rows(), Digits::Printed)
        .expect("a table")
        .terminal();
    assert!(
        terminal.contains("0.1475019") && !terminal.contains("0.14750192"),
        "{terminal}"
    );
    assert!(
        terminal.lines().all(|line| line.chars().count() < 145),
        "{terminal}"
    );
}

#[test]
fn latex_escapes_what_would_break_it() {
    let mut table = Table::new(
        "A_b % of #1 & {c} ~ ^ \\ μ ≤ 1",
        vec![
            Column::new("x_y", "N/m²", Align::Left),
            Column::new("v", "", Align::Decimal),
        ],
    );
    table
        .push(vec!["p_n & 50 % #2 $3".into(), "-1.5e-7".into()])
        .expect("a row");
    table
        .push(vec!["plain".into(), "NaN".into()])
        .expect("a row");
    let latex = table.latex("tab:x");
    assert!(latex.contains(
        r"\caption{A\_b \% of \#1 \& \{c\} \textasciitilde{} \textasciicircum{} \textbackslash{} $\mu$ $\le$ 1}"
    ));
    assert!(
        latex.contains(r"p\_n \& 50 \% \#2 \$3 & $-1.5 \times 10^{-7}$ \\"),
        "{latex}"
    );
    assert!(
        latex.is_ascii(),
        "pdflatex knows no other characters without packages"
    );
    let body: String = latex
        .lines()
        .filter(|line| !line.starts_with('%'))
        .collect();
    let unescaped = body.replace("\\{", "").replace("\\}", "");
    assert_eq!(
        unescaped.matches('{').count(),
        unescaped.matches('}').count()
    );
    assert_eq!(
        latex.matches("\\begin{").count(),
        latex.matches("\\end{").count()
    );
    for rule in ["\\toprule", "\\midrule", "\\bottomrule"] {
        assert_eq!(latex.matches(rule).count(), 1);
    }
    // One separator per row that is not escaped.
    let separators = |line: &str| line.replace("\\&", "").matches('&').count();
    assert!(
        latex
            .lines()
            .filter(|line| line.ends_with("\\\\"))
            .all(|line| separators(line) == 1)
    );
}

#[test]
fn tables_refuse_rows_of_another_length() {
    let mut table = Table::new("t", vec![Column::new("a", "", Align::Left)]);
    let error = table
        .push(vec!["1".into(), "2".into()])
        .expect_err("two cells for one column");
    assert!(matches!(
        error,
        ReportError::TableShape {
            row: 1,
            found: 2,
            expected: 1,
            ..
        }
    ));
}

#[test]
fn pipes_do_not_break_markdown_rows() {
    let mut table = Table::new("t", vec![Column::new("|p_t|", "", Align::Left)]);
    table.push(vec!["a|b".into()]).expect("a row");
    for line in table
        .markdown()
        .lines()
        .filter(|line| line.starts_with('|'))
    {
        assert_eq!(line.replace("\\|", "").matches('|').count(), 2, "{line}");
    }
}

/// Every kind of figure, with the texts that it must show.
fn figures() -> Vec<(&'static str, String, Vec<&'static str>)> {
    let results = results();
    let by_method: Vec<PointRow> = results
        .points
        .iter()
        .filter(|row| row.key.friction == 0.1)
        .cloned()
        .collect();
    let history: Vec<HistoryRow> = results
        .history
        .iter()
        .filter(|row| row.key.friction == 0.1)
        .cloned()
        .collect();
    let curve = |label: &str, factor: f64| Curve {
        label: label.into(),
        points: (0..8)
            .map(|i| 10f64.powi(9 + i))
            .map(|k| [k, factor / k + 1e-9])
            .collect(),
    };
    let error = CurvePlot {
        caption: "penalty".into(),
        x_label: "penalty parameter [N/m]".into(),
        y_label: "relative error [-]".into(),
        curves: vec![curve("μ = 0.1", 3e8), curve("μ = 1.2", 9e8)],
    };
    let path = [[0.0, 0.0], [1.0, 3e5], [2.0, 3e5], [0.0, -3e5], [1.0, 0.0]];
    let cycle = CurvePlot {
        caption: "cycle".into(),
        x_label: "displacement [mm]".into(),
        y_label: "force [N/m]".into(),
        curves: vec![Curve {
            label: "latin".into(),
            points: path.to_vec(),
        }],
    };
    let tier = Tier::named("high");
    vec![
        (
            "residual",
            plot::residual_history(&history, tier.as_ref()).expect("residual"),
            vec![
                "latin",
                "penalty",
                "tier high",
                "iteration [-]",
                "10⁻⁸",
                "natural-map residual [-]",
            ],
        ),
        (
            "traction",
            plot::contact_traction(&by_method, 1).expect("traction"),
            vec![
                "[MPa]",
                "distance along the crack [m]",
                "stick",
                "open",
                "slip limit",
            ],
        ),
        (
            "slip",
            plot::contact_slip(&by_method, 1).expect("slip"),
            vec!["slip [mm]", "normal gap [µm]", "b-newton"],
        ),
        (
            "contours",
            plot::displacement_contours(&plate(), Magnification::Auto, "plate").expect("contours"),
            vec!["plate, deformation ×10", "[mm]", "−50", "[m]"],
        ),
        (
            "solid",
            plot::solid_displacement(&beam(), Axis3::Z, Magnification::Factor(50.0), "beam")
                .expect("solid"),
            vec!["beam, deformation ×50", "[mm]", "−1.0"],
        ),
        (
            "error",
            plot::error_plot(&error, Some(-1.0)).expect("error"),
            vec!["penalty parameter [N/m]", "10¹²", "μ = 1.2", ">1<"],
        ),
        (
            "loop",
            plot::line_plot(&cycle).expect("loop"),
            vec!["force [10³ N/m]", "−200", "latin"],
        ),
    ]
}

#[test]
fn figures_show_their_labels_as_text() {
    for (name, svg, texts) in figures() {
        assert!(svg.matches("<text").count() >= 8, "{name}");
        assert_eq!(
            svg.matches("<text").count(),
            svg.matches("</text>").count(),
            "{name}"
        );
        assert_eq!(
            svg.matches("<tspan").count(),
            svg.matches("</tspan>").count(),
            "{name}"
        );
        for text in texts {
            assert!(svg.contains(text), "{name} lacks {text}");
        }
        let private = svg.chars().find(|c| ('\u{E000}'..='\u{F8FF}').contains(c));
        assert_eq!(private, None, "{name} holds a mark of the typesetting");
        assert!(
            !svg.contains("NaN") && !svg.contains("-2147483648"),
            "{name}"
        );
    }
}

#[test]
fn figures_have_print_sizes_in_millimetres() {
    for (name, svg, _) in figures() {
        let width = if name == "contours" {
            "170.00mm"
        } else {
            "85.00mm"
        };
        assert!(
            svg.starts_with(&format!("<svg width=\"{width}\" height=\"")),
            "{name}"
        );
    }
}

#[test]
fn figures_stay_inside_their_paper() {
    for (name, svg, _) in figures() {
        let view = svg.split_once("viewBox=\"0 0 ").expect("a view box").1;
        let size: Vec<f64> = view
            .split('"')
            .next()
            .unwrap_or_default()
            .split(' ')
            .map(|n| n.parse().expect("a number"))
            .collect();
        for points in svg
            .split("points=\"")
            .skip(1)
            .filter_map(|rest| rest.split('"').next())
        {
            for pair in points.split_whitespace() {
                let (x, y) = pair.split_once(',').expect("a pair");
                let at: [f64; 2] = [x, y].map(|n| n.parse().expect("a number"));
                assert!(
                    (0..2).all(|c| at[c] >= 0.0 && at[c] <= size[c]),
                    "{name}: {at:?} of {size:?}"
                );
            }
        }
    }
}

#[test]
fn figures_are_the_same_bytes_twice() {
    for (first, second) in figures().into_iter().zip(figures()) {
        assert_eq!(first.1, second.1, "{}", first.0);
    }
}

#[test]
fn contour_bands_cover_the_body_without_holes() {
    // The lowest band is filled everywhere: as one outline of exactly the deformed body's area.
    let svg =
        plot::displacement_contours(&plate(), Magnification::Factor(0.0), "").expect("a figure");
    let polygon = svg.split("<polygon").nth(1).expect("a polygon");
    let points = polygon
        .split("points=\"")
        .nth(1)
        .and_then(|p| p.split('"').next())
        .expect("points");
    let corners: Vec<[f64; 2]> = points
        .split_whitespace()
        .filter_map(|pair| pair.split_once(','))
        .map(|(x, y)| [x.parse().expect("a number"), y.parse().expect("a number")])
        .collect();
    let twice_area: f64 = (0..corners.len())
        .map(|i| (corners[i], corners[(i + 1) % corners.len()]))
        .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
        .sum();
    let width = corners.iter().map(|c| c[0]).fold(0.0, f64::max)
        - corners.iter().map(|c| c[0]).fold(f64::INFINITY, f64::min);
    assert!(
        (twice_area.abs() / 2.0 - width * width).abs() < 1.0,
        "a square: {twice_area} {width}"
    );
}

#[test]
fn figures_refuse_what_they_cannot_show() {
    let nothing = plot::residual_history(&[], None).expect_err("no rows");
    assert!(matches!(nothing, ReportError::Figure { .. }), "{nothing}");
    let other = plot::contact_slip(&points(&key("latin", 0.1)), 2).expect_err("no crack 2");
    assert!(other.to_string().contains("crack 2"), "{other}");
    let mut solid = points(&key("latin", 0.1));
    for row in &mut solid {
        row.force_unit = "N".into();
    }
    assert!(plot::contact_traction(&solid, 1).is_err());
    let wrong = plot::displacement_contours(&beam(), Magnification::Auto, "").expect_err("3D");
    assert!(wrong.to_string().contains("3 dimensions"), "{wrong}");
    let mut bare = plate();
    bare.point_vectors.clear();
    let bare = plot::displacement_contours(&bare, Magnification::Auto, "").expect_err("no vector");
    assert!(bare.to_string().contains("displacement_m"), "{bare}");
    let negative = CurvePlot {
        caption: String::new(),
        x_label: "x".into(),
        y_label: "y".into(),
        curves: vec![Curve {
            label: "c".into(),
            points: vec![[1.0, -1.0]],
        }],
    };
    assert!(plot::error_plot(&negative, Some(1.0)).is_err());
}

#[test]
fn figures_survive_sparse_and_flat_data() {
    let mut history = vec![HistoryRow {
        key: key("latin", 0.1),
        iteration: 0,
        natural_map: 0.0,
    }];
    plot::residual_history(&history, None).expect("a single zero residual");
    history.push(HistoryRow {
        key: key("latin", 0.1),
        iteration: 1,
        natural_map: f64::NAN,
    });
    let svg = plot::residual_history(&history, None).expect("a residual that is not finite");
    assert!(!svg.contains("NaN"));

    let mut rows = points(&key("latin", 0.0));
    for row in &mut rows {
        (row.slip_a_m, row.gap_m, row.status) = (1e-19, 0.0, "stick".into());
    }
    let svg = plot::contact_slip(&rows, 1).expect("round-off slips");
    assert!(
        svg.contains("slip [m]"),
        "round-off is not enlarged to an axis of its own"
    );
    plot::contact_traction(&rows[..1], 1).expect("a single point");

    let mut flat = plate();
    for u in &mut flat.point_vectors[0].1 {
        *u = [0.0; 3];
    }
    plot::displacement_contours(&flat, Magnification::Auto, "").expect("a body at rest");
}

#[test]
fn unit_marks_in_data_do_not_reach_the_typesetting() {
    let mut row = HistoryRow {
        key: key("a\u{E000}b", 0.1),
        iteration: 0,
        natural_map: 1.0,
    };
    row.key.case = "<script>&".into();
    let svg = plot::residual_history(&[row], None).expect("a figure");
    assert!(!svg.contains("<script>") && svg.contains("&lt;script&gt;&amp;"));
    assert!(svg.contains(">ab<"));
}

/// Arrays of a `.vtu` file by name, decoded: base64, header, zlib blocks.
fn decoded(vtu: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let xml = std::str::from_utf8(vtu).expect("UTF-8");
    let mut arrays = BTreeMap::new();
    for element in xml.split("<DataArray ").skip(1) {
        let name = element
            .split("Name=\"")
            .nth(1)
            .and_then(|n| n.split('"').next());
        let data = element.split('>').nth(1).and_then(|d| d.split('<').next());
        let (name, data) = (name.expect("a name"), data.expect("data"));
        let number = |bytes: &[u8], i: usize| {
            u64::from_le_bytes(bytes[8 * i..8 * i + 8].try_into().expect("8 bytes")) as usize
        };
        let first = STANDARD
            .decode(&data[..32])
            .expect("the first three numbers");
        let blocks = number(&first, 0);
        let header_length = (8 * (3 + blocks)).div_ceil(3) * 4;
        let header = STANDARD.decode(&data[..header_length]).expect("a header");
        let body = STANDARD.decode(&data[header_length..]).expect("blocks");
        let mut bytes = Vec::new();
        let mut start = 0;
        for block in 0..blocks {
            let end = start + number(&header, 3 + block);
            let mut inflated = Vec::new();
            flate2::read::ZlibDecoder::new(&body[start..end])
                .read_to_end(&mut inflated)
                .expect("zlib");
            let partial = number(&header, 2);
            let expected = if block + 1 == blocks && partial > 0 {
                partial
            } else {
                number(&header, 1)
            };
            assert_eq!(inflated.len(), expected, "{name}");
            bytes.extend(inflated);
            start = end;
        }
        assert_eq!(start, body.len(), "{name}");
        arrays.insert(name.to_owned(), bytes);
    }
    arrays
}

fn as_f64(bytes: &[u8]) -> Vec<f64> {
    bytes
        .chunks(8)
        .map(|b| f64::from_le_bytes(b.try_into().expect("8 bytes")))
        .collect()
}

fn as_i64(bytes: &[u8]) -> Vec<i64> {
    bytes
        .chunks(8)
        .map(|b| i64::from_le_bytes(b.try_into().expect("8 bytes")))
        .collect()
}

#[test]
fn vtu_files_decode_to_the_bits_that_were_written() {
    for picture in [plate(), beam(), crack_line(), Picture::default()] {
        let file = vtu::vtu(&picture, 0.5, "a -- b").expect("a file");
        let arrays = decoded(&file);
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let same = |name: &str, values: Vec<f64>| {
            assert_eq!(bits(&as_f64(&arrays[name])), bits(&values), "{name}");
        };
        same("TimeValue", vec![0.5]);
        same("Points", picture.points.iter().flatten().copied().collect());
        for (name, values) in &picture.point_vectors {
            same(name, values.iter().flatten().copied().collect());
        }
        for (name, values) in picture.point_scalars.iter().chain(&picture.cell_scalars) {
            same(name, values.clone());
        }
        let connectivity: Vec<i64> = picture
            .cells
            .iter()
            .flat_map(|cell| &cell.points)
            .map(|p| *p as i64)
            .collect();
        assert_eq!(as_i64(&arrays["connectivity"]), connectivity);
        assert_eq!(arrays["types"].len(), picture.cells.len());
        let end = as_i64(&arrays["offsets"]).last().copied().unwrap_or(0);
        assert_eq!(end, connectivity.len() as i64);

        let xml = String::from_utf8(file).expect("UTF-8");
        assert!(xml.contains(&format!("NumberOfPoints=\"{}\"", picture.points.len())));
        assert!(
            xml.contains("<!-- a - - b -->"),
            "two hyphens end a comment"
        );
        assert!(
            !xml.contains("type=\"String\""),
            "meshio ends the process on those"
        );
    }
}

#[test]
fn large_arrays_span_several_blocks() {
    let mut picture = Picture {
        dim: 2,
        ..Picture::default()
    };
    picture.points = (0..4096).map(|i| [f64::from(i), 0.5, -1.0]).collect();
    let arrays = decoded(&vtu::vtu(&picture, 0.0, "").expect("a file"));
    let points: Vec<f64> = picture.points.iter().flatten().copied().collect();
    assert_eq!(as_f64(&arrays["Points"]), points);
    assert_eq!(
        arrays["Points"].len(),
        3 * 32768,
        "whole blocks only, the case without a partial one"
    );
}

#[test]
fn vtu_refuses_arrays_that_do_not_fit() {
    let mut short = plate();
    short.point_scalars[0].1.pop();
    let error = vtu::vtu(&short, 0.0, "").expect_err("a value is missing");
    assert!(
        error
            .to_string()
            .contains("`side`: 539 values for 540 points"),
        "{error}"
    );
    let mut far = plate();
    far.cells[7].points[0] = 9999;
    assert!(vtu::vtu(&far, 0.0, "").is_err());
    let mut wrong = plate();
    wrong.cells[0].shape = PictureShape::Hexahedron;
    assert!(vtu::vtu(&wrong, 0.0, "").is_err());
}

#[test]
fn collections_name_files_that_exist() {
    let results = results();
    let bundle = standard::bundle(&results, &Provenance::collect(1)).expect("a bundle");
    let pvd = bundle
        .paths()
        .find(|path| path.ends_with(".pvd"))
        .expect("a collection")
        .to_owned();
    let xml = text(&bundle, &pvd);
    let files: Vec<&str> = xml
        .split("file=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    assert_eq!(files.len(), 4, "body and crack at two times");
    for file in files {
        assert!(bundle.get(&format!("fields/{file}")).is_some(), "{file}");
    }
    assert!(xml.contains("timestep=\"0.5\" part=\"1\""));
}

#[test]
fn one_command_writes_all_kinds_and_twice_the_same() {
    let (first, second) = (temporary(), temporary());
    for dir in [&first, &second] {
        standard::write(dir.path(), &results(), &Provenance::collect(2)).expect("written");
    }
    let files = files_below(first.path());
    assert_eq!(files, files_below(second.path()));
    for file in &files {
        let read = |dir: &tempfile::TempDir| fs::read(dir.path().join(file)).expect("a file");
        assert_eq!(read(&first), read(&second), "{file}");
    }
    let of = |end: &str| files.iter().filter(|file| file.ends_with(end)).count();
    // Three friction values with all methods, and four methods with all friction values.
    assert_eq!(
        [of(".residual.svg"), of(".traction.svg"), of(".slip.svg")],
        [3, 7, 7]
    );
    assert_eq!([of(".displacement.svg"), of(".vtu"), of(".pvd")], [1, 4, 1]);
    assert_eq!(
        [of(".csv"), of(".md"), of(".tex"), of("provenance.toml")],
        [5, 2, 2, 1]
    );
}

#[test]
fn wrong_answers_have_no_profile_and_no_time() {
    let mut results = results();
    for row in results
        .runs
        .iter_mut()
        .filter(|row| row.key.method == "latin")
    {
        row.verdict = "false-claim".into();
    }
    let bundle = standard::bundle(&results, &Provenance::collect(1)).expect("a bundle");
    let profile = text(
        &bundle,
        "figures/plate_mesh1.22x22.edge-pairs.mu-0.1.crack-1.slip.svg",
    );
    assert!(profile.contains("b-newton") && !profile.contains("latin"));
    let history = text(
        &bundle,
        "figures/plate_mesh1.22x22.edge-pairs.mu-0.1.residual.svg",
    );
    assert!(
        history.contains("latin"),
        "a failure is shown where it is one"
    );
    let runs = text(&bundle, "runs.md");
    assert!(
        runs.lines()
            .filter(|line| line.contains("false-claim"))
            .all(|line| line.ends_with("| – |"))
    );
    assert_eq!(runs.matches("| – |").count(), 3);
}

#[test]
fn provenance_is_in_its_own_file_only() {
    let provenance = Provenance::collect(3).with_option("tier", "high");
    let bundle = standard::bundle(&results(), &provenance).expect("a bundle");
    let parsed: toml::Table = text(&bundle, "provenance.toml").parse().expect("TOML");
    assert_eq!(parsed["version"].as_str(), Some(env!("CARGO_PKG_VERSION")));
    assert_eq!(parsed["threads"].as_integer(), Some(3));
    assert_eq!(parsed["options"]["tier"].as_str(), Some("high"));
    for name in ["commit", "dirty", "rustc", "target", "profile", "os", "cpu"] {
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
fn folders_that_cannot_be_written_are_named_before_anything_is_computed() {
    let dir = temporary();
    let file = dir.path().join("file");
    fs::write(&file, "in the way").expect("a file");
    for target in [file.clone(), file.join("below")] {
        let error = prepare_output(&target).expect_err("a file is no folder");
        assert!(
            error.to_string().contains(&target.display().to_string()),
            "{error}"
        );
        let error = csv::write_all(&target, &results()).expect_err("a file is no folder");
        assert!(matches!(error, ReportError::Io { .. }), "{error}");
    }
    assert_eq!(fs::read_to_string(&file).expect("the file"), "in the way");
    let fresh = dir.path().join("a/b");
    prepare_output(&fresh).expect("a new folder");
    assert_eq!(
        files_below(&fresh),
        Vec::<String>::new(),
        "the probe is gone"
    );
}

#[test]
fn a_failure_leaves_the_folder_as_it_was() {
    let dir = temporary();
    fs::write(dir.path().join("history.csv"), "old").expect("an old file");
    // The last of the five names is taken by a folder, the write fails after others were put in place.
    fs::create_dir_all(dir.path().join("runs.csv/inside")).expect("a folder in the way");
    let before = files_below(dir.path());
    let error = csv::write_all(dir.path(), &results()).expect_err("runs.csv is a folder");
    assert!(error.to_string().contains("runs.csv"), "{error}");
    assert_eq!(files_below(dir.path()), before);
    assert_eq!(
        fs::read_to_string(dir.path().join("history.csv")).expect("the file"),
        "old"
    );
    assert!(
        !dir.path().join("points.csv").exists(),
        "half the files would be a lie"
    );
}

#[test]
fn success_replaces_old_files_and_leaves_no_traces() {
    let dir = temporary();
    fs::write(dir.path().join("runs.csv"), "old").expect("an old file");
    fs::write(dir.path().join("mine.txt"), "mine").expect("another file");
    csv::write_all(dir.path(), &results()).expect("written");
    let names = files_below(dir.path());
    let expected = [
        "expectations.csv",
        "history.csv",
        "mine.txt",
        "points.csv",
        "quantities.csv",
        "runs.csv",
    ];
    assert_eq!(names, expected);
    assert!(
        fs::read_to_string(dir.path().join("runs.csv"))
            .expect("a file")
            .starts_with("case,mesh,")
    );
}

#[test]
fn bundles_refuse_names_outside_and_names_taken() {
    let mut bundle = Bundle::new();
    for path in ["../up.csv", "/etc/passwd", "", "a/../../b"] {
        assert!(
            matches!(
                bundle.add(path, "x"),
                Err(ReportError::OutsideFolder { .. })
            ),
            "{path}"
        );
    }
    bundle.add("a.csv", "x").expect("a name");
    assert!(matches!(
        bundle.add("a.csv", "y"),
        Err(ReportError::Duplicate { .. })
    ));
}

#[test]
fn file_names_hold_no_separators() {
    let mut odd = key(METHODS[0], 0.1);
    (odd.space, odd.method) = ("edge-pairs/gauss-6".into(), "penalty[k=1e12, μ]".into());
    let stem = standard::stem(&odd);
    assert_eq!(
        stem,
        "plate_mesh1.22x22.edge-pairs-gauss-6.penalty-k=1e12----.mu-0.1"
    );
}

fn files_below(dir: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut open = vec![dir.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path.clone());
            }
            let name = path.strip_prefix(dir).expect("below").display().to_string();
            if path.is_file() {
                found.push(name);
            }
        }
    }
    found.sort();
    found
}
