//! Material and kinematics: Young's modulus and Poisson's ratio, plane strain, plane stress or a solid.

use crate::geometry::{Point, dot};

/// Kinematics of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// ε_zz = 0; quad4, quantities per metre of thickness.
    PlaneStrain,
    /// σ_zz = 0; quad4, quantities per metre of thickness.
    PlaneStress,
    /// Three-dimensional; hex8.
    Solid,
}

impl Model {
    /// Space dimension, 2 or 3.
    pub fn dim(self) -> usize {
        if self == Model::Solid { 3 } else { 2 }
    }
}

/// Isotropic linear elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus E > 0 [Pa].
    pub young: f64,
    /// Poisson's ratio, 0 <= ν < 0.5 (the upper end is excluded: the solid is then incompressible).
    pub poisson: f64,
}

impl Material {
    /// A material of a Young's modulus and a Poisson's ratio.
    pub const fn new(young: f64, poisson: f64) -> Self {
        Material { young, poisson }
    }
}

/// The dilatation tr ε where the stress is that of the gradient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dilatation {
    /// That of the gradient, point by point.
    Full,
    /// Its mean over a cell, or over every region of a cut one: see [`stiffness::dilatation`](crate::stiffness::dilatation).
    Mean,
}

impl Dilatation {
    /// Poisson's ratio above which the mean is taken: full dilatation lacks 0.5 % of the energy of pure bending on 11 × 11 cells
    /// at ν = 0.3, 0.9 % at 0.4, 1.9 % at 0.45, 9 % at 0.49.
    pub const MEAN_ABOVE: f64 = 0.4;

    /// Demand of a material. Plane stress is free to change its thickness and never locks.
    pub fn of(material: Material, model: Model) -> Self {
        if model != Model::PlaneStress && material.poisson > Self::MEAN_ABOVE {
            Dilatation::Mean
        } else {
            Dilatation::Full
        }
    }
}

/// Lamé constants of the model [Pa].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lame {
    /// λ; in plane stress the effective 2λμ/(λ + 2μ).
    pub lambda: f64,
    /// μ, the shear modulus.
    pub mu: f64,
    /// σ_zz = λ_z (ε_xx + ε_yy): λ in plane strain, 0 in plane stress, unused in 3D.
    pub lambda_z: f64,
    /// Whether the stress is [assumed](crate::stiffness::assumed_stress) in the regions without branch functions.
    pub assumed: bool,
    /// The dilatation that λ multiplies where it is not.
    pub dilatation: Dilatation,
}

impl Lame {
    /// λ = E ν / ((1 + ν)(1 − 2ν)), μ = E / (2 (1 + ν)); assumed stress, elsewhere the dilatation as [`Dilatation::of`] has it.
    pub fn new(material: Material, model: Model) -> Self {
        let Material { young, poisson } = material;
        let mu = young / (2.0 * (1.0 + poisson));
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let (lambda, lambda_z) = match model {
            Model::PlaneStress => (2.0 * lambda * mu / (lambda + 2.0 * mu), 0.0),
            Model::PlaneStrain | Model::Solid => (lambda, lambda),
        };
        Lame {
            lambda,
            mu,
            lambda_z,
            assumed: true,
            dilatation: Dilatation::of(material, model),
        }
    }

    /// Von Mises stress [Pa] from the displacement gradient h[a][b] = ∂u_a/∂x_b. Whichever dilatation λ multiplies: the
    /// pressure cancels.
    pub fn von_mises(&self, h: &[Point; 3], dim: usize) -> f64 {
        let mut s = stress(*self, dim, h);
        if dim == 2 {
            s[2][2] = self.lambda_z * (h[0][0] + h[1][1]);
        }
        let [x, y, z] = [s[0][0], s[1][1], s[2][2]];
        let shear = s[0][1] * s[0][1] + s[1][2] * s[1][2] + s[0][2] * s[0][2];
        (0.5 * ((x - y).powi(2) + (y - z).powi(2) + (z - x).powi(2)) + 3.0 * shear).sqrt()
    }
}

/// σ = λ tr ε I + 2 μ ε from the displacement gradient [Pa]; 2D: the in-plane part.
pub fn stress(lame: Lame, dim: usize, h: &[Point; 3]) -> [Point; 3] {
    let trace: f64 = (0..dim).map(|a| h[a][a]).sum();
    let mut s = [[0.0; 3]; 3];
    for a in 0..dim {
        for b in 0..dim {
            s[a][b] = lame.mu * (h[a][b] + h[b][a]);
        }
        s[a][a] += lame.lambda * trace;
    }
    s
}

/// ε = (σ − λ/(d λ + 2 μ) tr σ I) / (2 μ), d the dimension; in 2D the out-of-plane stress of plane strain and the effective
/// λ of plane stress are in it.
pub fn strain(lame: Lame, dim: usize, s: &[Point; 3]) -> [Point; 3] {
    let trace: f64 = (0..dim).map(|a| s[a][a]).sum();
    let part = lame.lambda / (dim as f64 * lame.lambda + 2.0 * lame.mu) * trace;
    let mut e = [[0.0; 3]; 3];
    for a in 0..dim {
        for b in 0..dim {
            e[a][b] = s[a][b] / (2.0 * lame.mu);
        }
        e[a][a] -= part / (2.0 * lame.mu);
    }
    e
}

/// a : b
pub fn double_dot(a: &[Point; 3], b: &[Point; 3]) -> f64 {
    (0..3).map(|k| dot(&a[k], &b[k])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material = Material::new(210e9, 0.3);

    #[test]
    fn uniaxial_von_mises_is_the_stress_itself() {
        let lame = Lame::new(STEEL, Model::Solid);
        let e = 1e-3;
        let h = [[e, 0.0, 0.0], [0.0, -0.3 * e, 0.0], [0.0, 0.0, -0.3 * e]];
        assert!((lame.von_mises(&h, 3) / (STEEL.young * e) - 1.0).abs() < 1e-12);
        let plane_stress = Lame::new(STEEL, Model::PlaneStress);
        assert!((plane_stress.von_mises(&h, 2) / (STEEL.young * e) - 1.0).abs() < 1e-12);
    }
}
