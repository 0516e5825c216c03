//! The factor against the definition of what it is, on matrices whose factors are known or can be formed.

use super::*;
use crate::algebra::dense::dot;
use crate::algebra::matrix::SquareMatrix;

/// Numbers in [0, 1) that are the same everywhere (Knuth's MMIX generator).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A unit diagonal with couplings weak enough for it to dominate.
fn matrix(n: usize, links: &[(usize, usize)], random: &mut Random) -> SquareMatrix {
    let mut columns = vec![std::collections::BTreeMap::from([]); n];
    let mut degree = vec![0; n];
    for &(a, b) in links {
        degree[a] += 1;
        degree[b] += 1;
    }
    for (j, column) in columns.iter_mut().enumerate() {
        column.insert(j, 1.0);
    }
    for &(a, b) in links {
        let most = 1.0 / (1.0 + degree[a].max(degree[b]) as f64);
        columns[a.min(b)].insert(a.max(b), most * (2.0 * random.next() - 1.0));
    }
    let (mut begin, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in columns {
        rows.extend(column.keys());
        values.extend(column.values());
        begin.push(rows.len());
    }
    SquareMatrix::symmetric(n, begin, rows, values).unwrap()
}

/// Neighbours in a box of nodes, `dofs` unknowns each.
fn grid(size: [usize; 3], dofs: usize) -> (usize, Vec<(usize, usize)>) {
    let at = |i: [usize; 3]| i[0] + size[0] * (i[1] + size[1] * i[2]);
    let nodes: Vec<[usize; 3]> = (0..size[2])
        .flat_map(|k| (0..size[1]).flat_map(move |j| (0..size[0]).map(move |i| [i, j, k])))
        .collect();
    let mut links = Vec::new();
    for a in &nodes {
        for b in nodes
            .iter()
            .filter(|b| (0..3).all(|k| a[k].abs_diff(b[k]) <= 1))
        {
            for (s, t) in (0..dofs).flat_map(|s| (0..dofs).map(move |t| (s, t))) {
                let pair = (dofs * at(*a) + s, dofs * at(*b) + t);
                links.extend((pair.0 < pair.1).then_some(pair));
            }
        }
    }
    (dofs * nodes.len(), links)
}

/// A shuffled order.
fn shuffled(n: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    for k in (1..n).rev() {
        order.swap(k, (random.next() * (k + 1) as f64) as usize);
    }
    order
}

fn factor(k: &SquareMatrix, analysis: Analysis) -> (Arc<Ordering>, Result<Cholesky, Failure>) {
    let Analysis {
        ordering,
        tree,
        entries,
    } = analysis;
    let mut next = entries.begin.clone();
    let mut values = vec![0.0; entries.place.len()];
    for j in 0..k.size() {
        for e in k.col_ptr()[j] + 1..k.col_ptr()[j + 1] {
            let column = ordering.inverse[k.row_idx()[e]].min(ordering.inverse[j]);
            values[next[column]] = k.values()[e];
            next[column] += 1;
        }
    }
    let cholesky = Cholesky::new(tree, &entries, &values);
    (ordering, cholesky)
}

/// |K x − f| / |f| by column, with x from the factor.
fn residuals(k: &SquareMatrix, ordering: &Ordering, cholesky: &Cholesky) -> f64 {
    let n = k.size();
    let f = |column: usize, j: usize| ((3 * j + 7 * column) % 11) as f64 - 5.0;
    let mut x = faer::Mat::from_fn(n, 40, |i, j| f(j, ordering.forward[i]));
    (0..40).for_each(|j| cholesky.solve(x.col_as_slice_mut(j)));
    let worst = (0..40).map(|column| {
        let own = x.col_as_slice(column);
        let original: Vec<f64> = (0..n).map(|j| own[ordering.inverse[j]]).collect();
        let mut kx = vec![0.0; n];
        k.mul(&original, &mut kx);
        let (left, size) = (0..n).fold((0.0, 0.0), |(left, size), j| {
            (
                left + (kx[j] - f(column, j)).powi(2),
                size + f(column, j).powi(2),
            )
        });
        f64::sqrt(left / size)
    });
    worst.fold(0.0, f64::max)
}

/// Source: K x = f itself. Tolerance: rounding of matrices with condition numbers below 100.
#[test]
fn systems_are_solved_whatever_the_order() {
    let mut random = Random(7);
    for (size, dofs) in [
        ([1, 1, 1], 1),
        ([60, 1, 1], 1),
        ([9, 7, 1], 2),
        ([6, 5, 4], 3),
        ([40, 40, 1], 2),
    ] {
        let (n, links) = grid(size, dofs);
        let k = matrix(n, &links, &mut random);
        for turn in 0..3 {
            let order = shuffled(n, &mut random);
            let (ordering, cholesky) = factor(&k, Analysis::new(&k, &order));
            let cholesky = cholesky.unwrap();
            let mut sorted = ordering.forward.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..n));
            let worst = residuals(&k, &ordering, &cholesky);
            assert!(worst < 1e-14, "{size:?} {turn}: {worst}");
        }
    }
}

/// Source: elimination written down as it is defined, on sets of rows.
#[test]
fn supernodes_have_the_rows_of_their_columns_and_few_more() {
    let mut random = Random(11);
    let (n, links) = grid([7, 6, 2], 1);
    let k = matrix(n, &links, &mut random);
    let Analysis { ordering, tree, .. } = Analysis::new(&k, &shuffled(n, &mut random));
    let mut rows = vec![std::collections::BTreeSet::new(); n];
    for (a, b) in links {
        let (a, b) = (ordering.inverse[a], ordering.inverse[b]);
        rows[a.min(b)].insert(a.max(b));
    }
    for c in 0..n {
        let own = rows[c].clone();
        if let Some(&parent) = own.first() {
            rows[parent].extend(own.into_iter().skip(1));
        }
    }
    let exact: usize = rows.iter().map(|rows| 1 + rows.len()).sum();
    for (s, node) in tree.nodes.iter().enumerate() {
        for c in node.columns.clone() {
            let in_front = |&row: &usize| {
                node.columns.contains(&row) || tree.pattern(s).contains(&(row as u32))
            };
            assert!(rows[c].iter().all(in_front), "supernode {s}, column {c}");
        }
        let last = node.columns.end - 1;
        assert!(
            tree.pattern(s)
                .iter()
                .all(|&row| rows[last].contains(&(row as usize)))
        );
        assert!(
            tree.children[s]
                .iter()
                .all(|&c| c < s && tree.nodes[c].parent == s)
        );
    }
    assert!(
        (exact..2 * exact).contains(&tree.entries()),
        "{exact} {}",
        tree.entries()
    );
}

/// Columns of a few entries each, many of them far apart, and of every seventh a part of two that are shared.
fn sparse_columns(n: usize, m: usize, random: &mut Random) -> Columns {
    let mut at = |n: usize| (random.next() * n as f64) as usize;
    let mut column = |k: usize| -> Vec<(usize, f64)> {
        let places = [at(n), at(n), at(n / 9), at(n / 5)].into_iter().enumerate();
        let value = |i: usize| 1.0 - 0.3 * ((i + k) % 5) as f64;
        places.map(|(i, p)| (p, value(i))).collect()
    };
    let own = (0..m).map(&mut column).collect();
    let shared = |k: usize| Shared {
        entries: column(k),
        parts: (k as u32..m as u32)
            .step_by(7)
            .map(|j| (j, 0.1 * j as f64))
            .collect(),
    };
    let shared = [0, 3].map(shared).into();
    Columns { own, shared }
}

/// Source: W = Bᵀ A⁻¹ B by solves with the factor. Tolerance: rounding. Goal: the diagonal has the same bits without W.
#[test]
fn what_is_condensed_along_the_tree_is_what_solves_give() {
    let mut random = Random(17);
    for (size, dofs, m) in [([30, 30, 1], 2, 70), ([8, 7, 6], 3, 250), ([5, 1, 1], 1, 1)] {
        let (n, links) = grid(size, dofs);
        let k = matrix(n, &links, &mut random);
        let order: Vec<usize> = (0..n).collect();
        let (_, cholesky) = factor(&k, Analysis::new(&k, &order));
        let cholesky = cholesky.unwrap();
        let b = sparse_columns(n, m, &mut random);
        let (w, diagonal) = cholesky.condense(&b, true);
        assert_eq!(cholesky.condense(&b, false).1, diagonal);
        let mut whole = vec![vec![0.0; n]; m];
        for (j, own) in b.own.iter().enumerate() {
            own.iter().for_each(|&(p, value)| whole[j][p] += value);
        }
        for Shared { entries, parts } in &b.shared {
            for (&(j, part), &(p, value)) in parts
                .iter()
                .flat_map(|j| entries.iter().map(move |e| (j, e)))
            {
                whole[j as usize][p] += part * value;
            }
        }
        for j in (0..m).step_by(7) {
            let mut x = whole[j].clone();
            cholesky.solve(&mut x);
            for (i, own) in whole[..=j].iter().enumerate() {
                let off = (w[(i, j)] - dot(own, &x)).abs();
                assert!(off < 1e-13 * w[(j, j)].max(1.0), "{i} {j} {off:e}");
            }
            assert!((w[(j, j)] - diagonal[j]).abs() <= 1e-13 * w[(j, j)]);
        }
    }
}

#[test]
fn one_thread_and_four_give_the_same_bits() {
    let mut random = Random(3);
    let (n, links) = grid([15, 14, 13], 3);
    let k = matrix(n, &links, &mut random);
    // Layer by layer, so that fronts are large enough to be shared.
    let order: Vec<usize> = (0..n).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let (_, cholesky) = factor(&k, Analysis::new(&k, &order));
            let cholesky = cholesky.unwrap();
            let mut x: Vec<f64> = (0..n).map(|j| (j % 13) as f64).collect();
            cholesky.solve(&mut x);
            let b = sparse_columns(n, 800, &mut Random(1));
            let (w, diagonal) = cholesky.condense(&b, true);
            (cholesky.values, x, w, diagonal)
        })
    };
    assert!(run(1) == run(4));
}

#[test]
fn the_first_column_without_a_positive_pivot_is_named() {
    let mut random = Random(5);
    let (n, links) = grid([20, 20, 1], 1);
    let k = matrix(n, &links, &mut random);
    let mut values = k.values().to_vec();
    // Two unknowns far apart coupled to a neighbour more strongly than their diagonal.
    for j in [30, 333] {
        values[k.col_ptr()[j] + 1] = 1.5;
    }
    let k = SquareMatrix::symmetric(n, k.col_ptr().to_vec(), k.row_idx().to_vec(), values).unwrap();
    let order: Vec<usize> = (0..n).collect();
    let (ordering, cholesky) = factor(&k, Analysis::new(&k, &order));
    let Err(Failure::NotPositive(column)) = cholesky.map(|_| ()) else {
        panic!("a factor of an indefinite matrix");
    };
    // By then both unknowns of the first pair are eliminated, and nothing of the second.
    assert!(ordering.forward[column] < 333);
}
