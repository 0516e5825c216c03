//! The LaTeX tables: what TeX would choke on is escaped, numbers stand in siunitx columns that hold them, wide tables fit.
//!
//! TeX itself is not needed here: `scripts/compile-tables.sh` compiles the tables of a report folder.

use stickslip::report::tables::{Align, Column, Table};

fn table(title: &str, columns: Vec<Column>, rows: &[&[&str]]) -> String {
    let mut table = Table::new(title, columns);
    for row in rows {
        let cells = row.iter().map(|cell| (*cell).to_owned()).collect();
        table.push(cells).expect("a row");
    }
    table.latex("tab:x")
}

/// The column of these numbers and texts, and its cells as written.
fn column(align: Align, cells: &[&str]) -> (String, Vec<String>) {
    let rows: Vec<&[&str]> = cells.chunks(1).collect();
    let latex = table("t", vec![Column::new("v", "", align)], &rows);
    let mut lines = latex.lines().map(str::trim);
    let spec = lines
        .by_ref()
        .skip_while(|line| !line.starts_with("\\begin{tabular}"))
        .nth(1);
    let body = latex.split("\\midrule\n").nth(1).expect("a body");
    let body = body.lines().filter_map(|line| line.strip_suffix(" \\\\"));
    (
        spec.expect("a column").to_owned(),
        body.map(|cell| cell.trim().to_owned()).collect(),
    )
}

#[test]
fn latex_escapes_what_would_break_it() {
    let latex = table(
        "A_b % of #1 & {c} ~ ^ \\ μ ≤ 1",
        vec![
            Column::new("x_y", "N/m²", Align::Left),
            Column::new("v", "", Align::Decimal),
        ],
        &[
            &["p_n & 50 % #2 $3", "-1.5e-7"],
            &["plain", "NaN"],
            &["[a]", "*"],
        ],
    );
    assert!(latex.contains(
        r"\caption{A\_b \% of \#1 \& \{c\} \textasciitilde{} \textasciicircum{} \textbackslash{} $\mu$ $\le$ 1}"
    ));
    assert!(
        latex.contains(r"p\_n \& 50 \% \#2 \$3 & -1.5e-7 \\"),
        "{latex}"
    );
    assert!(latex.contains(r"plain & {NaN} \\"), "{latex}");
    assert!(
        latex.contains(r"    {}[a] & {*} \\"),
        "a bracket behind a line end is its argument: {latex}"
    );
    assert!(latex.contains(r"{[}\unit{N/m^2}]"), "{latex}");
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
    let mut rows = latex.lines().filter(|line| line.ends_with(" \\\\"));
    assert!(rows.all(|line| separators(line) == 1), "{latex}");
}

/// The expected formats are counted by hand from the cells: digits before and behind the point, of the exponent, signs.
#[test]
fn the_format_of_a_column_holds_its_longest_number() {
    for (cells, format) in [
        (&["973.3", "1107.263"][..], "4.3"),
        (&["12", "-345"], "-3"),
        (&["0.5", "NaN", "–", ""], "1.1"),
        (&["2.5e-4", "-1.25e-11", "0"], "-1.2e-2"),
        (&["1e10", "2e9"], "1e2"),
    ] {
        let (spec, written) = column(Align::Right, cells);
        assert_eq!(spec, format!("S[table-format={format}]"), "{cells:?}");
        assert_eq!(written.len(), cells.len());
    }
}

#[test]
fn what_is_no_number_stands_in_braces_in_a_column_of_numbers() {
    let (_, written) = column(
        Align::Decimal,
        &["1.5", "NaN", "inf", "–", "not solved", ""],
    );
    assert_eq!(
        written,
        ["1.5", "{NaN}", "{inf}", "{--}", "{not solved}", ""]
    );
    // Without any number there is nothing to align.
    assert_eq!(
        column(Align::Right, &["22x22", "4x4"]),
        ("r".into(), vec!["22x22".into(), "4x4".into()])
    );
    // Labels stay labels.
    assert_eq!(
        column(Align::Left, &["0.20", "none"]),
        ("l".into(), vec!["0.20".into(), "none".into()])
    );
}

/// Where one number has a power of ten all get one; the values stay what they are.
#[test]
fn powers_of_ten_are_all_or_none_in_a_column() {
    let cells = [
        "4.3e-6", "0.00013", "0.5", "1.65", "147000", "-20.50", "0", "0.00",
    ];
    let (spec, written) = column(Align::Right, &cells);
    assert_eq!(spec, "S[table-format=-1.3e-1]");
    assert_eq!(
        written,
        [
            "4.3e-6", "1.3e-4", "5e-1", "1.65", "1.47e5", "-2.050e1", "0", "0"
        ]
    );
    for (cell, written) in cells.iter().zip(&written) {
        let (a, b): (f64, f64) = (cell.parse().expect("a"), written.parse().expect("b"));
        assert!((a - b).abs() <= 1e-15 * a.abs(), "{cell}: {written}");
    }
}

#[test]
fn numbers_of_very_different_sizes_are_not_aligned_at_their_points() {
    let (spec, written) = column(Align::Right, &["-973539550", "-0.0013637805"]);
    assert_eq!(
        spec,
        "S[table-alignment-mode=none,table-number-alignment=right]"
    );
    assert_eq!(written, ["-973539550", "-0.0013637805"]);
}

#[test]
fn long_and_wide_tables_name_the_packages_they_need() {
    let narrow = || vec![Column::new("a", "", Align::Decimal)];
    let short = table("t", narrow(), &[&["1"][..]; 40]);
    assert!(short.starts_with("% needs \\usepackage{booktabs,siunitx}\n\\begin{table}\n"));
    let long = table("t", narrow(), &[&["1"][..]; 41]);
    assert!(long.starts_with("% needs \\usepackage{booktabs,siunitx,longtable}\n"));
    assert!(
        long.contains("\\endfirsthead") && long.matches("\\caption").count() == 1,
        "the caption stands on the first page only: {long}"
    );

    // Wider than a page: 12 columns of 20 digits.
    let columns: Vec<Column> = (0..12)
        .map(|_| Column::new("a", "", Align::Decimal))
        .collect();
    let wide = table("t", columns, &[&["0.12345678901234567890"; 12]]);
    let packages =
        "% needs \\usepackage{booktabs,siunitx,longtable,pdflscape}\n\\begin{landscape}\n";
    assert!(wide.starts_with(packages), "{wide}");
    assert!(wide.ends_with("\\end{landscape}\n") && wide.contains("\\scriptsize"));
}

#[test]
fn headings_longer_than_their_column_are_broken_but_equations_stay_whole() {
    let columns = vec![
        Column::new("natural map, largest", "", Align::Right),
        Column::new("μ = 0.1", "%", Align::Decimal),
        Column::new("long texts of a method", "", Align::Left),
    ];
    let latex = table(
        "t",
        columns,
        &[&["3", "99.5", "a text that is long as well"]],
    );
    assert!(
        latex.contains("{\\begin{tabular}[b]{@{}c@{}}natural\\\\map,\\\\largest\\end{tabular}} & "),
        "{latex}"
    );
    assert!(
        latex.contains(
            "{\\begin{tabular}[b]{@{}c@{}}$\\mu$ = 0.1\\\\{[}\\unit{\\percent}]\\end{tabular}} & "
        ),
        "{latex}"
    );
    assert!(latex.contains(" & long texts of a method \\\\"), "{latex}");
}
