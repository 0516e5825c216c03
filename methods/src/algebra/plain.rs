//! Plain loops over columns, with wide vectors where the machine has them: what is too small for blocks.

use std::ops::{Index, IndexMut};

/// Runs loops with vectors of 256 bits where the machine has them. Products and sums stay operations of their own, in their order: the bits
/// are the same on every machine.
#[inline(always)]
pub(crate) fn wide<R>(act: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(act)
}

/// A square matrix, column by column.
#[derive(Default)]
pub(crate) struct Full {
    pub size: usize,
    pub values: Vec<f64>,
}

impl Full {
    /// n × n zeros.
    pub fn clear(&mut self, n: usize) {
        self.size = n;
        self.values.clear();
        self.values.reserve_exact(n * n);
        self.values.resize(n * n, 0.0);
    }

    /// Column `j`.
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.size..][..self.size]
    }
}

impl Index<(usize, usize)> for Full {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.values[i + j * self.size]
    }
}

impl IndexMut<(usize, usize)> for Full {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.values[i + j * self.size]
    }
}

/// A := L and U with L U = P A, partial pivoting; row k of P A is row `rows[k]` of A. One column after the other, all later ones
/// updated at once.
pub(crate) fn lu(a: &mut Full, rows: &mut Vec<usize>) {
    let n = a.size;
    rows.clear();
    rows.extend(0..n);
    wide(
        #[inline(always)]
        || {
            for k in 0..n {
                let (done, later) = a.values.split_at_mut((k + 1) * n);
                let (earlier, column) = done.split_at_mut(k * n);
                let mut pivot = k;
                for i in k + 1..n {
                    if column[i].abs() > column[pivot].abs() {
                        pivot = i;
                    }
                }
                if pivot != k {
                    rows.swap(k, pivot);
                    column.swap(k, pivot);
                    let others = earlier.chunks_exact_mut(n);
                    (others.chain(later.chunks_exact_mut(n))).for_each(|c| c.swap(k, pivot));
                }
                let (first, own) = (column[k], &mut column[k + 1..]);
                if first != 0.0 {
                    own.iter_mut().for_each(|x| *x /= first);
                }
                for column in later.chunks_exact_mut(n) {
                    let (first, below) = (column[k], &mut column[k + 1..]);
                    let pairs = below.iter_mut().zip(&*own);
                    pairs.for_each(|(x, l)| *x -= l * first);
                }
            }
        },
    );
}

/// x := U⁻¹ L⁻¹ x.
pub(crate) fn solve(factors: &Full, x: &mut [f64]) {
    let n = factors.size;
    wide(
        #[inline(always)]
        || {
            for (k, l) in factors.values.chunks_exact(n.max(1)).enumerate() {
                let (first, below) = (x[k], &mut x[k + 1..]);
                let pairs = below.iter_mut().zip(&l[k + 1..]);
                pairs.for_each(|(x, l)| *x -= l * first);
            }
            for (k, u) in factors.values.chunks_exact(n.max(1)).enumerate().rev() {
                x[k] /= u[k];
                let (above, last) = x[..=k].split_at_mut(k);
                above.iter_mut().zip(u).for_each(|(x, u)| *x -= u * last[0]);
            }
        },
    );
}
