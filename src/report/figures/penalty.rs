//! The modelling error of the penalty method against its parameter.

use super::runs::friction;
use super::{Bundle, Kind, ReportError};
use crate::report::number::significant;
use crate::report::plot::{Axis, Figure, Guide, Panel, Series, Style};
use crate::studies::paper::plate_series::PenaltyRow;

/// What it is.
pub static KIND: Kind = Kind {
    file: "penalty.svg",
    question: "How stiff must a penalty be?",
    shows: "Relative error of the reaction of the paper's plate (Mesh I) by the penalty method against the penalty stiffness over \
            the natural scale, a curve per friction coefficient.",
};

/// The figure of all friction coefficients.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[PenaltyRow]) -> Result<(), ReportError> {
    let y = Axis::log("relative error of the reaction [-]");
    let mut panel = Panel::new(Axis::log("penalty stiffness / natural scale [-]"), y, 46.0);
    for (index, own) in rows.chunk_by(|a, b| a.friction == b.friction).enumerate() {
        let points = own
            .iter()
            .map(|row| [row.parameter, row.relative_error])
            .collect();
        panel.series.push(Series::new(
            friction(own[0].friction),
            Style::curve(index),
            points,
        ));
    }
    panel.guides.push(Guide {
        rise: -1.0,
        run: 1.0,
        label: String::new(),
    });
    let least = rows.iter().filter(|row| row.relative_error > 0.0);
    let least = least.min_by(|a, b| a.relative_error.total_cmp(&b.relative_error));
    let title = least.map_or("Error of the penalty method".to_owned(), |row| {
        format!(
            "The penalty's error falls to {} at {:e}",
            significant(row.relative_error, 1),
            row.parameter
        )
    });
    KIND.add(
        bundle,
        "",
        Figure::new(title, "plate, Mesh I, penalty method", vec![panel]).svg()?,
    )
}
