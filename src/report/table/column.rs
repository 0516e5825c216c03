//! A column: described once, shown in every form.

use crate::report::number::{self, fixed, significant};
use crate::run::verdict::Verdict;

/// Contents of one cell before it becomes text.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Words.
    Text(String),
    /// A count.
    Whole(u64),
    /// A number with decimals; not-a-number where a run has none.
    Real(f64),
    /// Nothing that could be there: an empty field.
    Empty,
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Text(flag.to_string())
    }
}

impl From<&Verdict> for Value {
    fn from(verdict: &Verdict) -> Self {
        Self::Text(verdict.to_string())
    }
}

impl From<u32> for Value {
    fn from(count: u32) -> Self {
        Self::Whole(count.into())
    }
}

impl From<u64> for Value {
    fn from(count: u64) -> Self {
        Self::Whole(count)
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Self {
        Self::Whole(count as u64)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Real(number)
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, T::into)
    }
}

/// How many digits of a number are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// As a value of a file: ten significant digits.
    Full,
    /// As a residual: two significant digits, rounding errors as 0.
    Residual,
    /// As a time: four significant digits.
    Time,
    /// So many significant digits.
    Significant(usize),
    /// So many decimals.
    Fixed(usize),
    /// So many digits with a power of ten: for numbers of very different sizes.
    Power(usize),
    /// A share in per cent with so many decimals.
    Percent(usize),
}

impl Digits {
    /// The number as text.
    pub fn write(self, x: f64) -> String {
        match self {
            Self::Full => number::value(x),
            Self::Residual => number::residual(x),
            Self::Time => number::time(x),
            Self::Significant(digits) => significant(x, digits),
            Self::Fixed(decimals) if x.is_finite() => fixed(x, decimals),
            Self::Power(_) if x == 0.0 => "0".into(),
            Self::Power(digits) if x.is_finite() => format!("{x:.*e}", digits.saturating_sub(1)),
            Self::Percent(decimals) if x.is_finite() => fixed(100.0 * x, decimals),
            Self::Fixed(_) | Self::Power(_) | Self::Percent(_) => number::value(x),
        }
    }
}

/// A column without any row.
#[derive(Debug, Clone, Copy)]
pub struct About {
    /// Name in the CSV file, the unit at its end.
    pub name: &'static str,
    /// Unit; `–` of numbers without one, empty of what is no measure.
    pub unit: &'static str,
    /// Contents of the column.
    pub meaning: &'static str,
    /// Whether rows are sorted by it, among the columns so marked in their order.
    pub key: bool,
    /// Digits in the CSV file.
    pub digits: Digits,
    /// Whether it stands in the forms for reading too.
    pub shown: bool,
    /// Heading there, where it is not made of the name.
    pub named: Option<&'static str>,
    /// Digits there.
    pub shown_digits: Option<Digits>,
}

impl About {
    /// A column of the CSV file alone.
    pub const fn new(name: &'static str, unit: &'static str, meaning: &'static str) -> Self {
        Self {
            name,
            unit,
            meaning,
            key: false,
            digits: Digits::Full,
            shown: false,
            named: None,
            shown_digits: None,
        }
    }

    /// Rows are sorted by it, and it is shown.
    pub const fn key(mut self) -> Self {
        self.key = true;
        self.shown()
    }

    /// Rows are sorted by it; it is not shown.
    pub const fn hidden_key(mut self) -> Self {
        self.key = true;
        self
    }

    /// It stands in the forms for reading.
    pub const fn shown(mut self) -> Self {
        self.shown = true;
        self
    }

    /// It stands there under this heading.
    pub const fn named(mut self, heading: &'static str) -> Self {
        self.named = Some(heading);
        self.shown()
    }

    /// It stands there with so many decimals.
    pub const fn fixed(mut self, decimals: usize) -> Self {
        self.shown_digits = Some(Digits::Fixed(decimals));
        self.shown()
    }

    /// It stands there with so many significant digits.
    pub const fn digits(mut self, digits: usize) -> Self {
        self.shown_digits = Some(Digits::Significant(digits));
        self.shown()
    }

    /// It stands there with so many digits and a power of ten.
    pub const fn power(mut self, digits: usize) -> Self {
        self.shown_digits = Some(Digits::Power(digits));
        self.shown()
    }

    /// It is a share and stands there in per cent with so many decimals.
    pub const fn percent(mut self, decimals: usize) -> Self {
        self.shown_digits = Some(Digits::Percent(decimals));
        self.shown()
    }

    /// Its file has so many significant digits.
    pub const fn significant(mut self, digits: usize) -> Self {
        self.digits = Digits::Significant(digits);
        self
    }

    /// Its file has so many decimals.
    pub const fn decimals(mut self, decimals: usize) -> Self {
        self.digits = Digits::Fixed(decimals);
        self
    }

    /// It is a residual, rounding errors as 0.
    pub const fn residual(mut self) -> Self {
        self.digits = Digits::Residual;
        self
    }

    /// It is a time.
    pub const fn time(mut self) -> Self {
        self.digits = Digits::Time;
        self
    }

    /// Heading for reading: the name without underscores and unit, unless there is another.
    pub fn heading(&self) -> String {
        let made = || {
            let words = self.name.replace('_', " ");
            let unit = self.unit.to_lowercase().replace('/', " per ");
            let ending = words.strip_suffix(&format!(" {unit}")).map(str::to_owned);
            ending.filter(|_| !unit.is_empty()).unwrap_or(words)
        };
        self.named.map_or_else(made, str::to_owned)
    }

    /// Unit for reading; empty for none.
    pub fn shown_unit(&self) -> &'static str {
        match (self.shown_digits, self.unit) {
            (Some(Digits::Percent(_)), _) => "%",
            (_, "–") => "",
            (_, unit) => unit,
        }
    }

    /// A number as it is read.
    pub fn read(&self, x: f64) -> String {
        if x.is_nan() {
            return "–".into();
        }
        self.shown_digits.unwrap_or(self.digits).write(x)
    }
}

/// One column of a table whose rows are `R`.
pub struct Column<R> {
    /// Name, unit, meaning, digits.
    pub about: About,
    /// Its contents.
    pub get: fn(&R) -> Value,
}

impl<R> Column<R> {
    /// Cell of a CSV file.
    pub fn csv(&self, row: &R) -> String {
        match (self.get)(row) {
            Value::Text(text) => text,
            Value::Whole(count) => count.to_string(),
            Value::Real(x) => self.about.digits.write(x),
            Value::Empty => String::new(),
        }
    }

    /// Cell of a JSON object, with the digits of the CSV file.
    pub fn json(&self, row: &R) -> serde_json::Value {
        match (self.get)(row) {
            Value::Text(text) => text.into(),
            Value::Whole(count) => count.into(),
            Value::Real(_) => self.csv(row).parse::<f64>().map_or(().into(), Into::into),
            Value::Empty => ().into(),
        }
    }

    /// Cell for reading; a dash where there is nothing.
    pub fn read(&self, row: &R) -> String {
        match (self.get)(row) {
            Value::Text(text) => text,
            Value::Whole(count) => count.to_string(),
            Value::Real(x) => self.about.read(x),
            Value::Empty => "–".into(),
        }
    }
}

/// The columns of a row type, one line each: name, unit, how it is shown (methods of [`About`]), contents, meaning.
///
/// ```text
/// columns! { row: PenaltyRow,
///     "friction" "–" .key() = row.friction, "friction coefficient";
///     "reaction_mn_per_m" "MN/m" .fixed(4) = row.reaction_mn_per_m, "reaction at the top";
/// }
/// ```
macro_rules! columns {
    ($row:ident: $Row:ty, $($name:literal $unit:literal $(. $how:ident ($($value:expr),*))* = $get:expr, $meaning:expr;)*) => {
        vec![$($crate::report::table::Column {
            about: $crate::report::table::About::new($name, $unit, $meaning)$(.$how($($value),*))*,
            get: |$row: &$Row| $crate::report::table::Value::from($get),
        }),*]
    };
}
pub(crate) use columns;
