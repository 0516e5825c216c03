//! Small problems with known answers.
//!
//! The answers are not computed: reactions r and local velocities u that fulfil the contact laws are chosen first, and
//! q = u − W r − V λ makes them the solution. W = I + A Aᵀ/m with entries of A in [−1, 1] is conditioned well enough for
//! it to be the only one at these friction coefficients.

use std::sync::Arc;

use stickslip_xfem::mesh::stream::Stream;

use crate::files::interchange::{
    Info, InterchangeError, LocalEquality, LocalProblem, Solution, SparseMatrix,
};
use crate::studies::axes::Subject;
use crate::studies::task::{Matter, digest_of_bytes};

/// A problem with what is known of it.
pub struct Exercise {
    /// In tables.
    pub name: &'static str,
    /// The problem.
    pub problem: LocalProblem,
    /// Its answer.
    pub known: Known,
    /// λ by column of V.
    pub amplitudes: Vec<f64>,
    /// u of the answer.
    velocity: Vec<f64>,
}

/// Class of exercises without answer.
pub const WITHOUT_ANSWER: &str = "pulled";

/// The answer of an exercise.
#[derive(Debug, Clone)]
pub enum Known {
    /// Reactions, the only ones.
    Reactions(Vec<f64>),
    /// No reactions within the cones balance the load.
    Nothing,
}

impl Exercise {
    /// As a source yields it: as the bytes of a file that holds the known answer.
    ///
    /// # Errors
    /// One that cannot be written.
    pub fn subject(&self) -> Result<Subject, InterchangeError> {
        let mut problem = self.problem.clone();
        let mut class = WITHOUT_ANSWER;
        if let Known::Reactions(r) = &self.known {
            let (u, l) = (self.velocity.clone(), self.amplitudes.clone());
            let (v, r) = (Vec::new(), r.clone());
            problem.solution = Some(Solution { v, u, r, l });
            class = "known";
        }
        let bytes = problem.to_bytes()?;
        Ok(Subject {
            name: self.name.to_owned(),
            class: class.to_owned(),
            digest: digest_of_bytes(&bytes),
            matter: Arc::new(Matter::Bytes(bytes)),
        })
    }
}

/// State of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    Open,
    Stick,
    Slip,
}
use State::{Open, Slip, Stick};

/// Points of the larger ones.
const MANY: usize = 12;
/// Friction coefficient of most.
const FRICTION: f64 = 0.3;
/// Sizes of forces and jumps in SI units, where a point of a body of steel moves 1e-10 m under 1 N.
const STEEL: [f64; 2] = [1e4, 1e-6];

/// All exercises, from one point to many.
pub fn exercises() -> Vec<Exercise> {
    let one = |name, dim, state| Recipe::new(name, dim, &[(state, FRICTION)]).cook();
    let mixed: [_; MANY] = std::array::from_fn(|i| ([Open, Stick, Slip][i % 3], FRICTION));
    let many = |name, dim| Recipe::new(name, dim, &mixed);
    let frictionless =
        |name, dim| Recipe::new(name, dim, &[(Slip, 0.0), (Open, 0.0), (Slip, 0.0)]).cook();
    let steep = [(Slip, 1.2), (Open, FRICTION), (Stick, 1.2), (Slip, 0.0)];
    vec![
        one("open-2d", 2, Open),
        one("open-3d", 3, Open),
        one("stick-2d", 2, Stick),
        one("stick-3d", 3, Stick),
        one("slip-2d", 2, Slip),
        one("slip-3d", 3, Slip),
        frictionless("frictionless-2d", 2),
        frictionless("frictionless-3d", 3),
        Recipe::new("coefficients-2d", 2, &steep).cook(),
        Recipe::new("coefficients-3d", 3, &steep).cook(),
        many("mixed-2d", 2).cook(),
        many("mixed-3d", 3).cook(),
        many("units-2d", 2).in_units(STEEL).cook(),
        many("units-3d", 3).in_units(STEEL).cook(),
        many("floating-2d", 2).floating(1).cook(),
        many("floating-3d", 3).floating(3).cook(),
        pulled("pulled-2d", 2),
        pulled("pulled-3d", 3),
    ]
}

/// How an exercise is made.
struct Recipe<'a> {
    name: &'static str,
    dim: usize,
    points: &'a [(State, f64)],
    motions: usize,
    /// Of forces and jumps.
    units: [f64; 2],
}

impl<'a> Recipe<'a> {
    fn new(name: &'static str, dim: usize, points: &'a [(State, f64)]) -> Self {
        Self {
            name,
            dim,
            points,
            motions: 0,
            units: [1.0; 2],
        }
    }

    fn in_units(self, units: [f64; 2]) -> Self {
        Self { units, ..self }
    }

    fn floating(self, motions: usize) -> Self {
        Self { motions, ..self }
    }

    /// r and u by the laws, W and V by chance, then q and s.
    fn cook(&self) -> Exercise {
        let Self { dim, units, .. } = *self;
        let mut chance = Stream::new(self.name.bytes().map(u64::from).sum());
        let (mut r, mut u) = (Vec::new(), Vec::new());
        for &(state, mu) in self.points {
            let (force, jump) = at_point(&mut chance, dim, state, mu);
            r.extend(force);
            u.extend(jump);
        }
        let rows = r.len();
        let w = compliance(&mut chance, rows);
        let v = orthonormal(&mut chance, rows, self.motions);
        let amplitudes: Vec<f64> = (v.iter()).map(|_| chance.between(-1.0, 1.0)).collect();
        let mut q = u.clone();
        for (i, q) in q.iter_mut().enumerate() {
            *q -= (0..rows).map(|j| w[i][j] * r[j]).sum::<f64>();
            *q -= v
                .iter()
                .zip(&amplitudes)
                .map(|(v, l)| v[i] * l)
                .sum::<f64>();
        }
        let s: Vec<f64> = v.iter().map(|v| -units[0] * dot(v, &r)).collect();
        let [force, jump] = units;
        Exercise {
            name: self.name,
            problem: LocalProblem {
                dim,
                w: SparseMatrix::from_dense(rows, rows, |i, j| jump / force * w[i][j]),
                q: scaled(jump, &q),
                mu: self.points.iter().map(|point| point.1).collect(),
                equality: equality(rows, &v, s),
                info: Info::default(),
                solution: None,
                guesses: Vec::new(),
            },
            known: Known::Reactions(scaled(force, &r)),
            amplitudes: scaled(jump, &amplitudes),
            velocity: scaled(jump, &u),
        }
    }
}

/// A body that nothing holds along its normals, pulled away.
fn pulled(name: &'static str, dim: usize) -> Exercise {
    let points = [(Stick, FRICTION); 2];
    let mut exercise = Recipe::new(name, dim, &points).cook();
    let rows = 2 * dim;
    let along_normals = |i: usize| match i % dim {
        0 => 0.5_f64.sqrt(),
        _ => 0.0,
    };
    let v = vec![(0..rows).map(along_normals).collect()];
    exercise.problem.equality = equality(rows, &v, vec![1.0]);
    exercise.known = Known::Nothing;
    exercise
}

/// Reactions and local velocity of a point.
fn at_point(chance: &mut Stream, dim: usize, state: State, mu: f64) -> (Vec<f64>, Vec<f64>) {
    let mut direction: Vec<f64> = (1..dim).map(|_| chance.between(-1.0, 1.0)).collect();
    let length = dot(&direction, &direction).sqrt();
    direction.iter_mut().for_each(|d| *d /= length);
    let with = |normal: f64, size: f64| {
        let tangential = direction.iter().map(move |d| size * d);
        std::iter::once(normal)
            .chain(tangential)
            .collect::<Vec<f64>>()
    };
    let (pressure, slip) = (chance.between(0.5, 1.5), chance.between(0.5, 1.5));
    match state {
        Open => (vec![0.0; dim], with(pressure, slip)),
        Stick => (with(pressure, 0.5 * mu * pressure), vec![0.0; dim]),
        Slip => (with(pressure, -mu * pressure), with(0.0, slip)),
    }
}

/// I + A Aᵀ/m.
fn compliance(chance: &mut Stream, rows: usize) -> Vec<Vec<f64>> {
    let a: Vec<Vec<f64>> = (0..rows)
        .map(|_| (0..rows).map(|_| chance.between(-1.0, 1.0)).collect())
        .collect();
    let entry = |i: usize, j: usize| {
        // The same order of sums on both sides of the diagonal: symmetric to the bit.
        let (i, j) = (i.max(j), i.min(j));
        f64::from(i == j) + dot(&a[i], &a[j]) / rows as f64
    };
    (0..rows)
        .map(|i| (0..rows).map(|j| entry(i, j)).collect())
        .collect()
}

/// Orthonormal vectors (modified Gram-Schmidt, twice).
fn orthonormal(chance: &mut Stream, rows: usize, count: usize) -> Vec<Vec<f64>> {
    let mut all: Vec<Vec<f64>> = Vec::new();
    for _ in 0..count {
        let mut v: Vec<f64> = (0..rows).map(|_| chance.between(-1.0, 1.0)).collect();
        for other in all.iter().chain(&all) {
            let c = dot(other, &v);
            v.iter_mut()
                .zip(other)
                .for_each(|(v, other)| *v -= c * other);
        }
        let length = dot(&v, &v).sqrt();
        v.iter_mut().for_each(|v| *v /= length);
        all.push(v);
    }
    all
}

fn equality(rows: usize, v: &[Vec<f64>], s: Vec<f64>) -> Option<LocalEquality> {
    let count = v.len();
    (count > 0).then(|| LocalEquality {
        v: SparseMatrix::from_dense_columns(rows, v),
        r: SparseMatrix::from_dense(count, count, |_, _| 0.0),
        s,
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn scaled(factor: f64, x: &[f64]) -> Vec<f64> {
    x.iter().map(|x| factor * x).collect()
}
