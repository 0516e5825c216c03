//! Place and shape of a crack, as a case states it.

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
    Ellipse {
        /// Centre [m].
        centre: [f64; 3],
        /// Unit normal, from side 2 to side 1.
        normal: [f64; 3],
        /// Unit direction of the first half axis, perpendicular to the normal; the local axis a.
        axis: [f64; 3],
        /// Half axes along `axis` and along normal × axis [m].
        half_axes: [f64; 2],
    },
    /// 3D plane through the whole body: a point [m] and a unit normal n (normalised by the parser).
    Plane {
        /// A point of the plane [m].
        point: [f64; 3],
        /// Unit normal, from side 2 to side 1.
        normal: [f64; 3],
    },
}
