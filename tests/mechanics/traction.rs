//! The traction operator against stresses known in closed form.

use crate::common::bodies::{bodies, bodies_like, motions, piecewise};
use crate::common::*;
use stickslip::model::body::{Body, Needs};
use stickslip_xfem::contact::traction::traction_rows;
use stickslip_xfem::fields::sampling::comparison_points;
use stickslip_xfem::material::{Lame, double_dot, strain};

const TRACTION: Needs = Needs {
    frictionless: Vec::new(),
    traction: true,
};

/// A linear field u = h x.
type Gradient = [[f64; 3]; 3];

fn linear(h: &Gradient, x: &[f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|a| (0..3).map(|b| h[a][b] * x[b]).sum())
}

fn gradient(random: &mut Random, dim: usize) -> Gradient {
    let mut h = [[0.0; 3]; 3];
    for row in &mut h[..dim] {
        for value in &mut row[..dim] {
            *value = random.between(-1.0, 1.0);
        }
    }
    h
}

/// −w σ n of a uniform stress, in the local frames of all points.
fn exact(body: &Body, stress: impl Fn(usize) -> Gradient) -> Vec<f64> {
    let dim = body.mesh.dim();
    let mut all = Vec::new();
    for (i, point) in body.points.iter().enumerate() {
        let s = stress(i);
        for e in &point.frame[..dim] {
            let t: f64 = (0..9)
                .map(|k| e[k / 3] * s[k / 3][k % 3] * point.frame[0][k % 3])
                .sum();
            all.push(-point.weight * t);
        }
    }
    all
}

/// Hooke's law with the constants of the body, σ = λ tr ε I + 2 μ ε.
fn hooke(lame: Lame, h: &Gradient) -> Gradient {
    let trace: f64 = (0..3).map(|a| h[a][a]).sum();
    let mut s = [[0.0; 3]; 3];
    for a in 0..3 {
        for b in 0..3 {
            s[a][b] = lame.mu * (h[a][b] + h[b][a]);
        }
        s[a][a] += lame.lambda * trace;
    }
    s
}

/// Source: Hooke's law. Goal: in a uniform stress every point of every kind of crack (oblique, through nodes, on cell edges,
/// with tips, 2D and 3D) gets −w σ n, whatever rigid motions part the pieces; rigid motions alone give no force. By the full
/// and by the mean dilatation.
/// Tolerance: rounding, relative to the largest force; gradients of slivers are as good as those of whole cells.
#[test]
fn uniform_stress_gives_its_exact_traction_and_rigid_motions_none() {
    let mut random = Random(17);
    let mean = bodies_like(TRACTION, |text| of_ratio(text, 0.4999));
    for (name, body) in bodies(TRACTION).into_iter().chain(mean) {
        let dim = body.mesh.dim();
        assert_eq!(body.traction_rows.len(), dim * body.points.len(), "{name}");
        let h = gradient(&mut random, dim);
        let expected = exact(&body, |_| hooke(body.lame, &h));
        let motions = motions(dim);
        let amounts: Vec<Vec<f64>> = (0..4).map(|_| random.vector(motions.len())).collect();
        let rigid = |piece: usize, x: &[f64; 3]| {
            let mut u = [0.0; 3];
            for (c, r) in amounts[piece].iter().zip(&motions) {
                (0..3).for_each(|a| u[a] += c * r(x)[a]);
            }
            u
        };
        let found = body.traction(&piecewise(&body, |piece, x| {
            let (u, r) = (linear(&h, x), rigid(piece, x));
            [0, 1, 2].map(|a| u[a] + r[a])
        }));
        let error = relative_difference(&found, &expected);
        assert!(error < 1e-12, "{name}: {error:e}");
        let still = body.traction(&piecewise(&body, rigid));
        let size = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        assert!(still.iter().all(|t| t.abs() < 1e-12 * size), "{name}");
    }
}

/// Source: Hooke's law of plane stress, σ_xx = E/(1 − ν²) (ε_xx + ν ε_yy). Goal: the model of the body is the operator's.
#[test]
fn plane_stress_takes_its_own_law() {
    let rest = crack([-1.0, 0.5], [2.0, 0.5], 0.3, "none") + &clamped(2);
    for (model, factor) in [
        ("plane-stress", 1.0 / (1.0 - 0.09)),
        ("plane-strain", 0.7 / (1.3 * 0.4)),
    ] {
        let text = plane([0.0, 0.0], [1.0, 1.0], [3, 3], &rest).replace("plane-strain", model);
        let body = Body::new(&parse(&text), 1, &TRACTION).unwrap();
        let found = body.traction(&piecewise(&body, |_, x| [0.0, -x[1], 0.0]));
        for (point, tau) in body.points.iter().zip(found.chunks_exact(2)) {
            assert!((tau[0] - factor * point.weight).abs() < 1e-13, "{tau:?}");
            assert!(tau[1].abs() < 1e-13, "{tau:?}");
        }
    }
}

/// Two different uniform stresses on the two sides of a horizontal crack at fraction e of a row: the mean has the weights
/// (1 − e) on side 1 (above) and e on side 2, however thin the sliver.
#[test]
fn sides_are_weighted_by_their_part_of_the_cut_cells() {
    let mut random = Random(19);
    for dim in [2, 3] {
        for e in [0.5, 0.3, 1e-3, 1e-5] {
            let z = 1.0 + e;
            let body = Body::new(
                &parse(&if dim == 2 {
                    let rest = crack([-1.0, z], [4.0, z], 0.3, "none") + &clamped(2);
                    plane([0.0, 0.0], [3.0, 3.0], [3, 3], &rest)
                } else {
                    let planes = [([0.0, 0.0, z], [0.0, 0.0, 1.0], 0.3)];
                    solid([3.0, 3.0, 3.0], [3, 3, 3], &planes, &clamped(3))
                }),
                1,
                &TRACTION,
            )
            .unwrap();
            let h = [gradient(&mut random, dim), gradient(&mut random, dim)];
            let lower =
                stickslip_xfem::enrichment::pieces::pieces(&body.mesh, &body.enrichment).of_node(0);
            let u = piecewise(&body, |p, x| linear(&h[usize::from(p == lower)], x));
            let expected = exact(&body, |_| {
                let [upper, lower] = [hooke(body.lame, &h[0]), hooke(body.lame, &h[1])];
                [0, 1, 2].map(|a| [0, 1, 2].map(|b| (1.0 - e) * upper[a][b] + e * lower[a][b]))
            });
            let error = relative_difference(&body.traction(&u), &expected);
            // The height of the sliver itself is known to 1e-16/e.
            assert!(error < 1e-12 + 1e-14 / e, "{dim} {e}: {error:e}");
        }
    }
}

/// The force vector of a point is one vector in space: turning the tangents turns the components.
#[test]
fn tangent_frames_do_not_change_the_force() {
    let mut random = Random(23);
    for (name, body) in bodies(TRACTION) {
        if body.mesh.dim() == 2 {
            continue;
        }
        let (sin, cos) = 0.7f64.sin_cos();
        let mut points = body.points.clone();
        for point in &mut points {
            let [n, a, b] = point.frame;
            point.frame = [
                n,
                [0, 1, 2].map(|k| cos * a[k] + sin * b[k]),
                [0, 1, 2].map(|k| cos * b[k] - sin * a[k]),
            ];
        }
        let turned = traction_rows(&body.integrator(), &points).unwrap();
        let u = random.vector(body.numbers.len());
        let found: Vec<f64> = turned
            .iter()
            .map(|row| row.iter().map(|&(i, v)| v * u[i]).sum())
            .collect();
        let expected: Vec<f64> = body
            .traction(&u)
            .chunks_exact(3)
            .flat_map(|t| [t[0], cos * t[1] + sin * t[2], cos * t[2] - sin * t[1]])
            .collect();
        let error = relative_difference(&found, &expected);
        assert!(error < 1e-12, "{name}: {error:e}");
    }
}

/// Source: σ = P β, K = Lᵀ H⁻¹ L. Goal: of any displacement ∫ σ:C⁻¹:σ by the stress that fields, errors and tractions take is
/// u·K u to rounding: one stress everywhere, assumed in whole cells and in parts of cut ones, of the gradient in slivers.
#[test]
fn the_energy_of_the_stress_is_that_of_the_stiffness() {
    let mut random = Random(31);
    let bodies = bodies(Needs::default()).into_iter();
    for (name, body) in bodies.filter(|(_, body)| body.enrichment.tips.is_empty()) {
        let (integrator, dim) = (body.integrator(), body.mesh.dim());
        let u = random.vector(body.numbers.len());
        let force = body.stiffness.mul(&u);
        let expected: f64 = force.iter().zip(&u).map(|(f, u)| f * u).sum();
        let mut found = 0.0;
        for cell in 0..body.mesh.cell_count() {
            let mut stress = integrator.stress(cell).unwrap();
            for p in comparison_points(&integrator, cell, &[], 4).unwrap() {
                let p = p.point;
                let h = stress.field(&p.xi, &p.x, p.region, &u).1;
                let s = hooke(body.lame, &h);
                found += p.weight * double_dot(&s, &strain(body.lame, dim, &s));
            }
        }
        assert!((found / expected - 1.0).abs() < 1e-11, "{name}");
    }
}

/// Near a tip the stress of the branch functions counts: the mean over the parts equals the one from differences of the
/// displacement itself, and is finite at every point.
#[test]
fn stresses_of_branch_functions_are_those_of_the_displacement() {
    let mut random = Random(29);
    let full = |text: &str| text.replace("poisson = 0.3", "poisson = 0.3, dilatation = \"full\"");
    for (name, body) in bodies_like(TRACTION, full) {
        if !name.contains("tip") || name == "no tip" {
            continue;
        }
        let integrator = body.integrator();
        let u = random.vector(body.numbers.len());
        let found = body.traction(&u);
        let step = 1e-6;
        let mut near_tip = 0;
        for (point, tau) in body.points.iter().zip(found.chunks_exact(2)) {
            let mut mean = [[0.0; 3]; 3];
            let mut total = 0.0;
            for cell in stickslip_xfem::cut::placement::cells_at(&body.mesh, &point.x) {
                near_tip += usize::from(body.enrichment.has_branch(cell));
                let points = integrator.points(cell).unwrap();
                for region in 0..body.enrichment.regions(cell) {
                    let side = body.enrichment.side(cell, region, 0).unwrap_or(1.0);
                    let measure: f64 = (points.iter().filter(|p| p.region == region))
                        .map(|p| p.weight)
                        .sum();
                    // A corner of the part: step into the cell, along the crack and away from it.
                    let centre = body.mesh.centre(cell);
                    let along: f64 = (0..2)
                        .map(|k| (centre[k] - point.x[k]) * point.frame[1][k])
                        .sum();
                    let at = |a: f64, n: f64| {
                        let x = [0, 1, 2].map(|k| {
                            point.x[k]
                                + a * along.signum() * point.frame[1][k]
                                + n * side * point.frame[0][k]
                        });
                        integrator.displacement(cell, &x, region, &u).unwrap()
                    };
                    let (o, a, n) = (at(0.0, 0.0), at(step, 0.0), at(0.0, step));
                    let (a2, n2) = (at(2.0 * step, 0.0), at(0.0, 2.0 * step));
                    let mut h = [[0.0; 3]; 3];
                    for i in 0..2 {
                        let slope = |f: f64, f2: f64| (4.0 * f - f2 - 3.0 * o[i]) / (2.0 * step);
                        let (da, dn) = (
                            along.signum() * slope(a[i], a2[i]),
                            side * slope(n[i], n2[i]),
                        );
                        for b in 0..2 {
                            h[i][b] = da * point.frame[1][b] + dn * point.frame[0][b];
                        }
                    }
                    let s = hooke(body.lame, &h);
                    (0..9).for_each(|k| mean[k / 3][k % 3] += measure * s[k / 3][k % 3]);
                    total += measure;
                }
            }
            let scale: f64 = tau[0].hypot(tau[1]) + point.weight;
            for (e, t) in point.frame.iter().zip(tau) {
                let exact: f64 = (0..9)
                    .map(|k| e[k / 3] * mean[k / 3][k % 3] * point.frame[0][k % 3])
                    .sum();
                let exact = -point.weight * exact / total;
                assert!((t - exact).abs() < 1e-6 * scale, "{name}: {t} {exact}");
            }
        }
        assert!(
            near_tip > 0,
            "{name}: no point at a cell with branch functions"
        );
    }
}

/// A run pays for the operator only if a method asks for it.
#[test]
fn bodies_have_no_traction_operator_unless_asked() {
    let rest = crack([-1.0, 0.5], [2.0, 0.5], 0.3, "none") + &clamped(2);
    let body = body(&plane([0.0, 0.0], [1.0, 1.0], [3, 3], &rest));
    assert!(body.traction_rows.is_empty());
    assert!(body.traction(&vec![1.0; body.numbers.len()]).is_empty());
}
