//! Results of measuring a task.

use crate::case::Case;
use crate::model::field_mesh::FieldStep;
use crate::model::quantities::PointState;
use crate::studies::record::Record;
use crate::studies::rows::Jump;
use crate::studies::stress::energy::Found as Last;

/// A record with what is too large for one.
#[derive(Debug, Clone)]
pub struct Answer {
    /// The part that is kept.
    pub record: Record,
    /// By increment, where curves were asked for: the violation by iteration.
    pub histories: Vec<Vec<f64>>,
    /// The same: the contact points of a body.
    pub points: Vec<Vec<PointState>>,
    /// By increment, where fields were asked for.
    pub fields: Vec<FieldStep>,
    /// Jumps that tell answers at tier high apart, by increment.
    pub jumps: Vec<Jump>,
    /// Reactions and local velocities of bare algebra.
    pub solution: Option<[Vec<f64>; 2]>,
}

impl Answer {
    /// The end of the last increment, as the independent check sees it.
    pub(super) fn last(&self) -> Last<'_> {
        let step = self.record.found.increments.last();
        let size = self.record.found.problem.as_ref();
        let quantities = step.map_or(&[][..], |step| &step.quantities);
        let mut last = Last {
            quantities,
            points: self.points.last().map_or(&[][..], Vec::as_slice),
            fields: self.fields.last(),
            jump: 0.0,
            moved: size.map_or(0.0, |size| size.moved),
            joined: size.map_or(&[][..], |size| &size.joined),
        };
        let jumps = ["max_gap", "max_slip"].map(|name| last.quantity(name).unwrap_or(0.0));
        let reference = step.map_or(0.0, |step| step.judge.reference_jump_m);
        last.jump = jumps.into_iter().fold(reference, f64::max);
        last
    }
}

/// The answer to a case as it is, and the task that it belongs to.
pub(super) struct AsItIs {
    pub id: String,
    pub case: Case,
    pub answer: Answer,
}
