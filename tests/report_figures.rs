//! Figures carry their labels as text, keep to their paper, come out the same twice, and refuse what they cannot show.

mod report_data;

use report_data::{beam, key, plate, points, rates, results, results_of_all_methods};
use stickslip::harness::record::{HistoryRow, Picture, PictureCell, PointRow};
use stickslip::report::ReportError;
use stickslip::report::comparison::comparison;
use stickslip::report::plot::{
    self, Axis3, Curve, CurvePlot, ErrorCurve, ErrorFigure, ErrorPanel, Guide, Magnification, Tier,
};
use stickslip_methods::METHODS;

/// Every kind of figure, with the texts that it must show.
fn figures() -> Vec<(&'static str, String, Vec<&'static str>)> {
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
    let cycle = CurvePlot {
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
            METHODS.iter().map(|method| method.name).collect(),
        ),
        (
            "traction of all methods",
            plot::contact_traction(&all.points, &[], 1).expect("traction"),
            vec![
                "12 exact methods, apart by at most 0.002",
                "penalty, off by at most 0.002",
            ],
        ),
        (
            "slip of all methods",
            plot::contact_slip(&all.points, &[], 1).expect("slip"),
            vec!["12 exact methods", "barrier, off by less than 1e-12"],
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
            plot::line_plot(&cycle).expect("loop"),
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

/// Texts with their estimated boxes [x0, x1, y0, y1]; texts that read upwards are left out.
fn boxes(svg: &str) -> Vec<(String, [f64; 4])> {
    let element = |rest: &str| {
        let (head, tail) = rest.split_once('>')?;
        let text = tail.split("</text>").next()?;
        let attribute = |name: &str| {
            let value = head.split_once(&format!(" {name}=\""))?.1;
            value.split('"').next().map(str::to_owned)
        };
        let number = |name: &str| attribute(name)?.parse::<f64>().ok();
        // Without the elements inside, each of which takes no room of its own.
        let letters = text
            .split('<')
            .map(|p| p.rsplit('>').next().unwrap_or(p).chars().count());
        // Slightly narrow: an estimate must not see what is not there.
        let (size, x, y) = (number("font-size")?, number("x")?, number("y")?);
        let width = 0.4 * size * letters.sum::<usize>() as f64;
        let start = match attribute("text-anchor").as_deref() {
            Some("middle") => x - 0.5 * width,
            Some("end") => x - width,
            _ => x,
        };
        let upwards = attribute("transform").is_some();
        let half = 0.25 * size;
        (!upwards).then(|| {
            (
                text.trim().to_owned(),
                [start, start + width, y - half, y + half],
            )
        })
    };
    svg.split("<text").skip(1).filter_map(element).collect()
}

#[test]
fn texts_do_not_overlap() {
    for (name, svg, _) in figures() {
        let boxes = boxes(&svg);
        assert!(boxes.len() >= 6, "{name}: {}", boxes.len());
        for (index, (text, a)) in boxes.iter().enumerate() {
            for (other, b) in &boxes[..index] {
                let apart = a[1] <= b[0] || b[1] <= a[0] || a[3] <= b[2] || b[3] <= a[2];
                assert!(apart, "{name}: {text} {a:?} and {other} {b:?}");
            }
        }
    }
}

#[test]
fn figures_show_their_labels_as_text() {
    for (name, svg, texts) in figures() {
        assert!(svg.matches("<text").count() >= 8, "{name}");
        assert_eq!(
            svg.matches("<text").count(),
            svg.matches("</text>").count(),
            "{name}"
        );
        assert_eq!(
            svg.matches("<tspan").count(),
            svg.matches("</tspan>").count(),
            "{name}"
        );
        for text in texts {
            assert!(svg.contains(text), "{name} lacks {text}");
        }
        let private = svg.chars().find(|c| ('\u{E000}'..='\u{F8FF}').contains(c));
        assert_eq!(private, None, "{name} holds a mark of the typesetting");
        assert!(
            !svg.contains("NaN") && !svg.contains("-2147483648"),
            "{name}"
        );
    }
}

#[test]
fn figures_have_print_sizes_in_millimetres() {
    for (name, svg, _) in figures() {
        let width = if ["contours", "convergence", "cost", "rates"].contains(&name) {
            "170.00mm"
        } else {
            "85.00mm"
        };
        assert!(
            svg.starts_with(&format!("<svg width=\"{width}\" height=\"")),
            "{name}"
        );
    }
}

#[test]
fn figures_stay_inside_their_paper() {
    for (name, svg, _) in figures() {
        let view = svg.split_once("viewBox=\"0 0 ").expect("a view box").1;
        let size: Vec<f64> = view
            .split('"')
            .next()
            .unwrap_or_default()
            .split(' ')
            .map(|n| n.parse().expect("a number"))
            .collect();
        for points in svg
            .split("points=\"")
            .skip(1)
            .filter_map(|rest| rest.split('"').next())
        {
            for pair in points.split_whitespace() {
                let (x, y) = pair.split_once(',').expect("a pair");
                let at: [f64; 2] = [x, y].map(|n| n.parse().expect("a number"));
                assert!(
                    (0..2).all(|c| at[c] >= 0.0 && at[c] <= size[c]),
                    "{name}: {at:?} of {size:?}"
                );
            }
        }
    }
}

#[test]
fn figures_are_the_same_bytes_twice() {
    for (first, second) in figures().into_iter().zip(figures()) {
        assert_eq!(first.1, second.1, "{}", first.0);
    }
}

#[test]
fn contour_bands_cover_the_body_without_holes() {
    // The lowest band is filled everywhere: as one outline of exactly the deformed body's area.
    let svg =
        plot::displacement_contours(&plate(), Magnification::Factor(0.0), "").expect("a figure");
    let polygon = svg.split("<polygon").nth(1).expect("a polygon");
    let points = polygon
        .split("points=\"")
        .nth(1)
        .and_then(|p| p.split('"').next())
        .expect("points");
    let corners: Vec<[f64; 2]> = points
        .split_whitespace()
        .filter_map(|pair| pair.split_once(','))
        .map(|(x, y)| [x.parse().expect("a number"), y.parse().expect("a number")])
        .collect();
    let twice_area: f64 = (0..corners.len())
        .map(|i| (corners[i], corners[(i + 1) % corners.len()]))
        .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
        .sum();
    let width = corners.iter().map(|c| c[0]).fold(0.0, f64::max)
        - corners.iter().map(|c| c[0]).fold(f64::INFINITY, f64::min);
    assert!(
        (twice_area.abs() / 2.0 - width * width).abs() < 1.0,
        "a square: {twice_area} {width}"
    );
}

#[test]
fn figures_refuse_what_they_cannot_show() {
    let nothing = plot::residual_history(&[], None).expect_err("no rows");
    assert!(matches!(nothing, ReportError::Figure { .. }), "{nothing}");
    let other = plot::contact_slip(&points(&key("latin", 0.1)), &[], 2).expect_err("no crack 2");
    assert!(other.to_string().contains("crack 2"), "{other}");
    let mut solid = points(&key("latin", 0.1));
    for row in &mut solid {
        row.force_unit = "N".into();
    }
    assert!(plot::contact_traction(&solid, &[], 1).is_err());
    let wrong = plot::displacement_contours(&beam(), Magnification::Auto, "").expect_err("3D");
    assert!(wrong.to_string().contains("3 dimensions"), "{wrong}");
    let mut bare = plate();
    bare.point_vectors.clear();
    let bare = plot::displacement_contours(&bare, Magnification::Auto, "").expect_err("no vector");
    assert!(bare.to_string().contains("displacement_m"), "{bare}");
    let negative = CurvePlot {
        caption: String::new(),
        x_label: "x".into(),
        y_label: "y".into(),
        curves: vec![Curve {
            label: "c".into(),
            points: vec![[1.0, -1.0]],
        }],
    };
    assert!(plot::error_plot(&negative, Some(1.0)).is_err());
}

#[test]
fn figures_survive_sparse_and_flat_data() {
    let mut history = vec![HistoryRow {
        key: key("latin", 0.1),
        iteration: 0,
        natural_map: 0.0,
    }];
    plot::residual_history(&history, None).expect("a single zero residual");
    history.push(HistoryRow {
        key: key("latin", 0.1),
        iteration: 1,
        natural_map: f64::NAN,
    });
    let svg = plot::residual_history(&history, None).expect("a residual that is not finite");
    assert!(!svg.contains("NaN"));

    let mut rows = points(&key("latin", 0.0));
    for row in &mut rows {
        (row.slip_a_m, row.gap_m, row.status) = (1e-19, 0.0, "stick".into());
    }
    let svg = plot::contact_slip(&rows, &[], 1).expect("round-off slips");
    assert!(
        svg.contains("slip [m]"),
        "round-off is not enlarged to an axis of its own"
    );
    plot::contact_traction(&rows[..1], &[], 1).expect("a single point");

    let mut flat = plate();
    for u in &mut flat.point_vectors[0].1 {
        *u = [0.0; 3];
    }
    plot::displacement_contours(&flat, Magnification::Auto, "").expect("a body at rest");
}

#[test]
fn unit_marks_in_data_do_not_reach_the_typesetting() {
    let mut row = HistoryRow {
        key: key("a\u{E000}b", 0.1),
        iteration: 0,
        natural_map: 1.0,
    };
    row.key.case = "<script>&".into();
    let svg = plot::residual_history(&[row], None).expect("a figure");
    assert!(!svg.contains("<script>") && svg.contains("&lt;script&gt;&amp;"));
    assert!(svg.contains(">ab<"));
}

/// The same picture with points of its own for every cell.
fn unshared(picture: &Picture) -> Picture {
    let mut own = Picture {
        dim: picture.dim,
        ..Picture::default()
    };
    let mut u = Vec::new();
    for cell in &picture.cells {
        let first = own.points.len();
        for point in &cell.points {
            own.points.push(picture.points[*point]);
            u.push(picture.point_vectors[0].1[*point]);
        }
        let points = (first..own.points.len()).collect();
        own.cells.push(PictureCell {
            shape: cell.shape,
            points,
        });
    }
    own.point_vectors
        .push((picture.point_vectors[0].0.clone(), u));
    own
}

#[test]
fn figures_do_not_depend_on_whether_cells_share_points() {
    let plane = |picture: &Picture| {
        plot::displacement_contours(picture, Magnification::Auto, "").expect("a figure")
    };
    assert_eq!(plane(&plate()), plane(&unshared(&plate())));
    // Patches at one depth may come in another order.
    let solid = |picture: &Picture| {
        let svg = plot::solid_displacement(picture, Axis3::X, Magnification::Auto, "");
        let mut lines: Vec<String> = svg.expect("a figure").lines().map(str::to_owned).collect();
        lines.sort();
        lines
    };
    assert!(solid(&beam()) == solid(&unshared(&beam())));
}

#[test]
fn cells_without_a_finite_displacement_are_left_out() {
    let mut picture = plate();
    picture.point_vectors[0].1[200] = [f64::NAN; 3];
    let svg = plot::displacement_contours(&picture, Magnification::Auto, "").expect("a figure");
    assert!(!svg.contains("NaN") && svg.contains("[mm]"));
    let mut solid = beam();
    solid.point_vectors[0].1[3] = [f64::NAN; 3];
    plot::solid_displacement(&solid, Axis3::Y, Magnification::Auto, "").expect("a figure");
}
