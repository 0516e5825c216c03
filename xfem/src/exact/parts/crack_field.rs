//! Field of a straight crack in an infinite plate: an uncracked field, and zones of the crack with loaded faces.
//!
//! ```text
//!   uncracked   σ_tt = S, σ_nn = N + k s, σ_tn = T        (uniform stress and pure bending along the crack)
//!   u_t = (S − ν'N) s/E' − ν'k s²/(2E') − k m²/(2E') + T m/G
//!   u_n = (N − ν'S) m/E' + k s m/E'
//! ```
//!
//! s, m are the coordinates along and across the crack ([`LineCrack`]). Rigid motion: the crack line keeps its direction,
//! and its midpoint does not move in the uncracked field.

use crate::geometry::Point;

use super::face_load::{FaceLoad, Mode};
use super::line_crack::LineCrack;
use crate::exact::solution::Field;
use crate::intensity::williams::{plane_modulus, plane_ratio};
use crate::material::Lame;

/// The uncracked field.
#[derive(Debug, Clone, Copy, Default)]
pub struct Background {
    /// S, N, T [Pa], tension positive.
    pub uniform: [f64; 3],
    /// k [Pa/m].
    pub bending: f64,
}

/// The sum of both, in the frame of the crack.
#[derive(Debug, Clone)]
pub struct CrackField {
    /// Where the crack is.
    pub crack: LineCrack,
    /// Elastic constants.
    pub elastic: Lame,
    /// Uncracked field.
    pub background: Background,
    /// Loaded zones, each with its factor.
    pub zones: Vec<(f64, FaceLoad)>,
    /// Work of friction since time 0 [J/m].
    pub dissipation: f64,
}

impl CrackField {
    /// (tt, nn, tn) at (s, m) [Pa].
    fn local_stress(&self, s: f64, m: f64) -> [f64; 3] {
        let [tt, nn, tn] = self.background.uniform;
        let mut sum = [tt, nn + self.background.bending * s, tn];
        for (factor, zone) in &self.zones {
            for (total, value) in sum.iter_mut().zip(zone.stress(s, m)) {
                *total += factor * value;
            }
        }
        sum
    }
}

impl Field for CrackField {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let (s, m) = self.crack.place(x, side);
        let (modulus, ratio) = (plane_modulus(self.elastic), plane_ratio(self.elastic));
        let k = self.background.bending / modulus;
        let [tt, nn, tn] = self.background.uniform;
        let [e_t, e_n] = [tt - ratio * nn, nn - ratio * tt].map(|s| s / modulus);
        let mut u = [
            e_t * s + tn / self.elastic.mu * m - 0.5 * k * (ratio * s * s + m * m),
            e_n * m + k * s * m,
        ];
        for (factor, zone) in &self.zones {
            for (total, value) in u.iter_mut().zip(zone.displacement(self.elastic, s, m)) {
                *total += factor * value;
            }
        }
        self.crack.vector(u)
    }

    fn stress(&self, x: &Point, side: f64) -> [Point; 3] {
        let (s, m) = self.crack.place(x, side);
        self.crack.tensor(self.local_stress(s, m))
    }

    fn traction(&self, x: &Point) -> [f64; 3] {
        let [_, nn, tn] = self.local_stress(self.crack.abscissa(x), 0.0);
        [-nn, -tn, 0.0]
    }

    fn jump(&self, x: &Point) -> [f64; 3] {
        let s = self.crack.abscissa(x);
        let mut jump = [0.0; 3];
        for (factor, zone) in &self.zones {
            let component = if zone.mode == Mode::Opening { 0 } else { 1 };
            jump[component] += factor * zone.jump(self.elastic, s);
        }
        jump
    }

    /// K_II belongs to (ahead, n): at the first point of the crack, where ahead is −t, a slip u₁ − u₂ along +t is negative.
    fn intensity(&self, front: &Point) -> Option<[f64; 3]> {
        let end = self.crack.end(front)?;
        let tip = end * self.crack.half_length;
        let mut k = [0.0; 3];
        for (factor, zone) in &self.zones {
            let reach = zone.centre + end * zone.half_length;
            if (reach - tip).abs() <= 1e-12 * self.crack.half_length {
                let value = factor * zone.intensity(end);
                match zone.mode {
                    Mode::Opening => k[0] += value,
                    // The case's normal is sense · n.
                    Mode::Shear => k[1] += value * end * self.crack.sense,
                }
            }
        }
        Some(k)
    }

    /// After a reversal slip has several zones, and the last one ends before all slip does.
    fn stick_boundary(&self) -> Option<Point> {
        let [(_, zone)] = self.zones[..] else {
            return None;
        };
        let end = zone.centre + zone.half_length;
        let inside = end < self.crack.half_length * (1.0 - 1e-12);
        (zone.mode == Mode::Shear && inside).then(|| self.crack.point(end, 0.0))
    }

    fn dissipation(&self) -> Option<f64> {
        Some(self.dissipation)
    }
}
