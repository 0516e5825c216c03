//! Between an increment and the problems of interchange files.

pub mod export;
pub mod problem_file;

use std::sync::Arc;

use faer::MatMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::amd;
use faer::sparse::{FaerError, SparseColMat, SymbolicSparseColMatRef, Triplet};
use nalgebra::{DMatrix, DVector};
use stickslip_methods::{
    ContactState, Elastic, ElasticParts, Increment, Load, LocalForm, MethodError, SquareMatrix,
    check_rows,
};

use crate::files::interchange::{GlobalProblem, Info, LocalProblem, Solution, SparseMatrix};
use crate::run::local_problem::{local_velocity, unsolved};

/// The problem that a file gives a method.
pub struct System {
    /// The body.
    pub elastic: Arc<Elastic>,
    /// Friction coefficient per point.
    pub friction: Vec<f64>,
    /// The load on it; the increment starts from rest.
    pub load: Load,
}

/// An increment with its solution as local problem.
pub fn local_problem(
    increment: &Increment<'_>,
    form: &LocalForm,
    solution: &ContactState,
    info: Info,
) -> LocalProblem {
    let rows = form.q.len();
    let u = local_velocity(increment, solution);
    // V is orthonormal: α = Vᵀ (u − q − W r).
    let mut rest = vec![0.0; rows];
    form.w.mul(&solution.p, &mut rest);
    for ((rest, u), q) in rest.iter_mut().zip(&u).zip(&form.q) {
        *rest = u - q - *rest;
    }
    let amplitude = |mode: &Vec<f64>| mode.iter().zip(&rest).map(|(v, x)| v * x).sum();
    LocalProblem {
        solution: Some(Solution {
            v: Vec::new(),
            u,
            r: solution.p.clone(),
            l: form.modes.iter().map(amplitude).collect(),
        }),
        ..unsolved(increment, form, info)
    }
}

/// An increment with its solution as global problem; `None` if only the Delassus operator is known.
pub fn global_problem(
    increment: &Increment<'_>,
    solution: &ContactState,
    info: Info,
) -> Option<GlobalProblem> {
    let elastic = increment.system.elastic();
    let none = ContactState::zero(increment.system);
    Some(GlobalProblem {
        dim: increment.system.dim(),
        m: SparseMatrix::from_square(elastic.stiffness()?),
        h: SparseMatrix::from_rows(elastic.jump()).transposed(),
        f: increment.load.force.clone(),
        w: local_velocity(increment, &none),
        mu: increment.system.friction().to_vec(),
        equality: None,
        info,
        solution: Some(Solution {
            v: solution.u.clone(),
            u: local_velocity(increment, solution),
            r: solution.p.clone(),
            l: Vec::new(),
        }),
        guesses: Vec::new(),
    })
}

/// Asymmetry of W or M, in units of the largest entry, up to which it is rounding of whoever wrote the file: their symmetric
/// part is taken. Beyond it they are taken as they stand.
pub const ROUNDING: f64 = 1e-12;

/// The body and load of a local problem. A W that is symmetric up to [`ROUNDING`] is held as such.
///
/// # Errors
/// Those of [`system`].
pub fn local_system(problem: &LocalProblem) -> Result<System, MethodError> {
    let square = problem.w.as_square()?;
    let w = match square.asymmetry() {
        ..=ROUNDING => problem.w.symmetric_part()?,
        _ => square,
    };
    // V may have no columns: then it says nothing.
    let equality = (problem.equality.as_ref()).filter(|equality| equality.v.cols() > 0);
    let motions = equality.map(|equality| {
        let columns = (0..equality.v.cols()).map(|j| equality.v.column(j));
        (columns.collect(), equality.s.as_slice())
    });
    system(problem.dim, w, &problem.q, &problem.mu, motions)
}

/// The body and load of u = W r + V λ + q, Vᵀ r + s = 0, given the columns of V and s where pieces float.
///
/// V and s become rigid motions and a load f on the contact points with Vᵀ f = s, whose free jump W f is taken off q.
///
/// # Errors
/// Refusals of [`Elastic::from_delassus`]; R ≠ 0 is the caller's to refuse.
pub fn system(
    dim: usize,
    w: SquareMatrix,
    q: &[f64],
    mu: &[f64],
    motions: Option<(Vec<Vec<f64>>, &[f64])>,
) -> Result<System, MethodError> {
    let (mut force, mut offset) = (vec![0.0; q.len()], q.to_vec());
    let (modes, balance) = motions.unwrap_or_default();
    let elastic = Elastic::from_delassus(dim, w, modes.clone())?;
    if !modes.is_empty() {
        // Independent columns, which the body has just checked: Vᵀ V is regular.
        let v = DMatrix::from_fn(q.len(), modes.len(), |i, j| modes[j][i]);
        let y = (v.transpose() * &v)
            .lu()
            .solve(&DVector::from_column_slice(balance));
        let y = y.ok_or(MethodError::FreeRigidMotion { modes: modes.len() })?;
        force.copy_from_slice((v * y).as_slice());
        let mut free = force.clone();
        elastic.solve(&mut free)?;
        offset
            .iter_mut()
            .zip(&free)
            .for_each(|(q, free)| *q -= free);
    }
    Ok(System {
        elastic,
        friction: mu.to_vec(),
        load: Load {
            force,
            offset,
            traction: Vec::new(),
        },
    })
}

/// The body and load of a global problem. Tributary areas are not in the file and taken as 1. An M that is not symmetric up
/// to [`ROUNDING`] is no stiffness: it is condensed, and the body known at its contact points only.
///
/// # Errors
/// Refusals of [`Elastic::new`] and [`local_system`], a singular M; equality constraints are the caller's to refuse.
pub fn global_system(problem: &GlobalProblem) -> Result<System, MethodError> {
    if problem.m.as_square()?.asymmetry() > ROUNDING {
        return local_system(&condensed(problem)?);
    }
    let stiffness = problem.m.symmetric_part()?;
    let elastic = Elastic::new(ElasticParts {
        dim: problem.dim,
        jump: problem.h.transposed().as_rows()?,
        weight: vec![1.0; problem.points()],
        order: minimum_degree(&stiffness)?,
        stiffness,
        floating: Vec::new(),
        frictionless: Vec::new(),
        traction: None,
    })?;
    Ok(System {
        elastic,
        friction: problem.mu.clone(),
        load: Load {
            force: problem.f.clone(),
            offset: problem.w.clone(),
            traction: Vec::new(),
        },
    })
}

/// Largest |M x − b|/|b| of a solve that counts: a singular matrix leaves more.
const SOLVED: f64 = 1e-9;

/// W = Hᵀ M⁻¹ H and q = Hᵀ M⁻¹ f + w by a sparse LU factor of M, with a step of iterative refinement.
fn condensed(problem: &GlobalProblem) -> Result<LocalProblem, MethodError> {
    let (n, rows, what) = (problem.f.len(), problem.w.len(), "LU factorisation of M");
    check_rows(rows)?;
    let failed = |reason: String| MethodError::Kernel { what, reason };
    let triplets: Vec<_> = (problem.m.entries())
        .map(|(i, j, v)| Triplet::new(i, j, v))
        .collect();
    let m = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets);
    let lu = m.map_err(|e| failed(format!("{e:?}")))?.sp_lu();
    let lu = lu.map_err(|e| failed(format!("{e:?}")))?;
    let (m, jump) = (problem.m.as_square()?, problem.h.transposed().as_rows()?);
    let solve = |b: Vec<f64>| {
        let (mut x, mut rest, mut product) = (vec![0.0; n], b.clone(), vec![0.0; n]);
        for _ in 0..2 {
            lu.solve_in_place(MatMut::from_column_major_slice_mut(&mut rest, n, 1));
            x.iter_mut().zip(&rest).for_each(|(x, d)| *x += d);
            m.mul(&x, &mut product);
            rest = b.iter().zip(&product).map(|(b, p)| b - p).collect();
        }
        let [left, all] = [rest, b].map(|v| v.iter().fold(0.0, |sum, v| v.mul_add(*v, sum)).sqrt());
        if left.is_nan() || left > SOLVED * all {
            return Err(failed("it is singular".into()));
        }
        let mut moved = vec![0.0; rows];
        jump.mul(&x, &mut moved);
        Ok(moved)
    };
    let columns: Result<Vec<_>, _> = (0..rows).map(|j| solve(problem.h.column(j))).collect();
    let free = solve(problem.f.clone())?;
    Ok(LocalProblem {
        dim: problem.dim,
        w: SparseMatrix::from_dense_columns(rows, &columns?),
        q: free.iter().zip(&problem.w).map(|(u, w)| u + w).collect(),
        mu: problem.mu.clone(),
        equality: None,
        info: problem.info.clone(),
        solution: None,
        guesses: Vec::new(),
    })
}

/// Approximate minimum degree order: a file has no mesh to dissect (Amestoy, Davis, Duff 1996).
fn minimum_degree(k: &SquareMatrix) -> Result<Vec<usize>, MethodError> {
    let n = k.size();
    let what = "elimination order";
    let pattern = SymbolicSparseColMatRef::new_checked(n, n, k.col_ptr(), None, k.row_idx());
    let request = amd::order_scratch::<usize>(n, k.row_idx().len());
    let mut memory = MemBuffer::try_new(request).map_err(|_| MethodError::OutOfMemory { what })?;
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let stack = MemStack::new(&mut memory);
    amd::order(&mut order, &mut inverse, pattern, Default::default(), stack).map_err(
        |e| match e {
            FaerError::OutOfMemory => MethodError::OutOfMemory { what },
            other => MethodError::Kernel {
                what,
                reason: format!("{other:?}"),
            },
        },
    )?;
    Ok(order)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: hand calculation. M⁻¹ = [[3, −1], [−2, 4]]/10, H = 1.
    #[test]
    fn an_unsymmetric_m_is_condensed_as_it_stands() {
        let square = |entries: [[f64; 2]; 2]| SparseMatrix::from_dense(2, 2, |i, j| entries[i][j]);
        let mut problem = GlobalProblem {
            dim: 2,
            m: square([[4.0, 1.0], [2.0, 3.0]]),
            h: square([[1.0, 0.0], [0.0, 1.0]]),
            f: vec![1.0, 2.0],
            w: vec![0.5, 0.0],
            mu: vec![0.3],
            equality: None,
            info: Info::default(),
            solution: None,
            guesses: Vec::new(),
        };
        let LocalProblem { w, q, .. } = condensed(&problem).unwrap();
        let found = [
            w.get(0, 0),
            w.get(0, 1),
            w.get(1, 0),
            w.get(1, 1),
            q[0],
            q[1],
        ];
        for (found, expected) in found.into_iter().zip([0.3, -0.1, -0.2, 0.4, 0.6, 0.6]) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
        assert_ne!(global_system(&problem).unwrap().elastic.asymmetry(), 0.0);
        problem.m = square([[1.0, 1.0], [2.0, 2.0]]);
        assert!(global_system(&problem).is_err());
    }
}
