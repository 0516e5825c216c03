//! Performance profiles of the times as rows and a figure.

use stickslip_methods::Tier;

use super::records::{SweepRecords, tier_heading};
use crate::report::number::fixed;
use crate::report::plot::{MethodCurve, MethodPanel, MethodPanels, method_panels, stairs};
use crate::report::tables::sweep::ProfileRow;
use crate::report::{Bundle, ReportError, table};
use crate::studies::sweep::analysis::costs::Costs;
use crate::studies::sweep::analysis::profile::{Curve, performance};
use crate::studies::sweep::analysis::test_set::TestSet;

/// Height of a panel of many methods [mm].
const HEIGHT_MM: f64 = 66.0;

/// Adds `time_profiles.csv` and its figure.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let tiers: Vec<TierCurves<'_>> = sweep.sets.iter().map(TierCurves::of).collect();
    if let Some(svg) = method_panels(&figure(sweep, &tiers))? {
        bundle.add("figures/profile.time.svg", svg)?;
    }
    table::add(bundle, &profile_rows(&tiers), "")
}

/// The curves of one tier.
struct TierCurves<'a> {
    tier: Tier,
    problems: usize,
    unsolved: usize,
    /// Median relative width of the intervals.
    width: f64,
    curves: Vec<Curve<'a>>,
}

impl<'a> TierCurves<'a> {
    fn of(set: &TestSet<'a>) -> Self {
        let costs = Costs::new(set);
        Self {
            tier: set.tier,
            problems: costs.problems(),
            unsolved: costs.unsolved(),
            width: costs.median_width(),
            curves: performance(&costs),
        }
    }
}

fn profile_rows(tiers: &[TierCurves<'_>]) -> Vec<ProfileRow> {
    let of_tier = |tier: &TierCurves<'_>| {
        let (name, problems) = (tier.tier, tier.problems);
        let of_curve = |curve: &Curve<'_>| {
            let method = curve.method.to_owned();
            let steps = curve.steps.clone().into_iter();
            steps.map(move |step| ProfileRow {
                tier: name,
                method: method.clone(),
                step,
                problems,
            })
        };
        tier.curves.iter().flat_map(of_curve).collect::<Vec<_>>()
    };
    tiers.iter().flat_map(of_tier).collect()
}

/// How many problems stand behind the panels.
fn told(sweep: &SweepRecords<'_>, tiers: &[TierCurves<'_>]) -> String {
    let of = |tier: &TierCurves<'_>| {
        let unsolved = match tier.unsolved {
            0 => String::new(),
            count => format!(" ({count} solved by none)"),
        };
        format!("{}{unsolved}", tier.problems)
    };
    let counts: Vec<String> = tiers.iter().map(of).collect();
    format!("problems: {}{}", counts.join(" / "), sweep.caveat())
}

fn widths(tiers: &[TierCurves<'_>]) -> String {
    let width = |tier: &TierCurves<'_>| {
        if tier.width.is_finite() {
            format!("{} %", fixed(100.0 * tier.width, 0))
        } else {
            "–".into()
        }
    };
    let widths: Vec<String> = tiers.iter().map(width).collect();
    widths.join(" / ")
}

fn figure(sweep: &SweepRecords<'_>, tiers: &[TierCurves<'_>]) -> MethodPanels {
    let steps = || tiers.iter().flat_map(|t| &t.curves).flat_map(|c| &c.steps);
    let largest = steps().map(|step| step[0]).fold(0.0, f64::max);
    let curve = |curve: &Curve<'_>| MethodCurve {
        method: curve.method.to_owned(),
        points: stairs(&curve.steps, 1.15 * largest),
        whiskers: Vec::new(),
    };
    let panel = |tier: &TierCurves<'_>| MethodPanel {
        heading: tier_heading(tier.tier),
        x_label: "time of the method / least of all methods [-]".into(),
        curves: tier.curves.iter().map(curve).collect(),
        guides: Vec::new(),
    };
    MethodPanels {
        title: "Performance profiles: time of the method".into(),
        caption: format!(
            "{}\nprofiles use medians, ratios below about 1 + the median width of the intervals ({}) mean nothing",
            told(sweep, tiers),
            widths(tiers)
        ),
        y_label: "fraction of the problems [-]".into(),
        logarithmic: false,
        every_point: false,
        columns: 3,
        height: HEIGHT_MM,
        panels: tiers.iter().map(panel).collect(),
    }
}
