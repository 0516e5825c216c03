//! Straight crack under remote stress that grows linearly along it: partly open, partly closed.
//!
//! Without the crack its line would carry the pressure p(s) = p₀ + p₁ s/a. Where the faces would be pulled apart they open,
//! from the end of lower pressure ([`released`] with F = −p₀, c = |p₁|), and the opening ends smoothly (K_I = 0) in front of
//! the closed part:
//!
//! ```text
//!   open on [−a, 2b − a],  b = 2 (x₀ + a)/3,  x₀ = −a p₀/p₁,  −a < x₀ < a/2
//!   opening (2p₁/(aE'))(b − ξ)^{3/2} (b + ξ)^{1/2}            K_I(−a) = √(πb) p₁ b/a
//!   pressure beyond (p₁/a)(ξ + b/2) √((ξ − b)/(ξ + b))
//! ```
//!
//! Otherwise the crack is closed or open over its whole length. There is no shear, so friction does not matter, and the
//! state follows from the present load factor alone. Example: half length 1, stress s (p₀ = 0, p₁ = −1) gives
//! K_I = √(2π/3) 2/3 = 0.9648 at the pulled end; with faces free to overlap it would be √π/2 = 0.8862.
//!
//! Rigid motion: the crack line keeps its direction, its midpoint does not move in the uncracked field.

use super::parts::contact_zone::released;
use super::parts::crack_field::{Background, CrackField};
use super::parts::face_load::Mode;
use super::parts::line_crack::LineCrack;
use super::solution::{Field, Setting, Solution, SolutionSpec, exactly, plane, required};

/// Registry entry.
pub const SPEC: SolutionSpec = SolutionSpec {
    name: "partial-opening",
    summary: "straight 2D crack in an infinite plate under stress growing linearly along it: partly open, partly closed",
    parameters: &[
        required(
            "pressure_pa",
            "pressure p₀ of the uncracked body at the midpoint of the crack, negative: tension",
        ),
        required(
            "pressure_rise_pa",
            "p₁: that pressure at the second end of the crack less that at the midpoint",
        ),
    ],
    build,
};

fn build(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let &[pressure, rise] = exactly(values)?;
    let crack = LineCrack::new(setting)?;
    let elastic = plane(setting)?;
    Ok(Box::new(move |factors: &[f64]| {
        let now = factors.last().copied().unwrap_or(0.0);
        let (pressure, rise) = (now * pressure, now * rise);
        // The crack opens from the end of lower pressure: make it s = −a.
        let crack = if rise < 0.0 { crack.reversed() } else { crack };
        let a = crack.half_length;
        let field: Box<dyn Field> = Box::new(CrackField {
            crack,
            elastic,
            background: Background {
                uniform: [0.0, -pressure, 0.0],
                bending: -rise.abs() / a,
            },
            zones: released(Mode::Opening, a, -pressure, rise.abs())
                .map(|zone| (1.0, zone))
                .into_iter()
                .collect(),
            dissipation: 0.0,
        });
        Ok(field)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{along, check_form, line, setting};
    use crate::material::Model;

    #[test]
    fn the_contact_laws_hold_in_every_state() {
        let shape = line([-0.5, -0.3], [0.4, 0.2]);
        let off = [[0.7, -0.5, 0.0], [-0.8, 0.4, 0.0], [0.2, 0.9, 0.0]];
        let tolerances = [[1e-13, 1e-14], [3e-4, 1e-9]];
        let mut open_points = Vec::new();
        for pressures in [
            [1.0, 0.5],
            [0.2, 0.5],
            [0.2, -0.5],
            [0.0, 1.0],
            [-0.1, -0.5],
            [-0.3, 0.5],
            [-1.0, 0.0],
            [1.0, 0.0],
        ] {
            for model in [Model::PlaneStrain, Model::PlaneStress] {
                let of = Setting {
                    model,
                    ..setting(&shape)
                };
                let along = along(&LineCrack::new(&of).unwrap());
                let solution = build(&of, &pressures).unwrap();
                let path = [0.3, 1.0, -1.0];
                for field in check_form(&*solution, &of, &path, [&along, &off], tolerances) {
                    open_points.push(along.iter().filter(|x| field.jump(x)[0] > 0.0).count());
                }
            }
        }
        // Closed, partly open and open states were all met.
        assert!(open_points.contains(&0) && open_points.contains(&200));
        let partly = open_points.iter().filter(|n| (20..180).contains(*n));
        assert!(partly.count() >= 6);
    }
}
