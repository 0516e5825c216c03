//! Dense kernels in strips that threads share. Strips are cut at the same places whatever the number of threads, so that
//! the bits are the same.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
};
use faer::reborrow::ReborrowMut;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns of a strip.
pub(crate) const STRIP: usize = 192;
/// Multiplications from which threads are worth it.
pub(crate) const WORTH_THREADS: f64 = 2e7;
/// Numbers from which moving them is.
pub(crate) const WORTH_MOVING: usize = 1 << 18;

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Failure {
    /// This column has no positive pivot.
    NotPositive(usize),
    OutOfMemory,
}

impl Failure {
    /// The same, columns counted from one that many columns earlier.
    pub fn behind(self, columns: usize) -> Self {
        match self {
            Self::NotPositive(column) => Self::NotPositive(columns + column),
            Self::OutOfMemory => Self::OutOfMemory,
        }
    }

    /// The one of two failures that is told, whichever came first: no memory, else the earlier column.
    pub fn or(self, other: Self) -> Self {
        match (self, other) {
            (Self::NotPositive(a), Self::NotPositive(b)) => Self::NotPositive(a.min(b)),
            _ => Self::OutOfMemory,
        }
    }
}

/// Calls `act` with all parts, on several threads if that is asked for.
pub(crate) fn for_all<T: Send>(parts: Vec<T>, threads: bool, act: impl Fn(T) + Sync + Send) {
    if threads && parts.len() > 1 {
        parts.into_par_iter().for_each(act);
    } else {
        parts.into_iter().for_each(act);
    }
}

/// Columns in strips of this width, each with its first column.
pub(crate) fn column_strips(mut a: MatMut<'_, f64>, most: usize) -> Vec<(usize, MatMut<'_, f64>)> {
    let (mut strips, mut begin) = (Vec::new(), 0);
    while a.ncols() > 0 {
        let width = a.ncols().min(most);
        let (strip, rest) = a.split_at_col_mut(width);
        strips.push((begin, strip));
        begin += width;
        a = rest;
    }
    strips
}

/// Rows in strips of this height, each with its first row.
pub(crate) fn row_strips(mut a: MatMut<'_, f64>, most: usize) -> Vec<(usize, MatMut<'_, f64>)> {
    let (mut strips, mut begin) = (Vec::new(), 0);
    while a.nrows() > 0 {
        let height = a.nrows().min(most);
        let (strip, rest) = a.split_at_row_mut(height);
        strips.push((begin, strip));
        begin += height;
        a = rest;
    }
    strips
}

/// A lower trapezoid, kept by strips of its columns one after the other: a strip has the rows from its first column on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trapezoid {
    pub columns: usize,
    /// Rows of the first column.
    pub height: usize,
}

impl Trapezoid {
    /// Entries on and below the diagonal.
    pub fn entries(self) -> usize {
        self.columns * self.height - self.columns * self.columns.saturating_sub(1) / 2
    }

    /// Numbers it takes: strips keep what stands above the diagonal in them.
    pub fn len(self) -> usize {
        let whole = self.columns / STRIP;
        self.begin(whole) + self.columns % STRIP * (self.height - whole * STRIP)
    }

    /// Where strip t begins.
    fn begin(self, t: usize) -> usize {
        STRIP * (t * self.height - STRIP * (t * t.saturating_sub(1) / 2))
    }

    /// Where rows j.. of column j stand.
    pub fn column(self, j: usize) -> Range<usize> {
        let (t, own) = (j / STRIP, j % STRIP);
        let height = self.height - t * STRIP;
        let begin = self.begin(t) + own * height;
        begin + own..begin + height
    }

    /// First column of every strip, and where it stands.
    fn places(self) -> impl Iterator<Item = (usize, Range<usize>)> {
        (0..self.columns).step_by(STRIP).map(move |first| {
            let size = STRIP.min(self.columns - first) * (self.height - first);
            let begin = self.begin(first / STRIP);
            (first, begin..begin + size)
        })
    }

    /// The strips, each with its first column.
    pub fn strips(self, values: &[f64]) -> impl Iterator<Item = (usize, MatRef<'_, f64>)> {
        self.places().map(move |(first, own)| {
            let height = self.height - first;
            let own = &values[own];
            let strip = MatRef::from_column_major_slice(own, height, own.len() / height);
            (first, strip)
        })
    }

    /// The strips.
    pub fn strips_mut(self, values: &mut [f64]) -> Vec<MatMut<'_, f64>> {
        let mut rest = values;
        let strip = |(first, own): (usize, Range<usize>)| {
            let (strip, others) = std::mem::take(&mut rest).split_at_mut(own.len());
            rest = others;
            let height = self.height - first;
            MatMut::from_column_major_slice_mut(strip, height, own.len() / height)
        };
        self.places().map(strip).collect()
    }
}

/// A −= X Xᵀ, lower triangle, for the leading columns of A and all rows of X.
pub(crate) fn subtract_square(a: MatMut<'_, f64>, x: MatRef<'_, f64>) {
    let (width, full) = (a.ncols(), BlockStructure::Rectangular);
    let (top, low) = a.split_at_row_mut(width);
    let (own, far) = x.split_at_row(width);
    let (lower, right) = (BlockStructure::TriangularLower, own.transpose());
    triangular::matmul(
        top,
        lower,
        Accum::Add,
        own,
        full,
        right,
        full,
        -1.0,
        Par::Seq,
    );
    if far.nrows() > 0 {
        matmul(low, Accum::Add, far, right, -1.0, Par::Seq);
    }
}

/// L with L Lᵀ = A, of which the lower triangle counts.
pub(crate) fn cholesky(a: MatMut<'_, f64>) -> Result<(), Failure> {
    let strips = column_strips(a, STRIP).into_iter();
    let strips = strips.map(|(begin, strip)| strip.split_at_row_mut(begin).1);
    cholesky_of_strips(strips.collect())
}

/// Columns of L with L Lᵀ = A on the rows and columns of a trapezoid, and on the rows below. A strip of columns at a time,
/// the later ones updated at once.
pub(crate) fn cholesky_of_strips(mut strips: Vec<MatMut<'_, f64>>) -> Result<(), Failure> {
    let columns: usize = strips.iter().map(|s| s.ncols()).sum();
    let height = strips.first().map_or(0, |s| s.nrows());
    let threads = (height * height * columns) as f64 > WORTH_THREADS;
    for t in 0..strips.len() {
        let (done, later) = strips.split_at_mut(t + 1);
        let Some(block) = done.last_mut() else {
            continue;
        };
        let width = block.ncols();
        let (mut top, mut below) = block.rb_mut().split_at_row_mut(width);
        cholesky_of_block(top.rb_mut()).map_err(|failure| failure.behind(t * STRIP))?;
        let top = top.as_ref();
        for_all(
            row_strips(below.rb_mut(), 2 * STRIP),
            threads,
            |(_, part)| {
                solve_lower_triangular_in_place(top, part.transpose_mut(), Par::Seq);
            },
        );
        let below = below.as_ref();
        let later = later.iter_mut().map(|strip| strip.rb_mut()).collect();
        for_all(later, threads, |strip: MatMut<'_, f64>| {
            let own = below.subrows(below.nrows() - strip.nrows(), strip.nrows());
            subtract_square(strip, own);
        });
    }
    Ok(())
}

fn cholesky_of_block(a: MatMut<'_, f64>) -> Result<(), Failure> {
    let scratch = cholesky_in_place_scratch::<f64>(a.nrows(), Par::Seq, Default::default());
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| Failure::OutOfMemory)?;
    let stack = MemStack::new(&mut memory);
    match cholesky_in_place(a, Default::default(), Par::Seq, stack, Default::default()) {
        Ok(_) => Ok(()),
        Err(LltError::NonPositivePivot { index }) => Err(Failure::NotPositive(index)),
    }
}

/// A := L and U with L U = P A, partial pivoting; row k of P A is row `rows[k]` of A.
pub(crate) fn lu(mut a: MatMut<'_, f64>) -> Vec<usize> {
    let n = a.nrows();
    let threads = (n * n) as f64 * n as f64 > WORTH_THREADS;
    let mut rows: Vec<usize> = (0..n).collect();
    let (mut to, mut from) = (vec![0usize; n], vec![0usize; n]);
    for k in (0..n).step_by(STRIP) {
        let width = STRIP.min(n - k);
        let (done, later) = a.rb_mut().split_at_col_mut(k + width);
        let (earlier, block) = done.split_at_col_mut(k);
        let mut block = block.split_at_row_mut(k).1;
        let (to, from) = (&mut to[..n - k], &mut from[..n - k]);
        let scratch = lu_in_place_scratch::<usize, f64>(n - k, width, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut memory);
        lu_in_place(
            block.rb_mut(),
            to,
            from,
            Par::Seq,
            stack,
            Default::default(),
        );
        let order: &[usize] = to;
        let block = block.as_ref();
        let moved: Vec<usize> = order.iter().map(|&i| rows[k + i]).collect();
        rows[k..].copy_from_slice(&moved);
        for_all(
            column_strips(earlier.split_at_row_mut(k).1, STRIP),
            threads,
            |(_, strip)| {
                permute_rows(strip, order);
            },
        );
        for_all(
            column_strips(later.split_at_row_mut(k).1, STRIP),
            threads,
            |(_, mut strip)| {
                permute_rows(strip.rb_mut(), order);
                let (mut top, low) = strip.split_at_row_mut(width);
                solve_unit_lower_triangular_in_place(
                    block.subrows(0, width),
                    top.rb_mut(),
                    Par::Seq,
                );
                let below = block.subrows(width, n - k - width);
                matmul(low, Accum::Add, below, top.as_ref(), -1.0, Par::Seq);
            },
        );
    }
    rows
}

/// Row i := row `order[i]`.
pub(crate) fn permute_rows(mut a: MatMut<'_, f64>, order: &[usize]) {
    // Pivoting moves few of many rows.
    let moved = order
        .iter()
        .copied()
        .enumerate()
        .filter(|(i, from)| i != from);
    let moved: Vec<(usize, usize)> = moved.collect();
    let mut column = vec![0.0; moved.len()];
    for j in 0..a.ncols() {
        let mut a = a.rb_mut().col_mut(j);
        (column.iter_mut().zip(&moved)).for_each(|(to, &(_, from))| *to = a[from]);
        (column.iter().zip(&moved)).for_each(|(value, &(i, _))| a[i] = *value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    fn matrix(n: usize) -> Mat<f64> {
        Mat::from_fn(n, n, |i, j| {
            (12.9 * (i + 1) as f64 + 78.2 * ((i * j) as f64).sqrt()).sin()
        })
    }

    /// Source: P A = L U itself. Tolerance: rounding, times the size.
    #[test]
    fn the_factors_multiply_to_the_matrix_with_its_rows_exchanged() {
        for n in [1, 5, STRIP, 3 * STRIP + 17] {
            let a = matrix(n);
            let mut factors = a.clone();
            let rows = lu(factors.as_mut());
            let (mut l, mut u) = (factors.clone(), factors);
            for j in 0..n {
                for i in 0..n {
                    match i.cmp(&j) {
                        std::cmp::Ordering::Less => l[(i, j)] = 0.0,
                        std::cmp::Ordering::Equal => l[(i, j)] = 1.0,
                        std::cmp::Ordering::Greater => u[(i, j)] = 0.0,
                    }
                    assert!(l[(i, j)].abs() <= 1.0, "a pivot is not the largest");
                }
            }
            let product = &l * &u;
            for j in 0..n {
                for i in 0..n {
                    let error = (product[(i, j)] - a[(rows[i], j)]).abs();
                    assert!(error < 1e-14 * n as f64, "{n}: {i} {j} {error}");
                }
            }
        }
    }

    /// Goal: around whole strips, columns stand one after the other, and their diagonal where the strip says.
    #[test]
    fn columns_of_a_trapezoid_tile_its_strips() {
        let columns = [1, STRIP - 1, STRIP, STRIP + 1, 2 * STRIP, 2 * STRIP + 1];
        for (columns, more) in columns
            .into_iter()
            .flat_map(|c| [0, 1, STRIP].map(|m| (c, m)))
        {
            let height = columns + more;
            let shape = Trapezoid { columns, height };
            let values: Vec<f64> = (0..shape.len()).map(|k| k as f64).collect();
            for (first, strip) in shape.strips(&values) {
                for k in 0..strip.ncols() {
                    let own = shape.column(first + k);
                    assert_eq!(own.len(), height - first - k);
                    assert_eq!(strip[(k, k)], values[own.start]);
                }
            }
            assert_eq!(shape.column(columns - 1).end, shape.len());
        }
    }

    #[test]
    fn one_thread_and_three_give_the_same_bits() {
        let n = 3 * STRIP + 40;
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let a = matrix(n);
                let mut square = &a * a.transpose();
                (0..n).for_each(|k| square[(k, k)] += 1.0);
                cholesky(square.as_mut()).unwrap();
                let mut general = a;
                let rows = lu(general.as_mut());
                (square, general, rows)
            })
        };
        assert!(run(1) == run(3));
    }
}
