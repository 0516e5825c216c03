//! Which method runs, with which options.

use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use stickslip_methods::{Enforcement, Method, OptionError, OptionSpec, OptionValue, Options};

use crate::case::reader::suggestion;
use crate::case::{Case, CaseError, MethodSpec};
use crate::run::outside::{OUTSIDE, Outside, Program, SECONDS};
use crate::run::registry::{method, methods};

/// A method with its options.
#[derive(Clone)]
pub struct Choice {
    source: Source,
    /// Time for an increment [s].
    pub seconds: f64,
    /// Set from outside to end runs at their next iteration.
    pub stop: Arc<AtomicBool>,
    /// Name in tables: registry name, changed options in brackets; of a program `exec:` and the name of its file.
    pub label: String,
}

/// Where a method comes from.
#[derive(Clone)]
enum Source {
    /// The registry, with options, defaults filled in.
    Registry(&'static Method, Options),
    /// A program.
    Outside(Program),
    /// Whoever embeds the program.
    Own(Build),
}

/// Makes an instance of a method.
type Build = Arc<dyn Fn() -> Box<dyn Enforcement> + Send + Sync>;

impl fmt::Debug for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.argument())
    }
}

impl Choice {
    /// A method with some of its options changed.
    pub fn new(method: &'static Method, given: &[(String, f64)]) -> Result<Self, OptionError> {
        let options = Options::new(method.options, given)?;
        let label = match changed(&options).as_str() {
            "" => method.name.to_owned(),
            list => format!("{}[{list}]", method.name),
        };
        let source = Source::Registry(method, options);
        Ok(Choice {
            source,
            label,
            seconds: SECONDS,
            stop: Arc::default(),
        })
    }

    /// A method as on the command line: `name`, `name:option=value,option=value`, or `exec:PROGRAM`.
    ///
    /// # Errors
    /// [`ChoiceError`].
    pub fn parse(argument: &str) -> Result<Self, ChoiceError> {
        if let Some(path) = argument.strip_prefix(OUTSIDE) {
            return Self::outside(path);
        }
        let (name, list) = argument.split_once(':').unwrap_or((argument, ""));
        let method = method(name).ok_or_else(|| ChoiceError::Unknown {
            name: name.into(),
            known: format!("{}, {OUTSIDE}PROGRAM", method_names()),
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

    /// A method that whoever embeds the program brings along, taken for one that solves the contact laws.
    pub fn own(name: &str, build: Build) -> Self {
        Choice {
            label: format!("{OWN}{name}"),
            source: Source::Own(build),
            seconds: SECONDS,
            stop: Arc::default(),
        }
    }

    fn outside(path: &str) -> Result<Self, ChoiceError> {
        let program = Program::find(path).map_err(|why| ChoiceError::Program {
            path: path.into(),
            why,
        })?;
        Ok(Choice {
            label: format!("{OUTSIDE}{}", program.name()),
            source: Source::Outside(program),
            seconds: SECONDS,
            stop: Arc::default(),
        })
    }

    /// As [`parse`](Self::parse) reads it, without options that have their defaults.
    pub fn argument(&self) -> String {
        match &self.source {
            Source::Outside(program) => format!("{OUTSIDE}{}", program.path()),
            Source::Registry(method, options) => match changed(options).as_str() {
                "" => method.name.to_owned(),
                list => format!("{}:{list}", method.name),
            },
            Source::Own(_) => self.label.clone(),
        }
    }

    /// Name without options: that in the registry, or the label of a program.
    pub fn name(&self) -> &str {
        match &self.source {
            Source::Registry(method, _) => method.name,
            Source::Outside(_) | Source::Own(_) => &self.label,
        }
    }

    /// Whether its limit is the solution of the contact laws; that of a program is taken for it.
    pub fn exact(&self) -> bool {
        match &self.source {
            Source::Registry(method, _) => method.exact,
            Source::Outside(_) | Source::Own(_) => true,
        }
    }

    /// Whether it is one of the registry: another shows nothing of its iterates.
    pub fn is_registered(&self) -> bool {
        matches!(self.source, Source::Registry(..))
    }

    /// All options with their values; a program has none.
    pub fn options(&self) -> Vec<(OptionSpec, OptionValue)> {
        match &self.source {
            Source::Registry(_, options) => options.iter().collect(),
            Source::Outside(_) | Source::Own(_) => Vec::new(),
        }
    }

    /// The option of this name, if it has one.
    pub fn spec(&self, name: &str) -> Option<OptionSpec> {
        let mut all = self.options().into_iter().map(|(spec, _)| spec);
        all.find(|spec| spec.name() == name)
    }

    /// The program, if it is one.
    pub fn program(&self) -> Option<&Program> {
        match &self.source {
            Source::Registry(..) | Source::Own(_) => None,
            Source::Outside(program) => Some(program),
        }
    }

    /// The same with so many seconds for an increment; a program, which cannot be trusted to give up, with an end to all of them.
    pub fn limited(self, seconds: f64, until: Option<Instant>) -> Self {
        let source = match self.source {
            Source::Outside(program) => Source::Outside(program.limited(seconds, until)),
            other => other,
        };
        Self {
            source,
            seconds,
            ..self
        }
    }

    /// Makes an instance.
    pub fn build(&self) -> Box<dyn Enforcement> {
        match &self.source {
            Source::Registry(method, options) => (method.build)(options),
            Source::Outside(program) => Box::new(Outside::new(program.clone())),
            Source::Own(build) => build(),
        }
    }

    /// Whether the method asks for the traction operator.
    pub fn needs_traction(&self) -> bool {
        self.build().needs().traction
    }

    /// Every registered method with its defaults.
    ///
    /// # Errors
    /// A method that refuses its own defaults.
    pub fn all() -> Result<Vec<Self>, ChoiceError> {
        let all = methods().iter();
        all.map(|method| Choice::parse(method.name)).collect()
    }
}

/// The argument of a method with the path of a program as seen from a folder.
pub fn seen_from(folder: &Path, argument: &str) -> String {
    match argument.strip_prefix(OUTSIDE) {
        Some(path) => format!("{OUTSIDE}{}", folder.join(path).display()),
        None => argument.to_owned(),
    }
}

/// Beginning of the label of a method that whoever embeds the program brings along.
const OWN: &str = "own:";

/// Whether a label or an argument names a method that is not in the registry.
pub fn is_outside(method: &str) -> bool {
    [OUTSIDE, OWN].iter().any(|begin| method.starts_with(begin))
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
    #[error("unknown method `{name}`{}, known: {known}", suggestion(name, &known.split(", ").collect::<Vec<_>>()))]
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
        /// The fault, in words.
        source: OptionError,
    },
    /// A file that is no program.
    #[error("method {OUTSIDE}{path}: {why}")]
    Program {
        /// As given.
        path: String,
        /// The fault, in words.
        why: String,
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
