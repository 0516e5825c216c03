//! Options of methods: declared once, with type, range, default and help; checked before a method is built.

use std::fmt;

/// An option with a real value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Real {
    /// Name in case files and on the command line.
    pub name: &'static str,
    /// Value if the user gives none.
    pub default: f64,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
    /// Its effect, in one sentence.
    pub help: &'static str,
}

/// An option with a whole number for a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Whole {
    /// Name in case files and on the command line.
    pub name: &'static str,
    /// Value if the user gives none.
    pub default: i64,
    /// Smallest allowed value.
    pub min: i64,
    /// Largest allowed value.
    pub max: i64,
    /// Its effect, in one sentence.
    pub help: &'static str,
}

/// An option that is on or off, written 1 or 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Switch {
    /// Name in case files and on the command line.
    pub name: &'static str,
    /// Value if the user gives none.
    pub default: bool,
    /// Its effect, in one sentence.
    pub help: &'static str,
}

/// Declares the settings of a method by their options, one a line: `name: Kind(default, least, most), help;`. A `Count` is a
/// [`Whole`] read as `usize`. Single options are constants: `NAME: Kind("name", default, least, most): help;`.
macro_rules! options {
    ($settings:ident { $($name:ident: $kind:ident($($value:expr),+), $help:expr;)* }) => {
        #[derive(Clone, Copy)]
        pub(crate) struct $settings {
            $($name: options!(@type $kind),)*
        }

        impl $settings {
            pub(crate) const OPTIONS: &'static [$crate::contract::options::OptionSpec] =
                &[$(options!(@spec $kind, stringify!($name), $help, $($value),+)),*];

            fn new(options: &$crate::contract::options::Options) -> Self {
                Self { $($name: options!(@read options, $kind, stringify!($name), $help, $($value),+),)* }
            }
        }
    };
    ($($id:ident: $kind:ident($name:literal, $($value:expr),+): $help:literal;)*) => {
        $(pub(crate) const $id: $crate::contract::options::$kind = options!(@new $kind, $name, $help, $($value),+);)*
    };
    (@type Real) => { f64 };
    (@type Whole) => { i64 };
    (@type Count) => { usize };
    (@type Switch) => { bool };
    (@new Switch, $name:expr, $help:expr, $default:expr) => {
        $crate::contract::options::Switch { name: $name, default: $default, help: $help }
    };
    (@new $kind:ident, $name:expr, $help:expr, $default:expr, $min:expr, $max:expr) => {
        $crate::contract::options::$kind { name: $name, default: $default, min: $min, max: $max, help: $help }
    };
    (@spec Count, $($of:expr),+) => { options!(@spec Whole, $($of),+) };
    (@spec $kind:ident, $($of:expr),+) => { $crate::contract::options::OptionSpec::$kind(options!(@new $kind, $($of),+)) };
    (@read $options:ident, Real, $($of:expr),+) => { $options.real(&options!(@new Real, $($of),+)) };
    (@read $options:ident, Whole, $($of:expr),+) => { $options.whole(&options!(@new Whole, $($of),+)) };
    (@read $options:ident, Count, $($of:expr),+) => { $options.count(&options!(@new Whole, $($of),+)) };
    (@read $options:ident, Switch, $($of:expr),+) => { $options.switch(&options!(@new Switch, $($of),+)) };
}
pub(crate) use options;

/// One option of a method, as the registry lists it. All options are dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OptionSpec {
    /// A number.
    Real(Real),
    /// A whole number.
    Whole(Whole),
    /// On or off.
    Switch(Switch),
}

/// Value of an option.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OptionValue {
    /// A number.
    Real(f64),
    /// A whole number.
    Whole(i64),
    /// On or off.
    Switch(bool),
}

impl OptionValue {
    /// As it is written: 1 or 0 for a switch.
    pub fn number(self) -> f64 {
        match self {
            OptionValue::Real(value) => value,
            OptionValue::Whole(value) => value as f64,
            OptionValue::Switch(on) => f64::from(u8::from(on)),
        }
    }
}

impl fmt::Display for OptionValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.number(), f)
    }
}

impl fmt::LowerExp for OptionValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::LowerExp::fmt(&self.number(), f)
    }
}

impl OptionSpec {
    /// Name in case files and on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            OptionSpec::Real(option) => option.name,
            OptionSpec::Whole(option) => option.name,
            OptionSpec::Switch(option) => option.name,
        }
    }

    /// Its effect, in one sentence.
    pub fn help(&self) -> &'static str {
        match self {
            OptionSpec::Real(option) => option.help,
            OptionSpec::Whole(option) => option.help,
            OptionSpec::Switch(option) => option.help,
        }
    }

    /// Value if the user gives none.
    pub fn default(&self) -> OptionValue {
        match self {
            OptionSpec::Real(option) => OptionValue::Real(option.default),
            OptionSpec::Whole(option) => OptionValue::Whole(option.default),
            OptionSpec::Switch(option) => OptionValue::Switch(option.default),
        }
    }

    /// The allowed values in words, e.g. `a number from 0.001 to 1000`.
    pub fn allowed(&self) -> String {
        let (kind, min, max) = match self {
            OptionSpec::Real(option) => ("a number", option.min, option.max),
            OptionSpec::Whole(option) => ("a whole number", option.min as f64, option.max as f64),
            OptionSpec::Switch(_) => ("a whole number", 0.0, 1.0),
        };
        format!("{kind} from {} to {}", plain(min), plain(max))
    }

    /// The value a number stands for; `None` if it may not be given.
    pub fn value(&self, number: f64) -> Option<OptionValue> {
        // NaN fails all comparisons.
        match self {
            OptionSpec::Real(option) => {
                (number >= option.min && number <= option.max).then_some(OptionValue::Real(number))
            }
            OptionSpec::Whole(option) => {
                let whole = number.fract() == 0.0;
                (whole && number >= option.min as f64 && number <= option.max as f64)
                    .then_some(OptionValue::Whole(number as i64))
            }
            OptionSpec::Switch(_) => match number {
                0.0 => Some(OptionValue::Switch(false)),
                1.0 => Some(OptionValue::Switch(true)),
                _ => None,
            },
        }
    }
}

/// Plain digits where they are short, powers of ten elsewhere.
fn plain(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// An option that a method does not have or does not accept.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OptionError {
    /// The method has no option of this name.
    #[error("unknown option `{name}` (known: {known})")]
    Unknown {
        /// Name given.
        name: String,
        /// Value given.
        value: f64,
        /// Names of the method's options, separated by commas.
        known: String,
    },
    /// The value is outside the range.
    #[error("option `{name}` = {value}: allowed is {allowed}")]
    OutOfRange {
        /// Name given.
        name: String,
        /// Value given.
        value: f64,
        /// Allowed values in words.
        allowed: String,
        /// Names of the method's options, separated by commas.
        known: String,
    },
    /// The option was given twice.
    #[error("option `{name}` is given twice")]
    Repeated {
        /// Name given.
        name: String,
        /// Second value.
        value: f64,
        /// Names of the method's options, separated by commas.
        known: String,
    },
}

/// A checked set of options: one value for each that the method declares.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    values: Vec<(OptionSpec, OptionValue)>,
}

impl Options {
    /// Defaults overridden by `given`.
    ///
    /// # Errors
    /// Unknown or repeated names and values out of range.
    pub fn new(specs: &[OptionSpec], given: &[(String, f64)]) -> Result<Self, OptionError> {
        let known = || {
            let names: Vec<&str> = specs.iter().map(OptionSpec::name).collect();
            names.join(", ")
        };
        let mut found: Vec<Option<OptionValue>> = vec![None; specs.len()];
        for (name, value) in given {
            let (name, value) = (name.clone(), *value);
            let Some(k) = specs.iter().position(|s| s.name() == name) else {
                let known = known();
                return Err(OptionError::Unknown { name, value, known });
            };
            let Some(accepted) = specs[k].value(value) else {
                return Err(OptionError::OutOfRange {
                    name,
                    value,
                    allowed: specs[k].allowed(),
                    known: known(),
                });
            };
            if found[k].replace(accepted).is_some() {
                let known = known();
                return Err(OptionError::Repeated { name, value, known });
            }
        }
        let values = specs.iter().zip(found);
        let values = values.map(|(spec, value)| (*spec, value.unwrap_or(spec.default())));
        Ok(Self {
            values: values.collect(),
        })
    }

    /// Value of the option `name`; `None` if the method does not declare it.
    pub fn get(&self, name: &str) -> Option<OptionValue> {
        let found = self.values.iter().find(|(spec, _)| spec.name() == name);
        found.map(|(_, value)| *value)
    }

    /// All options with their values, in declared order.
    pub fn iter(&self) -> impl Iterator<Item = (OptionSpec, OptionValue)> + '_ {
        self.values.iter().copied()
    }

    /// Value of a real option; its default if the method does not declare it.
    pub fn real(&self, option: &Real) -> f64 {
        match self.get(option.name) {
            Some(OptionValue::Real(value)) => value,
            _ => option.default,
        }
    }

    /// Value of a whole option; its default if the method does not declare it.
    pub fn whole(&self, option: &Whole) -> i64 {
        match self.get(option.name) {
            Some(OptionValue::Whole(value)) => value,
            _ => option.default,
        }
    }

    /// Value of a whole option that counts something: not negative.
    pub fn count(&self, option: &Whole) -> usize {
        usize::try_from(self.whole(option)).unwrap_or(0)
    }

    /// Value of a switch; its default if the method does not declare it.
    pub fn switch(&self, option: &Switch) -> bool {
        match self.get(option.name) {
            Some(OptionValue::Switch(on)) => on,
            _ => option.default,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    options! {
        R: Real("r", 1.0, 1e-3, 1e3): "scale";
        LIMIT: Whole("max_iterations", 50, 1, 1_000_000_000): "limit";
        POLISH: Switch("polish", true): "finish by Newton steps";
    }

    fn given(name: &str, value: f64) -> Result<Options, OptionError> {
        let specs = [
            OptionSpec::Real(R),
            OptionSpec::Whole(LIMIT),
            OptionSpec::Switch(POLISH),
        ];
        Options::new(&specs, &[(name.to_string(), value)])
    }

    #[test]
    fn values_outside_the_range_are_refused_with_value_and_range() {
        for value in [1e4, 0.0, -1.0, f64::NAN, f64::INFINITY] {
            let text = given("r", value).unwrap_err().to_string();
            let allowed = "a number from 0.001 to 1000";
            assert!(
                text.contains(&format!("{value}")) && text.contains(allowed),
                "{text}"
            );
        }
        let text = given("max_iterations", 2.5).unwrap_err().to_string();
        assert!(text.contains("a whole number from 1 to 1e9"), "{text}");
        for value in [0.5, 2.0, f64::NAN] {
            let text = given("polish", value).unwrap_err().to_string();
            assert!(text.contains("a whole number from 0 to 1"), "{text}");
        }
    }

    #[test]
    fn unknown_names_are_refused_with_the_known_ones() {
        let text = given("gamma", 1.0).unwrap_err().to_string();
        let known = "r, max_iterations, polish";
        assert!(text.contains("gamma") && text.contains(known), "{text}");
    }

    #[test]
    fn defaults_hold_until_overridden() {
        let options = given("r", 2.0).unwrap();
        assert_eq!((options.real(&R), options.count(&LIMIT)), (2.0, 50));
        assert!(options.switch(&POLISH) && !given("polish", 0.0).unwrap().switch(&POLISH));
        assert_eq!(options.get("x"), None);
        // An option that a method reads without having declared it has its default, not a number that means nothing.
        let none = Options::new(&[], &[]).unwrap();
        assert_eq!((none.real(&R), none.whole(&LIMIT)), (1.0, 50));
        let twice = [("r".to_string(), 2.0), ("r".to_string(), 3.0)];
        assert!(matches!(
            Options::new(&[OptionSpec::Real(R)], &twice),
            Err(OptionError::Repeated { .. })
        ));
    }
}
