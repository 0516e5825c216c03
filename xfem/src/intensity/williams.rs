//! Leading terms of the field at a crack tip: the √r displacements of unit stress intensity.
//!
//! ```text
//!   c = 1/(2 μ √(2π)),  κ = (λ + 3μ)/(λ + μ)     axes 1 ahead, 2 crack normal, 3 their product;  g_l the branch functions
//!
//!   K_I = 1:    u₁ = c [(κ − 1) g₂ + g₃]     u₂ = c [(κ + 1) g₁ − g₄]
//!   K_II = 1:   u₁ = c [(κ + 1) g₁ + g₄]     u₂ = c [(1 − κ) g₂ + g₃]
//!   K_III = 1:  u₃ = 4 c g₁
//! ```
//!
//! Williams, J. Appl. Mech. 24 (1957) 109, with g₁ … g₄ for √r sin θ/2, √r cos θ/2, √r sin θ/2 sin θ, √r cos θ/2 sin θ.
//! κ in Lamé's constants holds in plane strain, with the effective λ in plane stress.

use std::f64::consts::PI;

use crate::geometry::clip::Side;
use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, cross};
use crate::material::Lame;

/// E' of plane strain or plane stress, 8 μ/(κ + 1) = 4 μ (λ + μ)/(λ + 2μ) [Pa].
pub fn plane_modulus(lame: Lame) -> f64 {
    4.0 * lame.mu * (lame.lambda + lame.mu) / (lame.lambda + 2.0 * lame.mu)
}

/// ν' of plane strain or plane stress: ε_xx = (σ_xx − ν' σ_yy)/E'.
pub fn plane_ratio(lame: Lame) -> f64 {
    lame.lambda / (lame.lambda + 2.0 * lame.mu)
}

/// Kolosov's constant κ.
pub fn kolosov(lame: Lame) -> f64 {
    (lame.lambda + 3.0 * lame.mu) / (lame.lambda + lame.mu)
}

/// Fracture mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Opening.
    I,
    /// Sliding ahead.
    II,
    /// Sliding along the front.
    III,
}

/// Field of unit intensity of one mode at a tip.
#[derive(Debug, Clone)]
pub struct Williams<'a> {
    tip: &'a TipFrame,
    /// Coefficients of g₁ … g₄ for the components along 1, 2, 3.
    coefficients: [[f64; 4]; 3],
    axes: [Point; 3],
}

impl<'a> Williams<'a> {
    /// Field of a mode with K = 1 Pa √m.
    pub fn new(tip: &'a TipFrame, lame: Lame, mode: Mode) -> Self {
        let kappa = kolosov(lame);
        let unit = match mode {
            Mode::I => [
                [0.0, kappa - 1.0, 1.0, 0.0],
                [kappa + 1.0, 0.0, 0.0, -1.0],
                [0.0; 4],
            ],
            Mode::II => [
                [kappa + 1.0, 0.0, 0.0, 1.0],
                [0.0, 1.0 - kappa, 1.0, 0.0],
                [0.0; 4],
            ],
            Mode::III => [[0.0; 4], [0.0; 4], [4.0, 0.0, 0.0, 0.0]],
        };
        let c = 1.0 / (2.0 * lame.mu * (2.0 * PI).sqrt());
        Williams {
            tip,
            coefficients: unit.map(|row| row.map(|v| c * v)),
            axes: [tip.ahead, tip.normal, cross(&tip.ahead, &tip.normal)],
        }
    }

    /// Vector coefficient of a branch function g_l, l = 0..4, in space [m^½].
    pub fn coefficient(&self, order: usize) -> Point {
        let mut v = [0.0; 3];
        for (axis, row) in self.axes.iter().zip(&self.coefficients) {
            for a in 0..3 {
                v[a] += row[order] * axis[a];
            }
        }
        v
    }

    /// Displacement [m] and its gradient ∂u_a/∂x_b; `side`: the face, for points of the crack.
    pub fn at(&self, x: &Point, side: Option<Side>) -> (Point, [Point; 3]) {
        let (g, dg) = self.tip.branch(x, side);
        let (mut u, mut h) = ([0.0; 3], [[0.0; 3]; 3]);
        for l in 0..4 {
            let c = self.coefficient(l);
            for a in 0..3 {
                u[a] += c[a] * g[l];
                for b in 0..3 {
                    h[a][b] += c[a] * dg[l][b];
                }
            }
        }
        (u, h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{add_scaled, dot};
    use crate::material::{Lame, Material, Model, stress};

    /// Source: Williams 1957; definition of K by the stress ahead. Goal: σ_22, σ_12, σ_23 = 1/√(2πr) ahead of the tip, faces
    /// free of stress, equilibrium, for plane strain, plane stress and the solid.
    #[test]
    fn unit_fields_have_unit_intensity_free_faces_and_equilibrium() {
        let (s, c) = 0.7f64.sin_cos();
        let tip = TipFrame::straight(0, [0.2, 0.1, 0.0], [c, s, 0.0], [-s, c, 0.0]);
        let material = Material::new(3.0, 0.27);
        for model in [Model::PlaneStrain, Model::PlaneStress, Model::Solid] {
            let lame = Lame::new(material, model);
            let young = match model {
                Model::PlaneStress => 3.0,
                _ => 3.0 / (1.0 - 0.27 * 0.27),
            };
            assert!((plane_modulus(lame) / young - 1.0).abs() < 1e-13);
            for (k, mode) in [(1, Mode::I), (0, Mode::II), (2, Mode::III)] {
                if model != Model::Solid && mode == Mode::III {
                    continue;
                }
                let field = Williams::new(&tip, lame, mode);
                let traction = |x: &Point, side: Option<Side>| {
                    let sigma = stress(lame, 3, &field.at(x, side).1);
                    let t = [0, 1, 2].map(|a| dot(&sigma[a], &tip.normal));
                    [0, 1, 2].map(|a| dot(&t, &field.axes[a]))
                };
                let r = 0.03;
                let ahead = traction(&add_scaled(&tip.position, r, &tip.ahead), None);
                for (a, t) in ahead.iter().enumerate() {
                    let exact = if a == k {
                        1.0 / (2.0 * PI * r).sqrt()
                    } else {
                        0.0
                    };
                    assert!((t - exact).abs() < 1e-12, "{model:?} {mode:?}: {ahead:?}");
                }
                for side in [1.0, -1.0] {
                    let face = add_scaled(&tip.position, -r, &tip.ahead);
                    for t in traction(&face, Some(side)) {
                        assert!(t.abs() < 1e-12, "{mode:?} face {side}: {t}");
                    }
                }
                // div σ by central differences.
                let (x, step) = ([0.31, -0.04, 0.0], 1e-5);
                for a in 0..3 {
                    let mut divergence = 0.0;
                    for b in 0..2 {
                        let [p, m] = [step, -step].map(|d| {
                            let mut y = x;
                            y[b] += d;
                            stress(lame, 3, &field.at(&y, None).1)[a][b]
                        });
                        divergence += (p - m) / (2.0 * step);
                    }
                    assert!(divergence.abs() < 1e-6, "{mode:?} {divergence}");
                }
            }
        }
    }
}
