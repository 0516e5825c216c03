//! The local problem of FCLIB: condensed to the contact points.
//!
//! ```text
//! /fclib_local/spacedim, W, V, R, vectors/{q, mu, s}, info/{title, description, math_info}
//! ```
//! V, R and s stand together or not at all.

use super::error::InterchangeError;
use super::fclib_matrix::{check_matrix, put_matrix, read_matrix, read_symmetric};
use super::fclib_parts::{
    Info, Lengths, Solution, check_size, check_solutions, points, put_info, put_solutions,
    read_dim, read_friction, read_info, read_solutions, unwritable,
};
use super::hdf5::{Tree, Writer, put_integers, put_reals, subgroup};
use super::sparse::SparseMatrix;

const GROUP: &str = "fclib_local";

/// `Vᵀ r + R λ + s = 0`, `u = W r + V λ + q`, and the contact laws between u and r.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalProblem {
    /// Components per contact point, 2 or 3.
    pub dim: usize,
    /// Delassus operator W, m × m, symmetric, m = `dim` · points.
    pub w: SparseMatrix,
    /// Velocity without reactions q, m entries.
    pub q: Vec<f64>,
    /// Friction coefficient μ per point.
    pub mu: Vec<f64>,
    /// Unknowns λ beside the reactions, e.g. rigid motions.
    pub equality: Option<LocalEquality>,
    /// What the author says.
    pub info: Info,
    /// Solution.
    pub solution: Option<Solution>,
    /// Guesses.
    pub guesses: Vec<Solution>,
}

/// `Vᵀ r + R λ + s = 0`.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalEquality {
    /// V, m × p.
    pub v: SparseMatrix,
    /// R, p × p.
    pub r: SparseMatrix,
    /// s, p entries.
    pub s: Vec<f64>,
}

impl LocalProblem {
    /// Number of contact points.
    pub fn points(&self) -> usize {
        self.mu.len()
    }

    fn lengths(&self) -> Lengths {
        Lengths {
            v: 0,
            r: self.q.len(),
            l: self.equality.as_ref().map_or(0, |e| e.s.len()),
        }
    }

    /// Sizes come from the vectors, which the file must really hold; the matrices must agree with them.
    pub(super) fn read(tree: &Tree) -> Result<Self, InterchangeError> {
        let dim = read_dim(tree, GROUP)?;
        let q_name = format!("{GROUP}/vectors/q");
        let q = tree.all_reals(&q_name)?;
        let rows = q.len();
        let mu = read_friction(tree, GROUP, points(tree, &q_name, rows, dim)?)?;
        let w = read_symmetric(tree, &format!("{GROUP}/W"), rows)?;
        let (v_name, r_name) = (format!("{GROUP}/V"), format!("{GROUP}/R"));
        let equality = match (tree.has_group(&v_name)?, tree.has_group(&r_name)?) {
            (false, false) => None,
            (true, true) => {
                let s = tree.all_reals(&format!("{GROUP}/vectors/s"))?;
                Some(LocalEquality {
                    v: read_matrix(tree, &v_name, rows, s.len())?,
                    r: read_matrix(tree, &r_name, s.len(), s.len())?,
                    s,
                })
            }
            (has_v, _) => {
                return Err(InterchangeError::Missing {
                    path: tree.path().into(),
                    dataset: if has_v { r_name } else { v_name },
                });
            }
        };
        let mut problem = Self {
            dim,
            w,
            q,
            mu,
            equality,
            info: read_info(tree, GROUP)?,
            solution: None,
            guesses: Vec::new(),
        };
        (problem.solution, problem.guesses) = read_solutions(tree, problem.lengths())?;
        Ok(problem)
    }

    fn check(&self) -> Result<(), InterchangeError> {
        let rows = self.dim * self.points();
        if !(self.dim == 2 || self.dim == 3) || rows == 0 {
            let what = format!("{} points of {} components", self.points(), self.dim);
            return Err(unwritable(what));
        }
        check_size("q", self.q.len(), rows)?;
        check_matrix("W", &self.w, rows, rows)?;
        if let Some(equality) = &self.equality {
            let extra = equality.s.len();
            check_matrix("V", &equality.v, rows, extra)?;
            check_matrix("R", &equality.r, extra, extra)?;
        }
        check_solutions(self.solution.iter().chain(&self.guesses), self.lengths())
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// [`InterchangeError::Unwritable`] if the parts do not fit or exceed 32-bit integers.
    pub fn to_bytes(&self) -> Result<Vec<u8>, InterchangeError> {
        self.check()?;
        let mut file = Writer::new();
        file.group(GROUP, |group| {
            put_integers(group, "spacedim", &[self.dim as i32]);
            put_matrix(group, "W", &self.w);
            if let Some(equality) = &self.equality {
                put_matrix(group, "V", &equality.v);
                put_matrix(group, "R", &equality.r);
            }
            subgroup(group, "vectors", |group| {
                put_reals(group, "q", &self.q);
                put_reals(group, "mu", &self.mu);
                if let Some(equality) = &self.equality {
                    put_reals(group, "s", &equality.s);
                }
            });
            put_info(group, &self.info);
        });
        put_solutions(&mut file, self.solution.as_ref(), &self.guesses);
        file.finish()
    }
}
