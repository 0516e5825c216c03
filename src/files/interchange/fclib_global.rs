//! The global problem of FCLIB: with all displacement unknowns.
//!
//! ```text
//! /fclib_global/spacedim, M, H, G, vectors/{f, w, mu, b}, info/{title, description, math_info}
//! ```
//! G and b stand together or not at all.

use super::error::InterchangeError;
use super::fclib_matrix::read_matrix;
use super::fclib_parts::{
    Info, Layout, Lengths, Solution, read_dim, read_friction, read_info, read_solutions, rows,
};
use super::hdf5::Tree;
use super::sparse::SparseMatrix;

const GROUP: &str = "fclib_global";

/// `M v = H r + G λ + f`, `Gᵀ v + b = 0`, `u = Hᵀ v + w`, and the contact laws between u and r.
#[derive(Debug, Clone, PartialEq)]
pub struct GlobalProblem {
    /// Components per contact point, 2 or 3.
    pub dim: usize,
    /// M, n × n; here the stiffness K. Not always symmetric.
    pub m: SparseMatrix,
    /// H, n × m with m = `dim` · points; here Bᵀ.
    pub h: SparseMatrix,
    /// f, n entries.
    pub f: Vec<f64>,
    /// w, m entries.
    pub w: Vec<f64>,
    /// Friction coefficient μ per point.
    pub mu: Vec<f64>,
    /// Constraints on v.
    pub equality: Option<GlobalEquality>,
    /// Words of the author.
    pub info: Info,
    /// Solution.
    pub solution: Option<Solution>,
    /// Guesses.
    pub guesses: Vec<Solution>,
}

/// `Gᵀ v + b = 0`.
#[derive(Debug, Clone, PartialEq)]
pub struct GlobalEquality {
    /// G, n × p.
    pub g: SparseMatrix,
    /// b, p entries.
    pub b: Vec<f64>,
}

impl GlobalProblem {
    /// Number of contact points.
    pub fn points(&self) -> usize {
        self.mu.len()
    }

    fn lengths(&self) -> Lengths {
        Lengths {
            v: self.f.len(),
            r: self.w.len(),
            l: self.equality.as_ref().map_or(0, |e| e.b.len()),
        }
    }

    /// Sizes come from the shapes of the vectors; the matrices must agree with them before anything is read.
    pub(super) fn read(tree: &Tree) -> Result<Self, InterchangeError> {
        let dim = read_dim(tree, GROUP)?;
        let [f_name, w_name, b_name] = ["f", "w", "b"].map(|v| format!("{GROUP}/vectors/{v}"));
        let (unknowns, rows) = (tree.extent(&f_name)? as usize, rows(tree, &w_name, dim)?);
        let matrix = |name, cols| read_matrix(tree, &format!("{GROUP}/{name}"), unknowns, cols);
        let equality = if tree.has_group(&format!("{GROUP}/G"))? {
            let constraints = tree.extent(&b_name)? as usize;
            let g = matrix("G", constraints)?;
            let b = tree.reals(&b_name, constraints)?;
            Some(GlobalEquality { g, b })
        } else {
            None
        };
        let mut problem = Self {
            dim,
            m: matrix("M", unknowns)?,
            h: matrix("H", rows)?,
            f: tree.reals(&f_name, unknowns)?,
            w: tree.reals(&w_name, rows)?,
            mu: read_friction(tree, GROUP, rows / dim)?,
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
        let (unknowns, rows) = (self.f.len(), self.dim * self.points());
        let mut matrices = vec![
            ("M", &self.m, [unknowns, unknowns]),
            ("H", &self.h, [unknowns, rows]),
        ];
        let mut vectors = vec![
            ("f", &self.f[..], unknowns),
            ("w", &self.w, rows),
            ("mu", &self.mu, self.points()),
        ];
        if let Some(GlobalEquality { g, b }) = &self.equality {
            matrices.push(("G", g, [unknowns, b.len()]));
            vectors.push(("b", b, b.len()));
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
