//! Manufactured solution: interface through the whole body, pressure, friction and slip that vary along it, no tips.
//!
//! In the frame of the crack (x along it from its midpoint, y across it, + for side 1), k = 2π/L, M = λ + 2G:
//!
//! ```text
//!   p = p₀ + p₁ cos kx       pressure, |p₁| < p₀
//!   s = s₀ max(0, sin kx)³   slip on every other half wave
//!   h = 1 − c max(0, −sin kx)³,  0 < c < 2: used share of friction, 1 where the faces slip, |h| < 1 where they stick
//!
//!   u_x = ± s/2 + y μ p h/G                 u_y = −y (p ± λ s'/2)/M
//!   σ_xx = M (± s'/2 + y μ(ph)'/G) − λ (p ± λ s'/2)/M
//!   σ_yy = λ y μ(ph)'/G − p                 σ_xy = μ p h − G y (p' ± λ s''/2)/M
//!   f_x = −M (± s''/2 + y μ(ph)''/G) + (λ + G)(p' ± λ s''/2)/M
//!   f_y = −(1 + λ/G) μ(ph)' + G y (p'' ± λ s'''/2)/M
//! ```
//!
//! On both faces σ_yy = −p, σ_xy = μ p h, the jump is (s, 0): Coulomb's law holds for an increment from zero slip. The body
//! force f = −div σ jumps across the crack. s is twice continuously differentiable, so f leaps where slip ends.
//! The load factor scales the whole field; it may grow from increment to increment but not fall.
//! Dissipation: ½ (f² − f₀²) ∫ μ p s over the part of the crack inside the body, f₀ the first factor: p and s grow together.
//! The displacement is stated, with no rigid motion to choose. Manufactured for this project after P. J. Roache (2002).

use std::f64::consts::{PI, TAU};

use crate::geometry::Point;
use crate::material::Lame;

use super::parts::jet::hump;
use super::parts::line_crack::LineCrack;
use super::parts::plane_elasticity::PlaneElasticity;
use super::solution::{
    Field, Setting, Solution, SolutionSpec, exactly, growing, needed, optional, required,
};

/// Registry entry.
pub const SPEC: SolutionSpec = SolutionSpec {
    name: "manufactured-slip",
    summary: "2D body cut by a straight crack: alternating slip and stick under varying pressure, with a body force; load factor may only grow",
    parameters: &[
        required("pressure_pa", "mean pressure p₀ > 0"),
        required(
            "pressure_wave_pa",
            "amplitude p₁ of its variation, |p₁| < p₀",
        ),
        required("slip_m", "largest slip s₀ >= 0"),
        required(
            "wave_length_m",
            "length L of a slipping and a sticking half wave, which meet at the midpoint of the crack",
        ),
        optional(
            "stick_dip",
            "c, 0 < c < 2: share of friction not used in the middle of a sticking half wave",
            1.0,
        ),
    ],
    build,
};

fn build(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let &[pressure, wave, slip, length, dip] = exactly(values)?;
    needed(&[
        (wave.abs() < pressure, "|pressure_wave_pa| < pressure_pa"),
        (slip >= 0.0, "slip_m >= 0"),
        (length > 0.0, "wave_length_m > 0"),
        (0.0 < dip && dip < 2.0, "0 < stick_dip < 2"),
    ])?;
    let crack = LineCrack::new(setting)?;
    // Refuses solids.
    PlaneElasticity::new(setting)?;
    let inside = inside(&crack, &setting.body).ok_or("the crack does not meet the body")?;
    if inside
        .iter()
        .any(|s| s.abs() > crack.half_length * (1.0 + 1e-12))
    {
        return Err("the crack must cut the whole body".into());
    }
    Ok(Box::new(ManufacturedSlip {
        crack,
        lame: Lame::new(setting.material, setting.model),
        friction: setting.friction,
        pressure,
        wave,
        slip,
        wave_number: TAU / length,
        dip,
        inside,
        scale: 1.0,
        dissipation: 0.0,
    }))
}

/// Abscissae between which the line of a crack lies in a box [m].
fn inside(crack: &LineCrack, body: &[Point; 2]) -> Option<[f64; 2]> {
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..2 {
        let (low, high) = (body[0][k] - crack.centre[k], body[1][k] - crack.centre[k]);
        let t = crack.tangent[k];
        if t == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
        } else {
            from = from.max((low / t).min(high / t));
            to = to.min((low / t).max(high / t));
        }
    }
    (from < to).then_some([from, to])
}

#[derive(Debug, Clone)]
struct ManufacturedSlip {
    crack: LineCrack,
    lame: Lame,
    friction: f64,
    /// p₀, p₁ [Pa].
    pressure: f64,
    wave: f64,
    /// s₀ [m].
    slip: f64,
    /// k [1/m].
    wave_number: f64,
    /// c.
    dip: f64,
    /// Abscissae between which the crack lies in the body [m].
    inside: [f64; 2],
    /// Present load factor.
    scale: f64,
    dissipation: f64,
}

/// Functions of x and their derivatives.
struct Profile {
    /// p, p', p''.
    p: [f64; 3],
    /// s to s'''.
    s: [f64; 4],
    /// g = μ p h, g', g''.
    g: [f64; 3],
}

impl ManufacturedSlip {
    fn profile(&self, x: f64) -> Profile {
        let k = self.wave_number;
        let (sin, cos) = (k * x).sin_cos();
        let p = [
            self.pressure + self.wave * cos,
            -self.wave * k * sin,
            -self.wave * k * k * cos,
        ];
        let stuck = hump(k, x, PI);
        let h = [
            1.0 - self.dip * stuck[0],
            -self.dip * stuck[1],
            -self.dip * stuck[2],
        ];
        let g = [
            p[0] * h[0],
            p[1] * h[0] + p[0] * h[1],
            p[2] * h[0] + 2.0 * p[1] * h[1] + p[0] * h[2],
        ];
        Profile {
            p: p.map(|v| self.scale * v),
            s: hump(k, x, 0.0).map(|v| self.scale * self.slip * v),
            g: g.map(|v| self.scale * self.friction * v),
        }
    }

    /// Profile at the abscissa of a point, its ordinate y and the sign of its side.
    fn place(&self, x: &Point, side: f64) -> (Profile, f64, f64) {
        let (along, y) = self.crack.place(x, side);
        (self.profile(along), y, 1.0_f64.copysign(y))
    }

    /// ∫ μ p s at factor 1 from x = 0 to a point of the crack [J/m].
    fn work(&self, x: f64) -> f64 {
        let angle = self.wave_number * x;
        let waves = (angle / TAU).floor();
        let part = (angle - waves * TAU).min(PI);
        let (sin, cos) = part.sin_cos();
        let integral = self.pressure * (2.0 / 3.0 - cos + cos.powi(3) / 3.0)
            + 0.25 * self.wave * sin.powi(4)
            + self.pressure * waves * 4.0 / 3.0;
        self.friction * self.slip * integral / self.wave_number
    }
}

impl Solution for ManufacturedSlip {
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        let unit = self.work(self.inside[1]) - self.work(self.inside[0]);
        let mut now = ManufacturedSlip {
            scale: 0.0,
            ..self.clone()
        };
        growing(factors, |factor, before| {
            now.dissipation += 0.5 * (factor + before) * (factor - before) * unit;
            now.scale = factor;
        })?;
        Ok(Box::new(now))
    }
}

impl Field for ManufacturedSlip {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let (Profile { p, s, g }, y, sign) = self.place(x, side);
        let Lame { lambda, mu, .. } = self.lame;
        self.crack.vector([
            0.5 * sign * s[0] + y * g[0] / mu,
            -y * (p[0] + 0.5 * sign * lambda * s[1]) / (lambda + 2.0 * mu),
        ])
    }

    fn stress(&self, x: &Point, side: f64) -> [Point; 3] {
        let (Profile { p, s, g }, y, sign) = self.place(x, side);
        let Lame { lambda, mu, .. } = self.lame;
        let m = lambda + 2.0 * mu;
        let lift = [0, 1].map(|k| p[k] + 0.5 * sign * lambda * s[k + 1]);
        self.crack.tensor([
            m * (0.5 * sign * s[1] + y * g[1] / mu) - lambda * lift[0] / m,
            lambda * y * g[1] / mu - p[0],
            g[0] - mu * y * lift[1] / m,
        ])
    }

    fn body_force(&self, x: &Point, side: f64) -> Point {
        let (Profile { p, s, g }, y, sign) = self.place(x, side);
        let Lame { lambda, mu, .. } = self.lame;
        let m = lambda + 2.0 * mu;
        let lift = [1, 2].map(|k| p[k] + 0.5 * sign * lambda * s[k + 1]);
        self.crack.vector([
            -m * (0.5 * sign * s[2] + y * g[2] / mu) + (lambda + mu) * lift[0] / m,
            -(1.0 + lambda / mu) * g[1] + mu * y * lift[1] / m,
        ])
    }

    fn traction(&self, x: &Point) -> [f64; 3] {
        let Profile { p, g, .. } = self.profile(self.crack.abscissa(x));
        [p[0], -g[0], 0.0]
    }

    fn jump(&self, x: &Point) -> [f64; 3] {
        [0.0, self.profile(self.crack.abscissa(x)).s[0], 0.0]
    }

    fn dissipation(&self) -> Option<f64> {
        Some(self.dissipation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{Tolerances, check_form, line, setting};
    use crate::geometry::crack_shape::CrackShape;
    use crate::material::Model;

    const VALUES: [f64; 5] = [1.0, 0.4, 0.03, 0.9, 1.3];

    fn shapes() -> [CrackShape; 3] {
        [
            line([-1.2, 0.0], [1.2, 0.0]),
            line([-1.3, -0.7], [1.2, 0.5]),
            line([0.1, 1.4], [-0.2, -1.3]),
        ]
    }

    #[test]
    fn the_field_equations_and_the_contact_laws_hold() {
        for shape in &shapes() {
            for model in [Model::PlaneStrain, Model::PlaneStress] {
                let mut of = setting(shape);
                of.model = model;
                let crack = LineCrack::new(&of).unwrap();
                let solution = build(&of, &VALUES).unwrap();
                let on = (-20..=20).map(|k| crack.point(k as f64 / 20.0, 0.0));
                let on: Vec<Point> = on.collect();
                // Off the crack, and off the lines where s''' leaps.
                let off: Vec<Point> = (-7..8)
                    .flat_map(|k| [-0.6, -0.2, 0.2, 0.6].map(|y| crack.point(0.13 * k as f64, y)))
                    .filter(|x| (crack.abscissa(x) * TAU / 0.9).sin().abs() > 0.02)
                    .collect();
                assert!(off.len() > 50);
                let (contact, elastic) = ([1e-14; 2], [2e-4, 1e-9]);
                let tolerances = Tolerances { contact, elastic };
                check_form(&*solution, &of, &[0.3, 0.3, 1.0], [&on, &off], tolerances);
            }
        }
    }

    #[test]
    fn dissipation_is_the_integral_over_the_crack() {
        for shape in &shapes() {
            let of = setting(shape);
            let crack = LineCrack::new(&of).unwrap();
            let field = build(&of, &VALUES).unwrap().at(&[0.0, 1.0]).unwrap();
            let n = 400_000;
            let step = 2.0 * crack.half_length / n as f64;
            let sum: f64 = (0..n)
                .map(|k| crack.point((k as f64 + 0.5) * step - crack.half_length, 0.0))
                .filter(|x| x[0].abs() <= 1.0 && x[1].abs() <= 1.0)
                .map(|x| -0.5 * field.traction(&x)[1] * field.jump(&x)[1] * step)
                .sum();
            let stated = field.dissipation().unwrap();
            let error = (stated - sum).abs();
            assert!(stated > 1e-3 && error < 1e-6, "{stated} {sum}");
        }
    }

    #[test]
    fn values_and_paths_out_of_range_are_refused() {
        let [shape, ..] = shapes();
        let of = setting(&shape);
        for (k, value) in [(0, 0.3), (2, -0.1), (3, 0.0), (4, 2.0)] {
            let mut values = VALUES;
            values[k] = value;
            assert!(build(&of, &values).is_err());
        }
        assert!(build(&of, &VALUES).unwrap().at(&[1.0, 0.9]).is_err());
        let short = line([-0.9, 0.0], [1.2, 0.0]);
        assert!(build(&setting(&short), &VALUES).is_err());
        let model = Model::Solid;
        assert!(build(&Setting { model, ..of }, &VALUES).is_err());
    }
}
