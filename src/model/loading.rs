//! Loads on a body in the increments of a run: nodal forces, prescribed displacements, the closed form.
//!
//! ```text
//!   K u = f_ext + Bᵀ P over all unknowns, u = u_free + u_prescribed:
//!   f = f_ext − K u_prescribed   at the free unknowns,      offset = B u_prescribed
//! ```
//!
//! The closed form depends on friction, so there is one [`Loading`] per friction coefficient; the body, its stiffness and
//! all that is derived from it do not, and serve all of them.

use stickslip_methods::Load;
use stickslip_xfem::exact::{Field, Setting};
use stickslip_xfem::geometry::{Point, add_scaled};
use stickslip_xfem::loads::exact_values::exact_values;
use stickslip_xfem::loads::nodal_forces::no_force;

use crate::case::{Case, CaseError, ExactSpec, History, LoadKind, LoadSpec};
use crate::model::body::{Body, BodyError};
use crate::model::fixed_loads::FixedLoad;
use crate::model::nodal_forces::{Loaded, vector};
use crate::model::refusals::load_error;

/// The closed form at time 0 or at the end of an increment, on the body.
struct ExactStep {
    field: Box<dyn Field>,
    /// Prescribed unknowns that take their value from it [m].
    displacement: Vec<(usize, f64)>,
    /// Nodal forces of the loads that do; empty if there are none.
    force: Vec<f64>,
}

/// Loads on a body along the path of a case, for one friction coefficient. Increments are counted from 1 to the last
/// of the path. Where something acts at time 0 the state there is solved first, as increment 0 from a body at rest.
pub struct Loading<'a> {
    body: &'a Body,
    case: &'a Case,
    /// By increment, time 0 first; empty without closed form.
    exact: Vec<ExactStep>,
    first: usize,
}

impl<'a> Loading<'a> {
    /// Evaluates the closed form, if the case has one, at time 0 and for all increments; `friction` is that of the only crack.
    ///
    /// # Errors
    /// At `[exact]` where the closed form does not hold for the body, the friction coefficient or the path.
    pub fn new(body: &'a Body, case: &'a Case, friction: f64) -> Result<Self, BodyError> {
        let exact = exact_steps(body, case, friction)?;
        let mut loading = Loading {
            body,
            case,
            exact,
            first: 0,
        };
        let start = loading.at(0);
        let external = loading.external_force(0);
        let parts = [start.force, start.offset, start.traction, external];
        let rests = parts.iter().flatten().all(|value| *value == 0.0);
        loading.first = usize::from(rests);
        Ok(loading)
    }

    /// The body.
    pub fn body(&self) -> &'a Body {
        self.body
    }

    /// The increment that a run begins with: 0 where something acts at time 0, otherwise 1.
    pub fn first(&self) -> usize {
        self.first
    }

    /// Number of increments, without that at time 0.
    pub fn increments(&self) -> usize {
        self.case.path.increments
    }

    /// Time at the end of an increment.
    pub fn time(&self, increment: usize) -> f64 {
        self.case.path.time(increment)
    }

    /// The closed form at the end of an increment; `None` if the case names none.
    pub fn exact(&self, increment: usize) -> Option<&dyn Field> {
        self.exact.get(increment).map(|step| step.field.as_ref())
    }

    fn factor(&self, history: &History, increment: usize) -> f64 {
        history.factor(self.time(increment), self.case.path.end)
    }

    /// Uniform initial stress at the end of an increment [Pa].
    pub fn initial_stress(&self, increment: usize) -> [Point; 3] {
        let mut total = [[0.0; 3]; 3];
        for load in &self.case.loads {
            if let LoadKind::InitialStress(stress) = &load.kind {
                let factor = self.factor(&load.history, increment);
                for (row, own) in total.iter_mut().zip(stress) {
                    *row = add_scaled(row, factor, own);
                }
            }
        }
        total
    }

    /// Whether a force per volume acts.
    pub fn has_body_force(&self) -> bool {
        let mut kinds = self.case.loads.iter().map(|load| &load.kind);
        kinds.any(|kind| matches!(kind, LoadKind::Body(..) | LoadKind::ExactBody))
    }

    /// Force per volume at the end of an increment at a point on a side of the first crack [N/m³].
    pub fn body_force(&self, increment: usize, x: &Point, side: f64) -> Point {
        let factor = |load: &LoadSpec| self.factor(&load.history, increment);
        let mut total = [0.0; 3];
        for load in &self.case.loads {
            let (factor, force) = match &load.kind {
                LoadKind::Body(_, Some(own)) if own.side != side => continue,
                LoadKind::Body(density, _) => (factor(load), vector(density)),
                LoadKind::ExactBody => match self.exact(increment) {
                    Some(field) => (1.0, field.body_force(x, side)),
                    None => continue,
                },
                _ => continue,
            };
            total = add_scaled(&total, factor, &force);
        }
        total
    }

    /// External forces at the end of an increment over all unknowns [N, in 2D N/m].
    pub fn external_force(&self, increment: usize) -> Vec<f64> {
        let mut force = no_force(&self.body.integrator());
        let mut add = |factor: f64, vector: &[f64]| {
            for (f, v) in force.iter_mut().zip(vector) {
                *f += factor * v;
            }
        };
        for load in &self.body.loads {
            add(self.factor(&load.history, increment), &load.force);
        }
        if let Some(step) = self.exact.get(increment) {
            add(1.0, &step.force);
        }
        force
    }

    /// Prescribed part of the displacement at the end of an increment over all unknowns, 0 at the free ones [m].
    pub fn prescribed_displacement(&self, increment: usize) -> Vec<f64> {
        let mut u = vec![0.0; self.body.numbers.len()];
        let factors: Vec<f64> = (self.case.supports.iter())
            .map(|support| self.factor(&support.history, increment))
            .collect();
        for (&unknown, fixed) in &self.body.prescribed {
            if let Some(amount) = fixed.amount {
                let less = fixed.less.map_or(0.0, |(s, amount)| amount * factors[s]);
                u[unknown] = amount * factors[fixed.support] - less;
            }
        }
        if let Some(step) = self.exact.get(increment) {
            for &(unknown, value) in &step.displacement {
                u[unknown] = value;
            }
        }
        u
    }

    /// Right-hand side at the end of an increment: f = f_ext − K u_prescribed at the free unknowns, the jump the
    /// prescribed ones carry, and the contact forces that their stress and an initial one imply.
    pub fn at(&self, increment: usize) -> Load {
        let body = self.body;
        let prescribed = self.prescribed_displacement(increment);
        let held = body.stiffness.mul(&prescribed);
        let external = self.external_force(increment);
        let mut traction = body.traction(&prescribed);
        for load in &body.loads {
            let factor = self.factor(&load.history, increment);
            for (t, v) in traction.iter_mut().zip(&load.traction) {
                *t += factor * v;
            }
        }
        let mut force: Vec<f64> = external.iter().zip(&held).map(|(f, k)| f - k).collect();
        body.basis.force(body.mesh.dim(), &mut force);
        Load {
            force: (0..force.len())
                .filter(|&i| body.solver_numbers[i].is_some())
                .map(|i| force[i])
                .collect(),
            offset: body.jump(&prescribed),
            traction,
        }
    }

    /// The load that an increment begins with: none before the first one.
    pub fn before(&self, increment: usize) -> Load {
        match increment.checked_sub(1) {
            Some(before) if increment > self.first => self.at(before),
            _ => Load::zero(&self.body.elastic),
        }
    }

    /// −½ ∫ (σ₀(before) + σ₀(now)) : Δε, work of the initial stress in an increment with displacements Δu over all unknowns
    /// [J, in 2D J/m].
    pub fn initial_stress_work(&self, increment: usize, du: &[f64]) -> f64 {
        let work = |load: &FixedLoad| {
            let before = match increment.checked_sub(1) {
                Some(before) => self.factor(&load.history, before),
                None => 0.0,
            };
            let now = self.factor(&load.history, increment);
            let full: f64 = load.force.iter().zip(du).map(|(f, u)| f * u).sum();
            0.5 * (before + now) * full
        };
        let own = self.body.loads.iter().filter(|load| load.initial_stress);
        own.map(work).sum()
    }

    /// All unknowns at the end of an increment from the free ones [m].
    pub fn all_unknowns(&self, increment: usize, u: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.body.numbers.len()];
        for (value, number) in all.iter_mut().zip(&self.body.solver_numbers) {
            if let Some(n) = number {
                *value = u[*n as usize];
            }
        }
        self.body.basis.unknowns(self.body.mesh.dim(), &mut all);
        let prescribed = self.prescribed_displacement(increment);
        for ((value, held), number) in all.iter_mut().zip(prescribed).zip(&self.body.numbers) {
            if number.is_none() {
                *value = held;
            }
        }
        all
    }
}

/// The closed form of a case at time 0 and at the end of every increment; none where the case names none.
fn exact_steps(body: &Body, case: &Case, friction: f64) -> Result<Vec<ExactStep>, BodyError> {
    let (Some(spec), Some(crack)) = (&case.exact, case.cracks.first()) else {
        return Ok(Vec::new());
    };
    let setting = Setting {
        material: case.material,
        model: case.model,
        friction,
        crack: &crack.geometry,
        body: body.mesh.extents(),
    };
    let refuse = |message: String| exact_error(case, spec, friction, &message);
    let solution = (spec.solution.build)(&setting, &spec.values).map_err(refuse)?;
    let factors = spec.factors(&case.path);
    let integrator = body.integrator();
    let loaded = Loaded::new(case, &integrator);
    let Some(sides) = loaded.sides() else {
        return Ok(Vec::new());
    };
    let mut steps = Vec::new();
    for increment in 0..factors.len() {
        let field = solution.at(&factors[..=increment]).map_err(|message| {
            refuse(match case.path.increments {
                1 => message,
                _ => format!("increment {increment}: {message}"),
            })
        })?;
        let mut force = Vec::new();
        for load in &case.loads {
            if matches!(load.kind, LoadKind::ExactTraction(_) | LoadKind::ExactBody) {
                force.resize(body.numbers.len(), 0.0);
                let added = loaded.add(&load.kind, Some(field.as_ref()), &mut force);
                added.map_err(|e| load_error(case, &load.kind, &load.span, e))?;
            }
        }
        let taken = (body.prescribed.iter()).filter(|(_, fixed)| fixed.amount.is_none());
        let unknowns = taken.map(|(&i, _)| i);
        let displacement = exact_values(
            &body.mesh,
            &body.enrichment,
            sides,
            field.as_ref(),
            unknowns,
        );
        steps.push(ExactStep {
            field,
            displacement,
            force,
        });
    }
    Ok(steps)
}

/// A closed form that does not hold, at its table.
fn exact_error(case: &Case, spec: &ExactSpec, friction: f64, message: &str) -> CaseError {
    let value = format!("{} with friction {friction}", spec.solution.name);
    let allowed = "a body, crack, friction, parameters and history that the closed form holds for";
    case.error(&spec.span, value, allowed, message)
}
