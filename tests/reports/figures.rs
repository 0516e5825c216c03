//! Figures say what they show, keep to their paper, come out the same twice, and hide nothing.

use crate::report_data::figures::{comparison_of_methods, figures, of_results, one};
use crate::report_data::{answer, beam_step, cycle, key, plate_step, points, results, solved};
use stickslip::report::figures::CATALOGUE;
use stickslip::report::plot;
use stickslip::run::registry::methods;
use stickslip::studies::measure::Answer;
use stickslip::studies::results::Results;

/// Values of an attribute of all elements of a name.
fn attributes<'a>(svg: &'a str, element: &str, name: &str) -> Vec<&'a str> {
    let elements = svg
        .split('<')
        .filter(|rest| rest.starts_with(&format!("{element} ")));
    let value = |rest: &'a str| {
        let head = rest.split('>').next()?;
        let value = head.split(&format!("{name}=\"")).nth(1)?;
        value.split('"').next()
    };
    elements.filter_map(value).collect()
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
        let letters = text.split('<').map(|p| p.rsplit('>').next().unwrap_or(p));
        let letters: usize = letters.map(|p| p.chars().count()).sum();
        // Slightly narrow: an estimate must not see what is not there.
        let (size, x, y) = (number("font-size")?, number("x")?, number("y")?);
        let width = 0.4 * size * letters as f64;
        let start = match attribute("text-anchor").as_deref() {
            Some("middle") => x - 0.5 * width,
            Some("end") => x - width,
            _ => x,
        };
        let half = 0.25 * size;
        let corners = [start, start + width, y - half, y + half];
        attribute("transform")
            .is_none()
            .then(|| (text.trim().to_owned(), corners))
    };
    svg.split("<text").skip(1).filter_map(element).collect()
}

#[test]
fn every_figure_is_of_one_kind_of_the_catalogue() {
    let figures = figures();
    for (name, _) in &figures {
        let kinds = CATALOGUE.iter().filter(|(_, kind)| kind.has(name));
        assert_eq!(kinds.count(), 1, "{name}");
    }
    for (index, (_, kind)) in CATALOGUE.iter().enumerate() {
        assert!(kind.question.ends_with('?') && kind.shows.ends_with('.'));
        assert!(
            CATALOGUE[..index]
                .iter()
                .all(|other| other.1.file != kind.file)
        );
    }
    let drawn = CATALOGUE
        .iter()
        .filter(|(_, kind)| figures.iter().any(|(name, _)| kind.has(name)));
    assert!(drawn.count() >= 6, "those of runs, and of made-up rows");
}

#[test]
fn texts_do_not_overlap_and_are_large_enough() {
    for (name, svg) in figures() {
        let boxes = boxes(&svg);
        assert!(boxes.len() >= 6, "{name}: {}", boxes.len());
        for (index, (text, a)) in boxes.iter().enumerate() {
            for (other, b) in &boxes[..index] {
                let apart = a[1] <= b[0] || b[1] <= a[0] || a[3] <= b[2] || b[3] <= a[2];
                assert!(apart, "{name}: {text} {a:?} and {other} {b:?}");
            }
        }
        let private = svg.chars().find(|c| ('\u{E000}'..='\u{F8FF}').contains(c));
        assert_eq!(private, None, "{name} holds a mark of the typesetting");
    }
}

#[test]
fn figures_stay_inside_their_paper_of_one_or_two_columns() {
    for (name, svg) in figures() {
        let width = attributes(&svg, "svg", "width")[0];
        assert!(["85.00mm", "170.00mm"].contains(&width), "{name}: {width}");
        assert!(
            !svg.contains("NaN") && !svg.contains("-2147483648"),
            "{name}"
        );
        let view = attributes(&svg, "svg", "viewBox")[0].split(' ').skip(2);
        let size: Vec<f64> = view.map(|n| n.parse().expect("a number")).collect();
        let lines = attributes(&svg, "path", "d");
        assert!(!lines.is_empty(), "{name}");
        for points in lines {
            for pair in points.split([' ', 'M']).filter(|pair| !pair.is_empty()) {
                let (x, y) = pair.split_once(',').expect("a pair");
                let at: [f64; 2] = [x, y].map(|n| n.parse().expect("a number"));
                let inside = (0..2).all(|c| at[c] >= 0.0 && at[c] <= size[c]);
                assert!(inside, "{name}: {at:?} of {size:?}");
            }
        }
    }
}

#[test]
fn equal_data_give_equal_bytes_in_any_order() {
    assert_eq!(figures(), figures());
    let mut all = comparison_of_methods();
    let before = of_results(&all);
    all.answers.reverse();
    for own in &mut all.answers {
        own.points.iter_mut().for_each(|points| points.reverse());
    }
    assert_eq!(before, of_results(&all));
}

#[test]
fn all_methods_are_told_or_counted() {
    let svg = one(&comparison_of_methods(), ".residual.svg");
    let named = methods()
        .iter()
        .filter(|m| svg.contains(&format!(">{}<", m.name)));
    let named = named.count();
    let others = methods().len() - named;
    assert!(
        named >= 6 && svg.contains(&format!(">{others} other methods<")),
        "{named}"
    );
    assert!(svg.contains("violation of the contact laws [-]") && svg.contains("iteration [-]"));
    for (index, method) in methods().iter().enumerate() {
        let look = |label: &str| plot::looks(&[label], &[label]).remove(0).1;
        assert_eq!(look(method.name).filled, method.exact, "{}", method.name);
        assert_eq!(
            plot::rank(method.name),
            index,
            "in the order of the registry"
        );
    }
}

#[test]
fn methods_that_agree_share_a_band_and_others_stand_out() {
    let mut all = comparison_of_methods();
    for own in &mut all.answers {
        own.points = vec![points("b-newton", 0.1)];
    }
    let exact = methods().iter().filter(|method| method.exact).count();
    let band = |count: usize, apart: &str| format!("{count} exact methods agree to {apart}");
    let svg = one(&all, ".profile.svg");
    assert!(svg.contains(&band(exact, "1e-12")) && !svg.contains(">latin<"));
    assert!(svg.contains(">closed form<"), "the case has one");
    for (method, factor) in [("latin", 1.02), ("nsgs", 1.0 - 4e-4)] {
        let mut runs = all.answers.iter_mut();
        let own = runs.find(|own| own.record.found.method == method);
        let points = own.expect("a run").points.iter_mut().flatten();
        points.for_each(|point| point.p_n *= factor);
    }
    let svg = one(&all, ".profile.svg");
    assert!(
        svg.contains(&band(exact - 1, "0.0004")),
        "one within the width of a line"
    );
    assert!(svg.contains(">latin<") && svg.contains("latin is off by up to 2 %"));
    all.exact.iter_mut().for_each(|row| row.key.increment = 2);
    let other = one(&all, ".profile.svg");
    assert!(
        !other.contains(">closed form<"),
        "that of another increment"
    );
}

/// Goal: forces of open points that the tolerance leaves, a billionth of the reference force, have no axis of their own.
#[test]
fn what_the_tolerance_leaves_of_forces_is_drawn_as_zero() {
    let axis = |factor: f64| {
        let mut results = comparison_of_methods();
        let points = results.answers.iter_mut().flat_map(|own| &mut own.points);
        for point in points.flatten() {
            // P_ref is 1e8 N/m, the tier high: 0.1 N/m.
            point.p_n = factor * point.weight;
            (point.p_a, point.status) = (0.0, "open".into());
        }
        results.exact.clear();
        let svg = one(&results, ".profile.svg");
        svg.contains("[mPa]")
    };
    // A weight of 1.2 m.
    assert!(!axis(0.05) && axis(0.2));
}

#[test]
fn only_paths_that_run_back_are_loops() {
    assert!(one(&cycle(), ".loop.svg").contains("mean slip [mm]"));
    for increments in [3, 4] {
        let mut short = cycle();
        for own in &mut short.answers {
            own.record.found.increments.truncate(increments);
        }
        assert!(
            of_results(&short).is_empty(),
            "{increments} increments, or only forth"
        );
    }
}

#[test]
fn sparse_data_and_hostile_names_are_drawn() {
    let mut results = Results::default();
    let mut key = key("a\u{E000}b", 0.1);
    key.case = "<script>&".into();
    results.answers.push(Answer {
        histories: vec![vec![0.0, f64::NAN]],
        ..answer(&key, vec![solved(1)])
    });
    let svg = one(&results, ".residual.svg");
    assert!(!svg.contains("NaN") && !svg.contains("<script>"));
    assert!(svg.contains("&lt;script&gt;&amp;") && svg.contains(">ab<"));
    results.answers[0].histories[0].remove(0);
    assert!(
        of_results(&results).is_empty(),
        "nothing to draw is no figure"
    );
}

#[test]
fn contour_bands_cover_the_body_without_holes() {
    let mut flat = plate_step();
    // Its legend would come first.
    flat.crack = Default::default();
    flat.body.point_vectors[0]
        .1
        .iter_mut()
        .for_each(|u| *u = [0.0; 3]);
    // The lowest band is filled everywhere: as one outline of exactly the body's area.
    let svg = plot::displacement(&flat, "a body at rest").expect("a figure");
    let points = attributes(&svg, "polygon", "points")[0].split_whitespace();
    let corners = points.filter_map(|pair| pair.split_once(','));
    let corners = corners.map(|(x, y)| [x, y].map(|n| n.parse::<f64>().expect("a number")));
    let corners: Vec<[f64; 2]> = corners.collect();
    let sides = (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
    let twice_area: f64 = sides.map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
    let x = || corners.iter().map(|c| c[0]);
    let width = x().fold(0.0, f64::max) - x().fold(f64::INFINITY, f64::min);
    assert!(
        (0.5 * twice_area.abs() - width * width).abs() < 1.0,
        "a square"
    );
}

#[test]
fn pictures_name_what_they_lack_and_leave_out_what_has_no_place() {
    let error = plot::displacement(&beam_step(), "").expect_err("a solid");
    assert!(error.to_string().contains("3 dimensions"), "{error}");
    let mut bare = plate_step();
    bare.body.point_vectors.clear();
    let error = plot::displacement(&bare, "").expect_err("no vector");
    assert!(error.to_string().contains("displacement_m"), "{error}");
    let mut broken = plate_step();
    broken.body.point_vectors[0].1[200] = [f64::NAN; 3];
    let svg = plot::displacement(&broken, "").expect("a figure");
    assert!(!svg.contains("NaN") && svg.contains("[mm]"));
}

#[test]
fn the_solid_behind_a_crack_is_a_body_and_the_rest_an_outline() {
    let svg = plot::contact_status(&beam_step(), "").expect("a figure");
    let fills = attributes(&svg, "polygon", "fill");
    let count = |colour: &str| fills.iter().filter(|fill| **fill == colour).count();
    let tints = ["#5687BE", "#F4C878"].map(count);
    assert_eq!(tints, [2, 2], "a region and a sample each");
    // Three sides of the lower half are in sight, the top one below the crack: 6 x 5, 18 x 5 and 6 x 18 cells.
    let greys = fills.len() - count("#000000") - count("#FFFFFF") - 4;
    assert_eq!(greys, 30 + 90 + 108);
    let mut bare = beam_step();
    bare.crack.point_scalars.clear();
    let error = plot::contact_status(&bare, "").expect_err("no status");
    assert!(error.to_string().contains("status"), "{error}");
}

#[test]
fn solids_have_no_painted_fields() {
    let mut results = results();
    results.answers.truncate(1);
    results.answers[0].fields = vec![beam_step()];
    let all = of_results(&results);
    let own = all.iter().filter(|(name, _)| name.ends_with(".state.svg"));
    let own: Vec<&String> = own.map(|(_, svg)| svg).collect();
    assert!(own.len() == 1 && !own[0].contains("Displacement"));
}
