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

/// Enriched cells worked on at once: enough for all threads, few beside all matrices.
const AT_ONCE: usize = 4096;

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
        let mut own = Vec::with_capacity(total);
        for some in enriched.chunks(AT_ONCE) {
            let stiffness = |&(cell, _): &(u32, usize)| {
                let cell = cell as usize;
                integrator.stiffness(cell, &plain[shape[cell] as usize])
            };
            let matrices = some.par_iter().map(stiffness);
            for k in matrices.collect::<Result<Vec<_>, _>>()? {
                own.extend_from_slice(k.as_slice());
            }
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
        for some in self.enriched.chunks(AT_ONCE) {
            let changed = some.par_iter().map(|&(cell, from)| {
                let cell = cell as usize;
                let k = basis.matrix(dim, enrichment.cell(cell), self.of(cell));
                k.map(|k| (from, k))
            });
            for (from, k) in changed.collect::<Vec<_>>().into_iter().flatten() {
                let values = k.as_slice();
                self.own[from..from + values.len()].copy_from_slice(values);
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
