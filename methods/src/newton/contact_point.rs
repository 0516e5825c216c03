//! One contact point as the equations of Newton's methods see it.

#![allow(non_snake_case)]

use crate::condensed::point_row::PointRow;
use crate::condensed::problem::ContactProblem;
use crate::contract::law::{Branch, return_map};

/// Forces and jump of a point; all slices are its rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactPoint<'a> {
    pub mu: f64,
    /// Scales that turn jumps into forces.
    pub r: &'a [f64],
    pub P: &'a [f64],
    /// (g, d).
    pub v: &'a [f64],
}

impl<'a> ContactPoint<'a> {
    /// Point `i`, cut out of `r`, P and v of all rows.
    #[inline(always)]
    pub fn of(
        problem: &ContactProblem<'_>,
        i: usize,
        r: &'a [f64],
        (P, v): (&'a [f64], &'a [f64]),
    ) -> Self {
        let own = problem.rows.of(i);
        Self {
            mu: problem.friction(i),
            r: &r[own.clone()],
            P: &P[own.clone()],
            v: &v[own],
        }
    }

    /// Number of rows.
    #[inline(always)]
    pub fn size(&self) -> usize {
        self.P.len()
    }

    /// z = P − r v, the trial force of the augmented Lagrangian.
    #[inline(always)]
    pub fn trial(&self) -> [f64; 3] {
        let mut z = [0.0; 3];
        for k in 0..self.size() {
            z[k] = self.P[k] - self.r[k] * self.v[k];
        }
        z
    }

    /// The branch of Π(P − r v), Π the return mapping.
    pub fn branch(&self) -> Branch {
        return_map(self.mu, &mut self.trial()[..self.size()])
    }

    /// Rows δP = −H of an open point.
    pub fn open(&self, rows: &mut [PointRow; 3]) {
        (0..self.size()).for_each(|k| rows[k].a[k] = 1.0);
    }

    /// Rows r δv = −H of a sticking point.
    pub fn stick(&self, rows: &mut [PointRow; 3]) {
        (0..self.size()).for_each(|k| rows[k].c[k] = self.r[k]);
    }

    /// Rows of a slipping point: r_n δg = −H_n,  δP_t − μ e (δP_n − r_n δg) − M (δP_t − r_t δd) = −H_t.
    #[inline(always)]
    pub fn slip(&self, e: [f64; 2], M: [[f64; 2]; 2], rows: &mut [PointRow; 3]) {
        let Self { mu, r, .. } = *self;
        rows[0].c[0] = r[0];
        for k in 1..self.size() {
            rows[k].a[0] = -mu * e[k - 1];
            rows[k].c[0] = mu * e[k - 1] * r[0];
            rows[k].a[k] = 1.0;
            for l in 1..self.size() {
                rows[k].a[l] -= M[k - 1][l - 1];
                rows[k].c[l] += M[k - 1][l - 1] * r[l];
            }
        }
    }
}
