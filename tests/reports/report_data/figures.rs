//! Figures of made-up results, as the report writes them.

use super::{beam_step, cycle, exact, key, rates, results, results_of_all_methods};
use stickslip::report::{Bundle, Provenance, figures, standard};
use stickslip::studies::paper::comparison::comparison;
use stickslip::studies::results::Results;
use stickslip::studies::rows::RunFields;

/// The figures of a bundle by name, without their folder.
pub fn of(bundle: &Bundle) -> Vec<(String, String)> {
    let svg = |path: &str| {
        let name = path.strip_prefix("figures/")?;
        let bytes = bundle.get(path)?.to_vec();
        Some((name.to_owned(), String::from_utf8(bytes).expect("UTF-8")))
    };
    bundle.paths().filter_map(svg).collect()
}

/// The figures of a run.
pub fn of_results(results: &Results) -> Vec<(String, String)> {
    let bundle = standard::bundle(results, &Provenance::collect(1));
    of(&bundle.expect("a bundle"))
}

/// One figure of a run by the end of its name.
pub fn one(results: &Results, end: &str) -> String {
    let mut found = of_results(results);
    found.retain(|(name, _)| name.ends_with(end));
    assert_eq!(found.len(), 1, "{end}");
    found.remove(0).1
}

/// All methods on one problem, with a closed form.
pub fn comparison_of_methods() -> Results {
    Results {
        exact: exact(0.1),
        ..results_of_all_methods()
    }
}

/// Every kind of figure that made-up results have.
pub fn figures() -> Vec<(String, String)> {
    let mut found = of_results(&results());
    let all = comparison_of_methods();
    let mut bundle = Bundle::new();
    let mut compared = comparison(all.records());
    for (k, row) in compared.iter_mut().enumerate() {
        row.solve_s *= (1 + k) as f64;
    }
    figures::cost::add(&mut bundle, &compared).expect("cost");
    figures::success::add(&mut bundle, &rates(), "").expect("rates");
    let fields = RunFields {
        key: key("hybrid", 0.3),
        steps: &[beam_step()],
    };
    figures::fields::add(&mut bundle, &fields).expect("contact");
    found.extend(of(&bundle));
    let renamed = |(name, svg): (String, String)| (format!("all.{name}"), svg);
    found.extend(of_results(&all).into_iter().map(renamed));
    found.extend(of_results(&cycle()));
    found
}
