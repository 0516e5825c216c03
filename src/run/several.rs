//! Problems with several answers: what no judge of a single one can see.

use std::collections::BTreeMap;

use crate::run::record::{Answer, Results};
use crate::run::verdict::Verdict;

/// Jumps that differ by more, relative to u_ref and to the largest of both, are those of different answers: a thousand times what tier high
/// allows the contact laws to be broken.
const DIFFERENT: f64 = 1e-6;

/// Marks what is `solved` on problems to which different answers are known: then none of them is *the* answer. Above the critical
/// friction of a contact an increment may have several, and which one a method finds depends on where it starts.
pub fn mark_several(results: &mut Results) {
    let mut problems: BTreeMap<String, Vec<&Answer>> = BTreeMap::new();
    for answer in &results.answers {
        let own = problems.entry(answer.key.problem()).or_default();
        own.push(answer);
    }
    let several = |answers: &Vec<&Answer>| answers.iter().any(|a| a.differs_from(answers[0]));
    problems.retain(|_, answers| several(answers));
    let ambiguous: Vec<String> = problems.into_keys().collect();
    for row in &mut results.runs {
        if row.verdict == Verdict::Solved && ambiguous.binary_search(&row.key.problem()).is_ok() {
            row.verdict = Verdict::Several;
        }
    }
}

impl Answer {
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
