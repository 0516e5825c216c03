//! Nitsche's method seen from the contact points.
//!
//! With Γ = γ w and τ = S u + t the contact forces that the stress implies (t from prescribed displacements), the method is
//! ```text
//! K u = f + Bᵀ P + θ Sᵀ y,    y = Γ⁻¹ (τ − P),    P = Π(τ − Γ v)
//! ```
//! K is constant, so u can be eliminated. With X = B K⁻¹ Sᵀ, T = S K⁻¹ Sᵀ and s = S K⁻¹ f + t
//! ```text
//! v = q + W P + θ X y + Q β,    τ = s + Xᵀ P + θ T y    ⇒    (Γ − θ T) y = s − (I − Xᵀ) P
//! ```
//! Rigid motions have no stress, S R = 0, so Sᵀ y balances itself and Qᵀ P = c stays. As τ − Γ v = P − Γ (v − y), the law
//! is the exact contact law for v̂ = v − y instead of v:
//! ```text
//! v̂ = q + c₀ + (W + C) P + Q β,    C = (I − θ X)(Γ − θ T)⁻¹ (I − Xᵀ),    c₀ = −(I − θ X)(Γ − θ T)⁻¹ s
//! ```
//! So Nitsche's method is the multiplier method with a compliance C in series, between all points, that vanishes like 1/γ
//! and yields to the part of P that the stress does not follow: stabilised multipliers (Stenberg, J. Comput. Appl. Math. 63
//! (1995) 139). For K u = Bᵀ P + θ Sᵀ y one finds P·(W + C) P = |u|²_K − (1 + θ) y·τ + |y|²_Γ, positive for every P ≠ 0 if
//! ```text
//! γ > ¼ (1 + θ)² λ,    λ = largest eigenvalue of w^−½ T w^−½
//! ```
//! which is the bound of Chouly, Hild & Renard, with the discrete trace constant λ computed instead of estimated.

use std::sync::Arc;

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{Llt, Solve};
use faer::{Accum, Mat, MatMut, Par, Side};

use crate::algebra::delassus::{Dense, Series};
use crate::algebra::dense::{mul_add, mul_transpose_add};
use crate::algebra::factor::kernel;
use crate::algebra::floating::ModeJumps;
use crate::algebra::rows::RowSet;
use crate::algebra::spectrum::extremes;
use crate::condensed::problem::ContactProblem;
use crate::contract::judge::implied_forces;
use crate::contract::operator::ContactOperator;
use crate::contract::state::{Claim, Status};
use crate::contract::system::ContactSystem;
use crate::error::MethodError;
use crate::newton::springs::{Coupled, Springs};
use crate::own_laws::confirm::{Judged, judge};

/// Nitsche's terms for one system, θ and γ.
pub(crate) struct Stabilisation {
    operator: Arc<ContactOperator>,
    theta: f64,
    /// γ in N/m³.
    gamma: f64,
    /// Γ by row.
    stiffness: Vec<f64>,
    t: Mat<f64>,
    x: Mat<f64>,
    /// Cholesky factor of Γ − θ T.
    factor: Llt<f64>,
    /// W + C.
    series: Series,
}

impl Stabilisation {
    /// γ = `multiple` · λ.
    pub fn new(
        system: &ContactSystem,
        operator: Arc<ContactOperator>,
        theta: f64,
        multiple: f64,
    ) -> Result<Self, MethodError> {
        let elastic = system.elastic();
        let all = elastic.tractions()?;
        let rows = system.row_set();
        let at = rows.positions_in(&elastic.rows());
        let m = rows.len();
        let t = Mat::from_fn(m, m, |i, j| all.t[(at[i], at[j])]);
        let x = Mat::from_fn(m, m, |i, j| all.x[(at[i], at[j])]);

        let weight = weights(system, rows);
        let scaled = Mat::from_fn(m, m, |i, j| t[(i, j)] / (weight[i] * weight[j]).sqrt());
        let (_, lambda) =
            extremes(&Dense::new(&scaled, true), &ModeJumps::empty()).ok_or_else(|| {
                kernel(
                    "condensation of Nitsche's method",
                    "no displacement causes stress at the contact points".into(),
                )
            })?;
        let gamma = multiple * lambda;
        let stiffness: Vec<f64> = weight.iter().map(|w| gamma * w).collect();

        let unit = |i, j| f64::from(u8::from(i == j));
        let a = Mat::from_fn(m, m, |i, j| unit(i, j) * stiffness[i] - theta * t[(i, j)]);
        let factor = Llt::new(a.as_ref(), Side::Lower)
            .map_err(|e| kernel("factorisation of Γ − θ T", format!("{e:?}")))?;
        // C = (I − θ X) Y, Y = (Γ − θ T)⁻¹ (I − Xᵀ)
        let mut y = Mat::from_fn(m, m, |i, j| unit(i, j) - x[(j, i)]);
        factor.solve_in_place(y.as_mut());
        let mut compliance = y.clone();
        matmul(
            compliance.as_mut(),
            Accum::Add,
            x.as_ref(),
            y.as_ref(),
            -theta,
            Par::Seq,
        );
        Ok(Self {
            series: Series::new(operator.w.clone(), compliance),
            operator,
            theta,
            gamma,
            stiffness,
            t,
            x,
            factor,
        })
    }

    /// Whether the terms were made for this operator.
    pub fn belongs_to(&self, operator: &Arc<ContactOperator>) -> bool {
        Arc::ptr_eq(&self.operator, operator)
    }

    /// Which laws hold at the end.
    pub fn claim(&self) -> Claim {
        Claim::Nitsche {
            theta: self.theta,
            gamma: self.gamma,
        }
    }

    /// Largest Γ: turns the jump error of the Newton iteration into a force.
    pub fn stiffest(&self) -> f64 {
        self.stiffness.iter().copied().fold(0.0, f64::max)
    }

    /// s = S K⁻¹ f + t by row.
    pub fn free_stress(&self, problem: &ContactProblem<'_>) -> Result<Vec<f64>, MethodError> {
        stress(problem, &problem.free)
    }

    /// The contact laws with C and c₀ in series.
    pub fn springs(&self, problem: &ContactProblem<'_>, s: &[f64]) -> Springs<'_> {
        let y = self.solve(s.to_vec());
        let mut stretch: Vec<f64> = y.iter().map(|y| -y).collect();
        mul_add(&self.x, &scaled(self.theta, &y), &mut stretch);
        let coupled = Coupled {
            series: &self.series,
            stretch,
        };
        let rigid = (f64::INFINITY, f64::INFINITY);
        Springs::new(problem, rigid, vec![0.0; s.len()], Some(coupled))
    }

    /// y for given contact forces.
    fn mismatch(&self, s: &[f64], p: &[f64]) -> Vec<f64> {
        let mut rhs: Vec<f64> = s.iter().zip(p).map(|(s, p)| s - p).collect();
        mul_transpose_add(&self.x, p, &mut rhs);
        self.solve(rhs)
    }

    /// v = q + W P + θ X y + Q β.
    pub fn jump(
        &self,
        problem: &ContactProblem<'_>,
        s: &[f64],
        p: &[f64],
        beta: &[f64],
    ) -> Vec<f64> {
        let mut v = problem.jump(p, beta);
        let y = self.mismatch(s, p);
        mul_add(&self.x, &scaled(self.theta, &y), &mut v);
        v
    }

    /// θ Sᵀ y, the consistency term of equilibrium.
    pub fn consistency(
        &self,
        problem: &ContactProblem<'_>,
        s: &[f64],
        p: &[f64],
    ) -> Result<Vec<f64>, MethodError> {
        let traction = problem.increment.system.elastic().traction();
        let traction = traction.ok_or(MethodError::NoTraction)?;
        let y = scaled(self.theta, &self.mismatch(s, p));
        let mut force = vec![0.0; traction.cols()];
        traction.mul_transpose_add(&problem.all_forces(&y), &mut force);
        Ok(force)
    }

    /// Recovers the displacements and has them judged. If they do not keep the claim, q and s take up the difference
    /// between what they imply and the condensed values, and the method goes on from where it is (`None`).
    pub fn confirm(
        &self,
        problem: &mut ContactProblem<'_>,
        s: &mut [f64],
        p: &[f64],
        beta: &[f64],
        corrections: usize,
    ) -> Result<Option<Status>, MethodError> {
        problem.further = self.consistency(problem, s, p)?;
        let u = match judge(problem, p, beta, corrections)? {
            Judged::End(status) => return Ok(Some(status)),
            Judged::Wrong(u) => u,
        };
        let (v, mut tau) = (self.jump(problem, s, p, beta), s.to_vec());
        mul_transpose_add(&self.x, p, &mut tau);
        mul_add(&self.t, &scaled(self.theta, &self.mismatch(s, p)), &mut tau);
        let v_found = problem.slip_of(&u);
        let tau_found = stress(problem, &u)?;
        for k in 0..v.len() {
            problem.q[k] += v_found[k] - v[k];
            s[k] += tau_found[k] - tau[k];
        }
        Ok(None)
    }

    /// (Γ − θ T)⁻¹ x.
    fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        let n = x.len();
        (self.factor).solve_in_place(MatMut::from_column_major_slice_mut(&mut x, n, 1));
        x
    }
}

/// S u + t by row.
fn stress(problem: &ContactProblem<'_>, u: &[f64]) -> Result<Vec<f64>, MethodError> {
    let all = implied_forces(problem.increment, u)?;
    Ok(problem.rows.restrict(&all))
}

/// w by row.
fn weights(system: &ContactSystem, rows: &RowSet) -> Vec<f64> {
    let weight = system.weight();
    rows.source
        .iter()
        .map(|&i| weight[i / system.dim()])
        .collect()
}

fn scaled(factor: f64, x: &[f64]) -> Vec<f64> {
    x.iter().map(|x| factor * x).collect()
}

#[cfg(test)]
mod tests {
    use faer::linalg::solvers::PartialPivLu;

    use super::*;
    use crate::algebra::dense::dot;
    use crate::algebra::matrix::{JumpOperator, SquareMatrix};
    use crate::contract::elastic::{Elastic, ElasticParts};

    /// Numbers without symmetry between −1 and 1.
    fn number(k: usize) -> f64 {
        (12.9898 * (k + 1) as f64).sin()
    }

    fn sparse(m: usize, n: usize, entry: impl Fn(usize, usize) -> f64) -> JumpOperator {
        let columns = (0..m).flat_map(|_| 0..n).collect();
        let values = (0..m * n).map(|k| entry(k / n, k % n)).collect();
        JumpOperator::new(m, n, (0..=m).map(|i| i * n).collect(), columns, values).unwrap()
    }

    /// (W + C) P and the forces that P and y exert must be what elimination of u on the whole body gives: with
    /// y = Γ⁻¹ (S u − P), (K − θ Sᵀ Γ⁻¹ S) u = Bᵀ P − θ Sᵀ Γ⁻¹ P and v̂ = B u − y.
    #[test]
    fn the_condensed_operator_is_that_of_the_whole_body() {
        let (n, m) = (9, 6);
        let weight = vec![0.5, 1.0, 2.0];
        let (b, s) = (
            |i, j| number(100 + 9 * i + j),
            |i, j| number(200 + 9 * i + j),
        );
        let k = |i: usize, j: usize| match i.abs_diff(j) {
            0 => 3.0 + 0.1 * i as f64,
            1 => -1.0,
            _ => 0.0,
        };
        let mut col_ptr = vec![0];
        let (mut row_idx, mut values) = (vec![], vec![]);
        for j in 0..n {
            for i in j..n.min(j + 2) {
                row_idx.push(i);
                values.push(k(i, j));
            }
            col_ptr.push(row_idx.len());
        }
        let elastic = Elastic::new(ElasticParts {
            dim: 2,
            stiffness: SquareMatrix::symmetric(n, col_ptr, row_idx, values).unwrap(),
            jump: sparse(m, n, b),
            weight: weight.clone(),
            order: (0..n).collect(),
            floating: vec![],
            frictionless: vec![],
            traction: Some(sparse(m, n, s)),
        })
        .unwrap();
        // Friction at some points only: the others keep their normal row.
        for friction in [[0.3, 0.3, 0.3], [0.3, 0.0, 0.3]] {
            let system = ContactSystem::new(elastic.clone(), friction.to_vec()).unwrap();
            let rows = system.row_set().source.clone();
            let p: Vec<f64> = (0..rows.len()).map(|k| number(300 + k)).collect();
            for theta in [1.0, 0.0, -1.0] {
                let operator = system.operator(crate::DelassusForm::Formed).unwrap();
                let terms = Stabilisation::new(&system, operator.clone(), theta, 1.5).unwrap();
                let stiffness = |k: usize| terms.gamma * weight[rows[k] / 2];
                let sum = |f: &dyn Fn(usize) -> f64| (0..rows.len()).map(f).sum::<f64>();
                let whole = Mat::from_fn(n, n, |i, j| {
                    k(i, j) - theta * sum(&|l| s(rows[l], i) * s(rows[l], j) / stiffness(l))
                });
                let f = Mat::from_fn(n, 1, |i, _| {
                    sum(&|l| (b(rows[l], i) - theta * s(rows[l], i) / stiffness(l)) * p[l])
                });
                let u = PartialPivLu::new(whole.as_ref()).solve(f);
                let times =
                    |of: &dyn Fn(usize) -> f64| (0..n).map(|j| of(j) * u[(j, 0)]).sum::<f64>();
                let mut v = vec![0.0; rows.len()];
                operator.w.apply_add(&p, &mut v);
                mul_add(terms.series.compliance(), &p, &mut v);
                let y = terms.mismatch(&vec![0.0; rows.len()], &p);
                for l in 0..rows.len() {
                    let expected = (times(&|j| s(rows[l], j)) - p[l]) / stiffness(l);
                    assert!(
                        (y[l] - expected).abs() < 1e-12,
                        "{theta}: {} {expected}",
                        y[l]
                    );
                    let expected = times(&|j| b(rows[l], j)) - expected;
                    assert!(
                        (v[l] - expected).abs() < 1e-12,
                        "{theta}: {} {expected}",
                        v[l]
                    );
                }
                // The bound on γ is on this quadratic form.
                assert!(dot(&p, &v) > 0.0);
            }
        }
    }
}
