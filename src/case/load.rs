//! Supports and loads of a case file: where they act, what they prescribe, how they evolve.

use stickslip_xfem::geometry::Point;
use stickslip_xfem::mesh::box_mesh;

use super::condition::{Condition, Parts};
use super::error::{CaseError, Span};
use super::polynomial::Polynomial;
use super::reader::{Table, Value};

/// The part of the boundary a support or load acts on.
#[derive(Debug, Clone)]
pub struct Region {
    /// Where it stands in the file.
    pub span: Span,
    /// Names of box sides (`left right bottom top`; 3D `left right` = x, `front back` = y, `bottom top` = z: minimum,
    /// maximum). One name: that side. Two names: the edge (2D: the corner) both share. Three: the corner in 3D.
    pub sides: Vec<String>,
    /// Keeps only the part of the sides that fulfils the condition.
    pub condition: Option<Condition>,
}

impl Region {
    /// Whether the condition holds at a place of the sides, within δ [m].
    pub fn holds(&self, x: &Point, delta: f64) -> bool {
        let condition = self.condition.as_ref();
        condition.is_none_or(|c| c.holds(x, delta))
    }

    /// Part of a convex polygon or segment on the sides that the condition holds, and the rest; see [`Condition::split`].
    pub fn split(&self, polygon: Vec<Point>, delta: f64) -> [Parts; 2] {
        match &self.condition {
            Some(condition) => condition.split(polygon, delta),
            None => [vec![polygon], vec![]],
        }
    }
}

/// How a support or load evolves over time: value = factor(t) × stated value.
#[derive(Debug, Clone, PartialEq)]
pub enum History {
    /// factor = t / end.
    Ramp,
    /// factor = 1 at all times.
    Constant,
    /// Piecewise linear through (t, factor) points, strictly increasing t, constant beyond the ends.
    Points(Vec<[f64; 2]>),
}

impl History {
    /// Factor at time `t` of a path that lasts until `end`.
    pub fn factor(&self, t: f64, end: f64) -> f64 {
        match self {
            History::Ramp => t / end,
            History::Constant => 1.0,
            History::Points(points) => {
                let next = points.partition_point(|p| p[0] <= t);
                match (next.checked_sub(1).map(|i| points[i]), points.get(next)) {
                    (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]),
                    (Some(a), None) => a[1],
                    (None, Some(b)) => b[1],
                    (None, None) => 0.0,
                }
            }
        }
    }
}

/// Prescribed displacement.
#[derive(Debug, Clone)]
pub struct SupportSpec {
    /// Where the table stands in the file.
    pub span: Span,
    /// Where it acts.
    pub on: Region,
    /// Per component: prescribed value or free; `dim` entries.
    pub displacement: Vec<Option<Amount>>,
    /// The lip that nodes on a crack belong to, where the region does not tell.
    pub lip: Option<CrackSide>,
    /// Evolution of the stated numbers; values of the closed form follow the history of `[exact]`.
    pub history: History,
}

/// A prescribed component of the displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// At the place of the node, times the history factor [m].
    Number(Polynomial),
    /// The closed form at the node.
    Exact,
}

/// A load.
#[derive(Debug, Clone)]
pub struct LoadSpec {
    /// Where the table stands in the file.
    pub span: Span,
    /// Kind and place.
    pub kind: LoadKind,
    /// Evolution of stated numbers; values of the closed form follow the history of `[exact]`.
    pub history: History,
}

/// Kinds of load. Vectors have `dim` entries.
#[derive(Debug, Clone)]
pub enum LoadKind {
    /// Force per area on a side [Pa].
    Traction(Region, Vec<Polynomial>),
    /// Force per area σ n of the closed form on a side.
    ExactTraction(Region),
    /// Pressure on a side, positive towards the body [Pa].
    Pressure(Region, Polynomial),
    /// Force per length on the edge of two sides, solid only [N/m].
    Line(Region, Vec<f64>),
    /// Force per volume, in the whole body or on one side of its only crack [N/m³].
    Body(Vec<f64>, Option<CrackSide>),
    /// Force per volume −div σ of the closed form in the whole body.
    ExactBody,
    /// Stress σ₀ the body has without any strain: σ = C ε + σ₀, tension positive; 2D: in-plane, other entries 0 [Pa].
    InitialStress([[f64; 3]; 3]),
}

/// One side of a crack.
#[derive(Debug, Clone)]
pub struct CrackSide {
    /// Where it stands in the file.
    pub span: Span,
    /// +1: side 1, −1: side 2.
    pub side: f64,
}

/// Places that a support or load may refer to.
pub(super) struct Scene {
    /// Space dimension.
    pub(super) dim: usize,
    /// Number of cracks.
    pub(super) cracks: usize,
    /// Whether the case names a closed form.
    pub(super) exact: bool,
}

/// Axis and name of the sides of a box.
fn sides(dim: usize) -> Vec<(&'static str, usize)> {
    let axes = box_mesh::side_names(dim).iter().enumerate();
    axes.flat_map(|(axis, names)| names.map(|name| (name, axis)))
        .collect()
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
    let names = if on.text().is_some() {
        vec![on]
    } else {
        on.list()?
    };
    let choices: Vec<_> = sides(dim).into_iter().map(|side| (side.0, side)).collect();
    let mut taken: Vec<(&str, usize)> = Vec::new();
    for name in &names {
        let (side, axis) = name.one_of(&choices)?;
        if taken.iter().any(|(_, other)| *other == axis) {
            let allowed = "sides that meet in an edge or corner";
            return Err(name.refuse(allowed, "these sides have no common points"));
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
        sides: taken.iter().map(|(side, _)| side.to_string()).collect(),
        condition: table.optional("where", |v| condition(v, dim))?,
    })
}

/// `where`: a condition, or an array of conditions of which one must hold.
fn condition(value: Value<'_>, dim: usize) -> Result<Condition, CaseError> {
    let one = |value: &Value<'_>| {
        let text = value.string()?;
        let read = Condition::parse(text, dim);
        read.map_err(|e| value.refuse_part(text, e.at, e.allowed, e.message))
    };
    if value.text().is_some() {
        return one(&value);
    }
    let list = value.list_or("a condition, or an array of conditions")?;
    if list.is_empty() {
        return Err(value.refuse("at least one condition", "nothing is kept"));
    }
    let conditions = list.iter().map(one).collect::<Result<_, _>>()?;
    Ok(Condition::union(conditions))
}

/// `history` of a support, a load or the closed form.
pub(super) fn history(table: &Table<'_>) -> Result<History, CaseError> {
    let Some(value) = table.get("history") else {
        return Ok(History::Ramp);
    };
    if value.text().is_some() {
        let ramp = value.one_of(&[("ramp", true), ("constant", false)])?;
        return Ok(if ramp {
            History::Ramp
        } else {
            History::Constant
        });
    }
    let list = value.list_or("ramp, constant, or points [[t, factor], ...]")?;
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

/// Whether a value asks for the closed form, which the case must then name.
fn is_exact(value: &Value<'_>, scene: &Scene) -> Result<bool, CaseError> {
    match value.text() {
        Some("exact") if scene.exact => Ok(true),
        Some("exact") => {
            let allowed = "numbers, or \"exact\" in a case with an [exact] table";
            Err(value.refuse(allowed, "no closed form is named"))
        }
        _ => Ok(false),
    }
}

/// `history` of what takes all its values from the closed form: it has no other than that of `[exact]`.
fn no_history(table: &Table<'_>) -> Result<History, CaseError> {
    match table.get("history") {
        None => Ok(History::Ramp),
        Some(value) => Err(value.refuse(
            "no history here but one in [exact]",
            "all values follow the history of the closed form",
        )),
    }
}

/// `[[support]]`.
pub(super) fn support(value: Value<'_>, scene: &Scene) -> Result<SupportSpec, CaseError> {
    let dim = scene.dim;
    let table = value.table(&["on", "where", "displacement_m", "crack_side", "history"])?;
    let on = region(&table, dim, 1..=dim)?;
    let given = table.required("displacement_m")?;
    let others = "a finite number [m], \"free\", \"exact\"";
    let component = |v: &Value<'_>| match v.text() {
        Some("free") => Ok(None),
        _ if is_exact(v, scene)? => Ok(Some(Amount::Exact)),
        _ => polynomial(v, dim, others).map(|p| Some(Amount::Number(p))),
    };
    let displacement = if given.text().is_some() {
        if !is_exact(&given, scene)? {
            return Err(given.refuse(format_args!("{dim} entries or \"exact\""), "unknown name"));
        }
        vec![Some(Amount::Exact); dim]
    } else {
        let entries = given.list_of(dim)?;
        entries.iter().map(component).collect::<Result<_, _>>()?
    };
    if displacement.iter().all(Option::is_none) {
        return Err(given.refuse("at least one number", "nothing is prescribed"));
    }
    let all_exact = (displacement.iter().flatten()).all(|amount| *amount == Amount::Exact);
    let lip = table.optional("crack_side", |v| crack_side(&v, scene, usize::MAX))?;
    let history = if all_exact { no_history } else { history };
    Ok(SupportSpec {
        span: table.span(),
        on,
        displacement,
        lip,
        history: history(&table)?,
    })
}

/// Keys of a load, first those that say where and then those of its kinds.
const LOAD: [&str; 9] = [
    "on",
    "where",
    "traction_pa",
    "pressure_pa",
    "line_n_per_m",
    "body_n_per_m3",
    "initial_stress_pa",
    "crack_side",
    "history",
];

/// `[[load]]`.
pub(super) fn load(value: Value<'_>, scene: &Scene) -> Result<LoadSpec, CaseError> {
    let dim = scene.dim;
    let table = value.table(&LOAD)?;
    let (key, v) = table.exactly_one(&LOAD[2..7])?;
    let side = table.get("crack_side");
    if let Some(place) = side.filter(|_| key != "body_n_per_m3") {
        return Err(place.refuse(
            "crack_side beside body_n_per_m3 only",
            format_args!("`{key}` does not tell the sides of a crack apart"),
        ));
    }
    let on = |sides: usize| region(&table, dim, sides..=sides);
    let kind = match key {
        "traction_pa" if is_exact(&v, scene)? => LoadKind::ExactTraction(on(1)?),
        "traction_pa" => {
            let entries = v.list_of(dim)?;
            let vector = entries.iter().map(|v| density(v, dim));
            LoadKind::Traction(on(1)?, vector.collect::<Result<_, _>>()?)
        }
        "pressure_pa" => LoadKind::Pressure(on(1)?, density(&v, dim)?),
        "line_n_per_m" if dim == 2 => {
            let message = "a line load needs model = \"solid\"";
            return Err(v.refuse("traction_pa or pressure_pa in 2D", message));
        }
        "line_n_per_m" => LoadKind::Line(on(2)?, v.numbers(dim)?),
        _ => {
            if let Some(place) = table.get("on").or(table.get("where")) {
                let message = format!("`{key}` acts in the whole body");
                return Err(place.refuse("neither `on` nor `where`", message));
            }
            inside(key, v, side, scene)?
        }
    };
    let history = match kind {
        LoadKind::ExactTraction(_) | LoadKind::ExactBody => no_history(&table)?,
        _ => history(&table)?,
    };
    Ok(LoadSpec {
        span: table.span(),
        kind,
        history,
    })
}

/// Body forces and initial stresses.
fn inside(
    key: &str,
    v: Value<'_>,
    side: Option<Value<'_>>,
    scene: &Scene,
) -> Result<LoadKind, CaseError> {
    if key == "initial_stress_pa" {
        return initial_stress(&v, scene.dim);
    }
    if is_exact(&v, scene)? {
        return match side {
            None => Ok(LoadKind::ExactBody),
            Some(side) => Err(side.refuse(
                "no crack_side beside \"exact\"",
                "the closed form tells the sides apart itself",
            )),
        };
    }
    let side = side.map(|side| crack_side(&side, scene, 1));
    Ok(LoadKind::Body(v.numbers(scene.dim)?, side.transpose()?))
}

/// `crack_side`; in a case with more than `most` cracks, or none, it would tell nothing.
fn crack_side(value: &Value<'_>, scene: &Scene, most: usize) -> Result<CrackSide, CaseError> {
    let number = value.integer(1..=2)?;
    if !(1..=most).contains(&scene.cracks) {
        let allowed = match most {
            1 => "a case with exactly one [[crack]]",
            _ => "a case with a [[crack]]",
        };
        return Err(value.refuse(allowed, format_args!("{} cracks", scene.cracks)));
    }
    Ok(CrackSide {
        span: value.span(),
        side: if number == 1 { 1.0 } else { -1.0 },
    })
}

/// `initial_stress_pa`: xx, yy, xy; in a solid xx, yy, zz, yz, xz, xy.
fn initial_stress(value: &Value<'_>, dim: usize) -> Result<LoadKind, CaseError> {
    let places: &[(usize, usize)] = if dim == 2 {
        &[(0, 0), (1, 1), (0, 1)]
    } else {
        &[(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    };
    let mut stress = [[0.0; 3]; 3];
    for (number, &(a, b)) in value.numbers(places.len())?.into_iter().zip(places) {
        stress[a][b] = number;
        stress[b][a] = number;
    }
    Ok(LoadKind::InitialStress(stress))
}

/// A density [Pa]: a polynomial, or a table with the coefficients of a linear one.
fn density(value: &Value<'_>, dim: usize) -> Result<Polynomial, CaseError> {
    if !value.is_table() {
        let allowed = "a finite number [Pa], { at_origin_pa, gradient_pa_per_m }";
        return polynomial(value, dim, allowed);
    }
    let table = value.table(&["at_origin_pa", "gradient_pa_per_m"])?;
    Ok(Polynomial {
        linear: table.required("gradient_pa_per_m")?.in_space(dim)?,
        ..table.required("at_origin_pa")?.number()?.into()
    })
}

/// A number or the text of a polynomial; `others`: what else would be allowed.
fn polynomial(value: &Value<'_>, dim: usize, others: &str) -> Result<Polynomial, CaseError> {
    let allowed = format!("{others} or a polynomial such as \"2 - 3 x + 4 x*y\"");
    match value.text() {
        Some(text) => Polynomial::parse(text, dim).map_err(|e| {
            let allowed = format!("{allowed}; here {}", e.allowed);
            value.refuse_part(text, e.at, allowed, e.message)
        }),
        None => value.number_if(&allowed, |_| true).map(Polynomial::from),
    }
}
