//! Time and memory that a run by `hybrid` will take, told from a body and the analysis of its stiffness.
//!
//! ```text
//!   t = set-up + 8 L/0.8 GB/s + F/150 G/s + C/90 G/s + t₀ + t₁ n + N (8 L/6 GB/s + m³/a + m²/29 M/s + t₂ n + t₃ tips)
//!   M = M₀ + 1.23 · 8 L + 0.59 · 16 m² + 65 nnz K + M₁ n
//! ```
//!
//! L: numbers of the factor of K, F, C: multiplications and additions to factor and to condense, m: rows of W, N: increments, n:
//! cells, a: 400 G/s in 2D, where slipping points leave half of their rows out, 135 G/s in 3D. Set-up is as measured; the rest was fitted
//! to 27 bodies on two cores with AVX-512.

use stickslip_xfem::discretisation::tips::fronts;

use crate::model::body::Body;

/// t₀ and M₀: the program, its tables and pages [s, B].
const T0: f64 = 0.042;
const M0: f64 = 2.3e7;
/// t₁, t₂, t₃ [s] and M₁ [B], in 2D and 3D: fields and pictures, quantities of a cell and of a tip.
const T1: [f64; 2] = [6e-7, 3.9e-5];
const T2: [f64; 2] = [3.4e-6, 2.4e-5];
const T3: [f64; 2] = [1.5e-3, 0.0];
const M1: [f64; 2] = [0.0, 1100.0];

/// What a run takes.
#[derive(Debug, Clone, Copy)]
pub struct Cost {
    /// Wall-clock time [s].
    pub seconds: f64,
    /// Largest memory [GB].
    pub gb: f64,
}

/// Of a run with so many increments over all friction coefficients; none where W alone is known.
pub fn predicted(body: &Body, increments: usize) -> Option<Cost> {
    let (own, k) = (body.elastic.cost()?, body.elastic.stiffness()?);
    let solid = usize::from(body.mesh.dim() == 3);
    let (cells, m) = (body.mesh.cell_count() as f64, own.rows as f64);
    let factor = 8.0 * own.entries as f64;
    let set_up = body.setup.setup_s + body.setup.assembly_s + own.analysis_s;
    let to_w = factor / 8e8 + own.factorisation / 1.5e11 + own.condensation / 9e10;
    let contact = factor / 6e9 + m.powi(3) / [4e11, 1.35e11][solid] + m.powi(2) / 2.9e7;
    let increment = contact + T2[solid] * cells + T3[solid] * fronts(body).len() as f64;
    let entries = k.values().len() as f64;
    Some(Cost {
        seconds: set_up + to_w + T0 + T1[solid] * cells + increments as f64 * increment,
        gb: 1e-9 * (M0 + 1.23 * factor + 9.4 * m.powi(2) + 65.0 * entries + M1[solid] * cells),
    })
}
