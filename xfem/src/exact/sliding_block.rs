//! Confined block parted by a straight interface: rigid slip under uniform stress, over any path of the top displacement.
//!
//! A block w × H is parted by an interface at angle θ that leaves through its lateral sides. Pressure q acts on both lateral
//! sides, the bottom rolls, the top is pushed down by v times the load factor, the lower left corner is held in x.
//! φ = atan μ, E' and ν' of the plane model:
//!
//! ```text
//!   elastic             s₁ = ν'q + E' (v − s sin θ)/H        vertical pressure, s slip of the upper part down the slope
//!   forward slip at     s₁ = s_f = q tan θ / tan(θ − φ)      never if μ >= tan θ
//!   backward slip at    s₁ = s_r = q tan θ / tan(θ + φ)
//!   traction            p = s₁ cos²θ + q sin²θ, (s₁ − q) sin θ cos θ up the slope on the upper part
//!   dissipation         ∫ (s₁ − q) w sin θ ds
//! ```
//!
//! So the block is a friction spring ([`FrictionSpring`]) with force s₁ − q and slip s sin θ. While it slips s₁ and with it the
//! traction do not change, so the state does not depend on the number of increments. The lateral pressure acts from the start.

use std::f64::consts::FRAC_PI_2;

use crate::geometry::{Point, add_scaled, sub};
use crate::intensity::williams::{plane_modulus, plane_ratio};
use crate::material::strain;

use super::parts::line_crack::{LineCrack, apply};
use super::parts::one_dof::FrictionSpring;
use super::solution::{Field, Setting, Solution, SolutionSpec, exactly, plane, required};

/// Registry entry.
pub const SPEC: SolutionSpec = SolutionSpec {
    name: "sliding-block",
    summary: "2D block parted from side to side, lateral pressure, top pushed down by the load factor: rigid slip, cycles",
    parameters: &[
        required(
            "pressure_pa",
            "pressure q > 0 on the lateral sides, constant",
        ),
        required(
            "displacement_m",
            "downward displacement v of the top at load factor 1",
        ),
    ],
    build,
};

fn build(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let &[pressure, displacement] = exactly(values)?;
    if pressure <= 0.0 {
        return Err("pressure_pa must be positive: without it the block is a mechanism".into());
    }
    let crack = LineCrack::new(setting)?;
    // n upwards: side 1 of this frame is the upper part.
    let crack = if crack.tangent[0] < 0.0 {
        crack.reversed()
    } else {
        crack
    };
    let [low, high] = setting.body;
    for x in [low[0], high[0]] {
        let s = (x - crack.centre[0]) / crack.tangent[0];
        let y = crack.point(s, 0.0)[1];
        // Written so that a vertical interface, where s is not finite, fails too.
        let leaves = s.abs() <= crack.half_length * (1.0 + 1e-12) && y > low[1] && y < high[1];
        if !leaves {
            return Err("the crack must leave the body through both lateral sides".into());
        }
    }
    let slope = crack.tangent[1].abs().atan2(crack.tangent[0]);
    let friction = setting.friction.atan();
    let limit = |angle: f64| pressure * slope.tan() / angle.tan();
    let limits = if slope == 0.0 {
        [f64::NEG_INFINITY, f64::INFINITY]
    } else {
        let forward = if slope > friction {
            limit(slope - friction)
        } else {
            f64::INFINITY
        };
        // At θ + φ = 90° the block can be pulled up to s₁ = 0: tan has no value there.
        let backward = if slope + friction == FRAC_PI_2 {
            0.0
        } else {
            limit(slope + friction)
        };
        [backward, forward]
    };
    let elastic = plane(setting)?;
    let (stiffness, ratio) = (
        plane_modulus(elastic) / (high[1] - low[1]),
        plane_ratio(elastic),
    );
    Ok(Box::new(move |factors: &[f64]| {
        let mut spring = FrictionSpring {
            force: (ratio - 1.0) * pressure,
            ..FrictionSpring::default()
        };
        for (k, factor) in factors.iter().enumerate() {
            let u = factor * displacement + (ratio - 1.0) * pressure / stiffness;
            spring = spring.step(stiffness, u, limits.map(|s| s - pressure));
            if k == 0 {
                spring = spring.rest();
            }
        }
        let vertical = spring.force + pressure;
        let local = crack.components([-pressure, -vertical, 0.0]);
        if local[1] > 0.0 {
            return Err(format!("the interface opens: tension of {} Pa", local[1]));
        }
        // Down the slope, along t for a falling interface; a level one does not slip.
        let sine = crack.tangent[1];
        let slip = if sine == 0.0 {
            0.0
        } else {
            -spring.slip / sine
        };
        let stress = [[-pressure, 0.0, 0.0], [0.0, -vertical, 0.0], [0.0; 3]];
        let field: Box<dyn Field> = Box::new(Block {
            crack,
            corner: low,
            stress,
            strain: strain(elastic, 2, &stress),
            traction: [-local[1], -local[2], 0.0],
            slip,
            dissipation: spring.dissipation * (high[0] - low[0]),
        });
        Ok(field)
    }))
}

/// Uniform stress and rigid slip.
struct Block {
    crack: LineCrack,
    corner: Point,
    /// [Pa]
    stress: [Point; 3],
    strain: [Point; 3],
    traction: [f64; 3],
    /// Of the upper part along the tangent of `crack` [m].
    slip: f64,
    dissipation: f64,
}

impl Field for Block {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let u = apply(&self.strain, &sub(x, &self.corner));
        let (_, m) = self.crack.place(x, side);
        let upper = if m.is_sign_positive() { 1.0 } else { 0.0 };
        add_scaled(&u, upper * self.slip, &self.crack.tangent)
    }

    fn stress(&self, _x: &Point, _side: f64) -> [Point; 3] {
        self.stress
    }

    fn traction(&self, _x: &Point) -> [f64; 3] {
        self.traction
    }

    fn jump(&self, _x: &Point) -> [f64; 3] {
        [0.0, self.slip, 0.0]
    }

    fn dissipation(&self) -> Option<f64> {
        Some(self.dissipation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{check_form, setting};
    use crate::geometry::crack_shape::CrackShape;
    use crate::material::Material;

    const PATH: [f64; 16] = [
        1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0,
    ];

    fn line(degrees: f64) -> CrackShape {
        let rise = 0.6 * degrees.to_radians().tan();
        CrackShape::Polyline(vec![[-0.1, 0.5 - rise], [1.1, 0.5 + rise]])
    }

    /// The unit square of the shipped cases: E = 1, ν = 0.3.
    fn square(shape: &CrackShape, friction: f64) -> Setting<'_> {
        Setting {
            material: Material::new(1.0, 0.3),
            friction,
            body: [[0.0; 3], [1.0, 1.0, 0.0]],
            ..setting(shape)
        }
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} {b}");
    }

    #[test]
    fn a_cycle_gives_the_numbers_of_the_shipped_case() {
        let shape = line(25.0);
        let of = square(&shape, 0.2);
        let solution = build(&of, &[0.01, 0.01]).unwrap();
        for (k, top) in [
            (1, 0.015274725274725275),
            (6, 0.01914313047163978),
            (7, 0.008154119482628792),
            (11, 0.006345703618580372),
            (12, 0.01733471460759136),
        ] {
            let field = solution.at(&PATH[..k]).unwrap();
            close(-field.stress(&[0.5; 3], 1.0)[1][1], top);
        }
        let [six, last] = [6, 16].map(|k| solution.at(&PATH[..k]).unwrap().dissipation().unwrap());
        close(last, 0.0009158073108172716);
        assert!((last - six - 0.00049083688066).abs() < 1e-14);
    }

    /// Rising and falling interfaces, drawn from either end, with and without friction.
    #[test]
    fn the_contact_laws_hold_along_a_path() {
        for degrees in [25.0, -25.0, 40.0, 0.0] {
            let CrackShape::Polyline(points) = line(degrees) else {
                unreachable!()
            };
            let back = points.iter().rev().copied().collect();
            for shape in [CrackShape::Polyline(points), CrackShape::Polyline(back)] {
                for friction in [0.0, 0.2, 2.0] {
                    let of = square(&shape, friction);
                    let crack = LineCrack::new(&of).unwrap();
                    let on = [-0.4, 0.0, 0.3].map(|s| crack.point(s, 0.0));
                    let off = [[0.1, 0.05, 0.0], [0.8, 0.95, 0.0]];
                    let solution = build(&of, &[0.01, 0.01]).unwrap();
                    let tolerances = [[1e-15, 1e-15], [1e-3, 1e-12]];
                    let states = check_form(&*solution, &of, &PATH, [&on, &off], tolerances);
                    for (now, factor) in states.iter().zip(PATH) {
                        let top = now.displacement(&[0.6, 1.0, 0.0], 1.0)[1];
                        assert!((top + 0.01 * factor).abs() < 1e-15);
                        assert_eq!(now.displacement(&[0.0; 3], 1.0), [0.0; 3]);
                    }
                }
            }
        }
    }

    #[test]
    fn interfaces_that_do_not_part_the_block_from_side_to_side_are_refused() {
        for points in [
            vec![[0.2, 0.4], [0.8, 0.6]],
            vec![[0.5, -0.1], [0.5, 1.1]],
            vec![[-0.1, 0.1], [1.1, 1.2]],
        ] {
            let shape = CrackShape::Polyline(points);
            assert!(build(&square(&shape, 0.2), &[0.01, 0.06]).is_err());
        }
        let shape = line(25.0);
        assert!(build(&square(&shape, 0.2), &[0.0, 0.06]).is_err());
        let level = line(0.0);
        let pulled = build(&square(&level, 0.2), &[0.01, -0.06]).unwrap();
        assert!(pulled.at(&[1.0]).is_err());
    }
}
