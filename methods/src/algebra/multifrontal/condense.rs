//! W = Yᵀ Y with L Y = B for a sparse B, along the tree: a supernode sees the columns of B that begin in its subtree, and no
//! others.
//! ```text
//! [ L₁₁   ] [ Y₁ ]   [ F₁ ]     F₁, F₂: B and the updates of the children,  W += Y₁ᵀ Y₁,  update F₂ − L₂₁ Y₁
//! [ L₂₁ I ] [ U  ] = [ F₂ ]
//! ```

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::ReborrowMut;
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::algebra::multifrontal::Cholesky;
use crate::algebra::multifrontal::tree::{AssemblyTree, Supernode};
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

    /// Multiplications and additions of W for a B whose columns have entries at these positions.
    pub fn condensation(&self, b: impl Iterator<Item = Vec<usize>>) -> f64 {
        let of = self.supernodes();
        let begins = (0u32..).zip(b);
        let begins = begins.flat_map(|(column, at)| at.into_iter().map(move |p| (column, p)));
        let seen = self.seen(begins.map(|(column, p)| (column, of[p])));
        let work = |(node, columns): (&Supernode, &Vec<u32>)| {
            let [k, h, a] = [node.columns.len(), node.height(), columns.len()].map(|n| n as f64);
            a * k * (k + 2.0 * (h - k) + a)
        };
        self.nodes.iter().zip(&seen).map(work).sum()
    }
}

impl Cholesky {
    /// W for the B with these columns, given by positions in L and values, if it is to be formed, of which the upper triangle
    /// counts; and its diagonal. The same bits for any number of threads, and for the diagonal whether W is formed or not.
    pub fn condense(&self, b: &[Vec<(usize, f64)>], formed: bool) -> (Mat<f64>, Vec<f64>) {
        let (tree, m) = (&self.tree, b.len());
        let of = tree.supernodes();
        let mut entries: Vec<Vec<Entry>> = vec![Vec::new(); tree.nodes.len()];
        for (column, own) in (0u32..).zip(b) {
            own.iter()
                .for_each(|&(p, value)| entries[of[p]].push((column, p, value)));
        }
        let begins = entries.iter().enumerate();
        let begins = begins.flat_map(|(s, own)| own.iter().map(move |e| (e.0, s)));
        let seen = tree.seen(begins);
        let size = if formed { m } else { 0 };
        let mut w = Mat::<f64>::zeros(size, size);
        let mut squares = vec![0.0; m];
        let mut updates: Vec<Mat<f64>> = tree.nodes.iter().map(|_| Mat::new()).collect();
        for (s, node) in tree.nodes.iter().enumerate() {
            let columns = &seen[s];
            if columns.is_empty() {
                continue;
            }
            let (k, height, width) = (node.columns.len(), node.height(), columns.len());
            let mut y = Mat::<f64>::zeros(height, width);
            for &(column, p, value) in &entries[s] {
                let at = columns.partition_point(|&c| c < column);
                y[(p - node.columns.start, at)] += value;
            }
            for &child in &tree.children[s] {
                let update = std::mem::replace(&mut updates[child], Mat::new());
                let mut at = 0;
                for (j, &column) in seen[child].iter().enumerate() {
                    at += columns[at..].partition_point(|&c| c < column);
                    let (from, to) = (update.col_as_slice(j), y.col_as_slice_mut(at));
                    let places = tree.places(child).iter();
                    places
                        .zip(from)
                        .for_each(|(&row, value)| to[row as usize] += value);
                }
            }
            let panel = self.panel(s);
            let (top, low) = panel.split_at_row(k);
            let threads = (width * k * height) as f64 > WORTH_THREADS;
            for_all(column_strips(y.as_mut(), STRIP), threads, |(_, strip)| {
                let (mut own, below) = strip.split_at_row_mut(k);
                solve_lower_triangular_in_place(top, own.rb_mut(), Par::Seq);
                matmul(below, Accum::Add, low, own.as_ref(), -1.0, Par::Seq);
            });
            for (j, &column) in columns.iter().enumerate() {
                let own = &y.col_as_slice(j)[..k];
                squares[column as usize] += own.iter().map(|y| y * y).sum::<f64>();
            }
            if formed {
                add_square(w.as_mut(), columns, y.as_ref().subrows(0, k));
            }
            if height > k {
                updates[s] = y.as_ref().subrows(k, height - k).to_owned();
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
