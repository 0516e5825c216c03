//! Quantities of interest of an answer, by which meshes are compared where there is no closed form.

use serde::{Deserialize, Serialize};

use crate::case::Case;
use crate::model::intensities::intensities;
use crate::model::loading::Loading;
use crate::model::quantities::{Quantity, quantities};
use crate::model::snapshot::Snapshot;

/// Quantities of interest that are followed under refinement where there is no closed form.
const FOLLOWED: [&str; 9] = [
    "reaction",
    "contact_force",
    "strain_energy",
    "dissipation",
    "mean_slip",
    "max_slip",
    "max_gap",
    "stress_intensity",
    "energy_release_rate",
];

/// One followed quantity of interest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Value {
    /// Quantity, as in `quantities.csv`.
    pub quantity: String,
    /// Place and component, e.g. `top y`; empty: the whole body.
    pub at: String,
    /// Value, SI.
    pub value: f64,
    /// Reference of errors: the length of the vector that the value is a component of, |value| of others.
    pub norm: f64,
    /// Largest number of the same kind in the body; beside it the value may be rounding.
    pub scale: f64,
}

/// The quantities of interest that are followed under refinement, at the end of the path.
pub fn followed(case: &Case, loading: &Loading<'_>, now: &Snapshot) -> Vec<Value> {
    let mut rows = quantities(case, loading.body(), now);
    rows.extend(intensities(loading, loading.increments(), now));
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |m: f64, x| m.max(x.abs()));
    let displacement = largest(&mut now.u.iter().copied());
    let is_force = |row: &&Quantity| ["reaction", "contact_force"].contains(&row.name.as_str());
    let force = largest(&mut rows.iter().filter(is_force).map(|row| row.value));
    let of_tips =
        |name: &str| largest(&mut rows.iter().filter(|r| r.name == name).map(|r| r.value));
    // With one crack what is its own is that of all.
    let total = |name: &str| rows.iter().any(|row| row.name == name && row.at.is_empty());
    let followed = rows
        .iter()
        .filter(|row| FOLLOWED.contains(&row.name.as_str()) && !row.value.is_nan())
        .filter(|row| case.cracks.len() > 1 || row.at.is_empty() || !total(&row.name));
    followed
        .map(|row| {
            let vector = rows
                .iter()
                .filter(|other| (&other.name, &other.at) == (&row.name, &row.at));
            let norm = vector.map(|r| r.value.powi(2)).sum::<f64>().sqrt();
            let scale = match row.name.as_str() {
                "reaction" | "contact_force" => force,
                "mean_slip" | "max_slip" | "max_gap" => displacement,
                "stress_intensity" | "energy_release_rate" => of_tips(&row.name),
                _ => now.strain_energy,
            };
            Value {
                at: row.place(),
                quantity: row.name.clone(),
                value: row.value,
                norm,
                scale,
            }
        })
        .collect()
}
