//! The crack surface inside the cut cells: polygons (2D: segments) whose corners lie on mesh edges, at nodes or inside cells.

use std::collections::BTreeMap;

use crate::cut::crack::{Crack, Geometry};
use crate::cut::part::{FaceCorner, Place};
use crate::geometry::boxes::{Boxes, around};
use crate::geometry::clip::{bent_crossing, clip_with};
use crate::geometry::polygon::space_area;
use crate::geometry::{Point, add_scaled, norm, sub};
use crate::mesh::Mesh;

use super::Enrichment;

/// Corner of facets.
#[derive(Debug, Clone, Copy)]
pub struct Corner {
    /// Position [m].
    pub x: Point,
    /// Ends of the mesh edge it lies on, lower number first; equal at a node; `None` inside a cell.
    pub nodes: Option<[u32; 2]>,
    /// Places there on side 1 and side 2.
    pub sides: [Place; 2],
}

/// A piece of a crack between two regions, of one cell or of two.
#[derive(Debug, Clone)]
pub struct Facet {
    /// Corners: two along the crack (2D) or a convex polygon in cyclic order.
    pub corners: Vec<usize>,
    /// Places on side 1 and side 2.
    pub sides: [Place; 2],
    /// Frame n, a, b of the piece itself: a bent 2D crack is a chain of chords.
    pub frame: [Point; 3],
    /// The cell that a 3D front cut the piece from.
    pub front: Option<FrontCut>,
}

/// A face cut off by a front.
#[derive(Debug, Clone)]
pub struct FrontCut {
    /// Where the front crosses its border [m].
    pub chord: [Point; 2],
    /// The whole face.
    pub face: Vec<Point>,
}

/// All facets of one crack.
#[derive(Debug, Clone, Default)]
pub struct CrackFacets {
    /// Corners, those on mesh edges shared between cells.
    pub corners: Vec<Corner>,
    /// Facets in the order of their cells.
    pub facets: Vec<Facet>,
}

impl CrackFacets {
    /// Facets of the `index`-th crack, up to its tips or front.
    pub fn new(mesh: &Mesh, index: usize, crack: &Crack, enrichment: &Enrichment) -> Self {
        let cells = enrichment.cut_by(index).iter().copied();
        Self::of_cells(mesh, cells, index, crack, enrichment)
    }

    /// Facets of the `index`-th crack in one cell.
    pub fn of_cell(
        mesh: &Mesh,
        cell: usize,
        index: usize,
        crack: &Crack,
        enrichment: &Enrichment,
    ) -> Self {
        Self::of_cells(mesh, std::iter::once(cell), index, crack, enrichment)
    }

    fn of_cells(
        mesh: &Mesh,
        cells: impl Iterator<Item = usize>,
        index: usize,
        crack: &Crack,
        enrichment: &Enrichment,
    ) -> Self {
        let mut found = CrackFacets::default();
        // A bent crack may cross an edge twice; a plane does once, at a place that every cell rounds in its own way.
        let place = |x: &Point| match mesh.dim() {
            2 => x.map(f64::to_bits),
            _ => [0; 3],
        };
        let mut by_edge: BTreeMap<([u32; 2], [u64; 3]), usize> = BTreeMap::new();
        for cell in cells {
            let Some(partition) = enrichment.partition(cell) else {
                continue;
            };
            let nodes = mesh.cell(cell);
            let map = mesh.map(cell);
            // A part that is cut off or merged by it is missing from the crack, and so from the forces on it.
            let tolerance = 1e-12 * norm(&sub(&map[0], &map[2]));
            let own = partition.faces.iter().filter(|f| f.crack == index);
            let pieces = own.filter_map(|face| {
                let corner = |&(x, on): &FaceCorner| Corner {
                    x,
                    nodes: on.map(|[i, j]| [nodes[i].min(nodes[j]), nodes[i].max(nodes[j])]),
                    sides: face.sides,
                };
                let polygon: Vec<Corner> = face.corners.iter().map(corner).collect();
                Some((face, within(crack, &polygon)?))
            });
            let pieces: Vec<_> = pieces.collect();
            // Corners inside the cell that its own faces share: the first of those in one place stands for all.
            let all = || pieces.iter().flat_map(|(_, (polygon, _))| polygon);
            let inside = || all().filter(|corner| corner.nodes.is_none());
            let places: Vec<Point> = inside().map(|corner| corner.x).collect();
            let near = Boxes::new(places.iter().map(|x| [*x; 2]));
            let mut inner: Vec<Option<usize>> = Vec::with_capacity(places.len());
            for (face, (polygon, front)) in pieces {
                let mut corners = Vec::with_capacity(polygon.len());
                for corner in polygon {
                    let fresh = found.corners.len();
                    let known = match corner.nodes {
                        Some(nodes) => *by_edge.entry((nodes, place(&corner.x))).or_insert(fresh),
                        None => {
                            let here = near.meeting(&around([&corner.x], tolerance)).into_iter();
                            let mut firsts = here.filter_map(|k| *inner.get(k)?);
                            let same = |&i: &usize| {
                                norm(&sub(&found.corners[i].x, &corner.x)) <= tolerance
                            };
                            let first = firsts.find(same);
                            inner.push(first.is_none().then_some(fresh));
                            first.unwrap_or(fresh)
                        }
                    };
                    if known == fresh {
                        found.corners.push(corner);
                    }
                    corners.push(known);
                }
                found.facets.push(Facet {
                    corners,
                    sides: face.sides,
                    frame: face.frame,
                    front,
                });
            }
        }
        found
    }

    /// Parts the segments of an arm at the second multipliers of its corners.
    pub fn part_at_corners(&mut self, enrichment: &Enrichment, arm: usize) {
        let own = enrichment.corners_of(arm);
        own.for_each(|corner| self.part(&corner.x, corner.second()));
    }

    /// Parts the segment of a plane crack that crosses the distance d from a place [m].
    pub fn part(&mut self, from: &Point, d: f64) {
        /// Corners this near to it, in parts of d, are there.
        const THERE: f64 = 1e-6;
        let beyond = |c: usize| norm(&sub(&self.corners[c].x, from)) - d;
        let levels = self
            .facets
            .iter()
            .map(|f| [0, 1].map(|i| beyond(f.corners[i])));
        let crossed = levels
            .enumerate()
            .find(|(_, [low, high])| low * high < 0.0 && low.abs().min(high.abs()) > THERE * d);
        let Some((index, [low, high])) = crossed else {
            return;
        };
        let facet = &self.facets[index];
        let [x, y] = [0, 1].map(|i| self.corners[facet.corners[i]].x);
        let (mut rest, middle) = (facet.clone(), self.corners.len());
        self.corners.push(Corner {
            x: add_scaled(&x, low / (low - high), &sub(&y, &x)),
            nodes: None,
            sides: facet.sides,
        });
        (self.facets[index].corners[1], rest.corners[0]) = (middle, middle);
        self.facets.push(rest);
    }

    /// Positions of the corners of a facet.
    pub fn polygon(&self, facet: &Facet) -> Vec<Point> {
        facet.corners.iter().map(|&c| self.corners[c].x).collect()
    }
}

/// A facet and the front that cut it.
type Clipped = (Vec<Corner>, Option<FrontCut>);

/// The part of a face inside a 3D front; its new corners are points of the front.
fn within(crack: &Crack, polygon: &[Corner]) -> Option<Clipped> {
    match &crack.geometry {
        Geometry::Plane { .. } => Some((polygon.to_vec(), None)),
        Geometry::Ellipse(_) => inside_front(polygon, |x| crack.beyond(x)),
        // Traced up to its ends.
        Geometry::Curve(_) => Some((polygon.to_vec(), None)),
    }
}

/// The convex part ψ <= 0 of a polygon, the front taken as a chord between its two crossings with the border.
fn inside_front(polygon: &[Corner], psi: impl Fn(&Point) -> f64) -> Option<Clipped> {
    let values: Vec<f64> = polygon.iter().map(|c| psi(&c.x)).collect();
    if !values.iter().any(|&v| v < 0.0) {
        return None;
    }
    let corners: Vec<(Corner, f64)> = polygon.iter().copied().zip(values.clone()).collect();
    let inside = clip_with(&corners, &values, -1.0, |i, j| {
        let x = bent_crossing(&polygon[i].x, values[i], &polygon[j].x, &psi);
        let (nodes, sides) = (None, polygon[i].sides);
        (Corner { x, nodes, sides }, 0.0)
    });
    let part: Vec<Corner> = inside.iter().map(|c| c.0).collect();
    let places: Vec<Point> = part.iter().map(|corner| corner.x).collect();
    if part.len() < 3 || space_area(&places) <= 0.0 {
        return None;
    }
    let on_front = inside.iter().filter(|c| c.1 == 0.0).map(|c| c.0.x);
    let chord = <[Point; 2]>::try_from(on_front.collect::<Vec<_>>())
        .ok()
        .filter(|_| values.iter().any(|&v| v > 0.0));
    let cut = chord.map(|chord| FrontCut {
        chord,
        face: polygon.iter().map(|c| c.x).collect(),
    });
    Some((part, cut))
}
