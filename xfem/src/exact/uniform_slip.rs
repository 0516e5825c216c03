//! Straight crack in an infinite plate under uniform remote stress: stick, slip over its whole length, or open.
//!
//! With p = −n·σ·n and τ = t·σ·n of the remote stress, A the face load of [`FaceLoad`] and half length a:
//!
//! ```text
//!   open   p < 0          faces free: opening A = −p, shear A = τ
//!   stick  |τ − A| <= μp  A as before
//!   slip   otherwise      A = τ ∓ μp: uniform shear traction μp against the slip (4/E') A √(a² − s²)
//!
//!   K_I = max(−p, 0) √(πa), |K_II| = |A| √(πa)        dissipation of a slip increment ∫ μp |dA| 2πa²/E'
//! ```
//!
//! On a straight crack slip does not change the pressure and opening does not change the shear, so all points slip alike
//! and the crack is a friction spring ([`FrictionSpring`]). The load factor scales the remote stress. Over a path of
//! factors the state is the exact solution of the incremental problem (backward Euler). From rest the pressure grows with the
//! slip: D = ½ μp |A| 2πa²/E'. Source: F. A. McClintock and J. B. Walsh (1962), sliding crack under compression.
//!
//! Rigid motion: the midpoint of the crack does not move on average, the crack line does not turn.

use std::f64::consts::PI;

use crate::intensity::williams::plane_modulus;

use super::parts::crack_field::{Background, CrackField};
use super::parts::face_load::{FaceLoad, Mode};
use super::parts::line_crack::LineCrack;
use super::parts::one_dof::FrictionSpring;
use super::solution::{Field, Setting, Solution, SolutionSpec, exactly, plane, stress};

/// Registry entry.
pub const SPEC: SolutionSpec = SolutionSpec {
    name: "uniform-slip",
    summary: "straight 2D crack in an infinite plate under uniform remote stress: stick, full slip or open",
    parameters: &[
        stress("stress_xx_pa", "remote stress σ_xx, tension positive"),
        stress("stress_yy_pa", "remote stress σ_yy"),
        stress("stress_xy_pa", "remote stress σ_xy"),
    ],
    build,
};

fn build(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let crack = LineCrack::new(setting)?;
    let remote = crack.components(*exactly(values)?);
    let (elastic, friction) = (plane(setting)?, setting.friction);
    Ok(Box::new(move |factors: &[f64]| {
        let [_, nn, tn] = remote;
        // The spring's displacement is the remote shear, its slip the face load A, its force the traction.
        let mut spring = FrictionSpring::default();
        for (k, factor) in factors.iter().enumerate() {
            let bound = friction * (-factor * nn).max(0.0);
            spring = spring.step(1.0, factor * tn, [-bound, bound]);
            if k == 0 {
                spring = spring.rest();
            }
        }
        let now = factors.last().copied().unwrap_or(0.0);
        let a = crack.half_length;
        let opening = (now * nn).max(0.0);
        let loads = [(Mode::Opening, opening), (Mode::Shear, spring.slip)];
        let loads = loads.into_iter().filter(|(_, load)| *load != 0.0);
        let field: Box<dyn Field> = Box::new(CrackField {
            crack,
            elastic,
            background: Background {
                uniform: remote.map(|s| now * s),
                bending: 0.0,
            },
            zones: loads
                .map(|(mode, load)| (1.0, FaceLoad::new(mode, 0.0, a, load, 0.0)))
                .collect(),
            dissipation: spring.dissipation * 2.0 * PI * a * a / plane_modulus(elastic),
        });
        Ok(field)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{along, check_form, line, setting};
    use crate::geometry::Point;

    const OFF: [Point; 3] = [[0.8, 0.3, 0.0], [-0.6, 0.5, 0.0], [0.2, -0.7, 0.0]];
    const TOLERANCES: [[f64; 2]; 2] = [[1e-13, 1e-14], [3e-4, 1e-9]];

    /// States along a path under (xx, yy, xy), checked.
    fn states(of: &Setting<'_>, stress: [f64; 3], path: &[f64]) -> Vec<Box<dyn Field>> {
        let on = along(&LineCrack::new(of).unwrap());
        let solution = build(of, &stress).unwrap();
        check_form(&*solution, of, path, [&on, &OFF], TOLERANCES)
    }

    /// Uniaxial compression of an inclined crack: slip iff μ < tan θ.
    #[test]
    fn an_inclined_crack_slips_when_it_is_steeper_than_the_friction_angle() {
        let a = 0.45;
        for (degrees, friction) in [
            (27.0_f64, 0.3),
            (27.0, 0.6),
            (27.0, 0.0),
            (153.0, 0.3),
            (-60.0, 1.0),
        ] {
            let (s, c) = degrees.to_radians().sin_cos();
            let end = |sign: f64| [0.1 + sign * a * c, -0.07 + sign * a * s];
            let shape = line(end(-1.0), end(1.0));
            let of = Setting {
                friction,
                ..setting(&shape)
            };
            let field = &states(&of, [0.0, -1.0, 0.0], &[0.0, 1.0])[1];
            let slip = field.jump(&[0.1, -0.07, 0.0])[1];
            assert_eq!(slip != 0.0, s.abs() > friction * c.abs(), "{degrees}");
        }
    }

    /// Loading, unloading (the slip stays until the shear reverses), opening and closing again.
    #[test]
    fn the_contact_laws_hold_along_a_path() {
        let shape = line([-0.4, -0.1], [0.4, 0.1]);
        for stress in [[0.0, -1.0, 0.9], [-0.2, -1.0, 0.1]] {
            let path = [0.0, 0.4, 1.0, 0.9, 0.5, 0.2, 0.05, -0.3, 0.2, 1.2];
            let states = states(&setting(&shape), stress, &path);
            let dissipated = states.iter().map(|state| state.dissipation().unwrap());
            assert!(dissipated.is_sorted());
        }
    }
}
