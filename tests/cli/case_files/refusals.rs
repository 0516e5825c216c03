//! Faults that a reader of the file can see: each is refused at its line and column, with the value and what is allowed.

use stickslip::case::{self, Case, CaseError};

use super::{PLANE, SOLID, accepted, place, refused};

/// One fault: the text replaced, its replacement, where in it the fault is, what is allowed instead.
pub type Fault<'a> = (&'a str, &'a str, &'a str, &'a str);

pub const POINTS: &str = "points_m = [[-4, -4], [4, 4]]";
pub const PLANE_CRACK: &str = "plane = { point_m = [0, 0, 0.7], normal = [0, 3, 4] }";
pub const MOVED: &str = "displacement_m = [\"free\", -0.1]\nhistory = [[0, 0], [1, 2.5]]";
const LINES: &str = "lines_m = [[0, 1], [0, 1, 2], [0, 0.5, 1]]";
const CELLS: &str = "cells = [22, 23]";
const BODY: &str = "body_n_per_m3 = [0, -1e4]";
const PRESSURE: &str = "pressure_pa = 1e5";
const WHERE: &str = "where = \"x <= 1 and y > 2\"";

/// Demands of every fault a refusal at its place that shows the value there and says what is allowed.
pub fn assert_refused(text: &str, faults: &[Fault]) {
    assert_refused_by(|text| case::parse("bad.toml", text), text, faults);
}

/// The same of a reader of one's own.
pub fn assert_refused_by(
    read: impl Fn(&str) -> Result<Case, CaseError>,
    text: &str,
    faults: &[Fault],
) {
    for (from, to, mark, allowed) in faults {
        assert_eq!(text.matches(from).count(), 1, "`{from}` must occur once");
        let bad = text.replace(from, to);
        let at = text.find(from).unwrap() + to.find(mark).expect("mark inside the replacement");
        let error = read(&bad).expect_err(&bad);
        let (line, column) = place(&bad, at);
        assert_eq!(
            (error.line(), error.column()),
            (line, column),
            "{to}\n{error}"
        );
        let (value, wanted) = (error.value(), error.allowed());
        let shown = format!("bad.toml:{line}:{column}: {}", error.key());
        assert!(error.to_string().starts_with(&shown), "{error}");
        let shown = value == "nothing" || bad[at..].starts_with(value);
        assert!(!value.is_empty() && shown, "{error}");
        assert!(
            wanted.contains(allowed),
            "allowed `{allowed}` missing in\n{error}"
        );
        let end = format!("got {value}, allowed: {wanted}\n");
        assert!(error.to_string().contains(&end), "{error}");
    }
}

#[test]
fn unknown_keys_are_refused_with_the_allowed_ones() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("young_pa = 1e10", "yuong_pa = 1e10", "yuong_pa", "young_pa, poisson, dilatation"),
        ("title = \"Plate\"", "titel = \"Plate\"", "titel", "title, model, quadrature"),
        ("half_length_m = 5.5", "half_length = 5.5", "half_length", "half_length_m"),
        ("contact = \"edge", "contakt = \"edge", "contakt", "contact"),
        ("displacement_m = [0, 0]", "displacement_mm = [0, 0]", "displacement_mm", "displacement_m"),
        (PRESSURE, "pressure = 1e5", "pressure", "pressure_pa"),
        ("end = 2.0", "stop = 2.0", "stop", "increments, end"),
        ("refine = [1, 3]", "mesh = [1, 3]", "mesh", "friction, refine"),
        ("name = \"centre\"", "label = \"centre\"", "label", "name, point_m"),
        ("unit = \"N/m\"", "units = \"N/m\"", "units", "unit"),
        (POINTS, "arc = { center_m = [0, 0] }", "center_m", "centre_m, radius_m, from_deg, to_deg"),
        ("tip = \"branch\"", "tip = { radius_m = 1 }", "radius_m", "branch_radius_m"),
        (PRESSURE, "pressure_pa = { at_origin = 1 }", "at_origin", "at_origin_pa, gradient_pa_per_m"),
        (CELLS, "cells = [22, 23]\n[mesh.twist]\nangle = 20", "angle", "angle_deg"),
        (CELLS, "cells = [22, 23]\n[mesh.distort]\nseeds = 4", "seeds", "amplitude, seed"),
    ]);
    let error = refused(&PLANE.replace("young_pa", "yuong_pa"));
    assert!(
        error.message().contains("did you mean `young_pa`"),
        "{error}"
    );
    let error = refused(&SOLID.replace("young_pa = 1", "young_pa = 1, density = 2"));
    assert_eq!(error.key(), "material.density");
}

#[test]
fn every_allowed_key_is_documented() {
    let document = include_str!("../../../docs/case-format.md");
    for (text, table, prefix, count) in [
        (PLANE, "title = ", "", 16),
        (PLANE, "young_pa", "", 3),
        (PLANE, "min_m", "box.", 3),
        (PLANE, "angle_deg", "follow.", 3),
        (PLANE, "points_m", "", 8),
        (PLANE, "displacement_m = [0, 0]", "", 5),
        (PLANE, "pressure_pa", "", 9),
        (PLANE, "increments", "", 2),
        (PLANE, "refine = [", "", 2),
        (PLANE, "point_m = [0, 0]\n\n[[expect", "", 2),
        (PLANE, "quantity", "", 15),
        (SOLID, "lines_m", "", 5),
    ] {
        assert_eq!(text.matches(table).count(), 1, "`{table}` must occur once");
        let error = refused(&text.replace(table, &format!("bad = 0\n{table}")));
        let keys: Vec<&str> = error.allowed().split(", ").collect();
        assert_eq!(keys.len(), count, "{error}");
        for key in keys {
            // A key that holds a table is documented by the keys inside it.
            let mut named = ["` |", "."].iter();
            let named = named.any(|e| document.contains(&format!("| `{prefix}{key}{e}")));
            assert!(named, "`{prefix}{key}` is not documented");
        }
    }
    #[rustfmt::skip]
    let shapes = [
        (PLANE, POINTS, "arc", "centre_m, radius_m, from_deg, to_deg"),
        (SOLID, PLANE_CRACK, "plane", "point_m, normal"),
        (SOLID, PLANE_CRACK, "disc", "centre_m, normal, radius_m"),
        (SOLID, PLANE_CRACK, "ellipse", "centre_m, normal, axis, half_axes_m"),
    ];
    for (text, from, shape, keys) in shapes {
        let error = refused(&text.replace(from, &format!("{shape} = {{ bad = 1 }}")));
        assert_eq!(error.allowed(), keys, "{error}");
        for key in keys.split(", ") {
            assert!(
                document.contains(&format!("`{shape}.{key}`")),
                "{shape}.{key}"
            );
        }
    }
    for key in ["solution", "history", "crack_side", "initial_stress_pa"] {
        assert!(document.contains(&format!("| `{key}` |")), "{key}");
    }
    for key in ["at_origin_pa", "gradient_pa_per_m"] {
        assert!(document.contains(&format!("{key} = ")), "{key}");
    }
}

#[test]
fn missing_keys_are_refused_at_their_table() {
    #[rustfmt::skip]
    let rows = [
        (PLANE, "title = \"Plate\"\n", "", "title", "title"),
        (PLANE, "model = \"plane-strain\"\n", "", "model", "title"),
        (PLANE, "young_pa = 1e10\n", "", "young_pa", "[material]"),
        (PLANE, "max_m = [10, 10]\n", "", "max_m", "[mesh.box]"),
        (PLANE, "friction = 0.1\n", "", "friction", "[[crack]]"),
        (PLANE, "displacement_m = [0, 0]\n", "", "displacement_m", "[[support]]"),
        (PLANE, "pressure_pa = 1e5\n", "", "traction_pa", "[[load]]"),
        (PLANE, "name = \"b-newton\"\n", "", "name", "[[method]]"),
        (PLANE, "unit = \"N/m\"\n", "", "unit", "[[expect]]"),
        (PLANE, "relative = 1e-3\n", "", "absolute", "[[expect]]"),
        (SOLID, LINES, "", "box`, `lines_m", "[mesh]"),
        (PLANE, "tip = \"branch\"", "tip = {}", "branch_radius_m", "{}"),
        (PLANE, CELLS, "cells = [22, 23]\n[mesh.twist]", "angle_deg", "[mesh.twist]"),
        (PLANE, CELLS, "cells = [22, 23]\n[mesh.distort]", "amplitude", "[mesh.distort]"),
        (PLANE, POINTS, "arc = { centre_m = [0, 0], radius_m = 1, to_deg = 9 }", "from_deg", "{ centre"),
        (SOLID, PLANE_CRACK, "disc = { normal = [0, 0, 1], radius_m = 1 }", "centre_m", "{ normal"),
        (SOLID, PLANE_CRACK, "ellipse = { centre_m = [0, 0, 1], normal = [0, 0, 1] }", "axis", "{ centre"),
        (PLANE, PRESSURE, "pressure_pa = { gradient_pa_per_m = [2, 3] }", "at_origin_pa", "{ grad"),
        (PLANE, PRESSURE, "pressure_pa = { at_origin_pa = 1 }", "gradient_pa_per_m", "{ at"),
    ];
    for (text, from, to, key, table) in rows {
        assert_eq!(text.matches(from).count(), 1, "`{from}` must occur once");
        let bad = text.replace(from, to);
        let error = refused(&bad);
        assert!(error.message().starts_with("missing"), "{error}");
        assert!(error.allowed().contains(&format!("`{key}`")), "{error}");
        assert_eq!(error.value(), "nothing");
        let at = bad.find(table).unwrap_or(0);
        assert_eq!((error.line(), error.column()), place(&bad, at), "{error}");
    }
    assert_eq!((refused("").line(), refused("").column()), (1, 1));
}

#[test]
fn wrong_types_and_names_are_refused_where_they_stand() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("young_pa = 1e10", "young_pa = \"steel\"", "\"steel\"", "young_pa > 0"),
        ("poisson = 0.3", "poisson = [0.3]", "[0.3]", "0 <= poisson < 0.5"),
        ("poisson = 0.3", "poisson = 0.3\ndilatation = \"half\"", "\"half\"", "mean, full"),
        ("poisson = 0.3", "poisson = 0.3\ndilatation = 1", "1", "a string"),
        ("title = \"Plate\"", "title = 7", "7", "a string"),
        ("title = \"Plate\"", "title = \"\"", "\"\"", "one line"),
        ("title = \"Plate\"", "title = \"a\\u001b[31m\"", "\"a\\u", "one line"),
        ("name = \"centre\"", "name = \"a\\tb\"", "\"a\\tb\"", "one line"),
        ("increments = 4", "increments = 4.5", "4.5", "integers from 1 to 10000"),
        (CELLS, "cells = [22, true]", "true", "integers from 1"),
        (CELLS, "cells = [22, 23, 1]", "[22, 23, 1]", "2 entries"),
        ("angle_deg = 45", "angle_deg = 2020-01-01", "2020-01-01", "-80 < angle_deg < 80"),
        ("max_m = [10, 10]", "max_m = 10", "10", "an array"),
        ("[\"free\", -0.1]", "[\"fixed\", 0]", "fixed", "\"free\""),
        ("max_iterations = 50", "max_iterations = \"many\"", "\"many\"", "finite numbers"),
        ("[[probe]]", "[probe]", "[probe]", "[[probe]]"),
        ("[\"plane strain\"]", "[3]", "3", "a string"),
        ("tip = \"branch\"", "tip = 0.5", "0.5", "{ branch_radius_m = R }"),
        ("tip = \"branch\"", "tip = \"branches\"", "\"branches\"", "none, auto, branch"),
        ("\"edge-pairs\"", "\"stars\"", "\"stars\"", "star, edge-pairs"),
        ("[[0, 0], [1, 2.5]]", "\"sine\"", "\"sine\"", "ramp, constant"),
        ("quadrature = \"sub-cells\"", "quadrature = \"gauss-17\"", "\"gauss-17\"", "from 2 to 16"),
        ("tier = \"mid\"", "tier = \"best\"", "\"best\"", "low, mid, high"),
        (PRESSURE, "traction_pa = \"given\"", "\"given\"", "an array"),
        (WHERE, "where = 3", "3", "an array of conditions"),
        (WHERE, "where = [\"x <= 1\", 3]", "3", "a string"),
    ]);
    let mean = PLANE.replace("poisson = 0.3", "poisson = 0.3\ndilatation = \"mean\"");
    let error = refused(&mean.replace("plane-strain", "plane-stress"));
    assert_eq!(
        (error.key(), error.allowed()),
        ("material.dilatation", "full"),
        "{error}"
    );
}

#[test]
fn numbers_out_of_range_are_refused_with_the_range() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("young_pa = 1e10", "young_pa = -2e11", "-2e11", "young_pa > 0"),
        ("young_pa = 1e10", "young_pa = 0", "0", "young_pa > 0"),
        ("poisson = 0.3", "poisson = 0.5", "0.5", "0 <= poisson < 0.5"),
        ("poisson = 0.3", "poisson = 1", "1", "0 <= poisson < 0.5"),
        ("poisson = 0.3", "poisson = -0.1", "-0.1", "0 <= poisson < 0.5"),
        ("friction = 0.1\n", "friction = -0.1\n", "-0.1", "friction >= 0"),
        ("friction = [0.1, 0.8]", "friction = [0.1, -0.8]", "-0.8", "friction >= 0"),
        ("friction = [0.1, 0.8]", "friction = [0.8, 0.80]", "0.80", "each value once"),
        ("increments = 4", "increments = 0", "0", "integers from 1 to 10000"),
        ("increments = 4", "increments = -3", "-3", "integers from 1 to 10000"),
        ("increments = 4", "increments = 10001", "10001", "integers from 1 to 10000"),
        ("increments = 4", "increments = 99999999999999999999", "99999999999999999999", "integers from 1"),
        ("end = 2.0", "end = 0.0", "0.0", "end > 0"),
        ("relative = 1e-3", "relative = 0", "0", "> 0"),
        ("relative = 1e-3", "absolute = -1", "-1", "> 0"),
        ("refine = [1, 3]", "refine = [1, 0]", "0", "integers from 1"),
        ("refine = [1, 3]", "refine = [1, 500]", "500", "at most 20000000 cells"),
        ("refine = [1, 3]", "refine = []", "[]", "at least one value"),
        ("tip = \"branch\"", "tip = { branch_radius_m = -2 }", "-2", "branch_radius_m > 0"),
        ("[[0, 0], [1, 2.5]]", "[[0, 1], [-0.5, 2.5]]", "-0.5", "t > 0"),
        ("[[0, 0], [1, 2.5]]", "[]", "[]", "at least one point"),
        ("[[0, 0], [1, 2.5]]", "[[3]]", "[3]", "2 entries"),
    ]);
    let spots = [
        ("young_pa = ", "1e10", ""),
        ("[mesh.follow]\npoint_m = [0, ", "0", "]"),
        ("max_m = [10, ", "10", "]"),
        ("points_m = [[-4, -4], [4, ", "4", "]]"),
        ("[\"free\", ", "-0.1", "]"),
        ("pressure_pa = ", "1e5", ""),
        ("body_n_per_m3 = [0, ", "-1e4", "]"),
        ("history = [[0, 0], [1, ", "2.5", "]]"),
        ("history = [[0, 0], [", "1", ", 2.5]]"),
        ("end = ", "2.0", ""),
        ("friction = ", "0.1", "\n"),
        ("friction = [0.1, ", "0.8", "]"),
        ("max_iterations = ", "50", ""),
        ("value = ", "-9.7e8", ""),
        ("relative = ", "1e-3", ""),
    ];
    for (start, number, end) in spots {
        // No product of the numbers of a case vanishes or overflows; `1e-400` is not taken for 0.
        for bad in [
            "nan", "-inf", "1e999", "1e-300", "2e25", "1e-400", "0.5e-999",
        ] {
            let [from, to] = [number, bad].map(|number| format!("{start}{number}{end}"));
            assert_refused(PLANE, &[(&from, &to, bad, "")]);
        }
    }
    for good in ["1e-25", "1e25", "0e-400", "0.0"] {
        accepted(&PLANE.replace(PRESSURE, &format!("pressure_pa = {good}")));
    }
}

#[test]
fn meshes_without_cells_or_out_of_the_body_are_refused() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        (CELLS, "cells = [22, 0]", "0", "integers from 1"),
        (CELLS, "cells = [20000, 2000]", "[20000, 2000]", "at most 20000000 cells"),
        ("max_m = [10, 10]", "max_m = [10, -10]", "-10", "more than min_m = -10"),
        ("max_m = [10, 10]", "max_m = [10, -11]", "-11", "more than min_m = -10"),
        ("angle_deg = 45", "angle_deg = -80", "-80", "-80 < angle_deg < 80"),
        ("angle_deg = 45", "angle_deg = 70", "70", "shifts between"),
        ("half_length_m = 5.5", "half_length_m = 10", "10", "half_length_m < 10"),
        ("half_length_m = 5.5", "half_length_m = 0", "0", "0 < half_length_m"),
        ("[mesh.follow]\npoint_m = [0, 0]", "[mesh.follow]\npoint_m = [0, 10]", "10", "inside the body"),
        (CELLS, "cells = [22, 23]\n[mesh.twist]\nangle_deg = 180", "180", "-180 < angle_deg < 180"),
        (CELLS, "cells = [22, 23]\n[mesh.distort]\namplitude = 0.5", "0.5", "0 <= amplitude < 0.5"),
        (CELLS, "cells = [22, 23]\n[mesh.distort]\namplitude = 0.1\nseed = -1", "-1", "integers from 0"),
        (CELLS, "cells = [22, 23]\n[mesh.distort]\namplitude = 0.1\nseed = 4294967296", "4294967296", "integers from 0"),
    ]);
    #[rustfmt::skip]
    assert_refused(SOLID, &[
        (LINES, "lines_m = [[0, 1], [7], [0, 0.5, 1]]", "[7]", "at least 2 grid lines"),
        (LINES, "lines_m = [[0, 1], [], [0, 0.5, 1]]", "[]", "at least 2 grid lines"),
        (LINES, "lines_m = [[0, 1], [0, 1, 1.0], [0, 0.5, 1]]", "1.0", "more than 1"),
        (LINES, "lines_m = [[0, 1], [0, 2, -3], [0, 0.5, 1]]", "-3", "more than 2"),
        (LINES, "lines_m = [[0, 1], [0, 1]]", "[[0, 1], [0, 1]]", "3 entries"),
        (LINES, "box = { min_m = [0, 0, 0], max_m = [1, 1, 1], cells = [] }", "[]", "3 entries"),
        ("[mesh]\n", "[mesh]\ntwist = { angle_deg = 3 }\n", "{ angle_deg = 3 }", "a 2D model"),
        ("[mesh]\n", "[mesh]\ndistort = { amplitude = 0.1 }\n", "{ amplitude = 0.1 }", "a 2D model"),
    ]);
    let low = PLANE.replace(
        "[mesh.follow]\npoint_m = [0, 0]",
        "[mesh.follow]\npoint_m = [0, -5]",
    );
    let refined =
        SOLID.replace("[0, 0.5, 1]]", "[0, 1, 1.00000000000002]]") + "[sweep]\nrefine = [2]\n";
    for (text, key) in [
        (
            PLANE.replace("max_m = [10, 10]", "max_m = [10, -9.999999999999998]"),
            "mesh.box.cells",
        ),
        (
            SOLID.replace("[0, 0.5, 1]]", "[0, 0.5, 0.5000000000000001]]"),
            "mesh.lines_m[3][3]",
        ),
        (refined, "sweep.refine[1]"),
        // 5.5 m · tan 59° = 9.15 m is less than the 9.57 m between the row and the side; tan 61° is more.
        (
            PLANE.replace("angle_deg = 45", "angle_deg = -61"),
            "mesh.follow.angle_deg",
        ),
        // 5 m below or above the middle there is room for one of the two shifts only.
        (low.clone(), "mesh.follow.angle_deg"),
        (
            low.replace("point_m = [0, -5]", "point_m = [0, 5]"),
            "mesh.follow.angle_deg",
        ),
        // From side to side the line rises 20 m.
        (
            PLANE.replace("half_length_m = 5.5\n", ""),
            "mesh.follow.angle_deg",
        ),
    ] {
        assert_eq!(refused(&text).key(), key, "{text}");
    }
    accepted(&PLANE.replace("angle_deg = 45", "angle_deg = -59"));
    accepted(&low.replace("half_length_m = 5.5", "half_length_m = 4"));
    // Runs that differ in nothing.
    let whole = "title = \"t\"\nmodel = \"plane-strain\"\nmaterial = { young_pa = 1, poisson = 0 }\n\
                 mesh = { box = { min_m = [0, 0], max_m = [1, 1], cells = [2, 2] } }\nsweep = { friction = [0, 1] }\n";
    assert_eq!(refused(whole).message(), "friction of no crack");
}

#[test]
fn cracks_that_are_none_are_refused_at_the_point() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        (POINTS, "points_m = [[0, 0]]", "[[0, 0]]", "2 to 1000 points"),
        (POINTS, "points_m = []", "[]", "2 to 1000 points"),
        (POINTS, "points_m = [[0, 0], [1, 2, 3]]", "[1, 2, 3]", "2 entries"),
        (POINTS, "points_m = [[0, 0], [1, 2], [1, 2.0]]", "[1, 2.0]", "distinct"),
        (POINTS, "points_m = [[0, 0], [2, 2], [1, 1]]", "[1, 1]", "180 degrees"),
        (POINTS, "points_m = [[0, 0], [2, 0], [-1, 1e-12]]", "[-1, 1e-12]", "180 degrees"),
        (POINTS, "points_m = [[0, 0], [2, 0], [1, 1], [1, -1]]", "[1, -1]", "meet at their ends"),
        (POINTS, "points_m = [[0, 0], [2, 0], [1, 1], [1, 0]]", "[1, 0]", "meet at their ends"),
        (POINTS, "points_m = [[0, 0], [1, 0], [1, 1], [3, 0], [0.5, 0]]", "[0.5, 0]", "meet at their ends"),
        (POINTS, "arc = { centre_m = [0, 0], radius_m = -0.5, from_deg = 0, to_deg = 1 }", "-0.5", "radius_m > 0"),
        (POINTS, "arc = { centre_m = [0], radius_m = 1, from_deg = 0, to_deg = 1 }", "[0]", "2 entries"),
        (POINTS, "arc = { centre_m = [0, 0], radius_m = 1, from_deg = 361, to_deg = 1 }", "361", "-360 <= from_deg <= 360"),
        (POINTS, "arc = { centre_m = [0, 0], radius_m = 1, from_deg = 7, to_deg = 7.0 }", "7.0", "at most 360 degrees"),
        (POINTS, "arc = { centre_m = [0, 0], radius_m = 1, from_deg = -90, to_deg = 271 }", "271", "at most 360 degrees"),
        (POINTS, "disc = { radius_m = 1 }", "{ radius_m = 1 }", "points_m or arc"),
    ]);
    #[rustfmt::skip]
    assert_refused(SOLID, &[
        ("normal = [0, 3, 4]", "normal = [0, 0.0, 0]", "[0, 0.0, 0]", "not zero"),
        (PLANE_CRACK, "disc = { centre_m = [0, 1, 0], normal = [0, 0, 1], radius_m = -1 }", "-1", "radius_m > 0"),
        (PLANE_CRACK, "ellipse = { centre_m = [0, 1, 0], normal = [0, 3, 4], axis = [0, -6, -8], half_axes_m = [1, 1] }", "[0, -6, -8]", "not that of the normal"),
        (PLANE_CRACK, "ellipse = { centre_m = [0, 1, 0], normal = [0, 3, 4], axis = [0, 0, 0], half_axes_m = [1, 1] }", "[0, 0, 0]", "not zero"),
        (PLANE_CRACK, "ellipse = { centre_m = [0, 1, 0], normal = [0, 3, 4], axis = [1, 0, 0], half_axes_m = [1, -2] }", "-2", "half_axes_m > 0"),
        (PLANE_CRACK, "arc = { radius_m = 1 }", "{ radius_m = 1 }", "plane, disc or ellipse"),
        ("friction = 0", "friction = 0\ntip = { branch_radius_m = 1 }", "{ branch_radius_m = 1 }", "none"),
        ("friction = 0", "friction = 0\ntip = \"branch\"", "\"branch\"", "none"),
    ]);
}

#[test]
fn supports_and_loads_that_contradict_themselves_are_refused() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("[\"left\", \"top\"]", "[\"left\", \"right\"]", "\"right\"", "meet in an edge"),
        ("[\"left\", \"top\"]", "[]", "[]", "1 to 2 sides"),
        ("[\"left\", \"top\"]", "\"front\"", "\"front\"", "left, right, bottom, top"),
        ("\"left\"\npressure", "[\"left\", \"top\"]\npressure", "[\"left\", \"top\"]", "exactly one side"),
        ("[\"free\", -0.1]", "[\"free\", \"free\"]", "[\"free\", \"free\"]", "at least one number"),
        (MOVED, "displacement_m = [\"x - 2 w\", 0]", "w", "here a number or x, y"),
        (MOVED, "displacement_m = [0, 0]\ncrack_side = 3", "3", "integers from 1 to 2"),
        (BODY, "line_n_per_m = [1, 2]", "[1, 2]", "in 2D"),
        (BODY, "body_n_per_m3 = [0, 1]\non = \"top\"", "\"top\"", "neither"),
        (BODY, "body_n_per_m3 = [0, 0, 1]", "[0, 0, 1]", "2 entries"),
        (BODY, "body_n_per_m3 = [0, -4]\ncrack_side = 7", "7", "integers from 1 to 2"),
        (BODY, "body_n_per_m3 = [0, -4]\ncrack_side = 2\n[[crack]]\npoints_m = [[5, 0], [9, 0]]\nfriction = 0", "2\n", "exactly one [[crack]]"),
        (BODY, "initial_stress_pa = [1, 2]", "[1, 2]", "3 entries"),
        (BODY, "initial_stress_pa = [1, 2, 3]\nwhere = \"x > 0\"", "\"x > 0\"", "neither"),
        (BODY, "initial_stress_pa = [4, 2, 3]\ncrack_side = 1", "1", "beside body_n_per_m3"),
        (PRESSURE, "pressure_pa = 3e5\ncrack_side = 1", "1", "beside body_n_per_m3"),
        (PRESSURE, "pressure_pa = { at_origin_pa = 1, gradient_pa_per_m = [2] }", "[2]", "2 entries"),
        (PRESSURE, "pressure_pa = { at_origin_pa = inf, gradient_pa_per_m = [2, 3] }", "inf", "finite numbers"),
        (PRESSURE, "traction_pa = [1]", "[1]", "2 entries"),
        (PRESSURE, "traction_pa = [1, \"3 x + high\"]", "high", "here a number or x, y"),
        (PRESSURE, "pressure_pa = \"high\"", "high", "gradient_pa_per_m"),
        (PRESSURE, "pressure_pa = \"3 x*y^2\"", "3 x", "degree 0, 1 or 2"),
        (PRESSURE, "pressure_pa = \"3 z\"", "z", "here a number or x, y"),
        (PRESSURE, "pressure_pa = \"\"", "\"\"", "here a number or x, y"),
        // At the column inside the string.
        (WHERE, "where = \"x <= 1 and w > 2\"", "w >", "x, y"),
        (WHERE, "where = \"x <= 1 and z > 2\"", "z >", "2D"),
        (WHERE, "where = \"x <= 1 and y ! 2\"", "! 2", "<="),
        (WHERE, "where = 'x <= 1 xor y > 2'", "xor", "`and`"),
        (WHERE, "where = \"x <= inf\"", "inf", "finite number"),
        (WHERE, "where = \"\"\"\nx <= 1 or w > 2\"\"\"", "w >", "x, y"),
        (WHERE, "where = [\"x <= 1\", \"y > w\"]", "w\"", "a finite number"),
        (WHERE, "where = \"\"", "\"\"", "x, y"),
        (WHERE, "where = []", "[]", "at least one condition"),
    ]);
    #[rustfmt::skip]
    assert_refused(SOLID, &[
        ("on = [\"back\", \"top\"]", "on = \"top\"", "\"top\"", "two sides"),
        ("on = [\"back\", \"top\"]", "on = [\"back\", \"front\"]", "\"front\"", "meet in an edge"),
        ("on = [\"back\", \"top\"]\nline_n_per_m = [-1, 0, 2.5]", "initial_stress_pa = [1, 2, 3]", "[1, 2, 3]", "6 entries"),
    ]);
    let error = refused(&PLANE.replace(PRESSURE, "pressure_pa = 1e5\ntraction_pa = [0, 1]"));
    assert!(
        error.value().contains("`pressure_pa` beside `traction_pa`"),
        "{error}"
    );
    // An escape moves the columns: the whole value is marked.
    let error = refused(&PLANE.replace(WHERE, "where = \"\\u0078 <= 1 and w > 2\""));
    assert_eq!((error.column(), error.value()), (9, "w"), "{error}");
}

#[test]
fn expectations_no_run_can_meet_are_refused() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("friction = 0.8\n", "friction = 0.3\n", "0.3", "one of 0.1, 0.8"),
        ("refine = 3\n", "refine = 2\n", "2", "one of 1, 3"),
        ("increment = 2\n", "increment = 5\n", "5", "from 1 to 4"),
        ("at = \"top\"", "at = \"P9\"", "\"P9\"", "left, right, bottom, top, crack-1, centre"),
        ("component = \"y\"", "component = \"q\"", "\"q\"", "x, y, z, n, a, b"),
        ("value = -9.7e8", "value = 0", "0", "`absolute`"),
        ("kind = \"published\"", "kind = \"guess\"", "\"guess\"", "analytic, published, independent, snapshot"),
        ("name = \"centre\"", "name = \"crack-1\"", "\"crack-1\"", "other than left, right, bottom, top, crack-1"),
    ]);
    let own = PLANE.replace("friction = [0.1, 0.8]\n", "");
    assert_eq!(refused(&own).allowed(), "one of 0.1");
    accepted(&own.replace("friction = 0.8\n", "friction = 0.1\n"));
}
