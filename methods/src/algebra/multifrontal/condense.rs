//! W = Yᵀ Y with L Y = B for a sparse B, along the tree: a supernode sees the columns of B that begin in its subtree, and no
//! others.
//! ```text
//! [ L₁₁   ] [ Y₁ ]   [ F₁ ]     F₁, F₂: B and the updates of the children,  W += Y₁ᵀ Y₁,  update F₂ − L₂₁ Y₁
//! [ L₂₁ I ] [ U  ] = [ F₂ ]
//! ```
//! Columns of a floating body are sparse ones and multiples of a few that touch all of its contact: Y is added up before it is squared,
//! so that nothing cancels in W.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::ReborrowMut;
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::algebra::dense::add;
use crate::algebra::multifrontal::Cholesky;
use crate::algebra::multifrontal::tree::{AssemblyTree, Supernode};
use crate::algebra::plain::Full;
use crate::algebra::strips::{STRIP, WORTH_THREADS, column_strips, for_all};

/// Entry of B: column, position in L, value.
type Entry = (u32, usize, f64);

impl AssemblyTree {
    /// The supernode of every column of L.
    fn supernodes(&self) -> Vec<usize> {
        let nodes = self.nodes.iter().enumerate();
        nodes
            .flat_map(|(s, node)| std::iter::repeat_n(s, node.columns.len()))
            .collect()
    }

    /// The columns of B that every supernode sees, increasing; `begins`: for every column the supernodes of its entries.
    fn seen(&self, begins: impl Iterator<Item = (u32, usize)>) -> Vec<Vec<u32>> {
        let mut seen: Vec<Vec<u32>> = vec![Vec::new(); self.nodes.len()];
        begins.for_each(|(column, s)| seen[s].push(column));
        for s in 0..seen.len() {
            let mut own = std::mem::take(&mut seen[s]);
            for &child in &self.children[s] {
                own.extend_from_slice(&seen[child]);
            }
            own.sort_unstable();
            own.dedup();
            seen[s] = own;
        }
        seen
    }

    /// Multiplications and additions of W for a B whose columns have entries at these positions; `shared`: and at those of all others,
    /// as where a body floats.
    pub fn condensation(&self, b: &[Vec<usize>], shared: bool) -> f64 {
        const ALL: u32 = u32::MAX;
        let of = self.supernodes();
        let own = (0..)
            .zip(b)
            .flat_map(|(c, at)| at.iter().map(move |p| (c, p)));
        let all = b.iter().flatten().filter(|_| shared).map(|p| (ALL, p));
        let seen = self.seen(own.chain(all).map(|(column, &p)| (column, of[p])));
        let work = |(node, columns): (&Supernode, &Vec<u32>)| {
            let whole = match columns.last() {
                Some(&ALL) => b.len(),
                _ => columns.len(),
            };
            let sizes = [node.columns.len(), node.height(), columns.len(), whole];
            let [k, h, a, whole] = sizes.map(|n| n as f64);
            k * (a * (k + 2.0 * (h - k)) + whole * whole)
        };
        self.nodes.iter().zip(&seen).map(work).sum()
    }
}

/// A sparse B by columns: each its own entries, by position in L and value, and parts of what several share.
pub(crate) struct Columns {
    pub own: Vec<Vec<(usize, f64)>>,
    pub shared: Vec<Shared>,
}

/// Entries, and how much of them the columns have that do, increasing.
pub(crate) struct Shared {
    pub entries: Vec<(usize, f64)>,
    pub parts: Vec<(u32, f64)>,
}

/// Y and what is left of F, for the columns of B that a supernode sees.
struct Half {
    /// Rows of its own columns.
    own: Full,
    /// Rows below.
    below: Full,
}

impl Half {
    fn zeros(node: &Supernode, width: usize) -> Self {
        let (k, height) = (node.columns.len(), node.height());
        Self {
            own: Full::zeros(k, width),
            below: Full::zeros(height - k, width),
        }
    }

    /// Adds the update of a child, whose rows stand at `places` here; `from` and `to`: columns of B, increasing.
    fn add(&mut self, update: &Full, places: &[u32], from: &[u32], to: &[u32]) {
        let own = self.own.rows();
        let (first, second) = places.split_at(places.partition_point(|&p| (p as usize) < own));
        let of_child = |column| {
            let j = from.binary_search(column).ok()?;
            Some(update.column(j).split_at(first.len()))
        };
        let updates: Vec<_> = to.iter().map(of_child).collect();
        self.own.for_columns(|at, to| {
            if let Some((above, _)) = updates[at] {
                (first.iter().zip(above)).for_each(|(&row, value)| to[row as usize] += value);
            }
        });
        self.below.for_columns(|at, to| {
            if let Some((_, below)) = updates[at] {
                let pairs = second.iter().zip(below);
                pairs.for_each(|(&row, value)| to[row as usize - own] += value);
            }
        });
    }
}

impl Columns {
    /// Columns with a part in Y of those that a supernode sees, of which the shared ones stand last; `None` where it sees none of these.
    fn added_up(&self, seen: &[u32], y: &Full) -> Option<(Vec<u32>, Full)> {
        let m = self.own.len() as u32;
        let (own, shared) = seen.split_at(seen.partition_point(|&c| c < m));
        let parts = |&c: &u32| &self.shared[(c - m) as usize].parts;
        if shared.is_empty() {
            return None;
        }
        let others = shared.iter().flat_map(parts).map(|part| part.0);
        let mut whole: Vec<u32> = own.iter().copied().chain(others).collect();
        whole.sort_unstable();
        whole.dedup();
        let mut sum = Full::zeros(y.rows(), whole.len());
        let mut put = |column: u32, part: f64, y: &[f64]| {
            let at = whole.partition_point(|&c| c < column);
            add(part, y, sum.column_mut(at));
        };
        let mut columns = (0..y.columns()).map(|j| y.column(j));
        (own.iter().zip(&mut columns)).for_each(|(&column, y)| put(column, 1.0, y));
        for (c, y) in shared.iter().zip(columns) {
            (parts(c).iter()).for_each(|&(column, part)| put(column, part, y));
        }
        Some((whole, sum))
    }
}

impl Cholesky {
    /// W, if it is to be formed, of which the upper triangle counts, and its diagonal. The same bits for any number of threads, and
    /// for the diagonal whether W is formed or not.
    pub fn condense(&self, b: &Columns, formed: bool) -> (Full, Vec<f64>) {
        let (tree, m) = (&self.tree, b.own.len());
        let of = tree.supernodes();
        let mut entries: Vec<Vec<Entry>> = vec![Vec::new(); tree.nodes.len()];
        let shared = b.shared.iter().map(|shared| &shared.entries);
        for (column, own) in (0u32..).zip(b.own.iter().chain(shared)) {
            own.iter()
                .for_each(|&(p, value)| entries[of[p]].push((column, p, value)));
        }
        let begins = entries.iter().enumerate();
        let begins = begins.flat_map(|(s, own)| own.iter().map(move |e| (e.0, s)));
        let seen = tree.seen(begins);
        let size = if formed { m } else { 0 };
        let mut w = Full::zeros(size, size);
        let mut squares = vec![0.0; m];
        let mut fronts: Vec<Option<Half>> = tree.nodes.iter().map(|_| None).collect();
        for (s, node) in tree.nodes.iter().enumerate() {
            let columns = &seen[s];
            if columns.is_empty() {
                continue;
            }
            let (k, height, width) = (node.columns.len(), node.height(), columns.len());
            let front = fronts[s].take();
            let mut y = front.unwrap_or_else(|| Half::zeros(node, width));
            for &(column, p, value) in &entries[s] {
                let at = columns.partition_point(|&c| c < column);
                y.own[(p - node.columns.start, at)] += value;
            }
            let threads = (width * k * height) as f64 > WORTH_THREADS;
            let strips = column_strips(y.own.view_mut(), STRIP).into_iter();
            let strips = strips.zip(column_strips(y.below.view_mut(), STRIP));
            for_all(
                strips.collect(),
                threads,
                |((_, mut own), (_, mut below))| {
                    for (first, columns) in self.strips(s) {
                        let rows = own.rb_mut().split_at_row_mut(first).1;
                        let (mut top, own) = rows.split_at_row_mut(columns.ncols());
                        let (triangle, low) = columns.split_at_row(columns.ncols());
                        solve_lower_triangular_in_place(triangle, top.rb_mut(), Par::Seq);
                        let (near, far) = low.split_at_row(own.nrows());
                        matmul(own, Accum::Add, near, top.as_ref(), -1.0, Par::Seq);
                        matmul(
                            below.rb_mut(),
                            Accum::Add,
                            far,
                            top.as_ref(),
                            -1.0,
                            Par::Seq,
                        );
                    }
                },
            );
            let added = b.added_up(columns, &y.own);
            let (whole, sum) = match &added {
                Some((whole, sum)) => (&whole[..], sum),
                None => (&columns[..], &y.own),
            };
            for (j, &column) in whole.iter().enumerate() {
                let own = sum.column(j).iter();
                squares[column as usize] += own.map(|y| y * y).sum::<f64>();
            }
            if formed {
                add_square(w.view_mut(), whole, sum.view());
            }
            // The part that goes into the columns above is freed at once.
            if let Some(parent) = tree.nodes.get(node.parent) {
                let width = seen[node.parent].len();
                let above = fronts[node.parent].get_or_insert_with(|| Half::zeros(parent, width));
                above.add(&y.below, tree.places(s), columns, &seen[node.parent]);
            }
        }
        (w, squares)
    }
}

/// W += Yᵀ Y on these rows and columns of W, the upper triangle.
fn add_square(w: MatMut<'_, f64>, columns: &[u32], y: MatRef<'_, f64>) {
    let (k, width) = y.shape();
    let threads = (width * width * k) as f64 > WORTH_THREADS;
    // The columns of W that a strip goes to lie between those of its neighbours.
    let (mut strips, mut rest, mut before) = (Vec::new(), w, 0);
    for (t, own) in columns.chunks(STRIP).enumerate() {
        let end = own[own.len() - 1] as usize + 1;
        let (part, others) = rest.split_at_col_mut(end - before);
        strips.push((t * STRIP, before, part));
        (rest, before) = (others, end);
    }
    for_all(strips, threads, |(begin, first, mut part)| {
        let end = (begin + STRIP).min(width);
        let mut product = Mat::<f64>::zeros(end, end - begin);
        let own = y.subcols(begin, end - begin);
        let others = y.subcols(0, end).transpose();
        matmul(&mut product, Accum::Replace, others, own, 1.0, Par::Seq);
        for (j, &column) in columns[begin..end].iter().enumerate() {
            let mut to = part.rb_mut().col_mut(column as usize - first);
            let rows = columns[..=begin + j].iter();
            for (&row, value) in rows.zip(product.col_as_slice(j)) {
                to[row as usize] += value;
            }
        }
    });
}
