//! Values of prescribed unknowns under a closed form.
//!
//! ```text
//!   ū_j = u(x_j, s_j),  b_j = ½ (u⁻(x_j) − u(x_j, s_j))
//!   u⁻(x) = 2 u(x', −s) − u(2 x' − x, −s)   u of the other side, continued to x: x' foot of x on the crack
//! ```
//!
//! Closed forms tell the sides apart by the place of a point, but on the crack itself. So the other side's field is
//! continued linearly, with the order of the interpolation it enters.

use rayon::prelude::*;

use crate::enrichment::Enrichment;
use crate::enrichment::basis::{FunctionKind, STEP};
use crate::exact::Field;
use crate::geometry::{add_scaled, sub};
use crate::mesh::Mesh;

use super::sides::Sides;

/// Values that a closed form gives to unknowns (function-major) [m]; evaluated once per node.
pub fn exact_values(
    mesh: &Mesh,
    enrichment: &Enrichment,
    sides: &Sides,
    field: &dyn Field,
    unknowns: impl Iterator<Item = usize>,
) -> Vec<(usize, f64)> {
    let dim = mesh.dim();
    let function = |i: usize| enrichment.functions[i / dim];
    let mut unknowns: Vec<(usize, usize)> =
        unknowns.map(|i| (function(i).node as usize, i)).collect();
    unknowns.sort_unstable();
    let of_node = |list: &[(usize, usize)]| -> Vec<(usize, f64)> {
        let node = list[0].0;
        let (x, side) = (&mesh.nodes[node], sides.of_node(node));
        let own = field.displacement(x, side);
        let jumps = |&(_, i): &(usize, usize)| function(i).kind != FunctionKind::Standard;
        let jump = if list.iter().any(jumps) {
            let foot = sides.foot(x);
            let mirrored = add_scaled(&foot, 1.0, &sub(&foot, x));
            let (near, far) = (
                field.displacement(&foot, -side),
                field.displacement(&mirrored, -side),
            );
            [0, 1, 2].map(|a| (2.0 * near[a] - far[a] - own[a]) / STEP)
        } else {
            [0.0; 3]
        };
        let value = |entry| if jumps(entry) { jump } else { own };
        list.iter()
            .map(|entry| (entry.1, value(entry)[entry.1 % dim]))
            .collect()
    };
    let nodes: Vec<&[(usize, usize)]> = unknowns.chunk_by(|a, b| a.0 == b.0).collect();
    nodes.into_par_iter().flat_map_iter(of_node).collect()
}
