//! Loads of every kind on bodies with cracks: supports carry their resultant and their moment.

use crate::common::*;
use stickslip::case::Case;
use stickslip::model::body::{Body, Needs};
use stickslip_xfem::enrichment::basis::FunctionKind;

/// Forces of supports and loads over all unknowns: K u − Bᵀ P, and the loads alone.
fn forces(found: &Solved) -> (Vec<f64>, Vec<f64>) {
    let mut force = found.body.stiffness.mul(&found.u);
    for (f, b) in force.iter_mut().zip(contact_force(&found.body, found.p())) {
        *f -= b;
    }
    (force, found.external.clone())
}

/// Work of nodal forces on a displacement field without jump.
fn work(found: &Solved, force: &[f64], field: impl Fn(&[f64; 3]) -> [f64; 3]) -> f64 {
    work_of(&found.body, force, field)
}

/// Source: statics. Goal: traction, pressure and body force on a plate whose crack with a tip leaves through the loaded
/// side: the loads have the resultant and moment of the stated densities, and with the reactions they balance.
///
/// ```text
///   ↓↓↓↓↓↓  traction (2, −3)e-4 where x >= 0.5        body force (1, −2)e-4 everywhere
///        |←
///    ————|← pressure 5e-4, the crack leaves here
///   //////
/// ```
/// Tolerance: rounding; the rule on facets with branch functions integrates the standard ones exactly.
#[test]
fn loads_on_a_cracked_plate_have_their_resultants_and_balance_the_reactions() {
    for tip in ["branch", "none"] {
        let rest = crack([0.31, 0.43], [1.2, 0.57], 0.3, tip)
            + &support("\"bottom\"", "[0, 0]")
            + "[[load]]\non = \"top\"\nwhere = \"x >= 0.5\"\ntraction_pa = [2e-4, -3e-4]\n"
            + &load("right", "pressure_pa = 5e-4")
            + "[[load]]\nbody_n_per_m3 = [1e-4, -2e-4]\n";
        let found = solve(&plane([0.0, 0.0], [1.0, 1.0], [6, 6], &rest));
        let (force, external) = forces(&found);
        let x = work(&found, &external, |_| [1.0, 0.0, 0.0]);
        let y = work(&found, &external, |_| [0.0, 1.0, 0.0]);
        let turn = work(&found, &external, |x| [-x[1], x[0], 0.0]);
        assert!((x - (0.5 * 2e-4 - 5e-4 + 1e-4)).abs() < 1e-15, "{x:e}");
        assert!((y - (-0.5 * 3e-4 - 2e-4)).abs() < 1e-15, "{y:e}");
        // M = Σ x f_y − y f_x
        let exact = (-3e-4 * 0.375 - 2e-4 * 0.5) + 5e-4 * 0.5 + (-2e-4 * 0.5 - 1e-4 * 0.5);
        assert!((turn - exact).abs() < 1e-15, "{turn:e} {exact:e}");
        for field in [
            |_: &[f64; 3]| [1.0, 0.0, 0.0],
            |_: &[f64; 3]| [0.0, 1.0, 0.0],
            |x: &[f64; 3]| [-x[1], x[0], 0.0],
        ] {
            // K u − Bᵀ P = loads + reactions does no work on a rigid motion.
            let sum = work(&found, &force, field);
            assert!(sum.abs() < 1e-15, "{sum:e}");
        }
    }
}

/// The same in 3D with an oblique plane that leaves through loaded sides and the loaded edge.
#[test]
fn loads_on_a_cut_block_have_their_resultants_and_balance_the_reactions() {
    let planes = [([0.5, 0.5, 0.55], [0.6, 0.2, 1.0], 0.3)];
    let rest = support("\"bottom\"", "[0, 0, 0]")
        + &support("\"top\"", "[0, 0, -1e-4]")
        + &load("right", "pressure_pa = 5e-4")
        + &load("front", "traction_pa = [1e-4, 2e-4, 3e-4]")
        + "[[load]]\non = [\"right\", \"back\"]\nline_n_per_m = [1e-4, -2e-4, -3e-4]\n"
        + "[[load]]\nbody_n_per_m3 = [1e-4, 0, -2e-4]\n";
    let found = solve(&solid([1.0, 1.0, 1.0], [3, 3, 3], &planes, &rest));
    let (force, external) = forces(&found);
    let exact = [-5e-4 + 1e-4 + 1e-4 + 1e-4, 2e-4 - 2e-4, 3e-4 - 3e-4 - 2e-4];
    for a in 0..3 {
        let unit = |_: &[f64; 3]| [0, 1, 2].map(|b| f64::from(u8::from(a == b)));
        let sum = work(&found, &external, unit);
        assert!((sum - exact[a]).abs() < 1e-15, "{a}: {sum:e}");
        let turn = |x: &[f64; 3]| {
            let mut r = [0.0; 3];
            (r[a], r[(a + 1) % 3]) = (-x[(a + 1) % 3], x[a]);
            r
        };
        for sum in [work(&found, &force, unit), work(&found, &force, turn)] {
            assert!(sum.abs() < 1e-15, "{a}: {sum:e}");
        }
    }
    // About z: pressure −x at y = 0.5, traction at (0.5, 0), line at (1, 1), body at (0.5, 0.5).
    let moment = work(&found, &external, |x| [-x[1], x[0], 0.0]);
    let exact = 5e-4 * 0.5 + 2e-4 * 0.5 + (-2e-4 - 1e-4) - 1e-4 * 0.5;
    assert!((moment - exact).abs() < 1e-15, "{moment:e} {exact:e}");
}

/// Source: statics. Goal: a pressure and tractions that vary linearly along cut sides have their resultant and moment, in
/// the plane and in a solid. Tolerance: rounding; the rules integrate shape functions times linear densities exactly.
#[test]
fn linear_tractions_and_pressures_have_their_resultants() {
    let rest = crack([-0.1, 0.31], [1.1, 0.57], 0.3, "none")
        + &clamped(2)
        + &load(
            "right",
            "pressure_pa = { at_origin_pa = 5, gradient_pa_per_m = [1, -4] }",
        )
        + &load(
            "top",
            "traction_pa = [{ at_origin_pa = 1, gradient_pa_per_m = [2, 3] }, -7]",
        );
    let (case, body) = bodies(&plane([0.0, 0.0], [1.0, 1.0], [6, 6], &rest));
    let force = loading(&body, &case).external_force(1);
    // Right: p = 6 − 4 y. Top: t_x = 4 + 2 x.
    for (field, exact) in [
        ((|_| [1.0, 0.0, 0.0]) as fn(&[f64; 3]) -> _, -4.0 + 5.0),
        (|_| [0.0, 1.0, 0.0], -7.0),
        (|x| [x[1], 0.0, 0.0], -(3.0 - 4.0 / 3.0) + 5.0),
        (|x| [x[0], 0.0, 0.0], -4.0 + 2.0 + 2.0 / 3.0),
    ] {
        let found = work_of(&body, &force, field);
        assert!((found - exact).abs() < 1e-14, "{found} {exact}");
    }
    let planes = [([0.5, 0.5, 0.55], [0.6, 0.2, 1.0], 0.3)];
    let rest = clamped(3)
        + &load(
            "top",
            "pressure_pa = { at_origin_pa = 1, gradient_pa_per_m = [2, 0, 3] }",
        )
        + &load(
            "left",
            "traction_pa = [0, { at_origin_pa = 0, gradient_pa_per_m = [5, 6, 7] }, 0]",
        );
    let (case, body) = bodies(&solid([1.0, 1.0, 1.0], [3, 3, 3], &planes, &rest));
    let force = loading(&body, &case).external_force(1);
    // Top: p = 4 + 2 x. Left: t_y = 6 y + 7 z.
    for (field, exact) in [
        ((|_| [0.0, 0.0, 1.0]) as fn(&[f64; 3]) -> _, -5.0),
        (|x| [0.0, 0.0, x[0]], -(2.0 + 2.0 / 3.0)),
        (|_| [0.0, 1.0, 0.0], 6.5),
        (|x| [0.0, x[2], 0.0], 1.5 + 7.0 / 3.0),
    ] {
        let found = work_of(&body, &force, field);
        assert!((found - exact).abs() < 1e-13, "{found} {exact}");
    }
}

/// Goal: a body force on one side of a crack through the body weighs that side, wherever the crack cuts; both sides
/// together give the force on the whole body.
#[test]
fn one_sided_body_forces_act_on_their_side_only() {
    let whole = "[[load]]\nbody_n_per_m3 = [3, -2]\n";
    // Area above y = c + m x over the unit square: 1 − c − m/2; first moment in x: 1/2 − c/2 − m/3.
    for (c, m) in [(0.37, 0.0), (0.2, 0.5), (0.0, 1.0), (0.5, 0.0), (0.8, -0.6)] {
        let ends = ([-0.2, c - 0.2 * m], [1.2, c + 1.2 * m]);
        let mesh = |rest: &str| {
            let text = plane([0.0, 0.0], [1.0, 1.0], [6, 6], rest);
            match c {
                0.2 => moved(&text),
                0.5 => in_space(&text, "node-pairs"),
                _ => text,
            }
        };
        for (p, q, upper) in [(ends.0, ends.1, 1), (ends.1, ends.0, 2)] {
            let forces = [1, 2].map(|side| {
                let one = format!("{whole}crack_side = {side}\n");
                let rest = crack(p, q, 0.3, "none") + &clamped(2) + &one;
                let (case, body) = bodies(&mesh(&rest));
                let force = loading(&body, &case).external_force(1);
                let area = work_of(&body, &force, |_| [1.0 / 3.0, 0.0, 0.0]);
                let moment = work_of(&body, &force, |x| [0.0, -0.5 * x[0], 0.0]);
                (area, moment, force)
            });
            let exact = (1.0 - c - m / 2.0, 0.5 - c / 2.0 - m / 3.0);
            let (area, moment, _) = &forces[upper - 1];
            assert!((area - exact.0).abs() < 1e-13, "{c} {m}: {area}");
            assert!((moment - exact.1).abs() < 1e-13, "{c} {m}: {moment}");
            let rest = crack(p, q, 0.3, "none") + &clamped(2) + whole;
            let (case, body) = bodies(&mesh(&rest));
            let both = loading(&body, &case).external_force(1);
            for (i, f) in both.iter().enumerate() {
                assert!((f - forces[0].2[i] - forces[1].2[i]).abs() < 1e-14);
            }
        }
    }
}

/// Source: f(v) = −∫ σ₀ : ε(v). Goal: the nodal forces of an initial stress do the work −σ₀ : A_s |Ω_s| on a displacement
/// that is affine on each side of the crack, in the plane and in a solid; on a field without jump also around a tip.
#[test]
fn an_initial_stress_does_work_on_the_strain_of_each_side() {
    let maps = [
        [[0.3, -0.2, 0.5], [0.7, 0.1, -0.4], [-0.6, 0.2, 0.9]],
        [[-0.1, 0.4, 0.2], [0.05, -0.8, 0.3], [0.15, -0.35, 0.45]],
    ];
    let stress = [[2.0, 7.0, 5.0], [7.0, 3.0, -4.0], [5.0, -4.0, -6.0]];
    let affine = |a: &[[f64; 3]; 3], x: &[f64; 3]| {
        [0, 1, 2].map(|i| 0.3 + (0..3).map(|j| a[i][j] * x[j]).sum::<f64>())
    };
    let density = |a: &[[f64; 3]; 3], dim: usize| -> f64 {
        let pairs = (0..dim).flat_map(|i| (0..dim).map(move |j| (i, j)));
        pairs.map(|(i, j)| stress[i][j] * a[i][j]).sum()
    };
    let flat = "[[load]]\ninitial_stress_pa = [2, 3, 7]\n";
    let deep = "[[load]]\ninitial_stress_pa = [2, 3, -6, -4, 5, 7]\n";
    let through = |c: f64, m: f64| {
        let rest = crack([-0.2, c - 0.2 * m], [1.2, c + 1.2 * m], 0.3, "none") + &clamped(2) + flat;
        (
            plane([0.0, 0.0], [1.0, 1.0], [5, 5], &rest),
            1.0 - c - m / 2.0,
        )
    };
    let block = |height: f64, slope: f64| {
        let planes = [([0.5, 0.5, height], [-slope, 0.0, 1.0], 0.3)];
        let rest = clamped(3) + deep;
        (
            solid([1.0, 1.0, 1.0], [3, 3, 3], &planes, &rest),
            1.0 - height,
        )
    };
    let on_facets = |(text, upper): (String, f64)| (in_space(&text, "node-pairs"), upper);
    for (text, upper) in [
        through(0.37, 0.0),
        through(0.2, 0.5),
        (moved(&through(0.2, 0.5).0), through(0.2, 0.5).1),
        through(0.0, 1.0),
        on_facets(through(0.4, 0.0)),
        block(0.45, 0.3),
        on_facets(block(2.0 / 3.0, 0.0)),
    ] {
        let (case, body) = bodies(&text);
        let dim = body.mesh.dim();
        let force = loading(&body, &case).external_force(1);
        let sides = sides(&case, &body).unwrap();
        let mut found = 0.0;
        for (f, function) in body.enrichment.functions.iter().enumerate() {
            let (node, x) = (
                function.node as usize,
                &body.mesh.nodes[function.node as usize],
            );
            let side = sides.of_node(node);
            let of = |side: f64| affine(&maps[usize::from(side < 0.0)], x);
            let value = match function.kind {
                FunctionKind::Standard => of(side),
                _ => [0, 1, 2].map(|a| 0.5 * (of(-side)[a] - of(side)[a])),
            };
            found += (0..dim).map(|a| force[f * dim + a] * value[a]).sum::<f64>();
        }
        let exact = -density(&maps[0], dim) * upper - density(&maps[1], dim) * (1.0 - upper);
        assert!((found - exact).abs() < 1e-12, "{found} {exact}\n{text}");
    }
    let rest = crack([0.31, 0.43], [1.2, 0.57], 0.3, "branch") + &clamped(2) + flat;
    let (case, body) = bodies(&plane([0.0, 0.0], [1.0, 1.0], [6, 6], &rest));
    let force = loading(&body, &case).external_force(1);
    let found = work_of(&body, &force, |x| affine(&maps[0], x));
    assert!((found + density(&maps[0], 2)).abs() < 1e-12, "{found}");
}

/// Source: statics. Goal: in a body held on its whole border an initial stress strains nothing and the crack carries the
/// traction −σ₀ n, by multipliers and by the stress-based forces of Nitsche's method, in step with its history.
/// Tolerance 1e-10: the methods end within 1e-12 of equilibrium.
#[test]
fn a_held_body_carries_its_initial_stress_across_the_crack() {
    for y in [0.47, 0.6] {
        for name in [METHOD, "nitsche"] {
            let rest = crack([-0.1, y], [1.1, y], 0.9, "none")
                + &clamped(2)
                + "[[load]]\ninitial_stress_pa = [-1e-3, -4e-3, 1e-3]\nhistory = [[1, 0.5], [2, 1.5]]\n\
                   [path]\nincrements = 2\nend = 2\n";
            let results = run(
                &parse(&plane([0.0, 0.0], [1.0, 1.0], [5, 5], &rest)),
                &[name],
            );
            // It acts at time 0, too.
            assert_eq!(
                results.increments().len(),
                3,
                "{name} {:?}",
                results.increments()
            );
            assert!(!results.points().is_empty());
            for point in results.points() {
                let factor = [0.5, 0.5, 1.5][point.key.increment];
                let (p, q) = (
                    point.point.p_n / point.point.weight,
                    point.point.p_a / point.point.weight,
                );
                assert!((p - factor * 4e-3).abs() < 1e-10, "{name} {y}: {p}");
                assert!((q + factor * 1e-3).abs() < 1e-10, "{name} {y}: {q}");
                assert!(point.point.gap_m.abs() < 1e-12 && point.point.slip_a_m.abs() < 1e-12);
            }
        }
    }
}

/// A case and its body.
fn bodies(text: &str) -> (Case, Body) {
    let case = parse(text);
    let body = Body::new(&case, 1, &Needs::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    (case, body)
}

/// Work of nodal forces on a displacement field without jump.
fn work_of(body: &Body, force: &[f64], field: impl Fn(&[f64; 3]) -> [f64; 3]) -> f64 {
    let dim = body.mesh.dim();
    let nodes = body.mesh.nodes.iter().enumerate();
    nodes
        .map(|(n, x)| {
            (0..dim)
                .map(|a| force[n * dim + a] * field(x)[a])
                .sum::<f64>()
        })
        .sum()
}
