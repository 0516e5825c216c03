//! Every kind of figure of made-up results.

use super::{beam, beam_step, cycle, exact, plate, rates, results, results_of_all_methods};
use stickslip::report::plot::{
    self, Axis3, Curve, CurvePlot, ErrorCurve, ErrorFigure, ErrorPanel, Guide, Magnification, Tier,
};
use stickslip::run::record::{HistoryRow, PointRow};
use stickslip::run::registry::methods;
use stickslip::studies::paper::comparison::comparison;

/// Every kind of figure, with the texts that it must show.
pub fn figures() -> Vec<(&'static str, String, Vec<&'static str>)> {
    let results = results();
    let by_method: Vec<PointRow> = results
        .points
        .iter()
        .filter(|row| row.key.friction == 0.1)
        .cloned()
        .collect();
    let history: Vec<HistoryRow> = results
        .history
        .iter()
        .filter(|row| row.key.friction == 0.1)
        .cloned()
        .collect();
    let curve = |label: &str, factor: f64| Curve {
        label: label.into(),
        points: (0..8)
            .map(|i| 10f64.powi(9 + i))
            .map(|k| [k, factor / k + 1e-9])
            .collect(),
    };
    let error = CurvePlot {
        caption: "penalty".into(),
        x_label: "penalty parameter [N/m]".into(),
        y_label: "relative error [-]".into(),
        curves: vec![curve("μ = 0.1", 3e8), curve("μ = 1.2", 9e8)],
    };
    let path = [[0.0, 0.0], [1.0, 3e5], [2.0, 3e5], [0.0, -3e5], [1.0, 0.0]];
    let to_and_fro = CurvePlot {
        caption: "cycle".into(),
        x_label: "displacement [mm]".into(),
        y_label: "force [N/m]".into(),
        curves: vec![Curve {
            label: "latin".into(),
            points: path.to_vec(),
        }],
    };
    let tier = Tier::named("high");
    let all = results_of_all_methods();
    vec![
        (
            "residual of all methods",
            plot::residual_history(&all.history, tier.as_ref()).expect("residual"),
            methods().iter().map(|method| method.name).collect(),
        ),
        (
            "traction of all methods",
            plot::contact_traction(&all.points, &[], 1).expect("traction"),
            vec![
                " exact methods, apart by at most 0.002",
                "penalty, off by at most 0.002",
            ],
        ),
        (
            "slip of all methods",
            plot::contact_slip(&all.points, &[], 1).expect("slip"),
            vec![" exact methods", "barrier, off by less than 1e-12"],
        ),
        (
            "cost",
            plot::method_cost(&comparison(&all.runs)).expect("cost"),
            vec![
                "plate_mesh1",
                "iterations [-]",
                "solve time [s]",
                ">nitsche<",
            ],
        ),
        (
            "rates",
            plot::success_rates(&rates()).expect("rates"),
            vec![
                "solved, or own laws kept, in 2D [%]",
                "solved, or own laws kept, in 3D [%]",
                ">99.9<",
                ">87.5<",
                ">–<",
                ">nitsche<",
            ],
        ),
        (
            "residual",
            plot::residual_history(&history, tier.as_ref()).expect("residual"),
            vec![
                "latin",
                "penalty",
                "tier high (1e-9)",
                "iteration [-]",
                "10⁻⁸",
                "natural-map residual [-]",
            ],
        ),
        (
            "traction",
            plot::contact_traction(&by_method, &[], 1).expect("traction"),
            vec![
                "[MPa]",
                "distance along the crack [m]",
                "stick",
                "open",
                "slip limit",
            ],
        ),
        (
            "slip",
            plot::contact_slip(&by_method, &[], 1).expect("slip"),
            vec!["slip [mm]", "normal gap [µm]", "b-newton"],
        ),
        (
            "contours",
            plot::displacement_contours(&plate(), Magnification::Auto, "plate").expect("contours"),
            vec!["plate, deformation ×10", "[mm]", "−50", "[m]"],
        ),
        (
            "solid",
            plot::solid_displacement(&beam(), Axis3::Z, Magnification::Factor(50.0), "beam")
                .expect("solid"),
            vec!["beam, deformation ×50", "[mm]", "−1.0"],
        ),
        (
            "stress",
            plot::von_mises_contours(&plate(), Magnification::Auto, "plate").expect("stress"),
            vec![
                "plate, von Mises stress, deformation ×10",
                "[MPa]",
                ">vM<",
                ">500<",
            ],
        ),
        (
            "stress of a solid",
            plot::solid_von_mises(&beam(), Magnification::Auto, "beam").expect("stress"),
            // One cell in a thousand is under far more stress than the rest.
            vec!["[kPa]", ">to 2000<", ">300<"],
        ),
        (
            "contact of a solid",
            plot::contact_status(&beam_step(), Magnification::Auto, "beam").expect("contact"),
            vec![
                ">open<",
                ">stick<",
                ">slip<",
                "slip of side 1 against side 2, longest 300 µm",
            ],
        ),
        (
            "traction with closed form",
            plot::contact_traction(&by_method, &exact(0.1), 1).expect("traction"),
            vec![">exact<", "stick", "[MPa]"],
        ),
        (
            "friction loop",
            plot::friction_loop(&cycle(), 1, &["dissipated: 12 J/m".into()])
                .expect("drawn")
                .expect("a loop"),
            vec![
                "mean slip [mm]",
                "[kN/m]",
                "numbers: increments",
                "dissipated: 12 J/m",
                // Where force or slip turn back; increments at one place share a label.
                ">0<",
                ">4, 10<",
                ">6, 11<",
                ">8, 12<",
                ">9<",
                "2 exact methods",
            ],
        ),
        (
            "error",
            plot::error_plot(&error, Some(-1.0)).expect("error"),
            vec!["penalty parameter [N/m]", "10¹²", "μ = 1.2", ">1<"],
        ),
        (
            "convergence",
            drawn(&convergence()),
            vec![
                "unknowns",
                "tips not enriched",
                "p0: 0.45",
                "p0: 0.98",
                "edge-pairs: 0.94",
                // Orders 1/2 and 1 in h, as legs of triangles over 2 in N.
                ">theory: 0.5<",
                ">theory: 1<",
                ">0.5<",
                ">1<",
                ">2<",
                "10⁴",
            ],
        ),
        (
            "convergence without theory",
            drawn(&ErrorFigure {
                columns: 1,
                panels: vec![error_panel("", 0.8, None)],
                ..convergence()
            }),
            vec!["star: 0.80", ">1<", ">3<"],
        ),
        (
            "loop",
            plot::line_plot(&to_and_fro).expect("loop"),
            vec!["force [10³ N/m]", "−200", "latin"],
        ),
    ]
}

/// Errors h^p of four contact spaces on four meshes, p falling from space to space; without theory of a solid.
fn error_panel(heading: &str, p: f64, theory: Option<f64>) -> ErrorPanel {
    let run = if theory.is_some() { 2.0 } else { 3.0 };
    let curve = |(look, space): (usize, &str)| {
        let p = p - 0.02 * look as f64;
        let size = [0.1, 0.05, 0.025, 0.0125];
        let error = |h: f64| [2.0 * h.powf(-run), (1.0 + 0.2 * look as f64) * h.powf(p)];
        ErrorCurve {
            label: format!("{space}: {p:.2}"),
            look,
            points: size.map(error).to_vec(),
        }
    };
    let spaces = ["star", "p0", "facet", "edge-pairs"].into_iter();
    ErrorPanel {
        heading: heading.into(),
        curves: spaces.enumerate().map(curve).collect(),
        guides: vec![Guide {
            rise: -theory.unwrap_or(1.0),
            run,
            label: theory.map(|order| format!("theory: {order}")),
        }],
    }
}

/// Four contact spaces with three tip enrichments.
fn convergence() -> ErrorFigure {
    ErrorFigure {
        title: "energy norm against unknowns".into(),
        caption: "inclined crack, hybrid, μ = 0.3\nobserved orders in h".into(),
        x_label: "unknowns".into(),
        y_label: "error: energy norm".into(),
        columns: 3,
        panels: vec![
            error_panel("tips not enriched", 0.47, Some(0.5)),
            error_panel("tip cells enriched", 0.52, Some(0.5)),
            error_panel("tips enriched within 0.2 m", 1.0, Some(1.0)),
        ],
    }
}

fn drawn(figure: &ErrorFigure) -> String {
    let svg = plot::error_figure(figure).expect("a figure");
    svg.expect("errors above zero")
}
