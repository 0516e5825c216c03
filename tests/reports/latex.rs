//! The LaTeX tables: what TeX would choke on is escaped, numbers stand in siunitx columns that hold them, wide tables fit.
//!
//! TeX itself is not needed here: `scripts/compile-tables.sh` compiles the tables of a report folder.

use stickslip::report::table::{Align, Heading, Readable};

fn heading(name: &str, unit: &str, align: Align) -> Heading {
    Heading {
        name: name.into(),
        unit: unit.into(),
        align,
    }
}

fn latex(title: &str, columns: Vec<Heading>, rows: &[&[&str]]) -> String {
    let cells = |row: &&[&str]| row.iter().map(|cell| (*cell).to_owned()).collect();
    let table = Readable {
        title: title.into(),
        columns,
        rows: rows.iter().map(cells).collect(),
    };
    table.latex("tab:x")
}

/// The column of these numbers and texts, and its cells as written.
fn column(align: Align, cells: &[&str]) -> (String, Vec<String>) {
    let rows: Vec<&[&str]> = cells.chunks(1).collect();
    let latex = latex("t", vec![heading("v", "", align)], &rows);
    let mut lines = latex.lines().map(str::trim);
    assert!(lines.any(|line| line.starts_with("\\begin{tabular}")));
    let spec = lines.next().expect("a column").to_owned();
    let body = latex.split("\\midrule\n").nth(1).expect("a body");
    let body = body.lines().filter_map(|line| line.strip_suffix(" \\\\"));
    (spec, body.map(|cell| cell.trim().to_owned()).collect())
}

#[test]
fn latex_escapes_what_would_break_it() {
    let columns = vec![
        heading("x_y", "N/m²", Align::Left),
        heading("v", "", Align::Decimal),
    ];
    let latex = latex(
        "A_b % of #1 & {c} ~ ^ \\ μ ≤ 1",
        columns,
        &[
            &["p_n & 50 % #2 $3", "-1.5"],
            &["plain", "NaN"],
            &["[a]", "*"],
        ],
    );
    for part in [
        r"\caption{A\_b \% of \#1 \& \{c\} \textasciitilde{} \textasciicircum{} \textbackslash{} $\mu$ $\le$ 1}",
        r"p\_n \& 50 \% \#2 \$3 & -1.5 \\",
        r"plain & {NaN} \\",
        // A bracket behind a line end is its argument.
        r"    {}[a] & {*} \\",
        r"{[}\unit{N/m^2}]",
    ] {
        assert!(latex.contains(part), "{part}: {latex}");
    }
    assert!(
        latex.is_ascii(),
        "pdflatex knows no other characters without packages"
    );
    let body: String = latex
        .lines()
        .filter(|line| !line.starts_with('%'))
        .collect();
    let unescaped = body.replace("\\{", "").replace("\\}", "");
    let count = |part: &str| unescaped.matches(part).count();
    assert_eq!(count("{"), count("}"));
    assert_eq!(count("\\begin"), count("\\end"));
    for rule in ["\\toprule", "\\midrule", "\\bottomrule"] {
        assert_eq!(count(rule), 1);
    }
    // One separator per row that is not escaped.
    let separators = |line: &str| line.replace("\\&", "").matches('&').count();
    let mut rows = latex.lines().filter(|line| line.ends_with(" \\\\"));
    assert!(rows.all(|line| separators(line) == 1), "{latex}");
}

/// The expected formats are counted by hand from the cells: digits before and behind the point, signs.
#[test]
fn the_format_of_a_column_holds_its_longest_number() {
    for (cells, spec, written) in [
        (
            &["973.3", "1107.263"][..],
            "S[table-format=4.3]",
            &["973.3", "1107.263"][..],
        ),
        (&["12", "-345"], "S[table-format=-3.0]", &["12", "-345"]),
        (
            &["0.5", "NaN", "–", "not solved", ""],
            "S[table-format=1.1]",
            &["0.5", "{NaN}", "{--}", "{not solved}", ""],
        ),
        // Where one number has a power of ten there is no common point.
        (
            &["2.5e-4", "0", "–"],
            "r",
            &["\\num{2.5e-4}", "\\num{0}", "--"],
        ),
        // Without any number there is nothing to align.
        (&["22x22", "4x4"], "r", &["22x22", "4x4"]),
    ] {
        let (found, cells) = column(Align::Right, cells);
        assert_eq!(found, spec);
        assert_eq!(cells, written);
    }
    // Labels stay labels.
    let labels = column(Align::Left, &["0.20", "none"]);
    assert_eq!(labels, ("l".into(), vec!["0.20".into(), "none".into()]));
}

#[test]
fn short_tables_shrink_to_the_page_and_long_ones_go_over_several() {
    let columns = || vec![heading("a", "", Align::Decimal)];
    let short = latex("t", columns(), &[&["1"][..]; 45]);
    assert!(
        short.starts_with("% needs \\usepackage{adjustbox,booktabs,siunitx}\n\\begin{table}\n")
    );
    assert!(short.contains("{max width=\\linewidth}"));
    let long = latex("t", columns(), &[&["1"][..]; 46]);
    assert!(long.starts_with(
        "% needs \\usepackage{booktabs,longtable,pdflscape,siunitx}\n\\begin{landscape}"
    ));
    assert!(
        long.contains("\\endfirsthead") && long.matches("\\caption").count() == 1,
        "the caption stands on the first page only: {long}"
    );
}
