//! Analysis of the pattern of K before its values are known: elimination order, supernodes, their rows.
//!
//! The elimination tree of the preferred order is put in postorder (same fill, Liu 1990), columns with the same rows below them are joined, then also those that nearly have: dense kernels on
//! few zeros more are faster than sparse ones (Ashcraft and Grimes 1989).

use std::ops::Range;
use std::sync::Arc;

use crate::algebra::matrix::SquareMatrix;
use crate::algebra::multifrontal::tree::{AssemblyTree, NONE, postorder};
use crate::algebra::strips::Trapezoid;

/// A child is joined to its parent if of the entries of both at most this part is zero, by the number of columns.
const RELAXATION: [(usize, f64); 4] = [(4, 0.8), (16, 0.3), (48, 0.1), (usize::MAX, 0.01)];

/// A permutation of the unknowns: `forward[k]` is the k-th pivot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Ordering {
    pub forward: Vec<usize>,
    pub inverse: Vec<usize>,
}

impl Ordering {
    fn new(forward: Vec<usize>) -> Self {
        let mut inverse = vec![0; forward.len()];
        for (position, &j) in forward.iter().enumerate() {
            inverse[j] = position;
        }
        Self { forward, inverse }
    }
}

/// Entries of the lower triangle of the reordered K by columns: where each goes in the front of its column.
pub(crate) struct Entries {
    pub begin: Vec<usize>,
    pub place: Vec<u32>,
}

/// Plan of a factorisation, or of many that share it.
pub(crate) struct Analysis {
    pub ordering: Arc<Ordering>,
    pub tree: Arc<AssemblyTree>,
    pub entries: Entries,
}

impl Analysis {
    /// Of K, eliminated in the order `preferred`, a permutation.
    pub fn new(k: &SquareMatrix, preferred: &[usize]) -> Self {
        let wished = Ordering::new(preferred.to_vec());
        let columns = Columns::new(k, &wished);
        let groups = Groups::of_equal_rows(&columns).joined();
        let (order, sizes) = groups.in_postorder();
        let original = order.iter().map(|&c| wished.forward[columns.order[c]]);
        let ordering = Ordering::new(original.collect());
        let (tree, entries) = assembly_tree(k, &ordering, &sizes);
        Self {
            ordering: Arc::new(ordering),
            tree: Arc::new(tree),
            entries,
        }
    }
}

/// For every position the other ones that `pairs` names with it.
struct Lists {
    begin: Vec<usize>,
    items: Vec<u32>,
}

impl Lists {
    /// `pairs` calls what it is given with (position, item), the same ones whenever it is called.
    fn new(n: usize, pairs: impl Fn(&mut dyn FnMut(usize, usize))) -> Self {
        let mut begin = vec![0; n + 1];
        pairs(&mut |at, _| begin[at + 1] += 1);
        for k in 0..n {
            begin[k + 1] += begin[k];
        }
        let mut next = begin.clone();
        let mut items = vec![0; begin[n]];
        pairs(&mut |at, item| {
            items[next[at]] = item as u32;
            next[at] += 1;
        });
        Self { begin, items }
    }

    fn of(&self, at: usize) -> &[u32] {
        &self.items[self.begin[at]..self.begin[at + 1]]
    }
}

/// Calls `visit` with the two positions of every entry of K beside the diagonal, the earlier one first.
fn each_pair(k: &SquareMatrix, ordering: &Ordering, visit: &mut dyn FnMut(usize, usize)) {
    for j in 0..k.size() {
        let b = ordering.inverse[j];
        for &i in &k.row_idx()[k.col_ptr()[j] + 1..k.col_ptr()[j + 1]] {
            let a = ordering.inverse[i];
            visit(a.min(b), a.max(b));
        }
    }
}

/// The columns of L in postorder of their elimination tree.
struct Columns {
    /// Position in the order that was wished for.
    order: Vec<usize>,
    /// Parent in the tree.
    parent: Vec<usize>,
    /// Entries on and below the diagonal.
    count: Vec<usize>,
}

impl Columns {
    fn new(k: &SquareMatrix, wished: &Ordering) -> Self {
        let n = k.size();
        let earlier = Lists::new(n, |visit| each_pair(k, wished, &mut |a, b| visit(b, a)));
        let tree = elimination_tree(&earlier);
        let order = postorder(&tree);
        let mut position = vec![0; n];
        for (new, &old) in order.iter().enumerate() {
            position[old] = new;
        }
        let parent = order.iter().map(|&old| match tree[old] {
            NONE => NONE,
            above => position[above],
        });
        let parent: Vec<usize> = parent.collect();
        let later = Lists::new(n, |visit| {
            for b in 0..n {
                earlier
                    .of(b)
                    .iter()
                    .for_each(|&a| visit(position[a as usize], position[b]));
            }
        });
        let count = column_counts(&parent, &later);
        Self {
            order,
            parent,
            count,
        }
    }
}

/// Parents of the columns (Liu 1986, with path compression); [`NONE`] for roots.
fn elimination_tree(earlier: &Lists) -> Vec<usize> {
    let n = earlier.begin.len() - 1;
    let mut parent = vec![NONE; n];
    let mut ancestor = vec![NONE; n];
    for c in 0..n {
        for &start in earlier.of(c) {
            let mut i = start as usize;
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

/// Entries of the columns of L, which are in postorder (Gilbert, Ng and Peyton 1994): every row of L is a subtree of the
/// elimination tree, counted by its leaves less the points where their paths meet.
fn column_counts(parent: &[usize], later: &Lists) -> Vec<usize> {
    let n = parent.len();
    // First descendant; a column without children begins a path of its own.
    let mut first: Vec<usize> = (0..n).collect();
    let mut change = vec![1isize; n];
    for j in 0..n {
        if parent[j] != NONE {
            first[parent[j]] = first[parent[j]].min(first[j]);
            change[parent[j]] = 0;
        }
    }
    // By row: the first descendants of its last leaf plus one, and the leaf.
    let (mut seen, mut leaf) = (vec![0; n], vec![NONE; n]);
    let mut ancestor: Vec<usize> = (0..n).collect();
    for j in 0..n {
        if parent[j] != NONE {
            change[parent[j]] -= 1;
        }
        for &i in later.of(j) {
            let i = i as usize;
            if first[j] < seen[i] {
                continue;
            }
            // Column j is a leaf of the subtree of row i: no column below j has this row.
            seen[i] = j + 1;
            change[j] += 1;
            if leaf[i] != NONE {
                change[root(&mut ancestor, leaf[i])] -= 1;
            }
            leaf[i] = j;
        }
        if parent[j] != NONE {
            ancestor[j] = parent[j];
        }
    }
    for j in 0..n {
        if parent[j] != NONE {
            change[parent[j]] += change[j];
        }
    }
    change.into_iter().map(|c| c as usize).collect()
}

/// The end of the path from `start`, which is made short.
fn root(ancestor: &mut [usize], start: usize) -> usize {
    let mut end = start;
    while ancestor[end] != end {
        end = ancestor[end];
    }
    let mut k = start;
    while k != end {
        k = std::mem::replace(&mut ancestor[k], end);
    }
    end
}

/// Columns that follow each other and will be eliminated together.
struct Group {
    columns: Range<usize>,
    /// Columns in all, those of the children that were joined included.
    width: usize,
    /// Rows of the first column.
    height: usize,
    zeros: usize,
    parent: usize,
    /// The parent it was joined to, or [`NONE`].
    joined: usize,
}

struct Groups(Vec<Group>);

impl Groups {
    /// Columns whose rows are those of the next column and its diagonal.
    fn of_equal_rows(columns: &Columns) -> Self {
        let Columns { parent, count, .. } = columns;
        let n = count.len();
        let (mut groups, mut of_column) = (Vec::<Group>::new(), vec![0; n]);
        for c in 0..n {
            let goes_on = c > 0 && parent[c - 1] == c && count[c - 1] == count[c] + 1;
            match groups.last_mut() {
                Some(group) if goes_on => {
                    group.columns.end = c + 1;
                    group.width += 1;
                }
                _ => groups.push(Group {
                    columns: c..c + 1,
                    width: 1,
                    height: count[c],
                    zeros: 0,
                    parent: NONE,
                    joined: NONE,
                }),
            }
            of_column[c] = groups.len() - 1;
        }
        for group in &mut groups {
            let above = parent[group.columns.end - 1];
            group.parent = if above == NONE {
                NONE
            } else {
                of_column[above]
            };
        }
        Self(groups)
    }

    /// Joins children to their parents while few entries are zero.
    fn joined(mut self) -> Self {
        let mut children = vec![Vec::new(); self.0.len()];
        for p in 0..self.0.len() {
            let mut own: Vec<usize> = std::mem::take(&mut children[p]);
            // The lowest add the most zeros.
            own.sort_by_key(|&c| std::cmp::Reverse((self.0[c].height, c)));
            for c in own {
                self.join(c, p);
            }
            if self.0[p].parent != NONE {
                children[self.0[p].parent].push(p);
            }
        }
        self
    }

    /// Joins child `c` to its parent `p` if few entries are zero then.
    fn join(&mut self, c: usize, p: usize) {
        let (child, parent) = (&self.0[c], &self.0[p]);
        let (width, height) = (child.width + parent.width, child.width + parent.height);
        let new = child.width * (height - child.height);
        let whole = Trapezoid {
            columns: width,
            height,
        };
        let zeros = child.zeros + parent.zeros + new;
        let allowed = RELAXATION
            .iter()
            .find(|r| width <= r.0)
            .map_or(0.0, |r| r.1);
        if new == 0 || zeros as f64 <= allowed * whole.entries() as f64 {
            self.0[c].joined = p;
            let parent = &mut self.0[p];
            (parent.width, parent.height, parent.zeros) = (width, height, zeros);
        }
    }

    /// The columns, group by group after their children, and the sizes of the groups.
    fn in_postorder(&self) -> (Vec<usize>, Vec<usize>) {
        let count = self.0.len();
        // The group that each was joined to in the end: parents stand behind their children.
        let mut last: Vec<usize> = (0..count).collect();
        for g in (0..count).rev() {
            if self.0[g].joined != NONE {
                last[g] = last[self.0[g].joined];
            }
        }
        let mut members = vec![Vec::new(); count];
        for g in 0..count {
            members[last[g]].push(g);
        }
        // Groups that were joined are leaves without columns.
        let parent: Vec<usize> = (0..count)
            .map(|g| match self.0[g].parent {
                NONE => NONE,
                above => last[above],
            })
            .collect();
        let (mut order, mut sizes) = (Vec::new(), Vec::new());
        for g in postorder(&parent) {
            let before = order.len();
            members[g]
                .iter()
                .for_each(|&m| order.extend(self.0[m].columns.clone()));
            if order.len() > before {
                sizes.push(order.len() - before);
            }
        }
        (order, sizes)
    }
}

/// The tree of supernodes of these sizes, and where the entries of K go in their fronts.
fn assembly_tree(
    k: &SquareMatrix,
    ordering: &Ordering,
    sizes: &[usize],
) -> (AssemblyTree, Entries) {
    let n = k.size();
    let mut below = Lists::new(n, |visit| each_pair(k, ordering, visit));
    let mut tree = AssemblyTree::default();
    let mut of_column = vec![0; n];
    let (mut position, mut seen) = (vec![0u32; n], vec![NONE; n]);
    let mut waiting: Vec<Vec<usize>> = vec![Vec::new(); sizes.len()];
    let mut ends: Vec<usize> = Vec::with_capacity(sizes.len());
    for &size in sizes {
        ends.push(ends.last().copied().unwrap_or(0) + size);
    }
    for (s, &end) in ends.iter().enumerate() {
        (end - sizes[s]..end).for_each(|c| of_column[c] = s);
    }
    for (s, &end) in ends.iter().enumerate() {
        let columns = end - sizes[s]..end;
        let children = std::mem::take(&mut waiting[s]);
        let mut rows = Vec::new();
        let mut add = |row: u32| {
            if row as usize >= end && seen[row as usize] != s {
                seen[row as usize] = s;
                rows.push(row);
            }
        };
        columns
            .clone()
            .for_each(|c| below.of(c).iter().copied().for_each(&mut add));
        children
            .iter()
            .for_each(|&c| tree.pattern(c).iter().copied().for_each(&mut add));
        rows.sort_unstable();
        for (k, c) in columns.clone().enumerate() {
            position[c] = k as u32;
        }
        for (k, &row) in rows.iter().enumerate() {
            position[row as usize] = (sizes[s] + k) as u32;
        }
        if let Some(&row) = rows.first() {
            waiting[of_column[row as usize]].push(s);
        }
        let own = below.begin[columns.start]..below.begin[columns.end];
        for row in &mut below.items[own] {
            *row = position[*row as usize];
        }
        tree.push(columns, &rows, children, &position);
    }
    let entries = Entries {
        begin: below.begin,
        place: below.items,
    };
    (tree, entries)
}
