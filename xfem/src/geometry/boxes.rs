//! Boxes in a tree by place: which of many meet a given one, which of many things in them is nearest.

use super::{Point, norm};

/// A box: lowest and highest coordinates [m].
pub type Extents = [Point; 2];

/// Around nothing.
const EMPTY: Extents = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// The box of some points, larger by `margin` on all sides [m].
pub fn around<'a>(points: impl IntoIterator<Item = &'a Point>, margin: f64) -> Extents {
    let grown = |[low, high]: Extents, x: &Point| {
        let low = [0, 1, 2].map(|a| low[a].min(x[a] - margin));
        [low, [0, 1, 2].map(|a| high[a].max(x[a] + margin))]
    };
    points.into_iter().fold(EMPTY, grown)
}

/// What the distance of a place from none in a box falls below, however it rounds [m].
pub fn no_nearer(x: &Point, [low, high]: &Extents) -> f64 {
    /// In parts of coordinates and distances: a foot on a segment takes some ten steps.
    const ROUNDING: f64 = 64.0 * f64::EPSILON;
    let away = norm(&[0, 1, 2].map(|a| (low[a] - x[a]).max(x[a] - high[a]).max(0.0)));
    away - ROUNDING * (away + norm(low) + norm(high))
}

/// The box of two boxes.
pub fn joined(one: Extents, two: &Extents) -> Extents {
    let low = [0, 1, 2].map(|a| one[0][a].min(two[0][a]));
    [low, [0, 1, 2].map(|a| one[1][a].max(two[1][a]))]
}

/// Many boxes, halved again and again across the longest extent of their lowest corners.
#[derive(Debug, Clone, Default)]
pub struct Boxes {
    /// They and their numbers, those of a node one after the other.
    items: Vec<(Extents, u32)>,
    /// Boxes around those of every node; the halves of node k are the nodes 2 k + 1 and 2 k + 2.
    nodes: Vec<Extents>,
}

/// A node: its number, and from where to where its boxes stand.
type Node = (usize, [usize; 2]);

/// Nodes with fewer boxes are not halved.
const FEW: usize = 8;

fn halves((node, [begin, end]): Node) -> Option<[Node; 2]> {
    let middle = usize::midpoint(begin, end);
    let halves = [
        (2 * node + 1, [begin, middle]),
        (2 * node + 2, [middle, end]),
    ];
    (end - begin > FEW).then_some(halves)
}

impl Boxes {
    /// Sorts them.
    pub fn new(boxes: impl Iterator<Item = Extents>) -> Self {
        let mut found = Boxes {
            items: boxes.zip(0..).collect(),
            nodes: Vec::new(),
        };
        found.build(found.root());
        found
    }

    fn root(&self) -> Node {
        (0, [0, self.items.len()])
    }

    fn build(&mut self, own: Node) {
        let (node, [begin, end]) = own;
        if self.nodes.len() <= node {
            self.nodes.resize(node + 1, EMPTY);
        }
        self.nodes[node] = if let Some(halves) = halves(own) {
            let items = &mut self.items[begin..end];
            let lowest = around(items.iter().map(|item| &item.0[0]), 0.0);
            // Between infinite ones it is not-a-number, and no axis is longer.
            let extent = |a: &usize| lowest[1][*a] - lowest[0][*a];
            let axis = (1..3).fold(0, |best, a| {
                if extent(&a) > extent(&best) || extent(&best).is_nan() {
                    a
                } else {
                    best
                }
            });
            items.select_nth_unstable_by(halves[0].1[1] - begin, |a, b| {
                a.0[0][axis].total_cmp(&b.0[0][axis]).then(a.1.cmp(&b.1))
            });
            halves.into_iter().for_each(|half| self.build(half));
            let [one, two] = halves.map(|half| self.nodes[half.0]);
            joined(one, &two)
        } else {
            let items = self.items[begin..end].iter();
            items.fold(EMPTY, |all, item| joined(all, &item.0))
        };
    }

    /// Numbers of those that meet a box or its border, ascending.
    pub fn meeting(&self, [low, high]: &Extents) -> Vec<usize> {
        let meets = |b: &Extents| (0..3).all(|a| b[1][a] >= low[a] && b[0][a] <= high[a]);
        let mut found = Vec::new();
        self.any(meets, |number| {
            found.push(number);
            false
        });
        found.sort_unstable();
        found
    }

    /// Whether one `is` what is sought, given its number; only those are asked whose box, and all around it, `may` hold such.
    pub fn any(&self, may: impl Fn(&Extents) -> bool, mut is: impl FnMut(usize) -> bool) -> bool {
        let mut rest = vec![self.root()];
        while let Some(own) = rest.pop() {
            let (node, [begin, end]) = own;
            if begin == end || !may(&self.nodes[node]) {
                continue;
            }
            if let Some(halves) = halves(own) {
                rest.extend(halves);
                continue;
            }
            let items = self.items[begin..end].iter();
            let mut near = items.filter(|item| may(&item.0));
            if near.any(|item| is(item.1 as usize)) {
                return true;
            }
        }
        false
    }

    /// The least `value` below or equal to `best` with its number, of equal ones the lowest; `bound`: what no value of things in a
    /// box falls below.
    pub fn least(
        &self,
        bound: impl Fn(&Extents) -> f64,
        value: impl Fn(usize) -> f64,
        mut best: (f64, usize),
    ) -> (f64, usize) {
        let mut rest = vec![(f64::NEG_INFINITY, self.root())];
        while let Some((least, own)) = rest.pop() {
            let [begin, end] = own.1;
            if begin == end || least > best.0 {
                continue;
            }
            if let Some(halves) = halves(own) {
                let mut bounded = halves.map(|half| (bound(&self.nodes[half.0]), half));
                // The nearer one comes first.
                bounded.sort_by(|a, b| b.0.total_cmp(&a.0));
                rest.extend(bounded);
                continue;
            }
            for (extents, number) in &self.items[begin..end] {
                if bound(extents) > best.0 {
                    continue;
                }
                let own = (value(*number as usize), *number as usize);
                if own.0 < best.0 || own.0 == best.0 && own.1 < best.1 {
                    best = own;
                }
            }
        }
        best
    }
}
