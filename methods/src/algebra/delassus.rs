//! The Delassus operator W = B K⁻¹ Bᵀ from the trailing block of the factor.
//!
//! With D K D = L Lᵀ and the contact unknowns C eliminated last,
//! ```text
//! W = Yᵀ Y,   L_cc Y = (D B_c)ᵀ.
//! ```
//! Row i of B touches few unknowns, so column i of Y is zero above the first of them. Columns are therefore sorted by
//! their first non-zero and both the triangular solve and the product skip the leading zeros.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Mat, Par};

use crate::algebra::factor::Factor;
use crate::algebra::matrix::{JumpOperator, SymmetricMatrix};
use crate::error::MethodError;

/// Largest number of contact rows condensed: W then takes 8 n² bytes, 1.15 GB.
pub const MAX_CONDENSED_ROWS: usize = 12_000;
/// Columns handled together: wide enough for fast products, narrow enough to skip zeros.
const PANEL: usize = 128;

/// W for the listed rows of B, full (both triangles), exactly symmetric.
pub(crate) fn condense(
    factor: &Factor,
    jump: &JumpOperator,
    rows: &[usize],
) -> Result<Mat<f64>, MethodError> {
    let m = rows.len();
    check_rows(m)?;
    let (mut y, first, sorted) = right_hand_sides(factor, jump, rows);
    forward_solve(factor, &mut y, &first)?;

    // Wₛ = Yᵀ Y in sorted numbering, lower block triangle.
    let mut w = Mat::<f64>::zeros(m, m);
    let c = y.nrows();
    for begin in (0..m).step_by(PANEL) {
        let end = (begin + PANEL).min(m);
        let top = first[begin].min(c);
        matmul(
            w.as_mut().submatrix_mut(begin, 0, end - begin, end),
            Accum::Replace,
            y.as_ref()
                .submatrix(top, begin, c - top, end - begin)
                .transpose(),
            y.as_ref().submatrix(top, 0, c - top, end),
            1.0,
            Par::Seq,
        );
    }
    // Back to the order of `rows`; each pair is read from one triangle, so the result is symmetric to the bit.
    let mut position = vec![0; m];
    for (s, &i) in sorted.iter().enumerate() {
        position[i] = s;
    }
    Ok(Mat::from_fn(m, m, |i, j| {
        let (a, b) = (position[i], position[j]);
        w[(a.max(b), a.min(b))]
    }))
}

/// W given as a sparse matrix, full.
pub(crate) fn dense(sparse: &SymmetricMatrix) -> Result<Mat<f64>, MethodError> {
    let m = sparse.size();
    check_rows(m)?;
    let mut w = Mat::<f64>::zeros(m, m);
    for j in 0..m {
        for k in sparse.col_ptr()[j]..sparse.col_ptr()[j + 1] {
            let (i, value) = (sparse.row_idx()[k], sparse.values()[k]);
            w[(i, j)] = value;
            w[(j, i)] = value;
        }
    }
    Ok(w)
}

/// The lower triangle of a full W, every entry stored.
pub(crate) fn lower(w: &Mat<f64>) -> Result<SymmetricMatrix, MethodError> {
    let m = w.nrows();
    let mut col_ptr = vec![0];
    let (mut row_idx, mut values) = (Vec::new(), Vec::new());
    for j in 0..m {
        row_idx.extend(j..m);
        values.extend((j..m).map(|i| w[(i, j)]));
        col_ptr.push(values.len());
    }
    SymmetricMatrix::new(m, col_ptr, row_idx, values)
}

fn check_rows(rows: usize) -> Result<(), MethodError> {
    if rows > MAX_CONDENSED_ROWS {
        return Err(MethodError::TooManyRows {
            rows,
            limit: MAX_CONDENSED_ROWS,
        });
    }
    Ok(())
}

/// (D B_c)ᵀ with columns sorted by first non-zero: matrix, first non-zero of each column, original column.
fn right_hand_sides(
    factor: &Factor,
    jump: &JumpOperator,
    rows: &[usize],
) -> (Mat<f64>, Vec<usize>, Vec<usize>) {
    let begin = factor.ordering.contact_begin;
    let c = factor.scale.len() - begin;
    let mut pinned = vec![false; factor.scale.len()];
    for &pin in &factor.pins {
        pinned[pin] = true;
    }
    // Pinned unknowns do not move, so they carry no part of the jump.
    let entries = |i: usize| jump.row(i).filter(|&(j, b)| b != 0.0 && !pinned[j]);
    let first_of = |i: usize| {
        entries(i)
            .map(|(j, _)| factor.ordering.inverse[j] - begin)
            .min()
            .unwrap_or(c)
    };

    let starts: Vec<usize> = rows.iter().map(|&i| first_of(i)).collect();
    let mut sorted: Vec<usize> = (0..rows.len()).collect();
    sorted.sort_by_key(|&k| (starts[k], k));
    let first = sorted.iter().map(|&k| starts[k]).collect();
    let mut y = Mat::<f64>::zeros(c, rows.len());
    for (column, &k) in sorted.iter().enumerate() {
        for (j, b) in entries(rows[k]) {
            y[(factor.ordering.inverse[j] - begin, column)] += b * factor.scale[j];
        }
    }
    (y, first, sorted)
}

/// y <- L_cc⁻¹ y, supernode by supernode, in panels; column j is zero above `first[j]` (increasing in j).
fn forward_solve(factor: &Factor, y: &mut Mat<f64>, first: &[usize]) -> Result<(), MethodError> {
    let l = factor.supernodes()?;
    let begin = factor.ordering.contact_begin;
    for s in 0..factor.supernode_count() {
        let node = l.supernode(s);
        let (block, start) = (node.val(), node.start());
        let own = block.ncols();
        // A supernode may straddle the boundary: its leading columns belong to eliminated unknowns.
        let mut a = begin.saturating_sub(start);
        while a < own {
            let b = (a + PANEL).min(own);
            let row = start + a - begin;
            let columns = first.partition_point(|&f| f < row + (b - a));
            if columns > 0 {
                let (top, rest) = y
                    .as_mut()
                    .subcols_mut(0, columns)
                    .split_at_row_mut(row + (b - a));
                let mut top = top.subrows_mut(row, b - a);
                solve_lower_triangular_in_place(
                    block.submatrix(a, a, b - a, b - a),
                    top.as_mut(),
                    Par::Seq,
                );
                let (mut below, mut far) = rest.split_at_row_mut(own - b);
                matmul(
                    below.as_mut(),
                    Accum::Add,
                    block.submatrix(b, a, own - b, b - a),
                    top.as_ref(),
                    -1.0,
                    Par::Seq,
                );
                let pattern = node.pattern();
                if !pattern.is_empty() {
                    let mut update = Mat::<f64>::zeros(pattern.len(), columns);
                    matmul(
                        update.as_mut(),
                        Accum::Replace,
                        block.submatrix(own, a, pattern.len(), b - a),
                        top.as_ref(),
                        1.0,
                        Par::Seq,
                    );
                    for j in 0..columns {
                        for (k, &i) in pattern.iter().enumerate() {
                            far[(i - (start + own), j)] -= update[(k, j)];
                        }
                    }
                }
            }
            a = b;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Elastic, ElasticParts, SymmetricMatrix};

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
            stiffness: SymmetricMatrix::new(n, col_ptr, row_idx, values).unwrap(),
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
            floating: Vec::new(),
            frictionless: false,
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
            let w = condense(body.factor().unwrap(), body.jump(), &rows.source).unwrap();
            for j in (0..rows.len()).step_by(17) {
                let mut unit = vec![0.0; rows.len()];
                unit[j] = 1.0;
                let mut u = vec![0.0; n];
                body.jump().mul_transpose_add(&unit, &mut u);
                body.solve(&mut u).unwrap();
                let mut column = vec![0.0; rows.len()];
                body.jump().mul(&u, &mut column);
                for i in 0..rows.len() {
                    assert!((w[(i, j)] - column[i]).abs() < 1e-13, "{stride}: {i} {j}");
                    assert_eq!(w[(i, j)], w[(j, i)]);
                }
            }
        }
    }

    #[test]
    fn too_many_rows_are_refused_before_memory_is_asked_for() {
        let n = MAX_CONDENSED_ROWS + 2;
        let unit = |n: usize| (0..=n).collect::<Vec<_>>();
        let body = Elastic::new(ElasticParts {
            dim: 2,
            stiffness: SymmetricMatrix::new(n, unit(n), (0..n).collect(), vec![1.0; n]).unwrap(),
            jump: JumpOperator::new(n, n, unit(n), (0..n).collect(), vec![1.0; n]).unwrap(),
            weight: vec![1.0; n / 2],
            order: (0..n).collect(),
            floating: Vec::new(),
            frictionless: false,
            traction: None,
        })
        .unwrap();
        let error = body.condensed().err().unwrap();
        assert_eq!(
            error,
            MethodError::TooManyRows {
                rows: n,
                limit: MAX_CONDENSED_ROWS
            }
        );
    }
}
