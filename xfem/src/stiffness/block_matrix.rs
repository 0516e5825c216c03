//! Symmetric sparse matrix of dim × dim blocks on a precomputed pattern.
//!
//! Rows and columns belong to scalar functions with vector unknowns; all unknowns are kept, prescribed ones too, so
//! that reactions are products with kept rows. The lower triangle is stored by block columns, the diagonal block first.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

/// Where blocks stand: shared by all matrices of a body.
#[derive(Debug)]
pub struct BlockPattern {
    /// Start of every block column, `functions + 1` entries.
    col_ptr: Vec<usize>,
    /// Block rows, ascending in each column, first the column itself.
    rows: Vec<u32>,
}

/// Symmetric block matrix, lower triangle [N/m].
#[derive(Debug, Clone)]
pub struct BlockMatrix {
    dim: usize,
    pattern: Arc<BlockPattern>,
    /// dim² entries per block, row by row.
    values: Vec<f64>,
}

impl BlockPattern {
    /// Pattern of the cells' function lists.
    ///
    /// `users[c]` are the cells that carry function c; `functions(cell)` lists a cell's functions.
    pub fn new<'a>(users: &[Vec<u32>], functions: impl Fn(usize) -> &'a [u32] + Sync) -> Self {
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
        BlockPattern {
            col_ptr,
            rows: columns.concat(),
        }
    }

    /// Block rows of a column.
    pub fn column(&self, column: usize) -> &[u32] {
        &self.rows[self.range(column)]
    }

    /// Places of a column's blocks among all.
    fn range(&self, column: usize) -> Range<usize> {
        self.col_ptr[column]..self.col_ptr[column + 1]
    }
}

impl BlockMatrix {
    /// Zero matrix.
    pub fn zeros(dim: usize, pattern: Arc<BlockPattern>) -> Self {
        BlockMatrix {
            dim,
            values: vec![0.0; pattern.rows.len() * dim * dim],
            pattern,
        }
    }

    /// Block size.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of block columns.
    pub fn functions(&self) -> usize {
        self.pattern.col_ptr.len() - 1
    }

    /// Block rows of a column and their blocks, dim² entries each.
    fn column(&self, column: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let (block, range) = (self.dim * self.dim, self.pattern.range(column));
        let values = &self.values[range.start * block..range.end * block];
        let rows = self.pattern.rows[range].iter().map(|&row| row as usize);
        rows.zip(values.chunks_exact(block))
    }

    /// Diagonal entries over all unknowns.
    pub fn diagonal(&self) -> Vec<f64> {
        let unknowns = 0..self.functions() * self.dim;
        unknowns.map(|i| self.diagonal_at(i)).collect()
    }

    /// Diagonal entry of an unknown.
    pub fn diagonal_at(&self, unknown: usize) -> f64 {
        let (d, a) = (self.dim, unknown % self.dim);
        self.values[self.pattern.col_ptr[unknown / d] * d * d + a * d + a]
    }

    /// Fills every column independently: `fill(column, rows, values)` gets zeroed blocks.
    ///
    /// Each entry is summed by one thread in the order of its cells, so the bits do not depend on the thread count.
    pub fn fill(&mut self, fill: impl Fn(usize, &[u32], &mut [f64]) + Sync) {
        let block = self.dim * self.dim;
        let mut slices = Vec::with_capacity(self.functions());
        let mut rest = self.values.as_mut_slice();
        for window in self.pattern.col_ptr.windows(2) {
            let (column, tail) = rest.split_at_mut((window[1] - window[0]) * block);
            slices.push(column);
            rest = tail;
        }
        let pattern = &self.pattern;
        slices
            .into_par_iter()
            .with_min_len(64)
            .enumerate()
            .for_each(|(c, values)| {
                values.fill(0.0);
                fill(c, pattern.column(c), values);
            });
    }

    /// y = A x over all unknowns (function-major, `dim` entries each).
    pub fn mul(&self, x: &[f64]) -> Vec<f64> {
        self.mul_at(0..self.functions(), |_| true, x)
    }

    /// Rows of A x that belong to wanted functions; the others are 0. `columns`: all that share a cell with a wanted function.
    pub fn mul_at(
        &self,
        columns: impl IntoIterator<Item = usize>,
        wanted: impl Fn(usize) -> bool,
        x: &[f64],
    ) -> Vec<f64> {
        let d = self.dim;
        let mut y = vec![0.0; x.len()];
        for c in columns {
            let column = wanted(c);
            for (r, block) in self.column(c) {
                let row = wanted(r);
                if !(row || column) {
                    continue;
                }
                for a in 0..d {
                    for b in 0..d {
                        let k = block[a * d + b];
                        if row {
                            y[r * d + a] += k * x[c * d + b];
                        }
                        if r != c && column {
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
            for b in 0..d {
                if numbers[c * d + b].is_none() {
                    continue;
                }
                for (r, block) in self.column(c) {
                    let first = if r == c { b } else { 0 };
                    for a in first..d {
                        if let Some(row) = numbers[r * d + a] {
                            row_idx.push(row as usize);
                            values.push(block[a * d + b]);
                        }
                    }
                }
                col_ptr.push(row_idx.len());
            }
        }
        (col_ptr, row_idx, values)
    }
}
