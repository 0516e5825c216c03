//! The closed form of a case and what supports and loads take from it; loads that vary in space or know sides.

use stickslip::case::{self, Amount, Case, CaseError, History, LoadKind};
use stickslip_xfem::exact::{ParameterSpec, SolutionSpec};

use super::{PLANE, SOLID, accepted, place, refused};

static FORMS: &[SolutionSpec] = &[
    SolutionSpec {
        name: "uniform-slip",
        summary: "for the parser",
        parameters: &[
            ParameterSpec {
                name: "pressure_pa",
                summary: "required",
                default: None,
            },
            ParameterSpec {
                name: "shear_pa",
                summary: "with a default",
                default: Some(0.5),
            },
        ],
        build: |_, _| Err("never built".into()),
    },
    SolutionSpec {
        name: "partial-slip",
        summary: "another",
        parameters: &[],
        build: |_, _| Err("never built".into()),
    },
];

const EXACT: &str = "[exact]\nsolution = \"uniform-slip\"\npressure_pa = 3e5\n\n[path]";

/// The plate with a closed form.
fn plate() -> String {
    PLANE.replace("[path]", EXACT)
}

fn parse(text: &str) -> Result<Case, CaseError> {
    case::parse_with("bad.toml", text, FORMS)
}

/// Replaces a part of the text and demands a refusal at a mark in the replacement.
fn assert_refused(text: &str, from: &str, to: &str, mark: &str, allowed: &str) {
    assert_eq!(text.matches(from).count(), 1, "`{from}` must occur once");
    let bad = text.replace(from, to);
    let at = text.find(from).unwrap() + to.find(mark).expect("mark inside the replacement");
    let error = parse(&bad).expect_err("the text must be refused");
    assert_eq!((error.line(), error.column()), place(&bad, at), "{error}");
    assert!(error.allowed().contains(allowed), "{error}");
    assert!(
        !error.value().is_empty() && !error.key().is_empty(),
        "{error}"
    );
}

#[test]
fn the_closed_form_arrives_with_its_parameters_in_order() {
    let exact = parse(&plate()).unwrap().exact.unwrap();
    assert_eq!(exact.solution.name, "uniform-slip");
    assert_eq!(
        (&exact.values[..], &exact.history),
        (&[3e5, 0.5][..], &History::Ramp)
    );
    let given = "shear_pa = -2\npressure_pa = 3e5\nhistory = [[0, 0], [1, 3]]";
    let case = parse(&plate().replace("pressure_pa = 3e5", given)).unwrap();
    let exact = case.exact.unwrap();
    assert_eq!(exact.values, [3e5, -2.0]);
    // Time 0 and four increments until t = 2.
    assert_eq!(exact.factors(&case.path), [0.0, 1.5, 3.0, 3.0, 3.0]);
    assert!(accepted(PLANE).exact.is_none());
}

#[test]
fn faults_of_the_closed_form_are_refused_at_their_place() {
    let line = "solution = \"uniform-slip\"\npressure_pa = 3e5";
    #[rustfmt::skip]
    let rows = [
        ("solution = \"uniform\"", "\"uniform\"", "uniform-slip, partial-slip"),
        ("solution = 3", "3", "uniform-slip, partial-slip"),
        ("solution = \"partial-slip\"\npressure_pa = 3e5", "pressure_pa", "solution, history"),
        ("solution = \"uniform-slip\"\npressure = 3e5", "pressure", "solution, pressure_pa, shear_pa, history"),
        ("solution = \"uniform-slip\"\npressure_pa = \"high\"", "\"high\"", "finite numbers"),
        ("solution = \"uniform-slip\"\npressure_pa = inf", "inf", "finite numbers"),
        ("solution = \"partial-slip\"\nhistory = \"sine\"", "\"sine\"", "ramp, constant"),
    ];
    for (to, mark, allowed) in rows {
        assert_refused(&plate(), line, to, mark, allowed);
    }
    for (to, allowed) in [
        (
            "[exact]\nsolution = \"uniform-slip\"\n\n[path]",
            "`pressure_pa`",
        ),
        ("[exact]\nhistory = \"ramp\"\n\n[path]", "`solution`"),
        (
            "[[crack]]\npoints_m = [[5, 0], [9, 0]]\nfriction = 0\n\n[exact]\nsolution = \"partial-slip\"\n\n[path]",
            "exactly one [[crack]]",
        ),
    ] {
        assert_refused(PLANE, "[path]", to, "[exact]", allowed);
    }
    let without = plate();
    let (start, end) = (
        without.find("[[crack]]").unwrap(),
        without.find("[[support]]").unwrap(),
    );
    let error = parse(&(without[..start].to_owned() + &without[end..])).unwrap_err();
    assert!(error.message().contains("beside 0 cracks"), "{error}");
}

#[test]
fn supports_and_loads_take_values_from_the_closed_form() {
    let displacement = "displacement_m = [\"free\", -0.1]\nhistory = [[0, 0], [1, 2.5]]";
    let number = Some(Amount::Number((-0.1).into()));
    #[rustfmt::skip]
    let rows = [
        ("displacement_m = \"exact\"", [Some(Amount::Exact); 2]),
        ("displacement_m = [\"exact\", \"free\"]", [Some(Amount::Exact), None]),
        ("displacement_m = [\"exact\", -0.1]\nhistory = \"constant\"", [Some(Amount::Exact), number]),
    ];
    for (to, wanted) in rows {
        let case = parse(&plate().replace(displacement, to)).unwrap();
        assert_eq!(case.supports[1].displacement, wanted);
    }
    let loads = plate()
        .replace(
            "pressure_pa = 1e5\nhistory = \"constant\"",
            "traction_pa = \"exact\"",
        )
        .replace("body_n_per_m3 = [0, -1e4]", "body_n_per_m3 = \"exact\"");
    let case = parse(&loads).unwrap();
    assert!(matches!(&case.loads[0].kind, LoadKind::ExactTraction(on) if on.sides == ["left"]));
    assert!(matches!(case.loads[1].kind, LoadKind::ExactBody));

    let own = "no history here";
    #[rustfmt::skip]
    let rows = [
        (displacement, "displacement_m = \"exakt\"", "\"exakt\"", "2 entries or \"exact\""),
        (displacement, "displacement_m = [\"exakt\", 0]", "exakt", "\"free\", \"exact\" or a polynomial"),
        (displacement, "displacement_m = \"exact\"\nhistory = \"ramp\"", "\"ramp\"", own),
        (displacement, "displacement_m = [\"exact\", \"free\"]\nhistory = \"ramp\"", "\"ramp\"", own),
        ("pressure_pa = 1e5\nhistory = \"constant\"", "traction_pa = \"exact\"\nhistory = \"constant\"", "\"constant\"", own),
        ("pressure_pa = 1e5", "pressure_pa = \"exact\"", "exact", "at_origin_pa"),
        ("pressure_pa = 1e5\nhistory = \"constant\"", "traction_pa = \"given\"", "\"given\"", "an array"),
        ("body_n_per_m3 = [0, -1e4]", "body_n_per_m3 = \"exact\"\nhistory = \"ramp\"", "\"ramp\"", own),
        ("body_n_per_m3 = [0, -1e4]", "body_n_per_m3 = \"exact\"\ncrack_side = 1", "1", "no crack_side"),
        ("body_n_per_m3 = [0, -1e4]", "body_n_per_m3 = [\"exact\", 0]", "\"exact\"", "finite numbers"),
    ];
    for (from, to, mark, allowed) in rows {
        assert_refused(&plate(), from, to, mark, allowed);
    }
    // Without [exact] there is nothing to take.
    for (from, to) in [
        (displacement, "displacement_m = \"exact\""),
        (displacement, "displacement_m = [\"exact\", 0]"),
        (
            "pressure_pa = 1e5\nhistory = \"constant\"",
            "traction_pa = \"exact\"",
        ),
        ("body_n_per_m3 = [0, -1e4]", "body_n_per_m3 = \"exact\""),
    ] {
        assert_refused(PLANE, from, to, "\"exact\"", "[exact] table");
    }
}

#[test]
fn tractions_and_pressures_may_vary_in_space() {
    let table = "pressure_pa = { at_origin_pa = 1e5, gradient_pa_per_m = [2, -3] }";
    let case = accepted(&PLANE.replace("pressure_pa = 1e5", table));
    let LoadKind::Pressure(_, p) = &case.loads[0].kind else {
        panic!("{:?}", case.loads[0])
    };
    assert_eq!(p.at(&[10.0, 100.0, 0.0]), 1e5 + 20.0 - 300.0);
    let table = "traction_pa = [7, { at_origin_pa = -1, gradient_pa_per_m = [0.5, 0] }]";
    let case = accepted(&PLANE.replace("pressure_pa = 1e5", table));
    let LoadKind::Traction(_, t) = &case.loads[0].kind else {
        panic!("{:?}", case.loads[0])
    };
    assert_eq!([0, 1].map(|a| t[a].at(&[4.0, 9.0, 0.0])), [7.0, 1.0]);
    let text = "pressure_pa = \"1e5 + 2 x - 3e-1 x*y + y^2\"";
    let case = accepted(&PLANE.replace("pressure_pa = 1e5", text));
    let LoadKind::Pressure(_, p) = &case.loads[0].kind else {
        panic!("{:?}", case.loads[0])
    };
    assert_eq!(p.at(&[10.0, 100.0, 0.0]), 1e5 + 20.0 - 300.0 + 1e4);
    #[rustfmt::skip]
    let rows = [
        ("pressure_pa = { at_origin_pa = inf, gradient_pa_per_m = [2, 3] }", "inf", "finite numbers"),
        ("pressure_pa = { at_origin_pa = 1, gradient_pa_per_m = [2] }", "[2]", "2 entries"),
        ("pressure_pa = { at_origin_pa = 1, gradient_pa_per_m = [2, nan] }", "nan", "finite numbers"),
        ("pressure_pa = { at_origin = 1, gradient_pa_per_m = [2, 3] }", "at_origin", "at_origin_pa, gradient_pa_per_m"),
        ("pressure_pa = { gradient_pa_per_m = [2, 3] }", "{ grad", "`at_origin_pa`"),
        ("pressure_pa = { at_origin_pa = 1 }", "{ at", "`gradient_pa_per_m`"),
        ("pressure_pa = \"high\"", "high", "gradient_pa_per_m"),
        ("traction_pa = [1, \"3 x + high\"]", "high", "here a number or x, y"),
        ("pressure_pa = \"3 x*y^2\"", "3 x", "degree 0, 1 or 2"),
        ("pressure_pa = \"3 z\"", "z", "here a number or x, y"),
        ("pressure_pa = \"\"", "\"\"", "here a number or x, y"),
        ("traction_pa = [1]", "[1]", "2 entries"),
    ];
    for (to, mark, allowed) in rows {
        assert_refused(PLANE, "pressure_pa = 1e5", to, mark, allowed);
    }
}

#[test]
fn initial_stresses_and_one_sided_body_forces_are_read() {
    let body = "body_n_per_m3 = [0, -1e4]";
    let case = accepted(&PLANE.replace(body, "initial_stress_pa = [1, 2, 3]"));
    let wanted = [[1.0, 3.0, 0.0], [3.0, 2.0, 0.0], [0.0; 3]];
    assert!(matches!(case.loads[1].kind, LoadKind::InitialStress(s) if s == wanted));
    let line = "on = [\"back\", \"top\"]\nline_n_per_m = [-1, 0, 2.5]";
    let case = accepted(&SOLID.replace(line, "initial_stress_pa = [1, 2, 3, 4, 5, 6]"));
    let wanted = [[1.0, 6.0, 5.0], [6.0, 2.0, 4.0], [5.0, 4.0, 3.0]];
    assert!(matches!(case.loads[0].kind, LoadKind::InitialStress(s) if s == wanted));
    for (number, side) in [(1, 1.0), (2, -1.0)] {
        let text = PLANE.replace(body, &format!("{body}\ncrack_side = {number}"));
        let LoadKind::Body(_, Some(found)) = accepted(&text).loads[1].kind.clone() else {
            panic!("{text}")
        };
        assert_eq!(
            (found.side, &text[found.span]),
            (side, &*number.to_string())
        );
    }
    #[rustfmt::skip]
    let rows = [
        (body, "initial_stress_pa = [1, 2]", "[1, 2]", "3 entries"),
        (body, "initial_stress_pa = [1, 2, \"exact\"]", "\"exact\"", "finite numbers"),
        (body, "initial_stress_pa = \"exact\"", "\"exact\"", "an array"),
        (body, "initial_stress_pa = [1, 2, 3]\nwhere = \"x > 0\"", "\"x > 0\"", "neither"),
        (body, "initial_stress_pa = [4, 2, 3]\ncrack_side = 1", "1", "beside body_n_per_m3"),
        (body, "body_n_per_m3 = [0, -4]\ncrack_side = 7", "7", "integers from 1 to 2"),
        (body, "body_n_per_m3 = [0, -4]\ncrack_side = 0.5", "0.5", "integers from 1 to 2"),
        ("pressure_pa = 1e5", "pressure_pa = 3e5\ncrack_side = 1", "1", "beside body_n_per_m3"),
        (
            body,
            "body_n_per_m3 = [0, -4]\ncrack_side = 2\n[[crack]]\npoints_m = [[5, 0], [9, 0]]\nfriction = 0",
            "2\n",
            "exactly one [[crack]]",
        ),
    ];
    for (from, to, mark, allowed) in rows {
        assert_refused(PLANE, from, to, mark, allowed);
    }
    let error = refused(&SOLID.replace(line, "initial_stress_pa = [1, 2, 3]"));
    assert_eq!(error.allowed(), "6 entries", "{error}");
}

#[test]
fn keys_of_the_closed_form_are_documented() {
    let document = include_str!("../../../docs/case-format.md");
    for key in ["solution", "history", "crack_side", "initial_stress_pa"] {
        assert!(document.contains(&format!("| `{key}` |")), "{key}");
    }
    for key in ["at_origin_pa", "gradient_pa_per_m"] {
        assert!(document.contains(&format!("{key} = ")), "{key}");
    }
}

#[test]
fn supports_vary_in_space_and_tell_lips_apart() {
    let line = "displacement_m = [\"free\", -0.1]\nhistory = [[0, 0], [1, 2.5]]";
    let case = accepted(&PLANE.replace(line, "displacement_m = [\"x - 2 y\", 0]\ncrack_side = 2"));
    let support = &case.supports[1];
    let Some(Amount::Number(u)) = &support.displacement[0] else {
        panic!("{support:?}")
    };
    assert_eq!(u.at(&[3.0, 1.0, 0.0]), 1.0);
    assert_eq!(support.lip.as_ref().unwrap().side, -1.0);
    #[rustfmt::skip]
    let rows = [
        ("displacement_m = [\"x - 2 w\", 0]", "w", "here a number or x, y"),
        ("displacement_m = [\"x -\", 0]", "\", 0]", "here a number or x, y"),
        ("displacement_m = [0, 0]\ncrack_side = 3", "3", "integers from 1 to 2"),
    ];
    for (to, mark, allowed) in rows {
        assert_refused(PLANE, line, to, mark, allowed);
    }
    let (start, end) = (
        PLANE.find("[[crack]]").unwrap(),
        PLANE.find("[[support]]").unwrap(),
    );
    let whole = PLANE[..start].to_owned() + &PLANE[end..];
    assert_refused(
        &whole,
        line,
        "displacement_m = [0, 0]\ncrack_side = 1",
        "1",
        "a [[crack]]",
    );
}

#[test]
fn a_list_of_conditions_is_their_union() {
    let line = "where = \"x <= 1 and y > 2\"";
    let case = accepted(&PLANE.replace(line, "where = [\"x <= 1\", \"y > 2 and x < 3\"]"));
    let condition = case.supports[1].on.condition.as_ref().unwrap();
    for (x, holds) in [
        ([1.0, 0.0], true),
        ([2.0, 3.0], true),
        ([2.0, 2.0], false),
        ([3.0, 3.0], false),
    ] {
        assert_eq!(condition.holds(&[x[0], x[1], 0.0], 1e-9), holds, "{x:?}");
    }
    #[rustfmt::skip]
    let rows = [
        ("where = []", "[]", "at least one condition"),
        ("where = 3", "3", "an array of conditions"),
        ("where = [\"x <= 1\", 3]", "3", "a string"),
        ("where = [\"x <= 1\", \"y > w\"]", "w\"", "a finite number"),
    ];
    for (to, mark, allowed) in rows {
        assert_refused(PLANE, line, to, mark, allowed);
    }
}
