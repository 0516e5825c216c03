//! Potential of an elliptic disc and the elastic field of a jump across it, in closed form.
//!
//! ```text
//!   V(x) = ∫ w(y) / |x − y| dA,   w = √(1 − y₀²/a² − y₁²/b²) on the disc z = 0
//!        = (π a b / 2) ∫_λ^∞ (1 − x²/(a²+s) − y²/(b²+s) − z²/s) ds / √Q(s),   Q = (a²+s)(b²+s) s
//!   λ: largest root of x²/(a²+λ) + y²/(b²+λ) + z²/λ = 1
//!
//!   I₀ = ∫_λ^∞ ds/((a²+s)√Q) = ⅔ R_D(B, λ, A),   I₁ = ⅔ R_D(A, λ, B),   A = a² + λ, B = b² + λ
//!   ζ = z/√λ,  q = (x/A, y/B),  P = |q|²,  h = λ P + ζ²,  c = 2/√(A B)                 (α, β in the plane)
//!   V_α  = −π a b x_α I_α                          V_z  = −π a b (c ζ − z (I₀ + I₁))
//!   V_αβ = −π a b (δ_αβ I_α − c √λ q_α q_β / h)     V_αz = π a b c q_α ζ / h           V_zz = −V_xx − V_yy
//! ```
//!
//! The limit of a homogeneous ellipsoid (Kellogg 1929, ch. VII; Segedin 1950 for cracks), written with ζ instead of z/√λ,
//! so that nothing cancels or divides by zero as λ → 0 on the disc. R_D: Carlson (1995), "Numerical computation of real
//! or complex elliptic integrals". Accurate to rounding up to the rim, where h = 0 and second derivatives are singular.

//!
//! The field of the jump D w, D uniform, is the double layer of Somigliana's identity,
//!
//! ```text
//!   8π(1−ν) u_i = ∫ [(1−2ν)(D_i r·n + n_i r·D − r_i D·n) + 3 r_i r·n r·D/r²] w/r³ dA,   r = x − y
//!               = −2(1−ν) D_i V_z − (1−2ν)(δ_iz D_j V_j − D_z V_i) + z D_j V_ij
//! ```

use std::f64::consts::PI;

/// Derivatives of V at a point; index 2 is z.
#[derive(Debug, Clone, Copy)]
pub struct DiscPotential {
    /// V_i.
    pub first: [f64; 3],
    /// V_ij; singular on the rim.
    pub second: [[f64; 3]; 3],
    /// z V_ij, 0 on the disc and its rim.
    pub z_second: [[f64; 3]; 3],
    /// z V_ijk; singular on the rim.
    pub z_third: [[[f64; 3]; 3]; 3],
}

/// I₀(0) and I₁(0): the integrals on the disc itself [1/m³].
pub fn disc_integrals([a, b]: [f64; 2]) -> [f64; 2] {
    integrals([a * a, b * b], 0.0)
}

/// I₀ and I₁ for A, B and λ.
fn integrals([a, b]: [f64; 2], lambda: f64) -> [f64; 2] {
    [
        2.0 / 3.0 * carlson_rd(b, lambda, a),
        2.0 / 3.0 * carlson_rd(a, lambda, b),
    ]
}

/// Derivatives of V at x = (x, y, z) in the disc's frame; for z = 0 the limit from the side z → 0 with the sign `side`.
pub fn disc_potential([a, b]: [f64; 2], [x, y, z]: [f64; 3], side: f64) -> DiscPotential {
    let lambda = confocal([a * a, b * b], [x, y, z]);
    let root = lambda.sqrt();
    let squares = [a * a + lambda, b * b + lambda];
    let zeta = if z != 0.0 {
        z / root
    } else if lambda == 0.0 {
        let inside = 1.0 - (x / a).powi(2) - (y / b).powi(2);
        inside.max(0.0).sqrt().copysign(side)
    } else {
        0.0
    };
    let i = integrals(squares, lambda);
    let q = [x / squares[0], y / squares[1]];
    let p = q[0] * q[0] + q[1] * q[1];
    let h = lambda * p + zeta * zeta;
    let c = 2.0 / (squares[0] * squares[1]).sqrt();
    let factor = PI * a * b;

    let first = [
        -factor * x * i[0],
        -factor * y * i[1],
        -factor * (c * zeta - z * (i[0] + i[1])),
    ];
    // (scale, numerators over h): V_ij itself, and z V_ij with z = ζ √λ, whose numerators vanish faster than h.
    let assemble = |scale: f64, plane: f64, mixed: f64| {
        let mut v = [[0.0; 3]; 3];
        for k in 0..2 {
            for l in 0..2 {
                let unit = if k == l { scale * i[k] } else { 0.0 };
                v[k][l] = -factor * (unit - c * plane * q[k] * q[l]);
            }
            v[k][2] = factor * c * q[k] * mixed;
            v[2][k] = v[k][2];
        }
        v[2][2] = -v[0][0] - v[1][1];
        v
    };
    let over_h = |numerator: f64| if h == 0.0 { 0.0 } else { numerator / h };
    let second = assemble(1.0, root / h, zeta / h);
    let z_second = assemble(z, over_h(zeta * lambda), over_h(zeta * zeta * root));

    let inverse = [1.0 / squares[0], 1.0 / squares[1]];
    let s3 = q[0] * q[0] * inverse[0] + q[1] * q[1] * inverse[1];
    let common = 4.0 * lambda * s3 / h - inverse[0] - inverse[1];
    let delta = |k: usize, l: usize| if k == l { inverse[k] } else { 0.0 };
    let mut third = [[[0.0; 3]; 3]; 3];
    for k in 0..2 {
        for l in 0..2 {
            let pair = q[k] * q[l] / h;
            for m in 0..2 {
                let rest = (3.0 * zeta * zeta - lambda * p) / h
                    + lambda * (common - 2.0 * (inverse[k] + inverse[l] + inverse[m]));
                let direct = delta(k, l) * q[m] + delta(k, m) * q[l] + delta(l, m) * q[k];
                third[k][l][m] = factor * c * zeta * lambda / h * (direct + pair * q[m] * rest);
            }
            let rest = (zeta * zeta - 3.0 * lambda * p) / h
                + lambda * (common - 2.0 * (inverse[k] + inverse[l]));
            let value = factor * c * zeta * zeta * root / h * (delta(k, l) + pair * rest);
            for [r, s, t] in [[k, l, 2], [k, 2, l], [2, k, l]] {
                third[r][s][t] = value;
            }
        }
    }
    // V is harmonic: two z in terms of none.
    for k in 0..3 {
        let value = -third[k][0][0] - third[k][1][1];
        for [r, s, t] in [[k, 2, 2], [2, k, 2], [2, 2, k]] {
            third[r][s][t] = value;
        }
    }
    DiscPotential {
        first,
        second,
        z_second,
        z_third: third,
    }
}

impl DiscPotential {
    /// Displacement of the jump D w across the disc, in the disc's frame [m].
    pub fn displacement(&self, d: [f64; 3], poisson: f64) -> [f64; 3] {
        let along: f64 = (0..3).map(|j| d[j] * self.first[j]).sum();
        [0, 1, 2].map(|i| {
            let mut u = -2.0 * (1.0 - poisson) * d[i] * self.first[2];
            u += (1.0 - 2.0 * poisson) * d[2] * self.first[i];
            if i == 2 {
                u -= (1.0 - 2.0 * poisson) * along;
            }
            u += (0..3).map(|j| d[j] * self.z_second[i][j]).sum::<f64>();
            u / (8.0 * PI * (1.0 - poisson))
        })
    }

    /// Its gradient ∂u_i/∂x_k as [i][k].
    pub fn gradient(&self, d: [f64; 3], poisson: f64) -> [[f64; 3]; 3] {
        let mut g = [[0.0; 3]; 3];
        for i in 0..3 {
            for k in 0..3 {
                let sum = |f: &dyn Fn(usize) -> f64| (0..3).map(|j| d[j] * f(j)).sum::<f64>();
                let mut value = -2.0 * (1.0 - poisson) * d[i] * self.second[2][k];
                value += (1.0 - 2.0 * poisson) * d[2] * self.second[i][k];
                if i == 2 {
                    value -= (1.0 - 2.0 * poisson) * sum(&|j| self.second[j][k]);
                }
                if k == 2 {
                    value += sum(&|j| self.second[i][j]);
                }
                value += sum(&|j| self.z_third[i][j][k]);
                g[i][k] = value / (8.0 * PI * (1.0 - poisson));
            }
        }
        g
    }
}

/// λ >= 0 of the confocal ellipsoid through a point; 0 on the disc.
///
/// F(λ) = Σ x_i²/(a_i² + λ) = 1 by Newton's method on 1/√F, which is concave: monotone from the left.
fn confocal([a2, b2]: [f64; 2], [x, y, z]: [f64; 3]) -> f64 {
    /// Newton steps; 3 to 8 are needed.
    const STEPS: usize = 60;
    let squares = [x * x, y * y, z * z];
    let axes = [a2, b2, 0.0];
    let terms = |lambda: f64| {
        let (mut f, mut slope) = (0.0, 0.0); // F and −F'
        for (square, axis) in squares.iter().zip(axes) {
            if *square > 0.0 {
                f += square / (axis + lambda);
                slope += square / (axis + lambda).powi(2);
            }
        }
        (f, slope)
    };
    let mut lambda = squares[2]
        .max(squares[0] - a2)
        .max(squares[1] - b2)
        .max(0.0);
    if terms(lambda).0 < 1.0 && squares[2] == 0.0 {
        return 0.0;
    }
    for _ in 0..STEPS {
        let (f, slope) = terms(lambda);
        let step = 2.0 * f * (f.sqrt() - 1.0) / slope;
        if step.is_nan() || step <= 1e-16 * lambda {
            break;
        }
        lambda += step;
    }
    lambda
}

/// Carlson's R_D(x, y, z) = (3/2) ∫₀^∞ dt / (√(t+x) √(t+y) (t+z)^{3/2}); x, y >= 0, not both 0, z > 0.
fn carlson_rd(x: f64, y: f64, z: f64) -> f64 {
    /// Spread at which the series below has rounding accuracy: its error is 3 spread⁶.
    const SPREAD: f64 = 0.0015;
    let (mut x, mut y, mut z) = (x, y, z);
    let (mut sum, mut power) = (0.0, 1.0);
    loop {
        let mean = (x + y + 3.0 * z) / 5.0;
        let (dx, dy, dz) = ((mean - x) / mean, (mean - y) / mean, (mean - z) / mean);
        if dx.abs().max(dy.abs()).max(dz.abs()) < SPREAD || !mean.is_finite() {
            let (ea, eb) = (dx * dy, dz * dz);
            let (ec, ed) = (ea - eb, ea - 6.0 * eb);
            let ee = ed + 2.0 * ec;
            let series = 1.0
                + ed * (-3.0 / 14.0 + 9.0 / 88.0 * ed - 9.0 / 52.0 * dz * ee)
                + dz * (ee / 6.0 + dz * (-9.0 / 22.0 * ec + dz * 3.0 / 26.0 * ea));
            return 3.0 * sum + power * series / (mean * mean.sqrt());
        }
        let (rx, ry, rz) = (x.sqrt(), y.sqrt(), z.sqrt());
        let shift = rx * (ry + rz) + ry * rz;
        sum += power / (rz * (z + shift));
        power *= 0.25;
        x = 0.25 * (x + shift);
        y = 0.25 * (y + shift);
        z = 0.25 * (z + shift);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{dot, norm, sub};
    use crate::quadrature::gauss;

    #[test]
    fn carlson_rd_has_the_published_values() {
        // The first two: Carlson (1995), table of checks, to its 14 digits; all: 30-digit arithmetic.
        for (x, y, z, exact) in [
            (0.0, 2.0, 1.0, 1.797_210_352_103_388_3),
            (2.0, 3.0, 4.0, 0.165_105_272_942_610_53),
            (0.25, 1.0, 4.0, 0.337_051_324_726_511_6),
            (1e-12, 1.0, 0.25, 10.750_809_851_147_346),
        ] {
            let found = carlson_rd(x, y, z);
            assert!(
                (found - exact).abs() < 1e-15 * exact.max(1.0),
                "{found} {exact}"
            );
        }
    }

    /// ∫ w f(x − y) dA by quadrature: y = (a ρ cos t, b ρ sin t), ρ = sin s; spectral off the disc.
    fn by_quadrature([a, b]: [f64; 2], x: [f64; 3], f: impl Fn([f64; 3]) -> [f64; 3]) -> [f64; 3] {
        let angles = 400;
        let mut sum = [0.0; 3];
        for (s, ws) in gauss(60) {
            let s = 0.25 * PI * (1.0 + s);
            for k in 0..angles {
                let t = 2.0 * PI * f64::from(k) / f64::from(angles);
                // w dA = cos s · a b sin s cos s ds dt
                let weight = a * b * s.sin() * s.cos().powi(2) * 0.25 * PI * ws * 2.0 * PI
                    / f64::from(angles);
                let (p, q) = (a * s.sin() * t.cos(), b * s.sin() * t.sin());
                let value = f([x[0] - p, x[1] - q, x[2]]);
                for i in 0..3 {
                    sum[i] += weight * value[i];
                }
            }
        }
        sum
    }

    const DISCS: [[f64; 2]; 3] = [[1.0, 1.0], [1.0, 0.5], [0.3, 0.8]];
    const OFF: [[f64; 3]; 4] = [
        [0.2, 0.1, 0.5],
        [1.5, 0.3, 0.0],
        [0.0, 0.0, -0.7],
        [-0.8, 0.9, 0.2],
    ];

    #[test]
    fn the_displacement_is_the_double_layer_of_the_jump() {
        let (d, nu) = ([0.4, -0.7, 0.9], 0.3);
        for axes in DISCS {
            for x in OFF {
                let found = disc_potential(axes, x, 1.0).displacement(d, nu);
                let exact = by_quadrature(axes, x, |r| {
                    let r2 = dot(&r, &r);
                    let (rd, n) = (dot(&r, &d), [0.0, 0.0, 1.0]);
                    [0, 1, 2].map(|i| {
                        ((1.0 - 2.0 * nu) * (d[i] * r[2] + n[i] * rd - r[i] * d[2])
                            + 3.0 * r[i] * r[2] * rd / r2)
                            / (r2.powf(1.5) * 8.0 * PI * (1.0 - nu))
                    })
                });
                let error = norm(&sub(&found, &exact));
                assert!(error < 1e-9, "{axes:?} {x:?}: {found:?} {exact:?}");
            }
        }
    }
}
