//! Disc in two parts, pressed together over a circle without friction, under pressure p₀ + p₂ cos 2θ on its rim.
//!
//! Inner disc r < R₂ and ring R₂ < r < R₁ of one material, contact without friction on r = R₂. The mean pressure gives σ = −p₀ I
//! in both. The second harmonic, with Airy's function (J. H. Michell, 1899)
//!
//! ```text
//!   Φ cos 2θ          2G u_r / cos 2θ    2G u_θ / sin 2θ    σ_rr / cos 2θ   σ_θθ / cos 2θ   σ_rθ / sin 2θ
//!   r²   (a₁, a₂)     −2 r               2 r                −2              2               2
//!   r⁴   (b₁, b₂)     (κ − 3) r³         (κ + 3) r³         0               12 r²           6 r²
//!   r⁻²  (c₂)         2 r⁻³              2 r⁻³              −6 r⁻⁴          6 r⁻⁴           −6 r⁻⁴
//!   1    (d₂)         (κ + 1) r⁻¹        −(κ − 1) r⁻¹       −4 r⁻²          0               −2 r⁻²
//! ```
//!
//! has two coefficients in the disc and four in the ring, from six conditions: σ_rr = −p₂, σ_rθ = 0 at R₁; σ_rr and u_r
//! continuous, σ_rθ = 0 on either side at R₂. The faces slip along each other. Symmetry fixes the rigid motion: u_x = 0 on
//! x = 0, u_y = 0 on y = 0, no relative rotation. The load factor scales the pressure. With R₁ = 1, R₂ = 0.6, p₀ = 10 MPa,
//! p₂ = 0.1 MPa, ν = 0.2 and plane strain this is test SSNP169 of Code_Aster: contact pressure 10.147926 MPa at θ = 0,
//! 9.852074 MPa at 90°.

use nalgebra::{Matrix6, Vector6};

use crate::geometry::crack_shape::CrackShape;
use crate::geometry::{Point, add_scaled, norm, resolve, sub};
use crate::intensity::williams::{kolosov, plane_modulus, plane_ratio};
use crate::material::Lame;

use super::parts::line_crack::apply;
use super::solution::{Field, Setting, Solution, SolutionSpec, exactly, plane, required};

/// A point closer to the circle than this, in radii, lies on it: its side is the one asked for.
const ON_CIRCLE: f64 = 1e-10;

/// Registry entry.
pub const SPEC: SolutionSpec = SolutionSpec {
    name: "circular-interface",
    summary: "2D disc parted by a circular arc, contact without friction, pressure p₀ + p₂ cos 2θ on its rim",
    parameters: &[
        required(
            "outer_radius_m",
            "radius R₁ of the rim, about the centre of the arc",
        ),
        required("pressure_pa", "mean pressure p₀ on the rim"),
        required(
            "pressure_wave_pa",
            "amplitude p₂ of the pressure varying as cos 2θ",
        ),
    ],
    build,
};

fn build(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let &[rim, pressure, wave] = exactly(values)?;
    let &CrackShape::Arc {
        centre,
        radius,
        from,
        to,
    } = setting.crack
    else {
        return Err("the crack must be a circular arc".into());
    };
    if rim <= radius {
        return Err(format!(
            "outer_radius_m must exceed the radius of the arc, {radius} m"
        ));
    }
    if setting.friction != 0.0 {
        return Err("the solution holds without friction only".into());
    }
    let elastic = plane(setting)?;
    let k = kolosov(elastic);
    // In units of R₁ and p₂; unknowns a₁, b₁, a₂, b₂, c₂, d₂.
    let r = radius / rim;
    let (r2, r4) = (r.powi(-2), r.powi(-4));
    #[rustfmt::skip]
    let conditions = Matrix6::new(
        0.0, 0.0, -2.0, 0.0, -6.0, -4.0,
        0.0, 0.0, 2.0, 6.0, -6.0, -2.0,
        2.0, 6.0 * r * r, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 2.0, 6.0 * r * r, -6.0 * r4, -2.0 * r2,
        -2.0, 0.0, 2.0, 0.0, 6.0 * r4, 4.0 * r2,
        -2.0 * r, (k - 3.0) * r.powi(3), 2.0 * r, -(k - 3.0) * r.powi(3), -2.0 * r.powi(-3), -(k + 1.0) / r,
    );
    let load = Vector6::new(-wave, 0.0, 0.0, 0.0, 0.0, 0.0);
    let found = conditions
        .lu()
        .solve(&load)
        .ok_or("the ring is too thin: its equations are singular")?;
    let &[a1, b1, a2, b2, c2, d2] = found.as_ref();
    let disc = CircularInterface {
        crack: setting.crack.clone(),
        elastic,
        centre: [centre[0], centre[1], 0.0],
        radius,
        rim,
        // n points to the centre of a counter-clockwise arc: side 1 is the inner disc.
        inner_side: (to - from).signum(),
        pressure,
        coefficients: [[a1, b1, 0.0, 0.0], [a2, b2, c2, d2]],
    };
    Ok(Box::new(disc))
}

#[derive(Clone)]
struct CircularInterface {
    crack: CrackShape,
    elastic: Lame,
    centre: Point,
    /// R₂ [m].
    radius: f64,
    /// R₁ [m].
    rim: f64,
    /// Side of the inner disc.
    inner_side: f64,
    /// p₀ [Pa].
    pressure: f64,
    /// a, b, c, d of the disc and of the ring, lengths in units of R₁ [Pa].
    coefficients: [[f64; 4]; 2],
}

impl CircularInterface {
    /// r/R₁, θ and the coefficients of the part a point belongs to.
    fn place(&self, x: &Point, side: f64) -> (f64, f64, &[f64; 4]) {
        let from = sub(x, &self.centre);
        let distance = from[0].hypot(from[1]);
        let inner = if (distance - self.radius).abs() <= ON_CIRCLE * self.radius {
            side * self.inner_side > 0.0
        } else {
            distance < self.radius
        };
        let part = if inner { 0 } else { 1 };
        (
            distance / self.rim,
            from[1].atan2(from[0]),
            &self.coefficients[part],
        )
    }

    /// The point of the circle nearest to a point of the discrete interface, whose pieces may be chords: off the circle
    /// both sides would be in the same part.
    fn foot(&self, x: &Point) -> Point {
        let from = sub(x, &self.centre);
        add_scaled(&self.centre, self.radius / norm(&from), &from)
    }

    /// (u_r, u_θ) of the second harmonic [m].
    fn polar_displacement(&self, r: f64, theta: f64, [a, b, c, d]: &[f64; 4]) -> [f64; 2] {
        let k = kolosov(self.elastic);
        // The disc has no singular terms: at its centre they would be 0/0.
        let (singular, rotary) = if *c == 0.0 && *d == 0.0 {
            (0.0, 0.0)
        } else {
            let power = 2.0 * c * r.powi(-3);
            (power + (k + 1.0) * d / r, power - (k - 1.0) * d / r)
        };
        let (sin, cos) = (2.0 * theta).sin_cos();
        let scale = 0.5 * self.rim / self.elastic.mu;
        [
            scale * cos * (-2.0 * a * r + (k - 3.0) * b * r.powi(3) + singular),
            scale * sin * (2.0 * a * r + (k + 3.0) * b * r.powi(3) + rotary),
        ]
    }
}

impl Solution for CircularInterface {
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        let now = factors.last().copied().unwrap_or(0.0);
        let mut state = self.clone();
        state.pressure *= now;
        state.coefficients = self.coefficients.map(|part| part.map(|c| now * c));
        // Contact pressure p₀ + 2 a₁ cos 2θ.
        let least = state.pressure - 2.0 * state.coefficients[0][0].abs();
        if least < 0.0 {
            return Err(format!(
                "the interface would open: contact pressure {least} Pa"
            ));
        }
        Ok(Box::new(state))
    }
}

impl Field for CircularInterface {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let (r, theta, part) = self.place(x, side);
        let [u_r, u_t] = self.polar_displacement(r, theta, part);
        let shrink =
            -self.pressure * (1.0 - plane_ratio(self.elastic)) / plane_modulus(self.elastic);
        let (sin, cos) = theta.sin_cos();
        let u_r = u_r + shrink * r * self.rim;
        [u_r * cos - u_t * sin, u_r * sin + u_t * cos, 0.0]
    }

    fn stress(&self, x: &Point, side: f64) -> [Point; 3] {
        let (r, theta, [a, b, c, d]) = self.place(x, side);
        let (c4, d2) = if *c == 0.0 && *d == 0.0 {
            (0.0, 0.0)
        } else {
            (c * r.powi(-4), d * r.powi(-2))
        };
        let (sin2, cos2) = (2.0 * theta).sin_cos();
        let rr = cos2 * (-2.0 * a - 6.0 * c4 - 4.0 * d2) - self.pressure;
        let tt = cos2 * (2.0 * a + 12.0 * b * r * r + 6.0 * c4) - self.pressure;
        let rt = sin2 * (2.0 * a + 6.0 * b * r * r - 6.0 * c4 - 2.0 * d2);
        let (mean, half) = (0.5 * (rr + tt), 0.5 * (rr - tt));
        let (xx, xy) = (half * cos2 - rt * sin2, half * sin2 + rt * cos2);
        [[mean + xx, xy, 0.0], [xy, mean - xx, 0.0], [0.0; 3]]
    }

    fn traction(&self, x: &Point) -> [f64; 3] {
        let x = self.foot(x);
        let axes = self.crack.frame(&x);
        resolve(&axes, &apply(&self.stress(&x, 1.0), &axes[0])).map(|t| -t)
    }

    fn jump(&self, x: &Point) -> [f64; 3] {
        let x = self.foot(x);
        let apart = sub(&self.displacement(&x, 1.0), &self.displacement(&x, -1.0));
        resolve(&self.crack.frame(&x), &apart)
    }

    fn dissipation(&self) -> Option<f64> {
        Some(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{check_form, setting};
    use crate::material::{Material, Model};
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    fn at(centre: [f64; 2], r: f64, theta: f64) -> Point {
        let (sin, cos) = theta.sin_cos();
        [centre[0] + r * cos, centre[1] + r * sin, 0.0]
    }

    fn frictionless(shape: &CrackShape) -> Setting<'_> {
        Setting {
            friction: 0.0,
            ..setting(shape)
        }
    }

    #[test]
    fn the_contact_pressure_is_that_of_the_published_test() {
        let shape = CrackShape::arc([0.0, 0.0], 0.6, [0.0, FRAC_PI_2]);
        let mut of = frictionless(&shape);
        of.material = Material::new(1e9, 0.2);
        let field = build(&of, &[1.0, 1e7, 1e5]).unwrap().at(&[1.0]).unwrap();
        let pressure = |theta: f64| field.traction(&at([0.0; 2], 0.6, theta))[0];
        for (theta, exact) in [(0.0, 10.147926e6), (FRAC_PI_2, 9.852074e6)] {
            assert!((pressure(theta) - exact).abs() < 1.0, "{theta}");
        }
        // Symmetry.
        for r in [0.2, 0.5, 0.6, 0.7] {
            for side in [1.0, -1.0] {
                assert!(field.displacement(&[0.0, r, 0.0], side)[0].abs() < 1e-17);
                assert_eq!(field.displacement(&[r, 0.0, 0.0], side)[1], 0.0);
            }
        }
        assert_eq!(field.displacement(&[0.0; 3], 1.0), [0.0; 3]);
    }

    /// Goal: traction and jump at a point of a chord are those of the circle there.
    #[test]
    fn points_of_chords_are_taken_to_the_circle() {
        let shape = CrackShape::arc([0.1, -0.2], 0.6, [0.0, FRAC_PI_2]);
        let of = frictionless(&shape);
        let field = build(&of, &[1.0, 1e-3, 1e-5]).unwrap().at(&[1.0]).unwrap();
        for theta in [0.2, FRAC_PI_2 / 2.0, 1.3] {
            let [on, off] = [0.6, 0.599].map(|r| at([0.1, -0.2], r, theta));
            let slip = field.jump(&on)[1];
            assert!(slip.abs() > 1e-7);
            for k in 0..3 {
                assert!((field.jump(&off)[k] - field.jump(&on)[k]).abs() < 1e-10 * slip.abs());
                assert!((field.traction(&off)[k] - field.traction(&on)[k]).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn the_field_equations_and_the_contact_laws_hold() {
        let centre = [0.1, -0.2];
        for (from, to) in [(0.0, TAU), (TAU, 0.0), (0.3, 1.2)] {
            let shape = CrackShape::arc(centre, 0.6, [from, to]);
            for model in [Model::PlaneStrain, Model::PlaneStress] {
                let mut of = frictionless(&shape);
                of.model = model;
                let solution = build(&of, &[0.9, 1.0, 0.3]).unwrap();
                let ring =
                    |r: f64| (0..24).map(move |k| at(centre, r, 0.1 + TAU * k as f64 / 24.0));
                let off: Vec<Point> = [0.05, 0.3, 0.55, 0.65, 0.8]
                    .into_iter()
                    .flat_map(ring)
                    .collect();
                let on: Vec<Point> = if to - from < 1.0 {
                    vec![at(centre, 0.6, 0.3), at(centre, 0.6, 0.8)]
                } else {
                    ring(0.6).collect()
                };
                let tolerances = [[1e-13, 1e-14], [1e-3, 1e-9]];
                let field = &check_form(&*solution, &of, &[0.5], [&on, &off], tolerances)[0];
                // The faces do slip.
                assert!(field.jump(&at(centre, 0.6, PI / 4.0))[1].abs() > 0.01);
                // Rim.
                for x in ring(0.9) {
                    let n = [(x[0] - centre[0]) / 0.9, (x[1] - centre[1]) / 0.9, 0.0];
                    let pressure = 0.5 * (1.0 + 0.3 * (n[0] * n[0] - n[1] * n[1]));
                    let t = apply(&field.stress(&x, 1.0), &n);
                    for k in 0..2 {
                        assert!((t[k] + pressure * n[k]).abs() < 1e-14);
                    }
                }
            }
        }
    }

    #[test]
    fn opening_and_friction_are_refused() {
        let shape = CrackShape::arc([0.0, 0.0], 0.6, [0.0, 1.0]);
        assert!(build(&setting(&shape), &[1.0, 1.0, 0.1]).is_err());
        let of = frictionless(&shape);
        assert!(build(&of, &[0.6, 1.0, 0.1]).is_err());
        assert!(build(&of, &[1.0, 1.0, 0.1]).unwrap().at(&[-1.0]).is_err());
        assert!(build(&of, &[1.0, 1.0, 0.9]).unwrap().at(&[1.0]).is_err());
    }
}
