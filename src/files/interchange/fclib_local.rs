//! The local problem of FCLIB: condensed to the contact points.
//!
//! ```text
//! /fclib_local/spacedim, W, V, R, vectors/{q, mu, s}, info/{title, description, math_info}
//! ```
//! V, R and s stand together or not at all.

use super::error::InterchangeError;
use super::fclib_matrix::read_matrix;
use super::fclib_parts::{
    Info, Layout, Lengths, Solution, read_dim, read_friction, read_info, read_solutions, rows,
};
use super::hdf5::Tree;
use super::sparse::SparseMatrix;

const GROUP: &str = "fclib_local";

/// `Vᵀ r + R λ + s = 0`, `u = W r + V λ + q`, and the contact laws between u and r.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalProblem {
    /// Components per contact point, 2 or 3.
    pub dim: usize,
    /// Delassus operator W, m × m, m = `dim` · points; not always symmetric.
    pub w: SparseMatrix,
    /// Velocity without reactions q, m entries.
    pub q: Vec<f64>,
    /// Friction coefficient μ per point.
    pub mu: Vec<f64>,
    /// Unknowns λ beside the reactions, e.g. rigid motions.
    pub equality: Option<LocalEquality>,
    /// Words of the author.
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

    /// Sizes come from the shapes of the vectors; the matrices must agree with them before anything is read.
    pub(super) fn read(tree: &Tree) -> Result<Self, InterchangeError> {
        let dim = read_dim(tree, GROUP)?;
        let q_name = format!("{GROUP}/vectors/q");
        let rows = rows(tree, &q_name, dim)?;
        let w = read_matrix(tree, &format!("{GROUP}/W"), rows, rows)?;
        let mu = read_friction(tree, GROUP, rows / dim)?;
        let (v_name, r_name) = (format!("{GROUP}/V"), format!("{GROUP}/R"));
        let equality = match (tree.has_group(&v_name)?, tree.has_group(&r_name)?) {
            (false, false) => None,
            (true, true) => {
                let s_name = format!("{GROUP}/vectors/s");
                let motions = tree.extent(&s_name)? as usize;
                Some(LocalEquality {
                    v: read_matrix(tree, &v_name, rows, motions)?,
                    r: read_matrix(tree, &r_name, motions, motions)?,
                    s: tree.reals(&s_name, motions)?,
                })
            }
            (true, false) => return Err(tree.missing(&r_name)),
            (false, true) => return Err(tree.missing(&v_name)),
        };
        let mut problem = Self {
            dim,
            w,
            q: tree.reals(&q_name, rows)?,
            mu,
            equality,
            info: read_info(tree, GROUP),
            solution: None,
            guesses: Vec::new(),
        };
        (problem.solution, problem.guesses) = read_solutions(tree, problem.lengths());
        Ok(problem)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// [`InterchangeError::Unwritable`] if the parts do not fit or exceed 32-bit integers.
    pub fn to_bytes(&self) -> Result<Vec<u8>, InterchangeError> {
        let rows = self.dim * self.points();
        let mut matrices = vec![("W", &self.w, [rows, rows])];
        let mut vectors = vec![("q", &self.q[..], rows), ("mu", &self.mu, self.points())];
        if let Some(LocalEquality { v, r, s }) = &self.equality {
            matrices.extend([("V", v, [rows, s.len()]), ("R", r, [s.len(), s.len()])]);
            vectors.push(("s", s, s.len()));
        }
        let layout = Layout {
            group: GROUP,
            dim: self.dim,
            points: self.points(),
            matrices,
            vectors,
            info: &self.info,
            lengths: self.lengths(),
            solution: self.solution.as_ref(),
            guesses: &self.guesses,
        };
        layout.to_bytes()
    }
}
