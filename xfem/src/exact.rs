//! Closed forms: exact fields that the discrete solution is measured against.
//!
//! A case names one in its `[exact]` table; supports and loads can take their values from it, and errors of
//! displacement, energy, contact traction, jump and stress intensity are measured against it. Every solution has a file of
//! its own with its derivation, its source and a test of the field equations. Signs as everywhere: the crack normal n
//! points from side 2 to side 1, jump = u₁ − u₂, contact traction is the force per area on side 1, pressure positive.

#[cfg(test)]
mod check;
mod circular_interface;
mod elliptic_crack;
mod manufactured_slip;
mod partial_opening;
mod partial_slip;
mod parts;
mod sliding_block;
mod solution;
mod uniform_slip;
mod uniform_stress;

pub use solution::{Build, Field, ParameterSpec, Setting, Solution, SolutionSpec};

/// All solutions, in the order of the documentation.
pub static SOLUTIONS: &[SolutionSpec] = &[
    uniform_stress::SPEC,
    uniform_slip::SPEC,
    partial_slip::SPEC,
    partial_opening::SPEC,
    sliding_block::SPEC,
    manufactured_slip::FLAT,
    manufactured_slip::SOLID,
    circular_interface::SPEC,
    elliptic_crack::SPEC,
];

/// The solution of a name.
pub fn solution(name: &str) -> Option<&'static SolutionSpec> {
    SOLUTIONS.iter().find(|s| s.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_solution_is_found_by_its_own_name_and_names_its_parameters_once() {
        for (k, spec) in SOLUTIONS.iter().enumerate() {
            assert!(SOLUTIONS[..k].iter().all(|s| s.name != spec.name));
            assert!(solution(spec.name).is_some_and(|s| s.summary == spec.summary));
            for (j, parameter) in spec.parameters.iter().enumerate() {
                let mut before = spec.parameters[..j].iter();
                assert!(before.all(|p| p.name != parameter.name));
            }
        }
        assert!(solution("no-such-solution").is_none());
    }
}
