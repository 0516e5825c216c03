//! Points on the edges and faces of cells at which their functions are integrated: the same from both cells beside them.

use crate::cut::part::Region;
use crate::enrichment::cell_facets::pieces;
use crate::enrichment::facet_rule::facet_points;
use crate::enrichment::facets::CrackFacets;
use crate::geometry::clip::{bent_crossing, clip, clip_with, fan};
use crate::geometry::{Point, cross, dot, norm, sub, unit};
use crate::mesh::cell::CellMap;
use crate::quadrature::graded::{graded_segment, graded_triangles};
use crate::quadrature::{WeightedPoint, segment, triangle};

use super::cell_matrix::CellIntegrator;

/// The parts of a convex piece of an edge or face to integrate over.
pub type Within<'a> = &'a dyn Fn(Vec<Point>) -> Vec<Vec<Point>>;

/// Points on a part of an edge no longer than twice its distance from a tip, and halvings down to that: an error of 1e-9 at
/// any distance.
const BRANCH_EDGE: usize = 10;
const EDGE_DEPTH: usize = 40;

/// Points per direction on a part of a face no longer than its distance from the front, and halvings: an error of 1e-5 of a
/// cell that the front enters.
const BRANCH_FACE: usize = 4;
const FACE_DEPTH: usize = 4;

impl CellIntegrator<'_> {
    /// Points on an edge (2D) or face of a cell with their regions, for shape functions or for the branch functions of a tip:
    /// those the same from both cells beside it.
    pub(super) fn border_points(
        &self,
        cell: usize,
        local: &[usize],
        tip: Option<u32>,
        within: Within<'_>,
    ) -> Vec<(WeightedPoint, Region)> {
        let mesh = self.mesh;
        let nodes = mesh.cell(cell);
        // From the lowest node towards its lower neighbour.
        let count = local.len();
        let first = (0..count).min_by_key(|&i| nodes[local[i]]).unwrap_or(0);
        let at = |i: usize| local[i % count];
        let forward = nodes[at(first + 1)] < nodes[at(first + count - 1)] || count == 2;
        let order: Vec<usize> = (0..count)
            .map(|k| {
                if forward {
                    at(first + k)
                } else {
                    at(first + count - k)
                }
            })
            .collect();
        match (tip, mesh.dim()) {
            (None, dim) => {
                let pieces = pieces(mesh, self.cracks, self.enrichment, cell, &order).into_iter();
                let rule = |piece: Vec<Point>| match dim {
                    2 => segment(&piece[0], &piece[1], 2),
                    _ => fan(&piece).iter().flat_map(triangle).collect(),
                };
                let own = |piece| within(piece).into_iter().flat_map(rule);
                let points = pieces.flat_map(|(piece, r)| own(piece).map(move |p| (p, r)));
                points.collect()
            }
            (Some(_), 2) => self.branch_edge(cell, &order, within),
            (Some(tip), _) => self.branch_face(cell, &order, tip as usize, within),
        }
    }

    /// On an edge: from place to place of the cracks, whether they divide this cell or its neighbour. A continuation that ends
    /// on the edge is none of the neighbour's concern.
    fn branch_edge(
        &self,
        cell: usize,
        order: &[usize],
        within: Within<'_>,
    ) -> Vec<(WeightedPoint, Region)> {
        let mesh = self.mesh;
        let ends = [order[0], order[1]].map(|i| mesh.cell(cell)[i]);
        let [from, to] = ends.map(|n| mesh.nodes[n as usize]);
        let pieces = pieces(mesh, self.cracks, self.enrichment, cell, order);
        let away = |x: &Point| norm(&sub(x, &from));
        // By the edge: the cell on its other side must take the same.
        let tips = self.enrichment;
        let tips = tips.singular_points_near(&[from, to], away(&to));
        let mut places = self.enrichment.places_on(ends).collect::<Vec<_>>();
        places.extend([from, to]);
        places.sort_by(|a, b| away(a).total_cmp(&away(b)));
        let mut points = Vec::new();
        let parts = places.windows(2).flat_map(|w| within(w.to_vec()));
        for w in parts {
            for p in graded_segment(&w[0], &w[1], &tips, BRANCH_EDGE, EDGE_DEPTH) {
                let at = away(&p.x);
                let own = pieces.iter().find(|(piece, _)| at <= away(&piece[1]));
                points.push((p, own.or(pieces.last()).map_or(0, |own| own.1)));
            }
        }
        points
    }

    /// On a face: on both sides of the plane of the tip's crack, whether it divides this cell or its neighbour.
    fn branch_face(
        &self,
        cell: usize,
        order: &[usize],
        tip: usize,
        within: Within<'_>,
    ) -> Vec<(WeightedPoint, Region)> {
        let map = self.mesh.map(cell);
        let crack = &self.cracks[self.enrichment.tips[tip].crack];
        let phi = crack.cell_phi(self.mesh, cell);
        let levels: Vec<f64> = order.iter().map(|&i| phi[i]).collect();
        let face: Vec<Point> = order.iter().map(|&i| map[i]).collect();
        if levels.iter().all(|level| *level == 0.0) {
            return self.sheet_points(cell, &face, tip);
        }
        let mut points = Vec::new();
        for side in [1.0, -1.0] {
            if !levels.iter().any(|f| f * side > 0.0) {
                continue;
            }
            // On either side of other cracks the functions are the same.
            let of_crack = |s: &(usize, f64)| self.cracks[s.0].shares_tips(crack) && s.1 == side;
            let region = self.enrichment.partition(cell).and_then(|partition| {
                let mut parts = partition.parts.iter();
                parts.position(|part| part.sides.iter().any(of_crack))
            });
            let parts = within(clip(&face, &levels, side));
            for t in parts.iter().flat_map(|part| fan(part)) {
                let distance = |x: &Point| self.enrichment.tips[tip].distance(x);
                let rule = graded_triangles(&[t], distance, BRANCH_FACE, FACE_DEPTH).into_iter();
                points.extend(rule.map(|p| (p, region.unwrap_or(0))));
            }
        }
        points
    }

    /// On a face along the plane of the tip's crack: those of the jump up to the front, and others beyond, for both cells the same.
    fn sheet_points(
        &self,
        cell: usize,
        face: &[Point],
        tip: usize,
    ) -> Vec<(WeightedPoint, Region)> {
        let crack = &self.cracks[self.enrichment.tips[tip].crack];
        let mut points = Vec::new();
        for host in self.enrichment.hosts(cell) {
            for &arm in &self.enrichment.zones[tip].arms {
                let crack = &self.cracks[arm];
                let facets = CrackFacets::of_cell(self.mesh, host, arm, crack, self.enrichment);
                for facet in &facets.facets {
                    let [one, two] = facet.sides;
                    let beside = [one, two].into_iter().find(|side| side.0 == cell);
                    if let Some((_, own)) = beside.filter(|_| one.0 != two.0) {
                        let rule = facet_points(self.mesh, crack, self.enrichment, &facets, facet);
                        let rule = rule.into_iter().map(|p| WeightedPoint::new(p.x, p.weight));
                        points.extend(rule.map(|p| (p, own)));
                    }
                }
            }
        }
        let beyond: Vec<f64> = face.iter().map(|x| crack.beyond(x)).collect();
        let front = &self.enrichment.tips[tip];
        let distance = |x: &Point| front.distance(x);
        for t in fan(&clip_with(face, &beyond, 1.0, |i, j| {
            bent_crossing(&face[i], beyond[i], &face[j], |x| crack.beyond(x))
        })) {
            let rule = graded_triangles(&[t], distance, BRANCH_FACE, FACE_DEPTH).into_iter();
            let ahead = rule.filter(|p| front.coordinates(&p.x).psi >= 0.0);
            points.extend(ahead.map(|p| (p, 0)));
        }
        points
    }
}

/// Outward unit normal of a facet of a cell, given by its local nodes.
pub fn outward(map: &CellMap, local: &[usize]) -> Point {
    if let &[i, j] = local {
        let d = unit(&sub(&map[j], &map[i]));
        return [d[1], -d[0], 0.0];
    }
    let diagonals = [[2, 0], [3, 1]].map(|[i, j]: [usize; 2]| sub(&map[local[i]], &map[local[j]]));
    let normal = unit(&cross(&diagonals[0], &diagonals[1]));
    // Whatever the order of its corners.
    let sign = dot(&normal, &sub(&map[local[0]], &map.centre())).signum();
    normal.map(|v| sign * v)
}
