//! Checks shared by the tests of all closed forms: Hooke's law, equilibrium, consistency of the faces, contact laws.

use crate::geometry::crack_shape::CrackShape;
use crate::geometry::{Point, add_scaled, dot, norm, resolve, sub, unit};
use crate::material::{Lame, Material, Model};

use super::parts::line_crack::{LineCrack, apply};
use super::solution::{Field, Setting, Solution};

/// A setting for tests: E = 2, ν = 0.3, plane strain, μ = 0.5, body [−1, 1]².
pub fn setting(crack: &CrackShape) -> Setting<'_> {
    Setting {
        material: Material::new(2.0, 0.3),
        model: Model::PlaneStrain,
        friction: 0.5,
        crack,
        body: [[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]],
    }
}

/// ∂f/∂x_b at fourth order of the step.
fn derivative<const N: usize>(
    f: impl Fn(&Point) -> [f64; N],
    x: &Point,
    b: usize,
    step: f64,
) -> [f64; N] {
    let at = |k: f64| {
        let mut y = *x;
        y[b] += k * step;
        f(&y)
    };
    let (m2, m1, p1, p2) = (at(-2.0), at(-1.0), at(1.0), at(2.0));
    std::array::from_fn(|i| (8.0 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12.0 * step))
}

/// σ = Hooke(∇u) and div σ + f = 0 at points off the crack, by differences of `step`; `tolerance` is a stress [Pa].
///
/// The differences must not reach over the crack, where the side would change.
fn check_elasticity(
    field: &dyn Field,
    of: &Setting<'_>,
    points: &[Point],
    [step, tolerance]: [f64; 2],
) {
    let lame = Lame::new(of.material, of.model);
    let dim = of.model.dim();
    for x in points {
        // Off the crack the side does not matter: ask for the wrong one half of the time.
        for side in [1.0, -1.0] {
            let gradient: Vec<Point> = (0..dim)
                .map(|b| derivative(|y| field.displacement(y, side), x, b, step))
                .collect();
            let sigma = field.stress(x, side);
            let trace: f64 = (0..dim).map(|a| gradient[a][a]).sum();
            let mut force = field.body_force(x, side);
            for b in 0..dim {
                let rate = derivative(
                    |y| {
                        let s = field.stress(y, side);
                        [s[0][b], s[1][b], s[2][b]]
                    },
                    x,
                    b,
                    step,
                );
                for a in 0..dim {
                    force[a] += rate[a];
                    let mut hooke = lame.mu * (gradient[b][a] + gradient[a][b]);
                    if a == b {
                        hooke += lame.lambda * trace;
                    }
                    let found = sigma[a][b];
                    let error = (found - hooke).abs();
                    assert!(
                        error <= tolerance,
                        "Hooke at {x:?} [{a}{b}]: {found} {hooke}"
                    );
                }
            }
            // Per length of the body, which is of order one in all tests.
            assert!(norm(&force) <= tolerance, "equilibrium at {x:?}: {force:?}");
        }
    }
}

/// Faces and contact laws at points of the crack; `before` is the state one increment earlier, if any.
///
/// `tolerance` is a stress for tractions [Pa] and a length for jumps [m].
pub fn check_contact(
    field: &dyn Field,
    before: Option<&dyn Field>,
    of: &Setting<'_>,
    points: &[Point],
    tolerance: [f64; 2],
) {
    let [stress, length] = tolerance;
    for x in points {
        let axes = of.crack.frame(x);
        let traction = field.traction(x);
        for side in [1.0, -1.0] {
            let found = resolve(&axes, &apply(&field.stress(x, side), &axes[0]));
            for (t, s) in traction.iter().zip(found) {
                let off = (t + s).abs();
                assert!(off <= stress, "face {side} at {x:?}: {t} {s}");
            }
        }
        let jump = field.jump(x);
        let apart = sub(&field.displacement(x, 1.0), &field.displacement(x, -1.0));
        for (j, d) in jump.iter().zip(resolve(&axes, &apart)) {
            assert!((j - d).abs() <= length, "jump at {x:?}: {jump:?} {apart:?}");
        }
        let [p, t_a, t_b] = traction;
        assert!(p >= -stress, "tension at {x:?}: {p}");
        assert!(jump[0] >= -length, "overlap at {x:?}: {jump:?}");
        assert!(p <= stress || jump[0] <= length, "contact apart at {x:?}");
        let shear = t_a.hypot(t_b);
        let bound = of.friction * p.max(0.0);
        assert!(shear <= bound + stress, "shear at {x:?}: {shear} {bound}");
        let old = before.map_or([0.0; 3], |b| b.jump(x));
        let slip = [jump[1] - old[1], jump[2] - old[2]];
        let size = slip[0].hypot(slip[1]);
        if size > 100.0 * length {
            for (t, d) in [t_a, t_b].into_iter().zip(slip) {
                let expected = -bound * d / size;
                let off = (t - expected).abs();
                assert!(off <= stress, "friction at {x:?}: {t} {expected}");
            }
        }
    }
}

/// A form over a path: contact laws at points `on` the crack after every increment, field equations `off` it, and the
/// intensities of a straight crack where the form states any; the states. Tolerances: of tractions [Pa] and jumps [m]; the step
/// of differences [m] and the tolerance of the field equations [Pa].
pub fn check_form(
    solution: &dyn Solution,
    of: &Setting<'_>,
    path: &[f64],
    [on, off]: [&[Point]; 2],
    [contact, elastic]: [[f64; 2]; 2],
) -> Vec<Box<dyn Field>> {
    let at = |k: usize| solution.at(&path[..k]).unwrap();
    let states: Vec<Box<dyn Field>> = (1..=path.len()).map(at).collect();
    for (k, state) in states.iter().enumerate() {
        let before = k.checked_sub(1).map(|k| states[k].as_ref());
        check_contact(state.as_ref(), before, of, on, contact);
        check_elasticity(state.as_ref(), of, off, elastic);
        if let CrackShape::Polyline(points) = of.crack {
            let tip = [points[0][0], points[0][1], 0.0];
            if points.len() == 2 && state.intensity(&tip).is_some() {
                check_intensity(state.as_ref(), of);
            }
        }
    }
    states
}

/// A straight crack.
pub fn line(from: [f64; 2], to: [f64; 2]) -> CrackShape {
    CrackShape::Polyline(vec![from, to])
}

/// Points along a straight crack, off its ends.
pub fn along(crack: &LineCrack) -> Vec<Point> {
    let at = |k| crack.point((f64::from(k) / 100.0 - 0.995) * crack.half_length, 0.0);
    (0..200).map(at).collect()
}

/// K at both ends of a straight crack against the stress just ahead, in the frame (ahead, n).
fn check_intensity(field: &dyn Field, of: &Setting<'_>) {
    let CrackShape::Polyline(points) = of.crack else {
        panic!("not a straight crack")
    };
    let ends = [points[0], points[1]].map(|p| [p[0], p[1], 0.0]);
    let length = norm(&sub(&ends[1], &ends[0]));
    let n = of.crack.frame(&ends[0])[0];
    let rho = 1e-9 * length;
    for (tip, other) in [(ends[0], ends[1]), (ends[1], ends[0])] {
        let ahead = unit(&sub(&tip, &other));
        let on_n = apply(&field.stress(&add_scaled(&tip, rho, &ahead), 1.0), &n);
        let found = field.intensity(&tip).unwrap();
        let root = (2.0 * std::f64::consts::PI * rho).sqrt();
        for (k, stress) in found.iter().zip([dot(&n, &on_n), dot(&ahead, &on_n)]) {
            // The rest is √ρ times the stress that is not singular, at most of order one in all tests.
            let limit = root * stress;
            assert!((k - limit).abs() < 3.0 * root, "{k} {limit}");
        }
    }
}
