//! The border of a body: its facets and nodes in order along every side, so that a region finds its own among them.

use std::collections::BTreeMap;

use crate::cut::arrangement::DELTA;
use crate::geometry::Point;
use crate::mesh::{Facet, Mesh};

/// Convex polygons or segments.
pub type Parts = Vec<Vec<Point>>;

/// A condition on the place; comparisons of coordinates forgive δ [m].
pub trait Condition {
    /// Whether it holds at a place.
    fn holds(&self, x: &Point, delta: f64) -> bool;
    /// Its part of a convex polygon or segment, and the rest.
    fn split(&self, polygon: Vec<Point>, delta: f64) -> [Parts; 2];
    /// Lowest and highest coordinate along an axis where it can hold.
    fn range(&self, axis: usize) -> [f64; 2];
}

/// The part of the border that a support or load acts on.
#[derive(Clone, Copy)]
pub struct Region<'a> {
    /// One side of the box, or two or three that meet: their edge or corner.
    pub sides: &'a [String],
    /// Keeps only the part of the sides where it holds.
    pub condition: Option<&'a dyn Condition>,
}

/// Facets and nodes of the sides of a mesh.
pub struct Border<'a> {
    mesh: &'a Mesh,
    /// Bounds of regions closer than this to a node or a crack go through it [m].
    delta: f64,
    /// By node: the sides it lies on, one bit each.
    on: Vec<u8>,
    sides: BTreeMap<&'a str, Side>,
}

/// One side, in order along the axis of its largest extent.
struct Side {
    bit: u8,
    axis: usize,
    /// Largest extent of a facet [m].
    reach: f64,
    /// Facets with their lowest coordinate.
    facets: Vec<(f64, Facet)>,
}

/// A facet of the border, or an edge of one in a solid.
#[derive(Debug, Clone)]
pub struct BorderPart {
    /// Cell it belongs to.
    pub cell: usize,
    /// Its nodes in the numbers of the cell.
    pub local: Vec<usize>,
}

impl<'a> Border<'a> {
    /// Orders the sides of a mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        let mut border = Border {
            mesh,
            delta: (DELTA * mesh.smallest_edge()).max(mesh.rounding()),
            on: vec![0; mesh.nodes.len()],
            sides: BTreeMap::new(),
        };
        for (number, (name, facets)) in mesh.sides.iter().enumerate() {
            let bit = 1 << number;
            let nodes = || facets.iter().flat_map(|&f| mesh.facet_nodes(f));
            nodes().for_each(|n| border.on[n] |= bit);
            let span = |nodes: &mut dyn Iterator<Item = usize>, axis: usize| {
                let at = nodes.map(|n| mesh.nodes[n][axis]);
                at.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                    [a.min(x), b.max(x)]
                })
            };
            let extent = |[low, high]: [f64; 2]| high - low;
            let longest = |&a: &usize, &b: &usize| {
                let [a, b] = [a, b].map(|axis| extent(span(&mut nodes(), axis)));
                a.total_cmp(&b)
            };
            let axis = (0..mesh.dim()).max_by(longest).unwrap_or(0);
            let spans = facets
                .iter()
                .map(|&f| (f, span(&mut mesh.facet_nodes(f), axis)));
            let mut side = Side {
                bit,
                axis,
                reach: spans.clone().map(|s| extent(s.1)).fold(0.0, f64::max),
                facets: spans.map(|(f, [low, _])| (low, f)).collect(),
            };
            side.facets.sort_by(|a, b| a.0.total_cmp(&b.0));
            border.sides.insert(name, side);
        }
        border
    }

    /// Facets of the first side of a region that its range along the side can reach, in the order of cells.
    fn near(&self, region: &Region<'_>) -> Vec<Facet> {
        let side = region
            .sides
            .first()
            .and_then(|name| self.sides.get(name.as_str()));
        let Some(side) = side else {
            return Vec::new();
        };
        let [low, high] = match &region.condition {
            Some(condition) => condition.range(side.axis),
            None => [f64::NEG_INFINITY, f64::INFINITY],
        };
        let least = low - side.reach - 2.0 * self.delta;
        let from = side.facets.partition_point(|f| f.0 < least);
        let to = side.facets.partition_point(|f| f.0 <= high + self.delta);
        let mut found: Vec<Facet> = side.facets[from..to.max(from)]
            .iter()
            .map(|f| f.1)
            .collect();
        found.sort_by_key(|f| f.cell);
        found
    }

    /// Nodes of a region, sorted.
    pub fn nodes(&self, region: &Region<'_>) -> Vec<usize> {
        let all = self.bits(region);
        let holds = |x: &Point| (region.condition).is_none_or(|c| c.holds(x, self.delta));
        let near = self.near(region).into_iter();
        let mut nodes: Vec<usize> = near.flat_map(|f| self.mesh.facet_nodes(f)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.retain(|&n| self.on[n] & all == all && holds(&self.mesh.nodes[n]));
        nodes
    }

    /// Facets that can lie in a region of one side, or edges where its two sides meet: each belongs to one facet of the first.
    pub fn parts(&self, region: &Region<'_>) -> Vec<BorderPart> {
        let all = self.bits(region);
        let parts = self.near(region).into_iter().flat_map(|f| self.parts_of(f));
        let wanted = |part: &BorderPart| {
            self.sides_of(part) & all == all && (all.count_ones() == 1) == self.is_facet(part)
        };
        parts.filter(wanted).collect()
    }

    fn is_facet(&self, part: &BorderPart) -> bool {
        part.local.len() == self.mesh.kind.facets()[0].len()
    }

    /// A facet, and in a solid its edges.
    fn parts_of(&self, facet: Facet) -> Vec<BorderPart> {
        let local = self.mesh.kind.facets()[facet.local];
        let mut parts = vec![local.to_vec()];
        if local.len() > 2 {
            parts.extend((0..local.len()).map(|i| vec![local[i], local[(i + 1) % local.len()]]));
        }
        let part = |local| BorderPart {
            cell: facet.cell,
            local,
        };
        parts.into_iter().map(part).collect()
    }

    /// Facets of all sides, and in a solid their edges, of the cells that are asked for.
    pub fn parts_where(&self, cell: impl Fn(usize) -> bool) -> Vec<BorderPart> {
        let facets = self.mesh.sides.values().flatten();
        let wanted = facets.filter(|facet| cell(facet.cell));
        wanted.flat_map(|&facet| self.parts_of(facet)).collect()
    }

    /// Sides that a region names, one bit each.
    pub fn bits(&self, region: &Region<'_>) -> u8 {
        let sides = region
            .sides
            .iter()
            .filter_map(|s| self.sides.get(s.as_str()));
        sides.fold(0, |bits, side| bits | side.bit)
    }

    /// Sides that hold a part, one bit each.
    pub fn sides_of(&self, part: &BorderPart) -> u8 {
        self.nodes_of(part)
            .fold(u8::MAX, |bits, n| bits & self.on[n])
    }

    /// Nodes of a part.
    pub fn nodes_of(&self, part: &BorderPart) -> impl Iterator<Item = usize> + '_ {
        let cell = self.mesh.cell(part.cell);
        part.local.clone().into_iter().map(|i| cell[i] as usize)
    }

    /// Corners of a part [m].
    pub fn corners(&self, part: &BorderPart) -> Vec<Point> {
        self.nodes_of(part).map(|n| self.mesh.nodes[n]).collect()
    }

    /// Part of a convex piece of the border that a region holds, and the rest.
    pub fn split(&self, region: &Region<'_>, piece: Vec<Point>) -> [Parts; 2] {
        match region.condition {
            Some(condition) => condition.split(piece, self.delta),
            None => [vec![piece], vec![]],
        }
    }
}
