//! Straight crack under linear pressure and growing shear: a slip zone with a moving stick-slip boundary, and its cycles.
//!
//! Pressure p(s) = p₀ + p₁ s/a > 0 along the crack |s| <= a does not change; the remote shear is τ times the load factor.
//! Loaded once, the crack slips where resistance μp is exceeded, from the end of lower pressure ([`released`] with
//! F = |τ| − μp₀, c = μ|p₁|): stick, partial slip or full slip. Call that state g₁(τ).
//!
//! ```text
//!   slip (2μp₁/(aE'))(b − ξ)^{3/2} (b + ξ)^{1/2},  b = 2(x₀ + a)/3,  x₀ = a (τ/μ − p₀)/p₁,  K_II = √(πb) μp₁ b/a
//!   reversed at τ₁:   g = g₁(τ₁) − 2 g₁((τ₁ − τ)/2)           (Masing 1926; Cattaneo 1938, Mindlin 1949)
//! ```
//!
//! and so on at every turning point. A branch that passes the turning point it came from closes its loop and goes on along
//! the branch before; one that passes −τ of the first turning point is on the first loading curve again. The rule is exact:
//! after a reversal, resistance to the change is 2μp, so the change is twice a first loading with half the shear, and
//! the zone of the change grows monotonically. As the pressure is constant, slip within an increment is one-signed, so the
//! state and the dissipation Σ ∫ μp |Δslip| depend on the turning points only, not on the number of increments.
//!
//! Rigid motion: the crack line keeps its direction, its midpoint does not move in the uncracked field.

use crate::material::Lame;

use super::parts::contact_zone::released;
use super::parts::crack_field::{Background, CrackField};
use super::parts::face_load::{FaceLoad, Mode};
use super::parts::line_crack::LineCrack;
use super::solution::{Field, Setting, Solution, SolutionSpec, exactly, plane, required};

/// Registry entry.
pub const SPEC: SolutionSpec = SolutionSpec {
    name: "partial-slip",
    summary: "straight 2D crack in an infinite plate, pressure linear along it, shear scaled by the load factor: partial slip, cycles",
    parameters: &[
        required("pressure_pa", "pressure p₀ at the midpoint of the crack"),
        required(
            "pressure_rise_pa",
            "p₁: pressure at the second end less that at the midpoint, |p₁| < p₀",
        ),
        required("shear_pa", "remote shear stress t·σ·n at load factor 1"),
    ],
    build,
};

fn build(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let &[pressure, rise, shear] = exactly(values)?;
    if rise.abs() >= pressure {
        return Err(
            "the crack must be pressed everywhere: |pressure_rise_pa| < pressure_pa".into(),
        );
    }
    let crack = LineCrack::new(setting)?;
    Ok(Box::new(PartialSlip {
        // Slip starts at the end of lower pressure: make it s = −a.
        crack: if rise < 0.0 { crack.reversed() } else { crack },
        elastic: plane(setting)?,
        friction: setting.friction,
        pressure,
        rise: rise.abs(),
        shear,
    }))
}

struct PartialSlip {
    crack: LineCrack,
    elastic: Lame,
    friction: f64,
    /// p₀ [Pa].
    pressure: f64,
    /// |p₁| [Pa].
    rise: f64,
    /// τ at factor 1 [Pa].
    shear: f64,
}

impl PartialSlip {
    /// g₁(τ): the zone and its sign.
    fn first_loading(&self, shear: f64) -> Option<(f64, FaceLoad)> {
        if shear == 0.0 {
            return None;
        }
        let excess = shear.abs() - self.friction * self.pressure;
        let growth = self.friction * self.rise;
        released(Mode::Shear, self.crack.half_length, excess, growth)
            .map(|zone| (shear.signum(), zone))
    }

    /// Zones of the state that a history of turning points (from 0, the last is now) leads to.
    fn zones(&self, turns: &[f64]) -> Vec<(f64, FaceLoad)> {
        turns
            .windows(2)
            .enumerate()
            .filter_map(|(k, ends)| {
                // Only the first branch starts from the stress-free state.
                let times = if k == 0 { 1.0 } else { 2.0 };
                let (sign, zone) = self.first_loading((ends[1] - ends[0]) / times)?;
                Some((times * sign, zone))
            })
            .collect()
    }

    /// ∫ μp slip ds [J/m].
    fn work(&self, zones: &[(f64, FaceLoad)]) -> f64 {
        let slope = self.rise / self.crack.half_length;
        zones
            .iter()
            .map(|(factor, zone)| {
                let middle = self.pressure + slope * zone.centre;
                factor * self.friction * zone.moment(self.elastic, middle, slope)
            })
            .sum()
    }
}

/// Adds a value to a list of turning points (from 0): drops what is no turning point and the loops that it closes.
fn turn(turns: &mut Vec<f64>, value: f64) {
    turns.push(value);
    loop {
        match turns[..] {
            // On in the same direction.
            [.., a, b, c] if (c - b) * (b - a) >= 0.0 => {
                turns.truncate(turns.len() - 2);
                turns.push(c);
            }
            // Past the mirror image of the first turning point: first loading the other way.
            [_, b, c] if (c - b).abs() >= 2.0 * b.abs() => {
                turns.truncate(1);
                turns.push(c);
            }
            // Past the turning point the last branch but one came from: that loop is closed.
            [.., _, a, b, c] if turns.len() > 3 && (c - b).abs() >= (b - a).abs() => {
                turns.truncate(turns.len() - 3);
                turns.push(c);
            }
            _ => return,
        }
    }
}

impl Solution for PartialSlip {
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        let mut turns = vec![0.0];
        let mut zones = Vec::new();
        let (mut work, mut dissipation) = (0.0, 0.0);
        for (k, factor) in factors.iter().enumerate() {
            turn(&mut turns, factor * self.shear);
            zones = self.zones(&turns);
            let now = self.work(&zones);
            dissipation += if k == 0 { 0.0 } else { (now - work).abs() };
            work = now;
        }
        let now = factors.last().copied().unwrap_or(0.0);
        Ok(Box::new(CrackField {
            crack: self.crack,
            elastic: self.elastic,
            background: Background {
                uniform: [0.0, -self.pressure, now * self.shear],
                bending: -self.rise / self.crack.half_length,
            },
            zones,
            dissipation,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{along, check_form, line, setting};
    use crate::geometry::crack_shape::CrackShape;
    use crate::material::{Material, Model};

    /// a = 1, G = 1, ν = 0.3, μ = 0.5.
    fn example(shape: &CrackShape) -> Setting<'_> {
        Setting {
            material: Material::new(2.6, 0.3),
            ..setting(shape)
        }
    }

    fn at(solution: &dyn Solution, path: &[f64]) -> Box<dyn Field> {
        solution.at(path).unwrap()
    }

    #[test]
    fn turning_points_are_kept_and_closed_loops_forgotten() {
        let after = |path: &[f64]| {
            let mut turns = vec![0.0];
            for &v in path {
                turn(&mut turns, v);
            }
            turns
        };
        assert_eq!(after(&[0.3, 0.7, 1.0]), [0.0, 1.0]);
        assert_eq!(after(&[1.0, 0.2, -0.5]), [0.0, 1.0, -0.5]);
        assert_eq!(after(&[1.0, -0.5, 0.4, 0.1]), [0.0, 1.0, -0.5, 0.4, 0.1]);
        // The inner loop closes at 0.4, the outer one at 1.
        assert_eq!(after(&[1.0, -0.5, 0.4, 0.1, 0.6]), [0.0, 1.0, -0.5, 0.6]);
        assert_eq!(after(&[1.0, -0.5, 0.4, 0.1, 1.2]), [0.0, 1.2]);
        assert_eq!(after(&[1.0, -0.5, 0.4, -0.7]), [0.0, 1.0, -0.7]);
        assert_eq!(after(&[1.0, -0.5, 0.4, -1.3]), [0.0, -1.3]);
        assert_eq!(after(&[1.0, -1.0, 1.0]), [0.0, 1.0]);
    }

    /// b = 5/9: slip on [−1, 1/9], by one increment or many; none stated where slip has several zones, or reaches both ends.
    #[test]
    fn slip_ends_where_the_example_has_it() {
        let shape = line([-1.0, 0.0], [1.0, 0.0]);
        let solution = build(&example(&shape), &[1.0, 0.6, 0.45]).unwrap();
        let boundary = |path: &[f64]| at(&*solution, path).stick_boundary();
        for path in [&[0.0, 1.0][..], &[0.0, 0.2, 0.7, 0.75, 1.0]] {
            let [s, m, _] = boundary(path).unwrap();
            assert!((s - 1.0 / 9.0).abs() < 1e-14 && m == 0.0);
        }
        assert_eq!(boundary(&[1.0, -0.5]).or(boundary(&[2.0])), None);
    }

    /// Both senses of the pressure, both signs of the shear, stick, partial and full slip, loops within loops, both models.
    #[test]
    fn the_contact_laws_hold_along_a_path() {
        let inclined = line([-0.5, -0.3], [0.4, 0.2]);
        let path = [
            0.5, 1.0, 0.3, -0.6, -0.1, -0.3, 0.4, 0.9, -1.2, 0.2, -0.9, 1.0, 1.5, -0.2,
        ];
        let off = [[0.7, -0.5, 0.0], [-0.8, 0.4, 0.0], [0.2, 0.9, 0.0]];
        let tolerances = [[1e-13, 1e-14], [3e-4, 1e-9]];
        let (strain, stress) = (Model::PlaneStrain, Model::PlaneStress);
        for (model, rise, shear) in [
            (strain, 0.6, 0.45),
            (stress, -0.6, 0.45),
            (strain, 0.6, -0.45),
            (stress, -0.3, 0.8),
            (strain, 0.0, 0.6),
            (strain, 0.9, 0.2),
        ] {
            let of = Setting {
                model,
                ..example(&inclined)
            };
            let crack = LineCrack::new(&of).unwrap();
            let solution = build(&of, &[1.0, rise, shear]).unwrap();
            check_form(&*solution, &of, &path, [&along(&crack), &off], tolerances);
            let end = crack.point(crack.half_length * (1.0 - 1e-12), 0.0);
            assert!((at(&*solution, &[0.01]).traction(&end)[0] - 1.0 - rise).abs() < 1e-11);
        }
    }

    #[test]
    fn a_crack_that_would_open_is_refused() {
        let shape = line([-1.0, 0.0], [1.0, 0.0]);
        assert!(build(&example(&shape), &[1.0, -1.0, 0.1]).is_err());
    }
}
