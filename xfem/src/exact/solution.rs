//! Parts of a closed form: the setting it is built for, its states along a load path, the fields of a state.

use crate::geometry::Point;
use crate::geometry::crack_shape::CrackShape;
use crate::material::{Lame, Material, Model};

/// Words of a case about the body a solution lives in.
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

/// Lamé's constants of a plane setting; an error for a solid.
pub(super) fn plane(setting: &Setting<'_>) -> Result<Lame, String> {
    match setting.model {
        Model::Solid => Err("the model must be plane-strain or plane-stress".into()),
        model => Ok(Lame::new(setting.material, model)),
    }
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

/// A number that the case must give.
pub(super) const fn required(name: &'static str, summary: &'static str) -> ParameterSpec {
    ParameterSpec {
        name,
        summary,
        default: None,
    }
}

/// A number with a default.
pub(super) const fn optional(
    name: &'static str,
    summary: &'static str,
    default: f64,
) -> ParameterSpec {
    ParameterSpec {
        default: Some(default),
        ..required(name, summary)
    }
}

/// A stress component, 0 unless given.
pub(super) const fn stress(name: &'static str, summary: &'static str) -> ParameterSpec {
    optional(name, summary, 0.0)
}

/// The values of so many parameters.
pub(super) fn exactly<const N: usize>(values: &[f64]) -> Result<&[f64; N], String> {
    values
        .try_into()
        .map_err(|_| format!("{N} values are needed"))
}

/// Refuses values by the first condition that does not hold.
pub(super) fn needed(conditions: &[(bool, &str)]) -> Result<(), String> {
    match conditions.iter().find(|(holds, _)| !holds) {
        None => Ok(()),
        Some((_, condition)) => Err(format!("needed: {condition}")),
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
    /// State after a path of load factors: at time 0, then increment by increment, the last one is now. That at time 0 is
    /// reached from rest. The error says why the closed form does not hold there.
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String>;
}

/// A form without history of its own is a function of the path.
impl<F> Solution for F
where
    F: Fn(&[f64]) -> Result<Box<dyn Field>, String> + Send + Sync,
{
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        self(factors)
    }
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

    /// Work of friction since time 0, with loads that change linearly within increments [J, in 2D J/m].
    fn dissipation(&self) -> Option<f64> {
        None
    }
}

/// Visits the increments of a path whose slip would reverse if the load fell: the factor, and the one before; at time 0 twice
/// the same.
pub fn growing(factors: &[f64], mut increment: impl FnMut(f64, f64)) -> Result<(), String> {
    let mut before = 0.0;
    for (k, &factor) in factors.iter().enumerate() {
        if factor < before {
            return Err(format!(
                "the load factor falls from {before} to {factor}: slip would reverse"
            ));
        }
        increment(factor, if k == 0 { factor } else { before });
        before = factor;
    }
    Ok(())
}
