//! Convergence study: one exact method on a sequence of meshes, for several contact spaces and tip enrichments.
//!
//! Every combination is the case with another contact space and tip enrichment, run over its whole load path. Only honest
//! verdicts are measured, at the end of the path: against the closed form where the case names one, otherwise by their
//! quantities of interest on the finest mesh, whose error bars come from the meshes before it.

pub mod error_bar;
mod estimate;
pub mod orders;
mod power_law;
mod sample;

pub use error_bar::NoBar;
pub use estimate::{Errors, OfMeshes, errors_of_mesh, estimate, of_problem, put};
pub use power_law::slope;
pub use sample::{Measured, Sample, Variant};

use std::collections::BTreeSet;

use crate::case::{Case, ContactSpace, Tip};
use crate::run::choice::Choice;
use crate::run::progress::Progress;
use crate::run::verdict::Accuracy;
use crate::studies::axes::{Axes, Subject, named, space_name, tip_name};
use crate::studies::measure::{Bench, RunError, here};
use crate::studies::record::Record;
use crate::studies::task::Looks;
use crate::studies::tips::{Regularity, regularity};

/// Refinement factors where neither the study nor the case names several.
const REFINE: [usize; 4] = [1, 2, 4, 8];

/// The runs of a study. `None`: what the case says, see [`ConvergencePlan::meshes`], [`ConvergencePlan::spaces`], [`ConvergencePlan::tips`].
#[derive(Debug, Clone)]
pub struct ConvergencePlan {
    /// Refinement factors, increasing.
    pub refine: Option<Vec<usize>>,
    /// Contact spaces of all cracks.
    pub spaces: Option<Vec<ContactSpace>>,
    /// Enrichments of all tips.
    pub tips: Option<Vec<Tip>>,
    /// Method.
    pub choice: Choice,
}

impl ConvergencePlan {
    /// Refinement factors: those asked for, or those of the case if it has several, or 1, 2, 4, 8.
    pub fn meshes(&self, case: &Case) -> Vec<usize> {
        match &self.refine {
            Some(given) => given.clone(),
            None if case.sweep.refine.len() > 1 => {
                let mut own = case.sweep.refine.clone();
                own.sort_unstable();
                own
            }
            None => REFINE.to_vec(),
        }
    }

    /// Contact spaces: those asked for, or `star` and those of the case, where `None` leaves every crack its own.
    pub fn spaces(&self, case: &Case) -> Vec<Option<ContactSpace>> {
        match &self.spaces {
            Some(given) => given.iter().copied().map(Some).collect(),
            None if case.cracks.iter().all(|c| c.contact == ContactSpace::Star) => vec![None],
            None => vec![Some(ContactSpace::Star), None],
        }
    }

    /// Tip enrichments: those asked for, or those of the case, where `None` leaves every crack its own.
    pub fn tips(&self, case: &Case) -> Vec<Option<Tip>> {
        match &self.tips {
            // Where nothing ends inside the body there is nothing to enrich.
            Some(given) if regularity(case) != Regularity::Smooth => {
                given.iter().copied().map(Some).collect()
            }
            _ => vec![None],
        }
    }
}

/// Runs the study on one case: samples by contact space, tip enrichment, mesh and friction. One after the other, so that
/// times mean something.
///
/// # Errors
/// Of the case or its discretisation; what the method does wrong is a verdict.
pub fn run(
    case: &Case,
    plan: &ConvergencePlan,
    progress: &dyn Progress,
) -> Result<Vec<Sample>, RunError> {
    let choices = std::slice::from_ref(&plan.choice);
    let (mut samples, mut bench) = (Vec::new(), Bench::default());
    // A crack along cell facets has the same pairs in every space.
    let mut seen = BTreeSet::new();
    for space in plan.spaces(case) {
        for tip in plan.tips(case) {
            let axes = Axes {
                refine: plan.meshes(case),
                spaces: vec![space_name(space)],
                tips: vec![tip_name(tip)],
                ..Axes::of(case)
            };
            let own = records(&mut bench, case, &axes, choices, Looks::truth(), progress)?;
            let mut variant = case.clone();
            for crack in &mut variant.cracks {
                crack.tip = tip.unwrap_or(crack.tip);
            }
            let own = own.iter().filter_map(|record| Sample::of(record, &variant));
            samples.extend(own.filter(|sample| {
                let Variant {
                    space,
                    tip,
                    friction,
                    ..
                } = &sample.variant;
                let friction = friction.to_bits();
                seen.insert((space.clone(), tip.clone(), sample.refine, friction))
            }));
        }
    }
    Ok(samples)
}

/// Records of a case at its own accuracy, measured in this process one after the other, so that times mean something.
///
/// # Errors
/// Of the case or its discretisation; what a method does wrong is a verdict.
pub fn records(
    bench: &mut Bench,
    case: &Case,
    axes: &Axes,
    choices: &[Choice],
    looks: Looks,
    progress: &dyn Progress,
) -> Result<Vec<Record>, RunError> {
    let accuracy = [Accuracy::own(case)];
    let tasks = Subject::given(case).tasks(axes, &named(choices), &accuracy, looks);
    let answers = here(bench, &tasks, choices, 1, None, progress, &mut |_, _| ())?;
    Ok(answers.into_iter().map(|own| own.record).collect())
}
