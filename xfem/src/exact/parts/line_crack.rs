//! The straight 2D crack with its own coordinates.
//!
//! ```text
//!   s = t · (x − centre)    along the crack, −a <= s <= a
//!   m = n · (x − centre)    from side 2 to side 1; n = t turned by +90°
//! ```

use crate::geometry::crack_shape::CrackShape;
use crate::geometry::curve::turned;
use crate::geometry::{Point, add_scaled, dot, norm, rotated, sub, unit};

use crate::exact::solution::Setting;

/// A point closer to the line of the crack than this, in half lengths, lies on the side that is asked for: meshes put cracks on nodes
/// that they pass as closely.
const ON_LINE: f64 = 1e-6;

/// A straight crack in 2D.
#[derive(Debug, Clone, Copy)]
pub struct LineCrack {
    /// Midpoint [m].
    pub centre: Point,
    /// Unit tangent t.
    pub tangent: Point,
    /// Unit normal n, t turned by +90°.
    pub normal: Point,
    /// Half of the length, a [m].
    pub half_length: f64,
    /// +1, or −1 if this is the crack seen from its other end: t, n and the sides are those of the case turned by 180°.
    pub sense: f64,
}

impl LineCrack {
    /// The crack of a setting; an error unless it is one straight segment in 2D.
    pub fn new(setting: &Setting<'_>) -> Result<Self, String> {
        let CrackShape::Polyline(points) = setting.crack else {
            return Err("the crack must be straight: `points_m` with two points".into());
        };
        let [p, q] = points[..] else {
            return Err("the crack must be straight: exactly two points".into());
        };
        let (p, q) = ([p[0], p[1], 0.0], [q[0], q[1], 0.0]);
        let length = norm(&sub(&q, &p));
        if length <= 0.0 {
            return Err("the crack has no length".into());
        }
        let tangent = unit(&sub(&q, &p));
        Ok(LineCrack {
            centre: [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]), 0.0],
            tangent,
            normal: turned(&tangent),
            half_length: 0.5 * length,
            sense: 1.0,
        })
    }

    /// The same crack seen from its other end: s, m and the sides change sign, local components of traction and jump do
    /// not (both axes and the order of the sides turn).
    pub fn reversed(&self) -> Self {
        LineCrack {
            tangent: self.tangent.map(|t| -t),
            normal: self.normal.map(|n| -n),
            sense: -self.sense,
            ..*self
        }
    }

    /// s(x) [m].
    pub fn abscissa(&self, x: &Point) -> f64 {
        dot(&self.tangent, &sub(x, &self.centre))
    }

    /// (s, m) of a point; on the crack line m is a zero with the sign of the side asked for [m].
    pub fn place(&self, x: &Point, side: f64) -> (f64, f64) {
        let m = dot(&self.normal, &sub(x, &self.centre));
        let asked = side * self.sense;
        let beyond = m * asked <= 0.0 && m.abs() <= ON_LINE * self.half_length;
        let m = if beyond { 0.0_f64.copysign(asked) } else { m };
        (self.abscissa(x), m)
    }

    /// Point of the body at (s, m).
    pub fn point(&self, s: f64, m: f64) -> Point {
        add_scaled(&add_scaled(&self.centre, s, &self.tangent), m, &self.normal)
    }

    /// Vector with components (t, n).
    pub fn vector(&self, [t, n]: [f64; 2]) -> Point {
        let zero = [0.0; 3];
        add_scaled(&add_scaled(&zero, t, &self.tangent), n, &self.normal)
    }

    /// Symmetric tensor with components (tt, nn, tn).
    pub fn tensor(&self, [tt, nn, tn]: [f64; 3]) -> [Point; 3] {
        let axes = [self.tangent, self.normal, [0.0, 0.0, 1.0]];
        rotated(&axes, &[[tt, tn, 0.0], [tn, nn, 0.0], [0.0; 3]])
    }

    /// Components (tt, nn, tn) of a symmetric tensor given by xx, yy, xy.
    pub fn components(&self, [xx, yy, xy]: [f64; 3]) -> [f64; 3] {
        let sigma = [[xx, xy, 0.0], [xy, yy, 0.0], [0.0; 3]];
        let (t, n) = (&self.tangent, &self.normal);
        let on_n = apply(&sigma, n);
        [dot(t, &apply(&sigma, t)), dot(n, &on_n), dot(t, &on_n)]
    }

    /// +1 at the end s = a, −1 at s = −a, nothing elsewhere.
    pub fn end(&self, x: &Point) -> Option<f64> {
        [1.0, -1.0].into_iter().find(|end| {
            let tip = self.point(end * self.half_length, 0.0);
            norm(&sub(x, &tip)) <= 1e-6 * self.half_length
        })
    }
}

/// σ v
pub fn apply(sigma: &[Point; 3], v: &Point) -> Point {
    [dot(&sigma[0], v), dot(&sigma[1], v), dot(&sigma[2], v)]
}
