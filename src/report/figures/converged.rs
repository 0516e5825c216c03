//! Converged reactions of the paper's plate: distance from the limit against the cell width.

use super::kind::Kind;
use super::runs::{distinct, friction, least};
use crate::report::number::significant;
use crate::report::plot::{Axis, Figure, Guide, Panel, Series, Style, italic};
use crate::report::{Bundle, ReportError};
use crate::studies::paper::converged_reactions::{ConvergedRow, SequenceRow, agreements};
use crate::studies::paper::plate_series::RefinementRow;

/// What it is.
pub static KIND: Kind = Kind {
    file: "converged.svg",
    question: "What are the plate's reactions without discretisation error, and how far off are the printed ones?",
    shows: "Relative distance of the reaction at the top of the paper's plate from its limit (mean over three \
            meshes) against the cell width, a panel per friction coefficient: star multipliers with tips enriched \
            within a fixed radius, and edge pairs with enriched tip cells as in the paper.",
};

/// Order that the corners of the plate allow.
const CORNER_ORDER: f64 = 1.4;

/// The figure of all friction coefficients.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(
    bundle: &mut Bundle,
    sequences: &[SequenceRow],
    limits: &[ConvergedRow],
    edge_pairs: &[RefinementRow],
) -> Result<(), ReportError> {
    let star = sequences.iter().map(|row| {
        let label = format!("Mesh {}, star", row.mesh);
        (row.friction, label, row.h_m, row.reaction_mn_per_m)
    });
    let pairs = edge_pairs.iter().map(|row| {
        let label = format!("Mesh {}, edge pairs", row.family);
        (row.friction, label, row.h_m, row.reaction_mn_per_m)
    });
    let points: Vec<(f64, String, f64, f64)> = star.chain(pairs).collect();
    let mut panels = Vec::new();
    for found in agreements(limits) {
        let (mu, mean) = (found.friction, found.mean_mn_per_m);
        let x = Axis::log(&format!("cell width {} [m]", italic("h")));
        let y = Axis::log("relative distance from the limit [-]");
        let mut panel = Panel::new(x, y, 48.0);
        panel.heading = format!("{}, limit {} MN/m", friction(mu), significant(mean, 6));
        let labels = distinct(points.iter().map(|(_, label, ..)| label));
        for (index, label) in labels.into_iter().enumerate() {
            let own = points
                .iter()
                .filter(|point| point.0 == mu && point.1 == *label);
            let own = own.map(|(_, _, h, reaction)| [*h, ((reaction - mean) / mean).abs()]);
            let series = Series::new(label, Style::curve(index), own.collect());
            panel.series.push(series);
        }
        let label = format!("order {CORNER_ORDER} of the corners");
        panel.guides.push(Guide::new(CORNER_ORDER, 1.0, &label));
        panels.push(panel);
    }
    let off = limits
        .iter()
        .filter_map(|row| Some((row, row.printed_difference()?)));
    let worst = least(off, |row| -row.1.abs());
    let title = worst.map_or("The plate under refinement".to_owned(), |(row, off)| {
        let side = if off < 0.0 { "below" } else { "above" };
        let percent = significant(100.0 * off.abs(), 2);
        let at = friction(row.friction);
        format!("The printed reactions lie up to {percent} % {side} the converged ones ({at})")
    });
    let caption = "plate of the founding paper; star: tips enriched within a fixed radius; edge pairs: tip \
                   cells enriched, as printed";
    KIND.add(bundle, "", Figure::new(&title, caption, 3, panels).svg()?)
}
