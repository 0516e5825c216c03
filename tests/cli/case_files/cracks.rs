//! Shapes, tips and contact spaces of cracks: what is accepted arrives as stated, what is not is refused at its place.

use stickslip::case::{ContactSpace, CrackShape, Tip};
use stickslip_xfem::geometry::ellipse::Ellipse;

use super::refusals::assert_refused;
use super::{PLANE, SOLID, accepted};

const POINTS: &str = "points_m = [[-4, -4], [4, 4]]";
const PLANE_CRACK: &str = "plane = { point_m = [0, 0, 0.7], normal = [0, 3, 4] }";

fn shape(text: &str, from: &str, to: &str) -> CrackShape {
    assert_eq!(text.matches(from).count(), 1, "`{from}` must occur once");
    accepted(&text.replace(from, to)).cracks[0].geometry.clone()
}

#[test]
fn a_polyline_keeps_its_points_in_order() {
    let zigzag = "points_m = [[-4, -4], [0, 0], [1, -1], [1, 3.5], [-4, 3]]";
    assert_eq!(
        shape(PLANE, POINTS, zigzag),
        CrackShape::Polyline(vec![
            [-4.0, -4.0],
            [0.0, 0.0],
            [1.0, -1.0],
            [1.0, 3.5],
            [-4.0, 3.0]
        ])
    );
    // Points on one line may follow each other, and almost a full turn is not one.
    let straight = "points_m = [[0, 0], [1, 1], [3, 3]]";
    assert!(matches!(shape(PLANE, POINTS, straight), CrackShape::Polyline(p) if p.len() == 3));
    let sharp = "points_m = [[0, 0], [4, 0], [0, 1e-6]]";
    assert!(matches!(shape(PLANE, POINTS, sharp), CrackShape::Polyline(p) if p.len() == 3));
}

#[test]
fn polylines_that_fold_cross_or_touch_themselves_are_refused_at_the_point() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        (POINTS, "points_m = [[0, 0]]", "[[0, 0]]", "2 to 1000 points"),
        (POINTS, "points_m = []", "[]", "2 to 1000 points"),
        (POINTS, "points_m = [[0, 0], [1, 2, 3]]", "[1, 2, 3]", "2 entries"),
        (POINTS, "points_m = [[0, 0], [1, 2], [1, 2.0]]", "[1, 2.0]", "distinct"),
        (POINTS, "points_m = [[0, 0], [1e308, 0], [-1e308, 1]]", "1e308", "1e-25 to 1e25"),
        (POINTS, "points_m = [[0, 0], [2, 2], [1, 1]]", "[1, 1]", "180 degrees"),
        (POINTS, "points_m = [[0, 0], [2, 0], [-1, 1e-12]]", "[-1, 1e-12]", "180 degrees"),
        (POINTS, "points_m = [[0, 0], [2, 0], [1, 1], [1, -1]]", "[1, -1]", "meet at their ends"),
        (POINTS, "points_m = [[0, 0], [2, 0], [1, 1], [1, 0]]", "[1, 0]", "meet at their ends"),
        (POINTS, "points_m = [[0, 0], [2, 0], [1, 1], [0, 0.0]]", "[0, 0.0]", "meet at their ends"),
        (POINTS, "points_m = [[0, 0], [1, 0], [1, 1], [3, 0], [0.5, 0]]", "[0.5, 0]", "meet at their ends"),
    ]);
    let many: Vec<String> = (0..1001).map(|i| format!("[{i}, 0]")).collect();
    let error =
        super::refused(&PLANE.replace(POINTS, &format!("points_m = [{}]", many.join(", "))));
    assert_eq!(error.key(), "crack[1].points_m", "{error}");
}

#[test]
fn arcs_keep_their_sense() {
    let arc = "arc = { centre_m = [1, -2], radius_m = 3, from_deg = 90, to_deg = -45 }";
    let found = shape(PLANE, POINTS, arc);
    let CrackShape::Arc {
        centre,
        radius,
        from,
        to,
    } = found
    else {
        panic!("{found:?}")
    };
    assert_eq!((centre, radius), ([1.0, -2.0], 3.0));
    assert_eq!(from, std::f64::consts::FRAC_PI_2);
    assert_eq!(to, -std::f64::consts::FRAC_PI_4);
    let circle = "arc = { centre_m = [0, 0], radius_m = 3, from_deg = -180, to_deg = 180 }";
    assert!(
        matches!(shape(PLANE, POINTS, circle), CrackShape::Arc { from, to, .. } if to - from == std::f64::consts::TAU)
    );
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        (POINTS, "arc = { centre_m = [0, 0], radius_m = -0.5, from_deg = 0, to_deg = 1 }", "-0.5", "radius_m > 0"),
        (POINTS, "arc = { centre_m = [0], radius_m = 1, from_deg = 0, to_deg = 1 }", "[0]", "2 entries"),
        (POINTS, "arc = { centre_m = [0, 0], radius_m = 1, from_deg = 361, to_deg = 1 }", "361", "-360 <= from_deg <= 360"),
        (POINTS, "arc = { centre_m = [0, 0], radius_m = 1, from_deg = 7, to_deg = 7.0 }", "7.0", "at most 360 degrees"),
        (POINTS, "arc = { centre_m = [0, 0], radius_m = 1, from_deg = -90, to_deg = 271 }", "271", "at most 360 degrees"),
        (POINTS, "arc = { center_m = [0, 0], radius_m = 1, from_deg = 7, to_deg = 8 }", "center_m", "centre_m"),
        (POINTS, "disc = { centre_m = [0, 0, 0], normal = [0, 0, 1], radius_m = 1 }",
            "{ centre_m = [0, 0, 0], normal = [0, 0, 1], radius_m = 1 }", "points_m or arc"),
    ]);
}

#[test]
fn flat_cracks_in_solids_get_orthonormal_frames() {
    let disc = "disc = { centre_m = [0, 1, 0.5], normal = [0, 0, 2], radius_m = 0.3 }";
    assert_eq!(
        shape(SOLID, PLANE_CRACK, disc),
        CrackShape::Ellipse(Ellipse {
            centre: [0.0, 1.0, 0.5],
            normal: [0.0, 0.0, 1.0],
            axis: [1.0, 0.0, 0.0],
            half_axes: [0.3, 0.3],
        })
    );
    let ellipse = "ellipse = { centre_m = [0, 1, 0.5], normal = [0, 3, 4], axis = [5, 0, 7], half_axes_m = [0.3, 0.1] }";
    let found = shape(SOLID, PLANE_CRACK, ellipse);
    let CrackShape::Ellipse(Ellipse {
        normal,
        axis,
        half_axes,
        ..
    }) = found
    else {
        panic!("{found:?}")
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    assert_eq!(half_axes, [0.3, 0.1]);
    assert!((dot(normal, normal) - 1.0).abs() < 1e-15 && (dot(axis, axis) - 1.0).abs() < 1e-15);
    assert!(dot(normal, axis).abs() < 1e-15 && axis[0] > 0.0);
    // The axis stays in the plane of the normal and what was given.
    let given = [5.0, 0.0, 7.0];
    let [a, b] = [dot(given, axis), dot(given, normal)];
    assert!((0..3).all(|k| (a * axis[k] + b * normal[k] - given[k]).abs() < 1e-14));
    #[rustfmt::skip]
    assert_refused(SOLID, &[
        (PLANE_CRACK, "disc = { centre_m = [0, 1, 0], normal = [0, 0, 0.0], radius_m = 1 }", "[0, 0, 0.0]", "not zero"),
        (PLANE_CRACK, "disc = { centre_m = [0, 1, 0], normal = [0, 0, 1], radius_m = -1 }", "-1", "radius_m > 0"),
        (PLANE_CRACK, "ellipse = { centre_m = [0, 1, 0], normal = [0, 3, 4], axis = [0, -6, -8], half_axes_m = [1, 1] }", "[0, -6, -8]", "not that of the normal"),
        (PLANE_CRACK, "ellipse = { centre_m = [0, 1, 0], normal = [0, 3, 4], axis = [0, 0, 0], half_axes_m = [1, 1] }", "[0, 0, 0]", "not zero"),
        (PLANE_CRACK, "ellipse = { centre_m = [0, 1, 0], normal = [0, 3, 4], axis = [1, 0, 0], half_axes_m = [1, -2] }", "-2", "half_axes_m > 0"),
        (PLANE_CRACK, "ellipse = { centre_m = [0, 1, 0], normal = [0, 3, 4], axis = [1, 0, 0], half_axes_m = [1] }", "[1]", "2 entries"),
        (PLANE_CRACK, "arc = { centre_m = [0, 0], radius_m = 1, from_deg = 0, to_deg = 9 }",
            "{ centre_m = [0, 0], radius_m = 1, from_deg = 0, to_deg = 9 }", "plane, disc or ellipse"),
    ]);
}

#[test]
fn tips_take_a_radius_and_planes_have_none() {
    let tip = |text: &str, from: &str, to: &str| accepted(&text.replace(from, to)).cracks[0].tip;
    let radius = "tip = { branch_radius_m = 0.5 }";
    assert_eq!(tip(PLANE, "tip = \"branch\"", radius), Tip::Radius(0.5));
    assert_eq!(tip(PLANE, "tip = \"branch\"", "tip = \"none\""), Tip::None);
    let disc = "disc = { centre_m = [0, 1, 0.5], normal = [0, 0, 2], radius_m = 0.3 }";
    assert_eq!(tip(SOLID, PLANE_CRACK, disc), Tip::Auto);
    let with = format!("{disc}\n{radius}");
    assert_eq!(tip(SOLID, PLANE_CRACK, &with), Tip::Radius(0.5));
    assert_eq!(
        tip(SOLID, PLANE_CRACK, &format!("{disc}\ntip = \"none\"")),
        Tip::None
    );
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("tip = \"branch\"", "tip = { branch_radius_m = -2 }", "-2", "branch_radius_m > 0"),
        ("tip = \"branch\"", "tip = { branch_radius_m = inf }", "inf", "branch_radius_m > 0"),
        ("tip = \"branch\"", "tip = { radius_m = 1 }", "radius_m", "branch_radius_m"),
        ("tip = \"branch\"", "tip = 0.5", "0.5", "{ branch_radius_m = R }"),
        ("tip = \"branch\"", "tip = \"branches\"", "\"branches\"", "none, auto, branch"),
    ]);
    #[rustfmt::skip]
    assert_refused(SOLID, &[
        ("friction = 0", "friction = 0\ntip = { branch_radius_m = 1 }", "{ branch_radius_m = 1 }", "none"),
    ]);
}

#[test]
fn contact_spaces_have_their_names() {
    for space in ContactSpace::ALL {
        let text = PLANE.replace("\"edge-pairs\"", &format!("{:?}", space.name()));
        assert_eq!(accepted(&text).cracks[0].contact, space);
    }
    let text = PLANE.replace("contact = \"edge-pairs\"\n", "");
    assert_eq!(accepted(&text).cracks[0].contact, ContactSpace::Star);
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("\"edge-pairs\"", "\"stars\"", "\"stars\"", "star, edge-pairs"),
    ]);
}

#[test]
fn keys_of_shapes_are_required_and_documented() {
    let document = include_str!("../../../docs/case-format.md");
    #[rustfmt::skip]
    let rows = [
        (PLANE, POINTS, "arc", &["centre_m", "radius_m", "from_deg", "to_deg"][..]),
        (SOLID, PLANE_CRACK, "plane", &["point_m", "normal"]),
        (SOLID, PLANE_CRACK, "disc", &["centre_m", "normal", "radius_m"]),
        (SOLID, PLANE_CRACK, "ellipse", &["centre_m", "normal", "axis", "half_axes_m"]),
    ];
    for (text, from, shape, keys) in rows {
        let value = |key: &str| match key {
            "centre_m" if shape == "arc" => "[0, 0]",
            "half_axes_m" => "[1, 2]",
            "axis" => "[1, 0, 0]",
            "centre_m" | "point_m" | "normal" => "[0, 0, 0.7]",
            "to_deg" => "90",
            _ => "1",
        };
        for missing in keys {
            let given: Vec<String> = (keys.iter().filter(|k| *k != missing))
                .map(|k| format!("{k} = {}", value(k)))
                .collect();
            let bad = text.replace(from, &format!("{shape} = {{ {} }}", given.join(", ")));
            let error = super::refused(&bad);
            assert_eq!(error.message(), format!("missing `{missing}`"), "{error}");
            assert_eq!(error.key(), format!("crack[1].{shape}"), "{error}");
            assert!(
                document.contains(&format!("`{shape}.{missing}`")),
                "{shape}.{missing}"
            );
        }
        let error = super::refused(&text.replace(from, &format!("{shape} = {{ bad = 1 }}")));
        assert_eq!(error.allowed(), keys.join(", "), "{error}");
    }
    let error = super::refused(&PLANE.replace("tip = \"branch\"", "tip = {}"));
    assert_eq!(error.message(), "missing `branch_radius_m`", "{error}");
}
