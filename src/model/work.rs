//! Work along a load path: of supports and loads, of the initial stress, of friction.
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

use stickslip_methods::PointStatus;

use crate::model::loading::Loading;
use crate::model::quantities::{Snapshot, tangential};

/// Terms of this many times the rounding of the stored energies hold no balance: none is asked of them.
const NOTHING: f64 = 1e2;

/// Work since time 0 [J, in 2D J/m].
#[derive(Debug, Clone, PartialEq)]
pub struct Work {
    /// Of supports and loads.
    pub external: f64,
    /// Of the initial stress.
    pub initial_stress: f64,
    /// What the faces take, by the trapezoid of all components.
    pub faces: f64,
    /// What friction takes, per crack of the case; each >= 0.
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

    /// What the faces take beside friction, relative to the work of friction; 0 where friction does none [-].
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
