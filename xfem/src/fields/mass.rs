//! Mass matrix of the enriched functions.
//!
//! ```text
//!   M[(p,a),(q,b)] = δ_ab ∫ φ_p φ_q dx                u·M u = ∫ |u_h|² dx
//! ```
//!
//! Every part of a divided cell is integrated by itself, with the points that errors are measured at: exact for products of
//! two Heaviside functions on affine cells in 2D, of degree 5 per tetrahedron in 3D, graded towards tips and fronts. All
//! weights but those of bent parts about a tip are positive and lie in their part, so that a sliver has the mass of a sliver.

use nalgebra::{DMatrix, DVectorView};
use rayon::prelude::*;

use crate::stiffness::assembly::Assembly;
use crate::stiffness::block_matrix::BlockMatrix;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};
use crate::stiffness::elasticity::CellMatrix;

use super::sampling::comparison_points;

/// Points per direction without and with branch functions: degree 6 in triangles, for φ_p φ_q of degree 4; about a tip
/// φ_p φ_q has the factor r, and degree 13 in √r with the measure.
const RULES: [usize; 2] = [4, 6];

/// Mass matrix over all unknowns for density 1 [m^dim], on the pattern of the stiffness.
///
/// # Errors
/// A part of a cell that cannot be integrated.
pub fn mass(integrator: &CellIntegrator<'_>) -> Result<BlockMatrix, CellError> {
    let cells: Vec<CellMatrix> = (0..integrator.mesh.cell_count())
        .into_par_iter()
        .map(|cell| cell_mass(integrator, cell))
        .collect::<Result<_, _>>()?;
    let assembly = Assembly::new(integrator.mesh.dim(), integrator.enrichment);
    Ok(assembly.sum(|cell| cells[cell].as_view()))
}

fn cell_mass(integrator: &CellIntegrator<'_>, cell: usize) -> Result<CellMatrix, CellError> {
    let dim = integrator.mesh.dim();
    let mut functions = integrator.functions(cell);
    let n = functions.numbers.len();
    let mut scalar = DMatrix::zeros(n, n);
    let tips = &integrator.enrichment.tips;
    let rule = RULES[usize::from(integrator.enrichment.has_branch(cell))];
    for p in comparison_points(integrator, cell, tips, rule)? {
        let p = p.point;
        functions.evaluate(&p.xi, &p.x, p.region);
        let values = DVectorView::from_slice(&functions.values, n);
        scalar.ger(p.weight, &values, &values, 1.0);
    }
    Ok(scalar.kronecker(&DMatrix::identity(dim, dim)))
}
