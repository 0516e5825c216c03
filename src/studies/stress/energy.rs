//! Energies of a body, and what their errors are relative to.

use serde::{Deserialize, Serialize};

use crate::case::Case;
use crate::model::field_mesh::FieldStep;
use crate::model::quantities::{PointState, Quantity};

/// Quantities whose change measures how far two answers are apart.
const ENERGIES: [&str; 2] = ["strain_energy", "dissipation"];

/// Part of the energy of a deformed body below which energy is rounding.
const STILL: f64 = 1e-10;

/// A point of a crack that was joined with what it nearly touches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joined {
    /// Number of the crack, from 0.
    pub crack: usize,
    /// Where it was put [m].
    pub from: [f64; 3],
    /// Where it is [m].
    pub to: [f64; 3],
}

/// The state looked at: the end of one increment from rest.
#[derive(Clone, Copy)]
pub struct Found<'a> {
    /// Its quantities.
    pub quantities: &'a [Quantity],
    /// Its contact points.
    pub points: &'a [PointState],
    /// Its fields.
    pub fields: Option<&'a FieldStep>,
    /// Largest jump [m].
    pub jump: f64,
    /// How far cracks were moved to what they nearly touch, in shortest edges.
    pub moved: f64,
    /// Points of them that were joined with it.
    pub joined: &'a [Joined],
}

impl Found<'_> {
    /// A quantity of the whole body, by name.
    pub fn quantity(&self, name: &str) -> Option<f64> {
        let mut own = self.quantities.iter();
        let own = own.find(|q| q.name == name && q.at.is_empty());
        own.map(|q| q.value)
    }
}

/// Energies of an answer.
#[derive(Debug, Clone, Copy)]
pub struct Energies {
    /// Those of [`ENERGIES`].
    values: [f64; 2],
    /// Reference of a change of them.
    scale: f64,
}

impl Energies {
    /// Those at the end of an increment.
    pub fn of(case: &Case, found: Found<'_>) -> Self {
        let values = values(found).map(|value| value.unwrap_or(0.0));
        // A piece that only moves has no energy but rounding: E u² L^(dim−2) is that of one as large that is deformed.
        let area: f64 = found.points.iter().map(|p| p.weight).sum();
        let length = match case.model.dim() {
            3 => area.sqrt(),
            _ => 1.0,
        };
        let deformed = case.material.young * found.jump.powi(2) * length;
        let total = values.iter().map(|e| e.abs()).sum::<f64>();
        Self {
            values,
            scale: total.max(STILL * deformed),
        }
    }

    /// Whether the body has an energy: one whose pieces only move has none but rounding.
    pub fn are_there(&self) -> bool {
        self.values.iter().map(|e| e.abs()).sum::<f64>() >= self.scale
    }

    /// An energy over those of the body [-].
    pub fn relative(&self, energy: f64) -> f64 {
        energy.abs() / self.scale
    }

    /// Change to those of another answer, that are to be `factor` times what they were [-].
    pub fn change(&self, other: Found<'_>, factor: f64) -> f64 {
        let away = |(after, before): (Option<f64>, f64)| {
            after.map_or(f64::MAX, |after| (after / factor - before).abs())
        };
        let pairs = values(other).into_iter().zip(self.values);
        pairs.map(away).sum::<f64>() / self.scale
    }
}

fn values(found: Found<'_>) -> [Option<f64>; 2] {
    ENERGIES.map(|name| found.quantity(name))
}
