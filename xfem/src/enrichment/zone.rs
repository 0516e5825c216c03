//! The nodes around a tip or front that carry its branch functions, and the room that a front has.
//!
//! The ramp falls to zero over the cells around its nodes, and towards sides that cells of the tip do not touch: supports then
//! hold none of the functions, and g₃ and g₄ of the nodes there are superfluous. A radius is reduced until the ramp holds no crack
//! but its own. Of the smallest ramp, or a zone without, what other cracks cut off carries none of its functions.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use crate::cut::crack::{Crack, Geometry};
use crate::cut::part::Place;
use crate::geometry::ellipse::Ellipse;
use crate::geometry::tip_frame::TipFrame;
use crate::mesh::Mesh;
use crate::mesh::neighbours::Neighbours;

/// Nodes around a tip.
#[derive(Debug, Clone, Default)]
pub struct Zone {
    /// Those that carry its branch functions.
    pub nodes: BTreeSet<u32>,
    /// Those of the ramp; empty: there is none.
    pub core: BTreeSet<u32>,
    /// Those where the ramp makes g₃ and g₄ superfluous.
    pub surplus: Vec<u32>,
    /// Arms over which its functions jump.
    pub arms: Vec<usize>,
    /// Radius of the ramp [m]; 0: there is none.
    pub radius: f64,
    /// Regions of its cells that other cracks part from the tip.
    pub cut_off: BTreeSet<Place>,
}

impl Zone {
    /// Without a ramp.
    pub(super) fn plain(nodes: BTreeSet<u32>) -> Self {
        Zone {
            nodes,
            ..Zone::default()
        }
    }

    /// The nodes within the largest radius up to a given one [m] that is `free`, judged by the cells of the ramp's nodes, by all nodes,
    /// and by whether no ramp is smaller: what is cut off, or `None`. At least those around the cells of the tip, `at_tip`, which stay
    /// alone if not even these are free. `slack`: see [`WITHIN`](crate::cut::arrangement::WITHIN) [m].
    pub(super) fn widest(
        mesh: &Mesh,
        near: &Neighbours<'_>,
        frame: &TipFrame,
        mut radius: f64,
        (at_tip, slack): (BTreeSet<u32>, f64),
        free: impl Fn(&BTreeSet<usize>, &BTreeSet<u32>, bool) -> Option<BTreeSet<Place>>,
    ) -> Self {
        let of_side = |side| mesh.side_nodes(side).into_iter().map(|n| n as u32);
        let sides = mesh.sides.keys().map(|side| of_side(side).collect());
        let beside = sides.filter(|nodes: &BTreeSet<u32>| nodes.is_disjoint(&at_tip));
        let beside: BTreeSet<u32> = beside.flatten().collect();
        let smallest = &near.nodes_around(&at_tip) - &beside;
        let candidates = near.nodes_in(&frame.extents(radius + slack));
        loop {
            let within = |n: &u32| frame.distance(&mesh.nodes[*n as usize]) <= radius + slack;
            let inside: BTreeSet<u32> = candidates.iter().copied().filter(within).collect();
            let core = &(&inside - &beside) | &smallest;
            let nodes = near.nodes_around(&core);
            let last = core == smallest;
            if let Some(cut_off) = free(&near.cells_around(&core), &nodes, last) {
                return Zone {
                    cut_off,
                    surplus: (&nodes & &beside).into_iter().collect(),
                    nodes,
                    core,
                    radius,
                    ..Zone::default()
                };
            }
            if last {
                return Zone::plain(at_tip);
            }
            radius *= 0.85;
        }
    }
}

/// Room around the front of an ellipse: its shorter axis, the distance from other cracks and from the sides of the body that
/// it does not cross [m].
pub(super) fn front_room(mesh: &Mesh, arms: &[Crack], own: &Crack, front: &Ellipse) -> f64 {
    /// Places along the front.
    const PLACES: u32 = 64;
    let places = (0..PLACES).map(|k| front.point(TAU * f64::from(k) / f64::from(PLACES)));
    let places: Vec<_> = places.collect();
    let least = |distance: &dyn Fn(&[f64; 3]) -> f64| {
        let all = places.iter().map(distance);
        all.fold(f64::INFINITY, f64::min)
    };
    let [low, high] = mesh.extents();
    let sides = (0..3).flat_map(|a| [least(&|x| x[a] - low[a]), least(&|x| high[a] - x[a])]);
    let others = arms.iter().filter(|arm| arm.number != own.number);
    let cracks = others.map(|arm| match &arm.geometry {
        Geometry::Ellipse(e) => least(&|x| e.nearest(x).psi.max(0.0).hypot(arm.distance(x))),
        _ => least(&|x| arm.distance(x).abs()),
    });
    let shorter = 2.0 * front.half_axes[0].min(front.half_axes[1]);
    sides
        .filter(|d| *d > 0.0)
        .chain(cracks)
        .fold(shorter, f64::min)
}
