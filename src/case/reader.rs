//! Typed access to a parsed TOML document that keeps the place of every value.
//!
//! The document is walked by hand instead of through serde. That gives plain tables the same places, but loses those inside of
//! what may be a text or a table (`tip`, `history`, `on`, `pressure_pa`, options of methods), takes `1e-400` for 0 and says
//! `expected f64` where a range is meant.

use std::fmt::Display;
use std::ops::RangeInclusive;

use strsim::levenshtein;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{CaseError, Source, Span, clip};
use crate::files::visible::{LABEL, is_label};

/// Magnitudes of numbers other than 0: fourth powers of forces, (E L u)⁴ in a solid, are the highest products that methods
/// form, and keep all their digits.
const SMALLEST: f64 = 1e-25;
const LARGEST: f64 = 1e25;
const MAGNITUDES: &str = "0, or of magnitude 1e-25 to 1e25";

/// Whether products of such numbers stay finite and do not vanish; what is written as another number than 0 must not have
/// become one.
pub(super) fn computable(number: f64, written: &str) -> bool {
    if number != 0.0 {
        return (SMALLEST..=LARGEST).contains(&number.abs());
    }
    let mantissa = written.split(['e', 'E']).next().unwrap_or(written);
    !mantissa.contains(|c| ('1'..='9').contains(&c))
}

/// A value of the document with its place.
#[derive(Clone, Copy)]
pub(crate) struct Value<'a> {
    source: Source<'a>,
    item: &'a Spanned<DeValue<'a>>,
}

/// A table whose keys have been checked against the allowed ones.
#[derive(Clone)]
pub(crate) struct Table<'a> {
    source: Source<'a>,
    span: Span,
    map: &'a DeTable<'a>,
}

impl<'a> Source<'a> {
    fn value(self, item: &'a Spanned<DeValue<'a>>) -> Value<'a> {
        Value { source: self, item }
    }
}

impl<'a> Value<'a> {
    /// Place of the value.
    pub(crate) fn span(&self) -> Span {
        self.item.span()
    }

    /// Error about this value, shown as written.
    pub(crate) fn refuse(&self, allowed: impl Display, message: impl Display) -> CaseError {
        let span = self.span();
        self.source
            .error(&span, self.source.slice(&span), allowed, message)
    }

    /// Error about a byte range inside this string, whose decoded text is `text`.
    pub(crate) fn refuse_part(
        &self,
        text: &str,
        part: Span,
        allowed: impl Display,
        message: impl Display,
    ) -> CaseError {
        let span = self.span();
        let raw = self.source.slice(&span);
        // Where quotes, escapes or folded lines make the text differ from the source, the whole value is marked.
        let place = match raw.find(text) {
            Some(offset) if !text.is_empty() => {
                span.start + offset + part.start..span.start + offset + part.end
            }
            _ => span,
        };
        let value = if part.is_empty() { raw } else { &text[part] };
        self.source.error(&place, value, allowed, message)
    }

    fn wrong_type(&self, wanted: &str) -> CaseError {
        let found = match self.item.get_ref() {
            DeValue::String(_) => "a string",
            DeValue::Integer(_) => "an integer",
            DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "a boolean",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "an array",
            DeValue::Table(_) => "a table",
        };
        self.refuse(wanted, format_args!("wrong type, {found}"))
    }

    /// A finite number, written as integer or float.
    pub(crate) fn number(&self) -> Result<f64, CaseError> {
        self.number_if("finite numbers", |_| true)
    }

    /// A finite number that passes a test; `allowed` says which do.
    pub(crate) fn number_if(
        &self,
        allowed: &str,
        test: impl Fn(f64) -> bool,
    ) -> Result<f64, CaseError> {
        let (number, written) = match self.item.get_ref() {
            DeValue::Float(float) => (float.as_str().parse().ok(), float.as_str()),
            DeValue::Integer(integer) if integer.radix() == 10 => {
                (integer.as_str().parse().ok(), "0")
            }
            DeValue::Integer(integer) => {
                let number = u64::from_str_radix(integer.as_str(), integer.radix()).ok();
                (number.map(|n| n as f64), "0")
            }
            _ => return Err(self.wrong_type(allowed)),
        };
        match number {
            Some(number) if !f64::is_finite(number) => {
                Err(self.refuse(allowed, "not a finite number"))
            }
            Some(number) if test(number) && !computable(number, written) => Err(self.refuse(
                format_args!("{allowed}; {MAGNITUDES}"),
                "too small or too large to compute with",
            )),
            Some(number) if test(number) => Ok(number),
            _ => Err(self.refuse(allowed, "out of range")),
        }
    }

    /// An integer in a range.
    pub(crate) fn integer(&self, range: RangeInclusive<usize>) -> Result<usize, CaseError> {
        let allowed = format!("integers from {} to {}", range.start(), range.end());
        let DeValue::Integer(integer) = self.item.get_ref() else {
            return Err(self.wrong_type(&allowed));
        };
        match usize::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(number) if range.contains(&number) => Ok(number),
            _ => Err(self.refuse(allowed, "out of range")),
        }
    }

    /// A string.
    pub(crate) fn string(&self) -> Result<&'a str, CaseError> {
        self.item
            .get_ref()
            .as_str()
            .ok_or_else(|| self.wrong_type("a string"))
    }

    /// The text of a string, and nothing for other values: what is tried goes without errors, whose place is searched for in the
    /// whole document.
    pub(crate) fn text(&self) -> Option<&'a str> {
        self.item.get_ref().as_str()
    }

    /// Whether it is a table.
    pub(crate) fn is_table(&self) -> bool {
        self.item.get_ref().is_table()
    }

    /// Entries of an array; `allowed` says what else may stand in its place.
    pub(crate) fn list_or(&self, allowed: &str) -> Result<Vec<Value<'a>>, CaseError> {
        self.list().map_err(|e| self.refuse(allowed, e.message()))
    }

    /// A text that names something: it ends up on terminals, in tables and in figures.
    pub(crate) fn label(&self) -> Result<String, CaseError> {
        let text = self.string()?;
        if !is_label(text) {
            return Err(self.refuse(LABEL, "no label"));
        }
        Ok(text.to_string())
    }

    /// One of several names.
    pub(crate) fn one_of<T: Copy>(&self, choices: &[(&str, T)]) -> Result<T, CaseError> {
        let names: Vec<&str> = choices.iter().map(|c| c.0).collect();
        let allowed = names.join(", ");
        let DeValue::String(text) = self.item.get_ref() else {
            return Err(self.wrong_type(&allowed));
        };
        let found = choices.iter().find(|c| c.0 == text).map(|c| c.1);
        let unknown = || format!("unknown name{}", suggestion(text, &names));
        found.ok_or_else(|| self.refuse(&allowed, unknown()))
    }

    /// Entries of an array.
    pub(crate) fn list(&self) -> Result<Vec<Value<'a>>, CaseError> {
        match self.item.get_ref() {
            DeValue::Array(array) => Ok(array.iter().map(|item| self.source.value(item)).collect()),
            _ => Err(self.wrong_type("an array")),
        }
    }

    /// Array of `length` entries.
    pub(crate) fn list_of(&self, length: usize) -> Result<Vec<Value<'a>>, CaseError> {
        let list = self.list()?;
        let found = format!("{} entries", list.len());
        if list.len() == length {
            Ok(list)
        } else {
            Err(self.refuse(format_args!("{length} entries"), found))
        }
    }

    /// Array of `length` finite numbers.
    pub(crate) fn numbers(&self, length: usize) -> Result<Vec<f64>, CaseError> {
        self.list_of(length)?.iter().map(Value::number).collect()
    }

    /// Array of N finite numbers.
    pub(crate) fn point<const N: usize>(&self) -> Result<[f64; N], CaseError> {
        let mut point = [0.0; N];
        point.copy_from_slice(&self.numbers(N)?);
        Ok(point)
    }

    /// Array of `dim` finite numbers, with zeros up to three.
    pub(crate) fn in_space(&self, dim: usize) -> Result<[f64; 3], CaseError> {
        let mut point = [0.0; 3];
        point[..dim].copy_from_slice(&self.numbers(dim)?);
        Ok(point)
    }

    /// A table with no other keys than the allowed ones.
    pub(crate) fn table(&self, keys: &[&str]) -> Result<Table<'a>, CaseError> {
        let table = self.any_table()?;
        table.only(keys)?;
        Ok(table)
    }

    /// A table whose keys are not known beforehand.
    pub(crate) fn any_table(&self) -> Result<Table<'a>, CaseError> {
        match self.item.get_ref() {
            DeValue::Table(map) => Ok(Table {
                source: self.source,
                span: self.span(),
                map,
            }),
            _ => Err(self.wrong_type("a table")),
        }
    }
}

impl<'a> Table<'a> {
    /// The whole document.
    pub(crate) fn root(
        source: Source<'a>,
        map: &'a DeTable<'a>,
        keys: &[&str],
    ) -> Result<Self, CaseError> {
        let table = Table {
            source,
            span: 0..0,
            map,
        };
        table.only(keys)?;
        Ok(table)
    }

    fn only(&self, keys: &[&str]) -> Result<(), CaseError> {
        let unknown = |entry: &(&str, Span, Value)| !keys.contains(&entry.0);
        let Some((key, span, _)) = self.entries().into_iter().find(unknown) else {
            return Ok(());
        };
        let message = format!("unknown key{}", suggestion(key, keys));
        Err(self
            .source
            .error(&span, clip(key), keys.join(", "), message))
    }

    /// Place of the table: its header, or its braces.
    pub(crate) fn span(&self) -> Span {
        self.span.clone()
    }

    /// Keys with their places and values, in file order.
    pub(crate) fn entries(&self) -> Vec<(&'a str, Span, Value<'a>)> {
        let entries = self.map.iter();
        let entries = entries.map(|(key, item)| {
            let name = key.get_ref().as_ref();
            (name, key.span(), self.source.value(item))
        });
        let mut entries: Vec<_> = entries.collect();
        entries.sort_by_key(|e| e.1.start);
        entries
    }

    /// Value of a key that may be absent.
    pub(crate) fn get(&self, key: &str) -> Option<Value<'a>> {
        self.map.get(key).map(|item| self.source.value(item))
    }

    /// Value of a key that may be absent.
    pub(crate) fn optional<T>(
        &self,
        key: &str,
        read: impl FnOnce(Value<'a>) -> Result<T, CaseError>,
    ) -> Result<Option<T>, CaseError> {
        self.get(key).map(read).transpose()
    }

    /// Value of a key that must be given.
    pub(crate) fn required(&self, key: &str) -> Result<Value<'a>, CaseError> {
        self.get(key)
            .ok_or_else(|| self.missing(&format!("`{key}`")))
    }

    /// A number that must be given and pass a test; `allowed` says which do.
    pub(crate) fn number_if(
        &self,
        key: &str,
        allowed: &str,
        test: impl Fn(f64) -> bool,
    ) -> Result<f64, CaseError> {
        self.required(key)?.number_if(allowed, test)
    }

    /// A number above 0 that must be given.
    pub(crate) fn positive(&self, key: &str) -> Result<f64, CaseError> {
        self.number_if(key, &format!("{key} > 0"), |x| x > 0.0)
    }

    /// A point that must be given.
    pub(crate) fn point<const N: usize>(&self, key: &str) -> Result<[f64; N], CaseError> {
        self.required(key)?.point()
    }

    /// Place of the value of a key, of the table where it is not given.
    pub(crate) fn place(&self, key: &str) -> Span {
        self.get(key).map_or(self.span(), |value| value.span())
    }

    /// The one key of several that is given, exactly one of which must be.
    pub(crate) fn exactly_one<'k>(
        &self,
        keys: &[&'k str],
    ) -> Result<(&'k str, Value<'a>), CaseError> {
        let allowed = format!("exactly one of `{}`", keys.join("`, `"));
        let given = |key: &&'k str| self.get(key).map(|value| (*key, value));
        let mut given = keys.iter().filter_map(given);
        let first = given.next().ok_or_else(|| self.missing(&allowed))?;
        let Some((key, value)) = given.next() else {
            return Ok(first);
        };
        let both = format!("`{key}` beside `{}`", first.0);
        let message = "keys exclude each other";
        Err(self.source.error(&value.span(), both, allowed, message))
    }

    /// Error about what is not there, at the table itself.
    pub(crate) fn missing(&self, wanted: &str) -> CaseError {
        let message = format!("missing {wanted}");
        self.source.error(&self.span, "nothing", wanted, message)
    }

    /// Tables of an array of tables; none if the key is absent.
    pub(crate) fn tables(&self, key: &str) -> Result<Vec<Value<'a>>, CaseError> {
        let Some(value) = self.get(key) else {
            return Ok(Vec::new());
        };
        let wanted = format!("an array of tables, each headed `[[{key}]]`");
        let list = value.list().map_err(|_| value.wrong_type(&wanted))?;
        match list.iter().find(|v| !v.item.get_ref().is_table()) {
            Some(other) => Err(other.wrong_type(&wanted)),
            None => Ok(list),
        }
    }
}

/// `, did you mean ...?` where one of the names is close, or holds what was found.
pub fn suggestion(found: &str, names: &[&str]) -> String {
    // Names of the format have at most 17 letters; nothing much longer can be a slip of the finger.
    if found.len() > 32 {
        return String::new();
    }
    let names = || names.iter().copied();
    let nearest = names().map(|name| (levenshtein(found, name), name)).min();
    let close = nearest.filter(|(errors, name)| *errors <= 2.max(name.len() / 3));
    let holds = || names().find(|name| found.len() > 3 && name.contains(found));
    let meant = close.map(|own| own.1).or_else(holds);
    meant.map_or(String::new(), |name| format!(", did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_close_names_are_suggested() {
        assert_eq!(
            suggestion("poison", &["young_pa", "poisson"]),
            ", did you mean `poisson`?"
        );
        assert_eq!(suggestion("zzzzzzz", &["young_pa", "poisson"]), "");
    }
}
