//! Converged reactions of the paper's plate: distance from the limit against the cell width.

use super::runs::friction;
use super::{Bundle, Kind, ReportError};
use crate::report::number::significant;
use crate::report::plot::{Axis, Figure, Guide, Panel, Series, Style, italic};
use crate::studies::paper::converged_reactions::{
    Agreement, ConvergedRow, SequenceRow, agreements,
};
use crate::studies::paper::plate_series::RefinementRow;

/// What it is.
pub static KIND: Kind = Kind {
    file: "converged.svg",
    question: "What are the reactions of the plate without discretisation error, and how far off are the printed ones?",
    shows: "Relative distance of the reaction at the top of the paper's plate from its limit (mean over three meshes) against the \
            cell width, a panel per friction coefficient: star multipliers with tips enriched within a fixed radius, and edge \
            pairs with enriched tip cells as in the paper; the triangle has the order that the corners of the plate allow.",
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
        (
            row.friction,
            format!("Mesh {}, star", row.mesh),
            [row.h_m, row.reaction_mn_per_m],
        )
    });
    let pairs = edge_pairs.iter().map(|row| {
        (
            row.friction,
            format!("Mesh {}, edge pairs", row.family),
            [row.h_m, row.reaction_mn_per_m],
        )
    });
    let points: Vec<(f64, String, [f64; 2])> = star.chain(pairs).collect();
    let mut labels: Vec<&str> = Vec::new();
    for (_, label, _) in &points {
        if !labels.contains(&label.as_str()) {
            labels.push(label);
        }
    }
    let panel = |Agreement {
                     friction: mu,
                     mean_mn_per_m: mean,
                     ..
                 }: Agreement| {
        let x = Axis::log(&format!("cell width {} [m]", italic("h")));
        let mut panel = Panel::new(x, Axis::log("relative distance from the limit [-]"), 48.0);
        panel.heading = format!("{}, limit {} MN/m", friction(mu), significant(mean, 6));
        for (index, label) in labels.iter().enumerate() {
            let own = points
                .iter()
                .filter(|(friction, name, _)| *friction == mu && name == label);
            let own = own.map(|(_, _, [h, reaction])| [*h, ((reaction - mean) / mean).abs()]);
            panel
                .series
                .push(Series::new(*label, Style::curve(index), own.collect()));
        }
        let label = format!("order {CORNER_ORDER} of the corners");
        panel.guides.push(Guide {
            rise: CORNER_ORDER,
            run: 1.0,
            label,
        });
        panel
    };
    let panels: Vec<Panel> = agreements(limits).into_iter().map(panel).collect();
    let off = limits
        .iter()
        .filter_map(|row| Some((row, row.printed_difference()?)));
    let worst = off.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let title = worst.map_or(
        "Reactions of the plate under refinement".to_owned(),
        |(row, difference)| {
            let side = if difference < 0.0 { "below" } else { "above" };
            let percent = significant(100.0 * difference.abs(), 2);
            format!(
                "The printed reactions lie up to {percent} % {side} the converged ones ({})",
                friction(row.friction)
            )
        },
    );
    let columns = panels.len();
    let caption = "plate of the founding paper; star: tips enriched within a fixed radius; edge pairs: tip cells enriched, as printed";
    KIND.add(
        bundle,
        "",
        Figure::new(title, caption, panels).columns(columns).svg()?,
    )
}
