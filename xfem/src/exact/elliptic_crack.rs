//! `elliptic-crack`: flat elliptic crack in an infinite solid under remote uniform stress, closed with Coulomb friction or
//! open.
//!
//! ```text
//!   remote traction on side 1:   p = −n σ n (pressure),  τ = σ n − (n σ n) n
//!   jump = D √(1 − x²/a² − y²/b²),  D uniform;  the stress drop is uniform over the crack
//!   open (p < 0): D = (C_n |p|, C_a τ_a, C_b τ_b);   stick (|τ| <= μ p): D = 0;   slip: [`super::parts::elliptic_slip`]
//! ```
//!
//! The slip has one direction everywhere, so Coulomb's law holds at every point and not only on average. Mode I: Green and
//! Sneddon (1950); shear: Kassir and Sih (1966); a disc: Segedin (1950). The field off the crack is that of the jump
//! ([`super::parts::elliptic_disc::DiscPotential`]) and the uniform remote field: relative error 1e-15, 1e-16 a/r at a distance r from the front, where
//! stresses are singular. The uniform part of the displacement vanishes with its rotation at the centre of the crack.
//!
//! Load factors scale the remote stress. With friction and slip they may not fall; the slip then keeps its direction.

use std::f64::consts::PI;

use crate::geometry::crack_shape::CrackShape;
use crate::geometry::ellipse::Ellipse;
use crate::geometry::{Point, add_scaled, combine, cross, dot, rotated, sub};
use crate::material::{self, Lame, Material, Model, strain};

use super::parts::elliptic_disc::disc_potential;
use super::parts::elliptic_slip::{compliance, slip};
use super::parts::line_crack::apply;
use super::solution::{Field, Setting, Solution, SolutionSpec, exactly, growing, stress};

/// The registered solution.
pub const SPEC: SolutionSpec = SolutionSpec {
    name: "elliptic-crack",
    summary: "elliptic or circular crack in an infinite solid under remote stress, slipping, sticking or open",
    parameters: &[
        stress("stress_xx_pa", "remote stress σ_xx, tension positive"),
        stress("stress_yy_pa", "remote stress σ_yy"),
        stress("stress_zz_pa", "remote stress σ_zz"),
        stress("stress_xy_pa", "remote stress σ_xy"),
        stress("stress_yz_pa", "remote stress σ_yz"),
        stress("stress_xz_pa", "remote stress σ_xz"),
    ],
    build,
};

fn build(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let CrackShape::Ellipse(ellipse) = *setting.crack else {
        return Err("elliptic-crack needs an elliptic crack".into());
    };
    if setting.model != Model::Solid {
        return Err("elliptic-crack is a solution of solids".into());
    }
    let &[xx, yy, zz, xy, yz, xz] = exactly(values)?;
    Ok(Box::new(EllipticCrack {
        ellipse,
        material: setting.material,
        friction: setting.friction,
        stress: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
    }))
}

/// The crack under a remote stress for load factor 1.
#[derive(Debug, Clone)]
struct EllipticCrack {
    ellipse: Ellipse,
    material: Material,
    friction: f64,
    stress: [Point; 3],
}

/// State of the crack at one load factor.
#[derive(Debug, Clone)]
struct State {
    ellipse: Ellipse,
    /// Directions of the local coordinates x, y, z: axis, normal × axis, normal.
    frame: [Point; 3],
    material: Material,
    /// Remote stress, global [Pa].
    stress: [Point; 3],
    /// Jump at the centre along the frame [m].
    jump: [f64; 3],
    /// Uniform traction on side 1 along the frame, its last entry the pressure [Pa].
    traction: [f64; 3],
    dissipation: f64,
}

impl EllipticCrack {
    fn state(&self, factor: f64) -> State {
        let normal = self.ellipse.normal;
        let frame = [
            self.ellipse.axis,
            cross(&normal, &self.ellipse.axis),
            normal,
        ];
        let stress = self.stress.map(|row| row.map(|value| factor * value));
        let force = stress.map(|row| dot(&row, &normal));
        let [tau_a, tau_b, tension] = frame.map(|e| dot(&e, &force));
        let c = compliance(self.ellipse.half_axes, self.material);
        let pressure = (-tension).max(0.0);
        let bound = self.friction * pressure;
        let [slip_a, slip_b] = slip([tau_a, tau_b], bound, [c[0], c[1]]);
        State {
            ellipse: self.ellipse,
            frame,
            material: self.material,
            stress,
            jump: [slip_a, slip_b, c[2] * tension.max(0.0)],
            // The remote shear less the drop D/C; force on side 1 is −σ n.
            traction: [slip_a / c[0] - tau_a, slip_b / c[1] - tau_b, pressure],
            dissipation: 0.0,
        }
    }
}

impl Solution for EllipticCrack {
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        let Some(&last) = factors.last() else {
            return Err("no load factor".into());
        };
        if factors.iter().any(|f| *f < 0.0) {
            return Err("elliptic-crack holds for load factors >= 0".into());
        }
        let mut state = self.state(last);
        let unit = self.state(1.0);
        let slips = unit.jump[0] != 0.0 || unit.jump[1] != 0.0;
        if slips && unit.traction[2] > 0.0 && self.friction > 0.0 {
            // ∫ √(1 − x²/a² − y²/b²) dA = 2π a b / 3
            let [a, b] = self.ellipse.half_axes;
            let work = -(unit.traction[0] * unit.jump[0] + unit.traction[1] * unit.jump[1]);
            // Traction and slip are both proportional to the factor f: ∫ f df.
            growing(factors, |factor, before| {
                state.dissipation +=
                    2.0 * PI * a * b / 3.0 * work * 0.5 * (factor + before) * (factor - before);
            })?;
        }
        Ok(Box::new(state))
    }
}

impl State {
    fn lame(&self) -> Lame {
        Lame::new(self.material, Model::Solid)
    }

    /// Local coordinates; z = 0 exactly on the crack plane, so that `side` decides there and not rounding.
    fn local(&self, x: &Point) -> [f64; 3] {
        let d = sub(x, &self.ellipse.centre);
        let mut y = self.frame.map(|e| dot(&e, &d));
        let size = self.ellipse.half_axes[0].max(self.ellipse.half_axes[1]);
        if y[2].abs() <= 1e-12 * size {
            y[2] = 0.0;
        }
        y
    }

    /// √(1 − x²/a² − y²/b²), 0 outside the crack.
    fn profile(&self, x: &Point) -> f64 {
        let [x, y, _] = self.local(x);
        let [a, b] = self.ellipse.half_axes;
        (1.0 - (x / a).powi(2) - (y / b).powi(2)).max(0.0).sqrt()
    }
}

impl Field for State {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let potential = disc_potential(self.ellipse.half_axes, self.local(x), side);
        let layer = potential.displacement(self.jump, self.material.poisson);
        let uniform = apply(
            &strain(self.lame(), 3, &self.stress),
            &sub(x, &self.ellipse.centre),
        );
        add_scaled(&combine(&self.frame, layer), 1.0, &uniform)
    }

    fn stress(&self, x: &Point, side: f64) -> [Point; 3] {
        let potential = disc_potential(self.ellipse.half_axes, self.local(x), side);
        let gradient = potential.gradient(self.jump, self.material.poisson);
        let layer = rotated(&self.frame, &material::stress(self.lame(), 3, &gradient));
        [0, 1, 2].map(|k| add_scaled(&self.stress[k], 1.0, &layer[k]))
    }

    fn traction(&self, _x: &Point) -> [f64; 3] {
        let [a, b, n] = self.traction;
        [n, a, b]
    }

    fn jump(&self, x: &Point) -> [f64; 3] {
        let profile = self.profile(x);
        let [a, b, n] = self.jump;
        [n * profile, a * profile, b * profile]
    }

    /// Behind the front at a distance r the profile is √(2 r γ), γ = √(cos² t/a² + sin² t/b²), and by Irwin's relations
    /// K_I = G D_n √(πγ) / (2 (1−ν)), K_II likewise with D · ahead, K_III = G D · tangent √(πγ) / 2.
    fn intensity(&self, front: &Point) -> Option<[f64; 3]> {
        let Material { young, poisson } = self.material;
        let shear = young / (2.0 * (1.0 + poisson));
        let nearest = self.ellipse.nearest(front);
        let [ahead, _, tangent] = self.ellipse.front_frame(&nearest);
        let [a, b] = self.ellipse.half_axes;
        let [cos, sin] = nearest.parameter;
        let scale = 0.5 * shear * (PI * (cos / a).hypot(sin / b)).sqrt();
        let slip = combine(&self.frame, [self.jump[0], self.jump[1], 0.0]);
        Some([
            scale * self.jump[2] / (1.0 - poisson),
            scale * dot(&slip, &ahead) / (1.0 - poisson),
            scale * dot(&slip, &tangent),
        ])
    }

    fn dissipation(&self) -> Option<f64> {
        Some(self.dissipation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::check::{check_form, setting};
    use crate::geometry::{norm, unit};

    const MATERIAL: Material = Material::new(2.6, 0.3);

    /// Crack with a normal off the axes, and a remote stress with given traction components (σ_nn, σ_na, σ_nb).
    fn crack(half_axes: [f64; 2], [nn, na, nb]: [f64; 3], friction: f64) -> EllipticCrack {
        let normal = unit(&[1.0, -2.0, 3.0]);
        let axis = unit(&cross(&normal, &[0.2, 1.0, 0.4]));
        let ellipse = Ellipse {
            centre: [0.3, -0.1, 0.2],
            normal,
            axis,
            half_axes,
        };
        let frame = [axis, cross(&normal, &axis), normal];
        // Stresses along the crack plane must not matter to it.
        let local = [[0.3, -0.2, na], [-0.2, -0.6, nb], [na, nb, nn]];
        EllipticCrack {
            ellipse,
            material: MATERIAL,
            friction,
            stress: rotated(&frame, &local),
        }
    }

    /// Slipping, open, sticking, without friction, at the limit of stick; discs and ellipses either way round.
    fn cracks() -> [EllipticCrack; 7] {
        [
            crack([1.0, 0.5], [-1.0, 0.5, 0.5], 0.4),
            crack([0.4, 0.9], [-1.0, 0.7, -0.2], 0.3),
            crack([0.8, 0.8], [-1.0, 0.3, -0.6], 0.2),
            crack([1.0, 0.6], [0.5, 0.3, -0.6], 0.2),
            crack([1.0, 0.6], [-1.0, 0.3, -0.1], 0.6),
            crack([1.0, 0.5], [-1.0, 0.3, -0.4], 0.0),
            crack([1.0, 0.5], [-1.0, 0.3, -0.4], 0.5 - 1e-9),
        ]
    }

    #[test]
    fn oblique_slip_has_the_known_size_and_direction() {
        let state = crack([1.0, 0.5], [-1.0, 0.5, 0.5], 0.4).state(1.0);
        let [a, b, _] = state.jump;
        assert!((a.hypot(b) - 0.209_816_176_7).abs() < 1e-10, "{a} {b}");
        assert!((b.atan2(a).to_degrees() - 42.889_538_6).abs() < 1e-7);
    }

    #[test]
    fn penny_intensities_are_segedins() {
        let (a, nu, tau, mu) = (0.8f64, 0.3, 0.67f64, 0.2);
        let state = crack([a, a], [-1.0, tau, 0.0], mu).state(1.0);
        for t in [0.0, 0.7, 2.0, -1.3f64] {
            let [k1, k2, k3] = state.intensity(&state.ellipse.point(t)).unwrap();
            let scale = 4.0 / (2.0 - nu) * (tau - mu) * (a / PI).sqrt();
            assert!(k1 == 0.0 && (k2 - scale * t.cos()).abs() < 1e-14, "{k2}");
            // Tangent = ahead × n = (sin t, −cos t).
            assert!((k3 - scale * (1.0 - nu) * t.sin()).abs() < 1e-14, "{k3}");
        }
        let open = crack([a, a], [0.5, 0.0, 0.0], mu).state(1.0);
        let k1 = open.intensity(&open.ellipse.point(0.4)).unwrap()[0];
        assert!((k1 - 2.0 * 0.5 * (a / PI).sqrt()).abs() < 1e-14);
    }

    #[test]
    fn intensities_are_those_of_the_jump_near_the_front() {
        let (g, nu) = (1.0, 0.3);
        for state in cracks().map(|crack| crack.state(1.0)) {
            for t in [0.3, 1.4, -2.0] {
                let front = state.ellipse.point(t);
                let nearest = state.ellipse.nearest(&front);
                let [ahead, n, tangent] = state.ellipse.front_frame(&nearest);
                let r = 1e-8;
                let x = add_scaled(&front, -r, &ahead);
                let jump = sub(&state.displacement(&x, 1.0), &state.displacement(&x, -1.0));
                let root = (2.0 * PI / r).sqrt();
                let plane = 2.0 * g / (1.0 - nu) / 8.0 * root;
                let exact = [
                    plane * dot(&jump, &n),
                    plane * dot(&jump, &ahead),
                    g / 4.0 * root * dot(&jump, &tangent),
                ];
                let found = state.intensity(&front).unwrap();
                assert!(norm(&sub(&found, &exact)) < 1e-6, "{found:?} {exact:?}");
                // And of the stress ahead of it: σ_n √(2πr) → (K_I, K_II, K_III), the next term being O(√r).
                let r = 1e-10;
                let stress = state.stress(&add_scaled(&front, r, &ahead), 1.0);
                let force = stress.map(|row| dot(&row, &n) * (2.0 * PI * r).sqrt());
                for (k, e) in found.iter().zip([n, ahead, tangent]) {
                    assert!((k - dot(&force, &e)).abs() < 1e-4, "{found:?}");
                }
            }
        }
    }

    #[test]
    fn the_field_equations_and_the_contact_laws_hold() {
        for crack in cracks() {
            let state = crack.state(1.0);
            let shape = CrackShape::Ellipse(crack.ellipse);
            let mut of = setting(&shape);
            (of.model, of.material, of.friction) = (Model::Solid, MATERIAL, crack.friction);
            let [x, y, z] = crack.stress;
            let solution = build(&of, &[x[0], y[1], z[2], x[1], y[2], x[2]]).unwrap();
            let at = |local| add_scaled(&crack.ellipse.centre, 1.0, &combine(&state.frame, local));
            let [a, b] = crack.ellipse.half_axes;
            let on = [[0.0, 0.0], [0.5, 0.4], [-0.7, 0.7], [0.9, -0.43]]
                .map(|[p, q]| at([a * p, b * q, 0.0]));
            // Off the crack, close to it, close to its front, in its plane.
            let off = [
                [0.3, 0.2, 0.3],
                [0.2, -0.1, 0.02],
                [0.9, 0.5, 0.1],
                [1.4, 0.3, 0.0],
            ]
            .map(at);
            let tolerances = [[1e-11, 1e-13], [1e-4, 1e-7]];
            check_form(&*solution, &of, &[0.4, 1.0], [&on, &off], tolerances);
        }
        // Sticking and open, as meant.
        let jumps = cracks().map(|crack| crack.state(1.0).jump);
        assert!(jumps[4] == [0.0; 3] && jumps[3][2] > 0.0 && jumps[2][2] == 0.0);
    }

    #[test]
    fn dissipation_is_friction_times_slip_and_paths_are_checked() {
        let crack = crack([1.0, 0.5], [-1.0, 0.5, 0.5], 0.4);
        let one = crack.at(&[0.0, 1.0]).unwrap().dissipation().unwrap();
        let slip = 0.209_816_176_7;
        assert!((one - 0.5 * 0.4 * slip * 2.0 * PI / 3.0 * 0.5).abs() < 1e-10);
        // One increment or many; what a path starts with is not counted.
        let path: Vec<f64> = (0..=1000).map(|k| f64::from(k) / 1000.0).collect();
        let many = crack.at(&path).unwrap().dissipation().unwrap();
        let rest = crack.at(&[0.5, 1.0]).unwrap().dissipation().unwrap();
        assert!((many - one).abs() < 1e-12 && (rest - 0.75 * one).abs() < 1e-15);
        assert!(crack.at(&[1.0, 0.0]).is_err() && crack.at(&[-1.0]).is_err());
    }
}
