//! The frame in which a body is computed: far from zero, coordinates hold few digits of what happens inside a body.
//!
//! ```text
//!   x_file = x + o          o_a = min_a if min_a > size,  max_a if max_a < −size,  0 otherwise;   size: longest side
//! ```
//!
//! Within a factor of two differences of doubles are exact (Sterbenz 1974), so that no place loses a digit by it, and the
//! answer depends on the place of a body only through the digits its file has. A body around zero or beside it stays.

use stickslip_xfem::geometry::crack_shape::CrackShape;
use stickslip_xfem::geometry::{Point, add_scaled};

use super::load::{Amount, LoadKind, Region};
use super::parse::Case;

/// o of a body with the given grid lines.
fn origin(lines: &[Vec<f64>]) -> Point {
    let ends = |l: &Vec<f64>| [l[0], l[l.len() - 1]];
    let size = lines.iter().map(ends).map(|[low, high]| high - low);
    let size = size.fold(0.0, f64::max);
    let mut origin = [0.0; 3];
    for (o, [low, high]) in origin.iter_mut().zip(lines.iter().map(ends)) {
        *o = if low > size {
            low
        } else if high < -size {
            high
        } else {
            0.0
        };
    }
    origin
}

impl Case {
    /// A place as the file has it [m].
    pub fn place(&self, x: &Point) -> Point {
        add_scaled(x, 1.0, &self.origin)
    }

    /// The case in the frame of its body; [`Case::origin`] was zero before. A closed form is one in the coordinates of the
    /// file: such a case stays.
    pub(super) fn in_frame(mut self) -> Self {
        if self.exact.is_some() {
            return self;
        }
        let origin = origin(&self.mesh.grid.lines);
        let back = origin.map(|o| -o);
        for (lines, o) in self.mesh.grid.lines.iter_mut().zip(origin) {
            lines.iter_mut().for_each(|x| *x -= o);
        }
        if let Some(follow) = &mut self.mesh.grid.follow {
            follow.point = add_scaled(&follow.point, 1.0, &back);
        }
        for crack in &mut self.cracks {
            crack.geometry = crack.geometry.moved(&back);
        }
        for probe in &mut self.probes {
            probe.point = add_scaled(&probe.point, 1.0, &back);
        }
        let moved = |region: &mut Region| {
            if let Some(condition) = &mut region.condition {
                *condition = condition.moved(&back);
            }
        };
        for support in &mut self.supports {
            moved(&mut support.on);
            for amount in support.displacement.iter_mut().flatten() {
                if let Amount::Number(polynomial) = amount {
                    *polynomial = polynomial.moved(&origin);
                }
            }
        }
        for load in &mut self.loads {
            match &mut load.kind {
                LoadKind::Traction(region, values) => {
                    moved(region);
                    values.iter_mut().for_each(|v| *v = v.moved(&origin));
                }
                LoadKind::Pressure(region, value) => {
                    moved(region);
                    *value = value.moved(&origin);
                }
                LoadKind::ExactTraction(region) | LoadKind::Line(region, _) => moved(region),
                LoadKind::Body(..) | LoadKind::ExactBody | LoadKind::InitialStress(_) => {}
            }
        }
        Case { origin, ..self }
    }

    /// The shape of a crack as the file has it, by its number from 0.
    pub fn crack_in_file(&self, number: usize) -> CrackShape {
        self.cracks[number].geometry.moved(&self.origin)
    }
}
