//! Performance and data profiles as rows, those of counters and those of times in files of their own.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::records::SweepRecords;
use crate::report::csv::{self, Row};
use crate::report::number::significant;
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::compare_methods;
use crate::studies::sweep::analysis::costs::{Costs, Measure};
use crate::studies::sweep::analysis::profile::{Budget, Curve, data, performance};
use crate::studies::sweep::analysis::test_set::TestSet;

/// Digits of bounds and fractions.
const DIGITS: usize = 6;

/// Adds `profiles.csv`, `time_profiles.csv`, `data_profiles.csv`, `time_data_profiles.csv`.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let mut counters = Vec::new();
    for measure in Measure::COUNTERS {
        let tiers = tiers(sweep, measure, performance);
        counters.extend(profile_rows(measure.name(), &tiers));
    }
    let times = tiers(sweep, Measure::Time, performance);
    bundle.add(ProfileRow::FILE, csv::file(&counters)?)?;
    let times = profile_rows(Measure::Time.name(), &times);
    bundle.add("time_profiles.csv", csv::file(&times)?)?;
    for (budget, file) in [
        (Budget::Passes, "data_profiles.csv"),
        (Budget::Factorisations, "time_data_profiles.csv"),
    ] {
        let tiers = tiers(sweep, budget.measure(), |costs| data(costs, budget));
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
