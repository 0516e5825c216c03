//! What only the discretisation can find wrong: refused with file, line and column, exit code 2, and nothing written.

use crate::common::*;
use stickslip::model::body::BodyError;

/// A good case; every fault below changes one thing in it.
fn good() -> String {
    let rest = crack([-0.45, 0.23], [0.68, 0.31], 0.3, "branch")
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[1e-3, -1e-3]");
    plane([-1.0, -1.0], [1.0, 1.0], [8, 8], &rest)
}

/// Line and column, from 1, of the first occurrence of a mark.
fn place(text: &str, mark: &str) -> (usize, usize) {
    let at = text
        .find(mark)
        .unwrap_or_else(|| panic!("no {mark} in {text}"));
    let before = &text[..at];
    let line = before.matches('\n').count() + 1;
    (line, at - before.rfind('\n').map_or(0, |n| n + 1) + 1)
}

/// Demands that `check` and `run` end with 2, say where, and write nothing.
fn assert_code_2(text: &str, start: &str, words: &str) {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("bad.toml"), text).unwrap();
    for verb in [&["check", "bad.toml"][..], &["run", "bad.toml"]] {
        let (shown, complaints) = ends_with(2, verb, dir.path());
        let told = complaints.starts_with(start) && complaints.contains(words);
        assert!(told, "{verb:?}: {complaints}");
        assert!(shown.is_empty(), "{verb:?}: {shown}");
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
    let position = format!("bad.toml:{line}:{column}: ");
    assert_code_2(text, "error: ", &position);
}

fn replaced(from: &str, to: &str) -> String {
    let text = good();
    assert!(try_body(&text).is_ok(), "the good case is good");
    assert_eq!(text.matches(from).count(), 1, "`{from}` must occur once");
    text.replace(from, to)
}

const POINTS: &str = "[[-0.45, 0.23], [0.68, 0.31]]";

#[test]
fn a_crack_outside_the_mesh_is_refused() {
    for points in [
        "[[2, 0.2], [3, 0.3]]",
        "[[-0.4, 1.2], [0.7, 1.3]]",
        "[[-3, -4], [3, -4]]",
    ] {
        assert_refused(&replaced(POINTS, points), points, "outside the mesh");
    }
    let rest = support("\"bottom\"", "[0, 0, 0]");
    let plane = ([0.0, 0.0, 7.0], [0.0, 0.0, 1.0], 0.1);
    let text = solid([1.0, 1.0, 1.0], [2, 2, 2], &[plane], &rest);
    assert_refused(&text, "{ point_m = [0.0, 0.0, 7.0]", "outside the mesh");
}

#[test]
fn a_crack_too_short_for_the_mesh_is_refused() {
    for tip in ["branch", "none"] {
        let points = "[[0.05, 0.05], [0.2, 0.1]]";
        let text = replaced(POINTS, points).replace("\"branch\"", &format!("{tip:?}"));
        assert_refused(&text, points, "too short");
    }
}

#[test]
fn cracks_along_each_other_are_refused_at_the_later() {
    let [p, q] = [[-0.4, 0.2], [0.6, 0.3]];
    let one = format!("[{p:?}, {q:?}]");
    let points = "[[-0.2, 0.22000001], [0.4, 0.28000001]]";
    let second = format!("[[crack]]\npoints_m = {points}\nfriction = 0.1\n");
    assert_refused(
        &(replaced(POINTS, &one) + &second),
        points,
        "run along each other",
    );
    // A tip close to a crack, in a cell that it cuts, ends at the border of that cell.
    let points = "[[0.05, -0.6], [0.1, 0.26]]";
    let second = format!("[[crack]]\npoints_m = {points}\nfriction = 0.1\n");
    let body = try_body(&(good() + &second)).unwrap_or_else(|e| panic!("{e}"));
    assert!(body.suspect(0.0).is_none() && body.checks.uniform < 1e-12);
}

#[test]
fn node_pairs_are_for_one_crack_from_node_to_node() {
    let pairs = "\"node-pairs\"";
    let with = |points: &str, tip: &str| {
        let text = replaced(POINTS, points).replace("\"edge-pairs\"", pairs);
        text.replace("tip = \"branch\"", tip)
    };
    let along = "[[-0.5, 0.25], [0.5, 0.25]]";
    assert!(try_body(&with(along, "")).is_ok());
    for points in [
        POINTS,
        "[[-0.5, 0.25], [0.6, 0.25]]",
        "[[-0.5, 0.25], [0.5, 0.25], [0.5, 0.5]]",
    ] {
        assert_refused(&with(points, ""), pairs, "does not follow cell facets");
    }
    let second = "[[crack]]\npoints_m = [[-0.4, -0.5], [0.6, -0.3]]\nfriction = 0.1\n";
    assert_refused(&(with(along, "") + second), pairs, "alone in its body");
    // In any other space the same crack is a cut, with branch functions.
    let body = try_body(&replaced(POINTS, along)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(body.enrichment.tips.len(), 2);
}

#[test]
fn supports_that_leave_a_rigid_motion_are_refused() {
    let held = "[[support]]\non = \"bottom\"\ndisplacement_m = [0, 0]\n[[support]]\non = \"top\"\ndisplacement_m = [1e-3, -1e-3]\n";
    // None at all: there is no support to point at.
    assert_refused(&replaced(held, ""), "{ box", "rigid motion");
    // A roller: free to slide; a corner: free to turn.
    let roller = support("\"bottom\"", "[\"free\", 0]");
    assert_refused(&replaced(held, &roller), "[[support]]", "rigid motion");
    let corner = support("[\"left\", \"bottom\"]", "[0, 0]");
    assert_refused(&replaced(held, &corner), "[[support]]", "rigid motion");
    // Both together hold it.
    assert!(try_body(&replaced(held, &(roller + &corner))).is_ok());
}

#[test]
fn a_piece_that_contact_alone_holds_is_accepted() {
    let text = replaced(
        "[[support]]\non = \"top\"\ndisplacement_m = [1e-3, -1e-3]\n",
        "",
    );
    let points = "[[-2, 0.23], [2, 0.31]]";
    let body = try_body(&text.replace(POINTS, points)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(body.elastic.floating().len(), 3);
}

#[test]
fn a_motion_that_only_opens_no_crack_is_refused() {
    // The upper part may slide along a straight frictionless or frictional crack only if contact feels it: here it can
    // move along x without any jump being resisted, as both parts roll.
    let text = replaced("displacement_m = [0, 0]", "displacement_m = [\"free\", 0]");
    let text = text.replace(
        "displacement_m = [1e-3, -1e-3]",
        "displacement_m = [\"free\", -1e-3]",
    );
    assert_refused(
        &text.replace(POINTS, "[[-2, 0.23], [2, 0.23]]"),
        "[[support]]",
        "rigid motion",
    );
}

#[test]
fn a_load_on_no_facet_is_refused() {
    let region = "\"left\"\nwhere = \"y > 1.3 and y < 1.4\"";
    let load = format!("[[load]]\non = {region}\npressure_pa = 1\n");
    assert_refused(&(good() + &load), "\"left\"", "holds no cell facet");
    let rest = support("\"bottom\"", "[0, 0, 0]")
        + "[[load]]\non = [\"back\", \"top\"]\nwhere = \"x == 0.6 or x > 1\"\nline_n_per_m = [0, 0, 1]\n";
    let text = solid([1.0, 1.0, 1.0], [2, 2, 2], &[], &rest);
    assert_refused(&text, "[\"back\", \"top\"]", "holds no cell edge");
}

/// Goal: a crack that ends inside parts nothing, so a load cannot tell its sides apart.
#[test]
fn a_load_on_one_side_of_a_crack_with_a_tip_is_refused() {
    let load = "[[load]]\nbody_n_per_m3 = [0, 4]\ncrack_side = 2\n";
    for tip in ["branch", "none"] {
        let text = good().replace("\"branch\"", &format!("{tip:?}")) + load;
        assert_refused(&text, "2\n", "ends inside");
    }
    let text = replaced(POINTS, "[[-2, 0.23], [2, 0.31]]") + load;
    assert!(try_body(&text).is_ok());
}

#[test]
fn a_support_that_holds_no_node_is_refused() {
    let text = good()
        + "[[support]]\non = \"left\"\nwhere = \"y > 0.3 and y < 0.4\"\ndisplacement_m = [0, 0]\n";
    assert_refused(&text, "\"left\"", "holds nothing");
}

#[test]
fn a_probe_that_is_at_no_node_is_refused() {
    let text = good() + "[[probe]]\nname = \"here\"\npoint_m = [0.3, 0.3]\n";
    assert_refused(&text, "[[probe]]", "node");
}

#[test]
fn a_mesh_folded_by_following_a_steep_line_is_refused() {
    let mesh = "mesh = { box = { min_m = [-1.0, -1.0], max_m = [1.0, 1.0], cells = [8, 8] } }";
    let follow = "mesh = { box = { min_m = [-1.0, -1.0], max_m = [1.0, 1.0], cells = [8, 9] }, follow = { point_m = [0, 0], angle_deg = 45, half_length_m = 0.97 } }";
    let text = replaced(mesh, follow);
    let error = stickslip::case::parse("t.toml", text.as_str()).unwrap_err();
    let at = (error.line(), error.column());
    assert_eq!(at, place(&text, "45, half"), "{error}");
    // Just within the body: thin cells, but cells.
    assert!(try_body(&text.replace("45, half", "42, half")).is_ok());
}

/// Goal: a motion of the grid that folds a cell is refused at the table that asks for it, not at another one.
#[test]
fn a_mesh_folded_by_turning_or_moving_it_is_refused() {
    let with = |motion: &str| {
        let mark = "mesh = { ";
        let text = good();
        assert_eq!(text.matches(mark).count(), 1);
        text.replace(mark, &format!("{mark}{motion}, "))
    };
    let twist = "twist = { angle_deg = 179 }";
    assert_refused(&with(twist), "{ angle_deg", "fold the cell");
    let distort = "distort = { amplitude = 0.49, seed = 4 }";
    assert_refused(&with(distort), "{ amplitude", "fold the cell");
    let both = "distort = { amplitude = 0.49, seed = 4 }, twist = { angle_deg = 10 }";
    assert_refused(&with(both), "{ amplitude", "fold the cell");
    let mild = "distort = { amplitude = 0.2, seed = 4 }, twist = { angle_deg = 30 }";
    assert!(try_body(&with(mild)).is_ok());
}

#[test]
fn a_method_option_out_of_range_is_refused_at_its_value() {
    for (method, words) in [
        ("name = \"penalty\"\nnormal = -3\n", "normal"),
        ("name = \"penalty\"\nnormel = 3\n", "normel"),
        ("name = \"newton\"\n", "unknown method"),
    ] {
        let text = good() + "[[method]]\n" + method;
        assert_code_2(&text, "error: bad.toml:", words);
    }
}

/// Goal: a probe on the crack, between two faces, and expectations that no run can answer are refused where they stand.
#[test]
fn probes_between_the_faces_and_expectations_without_an_answer_are_refused() {
    let through = crack([-2.0, 0.0], [2.0, 0.0], 0.3, "none") + &clamped(2);
    let probe = "[[probe]]\nname = \"P\"\npoint_m = [0, 0]\n";
    let text = plane([-1.0, -1.0], [1.0, 1.0], [8, 8], &(through + probe));
    assert_refused(&text, "[[probe]]", "lies on a crack");
    for (quantity, at, unit, words) in [
        ("reactions", "top", "N/m", "unknown quantity"),
        ("reaction", "left", "N/m", "`at`"),
        ("reaction", "top", "N", "`unit`"),
    ] {
        let text = good()
            + &format!(
                "[[expect]]\nquantity = \"{quantity}\"\nat = \"{at}\"\ncomponent = \"y\"\nvalue = 1\nunit = \"{unit}\"\n\
                 relative = 1e-3\nkind = \"analytic\"\nsource = \"none\"\n"
            );
        let case = parse(&text);
        let error = stickslip::run::expect::check(&case).expect_err("no run has it");
        let at = (error.line(), error.column());
        assert_eq!(at, place(&text, "[[expect]]"), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// Goal: a support in a point of a crack says which lip it holds; where the region tells, the key has no meaning. A load whose
/// region has no length acts on nothing.
#[test]
fn supports_that_do_not_tell_lips_apart_and_loads_on_nothing_are_refused() {
    let text = |rest: &str| {
        let both = support("\"bottom\"", "[0, 0]") + &support("\"top\"", "[1e-3, -1e-3]");
        let rest = crack([-2.0, 0.5], [2.0, -0.5], 0.3, "none") + &both + rest;
        plane([-1.0, -1.0], [1.0, 1.0], [8, 8], &rest)
    };
    let lone =
        "[[support]]\non = \"left\" # here\nwhere = \"y == 0.25\"\ndisplacement_m = [0, 0]\n";
    assert_refused(&text(lone), "\"left\" # here", "two lips part");
    assert!(try_body(&text(&format!("{lone}crack_side = 1\n"))).is_ok());
    let other = lone.replace("y == 0.25", "y >= 0.25") + "crack_side = 2 # key\n";
    assert_refused(&text(&other), "2 # key", "the region tells itself");
    let lips = "[[support]]\non = \"left\"\nwhere = \"y >= 0.25\"\ndisplacement_m = [0, \"free\"]\n\
                [[support]]\non = \"left\" # here\nwhere = \"y <= 0.25\"\ndisplacement_m = [\"free\", 0]\n";
    assert_refused(&text(lips), "\"left\" # here", "in other components");
    let load = "[[load]]\non = \"right\" # here\nwhere = \"y == 0.25\"\npressure_pa = 1\n";
    assert_refused(&text(load), "\"right\" # here", "holds no cell facet");
}
