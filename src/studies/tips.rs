//! Which tips a case has inside its body, how they are enriched, and what that means for the order.

use std::collections::BTreeSet;

use crate::case::{Case, CrackShape, CrackSpec, Tip};

/// How regular the exact solution is beside what the discretisation knows of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regularity {
    /// No crack ends inside the body.
    Smooth,
    /// A tip without enrichment, or with enrichment that shrinks with the cells: the √r terms outside limit the order.
    Tip,
    /// Tips enriched within a fixed radius.
    FixedRadius,
}

/// Name of the tip enrichments of a case in tables: that of each tip, `no-tips` where no crack ends inside the body.
pub fn label(case: &Case) -> String {
    let names: BTreeSet<String> = ending_inside(case).map(|crack| name(crack.tip)).collect();
    match names.len() {
        0 => "no-tips".into(),
        _ => names.into_iter().collect::<Vec<_>>().join("+"),
    }
}

/// Name of an enrichment in tables, and on the command line: `none`, `auto`, `branch` or the radius in m.
pub fn name(tip: Tip) -> String {
    match tip {
        Tip::None => "none".into(),
        Tip::Auto => "auto".into(),
        Tip::Branch => "branch".into(),
        Tip::Radius(radius) => radius.to_string(),
    }
}

/// The enrichment of that name.
pub fn tip_named(text: &str) -> Option<Tip> {
    match (text, text.parse::<f64>()) {
        ("none", _) => Some(Tip::None),
        ("auto", _) => Some(Tip::Auto),
        ("branch", _) => Some(Tip::Branch),
        (_, Ok(radius)) if radius > 0.0 && radius.is_finite() => Some(Tip::Radius(radius)),
        _ => None,
    }
}

/// Limit of the order: the worst enriched tip.
pub fn regularity(case: &Case) -> Regularity {
    let mut inside = ending_inside(case).peekable();
    if inside.peek().is_none() {
        Regularity::Smooth
    } else if inside.all(|crack| matches!(crack.tip, Tip::Auto | Tip::Radius(_))) {
        Regularity::FixedRadius
    } else {
        Regularity::Tip
    }
}

/// Cracks with a tip or front inside the body.
fn ending_inside(case: &Case) -> impl Iterator<Item = &CrackSpec> {
    (case.cracks.iter()).filter(|crack| ends_inside(case, &crack.geometry))
}

/// Whether a crack has a tip or front inside the body.
fn ends_inside(case: &Case, shape: &CrackShape) -> bool {
    let [low, high] = case.mesh.grid.extents();
    let inside = |x: [f64; 2]| {
        (0..case.model.dim()).all(|a| {
            // An end on the border is none, whatever the rounding.
            let border = 1e-9 * (high[a] - low[a]);
            low[a] + border < x[a] && x[a] < high[a] - border
        })
    };
    match shape {
        CrackShape::Polyline(points) => {
            let ends = [points.first(), points.last()];
            ends.into_iter().flatten().any(|&end| inside(end))
        }
        CrackShape::Arc {
            centre,
            radius,
            from,
            to,
        } => {
            let closed = (to - from).abs() >= std::f64::consts::TAU * (1.0 - 1e-12);
            let on_arc = |angle: &f64| {
                let (sin, cos) = (angle.sin(), angle.cos());
                inside([centre[0] + radius * cos, centre[1] + radius * sin])
            };
            !closed && [from, to].into_iter().any(on_arc)
        }
        CrackShape::Ellipse(_) => true,
        CrackShape::Plane { .. } => false,
    }
}
