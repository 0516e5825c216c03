//! Case files: every shipped case is accepted and says what its sources say; every fault is refused at its place.

mod cracks;
mod loads;
mod refusals;
mod robustness;
mod shipped;

use stickslip::case::{
    self, Amount, Case, CaseError, ContactSpace, CrackShape, ExpectKind, History, LoadKind, Model,
    Quadrature, Tip, Tolerance,
};

/// A 2D case with every table.
const PLANE: &str = r#"title = "Plate"
model = "plane-strain"
quadrature = "sub-cells"
tier = "mid"

[material]
young_pa = 1e10
poisson = 0.3

[mesh.box]
min_m = [-10, -10]
max_m = [10, 10]
cells = [22, 23]

[mesh.follow]
point_m = [0, 0]
angle_deg = 45
half_length_m = 5.5

[[crack]]
points_m = [[-4, -4], [4, 4]]
friction = 0.1
tip = "branch"
contact = "edge-pairs"

[[support]]
on = "bottom"
displacement_m = [0, 0]

[[support]]
on = ["left", "top"]
where = "x <= 1 and y > 2"
displacement_m = ["free", -0.1]
history = [[0, 0], [1, 2.5]]

[[load]]
on = "left"
pressure_pa = 1e5
history = "constant"

[[load]]
body_n_per_m3 = [0, -1e4]

[path]
increments = 4
end = 2.0

[sweep]
friction = [0.1, 0.8]
refine = [1, 3]

[[method]]
name = "b-newton"
regularisation = 1e-12
max_iterations = 50

[[probe]]
name = "centre"
point_m = [0, 0]

[[expect]]
quantity = "reaction"
at = "top"
component = "y"
friction = 0.8
refine = 3
method = "b-newton"
increment = 2
value = -9.7e8
unit = "N/m"
relative = 1e-3
kind = "published"
source = "A book, page 3"
assumptions = ["plane strain"]
"#;

/// A 3D case, as short as they come.
const SOLID: &str = r#"title = "Beam"
model = "solid"
material = { young_pa = 1, poisson = 0 }

[mesh]
lines_m = [[0, 1], [0, 1, 2], [0, 0.5, 1]]

[[crack]]
plane = { point_m = [0, 0, 0.7], normal = [0, 3, 4] }
friction = 0

[[load]]
on = ["back", "top"]
line_n_per_m = [-1, 0, 2.5]
"#;

fn accepted(text: &str) -> Case {
    case::parse("plate.toml", text).unwrap_or_else(|e| panic!("{e}"))
}

fn refused(text: &str) -> CaseError {
    case::parse("bad.toml", text).expect_err("the text must be refused")
}

/// Line and column, from 1, of the byte `at`.
fn place(text: &str, at: usize) -> (usize, usize) {
    let (before, line) = text[..at].rsplit_once('\n').unwrap_or(("", &text[..at]));
    let above = if at == line.len() {
        0
    } else {
        before.matches('\n').count() + 1
    };
    (above + 1, line.chars().count() + 1)
}

#[test]
fn every_table_arrives_in_the_case() {
    let case = accepted(PLANE);
    assert_eq!([&*case.name, &case.title], ["plate", "Plate"]);
    assert_eq!(case.model, Model::PlaneStrain);
    assert_eq!(case.quadrature, Quadrature::SubCells);
    assert_eq!([case.material.young, case.material.poisson], [1e10, 0.3]);
    let [x, y] = &case.mesh.grid.lines[..] else {
        panic!("{:?}", case.mesh.grid.lines)
    };
    assert_eq!(
        (x.len(), y.len(), x[0], x[11], x[22]),
        (23, 24, -10.0, 0.0, 10.0)
    );
    let follow = case.mesh.grid.follow.as_ref().unwrap();
    assert_eq!(follow.angle, std::f64::consts::FRAC_PI_4);
    assert_eq!(follow.half_length, 5.5);
    let crack = &case.cracks[0];
    let points = vec![[-4.0, -4.0], [4.0, 4.0]];
    assert_eq!(crack.geometry, CrackShape::Polyline(points));
    assert_eq!(
        (crack.tip, crack.contact),
        (Tip::Branch, ContactSpace::EdgePairs)
    );
    let support = &case.supports[1];
    assert_eq!(support.on.sides, ["left", "top"]);
    assert_eq!(
        support.displacement,
        [None, Some(Amount::Number((-0.1).into()))]
    );
    let history = History::Points(vec![[0.0, 0.0], [1.0, 2.5]]);
    assert_eq!(support.history, history);
    let condition = support.on.condition.as_ref().unwrap();
    assert!(condition.holds(&[1.0, 2.1, 0.0], 0.0) && !condition.holds(&[1.0, 2.0, 0.0], 1e-9));
    let LoadKind::Pressure(on, p) = &case.loads[0].kind else {
        panic!("{:?}", case.loads[0])
    };
    assert!(on.sides == ["left"] && p.at(&[3.0; 3]) == 1e5);
    assert!(matches!(&case.loads[1].kind, LoadKind::Body(f, None) if *f == [0.0, -1e4]));
    assert_eq!((case.path.increments, case.path.end), (4, 2.0));
    assert_eq!(case.sweep.friction, [0.1, 0.8]);
    assert_eq!(case.sweep.refine, [1, 3]);
    let method = &case.methods[0];
    // In file order, which is not the alphabetical one.
    let options = [("regularisation", 1e-12), ("max_iterations", 50.0)];
    assert_eq!(
        method.options,
        options.map(|(name, v)| (name.to_owned(), v))
    );
    assert_eq!(&case.source[method.option_spans[0].clone()], "1e-12");
    let expect = &case.expects[0];
    assert_eq!(expect.value, -9.7e8);
    assert_eq!(expect.tolerance, Tolerance::Relative(1e-3));
    assert_eq!(expect.kind, ExpectKind::Published);
    let at = (expect.friction, expect.refine, expect.increment);
    assert_eq!(at, (Some(0.8), Some(3), Some(2)));
    assert_eq!(expect.assumptions, ["plane strain"]);
}

#[test]
fn absent_keys_take_their_documented_defaults() {
    let case = accepted(SOLID);
    assert_eq!(case.quadrature, Quadrature::SubCells);
    assert_eq!(case.target.to_string(), "high");
    assert_eq!((case.path.increments, case.path.end), (1, 1.0));
    assert!(case.sweep.friction.is_empty() && case.sweep.refine == [1]);
    let crack = &case.cracks[0];
    assert_eq!((crack.tip, crack.contact), (Tip::None, ContactSpace::Star));
    assert_eq!(case.loads[0].history, History::Ramp);
    let (point, normal) = ([0.0, 0.0, 0.7], [0.0, 0.6, 0.8]);
    assert_eq!(crack.geometry, CrackShape::Plane { point, normal });
    let plate = accepted(&PLANE.replace("tip = \"branch\"\n", ""));
    assert_eq!(plate.cracks[0].tip, Tip::Auto);
}

#[test]
fn the_documented_example_is_accepted() {
    let document = include_str!("../../../docs/case-format.md");
    let (_, example) = document.split_once("```toml\n").unwrap();
    let (example, _) = example.split_once("```").unwrap();
    let case = accepted(example);
    let counts = [case.cracks.len(), case.supports.len(), case.expects.len()];
    assert_eq!(counts, [1, 2, 1]);
}

#[test]
fn comments_line_endings_and_a_byte_order_mark_change_nothing() {
    let windows = format!("\u{feff}# a comment\r\n{}", SOLID.replace('\n', "\r\n"));
    let lines = |text: &str| accepted(text).mesh.grid.lines;
    assert_eq!(lines(&windows), lines(SOLID));
    let error = refused(&windows.replace("friction = 0", "friction = -1"));
    assert_eq!((error.line(), error.column()), (11, 12), "{error}");
    assert_eq!(error.source_line(), "friction = -1");
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
fn all_faults_of_a_file_are_told_at_once() {
    let [title, tier, poisson, side] = ["3", "\"hgih\"", "0.75", "\"bottm\""];
    let text = PLANE
        .replace("\"Plate\"", title)
        .replace("\"mid\"", tier)
        .replace("poisson = 0.3", &format!("poisson = {poisson}"))
        .replace("on = \"bottom\"", &format!("on = {side}"));
    let shown = refused(&text).to_string();
    assert_eq!(shown.matches("bad.toml:").count(), 4, "{shown}");
    let faults = refused(&text).faults();
    let told: Vec<&str> = faults.iter().map(|own| own.value()).collect();
    assert_eq!(told, [title, tier, poisson, side]);
    // Of sixty thousand the first, in time.
    let many = refused(&(PLANE.to_owned() + &"\n[[load]]".repeat(60_000))).to_string();
    assert!(
        many.ends_with("and more") && many.lines().count() < 40,
        "{many}"
    );
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
fn motions_of_the_grid_arrive() {
    let mesh = |tables: &str| {
        let cells = "cells = [22, 23]";
        accepted(&PLANE.replace(cells, &format!("{cells}\n\n{tables}")))
            .mesh
            .grid
    };
    let both = mesh("[mesh.twist]\nangle_deg = -30\n\n[mesh.distort]\namplitude = 0.25\nseed = 7");
    assert_eq!(both.twist.unwrap().angle, -30f64.to_radians());
    let distort = both.distort.unwrap();
    assert_eq!((distort.amplitude, distort.seed), (0.25, 7));
    let one = mesh("[mesh.distort]\namplitude = 0.25");
    assert!(one.twist.is_none() && one.distort.unwrap().seed == 1);
}
