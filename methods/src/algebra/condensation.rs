//! How the Delassus operator W = B K⁻¹ Bᵀ follows from the factor of K.
//!
//! With D K D = L Lᵀ and the contact unknowns C eliminated last,
//! ```text
//! W = Yᵀ Y,   L_cc Y = (D B_c)ᵀ.
//! ```
//! Where they are not last, L Y = (D B)ᵀ is solved along the tree of the factor, and so it is for the rows of a traction
//! operator, which reach beyond the contact unknowns.
//!
//! A floating body has a generalised inverse G for K⁻¹, and balanced rows: those of B P (`floating::Balance`).
//!
//! Row i of B touches few unknowns, so column i of Y is zero above the first of them. Columns are therefore sorted by
//! their first non-zero and both the triangular solve and the product skip the leading zeros.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::ReborrowMut;
use faer::{Accum, Mat, MatMut, Par};
use rayon::prelude::*;

use crate::algebra::delassus::check_rows;
use crate::algebra::factor::{Columns, Factor};
use crate::algebra::matrix::JumpOperator;
use crate::algebra::strips::{
    STRIP, WORTH_THREADS, column_strips, for_all, permute_rows, row_strips,
};
use crate::error::MethodError;

/// W and its diagonal.
pub(crate) type Condensed = (Mat<f64>, Vec<f64>);

/// W for the listed rows of B, full (both triangles), exactly symmetric, and the squared columns of Y: the diagonal of W
/// as [`diagonal`] gives it.
pub(crate) fn condense(
    factor: &Factor,
    jump: &JumpOperator,
    rows: &[usize],
) -> Result<Condensed, MethodError> {
    check_rows(rows.len())?;
    let half = Half::new(factor, jump, rows);
    let (mut w, squares) = if factor.contact_last() {
        half.square()
    } else {
        factor.condense(&half.entries, true)
    };
    // Back to the order of `rows`; each pair is read from one triangle, so the result is symmetric to the bit.
    mirror_upper(&mut w);
    let mut position = vec![0; rows.len()];
    for (s, &i) in half.sorted.iter().enumerate() {
        position[i] = s;
    }
    permute(&mut w, &position);
    Ok((w, half.unsorted(&squares)))
}

/// The diagonal of W for the listed rows of B, strips of Y in memory only.
pub(crate) fn diagonal(factor: &Factor, jump: &JumpOperator, rows: &[usize]) -> Vec<f64> {
    let half = Half::new(factor, jump, rows);
    if !factor.contact_last() {
        return half.unsorted(&factor.condense(&half.entries, false).1);
    }
    let strips = half.strips().map(|begin| half.solve(begin).1);
    half.unsorted(&strips.collect::<Vec<_>>().concat())
}

/// The traction operator S condensed to some rows: T and X.
pub(crate) struct Tractions {
    /// S K⁻¹ Sᵀ, symmetric positive semi-definite, in N/m.
    pub t: Mat<f64>,
    /// B K⁻¹ Sᵀ, dimensionless.
    pub x: Mat<f64>,
}

impl Tractions {
    /// For the listed rows of S and B.
    pub fn new(
        factor: &Factor,
        s: &JumpOperator,
        b: &JumpOperator,
        rows: &[usize],
    ) -> Result<Self, MethodError> {
        check_rows(rows.len())?;
        let m = rows.len();
        let both = [b, s].map(|operator| columns(factor, operator, rows, 0));
        let (square, _) = factor.condense(&both.concat(), true);
        let x = square.as_ref().submatrix(0, m, m, m).to_owned();
        let mut t = square.as_ref().submatrix(m, m, m, m).to_owned();
        mirror_upper(&mut t);
        Ok(Self { t, x })
    }
}

/// Lower triangle := upper triangle.
fn mirror_upper(a: &mut Mat<f64>) {
    /// Square blocks that fit a cache.
    const BLOCK: usize = 32;
    let n = a.nrows();
    for column in (0..n).step_by(BLOCK) {
        for row in (column..n).step_by(BLOCK) {
            for j in column..(column + BLOCK).min(n) {
                for i in row.max(j + 1)..(row + BLOCK).min(n) {
                    a[(i, j)] = a[(j, i)];
                }
            }
        }
    }
}

/// Row and column k := row and column `position[k]`.
fn permute(a: &mut Mat<f64>, position: &[usize]) {
    let threads = a.nrows() > STRIP;
    for_all(column_strips(a.as_mut(), STRIP), threads, |(_, strip)| {
        permute_rows(strip, position);
    });
    let mut done = vec![false; position.len()];
    let mut next = vec![0.0; position.len()];
    for start in 0..position.len() {
        if done[start] {
            continue;
        }
        // Along a cycle; its first column is the last to be read.
        let first = a.col_as_slice(start).to_vec();
        let mut column = start;
        while !done[column] {
            done[column] = true;
            match position[column] {
                from if from == start => next.copy_from_slice(&first),
                from => next.copy_from_slice(a.col_as_slice(from)),
            }
            a.col_as_slice_mut(column).copy_from_slice(&next);
            column = position[column];
        }
    }
}

/// (D B)ᵀ for the listed rows of B: positions in L, counted from `begin`, and values.
fn columns(
    factor: &Factor,
    jump: &JumpOperator,
    rows: &[usize],
    begin: usize,
) -> Vec<Vec<(usize, f64)>> {
    let mut pinned = vec![false; factor.scale.len()];
    factor.pins.iter().for_each(|&pin| pinned[pin] = true);
    // Pinned unknowns take no part of balanced forces.
    let column = |&i: &usize| -> Vec<(usize, f64)> {
        let row: Vec<(usize, f64)> = jump.row(i).filter(|e| e.1 != 0.0).collect();
        let own = row.iter().map(|&(j, b)| (j, b * factor.scale[j]));
        own.chain(factor.balance.completion(&row))
            .filter(|&(j, _)| !pinned[j])
            .map(|(j, value)| (factor.ordering.inverse[j] - begin, value))
            .collect()
    };
    rows.iter().map(column).collect()
}

/// Columns of Y from their first row that is not zero on.
struct Strip {
    top: usize,
    y: Mat<f64>,
}

/// Y with columns sorted by first non-zero, solved for strip by strip.
struct Half<'a> {
    factor: &'a Factor,
    /// Entries of (D B)ᵀ by sorted column: position in L, counted from the contact unknowns where these come last; value.
    entries: Vec<Vec<(usize, f64)>>,
    /// Rows of Y.
    height: usize,
    /// First non-zero of each sorted column.
    first: Vec<usize>,
    /// Original column of each sorted one.
    sorted: Vec<usize>,
}

impl<'a> Half<'a> {
    fn new(factor: &'a Factor, jump: &JumpOperator, rows: &[usize]) -> Self {
        let begin = if factor.contact_last() {
            factor.ordering.contact_begin
        } else {
            0
        };
        let height = factor.scale.len() - begin;
        let unsorted = columns(factor, jump, rows, begin);
        let first_of = |k: usize| unsorted[k].iter().map(|e| e.0).min().unwrap_or(height);
        let mut sorted: Vec<usize> = (0..rows.len()).collect();
        sorted.sort_by_key(|&k| (first_of(k), k));
        Self {
            factor,
            height,
            first: sorted.iter().map(|&k| first_of(k)).collect(),
            entries: sorted.iter().map(|&k| unsorted[k].clone()).collect(),
            sorted,
        }
    }

    /// Yᵀ Y, of which the upper triangle counts, and |y_k|².
    fn square(&self) -> Condensed {
        let (m, solved) = (
            self.sorted.len(),
            self.strips().map(|begin| self.solve(begin)),
        );
        let (mut y, squares): (Vec<Strip>, Vec<Vec<f64>>) = solved.unzip();
        let mut w = Mat::<f64>::zeros(m, m);
        let mut rest = w.as_mut();
        // The last columns of Y are done with first: they go while W grows.
        while let Some(last) = y.pop() {
            let begin = y.len() * STRIP;
            let (others, own) = rest.split_at_col_mut(begin);
            rest = others;
            let end = m.min(begin + STRIP);
            let threads = (last.y.nrows() * end) as f64 * (end - begin) as f64 > WORTH_THREADS;
            let parts = row_strips(own.subrows_mut(0, end), STRIP);
            for_all(parts, threads, |(row, part)| {
                let other = y.get(row / STRIP).unwrap_or(&last);
                let other = other.y.subrows(last.top - other.top, last.y.nrows());
                matmul(
                    part,
                    Accum::Replace,
                    other.transpose(),
                    &last.y,
                    1.0,
                    Par::Seq,
                );
            });
        }
        (w, squares.concat())
    }

    /// First columns of strips of Y.
    fn strips(&self) -> impl IndexedParallelIterator<Item = usize> + '_ {
        (0..self.sorted.len()).into_par_iter().step_by(STRIP)
    }

    /// The sorted columns of Y from `begin` on, and their |y_k|².
    fn solve(&self, begin: usize) -> (Strip, Vec<f64>) {
        let end = self.sorted.len().min(begin + STRIP);
        let first = &self.first[begin..end];
        let blocks = self.factor.of_contact().map(|block| block.begin);
        let top = blocks.take_while(|&row| row <= first[0]).last();
        let top = top.unwrap_or(0);
        let mut y = Mat::<f64>::zeros(self.height - top, end - begin);
        for (k, entries) in self.entries[begin..end].iter().enumerate() {
            (entries.iter()).for_each(|&(row, value)| y[(row - top, k)] += value);
        }
        forward_solve(self.factor, y.as_mut(), top, first);
        let square = |(k, &first): (usize, &usize)| -> f64 {
            y.col_as_slice(k)[first - top..].iter().map(|y| y * y).sum()
        };
        let squares = first.iter().enumerate().map(square).collect();
        (Strip { top, y }, squares)
    }

    /// In the order of the rows.
    fn unsorted(&self, values: &[f64]) -> Vec<f64> {
        let mut own = vec![0.0; values.len()];
        (self.sorted.iter().zip(values)).for_each(|(&k, &value)| own[k] = value);
        own
    }
}

/// y <- L_cc⁻¹ y, a strip of L after the other, y from row `from` on; column j is zero above `first[j]` (increasing in j).
fn forward_solve(factor: &Factor, mut y: MatMut<'_, f64>, from: usize, first: &[usize]) {
    for Columns {
        begin,
        block,
        below: pattern,
    } in factor.of_contact()
    {
        let own = block.ncols();
        let columns = first.partition_point(|&f| f < begin + own);
        if columns == 0 {
            continue;
        }
        let begin = begin - from;
        let (top, rest) = (y.rb_mut().subcols_mut(0, columns)).split_at_row_mut(begin + own);
        let mut top = top.subrows_mut(begin, own);
        let (triangle, low) = block.split_at_row(own);
        solve_lower_triangular_in_place(triangle, top.rb_mut(), Par::Seq);
        let (near, low) = low.split_at_row(low.nrows() - pattern.len());
        let (below, mut far) = rest.split_at_row_mut(near.nrows());
        matmul(below, Accum::Add, near, top.as_ref(), -1.0, Par::Seq);
        if !pattern.is_empty() {
            let mut update = Mat::<f64>::zeros(pattern.len(), columns);
            matmul(
                update.as_mut(),
                Accum::Replace,
                low,
                top.as_ref(),
                1.0,
                Par::Seq,
            );
            let before = factor.ordering.contact_begin + from + begin + own + near.nrows();
            for j in 0..columns {
                for (k, &i) in pattern.iter().enumerate() {
                    far[(i as usize - before, j)] -= update[(k, j)];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::delassus::MAX_CONDENSED_ROWS;
    use crate::algebra::matrix::SquareMatrix;
    use crate::contract::elastic::{Elastic, ElasticParts};

    /// Two separate strips of `long` × 3 nodes with springs to all neighbours; contact couples unknowns of each strip
    /// with itself only, so the trailing block has several supernodes.
    fn strips(long: usize, order: impl Fn(usize) -> usize) -> ElasticParts {
        let n = 2 * long * 3;
        let (mut col_ptr, mut row_idx, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n {
            row_idx.push(j);
            values.push(4.0 + (j % 7) as f64 / 10.0);
            for (step, ok) in [(1, j % 3 < 2), (3, j % (3 * long) + 3 < 3 * long)] {
                if ok {
                    row_idx.push(j + step);
                    values.push(-1.0);
                }
            }
            col_ptr.push(row_idx.len());
        }
        let rows = n / 3;
        let col_idx: Vec<usize> = (0..rows).flat_map(|i| [3 * i, (3 * i + 3) % n]).collect();
        let entries: Vec<f64> = (0..rows)
            .flat_map(|i| [1.0, -0.5 - (i % 3) as f64])
            .collect();
        ElasticParts {
            dim: 2,
            stiffness: SquareMatrix::symmetric(n, col_ptr, row_idx, values).unwrap(),
            jump: JumpOperator::new(
                rows,
                n,
                (0..=rows).map(|i| 2 * i).collect(),
                col_idx,
                entries,
            )
            .unwrap(),
            weight: vec![1.0; rows / 2],
            order: (0..n).map(order).collect(),
            free_order: Vec::new(),
            floating: Vec::new(),
            frictionless: vec![],
            traction: None,
        }
    }

    #[test]
    fn condensed_operator_equals_full_solves_in_every_elimination_order() {
        let long = 90;
        let n = 6 * long;
        for stride in [1, 7, 77] {
            let body = Elastic::new(strips(long, |k| k * stride % n)).unwrap();
            let rows = body.rows();
            // Before W is formed, so that neither borrows from the other.
            let diagonal = body.diagonal(&rows).unwrap();
            assert_eq!(body.counters().condensations, 0);
            let (w, mut work) = (body.formed().unwrap(), Vec::new());
            assert_eq!(body.counters().condensations, 1);
            for j in (0..rows.len()).step_by(17) {
                let mut unit = vec![0.0; rows.len()];
                unit[j] = 1.0;
                let mut product = vec![0.0; rows.len()];
                body.product_add(&rows, &unit, &mut product);
                let column = w.column(j, &mut work);
                for i in 0..rows.len() {
                    assert!((column[i] - product[i]).abs() < 1e-13, "{stride}: {i} {j}");
                    assert_eq!(column[i], w.column(i, &mut Vec::new())[j]);
                }
                assert!((diagonal[j] - column[j]).abs() < 1e-15, "{stride}: {j}");
            }
            // The same bits from a body whose W was formed first.
            let other = Elastic::new(strips(long, |k| k * stride % n)).unwrap();
            other.formed().unwrap();
            assert_eq!(other.diagonal(&rows).unwrap(), diagonal);
        }
    }

    #[test]
    fn too_many_rows_are_refused_before_memory_is_asked_for() {
        let n = MAX_CONDENSED_ROWS + 2;
        let unit = |n: usize| (0..=n).collect::<Vec<_>>();
        let body = Elastic::new(ElasticParts {
            dim: 2,
            stiffness: SquareMatrix::symmetric(n, unit(n), (0..n).collect(), vec![1.0; n]).unwrap(),
            jump: JumpOperator::new(n, n, unit(n), (0..n).collect(), vec![1.0; n]).unwrap(),
            weight: vec![1.0; n / 2],
            order: (0..n).collect(),
            free_order: Vec::new(),
            floating: Vec::new(),
            frictionless: vec![],
            traction: None,
        })
        .unwrap();
        let error = body.condensed().err().unwrap();
        let limit = MAX_CONDENSED_ROWS;
        assert_eq!(error, MethodError::TooManyRows { rows: n, limit });
    }
}
