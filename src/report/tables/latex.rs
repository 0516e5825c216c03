//! The LaTeX form of a table: `booktabs` rules, numbers in `siunitx` columns, text in braces beside them.
//!
//! Columns of numbers are `S` columns whose `table-format` is that of their own cells, so decimal points stand below each
//! other. Where one cell has a power of ten, all of its column get one. A table that is too wide for an A4 page with
//! margins of 25 mm gets smaller type first, is turned then, and breaks its longest texts at last; one that is too long is
//! broken between rows. The comment in the first line names the packages.

use super::{Align, Column, Table};

/// Rows that fit on a page beside the caption.
const PAGE_ROWS: usize = 40;

/// Where texts of a column are broken, first choice first: longest line that is not, characters per line of what is.
const WRAPS: [Wrap; 4] = [
    Wrap { line: 38, room: 30 },
    Wrap { line: 22, room: 22 },
    Wrap { line: 16, room: 16 },
    Wrap { line: 12, room: 12 },
];

/// Width, in digits, that aligning numbers at their points may cost.
const WASTE: f64 = 7.0;

/// Width of a digit in em.
const DIGIT_EM: f64 = 0.5;

#[derive(Debug, Clone, Copy)]
struct Wrap {
    line: usize,
    room: usize,
}

/// Type size and page: command, its width beside the normal one (small type is wider for its height), gap left and right of a column [pt], turned or not.
struct Layout {
    size: &'static str,
    scale: f64,
    gap: f64,
    turned: bool,
}

const LAYOUTS: [Layout; 6] = [
    layout("\\normalsize", 1.0, 6.0, false),
    layout("\\small", 0.925, 5.0, false),
    layout("\\footnotesize", 0.85, 4.0, false),
    layout("\\small", 0.925, 5.0, true),
    layout("\\footnotesize", 0.85, 4.0, true),
    layout("\\scriptsize", 0.8, 3.0, true),
];

const fn layout(size: &'static str, scale: f64, gap: f64, turned: bool) -> Layout {
    Layout {
        size,
        scale,
        gap,
        turned,
    }
}

impl Layout {
    /// Width of the text [pt]: A4, margins of 25 mm, normal size 10 pt.
    fn page(&self) -> f64 {
        if self.turned { 702.8 } else { 455.2 }
    }

    fn holds(&self, specs: &[Spec]) -> bool {
        let text: f64 = specs.iter().map(|s| s.width).sum();
        let gaps = 2.0 * self.gap * specs.len() as f64;
        10.0 * DIGIT_EM * self.scale * text + gaps <= self.page()
    }
}

/// How one column is set.
struct Spec {
    /// Its letter with options, e.g. `S[table-format=3.2]`.
    text: String,
    /// Whether numbers are parsed: everything else needs braces.
    parsed: bool,
    /// Whether numbers are written with a power of ten.
    scientific: bool,
    /// Width in digits.
    width: f64,
    /// Heading, in lines.
    heading: Vec<String>,
}

impl Table {
    /// A `table` float; a `longtable` where it would not fit on a page, on turned pages where it is too wide. `label` is
    /// the target of `\ref`.
    pub fn latex(&self, label: &str) -> String {
        let (layout, specs) = self.fit();
        let long = layout.turned || self.rows.len() > PAGE_ROWS;

        let mut packages = vec!["booktabs", "siunitx"];
        packages.extend(long.then_some("longtable"));
        packages.extend(layout.turned.then_some("pdflscape"));
        let title = escape_latex(&self.title);
        let columns: String = specs.iter().map(|s| format!("    {}\n", s.text)).collect();
        let heading = row_of(specs.iter().map(Spec::heading_cell));
        let body: String = self
            .rows
            .iter()
            .map(|row| row_of(row.iter().zip(&specs).map(|(cell, spec)| spec.cell(cell))))
            .collect();
        let size = format!(
            "{}\\setlength{{\\tabcolsep}}{{{}pt}}",
            layout.size, layout.gap
        );
        let full_width = "\\setlength{\\LTcapwidth}{\\linewidth}";

        let mut text = format!("% needs \\usepackage{{{}}}\n", packages.join(","));
        if layout.turned {
            text += "\\begin{landscape}\n";
        }
        if long {
            // The heading comes again on every page.
            text += &format!(
                "\\begingroup\n{size}{full_width}\n\\begin{{longtable}}{{\n{columns}  }}\n  \\caption{{{title}}}\n  \\label{{{label}}}\\\\\n    \
                 \\toprule\n{heading}    \\midrule\n    \\endfirsthead\n    \\toprule\n{heading}    \\midrule\n    \\endhead\n    \
                 \\bottomrule\n    \\endfoot\n{body}\\end{{longtable}}\n\\endgroup\n"
            );
        } else {
            text += &format!(
                "\\begin{{table}}\n  \\centering\n  {size}\\setlength{{\\belowcaptionskip}}{{6pt}}\n  \\caption{{{title}}}\n  \\label{{{label}}}\n  \
                 \\begin{{tabular}}{{\n{columns}  }}\n    \\toprule\n{heading}    \\midrule\n{body}    \\bottomrule\n  \
                 \\end{{tabular}}\n\\end{{table}}\n"
            );
        }
        if layout.turned {
            text += "\\end{landscape}\n";
        }
        text
    }

    /// The first layout that holds the columns; where none does, the smallest with ever more breaks.
    fn fit(&self) -> (&'static Layout, Vec<Spec>) {
        let specs = |wrap: Wrap| {
            (0..self.columns.len())
                .map(|k| self.spec(k, wrap))
                .collect()
        };
        let mut found: Vec<Spec> = specs(WRAPS[0]);
        if let Some(layout) = LAYOUTS.iter().find(|layout| layout.holds(&found)) {
            return (layout, found);
        }
        let smallest = &LAYOUTS[LAYOUTS.len() - 1];
        for wrap in &WRAPS[1..] {
            found = specs(*wrap);
            if smallest.holds(&found) {
                break;
            }
        }
        (smallest, found)
    }

    fn spec(&self, column: usize, wrap: Wrap) -> Spec {
        let cells = || self.rows.iter().map(|row| row[column].as_str());
        let longest = cells().map(|cell| cell.chars().count()).max().unwrap_or(0);
        let head = &self.columns[column];
        let exponents = |cell: &str| Digits::of(cell).is_some_and(|digits| digits.exponent > 0);
        let scientific = head.align != Align::Left && cells().any(exponents);
        let numbers: Vec<Digits> = match scientific {
            true => cells()
                .filter_map(|cell| Digits::of(&scientific_form(cell)?))
                .collect(),
            false => cells().filter_map(Digits::of).collect(),
        };
        let (text, width) = if head.align != Align::Left && !numbers.is_empty() {
            let all = numbers.iter().fold(Digits::default(), Digits::join);
            let natural = numbers.iter().map(Digits::width).fold(0.0, f64::max);
            // Numbers of very different sizes: a common decimal point would only waste the width.
            if all.width() > natural + WASTE {
                let text = "S[table-alignment-mode=none,table-number-alignment=right]";
                (text.to_owned(), natural)
            } else {
                let text = format!("S[table-format={}]", all.format());
                (text, all.width())
            }
        } else if longest > wrap.line {
            let em = DIGIT_EM * wrap.room as f64;
            let text = format!(">{{\\raggedright\\arraybackslash}}p{{{em}em}}");
            (text, wrap.room as f64)
        } else {
            let letter = if head.align == Align::Left { "l" } else { "r" };
            (letter.to_owned(), longest as f64)
        };
        let parsed = text.starts_with('S');
        let words = cells().filter(|cell| parsed && Digits::of(cell).is_none());
        let words = words.map(|cell| cell.chars().count()).max().unwrap_or(0);
        let width = width.max(words as f64);
        let (heading, broad) = heading_lines(head, width);
        Spec {
            text,
            parsed,
            scientific,
            width: width.max(broad),
            heading,
        }
    }
}

impl Spec {
    fn heading_cell(&self) -> String {
        let text = match self.heading.as_slice() {
            [line] => line.clone(),
            lines => {
                let letter = match (self.parsed, self.text.starts_with('r')) {
                    (true, _) => 'c',
                    (_, true) => 'r',
                    _ => 'l',
                };
                let lines = lines.join("\\\\");
                format!("\\begin{{tabular}}[b]{{@{{}}{letter}@{{}}}}{lines}\\end{{tabular}}")
            }
        };
        if self.parsed {
            format!("{{{text}}}")
        } else {
            text
        }
    }

    fn cell(&self, cell: &str) -> String {
        match (self.parsed, Digits::of(cell)) {
            (true, Some(_)) if self.scientific => {
                scientific_form(cell).unwrap_or_else(|| cell.to_owned())
            }
            (true, Some(_)) => cell.to_owned(),
            (true, None) if !cell.is_empty() => format!("{{{}}}", escape_latex(cell)),
            // Names have no spaces to break at.
            _ if self.text.starts_with('>') => {
                escape_latex(cell).replace("\\_", "\\_\\allowbreak{}")
            }
            _ => escape_latex(cell),
        }
    }
}

/// A line of the table. A bracket or an asterisk behind the `\\` of the line before would be taken for its argument.
fn row_of(cells: impl Iterator<Item = String>) -> String {
    let line = cells.collect::<Vec<_>>().join(" & ");
    let guard = if line.starts_with(['[', '*']) {
        "{}"
    } else {
        ""
    };
    format!("    {guard}{line} \\\\\n")
}

/// The heading broken between words where it is longer than the cells, and the length of its longest line.
fn heading_lines(column: &Column, width: f64) -> (Vec<String>, f64) {
    let mut names: Vec<String> = Vec::new();
    for word in column.name.split(' ').filter(|word| !word.is_empty()) {
        // Equations and brackets stay whole.
        let open = |name: &String| {
            name.ends_with('=') || name.matches('(').count() > name.matches(')').count()
        };
        match names.last_mut() {
            Some(name) if word == "=" || open(name) => *name += &format!(" {word}"),
            _ => names.push(word.to_owned()),
        }
    }
    let names = names.iter();
    let mut words: Vec<(String, usize)> = names
        .map(|name| (escape_latex(name), name.chars().count()))
        .collect();
    if !column.unit.is_empty() {
        let length = column.unit.chars().count() + 2;
        // The braces: a bracket that begins a line would be taken for the argument of the line end before.
        words.push((format!("{{[}}{}]", latex_unit(&column.unit)), length));
    }
    let longest = words.iter().map(|word| word.1).max().unwrap_or(0);
    let room = longest.max(width.round() as usize);
    let mut lines: Vec<(String, usize)> = Vec::new();
    for (word, length) in words {
        match lines.last_mut() {
            Some((line, own)) if *own + 1 + length <= room => {
                *line += &format!(" {word}");
                *own += 1 + length;
            }
            _ => lines.push((word, length)),
        }
    }
    let broad = lines.iter().map(|line| line.1).max().unwrap_or(0);
    let mut lines: Vec<String> = lines.into_iter().map(|line| line.0).collect();
    if lines.is_empty() {
        lines.push(String::new());
    }
    (lines, broad as f64)
}

/// A unit as it is written in the reports, e.g. `MN/m` or `N/m²`.
fn latex_unit(unit: &str) -> String {
    match unit {
        "%" => "\\unit{\\percent}".into(),
        _ if unit
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "/²³".contains(c)) =>
        {
            let literal = unit.replace('²', "^2").replace('³', "^3");
            format!("\\unit{{{literal}}}")
        }
        _ => escape_latex(unit),
    }
}

/// A number with one digit before the point, without a power of ten where that is 0. Zeros at the end are kept behind a
/// point only: in front of it they are place holders.
fn scientific_form(cell: &str) -> Option<String> {
    Digits::of(cell)?;
    let (mantissa, exponent) = cell.split_once(['e', 'E']).unwrap_or((cell, "0"));
    let exponent: i32 = exponent.parse().ok()?;
    let (sign, size) = match mantissa.strip_prefix('-') {
        Some(size) => ("-", size),
        None => ("", mantissa.trim_start_matches('+')),
    };
    let (whole, decimals) = size.split_once('.').unwrap_or((size, ""));
    let digits = format!("{whole}{decimals}");
    let first = digits.find(|c| c != '0');
    let Some(first) = first else {
        return Some("0".into());
    };
    let kept = match size.contains('.') {
        true => &digits[first..],
        false => digits[first..].trim_end_matches('0'),
    };
    let exponent = exponent + whole.len() as i32 - 1 - first as i32;
    let (head, tail) = kept.split_at(1);
    let point = if tail.is_empty() { "" } else { "." };
    let power = match exponent {
        0 => String::new(),
        _ => format!("e{exponent}"),
    };
    Some(format!("{sign}{head}{point}{tail}{power}"))
}

/// Digits of a number as it is written: before and behind the point, in the exponent; signs.
#[derive(Debug, Clone, Copy, Default)]
struct Digits {
    whole: usize,
    decimals: usize,
    exponent: usize,
    negative: bool,
    negative_exponent: bool,
}

impl Digits {
    /// Those of a cell; none of text, of `NaN` and of infinities.
    fn of(cell: &str) -> Option<Self> {
        if !cell.parse::<f64>().is_ok_and(f64::is_finite) {
            return None;
        }
        let (mantissa, exponent) = cell.split_once(['e', 'E']).unwrap_or((cell, ""));
        let (whole, decimals) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let count = |text: &str| text.chars().filter(char::is_ascii_digit).count();
        Some(Self {
            whole: count(whole),
            decimals: count(decimals),
            exponent: count(exponent),
            negative: whole.starts_with('-'),
            negative_exponent: exponent.starts_with('-'),
        })
    }

    fn join(self, other: &Self) -> Self {
        Self {
            whole: self.whole.max(other.whole),
            decimals: self.decimals.max(other.decimals),
            exponent: self.exponent.max(other.exponent),
            negative: self.negative || other.negative,
            negative_exponent: self.negative_exponent || other.negative_exponent,
        }
    }

    /// Value of `table-format`.
    fn format(&self) -> String {
        let mut format = String::new();
        if self.negative {
            format.push('-');
        }
        format += &self.whole.to_string();
        if self.decimals > 0 {
            format += &format!(".{}", self.decimals);
        }
        if self.exponent > 0 {
            let sign = if self.negative_exponent { "-" } else { "" };
            format += &format!("e{sign}{}", self.exponent);
        }
        format
    }

    /// Width in digits: a sign takes 1.5, the point 0.5, a thin space 0.3 per three of five and more digits, the power of
    /// ten 4.5 without its digits, which are small.
    fn width(&self) -> f64 {
        let flag = |on: bool, width: f64| if on { width } else { 0.0 };
        let group = |digits: usize| {
            if digits > 4 {
                0.3 * (digits / 3) as f64
            } else {
                0.0
            }
        };
        let digits = (self.whole + self.decimals) as f64;
        let exponent = 4.5 + 0.8 * self.exponent as f64 + flag(self.negative_exponent, 1.0);
        digits
            + group(self.whole)
            + group(self.decimals)
            + flag(self.negative, 1.5)
            + flag(self.decimals > 0, 0.5)
            + flag(self.exponent > 0, exponent)
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
