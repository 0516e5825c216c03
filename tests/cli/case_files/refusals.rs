//! Faults a reader of the file can see: each is refused at its line and column, with the value and what is allowed.

use super::{PLANE, SOLID, accepted, place, refused};

/// One fault: the text replaced, its replacement, the place of the fault in it with the value shown, what is allowed.
type Fault = (&'static str, &'static str, &'static str, &'static str);

pub fn assert_refused(text: &str, faults: &[Fault]) {
    for (from, to, mark, allowed) in faults {
        assert_refused_at(text, from, to, mark, mark, allowed);
    }
}

/// Replaces `from` in `text` by `to` and demands a refusal at the first `mark` in it, naming `value` and `allowed`.
fn assert_refused_at(text: &str, from: &str, to: &str, mark: &str, value: &str, allowed: &str) {
    assert_eq!(text.matches(from).count(), 1, "`{from}` must occur once");
    let bad = text.replace(from, to);
    let at = text.find(from).unwrap() + to.find(mark).expect("mark inside the replacement");
    let error = refused(&bad);
    let shown = error.to_string();
    assert_eq!(
        (error.line(), error.column()),
        place(&bad, at),
        "{to}\n{shown}"
    );
    let start = format!("bad.toml:{}:{}: ", error.line(), error.column());
    assert!(shown.starts_with(&start), "{shown}");
    assert_eq!(error.value(), value, "{shown}");
    assert!(
        error.allowed().contains(allowed),
        "allowed `{allowed}` missing in\n{shown}"
    );
    let end = format!("got {}, allowed: {}\n", error.value(), error.allowed());
    assert!(shown.contains(&end), "{shown}");
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
        ("pressure_pa = 1e5", "pressure = 1e5", "pressure", "pressure_pa"),
        ("end = 2.0", "stop = 2.0", "stop", "increments, end"),
        ("refine = [1, 3]", "mesh = [1, 3]", "mesh", "friction, refine"),
        ("name = \"centre\"", "label = \"centre\"", "label", "name, point_m"),
        ("unit = \"N/m\"", "units = \"N/m\"", "units", "unit"),
    ]);
    let error = refused(&PLANE.replace("young_pa", "yuong_pa"));
    assert!(
        error.message().contains("did you mean `young_pa`"),
        "{error}"
    );
    let error = refused(&SOLID.replace("young_pa = 1", "young_pa = 1, density = 2"));
    assert_eq!(error.key(), "material.density");
}

/// Goal: no product of the numbers of a case vanishes or overflows; `1e-400` is not taken for 0.
#[test]
fn numbers_whose_products_vanish_or_overflow_are_refused() {
    for bad in [
        "1e-300", "9.9e-26", "2e25", "1e-320", "1e-400", "0.5e-999", "1e300",
    ] {
        let negative = format!("-{bad}");
        for (from, to, mark) in [
            ("young_pa = 1e10", format!("young_pa = {bad}"), bad),
            ("pressure_pa = 1e5", format!("pressure_pa = {bad}"), bad),
            (
                "[\"free\", -0.1]",
                format!("[\"free\", -{bad}]"),
                &*negative,
            ),
            ("[[-4, -4], [4, 4]]", format!("[[-4, {bad}], [4, 4]]"), bad),
        ] {
            let allowed = if mark == "1e-400" || !to.starts_with("young") {
                ""
            } else {
                "young_pa > 0"
            };
            assert_refused_at(PLANE, from, &to, mark, mark, allowed);
        }
    }
    for good in ["1e-25", "1e25", "0e-400", "0.0"] {
        accepted(&PLANE.replace("pressure_pa = 1e5", &format!("pressure_pa = {good}")));
    }
}

/// Goal: what names something commands neither the terminal nor the spreadsheet that shows it.
#[test]
fn labels_that_are_commands_are_refused() {
    for bad in [
        "=1+1",
        "+A1",
        "-A1",
        "@SUM(A1)",
        " =1+1",
        "a\\u001b[31m",
        "a\\u202eb",
        "a\\tb",
    ] {
        for (from, key) in [
            ("title = \"Plate\"", "title"),
            ("name = \"centre\"", "name"),
        ] {
            let to = format!("{key} = \"{bad}\"");
            let mark = format!("\"{bad}\"");
            assert_refused_at(
                PLANE,
                from,
                &to,
                &mark,
                &mark,
                "does not begin like a formula",
            );
        }
    }
}

#[test]
fn every_allowed_key_is_documented() {
    let document = include_str!("../../../docs/case-format.md");
    let mut count = 0;
    for (table, prefix) in [
        ("title = ", ""),
        ("young_pa", ""),
        ("min_m", "box."),
        ("angle_deg", "follow."),
        ("points_m", ""),
        ("displacement_m = [0, 0]", ""),
        ("pressure_pa", ""),
        ("increments", ""),
        ("refine = [", ""),
        ("point_m = [0, 0]\n\n[[expect", ""),
        ("quantity", ""),
    ] {
        assert_eq!(PLANE.matches(table).count(), 1, "`{table}` must occur once");
        let error = refused(&PLANE.replace(table, &format!("bad = 0\n{table}")));
        for key in error.allowed().split(", ") {
            // A key that holds a table is documented by the keys inside it.
            let named = ["` |", "."]
                .iter()
                .any(|e| document.contains(&format!("| `{prefix}{key}{e}")));
            assert!(named, "`{prefix}{key}` is not documented");
            count += 1;
        }
    }
    assert_eq!(count, 16 + 3 + 3 + 3 + 8 + 5 + 9 + 2 + 2 + 2 + 15);
}

#[test]
fn missing_keys_are_refused_at_their_table() {
    for (line, key, table) in [
        ("title = \"Plate\"\n", "title", "title"),
        ("model = \"plane-strain\"\n", "model", "title"),
        ("young_pa = 1e10\n", "young_pa", "[material]"),
        ("max_m = [10, 10]\n", "max_m", "[mesh.box]"),
        ("friction = 0.1\n", "friction", "[[crack]]"),
        ("displacement_m = [0, 0]\n", "displacement_m", "[[support]]"),
        ("pressure_pa = 1e5\n", "traction_pa", "[[load]]"),
        ("name = \"b-newton\"\n", "name", "[[method]]"),
        ("unit = \"N/m\"\n", "unit", "[[expect]]"),
        ("relative = 1e-3\n", "absolute", "[[expect]]"),
    ] {
        assert_eq!(PLANE.matches(line).count(), 1, "`{line}` must occur once");
        let bad = PLANE.replace(line, "");
        let error = refused(&bad);
        assert!(error.message().starts_with("missing"), "{error}");
        assert!(error.allowed().contains(&format!("`{key}`")), "{error}");
        assert_eq!(error.value(), "nothing");
        let at = bad.find(table).unwrap_or(0);
        assert_eq!((error.line(), error.column()), place(&bad, at), "{error}");
    }
    let error = refused("");
    assert_eq!((error.line(), error.column()), (1, 1), "{error}");
}

#[test]
fn wrong_types_are_refused_where_they_stand() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("young_pa = 1e10", "young_pa = \"steel\"", "\"steel\"", "young_pa > 0"),
        ("poisson = 0.3", "poisson = [0.3]", "[0.3]", "0 <= poisson < 0.5"),
        ("title = \"Plate\"", "title = 7", "7", "a string"),
        ("increments = 4", "increments = 4.5", "4.5", "integers from 1 to 10000"),
        ("cells = [22, 23]", "cells = [22, true]", "true", "integers from 1"),
        ("cells = [22, 23]", "cells = [22, 23, 1]", "[22, 23, 1]", "2 entries"),
        ("angle_deg = 45", "angle_deg = 2020-01-01", "2020-01-01", "-80 < angle_deg < 80"),
        ("max_m = [10, 10]", "max_m = 10", "10", "an array"),
        ("[\"free\", -0.1]", "[\"fixed\", 0]", "fixed", "\"free\""),
        ("max_iterations = 50", "max_iterations = \"many\"", "\"many\"", "finite numbers"),
        ("[[probe]]", "[probe]", "[probe]", "[[probe]]"),
        ("[\"plane strain\"]", "[3]", "3", "a string"),
    ]);
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
        ("increments = 4", "increments = 0", "0", "integers from 1 to 10000"),
        ("increments = 4", "increments = -3", "-3", "integers from 1 to 10000"),
        ("increments = 4", "increments = 10001", "10001", "integers from 1 to 10000"),
        ("increments = 4", "increments = 99999999999999999999", "99999999999999999999", "integers from 1"),
        ("end = 2.0", "end = 0.0", "0.0", "end > 0"),
        ("angle_deg = 45", "angle_deg = -80", "-80", "-80 < angle_deg < 80"),
        ("relative = 1e-3", "relative = 0", "0", "> 0"),
        ("relative = 1e-3", "absolute = -1", "-1", "> 0"),
        ("refine = [1, 3]", "refine = [1, 0]", "0", "integers from 1"),
        ("refine = [1, 3]", "refine = [1, 500]", "500", "at most 20000000 cells"),
        ("refine = [1, 3]", "refine = []", "[]", "at least one value"),
    ]);
}

#[test]
fn dilatations_are_refused_where_they_make_no_sense() {
    let with = |value: &str| {
        PLANE.replace(
            "poisson = 0.3",
            &format!("poisson = 0.3\ndilatation = {value}"),
        )
    };
    for (text, allowed) in [
        (with("\"half\""), "mean, full"),
        (with("1"), "a string"),
        (
            with("\"mean\"").replace("plane-strain", "plane-stress"),
            "full",
        ),
    ] {
        let error = refused(&text);
        assert_eq!(
            (error.key(), error.allowed()),
            ("material.dilatation", allowed),
            "{error}"
        );
        let at = text.find("dilatation = ").unwrap() + "dilatation = ".len();
        assert_eq!((error.line(), error.column()), place(&text, at), "{error}");
    }
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let spots = [
        ("young_pa = ", "1e10"),
        ("poisson = ", "0.3"),
        ("[mesh.follow]\npoint_m = [0, ", "0]"),
        ("max_m = [10, ", "10]"),
        ("points_m = [[-4, -4], [4, ", "4]]"),
        ("[\"free\", ", "-0.1]"),
        ("pressure_pa = ", "1e5"),
        ("body_n_per_m3 = [0, ", "-1e4]"),
        ("history = [[0, 0], [1, ", "2.5]]"),
        ("history = [[0, 0], [", "1, 2.5]]"),
        ("end = ", "2.0"),
        ("friction = ", "0.1\n"),
        ("friction = [0.1, ", "0.8]"),
        ("max_iterations = ", "50"),
        ("value = ", "-9.7e8"),
        ("relative = ", "1e-3"),
    ];
    for (start, end) in spots {
        for number in ["nan", "-nan", "inf", "-inf", "+inf", "1e999"] {
            let from = format!("{start}{end}");
            let digits = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-');
            let to = format!("{start}{number}{}", end.trim_start_matches(digits));
            assert_refused_at(PLANE, &from, &to, number, number, "");
            let error = refused(&PLANE.replace(&from, &to));
            assert_eq!(error.message(), "not a finite number", "{error}");
        }
    }
}

#[test]
fn empty_meshes_are_refused() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("cells = [22, 23]", "cells = [22, 0]", "0", "integers from 1"),
        ("cells = [22, 23]", "cells = [20000, 2000]", "[20000, 2000]", "at most 20000000 cells"),
        ("max_m = [10, 10]", "max_m = [10, -10]", "-10", "more than min_m = -10"),
        ("max_m = [10, 10]", "max_m = [10, -11]", "-11", "more than min_m = -10"),
    ]);
    let lines = "lines_m = [[0, 1], [0, 1, 2], [0, 0.5, 1]]";
    #[rustfmt::skip]
    assert_refused(SOLID, &[
        (lines, "lines_m = [[0, 1], [7], [0, 0.5, 1]]", "[7]", "at least 2 grid lines"),
        (lines, "lines_m = [[0, 1], [], [0, 0.5, 1]]", "[]", "at least 2 grid lines"),
        (lines, "lines_m = [[0, 1], [0, 1, 1.0], [0, 0.5, 1]]", "1.0", "more than 1"),
        (lines, "lines_m = [[0, 1], [0, 2, -3], [0, 0.5, 1]]", "-3", "more than 2"),
        (lines, "lines_m = [[0, 1], [0, 1]]", "[[0, 1], [0, 1]]", "3 entries"),
        (lines, "lines_m = []", "[]", "3 entries"),
        (lines, "box = { min_m = [0, 0, 0], max_m = [1, 1, 1], cells = [] }", "[]", "3 entries"),
    ]);
    let error = refused(&SOLID.replace(lines, ""));
    assert_eq!((error.line(), error.column()), (5, 1), "{error}");
    assert!(error.allowed().contains("`box`, `lines_m`"), "{error}");
}

#[test]
fn cells_without_width_are_refused() {
    let thin = PLANE.replace("max_m = [10, 10]", "max_m = [10, -9.999999999999998]");
    let error = refused(&thin);
    assert_eq!(
        (error.line(), error.key()),
        (13, "mesh.box.cells"),
        "{error}"
    );
    let lines = SOLID.replace("[0, 0.5, 1]]", "[0, 0.5, 0.5000000000000001]]");
    assert_eq!(refused(&lines).key(), "mesh.lines_m[3][3]");
    let refined =
        SOLID.replace("[0, 0.5, 1]]", "[0, 1, 1.00000000000002]]") + "[sweep]\nrefine = [2]\n";
    assert_eq!(refused(&refined).key(), "sweep.refine[1]");
    // Runs that differ in nothing.
    let whole = "title = \"t\"\nmodel = \"plane-strain\"\nmaterial = { young_pa = 1, poisson = 0 }\n\
                 mesh = { box = { min_m = [0, 0], max_m = [1, 1], cells = [2, 2] } }\nsweep = { friction = [0, 1] }\n";
    assert_eq!(refused(whole).message(), "friction of no crack");
}

#[test]
fn grid_lines_that_leave_the_body_are_refused() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("angle_deg = 45", "angle_deg = 70", "70", "shifts between"),
        ("half_length_m = 5.5", "half_length_m = 10", "10", "half_length_m < 10"),
        ("half_length_m = 5.5", "half_length_m = 0", "0", "0 < half_length_m"),
        ("[mesh.follow]\npoint_m = [0, 0]", "[mesh.follow]\npoint_m = [0, 10]", "10", "inside the body"),
    ]);
    // 5.5 m · tan 59° = 9.15 m is less than the 9.57 m between the row and the side; tan 61° is more.
    accepted(&PLANE.replace("angle_deg = 45", "angle_deg = -59"));
    assert_eq!(
        refused(&PLANE.replace("angle_deg = 45", "angle_deg = -61")).key(),
        "mesh.follow.angle_deg"
    );
    // 5 m below or above the middle there is room for one of the two shifts only.
    let low = PLANE.replace(
        "[mesh.follow]\npoint_m = [0, 0]",
        "[mesh.follow]\npoint_m = [0, -5]",
    );
    let high = low.replace("point_m = [0, -5]", "point_m = [0, 5]");
    for text in [low, high] {
        accepted(&text.replace("half_length_m = 5.5", "half_length_m = 4"));
        assert_eq!(refused(&text).key(), "mesh.follow.angle_deg");
    }
    // From side to side the line rises 20 m.
    assert_eq!(
        refused(&PLANE.replace("half_length_m = 5.5\n", "")).key(),
        "mesh.follow.angle_deg"
    );
}

#[test]
fn contradictions_are_refused() {
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        ("[\"left\", \"top\"]", "[\"left\", \"right\"]", "\"right\"", "meet in an edge"),
        ("[\"left\", \"top\"]", "[]", "[]", "1 to 2 sides"),
        ("[\"left\", \"top\"]", "\"front\"", "\"front\"", "left, right, bottom, top"),
        ("\"left\"\npressure", "[\"left\", \"top\"]\npressure", "[\"left\", \"top\"]", "exactly one side"),
        ("[[-4, -4], [4, 4]]", "[[4, 4], [4, 4.0]]", "[4, 4.0]", "distinct"),
        ("points_m = [[-4, -4], [4, 4]]", "plane = { normal = [1, 0] }", "{ normal = [1, 0] }", "points_m"),
        ("body_n_per_m3 = [0, -1e4]", "line_n_per_m = [1, 2]", "[1, 2]", "in 2D"),
        ("body_n_per_m3 = [0, -1e4]", "body_n_per_m3 = [0, 1]\non = \"top\"", "\"top\"", "neither"),
        ("body_n_per_m3 = [0, -1e4]", "body_n_per_m3 = [0, 0, 1]", "[0, 0, 1]", "2 entries"),
        ("[\"free\", -0.1]", "[\"free\", \"free\"]", "[\"free\", \"free\"]", "at least one number"),
        ("[[0, 0], [1, 2.5]]", "[[0, 1], [-0.5, 2.5]]", "-0.5", "t > 0"),
        ("[[0, 0], [1, 2.5]]", "\"sine\"", "\"sine\"", "ramp, constant"),
        ("[[0, 0], [1, 2.5]]", "[]", "[]", "at least one point"),
        ("[[0, 0], [1, 2.5]]", "[[3]]", "[3]", "2 entries"),
        ("quadrature = \"sub-cells\"", "quadrature = \"gauss-17\"", "\"gauss-17\"", "from 2 to 16"),
        ("title = \"Plate\"", "title = \"\"", "\"\"", "one line"),
        ("tier = \"mid\"", "tier = \"best\"", "\"best\"", "low, mid, high"),
        ("friction = [0.1, 0.8]", "friction = [0.8, 0.80]", "0.80", "each value once"),
    ]);
    #[rustfmt::skip]
    assert_refused(SOLID, &[
        ("normal = [0, 3, 4]", "normal = [0, 0.0, 0]", "[0, 0.0, 0]", "not zero"),
        ("on = [\"back\", \"top\"]", "on = \"top\"", "\"top\"", "two sides"),
        ("on = [\"back\", \"top\"]", "on = [\"back\", \"front\"]", "\"front\"", "meet in an edge"),
        ("friction = 0", "friction = 0\ntip = \"branch\"", "\"branch\"", "none"),
    ]);
    let error = refused(&PLANE.replace(
        "pressure_pa = 1e5",
        "pressure_pa = 1e5\ntraction_pa = [0, 1]",
    ));
    assert!(
        error.value().contains("`pressure_pa` beside `traction_pa`"),
        "{error}"
    );
    let twice = PLANE.replace("poisson = 0.3", "poisson = 0.3\npoisson = 0.2");
    let error = refused(&twice);
    assert_eq!((error.line(), error.column()), (9, 1), "{error}");
    assert!(error.message().contains("duplicate key"), "{error}");
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

#[test]
fn conditions_are_refused_at_the_column_inside_the_string() {
    let from = "where = \"x <= 1 and y > 2\"";
    #[rustfmt::skip]
    let rows = [
        ("where = \"x <= 1 and w > 2\"", "w >", "w", "x, y"),
        ("where = \"x <= 1 and z > 2\"", "z >", "z", "2D"),
        ("where = \"x <= 1 and y ! 2\"", "! 2", "!", "<="),
        ("where = 'x <= 1 xor y > 2'", "xor", "xor", "`and`"),
        ("where = \"x <= inf\"", "inf", "inf", "finite number"),
        ("where = \"\"\"\nx <= 1 or w > 2\"\"\"", "w >", "w", "x, y"),
        // An escape moves the columns: the whole value is marked.
        ("where = \"\\u0078 <= 1 and w > 2\"", "\"\\u0078", "w", "x, y"),
        ("where = \"\"", "\"\"", "\"\"", "x, y"),
    ];
    for (to, mark, value, allowed) in rows {
        assert_refused_at(PLANE, from, to, mark, value, allowed);
    }
}

#[test]
fn an_error_shows_the_line_with_the_value_underlined() {
    let shown = refused(&PLANE.replace("poisson = 0.3", "poisson = 0.75 # rubber")).to_string();
    let wanted = [
        "bad.toml:8:11: material.poisson: out of range: got 0.75, allowed: 0 <= poisson < 0.5",
        "    poisson = 0.75 # rubber",
        "              ^^^^",
    ];
    assert_eq!(shown, wanted.join("\n"));
}

#[test]
fn columns_count_characters() {
    let error = refused(&PLANE.replace("\"plane strain\"", "\"Häuser, ü\", 3"));
    assert_eq!(error.column(), 29, "{error}");
    let caret = format!("\n    {}^", " ".repeat(28));
    assert!(error.to_string().ends_with(&caret), "{error}");
}

#[test]
fn errors_found_after_parsing_point_into_the_file() {
    let case = accepted(PLANE);
    let span = &case.cracks[0].geometry_span;
    let error = case.error(
        span,
        "x from 40 to 48",
        "points in the box",
        "crack wholly outside",
    );
    let at = PLANE.find("[[-4, -4]").unwrap();
    assert_eq!((error.line(), error.column()), place(PLANE, at));
    assert_eq!(error.key(), "crack[1].points_m");
    let wanted = "plate.toml:21:12: crack[1].points_m: crack wholly outside: got x from 40 to 48, allowed: points in the box\n";
    assert!(error.to_string().starts_with(wanted), "{error}");
}

#[test]
fn motions_of_the_grid_are_read_and_refused_at_their_place() {
    let cells = "cells = [22, 23]";
    let with = |tables: &str| PLANE.replace(cells, &format!("{cells}\n\n{tables}"));
    let mesh = accepted(&with(
        "[mesh.twist]\nangle_deg = -30\n\n[mesh.distort]\namplitude = 0.25\nseed = 7",
    ))
    .mesh
    .grid;
    let (twist, distort) = (mesh.twist.unwrap(), mesh.distort.unwrap());
    assert_eq!(twist.angle, -30f64.to_radians());
    assert_eq!((distort.amplitude, distort.seed), (0.25, 7));
    let mesh = accepted(&with("[mesh.distort]\namplitude = 0.25"))
        .mesh
        .grid;
    assert_eq!(mesh.distort.unwrap().seed, 1);
    assert!(mesh.twist.is_none());
    #[rustfmt::skip]
    let rows = [
        ("[mesh.twist]\nangle_deg = 180", "180", "-180 < angle_deg < 180"),
        ("[mesh.twist]\nangle_deg = nan", "nan", "-180 < angle_deg < 180"),
        ("[mesh.twist]\nangle = 20", "angle", "angle_deg"),
        ("[mesh.distort]\namplitude = 0.5", "0.5", "0 <= amplitude < 0.5"),
        ("[mesh.distort]\namplitude = -0.1", "-0.1", "0 <= amplitude < 0.5"),
        ("[mesh.distort]\namplitude = 0.1\nseed = -1", "-1", "integers from 0"),
        ("[mesh.distort]\namplitude = 0.1\nseed = 4294967296", "4294967296", "integers from 0"),
        ("[mesh.distort]\namplitude = 0.1\nseeds = 4", "seeds", "amplitude, seed"),
    ];
    for (table, mark, allowed) in rows {
        let to = format!("{cells}\n\n{table}");
        assert_refused_at(PLANE, cells, &to, mark, mark, allowed);
    }
    for (table, key) in [
        ("[mesh.twist]", "angle_deg"),
        ("[mesh.distort]", "amplitude"),
    ] {
        let error = refused(&with(table));
        assert_eq!(error.message(), format!("missing `{key}`"), "{error}");
    }
    for motion in ["twist = { angle_deg = 3 }", "distort = { amplitude = 0.1 }"] {
        let error = refused(&SOLID.replace("[mesh]\n", &format!("[mesh]\n{motion}\n")));
        assert_eq!(error.allowed(), "a 2D model", "{error}");
    }
    let document = include_str!("../../../docs/case-format.md");
    for key in refused(&PLANE.replace("[mesh.box]", "[mesh.bad]"))
        .allowed()
        .split(", ")
    {
        let named = document.contains(&format!("| `{key}` |"));
        assert!(named || document.contains(&format!("| `{key}.")), "{key}");
    }
}
