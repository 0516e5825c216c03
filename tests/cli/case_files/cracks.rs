//! Shapes, tips and contact spaces of cracks: what is accepted arrives as stated.

use stickslip::case::{ContactSpace, CrackShape, Tip};
use stickslip_xfem::geometry::ellipse::Ellipse;

use super::refusals::{PLANE_CRACK, POINTS};
use super::{PLANE, SOLID, accepted, refused};

const DISC: &str = "disc = { centre_m = [0, 1, 0.5], normal = [0, 0, 2], radius_m = 0.3 }";

fn shape(text: &str, from: &str, to: &str) -> CrackShape {
    assert_eq!(text.matches(from).count(), 1, "`{from}` must occur once");
    accepted(&text.replace(from, to)).cracks[0].geometry.clone()
}

#[test]
fn a_polyline_keeps_its_points_in_order() {
    for points in [
        vec![
            [-4.0, -4.0],
            [0.0, 0.0],
            [1.0, -1.0],
            [1.0, 3.5],
            [-4.0, 3.0],
        ],
        // Points on one line may follow each other, and almost a full turn is not one.
        vec![[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]],
        vec![[0.0, 0.0], [4.0, 0.0], [0.0, 1e-6]],
    ] {
        let found = shape(PLANE, POINTS, &format!("points_m = {points:?}"));
        assert_eq!(found, CrackShape::Polyline(points));
    }
    let many: Vec<String> = (0..1001).map(|i| format!("[{i}, 0]")).collect();
    let error = refused(&PLANE.replace(POINTS, &format!("points_m = [{}]", many.join(", "))));
    assert_eq!(error.key(), "crack[1].points_m", "{error}");
}

#[test]
fn arcs_keep_their_sense() {
    let arc = "arc = { centre_m = [1, -2], radius_m = 3, from_deg = 90, to_deg = -45 }";
    let expected = CrackShape::Arc {
        centre: [1.0, -2.0],
        radius: 3.0,
        from: std::f64::consts::FRAC_PI_2,
        to: -std::f64::consts::FRAC_PI_4,
    };
    assert_eq!(shape(PLANE, POINTS, arc), expected);
    let circle = "arc = { centre_m = [0, 0], radius_m = 3, from_deg = -180, to_deg = 180 }";
    let CrackShape::Arc { from, to, .. } = shape(PLANE, POINTS, circle) else {
        panic!("no arc")
    };
    assert_eq!(to - from, std::f64::consts::TAU);
}

#[test]
fn flat_cracks_in_solids_get_orthonormal_frames() {
    assert_eq!(
        shape(SOLID, PLANE_CRACK, DISC),
        CrackShape::Ellipse(Ellipse {
            centre: [0.0, 1.0, 0.5],
            normal: [0.0, 0.0, 1.0],
            axis: [1.0, 0.0, 0.0],
            half_axes: [0.3, 0.3],
        })
    );
    let given = [5.0, 0.0, 7.0];
    let ellipse = "ellipse = { centre_m = [0, 1, 0.5], normal = [0, 3, 4], axis = [5, 0, 7], half_axes_m = [0.3, 0.1] }";
    let CrackShape::Ellipse(found) = shape(SOLID, PLANE_CRACK, ellipse) else {
        panic!("no ellipse")
    };
    let (normal, axis) = (found.normal, found.axis);
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    assert_eq!(found.half_axes, [0.3, 0.1]);
    assert!((dot(normal, normal) - 1.0).abs() < 1e-15 && (dot(axis, axis) - 1.0).abs() < 1e-15);
    assert!(dot(normal, axis).abs() < 1e-15 && axis[0] > 0.0);
    // The axis stays in the plane of the normal and what was given.
    let [a, b] = [dot(given, axis), dot(given, normal)];
    assert!((0..3).all(|k| (a * axis[k] + b * normal[k] - given[k]).abs() < 1e-14));
}

#[test]
fn tips_and_contact_spaces_arrive() {
    let tip = |text: &str, from: &str, to: &str| accepted(&text.replace(from, to)).cracks[0].tip;
    let radius = "tip = { branch_radius_m = 0.5 }";
    let with = |tip: &str| format!("{DISC}\n{tip}");
    for (text, from, to, expected) in [
        (PLANE, "tip = \"branch\"", radius, Tip::Radius(0.5)),
        (PLANE, "tip = \"branch\"", "tip = \"none\"", Tip::None),
        (PLANE, "tip = \"branch\"\n", "", Tip::Auto),
        (SOLID, PLANE_CRACK, DISC, Tip::Auto),
        (SOLID, PLANE_CRACK, &with(radius), Tip::Radius(0.5)),
        (SOLID, PLANE_CRACK, &with("tip = \"none\""), Tip::None),
    ] {
        assert_eq!(tip(text, from, to), expected, "{to}");
    }
    for space in ContactSpace::ALL {
        let text = PLANE.replace("\"edge-pairs\"", &format!("{:?}", space.name()));
        assert_eq!(accepted(&text).cracks[0].contact, space);
    }
    let text = PLANE.replace("contact = \"edge-pairs\"\n", "");
    assert_eq!(accepted(&text).cracks[0].contact, ContactSpace::Star);
}
