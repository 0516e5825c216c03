//! The independent check of what is known of an answer: uniform stress where all cracks stick, otherwise the energy.
//!
//! It reads what every user can read: quantities, contact points and the fields of the pictures.

use serde::{Deserialize, Serialize};
use stickslip_methods::PointStatus;

use super::energy::{Energies, Found, Joined};
use super::scene::Shape;
use super::scene::flat::{Flat, Place, distance};
use super::uniform::Uniform;
use crate::case::Case;
use crate::files::nan;
use crate::model::quantities::PointState;

/// Error of the energy identity that is rounding, in a body whose forces hold to 1e-12.
const ENERGY: f64 = 1e-8;

/// Relative error that is rounding.
const ROUNDING: f64 = 1e-9;

/// Turn of a crack that is moved, over by how much, in shortest edges.
const TURNED: f64 = 10.0;

/// Force that is rounding whatever the length it acts on: relative to that on a whole cell. Points that stand for less
/// than 1e-3 of a cell are held to this.
const FLOOR: f64 = 1e-12;

/// Result of the check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Whether it is the closed form of uniform stress; else it is the energy.
    pub uniform: bool,
    /// The fault, in words.
    pub faults: Vec<String>,
    /// Largest relative error.
    #[serde(with = "nan")]
    pub error: f64,
    /// That of the energy alone.
    #[serde(with = "nan", default = "nan::nothing")]
    pub energy: f64,
    /// A matter to be looked at, and no fault.
    pub remark: String,
}

/// Checks an answer; none where nothing is known of it.
pub fn check(case: &Case, found: Found<'_>) -> Option<Check> {
    if let Some(patch) = Patch::of(case, found.joined) {
        let (faults, [error, energy]) = compare(&patch, found);
        return Some(Check {
            uniform: true,
            faults,
            error,
            energy,
            remark: uncovered(&patch, found),
        });
    }
    let energies = Energies::of(case, found);
    if !energies.are_there() {
        return None;
    }
    let identity = found.quantity("energy_identity").unwrap_or(f64::NAN).abs();
    let dissipation = found.quantity("dissipation").unwrap_or(f64::NAN);
    let friction = energies.relative(dissipation - friction_work(case, found.points));
    // NaN is the larger.
    let error = if identity >= friction || identity.is_nan() {
        identity
    } else {
        friction
    };
    let wrong = error.is_nan() || error > ENERGY;
    let fault = wrong.then(|| format!("energy identity or friction off by {error:.1e}"));
    Some(Check {
        uniform: false,
        faults: fault.into_iter().collect(),
        error,
        energy: error,
        remark: String::new(),
    })
}

/// ½ Σ μ P_n |d| over the slipping points of an increment from rest: what friction took.
fn friction_work(case: &Case, points: &[PointState]) -> f64 {
    let slipping = points
        .iter()
        .filter(|p| p.status == PointStatus::Slip.as_str());
    let work = |p: &PointState| {
        let mu = case.cracks[p.crack - 1].friction;
        0.5 * mu * p.p_n.max(0.0) * p.slip_a_m.hypot(p.slip_b_m)
    };
    slipping.map(work).sum()
}

/// Size of a contact force.
pub fn magnitude(p: &PointState) -> f64 {
    p.p_n.hypot(p.p_a).hypot(p.p_b)
}

/// A case in uniform stress: what its answer is held to.
struct Patch {
    exact: Uniform,
    cracks: Vec<Shape>,
}

impl Patch {
    /// Of a case that has such an answer, its cracks as they are told to be joined.
    fn of(case: &Case, joined: &[Joined]) -> Option<Self> {
        let cracks = (0..case.cracks.len()).map(|k| Shape::of(&case.crack_in_file(k)));
        let mut cracks: Vec<Shape> = cracks.collect();
        for Joined { crack, from, to } in joined {
            if let Shape::Flat(Flat::Chain(points)) = &mut cracks[*crack] {
                let away = |p: &Place| distance(p, &[from[0], from[1]]);
                let put = points.iter_mut().min_by(|p, q| away(p).total_cmp(&away(q)));
                put.into_iter().for_each(|p| *p = [to[0], to[1]]);
            }
        }
        Some(Patch {
            exact: Uniform::of(&case.source)?,
            cracks,
        })
    }
}

/// The largest of some errors, and where; a NaN is the largest.
#[derive(Default)]
struct Worst(f64, String);

impl Worst {
    fn see(&mut self, error: f64, place: impl FnOnce() -> String) {
        if error > self.0 || error.is_nan() && !self.0.is_nan() {
            *self = Worst(error, place());
        }
    }
}

/// The quantity that differs from the closed form, the largest relative error, and that of the energy.
fn compare(patch: &Patch, answer: Found<'_>) -> (Vec<String>, [f64; 2]) {
    let exact = &patch.exact;
    let mut found: Vec<(&str, Worst)> = Vec::new();
    let quantity = |name: &str| answer.quantity(name).unwrap_or(f64::NAN);
    let mut energy = Worst::default();
    let error = (quantity("strain_energy") / exact.energy() - 1.0).abs();
    energy.see(error, String::new);
    found.push(("energy", energy));
    let mut overlap = Worst::default();
    let error = quantity("max_penetration_sampled") / exact.largest();
    overlap.see(error, String::new);
    found.push(("penetration", overlap));
    found.push(("displacement", displacement(exact, answer)));
    let mut traction = Worst::default();
    for p in answer.points {
        let error = match &patch.cracks[p.crack - 1] {
            Shape::Flat(flat) => flat_error(exact, flat, p),
            Shape::Solid(flaw) => solid_error(exact, &flaw.normal(), p),
        };
        traction.see(error, || {
            format!(
                "crack {} at {:?}, weight {:.1e}",
                p.crack,
                (p.x_m, p.y_m, p.z_m),
                p.weight
            )
        });
    }
    found.push(("traction", traction));
    if exact.dim == 3 {
        found.push(("traction in space", directions(patch, answer)));
    } else {
        found.push(("surface", surface(patch, answer)));
    }
    let largest = found.iter().fold(
        0.0,
        |m: f64, (_, w)| {
            if w.0.is_nan() { w.0 } else { m.max(w.0) }
        },
    );
    // Of the cracks as they are told: where one is bent by so much, a tenth of a cell from the next place, it turns by ten times as
    // much.
    let rounding = ROUNDING.max(exact.place()).max(TURNED * answer.moved);
    let errors = [largest, found[0].1.0];
    let wrong = found
        .into_iter()
        .filter(|(_, w)| w.0.is_nan() || w.0 > rounding);
    let told = wrong.map(|(what, Worst(error, place))| format!("{what} {error:.1e} {place}"));
    (told.collect(), errors)
}

/// Displacement of nodes and of both faces of every crack, relative to the largest.
fn displacement(exact: &Uniform, answer: Found<'_>) -> Worst {
    let mut worst = Worst::default();
    let Some(step) = answer.fields else {
        return Worst(f64::NAN, "no field".into());
    };
    let vectors = &step.body.point_vectors;
    let Some((_, u)) = vectors.iter().find(|(name, _)| name == "displacement_m") else {
        return Worst(f64::NAN, "no field".into());
    };
    for (x, u) in step.body.points.iter().zip(u) {
        let right = exact.displacement(x);
        for a in 0..exact.dim {
            let error = (u[a] - right[a]).abs() / exact.largest();
            worst.see(error, || format!("at {:?}", (x[0], x[1], x[2])));
        }
    }
    worst
}

/// Error of a traction at a point, relative to the largest stress; a point that stands for next to nothing by its force.
fn relative(exact: &Uniform, error: f64, weight: f64) -> f64 {
    let floor = FLOOR / ROUNDING * exact.cell.powi(exact.dim as i32 - 1);
    error * weight / weight.max(floor) / exact.size()
}

/// Error of a contact point of a plane body.
///
/// On one segment the two components are known. Near a kink, and on an arc, a point may be the mean over several
/// normals: then the length of its traction must lie between those of the means.
fn flat_error(exact: &Uniform, flat: &Flat, p: &PointState) -> f64 {
    let found = [p.p_n / p.weight, p.p_a / p.weight];
    let size = found[0].hypot(found[1]);
    let off = |low: f64, high: f64| {
        let beyond = (size - high).max(low - size);
        if beyond.is_nan() {
            beyond
        } else {
            beyond.max(0.0)
        }
    };
    let error = match flat {
        Flat::Arc { radius, .. } => {
            let pressure = -exact.stress[0];
            let half = (3.0 * p.weight.max(exact.cell) / radius).min(1.5);
            let mean = off(half.cos() * pressure, pressure);
            let plain = (found[0] - pressure).abs().max(found[1].abs());
            // No shear, whatever the frame; a mean in a frame of its own has none either.
            plain.min(mean.max(found[1].abs()))
        }
        Flat::Chain(points) => {
            let normals = flat.normals();
            let x = [p.x_m, p.y_m];
            let reach = 4.0 * p.weight + 1e-6 * exact.cell;
            let away = |k: usize| to_segment(&x, &points[k], &points[k + 1]);
            let nearest = (0..normals.len()).map(away).fold(f64::MAX, f64::min);
            let near: Vec<[f64; 3]> = (0..normals.len())
                .filter(|&k| away(k) <= nearest + reach)
                .map(|k| normals[k])
                .collect();
            if let [n] = near[..] {
                let t = exact.traction(&n);
                // The tangent is the normal turned by −90 degrees.
                let right = [t[0] * n[0] + t[1] * n[1], t[0] * n[1] - t[1] * n[0]];
                (found[0] - right[0]).abs().max((found[1] - right[1]).abs())
            } else {
                let (mut low, mut high) = (f64::MAX, 0.0f64);
                for (i, m) in near.iter().enumerate() {
                    for n in &near[i..] {
                        for k in 0..=20 {
                            let s = f64::from(k) / 20.0;
                            let mean = [0, 1, 2].map(|a| (1.0 - s) * m[a] + s * n[a]);
                            let t = exact.traction(&mean);
                            let size = t[0].hypot(t[1]);
                            (low, high) = (low.min(size), high.max(size));
                        }
                    }
                }
                // Three normals at once, and the grain of the samples.
                off(if near.len() > 2 { 0.0 } else { 0.99 * low }, high)
            }
        }
    };
    relative(exact, error, p.weight)
}

fn to_segment(x: &[f64; 2], p: &[f64; 2], q: &[f64; 2]) -> f64 {
    let d = [q[0] - p[0], q[1] - p[1]];
    let t = ((x[0] - p[0]) * d[0] + (x[1] - p[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
    let t = t.clamp(0.0, 1.0);
    distance(x, &[p[0] + t * d[0], p[1] + t * d[1]])
}

/// Error of a contact point in a solid: pressure and size of the shear; its axes are told in space only.
fn solid_error(exact: &Uniform, n: &[f64; 3], p: &PointState) -> f64 {
    let t = exact.traction(n);
    let pressure: f64 = (0..3).map(|a| t[a] * n[a]).sum();
    let shear = exact.steepness(n) * pressure;
    let found = [p.p_n, p.p_a, p.p_b].map(|v| v / p.weight);
    let error = (found[0] - pressure).abs();
    let error = error.max((found[1].hypot(found[2]) - shear).abs());
    relative(exact, error, p.weight)
}

/// Tractions in space on the faces of flat cracks: at every corner that of one of the cracks. To 1e-6 of the stress, and
/// passed on as a thousandth of it: slivers have been seen by their force already.
fn directions(patch: &Patch, answer: Found<'_>) -> Worst {
    let exact = &patch.exact;
    let mut worst = Worst::default();
    let Some(step) = answer.fields else {
        return Worst(f64::NAN, "no field".into());
    };
    let vectors = &step.crack.point_vectors;
    let Some((_, found)) = vectors.iter().find(|v| v.0 == "contact_traction_pa") else {
        return Worst(f64::NAN, "no field".into());
    };
    let normals = patch.cracks.iter().filter_map(|crack| match crack {
        Shape::Solid(flaw) => Some(flaw.normal()),
        Shape::Flat(_) => None,
    });
    let right: Vec<[f64; 3]> = normals.map(|n| exact.traction(&n)).collect();
    for (x, t) in step.crack.points.iter().zip(found) {
        let away = |r: &[f64; 3]| {
            let square: f64 = (0..3).map(|a| (t[a] - r[a]).powi(2)).sum();
            square.sqrt() / exact.size()
        };
        let error = right.iter().map(away).reduce(f64::min).unwrap_or(f64::NAN);
        worst.see(1e-3 * error, || format!("at {:?}", (x[0], x[1], x[2])));
    }
    worst
}

/// Measure that the points of a plane crack stand for, and its length in the body [m].
fn lengths<'a>(
    patch: &'a Patch,
    answer: Found<'a>,
) -> impl Iterator<Item = (usize, f64, f64)> + 'a {
    let Uniform { min, max, .. } = &patch.exact;
    let flat = patch
        .cracks
        .iter()
        .enumerate()
        .filter_map(|(k, crack)| match crack {
            Shape::Flat(flat) => Some((k + 1, flat)),
            Shape::Solid(_) => None,
        });
    flat.map(move |(number, flat)| {
        let points = answer.points.iter();
        let own = points.filter(|p| p.crack == number);
        let total = own.map(|p| p.weight).sum();
        // Chords may stay inside where the arc leaves the body by less than their height c²/8R.
        let height = match flat {
            Flat::Arc { radius, .. } => patch.exact.cell.powi(2) / (8.0 * radius),
            Flat::Chain(_) => 0.0,
        };
        let [low, high] = [(min, -height), (max, height)].map(|(x, d)| x.map(|x| x + d));
        (number, total, flat.length_in(&low, &high))
    })
}

/// By how much the points of a crack stand for more than its length in the body, in cells. An end that is moved onto a
/// crack beside it, and the small steps in which an arc is measured, are none of it.
fn surface(patch: &Patch, answer: Found<'_>) -> Worst {
    let mut worst = Worst::default();
    for (number, total, length) in lengths(patch, answer) {
        let excess = (total - 1.001 * length) / patch.exact.cell - 0.01;
        worst.see(excess, || format!("crack {number}: {total} of {length} m"));
    }
    worst
}

/// Cracks of which more is missing than the cells of their ends. No fault in uniform stress, which a crack that is not
/// there solves as well; and where a support holds the normal jump there is no contact. To be looked at.
fn uncovered(patch: &Patch, answer: Found<'_>) -> String {
    let few =
        |(_, total, length): &(usize, f64, f64)| total + 2.5 * patch.exact.cell < 0.95 * length;
    let told =
        |(number, total, length)| format!("crack {number} acts on {total:.2e} of {length:.2e} m");
    let all: Vec<String> = lengths(patch, answer).filter(few).map(told).collect();
    all.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::choice::Choice;
    use crate::studies::axes::{Axes, Subject, named};
    use crate::studies::measure::{Bench, measure};
    use crate::studies::stress::scene::{Family, scene};
    use crate::studies::task::Looks;
    use crate::{case, run::verdict::Accuracy};

    /// The check itself: it must see a traction, a displacement and an energy that are off by 1e-6.
    #[test]
    fn errors_that_are_put_in_are_seen() {
        let text = scene(Family::Patch2d, 20_261_122, 0).text;
        let case = case::parse("scene.toml", text).unwrap();
        let choice = [Choice::parse("b-newton").unwrap()];
        let looks = Looks {
            quantities: true,
            curves: true,
            fields: true,
            ..Looks::default()
        };
        let accuracy = [Accuracy::own(&case)];
        let tasks = Subject::of(&case).tasks(&Axes::of(&case), &named(&choice), &accuracy, looks);
        let mut bench = Bench::default();
        let scene = bench.scene(&tasks[0]).unwrap();
        let answer = measure(&scene, &tasks[0], &choice[0]).unwrap();
        let found = Found {
            quantities: &answer.record.found.increments[0].quantities,
            points: &answer.points[0],
            fields: answer.fields.last(),
            jump: 0.0,
            moved: 0.0,
            joined: &[],
        };
        let faults = |change: &dyn Fn(&mut Uniform)| {
            let mut patch = Patch::of(&case, &[]).unwrap();
            change(&mut patch.exact);
            compare(&patch, found).0.join("; ")
        };
        assert_eq!(faults(&|_| ()), "");
        for a in 0..2 {
            let reason = faults(&|exact| exact.stress[a] *= 1.0 + 1e-6);
            assert!(reason.contains("traction"), "{reason}");
            let reason = faults(&|exact| exact.strain[a] *= 1.0 + 1e-6);
            assert!(reason.contains("displacement"), "{reason}");
            assert!(reason.contains("energy"), "{reason}");
        }
    }
}
