//! Symmetric sparse matrix of dim × dim blocks on a precomputed pattern.
//!
//! Rows and columns belong to scalar functions with vector unknowns; all unknowns are kept, prescribed ones too, so
//! that reactions are products with kept rows. The lower triangle is stored by block columns, the diagonal block first.

use rayon::prelude::*;

/// Symmetric block matrix, lower triangle [N/m].
#[derive(Debug, Clone)]
pub struct BlockMatrix {
    dim: usize,
    /// Start of every block column, `functions + 1` entries.
    col_ptr: Vec<usize>,
    /// Block rows, ascending in each column, first the column itself.
    rows: Vec<u32>,
    /// dim² entries per block, row by row.
    values: Vec<f64>,
}

impl BlockMatrix {
    /// Zero matrix on the pattern of the cells' function lists.
    ///
    /// `users[c]` are the cells that carry function c; `functions(cell)` lists a cell's functions.
    pub fn pattern<'a>(
        dim: usize,
        users: &[Vec<u32>],
        functions: impl Fn(usize) -> &'a [u32] + Sync,
    ) -> Self {
        let columns: Vec<Vec<u32>> = users
            .par_iter()
            .enumerate()
            .map(|(c, cells)| {
                let mut rows: Vec<u32> = vec![c as u32];
                for &cell in cells {
                    rows.extend(functions(cell as usize).iter().filter(|&&r| r as usize > c));
                }
                rows.sort_unstable();
                rows.dedup();
                rows
            })
            .collect();
        let mut col_ptr = vec![0];
        let mut total = 0;
        for column in &columns {
            total += column.len();
            col_ptr.push(total);
        }
        BlockMatrix {
            dim,
            col_ptr,
            rows: columns.concat(),
            values: vec![0.0; total * dim * dim],
        }
    }

    /// Block size.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of block columns.
    pub fn functions(&self) -> usize {
        self.col_ptr.len() - 1
    }

    /// Block rows of a column.
    pub fn column_rows(&self, column: usize) -> &[u32] {
        &self.rows[self.col_ptr[column]..self.col_ptr[column + 1]]
    }

    /// Diagonal entries over all unknowns.
    pub fn diagonal(&self) -> Vec<f64> {
        let d = self.dim;
        let of_column = |c: usize| {
            let block = &self.values[self.col_ptr[c] * d * d..][..d * d];
            (0..d).map(|a| block[a * d + a]).collect::<Vec<f64>>()
        };
        (0..self.functions()).flat_map(of_column).collect()
    }

    /// Fills every column independently: `fill(column, rows, values)` gets zeroed blocks.
    ///
    /// Each entry is summed by one thread in the order of its cells, so the bits do not depend on the thread count.
    pub fn fill(&mut self, fill: impl Fn(usize, &[u32], &mut [f64]) + Sync) {
        let block = self.dim * self.dim;
        let mut slices = Vec::with_capacity(self.functions());
        let mut rest = self.values.as_mut_slice();
        for window in self.col_ptr.windows(2) {
            let (column, tail) = rest.split_at_mut((window[1] - window[0]) * block);
            slices.push(column);
            rest = tail;
        }
        let (col_ptr, rows) = (&self.col_ptr, &self.rows);
        slices
            .into_par_iter()
            .with_min_len(64)
            .enumerate()
            .for_each(|(c, values)| {
                values.fill(0.0);
                fill(c, &rows[col_ptr[c]..col_ptr[c + 1]], values);
            });
    }

    /// y = A x over all unknowns (function-major, `dim` entries each).
    pub fn mul(&self, x: &[f64]) -> Vec<f64> {
        let d = self.dim;
        let mut y = vec![0.0; x.len()];
        for c in 0..self.functions() {
            let range = self.col_ptr[c]..self.col_ptr[c + 1];
            for (&r, block) in self.rows[range.clone()]
                .iter()
                .zip(self.values[range.start * d * d..range.end * d * d].chunks_exact(d * d))
            {
                let r = r as usize;
                for a in 0..d {
                    for b in 0..d {
                        let k = block[a * d + b];
                        y[r * d + a] += k * x[c * d + b];
                        if r != c {
                            y[c * d + b] += k * x[r * d + a];
                        }
                    }
                }
            }
        }
        y
    }

    /// Lower triangle over the unknowns with a number (`numbers[i] = None`: prescribed), compressed columns.
    ///
    /// Numbers must ascend with the unknowns. Returns (column pointers, row indices, values).
    pub fn restrict(&self, numbers: &[Option<u32>]) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let d = self.dim;
        let mut col_ptr = vec![0];
        let mut row_idx = Vec::with_capacity(self.values.len());
        let mut values = Vec::with_capacity(self.values.len());
        for c in 0..self.functions() {
            let range = self.col_ptr[c]..self.col_ptr[c + 1];
            for b in 0..d {
                if numbers[c * d + b].is_none() {
                    continue;
                }
                for position in range.clone() {
                    let r = self.rows[position] as usize;
                    let first = if r == c { b } else { 0 };
                    for a in first..d {
                        if let Some(row) = numbers[r * d + a] {
                            row_idx.push(row as usize);
                            values.push(self.values[(position * d + a) * d + b]);
                        }
                    }
                }
                col_ptr.push(row_idx.len());
            }
        }
        (col_ptr, row_idx, values)
    }
}
