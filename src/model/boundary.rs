//! Parts of the border and supports, from the words of a case to plain values.

use stickslip_xfem::geometry::Point;
use stickslip_xfem::loads::border::{self, Parts};
use stickslip_xfem::loads::supports::{self, Support};

use crate::case::{Amount, Case, Condition, Region};

impl border::Condition for Condition {
    fn holds(&self, x: &Point, delta: f64) -> bool {
        Condition::holds(self, x, delta)
    }

    fn split(&self, polygon: Vec<Point>, delta: f64) -> [Parts; 2] {
        Condition::split(self, polygon, delta)
    }

    fn range(&self, axis: usize) -> [f64; 2] {
        Condition::range(self, axis)
    }
}

/// Name of a region in the tables: its sides joined by `+`.
pub fn region_name(region: &Region) -> String {
    region.sides.join("+")
}

/// A region as the border takes it.
pub fn part(region: &Region) -> border::Region<'_> {
    let condition = region.condition.as_ref();
    border::Region {
        sides: &region.sides,
        condition: condition.map(|c| c as &dyn border::Condition),
    }
}

/// The supports of a case, in its order.
pub fn supports(case: &Case) -> Vec<Support<'_>> {
    let amount = |amount| match amount {
        Amount::Number(polynomial) => supports::Amount::Stated(Box::new(move |x| polynomial.at(x))),
        Amount::Exact => supports::Amount::Exact,
    };
    let all = case.supports.iter().map(|support| Support {
        on: part(&support.on),
        displacement: (support.displacement.iter())
            .map(|stated| stated.map(amount))
            .collect(),
        lip: support.lip.as_ref().map(|lip| lip.side),
    });
    all.collect()
}
