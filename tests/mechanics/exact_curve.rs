//! The closed form along a crack, as figures draw it, and the mean slip of a crack, against formulas.

use crate::common::{assert_near, run};
use stickslip::case::Case;
use stickslip::case::shipped;
use stickslip::studies::results::Results;
use stickslip::studies::rows::ExactPoint;

fn case(name: &str) -> Case {
    shipped::find(name).unwrap().unwrap()
}

/// Source: head of the case; F. A. McClintock and J. B. Walsh (1962).
/// Goal: pressure S cos²θ, friction μ p against the slip and the ellipse (4/E') A √(a² − s²), from tip to tip, once for all
/// meshes and methods; to 1e-9 relative, which is more than figures show and below the ten digits of the file.
#[test]
fn a_crack_that_slips_all_over_has_an_ellipse_of_slip() {
    let mut case = case("inclined_crack");
    case.sweep.refine = vec![1, 2];
    let rows = run(&case, &["b-newton", "nsgs"]).exact;
    let (half, angle) = (0.45, 27f64.to_radians());
    let pressure = 1e7 * angle.cos().powi(2);
    let excess = 1e7 * angle.sin() * angle.cos() - 0.1 * pressure;
    let modulus = 1e10 / (1.0 - 0.3f64.powi(2));
    let largest = 4.0 / modulus * excess * half;
    assert_eq!(rows.len(), 161);
    for ExactPoint { key, point: row } in &rows {
        let s = row.s_m - half;
        // Side 1 lies above and slides down, against the tangent.
        let slip = -4.0 / modulus * excess * (half * half - s * s).max(0.0).sqrt();
        assert_near(row.slip_a_m, slip, 1e-9 * largest, row);
        assert_near(row.p_n, pressure, 1e-9 * pressure, row);
        assert_near(row.p_a, 0.1 * pressure, 1e-9 * pressure, row);
        assert_eq!(
            (row.gap_m, row.crack, key.increment, key.friction),
            (0.0, 1, 1, 0.1)
        );
        let [x, y] = [-0.3699529358847655, -0.25129572488279606];
        let at = [x + row.s_m * angle.cos(), y + row.s_m * angle.sin()];
        assert!((row.x_m - at[0]).abs() < 1e-9 && (row.y_m - at[1]).abs() < 1e-9);
    }
    let ends = [rows[0].point.s_m, rows[160].point.s_m - 2.0 * half];
    assert!(ends.iter().all(|s| s.abs() < 1e-11), "tips: {ends:?}");
    let increasing = |pair: &[ExactPoint]| pair[0].point.s_m < pair[1].point.s_m;
    assert!(rows.windows(2).all(increasing));
}

/// Goal: a curve per increment; nothing of a crack outside its body, of a solid, or of a case without a closed form.
#[test]
fn curves_follow_the_path_and_end_with_the_body() {
    let exact = |name: &str| run(&case(name), &["b-newton"]).exact;
    let cycle = exact("partial_slip_cycle");
    let of = |increment| {
        cycle
            .iter()
            .filter(move |row| row.key.increment == increment)
    };
    assert!((1..=5).all(|increment| of(increment).count() == 161));
    // Loaded, unloaded in part, and to the other side: the slip reversed.
    let slip = |increment| {
        of(increment)
            .map(|row| row.point.slip_a_m)
            .fold(0.0, |m: f64, s| if s.abs() > m.abs() { s } else { m })
    };
    assert!((slip(1) + slip(3)).abs() < 1e-9 * slip(1).abs() && slip(1) != 0.0);
    let through = exact("manufactured_slip");
    assert!((101..161).contains(&through.len()), "of a box from -1 to 1");
    for ExactPoint { point, .. } in through {
        assert!(point.x_m.abs().max(point.y_m.abs()) <= 1.0 + 1e-9);
    }
    assert!(exact("manufactured_slip_3d").is_empty());
    assert!(exact("tension_open").is_empty());
}

/// Source: head of the case: s from v = (s1 − nb q) H/E' + s sin θ with s1 = s_f while it slides down.
/// Goal: the mean slip is the rigid slip, against the tangent, which points up the slope; to 1e-10 relative, as all of the
/// closed form of this case.
#[test]
fn the_mean_slip_of_a_sliding_block_is_its_slip() {
    let results: Results = run(&case("sliding_block_cycle"), &["b-newton"]);
    let (angle, friction) = (25f64.to_radians(), 0.2f64);
    let (modulus, lateral) = (1.0 / (1.0 - 0.09), 0.3 / 0.7 * 0.01);
    let sliding = 0.01 * angle.tan() / (angle - friction.atan()).tan();
    for increment in [3, 6, 16] {
        let v = 0.01 * f64::min(increment as f64, 6.0);
        let slip = (v - (sliding - lateral) / modulus) / angle.sin();
        let found: Vec<f64> = results
            .quantities()
            .iter()
            .filter(|row| row.quantity.name == "mean_slip" && row.key.increment == increment)
            .map(|row| row.quantity.value)
            .collect();
        assert_eq!(found.len(), 1, "one crack, one tangent");
        assert_near(found[0], -slip, 1e-10 * slip, increment);
    }
}
