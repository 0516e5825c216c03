//! The tables of a case file, one function each; `docs/case-format.md` says the same in words.

use super::error::CaseError;
use super::reader::{Table, Value};
use super::{
    Condition, History, LoadKind, LoadSpec, Material, MethodSpec, PathSpec, Quadrature, Region,
    SupportSpec,
};

pub(super) use super::crack::crack;
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

/// Axis and name of the sides of a box.
fn sides(dim: usize) -> &'static [(&'static str, usize)] {
    match dim {
        2 => &[("left", 0), ("right", 0), ("bottom", 1), ("top", 1)],
        _ => &[
            ("left", 0),
            ("right", 0),
            ("front", 1),
            ("back", 1),
            ("bottom", 2),
            ("top", 2),
        ],
    }
}

/// Names of the sides of a box.
pub(super) fn side_names(dim: usize) -> Vec<&'static str> {
    sides(dim).iter().map(|s| s.0).collect()
}

/// `on` and `where` of a support or load; `counts` says how many sides may be named.
fn region(
    table: &Table<'_>,
    dim: usize,
    counts: std::ops::RangeInclusive<usize>,
) -> Result<Region, CaseError> {
    let on = table.required("on")?;
    let names = if on.string().is_ok() {
        vec![on]
    } else {
        on.list()?
    };
    let mut taken = Vec::new();
    for name in &names {
        let (side, axis) =
            name.one_of(&sides(dim).iter().map(|s| (s.0, *s)).collect::<Vec<_>>())?;
        if taken.iter().any(|(_, other)| *other == axis) {
            return Err(name.refuse(
                "sides that meet in an edge or corner",
                "these sides have no common points",
            ));
        }
        taken.push((side, axis));
    }
    if !counts.contains(&taken.len()) {
        let allowed = match (*counts.start(), *counts.end()) {
            (1, 1) => "exactly one side".to_string(),
            (2, 2) => "the two sides that meet in the edge".to_string(),
            (low, high) => format!("{low} to {high} sides"),
        };
        return Err(on.refuse(allowed, format_args!("{} sides", taken.len())));
    }
    Ok(Region {
        span: on.span(),
        sides: taken
            .into_iter()
            .map(|(side, _)| side.to_string())
            .collect(),
        condition: table.get("where").map(|v| condition(v, dim)).transpose()?,
    })
}

fn condition(value: Value<'_>, dim: usize) -> Result<Condition, CaseError> {
    let text = value.string()?;
    Condition::parse(text, dim).map_err(|e| value.refuse_part(text, e.at, e.allowed, e.message))
}

/// `history` of a support or load.
fn history(table: &Table<'_>) -> Result<History, CaseError> {
    let Some(value) = table.get("history") else {
        return Ok(History::Ramp);
    };
    if value.string().is_ok() {
        return match value.one_of(&[("ramp", true), ("constant", false)])? {
            true => Ok(History::Ramp),
            false => Ok(History::Constant),
        };
    }
    let allowed = "ramp, constant, or points [[t, factor], ...]";
    let list = value
        .list()
        .map_err(|e| value.refuse(allowed, e.message()))?;
    if list.is_empty() {
        return Err(value.refuse("at least one point [t, factor]", "history without points"));
    }
    let mut points: Vec<[f64; 2]> = Vec::new();
    for entry in list {
        let pair = entry.list_of(2)?;
        let previous = points.last().map(|p| p[0]);
        let allowed = previous.map_or("t >= 0".to_string(), |t| {
            format!("t > {t} (strictly increasing)")
        });
        let t = pair[0].number_if(&allowed, |t| previous.map_or(t >= 0.0, |p| t > p))?;
        points.push([t, pair[1].number()?]);
    }
    Ok(History::Points(points))
}

/// `[[support]]`.
pub(super) fn support(value: Value<'_>, dim: usize) -> Result<SupportSpec, CaseError> {
    let table = value.table(&["on", "where", "displacement_m", "history"])?;
    let on = region(&table, dim, 1..=dim)?;
    let given = table.required("displacement_m")?;
    let component = |v: &Value<'_>| match v.string() {
        Ok("free") => Ok(None),
        Ok(_) => Err(v.refuse("a number [m] or \"free\"", "unknown name")),
        Err(_) => v
            .number_if("a finite number [m] or \"free\"", |_| true)
            .map(Some),
    };
    let displacement = given
        .list_of(dim)?
        .iter()
        .map(component)
        .collect::<Result<Vec<_>, _>>()?;
    if displacement.iter().all(Option::is_none) {
        return Err(given.refuse("at least one number", "nothing is prescribed"));
    }
    Ok(SupportSpec {
        span: table.span(),
        on,
        displacement,
        history: history(&table)?,
    })
}

/// `[[load]]`.
pub(super) fn load(value: Value<'_>, dim: usize) -> Result<LoadSpec, CaseError> {
    let kinds = [
        "traction_pa",
        "pressure_pa",
        "line_n_per_m",
        "body_n_per_m3",
    ];
    let table = value.table(&[
        "on", "where", kinds[0], kinds[1], kinds[2], kinds[3], "history",
    ])?;
    let kind = match table.exactly_one(&kinds)? {
        ("traction_pa", v) => LoadKind::Traction(region(&table, dim, 1..=1)?, v.numbers(dim)?),
        ("pressure_pa", v) => LoadKind::Pressure(region(&table, dim, 1..=1)?, v.number()?),
        ("line_n_per_m", v) if dim == 2 => {
            return Err(v.refuse(
                "traction_pa or pressure_pa in 2D",
                "a line load needs model = \"solid\"",
            ));
        }
        ("line_n_per_m", v) => LoadKind::Line(region(&table, dim, 2..=2)?, v.numbers(dim)?),
        (_, v) => {
            if let Some(place) = table.get("on").or(table.get("where")) {
                return Err(place.refuse(
                    "neither `on` nor `where`",
                    "a body force acts in the whole body",
                ));
            }
            LoadKind::Body(v.numbers(dim)?)
        }
    };
    Ok(LoadSpec {
        span: table.span(),
        kind,
        history: history(&table)?,
    })
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
