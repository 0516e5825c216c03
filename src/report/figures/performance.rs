//! Performance profiles of the time of the methods, a panel per accuracy tier.

use super::kind::Kind;
use super::runs::least;
use crate::report::number::{fixed, significant};
use crate::report::plot::{Axis, Draw, Figure, Panel, Series, looks, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::costs::Costs;
use crate::studies::analysis::profile::performance;
use crate::studies::analysis::test_set::TestSet;
use stickslip_methods::Tier;

/// The kind.
pub static KIND: Kind = Kind {
    file: "*profile.time.svg",
    question: "How often is a method fastest, and how often within a factor of the fastest?",
    shows: "Fraction of the problems that a method solves within a multiple of the time of the fastest method on \
            each of them (Dolan and Moré), a panel per accuracy tier; a problem without right answer of a method is \
            solved at no multiple. One of all problems, and one per family of problem files.",
};

/// A tier in headings.
fn heading(tier: Tier) -> String {
    let tolerance = significant(tier.tolerance(), 1);
    format!("tier {tier}: natural map ≤ {tolerance}")
}

/// The figure of all tiers; `own`: how its file name begins; `caveat`: what the caption says of a sweep that is not complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(
    bundle: &mut Bundle,
    own: &str,
    sets: &[TestSet<'_>],
    caveat: &str,
) -> Result<(), ReportError> {
    let (mut panels, mut counts, mut title) = (Vec::new(), Vec::new(), String::new());
    for set in sets {
        let costs = Costs::new(set);
        let curves = performance(&costs);
        let x = Axis::log("time of the method / least of all methods [-]").through(&[1.0]);
        let y = Axis::linear("fraction of the problems [-]").through(&[0.0]);
        let mut panel = Panel::new(x, y, 60.0);
        panel.heading = heading(set.tier);
        let at_once = |steps: &[[f64; 2]]| steps.iter().find(|s| s[0] <= 1.0).map_or(0.0, |s| s[1]);
        let wins = curves
            .iter()
            .map(|curve| (at_once(&curve.steps), curve.method));
        let best = least(wins, |win| -win.0);
        // The sentence is that of the finest tier.
        if let Some((share, method)) = best {
            let (share, method) = (fixed(100.0 * share, 0), plain(method));
            let tier = set.tier;
            title = format!(
                "{method} is most often fastest: on {share} % of the problems at tier {tier}"
            );
        }
        let labels: Vec<&str> = curves.iter().map(|curve| curve.method).collect();
        let further: Vec<&str> = best.iter().map(|best| best.1).collect();
        for (curve, (label, style)) in curves.iter().zip(looks(&labels, &further)) {
            let steps = curve.steps.iter().copied().filter(|step| step[1] > 0.0);
            let mut series = Series::new(label, style, steps.collect());
            series.draw = Draw::Stairs;
            panel.series.push(series);
        }
        panels.push(panel);
        let unsolved = match costs.unsolved() {
            0 => String::new(),
            count => format!(" ({count} solved by none)"),
        };
        let width = fixed(100.0 * costs.median_width(), 0);
        let problems = costs.problems();
        counts.push(format!(
            "{problems} problems{unsolved}, intervals of {width} %"
        ));
    }
    let counts = counts.join("; ");
    let caption = format!("{counts}{caveat}; ratios of medians within the intervals mean nothing");
    KIND.add(bundle, own, Figure::new(&title, &caption, 3, panels).svg()?)
}
