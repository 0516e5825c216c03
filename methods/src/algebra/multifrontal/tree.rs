//! The assembly tree: which columns of L are eliminated together, which rows they have, and whom they pass their update to.

use std::ops::Range;

use crate::algebra::strips::Trapezoid;

/// No parent.
pub(crate) const NONE: usize = usize::MAX;

/// A supernode: columns of L with the same rows below them, eliminated as one dense front.
#[derive(Debug)]
pub(crate) struct Supernode {
    /// Its columns, in the numbering of L.
    pub columns: Range<usize>,
    /// Where its rows below the columns stand in [`AssemblyTree::rows`].
    pattern: Range<usize>,
    /// Where its columns stand among the entries of L.
    pub entries: Range<usize>,
    /// The supernode that takes its update, or [`NONE`].
    pub parent: usize,
    /// First supernode of its subtree, which ends with itself.
    pub first: usize,
    /// Multiplications and additions of its subtree.
    pub work: f64,
}

impl Supernode {
    /// Columns and rows below them.
    pub fn height(&self) -> usize {
        self.columns.len() + self.pattern.len()
    }

    /// Its columns of L.
    pub fn shape(&self) -> Trapezoid {
        Trapezoid {
            columns: self.columns.len(),
            height: self.height(),
        }
    }
}

/// Supernodes, children before parents.
#[derive(Debug, Default)]
pub(crate) struct AssemblyTree {
    pub nodes: Vec<Supernode>,
    /// Children of a supernode, in increasing order.
    pub children: Vec<Vec<usize>>,
    /// Rows below the columns, increasing.
    rows: Vec<u32>,
    /// Where each of these rows stands in the front of the parent.
    places: Vec<u32>,
}

impl AssemblyTree {
    /// The rows of L below the columns of supernode `s`.
    pub fn pattern(&self, s: usize) -> &[u32] {
        &self.rows[self.nodes[s].pattern.clone()]
    }

    /// Where the rows below the columns of supernode `s` stand in the front of its parent.
    pub fn places(&self, s: usize) -> &[u32] {
        &self.places[self.nodes[s].pattern.clone()]
    }

    /// Multiplications and additions of all.
    pub fn work(&self) -> f64 {
        let roots = self.nodes.iter().filter(|s| s.parent == NONE);
        roots.map(|s| s.work).sum()
    }

    /// Numbers that L is kept in: zeros that were let in and the upper triangles of strips included.
    pub fn entries(&self) -> usize {
        self.nodes.last().map_or(0, |s| s.entries.end)
    }

    /// Adds the next supernode; its children have been added before, `rows` are those below its columns, and `position`
    /// says where any row of its front stands in it.
    pub fn push(
        &mut self,
        columns: Range<usize>,
        rows: &[u32],
        children: Vec<usize>,
        position: &[u32],
    ) {
        let (own, begin) = (columns.len(), self.rows.len());
        self.rows.extend_from_slice(rows);
        self.places.resize(self.rows.len(), 0);
        let height = own + rows.len();
        let squares = |h: usize| (h * (h + 1) * (2 * h + 1)) as f64 / 6.0;
        let mut work = squares(height) - squares(height - own);
        for &child in &children {
            let pattern = self.nodes[child].pattern.clone();
            for k in pattern {
                self.places[k] = position[self.rows[k] as usize];
            }
            self.nodes[child].parent = self.nodes.len();
            work += self.nodes[child].work;
        }
        let first = children
            .first()
            .map_or(self.nodes.len(), |&c| self.nodes[c].first);
        let mut node = Supernode {
            columns,
            pattern: begin..begin + rows.len(),
            entries: 0..0,
            parent: NONE,
            first,
            work,
        };
        let before = self.entries();
        node.entries = before..before + node.shape().len();
        self.nodes.push(node);
        self.children.push(children);
    }
}

/// Postorder of a forest given by parents; a parent outside the slice makes a root. Children in increasing order.
pub(super) fn postorder(parent: &[usize]) -> Vec<usize> {
    let n = parent.len();
    let mut first_child = vec![NONE; n];
    let mut sibling = vec![NONE; n];
    let mut roots = Vec::new();
    for i in (0..n).rev() {
        if parent[i] < n {
            sibling[i] = first_child[parent[i]];
            first_child[parent[i]] = i;
        } else {
            roots.push(i);
        }
    }
    let mut order = Vec::with_capacity(n);
    let mut stack = Vec::new();
    for &root in roots.iter().rev() {
        stack.push(root);
        while let Some(&top) = stack.last() {
            let child = first_child[top];
            if child == NONE {
                order.push(top);
                stack.pop();
            } else {
                first_child[top] = sibling[child];
                stack.push(child);
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parents_follow_their_children() {
        let parent = [3, 3, 4, 4, NONE];
        assert_eq!(postorder(&parent), [2, 0, 1, 3, 4]);
    }
}
