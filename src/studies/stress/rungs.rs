//! Judges the steps of a ladder of pairs: those of neighbours hardly differ, and no answer much from that in other cells.
//!
//! ```text
//!   Δ = max |a − b| / max(|a|, |b|)    over all cracks, of force, mean slip and dissipation
//!   up to 10⁻³ of a cell               Δ ≤ 10⁻³ between neighbours
//!   beyond                             Δ ≤ 10 % from the same body in 1.39 times as many cells, where both join as many ends
//! ```
//!
//! The latter over the largest of all cracks: what is within a cell of others has an error of up to 8 % of it.

use super::find::{Effort, find as found};
use super::finding::{Fault, Finding};
use super::places::{Compared, Ladder, Step, step};
use super::scene::Scene;
use crate::studies::lab::{Ask, LabError};
use crate::studies::record::Record;

/// Difference of neighbours.
const JUMP: f64 = 1e-3;

/// Difference from other cells.
const MESH: f64 = 0.1;

/// Errors of uniform stress that rounding may be amplified to: of the energy, and of anything else.
const ENERGY: f64 = 1e-7;
const TRACTION: f64 = 1e-5;

/// Part of the largest value of all cracks below which one is none.
const NOTHING: f64 = 1e-6;

/// The answer of a step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    /// Of every crack contact force along n and a [N/m], mean slip [m], dissipation [J/m].
    pub cracks: Vec<[f64; 4]>,
    /// Ends that are joined with what they nearly touch.
    pub joined: usize,
}

/// What is known of a step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rung {
    /// Value of its parameter: a distance up to 1, above digits.
    pub value: f64,
    /// Whether it is compared with its neighbours, or with other cells.
    pub near: bool,
    /// The answer, and that in other cells, where there is one that nobody doubts.
    pub answers: [Option<Answer>; 2],
}

impl Answer {
    fn of(finding: &Finding) -> Option<Self> {
        let right = finding.records.first().filter(|_| finding.fault.is_none());
        let Record { asked, found, .. } = right?;
        let increment = found.increments.last()?;
        let value = |name: &str, at: &str, component: &str| {
            let all = increment.quantities.iter();
            let mut own = all.filter(|q| q.name == name && q.at == at && q.component == component);
            // A crack without contact points has no mean.
            let value = own.next().filter(|q| !q.value.is_nan());
            value.map_or(0.0, |q| q.value)
        };
        let crack = |k: usize| {
            let at = &*format!("crack-{}", k + 1);
            let [n, a] = ["n", "a"].map(|c| value("contact_force", at, c));
            let slip = value("mean_slip", at, "a");
            [n, a, slip, value("dissipation", at, "")]
        };
        Some(Self {
            cracks: (0..asked.friction.len()).map(crack).collect(),
            joined: found.problem.as_ref()?.joined.len(),
        })
    }

    /// Difference from another answer, over no less than that part of the largest value of all cracks; where cracks stick
    /// that of forces.
    fn apart(&self, other: &Self, slips: bool, part: f64) -> f64 {
        let sizes = |own: [f64; 4]| [own[0].hypot(own[1]), own[2].abs(), own[3].abs()];
        let pairs = || self.cracks.iter().zip(&other.cracks);
        let of = |kind: usize| {
            let size = |(a, b): (&[f64; 4], &[f64; 4])| sizes(*a)[kind].max(sizes(*b)[kind]);
            let least = part * pairs().map(size).fold(f64::MIN_POSITIVE, f64::max);
            let away = |(a, b): (&[f64; 4], &[f64; 4])| {
                sizes([0, 1, 2, 3].map(|i| a[i] - b[i]))[kind] / size((a, b)).max(least)
            };
            pairs().map(away).fold(0.0, f64::max)
        };
        (0..if slips { 3 } else { 1 }).map(of).fold(0.0, f64::max)
    }
}

/// What is wrong with the steps of a ladder, and the difference that tells; NaN where nothing is compared.
pub fn judge(rungs: &[Rung], slips: bool) -> Vec<(Option<Fault>, f64)> {
    let mut judged = vec![(None, f64::NAN); rungs.len()];
    let all = 0..rungs.len();
    let (distances, digits): (Vec<usize>, Vec<usize>) = all.partition(|&k| rungs[k].value <= 1.0);
    // All digits are next to no distance.
    let zero = distances.iter().copied().filter(|&k| rungs[k].value == 0.0);
    for order in [zero.chain(digits).collect(), distances.clone()] {
        for near in order.chunk_by(|&a, &b| rungs[a].near && rungs[b].near) {
            let answer = |&k: &usize| Some((k, rungs[k].answers[0].as_ref()?));
            let answers: Vec<(usize, &Answer)> = near.iter().filter_map(answer).collect();
            for pair in answers.windows(2) {
                let apart = pair[0].1.apart(pair[1].1, slips, NOTHING);
                judged[pair[1].0] = (Some(Fault::Jump).filter(|_| apart > JUMP), apart);
            }
        }
    }
    for (own, judged) in rungs.iter().zip(&mut judged) {
        if let [Some(one), Some(other)] = &own.answers
            && one.joined == other.joined
        {
            let apart = one.apart(other, slips, 1.0);
            *judged = (Some(Fault::OtherCells).filter(|_| apart > MESH), apart);
        }
    }
    judged
}

/// Short pieces amplify rounding: an error of uniform stress that is no more is none.
fn allow_rounding(finding: &mut Finding) {
    let record = finding.records.first();
    let check = record.and_then(|own| own.found.check.as_ref());
    let small = check.is_some_and(|own| own.error <= TRACTION && own.energy <= ENERGY);
    if small && matches!(finding.fault, Some(Fault::WrongPatch | Fault::Floor)) {
        finding.fault = None;
        finding.reason.clear();
    }
}

/// Findings on scenes that are steps of one ladder; fewer where it was told to stop.
///
/// # Errors
/// [`LabError`].
pub fn find(
    ask: &mut dyn Ask,
    ladder: &Ladder,
    scenes: &[Scene],
) -> Result<Vec<Finding>, LabError> {
    let mut asked = |scenes: &[Scene]| {
        let mut findings = found(ask, scenes, Effort::Default)?;
        findings.iter_mut().for_each(allow_rounding);
        Ok::<_, LabError>(findings)
    };
    let mut findings = asked(scenes)?;
    let steps: Vec<&Step> = scenes.iter().map(|own| step(own.number).2).collect();
    let other = |(scene, step): (&Scene, &&Step)| {
        let text = step.other.clone()?;
        Some(Scene {
            text,
            ..scene.clone()
        })
    };
    let elsewhere: Vec<Scene> = scenes.iter().zip(&steps).filter_map(other).collect();
    let others = asked(&elsewhere)?;
    if others.len() < elsewhere.len() {
        return Ok(Vec::new());
    }
    let rung = |(own, step): (&Finding, &&Step)| {
        let mut others = others.iter();
        let other = others.find(|other| other.scene.number == own.scene.number);
        Rung {
            value: step.value,
            near: step.other.is_none(),
            answers: [Some(own), other].map(|own| own.and_then(Answer::of)),
        }
    };
    let rungs: Vec<Rung> = findings.iter().zip(&steps).map(rung).collect();
    let Compared { slips, may_step } = ladder.compared.unwrap_or_default();
    for (own, (fault, apart)) in findings.iter_mut().zip(judge(&rungs, slips)) {
        own.apart = apart;
        if fault.is_some() {
            own.fault = fault.map(|fault| if may_step { Fault::Step } else { fault });
            own.reason = format!("{}: {apart:.1e} apart", ladder.name);
        }
    }
    Ok(findings)
}
