//! Loads of every kind on bodies with cracks: supports carry their resultant and their moment.

mod common;

use common::*;

/// Forces of supports and loads over all unknowns: K u − Bᵀ P, and the loads alone.
fn forces(found: &Solved) -> (Vec<f64>, Vec<f64>) {
    let mut force = found.body.stiffness.mul(&found.u);
    for (f, b) in force.iter_mut().zip(contact_force(&found.body, found.p())) {
        *f -= b;
    }
    (force, found.body.external_force(1.0))
}

/// Work of nodal forces on a displacement field without jump.
fn work(found: &Solved, force: &[f64], field: impl Fn(&[f64; 3]) -> [f64; 3]) -> f64 {
    let dim = found.body.mesh.dim();
    let nodes = found.body.mesh.nodes.iter().enumerate();
    nodes
        .map(|(n, x)| {
            (0..dim)
                .map(|a| force[n * dim + a] * field(x)[a])
                .sum::<f64>()
        })
        .sum()
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
