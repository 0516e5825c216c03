//! How the Delassus operator W = B K⁻¹ Bᵀ follows from the factor of K: with D K D = L Lᵀ,
//! ```text
//! W = Yᵀ Y,   L Y = (D B)ᵀ        along the tree of the factor
//! ```
//! A floating body has a generalised inverse G for K⁻¹, and balanced rows: those of B P (`floating::Balance`).

use faer::{Mat, MatMut};

use crate::algebra::delassus::check_rows;
use crate::algebra::factor::Factor;
use crate::algebra::matrix::JumpOperator;
use crate::algebra::multifrontal::{Columns, Shared};
use crate::algebra::plain::Full;
use crate::algebra::strips::{STRIP, column_strips, for_all};
use crate::error::MethodError;

/// W and its diagonal.
pub(crate) type Condensed = (Full, Vec<f64>);

/// W for the listed rows of B, full (both triangles), exactly symmetric, and the squared columns of Y: the diagonal of W
/// as [`diagonal`] gives it.
pub(crate) fn condense(
    factor: &Factor,
    jump: &JumpOperator,
    rows: &[usize],
) -> Result<Condensed, MethodError> {
    check_rows(rows.len())?;
    let (mut w, diagonal) = factor.condense(&columns(factor, &[(jump, rows)]), true);
    // Each pair is read from one triangle, so the result is symmetric to the bit.
    mirror_upper(w.view_mut());
    Ok((w, diagonal))
}

/// The diagonal of W for the listed rows of B: W is not formed.
pub(crate) fn diagonal(factor: &Factor, jump: &JumpOperator, rows: &[usize]) -> Vec<f64> {
    factor.condense(&columns(factor, &[(jump, rows)]), false).1
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
        let (square, _) = factor.condense(&columns(factor, &[(b, rows), (s, rows)]), true);
        let x = square.view().submatrix(0, m, m, m).to_owned();
        let mut t = square.view().submatrix(m, m, m, m).to_owned();
        mirror_upper(t.as_mut());
        Ok(Self { t, x })
    }
}

/// Lower triangle := upper triangle, by quarters.
fn mirror_upper(mut a: MatMut<'_, f64>) {
    /// Square blocks that fit a cache.
    const BLOCK: usize = 32;
    let n = a.nrows();
    if n <= BLOCK {
        for j in 0..n {
            (0..j).for_each(|i| a[(j, i)] = a[(i, j)]);
        }
        return;
    }
    let half = (n / 2).next_multiple_of(BLOCK);
    let (first, upper, lower, last) = a.split_at_mut(half, half);
    let (upper, threads) = (upper.as_ref(), n > STRIP);
    for_all(
        column_strips(lower, BLOCK),
        threads,
        |(begin, mut strip)| {
            for row in (0..strip.nrows()).step_by(BLOCK) {
                for j in 0..strip.ncols() {
                    for i in row..(row + BLOCK).min(strip.nrows()) {
                        strip[(i, j)] = upper[(begin + j, i)];
                    }
                }
            }
        },
    );
    mirror_upper(first);
    mirror_upper(last);
}

/// (D B)ᵀ for the listed rows of operators B; of a floating body with the part of its balance that each takes.
fn columns(factor: &Factor, b: &[(&JumpOperator, &[usize])]) -> Columns {
    let mut pinned = vec![false; factor.scale.len()];
    factor.pins.iter().for_each(|&pin| pinned[pin] = true);
    // Pinned unknowns take no part of balanced forces.
    let placed = |j: usize, value: f64| (!pinned[j]).then(|| (factor.ordering.inverse[j], value));
    let rows = || {
        b.iter()
            .flat_map(|&(b, rows)| rows.iter().map(move |&i| (b, i)))
    };
    let own = |(b, i): (&JumpOperator, usize)| {
        let row = b.touched(i);
        row.filter_map(|(j, b)| placed(j, b * factor.scale[j]))
            .collect()
    };
    let shared = factor.balance.motions.iter().map(|motion| {
        let resultant = |(b, i): (&JumpOperator, usize)| {
            let row = b.row(i).map(|(j, b)| motion.r[j] * b);
            row.sum::<f64>()
        };
        let parts = (0..).zip(rows().map(|row| -resultant(row)));
        Shared {
            entries: motion.s.iter().filter_map(|&(j, s)| placed(j, s)).collect(),
            parts: parts.filter(|part| part.1 != 0.0).collect(),
        }
    });
    Columns {
        own: rows().map(own).collect(),
        shared: shared.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::matrix::SquareMatrix;
    use crate::algebra::memory::{free_gb, machine_gb};
    use crate::contract::elastic::{Elastic, ElasticParts};

    /// Two separate strips of `long` × 3 nodes with springs to all neighbours; contact couples unknowns of each strip
    /// with itself only: W is sparse.
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
        // More than is free while tests beside this one give some back.
        let most = machine_gb().unwrap_or_else(free_gb);
        let n = 2 * (1e9 * most / 64.0).sqrt().ceil() as usize + 2;
        let unit = |n: usize| (0..=n).collect::<Vec<_>>();
        let body = Elastic::new(ElasticParts {
            dim: 2,
            stiffness: SquareMatrix::symmetric(n, unit(n), (0..n).collect(), vec![1.0; n]).unwrap(),
            jump: JumpOperator::new(n, n, unit(n), (0..n).collect(), vec![1.0; n]).unwrap(),
            weight: vec![1.0; n / 2],
            order: (0..n).collect(),
            floating: Vec::new(),
            frictionless: vec![],
            traction: None,
        })
        .unwrap();
        let error = body.condensed().err().unwrap();
        assert!(matches!(error, MethodError::TooManyRows { rows, .. } if rows == n));
    }
}
