//! Multiplier spaces on the crack surface: which contact point speaks for which corner of a facet.
//!
//! ```text
//!   λ_h(x) = Σ_corners hat_c(x) Σ_k share_ck λ_k            Σ_k share_ck = 1
//!
//!   star    one multiplier per star of crossed edges; a crossed edge (i, j) that belongs to none, cut at the fraction w
//!           from i, takes (1 − w) λ_star(i) + w λ_star(j)                      (Géniaut, Massin & Moës 2007);
//!           where the crack turns along a star, each of its edges has one;
//!           an arm with branch functions at a corner has two of its own there: in the corner and a little way from it,
//!           or the pressure of a corner would be that of the next crossing
//! ```
//!
//! An arm of a short crack with functions of both ends has linear functions on equal parts of about a cell: the few edges that it
//! crosses would leave it one or two, under which its faces turn into each other.
//!
//! Corners whose jump is prescribed, tips, and facets too small to have an equation of their own take the mean of their
//! neighbours along the crack: a constant continuation that leaves no multiplier without a jump to act on.

use std::collections::{BTreeMap, BTreeSet};

use crate::enrichment::facets::CrackFacets;
use crate::geometry::{Point, add_scaled, dot, norm, sub, unit};

use super::free_jumps::{Crossing, FreeJumps};
use super::star_forest::star_forest;

/// Contact points and their part in a value, summing to one.
pub type Shares = Vec<(u32, f64)>;

/// A multiplier space: shares of every corner of every facet.
#[derive(Debug, Clone)]
pub struct Multipliers {
    /// Number of multipliers.
    pub count: usize,
    /// Per facet and corner; empty where a crack carries no multiplier at all.
    pub shares: Vec<Vec<Shares>>,
}

/// The given multiplier of every corner.
pub fn pair_space(facets: &CrackFacets, number: &[Option<u32>]) -> Multipliers {
    let own = number.iter().map(|k| k.map(|k| vec![(k, 1.0)])).collect();
    let count = number.iter().flatten().count();
    by_corner(facets, own, count)
}

/// One multiplier per star of crossings, and two at the ends of arms in corners.
pub fn star_space(free: &mut FreeJumps<'_>) -> Multipliers {
    if let Some((from, places)) = free.short() {
        return even_space(free, &from, &places);
    }
    let ends = free.part_at_corners();
    let crossings = free.crossings();
    let near: Vec<_> = (0..crossings.len())
        .filter_map(|corner| Some((corner, near_end(free, &ends, corner)?)))
        .collect();
    let mut edges: Vec<(usize, Crossing)> = crossings
        .iter()
        .enumerate()
        .filter(|(corner, _)| near.binary_search_by_key(corner, |n| n.0).is_err())
        .filter_map(|(corner, crossing)| crossing.map(|c| (corner, c)))
        .collect();
    // Which of equal edges leaves the forest must not depend on how the crack is read.
    let along = free.along();
    edges.sort_by_cached_key(|(corner, _)| along(*corner));
    let pairs: Vec<_> = edges.iter().map(|(_, c)| c.ends).collect();
    let stars = part_bent(&free.facets, &edges, star_forest(&pairs));
    let mut stars_of: BTreeMap<u32, BTreeSet<usize>> = BTreeMap::new();
    for (pair, star) in pairs.iter().zip(&stars) {
        for node in pair.iter().flatten() {
            stars_of.entry(*node).or_default().extend(star);
        }
    }
    let mut own = vec![None; crossings.len()];
    for ((corner, crossing), star) in edges.iter().zip(&stars) {
        own[*corner] = Some(match (star, crossing.ends) {
            (Some(star), _) => vec![(*star as u32, 1.0)],
            (None, ends) => {
                let parts = ends
                    .into_iter()
                    .zip([1.0 - crossing.fraction, crossing.fraction]);
                let shares = parts.filter_map(|(end, part)| Some((stars_of.get(&end?)?, part)));
                shares
                    .flat_map(|(stars, part)| {
                        let share = part / stars.len() as f64;
                        stars.iter().map(move |&star| (star as u32, share))
                    })
                    .collect()
            }
        });
    }
    let count = stars.iter().flatten().max().map_or(0, |s| s + 1);
    for (corner, (k, share)) in near {
        let first = (count + 2 * k) as u32;
        let shares = [(first, share), (first + 1, 1.0 - share)].into_iter();
        own[corner] = Some(shares.filter(|s| s.1 > 0.0).collect());
    }
    let count = count + 2 * ends.len();
    complete(free, by_corner(&free.facets, own, count))
}

/// Linear functions between places of an arm, given by their distances from its start [m].
fn even_space(free: &mut FreeJumps<'_>, from: &Point, places: &[f64]) -> Multipliers {
    /// Rounding of places, in parts.
    const ROUNDING: f64 = 1e-6;
    let inner = &places[1..places.len() - 1];
    inner
        .iter()
        .for_each(|&place| free.facets.part(from, place));
    let own = free.facets.corners.iter().map(|corner| {
        let away = norm(&sub(&corner.x, from));
        let next = places
            .partition_point(|place| *place <= away)
            .clamp(1, places.len() - 1);
        let (low, high) = (places[next - 1], places[next]);
        let share = ((away - low) / (high - low)).clamp(0.0, 1.0);
        let share = if share < ROUNDING { 0.0 } else { share };
        let share = if share > 1.0 - ROUNDING { 1.0 } else { share };
        let shares = [(next as u32 - 1, 1.0 - share), (next as u32, share)].into_iter();
        Some(shares.filter(|s| s.1 > 0.0).collect())
    });
    let own = own.collect();
    by_corner(&free.facets, own, places.len())
}

/// Gives every crossing of a star along which the crack turns a multiplier of its own: held together by one, faces that slide along
/// a curve overlap by about half of its turn.
fn part_bent(
    facets: &CrackFacets,
    edges: &[(usize, Crossing)],
    mut stars: Vec<Option<usize>>,
) -> Vec<Option<usize>> {
    /// Turn above which they do [rad]: without, slip on arcs of 4 cells' radius was 6 to 14 % low, and a tenth to a fifth of it overlap.
    const TURN: f64 = 0.05;
    let mut normals = vec![[0.0; 3]; facets.corners.len()];
    for facet in &facets.facets {
        for &corner in &facet.corners {
            normals[corner] = add_scaled(&normals[corner], 1.0, &facet.frame[0]);
        }
    }
    let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (edge, star) in stars.iter().enumerate() {
        if let Some(star) = *star {
            members.entry(star).or_default().push(edge);
        }
    }
    let mut count = members.len();
    for own in members.into_values() {
        let normal = |edge: usize| unit(&normals[edges[edge].0]);
        let first = normal(own[0]);
        if own
            .iter()
            .any(|&edge| dot(&first, &normal(edge)) < TURN.cos())
        {
            for &edge in &own[1..] {
                stars[edge] = Some(count);
                count += 1;
            }
        }
    }
    stars
}

/// The end of the arm to which a corner of facets is so near that its multipliers speak there, and the share of the one in
/// the end itself: linear up to the distance of the other, which goes on from there as far again.
fn near_end(free: &FreeJumps<'_>, ends: &[(Point, f64)], corner: usize) -> Option<(usize, f64)> {
    let x = &free.facets.corners[corner].x;
    let away = ends.iter().map(|(end, d)| norm(&sub(x, end)) / d);
    let nearest = away.enumerate().filter(|(_, r)| *r < 2.0);
    let (k, r) = nearest.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let share = (1.0 - r).clamp(0.0, 1.0);
    // Rounding of places.
    Some((k, if share < 1e-6 { 0.0 } else { share }))
}

/// Gives facets with jumps that no multiplier reaches a constant one, common to those that share corners: next to a junction
/// the nodes of one cell may jump over an arm that ends in the next.
fn complete(free: &FreeJumps<'_>, mut multipliers: Multipliers) -> Multipliers {
    let facets = &free.facets.facets;
    let bare = |shares: &[Shares]| shares.iter().any(Vec::is_empty);
    let around = groups_of(facets.iter().map(|facet| &facet.corners));
    for first in 0..facets.len() {
        if !bare(&multipliers.shares[first]) || !free.jumps_on(&facets[first]) {
            continue;
        }
        let own = multipliers.count as u32;
        multipliers.count += 1;
        let mut reached = vec![first];
        while let Some(facet) = reached.pop() {
            let shares = &mut multipliers.shares[facet];
            if bare(shares) {
                shares.iter_mut().for_each(|all| *all = vec![(own, 1.0)]);
                reached.extend(
                    facets[facet]
                        .corners
                        .iter()
                        .flat_map(|corner| &around[corner]),
                );
            }
        }
    }
    multipliers
}

/// By item: the groups that hold it, ascending.
fn groups_of<'a>(groups: impl Iterator<Item = &'a Vec<usize>>) -> BTreeMap<usize, Vec<usize>> {
    let mut found: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (group, items) in groups.enumerate() {
        items
            .iter()
            .for_each(|&item| found.entry(item).or_default().push(group));
    }
    found
}

/// Extends the shares of some corners to all of them.
fn by_corner(facets: &CrackFacets, mut own: Vec<Option<Shares>>, count: usize) -> Multipliers {
    let groups: Vec<Vec<usize>> = facets.facets.iter().map(|f| f.corners.clone()).collect();
    extend(&mut own, &groups);
    let shares = groups
        .iter()
        .map(|list| {
            list.iter()
                .map(|&c| own[c].clone().unwrap_or_default())
                .collect()
        })
        .collect();
    Multipliers { count, shares }
}

/// Gives every item without shares the mean of its neighbours, ring by ring; items of one group are neighbours.
fn extend(own: &mut [Option<Shares>], groups: &[Vec<usize>]) {
    let around = groups_of(groups.iter());
    let beside = |item: usize| {
        around
            .get(&item)
            .into_iter()
            .flatten()
            .flat_map(|&g| &groups[g])
    };
    let mut ring: Vec<usize> = (0..own.len()).filter(|&item| own[item].is_some()).collect();
    while !ring.is_empty() {
        let next = ring.iter().flat_map(|&item| beside(item));
        let next: BTreeSet<usize> = next.copied().filter(|&item| own[item].is_none()).collect();
        let of = |item: usize| {
            mean(
                &beside(item)
                    .filter_map(|&i| own[i].as_ref())
                    .collect::<Vec<_>>(),
            )
        };
        let means: Vec<Shares> = next.iter().map(|&item| of(item)).collect();
        ring = next.into_iter().collect();
        for (&item, shares) in ring.iter().zip(means) {
            own[item] = Some(shares);
        }
    }
}

fn mean(list: &[&Shares]) -> Shares {
    let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
    for &(k, value) in list.iter().flat_map(|shares| shares.iter()) {
        *sum.entry(k).or_default() += value / list.len() as f64;
    }
    sum.into_iter().collect()
}
