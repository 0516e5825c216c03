//! Body in uniform stress whose crack holds: patch tests of stick, of hydrostatic pressure and of free faces.
//!
//! ```text
//!   u = ε (x − x_c),  ε = Hooke⁻¹(σ),  jump 0,  contact traction −σ n
//! ```
//!
//! is a solution as long as the traction is admissible on the whole crack: p = −n·σ·n >= 0 and |σn + p n| <= μp. With
//! σ = −p I that is so for a crack of any shape and without friction; with σ n = 0 the faces are free and about to open. Where
//! it is not so the solution is refused. The load factor scales the stress.
//!
//! A straight crack or a plane that is free of traction may also stand open: side 1 moved by δ along n, jump (δ, 0, 0).
//! The load factor scales δ too.
//!
//! In 2D the stress is that of the plane; in plane strain σ_zz follows. Rigid motion: none at x_c, the middle between the
//! ends of a chain of segments, the centre of an arc or ellipse, the stated point of a plane.

use std::f64::consts::PI;

use crate::geometry::crack_shape::CrackShape;
use crate::geometry::{Point, add_scaled, dot, norm, resolve, sub};
use crate::material::{Lame, Model, strain};

use super::parts::line_crack::apply;
use super::solution::{Field, Setting, Solution, SolutionSpec, exactly, stress};

/// Excess over the friction bound, and tension, that count as rounding, per largest stress component.
const ROUNDING: f64 = 1e-12;

/// A point closer to an open crack than this, in units of the body's diagonal, lies on the side that is asked for: meshes put cracks
/// on nodes that they pass as closely.
const ON_CRACK: f64 = 1e-6;

/// Registry entry.
pub const SPEC: SolutionSpec = SolutionSpec {
    name: "uniform-stress",
    summary: "uniform stress, the crack of any shape closed and sticking (or free of traction); 2D and 3D",
    parameters: &[
        stress("stress_xx_pa", "stress σ_xx, tension positive"),
        stress("stress_yy_pa", "stress σ_yy"),
        stress("stress_zz_pa", "stress σ_zz, solids only"),
        stress("stress_xy_pa", "stress σ_xy"),
        stress("stress_yz_pa", "stress σ_yz, solids only"),
        stress("stress_xz_pa", "stress σ_xz, solids only"),
        stress(
            "opening_m",
            "opening δ >= 0 of a straight crack or plane without traction",
        ),
    ],
    build,
};

fn build(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let &[xx, yy, zz, xy, yz, xz, opening] = exactly(values)?;
    let flat = match setting.crack {
        CrackShape::Plane { .. } => true,
        CrackShape::Polyline(points) => points.len() == 2,
        _ => false,
    };
    if opening < 0.0 || (opening > 0.0 && !flat) {
        return Err("only a straight crack or a plane can stand open, by opening_m >= 0".into());
    }
    if setting.model != Model::Solid && [zz, yz, xz] != [0.0; 3] {
        return Err("a plane problem takes the stresses xx, yy and xy only".into());
    }
    let lame = Lame::new(setting.material, setting.model);
    let stress = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    Ok(Box::new(UniformStress {
        crack: setting.crack.clone(),
        friction: setting.friction,
        centre: centre(setting.crack),
        strain: strain(lame, setting.model.dim(), &stress),
        stress,
        opening,
        near: ON_CRACK * norm(&sub(&setting.body[1], &setting.body[0])),
    }))
}

/// x_c.
fn centre(crack: &CrackShape) -> Point {
    match crack {
        CrackShape::Polyline(points) => match (points.first(), points.last()) {
            (Some(p), Some(q)) => [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]), 0.0],
            _ => [0.0; 3],
        },
        CrackShape::Arc { centre, .. } => [centre[0], centre[1], 0.0],
        CrackShape::Ellipse(ellipse) => ellipse.centre,
        CrackShape::Plane { point, .. } => *point,
    }
}

#[derive(Clone)]
struct UniformStress {
    crack: CrackShape,
    friction: f64,
    centre: Point,
    /// [Pa], at factor 1 or at the present one.
    stress: [Point; 3],
    strain: [Point; 3],
    /// δ [m], at factor 1 or at the present one.
    opening: f64,
    /// Distance from the crack below which a point lies on it [m].
    near: f64,
}

impl UniformStress {
    /// Points of the crack at which the contact traction is most critical: one per flat piece, on an arc the ends and the
    /// places where μp − |τ| is stationary.
    fn critical_points(&self) -> Vec<Point> {
        match &self.crack {
            CrackShape::Polyline(points) => points
                .windows(2)
                .map(|p| [0.5 * (p[0][0] + p[1][0]), 0.5 * (p[0][1] + p[1][1]), 0.0])
                .collect(),
            CrackShape::Arc {
                centre,
                radius,
                from,
                to,
            } => {
                // On the Mohr circle p = −m − R cos(2α − β), |τ| = R |sin(2α − β)| for the normal at angle α:
                // μp ∓ τ is stationary where tan(2α − β) = ±1/μ.
                let [x, y, _] = self.stress;
                let beta = x[1].atan2(0.5 * (x[0] - y[1]));
                let (low, high) = (from.min(*to), from.max(*to));
                let slope = 1.0_f64.atan2(self.friction);
                let stationary = [slope, -slope]
                    .into_iter()
                    .flat_map(|psi| (0..4).map(move |k| 0.5 * (beta + psi + PI * k as f64)));
                stationary
                    // The one turn of the angle that may lie within the arc.
                    .map(|alpha| low + (alpha - low).rem_euclid(2.0 * PI))
                    .filter(|alpha| *alpha <= high)
                    .chain([low, high])
                    .map(|alpha| {
                        [
                            centre[0] + radius * alpha.cos(),
                            centre[1] + radius * alpha.sin(),
                            0.0,
                        ]
                    })
                    .collect()
            }
            CrackShape::Ellipse(ellipse) => vec![ellipse.centre],
            CrackShape::Plane { point, .. } => vec![*point],
        }
    }

    /// Refuses a state whose contact traction is not admissible.
    fn admissible(&self) -> Result<(), String> {
        let largest = self
            .stress
            .as_flattened()
            .iter()
            .fold(0.0_f64, |m, s| m.max(s.abs()));
        let rounding = ROUNDING * largest;
        for x in self.critical_points() {
            let [p, a, b] = self.traction(&x);
            if p < -rounding {
                return Err(format!("the crack is under tension of {} Pa at {x:?}", -p));
            }
            if self.opening > 0.0 && p.hypot(a).hypot(b) > rounding {
                return Err(format!(
                    "an open crack carries traction ({p}, {a}, {b}) Pa at {x:?}"
                ));
            }
            if self.opening < 0.0 {
                return Err("the faces overlap".into());
            }
            let (shear, bound) = (a.hypot(b), self.friction * p.max(0.0));
            if shear > bound + rounding {
                return Err(format!(
                    "the crack slips at {x:?}: shear {shear} Pa, friction bound {bound} Pa"
                ));
            }
        }
        Ok(())
    }
}

impl Solution for UniformStress {
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        let mut state = self.clone();
        // Every state on the way must hold: slip would stay.
        for factor in factors {
            let scaled = |t: &[Point; 3]| t.map(|row| row.map(|v| factor * v));
            state.stress = scaled(&self.stress);
            state.strain = scaled(&self.strain);
            state.opening = factor * self.opening;
            state.admissible()?;
        }
        Ok(Box::new(state))
    }
}

impl Field for UniformStress {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let u = apply(&self.strain, &sub(x, &self.centre));
        if self.opening == 0.0 {
            return u;
        }
        // The centre of a straight crack or plane lies on it.
        let normal = self.crack.frame(x)[0];
        let distance = dot(&normal, &sub(x, &self.centre));
        let side = if distance.abs() <= self.near {
            side
        } else {
            distance
        };
        let moved = if side > 0.0 { self.opening } else { 0.0 };
        add_scaled(&u, moved, &normal)
    }

    fn stress(&self, _x: &Point, _side: f64) -> [Point; 3] {
        self.stress
    }

    fn traction(&self, x: &Point) -> [f64; 3] {
        let axes = self.crack.frame(x);
        resolve(&axes, &apply(&self.stress, &axes[0])).map(|t| -t)
    }

    fn jump(&self, _x: &Point) -> [f64; 3] {
        [self.opening, 0.0, 0.0]
    }

    fn intensity(&self, _front: &Point) -> Option<[f64; 3]> {
        Some([0.0; 3])
    }

    fn dissipation(&self) -> Option<f64> {
        Some(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{check_contact, check_form, line, setting};
    use crate::geometry::ellipse::Ellipse;
    use crate::geometry::unit;

    fn held(of: &Setting<'_>, stress: &[f64; 6]) -> Result<Box<dyn Solution>, String> {
        build(of, &[stress.as_slice(), &[0.0]].concat())
    }

    fn with<'a>(shape: &'a CrackShape, model: Model, friction: f64) -> Setting<'a> {
        Setting {
            model,
            friction,
            ..setting(shape)
        }
    }

    #[test]
    fn an_elliptic_crack_holds_under_six_components() {
        let shape = CrackShape::Ellipse(Ellipse {
            centre: [0.1, 0.0, -0.2],
            normal: unit(&[1.0, 1.0, 1.0]),
            axis: unit(&[1.0, -1.0, 0.0]),
            half_axes: [0.5, 0.3],
        });
        let of = with(&shape, Model::Solid, 0.5);
        let stress = [-1.0, -1.2, -0.9, 0.1, -0.15, 0.05];
        let places: [&[Point]; 2] = [&[[0.1, 0.0, -0.2]], &[[0.4, 0.3, 0.2]]];
        let solution = held(&of, &stress).unwrap();
        let tolerances = [[1e-14, 1e-15], [1e-2, 1e-12]];
        check_form(&*solution, &of, &[1.0], places, tolerances);
        let slippery = with(&shape, Model::Solid, 0.05);
        assert!(held(&slippery, &stress).unwrap().at(&[1.0]).is_err());
    }

    #[test]
    fn free_faces_and_the_friction_bound_are_admitted_and_no_more() {
        let shape = line([-1.0, 0.0], [1.0, 0.0]);
        let of = with(&shape, Model::PlaneStrain, 0.0);
        for (yy, admitted) in [(0.0, true), (1e-9, false)] {
            let solution = held(&of, &[1.0, yy, 0.0, 0.0, 0.0, 0.0]).unwrap();
            assert_eq!(solution.at(&[1.0]).is_ok(), admitted);
        }
        assert!(held(&of, &[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]).is_err());
        // A block on a slope of 1/2: the bound itself is admitted, less friction is not.
        let shape = line([-1.0, -0.5], [1.0, 0.5]);
        for (friction, admitted) in [(0.5, true), (0.4999, false)] {
            let of = with(&shape, Model::PlaneStress, friction);
            let solution = held(&of, &[0.0, -5.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
            assert_eq!(solution.at(&[1.0]).is_ok(), admitted);
        }
    }

    /// The verdict on an arc agrees with a fine sampling of it.
    #[test]
    fn an_arc_is_judged_at_its_worst_point() {
        let mut verdicts = [0, 0];
        for k in 0..200 {
            let r = |m: usize| ((k * m) % 97) as f64 / 97.0;
            let from = 6.0 * r(13) - 3.0;
            let to = from + 4.0 * r(31) - 2.0;
            let arc = CrackShape::arc([0.0, 0.0], 1.0, [from, to]);
            let of = with(&arc, Model::PlaneStrain, r(7));
            let [xx, yy, xy] = [-1.0 - r(3), -1.0 - r(5), r(11) - 0.5];
            let solution = held(&of, &[xx, yy, 0.0, xy, 0.0, 0.0]).unwrap();
            let accepted = solution.at(&[1.0]).is_ok();
            let slack = |j: i32| {
                let (sin, cos) = (from + (to - from) * f64::from(j) / 20000.0).sin_cos();
                let s = [xx * cos + xy * sin, xy * cos + yy * sin];
                let p = -(s[0] * cos + s[1] * sin);
                of.friction * p - (s[1] * cos - s[0] * sin).abs()
            };
            let least = (0..=20000).map(slack).fold(f64::INFINITY, f64::min);
            if least.abs() > 1e-6 {
                assert_eq!(accepted, least > 0.0, "{k}: {least}");
                verdicts[usize::from(accepted)] += 1;
            }
        }
        assert!(verdicts[0] > 20 && verdicts[1] > 20, "{verdicts:?}");
    }

    #[test]
    fn a_crack_free_of_traction_may_stand_open_and_no_other() {
        let flat = line([-1.0, 0.5], [3.0, 0.5]);
        let arc = CrackShape::arc([0.0, 0.0], 1.0, [0.0, 1.0]);
        let mut of = setting(&flat);
        of.body = [[0.0; 3], [1.0, 1.0, 0.0]];
        let open = |of: &Setting<'_>, yy: f64, opening: f64| {
            build(of, &[2.0, yy, 0.0, 0.0, 0.0, 0.0, opening])
        };
        let [field, closed] = [0.1, 0.0].map(|by| open(&of, 0.0, by).unwrap().at(&[0.5]).unwrap());
        for (y, side, moved) in [
            (0.7, -1.0, 0.05),
            (0.3, 1.0, 0.0),
            (0.5, 1.0, 0.05),
            (0.5, -1.0, 0.0),
        ] {
            let [u, v] = [&field, &closed].map(|field| field.displacement(&[0.3, y, 0.0], side));
            assert!(norm(&sub(&sub(&u, &v), &[0.0, moved, 0.0])) < 1e-16);
        }
        check_contact(&*field, None, &of, &[[0.2, 0.5, 0.0]], [1e-15, 1e-15]);
        assert!(open(&of, -1.0, 0.1).unwrap().at(&[1.0]).is_err());
        assert!(open(&of, 0.0, 0.1).unwrap().at(&[-1.0]).is_err());
        assert!(open(&of, 0.0, -0.1).is_err());
        assert!(open(&setting(&arc), 0.0, 0.1).is_err());
    }
}
