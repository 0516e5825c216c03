//! Methods: what one is, how it describes itself, and the list of those a program knows.

use crate::algebra::stiffness::INDEFINITE;
use crate::contract::operator::DelassusForm;
use crate::contract::options::{OptionSpec, Options};
use crate::contract::state::{Monitor, Outcome};
use crate::contract::system::{ContactSystem, Increment};
use crate::error::MethodError;

/// A method of enforcing the contact laws. Methods that iterate on the condensed increment implement
/// [`CondensedMethod`](crate::CondensedMethod) instead, which gives them this one.
///
/// It may keep factorisations between calls, never history: the same increment twice gives the same bits.
pub trait Enforcement: Send {
    /// Why the method cannot treat this system; `None` if it can.
    fn refuses(&self, system: &ContactSystem) -> Option<String> {
        self.needs().refuses(system)
    }

    /// Needs of the method.
    fn needs(&self) -> Needs {
        Needs::default()
    }

    /// Factors what any load needs: K. `solve` does it if it was not done before. The condensation to the contact
    /// points waits for the first load that closes the contact, because an open crack does not need it;
    /// [`ContactSystem::condense`] brings it forward, [`Elastic::timings`](crate::Elastic::timings) tells its time apart.
    ///
    /// # Errors
    /// Input that no method could treat; see [`MethodError`].
    fn prepare(&mut self, system: &ContactSystem) -> Result<(), MethodError> {
        system.elastic().factorise()
    }

    /// Solves one increment. Failure to converge is a [`Status`](crate::Status).
    ///
    /// # Errors
    /// Input that no method could treat; see [`MethodError`].
    fn solve(
        &mut self,
        increment: &Increment<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError>;

    /// Time of the last [`solve`](Self::solve) by the method's own account \[s\], where it runs outside this process and says
    /// so.
    fn reported_s(&self) -> Option<f64> {
        None
    }
}

/// Which Delassus operators a method can treat. Those of a stiffness are of the first kind; one that was given may not be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OperatorKind {
    /// Symmetric positive semi-definite: the method minimises ½ P·W P + q·P, or relies on it in another way. What is taken
    /// for granted of a method that says nothing.
    #[default]
    SemiDefinite,
    /// Any: the method works with products, rows and columns of W alone, and solves with LU factors.
    Any,
}

/// Needs of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Needs {
    /// Which Delassus operators it can treat.
    pub operator: OperatorKind,
    /// How it works with the Delassus operator.
    pub delassus: DelassusForm,
    /// The stress at the contact points, [`ElasticParts::traction`](crate::ElasticParts::traction).
    pub traction: bool,
}

impl Needs {
    /// Those of a method that works with any W, as a matrix.
    pub const ANY_OPERATOR: Self = Self {
        operator: OperatorKind::Any,
        delassus: DelassusForm::Formed,
        traction: false,
    };

    /// Why a method with these needs cannot treat a system, by its Delassus operator; `None` if it can.
    pub fn refuses(&self, system: &ContactSystem) -> Option<String> {
        let elastic = system.elastic();
        let asymmetry = elastic.asymmetry();
        match self.operator {
            OperatorKind::Any => None,
            OperatorKind::SemiDefinite if asymmetry > 0.0 => Some(format!(
                "W is unsymmetric by {asymmetry:.1e} relative, the method needs a symmetric W"
            )),
            OperatorKind::SemiDefinite => elastic.indefinite().then(|| {
                format!(
                    "W has an eigenvalue below -{INDEFINITE:e} of its largest entry, the method needs a positive \
                     semi-definite W"
                )
            }),
        }
    }
}

/// A method as a registry lists it.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    /// Name on the command line and in tables.
    pub name: &'static str,
    /// Name in plots.
    pub label: &'static str,
    /// Where it was published.
    pub reference: &'static str,
    /// Its effect, in one sentence.
    pub summary: &'static str,
    /// Whether its limit is the solution of the contact laws; otherwise a parameter is a modelling error.
    pub exact: bool,
    /// Options it takes.
    pub options: &'static [OptionSpec],
    /// Its own file, whose head is its page; see [`page`](Method::page).
    pub source: &'static str,
    /// Makes an instance.
    pub build: fn(&Options) -> Box<dyn Enforcement>,
}

impl Method {
    /// Manual of the method in Markdown: equations, options, guarantees, failure modes, what it skips.
    /// It is the documentation at the head of the method's file, so that there is one text.
    pub fn page(&self) -> String {
        let head = self.source.lines().map_while(|l| l.strip_prefix("//!"));
        let lines: Vec<&str> = head.map(|l| l.strip_prefix(' ').unwrap_or(l)).collect();
        lines.join("\n") + "\n"
    }
}

/// The methods a program knows, in the order of its tables.
///
/// [`Registry::standard`] holds those of this package. A method from elsewhere is added to it:
/// ```
/// use stickslip_methods::{CondensedMethod, ContactProblem, End, Method, MethodError, Monitor, Registry};
///
/// struct Mine;
///
/// impl CondensedMethod for Mine {
///     fn iterate(&mut self, problem: &mut ContactProblem<'_>, _: &mut dyn Monitor) -> Result<End, MethodError> {
///         Ok(End::at_start(problem)) // gives up at once
///     }
/// }
///
/// static MINE: Method = Method {
///     name: "mine",
///     label: "Mine",
///     reference: "unpublished",
///     summary: "does nothing",
///     exact: true,
///     options: &[],
///     source: "//! A method from elsewhere.",
///     build: |_| Box::new(Mine),
/// };
///
/// let registry = Registry::standard().with(&MINE)?;
/// assert!(registry.get("mine").is_some() && registry.get("b-newton").is_some());
/// assert!(registry.with(&MINE).is_err());
/// # Ok::<(), stickslip_methods::NameTaken>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Registry {
    methods: Vec<&'static Method>,
}

impl Registry {
    /// The registry with one more method, the last of its list.
    ///
    /// # Errors
    /// A method of that name is there already.
    pub fn with(mut self, method: &'static Method) -> Result<Self, NameTaken> {
        if self.get(method.name).is_some() {
            return Err(NameTaken(method.name));
        }
        self.methods.push(method);
        Ok(self)
    }

    /// The method of that name.
    pub fn get(&self, name: &str) -> Option<&'static Method> {
        self.iter().find(|m| m.name == name)
    }

    /// Place of a name in the list.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.iter().position(|m| m.name == name)
    }

    /// All methods, in the order of the list.
    pub fn methods(&self) -> &[&'static Method] {
        &self.methods
    }

    /// The same one by one.
    pub fn iter(
        &self,
    ) -> impl DoubleEndedIterator<Item = &'static Method> + ExactSizeIterator + '_ {
        self.methods.iter().copied()
    }

    /// Names of all methods, separated by commas.
    pub fn names(&self) -> String {
        self.iter().map(|m| m.name).collect::<Vec<_>>().join(", ")
    }
}

impl FromIterator<&'static Method> for Registry {
    fn from_iter<I: IntoIterator<Item = &'static Method>>(methods: I) -> Self {
        Self {
            methods: methods.into_iter().collect(),
        }
    }
}

/// Two methods of one name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a method named `{0}` is registered already")]
pub struct NameTaken(pub &'static str);
