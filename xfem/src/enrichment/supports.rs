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

use crate::cut::crack::{Crack, HAIR, first_on};
use crate::cut::part::Place;
use crate::cut::partition::Partition;
use crate::cut::trace::Trace;
use crate::geometry::polygon::{self, border_distance, space_area};
use crate::geometry::{Point, norm, root, sub, unite};
use crate::mesh::Mesh;
use crate::mesh::neighbours::Neighbours;
use crate::quadrature::measure;

use super::cell_facets::clipped;

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
    trace: &Trace,
    partitions: &BTreeMap<usize, Partition>,
    beside: &BTreeMap<u32, Point>,
) -> Pieces {
    let near = Neighbours::new(mesh);
    let touched = mesh.nodes_of(partitions.keys().copied());
    let mut facets: BTreeMap<FacetKey, Vec<usize>> = BTreeMap::new();
    for cell in near.cells_around(&touched) {
        for local in mesh.kind.facets() {
            let facet = key(local.iter().map(|&i| mesh.cell(cell)[i]));
            facets.entry(facet).or_default().push(cell);
        }
    }
    let joiner = Joiner {
        on_crack: first_on(cracks),
        mesh,
        cracks,
        trace,
        partitions,
        beside,
    };
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
        let pieces = joiner.pieces(node, &cells, own);
        if !pieces.is_empty() {
            found.insert(node, pieces);
        }
    }
    found
}

/// Parts of some cells that a place of a plane body, in the closure of regions of theirs, is parted from by faces of other cracks
/// than some arms.
pub fn parted_from(
    mesh: &Mesh,
    arms: &[usize],
    x: &Point,
    cells: &BTreeSet<usize>,
    trace: &Trace,
    partitions: &BTreeMap<usize, Partition>,
) -> BTreeSet<Place> {
    let divided = || cells.iter().filter_map(|c| Some((*c, partitions.get(c)?)));
    let own = |crack: usize| arms.contains(&crack);
    if divided().all(|(_, p)| p.faces.iter().all(|f| own(f.crack))) {
        return BTreeSet::new();
    }
    let joiner = Joiner {
        mesh,
        cracks: &[],
        trace,
        partitions,
        beside: &BTreeMap::new(),
        on_crack: BTreeMap::new(),
    };
    let places: Vec<Place> = (cells.iter())
        .flat_map(|&cell| (0..joiner.regions(cell)).map(move |region| (cell, region)))
        .collect();
    let number = |place: &Place| places.binary_search(place).unwrap_or_default();
    let mut parent: Vec<usize> = (0..places.len()).collect();
    let mut join = |[one, two]: [Place; 2]| unite(&mut parent, number(&one), number(&two));
    let mut facets: BTreeMap<FacetKey, usize> = BTreeMap::new();
    for &cell in cells {
        for local in mesh.kind.facets() {
            let facet = key(local.iter().map(|&i| mesh.cell(cell)[i]));
            if let Some(other) = facets.insert(facet, cell) {
                joiner
                    .over(&facet, [other, cell])
                    .into_iter()
                    .for_each(&mut join);
            }
        }
    }
    for (cell, partition) in divided() {
        let faces = partition.faces.iter().filter(|f| own(f.crack));
        let faces = faces.map(|f| f.sides);
        let within = faces.filter(|sides| sides.iter().all(|side| cells.contains(&side.0)));
        let joined = partition.joined.iter();
        let joined = joined.map(|pair| pair.map(|region| (cell, region)));
        within.chain(joined).for_each(&mut join);
    }
    let near = |&&(cell, region): &&Place| {
        let map = mesh.map(cell);
        let outline = match partitions.get(&cell) {
            None => &map[..],
            Some(partition) => &partition.parts[region].polygon,
        };
        polygon::contains(outline, x) || border_distance(outline, x) <= 1e-9 * map.diagonal()
    };
    let held: BTreeSet<usize> = (places.iter().filter(near))
        .map(|place| root(&mut parent, number(place)))
        .collect();
    let away = |place: &Place| !held.contains(&root(&mut parent, number(place)));
    places.iter().copied().filter(away).collect()
}

fn key(nodes: impl Iterator<Item = u32>) -> FacetKey {
    let mut nodes: Vec<u32> = nodes.collect();
    nodes.sort_unstable();
    [0, 1, 2, 3].map(|i| nodes[i.min(nodes.len() - 1)])
}

/// The rule that tells which regions are joined.
struct Joiner<'a> {
    mesh: &'a Mesh,
    cracks: &'a [Crack],
    trace: &'a Trace,
    partitions: &'a BTreeMap<usize, Partition>,
    beside: &'a BTreeMap<u32, Point>,
    /// The first crack that runs through a node.
    on_crack: BTreeMap<u32, usize>,
}

impl Joiner<'_> {
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

    /// In 2D: over every part of the edge between two places on it.
    fn over_edge(&self, edge: [u32; 2], cells: [usize; 2]) -> Vec<[Place; 2]> {
        let [from, to] = edge.map(|n| self.mesh.nodes[n as usize]);
        let mut places: Vec<Point> = self.trace.on_edges.get(&edge).cloned().unwrap_or_default();
        places.insert(0, from);
        places.push(to);
        let region = |cell: usize, p: &Point, q: &Point| match self.partitions.get(&cell) {
            None => Some(0),
            Some(partition) => partition.beside(p, q),
        };
        let parts = places.windows(2).filter_map(|w| {
            let [one, two] = cells.map(|cell| region(cell, &w[0], &w[1]));
            Some([(cells[0], one?), (cells[1], two?)])
        });
        parts.collect()
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
        let mut joins = Vec::new();
        for one in 0..self.regions(cells[0]) {
            let own = self.clipped(&corners, face.clone(), (cells[0], one));
            for two in 0..self.regions(cells[1]) {
                let both = self.clipped(&corners, own.clone(), (cells[1], two));
                // Rounding leaves less.
                if space_area(&both) > 1e-26 * whole {
                    joins.push([(cells[0], one), (cells[1], two)]);
                }
            }
        }
        joins
    }

    /// The part of a polygon in a face that lies on the sides of a region.
    fn clipped(&self, nodes: &[u32], polygon: Vec<Point>, (cell, region): Place) -> Vec<Point> {
        match self.partitions.get(&cell) {
            None => polygon,
            Some(partition) => {
                let part = &partition.parts[region];
                clipped(self.mesh, self.cracks, nodes, part, polygon)
            }
        }
    }

    /// The pieces of the support of a node beyond its own.
    fn pieces(&self, node: u32, cells: &[usize], joins: &[[Place; 2]]) -> Vec<Vec<Place>> {
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
        let mut own = roots[self.own(node, &places)];
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

    /// The region a node belongs to: one that has it as a corner; on a crack one on side 1 of the first that runs there, or
    /// on the side that was asked for.
    fn own(&self, node: u32, places: &[Place]) -> usize {
        let x = &self.mesh.nodes[node as usize];
        // Beside a crack a hair away as on it: a piece that comes that close.
        let size = self.mesh.map(places[0].0).diagonal();
        let at_node = |&(cell, region): &Place| match self.partitions.get(&cell) {
            None => true,
            Some(partition) => {
                let part = &partition.parts[region];
                let mut corners = part.polygon.iter().chain(part.tetrahedra.iter().flatten());
                if self.beside.contains_key(&node) {
                    corners.any(|c| norm(&sub(c, x)) <= HAIR * size)
                } else {
                    corners.any(|c| c == x)
                }
            }
        };
        let crack = self.on_crack.get(&node).map(|&k| &self.cracks[k]);
        let wanted = self.beside.get(&node).zip(crack);
        let below = wanted.is_some_and(|(x, crack)| crack.distance(x) < 0.0);
        let above = |&(cell, region): &Place| {
            let middle = match self.partitions.get(&cell) {
                None => self.mesh.centre(cell),
                Some(partition) => partition.parts[region].middle(),
            };
            crack.is_none_or(|c| (c.distance(&middle) > 0.0) != below)
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
