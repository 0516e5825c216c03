//! Converged reactions of the paper's plate: distance from the finest meshes against the cell width.

use super::kind::Kind;
use super::runs::{distinct, friction, least};
use crate::report::number::significant;
use crate::report::plot::{Axis, Figure, Guide, Panel, Series, Style, italic};
use crate::report::{Bundle, ReportError};
use crate::studies::paper::as_printed;
use crate::studies::paper::converged_reactions::{ConvergedRow, SequenceRow};

/// What it is.
pub static KIND: Kind = Kind {
    file: "converged.svg",
    question: "What are the plate's reactions without discretisation error, and how far off are the printed ones?",
    shows: "Relative distance of the reaction at the top of the paper's plate from that of the finest star meshes \
            (mean over three), where it exceeds their error bar, against the cell width, a panel per friction \
            coefficient: star multipliers with tips enriched within a fixed radius, and edge pairs with enriched \
            tip cells as in the paper.",
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
    finest: &[ConvergedRow],
) -> Result<(), ReportError> {
    let label = |row: &SequenceRow| format!("Mesh {}, {}", row.mesh, row.found.variant.space);
    let labels = distinct(sequences.iter().map(label));
    let star: Vec<&ConvergedRow> = finest.iter().filter(|row| row.is_star()).collect();
    let mut panels = Vec::new();
    for mu in distinct(star.iter().map(|row| row.finest.variant.friction)) {
        let own = star.iter().filter(|row| row.finest.variant.friction == mu);
        let reactions: Vec<f64> = own.clone().map(|row| row.reaction_mn_per_m()).collect();
        let mean = reactions.iter().sum::<f64>() / reactions.len() as f64;
        let bar = own.map(|row| row.error_bar_mn_per_m()).fold(0.0, f64::max);
        let x = Axis::log(&format!("cell width {} [m]", italic("h")));
        let y = Axis::log("relative distance from the finest [-]");
        let mut panel = Panel::new(x, y, 48.0);
        panel.heading = format!("{}, {} MN/m", friction(mu), significant(mean, 6));
        for (index, own) in labels.iter().enumerate() {
            let rows = sequences.iter();
            let rows = rows.filter(|row| row.found.variant.friction == mu && label(row) == *own);
            let off = rows.map(|row| [row.found.h, (as_printed(row.found.found) - mean).abs()]);
            // Nearer ones may be as good as what they are measured against.
            let off = off.filter(|[_, off]| *off > bar);
            let points = off.map(|[h, off]| [h, off / mean]).collect();
            let series = Series::new(own, Style::curve(index), points);
            panel.series.push(series);
        }
        let label = format!("order {CORNER_ORDER} of the corners");
        panel.guides.push(Guide::new(CORNER_ORDER, 1.0, &label));
        panels.push(panel);
    }
    let off = star.iter();
    let off = off.filter_map(|row| Some((row, row.printed_difference()?)));
    let worst = least(off, |row| -row.1.abs());
    let title = worst.map_or("The plate under refinement".to_owned(), |(row, off)| {
        let side = if off < 0.0 { "below" } else { "above" };
        let percent = significant(100.0 * off.abs(), 2);
        let at = friction(row.finest.variant.friction);
        format!("The printed reactions lie up to {percent} % {side} the converged ones ({at})")
    });
    let caption = "plate of the founding paper; star: tips enriched within a fixed radius; edge-pairs: \
                   tip cells enriched, as printed";
    KIND.add(bundle, "", Figure::new(&title, caption, 3, panels).svg()?)
}
