//! Performance and data profiles as rows and figures, those of counters and those of times in files of their own.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::records::{SweepRecords, tier_heading};
use crate::report::csv::{self, Row};
use crate::report::number::{fixed, significant};
use crate::report::plot::{MethodCurve, MethodPanel, MethodPanels, method_panels, stairs};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::compare_methods;
use crate::studies::sweep::analysis::costs::{Costs, Measure};
use crate::studies::sweep::analysis::profile::{Budget, Curve, data, performance};
use crate::studies::sweep::analysis::test_set::TestSet;

/// Digits of bounds and fractions.
const DIGITS: usize = 6;
/// Height of a panel of many methods [mm].
const HEIGHT_MM: f64 = 66.0;

/// Adds `profiles.csv`, `time_profiles.csv`, `data_profiles.csv`, `time_data_profiles.csv` and their figures.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let mut counters = Vec::new();
    for measure in Measure::COUNTERS {
        let tiers = tiers(sweep, measure, performance);
        add_performance(bundle, sweep, measure, &tiers)?;
        counters.extend(profile_rows(measure.name(), &tiers));
    }
    let times = tiers(sweep, Measure::Time, performance);
    add_performance(bundle, sweep, Measure::Time, &times)?;
    bundle.add(ProfileRow::FILE, csv::file(&counters)?)?;
    let times = profile_rows(Measure::Time.name(), &times);
    bundle.add("time_profiles.csv", csv::file(&times)?)?;
    for (budget, file) in [
        (Budget::Passes, "data_profiles.csv"),
        (Budget::Factorisations, "time_data_profiles.csv"),
    ] {
        let tiers = tiers(sweep, budget.measure(), |costs| data(costs, budget));
        add_data(bundle, sweep, budget, &tiers)?;
        let rows: Vec<DataRow> = profile_rows(budget.name(), &tiers)
            .into_iter()
            .map(DataRow)
            .collect();
        bundle.add(file, csv::file(&rows)?)?;
    }
    Ok(())
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

fn tiers<'a>(
    sweep: &SweepRecords<'a>,
    measure: Measure,
    curves: impl Fn(&Costs<'a>) -> Vec<Curve<'a>>,
) -> Vec<TierCurves<'a>> {
    let of = |set: &TestSet<'a>| {
        let costs = Costs::new(set, measure);
        TierCurves {
            tier: set.tier,
            problems: costs.problems(),
            unsolved: costs.unsolved(),
            width: costs.median_width(),
            curves: curves(&costs),
        }
    };
    sweep.sets.iter().map(of).collect()
}

/// A step of a profile.
struct ProfileRow {
    measure: &'static str,
    tier: Tier,
    method: String,
    step: [f64; 2],
    problems: usize,
}

fn profile_rows(measure: &'static str, tiers: &[TierCurves<'_>]) -> Vec<ProfileRow> {
    let of_tier = |tier: &TierCurves<'_>| {
        let (name, problems) = (tier.tier, tier.problems);
        let of_curve = |curve: &Curve<'_>| {
            let method = curve.method.to_owned();
            let steps = curve.steps.clone().into_iter();
            steps.map(move |step| ProfileRow {
                measure,
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

impl Row for ProfileRow {
    const FILE: &'static str = "profiles.csv";
    const COLUMNS: &'static [&'static str] =
        &["measure", "tier", "method", "tau", "fraction", "problems"];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let [bound, fraction] = self.step.map(|x| significant(x, DIGITS));
        vec![
            self.measure.into(),
            self.tier.to_string(),
            self.method.clone(),
            bound,
            fraction,
            self.problems.to_string(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let tolerance = |row: &Self| row.tier.tolerance();
        (self.measure.cmp(other.measure))
            .then(tolerance(other).total_cmp(&tolerance(self)))
            .then_with(|| compare_methods(&self.method, &other.method))
            .then(self.step[0].total_cmp(&other.step[0]))
    }
}

/// A step of a data profile.
struct DataRow(ProfileRow);

impl Row for DataRow {
    const FILE: &'static str = "data_profiles.csv";
    const COLUMNS: &'static [&'static str] =
        &["budget", "tier", "method", "alpha", "fraction", "problems"];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        self.0.cells()
    }

    fn order(&self, other: &Self) -> Ordering {
        self.0.order(&other.0)
    }
}

fn add_performance(
    bundle: &mut Bundle,
    sweep: &SweepRecords<'_>,
    measure: Measure,
    tiers: &[TierCurves<'_>],
) -> Result<(), ReportError> {
    let note = match measure {
        Measure::Time => format!(
            "profiles use medians, ratios below about 1 + the median width of the intervals ({}) mean nothing",
            widths(tiers)
        ),
        _ => "costs are 1 + the number, the same on every machine".into(),
    };
    let figure = figure(
        format!("Performance profiles: {}", measure.words()),
        format!("{}\n{note}", told(sweep, tiers)),
        format!("{} / least of all methods [-]", measure.words()),
        tiers,
    );
    if let Some(svg) = method_panels(&figure)? {
        bundle.add(format!("figures/profile.{}.svg", measure.name()), svg)?;
    }
    Ok(())
}

fn add_data(
    bundle: &mut Bundle,
    sweep: &SweepRecords<'_>,
    budget: Budget,
    tiers: &[TierCurves<'_>],
) -> Result<(), ReportError> {
    let x_label = match budget {
        Budget::Passes => "evaluations of the contact law per contact point [-]",
        Budget::Factorisations => "time of the method / factorisation of K [-]",
    };
    let figure = figure(
        format!("Data profiles: {x_label}"),
        told(sweep, tiers),
        x_label.into(),
        tiers,
    );
    if let Some(svg) = method_panels(&figure)? {
        bundle.add(format!("figures/data_profile.{}.svg", budget.name()), svg)?;
    }
    Ok(())
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

fn figure(
    title: String,
    caption: String,
    x_label: String,
    tiers: &[TierCurves<'_>],
) -> MethodPanels {
    let steps = || tiers.iter().flat_map(|t| &t.curves).flat_map(|c| &c.steps);
    let largest = steps().map(|step| step[0]).fold(0.0, f64::max);
    let curve = |curve: &Curve<'_>| MethodCurve {
        method: curve.method.to_owned(),
        points: stairs(&curve.steps, 1.15 * largest),
        whiskers: Vec::new(),
    };
    let panel = |tier: &TierCurves<'_>| MethodPanel {
        heading: tier_heading(tier.tier),
        x_label: x_label.clone(),
        curves: tier.curves.iter().map(curve).collect(),
        guides: Vec::new(),
    };
    MethodPanels {
        title,
        caption,
        y_label: "fraction of the problems [-]".into(),
        logarithmic: false,
        every_point: false,
        columns: 3,
        height: HEIGHT_MM,
        panels: tiers.iter().map(panel).collect(),
    }
}
