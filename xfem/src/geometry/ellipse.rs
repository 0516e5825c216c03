//! Distance from the front of a flat elliptic crack, and the frame of the front.
//!
//! ```text
//!   front: c + a₀ cos t e₀ + a₁ sin t e₁,   e₁ = n × e₀
//!   nearest point y of x, both in the plane's coordinates, a₀ >= a₁ after exchange, x >= 0 by symmetry:
//!     y_i = a_i² x_i / (a_i² + s),   F(s) = Σ (a_i x_i / (a_i² + s))² = 1,   s > −a₁²
//!   1/√F is concave and increasing: Newton's method on 1/√F = 1 from the left converges monotonically
//! ```
//!
//! The bracket and the special cases are those of Eberly (2013), "Distance from a point to an ellipse"; the iteration is
//! that of the trust-region problem (Reinsch 1971; Moré and Sorensen 1983), which has the same secular equation.

use super::{Point, Points, add_scaled, cross, dot, sub};

/// A flat ellipse in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Centre [m].
    pub centre: Point,
    /// Unit normal n, from side 2 to side 1.
    pub normal: Point,
    /// Unit direction e₀ of the first half axis, perpendicular to the normal.
    pub axis: Point,
    /// Half axes along e₀ and e₁ = n × e₀ [m]; either may be the longer one.
    pub half_axes: [f64; 2],
}

/// The point of the front nearest to a point's projection on the crack plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Signed distance in the crack plane, negative inside the crack [m].
    pub psi: f64,
    /// Nearest point of the front [m].
    pub point: Point,
    /// Unit normal of the front in the crack plane there, pointing out of the crack; the gradient of ψ.
    pub ahead: Point,
    /// cos t and sin t of its parameter.
    pub parameter: [f64; 2],
}

impl Ellipse {
    /// Local frame n, a, b of the crack.
    pub fn frame(&self) -> [Point; 3] {
        [self.normal, self.axis, cross(&self.normal, &self.axis)]
    }

    /// Nearest point of the front. Where several are equally near (evolute, centre) one is chosen by a fixed rule.
    pub fn nearest(&self, x: &Point) -> Nearest {
        let first = |[v]: [f64; 1]| v;
        let (psi, ahead, y) = self.nearests(&x.map(|v| [v]));
        let y = y.map(first);
        let second = cross(&self.normal, &self.axis);
        let along = add_scaled(&self.centre, y[0], &self.axis);
        Nearest {
            psi: first(psi),
            point: add_scaled(&along, y[1], &second),
            ahead: ahead.map(first),
            parameter: [y[0] / self.half_axes[0], y[1] / self.half_axes[1]],
        }
    }

    /// Distances of L points, directions ahead, and the nearest points in the plane's coordinates.
    #[inline(always)]
    pub fn nearests<const L: usize>(&self, x: &Points<L>) -> ([f64; L], Points<L>, [[f64; L]; 2]) {
        let second = cross(&self.normal, &self.axis);
        let mut flat = [[0.0; L]; 2];
        for q in 0..L {
            let from_centre = sub(&x.map(|v| v[q]), &self.centre);
            flat[0][q] = dot(&from_centre, &self.axis);
            flat[1][q] = dot(&from_centre, &second);
        }
        let y = nearest_in_plane(self.half_axes, &flat);
        let [a, b] = self.half_axes;
        let (mut psi, mut ahead) = ([0.0; L], [[0.0; L]; 3]);
        for q in 0..L {
            // (y₀/a₀², y₁/a₁²) times a₁.
            let outward = [y[0][q] / a * (b / a), y[1][q] / b];
            let length = (outward[0] * outward[0] + outward[1] * outward[1]).sqrt();
            let outward = [outward[0] / length, outward[1] / length];
            psi[q] = (flat[0][q] - y[0][q]) * outward[0] + (flat[1][q] - y[1][q]) * outward[1];
            for c in 0..3 {
                ahead[c][q] = outward[0] * self.axis[c] + outward[1] * second[c];
            }
        }
        (psi, ahead, y)
    }

    /// Point of the front at a parameter t.
    pub fn point(&self, parameter: f64) -> Point {
        let [a, b] = self.half_axes;
        let along = add_scaled(&self.centre, a * parameter.cos(), &self.axis);
        let second = cross(&self.normal, &self.axis);
        add_scaled(&along, b * parameter.sin(), &second)
    }

    /// Frame of the front at a nearest point: ahead, crack normal n, tangent = ahead × n.
    pub fn front_frame(&self, nearest: &Nearest) -> [Point; 3] {
        [
            nearest.ahead,
            self.normal,
            cross(&nearest.ahead, &self.normal),
        ]
    }

    /// The point x + t d of the front with the smallest |t|, for x and the direction d in the crack plane; `None` if
    /// the line misses the front.
    pub fn meet(&self, x: &Point, direction: &Point) -> Option<Point> {
        let second = cross(&self.normal, &self.axis);
        let from_centre = sub(x, &self.centre);
        let scaled = |v: &Point| {
            [
                dot(v, &self.axis) / self.half_axes[0],
                dot(v, &second) / self.half_axes[1],
            ]
        };
        // |p + t q|² = 1 in coordinates that make the front the unit circle.
        let (p, q) = (scaled(&from_centre), scaled(direction));
        let (qq, pq) = (q[0] * q[0] + q[1] * q[1], p[0] * q[0] + p[1] * q[1]);
        let c = (p[0].hypot(p[1]) - 1.0) * (p[0].hypot(p[1]) + 1.0);
        let discriminant = pq * pq - qq * c;
        if discriminant < 0.0 || qq == 0.0 {
            return None;
        }
        // The root of smaller size, without cancellation: c over the sum of equal signs.
        let sum = pq + discriminant.sqrt().copysign(pq);
        let t = if sum == 0.0 { 0.0 } else { -c / sum };
        Some(add_scaled(x, t, direction))
    }
}

/// Nearest points of the ellipse (a₀ cos t, a₁ sin t).
#[inline(always)]
fn nearest_in_plane<const L: usize>(half_axes: [f64; 2], x: &[[f64; L]; 2]) -> [[f64; L]; 2] {
    let long = usize::from(half_axes[0] < half_axes[1]);
    let [i, j] = [long, 1 - long];
    let y = nearest_in_quadrant(
        [half_axes[i], half_axes[j]],
        [x[i].map(f64::abs), x[j].map(f64::abs)],
    );
    let mut found = [[0.0; L]; 2];
    for (k, y) in [i, j].into_iter().zip(y) {
        for q in 0..L {
            found[k][q] = if x[k][q] < 0.0 { -y[q] } else { y[q] };
        }
    }
    found
}

/// The same for a₀ >= a₁ and points of the first quadrant.
#[inline(always)]
fn nearest_in_quadrant<const L: usize>([a, b]: [f64; 2], x: [[f64; L]; 2]) -> [[f64; L]; 2] {
    /// Distance from the long axis, in half axes, that counts as none: ψ is Lipschitz, so it changes by as little.
    const ON_AXIS: f64 = 1e-16;
    /// Newton steps; 3 to 8 are needed.
    const STEPS: usize = 60;
    let ratio = (a / b) * (a / b);
    let (mut p, mut q) = ([0.0; L], [0.0; L]);
    if a == b {
        (p, q) = (x[0], x[1]);
    } else {
        let (u, v) = (x[0].map(|x| x / a), x[1].map(|y| y / b));
        // With σ = 1 + s/a₁² > 0 and ϱ = a₀²/a₁²:  F = (ϱ u/(σ + ϱ − 1))² + (v/σ)².
        let terms = |l: usize, sigma: f64| (ratio * u[l] / (sigma + (ratio - 1.0)), v[l] / sigma);
        // F >= 1 here, so the root lies to the right.
        let mut sigma = [0.0; L];
        for l in 0..L {
            sigma[l] = v[l].max(ratio * u[l] - (ratio - 1.0));
        }
        for _ in 0..STEPS {
            let mut moved = false;
            for l in 0..L {
                let (p, q) = terms(l, sigma[l]);
                let f = p * p + q * q;
                let slope = p * p / (sigma[l] + (ratio - 1.0)) + q * q / sigma[l]; // −F'/2
                let step = f * (f.sqrt() - 1.0) / slope;
                // Monotone in exact arithmetic: the first step that does not go right is rounding.
                let goes = step > 1e-16 * sigma[l];
                sigma[l] += if goes { step } else { 0.0 };
                moved |= goes;
            }
            if !moved {
                break;
            }
        }
        for l in 0..L {
            (p[l], q[l]) = terms(l, sigma[l]);
        }
    }
    let mut found = [[0.0; L]; 2];
    for l in 0..L {
        // On the ellipse also against rounding of σ.
        let length = (p[l] * p[l] + q[l] * q[l]).sqrt();
        (found[0][l], found[1][l]) = (a * (p[l] / length), b * (q[l] / length));
    }
    for l in 0..L {
        if x[1][l] > ON_AXIS * b {
            continue;
        }
        // On the long axis: the foot leaves the vertex inside of the centre of curvature there.
        let c = if ratio > 1.0 {
            ratio * (x[0][l] / a) / (ratio - 1.0)
        } else {
            f64::INFINITY
        };
        (found[0][l], found[1][l]) = if c < 1.0 {
            (a * c, b * ((1.0 - c) * (1.0 + c)).sqrt())
        } else {
            (a, 0.0)
        };
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{norm, unit};
    use proptest::prelude::*;

    fn ellipse(a: f64, b: f64) -> Ellipse {
        let normal = unit(&[1.0, -2.0, 3.0]);
        Ellipse {
            centre: [0.3, -0.1, 0.2],
            normal,
            axis: unit(&cross(&normal, &[0.2, 1.0, 0.4])),
            half_axes: [a, b],
        }
    }

    /// Point of the crack plane with coordinates (p, q), `height` above it.
    fn at(e: &Ellipse, p: f64, q: f64, height: f64) -> Point {
        let x = add_scaled(&e.centre, p, &e.axis);
        let x = add_scaled(&x, q, &cross(&e.normal, &e.axis));
        add_scaled(&x, height, &e.normal)
    }

    proptest! {
        #[test]
        fn agrees_with_a_search_along_the_front(
            b in 0.01f64..1.5, p in -2.0f64..2.0, q in -2.0f64..2.0, scale in 0.0f64..1.0
        ) {
            let e = ellipse(1.0, b);
            let x = at(&e, p * scale, q * scale * scale, 0.0);
            let found = e.nearest(&x);
            let distance = |t: f64| norm(&sub(&e.point(t), &x));
            let step = std::f64::consts::TAU / 4000.0;
            let start = (0..4000).map(|k| k as f64 * step).min_by(|s, t| distance(*s).total_cmp(&distance(*t)));
            let (mut low, mut high) = (start.unwrap() - step, start.unwrap() + step);
            for _ in 0..200 {
                // Golden section.
                let d = 0.381_966 * (high - low);
                if distance(low + d) < distance(high - d) { high -= d } else { low += d }
            }
            prop_assert!((found.psi.abs() - distance(low)).abs() < 1e-12, "{} {}", found.psi, distance(low));
            prop_assert!((norm(&sub(&found.point, &x)) - found.psi.abs()).abs() < 1e-12);
            let [cos, sin] = found.parameter;
            prop_assert!(norm(&sub(&e.point(sin.atan2(cos)), &found.point)) < 1e-13);
            let inside = (p * scale).powi(2) + (q * scale * scale / b).powi(2) < 1.0;
            prop_assert_eq!(found.psi < 0.0, inside);
        }

        #[test]
        fn psi_has_the_gradient_ahead(b in 0.2f64..1.5, p in -2.0f64..2.0, q in -2.0f64..2.0, height in -1.0f64..1.0) {
            // Away from the axes, where ψ has its ridge.
            prop_assume!(p.abs() > 0.05 && q.abs() > 0.05);
            let e = ellipse(1.0, b);
            let x = at(&e, p, q, height);
            let found = e.nearest(&x);
            for k in 0..3 {
                let mut d = [0.0; 3];
                d[k] = 1e-6;
                let slope = (e.nearest(&add_scaled(&x, 1.0, &d)).psi - e.nearest(&add_scaled(&x, -1.0, &d)).psi) / 2e-6;
                prop_assert!((slope - found.ahead[k]).abs() < 1e-7, "{slope} {}", found.ahead[k]);
            }
            let [ahead, n, tangent] = e.front_frame(&found);
            prop_assert!(dot(&ahead, &n).abs() < 1e-14 && (norm(&tangent) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn degenerate_points_and_circles_have_finite_and_exact_answers() {
        let check = |e: &Ellipse, [p, q]: [f64; 2], psi: f64, tolerance: f64| {
            let found = e.nearest(&at(e, p, q, 0.9));
            assert!(
                (found.psi - psi).abs() < tolerance,
                "({p}, {q}): {found:?} {psi}"
            );
            assert!((norm(&found.ahead) - 1.0).abs() < 1e-14);
            found
        };
        // (point, ψ): centre, foot of the evolute's cusp, vertices, on both axes.
        for (p, q, psi) in [
            (0.0, 0.0, -0.5),
            (0.75, 0.0, -0.25),
            (-0.9, 0.0, -0.1),
            (1.0, 0.0, 0.0),
            (0.0, 0.5, 0.0),
            (0.0, -0.2, -0.3),
            (0.0, 4.0, 3.5),
            (5.0, 0.0, 4.0),
            (0.75, 1e-14, -0.25),
            (1e-300, 1e-300, -0.5),
        ] {
            check(&ellipse(1.0, 0.5), [p, q], psi, 1e-14);
        }
        let circle = ellipse(0.7, 0.7);
        check(&circle, [0.0, 0.0], -0.7, 1e-15);
        for [p, q] in [
            [0.1, 0.2],
            [-0.5, 0.4],
            [1e-9, 0.0],
            [0.0, -3.0],
            [0.7, 0.0],
        ] {
            let r = f64::hypot(p, q);
            let found = check(&circle, [p, q], r - 0.7, 1e-15);
            let radial = sub(&at(&circle, p / r, q / r, 0.0), &circle.centre);
            assert!(norm(&sub(&found.ahead, &radial)) < 1e-14);
        }
    }

    #[test]
    fn a_line_in_the_plane_meets_the_front_at_the_nearer_point() {
        let e = ellipse(1.0, 0.5);
        let x = at(&e, 0.9, 0.1, 0.0);
        let found = e.meet(&x, &cross(&e.normal, &e.axis)).unwrap();
        let expected = at(&e, 0.9, 0.5 * (1.0f64 - 0.81).sqrt(), 0.0);
        assert!(norm(&sub(&found, &expected)) < 1e-15);
        let beyond = at(&e, 2.0, 0.0, 0.0);
        assert!(e.meet(&beyond, &cross(&e.normal, &e.axis)).is_none());
    }
}
