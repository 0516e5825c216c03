//! The patch test with a closed crack: uniform stress passes it, wherever it cuts the cells; and where edge pairs fail.

use crate::common::*;

/// Distances of the crack from a row of nodes, in cells: both signs, down to the limit where it snaps to the row.
const OFFSETS: [f64; 13] = [
    0.3, 0.01, 1e-4, 1e-6, 1e-8, 1e-9, 1.1e-10, 0.9e-10, 1e-12, 0.0, -1e-9, -1e-6, -0.3,
];

/// Plane strain: E' = E/(1 − ν²), ν/(1 − ν) for E = 1, ν = 0.3.
const STIFF: f64 = 1.0 / 0.91;
const RATIO: f64 = 0.3 / 0.7;

/// A plate 1 × 2 m in 5 × 10 cells, rolling at the bottom, pushed down by 1e-3 m at the top:
/// σ_yy = −E' v/H, u_x = ν/(1 − ν) (v/H) x, u_y = −(v/H) y.
fn pushed(crack: &str) -> String {
    let rest = crack.to_owned()
        + &support("\"bottom\"", "[\"free\", 0]")
        + &support("[\"left\", \"bottom\"]", "[0, 0]")
        + &support("\"top\"", "[\"free\", -1e-3]");
    plane([0.0, 0.0], [1.0, 2.0], [5, 10], &rest)
}

/// Source: elasticity, uniform stress. Goal: a horizontal crack that sticks is not felt, at any distance from the nodes.
///
/// ```text
///   ↓ ↓ ↓ ↓ ↓   v = 1 mm          P_n = σ × tributary length at every pair, P_a = 0, no jump
///   |_______|   crack at (4 + offset) h
///   |       |
///   o o o o o
/// ```
/// Tolerance 1e-10 of the pressure: rounding, times 1e2 for slivers; numbers of the run are 1e-14 to 1e-12.
#[test]
fn a_horizontal_crack_that_sticks_passes_the_patch_test_at_every_distance_from_the_nodes() {
    let pressure = STIFF * 1e-3 / 2.0;
    for offset in OFFSETS {
        let y = (4.0 + offset) * 0.2;
        let found = solve(&pushed(&crack([-0.1, y], [1.1, y], 10.0, "none")));
        assert_eq!(found.body.points.len(), 6);
        for (n, t) in found.traction(0).iter().zip(found.traction(1)) {
            assert!(
                (n - pressure).abs() < 1e-10 * pressure,
                "{offset:e}: {n:e} {pressure:e}"
            );
            assert!(t.abs() < 1e-10 * pressure, "{offset:e}: {t:e}");
        }
        let error = found.displacement_error(|x| [RATIO * 5e-4 * x[0], -5e-4 * x[1], 0.0]);
        assert!(error < 1e-10 * 1e-3, "{offset:e}: {error:e}");
        assert!(
            found.jump.iter().all(|j| j.abs() < 1e-10 * 1e-3),
            "{offset:e}"
        );
        let top = found.reaction("top", 1);
        assert!(
            (top + pressure).abs() < 1e-10 * pressure,
            "{offset:e}: {top:e}"
        );
    }
}

/// Source: elasticity, uniform stress with shear below the Coulomb limit, ν = 0.
///
/// The top is pushed down by v and to the side by w, tractions (0, ±τ) act on the lateral sides, also on the facets the
/// crack cuts: u = (w y/H, −v y/H), P_n/length = E v/H, P_a/length = −τ = −G w/H on side 1 (upper part pushed to +x is
/// held back towards −x).
/// Tolerance as above.
#[test]
fn a_crack_that_sticks_under_shear_passes_the_patch_test() {
    for offset in OFFSETS {
        let y = (4.0 + offset) * 0.2;
        let shear = 0.5 * 2e-4 / 2.0;
        let rest = crack([-0.1, y], [1.1, y], 0.5, "none")
            + &support("\"bottom\"", "[0, 0]")
            + &support("\"top\"", "[2e-4, -1e-3]")
            + &load("right", &format!("traction_pa = [0, {shear:e}]"))
            + &load("left", &format!("traction_pa = [0, -{shear:e}]"));
        let text = plane([0.0, 0.0], [1.0, 2.0], [5, 10], &rest);
        let found = solve(&text.replace("poisson = 0.3", "poisson = 0"));
        let pressure = 1e-3 / 2.0;
        for (n, t) in found.traction(0).iter().zip(found.traction(1)) {
            assert!((n - pressure).abs() < 1e-10 * pressure, "{offset:e}: {n:e}");
            assert!(
                (t + shear).abs() < 1e-10 * pressure,
                "{offset:e}: {t:e} {shear:e}"
            );
        }
        let error = found.displacement_error(|x| [1e-4 * x[1], -5e-4 * x[1], 0.0]);
        assert!(error < 1e-10 * 1e-3, "{offset:e}: {error:e}");
    }
}

/// Source: paired point forces on cells cut through adjacent sides, whose fourth node carries no pair.
///
/// The documented limitation of edge pairs: uniform stress across an oblique crack that sticks is not reproduced; the
/// reaction by percents, pair forces far more. A contact space that passes must replace this test by its opposite.
/// Bottom and top held sideways, ν = 0: the exact stress is E v/H.
#[test]
fn off_grid_edge_pairs_fail_the_patch_test() {
    for angle in [27.0f64, 45.0] {
        let slope = angle.to_radians().tan();
        let y = |x: f64| 0.49 + slope * x;
        let rest = crack([-0.1, y(-0.1)], [1.1, y(1.1)], 10.0, "none")
            + &support("\"bottom\"", "[0, 0]")
            + &support("\"top\"", "[0, -1e-3]");
        let text = plane([0.0, 0.0], [1.0, 2.0], [5, 10], &rest);
        let found = solve(&text.replace("poisson = 0.3", "poisson = 0"));
        let pressure = 5e-4 * angle.to_radians().cos().powi(2);
        let worst = found
            .traction(0)
            .iter()
            .fold(0.0f64, |m, n| m.max((n / pressure - 1.0).abs()));
        let top = found.reaction("top", 1) / -5e-4 - 1.0;
        println!("{angle} degrees: pair forces off by {worst:.3}, reaction by {top:.3}");
        assert!(worst > 1e-3, "{angle}: {worst:e}");
        assert!(top.abs() > 1e-3 && top.abs() < 0.1, "{angle}: {top:e}");
    }
}

/// Source: elasticity, uniform stress. Goal: horizontal planes that stick are not felt in 3D: P_n = σ × area.
/// A block 1 × 1 × 2 m in 2 × 3 × 5 cells pushed down by 1e-3 m on rollers; E = 1: σ = v/H.
/// Tolerance as in 2D.
#[test]
fn a_horizontal_plane_that_sticks_passes_the_patch_test_at_every_distance_from_the_nodes() {
    for offset in OFFSETS {
        let planes = [([0.0, 0.0, (2.0 + offset) * 0.4], [0.0, 0.0, 1.0], 10.0)];
        let rest = support("\"bottom\"", "[\"free\", \"free\", 0]")
            + &support("\"top\"", "[\"free\", \"free\", -1e-3]")
            + &support("[\"left\", \"front\", \"bottom\"]", "[0, 0, 0]")
            + &support("[\"right\", \"front\", \"bottom\"]", "[\"free\", 0, 0]");
        let found = solve(&solid([1.0, 1.0, 2.0], [2, 3, 5], &planes, &rest));
        assert_eq!(found.body.points.len(), 12);
        for component in 0..3 {
            let exact = if component == 0 { 5e-4 } else { 0.0 };
            for t in found.traction(component) {
                assert!((t - exact).abs() < 1e-10 * 5e-4, "{offset:e}: {t:e}");
            }
        }
        let error =
            found.displacement_error(|x| [0.3 * 5e-4 * x[0], 0.3 * 5e-4 * x[1], -5e-4 * x[2]]);
        assert!(error < 1e-10 * 1e-3, "{offset:e}: {error:e}");
    }
}

/// Source: σ = −p I, a crack without friction carries p on every direction.
/// Goal: hydrostatic pressure passes through a frictionless crack: u = −p (1 + ν)(1 − 2ν)/E x in plane strain,
/// u = −p (1 − 2ν)/E x in a solid. Rollers on three sides (2D: two), pressure on the others, facets the crack cuts
/// among them.
/// Tolerance as above.
#[test]
fn hydrostatic_pressure_passes_through_a_frictionless_crack() {
    for offset in OFFSETS {
        let y = (2.0 + offset) * 0.25;
        let rest = crack([-0.1, y], [1.1, y], 0.0, "none")
            + &support("\"left\"", "[0, \"free\"]")
            + &support("\"bottom\"", "[\"free\", 0]")
            + &load("right", "pressure_pa = 1e-3")
            + &load("top", "pressure_pa = 1e-3");
        let flat = solve(&plane([0.0, 0.0], [1.0, 1.0], [3, 4], &rest));
        let planes = [([0.0, 0.0, y], [0.0, 0.0, 1.0], 0.0)];
        let rest = support("\"left\"", "[0, \"free\", \"free\"]")
            + &support("\"front\"", "[\"free\", 0, \"free\"]")
            + &support("\"bottom\"", "[\"free\", \"free\", 0]")
            + &load("right", "pressure_pa = 1e-3")
            + &load("back", "pressure_pa = 1e-3")
            + &load("top", "pressure_pa = 1e-3");
        let block = solve(&solid([1.0, 1.0, 1.0], [2, 2, 4], &planes, &rest));
        for (found, strain) in [(&flat, 1.3 * 0.4e-3), (&block, 0.4e-3)] {
            for t in found.traction(0) {
                assert!((t - 1e-3).abs() < 1e-10 * 1e-3, "{offset:e}: {t:e}");
            }
            let dim = found.body.mesh.dim();
            let tangential = found.p().iter().enumerate().filter(|(i, _)| i % dim != 0);
            assert!(tangential.into_iter().all(|(_, p)| *p == 0.0));
            let error = found.displacement_error(|x| x.map(|v| -strain * v));
            assert!(error < 1e-10 * 1e-3, "{offset:e}: {error:e}");
        }
    }
}

/// Source: continuity of the exact solution in the place of the crack. Goal: a crack through the nodes (doubled nodes)
/// and cracks ever closer to them (cut cells) give one reaction, from both sides; friction μ = 0.1 and an uneven load
/// make part of the crack slip.
/// Tolerance: the crack moves by `offset` cells, so the reaction by about that much; 1e-9 is left for rounding.
#[test]
fn the_reaction_is_continuous_as_a_horizontal_crack_passes_through_the_nodes() {
    let reaction = |offset: f64| {
        let y = (4.0 + offset) * 0.2;
        let rest = crack([-0.1, y], [1.1, y], 0.1, "none")
            + &support("\"bottom\"", "[0, 0]")
            + &support("\"top\"", "[1e-4, -1e-3]")
            + &load("right", "traction_pa = [0, -1e-4]");
        let text = plane([0.0, 0.0], [1.0, 2.0], [5, 10], &rest);
        let found = solve_with(&text, "augmented-lagrangian", 1e-12);
        [found.reaction("top", 0), found.reaction("top", 1)]
    };
    let exact = reaction(0.0);
    for offset in [
        1e-4, 1e-6, 1e-8, 1e-9, 1e-12, -1e-12, -1e-9, -1e-8, -1e-6, -1e-4f64,
    ] {
        let change = relative_difference(&reaction(offset), &exact);
        assert!(change < 1e-9 + 3.0 * offset.abs(), "{offset:e}: {change:e}");
    }
}

/// Source: an enriched function with a sliver of support is small in both K and its diagonal.
/// Goal: scaled by its diagonal, K is as well conditioned for a cut at 1e-9 h as for one at 0.3 h.
/// Tolerance: a factor of 3 between the smallest eigenvalues.
#[test]
fn slivers_do_not_spoil_the_scaled_stiffness() {
    let least = |offset: f64| {
        let y = (4.0 + offset) * 0.2;
        let body = body(&pushed(&crack([-0.1, y], [1.1, y], 10.0, "none")));
        let k = body.elastic.stiffness().unwrap();
        let n = k.size();
        let mut dense = nalgebra::DMatrix::zeros(n, n);
        for j in 0..n {
            for e in k.col_ptr()[j]..k.col_ptr()[j + 1] {
                let i = k.row_idx()[e];
                let value = k.values()[e] / (k.diagonal(i) * k.diagonal(j)).sqrt();
                dense[(i, j)] = value;
                dense[(j, i)] = value;
            }
        }
        let mut values: Vec<f64> = nalgebra::SymmetricEigen::new(dense)
            .eigenvalues
            .iter()
            .copied()
            .collect();
        values.sort_by(f64::total_cmp);
        // The upper part slides along the crack and turns: motions only contact can stop.
        let floating = body.elastic.floating().len();
        assert!(values[..floating].iter().all(|v| v.abs() < 1e-12));
        values[floating]
    };
    let usual = least(0.3);
    for offset in [1e-2, 1e-4, 1e-6, 1e-9] {
        let found = least(offset);
        assert!(found > usual / 3.0, "{offset:e}: {found:e} {usual:e}");
    }
}
