//! All scenes of a suite, and what fails made small.

use std::collections::{BTreeMap, VecDeque};

use super::find::{Effort, find};
use super::finding::{Fault, Finding};
use super::places::{self, Ladder};
use super::rungs;
use super::scene::{Family, Scene, scene};
use super::shrink::smaller;

use crate::studies::lab::{Ask, LabError, Shard};

/// Scenes asked for at once: as many as a ladder of pairs has steps.
const TOGETHER: usize = 72;

/// Scenes of one family, category and fault that are made small: they are likely the same.
const SHRUNK: usize = 2;

/// Attempts to make a scene smaller.
const ATTEMPTS: usize = 80;

/// Unknowns from which a scene is tried an eighth as often.
const LARGE: usize = 5000;

/// How many scenes of every family, and which seed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Suite {
    /// Seed of all scenes.
    pub seed: u64,
    /// Scenes per family.
    pub scenes: BTreeMap<Family, u64>,
    /// Which part: every so many scenes of a family, or ladders.
    pub shard: Shard,
    /// Only ladders whose name has this in it.
    pub ladders: String,
    /// Whether all steps of these are tried.
    pub all_steps: bool,
}

impl Suite {
    /// All scenes, in order.
    pub fn scenes(&self) -> Vec<Scene> {
        let all = (self.scenes.iter()).flat_map(|(&family, &n)| (0..n).map(move |k| (family, k)));
        let Shard { number, of } = self.shard;
        // A part has whole ladders.
        let wanted = |(family, k): &(Family, u64)| {
            if family.is_random() {
                return *k as usize % of == number - 1;
            }
            let (place, ladder, step) = places::step(*k);
            let asked = self.all_steps || step.usual;
            asked && place % of == number - 1 && ladder.name.contains(&self.ladders)
        };
        let own = all.filter(wanted);
        own.map(|(family, k)| scene(family, self.seed, k)).collect()
    }
}

/// The ladder of a step that is compared with others.
fn compared(scene: &Scene) -> Option<&'static Ladder> {
    let own = (!scene.family.is_random()).then(|| places::step(scene.number).1);
    own.filter(|ladder| ladder.compared.is_some())
}

/// Findings on the scenes of a suite, in order; fewer where it was told to stop.
///
/// # Errors
/// [`LabError`].
pub fn run(ask: &mut dyn Ask, scenes: &[Scene]) -> Result<Vec<Finding>, LabError> {
    let (mut findings, mut shrunk) = (Vec::new(), BTreeMap::new());
    let name = |own: &Scene| compared(own).map(|ladder| &ladder.name);
    let ladders = scenes.chunk_by(|a, b| name(a) == name(b));
    for together in ladders.flat_map(|own| own.chunks(TOGETHER)) {
        let found = if let Some(ladder) = compared(&together[0]) {
            rungs::find(ask, ladder, together)?
        } else {
            let mut found = find(ask, together, Effort::All)?;
            shrink(ask, &mut found, &mut shrunk)?;
            found
        };
        let stopped = found.len() < together.len();
        findings.extend(found);
        if stopped {
            break;
        }
    }
    Ok(findings)
}

/// How many scenes of a family and category with a fault were made small.
type Shrunk = BTreeMap<(Family, String, Fault), usize>;

/// A scene that is being made small.
struct Small {
    /// Place of its finding.
    place: usize,
    fault: Fault,
    best: Scene,
    /// Next steps from the best one.
    next: VecDeque<String>,
    left: usize,
}

/// Gives findings the smallest case found that fails for the same fault; all at the same time, one attempt each.
fn shrink(
    ask: &mut dyn Ask,
    findings: &mut [Finding],
    shrunk: &mut Shrunk,
) -> Result<(), LabError> {
    let mut small: Vec<Small> = Vec::new();
    for (place, finding) in findings.iter().enumerate() {
        // Beyond any mesh of such cells: nothing failed.
        let Some(fault) = finding.fault.filter(|fault| *fault != Fault::Beyond) else {
            continue;
        };
        let key = (finding.scene.family, finding.scene.category.clone(), fault);
        let count = shrunk.entry(key).or_default();
        *count += 1;
        if *count <= SHRUNK {
            let main = finding
                .records
                .first()
                .and_then(|own| own.found.problem.as_ref());
            let large = main.is_some_and(|size| size.dofs > LARGE);
            small.push(Small {
                place,
                fault,
                best: finding.scene.clone(),
                next: smaller(&finding.scene.text).into(),
                left: if large { ATTEMPTS / 8 } else { ATTEMPTS },
            });
        }
    }
    // A scene whose fault is that of the default method alone is tried by it alone.
    let all = [
        Fault::FalseClaim,
        Fault::NotInvariant,
        Fault::FrictionLimit,
        Fault::SeveralSolutions,
        Fault::Panic,
    ];
    for (effort, by_all) in [(Effort::Default, false), (Effort::All, true)] {
        let mut own: Vec<&mut Small> = small
            .iter_mut()
            .filter(|own| all.contains(&own.fault) == by_all)
            .collect();
        loop {
            own.retain(|own| own.left > 0 && !own.next.is_empty());
            let candidate = |own: &mut &mut Small| Scene {
                text: own.next.pop_front().unwrap_or_default(),
                ..own.best.clone()
            };
            let candidates: Vec<Scene> = own.iter_mut().map(candidate).collect();
            if candidates.is_empty() {
                break;
            }
            let found = find(ask, &candidates, effort)?;
            for ((own, scene), finding) in own.iter_mut().zip(candidates).zip(found) {
                own.left -= 1;
                if finding.fault == Some(own.fault) {
                    own.next = smaller(&scene.text).into();
                    own.best = scene;
                }
            }
        }
    }
    for own in small {
        findings[own.place].minimal = Some(own.best.text);
    }
    Ok(())
}
