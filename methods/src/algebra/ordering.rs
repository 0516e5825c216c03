//! Elimination order: the preferred order with the contact unknowns C moved to the end, postordered.
//!
//! With C last, the trailing block L_cc of the Cholesky factor is the factor of the Schur complement on C, and the
//! Delassus operator needs nothing else of L. The other unknowns are renumbered by a postorder of the elimination
//! tree (same fill, Liu 1990), because faer merges a supernode only with the one just before it.

use crate::algebra::matrix::SymmetricMatrix;

const NONE: usize = usize::MAX;

/// A permutation of the unknowns: `forward[k]` is the k-th pivot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Ordering {
    pub forward: Vec<usize>,
    pub inverse: Vec<usize>,
    /// Position of the first contact unknown.
    pub contact_begin: usize,
}

/// Reorders `preferred` (a permutation) as described above; `in_contact[j]` marks C.
pub(crate) fn contact_last(
    k: &SymmetricMatrix,
    preferred: &[usize],
    in_contact: &[bool],
) -> Ordering {
    let n = k.size();
    let rest = preferred.iter().copied().filter(|&j| !in_contact[j]);
    let contact = preferred.iter().copied().filter(|&j| in_contact[j]);
    let first: Vec<usize> = rest.chain(contact).collect();
    let contact_begin = in_contact.iter().filter(|c| !**c).count();

    let parent = elimination_tree(k, &first);
    // Contact unknowns keep their order: their trailing block is one dense chain anyway.
    let forward: Vec<usize> = postorder(&parent[..contact_begin])
        .into_iter()
        .chain(contact_begin..n)
        .map(|position| first[position])
        .collect();
    let inverse = invert(&forward);
    Ordering {
        forward,
        inverse,
        contact_begin,
    }
}

fn invert(forward: &[usize]) -> Vec<usize> {
    let mut inverse = vec![0; forward.len()];
    for (position, &j) in forward.iter().enumerate() {
        inverse[j] = position;
    }
    inverse
}

/// Elimination tree of the permuted matrix (Liu 1986, path compression); roots have parent `NONE`.
fn elimination_tree(k: &SymmetricMatrix, forward: &[usize]) -> Vec<usize> {
    let n = k.size();
    let inverse = invert(forward);
    // Upper triangle of the permuted pattern by columns: for each later position the earlier ones it couples to.
    let pairs = || {
        (0..n).flat_map(|j| {
            let rows = &k.row_idx()[k.col_ptr()[j] + 1..k.col_ptr()[j + 1]];
            rows.iter().map(move |&i| (i, j))
        })
    };
    let mut ptr = vec![0usize; n + 1];
    for (i, j) in pairs() {
        ptr[inverse[i].max(inverse[j]) + 1] += 1;
    }
    for c in 0..n {
        ptr[c + 1] += ptr[c];
    }
    let mut next = ptr.clone();
    let mut earlier = vec![0usize; ptr[n]];
    for (i, j) in pairs() {
        let (a, b) = (inverse[i], inverse[j]);
        earlier[next[a.max(b)]] = a.min(b);
        next[a.max(b)] += 1;
    }

    let mut parent = vec![NONE; n];
    let mut ancestor = vec![NONE; n];
    for c in 0..n {
        for &start in &earlier[ptr[c]..ptr[c + 1]] {
            let mut i = start;
            while i != c {
                let up = ancestor[i];
                ancestor[i] = c;
                if up == NONE {
                    parent[i] = c;
                    break;
                }
                i = up;
            }
        }
    }
    parent
}

/// Postorder of a forest given by parents; a parent outside the slice makes a root. Children in increasing order.
fn postorder(parent: &[usize]) -> Vec<usize> {
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

    /// Path 0-1-2-3-4 with fill-free order.
    fn path(n: usize) -> SymmetricMatrix {
        let mut col_ptr = vec![0];
        let (mut row_idx, mut values) = (Vec::new(), Vec::new());
        for j in 0..n {
            row_idx.push(j);
            values.push(2.0);
            if j + 1 < n {
                row_idx.push(j + 1);
                values.push(-1.0);
            }
            col_ptr.push(row_idx.len());
        }
        SymmetricMatrix::new(n, col_ptr, row_idx, values).unwrap()
    }

    #[test]
    fn order_is_a_permutation_with_contact_unknowns_last() {
        let k = path(5);
        let in_contact = [false, true, false, true, false];
        let order = contact_last(&k, &[4, 3, 2, 1, 0], &in_contact);
        assert_eq!(order.contact_begin, 3);
        let mut sorted = order.forward.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3, 4]);
        assert_eq!(
            order.forward[3..],
            [3, 1],
            "contact unknowns keep the preferred order"
        );
        assert!((0..5).all(|j| order.forward[order.inverse[j]] == j));
    }

    #[test]
    fn parents_follow_their_children() {
        let parent = [3, 3, 4, 4, NONE];
        let order = postorder(&parent);
        assert_eq!(order, [2, 0, 1, 3, 4].map(|x: usize| x));
    }
}
