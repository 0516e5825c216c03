//! Contact problems as files: FCLIB (HDF5), read and written.
//!
//! ```text
//! local    Vᵀ r + R λ + s = 0,   u = W r + V λ + q        W = B K⁻¹ Bᵀ
//! global   M v = H r + G λ + f,  Gᵀ v + b = 0,  u = Hᵀ v + w        M = K, H = Bᵀ
//! both     K_μ* ∋ u + μ |u_t| n ⊥ r ∈ K_μ                 one cone per contact point
//! ```
//! The reaction r is P, the local velocity u is (g, d): gap, and slip since the start of the increment. Both packages
//! order the components of a point (n, a[, b]) and count compression positive, so no sign changes between the two
//! (Acary, Brémond, Huber: FCLIB, Inria technical report 444, 2014).
//!
//! The types here are plain data that were checked when read; they know nothing of cases and methods.

mod error;
pub mod fclib;
pub mod fclib_global;
pub mod fclib_local;
mod fclib_matrix;
mod fclib_parts;
mod hdf5;
mod sparse;

pub use error::InterchangeError;
pub use fclib::Problem;
pub use fclib_global::{GlobalEquality, GlobalProblem};
pub use fclib_local::{LocalEquality, LocalProblem};
pub use fclib_parts::{Info, Solution};
pub use sparse::SparseMatrix;
