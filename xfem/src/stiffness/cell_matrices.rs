//! Matrices of all cells of a body, shared among cells of one shape.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::geometry::sub;
use crate::mesh::cell::{CellMap, MOST_NODES};

use super::cell_matrix::{CellError, CellIntegrator};
use super::elasticity::{CellMatrix, cell_stiffness};
use super::orthonormal::SolverBasis;

/// Shape up to translation, in quanta of length.
type ShapeKey = [i64; 3 * (MOST_NODES - 1)];

/// Stiffness matrices of all cells over their functions.
pub struct CellMatrices {
    distinct: Vec<CellMatrix>,
    of_cell: Vec<u32>,
}

impl CellMatrices {
    /// One matrix per shape of plain cell, one per enriched cell.
    ///
    /// # Errors
    /// A cut cell that cannot be integrated.
    pub fn new(integrator: &CellIntegrator<'_>) -> Result<Self, CellError> {
        let (mesh, enrichment) = (integrator.mesh, integrator.enrichment);
        // Coordinates of a body 10⁴ cells wide carry rounding of 1e-12 of a cell.
        let smallest = mesh.smallest_edge();
        let keys: Vec<ShapeKey> = (0..mesh.cell_count())
            .into_par_iter()
            .map(|cell| shape_key(&mesh.map(cell), 1e-10 * smallest))
            .collect();
        let mut shapes: HashMap<&ShapeKey, u32> = HashMap::new();
        let mut first = Vec::new();
        let shape: Vec<u32> = keys
            .iter()
            .enumerate()
            .map(|(cell, key)| {
                *shapes.entry(key).or_insert_with(|| {
                    first.push(cell);
                    first.len() as u32 - 1
                })
            })
            .collect();
        let mut distinct: Vec<CellMatrix> = first
            .par_iter()
            .map(|&cell| cell_stiffness(&mesh.map(cell), integrator.lame))
            .collect();
        let enriched: Vec<usize> = (0..mesh.cell_count())
            .filter(|&c| !enrichment.is_plain(mesh, c))
            .collect();
        let own: Vec<CellMatrix> = enriched
            .par_iter()
            .map(|&cell| integrator.stiffness(cell, &distinct[shape[cell] as usize]))
            .collect::<Result<_, _>>()?;
        let mut of_cell = shape;
        for (position, &cell) in enriched.iter().enumerate() {
            of_cell[cell] = (distinct.len() + position) as u32;
        }
        distinct.extend(own);
        Ok(CellMatrices { distinct, of_cell })
    }

    /// Matrix of a cell over its functions.
    pub fn of(&self, cell: usize) -> &CellMatrix {
        &self.distinct[self.of_cell[cell] as usize]
    }

    /// Goes over to the basis of the solver.
    pub fn transform(&mut self, integrator: &CellIntegrator<'_>, basis: &SolverBasis) {
        for cell in 0..self.of_cell.len() {
            let functions = integrator.enrichment.cell(cell);
            if let Some(k) = basis.matrix(integrator.mesh.dim(), functions, self.of(cell)) {
                // Cells with enriched functions have a matrix of their own.
                self.distinct[self.of_cell[cell] as usize] = k;
            }
        }
    }
}

/// Cells with equal keys share one standard stiffness; `quantum`: length below which they are equal [m].
fn shape_key(map: &CellMap, quantum: f64) -> ShapeKey {
    let mut key = [0; 3 * (MOST_NODES - 1)];
    let edges = map[1..].iter().flat_map(|corner| sub(corner, &map[0]));
    for (entry, length) in key.iter_mut().zip(edges) {
        *entry = (length / quantum).round() as i64;
    }
    key
}
