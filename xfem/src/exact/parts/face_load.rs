//! Crack under polynomial loads on its faces, in an infinite plate: the field behind the closed forms of straight cracks.
//!
//! Faces |x| < b, y = 0 carry the load A + B x: stress σ_yy (opening) or σ_xy (shear) of −(A + B x) on both faces, nothing
//! far away. Added to an uncracked field with stress A + B x on y = 0, it frees the faces. With z = x + iy,
//! r = √(z − b), q = √(z + b) (principal roots: the cut of S = r q is the crack itself):
//!
//! ```text
//!   Z  = B r q + α r/q + β q/r − A − B z       α = (A − B b/2)/2, β = (A + B b/2)/2
//!   Z' = B z/S + α b/(r q³) − β b/(q r³) − B
//!   Ẑ  = (A + B z/2) S − A z − B z²/2          Ẑ' = Z
//!
//!   opening  σ_xx = Re Z − y Im Z'     σ_yy = Re Z + y Im Z'     σ_xy = −y Re Z'
//!            2G u = (κ−1)/2 Re Ẑ − y Im Z                        2G v = (κ+1)/2 Im Ẑ − y Re Z
//!   shear    σ_xx = 2 Im Z + y Re Z'   σ_yy = −y Re Z'           σ_xy = Re Z − y Im Z'
//!            2G u = (κ+1)/2 Im Ẑ + y Re Z                        2G v = −(κ−1)/2 Re Ẑ − y Im Z
//!
//!   jump = (4/E') (A + B x/2) √(b² − x²)       K(±b) = √(πb) (A ± B b/2)
//! ```
//!
//! Source: H. M. Westergaard (1939); N. I. Muskhelishvili (1953), with φ' = Z/2, ψ' = −z Z'/2 (opening) and φ' = −iZ/2,
//! ψ' = iZ + i z Z'/2 (shear). Z is written by the strengths α, β of its two singularities, so that a zone that
//! closes smoothly (α or β zero) has no singularity left to cancel.

use std::f64::consts::PI;

use nalgebra::Complex;

use crate::intensity::williams::{kolosov, plane_modulus};
use crate::material::Lame;

/// Which way the faces are loaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Normal load, mode I.
    Opening,
    /// Tangential load, mode II.
    Shear,
}

/// A loaded zone of the line y = 0.
#[derive(Debug, Clone, Copy)]
pub struct FaceLoad {
    /// Direction of the load.
    pub mode: Mode,
    /// Place of the zone's midpoint on the crack [m]; x below is measured from it.
    pub centre: f64,
    /// b [m].
    pub half_length: f64,
    /// B [Pa/m].
    slope: f64,
    /// Strength α of the singularity at x = −b [Pa].
    near: f64,
    /// Strength β of the singularity at x = b [Pa].
    far: f64,
}

impl FaceLoad {
    /// Load A + B x on a zone.
    pub fn new(mode: Mode, centre: f64, half_length: f64, a: f64, slope: f64) -> Self {
        let turn = 0.5 * slope * half_length;
        FaceLoad {
            mode,
            centre,
            half_length,
            slope,
            near: 0.5 * (a - turn),
            far: 0.5 * (a + turn),
        }
    }

    /// A [Pa].
    pub fn mean(&self) -> f64 {
        self.near + self.far
    }

    /// (Z, Z', Ẑ) at a point; the sign of a zero y tells the face. Not finite at a singular end.
    fn potentials(&self, x: f64, y: f64) -> [Complex<f64>; 3] {
        let (b, slope, mean) = (self.half_length, self.slope, self.mean());
        let x = x - self.centre;
        let z = Complex::new(x, y);
        let (r, q) = (Complex::new(x - b, y).sqrt(), Complex::new(x + b, y).sqrt());
        let s = r * q;
        let mut value = s * slope - mean - z * slope;
        let mut rate = Complex::new(-slope, 0.0);
        if slope != 0.0 {
            rate += z / s * slope;
        }
        if self.near != 0.0 {
            value += r / q * self.near;
            rate += (r * q * q * q).inv() * (self.near * b);
        }
        if self.far != 0.0 {
            value += q / r * self.far;
            rate -= (q * r * r * r).inv() * (self.far * b);
        }
        let integral = (z * (0.5 * slope) + mean) * s - z * (z * (0.5 * slope) + mean);
        [value, rate, integral]
    }

    /// Displacement (u, v) at a point [m]; the zone's midpoint does not move on average.
    pub fn displacement(&self, elastic: Lame, x: f64, y: f64) -> [f64; 2] {
        let [value, _, integral] = self.potentials(x, y);
        // y Z vanishes on the line, also at an end where Z itself is infinite.
        let lever = if y == 0.0 {
            Complex::new(0.0, 0.0)
        } else {
            value * y
        };
        let kappa = kolosov(elastic);
        let (less, more) = (0.5 * (kappa - 1.0), 0.5 * (kappa + 1.0));
        let [u, v] = match self.mode {
            Mode::Opening => [less * integral.re - lever.im, more * integral.im - lever.re],
            Mode::Shear => [
                more * integral.im + lever.re,
                -less * integral.re - lever.im,
            ],
        };
        [0.5 * u / elastic.mu, 0.5 * v / elastic.mu]
    }

    /// Stress (xx, yy, xy) at a point [Pa]; not finite at a singular end itself.
    pub fn stress(&self, x: f64, y: f64) -> [f64; 3] {
        let [value, rate, _] = self.potentials(x, y);
        let lever = if y == 0.0 {
            Complex::new(0.0, 0.0)
        } else {
            rate * y
        };
        match self.mode {
            Mode::Opening => [value.re - lever.im, value.re + lever.im, -lever.re],
            Mode::Shear => [2.0 * value.im + lever.re, -lever.re, value.re - lever.im],
        }
    }

    /// Jump u(y = +0) − u(y = −0) in the direction of the load [m].
    pub fn jump(&self, elastic: Lame, x: f64) -> f64 {
        let (b, x) = (self.half_length, x - self.centre);
        if x.abs() >= b {
            return 0.0;
        }
        4.0 / plane_modulus(elastic)
            * (self.mean() + 0.5 * self.slope * x)
            * ((b - x) * (b + x)).sqrt()
    }

    /// ∫ (c + d x) jump dx over the zone, with x from the zone's midpoint: (2π/E') b² (c A + d B b²/8).
    pub fn moment(&self, elastic: Lame, c: f64, d: f64) -> f64 {
        let b2 = self.half_length.powi(2);
        2.0 * PI / plane_modulus(elastic) * b2 * (c * self.mean() + 0.125 * d * self.slope * b2)
    }

    /// lim √(2πρ) σ_yy or σ_xy ahead of the end at +b (`end` > 0) or −b [Pa √m].
    pub fn intensity(&self, end: f64) -> f64 {
        let strength = if end > 0.0 { self.far } else { self.near };
        2.0 * strength * (PI * self.half_length).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Material, Model};

    const LOADS: [(f64, f64); 3] = [(1.0, 0.0), (0.0, 0.7), (0.6, -1.1)];

    fn loads() -> impl Iterator<Item = FaceLoad> {
        [Mode::Opening, Mode::Shear].into_iter().flat_map(|mode| {
            let smooth = FaceLoad::new(mode, 0.2, 0.5, -0.5 * 0.9 * 0.5, 0.9);
            let any = LOADS.map(|(a, slope)| FaceLoad::new(mode, 0.2, 0.5, a, slope));
            any.into_iter().chain([smooth])
        })
    }

    #[test]
    fn far_away_nothing_is_left() {
        for load in loads() {
            for (x, y) in [(200.0, 0.0), (-90.0, 140.0), (0.0, -300.0)] {
                assert!(load.stress(x, y).iter().all(|s| s.abs() < 1e-5));
            }
        }
    }

    #[test]
    fn the_moment_is_the_integral_of_the_jump() {
        let c = Lame::new(Material::new(2.0, 0.3), Model::PlaneStrain);
        for load in loads() {
            // x = b sin t: the integrand is smooth and periodic, the midpoint rule exact.
            let n = 64;
            let sum: f64 = (0..n)
                .map(|k| {
                    let t = PI * ((k as f64 + 0.5) / n as f64 - 0.5);
                    let x = 0.5 * t.sin();
                    (0.3 - 0.8 * x) * load.jump(c, 0.2 + x) * 0.5 * t.cos() * PI / n as f64
                })
                .sum();
            assert!((sum - load.moment(c, 0.3, -0.8)).abs() < 1e-14);
        }
    }
}
