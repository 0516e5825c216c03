//! Constants of plane elasticity in the form closed forms use.
//!
//! ```text
//!                    plane strain        plane stress
//!   κ                3 − 4ν              (3 − ν)/(1 + ν)
//!   E'               E/(1 − ν²)          E                  (κ + 1)/(2G) = 4/E'
//!   ν'               ν/(1 − ν)           ν                  ε_xx = (σ_xx − ν' σ_yy)/E'
//! ```

use crate::material::{Lame, Model};

use crate::exact::solution::Setting;

/// Elastic constants of a plane problem.
#[derive(Debug, Clone, Copy)]
pub struct PlaneElasticity {
    /// Shear modulus G [Pa].
    pub shear: f64,
    /// Kolosov's constant κ.
    pub kappa: f64,
    /// E' [Pa].
    pub modulus: f64,
    /// ν'.
    pub ratio: f64,
}

impl PlaneElasticity {
    /// Of a plane setting; an error for a solid.
    pub fn new(setting: &Setting<'_>) -> Result<Self, String> {
        if setting.model == Model::Solid {
            return Err("the model must be plane-strain or plane-stress".into());
        }
        let Lame { lambda, mu, .. } = Lame::new(setting.material, setting.model);
        Ok(PlaneElasticity {
            shear: mu,
            kappa: (lambda + 3.0 * mu) / (lambda + mu),
            modulus: 4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu),
            ratio: lambda / (lambda + 2.0 * mu),
        })
    }

    /// Strain (xx, yy, xy) of a stress (xx, yy, xy) [Pa].
    pub fn strain(&self, [xx, yy, xy]: [f64; 3]) -> [f64; 3] {
        [
            (xx - self.ratio * yy) / self.modulus,
            (yy - self.ratio * xx) / self.modulus,
            0.5 * xy / self.shear,
        ]
    }
}
