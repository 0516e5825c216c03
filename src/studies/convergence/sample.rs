//! What one mesh of a sequence leaves behind.

use serde::{Deserialize, Serialize};

use super::tips::Regularity;
use crate::model::errors::Deviation;
use crate::run::record::RunRow;
use crate::run::verdict::Verdict;

/// Times of a run [s]: mesh with cracks, sparsity pattern and elimination order; assembly of K; its factorisation;
/// condensation to the contact points; preparation of the method; all increments together. The first four are shared by
/// all friction coefficients on a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seconds(pub [f64; 6]);

impl Seconds {
    /// No times.
    pub const NONE: Self = Self([f64::NAN; 6]);

    /// What the run alone would have taken.
    pub fn total(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Times of the rows of one run, increment by increment.
    pub fn of(rows: &[RunRow]) -> Self {
        let Some(last) = rows.last() else {
            return Self::NONE;
        };
        let sum = |time: fn(&RunRow) -> f64| rows.iter().map(time).sum();
        let once = [
            last.setup_s,
            last.assembly_s,
            last.factorisation_s,
            last.condensation_s,
        ];
        let [setup, assembly, factorisation, condensation] = once;
        let (prepare, solve) = (sum(|row| row.prepare_s), sum(|row| row.solve_s));
        Self([setup, assembly, factorisation, condensation, prepare, solve])
    }
}

/// One followed quantity of interest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Value {
    /// Quantity, as in `quantities.csv`.
    pub quantity: String,
    /// Place and component, e.g. `top y`; empty: the whole body.
    pub at: String,
    /// Value, SI.
    pub value: f64,
    /// What errors are relative to: the length of the vector that the value is a component of, |value| of others.
    pub norm: f64,
    /// Largest number of the same kind in the body; beside it the value may be rounding.
    pub scale: f64,
}

/// What an honest run is measured by.
#[derive(Debug, Clone, PartialEq)]
pub enum Measured {
    /// Nothing: the run has no honest verdict.
    Nothing,
    /// Against the closed form.
    Exact(Vec<Deviation>),
    /// Quantities of interest; their reference comes from all meshes.
    Values(Vec<Value>),
}

/// What the meshes of a sequence have in common.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// Case name.
    pub case: String,
    /// Contact space with its marks, as in `runs.csv`.
    pub space: String,
    /// `none`, `branch`, a radius in m, or `no-tips` where no crack ends inside the body.
    pub tip: String,
    /// Method label.
    pub method: String,
    /// Friction coefficient (of the first crack where cracks differ).
    pub friction: f64,
}

/// One mesh of a sequence.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Which sequence.
    pub variant: Variant,
    /// What limits the order.
    pub regularity: Regularity,
    /// Mesh label.
    pub mesh: String,
    /// Refinement factor.
    pub refine: usize,
    /// Largest distance of neighbouring grid lines [m].
    pub h: f64,
    /// Dimension of the body.
    pub dim: usize,
    /// Free displacement unknowns.
    pub dofs: usize,
    /// Contact points.
    pub points: usize,
    /// The worst thing that happened on the path: its last increment's.
    pub verdict: Verdict,
    /// Times; none unless the verdict is honest.
    pub seconds: Seconds,
    /// What was found.
    pub measured: Measured,
}
