//! Figures with all methods of the registry in one picture tell them apart.

use crate::report_data::{key, results_of_all_methods};
use stickslip::report::plot;
use stickslip::run::record::PointRow;
use stickslip::run::registry::methods;

#[test]
fn methods_stand_in_the_order_of_the_registry_in_lines_of_equal_width() {
    let all = results_of_all_methods();
    let svg = plot::residual_history(&all.history, None).expect("a figure");
    let places: Vec<usize> = methods()
        .iter()
        .map(|method| svg.find(&format!(">{}<", method.name)).expect("a label"))
        .collect();
    assert!(
        places.windows(2).all(|pair| pair[0] < pair[1]),
        "{places:?}"
    );
    // Of 0.05 mm each: nothing is wider than 1.4 pt.
    let widths = svg
        .split("stroke-width=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next());
    let widest = widths.filter_map(|w| w.parse::<u32>().ok()).max();
    assert_eq!(widest, Some(9));
}

#[test]
fn methods_that_agree_share_a_curve_and_others_have_their_own() {
    let mut points: Vec<PointRow> = Vec::new();
    for method in methods() {
        let mut own = crate::report_data::points(&key("b-newton", 0.1));
        own.iter_mut()
            .for_each(|row| row.key.method = method.name.into());
        points.extend(own);
    }
    let exact = methods().iter().filter(|method| method.exact).count();
    let together = plot::contact_traction(&points, &[], 1).expect("a figure");
    assert!(together.contains(&format!("{exact} exact methods, apart by less than 1e-12")));
    for method in methods() {
        assert!(together.contains(method.name), "{} is named", method.name);
        assert!(
            !together.contains(&format!(">{}<", method.name)),
            "{}",
            method.name
        );
    }
    for row in points.iter_mut().filter(|row| row.key.method == "latin") {
        row.point.p_n *= 1.02;
    }
    for row in points.iter_mut().filter(|row| row.key.method == "nsgs") {
        row.point.p_n *= 1.0 - 4e-4;
    }
    let svg = plot::contact_traction(&points, &[], 1).expect("a figure");
    assert!(svg.contains(">latin<"), "one that differs stands alone");
    let fewer = format!("{} exact methods, apart by at most 0.0004", exact - 1);
    assert!(svg.contains(&fewer));
    // The same laws with another status at a point are another answer, whatever the forces.
    for row in points
        .iter_mut()
        .filter(|row| row.key.method == "tresca" && row.point.number == 5)
    {
        row.point.status = "stick".into();
    }
    let svg = plot::contact_traction(&points, &[], 1).expect("a figure");
    let fewer = format!("{} exact methods", exact - 2);
    assert!(svg.contains(&fewer) && svg.contains(">tresca<"));
}
