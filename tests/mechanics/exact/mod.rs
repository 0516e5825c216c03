//! Supports and loads that take their values from a closed form, through the whole chain.

mod forms;

use crate::common::*;
use forms::{FORMS, K, Point, Smooth, map};
use stickslip::case;
use stickslip::case::{Amount, Case};
use stickslip::model::body::{Body, BodyError, Needs};
use stickslip::model::loading::Loading;
use stickslip::run::verdict::Verdict;
use stickslip_methods::Load;
use stickslip_xfem::enrichment::cell_facets::region_at;
use stickslip_xfem::exact::Field;
use stickslip_xfem::material::Lame;

fn exact_case(text: &str) -> Case {
    case::parse_with("test.toml", text, FORMS).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn all_sides(dim: usize, displacement: &str) -> String {
    clamped(dim).replace(if dim == 2 { "[0, 0]" } else { "[0, 0, 0]" }, displacement)
}

/// Goal: on supported sides both faces of a crack that leaves there move as the closed form says, wherever it cuts: an
/// affine map per side is reproduced all along the side, on both sides of the crack, at every increment.
/// Tolerance: rounding of sums of terms of order one.
#[test]
fn prescribed_sides_follow_the_closed_form_on_both_faces() {
    let exact = "[exact]\nsolution = \"two-maps\"\n[path]\nincrements = 3\n";
    let flat = |p: [f64; 2], q: [f64; 2]| {
        let rest = crack(p, q, 0.3, "none") + exact + &all_sides(2, "\"exact\"");
        plane([0.0, 0.0], [3.0, 3.0], [6, 6], &rest)
    };
    let block = |point: Point, normal: Point| {
        let rest = exact.to_owned() + &all_sides(3, "[\"exact\", \"exact\", \"exact\"]");
        solid([3.0, 3.0, 3.0], [3, 3, 3], &[(point, normal, 0.3)], &rest)
    };
    for (name, text) in [
        ("straight", flat([-1.0, 1.6], [4.0, 1.6])),
        ("reversed", flat([4.0, 1.6], [-1.0, 1.6])),
        ("oblique", flat([-1.0, 0.3], [4.0, 2.6])),
        ("through nodes", flat([-1.0, -1.0], [4.0, 4.0])),
        ("on cell edges", flat([-1.0, 1.5], [4.0, 1.5])),
        ("distorted", moved(&flat([-1.0, 0.3], [4.0, 2.6]))),
        ("plane", block([0.0, 0.0, 1.7], [0.0, 0.0, 1.0])),
        ("oblique plane", block([1.4, 1.6, 1.5], [1.0, 0.3, 2.0])),
        ("plane on facets", block([0.0, 0.0, 2.0], [0.0, 0.0, -1.0])),
    ] {
        let case = exact_case(&text);
        let body = Body::new(&case, 1, &Needs::default()).unwrap();
        let loading = loading(&body, &case);
        let integrator = body.integrator();
        let sides = sides(&case, &body).unwrap();
        let mut seen = [0, 0];
        for increment in 1..=3 {
            let factor = increment as f64 / 3.0;
            let u = loading.prescribed_displacement(increment);
            for facets in body.mesh.sides.values() {
                for facet in facets {
                    let nodes: Vec<Point> = body
                        .mesh
                        .facet_nodes(*facet)
                        .map(|n| body.mesh.nodes[n])
                        .collect();
                    for (s, t) in [(0.1, 0.2), (0.5, 0.55), (0.85, 0.3), (0.97, 0.92)] {
                        // A point inside the facet.
                        let opposite = nodes.len() - 1;
                        let x = [0, 1, 2].map(|a| {
                            let along = nodes[0][a] + s * (nodes[1][a] - nodes[0][a]);
                            match opposite {
                                1 => along,
                                _ => along + t * (nodes[opposite][a] - nodes[0][a]),
                            }
                        });
                        let distance = sides.crack().distance(&x);
                        if distance.abs() < 1e-6 {
                            continue;
                        }
                        let side = distance.signum();
                        seen[usize::from(side > 0.0)] += 1;
                        let region = body
                            .enrichment
                            .partition(facet.cell)
                            .map_or(0, |partition| region_at(&body.cracks, partition, &x));
                        let found = integrator.displacement(facet.cell, &x, region, &u).unwrap();
                        let wanted = map(&x, side);
                        for a in 0..body.mesh.dim() {
                            let error = found[a] - factor * wanted[a];
                            assert!(error.abs() < 1e-12, "{name} {x:?} {side}: {error:e}");
                        }
                    }
                }
            }
        }
        assert!(seen[0] > 10 && seen[1] > 10, "{name}: {seen:?}");
    }
}

fn sliding_text(y: f64, friction: f64, rest: &str) -> String {
    let rest = crack([-0.1, y], [1.1, y], friction, "none")
        + "[exact]\nsolution = \"sliding\"\npressure_pa = 2e-2\n"
        + rest;
    plane([0.0, 0.0], [1.0, 1.0], [5, 5], &rest)
}

/// Source: Hooke, Coulomb. Goal: a block at the limit of friction, slipping rigidly, its border held by the closed form:
/// uniform contact traction (p, −μ p), the stated slip, the displacement to rounding. Edge pairs are exact for a horizontal
/// cut. Tolerance 1e-10: the method ends within 1e-12 of equilibrium.
#[test]
fn a_rigid_slip_under_exact_displacements_is_reproduced() {
    for y in [0.47, 0.4 + 1e-6, 0.6] {
        let case = exact_case(&sliding_text(y, 0.35, &all_sides(2, "\"exact\"")));
        let found = solve_case(&case, 1, METHOD, TOLERANCE);
        assert!(found.traction(0).len() >= 4);
        for (p, q) in found.traction(0).iter().zip(found.traction(1)) {
            assert!((p / 2e-2 - 1.0).abs() < 1e-10, "{y}: {p}");
            assert!((q / (-0.35 * 2e-2) - 1.0).abs() < 1e-10, "{y}: {q}");
        }
        for jump in found.jump.chunks(2) {
            assert!(jump[0].abs() < 1e-14 && (jump[1] - 1e-3).abs() < 1e-13);
        }
    }
}

/// Goal: the closed form follows the friction of the run, while K is factored once for all of them.
#[test]
fn exact_values_belong_to_the_friction_of_the_run_and_share_one_factorisation() {
    let rest = all_sides(2, "\"exact\"") + "[sweep]\nfriction = [0.1, 0.4, 0.9]\n";
    let results = run(
        &exact_case(&sliding_text(0.47, 0.3, &rest)),
        &["b-newton", "nsgs"],
    );
    // Pressed and sheared at time 0, without slip.
    assert_eq!(results.increments().len(), 2 * 6);
    for row in results.increments() {
        let factorisations = row.record.spent.as_ref().map(|own| own.factorisations);
        assert_eq!(
            (factorisations, &row.step.verdict),
            (Some(1), &Verdict::Solved)
        );
    }
    for point in results.points() {
        let ratio = -point.point.p_a / point.point.p_n;
        assert!((ratio / point.key.friction - 1.0).abs() < 1e-7, "{point:?}");
        let slip = point.key.increment as f64;
        assert!(
            (point.point.slip_a_m / 1e-3 - slip).abs() < 1e-7,
            "{point:?}"
        );
    }
}

/// Source: manufactured solution. Goal: exact tractions on all sides but the bottom and exact body forces, in the plane and in a
/// solid: the displacement converges with order 2. Wrong signs, normals or sides leave an error that does not fall.
#[test]
fn exact_tractions_and_body_forces_converge_with_order_two() {
    let exact = "[exact]\nsolution = \"smooth\"\n[[load]]\nbody_n_per_m3 = \"exact\"\n";
    let loads = |sides: &[&str]| -> String {
        let one = |side: &&str| load(side, "traction_pa = \"exact\"");
        sides.iter().map(one).collect()
    };
    let flat = crack([-0.1, 0.47], [1.1, 0.47], 5.0, "none")
        + exact
        + &support("\"bottom\"", "\"exact\"")
        + &support("[\"left\", \"top\"]", "\"exact\"")
        + &loads(&["left", "right", "top"]);
    let flat = plane([0.0, 0.0], [1.0, 1.0], [5, 5], &flat);
    let block = exact.to_owned()
        + &support("\"bottom\"", "\"exact\"")
        + &support("[\"left\", \"top\"]", "\"exact\"")
        + &loads(&["left", "right", "front", "back", "top"]);
    let planes = [([0.0, 0.0, 0.47], [0.0, 0.0, 1.0], 5.0)];
    let block = solid([1.0, 1.0, 1.0], [3, 3, 3], &planes, &block);
    for (text, refine) in [(flat, [1, 2, 4]), (block, [1, 2, 3])] {
        let case = exact_case(&text);
        let lame = Lame::new(case.material, case.model);
        let field = Smooth {
            lame,
            last: case.model.dim() - 1,
        };
        let errors = refine.map(|refine| {
            let found = solve_case(&case, refine, METHOD, 1e-10);
            // Root mean square over the nodes; the largest error carries a logarithm of h.
            let dim = found.body.mesh.dim();
            let nodes = found.body.mesh.nodes.iter().zip(found.u.chunks(dim));
            let squares = nodes.map(|(x, u)| {
                let exact = field.displacement(x, 1.0);
                (0..dim).map(|a| (u[a] - exact[a]).powi(2)).sum::<f64>()
            });
            (squares.sum::<f64>() / found.body.mesh.nodes.len() as f64).sqrt()
        });
        println!("{errors:?}");
        for k in 1..3 {
            let order =
                (errors[k - 1] / errors[k]).ln() / (refine[k] as f64 / refine[k - 1] as f64).ln();
            assert!(order > 1.7, "{order} {errors:?}");
        }
        assert!(errors[2] < 0.02 * K, "{errors:?}");
    }
}

/// Goal: body forces of a closed form are integrated side by side: resultant and moment of a polynomial that jumps across an
/// oblique crack. Sources: ∫∫ over [0, 1]², crack y = 0.2 + 0.5 x, side 1 above.
#[test]
fn exact_body_forces_are_integrated_on_each_side() {
    let rest = crack([-0.2, 0.1], [1.2, 0.8], 0.3, "none")
        + "[exact]\nsolution = \"two-maps\"\n[[load]]\nbody_n_per_m3 = \"exact\"\n"
        + &clamped(2);
    let case = exact_case(&plane([0.0, 0.0], [1.0, 1.0], [5, 5], &rest));
    let body = Body::new(&case, 1, &Needs::default()).unwrap();
    let force = loading(&body, &case).external_force(1);
    let nodes = || body.mesh.nodes.iter().enumerate();
    let x: f64 = nodes().map(|(n, _)| force[2 * n]).sum();
    assert!((x - 0.25).abs() < 1e-14, "{x}");
    let x: f64 = nodes().map(|(n, x)| x[0] * force[2 * n]).sum();
    assert!((x - 0.2).abs() < 1e-14, "{x}");
    // ∫ x (∫_c^1 y dy − ∫_0^c y dy) dx = ∫ x (½ − c²) dx with c = 0.2 + 0.5 x
    let exact = 0.25 - (0.04 / 2.0 + 0.2 / 3.0 + 0.25 / 4.0);
    let y: f64 = nodes().map(|(n, _)| force[2 * n + 1]).sum();
    assert!((y - exact).abs() < 1e-14, "{y} {exact}");
}

/// Goal: what the closed form refuses is refused at `[exact]`, naming the increment; nothing is computed.
#[test]
fn a_closed_form_that_does_not_hold_is_refused_at_its_table() {
    let all = all_sides(2, "\"exact\"");
    let sloping = sliding_text(0.47, 0.3, &all).replace("[1.1, 0.47]", "[1.1, 0.5]");
    let back = sliding_text(0.47, 0.3, &all).replace(
        "pressure_pa = 2e-2\n",
        "pressure_pa = 2e-2\nhistory = [[1, 1], [2, 0.5]]\n[path]\nincrements = 3\nend = 3\n",
    );
    for (text, words) in [
        (
            sloping,
            "the crack must be horizontal: got sliding with friction 0.3",
        ),
        (back, "increment 2: slip must not turn back"),
    ] {
        let case = exact_case(&text);
        let body = Body::new(&case, 1, &Needs::default()).unwrap();
        let Err(BodyError::Case(error)) = Loading::new(&body, &case, 0.3) else {
            panic!("accepted:\n{text}")
        };
        let line = text[..text.find("[exact]").unwrap()].matches('\n').count() + 1;
        assert_eq!((error.line(), error.column()), (line, 1), "{error}");
        assert!(error.to_string().contains(words), "{error}");
        assert_eq!(error.key(), "exact", "{error}");
    }
}

/// Goal: a name that no closed form has is refused by `check` and `run`, exit code 2.
#[test]
fn an_unknown_closed_form_is_refused_by_the_program() {
    let dir = tempfile::tempdir().unwrap();
    let text = sliding_text(0.47, 0.3, &clamped(2)).replace("\"sliding\"", "\"sliding-by-name\"");
    std::fs::write(dir.path().join("bad.toml"), text).unwrap();
    for verb in ["check", "run"] {
        let (_, complaints) = ends_with(2, &[verb, "bad.toml"], dir.path());
        assert!(
            complaints.contains("exact.solution: unknown"),
            "{complaints}"
        );
    }
}

/// Goal: a component can be stated as a number beside exact ones; the number follows the history of the support.
#[test]
fn stated_and_exact_components_stand_side_by_side() {
    let rest = "[[support]]\non = \"top\"\ndisplacement_m = [\"exact\", -7e-3]\nhistory = \"constant\"\n\
                [[support]]\non = \"bottom\"\ndisplacement_m = \"exact\"\n[path]\nincrements = 2\n";
    let case = exact_case(&sliding_text(0.47, 0.3, rest));
    assert_eq!(
        case.supports[0].displacement,
        [Some(Amount::Exact), Some(Amount::Number((-7e-3).into()))]
    );
    let body = Body::new(&case, 1, &Needs::default()).unwrap();
    let loading = loading(&body, &case);
    let u = loading.prescribed_displacement(1);
    let field = loading.exact(1).unwrap();
    for node in body.mesh.side_nodes("top") {
        let x = &body.mesh.nodes[node];
        assert_eq!(u[2 * node], field.displacement(x, 1.0)[0]);
        assert_eq!(u[2 * node + 1], -7e-3);
    }
    let Load { force, offset, .. } = loading.at(1);
    assert_eq!(
        (force.len(), offset.len()),
        (body.elastic.unknowns(), 2 * body.points.len())
    );
}
