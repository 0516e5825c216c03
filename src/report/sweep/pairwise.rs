//! Methods two by two: counts, a matrix of wins, and profiles of the best method against each other one.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::records::{SweepRecords, tier_heading};
use crate::report::csv::{self, Row};
use crate::report::number::significant;
use crate::report::plot::{
    Matrix, MethodCurve, MethodPanel, MethodPanels, matrix, method_panels, stairs,
};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::compare_methods;
use crate::studies::sweep::analysis::costs::{Costs, Measure};
use crate::studies::sweep::analysis::pairwise::{Duel, Pair, duels, pairs};
use crate::studies::sweep::analysis::profile::Curve;
use crate::studies::sweep::analysis::ranking::ranking;

/// Digits of bounds and fractions.
const DIGITS: usize = 6;

/// Adds `pairwise.csv`, `pairwise_profiles.csv` and their figures, of times.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let (mut rows, mut duel_rows) = (Vec::new(), Vec::new());
    for set in &sweep.sets {
        let costs = Costs::new(set, Measure::Time);
        let own = pairs(&costs);
        if costs.problems() == 0 || own.is_empty() {
            continue;
        }
        let figure = wins(&own, &costs, set.tier, &sweep.caveat());
        bundle.add(
            format!("figures/pairwise.{}.svg", set.tier),
            matrix(&figure)?,
        )?;
        let tier = set.tier;
        rows.extend(own.into_iter().map(|pair| PairRow { tier, pair }));
        let best = ranking(&costs).and_then(|ranking| {
            let best = ranking.standings.first()?.method;
            costs.methods.iter().position(|method| *method == best)
        });
        let Some(best) = best else { continue };
        let duels = duels(&costs, best);
        let figure = duel_figure(&duels, costs.problems(), set.tier, &sweep.caveat());
        if let Some(svg) = method_panels(&figure)? {
            bundle.add(format!("figures/pairwise_profiles.{tier}.svg"), svg)?;
        }
        duel_rows.extend(duels.iter().flat_map(|duel| DuelRow::all(duel, tier)));
    }
    bundle.add(PairRow::FILE, csv::file(&rows)?)?;
    Ok(bundle.add(DuelRow::FILE, csv::file(&duel_rows)?)?)
}

struct PairRow<'a> {
    tier: Tier,
    pair: Pair<'a>,
}

impl Row for PairRow<'_> {
    const FILE: &'static str = "pairwise.csv";
    const COLUMNS: &'static [&'static str] = &[
        "tier", "method", "other", "problems", "wins", "ties", "losses", "neither",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let Pair {
            method,
            other,
            problems,
            wins,
            ties,
            losses,
            neither,
        } = &self.pair;
        let mut cells = vec![
            self.tier.to_string(),
            (*method).to_owned(),
            (*other).to_owned(),
        ];
        cells.extend([problems, wins, ties, losses, neither].map(usize::to_string));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_tiers(self.tier, other.tier)
            .then_with(|| compare_methods(self.pair.method, other.pair.method))
            .then_with(|| compare_methods(self.pair.other, other.pair.other))
    }
}

fn compare_tiers(a: Tier, b: Tier) -> Ordering {
    b.tolerance().total_cmp(&a.tolerance())
}

#[derive(Clone)]
struct DuelRow {
    tier: Tier,
    first: String,
    other: String,
    method: String,
    step: [f64; 2],
}

impl DuelRow {
    fn all(duel: &Duel<'_>, tier: Tier) -> Vec<Self> {
        let of = |curve: &Curve<'_>| -> Vec<Self> {
            let steps = curve.steps.iter();
            steps
                .map(|step| Self {
                    tier,
                    first: duel.first.method.to_owned(),
                    other: duel.second.method.to_owned(),
                    method: curve.method.to_owned(),
                    step: *step,
                })
                .collect()
        };
        [of(&duel.first), of(&duel.second)].concat()
    }
}

impl Row for DuelRow {
    const FILE: &'static str = "pairwise_profiles.csv";
    const COLUMNS: &'static [&'static str] =
        &["tier", "first", "other", "method", "tau", "fraction"];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let [tau, fraction] = self.step.map(|x| significant(x, DIGITS));
        vec![
            self.tier.to_string(),
            self.first.clone(),
            self.other.clone(),
            self.method.clone(),
            tau,
            fraction,
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_tiers(self.tier, other.tier)
            .then_with(|| compare_methods(&self.other, &other.other))
            .then_with(|| compare_methods(&self.method, &other.method))
            .then(self.step[0].total_cmp(&other.step[0]))
    }
}

fn wins(pairs: &[Pair<'_>], costs: &Costs<'_>, tier: Tier, caveat: &str) -> Matrix {
    let fraction = |method: &str, other: &str| {
        let pair = pairs
            .iter()
            .find(|p| p.method == method && p.other == other)?;
        Some(pair.wins as f64 / pair.problems as f64)
    };
    let row = |method: &&str| -> Vec<Option<f64>> {
        let others = costs.methods.iter();
        others.map(|other| fraction(method, other)).collect()
    };
    Matrix {
        title: format!("Faster beyond the intervals, tier {tier}"),
        caption: format!(
            "{}{caveat}\npercentage of {} problems on which the row is right and faster than the column beyond the intervals, or right alone",
            tier_heading(tier),
            costs.problems()
        ),
        names: costs.methods.iter().map(|m| (*m).to_owned()).collect(),
        fractions: costs.methods.iter().map(row).collect(),
    }
}

fn duel_figure(duels: &[Duel<'_>], problems: usize, tier: Tier, caveat: &str) -> MethodPanels {
    let steps = duels
        .iter()
        .flat_map(|duel| duel.first.steps.iter().chain(&duel.second.steps));
    let largest = steps.map(|step| step[0]).fold(0.0, f64::max);
    let curve = |curve: &Curve<'_>| MethodCurve {
        method: curve.method.to_owned(),
        points: stairs(&curve.steps, 1.15 * largest),
        whiskers: Vec::new(),
    };
    let panel = |duel: &Duel<'_>| MethodPanel {
        heading: duel.second.method.to_owned(),
        x_label: "time / least of the two [-]".into(),
        curves: [&duel.first, &duel.second].map(curve).into(),
        guides: Vec::new(),
    };
    let ever_right = |duel: &&Duel<'_>| duel.second.steps.iter().any(|step| step[1] > 0.0);
    let best = duels.first().map_or("", |duel| duel.first.method);
    MethodPanels {
        title: format!("Performance profiles of two methods, tier {tier}"),
        caption: format!(
            "{}, {problems} problems{caveat}\n{best} (least shifted geometric mean) against each other method alone that is ever right",
            tier_heading(tier)
        ),
        y_label: "fraction [-]".into(),
        logarithmic: false,
        every_point: false,
        columns: 5,
        height: 26.0,
        panels: duels.iter().filter(ever_right).map(panel).collect(),
    }
}
