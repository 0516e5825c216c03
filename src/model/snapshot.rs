//! The mechanics at the end of an increment, and the work along the load path up to there: of supports and loads, of the initial stress, of
//! friction.
//!
//! ```text
//!   per increment, 0 its begin, 1 its end, Δu = u¹ − u⁰, R the force of the supports:
//!     supports and loads  ½ (R⁰ + R¹)·Δu + ½ (f⁰ + f¹)·Δu,     f without that of σ₀
//!     initial stress      −½ ∫ (σ₀⁰ + σ₀¹) : Δε
//!     stored              ½ u¹·K u¹ − ½ u⁰·K u⁰,               without σ₀
//!     faces               −½ Σ (P⁰ + P¹)·Δ[[u]]                all components; Nitsche's consistency term likewise
//!     friction            ½ Σ μ (P_n⁰ + P_n¹) |d|              over the points that slip, P_n < 0 counts as 0
//! ```
//!
//! Equilibrium at both ends makes supports and loads + initial stress = stored + faces an identity, whatever the contact laws.
//! Friction differs from the faces as long as forces do not change linearly with the slip: where slip turns or starts within
//! an increment, or faces open or close. Both tend to the same work as increments are added.

use stickslip_methods::{ContactState, PointStatus};
use stickslip_xfem::contact::surface_point::extremes;

use crate::model::body::Body;
use crate::model::loading::Loading;

/// Terms of this many times the rounding of the stored energies hold no balance: none is asked of them.
const NOTHING: f64 = 1e2;

/// The mechanics at the end of an increment, over all unknowns and points.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Time.
    pub time: f64,
    /// All unknowns [m].
    pub u: Vec<f64>,
    /// Jump at the points in local frames, `dim` each [m].
    pub jump: Vec<f64>,
    /// Contact forces on side 1, `dim` each.
    pub p: Vec<f64>,
    /// Factors of the traction rows in Nitsche's consistency term; empty for other methods.
    pub consistency: Vec<f64>,
    /// External forces plus reactions over all unknowns: K u − Bᵀ P, less the consistency term of Nitsche's method.
    pub force: Vec<f64>,
    /// External forces over all unknowns.
    pub external: Vec<f64>,
    /// Open, stick or slip of every point.
    pub status: Vec<PointStatus>,
    /// ½ u·K u: that of the strain, without the initial stress [J, in 2D J/m]; 0 if it is rounding.
    pub strain_energy: f64,
    /// ε ½ Σ K_ii u_i²: what rounding makes of it where the body moves without strain.
    pub rounding: f64,
    /// Work since time 0.
    pub work: Work,
    /// Deepest overlap of the faces and largest slip of every crack of the case, between its contact points too [m].
    pub extremes: Vec<[f64; 2]>,
}

impl Snapshot {
    /// The unloaded body.
    pub fn virgin(body: &Body) -> Self {
        let (n, m) = (body.numbers.len(), body.points.len() * body.mesh.dim());
        Snapshot {
            time: 0.0,
            u: vec![0.0; n],
            jump: vec![0.0; m],
            p: vec![0.0; m],
            consistency: Vec::new(),
            force: vec![0.0; n],
            external: vec![0.0; n],
            status: vec![PointStatus::Open; body.points.len()],
            strain_energy: 0.0,
            rounding: 0.0,
            work: Work::none(body.integrated.len()),
            extremes: vec![[0.0; 2]; body.integrated.len()],
        }
    }

    /// Deepest overlap of the faces and largest slip of all cracks [m].
    pub fn largest(&self) -> [f64; 2] {
        [0, 1].map(|i| self.extremes.iter().map(|own| own[i]).fold(0.0, f64::max))
    }

    /// The state a method returned at the end of an increment, after the given one; `consistency` as its claim asks,
    /// `friction`: coefficient of every point.
    pub fn new(
        loading: &Loading<'_>,
        increment: usize,
        state: &ContactState,
        consistency: Option<&[f64]>,
        status: Vec<PointStatus>,
        friction: &[f64],
        before: &Snapshot,
    ) -> Self {
        let body = loading.body();
        let u = loading.all_unknowns(increment, &state.u);
        let jump = body.jump(&u);
        let internal = body.stiffness.mul(&u);
        let energy = 0.5 * u.iter().zip(&internal).map(|(u, f)| u * f).sum::<f64>();
        let diagonal = body.stiffness.diagonal().into_iter().zip(&u);
        let rounding = 0.5 * f64::EPSILON * diagonal.map(|(k, u)| k * u * u).sum::<f64>();
        let mut force = internal;
        let contact = body.jump_rows.iter().zip(&state.p);
        let further = body.traction_rows.iter().zip(consistency.unwrap_or(&[]));
        for (row, p) in contact.chain(further) {
            for &(i, coefficient) in row {
                force[i] -= coefficient * p;
            }
        }
        let mut now = Snapshot {
            external: loading.external_force(increment),
            time: loading.time(increment),
            extremes: sampled_extremes(body, &u, &jump),
            jump,
            p: state.p.clone(),
            consistency: consistency.unwrap_or_default().to_vec(),
            force,
            status,
            strain_energy: if energy > rounding { energy } else { 0.0 },
            rounding,
            work: Work::none(0),
            u,
        };
        now.work = Work::after(loading, increment, friction, before, &now);
        now
    }
}

impl Snapshot {
    /// The part of it that is no finite number, if any: then there is no answer, whatever the residuals say.
    pub fn not_finite(&self) -> Option<&'static str> {
        let Work {
            external,
            initial_stress,
            faces,
            identity,
            ..
        } = self.work;
        let friction = self.work.dissipation();
        let energies = [
            self.strain_energy,
            external,
            initial_stress,
            faces,
            friction,
            identity,
        ];
        let parts: [(&str, &[f64]); 5] = [
            ("displacements", &self.u),
            ("jumps", &self.jump),
            ("contact forces", &self.p),
            ("nodal forces", &self.force),
            ("energies", &energies),
        ];
        let broken = |values: &[f64]| !values.iter().all(|x| x.is_finite());
        let found = parts.iter().find(|(_, values)| broken(values));
        found.map(|(name, _)| *name)
    }
}

/// Deepest overlap of the faces and largest slip of every crack [m], between its contact points too. Along cell facets the jump of a
/// crack is linear between its points, which then hold its extremes.
fn sampled_extremes(body: &Body, u: &[f64], jump: &[f64]) -> Vec<[f64; 2]> {
    let (dim, integrator) = (body.mesh.dim(), body.integrator());
    let of_crack = |crack: usize| {
        if body.cracks.iter().any(|c| c.number == crack) {
            let own = body.samples.iter().filter(|s| s.crack == crack);
            return extremes(&integrator, own, u);
        }
        let own = (0..body.points.len()).filter(|&i| body.points[i].crack == crack);
        let at = |i: usize| [-jump[i * dim], tangential(jump, dim, i)];
        own.map(at).fold([0.0; 2], |most, own| {
            [0, 1].map(|i| f64::max(most[i], own[i]))
        })
    };
    (0..body.integrated.len()).map(of_crack).collect()
}

/// Length of the tangential part of a vector at a contact point.
pub(crate) fn tangential(values: &[f64], dim: usize, point: usize) -> f64 {
    let own = &values[point * dim + 1..(point + 1) * dim];
    own.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Work since time 0 [J, in 2D J/m].
#[derive(Debug, Clone, PartialEq)]
pub struct Work {
    /// Of supports and loads.
    pub external: f64,
    /// Of the initial stress.
    pub initial_stress: f64,
    /// Work that the faces take, by the trapezoid of all components.
    pub faces: f64,
    /// Work of friction, per crack of the case; each >= 0.
    pub friction: Vec<f64>,
    /// Residual of the identity in this increment, relative to the sum of its terms' sizes, with the stored energies at both
    /// ends as two terms [-].
    pub identity: f64,
}

impl Work {
    /// None yet.
    pub fn none(cracks: usize) -> Self {
        Work {
            external: 0.0,
            initial_stress: 0.0,
            faces: 0.0,
            friction: vec![0.0; cracks],
            identity: 0.0,
        }
    }

    /// Work of friction on all cracks [J, in 2D J/m].
    pub fn dissipation(&self) -> f64 {
        self.friction.iter().sum()
    }

    /// Work that the faces take beside friction, relative to the work of friction; 0 where friction does none [-].
    pub fn path_error(&self) -> f64 {
        let friction = self.dissipation();
        if friction > 0.0 {
            (self.faces - friction).abs() / friction
        } else {
            0.0
        }
    }

    /// After an increment between two states; `friction`: coefficient of every point. The state at time 0 is what a path
    /// starts with: it is checked, but its work is not counted, since nobody says how it came about.
    pub fn after(
        loading: &Loading<'_>,
        increment: usize,
        friction: &[f64],
        before: &Snapshot,
        now: &Snapshot,
    ) -> Self {
        let body = loading.body();
        let dim = body.mesh.dim();
        let du: Vec<f64> = now.u.iter().zip(&before.u).map(|(a, b)| a - b).collect();
        // The nodal force of a prescribed unknown is that of support and load.
        let mean = |i: usize| match body.numbers[i] {
            Some(_) => 0.5 * (before.external[i] + now.external[i]),
            None => 0.5 * (before.force[i] + now.force[i]),
        };
        let all: f64 = du.iter().enumerate().map(|(i, du)| mean(i) * du).sum();
        let initial_stress = loading.initial_stress_work(increment, &du);
        let external = all - initial_stress;
        let faces = -mean_work(&body.jump_rows, [&before.p, &now.p], &du)
            - mean_work(
                &body.traction_rows,
                [&before.consistency, &now.consistency],
                &du,
            );
        let terms = [
            external,
            initial_stress,
            before.strain_energy,
            -now.strain_energy,
            -faces,
        ];
        let (sum, size) = terms.iter().fold((0.0, 0.0), |(sum, size), term| {
            (sum + term, size + f64::abs(*term))
        });
        // A body pulled apart moves without strain: then nothing but rounding is left of all terms.
        let identity = if size > NOTHING * (before.rounding + now.rounding) {
            f64::abs(sum) / size
        } else {
            0.0
        };
        if increment == 0 {
            return Work {
                identity,
                ..Work::none(before.work.friction.len())
            };
        }
        let mut work = Work {
            external: before.work.external + external,
            initial_stress: before.work.initial_stress + initial_stress,
            faces: before.work.faces + faces,
            friction: before.work.friction.clone(),
            identity,
        };
        let step: Vec<f64> = (now.jump.iter().zip(&before.jump))
            .map(|(a, b)| a - b)
            .collect();
        for (i, point) in body.points.iter().enumerate() {
            if now.status[i] == PointStatus::Slip {
                let pressure = |state: &Snapshot| state.p[i * dim].max(0.0);
                let mean = 0.5 * (pressure(before) + pressure(now));
                work.friction[point.crack] += friction[i] * mean * tangential(&step, dim, i);
            }
        }
        work
    }
}

/// ½ Σ (P⁰ + P¹)·B Δu of forces before and now on some rows of B; none are zero.
fn mean_work(rows: &[Vec<(usize, f64)>], [before, now]: [&[f64]; 2], du: &[f64]) -> f64 {
    let force = |r: usize| {
        let of = |p: &[f64]| p.get(r).copied().unwrap_or(0.0);
        0.5 * (of(before) + of(now))
    };
    let step = |row: &[(usize, f64)]| row.iter().map(|&(i, b)| b * du[i]).sum::<f64>();
    let all = rows.iter().enumerate();
    all.map(|(r, row)| force(r) * step(row)).sum()
}
