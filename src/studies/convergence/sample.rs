//! Measurements on one mesh of a sequence.

use crate::case::Case;
use crate::model::errors::Deviation;
use crate::run::verdict::Verdict;
use crate::studies::followed::Value;
use crate::studies::record::{Record, Spent};
use crate::studies::tips::{Regularity, label, regularity};

/// Measure of an honest run.
#[derive(Debug, Clone, PartialEq)]
pub enum Measured {
    /// Nothing: the run has no honest verdict.
    Nothing,
    /// Against the closed form.
    Exact(Vec<Deviation>),
    /// Quantities of interest; their reference comes from all meshes.
    Values(Vec<Value>),
}

/// Common traits of the meshes of a sequence.
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
    /// Limit of the order.
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
    /// Times of a run [s]: mesh with cracks, sparsity pattern and elimination order; assembly of K; its factorisation;
    /// condensation to the contact points; preparation of the method; all increments together. The first four are shared by
    /// all friction coefficients on a mesh. NaN unless the verdict is honest.
    pub seconds: [f64; 6],
    /// The findings.
    pub measured: Measured,
}

impl Sample {
    /// A record, and its case with the tips of the task; none where the body was never discretised.
    pub fn of(record: &Record, case: &Case) -> Option<Self> {
        let found = &record.found;
        let size = found.problem.as_ref()?;
        let times = |spent: &Spent| {
            let once = [
                spent.setup_s,
                spent.assembly_s,
                spent.factorisation_s,
                spent.condensation_s,
            ];
            let [setup, assembly, factorisation, condensation] = once;
            let (prepare, solve) = (spent.prepare.median_s, spent.solve.median_s);
            [setup, assembly, factorisation, condensation, prepare, solve]
        };
        let honest = found.verdict.is_honest();
        let spent = record.spent.as_ref().filter(|_| honest);
        Some(Self {
            variant: Variant {
                case: case.name.clone(),
                space: size.space.clone(),
                tip: label(case),
                method: found.method.clone(),
                friction: record.asked.mu(),
            },
            regularity: regularity(case),
            mesh: size.mesh.clone(),
            refine: record.asked.refine,
            h: size.h_m,
            dim: size.dim,
            dofs: size.dofs,
            points: size.points,
            verdict: found.verdict.clone(),
            seconds: spent.map_or([f64::NAN; 6], times),
            measured: match (found.deviations.is_empty(), found.values.is_empty()) {
                (false, _) => Measured::Exact(found.deviations.clone()),
                (true, false) => Measured::Values(found.values.clone()),
                (true, true) => Measured::Nothing,
            },
        })
    }
}
