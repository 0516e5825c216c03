//! Figures carry their labels as text, keep to their paper, come out the same twice, and refuse what they cannot show.

use crate::report_data::figures::figures;
use crate::report_data::{beam, beam_step, cycle, exact, key, plate, points};
use stickslip::model::field_mesh::{FieldCell, FieldMesh};
use stickslip::report::ReportError;
use stickslip::report::plot::{self, Axis3, Curve, CurvePlot, Magnification};
use stickslip::run::record::HistoryRow;

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
        row.point.force_unit = "N".into();
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
        (row.point.slip_a_m, row.point.gap_m, row.point.status) = (1e-19, 0.0, "stick".into());
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
fn unshared(picture: &FieldMesh) -> FieldMesh {
    let mut own = FieldMesh {
        dim: picture.dim,
        ..FieldMesh::default()
    };
    let mut u = Vec::new();
    for cell in &picture.cells {
        let first = own.points.len();
        for point in &cell.points {
            own.points.push(picture.points[*point]);
            u.push(picture.point_vectors[0].1[*point]);
        }
        let points = (first..own.points.len()).collect();
        own.cells.push(FieldCell {
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
    let plane = |picture: &FieldMesh| {
        plot::displacement_contours(picture, Magnification::Auto, "").expect("a figure")
    };
    assert_eq!(plane(&plate()), plane(&unshared(&plate())));
    // Patches at one depth may come in another order.
    let solid = |picture: &FieldMesh| {
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

/// Points of all lines of a colour in a figure.
fn lines_of(svg: &str, colour: &str) -> Vec<Vec<[f64; 2]>> {
    let lines = svg.split("<polyline").skip(1);
    let own = lines.filter(|line| {
        let element = line.split('>').next().unwrap_or_default();
        element.contains(&format!("stroke=\"{colour}\""))
    });
    let points = own.filter_map(|line| line.split("points=\"").nth(1)?.split('"').next());
    let pair = |pair: &str| {
        let (x, y) = pair.split_once(',').expect("a pair");
        [x, y].map(|n| n.parse().expect("a number"))
    };
    let line = |text: &str| text.split_whitespace().map(pair).collect();
    points.map(line).collect()
}

#[test]
fn the_closed_form_is_drawn_where_it_belongs_and_nowhere_else() {
    let rows = points(&key("b-newton", 0.1));
    let curves = |exact: &[_]| {
        let svg = plot::contact_traction(&rows, exact, 1).expect("a figure");
        let lines = lines_of(&svg, "#000000");
        let long = lines.iter().filter(|line| line.len() == 41).count();
        assert_eq!(svg.contains(">exact<"), long > 0);
        long
    };
    assert_eq!(curves(&exact(0.1)), 2, "p_n and |p_t|");
    assert_eq!(curves(&exact(0.8)), 0, "another friction coefficient");
    let mut later = exact(0.1);
    later.iter_mut().for_each(|row| row.increment = 2);
    assert_eq!(curves(&later), 0, "another increment");
    let mut other = exact(0.1);
    other.iter_mut().for_each(|row| row.crack = 2);
    assert_eq!(curves(&other), 0, "another crack");
}

#[test]
fn paths_that_do_not_run_back_are_no_loops() {
    let loop_of = |rows: &[_], crack| plot::friction_loop(rows, crack, &[]).expect("drawn");
    assert!(loop_of(&cycle(), 1).is_some());
    assert!(loop_of(&cycle(), 2).is_none(), "no such crack");
    let mut three = cycle();
    three.retain(|row| row.key.increment <= 3);
    assert!(loop_of(&three, 1).is_none(), "three increments");
    let mut forth = cycle();
    forth.retain(|row| row.key.increment <= 4);
    assert!(loop_of(&forth, 1).is_none(), "only forth");
}

#[test]
fn the_solid_behind_a_crack_is_a_body_and_the_rest_an_outline() {
    let svg = plot::contact_status(&beam_step(), Magnification::Auto, "").expect("a figure");
    // Three sides of the lower half are in sight, the top one below the crack: 6 x 5, 18 x 5 and 6 x 18 cells.
    let greys =
        svg.matches("<polygon").count() - count_of(&svg, "#000000") - count_of(&svg, "#FFFFFF");
    let tints = ["#5687BE", "#F4C878"].map(|tint| count_of(&svg, tint));
    assert_eq!(tints, [2, 2], "a region and a sample each");
    assert_eq!(greys - tints[0] - tints[1], 30 + 90 + 108);
    let mut bare = beam_step();
    bare.crack.point_scalars.clear();
    let error = plot::contact_status(&bare, Magnification::Auto, "").expect_err("no status");
    assert!(error.to_string().contains("status"), "{error}");
    bare.crack.cells.clear();
    assert!(plot::contact_status(&bare, Magnification::Auto, "").is_err());
}

/// Filled polygons of a colour.
fn count_of(svg: &str, colour: &str) -> usize {
    let polygons = svg.split("<polygon").skip(1);
    let own = polygons.filter(|p| {
        let element = p.split('>').next().unwrap_or_default();
        element.contains(&format!("fill=\"{colour}\""))
    });
    own.count()
}
