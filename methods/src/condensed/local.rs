//! The contact problem of one point with all others held, solved exactly.
//! ```text
//! v = (g, d) = q + W P,   0 <= g ⊥ P_n >= 0,   |P_t| <= μ P_n,   d ≠ 0 ⇒ P_t = −μ P_n d/|d|
//!
//! open    q_n >= 0                   P = 0
//! closed  g = 0  eliminates P_n:     P_n = −(q_n + w·P_t)/W_nn,   d = b + S P_t
//!                                    w = W_ntᵀ,  w' = W_tn,  S = W_tt − w' wᵀ/W_nn,  b = q_t − w' q_n/W_nn
//!         d = −α P_t, α >= 0:        P_t(α) = −(S + α I)⁻¹ b
//! stick   α = 0                      if |P_t(0)| <= μ P_n(0)
//! slip    |P_t(α)| = μ P_n(α)        one equation in α, a quartic once cleared of fractions
//! ```
//! (Bonnefon & Daviet, INRIA research report (2011): quartic formulation of Coulomb 3D frictional contact.) Where the point
//! does not stick, |P_t| − μ P_n is positive at α = 0 and tends to μ q_n/W_nn < 0 for α → ∞: a root always exists for
//! definite W, whatever μ, symmetric or not. In 2D it is unique and explicit. In 3D ψ(α) = μ P_n/|P_t| − 1 is linear in α where S is
//! isotropic and nearly linear elsewhere: Newton's method on ψ, kept inside a bracket by bisection, takes a handful of
//! steps and always the same root. A point that may open opens, even if for large μ it might also stay closed.

use crate::contract::law::{Branch, tangential_norm};

/// Newton or bisection steps; bisection alone leaves nothing of a bracket of doubles after so many.
const MAX_STEPS: usize = 200;

/// W at one point, prepared for repeated solves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalOperator {
    /// Rows of the point, 1, 2 or 3.
    size: usize,
    w_nn: f64,
    /// W_nt.
    w: [f64; 2],
    /// W_tn.
    below: [f64; 2],
    /// S by row.
    s: [[f64; 2]; 2],
}

impl LocalOperator {
    /// For the positive definite block with entries `w(k, l)`, k, l < `size`.
    pub fn new(size: usize, w: impl Fn(usize, usize) -> f64) -> Self {
        let mut operator = Self {
            size,
            w_nn: w(0, 0),
            w: [0.0; 2],
            below: [0.0; 2],
            s: [[0.0; 2]; 2],
        };
        for k in 1..size {
            operator.w[k - 1] = w(0, k);
            operator.below[k - 1] = w(k, 0);
            for l in 1..size {
                operator.s[k - 1][l - 1] = w(k, l) - w(k, 0) * w(0, l) / w(0, 0);
            }
        }
        operator
    }

    /// P for v = `q` + W P; entries beyond the size of the point are 0.
    pub fn solve(&self, mu: f64, q: &[f64]) -> ([f64; 3], Branch) {
        if q[0] >= 0.0 {
            return ([0.0; 3], Branch::Open);
        }
        let mut b = [0.0; 2];
        for (k, b) in b[..self.size - 1].iter_mut().enumerate() {
            *b = q[k + 1] - self.below[k] * q[0] / self.w_nn;
        }
        let stick = self.closed(q[0], b, 0.0);
        if tangential_norm(&stick[..self.size]) <= mu * stick[0] {
            return (stick, Branch::Stick);
        }
        (self.slip(mu, q[0], b), Branch::Slip)
    }

    /// (P_n, P_t) of α.
    fn closed(&self, q_n: f64, b: [f64; 2], alpha: f64) -> [f64; 3] {
        let p_t = self.shifted_solve(alpha, b).map(|x| -x);
        let p_n = -(q_n + self.w[0] * p_t[0] + self.w[1] * p_t[1]) / self.w_nn;
        [p_n, p_t[0], p_t[1]]
    }

    /// (S + α I)⁻¹ x.
    fn shifted_solve(&self, alpha: f64, x: [f64; 2]) -> [f64; 2] {
        let a = self.s[0][0] + alpha;
        match self.size {
            3 => {
                // Elimination, not Cramer's rule: the determinant of small blocks may underflow.
                let factor = self.s[1][0] / a;
                let y = (x[1] - factor * x[0]) / (self.s[1][1] + alpha - factor * self.s[0][1]);
                [(x[0] - self.s[0][1] * y) / a, y]
            }
            2 => [x[0] / a, 0.0],
            _ => [0.0; 2],
        }
    }

    /// The force on the cone that opposes the slip.
    fn slip(&self, mu: f64, q_n: f64, b: [f64; 2]) -> [f64; 3] {
        if self.size == 2 {
            let e = -b[0].signum();
            let p_n = -q_n / (self.w_nn + mu * self.w[0] * e);
            return [p_n, mu * p_n * e, 0.0];
        }
        let p = self.closed(q_n, b, self.slip_root(mu, q_n, b));
        let t = p[1].hypot(p[2]);
        [p[0], mu * p[0] * p[1] / t, mu * p[0] * p[2] / t]
    }

    /// α > 0 with ψ(α) = 0.
    fn slip_root(&self, mu: f64, q_n: f64, b: [f64; 2]) -> f64 {
        let (mut low, mut high) = (0.0_f64, f64::INFINITY);
        let mut alpha = 0.0;
        for _ in 0..MAX_STEPS {
            let [p_n, x, y] = self.closed(q_n, b, alpha);
            let t = x.hypot(y);
            let psi = mu * p_n / t - 1.0;
            if psi < 0.0 {
                low = alpha;
            } else {
                high = alpha;
            }
            // dP_t/dα = −(S + α I)⁻¹ P_t.
            let [dx, dy] = self.shifted_solve(alpha, [x, y]).map(|x| -x);
            let dp_n = -(self.w[0] * dx + self.w[1] * dy) / self.w_nn;
            let dt = (x * dx + y * dy) / t;
            let slope = mu * (dp_n - p_n * dt / t) / t;
            let newton = alpha - psi / slope;
            let next = if newton > low && newton < high {
                newton
            } else if high.is_finite() {
                low + 0.5 * (high - low)
            } else {
                2.0 * (low + self.s[0][0] + self.s[1][1])
            };
            if (next - alpha).abs() <= f64::EPSILON * alpha {
                return next;
            }
            alpha = next;
        }
        alpha
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::law::natural_map_squared;
    use proptest::prelude::*;

    /// A random positive definite block Mᵀ M + shift, times a unit.
    fn block(size: usize, m: [[f64; 3]; 3], shift: f64, unit: f64) -> [[f64; 3]; 3] {
        let mut w = [[0.0; 3]; 3];
        for i in 0..size {
            for j in 0..size {
                let dot: f64 = (0..size).map(|k| m[k][i] * m[k][j]).sum();
                w[i][j] = unit * (dot + if i == j { shift } else { 0.0 });
            }
        }
        w
    }

    fn norm(x: &[f64]) -> f64 {
        x.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    fn matrix() -> impl Strategy<Value = [[f64; 3]; 3]> {
        prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]

        #[test]
        fn solutions_fulfil_the_law_at_rounding(
            size in 1..=3_usize, m in matrix(), q in prop::array::uniform3(-1.0..1.0_f64),
            mu in prop_oneof![Just(0.0), 0.0..5.0_f64], shift in 0.05..1.0_f64, power in -12..3_i32,
        ) {
            let unit = 10.0_f64.powi(power);
            let w = block(size, m, shift, unit);
            let q = &q[..size];
            let (p, branch) = LocalOperator::new(size, |k, l| w[k][l]).solve(mu, q);
            let p = &p[..size];
            let v: Vec<f64> = (0..size).map(|k| q[k] + (0..size).map(|l| w[k][l] * p[l]).sum::<f64>()).collect();
            let rho = size as f64 / (0..size).map(|k| w[k][k]).sum::<f64>();
            let e = natural_map_squared(mu, rho, p, &v).sqrt();
            prop_assert!(e <= 1e-13 * norm(p).max(rho * norm(q)), "{branch:?} {e:e} {p:?} {v:?}");
            match branch {
                Branch::Open => prop_assert!(v[0] >= 0.0 && p.iter().all(|&p| p == 0.0)),
                Branch::Stick => prop_assert!(p[0] > 0.0 && tangential_norm(p) <= mu * p[0]),
                Branch::Slip => prop_assert!(p[0] > 0.0),
            }
        }

        #[test]
        fn solutions_turn_with_the_tangent_frame(
            m in matrix(), q in prop::array::uniform3(-1.0..1.0_f64), mu in 0.0..1.0_f64, angle in 0.0..6.3_f64,
        ) {
            let (sin, cos) = angle.sin_cos();
            let r = [[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]];
            let w = block(3, m, 0.3, 1.0);
            let turn = |x: [f64; 3]| [0, 1, 2].map(|i| (0..3).map(|j| r[i][j] * x[j]).sum::<f64>());
            let turned = |i: usize, j: usize| (0..3).map(|k| (0..3).map(|l| r[i][k] * w[k][l] * r[j][l]).sum::<f64>()).sum();
            let (p, _) = LocalOperator::new(3, |k, l| w[k][l]).solve(mu, &q);
            let (c, _) = LocalOperator::new(3, turned).solve(mu, &turn(q));
            let p = turn(p);
            let error = norm(&[p[0] - c[0], p[1] - c[1], p[2] - c[2]]);
            prop_assert!(error <= 1e-10 * norm(&q), "{p:?} {c:?}");
        }
    }
}
