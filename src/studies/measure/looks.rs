//! Looks along a load path, and afterwards at an increment that a method gave up.

use std::time::Instant;

use stickslip_methods::contact_wise_margin;
use stickslip_xfem::cut::arrangement::Moved;
use stickslip_xfem::geometry::{norm, sub};

use super::answer::Answer;
use super::bench::{MeasureError, Scene};

use crate::model::field_mesh::{FieldStep, field_step};
use crate::model::intensities::{OF_TIPS, intensities};
use crate::model::quantities::{PointState, point_states, quantities};
use crate::model::snapshot::Snapshot;
use crate::run::choice::Choice;
use crate::run::local_problem::local_velocity;
use crate::run::path::Moment;
use crate::run::verdict::Verdict;
use crate::studies::record::{Found, ProblemSize, Record, Step};
use crate::studies::rows::Jump;
use crate::studies::stress::energy::Joined;
use crate::studies::task::Task;
use crate::studies::why::{explain, stops};

/// Contact points up to which runs that gave up are explained: solutions are looked for on a full W.
const EXPLAINED: usize = 500;

/// Looks on the way.
#[derive(Default)]
pub(super) struct Seen {
    pub histories: Vec<Vec<f64>>,
    pub points: Vec<Vec<PointState>>,
    pub fields: Vec<FieldStep>,
    pub jumps: Vec<Jump>,
    pub solution: Option<[Vec<f64>; 2]>,
    /// Of honest increments.
    pub snapshots: Vec<Snapshot>,
}

impl Seen {
    pub fn with(self, record: Record) -> Answer {
        Answer {
            record,
            histories: self.histories,
            points: self.points,
            fields: self.fields,
            jumps: self.jumps,
            solution: self.solution,
        }
    }

    pub fn keep_jump(&mut self, moment: &Moment<'_, '_>) {
        let solved = moment.solved;
        if let (Some(jump), Some(judged)) = (&solved.jump, &solved.judged) {
            self.jumps.push(Jump {
                increment: moment.number,
                jump: jump.clone(),
                reference_jump: judged.found.reference_jump,
            });
        }
    }

    pub fn look(
        &mut self,
        scene: &Scene<'_>,
        task: &Task,
        moment: &Moment<'_, '_>,
        step: &mut Step,
    ) {
        let (looks, judged) = (task.looks, moment.solved.judged.as_ref());
        if looks.curves {
            let history = judged.map_or(&[][..], |judged| &judged.outcome.history);
            let history = history.iter().map(|iterate| iterate.violation);
            self.histories.push(history.collect());
        }
        self.keep_jump(moment);
        if let (None, Some(judged), Some((_, problem))) =
            (scene.body(), moment.solved.honest(), &moment.again)
        {
            let state = &judged.outcome.state;
            self.solution = Some([state.p.clone(), local_velocity(problem, state)]);
        }
        let (Some((case, loading)), Some(now)) = (scene.body(), moment.now) else {
            return;
        };
        if looks.quantities {
            step.quantities = quantities(case, loading.body(), now);
            // The same by every method that is right: of those with pictures, and where a case expects some.
            if looks.fields
                || case
                    .expects
                    .iter()
                    .any(|own| OF_TIPS.contains(&&own.quantity[..]))
            {
                let tips = intensities(loading, moment.number, now);
                step.quantities.extend(tips);
            }
        }
        if looks.curves {
            self.points.push(point_states(loading.body(), now));
        }
        if looks.fields {
            self.fields.push(field_step(loading.body(), now));
        }
        if looks.error {
            self.snapshots.push(now.clone());
        }
    }
}

/// Why a run gave up, and where published tests would have stopped it, as far as a task asks.
pub(super) fn ask(
    scene: &Scene<'_>,
    task: &Task,
    choice: &Choice,
    moment: Moment<'_, '_>,
    found: &mut Found,
) -> Result<(), MeasureError> {
    let Some((solver, problem)) = moment.again else {
        return Ok(());
    };
    let first = moment.number == scene.posed().loads.first();
    if task.looks.stops && first {
        found.stops = stops(choice, solver, problem)?;
    }
    let (verdict, remedy) = (&moment.solved.verdict, task.looks.remedy);
    let gave_up = matches!(verdict, Verdict::GaveUp(_));
    if task.looks.why && gave_up && scene.system.points() <= EXPLAINED {
        let known = scene.answers(problem, first)?;
        found.why = Some(explain(choice, solver, problem, verdict, &known, remedy)?);
    }
    Ok(())
}

impl Scene<'_> {
    /// Seconds to gather the tables and fields of an increment.
    pub(super) fn output(&self, now: &Snapshot) -> f64 {
        let Some((case, loading)) = self.body() else {
            return 0.0;
        };
        let (clock, body) = (Instant::now(), loading.body());
        let rows = quantities(case, body, now);
        let tips = intensities(loading, loading.increments(), now);
        std::hint::black_box((rows, tips, point_states(body, now), field_step(body, now)));
        clock.elapsed().as_secs_f64()
    }

    pub(super) fn size(&self, task: &Task) -> ProblemSize {
        let elastic = self.system.elastic();
        // A failure here is one of every method, whose verdict it is.
        let margin = task.looks.why.then(|| contact_wise_margin(self.system));
        let unique = margin.and_then(Result::ok).map(|margin| margin > 0.0);
        let (mesh, space) = self.labels();
        ProblemSize {
            mesh,
            space,
            h_m: self.cell_size(),
            dim: self.system.dim(),
            dofs: elastic.unknowns(),
            points: self.system.points(),
            unknowns: self.system.rows(),
            uniform_stress: self.uniform_stress(),
            joined: self.body().map_or_else(Vec::new, |(_, loading)| {
                let body = loading.body();
                let joined = body.moved.iter().filter(|moved| moved.joined);
                let told = |moved: &Moved| Joined {
                    crack: moved.crack,
                    from: body.place(&moved.from),
                    to: body.place(&moved.to),
                };
                joined.map(told).collect()
            }),
            moved: self.body().map_or(0.0, |(_, loading)| {
                let body = loading.body();
                let moved = body.moved.iter().filter(|moved| !moved.joined);
                let by = moved.map(|moved| norm(&sub(&moved.to, &moved.from)));
                by.fold(0.0, f64::max) / body.mesh.smallest_edge()
            }),
            unique,
            operator: self.operator(),
        }
    }
}
