//! Mean time of every method at every accuracy.

use super::performance::heading;
use super::{Bundle, Kind, ReportError};
use crate::report::number::significant;
use crate::report::plot::{Axis, Figure, Panel, Series, Style, plain};
use crate::studies::sweep::analysis::costs::Costs;
use crate::studies::sweep::analysis::ranking::{PENALTY, Ranking, ranking};
use crate::studies::sweep::analysis::test_set::TestSet;
use stickslip_methods::Tier;

/// What it is.
pub static KIND: Kind = Kind {
    file: "fastest.svg",
    question: "Which method is fastest at which accuracy?",
    shows: "Shifted geometric mean of the time of every method over all problems with its interval, a panel per accuracy tier, methods \
            in the order of the finest tier; in brackets the ranks that they may have there. A problem without right answer counts \
            ten times the slowest right one.",
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
    let mut names: Vec<&str> = Vec::new();
    for standing in found.iter().rev().flat_map(|(_, ranked)| &ranked.standings) {
        if !names.contains(&standing.method) {
            names.push(standing.method);
        }
    }
    let rank = |name: &&str| match finest
        .standings
        .iter()
        .find(|s| s.method == *name)
        .map(|s| s.rank)
    {
        Some([first, last]) if first == last => format!("{} ({first})", plain(name)),
        Some([first, last]) => format!("{} ({first}–{last})", plain(name)),
        None => plain(name),
    };
    let y = Axis::names("", names.iter().map(rank));
    let panel = |(tier, ranked): &(Tier, Ranking<'_>)| {
        let mut panel = Panel::new(Axis::log("mean time of the method [s]"), y.clone(), 0.0);
        panel.heading = heading(*tier);
        for standing in &ranked.standings {
            let row = names
                .iter()
                .position(|name| *name == standing.method)
                .unwrap_or(0);
            let style = Style {
                width: 0.0,
                ..Style::of_method(standing.method)
            };
            let point = [standing.mean.value, row as f64];
            let best = standing.rank[0] == 1;
            let mut series = Series::new("", style, vec![point]);
            series.intervals = vec![[standing.mean.low, standing.mean.high]];
            series.texts = vec![if best {
                "fastest".into()
            } else {
                String::new()
            }];
            panel.series.push(series);
        }
        panel
    };
    let first = |ranked: &Ranking<'_>| -> Vec<String> {
        ranked
            .standings
            .iter()
            .filter(|s| s.rank[0] == 1)
            .map(|s| plain(s.method))
            .collect()
    };
    let told: Vec<(String, String)> = found
        .iter()
        .map(|(tier, ranked)| (first(ranked).join(" or "), tier.to_string()))
        .collect();
    let title = match told.windows(2).all(|pair| pair[0].0 == pair[1].0) {
        true => format!("{} is fastest at every accuracy", told[0].0),
        false => {
            let parts: Vec<String> = told
                .iter()
                .map(|(who, tier)| format!("{who} at {tier}"))
                .collect();
            format!("Fastest: {}", parts.join(", "))
        }
    };
    let caption = format!(
        "shifted geometric mean over {} problems{caveat}; a problem without right answer counts {} times the slowest right one; in \
         brackets: ranks at tier {}; methods whose intervals overlap share a rank",
        finest.problems,
        significant(PENALTY, 2),
        found
            .last()
            .map_or(String::new(), |(tier, _)| tier.to_string()),
    );
    let panels: Vec<Panel> = found.iter().map(panel).collect();
    KIND.add(
        bundle,
        "",
        Figure::new(title, caption, panels).columns(3).svg()?,
    )
}
