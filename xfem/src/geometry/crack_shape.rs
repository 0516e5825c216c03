//! Place and shape of a crack, as a case states it.

use super::curve::Curve;
use super::ellipse::Ellipse;
use super::{Point, add_scaled, cross, unit};

/// Geometry of a crack.
#[derive(Debug, Clone, PartialEq)]
pub enum CrackShape {
    /// 2D chain of straight segments through at least two points [m]; n is the tangent turned by +90 degrees.
    Polyline(Vec<[f64; 2]>),
    /// 2D circular arc, counter-clockwise for `to > from` [rad]; n is the tangent turned by +90 degrees, towards the
    /// centre of a counter-clockwise arc. |to − from| = 2π: a closed circle.
    Arc {
        /// Centre [m].
        centre: [f64; 2],
        /// Radius [m].
        radius: f64,
        /// Angle of the first end from the x axis [rad].
        from: f64,
        /// Angle of the second end [rad].
        to: f64,
    },
    /// Flat elliptic crack inside a solid; a disc if both half axes are equal.
    Ellipse(Ellipse),
    /// 3D plane through the whole body: a point [m] and a unit normal n (normalised by the parser).
    Plane {
        /// A point of the plane [m].
        point: [f64; 3],
        /// Unit normal, from side 2 to side 1.
        normal: [f64; 3],
    },
}

impl CrackShape {
    /// An arc about a centre between two angles.
    pub fn arc(centre: [f64; 2], radius: f64, [from, to]: [f64; 2]) -> Self {
        CrackShape::Arc {
            centre,
            radius,
            from,
            to,
        }
    }

    /// The same shape elsewhere [m].
    pub fn moved(&self, by: &Point) -> Self {
        let flat = |x: &[f64; 2]| [x[0] + by[0], x[1] + by[1]];
        match self {
            CrackShape::Polyline(points) => CrackShape::Polyline(points.iter().map(flat).collect()),
            &CrackShape::Arc {
                centre,
                radius,
                from,
                to,
            } => CrackShape::arc(flat(&centre), radius, [from, to]),
            CrackShape::Ellipse(ellipse) => CrackShape::Ellipse(Ellipse {
                centre: add_scaled(&ellipse.centre, 1.0, by),
                ..*ellipse
            }),
            CrackShape::Plane { point, normal } => {
                CrackShape::plane(add_scaled(point, 1.0, by), *normal)
            }
        }
    }

    /// Local frame n, a, b at a point of the crack; in the plane b = e_z.
    pub fn frame(&self, x: &Point) -> [Point; 3] {
        let curve = match self {
            CrackShape::Polyline(points) => Curve::chain(points),
            &CrackShape::Arc {
                centre,
                radius,
                from,
                to,
            } => Curve::arc(centre, radius, [from, to]),
            CrackShape::Ellipse(ellipse) => return ellipse.frame(),
            CrackShape::Plane { normal, .. } => return plane_frame(normal),
        };
        curve.frame(x)
    }

    /// A plane through a point with a unit normal.
    pub fn plane(point: Point, normal: Point) -> Self {
        CrackShape::Plane { point, normal }
    }
}

/// n, a, b of a plane: a from the axis least along n, the first of equals, so that n = e_z gives a = e_x, b = e_y.
pub fn plane_frame(normal: &Point) -> [Point; 3] {
    let n = unit(normal);
    let mut axis = 0;
    for k in 1..3 {
        if n[k].abs() < n[axis].abs() - 1e-12 {
            axis = k;
        }
    }
    let mut e = [0.0; 3];
    e[axis] = 1.0;
    let a = unit(&add_scaled(&e, -n[axis], &n));
    [n, a, cross(&n, &a)]
}
