//! Problems with several answers: what no judge of a single one can see.

use std::collections::{BTreeMap, BTreeSet};

use crate::run::verdict::Verdict;
use crate::studies::rows::{Jump, Results};

/// Jumps that differ by more, relative to u_ref and to the largest of both, are those of different answers: a thousand times what tier high
/// allows the contact laws to be broken.
pub const DIFFERENT: f64 = 1e-6;

/// Marks what is `solved` on problems to which different answers are known: then none of them is *the* answer. Above the critical
/// friction of a contact an increment may have several, and which one a method finds depends on where it starts.
pub fn mark_several(results: &mut Results) {
    let ambiguous = ambiguous(&results.answers);
    for row in &mut results.runs {
        row.step
            .verdict
            .mark(ambiguous.contains(&row.key.problem()));
    }
}

/// Problems with different answers among some.
pub fn ambiguous(answers: &[(String, Jump)]) -> BTreeSet<String> {
    let mut problems: BTreeMap<&str, Vec<&Jump>> = BTreeMap::new();
    for (problem, jump) in answers {
        problems.entry(problem).or_default().push(jump);
    }
    problems.retain(|_, answers| answers.iter().any(|a| a.differs_from(answers[0])));
    problems.into_keys().map(str::to_owned).collect()
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
