//! Which side of the only crack nodes and points lie on: what closed forms and one-sided loads ask for.
//!
//! Beyond its ends the crack is thought to go on along its level set: the values on both sides agree there.

use crate::cut::crack::{Crack, End, Tip};
use crate::cut::part::Region;
use crate::cut::placement::cells_at;
use crate::geometry::clip::Side;
use crate::geometry::crack_shape::CrackShape;
use crate::geometry::{Point, add_scaled, dot};
use crate::stiffness::cell_matrix::CellIntegrator;

/// How far ahead of an end at a node the body is looked for, in shortest edges.
const AHEAD: f64 = 1e-6;

/// Sides of the first crack in a mesh.
pub struct Sides {
    crack: Crack,
    nodes: Vec<Side>,
}

impl Sides {
    /// Sides of all nodes; `None` for a body without crack. `first`: the first crack as it was asked for.
    pub fn new(first: Option<(&CrackShape, Tip)>, integrator: &CellIntegrator<'_>) -> Option<Self> {
        let mesh = integrator.mesh;
        if let Some(crack) = integrator.cracks.first() {
            let nodes = (0..mesh.nodes.len()).map(|node| crack.side_of(mesh, node));
            return Some(Sides {
                nodes: nodes.collect(),
                crack: crack.clone(),
            });
        }
        // A crack on cell facets: its nodes are doubled, and every copy belongs to cells of one side only.
        let (shape, tip) = first?;
        let mut crack = Crack::new(0, shape, tip, mesh, &mesh.lengths());
        for (end, x, ahead) in crack.tips() {
            let step = AHEAD * mesh.smallest_edge();
            if cells_at(mesh, &add_scaled(&x, step, &ahead)).is_empty() {
                crack.ends[end] = End::Mouth;
            }
        }
        let mut nodes: Vec<Side> = (0..mesh.nodes.len())
            .map(|n| crack.side_of(mesh, n))
            .collect();
        for cell in 0..mesh.cell_count() {
            let side = sign(crack.distance(&mesh.centre(cell)));
            for &node in mesh.cell(cell) {
                if crack.holds(node) {
                    nodes[node as usize] = side;
                }
            }
        }
        Some(Sides { crack, nodes })
    }

    /// The crack.
    pub fn crack(&self) -> &Crack {
        &self.crack
    }

    /// The point of the crack, or of its continuation, nearest to a given one.
    pub fn foot(&self, x: &Point) -> Point {
        /// Newton steps along the gradient of the level set; a signed distance needs one, rounding another.
        const STEPS: usize = 4;
        let mut foot = *x;
        for _ in 0..STEPS {
            let distance = self.crack.distance(&foot);
            if distance == 0.0 {
                break;
            }
            // Central differences over a part of the distance: far above rounding, far below any radius of curvature.
            let step = 1e-3 * distance.abs();
            let slope = [0, 1, 2].map(|a| {
                let (mut ahead, mut behind) = (foot, foot);
                ahead[a] += step;
                behind[a] -= step;
                (self.crack.distance(&ahead) - self.crack.distance(&behind))
                    / (ahead[a] - behind[a])
            });
            let square = dot(&slope, &slope);
            if !(square > 0.5 && square < 2.0) {
                break; // the distance has sunk into rounding
            }
            foot = add_scaled(&foot, -distance / square, &slope);
        }
        foot
    }

    /// Side of a node; of one on a crack through cells side 1, as its shifted Heaviside function has it.
    pub fn of_node(&self, node: usize) -> Side {
        self.nodes[node]
    }

    /// Side of a point in a region of a cell.
    pub fn of_point(
        &self,
        integrator: &CellIntegrator<'_>,
        cell: usize,
        x: &Point,
        region: Region,
    ) -> Side {
        match integrator.enrichment.side(cell, region, 0) {
            Some(side) => side,
            None => sign(self.crack.distance(x)),
        }
    }
}

fn sign(distance: f64) -> Side {
    if distance >= 0.0 { 1.0 } else { -1.0 }
}
