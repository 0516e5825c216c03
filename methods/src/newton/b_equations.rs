//! The B-differentiable contact equations of one point and the pieces of their derivative.
//! ```text
//! H_n = min(r_n g, P_n)        H_t = P_t − proj_{μ max(P_n, 0)}(P_t − r_t d)
//! ```
//! Christensen, Klarbring, Pang & Strömberg 1998; Eqs. 5 to 7 of the founding paper, with max for its min in Eq. 7.

#![allow(non_snake_case)]

use crate::contract::law::{ball_derivative, project_ball, tangential_norm};
use crate::newton::iteration::trial;

/// Pieces of H' in use at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Piece {
    pub closed: bool,
    /// δs = μ δP_n instead of 0.
    pub bound_moves: bool,
    pub slip: bool,
}

/// H at one point; `P`, `v`, `r` are its rows.
pub(crate) fn equations(mu: f64, r: &[f64], P: &[f64], v: &[f64]) -> [f64; 3] {
    let mut H = [0.0; 3];
    H[0] = (r[0] * v[0]).min(P[0]);
    for k in 1..P.len() {
        H[k] = P[k] - r[k] * v[k];
    }
    project_ball(mu * P[0].max(0.0), &mut H[1..P.len()]);
    for k in 1..P.len() {
        H[k] = P[k] - H[k];
    }
    H
}

/// Row k of the linearised equations at one point: Σ a_l δP_l + Σ c_l δv_l = −h.
pub(crate) struct Row {
    pub a: [f64; 3],
    pub c: [f64; 3],
    pub h: f64,
}

impl Row {
    /// A row with a right-hand side and no coefficients yet.
    pub fn reading(h: f64) -> Self {
        Self {
            a: [0.0; 3],
            c: [0.0; 3],
            h,
        }
    }
}

pub(crate) fn linearise(mu: f64, r: &[f64], P: &[f64], v: &[f64], piece: Piece) -> [Row; 3] {
    let H = equations(mu, r, P, v);
    let mut rows = H.map(Row::reading);
    if piece.closed {
        rows[0].c[0] = r[0];
    } else {
        rows[0].a[0] = 1.0;
    }
    let z = trial(r, P, v);
    let z = &z[..P.len()];
    if !piece.slip {
        for k in 1..P.len() {
            rows[k].c[k] = r[k];
        }
    } else {
        let t = tangential_norm(z);
        let (e, S) = if t > 0.0 {
            ball_derivative(mu * P[0].max(0.0), &z[1..])
        } else {
            Default::default()
        };
        for k in 1..P.len() {
            rows[k].a[k] = 1.0;
            if piece.bound_moves {
                rows[k].a[0] = -mu * e[k - 1];
            }
            for l in 1..P.len() {
                rows[k].a[l] -= S[k - 1][l - 1];
                rows[k].c[l] += S[k - 1][l - 1] * r[l];
            }
        }
    }
    rows
}
