//! The connected pieces of the supports of nodes: which functions a cut body needs.
//!
//! The support of N_i less all crack faces falls into pieces. Every piece beyond that of the node itself gets a function of
//! its own, N_i on the piece and 0 elsewhere. One crack gives the span of the shifted Heaviside function; crossings,
//! junctions, kinks, several cracks in a cell and ends anywhere need no rule of their own, and the functions of a node are
//! independent because pieces are disjoint (Hansbo & Hansbo, Comput. Meth. Appl. Mech. Engng 193 (2004) 3523; Song, Areias &
//! Belytschko, Int. J. Numer. Meth. Engng 67 (2006) 868; Richardson, Hegemann, Sifakis, Hellrung & Teran, Int. J. Numer.
//! Meth. Engng 88 (2011) 1042).
//!
//! Regions of neighbouring cells are joined over what the cracks leave of the facet between them.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::arrangement::Arrangement;
use crate::cut::crack::{Crack, first_on};
use crate::cut::part::{FaceCorner, Place};
use crate::cut::partition::Partition;
use crate::geometry::polygon::{self, space_area};
use crate::geometry::{Point, root, unite};
use crate::mesh::Mesh;
use crate::mesh::neighbours::Neighbours;
use crate::quadrature::measure;

use super::cell_facets::parted;
use super::tips::Tips;

/// A node's own piece no region of which is larger than this part of a cell is no longer its own: the largest piece is.
const SLIVER: f64 = 1e-9;

/// The pieces of the supports of nodes beyond the node's own, by node: the regions of each.
pub type Pieces = BTreeMap<u32, Vec<Vec<Place>>>;

/// Nodes of a facet in rising order; the last repeated on an edge.
type FacetKey = [u32; 4];

/// Finds the pieces of the supports of all nodes of divided cells. `beside`: as in [`Enrichment::new`](super::Enrichment::new).
pub fn support_pieces(
    mesh: &Mesh,
    cracks: &[Crack],
    arrangement: &Arrangement,
    tips: &Tips,
    beside: &BTreeMap<u32, Point>,
) -> Pieces {
    let near = Neighbours::new(mesh);
    let touched = mesh.nodes_of(tips.partitions.keys().copied());
    let mut facets: BTreeMap<FacetKey, Vec<usize>> = BTreeMap::new();
    for cell in near.cells_around(&touched) {
        for local in mesh.kind.facets() {
            let facet = key(local.iter().map(|&i| mesh.cell(cell)[i]));
            facets.entry(facet).or_default().push(cell);
        }
    }
    let joiner = Joiner {
        mesh,
        cracks,
        arrangement,
        partitions: &tips.partitions,
        parted: &tips.parted,
    };
    let on_crack = first_on(cracks);
    let mut joins: BTreeMap<u32, Vec<[Place; 2]>> = BTreeMap::new();
    for (facet, cells) in &facets {
        let &[one, two] = cells.as_slice() else {
            continue;
        };
        let own = joiner.over(facet, [one, two]);
        let nodes: BTreeSet<u32> = facet.iter().copied().collect();
        for node in nodes.intersection(&touched).copied() {
            joins.entry(node).or_default().extend(&own);
        }
    }
    let mut found = Pieces::new();
    for node in touched {
        let own = joins.get(&node).map_or(&[][..], Vec::as_slice);
        let cells: Vec<usize> = near.cells_around(&[node].into()).into_iter().collect();
        let crack = on_crack.get(&node).map(|&k| &cracks[k]);
        let pieces = joiner.pieces(
            node,
            &cells,
            own,
            crack.map(|crack| (crack, beside.get(&node))),
        );
        if !pieces.is_empty() {
            found.insert(node, pieces);
        }
    }
    found
}

fn key(nodes: impl Iterator<Item = u32>) -> FacetKey {
    let mut nodes: Vec<u32> = nodes.collect();
    nodes.sort_unstable();
    [0, 1, 2, 3].map(|i| nodes[i.min(nodes.len() - 1)])
}

/// The rule that tells which regions are joined.
pub(super) struct Joiner<'a> {
    pub mesh: &'a Mesh,
    pub cracks: &'a [Crack],
    pub arrangement: &'a Arrangement,
    pub partitions: &'a BTreeMap<usize, Partition>,
    /// See [`Tips::parted`].
    pub parted: &'a BTreeSet<([u32; 2], usize)>,
}

impl Joiner<'_> {
    /// Parts of some cells that an end in the plane, in the closure of the cells `at`, is parted from by faces of other cracks than some
    /// arms.
    pub fn parted_from(
        &self,
        arms: &[usize],
        (x, at): (&Point, &[usize]),
        cells: &BTreeSet<usize>,
    ) -> BTreeSet<Place> {
        let divided = || {
            cells
                .iter()
                .filter_map(|c| Some((*c, self.partitions.get(c)?)))
        };
        if divided().all(|(_, p)| p.arms().all(|arm| arms.contains(&arm))) {
            return BTreeSet::new();
        }
        let places: Vec<Place> = (cells.iter())
            .flat_map(|&cell| (0..self.regions(cell)).map(move |region| (cell, region)))
            .collect();
        let number = |place: &Place| places.binary_search(place).ok();
        let mut parent: Vec<usize> = (0..places.len()).collect();
        let mut join = |pair: [Place; 2]| {
            if let [Some(one), Some(two)] = pair.map(|place| number(&place)) {
                unite(&mut parent, one, two);
            }
        };
        let mut facets: BTreeMap<FacetKey, usize> = BTreeMap::new();
        for &cell in cells {
            for local in self.mesh.kind.facets() {
                let facet = key(local.iter().map(|&i| self.mesh.cell(cell)[i]));
                if let Some(other) = facets.insert(facet, cell) {
                    let joined = self.over(&facet, [other, cell]);
                    joined.into_iter().for_each(&mut join);
                }
            }
        }
        for (cell, partition) in divided() {
            let faces = partition.faces.iter().filter(|f| arms.contains(&f.crack));
            let beyond = partition.joined.iter();
            let pairs = faces.map(|f| f.sides);
            let pairs = pairs.chain(beyond.map(|pair| pair.map(|region| (cell, region))));
            pairs.for_each(&mut join);
        }
        let near = |&&(cell, region): &&Place| match self.partitions.get(&cell) {
            None => at.contains(&cell),
            Some(partition) => {
                let outline = &partition.parts[region].polygon;
                outline.contains(x) || at == [cell] && polygon::contains(outline, x)
            }
        };
        let held: BTreeSet<usize> = (places.iter().filter(near))
            .filter_map(|place| Some(root(&mut parent, number(place)?)))
            .collect();
        let roots: Vec<usize> = (0..places.len()).map(|i| root(&mut parent, i)).collect();
        let away = places
            .iter()
            .zip(roots)
            .filter(|(_, root)| !held.contains(root));
        away.map(|(place, _)| *place).collect()
    }

    fn regions(&self, cell: usize) -> usize {
        self.partitions.get(&cell).map_or(1, |p| p.parts.len())
    }

    /// Regions of two cells that are joined over the facet between them.
    fn over(&self, facet: &FacetKey, cells: [usize; 2]) -> Vec<[Place; 2]> {
        if cells.iter().all(|cell| !self.partitions.contains_key(cell)) {
            return vec![cells.map(|cell| (cell, 0))];
        }
        if self.mesh.dim() == 2 {
            self.over_edge([facet[0], facet[1]], cells)
        } else {
            self.over_face(facet, cells)
        }
    }

    /// In 2D: over every piece of the edge between two places on it, but those that cracks run along.
    fn over_edge(&self, edge: [u32; 2], cells: [usize; 2]) -> Vec<[Place; 2]> {
        let count = self.arrangement.on_edge(edge).count() + 1;
        let [one, two] = cells.map(|cell| match self.partitions.get(&cell) {
            None => vec![0; count],
            Some(partition) => {
                let nodes = self.mesh.cell(cell);
                let next = |i: usize| nodes[(i + 1) % nodes.len()];
                let local =
                    (0..nodes.len()).find(|&i| edge.contains(&nodes[i]) && edge.contains(&next(i)));
                let local = local.unwrap_or_default();
                let pieces = partition.along(local).filter(|piece| piece.at_place);
                let pieces = pieces.map(|piece| piece.region);
                // From the lower node on.
                if nodes[local] == edge[0] {
                    pieces.collect()
                } else {
                    pieces.rev().collect()
                }
            }
        });
        let pieces = one.into_iter().zip(two).enumerate();
        let open = pieces.filter(|(k, _)| !self.parted.contains(&(edge, *k)));
        open.map(|(_, (one, two))| [(cells[0], one), (cells[1], two)])
            .collect()
    }

    /// In 3D: where the polygons that the regions leave of the face overlap.
    fn over_face(&self, facet: &FacetKey, cells: [usize; 2]) -> Vec<[Place; 2]> {
        let nodes = self.mesh.cell(cells[0]);
        let facets = self.mesh.kind.facets().iter();
        let mut corners = facets.map(|l| l.iter().map(|&i| nodes[i]).collect::<Vec<u32>>());
        let corners = corners.find(|own| key(own.iter().copied()) == *facet);
        let corners = corners.unwrap_or_default();
        let at = |&n: &u32| self.mesh.nodes[n as usize];
        let face: Vec<Point> = corners.iter().map(at).collect();
        let whole = space_area(&face);
        let corners: Vec<FaceCorner> = face.iter().map(|x| (*x, None)).collect();
        let clipped = |(cell, region): Place, polygon| match self.partitions.get(&cell) {
            None => polygon,
            Some(own) => own.clipped(self.cracks, region, polygon),
        };
        let mut joins = Vec::new();
        let beside = |(cell, region): Place| {
            let own = self.partitions.get(&cell);
            own.is_some_and(|own| parted(self.cracks, &own.parts[region], &face))
        };
        for one in (0..self.regions(cells[0])).filter(|&one| !beside((cells[0], one))) {
            let own = clipped((cells[0], one), corners.clone());
            for two in 0..self.regions(cells[1]) {
                let both = clipped((cells[1], two), own.clone());
                let both: Vec<Point> = both.into_iter().map(|corner| corner.0).collect();
                // Rounding leaves less.
                if space_area(&both) > 1e-26 * whole {
                    joins.push([(cells[0], one), (cells[1], two)]);
                }
            }
        }
        joins
    }

    /// The pieces of the support of a node beyond its own.
    fn pieces(
        &self,
        node: u32,
        cells: &[usize],
        joins: &[[Place; 2]],
        crack: Option<(&Crack, Option<&Point>)>,
    ) -> Vec<Vec<Place>> {
        let own = |&cell: &usize| (0..self.regions(cell)).map(move |region| (cell, region));
        let places: Vec<Place> = cells.iter().flat_map(own).collect();
        let number = |place: &Place| places.binary_search(place).unwrap_or_default();
        let mut parent: Vec<usize> = (0..places.len()).collect();
        let divided = |&c: &usize| Some((c, self.partitions.get(&c)?));
        let inside = cells.iter().filter_map(divided);
        let within = inside.flat_map(|(cell, partition)| {
            let pairs = partition.joined.iter();
            pairs.map(move |pair| pair.map(|region| (cell, region)))
        });
        for [one, two] in joins.iter().copied().chain(within) {
            unite(&mut parent, number(&one), number(&two));
        }
        let roots: Vec<usize> = (0..places.len()).map(|i| root(&mut parent, i)).collect();
        let mut own = roots[self.own(node, &places, crack)];
        let of = |piece: usize| {
            let both = places.iter().zip(&roots);
            both.filter(move |(_, root)| **root == piece)
                .map(|own| self.measure(own.0))
        };
        let size = self.mesh.map(places[0].0).diagonal();
        let least = SLIVER * size.powi(self.mesh.dim() as i32);
        // The node's own function is what those of the other pieces leave of N_i: of a sliver nothing but rounding.
        if of(own).all(|measure| measure < least) {
            let sum = |piece: &usize| of(*piece).sum::<f64>();
            let larger = |one: &usize, two: &usize| sum(one).total_cmp(&sum(two));
            own = roots.iter().copied().max_by(larger).unwrap_or(own);
        }
        let mut pieces: BTreeMap<usize, Vec<Place>> = BTreeMap::new();
        for (place, root) in places.into_iter().zip(roots) {
            if root != own {
                pieces.entry(root).or_default().push(place);
            }
        }
        pieces.into_values().collect()
    }

    /// Area or volume of a region.
    fn measure(&self, &(cell, region): &Place) -> f64 {
        match self.partitions.get(&cell) {
            None => measure(&self.mesh.map(cell)),
            Some(partition) => partition.parts[region].measure(),
        }
    }

    /// The region a node belongs to: one that has it as a corner; on a crack one on side 1 of it, or on the side that was asked for.
    fn own(&self, node: u32, places: &[Place], crack: Option<(&Crack, Option<&Point>)>) -> usize {
        let x = &self.mesh.nodes[node as usize];
        let at_node = |&(cell, region): &Place| match self.partitions.get(&cell) {
            None => true,
            Some(partition) => partition.parts[region].corners().any(|c| c == x),
        };
        let below =
            crack.is_some_and(|(crack, beside)| beside.is_some_and(|x| crack.distance(x) < 0.0));
        let above = |&(cell, region): &Place| {
            let middle = match self.partitions.get(&cell) {
                None => self.mesh.centre(cell),
                Some(partition) => partition.parts[region].middle(),
            };
            crack.is_none_or(|(c, _)| (c.distance(&middle) > 0.0) != below)
        };
        let mut best = 0;
        let mut found = 0;
        for (i, place) in places.iter().enumerate() {
            let rank = match (at_node(place), found) {
                (true, 0 | 1) if above(place) => 2,
                (true, 0) => 1,
                _ => 0,
            };
            if rank > found {
                (best, found) = (i, rank);
            }
        }
        best
    }
}
