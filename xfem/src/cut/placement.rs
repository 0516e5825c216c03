//! Where cracks lie in a mesh: which cells they run through, in which they end, their tips and fronts inside the body.

use crate::geometry::Point;
use crate::geometry::curve::turned;
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::mesh::Mesh;

use super::crack::{Crack, Geometry, crossings};
use super::is_split;

/// Lengths along the crack are equal within this, in units of the cell's diagonal: a tip this close to an edge is on it.
const ON_EDGE: f64 = 1e-9;

/// How a cell of a solid that the crack's plane splits lies along the crack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Along {
    /// Beyond an end.
    Away,
    /// The crack runs through, or to another crack.
    Through,
    /// The crack ends inside.
    Ends,
}

/// Where a cell of a solid lies along a crack: φ is linear.
pub fn along(mesh: &Mesh, crack: &Crack, cell: usize) -> Along {
    let phi = crack.cell_phi(mesh, cell);
    if !is_split(&phi) {
        return Along::Away;
    }
    let crossings = crossings(&mesh.map(cell), &phi);
    along_places(crack, crossings.iter().map(|crossing| &crossing.0))
}

/// Where the polygon between some places of its plane lies along a crack.
pub fn along_places<'a>(crack: &Crack, places: impl Iterator<Item = &'a Point>) -> Along {
    let psi: Vec<f64> = places.map(|x| crack.beyond(x)).collect();
    match psi.iter().filter(|psi| **psi <= 0.0).count() {
        _ if psi.iter().all(|psi| *psi >= 0.0) => Along::Away,
        inside if inside == psi.len() => Along::Through,
        _ => Along::Ends,
    }
}

/// The front of an elliptic crack; `None` for others.
pub fn front_frame(index: usize, crack: &Crack) -> Option<TipFrame> {
    let Geometry::Ellipse(ellipse) = &crack.geometry else {
        return None;
    };
    Some(TipFrame {
        crack: index,
        position: ellipse.centre,
        ahead: ellipse.axis,
        normal: ellipse.normal,
        shape: FrontShape::Ellipse(*ellipse),
    })
}

/// The tip at an end (0 or 1) of a 2D arm, at a place next to it.
pub fn tip_frame(index: usize, crack: &Crack, end: usize, position: &Point) -> TipFrame {
    let along = match &crack.geometry {
        Geometry::Curve(curve) => curve.at(crack.range[end]).1,
        _ => [0.0; 3],
    };
    TipFrame {
        crack: index,
        position: *position,
        ahead: if end == 0 { along.map(|v| -v) } else { along },
        normal: turned(&along),
        shape: FrontShape::Straight,
    }
}

/// Tips and fronts of a crack inside the body.
pub fn fronts(index: usize, crack: &Crack) -> Vec<TipFrame> {
    let tips = crack
        .tips()
        .into_iter()
        .map(|(end, x, _)| tip_frame(index, crack, end, &x));
    front_frame(index, crack).into_iter().chain(tips).collect()
}

/// Cells whose closure contains a point, within 1e-9 of their diagonal.
pub fn cells_at(mesh: &Mesh, x: &Point) -> Vec<usize> {
    let mut near = mesh.surroundings().meeting(&[*x; 2]);
    near.retain(|&cell| reference_position(mesh, cell, x, ON_EDGE).is_some());
    near
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
