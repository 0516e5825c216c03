//! Time to accuracy: the error of the discretisation against what it takes to have the answer, mesh by mesh.
//!
//! All quantities that are followed over a sequence of meshes, against the closed form or against the finest mesh, see
//! [`orders`]. Methods that solve the contact laws enter, with default options and the finest tolerance that was asked for on every mesh: the
//! modelling error of the others would hide that of the mesh.

use super::{
    body_times, common_tolerance, compare_methods, compare_problems, has_defaults, problems,
    published_times,
};
use crate::run::verdict::Verdict;
use crate::studies::convergence::orders::{self, ErrorRow, OrderRow};
use crate::studies::convergence::{Measured, Sample, Variant};
use crate::studies::record::Record;
use crate::studies::task::Problem;
use crate::studies::tips::Regularity;

/// Quantity of the figures: the error in the energy norm.
const SHOWN: &str = "energy";

/// One case, contact space and friction on several meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// The problem on its coarsest mesh.
    pub coarsest: Problem,
    /// Dimension of the body.
    pub dim: usize,
    /// By method and mesh, with the times that may be shown.
    pub errors: Vec<ErrorRow>,
    /// By method.
    pub orders: Vec<OrderRow>,
}

impl Refinement {
    /// The errors that figures show, none of what has one mesh.
    pub fn shown(&self) -> (Vec<&ErrorRow>, Option<&OrderRow>) {
        let is_shown = |row: &ErrorRow| row.quantity == SHOWN && row.at.is_empty();
        let mut orders = self.orders.iter().filter(|order| order.meshes > 1);
        let errors = self.errors.iter().filter(|row| is_shown(row));
        (
            errors.collect(),
            orders.find(|order| is_shown(&order.finest)),
        )
    }
}

/// All sequences of meshes with something to measure.
pub fn refinements(records: &[Record]) -> Vec<Refinement> {
    let mut all = problems(records);
    all.sort_by(|a, b| {
        compare_problems(&a.without_mesh(), &b.without_mesh()).then(a.refine.cmp(&b.refine))
    });
    let sequences = all.chunk_by(|a, b| a.without_mesh() == b.without_mesh());
    sequences
        .filter_map(|meshes| refinement(records, meshes))
        .collect()
}

fn refinement(records: &[Record], meshes: &[Problem]) -> Option<Refinement> {
    let exact = |r: &&Record| r.found.exact && has_defaults(&r.asked);
    let own: Vec<&Record> = records.iter().filter(exact).collect();
    let on = |mesh: &Problem| -> Vec<f64> {
        let own = own.iter().filter(|r| r.asked.is_same_problem(mesh));
        own.map(|r| r.asked.tolerance).collect()
    };
    let tolerance = common_tolerance(&meshes.iter().map(on).collect::<Vec<_>>())?;
    let mut finest = own;
    finest.retain(|r| {
        let is_own = || meshes.iter().any(|mesh| mesh.is_same_problem(&r.asked));
        r.asked.tolerance == tolerance && r.is_honest() && is_own()
    });
    finest.sort_by(|a, b| {
        compare_methods(&a.asked.method, &b.asked.method).then(a.asked.refine.cmp(&b.asked.refine))
    });
    let samples = finest.iter().filter_map(|record| sample(record, records));
    // A value on one mesh says nothing of its error.
    let tells = |own: &Sample| meshes.len() > 1 || matches!(own.measured, Measured::Exact(_));
    let samples: Vec<Sample> = samples.filter(tells).collect();
    let (errors, orders) = orders::rows(&samples);
    Some(Refinement {
        coarsest: meshes.first()?.clone(),
        dim: samples.first()?.dim,
        errors,
        orders,
    })
}

fn sample(record: &Record, records: &[Record]) -> Option<Sample> {
    let found = &record.found;
    let size = found.problem.clone()?;
    Some(Sample {
        variant: Variant {
            case: record.asked.case.clone() + &record.asked.problem().path_name(),
            space: size.space,
            tip: String::new(),
            method: found.method.clone(),
            friction: record.asked.mu(),
        },
        // Records do not know it: the wider error bars.
        regularity: Regularity::Tip,
        mesh: size.mesh,
        refine: record.asked.refine,
        h: size.h_m,
        dim: size.dim,
        dofs: size.dofs,
        points: size.points,
        verdict: Verdict::Solved,
        seconds: seconds(record, records),
        measured: measured(record)?,
    })
}

fn measured(record: &Record) -> Option<Measured> {
    let found = &record.found;
    if !found.deviations.is_empty() {
        return Some(Measured::Exact(found.deviations.clone()));
    }
    (!found.values.is_empty()).then(|| Measured::Values(found.values.clone()))
}

/// Times of a cell, NaN where they may not be shown; those of the body as [`body_times`] has them.
pub(super) fn seconds(record: &Record, records: &[Record]) -> [f64; 6] {
    let times = body_times(record, records).zip(published_times(record));
    times.map_or(
        [f64::NAN; 6],
        |([setup, assembly, factorisation], spent)| {
            let [prepare, solve] = [spent.prepare, spent.solve].map(|times| times.median_s);
            [
                setup,
                assembly,
                factorisation,
                spent.condensation_s,
                prepare,
                solve,
            ]
        },
    )
}

#[cfg(test)]
mod tests {
    use super::super::support::{record, timed};
    use super::*;
    use crate::model::errors::Deviation;
    use crate::studies::convergence::orders::Kind;

    fn mesh(refine: usize, method: &str, tolerance: f64) -> Record {
        let mut record = timed(record("a", method, tolerance), 1.0);
        record.asked.refine = refine;
        let size = record.found.problem.as_mut().unwrap();
        size.h_m = 0.4 / refine as f64;
        record
    }

    fn with_error(mut record: Record, error: f64) -> Record {
        record.found.deviations.push(Deviation {
            quantity: "energy".into(),
            at: String::new(),
            found: 1.0,
            exact: 1.0,
            error,
        });
        record
    }

    /// Source: the numbers of `timed`: 0.13 s of stages, 0.1 s of preparation, 1 s of solution; errors ~ h.
    #[test]
    fn errors_of_the_closed_form_stand_beside_total_times() {
        let records: Vec<Record> = [1, 2, 4]
            .map(|refine| with_error(mesh(refine, "latin", 1e-9), 0.1 / refine as f64))
            .into();
        let found = refinements(&records);
        let [one] = &found[..] else {
            panic!("{found:?}")
        };
        let errors: Vec<f64> = one.errors.iter().map(|row| row.error).collect();
        assert_eq!(errors, [0.1, 0.05, 0.025]);
        for row in &one.errors {
            assert!((row.seconds.iter().sum::<f64>() - 1.23).abs() < 1e-12);
            assert_eq!(row.kind, Some(Kind::Exact));
        }
        assert!((one.orders[0].finest.order - 1.0).abs() < 1e-12);
    }

    #[test]
    fn coarse_tolerances_and_approximate_methods_are_left_out() {
        let mut records = Vec::new();
        for refine in [1, 2] {
            records.push(with_error(mesh(refine, "latin", 1e-3), 0.5));
            records.push(with_error(mesh(refine, "latin", 1e-9), 0.1));
            records.push(with_error(mesh(refine, "penalty", 1e-9), 0.2));
            records.push(with_error(mesh(refine, "latin:k=2", 1e-9), 0.3));
        }
        let errors: Vec<f64> = refinements(&records)[0]
            .errors
            .iter()
            .map(|r| r.error)
            .collect();
        assert_eq!(errors, [0.1, 0.1]);
        assert!(
            refinements(&records[..4])[0].shown().1.is_none(),
            "one mesh"
        );
    }
}
