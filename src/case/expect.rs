//! `[[probe]]` and `[[expect]]` of a case file, checked against what the case runs.

use std::collections::BTreeSet;

use super::crack::friction;
use super::error::{CaseError, Span};
use super::load::side_names;
use super::mesh::{MAX_REFINE, Sweep};
use super::named::named;
use super::reader::Value;
use super::settings::PathSpec;

/// A named place: the mesh node at it is recorded.
#[derive(Debug, Clone)]
pub struct ProbeSpec {
    /// Where it stands in the file.
    pub span: Span,
    /// Name in `quantities.csv`; differs from every side, crack and other probe.
    pub name: String,
    /// Place [m]; must coincide with a node.
    pub point: [f64; 3],
}

/// One expected number.
#[derive(Debug, Clone)]
pub struct Expect {
    /// Where it stands in the file.
    pub span: Span,
    /// Quantity name as in `quantities.csv`.
    pub quantity: String,
    /// Place (`at` column): a side, a probe or a crack (`crack-1`); empty: the whole body.
    pub at: String,
    /// Component (`component` column), e.g. `y`; empty: none.
    pub component: String,
    /// Only for this friction coefficient.
    pub friction: Option<f64>,
    /// Only for this refinement factor.
    pub refine: Option<usize>,
    /// Only for this method; otherwise every exact method (not `penalty`).
    pub method: Option<String>,
    /// Increment, counted from 1; otherwise the last.
    pub increment: Option<usize>,
    /// Expected value, in SI units.
    pub value: f64,
    /// Unit of the value, as in `quantities.csv`.
    pub unit: String,
    /// |found − value| <= tolerance.
    pub tolerance: Tolerance,
    /// Where the number comes from.
    pub kind: ExpectKind,
    /// Book, paper, table, derivation.
    pub source: String,
    /// The assumptions that were made.
    pub assumptions: Vec<String>,
    /// True for a documented limitation: the number must be found outside its tolerance.
    pub missed: bool,
}

/// Tolerance of an expected number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Relative to |value|.
    Relative(f64),
    /// In the unit of the value.
    Absolute(f64),
}

named! {
    /// Origin of an expected number, strongest first.
    pub enum ExpectKind {
        /// Closed form.
        Analytic = "analytic",
        /// Printed in a publication.
        Published = "published",
        /// Another code.
        Independent = "independent",
        /// This code, earlier; certifies nothing but stability.
        Snapshot = "snapshot",
    }
}

/// Keys of an expectation.
#[rustfmt::skip]
const EXPECT: [&str; 15] = [
    "quantity", "at", "component", "friction", "refine", "method", "increment", "value", "unit", "relative", "absolute",
    "kind", "source", "assumptions", "outcome",
];

/// Numbers that the runs of a case offer to an expectation; one that no run can meet would never be tested.
pub(super) struct Runs {
    frictions: Vec<f64>,
    refine: Vec<usize>,
    increments: usize,
    places: Vec<String>,
    /// The places again: with as many probes as a file holds a search through all takes seconds.
    known: BTreeSet<String>,
}

impl Runs {
    /// `cracks` holds the friction coefficient of each crack.
    pub(super) fn new(dim: usize, cracks: &[f64], sweep: &Sweep, path: &PathSpec) -> Self {
        let sides = side_names(dim).into_iter().map(str::to_string);
        let frictions = if sweep.friction.is_empty() {
            cracks
        } else {
            &sweep.friction
        };
        let cracks = (1..=cracks.len()).map(|i| format!("crack-{i}"));
        let places: Vec<String> = sides.chain(cracks).collect();
        Runs {
            frictions: frictions.to_vec(),
            refine: sweep.refine.clone(),
            increments: path.increments,
            known: places.iter().cloned().collect(),
            places,
        }
    }

    /// `[[probe]]`; its name joins the places.
    pub(super) fn probe(&mut self, value: Value<'_>, dim: usize) -> Result<ProbeSpec, CaseError> {
        let table = value.table(&["name", "point_m"])?;
        let given = table.required("name")?;
        let name = given.label()?;
        if !self.known.insert(name.clone()) {
            let allowed = format!("a name other than {}", self.places.join(", "));
            return Err(given.refuse(allowed, "name already taken"));
        }
        self.places.push(name.clone());
        Ok(ProbeSpec {
            span: table.span(),
            name,
            point: table.required("point_m")?.in_space(dim)?,
        })
    }

    /// `[[expect]]`.
    pub(super) fn expect(&self, value: Value<'_>) -> Result<Expect, CaseError> {
        let table = value.table(&EXPECT)?;
        let (size, given) = table.exactly_one(&["relative", "absolute"])?;
        let number = given.number_if("a tolerance > 0", |x| x > 0.0)?;
        let tolerance = match size {
            "relative" => Tolerance::Relative(number),
            _ => Tolerance::Absolute(number),
        };
        let wanted = table.required("value")?;
        let number = wanted.number()?;
        if number == 0.0 && matches!(tolerance, Tolerance::Relative(_)) {
            let allowed = "values other than 0, or `absolute`";
            return Err(wanted.refuse(allowed, "a relative tolerance of zero is zero"));
        }
        let kinds: Vec<_> = ExpectKind::ALL.iter().map(|k| (k.name(), *k)).collect();
        let list = |v: Value<'_>| v.list()?.iter().map(Value::label).collect();
        let outcomes = [("met", false), ("missed", true)];
        Ok(Expect {
            span: table.span(),
            quantity: table.required("quantity")?.label()?,
            at: table.optional("at", |v| self.place(v))?.unwrap_or_default(),
            component: table.optional("component", component)?.unwrap_or("").into(),
            friction: table.optional("friction", |v| of_runs(v, friction(v)?, &self.frictions))?,
            refine: table.optional("refine", |v| {
                of_runs(v, v.integer(1..=MAX_REFINE)?, &self.refine)
            })?,
            method: table.optional("method", |v| v.label())?,
            increment: table.optional("increment", |v| v.integer(1..=self.increments))?,
            value: number,
            unit: table.required("unit")?.label()?,
            tolerance,
            kind: table.required("kind")?.one_of(&kinds)?,
            source: table.required("source")?.label()?,
            assumptions: table.optional("assumptions", list)?.unwrap_or_default(),
            missed: (table.optional("outcome", |v| v.one_of(&outcomes))?).unwrap_or(false),
        })
    }

    /// `at`: a side, a crack or a probe; empty for the whole body.
    fn place(&self, value: Value<'_>) -> Result<String, CaseError> {
        let place = value.string()?;
        if !place.is_empty() && !self.known.contains(place) {
            return Err(value.refuse(self.places.join(", "), "unknown place"));
        }
        Ok(place.to_string())
    }
}

/// A value that some run of the case has.
fn of_runs<T: PartialEq + ToString>(
    value: Value<'_>,
    found: T,
    runs: &[T],
) -> Result<T, CaseError> {
    if runs.contains(&found) {
        return Ok(found);
    }
    let known: Vec<String> = runs.iter().map(T::to_string).collect();
    let allowed = format!("one of {}", known.join(", "));
    Err(value.refuse(allowed, "no run of this case has this value"))
}

/// An axis of the body or of the contact frame; empty for none.
fn component(value: Value<'_>) -> Result<&'static str, CaseError> {
    value.one_of(&["x", "y", "z", "n", "a", "b", ""].map(|name| (name, name)))
}
