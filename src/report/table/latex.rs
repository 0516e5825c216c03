//! The LaTeX form of a table: `booktabs` rules, numbers in `siunitx` columns.
//!
//! Numbers without powers of ten stand in `S` columns whose `table-format` is that of their cells, so decimal points stand
//! below each other; a column with powers of ten is set by `\num`. What fits on a page is a float that `adjustbox` shrinks
//! to the width of the text where needed; what is longer is a `longtable` in small type on turned pages. The comment in the
//! first line names the packages.

use super::{Align, Heading, Readable};

/// Rows that fit on a page beside the caption.
const PAGE_ROWS: usize = 45;

/// How the cells of a column are set.
enum Set {
    /// As text.
    Text,
    /// As numbers with so many digits before and behind the point, and a sign.
    Aligned(usize, usize, bool),
    /// As numbers with powers of ten.
    Powers,
}

impl Readable {
    /// A `table` float, or a `longtable` where it would not fit on a page; `label` is the target of `\ref`.
    pub fn latex(&self, label: &str) -> String {
        let sets: Vec<Set> = (0..self.columns.len()).map(|k| self.set(k)).collect();
        let specs = self.columns.iter().zip(&sets);
        let specs: String = specs
            .map(|(c, set)| format!("    {}\n", spec(c, set)))
            .collect();
        let heading = self.columns.iter().zip(&sets).map(|(column, set)| {
            let text = escape_latex(&column.name);
            let text = match column.unit.as_str() {
                "" => text,
                unit => format!("{text} {{[}}{}]", latex_unit(unit)),
            };
            match set {
                Set::Aligned(..) => format!("{{{text}}}"),
                _ => text,
            }
        });
        let heading = line(heading);
        let body =
            |row: &Vec<String>| line(row.iter().zip(&sets).map(|(text, set)| cell(text, set)));
        let body: String = self.rows.iter().map(body).collect();
        let title = escape_latex(&self.title);
        if self.rows.len() > PAGE_ROWS {
            // The heading comes again on every page.
            return format!(
                "% needs \\usepackage{{booktabs,longtable,pdflscape,siunitx}}\n\\begin{{landscape}}\n\\begingroup\n\
                 \\scriptsize\\setlength{{\\tabcolsep}}{{3pt}}\\setlength{{\\LTcapwidth}}{{\\linewidth}}\n\\begin{{longtable}}{{\n{specs}  }}\n  \
                 \\caption{{{title}}}\n  \\label{{{label}}}\\\\\n    \\toprule\n{heading}    \\midrule\n    \\endfirsthead\n    \\toprule\n\
                 {heading}    \\midrule\n    \\endhead\n    \\bottomrule\n    \\endfoot\n{body}\\end{{longtable}}\n\\endgroup\n\\end{{landscape}}\n"
            );
        }
        format!(
            "% needs \\usepackage{{adjustbox,booktabs,siunitx}}\n\\begin{{table}}\n  \\centering\n  \\caption{{{title}}}\n  \\label{{{label}}}\n  \
             \\begin{{adjustbox}}{{max width=\\linewidth}}\n  \\begin{{tabular}}{{\n{specs}  }}\n    \\toprule\n{heading}    \\midrule\n{body}    \
             \\bottomrule\n  \\end{{tabular}}\n  \\end{{adjustbox}}\n\\end{{table}}\n"
        )
    }

    fn set(&self, column: usize) -> Set {
        let cells = self.rows.iter().map(|row| row[column].as_str());
        let numbers: Vec<&str> = cells.filter(|cell| is_number(cell)).collect();
        if self.columns[column].align == Align::Left || numbers.is_empty() {
            return Set::Text;
        }
        if numbers.iter().any(|number| number.contains('e')) {
            return Set::Powers;
        }
        let parts = |number: &&str| {
            let size = number.trim_start_matches('-');
            let (whole, decimals) = size.split_once('.').unwrap_or((size, ""));
            [whole.len(), decimals.len()]
        };
        let most = |k: usize| numbers.iter().map(|n| parts(n)[k]).max().unwrap_or(0);
        let negative = numbers.iter().any(|number| number.starts_with('-'));
        Set::Aligned(most(0), most(1), negative)
    }
}

fn is_number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok_and(f64::is_finite)
}

/// The letter of a column.
fn spec(column: &Heading, set: &Set) -> String {
    match (set, column.align) {
        (Set::Aligned(whole, decimals, negative), _) => {
            let sign = if *negative { "-" } else { "" };
            format!("S[table-format={sign}{whole}.{decimals}]")
        }
        (Set::Text, Align::Left) => "l".into(),
        _ => "r".into(),
    }
}

fn cell(text: &str, set: &Set) -> String {
    match set {
        Set::Aligned(..) if is_number(text) => text.to_owned(),
        Set::Aligned(..) if !text.is_empty() => format!("{{{}}}", escape_latex(text)),
        Set::Powers if is_number(text) => format!("\\num{{{text}}}"),
        _ => escape_latex(text),
    }
}

/// A line of the table. A bracket or an asterisk behind the `\\` of the line before would be taken for its argument.
fn line(cells: impl Iterator<Item = String>) -> String {
    let line = cells.collect::<Vec<_>>().join(" & ");
    let guard = if line.starts_with(['[', '*']) {
        "{}"
    } else {
        ""
    };
    format!("    {guard}{line} \\\\\n")
}

/// A unit as it is written in the reports, e.g. `MN/m` or `N/m²`.
fn latex_unit(unit: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/²³".contains(c);
    match unit {
        "%" => "\\unit{\\percent}".into(),
        _ if unit.chars().all(plain) => {
            let literal = unit.replace('²', "^2").replace('³', "^3");
            format!("\\unit{{{literal}}}")
        }
        _ => escape_latex(unit),
    }
}

/// Text for LaTeX: special characters escaped, the non-ASCII characters used in reports as commands.
fn escape_latex(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => out.extend(['\\', c]),
            '\\' => out += "\\textbackslash{}",
            '~' => out += "\\textasciitilde{}",
            '^' => out += "\\textasciicircum{}",
            '<' | '>' | '|' => out += &format!("${c}$"),
            '\n' => out.push(' '),
            _ => match symbol(c) {
                Some(command) => out += command,
                None => out.push(c),
            },
        }
    }
    out
}

/// The command of a character that pdflatex does not know by itself.
fn symbol(c: char) -> Option<&'static str> {
    Some(match c {
        'α' => "$\\alpha$",
        'β' => "$\\beta$",
        'γ' => "$\\gamma$",
        'δ' => "$\\delta$",
        'ε' => "$\\varepsilon$",
        'θ' => "$\\theta$",
        'κ' => "$\\kappa$",
        'λ' => "$\\lambda$",
        'μ' | 'µ' => "$\\mu$",
        'ν' => "$\\nu$",
        'ρ' => "$\\rho$",
        'σ' => "$\\sigma$",
        'τ' => "$\\tau$",
        'φ' => "$\\varphi$",
        'Δ' => "$\\Delta$",
        '→' => "$\\to$",
        '×' => "$\\times$",
        '−' => "$-$",
        '·' => "$\\cdot$",
        '±' => "$\\pm$",
        '°' => "$^\\circ$",
        '²' => "$^2$",
        '³' => "$^3$",
        '≤' => "$\\le$",
        '≥' => "$\\ge$",
        '∞' => "$\\infty$",
        '√' => "$\\surd$",
        '–' => "--",
        '—' => "---",
        '…' => "\\ldots{}",
        _ => return None,
    })
}
