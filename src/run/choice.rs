//! Which method runs, with which options.

use stickslip_methods::{Method, OptionError, Options};

use crate::case::{Case, CaseError, MethodSpec};
use crate::run::registry::{method, methods};

/// A method with its options.
#[derive(Debug, Clone)]
pub struct Choice {
    /// Method.
    pub method: &'static Method,
    /// Options, defaults filled in.
    pub options: Options,
    /// Name in tables: registry name, changed options in brackets.
    pub label: String,
}

impl Choice {
    /// A method with some of its options changed.
    pub fn new(method: &'static Method, given: &[(String, f64)]) -> Result<Self, OptionError> {
        let options = Options::new(method.options, given)?;
        let label = match changed(&options).as_str() {
            "" => method.name.to_owned(),
            list => format!("{}[{list}]", method.name),
        };
        Ok(Choice {
            method,
            options,
            label,
        })
    }

    /// A method as on the command line: `name` or `name:option=value,option=value`.
    ///
    /// # Errors
    /// [`ChoiceError`].
    pub fn parse(argument: &str) -> Result<Self, ChoiceError> {
        let (name, list) = argument.split_once(':').unwrap_or((argument, ""));
        let method = method(name).ok_or_else(|| ChoiceError::Unknown {
            name: name.into(),
            known: method_names(),
        })?;
        let mut options = Vec::new();
        for part in list.split(',').filter(|part| !part.is_empty()) {
            let pair = part.split_once('=');
            let Some((key, Ok(value))) = pair.map(|(k, v)| (k, v.parse::<f64>())) else {
                return Err(ChoiceError::Syntax {
                    argument: argument.into(),
                    part: part.into(),
                });
            };
            options.push((key.to_owned(), value));
        }
        Choice::new(method, &options).map_err(|source| ChoiceError::Option {
            argument: argument.into(),
            source,
        })
    }

    /// As [`parse`](Self::parse) reads it, without options that have their defaults.
    pub fn argument(&self) -> String {
        match changed(&self.options).as_str() {
            "" => self.method.name.to_owned(),
            list => format!("{}:{list}", self.method.name),
        }
    }

    /// Whether the method asks for the traction operator.
    pub fn needs_traction(&self) -> bool {
        (self.method.build)(&self.options).needs().traction
    }

    /// Every registered method with its defaults.
    pub fn all() -> Result<Vec<Self>, OptionError> {
        let all = methods().iter();
        all.map(|method| Choice::new(method, &[])).collect()
    }
}

/// The options that differ from their defaults, in the order of the method: the same settings give the same text.
fn changed(options: &Options) -> String {
    let changed = options.iter().filter(|(spec, v)| *v != spec.default());
    let changed: Vec<String> = changed
        .map(|(spec, value)| format!("{}={value:e}", spec.name()))
        .collect();
    changed.join(",")
}

/// Names of all methods, separated by commas.
pub fn method_names() -> String {
    let names = methods().iter().map(|m| m.name);
    names.collect::<Vec<_>>().join(", ")
}

/// Why a text names no method with options.
#[derive(Debug, thiserror::Error)]
pub enum ChoiceError {
    /// A name nobody knows.
    #[error("unknown method `{name}`, known: {known}")]
    Unknown {
        /// As given.
        name: String,
        /// The choices.
        known: String,
    },
    /// An option the method does not have or does not accept.
    #[error("method {argument}: {source}")]
    Option {
        /// As given.
        argument: String,
        /// What is wrong.
        source: OptionError,
    },
    /// An option that is no `key=value`.
    #[error("method {argument}: `{part}` is not key=value with a number")]
    Syntax {
        /// As given.
        argument: String,
        /// The part in question.
        part: String,
    },
}

/// Methods a case runs: its own list, or the given ones, or all of the registry.
pub fn choices(case: &Case, given: &[Choice]) -> Result<Vec<Choice>, CaseError> {
    if !given.is_empty() {
        return Ok(given.to_vec());
    }
    if case.methods.is_empty() {
        return Choice::all().map_err(|e| {
            let message = "a method refuses its own defaults";
            case.error(&case.mesh.span, "methods", e, message)
        });
    }
    case.methods
        .iter()
        .map(|spec| {
            let Some(method) = method(&spec.name) else {
                return Err(case.error(&spec.span, &spec.name, method_names(), "unknown method"));
            };
            Choice::new(method, &spec.options).map_err(|e| option_error(case, spec, &e))
        })
        .collect()
}

fn option_error(case: &Case, spec: &MethodSpec, error: &OptionError) -> CaseError {
    let (name, allowed) = match error {
        OptionError::Unknown { name, known, .. } => (name, known.clone()),
        OptionError::OutOfRange { name, allowed, .. } => (name, allowed.clone()),
        OptionError::Repeated { name, .. } => (name, "each option once".to_owned()),
    };
    // The last one of the name: a repeated option is wrong where it stands again.
    let position = spec.options.iter().rposition(|(given, _)| given == name);
    let span = position.map_or(&spec.span, |i| &spec.option_spans[i]);
    case.refuse(span, allowed, error)
}
