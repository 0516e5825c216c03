//! Contact laws smoothed by a barrier, at one point: forces, their derivative, and how far a pair (P, v) is from them.
//! ```text
//! P_n = −B'(g),  B = −κ (g − ĝ)² ln(g/ĝ) for 0 < g < ĝ, else 0
//! P_t = −μ P_n f(|d|/ε) d/|d|,  f(y) = 2 y − y² for y < 1, else 1
//! ```
//! Zhao, Choo, Jiang, Li, Jiang & Soga 2022; barrier and mollifier: Li et al. 2020.

#![allow(non_snake_case)]

use crate::contract::law::tangential_norm;
use crate::contract::state::Claim;

/// Steps of the scalar solve of [`BarrierLaw::mismatch`]: bisection alone would need fewer.
const SCALAR_STEPS: usize = 200;

/// The smoothed laws with their parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BarrierLaw {
    /// ĝ in m.
    pub gap: f64,
    /// ε in m.
    pub slip: f64,
    /// κ in N/m.
    pub stiffness: f64,
}

/// b and b' with P_n = κ ĝ b(g/ĝ).
fn barrier(y: f64) -> (f64, f64) {
    if y >= 1.0 {
        return (0.0, 0.0);
    }
    let log = y.ln();
    let force = 2.0 * (y - 1.0) * log + (1.0 - y).powi(2) / y;
    (force, 2.0 * log + 3.0 - 2.0 / y - 1.0 / (y * y))
}

impl BarrierLaw {
    /// That these laws hold.
    pub fn claim(&self) -> Claim {
        Claim::Barrier {
            gap: self.gap,
            slip: self.slip,
            stiffness: self.stiffness,
        }
    }

    /// The same laws with ĝ and ε multiplied and the forces kept: P(factor · v) is P(v) of before.
    pub fn widened(&self, factor: f64) -> Self {
        Self {
            gap: factor * self.gap,
            slip: factor * self.slip,
            stiffness: self.stiffness / factor,
        }
    }

    /// f(s/ε)/s, and its derivative with respect to s.
    fn mollifier(&self, s: f64) -> (f64, f64) {
        if s < self.slip {
            ((2.0 - s / self.slip) / self.slip, -1.0 / self.slip.powi(2))
        } else {
            (1.0 / s, -1.0 / (s * s))
        }
    }

    /// P of one point; `v` = (g, d) with g > 0.
    pub fn forces(&self, mu: f64, v: &[f64]) -> [f64; 3] {
        let normal = self.stiffness * self.gap * barrier(v[0] / self.gap).0;
        let (f, _) = self.mollifier(tangential_norm(v));
        let mut p = [normal, 0.0, 0.0];
        for k in 1..v.len() {
            p[k] = -mu * normal * f * v[k];
        }
        p
    }

    /// ∂P/∂v: row i, column j is ∂P_i/∂v_j.
    pub fn derivative(&self, mu: f64, v: &[f64]) -> [[f64; 3]; 3] {
        let (force, slope) = barrier(v[0] / self.gap);
        let (normal, slope) = (self.stiffness * self.gap * force, self.stiffness * slope);
        let s = tangential_norm(v);
        let (f, df) = self.mollifier(s);
        let mut d = [[0.0; 3]; 3];
        d[0][0] = slope;
        for k in 1..v.len() {
            d[k][0] = -mu * slope * f * v[k];
            d[k][k] = -mu * normal * f;
            for l in (1..v.len()).filter(|_| s > 0.0) {
                d[k][l] -= mu * normal * df * v[k] * v[l] / s;
            }
        }
        d
    }

    /// |P − P'|² with (P', v') the pair on the laws that has P' − ρ v' = P − ρ v, friction under the given P_n.
    ///
    /// Both laws are monotone, so the pair is unique, and the distance is defined for any P and v, penetrating ones
    /// too. Near the barrier it is the force mismatch divided by 1 + B''/ρ: rounding of v costs ρ times itself.
    pub fn mismatch_squared(&self, mu: f64, rho: f64, p: &[f64], v: &[f64]) -> f64 {
        let normal = rho * (v[0] - self.resolved_gap(rho, p[0] - rho * v[0]));
        let mut z = [0.0; 3];
        for k in 1..p.len() {
            z[k] = p[k] - rho * v[k];
        }
        let size = tangential_norm(&z[..p.len()]);
        // s solves a f(s/ε) + ρ s = |z|.
        let a = mu * p[0].max(0.0);
        let s = if size >= a + rho * self.slip {
            (size - a) / rho
        } else {
            let b = 2.0 * a + rho * self.slip;
            self.slip * 2.0 * size / (b + (b * b - 4.0 * a * size).sqrt())
        };
        let mut sum = normal * normal;
        for k in 1..p.len() {
            let opposed = if size > 0.0 { -s * z[k] / size } else { 0.0 };
            sum += (rho * (v[k] - opposed)).powi(2);
        }
        sum
    }

    /// The gap g' with −B'(g') − ρ g' = z.
    fn resolved_gap(&self, rho: f64, z: f64) -> f64 {
        let (a, c) = (self.stiffness * self.gap, rho * self.gap);
        if z <= -c {
            return -z / rho;
        }
        // a b(y) − c y falls from ∞ at y = 0 to −c at y = 1, and b(y) >= 1/y − 2. Newton in ln y, kept in the bracket.
        let (mut low, mut high) = ((1.0 / ((z + c) / a + 2.0)).ln(), 0.0);
        let mut x: f64 = 0.5 * low;
        for _ in 0..SCALAR_STEPS {
            let y = x.exp();
            let (b, slope) = barrier(y);
            let value = a * b - c * y - z;
            if value > 0.0 {
                low = x;
            } else {
                high = x;
            }
            let newton = x - value / ((a * slope - c) * y);
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if next == x {
                break;
            }
            x = next;
        }
        self.gap * x.exp()
    }
}

/// S = (I − r⁻¹ D)⁻¹ of one point, D as from [`BarrierLaw::derivative`]. The normal row of D has the normal entry only,
/// its tangential block is symmetric.
pub(crate) fn resolvent(D: &[[f64; 3]; 3], r: &[f64]) -> [[f64; 3]; 3] {
    let mut S = [[0.0; 3]; 3];
    S[0][0] = 1.0 / (1.0 - D[0][0] / r[0]);
    if r.len() == 1 {
        return S;
    }
    // One r for both tangential rows, as in `ContactProblem::scales`.
    let t = |a: usize, b: usize| f64::from(u8::from(a == b)) - D[a][b] / r[1];
    if r.len() == 2 {
        S[1][1] = 1.0 / t(1, 1);
    } else {
        let determinant = t(1, 1) * t(2, 2) - t(1, 2) * t(2, 1);
        S[1][1] = t(2, 2) / determinant;
        S[2][2] = t(1, 1) / determinant;
        S[1][2] = -t(1, 2) / determinant;
        S[2][1] = -t(2, 1) / determinant;
    }
    for a in 1..r.len() {
        S[a][0] = (1..r.len()).map(|b| S[a][b] * D[b][0] / r[1]).sum::<f64>() * S[0][0];
    }
    S
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LAW: BarrierLaw = BarrierLaw {
        gap: 0.5,
        slip: 0.2,
        stiffness: 3.0,
    };

    #[test]
    fn the_force_is_minus_the_derivative_of_the_barrier_energy() {
        let energy = |g: f64| -LAW.stiffness * (g - LAW.gap).powi(2) * (g / LAW.gap).ln();
        for g in [0.01, 0.1, 0.3, 0.49] {
            let h = 1e-6 * g;
            let difference = (energy(g - h) - energy(g + h)) / (2.0 * h);
            let force = LAW.forces(0.0, &[g])[0];
            assert!((force - difference).abs() < 1e-7 * force, "{g}");
        }
        assert_eq!(LAW.forces(1.0, &[0.5, 1.0]), [0.0; 3]);
        // Energy and force close smoothly.
        let near = LAW.forces(0.0, &[0.5 - 1e-6])[0];
        assert!(near > 0.0 && near < 1e-10);
    }

    proptest! {
        #[test]
        fn the_derivative_matches_differences(
            mu in 0.0..3.0_f64, g in 0.02..0.6_f64, d in prop::array::uniform2(-0.5..0.5_f64), k in 0..3_usize,
        ) {
            let v = [g, d[0], d[1]];
            let s = tangential_norm(&v);
            // Away from where second derivatives jump.
            prop_assume!(s > 1e-2 && (s - LAW.slip).abs() > 1e-3 && (g - LAW.gap).abs() > 1e-3);
            let h = 1e-7;
            let (mut up, mut down) = (v, v);
            up[k] += h;
            down[k] -= h;
            let (up, down) = (LAW.forces(mu, &up), LAW.forces(mu, &down));
            let found = LAW.derivative(mu, &v);
            for i in 0..3 {
                let difference = (up[i] - down[i]) / (2.0 * h);
                prop_assert!((found[i][k] - difference).abs() < 1e-5 * (1.0 + difference.abs()));
            }
        }

        #[test]
        fn the_resolvent_inverts(
            mu in 0.0..3.0_f64, g in 1e-6..0.6_f64, d in prop::array::uniform2(-0.5..0.5_f64), r in prop::array::uniform2(0.1..10.0_f64), size in 1..4_usize,
        ) {
            let v = [g, d[0], d[1]];
            let r = [r[0], r[1], r[1]];
            let (D, S) = (LAW.derivative(mu, &v[..size]), resolvent(&LAW.derivative(mu, &v[..size]), &r[..size]));
            for a in 0..size {
                for b in 0..size {
                    let (mut product, mut largest) = (0.0, 1.0_f64);
                    for c in 0..size {
                        let term = (f64::from(u8::from(a == c)) - D[a][c] / r[a]) * S[c][b];
                        product += term;
                        largest = largest.max(term.abs());
                    }
                    let expected = f64::from(u8::from(a == b));
                    prop_assert!((product - expected).abs() < 1e-9 * largest, "{a} {b}: {product}");
                }
            }
        }

        #[test]
        fn pairs_on_the_laws_have_no_mismatch_and_others_as_much_as_they_were_moved(
            mu in 0.0..3.0_f64, y in 1e-9..2.0_f64, d in prop::array::uniform2(-0.5..0.5_f64), rho in 1e-3..1e3_f64, by in -1.0..1.0_f64,
        ) {
            let v = [y * LAW.gap, d[0], d[1]];
            let p = LAW.forces(mu, &v);
            let scale = 1.0 + rho + p[0] * (1.0 + mu);
            prop_assert!(LAW.mismatch_squared(mu, rho, &p, &v).sqrt() < 1e-12 * scale);
            // Nonexpansive: a jump wrong by `by` counts at most ρ |by|, even through the barrier.
            let moved = [v[0] + by, v[1], v[2]];
            let found = LAW.mismatch_squared(mu, rho, &p, &moved).sqrt();
            prop_assert!(found <= rho * by.abs() + 1e-12 * scale);
            let penetrates = [-by.abs() - 1e-3, v[1], v[2]];
            let found = LAW.mismatch_squared(mu, rho, &p, &penetrates).sqrt();
            prop_assert!(found >= rho * (by.abs() + 1e-3) * (1.0 - 1e-12) - 1e-12 * scale || p[0] > 0.0);
            prop_assert!(found > 0.0);
        }

        #[test]
        fn every_broken_law_is_seen(y in 0.1..0.9_f64, d in 0.3..0.5_f64, amount in 0.1..1.0_f64) {
            let (mu, v) = (0.5, [y * LAW.gap, d]);
            let p = LAW.forces(mu, &v);
            for broken in [[p[0] + amount, p[1]], [p[0], p[1] + amount], [p[0], -p[1]], [-amount, 0.0]] {
                let found = LAW.mismatch_squared(mu, 1.0, &broken, &v).sqrt();
                let size = (broken[0] - p[0]).hypot(broken[1] - p[1]);
                prop_assert!(found > 1e-4 * size, "{broken:?}: {found:e}");
            }
        }

        #[test]
        fn widening_keeps_the_forces(mu in 0.0..3.0_f64, g in 0.02..0.6_f64, d in -0.5..0.5_f64, factor in 1e-6..1.0_f64) {
            let (a, b) = (LAW.forces(mu, &[g, d]), LAW.widened(factor).forces(mu, &[factor * g, factor * d]));
            for k in 0..2 {
                prop_assert!((a[k] - b[k]).abs() <= 1e-9 * (1.0 + a[k].abs()));
            }
        }
    }
}
