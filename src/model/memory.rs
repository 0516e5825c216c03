//! Memory that a body will take, told before anything of it is built.
//!
//! ```text
//!   2D: A n + B n log₂ n       3D: A n + B n^(4/3)       n cells
//! ```
//!
//! n log n and n^(4/3) are the entries of a factor of K in nested dissection (George 1973), A n all that is kept by cell. A and B
//! are those of bodies with little contact, so that what fits is never refused: a plane through all of a solid takes up to
//! two thirds more.

use stickslip_methods::machine_gb;
use stickslip_xfem::mesh::box_mesh::GridSpec;

use crate::case::{Case, CaseError};

/// A and B in bytes, in 2D and 3D.
const BYTES: [[f64; 2]; 2] = [[2200.0, 65.0], [20_000.0, 700.0]];

/// Least memory of a run on so many cells [GB].
fn predicted_gb(dim: usize, cells: f64) -> f64 {
    let [by_cell, by_entry] = BYTES[usize::from(dim == 3)];
    let entries = match dim {
        2 => cells * cells.log2(),
        _ => cells.powf(4.0 / 3.0),
    };
    1e-9 * (by_cell * cells + by_entry * entries)
}

/// Refuses a mesh that does not fit this machine, with the number of cells that does.
///
/// # Errors
/// Such a mesh, at its place in the file.
pub fn check(case: &Case, grid: &GridSpec) -> Result<(), CaseError> {
    match machine_gb() {
        Some(machine) => fits(case, grid, machine),
        None => Ok(()),
    }
}

fn fits(case: &Case, grid: &GridSpec, machine: f64) -> Result<(), CaseError> {
    let dim = grid.lines.len();
    let cells = grid.cells();
    let needed = predicted_gb(dim, cells);
    if needed <= machine {
        return Ok(());
    }
    // By halving: the prediction grows with the cells.
    let (mut low, mut high) = (1.0, cells);
    while high - low > 1e-3 * low {
        let middle: f64 = 0.5 * (low + high);
        if predicted_gb(dim, middle) <= machine {
            low = middle
        } else {
            high = middle
        }
    }
    let message = format!(
        "{cells} cells need at least {needed:.0} GB of memory, this machine has {machine:.0}"
    );
    let allowed = format!("at most about {low:.1e} cells");
    Err(case.refuse(&case.mesh.span, &allowed, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Peaks of `run --method hybrid` on two threads [GB]: dimension, cells, measured.
    #[rustfmt::skip]
    const MEASURED: [(usize, f64, f64); 5] = [
        (2, 250.0 * 250.0, 0.245), (2, 1e6, 3.5), (3, 16.0 * 16.0 * 16.0, 0.191), (3, 24.0 * 24.0 * 24.0, 0.874), (3, 64e3, 3.0),
    ];

    #[test]
    fn predictions_stay_below_the_peaks_of_runs_and_above_half_of_them() {
        for (dim, cells, measured) in MEASURED {
            let ratio = predicted_gb(dim, cells) / measured;
            assert!((0.5..1.05).contains(&ratio), "{dim} {cells}: {ratio}");
        }
    }
}
