//! Manufactured solutions: straight crack or plane through the whole body, pressure, friction and slip that vary over it, no tips.
//!
//! In the frame of the crack (x₁ along a, x₂ along b from the point of the plane, y across it, + for side 1) with the unit
//! direction e of slip in the plane, D = e·∇, k = 2π/L, H(θ) = max(0, sin θ)³, M = λ + 2G:
//!
//! ```text
//!   p = p₀ + p₁ cos kx₁ cos kx₂      pressure, |p₁| < p₀
//!   s = s₀ H(kx₁) (1 + m cos kx₂)    slip along e on every other half wave, |m| < 1
//!   h = 1 − c H(kx₁ + π), 0 < c < 2   used share of friction, 1 where the faces slip, |h| < 1 where they stick
//!   g = μ p h,   w = ± s/2 + y g/G,   l = p ± λ Ds/2
//!
//!   u_α = e_α w,   u_y = −y l/M       σ by Hooke's law, f = −(λ+G) ∇ div u − G Δu
//! ```
//!
//! On both faces σ_yy = −p, σ_yα = μ p h e_α, the jump is s e: Coulomb's law holds for an increment from zero slip. In the
//! plane x₂ = 0, m = 0, e = a, nothing varies along x₂, and σ_22 is not of the plane. s is twice continuously differentiable: the
//! body force jumps across the crack, and leaps where slip ends. The load factor scales the whole field; it may grow from increment to increment but not fall. Dissipation:
//! ½ (f² − f₀²) ∫ μ p s over the part of the crack inside the body, f₀ the first factor: p and s grow together.
//! The displacement is stated, with no rigid motion to choose. Manufactured for this project after P. J. Roache (2002).

use std::f64::consts::{PI, TAU};

use crate::geometry::clip::{clip, crossing};
use crate::geometry::crack_shape::CrackShape;
use crate::geometry::{Point, add_scaled, combine, dot, norm, rotated, sub};
use crate::material::{Lame, Model, stress};
use crate::quadrature::gauss;

use super::parts::jet::{Jet, Separable, cosine, hump, product, times};
use super::parts::line_crack::LineCrack;
use super::solution::{
    Field, ParameterSpec, Setting, Solution, SolutionSpec, exactly, growing, needed, optional,
    plane, required,
};

/// A point closer to the plane than this, in diagonals of the body, lies on it: its side is the one asked for.
const ON_PLANE: f64 = 1e-10;

const PRESSURE: ParameterSpec = required("pressure_pa", "mean pressure p₀ > 0");
const WAVE: ParameterSpec = required(
    "pressure_wave_pa",
    "amplitude p₁ of its variation, |p₁| < p₀",
);
const DIP: ParameterSpec = optional(
    "stick_dip",
    "c, 0 < c < 2: share of friction not used in the middle of a sticking half wave",
    1.0,
);

/// Registry entry of the plane.
pub const FLAT: SolutionSpec = SolutionSpec {
    name: "manufactured-slip",
    summary: "2D body cut by a straight crack: alternating slip and stick under varying pressure, with a body force; load factor may only grow",
    parameters: &[
        PRESSURE,
        WAVE,
        required("slip_m", "largest slip s₀ >= 0"),
        required(
            "wave_length_m",
            "length L of a slipping and a sticking half wave, which meet at the midpoint of the crack",
        ),
        DIP,
    ],
    build: flat,
};

/// Registry entry of solids.
pub const SOLID: SolutionSpec = SolutionSpec {
    name: "manufactured-slip-3d",
    summary: "solid cut by a plane: alternating slip and stick under varying pressure, with a body force; load factor may only grow",
    parameters: &[
        PRESSURE,
        WAVE,
        required("slip_m", "slip s₀ >= 0 of a half wave's middle"),
        required(
            "wave_length_m",
            "length L of a slipping and a sticking half wave, which meet at the point of the plane",
        ),
        optional(
            "slip_wave",
            "m, |m| < 1: variation of the slip along the half waves",
            0.5,
        ),
        optional(
            "slip_angle_deg",
            "direction of slip, from the local axis a towards b",
            30.0,
        ),
        DIP,
    ],
    build: solid,
};

fn flat(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let &[pressure, wave, slip, length, dip] = exactly(values)?;
    let crack = LineCrack::new(setting)?;
    // Refuses solids.
    plane(setting)?;
    let values = [pressure, wave, slip, length, 0.0, 0.0, dip];
    cut(setting, crack.centre, crack.half_length, values)
}

fn solid(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let CrackShape::Plane { point, .. } = *setting.crack else {
        return Err("the crack must be a plane".into());
    };
    if setting.model != Model::Solid {
        return Err("manufactured-slip-3d is a solution of solids".into());
    }
    cut(setting, point, f64::INFINITY, *exactly(values)?)
}

/// The solution of a crack that reaches so far from an origin, by the values of a solid.
fn cut(
    setting: &Setting<'_>,
    origin: Point,
    reach: f64,
    [pressure, wave, slip, length, slip_wave, angle, dip]: [f64; 7],
) -> Result<Box<dyn Solution>, String> {
    needed(&[
        (wave.abs() < pressure, "|pressure_wave_pa| < pressure_pa"),
        (slip >= 0.0, "slip_m >= 0"),
        (length > 0.0, "wave_length_m > 0"),
        (slip_wave.abs() < 1.0, "|slip_wave| < 1"),
        (0.0 < dip && dip < 2.0, "0 < stick_dip < 2"),
    ])?;
    let [n, a, b] = setting.crack.frame(&origin);
    let angle = angle.to_radians();
    let flat = setting.model != Model::Solid;
    let wave_number = TAU / length;
    let mut solution = ManufacturedSlip {
        origin,
        frame: [a, b, n],
        flat,
        size: norm(&sub(&setting.body[1], &setting.body[0])),
        lame: Lame::new(setting.material, setting.model),
        friction: setting.friction,
        pressure,
        wave,
        slip,
        slip_wave,
        wave_numbers: [wave_number, if flat { 0.0 } else { wave_number }],
        direction: [angle.cos(), angle.sin()],
        dip,
        work: 0.0,
        scale: 1.0,
        dissipation: 0.0,
    };
    let mut body = setting.body;
    if flat {
        // One metre thick.
        body[1][2] = 1.0;
    }
    solution.work = solution.work_inside(&body, reach)?;
    Ok(Box::new(solution))
}

#[derive(Debug, Clone)]
struct ManufacturedSlip {
    /// Point of the plane, midpoint of a straight crack [m].
    origin: Point,
    /// a, b, n.
    frame: [Point; 3],
    /// Whether the body is plane.
    flat: bool,
    /// Diagonal of the body [m].
    size: f64,
    lame: Lame,
    friction: f64,
    /// p₀, p₁ [Pa].
    pressure: f64,
    wave: f64,
    /// s₀ [m] and m.
    slip: f64,
    slip_wave: f64,
    /// k along x₁ and x₂, there 0 in the plane [1/m].
    wave_numbers: [f64; 2],
    /// e.
    direction: [f64; 2],
    /// c.
    dip: f64,
    /// ∫ μ p s over the crack inside the body, at factor 1 [J, in the plane J/m].
    work: f64,
    /// Present load factor.
    scale: f64,
    dissipation: f64,
}

const AXES: [usize; 3] = [0, 1, 2];
const ONE: Jet = [1.0, 0.0, 0.0, 0.0];
const NONE: (Jet, Jet) = ([0.0; 4], [0.0; 4]);

/// The functions at a point, and its place across the plane.
struct Place {
    p: Separable,
    s: Separable,
    /// μ p h
    g: Separable,
    y: f64,
    sign: f64,
}

impl ManufacturedSlip {
    fn place(&self, x: &Point, side: f64) -> Place {
        let d = sub(x, &self.origin);
        let [x1, x2, y] = self.frame.map(|e| dot(&e, &d));
        let y = if y.abs() <= ON_PLANE * self.size {
            0.0_f64.copysign(side)
        } else {
            y
        };
        let [k, k2] = self.wave_numbers;
        let (c1, c2) = (cosine(k, x1), cosine(k2, x2));
        let stuck = hump(k, x1, PI);
        let mut h = times(-self.dip, stuck);
        h[0] += 1.0;
        let mut across = times(self.slip_wave, c2);
        across[0] += 1.0;
        let f = self.scale;
        Place {
            p: Separable([
                (times(f * self.pressure, ONE), ONE),
                (times(f * self.wave, c1), c2),
            ]),
            s: Separable([(times(f * self.slip, hump(k, x1, 0.0)), across), NONE]),
            g: Separable([
                (times(f * self.friction * self.pressure, h), ONE),
                (times(f * self.friction * self.wave, product(c1, h)), c2),
            ]),
            y,
            sign: 1.0_f64.copysign(y),
        }
    }

    /// Derivative of the component `a` of the displacement along axes of the frame, at most two; index 2 is y.
    fn derivative(&self, place: &Place, a: usize, along: &[usize]) -> f64 {
        let Place { p, s, g, y, sign } = place;
        let Lame { lambda, mu, .. } = self.lame;
        let [i, j, k] = AXES.map(|b| along.iter().filter(|c| **c == b).count());
        // Of a function of x₁, x₂ and of one that y multiplies.
        let constant = if k == 0 { 1.0 } else { 0.0 };
        let linear = [*y, 1.0, 0.0][k];
        if a < 2 {
            let w = 0.5 * sign * constant * s.d(i, j) + linear * g.d(i, j) / mu;
            return self.direction[a] * w;
        }
        let l = p.d(i, j) + 0.5 * sign * lambda * s.along(self.direction, i, j);
        -linear * l / (lambda + 2.0 * mu)
    }

    /// ∫ μ p s dA over the crack inside a box, which it must leave everywhere: exact along x₂, Gauss along x₁ between
    /// vertices and ends of half waves.
    fn work_inside(&self, body: &[Point; 2], reach: f64) -> Result<f64, String> {
        /// Points per interval, at most half a wave.
        const POINTS: usize = 20;
        let [a, b, _] = self.frame;
        let centre = [0, 1, 2].map(|k| 0.5 * (body[0][k] + body[1][k]));
        let size = norm(&sub(&body[1], &body[0]));
        let d = sub(&centre, &self.origin);
        let middle = add_scaled(&centre, -dot(&d, &self.frame[2]), &self.frame[2]);
        // A square of the plane that holds its part inside the body, cut by the faces.
        let mut polygon: Vec<Point> = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .iter()
            .map(|[p, q]| add_scaled(&add_scaled(&middle, p * size, &a), q * size, &b))
            .collect();
        for k in 0..3 {
            for (sign, wall) in [(1.0, body[0][k]), (-1.0, body[1][k])] {
                let levels: Vec<f64> = polygon.iter().map(|x| sign * (x[k] - wall)).collect();
                polygon = clip(&polygon, &levels, 1.0);
            }
        }
        if polygon.len() < 3 {
            return Err("the crack does not meet the body".into());
        }
        let flat: Vec<Point> = polygon
            .iter()
            .map(|x| sub(x, &self.origin))
            .map(|d| [dot(&d, &a), dot(&d, &b), 0.0])
            .collect();
        let mut breaks: Vec<f64> = flat.iter().map(|x| x[0]).collect();
        breaks.sort_by(f64::total_cmp);
        let (low, high) = (breaks[0], breaks[breaks.len() - 1]);
        if high.max(-low) > reach * (1.0 + 1e-12) {
            return Err("the crack must cut the whole body".into());
        }
        let [k, k2] = self.wave_numbers;
        let half = PI / k;
        let mut at = (low / half).ceil();
        while at * half < high {
            breaks.push(at * half);
            at += 1.0;
        }
        breaks.sort_by(f64::total_cmp);
        // ∫ cos(n k₂ x₂) dx₂ from 0.
        let sine = |n: f64, x2: f64| match n * k2 {
            0.0 => x2,
            k => (k * x2).sin() / k,
        };
        let mut work = 0.0;
        for pair in breaks.windows(2) {
            let width = 0.5 * (pair[1] - pair[0]);
            for (t, weight) in gauss(POINTS) {
                let x1 = pair[0] + width * (1.0 + t);
                let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
                for (i, p) in flat.iter().enumerate() {
                    let q = &flat[(i + 1) % flat.len()];
                    if (p[0] - x1) * (q[0] - x1) < 0.0 {
                        let x2 = crossing(p, p[0] - x1, q, q[0] - x1)[1];
                        from = from.min(x2);
                        to = to.max(x2);
                    }
                }
                if from >= to {
                    continue;
                }
                // ∫ (1 + m cos)(p₀ + p₁ c₁ cos) dx₂
                let wave = self.wave * (k * x1).cos();
                let integral = |x2: f64| {
                    self.pressure * x2
                        + (self.slip_wave * self.pressure + wave) * sine(1.0, x2)
                        + 0.5 * self.slip_wave * wave * (x2 + sine(2.0, x2))
                };
                work += width * weight * hump(k, x1, 0.0)[0] * (integral(to) - integral(from));
            }
        }
        Ok(self.friction * self.slip * work)
    }
}

impl Solution for ManufacturedSlip {
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        let mut now = ManufacturedSlip {
            scale: 0.0,
            ..self.clone()
        };
        growing(factors, |factor, before| {
            now.dissipation += 0.5 * (factor + before) * (factor - before) * self.work;
            now.scale = factor;
        })?;
        Ok(Box::new(now))
    }
}

impl Field for ManufacturedSlip {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let place = self.place(x, side);
        combine(&self.frame, AXES.map(|a| self.derivative(&place, a, &[])))
    }

    fn stress(&self, x: &Point, side: f64) -> [Point; 3] {
        let place = self.place(x, side);
        let gradient = AXES.map(|a| AXES.map(|b| self.derivative(&place, a, &[b])));
        let mut local = stress(self.lame, 3, &gradient);
        if self.flat {
            local[1][1] = 0.0;
        }
        rotated(&self.frame, &local)
    }

    fn body_force(&self, x: &Point, side: f64) -> Point {
        let place = self.place(x, side);
        let second = |a: usize, b: usize, c: usize| self.derivative(&place, a, &[b, c]);
        let Lame { lambda, mu, .. } = self.lame;
        let force = AXES.map(|a| {
            let [dilatation, laplace] = AXES.iter().fold([0.0; 2], |[d, l], &b| {
                [d + second(b, b, a), l + second(a, b, b)]
            });
            -(lambda + mu) * dilatation - mu * laplace
        });
        combine(&self.frame, force)
    }

    fn traction(&self, x: &Point) -> [f64; 3] {
        let Place { p, g, .. } = self.place(x, 1.0);
        let [e0, e1] = self.direction;
        [p.d(0, 0), -g.d(0, 0) * e0, -g.d(0, 0) * e1]
    }

    fn jump(&self, x: &Point) -> [f64; 3] {
        let s = self.place(x, 1.0).s.d(0, 0);
        [0.0, s * self.direction[0], s * self.direction[1]]
    }

    fn dissipation(&self) -> Option<f64> {
        Some(self.dissipation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{check_form, line, setting};
    use crate::geometry::unit;

    const VALUES: [f64; 7] = [1.0, 0.4, 0.03, 0.9, 0.6, 35.0, 1.3];
    const FLAT_VALUES: [f64; 5] = [1.0, 0.4, 0.03, 0.9, 1.3];

    fn shapes() -> [CrackShape; 6] {
        let plane = |normal| CrackShape::plane([0.1, -0.05, 0.2], unit(&normal));
        [
            line([-1.2, 0.0], [1.2, 0.0]),
            line([-1.3, -0.7], [1.2, 0.5]),
            line([0.1, 1.4], [-0.2, -1.3]),
            plane([0.0, 0.0, 1.0]),
            plane([1.0, -2.0, 3.0]),
            plane([1.0, 1.0, 0.0]),
        ]
    }

    /// Settings of a shape, and the middle of the crack.
    fn settings(shape: &CrackShape) -> (Vec<Setting<'_>>, Point) {
        let of = setting(shape);
        if let CrackShape::Plane { point, .. } = shape {
            let (model, body) = (Model::Solid, [[-1.0; 3], [1.0, 0.9, 0.8]]);
            return (vec![Setting { model, body, ..of }], *point);
        }
        let centre = LineCrack::new(&of).unwrap().centre;
        let model = Model::PlaneStress;
        (vec![of.clone(), Setting { model, ..of }], centre)
    }

    fn built(of: &Setting<'_>) -> Result<Box<dyn Solution>, String> {
        match of.model {
            Model::Solid => solid(of, &VALUES),
            _ => flat(of, &FLAT_VALUES),
        }
    }

    #[test]
    fn the_field_equations_and_the_contact_laws_hold() {
        for shape in &shapes() {
            let (settings, middle) = settings(shape);
            for of in settings {
                let rows = if of.model == Model::Solid { 3 } else { 0 };
                let places: Vec<[f64; 2]> = (-8..=8)
                    .flat_map(|i| (-rows..=rows).map(move |j| [i, j]))
                    .map(|[i, j]| [0.11 * f64::from(i), 0.27 * f64::from(j)])
                    .collect();
                let frame = shape.frame(&middle);
                let at = |[x1, x2]: [f64; 2], y: f64| {
                    add_scaled(&middle, 1.0, &combine(&frame, [y, x1, x2]))
                };
                let on: Vec<Point> = places.iter().map(|x| at(*x, 0.0)).collect();
                // Off the crack, and off the lines where s''' leaps.
                let off: Vec<Point> = places
                    .iter()
                    .filter(|[p, _]| (p * TAU / 0.9).sin().abs() > 0.02)
                    .flat_map(|x| [-0.6, -0.1, 0.2].map(|y| at(*x, y)))
                    .collect();
                assert!(off.len() >= 45);
                let tolerances = [[1e-14; 2], [1e-4, 1e-9]];
                let path = [0.3, 0.3, 1.0];
                check_form(&*built(&of).unwrap(), &of, &path, [&on, &off], tolerances);
            }
        }
    }

    #[test]
    fn values_and_paths_out_of_range_are_refused() {
        let shapes = shapes();
        let [plane, solids] = [0, 3].map(|k| settings(&shapes[k]).0.remove(0));
        for (k, value) in [(0, 0.3), (2, -0.1), (3, 0.0), (4, 1.0), (6, 2.0)] {
            let mut values = VALUES;
            values[k] = value;
            assert!(solid(&solids, &values).is_err());
            let [p, wave, slip, length, _, _, dip] = values;
            let refused = flat(&plane, &[p, wave, slip, length, dip]).is_err();
            assert_eq!(refused, k != 4);
        }
        for of in [&plane, &solids] {
            assert!(built(of).unwrap().at(&[1.0, 0.9]).is_err());
        }
        let far = CrackShape::plane([5.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let short = line([-0.9, 0.0], [1.2, 0.0]);
        for shape in [&far, &short] {
            assert!(built(&settings(shape).0[0]).is_err());
        }
        let model = Model::Solid;
        assert!(flat(&Setting { model, ..plane }, &FLAT_VALUES).is_err());
    }
}
