//! Rigid motions of a body without enough supports: pins that make K regular, and the jumps the motions cause.
//!
//! Forces that the pins would take are balanced before a solve, and the rigid motion of its result is taken out:
//! ```text
//! G = P Kₚ⁻¹ Pᵀ,   P = I − Σ r (D s)ᵀ,   s = D r on the contact unknowns, 0 elsewhere,   D = diag(K)^½,   sᵢ·sⱼ = δᵢⱼ
//! ```
//! Kₚ is K with pins. G is a generalised inverse (K G K = K) that the choice of pins does not change. With Kₚ⁻¹ alone a
//! slender piece sways about its pins by 10⁵ times what it deforms, and as many digits are lost.

use crate::algebra::dense::{dot, norm};
use crate::algebra::matrix::{JumpOperator, SquareMatrix};
use crate::error::MethodError;

/// A mode whose pivot falls below this fraction of its size depends on the others.
const DEPENDENT: f64 = 1e-8;
/// |K r| allowed, relative to |diag(K) r|: rounding of assembly, not deformation.
const RIGID: f64 = 1e-9;

/// Checks that the modes are in the kernel of K and chooses one unknown per mode to pin (Gaussian elimination with
/// complete pivoting of D R, modes scaled to unit size): unknowns of much stiffness, since what is left of K is the softer
/// the smaller its part in the motion.
pub(crate) fn pins(k: &SquareMatrix, modes: &[Vec<f64>]) -> Result<Vec<usize>, MethodError> {
    let n = k.size();
    let mut kr = vec![0.0; n];
    for (mode, r) in modes.iter().enumerate() {
        k.mul(r, &mut kr);
        let diag: Vec<f64> = (0..n).map(|j| k.diagonal(j) * r[j]).collect();
        let relative = norm(&kr) / norm(&diag);
        // A zero mode gives NaN.
        if relative.is_nan() || relative > RIGID {
            let part = |j: &usize| kr[*j].abs() / k.diagonal(*j).sqrt();
            let largest = (0..n).max_by(|i, j| part(i).total_cmp(&part(j)));
            return Err(MethodError::NotRigid {
                mode,
                unknown: largest.unwrap_or_default(),
                relative,
            });
        }
    }
    let largest = |r: &[f64]| r.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let scaled = |r: &[f64]| -> Vec<f64> {
        let own = r.iter().enumerate();
        own.map(|(j, v)| k.diagonal(j).sqrt() * v).collect()
    };
    // The first of the largest entries, with its size.
    let pivot_of = |r: &[f64]| {
        let own = r.iter().enumerate();
        own.fold((0, -1.0), |best: (usize, f64), (j, v)| {
            if v.abs() > best.1 { (j, v.abs()) } else { best }
        })
    };
    let mut work: Vec<(usize, Vec<f64>, (usize, f64))> = modes
        .iter()
        .enumerate()
        .map(|(mode, r)| {
            let r = scaled(r);
            let size = largest(&r);
            let r: Vec<f64> = r.iter().map(|v| v / size).collect();
            let pivot = pivot_of(&r);
            (mode, r, pivot)
        })
        .collect();
    let mut pins = Vec::with_capacity(modes.len());
    while !work.is_empty() {
        let mut best = 0;
        for (w, (.., (_, size))) in work.iter().enumerate() {
            if *size > work[best].2.1 {
                best = w;
            }
        }
        let (mode, r, (pivot, size)) = work.swap_remove(best);
        if size < DEPENDENT {
            return Err(MethodError::DependentModes { mode });
        }
        // Motions of other pieces stay as they are.
        for (_, other, largest) in work.iter_mut().filter(|w| w.1[pivot] != 0.0) {
            let factor = other[pivot] / r[pivot];
            for j in 0..n {
                other[j] -= factor * r[j];
            }
            other[pivot] = 0.0;
            *largest = pivot_of(other);
        }
        pins.push(pivot);
    }
    Ok(pins)
}

/// A rigid motion of the balanced solution: D⁻¹ Pᵀ b = D⁻¹ b − Σ (r·b) s.
#[derive(Debug, Clone)]
pub(crate) struct Motion {
    /// r by unknown.
    pub r: Vec<f64>,
    /// s by contact unknown, where it is not zero.
    pub s: Vec<(usize, f64)>,
}

/// P of the generalised inverse.
#[derive(Debug, Clone)]
pub(crate) struct Balance {
    /// D by unknown.
    root: Vec<f64>,
    pub motions: Vec<Motion>,
}

impl Balance {
    /// From modes that span the kernel of K. A motion that moves no contact unknown is left to the pins: no force balances it.
    pub fn new(k: &SquareMatrix, modes: &[Vec<f64>], in_contact: &[bool]) -> Self {
        let mut balance = Self {
            root: Vec::new(),
            motions: Vec::new(),
        };
        if modes.is_empty() {
            return balance;
        }
        balance.root = (0..k.size()).map(|j| k.diagonal(j).sqrt()).collect();
        for mode in modes {
            let mut r = mode.clone();
            let size = |r: &[f64]| norm(&balance.weighted(r, in_contact));
            let before = size(&r);
            // Twice for orthogonality.
            for _ in 0..2 {
                balance.take_out(&mut r);
            }
            let length = size(&r);
            if length <= DEPENDENT * before || length == 0.0 {
                continue;
            }
            r.iter_mut().for_each(|v| *v /= length);
            let weighted = balance.weighted(&r, in_contact);
            let s = weighted.into_iter().enumerate().filter(|s| s.1 != 0.0);
            let s = s.collect();
            balance.motions.push(Motion { r, s });
        }
        balance
    }

    /// D r on the contact unknowns, 0 elsewhere.
    fn weighted(&self, r: &[f64], in_contact: &[bool]) -> Vec<f64> {
        let own = r.iter().zip(&self.root).zip(in_contact);
        own.map(|((r, d), &c)| if c { d * r } else { 0.0 })
            .collect()
    }

    /// f := Pᵀ f.
    pub fn balance(&self, f: &mut [f64]) {
        for Motion { r, s } in &self.motions {
            let resultant = dot(r, f);
            (s.iter()).for_each(|&(j, s)| f[j] -= resultant * self.root[j] * s);
        }
    }

    /// x := P x.
    pub fn take_out(&self, x: &mut [f64]) {
        for Motion { r, s } in &self.motions {
            let amount: f64 = s.iter().map(|&(j, s)| self.root[j] * s * x[j]).sum();
            if amount != 0.0 {
                x.iter_mut().zip(r).for_each(|(x, r)| *x -= amount * r);
            }
        }
    }
}

/// Orthonormal basis of the jumps the rigid motions cause on the listed rows, with the map between the two.
///
/// N = B R = Q T with Q orthonormal and T upper triangular (modified Gram-Schmidt, twice).
#[derive(Debug, Clone)]
pub(crate) struct ModeJumps {
    /// Q by column.
    pub q: Vec<Vec<f64>>,
    /// T by column: `t[j][i]`, i <= j.
    t: Vec<Vec<f64>>,
    /// Number of rigid motions without jump on these rows.
    pub free: usize,
}

impl ModeJumps {
    pub fn new(jump: &JumpOperator, rows: &[usize], modes: &[Vec<f64>]) -> Self {
        let mut result = Self {
            q: Vec::new(),
            t: Vec::new(),
            free: 0,
        };
        let mut all = vec![0.0; jump.rows()];
        for r in modes {
            jump.mul(r, &mut all);
            let mut column: Vec<f64> = rows.iter().map(|&i| all[i]).collect();
            // Size of the jump if nothing cancelled, to tell a motion without jump from rounding.
            let size = rows
                .iter()
                .map(|&i| jump.row(i).map(|(j, b)| (b * r[j]).powi(2)).sum::<f64>())
                .sum::<f64>();
            let mut t = vec![0.0; result.q.len() + 1];
            for _ in 0..2 {
                for (i, q) in result.q.iter().enumerate() {
                    let c = dot(q, &column);
                    t[i] += c;
                    for (x, q) in column.iter_mut().zip(q) {
                        *x -= c * q;
                    }
                }
            }
            let length = norm(&column);
            if length <= DEPENDENT * size.sqrt() || length == 0.0 {
                result.free += 1;
                continue;
            }
            *t.last_mut().unwrap_or(&mut 0.0) = length;
            column.iter_mut().for_each(|x| *x /= length);
            result.q.push(column);
            result.t.push(t);
        }
        result
    }

    /// No rigid motions.
    pub fn empty() -> Self {
        Self {
            q: Vec::new(),
            t: Vec::new(),
            free: 0,
        }
    }

    /// Number of columns of Q.
    pub fn len(&self) -> usize {
        self.q.len()
    }

    /// α with N α = Q β, for `free == 0`: solves T α = β.
    pub fn amplitudes(&self, beta: &[f64]) -> Vec<f64> {
        let mut alpha = beta.to_vec();
        for j in (0..self.len()).rev() {
            alpha[j] /= self.t[j][j];
            for i in 0..j {
                alpha[i] -= self.t[j][i] * alpha[j];
            }
        }
        alpha
    }

    /// c with Qᵀ P = c equivalent to Nᵀ P = b, for `free == 0`: solves Tᵀ c = b.
    pub fn balance(&self, b: &[f64]) -> Vec<f64> {
        let mut c = b.to_vec();
        for j in 0..self.len() {
            for i in 0..j {
                c[j] -= self.t[j][i] * c[i];
            }
            c[j] /= self.t[j][j];
        }
        c
    }

    /// Qᵀ x.
    pub fn components(&self, x: &[f64]) -> Vec<f64> {
        self.q.iter().map(|q| dot(q, x)).collect()
    }

    /// x += Q c.
    pub fn add(&self, c: &[f64], x: &mut [f64]) {
        for (q, c) in self.q.iter().zip(c) {
            for (x, q) in x.iter_mut().zip(q) {
                *x += c * q;
            }
        }
    }

    /// x <- (I − Q Qᵀ) x.
    pub fn project_out(&self, x: &mut [f64]) {
        let c: Vec<f64> = self.components(x).iter().map(|c| -c).collect();
        self.add(&c, x);
    }
}
