//! The points at which the discrete field of a cell is compared with an exact one.
//!
//! The rules that integrate the stiffness are exact for the discrete functions only. An exact field with a crack tip near
//! varies faster: here rules are in polar coordinates around every tip nearby, in solids on parts halved towards the front.

use crate::cut::part::Part;
use crate::cut::partition::Partition;
use crate::geometry::clip::Side;
use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, diameter, polygon};
use crate::quadrature::WeightedPoint;
use crate::quadrature::graded::graded_points;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator, SidedPoint, whole_cell};
use crate::stiffness::near_front::{Effort, NearFront};

/// A point of comparison.
#[derive(Debug, Clone, Copy)]
pub struct ComparisonPoint {
    /// The point, with the region whose functions count there.
    pub point: SidedPoint,
    /// Side of the crack that cuts the cell, or ends in it; `None` elsewhere.
    pub side: Option<Side>,
}

/// Quadrature points of a cell for the difference between the discrete and an exact field.
///
/// `fronts`: where the exact field is singular, whether the crack carries branch functions there or not. `n`: points per
/// direction, 4 for errors; doubling it shows what the rule leaves out. The weights sum to the cell's measure.
pub fn comparison_points(
    integrator: &CellIntegrator<'_>,
    cell: usize,
    fronts: &[TipFrame],
    n: usize,
) -> Result<Vec<ComparisonPoint>, CellError> {
    let mesh = integrator.mesh;
    let map = mesh.map(cell);
    let (centre, diameter) = (map.centre(), diameter(&map));
    let near = |x: &Point, size: f64| fronts.iter().any(|f| f.distance(x) < size);
    let partition = integrator.enrichment.partition(cell);
    // The centre is at most half a diameter from any point of the cell.
    if partition.is_none() && !near(&centre, 2.0 * diameter) {
        let points = whole_cell(&map, n, |_| 0).into_iter();
        let plain = |point| ComparisonPoint { point, side: None };
        return Ok(points.map(plain).collect());
    }
    // A crack without tip functions ends in a cell that it does not split; the exact field jumps there all the same.
    let whole = Partition::whole(&map);
    let divided = integrator.enrichment.ending(cell).unwrap_or(&whole);
    let parts = &partition.unwrap_or(divided).parts;
    let rule: Vec<(WeightedPoint, usize)> = if mesh.dim() == 2 {
        let tips: Vec<Point> = fronts.iter().flat_map(TipFrame::tips).collect();
        let of_part = |(number, part): (usize, &Part)| {
            let points = graded_points(&polygon::pieces(&part.polygon), &tips, [n; 2]);
            points.into_iter().map(move |p| (p, number))
        };
        parts.iter().enumerate().flat_map(of_part).collect()
    } else {
        let near = NearFront {
            map: &map,
            parts,
            fronts,
            chords: Vec::new(),
        };
        let effort = [Effort::WORKING, Effort::REFERENCE][usize::from(n > 4)];
        near.points(|crack| integrator.plane(cell, crack), effort)
    };
    let located = |(p, number): (WeightedPoint, usize)| {
        let none = || CellError::new(p.x, "a point of a sub-cell has no reference position");
        let xi = map.inverse(&p.x).ok_or_else(none)?;
        // A part has functions of its own only where the enrichment divides the cell, too.
        let region = if partition.is_some() { number } else { 0 };
        let point = SidedPoint::new(xi, p, region);
        let side = parts[number].sides.first().map(|s| s.1);
        Ok(ComparisonPoint { point, side })
    };
    rule.into_iter().map(located).collect()
}
