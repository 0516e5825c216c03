//! Where on a crack the displacement jumps and is free to do so: what a multiplier can act on.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::crack::{End, PathVertex};
use crate::cut::part::Place;
use crate::enrichment::basis::{ABSENT, FunctionKind};
use crate::enrichment::facets::{Corner, CrackFacets, Facet};
use crate::geometry::{Point, norm, root, sub};
use crate::stiffness::cell_matrix::CellIntegrator;

/// Displacement at a crossed mesh edge or node.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Numbers of the jumps of the edge's ends that are free here; at a node the second is `None`. The same number stands for
    /// the jump of one node between the same two pieces of its support.
    pub ends: [Option<u32>; 2],
    /// Fraction w of the edge between its first end and the crack.
    pub fraction: f64,
}

/// The facets of a crack, and the functions that jump across it and are free to do so: in all directions but those in which
/// supports hold the jump on the whole crack.
pub struct FreeJumps<'a> {
    /// Facets.
    pub facets: CrackFacets,
    integrator: &'a CellIntegrator<'a>,
    index: usize,
    /// Functions that jump across it and are free to.
    free: BTreeSet<usize>,
}

impl<'a> FreeJumps<'a> {
    /// Of the `index`-th crack; `held` tells the prescribed unknowns.
    pub fn new(
        integrator: &'a CellIntegrator<'a>,
        index: usize,
        held: impl Fn(usize) -> bool,
    ) -> Self {
        let (mesh, enrichment) = (integrator.mesh, integrator.enrichment);
        let mut jumps = FreeJumps {
            facets: CrackFacets::new(mesh, index, &integrator.cracks[index], enrichment),
            integrator,
            index,
            free: BTreeSet::new(),
        };
        let all: BTreeSet<usize> = (jumps.facets.facets.iter())
            .flat_map(|facet| jumps.jumping_on(facet))
            .collect();
        let is_free = |f: usize, a: usize| !held(f * mesh.dim() + a);
        let moves = (0..mesh.dim()).filter(|&a| all.iter().any(|&f| is_free(f, a)));
        let moves: Vec<usize> = moves.collect();
        let of_all = all
            .into_iter()
            .filter(|&f| moves.iter().all(|&a| is_free(f, a)));
        jumps.free = of_all.collect();
        jumps
    }

    /// Nodes whose functions do not vanish on a facet: those that its cells share.
    fn nodes_of(&self, facet: &Facet) -> impl Iterator<Item = u32> + use<'a> {
        let [one, two] = facet.sides.map(|side| self.integrator.mesh.cell(side.0));
        one.iter().copied().filter(|node| two.contains(node))
    }

    /// Functions that jump across a facet.
    fn jumping_on(&self, facet: &Facet) -> impl Iterator<Item = usize> {
        let (nodes, sides) = (self.nodes_of(facet), facet.sides);
        nodes.flat_map(move |n| self.jumping(n, sides))
    }

    /// Functions that jump where no multiplier of the crack can be: on a stretch of it without a free jump, beside supports
    /// that hold them in part. Nothing would resist what is left of their jumps.
    pub fn unguarded(&self) -> BTreeSet<usize> {
        let facets = &self.facets.facets;
        let mut parent: Vec<usize> = (0..self.facets.corners.len()).collect();
        for facet in facets {
            for w in facet.corners.windows(2) {
                let [a, b] = [0, 1].map(|i| root(&mut parent, w[i]));
                parent[a.max(b)] = a.min(b);
            }
        }
        let mut stretch = |facet: &Facet| facet.corners.first().map(|&c| root(&mut parent, c));
        let free = facets.iter().filter(|f| self.jumps_on(f));
        let guarded: BTreeSet<Option<usize>> = free.map(&mut stretch).collect();
        let bare = facets.iter().filter(|f| !guarded.contains(&stretch(f)));
        bare.flat_map(|facet| self.jumping_on(facet)).collect()
    }

    /// Functions of a node that jump between two places.
    fn jumping(&self, node: u32, sides: [Place; 2]) -> Vec<usize> {
        let enrichment = self.integrator.enrichment;
        let jumps = |f: &usize| match enrichment.functions[*f].kind {
            FunctionKind::Piece { .. } => enrichment.step_across(sides, *f).is_some(),
            FunctionKind::Branch { tip, order: 0 } => {
                let lives = |side| enrichment.step(side, *f) != ABSENT;
                enrichment.jumps_over(tip as usize, self.index) && sides.into_iter().all(lives)
            }
            _ => false,
        };
        enrichment
            .enriched_of(node as usize)
            .filter(jumps)
            .collect()
    }

    /// Copies of a node on both sides of the crack, if it jumps there and is free to; 0: its own.
    fn jump(&self, node: u32, sides: [Place; 2]) -> Option<[usize; 2]> {
        let enrichment = self.integrator.enrichment;
        let mut copies = [0, 0];
        for (k, f) in enrichment.enriched_of(node as usize).enumerate() {
            if let FunctionKind::Piece { .. } = enrichment.functions[f].kind {
                for (copy, side) in copies.iter_mut().zip(sides) {
                    if enrichment.step(side, f) != 0.0 {
                        *copy = k + 1;
                    }
                }
            }
        }
        let mut jumping = self.jumping(node, sides).into_iter();
        jumping.any(|f| self.free.contains(&f)).then_some(copies)
    }

    /// Role of every corner; `None` where no multiplier can live: inside cells, at tips, where all is held.
    pub fn crossings(&self) -> Vec<Option<Crossing>> {
        let mesh = self.integrator.mesh;
        let enrichment = self.integrator.enrichment;
        let sizes = &enrichment.lengths.of_nodes;
        let mut numbers: BTreeMap<(u32, [usize; 2]), u32> = BTreeMap::new();
        let mut crossing = |corner: &Corner| {
            let [i, j] = corner.nodes?;
            if enrichment.is_at_tip(&corner.x, sizes[i as usize].min(sizes[j as usize])) {
                return None;
            }
            let mut free = |node: u32| {
                let [one, two] = self.jump(node, corner.sides)?;
                let next = numbers.len() as u32;
                let pair = [one.min(two), one.max(two)];
                Some(*numbers.entry((node, pair)).or_insert(next))
            };
            let ends = [free(i), if i == j { None } else { free(j) }];
            let away = |node: u32| norm(&sub(&corner.x, &mesh.nodes[node as usize]));
            let [from, to] = [away(i), away(j)];
            ends.iter().any(Option::is_some).then_some(Crossing {
                ends,
                fraction: if i == j { 0.0 } else { from / (from + to) },
            })
        };
        self.facets.corners.iter().map(&mut crossing).collect()
    }

    /// Of an arm of a short crack, with functions of both ends, that jumps: where it starts, and how far from there its
    /// multipliers are: at equal distances of about a cell, and beside a bend [m].
    pub fn short(&self) -> Option<(Point, Vec<f64>)> {
        /// How far from a bend, in parts: there the faces begin to slide another way (without, dissipation +20 %, with 0.3 +6, with
        /// 0.1 within 1).
        const BESIDE: f64 = 0.1;
        let (mesh, enrichment) = (self.integrator.mesh, self.integrator.enrichment);
        let (crack, facets) = (&self.integrator.cracks[self.index], &self.facets.facets);
        if !enrichment.is_short(self.index) || !facets.iter().any(|facet| self.jumps_on(facet)) {
            return None;
        }
        let cells = enrichment.cut_by(self.index).iter();
        let nodes = cells.flat_map(|&cell| mesh.cell(cell));
        let sizes = nodes.map(|&node| enrichment.lengths.of_nodes[node as usize]);
        let size = sizes.fold(f64::INFINITY, f64::min);
        let corners = self.facets.corners.iter();
        let mut places: Vec<_> = corners.map(|c| (crack.abscissa(&c.x), c.x)).collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let length = places.last()?.0 - places.first()?.0;
        let parts = (length / size).round().max(1.0);
        let part = length / parts;
        let mut found: Vec<f64> = (0..=parts as usize).map(|k| k as f64 * part).collect();
        if crack.ends[0] == End::Bend {
            found.insert(1, BESIDE * part);
        }
        if crack.ends[1] == End::Bend {
            found.insert(found.len() - 1, length - BESIDE * part);
        }
        (length > 0.0).then_some((places[0].1, found))
    }

    /// Where the arm has multipliers of its own in corners, with the distance from there of the second [m]; the facets are parted
    /// there.
    pub fn part_at_corners(&mut self) -> Vec<(Point, f64)> {
        let enrichment = self.integrator.enrichment;
        self.facets.part_at_corners(enrichment, self.index);
        let own = enrichment.corners_of(self.index);
        own.map(|corner| (corner.x, corner.second())).collect()
    }

    /// Where corners of facets lie along the arm, in 1e-9 of its length, from its end nearer to the middle of the body: the same
    /// however the crack is read. 0 in a solid.
    pub fn along(&self) -> impl Fn(usize) -> i64 {
        let (extent, middle) = self.integrator.enrichment.lengths.extent;
        let crack = &self.integrator.cracks[self.index];
        let round = |v: f64| (v * 1e9).round() as i64;
        let key = |vertex: &PathVertex| {
            let d = sub(&vertex.x, &middle).map(|v| v / extent);
            (round(norm(&d)), d.map(round))
        };
        let [first, last] = [crack.path.first(), crack.path.last()].map(|v| v.map(key));
        let sign = if first <= last { 1.0 } else { -1.0 };
        let length = crack.range[1] - crack.range[0];
        move |corner| round(sign * crack.abscissa(&self.facets.corners[corner].x) / length)
    }

    /// Whether anything free jumps on a facet.
    pub fn jumps_on(&self, facet: &Facet) -> bool {
        let mut nodes = self.nodes_of(facet);
        nodes.any(|n| self.jump(n, facet.sides).is_some())
    }
}
