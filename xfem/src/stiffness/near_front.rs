//! Quadrature of 3D cells near a crack front: which rule where.
//!
//! ```text
//!   the front in the cell, or nearer than REACH cells      slices perpendicular to the front      [`super::front`]
//!   farther away, not cut                                  boxes halved towards the front         [`super::graded`]
//!   farther away, cut                                      tetrahedra halved towards the front    [`super::graded`]
//! ```
//!
//! Halving resolves a front at a distance d of the cell with about 1/d parts, slices with as many at any distance.

use crate::cut::part::{Part, Region};
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub};
use crate::mesh::cell::{CellMap, Nodal};
use crate::quadrature::front::{FrontPiece, FrontRule, front_cell_points, front_part_points};
use crate::quadrature::graded::{graded_cell, graded_tetrahedra, nearest_in_box};
use crate::quadrature::{FanRule, WeightedPoint};

/// Distances in edges of the cell within which a front is resolved by slices: in whole cells, in cut ones.
const REACH: [f64; 2] = [0.15, 1.0];

/// Halvings of what is not sliced: no front is nearer than [`REACH`].
const DEPTH: usize = 4;

/// How finely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// In slices.
    pub slices: FrontRule,
    /// Scale of distances in units of their own, where boxes and tetrahedra are halved: at most 1.
    pub nearer: f64,
}

impl Effort {
    /// Entries of a stiffness to 5e-4 of their diagonals at worst: far below the error of any mesh. The worst are those of
    /// branch functions with little energy of their own, where the front cuts off a corner.
    pub const WORKING: Effort = Effort {
        slices: FrontRule {
            along: 6,
            fan: FanRule {
                radial: 6,
                angular: 10,
            },
        },
        nearer: 0.7,
    };

    /// To measure the former.
    pub const REFERENCE: Effort = Effort {
        slices: FrontRule {
            along: 10,
            fan: FanRule::fine(false),
        },
        nearer: 0.3,
    };
}

/// A cell near fronts.
pub struct NearFront<'a> {
    /// The cell.
    pub map: &'a CellMap,
    /// Parts into which cracks divide it.
    pub parts: &'a [Part],
    /// Fronts.
    pub fronts: &'a [TipFrame],
    /// The fronts that cross the border of their crack's face in the cell: where they enter it and leave it [m].
    pub chords: Vec<(usize, [Point; 2])>,
}

impl NearFront<'_> {
    /// Points with the part they lie in; `crack`: signed distances of the corners to the plane of a crack [m], and its normal.
    pub fn points(
        &self,
        crack: impl Fn(usize) -> (Nodal<f64>, Point),
        effort: Effort,
    ) -> Vec<(WeightedPoint, Region)> {
        let nearest = |fronts: &[&TipFrame], x: &Point| {
            (fronts.iter()).fold(f64::INFINITY, |least, f| least.min(f.distance(x)))
        };
        // Farther from the centre than another by a diameter, a front is nowhere in the cell the nearest.
        let centre = self.map.centre();
        let corners = self.map.iter().map(|corner| norm(&sub(corner, &centre)));
        let mut near: Vec<&TipFrame> = self.fronts.iter().collect();
        let reach = nearest(&near, &centre) + 2.0 * corners.fold(0.0, f64::max);
        near.retain(|f| f.distance(&centre) <= reach);
        let distance = |x: &Point| nearest(&near, x);
        let nearer = |x: &Point| effort.nearer * distance(x);
        if let Some((front, chord)) = self.sliced(&distance) {
            return self.slices(front, chord, crack, effort.slices);
        }
        match self.parts {
            [part] if part.sides.is_empty() => {
                let points = graded_cell(self.map, nearer, DEPTH).into_iter();
                points.map(|p| (p, 0)).collect()
            }
            parts => {
                let of_part = |(region, part): (Region, &Part)| {
                    let points = graded_tetrahedra(&part.tetrahedra, nearer, DEPTH).into_iter();
                    points.map(move |p| (p, region))
                };
                parts.iter().enumerate().flat_map(of_part).collect()
            }
        }
    }

    /// The front to slice around, of those in the cell first, and its chord, or a piece of its tangent next to the cell.
    fn sliced(&self, distance: &impl Fn(&Point) -> f64) -> Option<(&TipFrame, [Point; 2])> {
        let cut = self.parts.len() > 1;
        let reach = REACH[usize::from(cut)] * self.map.longest_edge();
        let (place, nearest) = nearest_in_box(self.map, &[0.0; 3], 1.0, distance);
        let from_place = |tip: usize| self.fronts[tip].distance(&place);
        let chords = self.chords.iter();
        let inside = chords.min_by(|f, g| from_place(f.0).total_cmp(&from_place(g.0)));
        if let Some(&(tip, chord)) = inside {
            return Some((&self.fronts[tip], chord));
        }
        if nearest > reach {
            return None;
        }
        let fronts = self.fronts.iter();
        let front = fronts.min_by(|f, g| f.distance(&place).total_cmp(&g.distance(&place)))?;
        let [ahead, normal, tangent] = front.frame(&place);
        let at = front.coordinates(&place);
        let foot = add_scaled(&place, -at.psi, &ahead);
        let foot = add_scaled(&foot, -at.phi, &normal);
        // Ends far outside of the cell.
        let far = 10.0 * self.map.diagonal();
        Some((front, [-far, far].map(|s| add_scaled(&foot, s, &tangent))))
    }

    /// Slices perpendicular to a chord.
    fn slices(
        &self,
        front: &TipFrame,
        chord: [Point; 2],
        crack: impl Fn(usize) -> (Nodal<f64>, Point),
        rule: FrontRule,
    ) -> Vec<(WeightedPoint, Region)> {
        let along = sub(&chord[1], &chord[0]);
        let across = cross(&front.normal, &along);
        let across = across.map(|v| v / dot(&across, &across).sqrt());
        let piece = FrontPiece {
            chord,
            normal: front.normal,
            at: |x: &Point| match &front.shape {
                FrontShape::Ellipse(ellipse) => ellipse.meet(x, &across),
                _ => Some(*x),
            },
        };
        let mut points = Vec::new();
        let mut push = |region: Region, own: Vec<WeightedPoint>| {
            points.extend(own.into_iter().map(|p| (p, region)));
        };
        for (region, part) in self.parts.iter().enumerate() {
            if part.sides.iter().any(|s| s.0 != front.crack) {
                let walls: Vec<(Point, Point)> = (part.sides.iter())
                    .map(|&(other, side)| {
                        let (phi, normal) = crack(other);
                        let on_it = add_scaled(&self.map[0], -phi[0], &normal);
                        (on_it, normal.map(|n| -side * n))
                    })
                    .collect();
                let vertices = self.vertices(part);
                push(
                    region,
                    front_part_points(self.map, &walls, &vertices, &piece, rule),
                );
                continue;
            }
            let (own, (phi, _)) = (part.side(front.crack), crack(front.crack));
            for side in [1.0, -1.0] {
                if own.is_none_or(|s| s == side) {
                    push(
                        region,
                        front_cell_points(self.map, &phi, side, &piece, rule),
                    );
                }
            }
        }
        points
    }

    /// Corners of the tetrahedra of a part.
    fn vertices(&self, part: &Part) -> Vec<Point> {
        let same = 1e-12 * self.map.diagonal();
        let mut found: Vec<Point> = Vec::new();
        for x in part.tetrahedra.iter().flatten() {
            if found.iter().all(|y| norm(&sub(x, y)) > same) {
                found.push(*x);
            }
        }
        found
    }
}
