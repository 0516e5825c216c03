//! Errors and observed orders on sequences of meshes.

use super::blocks::{figures, made, tables};
use crate::report::page::{Budget, Folder, Kind, PageError, Section, Show};

const ORDERS: [Show; 13] = [
    Show::new("case", Kind::Text),
    Show::new("space", Kind::Text),
    Show::new("tip", Kind::Text),
    Show::new("friction", Kind::Number),
    Show::new("quantity", Kind::Text),
    Show::new("at", Kind::Text),
    Show::new("order", Kind::Fixed(2)),
    Show::new("theoretical_order", Kind::Fixed(1)).titled("theory"),
    Show::new("error", Kind::Digits(3)).titled("error, finest mesh"),
    Show::new("error_bar", Kind::Digits(2)),
    Show::new("finest_h_m", Kind::Digits(3)),
    Show::new("meshes", Kind::Number),
    Show::new("kind", Kind::Text).titled("reference"),
];

/// The section.
pub fn section(folder: &Folder, budget: &mut Budget) -> Result<Option<Section>, PageError> {
    let title = "Observed beside theoretical orders, by case, contact space and tip enrichment";
    let mut blocks = tables(folder, "orders.csv", title, &ORDERS)?;
    blocks.extend(figures(
        folder,
        budget,
        "Errors in the energy norm",
        |name| name.ends_with(".energy.error.svg"),
    )?);
    let others = |name: &str| {
        let error = name.ends_with(".error.svg") || name.ends_with(".error-time.svg");
        error && !name.ends_with(".energy.error.svg")
    };
    blocks.extend(figures(
        folder,
        budget,
        "Errors of other quantities, and against time",
        others,
    )?);
    let lead = "Errors against closed forms, or against limits extrapolated from the meshes themselves where there is no \
                closed form. Observed orders are those of the last two halvings.";
    Ok(made("accuracy", "Accuracy and orders", lead, blocks))
}
