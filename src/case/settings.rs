//! Short parts of a case: quadrature, material, load path, methods.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use stickslip_methods::Tier;
use stickslip_xfem::material::{Dilatation, Material, Model};
use stickslip_xfem::quadrature::Quadrature;

use super::error::{CaseError, Span};
use super::reader::{Table, Value};

/// Accuracy asked for, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A tier.
    Tier(Tier),
    /// A tenth of the error of the mesh.
    Mesh,
}

impl Target {
    /// Its names.
    pub const ALL: [(&str, Self); 4] = [
        (Tier::Low.as_str(), Self::Tier(Tier::Low)),
        (Tier::Mid.as_str(), Self::Tier(Tier::Mid)),
        (Tier::High.as_str(), Self::Tier(Tier::High)),
        ("mesh", Self::Mesh),
    ];

    /// The tier, also where nothing is known of the mesh.
    pub fn tier(self) -> Tier {
        match self {
            Self::Tier(tier) => tier,
            Self::Mesh => Tier::High,
        }
    }
}

impl FromStr for Target {
    type Err = &'static str;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let known = Self::ALL.into_iter().find(|own| own.0 == name);
        known.map(|own| own.1).ok_or("known: low, mid, high, mesh")
    }
}

impl Display for Target {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tier(tier) => tier.fmt(f),
            Self::Mesh => f.write_str("mesh"),
        }
    }
}

/// Load path: times t_k = end · k / increments, k = 1..=increments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathSpec {
    /// Number of increments >= 1.
    pub increments: usize,
    /// Final time > 0 (no physical meaning: quasi-static).
    pub end: f64,
}

impl PathSpec {
    /// Time at the end of an increment, counted from 1.
    pub fn time(&self, increment: usize) -> f64 {
        self.end * increment as f64 / self.increments as f64
    }
}

/// A method with options.
#[derive(Debug, Clone)]
pub struct MethodSpec {
    /// Where it stands in the file.
    pub span: Span,
    /// Registry name.
    pub name: String,
    /// Options by name, in file order.
    pub options: Vec<(String, f64)>,
    /// Where the value of each option stands in the file, in the same order.
    pub option_spans: Vec<Span>,
}

/// Largest number of load increments; more is a slip of the finger.
const MAX_INCREMENTS: usize = 10_000;

/// `quadrature`.
pub(super) fn quadrature(root: &Table<'_>) -> Result<Quadrature, CaseError> {
    let Some(value) = root.get("quadrature") else {
        return Ok(Quadrature::SubCells);
    };
    let allowed = "sub-cells, gauss-N with N from 2 to 16";
    let text = value.string()?;
    if text == "sub-cells" {
        return Ok(Quadrature::SubCells);
    }
    let points = text.strip_prefix("gauss-").and_then(|n| n.parse().ok());
    match points {
        Some(points @ 2..=16) => Ok(Quadrature::Gauss(points)),
        _ => Err(value.refuse(allowed, "unknown quadrature")),
    }
}

/// `[material]`.
pub(super) fn material(
    root: &Table<'_>,
    model: Model,
) -> Result<(Material, Option<Dilatation>), CaseError> {
    let table = root
        .required("material")?
        .table(&["young_pa", "poisson", "dilatation"])?;
    let material = Material {
        young: table.positive("young_pa")?,
        poisson: table.number_if("poisson", "0 <= poisson < 0.5", |nu| {
            (0.0..0.5).contains(&nu)
        })?,
    };
    let dilatation = table.optional("dilatation", |value| match value.string()? {
        "full" => Ok(Dilatation::Full),
        "mean" if model != Model::PlaneStress => Ok(Dilatation::Mean),
        "mean" => Err(value.refuse("full", "plane stress is free to change its thickness")),
        _ => Err(value.refuse("mean, full", "unknown dilatation")),
    })?;
    Ok((material, dilatation))
}

/// `[path]`.
pub(super) fn path(root: &Table<'_>) -> Result<PathSpec, CaseError> {
    let Some(value) = root.get("path") else {
        return Ok(PathSpec {
            increments: 1,
            end: 1.0,
        });
    };
    let table = value.table(&["increments", "end"])?;
    let increments = table.optional("increments", |v| v.integer(1..=MAX_INCREMENTS))?;
    let end = table.optional("end", |v| v.number_if("end > 0", |t| t > 0.0))?;
    Ok(PathSpec {
        increments: increments.unwrap_or(1),
        end: end.unwrap_or(1.0),
    })
}

/// `[[method]]`; names and ranges of options are the registry's affair.
pub(super) fn method(value: Value<'_>) -> Result<MethodSpec, CaseError> {
    let table = value.any_table()?;
    let name = table.required("name")?.label()?;
    let mut spec = MethodSpec {
        span: table.span(),
        name,
        options: Vec::new(),
        option_spans: Vec::new(),
    };
    for (key, _, value) in table.entries() {
        if key != "name" {
            spec.options.push((key.to_string(), value.number()?));
            spec.option_spans.push(value.span());
        }
    }
    Ok(spec)
}
