//! Plain loops over columns, with wide vectors where the machine has them: what is too small for blocks.

use std::ops::{Index, IndexMut};

use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

use crate::algebra::strips::WORTH_MOVING;

/// Runs loops with vectors of 256 bits where the machine has them. Products and sums stay operations of their own, in their order: the bits
/// are the same on every machine.
#[inline(always)]
pub(crate) fn wide<R>(act: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(act)
}

/// Numbers of a vector of 256 bits.
const LANES: usize = 4;

/// A matrix, column by column. Columns are followed by zeros up to a whole number of vectors: loops have no rest.
#[derive(Default, PartialEq)]
pub(crate) struct Full {
    rows: usize,
    columns: usize,
    stride: usize,
    values: Vec<f64>,
}

impl Full {
    /// Zeros to add to: written, since a page that is read before is given out twice.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self::of_columns(rows, columns, |_, column| column.fill(0.0))
    }

    /// What `write` makes of every column, of zeros.
    pub fn of_columns(
        rows: usize,
        columns: usize,
        write: impl Fn(usize, &mut [f64]) + Sync,
    ) -> Self {
        let mut full = Self::default();
        full.clear(rows, columns);
        full.for_columns(write);
        full
    }

    /// Zeros in place of what it holds, of which the system keeps no pages until they are written to.
    pub fn clear(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.stride = rows.next_multiple_of(LANES);
        let len = columns * self.stride;
        self.values.clear();
        if len <= self.values.capacity() {
            self.values.resize(len, 0.0);
        } else {
            // Freed before others are asked for.
            self.values = Vec::new();
            self.values = vec![0.0; len];
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// For blocked algorithms.
    pub fn view(&self) -> MatRef<'_, f64> {
        let (rows, columns, stride) = (self.rows, self.columns, self.stride);
        MatRef::from_column_major_slice_with_stride(&self.values, rows, columns, stride)
    }

    /// The same, to be changed.
    pub fn view_mut(&mut self) -> MatMut<'_, f64> {
        let (rows, columns, stride) = (self.rows, self.columns, self.stride);
        MatMut::from_column_major_slice_with_stride_mut(&mut self.values, rows, columns, stride)
    }

    /// Column `j`.
    pub fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.stride..][..self.rows]
    }

    /// The same, to be changed.
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.stride..][..self.rows]
    }

    /// Calls `act` with every column and its number, of a large matrix on several threads.
    pub fn for_columns(&mut self, act: impl Fn(usize, &mut [f64]) + Sync) {
        let (rows, stride) = (self.rows, self.stride.max(1));
        if self.values.len() > WORTH_MOVING {
            let columns = self.values.par_chunks_exact_mut(stride).enumerate();
            columns.for_each(|(j, column)| act(j, &mut column[..rows]));
        } else {
            let columns = self.values.chunks_exact_mut(stride).enumerate();
            columns.for_each(|(j, column)| act(j, &mut column[..rows]));
        }
    }
}

impl From<&Mat<f64>> for Full {
    fn from(a: &Mat<f64>) -> Self {
        Self::of_columns(a.nrows(), a.ncols(), |j, column| {
            column.copy_from_slice(a.col_as_slice(j));
        })
    }
}

impl Index<(usize, usize)> for Full {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.values[i + j * self.stride]
    }
}

impl IndexMut<(usize, usize)> for Full {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.values[i + j * self.stride]
    }
}

/// A := L and U with L U = P A, partial pivoting; row k of P A is row `rows[k]` of A. One column after the other, all later ones
/// updated at once. `multipliers`: room for a column of L, with zeros above, so that updates begin with a whole vector.
pub(crate) fn lu(a: &mut Full, rows: &mut Vec<usize>, multipliers: &mut Vec<f64>) {
    let (n, stride) = (a.rows, a.stride);
    rows.clear();
    rows.extend(0..n);
    multipliers.clear();
    multipliers.resize(stride, 0.0);
    wide(
        #[inline(always)]
        || {
            for k in 0..n {
                let (done, later) = a.values.split_at_mut((k + 1) * stride);
                let column = &mut done[k * stride..];
                let pivot = k + largest(&column[k..n]);
                if pivot != k {
                    rows.swap(k, pivot);
                    (done.chunks_exact_mut(stride)).for_each(|c| c.swap(k, pivot));
                    (later.chunks_exact_mut(stride)).for_each(|c| c.swap(k, pivot));
                }
                let column = &mut done[k * stride..];
                let divisor = if column[k] == 0.0 { 1.0 } else { column[k] };
                multipliers[k] = 0.0;
                for (x, l) in column[k + 1..].iter_mut().zip(&mut multipliers[k + 1..]) {
                    *x /= divisor;
                    *l = *x;
                }
                let begin = (k + 1) / LANES * LANES;
                let (below, _) = multipliers[begin..].as_chunks();
                let columns = later.chunks_exact_mut(stride);
                match below.len() {
                    0 => {}
                    1 => subtract::<1>(below, k, columns),
                    2 => subtract::<2>(below, k, columns),
                    3 => subtract::<3>(below, k, columns),
                    4 => subtract::<4>(below, k, columns),
                    5 => subtract::<5>(below, k, columns),
                    6 => subtract::<6>(below, k, columns),
                    _ => columns.for_each(|column| {
                        let (first, (own, _)) = (column[k], column[begin..].as_chunks_mut());
                        own.iter_mut()
                            .zip(below)
                            .for_each(|(x, l)| subtract_scaled(x, l, first));
                    }),
                }
            }
        },
    );
}

/// x −= l first.
#[inline(always)]
fn subtract_scaled(x: &mut [f64; LANES], l: &[f64; LANES], first: f64) {
    x.iter_mut().zip(l).for_each(|(x, l)| *x -= l * first);
}

/// Subtracts multiples of a column of L, their row k, from the last `N` vectors of columns; known at compilation, that loop costs
/// nothing and L stays in registers.
#[inline(always)]
fn subtract<'a, const N: usize>(
    l: &[[f64; LANES]],
    k: usize,
    columns: impl Iterator<Item = &'a mut [f64]>,
) {
    let l: [[f64; LANES]; N] = std::array::from_fn(|i| l[i]);
    for column in columns {
        let (first, (own, _)) = (column[k], column.as_chunks_mut());
        if let Some(own) = own.last_chunk_mut::<N>() {
            own.iter_mut()
                .zip(&l)
                .for_each(|(x, l)| subtract_scaled(x, l, first));
        }
    }
}

/// Where the first entry of largest magnitude stands; 0 if all are NaN.
#[inline(always)]
fn largest(x: &[f64]) -> usize {
    let grow = |most: &mut f64, x: &f64| *most = if x.abs() > *most { x.abs() } else { *most };
    let mut most = [0.0; LANES];
    let (vectors, rest) = x.as_chunks::<LANES>();
    for vector in vectors {
        most.iter_mut()
            .zip(vector)
            .for_each(|(most, x)| grow(most, x));
    }
    let mut all = 0.0;
    (rest.iter().chain(&most)).for_each(|x| grow(&mut all, x));
    x.iter().position(|x| x.abs() == all).unwrap_or(0)
}

/// x := U⁻¹ L⁻¹ x.
pub(crate) fn solve(factors: &Full, x: &mut [f64]) {
    let columns = || {
        factors
            .values
            .chunks_exact(factors.stride.max(1))
            .enumerate()
    };
    wide(
        #[inline(always)]
        || {
            for (k, l) in columns() {
                let (first, below) = (x[k], &mut x[k + 1..]);
                let pairs = below.iter_mut().zip(&l[k + 1..]);
                pairs.for_each(|(x, l)| *x -= l * first);
            }
            for (k, u) in columns().rev() {
                x[k] /= u[k];
                let (above, last) = x[..=k].split_at_mut(k);
                above.iter_mut().zip(u).for_each(|(x, u)| *x -= u * last[0]);
            }
        },
    );
}
