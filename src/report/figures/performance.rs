//! Performance profiles of the time of the methods, a panel per accuracy tier.

use super::{Bundle, Kind, ReportError};
use crate::report::number::{fixed, significant};
use crate::report::plot::{Axis, Draw, Figure, Panel, Series, looks, plain};
use crate::studies::sweep::analysis::costs::Costs;
use crate::studies::sweep::analysis::profile::performance;
use crate::studies::sweep::analysis::test_set::TestSet;
use stickslip_methods::Tier;

/// What it is.
pub static KIND: Kind = Kind {
    file: "profile.time.svg",
    question: "How often is a method fastest, and how often within a factor of the fastest?",
    shows: "Fraction of the problems that a method solves within a multiple of the time of the fastest method on each of them \
            (Dolan and Moré), a panel per accuracy tier. A problem without right answer of a method is solved at no multiple.",
};

/// A tier in headings.
pub fn heading(tier: Tier) -> String {
    format!(
        "tier {tier}: natural map ≤ {}",
        significant(tier.tolerance(), 1)
    )
}

/// The figure of all tiers; `caveat`: what the caption says of a sweep that is not complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, sets: &[TestSet<'_>], caveat: &str) -> Result<(), ReportError> {
    let (mut panels, mut counts, mut widths, mut title) =
        (Vec::new(), Vec::new(), Vec::new(), String::new());
    for set in sets {
        let costs = Costs::new(set);
        let curves = performance(&costs);
        let first = |steps: &[[f64; 2]]| steps.iter().find(|s| s[0] <= 1.0).map_or(0.0, |s| s[1]);
        let best = curves
            .iter()
            .max_by(|a, b| first(&a.steps).total_cmp(&first(&b.steps)));
        // The sentence is that of the finest tier.
        title = best.map_or(title, |best| {
            let percent = fixed(100.0 * first(&best.steps), 0);
            format!(
                "{} is most often fastest: on {percent} % of the problems at tier {}",
                plain(best.method),
                set.tier
            )
        });
        let x = Axis::log("time of the method / least of all methods [-]").through(1.0);
        let mut panel = Panel::new(
            x,
            Axis::linear("fraction of the problems [-]").through(0.0),
            60.0,
        );
        panel.heading = heading(set.tier);
        let labels: Vec<&str> = curves.iter().map(|curve| curve.method).collect();
        let further: Vec<&str> = best.iter().map(|curve| curve.method).collect();
        for (curve, (label, style)) in curves.iter().zip(looks(&labels, &further)) {
            let steps = curve
                .steps
                .iter()
                .copied()
                .filter(|step| step[1] > 0.0)
                .collect();
            panel.series.push(Series {
                draw: Draw::Stairs,
                ..Series::new(label, style, steps)
            });
        }
        panels.push(panel);
        let unsolved = match costs.unsolved() {
            0 => String::new(),
            count => format!(" ({count} solved by none)"),
        };
        counts.push(format!("{}{unsolved}", costs.problems()));
        let width = costs.median_width();
        widths.push(if width.is_finite() {
            format!("{} %", fixed(100.0 * width, 0))
        } else {
            "–".into()
        });
    }
    let caption = format!(
        "problems: {}{caveat}; ratios of medians, those below about 1 + the median width of the intervals ({}) mean nothing",
        counts.join(" / "),
        widths.join(" / ")
    );
    KIND.add(
        bundle,
        "",
        Figure::new(title, caption, panels).columns(3).svg()?,
    )
}
