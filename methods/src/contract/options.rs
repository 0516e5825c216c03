//! Options of methods: declared once, with range, unit, default and help; checked before a method is built.

/// One numerical option of a method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OptionSpec {
    /// Name in case files and on the command line.
    pub name: &'static str,
    /// Unit, `-` if dimensionless.
    pub unit: &'static str,
    /// Value if the user gives none.
    pub default: f64,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
    /// Whether only whole numbers are allowed.
    pub integer: bool,
    /// What it does, in one sentence.
    pub help: &'static str,
}

impl OptionSpec {
    /// The allowed values in words, e.g. `a number from 0.001 to 1000`.
    pub fn allowed(&self) -> String {
        let kind = if self.integer {
            "a whole number"
        } else {
            "a number"
        };
        format!("{kind} from {} to {}", plain(self.min), plain(self.max))
    }

    /// Whether `value` may be given.
    pub fn accepts(&self, value: f64) -> bool {
        // NaN fails both comparisons.
        value >= self.min && value <= self.max && (!self.integer || value.fract() == 0.0)
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
    specs: &'static [OptionSpec],
    values: Vec<f64>,
}

impl Options {
    /// Defaults overridden by `given`.
    ///
    /// # Errors
    /// Unknown or repeated names and values out of range.
    pub fn new(specs: &'static [OptionSpec], given: &[(String, f64)]) -> Result<Self, OptionError> {
        let known = || specs.iter().map(|s| s.name).collect::<Vec<_>>().join(", ");
        let mut values: Vec<Option<f64>> = vec![None; specs.len()];
        for (name, value) in given {
            let (name, value) = (name.clone(), *value);
            let Some(k) = specs.iter().position(|s| s.name == name) else {
                return Err(OptionError::Unknown {
                    name,
                    value,
                    known: known(),
                });
            };
            if !specs[k].accepts(value) {
                return Err(OptionError::OutOfRange {
                    name,
                    value,
                    allowed: specs[k].allowed(),
                    known: known(),
                });
            }
            if values[k].replace(value).is_some() {
                return Err(OptionError::Repeated {
                    name,
                    value,
                    known: known(),
                });
            }
        }
        let values = specs
            .iter()
            .zip(values)
            .map(|(s, v)| v.unwrap_or(s.default))
            .collect();
        Ok(Self { specs, values })
    }

    /// Value of the option `name`; `None` if the method does not declare it.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.specs
            .iter()
            .position(|s| s.name == name)
            .map(|k| self.values[k])
    }

    /// All options with their values, in declared order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static OptionSpec, f64)> + '_ {
        self.specs.iter().zip(self.values.iter().copied())
    }

    /// Value of an option the caller itself declares. `builder` functions use it: a missing name is a slip in the
    /// method's own file, found by the first test that builds the method.
    pub(crate) fn own(&self, name: &'static str) -> f64 {
        self.get(name).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static SPECS: [OptionSpec; 2] = [
        OptionSpec {
            name: "r",
            unit: "-",
            default: 1.0,
            min: 1e-3,
            max: 1e3,
            integer: false,
            help: "scale",
        },
        OptionSpec {
            name: "max_iterations",
            unit: "-",
            default: 50.0,
            min: 1.0,
            max: 1e9,
            integer: true,
            help: "limit",
        },
    ];

    fn given(name: &str, value: f64) -> Result<Options, OptionError> {
        Options::new(&SPECS, &[(name.to_string(), value)])
    }

    #[test]
    fn values_outside_the_range_are_refused_with_value_and_range() {
        for value in [1e4, 0.0, -1.0, f64::NAN, f64::INFINITY] {
            let text = given("r", value).unwrap_err().to_string();
            assert!(
                text.contains(&format!("{value}")) && text.contains("a number from 0.001 to 1000"),
                "{text}"
            );
        }
        let text = given("max_iterations", 2.5).unwrap_err().to_string();
        assert!(text.contains("a whole number from 1 to 1e9"), "{text}");
    }

    #[test]
    fn unknown_names_are_refused_with_the_known_ones() {
        let text = given("gamma", 1.0).unwrap_err().to_string();
        assert!(
            text.contains("gamma") && text.contains("r, max_iterations"),
            "{text}"
        );
    }

    #[test]
    fn defaults_hold_until_overridden() {
        let options = given("r", 2.0).unwrap();
        assert_eq!(
            (
                options.get("r"),
                options.get("max_iterations"),
                options.get("x")
            ),
            (Some(2.0), Some(50.0), None)
        );
        let twice = [("r".to_string(), 2.0), ("r".to_string(), 3.0)];
        assert!(matches!(
            Options::new(&SPECS, &twice),
            Err(OptionError::Repeated { .. })
        ));
    }
}
