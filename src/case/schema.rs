//! The tables of a case file, one function each; `docs/case-format.md` says the same in words.

use super::error::CaseError;
use super::reader::{Table, Value};
use super::{Material, MethodSpec, PathSpec, Quadrature};

pub(super) use super::crack::crack;
pub(super) use super::exact::exact;
pub(super) use super::load::{Scene, load, side_names, support};
pub(super) use super::mesh::{mesh, sweep};

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
    let points = text
        .strip_prefix("gauss-")
        .and_then(|n| n.parse().ok())
        .filter(|n| (2..=16).contains(n));
    points
        .map(Quadrature::Gauss)
        .ok_or_else(|| value.refuse(allowed, "unknown quadrature"))
}

/// `[material]`.
pub(super) fn material(root: &Table<'_>) -> Result<Material, CaseError> {
    let table = root.required("material")?.table(&["young_pa", "poisson"])?;
    Ok(Material {
        young: table
            .required("young_pa")?
            .number_if("young_pa > 0", |e| e > 0.0)?,
        poisson: table
            .required("poisson")?
            .number_if("0 <= poisson < 0.5", |nu| (0.0..0.5).contains(&nu))?,
    })
}

/// A friction coefficient.
pub(super) fn friction(value: Value<'_>) -> Result<f64, CaseError> {
    value.number_if("friction >= 0", |mu| mu >= 0.0)
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
    Ok(PathSpec {
        increments: table
            .get("increments")
            .map_or(Ok(1), |v| v.integer(1..=MAX_INCREMENTS))?,
        end: table
            .get("end")
            .map_or(Ok(1.0), |v| v.number_if("end > 0", |t| t > 0.0))?,
    })
}

/// `[[method]]`; names and ranges of options are the registry's affair.
pub(super) fn method(value: Value<'_>) -> Result<MethodSpec, CaseError> {
    let table = value.any_table()?;
    let name = table.required("name")?.line()?;
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
