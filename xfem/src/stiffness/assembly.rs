//! Assembly: cell matrices into the block matrix of the body, identical bits for any number of threads.

use std::sync::Arc;

use rayon::prelude::*;

use crate::enrichment::Enrichment;
use crate::mesh::Mesh;
use crate::mesh::ordering::nested_dissection;

use super::block_matrix::{BlockMatrix, BlockPattern};
use super::elasticity::CellView;

/// Pattern of a body's matrices and the place of every cell in it: computed once per mesh.
#[derive(Debug)]
pub struct Assembly<'a> {
    dim: usize,
    enrichment: &'a Enrichment,
    /// Cells that carry each function, ascending.
    pub users: Vec<Vec<u32>>,
    pattern: Arc<BlockPattern>,
    start: Vec<usize>,
    /// For cell-local functions (l, k), l the column: position of row k in column l; unused above the diagonal.
    position: Vec<u16>,
}

impl<'a> Assembly<'a> {
    /// Finds the position of every cell block.
    pub fn new(dim: usize, enrichment: &'a Enrichment) -> Self {
        let users = enrichment.users();
        let pattern = BlockPattern::new(&users, |cell| enrichment.cell(cell));
        let lists: Vec<Vec<u16>> = (0..enrichment.cells())
            .into_par_iter()
            .map(|cell| {
                let functions = enrichment.cell(cell);
                let mut positions = Vec::with_capacity(functions.len() * functions.len());
                for &column in functions {
                    let rows = pattern.column(column as usize);
                    for row in functions {
                        // Rows above the diagonal are absent and never asked for.
                        positions.push(rows.binary_search(row).unwrap_or_default() as u16);
                    }
                }
                positions
            })
            .collect();
        let mut start = vec![0];
        for list in &lists {
            start.push(start[start.len() - 1] + list.len());
        }
        Assembly {
            dim,
            enrichment,
            users,
            pattern: Arc::new(pattern),
            start,
            position: lists.concat(),
        }
    }

    /// The sum of cell matrices over their functions. Every column gathers its cells in ascending order.
    pub fn sum<'m>(&self, of_cell: impl Fn(usize) -> CellView<'m> + Sync) -> BlockMatrix {
        let dim = self.dim;
        let mut matrix = BlockMatrix::zeros(dim, self.pattern.clone());
        matrix.fill(|column, _, values| {
            for &cell in &self.users[column] {
                let cell = cell as usize;
                let functions = self.enrichment.cell(cell);
                let n = functions.len();
                let Some(l) = functions.iter().position(|&f| f as usize == column) else {
                    continue;
                };
                let positions = &self.position[self.start[cell] + l * n..][..n];
                let k = of_cell(cell);
                for (row, &function) in functions.iter().enumerate() {
                    if (function as usize) < column {
                        continue;
                    }
                    let block = &mut values[positions[row] as usize * dim * dim..][..dim * dim];
                    for a in 0..dim {
                        for b in 0..dim {
                            block[a * dim + b] += k[(l * dim + b, row * dim + a)];
                        }
                    }
                }
            }
        });
        matrix
    }
}

/// Nested dissection of the nodes, expanded to their unknowns with a number (`None`: prescribed).
pub fn elimination_order(
    mesh: &Mesh,
    enrichment: &Enrichment,
    numbers: &[Option<u32>],
) -> Vec<usize> {
    let dim = mesh.dim();
    let free = |node: usize| {
        let functions = std::iter::once(node).chain(enrichment.enriched_of(node));
        functions.flat_map(|f| (0..dim).filter_map(move |a| numbers[f * dim + a]))
    };
    let counted = |node: usize| free(node).count() as u32;
    let unknowns: Vec<u32> = (0..mesh.grid.len()).map(counted).collect();
    let nodes = nested_dissection(&mesh.grid, &unknowns);
    nodes
        .into_iter()
        .flat_map(|node| free(node).map(|n| n as usize))
        .collect()
}
