//! The laws of one point as complementarity of second-order cones, and Newton's equations along their central path.
//! ```text
//! P_n g = ν                          P_n > 0, g > 0             Signorini
//! (P_n, P_t/μ) ∘ (λ, d) = (ν, 0)     |P_t| < μ P_n, |d| < λ     Coulomb
//! ```
//! with the Jordan product (x₀, x) ∘ (y₀, y) = (x₀ y₀ + x·y, x₀ y + y₀ x). For ν = 0 these are the laws: where P_n > 0
//! the second line says that λ = |d| and that slip is opposed by μ P_n (Kanno, Martins & Pinto da Costa, Int. J. Numer.
//! Meth. Engng 65 (2006) 62). λ stands for |d|, so that nothing is left to smooth.

#![allow(non_snake_case)]

use crate::contract::law::tangential_norm;

/// How far rounding may put a point outside a cone, relative to its size: without it steps would end there.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Tangential forces moved inside keep this fraction of `depth` from Coulomb's bound.
const INSIDE: f64 = 0.5;

/// One point of the path, or a step of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ConePoint<'a> {
    pub mu: f64,
    pub P: &'a [f64],
    /// (g, d).
    pub v: &'a [f64],
    /// Bound of |d|; without meaning where there is no friction.
    pub lambda: f64,
}

/// The products of one point, or what they lack to their target.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Products {
    /// P_n g.
    pub normal: f64,
    /// P_n λ + P_t·d/μ.
    pub scalar: f64,
    /// λ P_t/μ + P_n d.
    pub vector: [f64; 2],
}

impl Products {
    /// self + t other.
    pub fn plus(&self, t: f64, other: &Products) -> Self {
        Self {
            normal: self.normal + t * other.normal,
            scalar: self.scalar + t * other.scalar,
            vector: [0, 1].map(|k| self.vector[k] + t * other.vector[k]),
        }
    }

    /// Distance to ν; `second` are the products of a step, its error of second order.
    pub fn lack(&self, nu: f64, second: &Products) -> Self {
        Self {
            normal: nu - self.normal - second.normal,
            scalar: nu - self.scalar - second.scalar,
            vector: [0, 1].map(|k| -self.vector[k] - second.vector[k]),
        }
    }
}

/// Left side of one of Newton's equations at a point: Σ a_l δP_l + Σ c_l δv_l.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PathRow {
    pub a: [f64; 3],
    pub c: [f64; 3],
}

impl ConePoint<'_> {
    /// The products.
    pub fn products(&self) -> Products {
        self.products_with(self)
    }

    /// The symmetric bilinear form whose square they are.
    pub fn products_with(&self, other: &ConePoint<'_>) -> Products {
        let ((P, v), (R, w)) = ((self.P, self.v), (other.P, other.v));
        let mut result = Products {
            normal: 0.5 * (P[0] * w[0] + R[0] * v[0]),
            ..Default::default()
        };
        if P.len() > 1 {
            result.scalar = 0.5 * (P[0] * other.lambda + R[0] * self.lambda);
        }
        for k in 1..P.len() {
            result.scalar += 0.5 * (P[k] * w[k] + R[k] * v[k]) / self.mu;
            let forces = 0.5 * (other.lambda * P[k] + self.lambda * R[k]) / self.mu;
            result.vector[k - 1] = forces + 0.5 * (P[0] * w[k] + R[0] * v[k]);
        }
        result
    }

    /// Whether the point is inside all cones.
    pub fn is_inside(&self) -> bool {
        let outside = |bound: f64, x: &[f64]| x.len() > 1 && tangential_norm(x) >= bound;
        self.P[0] > 0.0
            && self.v[0] > 0.0
            && !outside(self.mu * self.P[0], self.P)
            && !outside(self.lambda, self.v)
    }

    /// The same after t times a step.
    pub fn products_after(&self, t: f64, step: &ConePoint<'_>) -> Products {
        let (mut P, mut v) = ([0.0; 3], [0.0; 3]);
        for k in 0..self.P.len() {
            P[k] = self.P[k] + t * step.P[k];
            v[k] = self.v[k] + t * step.v[k];
        }
        let moved = ConePoint {
            mu: self.mu,
            P: &P[..self.P.len()],
            v: &v[..self.P.len()],
            lambda: self.lambda + t * step.lambda,
        };
        moved.products()
    }

    /// τ = P_t/(μ P_n), component k.
    fn tau(&self, k: usize) -> f64 {
        self.P[k] / (self.mu * self.P[0])
    }

    /// Newton's equations for the products with δλ eliminated, left side:
    /// ```text
    /// g δP_n + P_n δg = l_n
    /// (d − λτ) δP_n + (λ I − τ dᵀ) δP_t/μ + P_n (I − τ τᵀ) δd = l_t − τ l_0,     τ = P_t/(μ P_n)
    /// ```
    /// They stay regular at the solution: those of an open point fix δP, those of a sticking one δd, and for d = −λτ,
    /// |τ| = 1 they are the derivative of P_t = −μ P_n d/|d|.
    pub fn equations(&self) -> [PathRow; 3] {
        let (P, v, lambda, mu) = (self.P, self.v, self.lambda, self.mu);
        let mut rows = [PathRow::default(); 3];
        rows[0].a[0] = v[0];
        rows[0].c[0] = P[0];
        for k in 1..P.len() {
            rows[k].a[0] = v[k] - lambda * self.tau(k);
            for l in 1..P.len() {
                let unit = f64::from(u8::from(k == l));
                rows[k].a[l] = (lambda * unit - self.tau(k) * v[l]) / mu;
                rows[k].c[l] = P[0] * (unit - self.tau(k) * self.tau(l));
            }
        }
        rows
    }

    /// Right side of [`equations`](Self::equations).
    pub fn right_side(&self, lack: &Products) -> [f64; 3] {
        let mut h = [lack.normal, 0.0, 0.0];
        for k in 1..self.P.len() {
            h[k] = lack.vector[k - 1] - self.tau(k) * lack.scalar;
        }
        h
    }

    /// δλ that goes with a step of P and v.
    pub fn lambda_step(&self, lack: &Products, dP: &[f64], dv: &[f64]) -> f64 {
        if dP.len() == 1 {
            return 0.0;
        }
        let mut rest = lack.scalar - self.lambda * dP[0];
        for k in 1..dP.len() {
            rest -= (self.P[k] * dv[k] + self.v[k] * dP[k]) / self.mu;
        }
        rest / self.P[0]
    }

    /// Longest t <= `longest` for which the point moved by t `step` is in all cones.
    pub fn step_length(&self, step: &ConePoint<'_>, longest: f64) -> f64 {
        let half_line = |x: f64, dx: f64| if dx < 0.0 { -x / dx } else { longest };
        let mut t = longest
            .min(half_line(self.P[0], step.P[0]))
            .min(half_line(self.v[0], step.v[0]));
        if self.P.len() > 1 {
            let vector = |x0: f64, x: &[f64]| [x0, x[1], x.get(2).copied().unwrap_or(0.0)];
            let force = |p: &ConePoint<'_>| vector(self.mu * p.P[0], p.P);
            let slip = |p: &ConePoint<'_>| vector(p.lambda, p.v);
            t = cone_step(force(self), force(step), t);
            t = cone_step(slip(self), slip(step), t);
        }
        t
    }
}

/// Moves (P, v) inside the cones, by `force` and `length` from all boundaries; returns λ.
pub(crate) fn move_inside(mu: f64, P: &mut [f64], v: &mut [f64], force: f64, length: f64) -> f64 {
    P[0] = P[0].max(0.0) + force;
    v[0] = v[0].max(0.0) + length;
    let (t, bound) = (tangential_norm(P), mu * (P[0] - INSIDE * force));
    if t > bound {
        P[1..].iter_mut().for_each(|x| *x *= bound / t);
    }
    tangential_norm(v) + length
}

/// Longest t <= `longest` with x₀ + t y₀ >= |x + t y|.
fn cone_step(mut x: [f64; 3], y: [f64; 3], longest: f64) -> f64 {
    x[0] *= 1.0 + ROUNDING;
    let form = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] - x[1] * y[1] - x[2] * y[2];
    // a t² + 2 b t + c = 0, c without the cancellation of x₀² − |x|².
    let size = x[1].hypot(x[2]);
    let (a, b, c) = (form(y, y), form(x, y), (x[0] - size) * (x[0] + size));
    if c <= 0.0 {
        return 0.0;
    }
    let discriminant = b * b - a * c;
    if discriminant < 0.0 || (a >= 0.0 && b >= 0.0) {
        return longest;
    }
    (c / (discriminant.sqrt() - b)).min(longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A point inside both cones, with `rows` rows.
    fn inside(mu: f64, x: &[f64], rows: usize) -> ([f64; 3], [f64; 3], f64) {
        let (mut P, mut v) = ([x[0], x[1], x[2]], [x[3], x[4], x[5]]);
        let lambda = move_inside(mu, &mut P[..rows], &mut v[..rows], 0.3, 0.2);
        (P, v, lambda)
    }

    fn at<'a>(mu: f64, x: &'a ([f64; 3], [f64; 3], f64), rows: usize) -> ConePoint<'a> {
        let (P, v) = (&x.0[..rows], &x.1[..rows]);
        ConePoint {
            mu,
            P,
            v,
            lambda: x.2,
        }
    }

    /// Distance to the boundary of the nearest cone, negative outside.
    fn margin(p: &ConePoint<'_>) -> f64 {
        let normal = p.P[0].min(p.v[0]);
        if p.P.len() == 1 {
            return normal;
        }
        let cones = (p.mu * p.P[0] - tangential_norm(p.P)).min(p.lambda - tangential_norm(p.v));
        normal.min(cones)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        /// A step that fulfils the condensed equations makes up for the lack to first order.
        #[test]
        fn equations_are_the_derivative_of_the_products(
            mu in 0.05..3.0_f64, x in prop::array::uniform6(-2.0..2.0_f64), y in prop::array::uniform6(-1.0..1.0_f64),
            l in prop::array::uniform4(-1.0..1.0_f64), rows in 1..=3_usize,
        ) {
            let x = inside(mu, &x, rows);
            let point = at(mu, &x, rows);
            let (dP, dv) = ([y[0], y[1], y[2]], [y[3], y[4], y[5]]);
            let (equations, size) = (point.equations(), 1e-6);
            let mut lack = Products { normal: 0.0, scalar: if rows > 1 { l[0] } else { 0.0 }, vector: [0.0; 2] };
            // The lack that this step makes up for, by the equations.
            let left = |k: usize| (0..rows).map(|i| equations[k].a[i] * dP[i] + equations[k].c[i] * dv[i]).sum::<f64>();
            let h = point.right_side(&lack);
            lack.normal = left(0);
            for k in 1..rows {
                lack.vector[k - 1] = left(k) - h[k];
            }
            let dlambda = point.lambda_step(&lack, &dP[..rows], &dv[..rows]);
            let moved = |s: f64| {
                let add = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] + s * b[k]);
                let y = (add(x.0, dP), add(x.1, dv), x.2 + s * dlambda);
                at(mu, &y, rows).products()
            };
            let (up, down) = (moved(size), moved(-size));
            let slope = |a: f64, b: f64| (a - b) / (2.0 * size);
            let scale = 1.0 + dlambda.abs() + 1.0 / mu;
            let close = |found: f64, wanted: f64| (found - wanted).abs() < 1e-7 * scale * scale;
            prop_assert!(close(slope(up.normal, down.normal), lack.normal));
            prop_assert!(close(slope(up.scalar, down.scalar), lack.scalar));
            for k in 1..rows {
                prop_assert!(close(slope(up.vector[k - 1], down.vector[k - 1]), lack.vector[k - 1]));
            }
        }

        /// The longest step ends on a boundary, or is the longest asked for; everything before is inside.
        #[test]
        fn the_longest_step_ends_at_the_boundary(
            mu in 0.05..3.0_f64, x in prop::array::uniform6(-2.0..2.0_f64), y in prop::array::uniform6(-2.0..2.0_f64),
            dlambda in -2.0..2.0_f64, rows in 1..=3_usize,
        ) {
            let x = inside(mu, &x, rows);
            let (dP, dv) = ([y[0], y[1], y[2]], [y[3], y[4], y[5]]);
            let step = (dP, dv, dlambda);
            let t = at(mu, &x, rows).step_length(&at(mu, &step, rows), 10.0);
            let margin_at = |t: f64| {
                let add = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] + t * b[k]);
                margin(&at(mu, &(add(x.0, dP), add(x.1, dv), x.2 + t * dlambda), rows))
            };
            prop_assert!(margin(&at(mu, &x, rows)) > 0.0);
            prop_assert!((1..100).all(|i| margin_at(t * f64::from(i) / 100.0) > 0.0));
            prop_assert!(t == 10.0 || margin_at(t).abs() < 1e-9, "{t} {}", margin_at(t));
        }
    }
}
