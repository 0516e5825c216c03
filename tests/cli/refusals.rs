//! Faults that only the discretisation can find: refused with file, line and column, exit code 2, and nothing written.

use crate::common::*;
use stickslip::model::body::BodyError;

const POINTS: &str = "[[-0.45, 0.23], [0.68, 0.31]]";
const MESH: &str = "mesh = { box";
const BOTTOM: &str = "displacement_m = [0, 0]";
const HELD: &str = "[[support]]\non = \"bottom\"\ndisplacement_m = [0, 0]\n[[support]]\non = \"top\"\ndisplacement_m = [1e-3, -1e-3]\n";
const ROLLER: &str = "[[support]]\non = \"bottom\"\ndisplacement_m = [\"free\", 0]\n";
const CORNER: &str = "[[support]]\non = [\"left\", \"bottom\"]\ndisplacement_m = [0, 0]\n";
const SPACE: &str = "tip = \"branch\"\ncontact = \"edge-pairs\"";
const THROUGH: &str = "[[-2, 0.23], [2, 0.31]]";

/// A good case; every fault below changes one thing in it.
fn good() -> String {
    let rest = crack([-0.45, 0.23], [0.68, 0.31], 0.3, "branch")
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[1e-3, -1e-3]");
    plane([-1.0, -1.0], [1.0, 1.0], [8, 8], &rest)
}

/// The good case with one text in place of another; an empty one stands for the end.
fn replaced(from: &str, to: &str) -> String {
    let text = good();
    if from.is_empty() {
        return text + to;
    }
    assert_eq!(text.matches(from).count(), 1, "`{from}` must occur once");
    text.replace(from, to)
}

/// A solid cube with a plane at a height.
fn cube(height: f64, rest: &str) -> String {
    let plane = ([0.0, 0.0, height], [0.0, 0.0, 1.0], 0.1);
    let held = support("\"bottom\"", "[0, 0, 0]");
    solid([1.0, 1.0, 1.0], [2, 2, 2], &[plane], &(held + rest))
}

/// A plate with a sloping crack from side to side, which ends on its sides.
fn parted(rest: &str) -> String {
    let both = support("\"bottom\"", "[0, 0]") + &support("\"top\"", "[1e-3, -1e-3]");
    let rest = crack([-2.0, 0.5], [2.0, -0.5], 0.3, "none") + &both + rest;
    plane([-1.0, -1.0], [1.0, 1.0], [8, 8], &rest)
}

/// Line and column, from 1, of the first occurrence of a mark.
fn place(text: &str, mark: &str) -> (usize, usize) {
    let at = text.find(mark);
    let before = &text[..at.unwrap_or_else(|| panic!("no {mark} in {text}"))];
    let line = before.matches('\n').count() + 1;
    (
        line,
        before.len() - before.rfind('\n').map_or(0, |n| n + 1) + 1,
    )
}

/// Demands that `check` and `run` end with 2, say where, and write nothing.
fn assert_code_2(text: &str, words: &str) {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("bad.toml"), text).unwrap();
    for verb in [&["check", "bad.toml"][..], &["run", "bad.toml"]] {
        let (shown, complaints) = ends_with(2, verb, dir.path());
        let told = complaints.starts_with("error: bad.toml:") && complaints.contains(words);
        assert!(told && shown.is_empty(), "{verb:?}: {shown}{complaints}");
    }
    assert_eq!(files(dir.path()).len(), 1, "{words}: written");
}

/// Demands a refusal of the body at a mark, by the library and by `check` and `run`; nothing is written.
fn assert_refused(text: &str, mark: &str, words: &str) {
    let error = match try_body(text) {
        Ok(_) => panic!("accepted, `{words}` expected:\n{text}"),
        Err(BodyError::Case(error)) => error,
        Err(other) => panic!("no position: {other}\n{text}"),
    };
    let (line, column) = place(text, mark);
    assert_eq!((error.line(), error.column()), (line, column), "{error}");
    assert!(error.to_string().contains(words), "{error}");
    assert!(!error.allowed().is_empty() && !error.value().is_empty());
    assert_code_2(text, &format!("bad.toml:{line}:{column}: "));
}

fn assert_accepted(text: &str) {
    assert!(try_body(text).is_ok(), "{text}");
}

#[test]
fn cracks_that_the_mesh_cannot_have_are_refused() {
    let short = "[[0.05, 0.05], [0.2, 0.1]]";
    #[rustfmt::skip]
    let rows = [
        (POINTS, "[[2, 0.2], [3, 0.3]]", "[[2, 0.2]", "outside the mesh"),
        (POINTS, "[[-0.4, 1.2], [0.7, 1.3]]", "[[-0.4, 1.2]", "outside the mesh"),
        (POINTS, "[[-3, -4], [3, -4]]", "[[-3, -4]", "outside the mesh"),
        (POINTS, short, short, "too short"),
        // Node pairs are for one crack from node to node.
        ("\"edge-pairs\"", "\"node-pairs\"", "\"node-pairs\"", "does not follow cell facets"),
    ];
    for (from, to, mark, words) in rows {
        let text =
            replaced(from, to).replace("tip = \"branch\"\ncontact = \"node", "contact = \"node");
        assert_refused(&text, mark, words);
    }
    assert_refused(
        &replaced(POINTS, short).replace("\"branch\"", "\"none\""),
        short,
        "too short",
    );
    assert_refused(
        &cube(7.0, ""),
        "{ point_m = [0.0, 0.0, 7.0]",
        "outside the mesh",
    );
    let one = replaced(POINTS, "[[-0.4, 0.2], [0.6, 0.3]]");
    let along = "[[-0.2, 0.22000001], [0.4, 0.28000001]]";
    let second = format!("[[crack]]\npoints_m = {along}\nfriction = 0.1\n");
    assert_refused(&(one + &second), along, "run along each other");
    // A tip close to a crack, in a cell that it cuts, ends at the border of that cell.
    let second = "[[crack]]\npoints_m = [[0.05, -0.6], [0.1, 0.26]]\nfriction = 0.1\n";
    let body = body(&replaced("", second));
    assert!(body.suspect(0.0).is_none() && body.checks.uniform < 1e-12);

    let along = replaced(POINTS, "[[-0.5, 0.25], [0.5, 0.25]]");
    let pairs = along.replace(SPACE, "contact = \"node-pairs\"");
    assert_accepted(&pairs);
    for other in ["0.6, 0.25]]", "0.5, 0.25], [0.5, 0.5]]"] {
        let text = pairs.replace("0.5, 0.25]]", other);
        assert_refused(&text, "\"node-pairs\"", "does not follow cell facets");
    }
    let second = "[[crack]]\npoints_m = [[-0.4, -0.5], [0.6, -0.3]]\nfriction = 0.1\n";
    assert_refused(&(pairs + second), "\"node-pairs\"", "alone in its body");
}

/// Source: random cases. Goal: where the functions of cracks are dependent (two Gauss points see nothing of a sliver), `check` and `run`
/// refuse, at a place and with a cell.
#[test]
fn stiffnesses_that_do_not_part_cracks_are_refused() {
    let text = "title = \"near\"\nmodel = \"solid\"\nquadrature = \"gauss-2\"\n\
        material = { young_pa = 1e11, poisson = 0.45 }\n\
        mesh.box = { min_m = [0, -5, 0], max_m = [8, 5, 0.0997], cells = [4, 5, 2] }\n\
        [[crack]]\ndisc = { centre_m = [5.03564, 0.550689, 0.072657], normal = [1.431, 0.866, 0.029], radius_m = 9.3 }\n\
        friction = 0.3\n[[crack]]\n\
        plane = { point_m = [4.743419, 0.295, 0.05], normal = [-1.024, -2.733, -1.063] }\nfriction = 0.1\n\
        [[support]]\non = \"front\"\ndisplacement_m = [0, 0, 0]\n[[load]]\non = \"back\"\npressure_pa = 1e6\n";
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("near.toml"), text).unwrap();
    for verb in ["check", "run"] {
        let (shown, complaints) = ends_with(2, &[verb, "near.toml"], dir.path());
        assert!(shown.is_empty() && complaints.starts_with("error: near.toml:"));
        for words in ["does not tell how", ", near [", "or cells of at most"] {
            assert!(complaints.contains(words), "{complaints}");
        }
    }
    assert_eq!(files(dir.path()).len(), 1);
}

#[test]
fn motions_that_nothing_holds_are_refused() {
    // None at all: there is no support to point at. A roller: free to slide; a corner: free to turn.
    assert_refused(&replaced(HELD, ""), "{ box", "rigid motion");
    assert_refused(&replaced(HELD, ROLLER), "[[support]]", "rigid motion");
    assert_refused(&replaced(HELD, CORNER), "[[support]]", "rigid motion");
    assert_accepted(&replaced(HELD, &(ROLLER.to_owned() + CORNER)));
    // Both parts roll along a straight crack: no jump resists it.
    let text = replaced(BOTTOM, "displacement_m = [\"free\", 0]")
        .replace("[1e-3, -1e-3]", "[\"free\", -1e-3]");
    assert_refused(
        &text.replace(POINTS, "[[-2, 0.23], [2, 0.23]]"),
        "[[support]]",
        "rigid motion",
    );
    // A piece that contact alone holds.
    let text = replaced(
        "[[support]]\non = \"top\"\ndisplacement_m = [1e-3, -1e-3]\n",
        "",
    );
    assert_eq!(
        body(&text.replace(POINTS, THROUGH))
            .elastic
            .floating()
            .len(),
        3
    );
}

#[test]
fn supports_loads_and_probes_on_nothing_are_refused() {
    #[rustfmt::skip]
    let rows = [
        ("[[load]]\non = \"left\"\nwhere = \"y > 1.3 and y < 1.4\"\npressure_pa = 1\n", "\"left\"", "holds no cell facet"),
        ("[[support]]\non = \"left\"\nwhere = \"y > 0.3 and y < 0.4\"\ndisplacement_m = [0, 0]\n", "\"left\"", "holds nothing"),
        ("[[probe]]\nname = \"here\"\npoint_m = [0.3, 0.3]\n", "[[probe]]", "node"),
        // A crack that ends inside parts nothing, so a load cannot tell its sides apart.
        ("[[load]]\nbody_n_per_m3 = [0, 4]\ncrack_side = 2\n", "2\n", "ends inside"),
    ];
    for (rest, mark, words) in rows {
        assert_refused(&replaced("", rest), mark, words);
    }
    let side = "[[load]]\nbody_n_per_m3 = [0, 4]\ncrack_side = 2\n";
    assert_accepted(&(replaced(POINTS, THROUGH) + side));
    let edge = "[[load]]\non = [\"back\", \"top\"]\nwhere = \"x == 0.6 or x > 1\"\nline_n_per_m = [0, 0, 1]\n";
    assert_refused(
        &cube(0.3, edge),
        "[\"back\", \"top\"]",
        "holds no cell edge",
    );
    let through = crack([-2.0, 0.0], [2.0, 0.0], 0.3, "none") + &clamped(2);
    let probe = through + "[[probe]]\nname = \"P\"\npoint_m = [0, 0]\n";
    assert_refused(
        &plane([-1.0, -1.0], [1.0, 1.0], [8, 8], &probe),
        "[[probe]]",
        "lies on a crack",
    );
}

/// Goal: a support in a point of a crack says which lip it holds; where the region tells, the key has no meaning.
#[test]
fn supports_that_do_not_tell_lips_apart_are_refused() {
    let lone =
        "[[support]]\non = \"left\" # here\nwhere = \"y == 0.25\"\ndisplacement_m = [0, 0]\n";
    assert_refused(&parted(lone), "\"left\" # here", "two lips part");
    assert_accepted(&parted(&format!("{lone}crack_side = 1\n")));
    let other = lone.replace("y == 0.25", "y >= 0.25") + "crack_side = 2 # key\n";
    assert_refused(&parted(&other), "2 # key", "the region tells itself");
    let lips = "[[support]]\non = \"left\"\nwhere = \"y >= 0.25\"\ndisplacement_m = [0, \"free\"]\n\
                [[support]]\non = \"left\" # here\nwhere = \"y <= 0.25\"\ndisplacement_m = [\"free\", 0]\n";
    assert_refused(&parted(lips), "\"left\" # here", "in other components");
    let load = "[[load]]\non = \"right\" # here\nwhere = \"y == 0.25\"\npressure_pa = 1\n";
    assert_refused(&parted(load), "\"right\" # here", "holds no cell facet");
}

/// Goal: a motion of the grid that folds a cell is refused at the table that asks for it, not at another one.
#[test]
fn folded_meshes_are_refused_at_what_folds_them() {
    let with = |motion: &str| replaced(MESH, &format!("mesh = {{ {motion}, box"));
    let distort = "distort = { amplitude = 0.49, seed = 4 }";
    for (motion, mark) in [
        ("twist = { angle_deg = 179 }", "{ angle_deg"),
        (distort, "{ amplitude"),
        (
            &format!("{distort}, twist = {{ angle_deg = 10 }}"),
            "{ amplitude",
        ),
    ] {
        assert_refused(&with(motion), mark, "fold the cell");
    }
    assert_accepted(&with(
        "distort = { amplitude = 0.2, seed = 4 }, twist = { angle_deg = 30 }",
    ));
    let follow = |angle: &str| {
        let line =
            format!("follow = {{ point_m = [0, 0], angle_deg = {angle}, half_length_m = 0.97 }}");
        with(&line).replace("cells = [8, 8]", "cells = [8, 9]")
    };
    let error = stickslip::case::parse("t.toml", follow("45")).unwrap_err();
    assert_eq!(
        (error.line(), error.column()),
        place(&follow("45"), "45, half"),
        "{error}"
    );
    // Just within the body: thin cells, but cells.
    assert_accepted(&follow("42"));
}

#[test]
fn methods_and_expectations_that_no_run_has_are_refused() {
    for (method, words) in [
        ("name = \"penalty\"\nnormal = -3\n", "normal"),
        ("name = \"penalty\"\nnormel = 3\n", "normel"),
        ("name = \"newton\"\n", "unknown method"),
    ] {
        assert_code_2(&replaced("", &format!("[[method]]\n{method}")), words);
    }
    for (quantity, at, unit, words) in [
        ("reactions", "top", "N/m", "unknown quantity"),
        ("reaction", "left", "N/m", "`at`"),
        ("reaction", "top", "N", "`unit`"),
    ] {
        let text = replaced(
            "",
            &format!(
                "[[expect]]\nquantity = \"{quantity}\"\nat = \"{at}\"\ncomponent = \"y\"\nvalue = 1\nunit = \"{unit}\"\n\
                 relative = 1e-3\nkind = \"analytic\"\nsource = \"none\"\n"
            ),
        );
        let error = stickslip::studies::expect::check(&parse(&text)).expect_err("no run has it");
        assert_eq!(
            (error.line(), error.column()),
            place(&text, "[[expect]]"),
            "{error}"
        );
        assert!(error.to_string().contains(words), "{error}");
    }
}
