//! Assembly: element matrices into the block matrix, identical bits for any number of threads.

use rayon::prelude::*;

use super::block_matrix::BlockMatrix;
use super::elasticity::CellMatrix;

/// The cells of a body as assembly sees them.
pub trait Cells: Sync {
    /// Functions of a cell.
    fn functions(&self, cell: usize) -> &[u32];
    /// Cells that carry a function, ascending.
    fn users(&self, function: usize) -> &[u32];
    /// Matrix of a cell over its functions, row by row; cells of one shape return the same matrix.
    fn matrix(&self, cell: usize) -> &CellMatrix;
}

/// Positions of the blocks of every cell inside the columns of the matrix: computed once per mesh.
#[derive(Debug, Clone)]
pub struct Scatter {
    start: Vec<usize>,
    /// For cell-local functions (l, k), l the column: position of row k in column l; unused above the diagonal.
    position: Vec<u16>,
}

impl Scatter {
    /// Finds the position of every cell block.
    pub fn new(matrix: &BlockMatrix, cells: &impl Cells, count: usize) -> Self {
        let lists: Vec<Vec<u16>> = (0..count)
            .into_par_iter()
            .map(|cell| {
                let functions = cells.functions(cell);
                let mut positions = Vec::with_capacity(functions.len() * functions.len());
                for &column in functions {
                    let rows = matrix.column_rows(column as usize);
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
        Scatter {
            start,
            position: lists.concat(),
        }
    }

    /// Sums the cell matrices into the matrix. Every column gathers its cells in ascending order.
    pub fn assemble(&self, matrix: &mut BlockMatrix, cells: &impl Cells) {
        let dim = matrix.dim();
        matrix.fill(|column, _, values| {
            for &cell in cells.users(column) {
                let cell = cell as usize;
                let functions = cells.functions(cell);
                let n = functions.len();
                let Some(l) = functions.iter().position(|&f| f as usize == column) else {
                    continue;
                };
                let positions = &self.position[self.start[cell] + l * n..][..n];
                let k = cells.matrix(cell);
                for (row, &function) in functions.iter().enumerate() {
                    if (function as usize) < column {
                        continue;
                    }
                    let block = &mut values[positions[row] as usize * dim * dim..][..dim * dim];
                    for a in 0..dim {
                        for b in 0..dim {
                            block[a * dim + b] += k.get(row * dim + a, l * dim + b);
                        }
                    }
                }
            }
        });
    }
}
