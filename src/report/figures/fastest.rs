//! Mean time of every method at every accuracy.

use super::kind::Kind;
use super::performance::heading;
use super::runs::distinct;
use crate::report::plot::{Axis, Figure, Panel, Series, Style, plain, rank};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::costs::Costs;
use crate::studies::analysis::ranking::{PENALTY, Ranking, ranking};
use crate::studies::analysis::test_set::TestSet;
use stickslip_methods::Tier;

/// What it is.
pub static KIND: Kind = Kind {
    file: "fastest.svg",
    question: "Which method is fastest at which accuracy?",
    shows: "Shifted geometric mean of the time of every method over all problems with its interval, a panel per \
            accuracy tier, methods in the order of the finest one; numbers: ranks that a method may have. A problem \
            without right answer counts ten times the slowest right one.",
};

/// The figure of all tiers; `caveat`: what the caption says of a sweep that is not complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, sets: &[TestSet<'_>], caveat: &str) -> Result<(), ReportError> {
    let costs: Vec<(Tier, Costs<'_>)> =
        sets.iter().map(|set| (set.tier, Costs::new(set))).collect();
    let found = costs
        .iter()
        .filter_map(|(tier, costs)| Some((*tier, ranking(costs)?)));
    let found: Vec<(Tier, Ranking<'_>)> = found.collect();
    let Some((_, finest)) = found.last() else {
        return Ok(());
    };
    let standings = || {
        found
            .iter()
            .rev()
            .flat_map(|(_, ranking)| &ranking.standings)
    };
    let names = distinct(standings().map(|standing| standing.method));
    let y = Axis::names("", names.iter().map(|name| plain(name)).collect());
    let slowest = standings().map(|s| s.mean.high).fold(0.0, f64::max);
    let mut panels = Vec::new();
    for (tier, ranking) in &found {
        // Room for the ranks behind the intervals.
        let x = Axis::log("mean time of the method [s]").through(&[2.0 * slowest]);
        let mut panel = Panel::new(x, y.clone(), 0.0);
        panel.heading = heading(*tier);
        for (row, name) in names.iter().enumerate() {
            let own = ranking.standings.iter().find(|s| s.method == *name);
            let Some(standing) = own else { continue };
            let style = Style::of_method(name, 0);
            let style = Style {
                width: 0.0,
                ..style
            };
            let point = [standing.mean.value, row as f64];
            let mut series = Series::new("", style, vec![point]);
            series.intervals = vec![[standing.mean.low, standing.mean.high]];
            let [first, last] = standing.rank.map(|rank| rank.to_string());
            let rank = if first == last {
                first
            } else {
                format!("{first}–{last}")
            };
            series.texts = vec![rank];
            panel.series.push(series);
        }
        panels.push(panel);
    }
    let tied = |ranking: &Ranking<'_>| {
        let first = ranking.standings.iter().filter(|s| s.rank[0] == 1);
        let mut names: Vec<&str> = first.map(|s| s.method).collect();
        names.sort_by_key(|name| (rank(name), *name));
        let names: Vec<String> = names.into_iter().map(plain).collect();
        match names.as_slice() {
            [one] => one.clone(),
            all => format!("{}, a tie", all.join(", ")),
        }
    };
    let told: Vec<String> = found.iter().map(|(_, ranking)| tied(ranking)).collect();
    let title = match distinct(&told)[..] {
        [one] => format!("Least mean time at every accuracy: {one}"),
        _ => {
            let parts = found.iter().zip(&told);
            let parts: Vec<String> = parts
                .map(|((tier, _), names)| format!("{tier}: {names}"))
                .collect();
            format!("Least mean time, {}", parts.join("; "))
        }
    };
    let caption = format!(
        "shifted geometric mean over {} problems with its interval{caveat}; a problem without right answer counts \
         {PENALTY} times the slowest right one; numbers: ranks, which methods share whose intervals overlap",
        finest.problems,
    );
    KIND.add(bundle, "", Figure::new(&title, &caption, 3, panels).svg()?)
}
