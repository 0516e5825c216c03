//! Spanning forest of stars of the cut mesh edges: which crossed edges may share one multiplier.
//!
//! Vertices are the nodes whose displacement jumps, edges the mesh edges that the crack crosses. While some edge has two
//! ends of degree 2 or more, one of them is removed; what remains is a forest of stars that reaches every node. One
//! multiplier per star keeps the inf-sup constant independent of the cut: Moës, Béchet & Tourbier, Int. J. Numer. Meth.
//! Engng 67 (2006) 1641; Géniaut, Massin & Moës, Eur. J. Comput. Mech. 16 (2007) 305 ("vital edges"); Béchet, Moës &
//! Wohlmuth, Int. J. Numer. Meth. Engng 78 (2009) 931.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Star of every edge, numbered from 0 in the order of the edges that stay; `None` for a removed edge.
///
/// `ends` are the vertices of each edge, `None` for an end that carries no free jump: such an edge is a leaf there. The
/// order of removal is largest smaller degree, largest sum of degrees, lowest edge: it depends on nothing but the graph.
pub fn star_forest(ends: &[[Option<u32>; 2]]) -> Vec<Option<usize>> {
    let mut edges_of: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (edge, pair) in ends.iter().enumerate() {
        for vertex in pair.iter().flatten() {
            edges_of.entry(*vertex).or_default().push(edge);
        }
    }
    let mut degree: BTreeMap<u32, usize> = edges_of.iter().map(|(&v, e)| (v, e.len())).collect();
    let mut kept = vec![true; ends.len()];
    let rank = |degree: &BTreeMap<u32, usize>, edge: usize| {
        let [p, q] = ends[edge].map(|v| v.map_or(1, |v| degree[&v]));
        (p.min(q), p + q, Reverse(edge))
    };
    let mut heap: BinaryHeap<_> = (0..ends.len()).map(|e| rank(&degree, e)).collect();
    while let Some(entry @ (smaller, _, Reverse(edge))) = heap.pop() {
        if smaller < 2 {
            break;
        }
        // Degrees only fall: an entry that is out of date has a fresher one behind it.
        if !kept[edge] || entry != rank(&degree, edge) {
            continue;
        }
        kept[edge] = false;
        for vertex in ends[edge].iter().flatten() {
            if let Some(d) = degree.get_mut(vertex) {
                *d -= 1;
            }
        }
        let touched = ends[edge].iter().flatten().flat_map(|v| &edges_of[v]);
        heap.extend(touched.filter(|&&e| kept[e]).map(|&e| rank(&degree, e)));
    }
    // The edges of a star share its centre, the only vertex of degree 2 or more.
    let mut star_of: BTreeMap<u32, usize> = BTreeMap::new();
    let mut count = 0;
    (0..ends.len())
        .map(|edge| {
            kept[edge].then(|| {
                let joined = ends[edge].iter().flatten().find_map(|v| star_of.get(v));
                let star = joined.copied().unwrap_or(count);
                count += usize::from(star == count);
                for vertex in ends[edge].iter().flatten() {
                    star_of.insert(*vertex, star);
                }
                star
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn edges(list: &[(u32, u32)]) -> Vec<[Option<u32>; 2]> {
        list.iter().map(|&(a, b)| [Some(a), Some(b)]).collect()
    }

    #[test]
    fn parallel_edges_stay_and_a_zigzag_loses_its_links() {
        let parallel = edges(&[(0, 10), (1, 11), (2, 12)]);
        assert_eq!(star_forest(&parallel), [Some(0), Some(1), Some(2)]);
        // Zigzag 0-10-1-11-2-12 as a 45 degree crack makes it: every other edge is a link.
        let zigzag = edges(&[(0, 10), (1, 10), (1, 11), (2, 11), (2, 12)]);
        let stars = star_forest(&zigzag);
        assert_eq!(stars, [Some(0), None, Some(1), None, Some(2)]);
    }

    #[test]
    fn edges_to_a_held_node_join_at_their_free_end() {
        let stars = star_forest(&[[Some(0), None], [Some(0), None], [None, Some(1)]]);
        assert_eq!(stars, [Some(0), Some(0), Some(1)]);
    }

    proptest! {
        #[test]
        fn stars_span_all_vertices_and_every_edge_has_a_leaf(
            list in prop::collection::btree_set((0u32..12, 20u32..32), 1..60)
        ) {
            let list: Vec<(u32, u32)> = list.into_iter().collect();
            let stars = star_forest(&edges(&list));
            let mut degree = BTreeMap::new();
            for (&(a, b), star) in list.iter().zip(&stars) {
                for v in [a, b] {
                    *degree.entry(v).or_insert(0) += usize::from(star.is_some());
                }
            }
            prop_assert!(degree.values().all(|&d| d >= 1));
            for (&(a, b), star) in list.iter().zip(&stars) {
                if star.is_some() {
                    prop_assert!(degree[&a] == 1 || degree[&b] == 1);
                }
            }
            // A star is one connected piece: as many stars as vertices minus kept edges.
            let kept = stars.iter().flatten().count();
            prop_assert_eq!(degree.len() - kept, stars.iter().flatten().max().map_or(0, |s| s + 1));
        }
    }
}
