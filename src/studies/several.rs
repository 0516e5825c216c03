//! Problems with several answers: what no judge of a single one can see.

use std::collections::{BTreeMap, BTreeSet};

use crate::run::verdict::Verdict;
use crate::studies::measure::Answer;
use crate::studies::record::Step;
use crate::studies::rows::{Jump, RunKey};

/// Jumps that differ by more, relative to u_ref and to the largest of both, are those of different answers: a thousand times what tier high
/// allows the contact laws to be broken.
pub const DIFFERENT: f64 = 1e-6;

/// Marks what is `solved` on problems to which different answers are known: then none of them is *the* answer. Above the critical
/// friction of a contact an increment may have several, and which one a method finds depends on where it starts.
pub fn mark_several(answers: &mut [Answer]) {
    let known = answers.iter().flat_map(|own| {
        let problem = |jump: &Jump| RunKey::of(&own.record, jump.increment).problem();
        own.jumps.iter().map(move |jump| (problem(jump), jump))
    });
    let ambiguous = ambiguous(known);
    for record in answers.iter_mut().map(|own| &mut own.record) {
        let problem = |step: &Step| RunKey::of(record, step.increment).problem();
        let marked = record.found.increments.iter().map(problem);
        let marked: Vec<bool> = marked.map(|name| ambiguous.contains(&name)).collect();
        for (step, marked) in record.found.increments.iter_mut().zip(marked) {
            step.verdict.mark(marked);
        }
        if let Some(last) = record.found.increments.last() {
            record.found.verdict = last.verdict.clone();
        }
    }
}

/// Problems with different answers among some.
fn ambiguous<'a>(answers: impl Iterator<Item = (String, &'a Jump)>) -> BTreeSet<String> {
    let mut problems: BTreeMap<String, Vec<&Jump>> = BTreeMap::new();
    for (problem, jump) in answers {
        problems.entry(problem).or_default().push(jump);
    }
    problems.retain(|_, answers| answers.iter().any(|a| a.differs_from(answers[0])));
    problems.into_keys().collect()
}

impl Verdict {
    /// Marks what is solved where another answer is known.
    pub fn mark(&mut self, ambiguous: bool) {
        if ambiguous && *self == Self::Solved {
            *self = Self::Several;
        }
    }
}

impl Jump {
    fn differs_from(&self, other: &Self) -> bool {
        // Where all sticks the jumps are rounding.
        let reference = self.reference_jump.max(other.reference_jump);
        let jumps = self.jump.iter().chain(&other.jump);
        let size = jumps.fold(reference, |m, x| m.max(x.abs()));
        let mut apart = self
            .jump
            .iter()
            .zip(&other.jump)
            .map(|(a, b)| (a - b).abs());
        apart.any(|apart| apart > DIFFERENT * size)
    }
}
