//! Closed forms: exact fields that the discrete solution is measured against.
//!
//! A case names one in its `[exact]` table; supports and loads can take their values from it, and errors of
//! displacement, energy, contact traction, jump and stress intensity are measured against it. Every solution has a file of
//! its own with its derivation, its source and a test of the field equations. Signs as everywhere: the crack normal n
//! points from side 2 to side 1, jump = u₁ − u₂, contact traction is the force per area on side 1, pressure positive.

#[cfg(test)]
mod check;
mod circular_interface;
mod contact_zone;
mod crack_field;
mod elliptic_crack;
mod elliptic_disc;
mod elliptic_slip;
mod face_load;
mod jet;
mod line_crack;
mod manufactured_slip;
mod manufactured_slip_3d;
mod one_dof;
mod partial_opening;
mod partial_slip;
mod plane_elasticity;
mod sliding_block;
mod uniform_slip;
mod uniform_stress;

use crate::geometry::{CrackShape, Point};
use crate::material::{Material, Model};

/// What a case says about the body a solution lives in.
#[derive(Debug, Clone)]
pub struct Setting<'a> {
    /// Isotropic linear elasticity.
    pub material: Material,
    /// Plane strain, plane stress or a solid.
    pub model: Model,
    /// Coulomb friction coefficient of the run.
    pub friction: f64,
    /// The only crack of the case.
    pub crack: &'a CrackShape,
    /// Lowest and highest corner of the box [m]; third entries 0 in 2D.
    pub body: [Point; 2],
}

/// A number that a solution asks for in the case file.
#[derive(Debug, Clone, Copy)]
pub struct ParameterSpec {
    /// Key in `[exact]`, unit last: `pressure_pa`.
    pub name: &'static str,
    /// One line for the user.
    pub summary: &'static str,
    /// Value if the case gives none; `None`: required.
    pub default: Option<f64>,
}

impl ParameterSpec {
    /// A number that the case must give.
    const fn required(name: &'static str, summary: &'static str) -> Self {
        ParameterSpec {
            name,
            summary,
            default: None,
        }
    }

    /// A number with a default.
    const fn optional(name: &'static str, summary: &'static str, default: f64) -> Self {
        ParameterSpec {
            name,
            summary,
            default: Some(default),
        }
    }
}

/// Builds a solution; the values stand in the order of its parameters. The error says what the setting or a value violates.
pub type Build = fn(&Setting<'_>, &[f64]) -> Result<Box<dyn Solution>, String>;

/// A registered solution.
#[derive(Debug)]
pub struct SolutionSpec {
    /// Name in case files.
    pub name: &'static str,
    /// One line for the user.
    pub summary: &'static str,
    /// Numbers it takes.
    pub parameters: &'static [ParameterSpec],
    /// Builds it.
    pub build: Build,
}

/// A closed form over a load path.
pub trait Solution: Send + Sync {
    /// State after a path of load factors (increment by increment, the last one is now; `[1.0]` for a single increment).
    /// The error says why the closed form does not hold there.
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String>;
}

/// Exact state of a body at one time. `side` is that of the crack, +1 or −1; a formula that holds in the whole body
/// needs it only on the crack itself, where the two faces have different values.
pub trait Field: Send + Sync {
    /// Displacement [m].
    fn displacement(&self, x: &Point, side: f64) -> Point;

    /// Stress σ_ab [Pa], tension positive; 2D: the in-plane part, other entries 0.
    fn stress(&self, x: &Point, side: f64) -> [Point; 3];

    /// Force per volume −div σ [N/m³].
    fn body_force(&self, _x: &Point, _side: f64) -> Point {
        [0.0; 3]
    }

    /// Contact traction on side 1 at a point of the crack, in the local frame (n, a, b) [Pa].
    fn traction(&self, x: &Point) -> [f64; 3];

    /// Jump u₁ − u₂ at a point of the crack, in the local frame (n, a, b) [m].
    fn jump(&self, x: &Point) -> [f64; 3];

    /// K_I, K_II, K_III at a tip or front point [Pa √m], in the frame of the front: ahead, crack normal, their product.
    fn intensity(&self, _front: &Point) -> Option<[f64; 3]> {
        None
    }

    /// Place inside a 2D crack where slip ends and stick begins, if there is one and all slip of the path ends there,
    /// with the 3/2 power of the distance as where a slip zone grows.
    fn stick_boundary(&self) -> Option<Point> {
        None
    }

    /// Frictional dissipation since the start of the path [J, in 2D J/m].
    fn dissipation(&self) -> Option<f64> {
        None
    }
}

/// Visits the increments of a path whose slip would reverse if the load fell: the factor, and the one before.
fn growing(factors: &[f64], mut increment: impl FnMut(f64, f64)) -> Result<(), String> {
    let mut before = 0.0;
    for &factor in factors {
        if factor < before {
            return Err(format!(
                "the load factor falls from {before} to {factor}: slip would reverse"
            ));
        }
        increment(factor, before);
        before = factor;
    }
    Ok(())
}

/// All solutions, in the order of the documentation.
pub static SOLUTIONS: &[SolutionSpec] = &[
    uniform_stress::SPEC,
    uniform_slip::SPEC,
    partial_slip::SPEC,
    partial_opening::SPEC,
    sliding_block::SPEC,
    manufactured_slip::SPEC,
    manufactured_slip_3d::SPEC,
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
                assert!(
                    spec.parameters[..j]
                        .iter()
                        .all(|p| p.name != parameter.name)
                );
            }
        }
        assert!(solution("no-such-solution").is_none());
    }
}
