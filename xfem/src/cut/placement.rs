//! Where cracks lie in a mesh: which cells they run through, in which they end, their tips and fronts inside the body.

use crate::geometry::curve::Curve;
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, add_scaled, norm, sub};
use crate::mesh::Mesh;

use super::crack::{Crack, Geometry};
use super::is_split;

/// Lengths along the crack are equal within this, in units of the cell's diagonal: a tip this close to an edge is on it.
const ON_EDGE: f64 = 1e-9;

/// Shortest arm in a cell, in units of the cell's diagonal: above rounding.
const SHORTEST_ARM: f64 = 1e-12;

/// How a cell that the crack's curve or plane splits lies along the crack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Along {
    /// Beyond an end.
    Away,
    /// The crack runs through, or to another crack.
    Through,
    /// The crack ends inside.
    Ends,
}

/// Where a cell lies along a crack.
pub fn along(mesh: &Mesh, crack: &Crack, cell: usize) -> Along {
    let phi = crack.cell_phi(mesh, cell);
    if !is_split(&phi) {
        return Along::Away;
    }
    let map = mesh.map(cell);
    let size = map.diagonal();
    // Far from a bent crack φ changes sign where two of its parts are equally near.
    if phi.iter().any(|f| f.abs() > 2.0 * size) {
        return Along::Away;
    }
    let points = crack.crossings(&map, &phi);
    if points
        .iter()
        .any(|(x, _)| crack.distance(x).abs() > 1e-6 * size)
    {
        return Along::Away;
    }
    let tolerance = ON_EDGE * size;
    match &crack.geometry {
        Geometry::Plane { .. } => Along::Through,
        Geometry::Ellipse(ellipse) => {
            let inside = points
                .iter()
                .filter(|(x, _)| ellipse.nearest(x).psi <= tolerance)
                .count();
            let strictly = points
                .iter()
                .any(|(x, _)| ellipse.nearest(x).psi < -tolerance);
            match inside {
                _ if !strictly => Along::Away,
                n if n == points.len() => Along::Through,
                _ => Along::Ends,
            }
        }
        Geometry::Curve(curve) if curve.is_closed() => Along::Through,
        Geometry::Curve(_) => {
            let s = points.iter().map(|(x, _)| crack.abscissa(x));
            let (low, high) = s.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| {
                (l.min(s), h.max(s))
            });
            let [first, last] = crack.range;
            // A tip this close to an edge is on it; an arm that another crack ends exists however short it is.
            let [at_first, at_last] = crack
                .free
                .map(|f| if f { tolerance } else { SHORTEST_ARM * size });
            if high <= first + at_first || low >= last - at_last {
                Along::Away
            } else if (low < first - tolerance && crack.free[0])
                || (high > last + tolerance && crack.free[1])
            {
                Along::Ends
            } else {
                Along::Through
            }
        }
    }
}

/// Tips and fronts of a crack inside the body with the cells they touch; those of a 3D front are told by its cells.
pub fn fronts(mesh: &Mesh, index: usize, crack: &Crack) -> Vec<(TipFrame, Vec<usize>)> {
    if let Geometry::Ellipse(ellipse) = &crack.geometry {
        let frame = TipFrame {
            crack: index,
            position: ellipse.centre,
            ahead: ellipse.axis,
            normal: ellipse.normal,
            shape: FrontShape::Ellipse(*ellipse),
        };
        return vec![(frame, Vec::new())];
    }
    let arc = |position: &Point| match &crack.geometry {
        Geometry::Curve(curve @ Curve::Arc { .. }) => FrontShape::Arc {
            curve: curve.clone(),
            last: norm(&sub(position, &curve.at(curve.length()).0)) < 1e-9 * curve.length(),
        },
        _ => FrontShape::Straight,
    };
    ends_inside(mesh, crack)
        .into_iter()
        .map(|(position, ahead)| {
            let frame = TipFrame {
                crack: index,
                position,
                ahead,
                normal: crack.frame(&position)[0],
                shape: arc(&position),
            };
            (frame, cells_at(mesh, &position))
        })
        .collect()
}

/// Distance from a tip to the nearest kink, other end or meeting of its crack: branch functions know nothing of those [m].
pub fn undisturbed(crack: &Crack, frame: &TipFrame) -> f64 {
    let Geometry::Curve(curve) = &crack.geometry else {
        return f64::INFINITY;
    };
    let s = curve.nearest(&frame.position).s;
    let others = curve.kinks().into_iter().chain(crack.range);
    others
        .map(|k| (k - s).abs())
        .filter(|d| *d > 1e-9 * curve.length())
        .fold(f64::INFINITY, f64::min)
}

/// Ends of a 2D crack strictly inside the body: position and direction ahead. An end on the outer boundary is no tip.
pub fn ends_inside(mesh: &Mesh, crack: &Crack) -> Vec<(Point, Point)> {
    crack
        .ends()
        .into_iter()
        .filter(|(x, ahead)| {
            let Some(&cell) = cells_at(mesh, x).first() else {
                return false;
            };
            let step = 1e-6 * mesh.map(cell).diagonal();
            !cells_at(mesh, &add_scaled(x, step, ahead)).is_empty()
        })
        .collect()
}

/// Cells whose closure contains a point, within 1e-9 of their diagonal.
pub fn cells_at(mesh: &Mesh, x: &Point) -> Vec<usize> {
    (0..mesh.cell_count())
        .filter(|&cell| reference_position(mesh, cell, x, ON_EDGE).is_some())
        .collect()
}

/// Reference position of a point in the closure of a cell, give or take `slack` diagonals; `None` if it lies outside.
pub fn reference_position(mesh: &Mesh, cell: usize, x: &Point, slack: f64) -> Option<Point> {
    let map = mesh.map(cell);
    let margin = slack * map.diagonal();
    let outside = (0..mesh.dim()).any(|a| {
        map.iter().all(|c| c[a] < x[a] - margin) || map.iter().all(|c| c[a] > x[a] + margin)
    });
    if outside {
        return None;
    }
    let xi = map.inverse(x)?;
    map.kind.contains(&xi, 4.0 * slack).then_some(xi)
}
