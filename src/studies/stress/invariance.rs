//! What transformations change: a scene is run again, and forces and energies are compared.

use super::examine::{FILE, default_method, has_place, magnitude, run};
use super::finding::Change;
use super::scene::Scene;
use super::transform::{Transform, finer};
use crate::case::{self, Case};
use crate::model::quantities::PointState;
use crate::run::record::{Results, RunRow};
use crate::run::run_case::RunError;
use crate::run::verdict::Verdict;

/// Change of contact forces by a transformation that is rounding; the table counts digits by it.
pub const INVARIANT: f64 = 1e-9;

/// Change of energy by other contact points that is nothing beside the error of any mesh; a larger one is compared with
/// what a mesh twice as fine changes.
const CHOSEN: f64 = 0.02;

/// Quantities whose change measures how far two answers are apart.
const ENERGIES: [&str; 2] = ["strain_energy", "dissipation"];

/// Part of the energy of a deformed body below which energy is rounding.
const STILL: f64 = 1e-10;

/// How many transformations a scene is put through, in 2D and in 3D: other scenes take the next ones.
const TRANSFORMED: [usize; 2] = [4, 2];

/// The answer of a scene as it is.
pub struct Base<'a> {
    scene: &'a Scene,
    case: &'a Case,
    points: &'a [PointState],
    /// Those of [`ENERGIES`].
    energies: [f64; 2],
    /// What a change of them is relative to.
    scale: f64,
}

impl<'a> Base<'a> {
    /// `quantity`: by name; `jump`: the largest jump [m].
    pub fn new(
        scene: &'a Scene,
        case: &'a Case,
        points: &'a [PointState],
        quantity: impl Fn(&str) -> Option<f64>,
        jump: f64,
    ) -> Self {
        let energies = ENERGIES.map(|name| quantity(name).unwrap_or(0.0));
        // A piece that only moves has no energy but rounding: E u² L^(dim−2) is that of one as large that is deformed.
        let area: f64 = points.iter().map(|p| p.weight).sum();
        let length = if scene.dim == 3 { area.sqrt() } else { 1.0 };
        let deformed = case.material.young * jump.powi(2) * length;
        let total = energies.iter().map(|e| e.abs()).sum::<f64>();
        let scale = total.max(STILL * deformed);
        Base {
            scene,
            case,
            points,
            energies,
            scale,
        }
    }

    /// Whether the body has an energy: one whose pieces only move has none but rounding.
    pub fn has_energy(&self) -> bool {
        self.energies.iter().map(|e| e.abs()).sum::<f64>() >= self.scale
    }

    /// An energy over those of the body [-].
    pub fn relative(&self, energy: f64) -> f64 {
        energy.abs() / self.scale
    }

    /// Change by the transformations of the scene that apply to it.
    pub fn changes(&self) -> Vec<Change> {
        let many = TRANSFORMED[self.scene.dim - 2];
        let first = self.scene.number as usize * many;
        let own = (0..many).map(|k| &Transform::ALL[(first + k) % Transform::ALL.len()]);
        own.filter_map(|transform| self.change(transform)).collect()
    }

    fn change(&self, transform: &Transform) -> Option<Change> {
        let text = transform.apply(&self.scene.text)?;
        let changed = case::parse(FILE, text).map_err(RunError::from);
        let results = changed.and_then(|case| run(&case, &default_method()));
        let refused = results.as_ref().is_err_and(|e| has_place(&e.to_string()));
        let suspect = |r: &RunRow| matches!(r.verdict, Verdict::Suspect(_));
        let doubted = results.as_ref().is_ok_and(|r| r.runs.iter().any(suspect));
        // Other contact points may be too few of them; and where the judge has doubts nothing is claimed.
        if refused && !transform.is_exact() || doubted {
            return None;
        }
        // Another verdict is the largest change there is.
        let (mut force, mut energy, mut verdict) = (None, 1.0, None);
        match results {
            Err(error) => verdict = Some(error.to_string()),
            Ok(results) => match results.runs.iter().find(|r| !r.verdict.is_solved()) {
                Some(row) => verdict = Some(row.verdict.to_string()),
                None => {
                    energy = self.energy(&results, transform.energy(self.scene.dim));
                    let own = results.points.into_iter();
                    force = self.force(transform, &own.map(|row| row.point).collect::<Vec<_>>());
                }
            },
        }
        Some(Change {
            transformation: transform.name(),
            exact: transform.is_exact(),
            verdict,
            force,
            energy: if energy.is_finite() { energy } else { 1.0 },
        })
    }

    /// Change of energies that are to be `factor` times what they were.
    fn energy(&self, results: &Results, factor: f64) -> f64 {
        let away = |(name, before): (&str, f64)| {
            let mut own = results.quantities.iter().map(|row| &row.quantity);
            let after = own.find(|q| q.name == name && q.at.is_empty());
            after.map_or(f64::MAX, |q| (q.value / factor - before).abs())
        };
        ENERGIES
            .into_iter()
            .zip(self.energies)
            .map(away)
            .sum::<f64>()
            / self.scale
    }

    /// Largest change of pressure and shear over the contact points, over the largest force; none where the points are
    /// others.
    fn force(&self, transform: &Transform, other: &[PointState]) -> Option<f64> {
        /// Points closer than this part of the weight of one are the same.
        const SAME: f64 = 1e-3;
        let (scene, base) = (self.scene, self.points);
        let size = base.iter().map(magnitude).fold(0.0, f64::max);
        if base.len() != other.len() {
            return None;
        }
        if size == 0.0 {
            return Some(other.iter().map(magnitude).fold(0.0, f64::max).min(1.0));
        }
        let places = transform.places(&scene.text)?;
        let shear = |p: &PointState| p.p_a.hypot(p.p_b);
        let mut largest: f64 = 0.0;
        for p in base {
            let x = places.point([p.x_m, p.y_m, p.z_m]);
            let crack = transform.crack(p.crack, self.case.cracks.len());
            let away = |q: &&PointState| {
                let d = [q.x_m - x[0], q.y_m - x[1], q.z_m - x[2]];
                d.iter().map(|v| v * v).sum::<f64>().sqrt()
            };
            let own = other.iter().filter(|q| q.crack == crack);
            let q = own.min_by(|a, b| away(a).total_cmp(&away(b)))?;
            let width = p.weight.powf(1.0 / (scene.dim as f64 - 1.0)) * transform.length();
            if away(&q) > SAME * width {
                return None;
            }
            let factor = transform.force(scene.dim);
            let normal = (q.p_n / factor - p.p_n).abs();
            largest = largest.max(normal.max((shear(q) / factor - shear(p)).abs()) / size);
        }
        Some(largest)
    }

    /// The first change that is neither rounding nor, where names and last digits changed, below the error of the mesh: at
    /// first order twice what a mesh twice as fine changes.
    pub fn not_kept(&self, changes: &[Change]) -> Option<String> {
        let chosen = |c: &Change| c.exact || c.energy <= CHOSEN;
        let error = match changes.iter().all(chosen) {
            true => CHOSEN,
            false => CHOSEN.max(2.0 * self.refined().unwrap_or(0.0)),
        };
        let kept = |c: &&Change| match c.exact {
            true => c.force.is_some_and(|f| f <= INVARIANT) && c.energy <= INVARIANT,
            false => c.energy <= error,
        };
        let lost = changes.iter().find(|c| !kept(c))?;
        Some(format!("{}: {lost}", lost.transformation))
    }

    /// Change of energy by a mesh twice as fine; none where that has no answer.
    fn refined(&self) -> Option<f64> {
        let case = case::parse(FILE, finer(&self.scene.text)?).ok()?;
        let results = run(&case, &default_method()).ok()?;
        let solved = results.runs.iter().all(|r| r.verdict.is_solved());
        solved.then(|| self.energy(&results, 1.0))
    }
}
