//! The closed form of a case and what supports and loads take from it; loads that vary in space or know sides.

use stickslip::case::{self, Amount, Case, CaseError, History, LoadKind};
use stickslip_xfem::exact::{ParameterSpec, SolutionSpec};

use super::refusals::{self, Fault, MOVED};
use super::{PLANE, SOLID, accepted};

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

/// As for other faults, with the forms above.
fn assert_refused(text: &str, faults: &[Fault]) {
    refusals::assert_refused_by(parse, text, faults);
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
    let load = "pressure_pa = 1e5\nhistory = \"constant\"";
    let body = "body_n_per_m3 = [0, -1e4]";
    let own = "no history here";
    #[rustfmt::skip]
    assert_refused(&plate(), &[
        (line, "solution = \"uniform\"", "\"uniform\"", "uniform-slip, partial-slip"),
        (line, "solution = 3", "3", "uniform-slip, partial-slip"),
        (line, "solution = \"partial-slip\"\npressure_pa = 3e5", "pressure_pa", "solution, history"),
        (line, "solution = \"uniform-slip\"\npressure = 3e5", "pressure", "solution, pressure_pa, shear_pa, history"),
        (line, "solution = \"uniform-slip\"\npressure_pa = \"high\"", "\"high\"", "finite numbers"),
        (line, "solution = \"uniform-slip\"\npressure_pa = inf", "inf", "finite numbers"),
        (line, "solution = \"partial-slip\"\nhistory = \"sine\"", "\"sine\"", "ramp, constant"),
        (MOVED, "displacement_m = \"exakt\"", "\"exakt\"", "2 entries or \"exact\""),
        (MOVED, "displacement_m = [\"exakt\", 0]", "exakt", "\"free\", \"exact\" or a polynomial"),
        (MOVED, "displacement_m = \"exact\"\nhistory = \"ramp\"", "\"ramp\"", own),
        (MOVED, "displacement_m = [\"exact\", \"free\"]\nhistory = \"ramp\"", "\"ramp\"", own),
        (load, "traction_pa = \"exact\"\nhistory = \"constant\"", "\"constant\"", own),
        (load, "pressure_pa = \"exact\"", "exact", "at_origin_pa"),
        (body, "body_n_per_m3 = \"exact\"\nhistory = \"ramp\"", "\"ramp\"", own),
        (body, "body_n_per_m3 = \"exact\"\ncrack_side = 1", "1", "no crack_side"),
        (body, "body_n_per_m3 = [\"exact\", 0]", "\"exact\"", "finite numbers"),
    ]);
    // Without [exact] there is nothing to take.
    let without = "[exact] table";
    #[rustfmt::skip]
    assert_refused(PLANE, &[
        (MOVED, "displacement_m = \"exact\"", "\"exact\"", without),
        (MOVED, "displacement_m = [\"exact\", 0]", "\"exact\"", without),
        (load, "traction_pa = \"exact\"", "\"exact\"", without),
        (body, "body_n_per_m3 = \"exact\"", "\"exact\"", without),
        ("[path]", "[exact]\nsolution = \"uniform-slip\"\n\n[path]", "[exact]", "`pressure_pa`"),
        ("[path]", "[exact]\nhistory = \"ramp\"\n\n[path]", "[exact]", "`solution`"),
        ("[path]", "[[crack]]\npoints_m = [[5, 0], [9, 0]]\nfriction = 0\n\n[exact]\nsolution = \"partial-slip\"\n\n[path]", "[exact]", "exactly one [[crack]]"),
    ]);
    let whole = plate();
    let (start, end) = (
        whole.find("[[crack]]").unwrap(),
        whole.find("[[support]]").unwrap(),
    );
    let whole = whole[..start].to_owned() + &whole[end..];
    assert!(
        parse(&whole)
            .unwrap_err()
            .message()
            .contains("beside 0 cracks")
    );
    let whole = whole.replace(EXACT, "[path]");
    assert_refused(
        &whole,
        &[(
            MOVED,
            "displacement_m = [0, 0]\ncrack_side = 1",
            "1",
            "a [[crack]]",
        )],
    );
}

#[test]
fn supports_and_loads_take_values_from_the_closed_form() {
    let number = Some(Amount::Number((-0.1).into()));
    #[rustfmt::skip]
    let rows = [
        ("displacement_m = \"exact\"", [Some(Amount::Exact); 2]),
        ("displacement_m = [\"exact\", \"free\"]", [Some(Amount::Exact), None]),
        ("displacement_m = [\"exact\", -0.1]\nhistory = \"constant\"", [Some(Amount::Exact), number]),
    ];
    for (to, wanted) in rows {
        let case = parse(&plate().replace(MOVED, to)).unwrap();
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
}

#[test]
fn supports_vary_in_space_and_tell_lips_apart() {
    let case = accepted(&PLANE.replace(MOVED, "displacement_m = [\"x - 2 y\", 0]\ncrack_side = 2"));
    let support = &case.supports[1];
    let Some(Amount::Number(u)) = &support.displacement[0] else {
        panic!("{support:?}")
    };
    assert_eq!(u.at(&[3.0, 1.0, 0.0]), 1.0);
    assert_eq!(support.lip.as_ref().unwrap().side, -1.0);
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
}
