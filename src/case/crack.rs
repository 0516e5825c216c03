//! `[[crack]]` of a case file: shapes, tip enrichment, contact space.

use stickslip_xfem::contact::ContactSpace;
use stickslip_xfem::cut::crack::Tip;
use stickslip_xfem::geometry::crack_shape::CrackShape;
use stickslip_xfem::geometry::ellipse::Ellipse;
use stickslip_xfem::geometry::{Point, add_scaled, dot, norm, unit};

use super::error::{CaseError, Span};
use super::reader::{Table, Value};

/// Most points of a polyline: all pairs of its segments are compared.
const MAX_POINTS: usize = 1000;

/// Sine of the smallest angle between two directions that are told apart, also from a turn of 180 degrees.
const PARALLEL: f64 = 1e-9;

/// Keys of a crack, first those that say where it lies.
const KEYS: [&str; 8] = [
    "points_m", "arc", "plane", "disc", "ellipse", "friction", "tip", "contact",
];

/// One crack.
#[derive(Debug, Clone)]
pub struct CrackSpec {
    /// Where the crack's table stands in the file.
    pub span: Span,
    /// Where the geometry (the value of `points_m`, `arc`, `plane`, ...) stands in the file.
    pub geometry_span: Span,
    /// Place and shape.
    pub geometry: CrackShape,
    /// Coulomb friction coefficient μ >= 0, for runs without a friction sweep.
    pub friction: f64,
    /// Enrichment at tips inside the body.
    pub tip: Tip,
    /// Contact space.
    pub contact: ContactSpace,
    /// Where `contact` stands in the file, or the crack's table.
    pub contact_span: Span,
}

/// A friction coefficient.
pub(super) fn friction(value: Value<'_>) -> Result<f64, CaseError> {
    value.number_if("friction >= 0", |mu| mu >= 0.0)
}

/// `[[crack]]`.
pub(super) fn crack(value: Value<'_>, dim: usize) -> Result<CrackSpec, CaseError> {
    let table = value.table(&KEYS)?;
    let (key, geometry) = table.exactly_one(&KEYS[..5])?;
    let flat = ["points_m", "arc"].contains(&key);
    if flat != (dim == 2) {
        let (allowed, needed) = if flat {
            ("plane, disc or ellipse in a solid", "a 2D model")
        } else {
            ("points_m or arc in 2D", "model = \"solid\"")
        };
        return Err(geometry.refuse(allowed, format_args!("`{key}` needs {needed}")));
    }
    let shape = match key {
        "points_m" => polyline(geometry)?,
        "arc" => arc(geometry)?,
        "plane" => plane(geometry)?,
        "disc" => disc(geometry)?,
        _ => ellipse(geometry)?,
    };
    let tip_value = table.get("tip");
    let contact = contact(&table)?;
    Ok(CrackSpec {
        span: table.span(),
        geometry_span: geometry.span(),
        tip: match contact {
            ContactSpace::NodePairs => no_tip(tip_value, "node pairs have no branch functions")?,
            _ => tip(tip_value, &shape)?,
        },
        geometry: shape,
        friction: friction(table.required("friction")?)?,
        contact,
        contact_span: table.place("contact"),
    })
}

/// `tip`; a plane goes through the whole solid and has none. By default a tip or front has branch functions within a radius
/// that fits.
fn tip(value: Option<Value<'_>>, shape: &CrackShape) -> Result<Tip, CaseError> {
    if let CrackShape::Plane { .. } = shape {
        return no_tip(value, "a plane goes through the whole solid and has no tip");
    }
    let Some(value) = value else {
        return Ok(Tip::Auto);
    };
    if value.is_table() {
        let table = value.table(&["branch_radius_m"])?;
        Ok(Tip::Radius(table.positive("branch_radius_m")?))
    } else if value.text().is_some() {
        let names = [
            ("none", Tip::None),
            ("auto", Tip::Auto),
            ("branch", Tip::Branch),
        ];
        value.one_of(&names)
    } else {
        let allowed = "none, auto, branch or { branch_radius_m = R }";
        Err(value.refuse(allowed, "wrong type"))
    }
}

/// `tip` of a crack that can have no functions at one.
fn no_tip(value: Option<Value<'_>>, why: &str) -> Result<Tip, CaseError> {
    match value {
        Some(value) if value.text() != Some("none") => Err(value.refuse("none", why)),
        _ => Ok(Tip::None),
    }
}

/// `contact`.
fn contact(table: &Table<'_>) -> Result<ContactSpace, CaseError> {
    let all = ContactSpace::ALL.into_iter();
    let all = all.chain([ContactSpace::NodePairs]);
    let named: Vec<_> = all.map(|space| (space.name(), space)).collect();
    let given = table.optional("contact", |v| v.one_of(&named))?;
    Ok(given.unwrap_or(ContactSpace::Star))
}

/// `points_m`: a chain of segments that neither folds back nor touches itself.
fn polyline(value: Value<'_>) -> Result<CrackShape, CaseError> {
    let entries = value.list()?;
    if !(2..=MAX_POINTS).contains(&entries.len()) {
        return Err(value.refuse(
            format_args!("2 to {MAX_POINTS} points"),
            format_args!("{} points", entries.len()),
        ));
    }
    let mut points: Vec<[f64; 2]> = Vec::new();
    for entry in entries {
        let x: [f64; 2] = entry.point()?;
        if let Some(&last) = points.last() {
            let d = difference(last, x);
            let length = d[0].hypot(d[1]);
            if length == 0.0 {
                let allowed = "a point distinct from the one before";
                return Err(entry.refuse(allowed, "crack without length"));
            }
            if let Some(&before) = points.len().checked_sub(2).and_then(|i| points.get(i)) {
                let e = difference(before, last);
                let scale = length * e[0].hypot(e[1]);
                if e[0] * d[0] + e[1] * d[1] < 0.0 && cross(e, d).abs() <= PARALLEL * scale {
                    let allowed = "a turn of less than 180 degrees";
                    return Err(entry.refuse(allowed, "the crack folds back on itself"));
                }
                // The segment before shares its end with this one and cannot meet it elsewhere.
                let earlier = points.windows(2).take(points.len() - 2);
                if earlier.clone().any(|s| meet([s[0], s[1]], [last, x])) {
                    let allowed = "a chain of segments that meet at their ends only";
                    return Err(entry.refuse(allowed, "the crack crosses or touches itself"));
                }
            }
        }
        points.push(x);
    }
    Ok(CrackShape::Polyline(points))
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [b[0] - a[0], b[1] - a[1]]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Whether two segments have a common point.
fn meet([a, b]: [[f64; 2]; 2], [p, q]: [[f64; 2]; 2]) -> bool {
    let side = |a, b, x| cross(difference(a, b), difference(a, x));
    let apart = |s: f64, t: f64| (s > 0.0 && t > 0.0) || (s < 0.0 && t < 0.0);
    if apart(side(a, b, p), side(a, b, q)) || apart(side(p, q, a), side(p, q, b)) {
        return false;
    }
    // The rest meets, or lies on one line: there the boxes decide.
    (0..2).all(|k| a[k].min(b[k]) <= p[k].max(q[k]) && p[k].min(q[k]) <= a[k].max(b[k]))
}

/// `arc`.
fn arc(value: Value<'_>) -> Result<CrackShape, CaseError> {
    let table = value.table(&["centre_m", "radius_m", "from_deg", "to_deg"])?;
    let centre = table.point("centre_m")?;
    let radius = table.positive("radius_m")?;
    let angle =
        |key: &str| table.number_if(key, &format!("-360 <= {key} <= 360"), |a| a.abs() <= 360.0);
    let (from, to) = (angle("from_deg")?, angle("to_deg")?);
    if from == to || (to - from).abs() > 360.0 {
        return Err(table.required("to_deg")?.refuse(
            format_args!("more than 0 and at most 360 degrees from from_deg = {from}"),
            format_args!("an arc over {} degrees", to - from),
        ));
    }
    Ok(CrackShape::Arc {
        centre,
        radius,
        from: from.to_radians(),
        to: to.to_radians(),
    })
}

/// `plane`.
fn plane(value: Value<'_>) -> Result<CrackShape, CaseError> {
    let table = value.table(&["point_m", "normal"])?;
    Ok(CrackShape::Plane {
        point: table.point("point_m")?,
        normal: direction(table.required("normal")?)?,
    })
}

/// `disc`: an ellipse with equal half axes, the first one along the body axis least along the normal.
fn disc(value: Value<'_>) -> Result<CrackShape, CaseError> {
    let table = value.table(&["centre_m", "normal", "radius_m"])?;
    let centre = table.point("centre_m")?;
    let normal = direction(table.required("normal")?)?;
    let radius = table.positive("radius_m")?;
    // The first of equals, so that a normal along z has its axis along x.
    let mut least = 0;
    for k in 1..3 {
        if normal[k].abs() < normal[least].abs() - 1e-12 {
            least = k;
        }
    }
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    Ok(CrackShape::Ellipse(Ellipse {
        centre,
        normal,
        axis: unit(&perpendicular(&axis, &normal)),
        half_axes: [radius; 2],
    }))
}

/// `ellipse`.
fn ellipse(value: Value<'_>) -> Result<CrackShape, CaseError> {
    let table = value.table(&["centre_m", "normal", "axis", "half_axes_m"])?;
    let centre = table.point("centre_m")?;
    let normal = direction(table.required("normal")?)?;
    let given = table.required("axis")?;
    let axis = perpendicular(&direction(given)?, &normal);
    if norm(&axis) <= PARALLEL {
        let allowed = "a direction that is not that of the normal";
        return Err(given.refuse(allowed, "axis parallel to the normal"));
    }
    let mut half_axes = [0.0; 2];
    let entries = table.required("half_axes_m")?.list_of(2)?;
    for (half, entry) in half_axes.iter_mut().zip(entries) {
        *half = entry.number_if("half_axes_m > 0, each", |a| a > 0.0)?;
    }
    Ok(CrackShape::Ellipse(Ellipse {
        centre,
        normal,
        axis: unit(&axis),
        half_axes,
    }))
}

/// The unit vector along a given one.
fn direction(value: Value<'_>) -> Result<Point, CaseError> {
    let v: Point = value.point()?;
    // Scaled first, so that tiny and huge vectors are not lost in the squares.
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest == 0.0 {
        return Err(value.refuse("a vector that is not zero", "vector without direction"));
    }
    Ok(unit(&v.map(|x| x / largest)))
}

/// The part of v perpendicular to the unit vector n.
fn perpendicular(v: &Point, n: &Point) -> Point {
    add_scaled(v, -dot(v, n), n)
}
