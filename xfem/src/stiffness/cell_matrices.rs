//! Matrices of all cells of a body, shared among cells of one shape.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::geometry::sub;
use crate::mesh::cell::{CellMap, MOST_NODES};

use super::cell_matrix::{CellError, CellIntegrator};
use super::elasticity::{CellMatrix, CellView, cell_stiffness};
use super::orthonormal::SolverBasis;

/// Shape up to translation, in quanta of length.
type ShapeKey = [i64; 3 * (MOST_NODES - 1)];

/// Stiffness matrices of all cells over their functions.
pub struct CellMatrices {
    /// Those of plain cells, one per shape.
    plain: Vec<CellMatrix>,
    /// Of every cell: its shape, or after all shapes its place among the enriched cells.
    of_cell: Vec<u32>,
    /// Enriched cells, ascending, and where the matrix of each begins.
    enriched: Vec<(u32, usize)>,
    /// Their matrices one after the other: as one block, memory that goes back when they are no longer used.
    own: Vec<f64>,
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
        let plain: Vec<CellMatrix> = first
            .par_iter()
            .map(|&cell| cell_stiffness(&mesh.map(cell), integrator.lame))
            .collect::<Result<_, _>>()?;
        let mut total = 0;
        let mut enriched = Vec::new();
        for cell in (0..mesh.cell_count()).filter(|&c| !enrichment.is_plain(mesh, c)) {
            enriched.push((cell as u32, total));
            total += (enrichment.cell(cell).len() * mesh.dim()).pow(2);
        }
        let mut own = vec![0.0; total];
        let failed =
            (parts(&mut own, &enriched).into_par_iter()).find_map_first(|(cell, place)| {
                let k = integrator.stiffness(cell, &plain[shape[cell] as usize]);
                k.map(|k| place.copy_from_slice(k.as_slice())).err()
            });
        if let Some(error) = failed {
            return Err(error);
        }
        let mut of_cell = shape;
        for (place, &(cell, _)) in enriched.iter().enumerate() {
            of_cell[cell as usize] = (plain.len() + place) as u32;
        }
        Ok(CellMatrices {
            plain,
            of_cell,
            enriched,
            own,
        })
    }

    /// Matrix of a cell over its functions.
    pub fn of(&self, cell: usize) -> CellView<'_> {
        let matrix = self.of_cell[cell] as usize;
        let Some(place) = matrix.checked_sub(self.plain.len()) else {
            return self.plain[matrix].as_view();
        };
        let from = self.enriched[place].1;
        let next = self.enriched.get(place + 1);
        let values = &self.own[from..next.map_or(self.own.len(), |e| e.1)];
        let size = values.len().isqrt();
        CellView::from_slice(values, size, size)
    }

    /// Goes over to the basis of the solver.
    pub fn transform(&mut self, integrator: &CellIntegrator<'_>, basis: &SolverBasis) {
        let (dim, enrichment) = (integrator.mesh.dim(), integrator.enrichment);
        let all = parts(&mut self.own, &self.enriched);
        all.into_par_iter().for_each(|(cell, place)| {
            let size = place.len().isqrt();
            let k = CellView::from_slice(place, size, size);
            if let Some(k) = basis.matrix(dim, enrichment.cell(cell), k) {
                place.copy_from_slice(k.as_slice());
            }
        });
    }
}

/// The matrices of enriched cells, each where it begins.
fn parts<'a>(own: &'a mut [f64], enriched: &[(u32, usize)]) -> Vec<(usize, &'a mut [f64])> {
    let (mut rest, mut parts) = (own, Vec::with_capacity(enriched.len()));
    // From the last on: one ends where the next begins.
    for &(cell, from) in enriched.iter().rev() {
        let (before, part) = rest.split_at_mut(from);
        parts.push((cell as usize, part));
        rest = before;
    }
    parts.reverse();
    parts
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
