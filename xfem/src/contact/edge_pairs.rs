//! The founding paper's contact points: one pair per mesh edge that an arm crosses, merged at a node it runs through.
//!
//! ```text
//!   [[u]](x_c) = ± Σ N_j(x_c) b_j + 2 √r Σ N_k(x_c) c_k1      (paper, Eq. 14)
//! ```
//!
//! P is a point force. Off the grid lines the pairs miss the patch test; the integrated spaces do not.

use crate::cut::crack::End;
use crate::enrichment::AT_TIP;
use crate::enrichment::basis::FunctionKind;
use crate::enrichment::facets::{Corner, CrackFacets};
use crate::geometry::{Point, norm, sub};
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

use super::multipliers::pair_space;
use super::pairs::{ContactPoint, ContactSurface, vertex_weights};
use super::surface_rule::surface_points;

/// Contact surface of the `index`-th crack. `held` tells the prescribed unknowns: a pair whose normal jump is prescribed
/// has no contact left to enforce.
pub fn edge_pairs(
    integrator: &CellIntegrator<'_>,
    index: usize,
    held: impl Fn(usize) -> bool,
) -> Result<ContactSurface, CellError> {
    let (mesh, dim) = (integrator.mesh, integrator.mesh.dim());
    let crack = &integrator.cracks[index];
    let sizes = &integrator.enrichment.lengths.of_nodes;
    let facets = CrackFacets::new(mesh, index, crack, integrator.enrichment);
    // Where arms meet on an edge the jump has no one normal: as at a bend inside a cell no pair stands there.
    let ends = crack
        .ends
        .into_iter()
        .zip([crack.path.first(), crack.path.last()]);
    let ends = ends.filter(|(end, _)| matches!(end, End::Bend | End::Meeting));
    let joined: Vec<Point> = ends.filter_map(|(_, vertex)| Some(vertex?.x)).collect();
    let mut points: Vec<Option<ContactPoint>> = facets
        .corners
        .iter()
        .map(|corner| {
            let nodes = corner.nodes.filter(|_| !joined.contains(&corner.x))?;
            let at_tip = AT_TIP * sizes[nodes[0] as usize].min(sizes[nodes[1] as usize]);
            let terms = jump_terms(integrator, index, corner, nodes, at_tip);
            (!terms.is_empty()).then(|| ContactPoint::of(crack, corner.x, 0.0, &terms))
        })
        .collect();
    for facet in &facets.facets {
        let weights = vertex_weights(&facets.polygon(facet));
        let carried = |corner: &usize| points[*corner].is_some();
        let kept = facet.corners.iter().filter(|c| carried(c)).count();
        // The share of a corner without a point is carried by the others of its facet.
        let lost: f64 = facet
            .corners
            .iter()
            .zip(&weights)
            .filter(|(c, _)| !carried(c))
            .map(|(_, w)| w)
            .sum();
        for (&corner, weight) in facet.corners.iter().zip(&weights) {
            if let Some(point) = &mut points[corner] {
                point.weight += weight + lost / kept as f64;
            }
        }
    }
    // Their parts of the crack stay with them: the supports carry those.
    let acts = |point: &ContactPoint| point.acts(dim, &held);
    let mut keyed: Vec<(usize, ContactPoint)> = Vec::new();
    for (corner, point) in points.into_iter().enumerate() {
        keyed.extend(point.filter(acts).map(|p| (corner, p)));
    }
    let faces = facets.facets.iter().map(|f| f.corners.clone()).collect();
    keyed.sort_by(|(_, p), (_, q)| p.compare(q));
    let mut number_of = vec![None; facets.corners.len()];
    for (number, (corner, _)) in keyed.iter().enumerate() {
        number_of[*corner] = Some(number as u32);
    }
    let quadrature = surface_points(integrator, index, &facets, &pair_space(&facets, &number_of))?;
    let mut surface = ContactSurface::new(keyed, faces);
    surface.surface.quadrature = quadrature;
    Ok(surface)
}

/// Coefficients of the functions that jump at a corner on a mesh edge or node; one closer than `at_tip` to a tip lies at
/// the tip.
fn jump_terms(
    integrator: &CellIntegrator<'_>,
    index: usize,
    corner: &Corner,
    nodes: [u32; 2],
    at_tip: f64,
) -> Vec<(u32, f64)> {
    let enrichment = integrator.enrichment;
    let [p, q] = nodes.map(|n| &integrator.mesh.nodes[n as usize]);
    let x = &corner.x;
    let shares = if nodes[0] == nodes[1] {
        vec![(nodes[0], 1.0)]
    } else {
        // N_i = |x − x_j| / |x_i − x_j| on the edge
        let [from, to] = [p, q].map(|end| norm(&sub(x, end)));
        vec![(nodes[0], to / (from + to)), (nodes[1], from / (from + to))]
    };
    let mut terms = Vec::new();
    for &(node, share) in &shares {
        for f in enrichment.enriched_of(node as usize) {
            let coefficient = match enrichment.functions[f].kind {
                FunctionKind::Piece { .. } => {
                    let steps = enrichment.step_across(corner.sides, f);
                    steps.map_or(0.0, |[one, two]| share * (one - two))
                }
                FunctionKind::Branch { tip, order: 0 } => {
                    let frame = &enrichment.tips[tip as usize];
                    // At the tip nothing jumps; rounding in r must not make a pair with a coefficient of 1e-8.
                    if !enrichment.jumps_over(tip as usize, index) || frame.distance(x) <= at_tip {
                        continue;
                    }
                    let [one, two] = [1.0, -1.0].map(|side| frame.branch(x, Some(side)).0[0]);
                    // ρ on the edge, or at the node
                    let ends: Vec<u32> = shares.iter().map(|share| share.0).collect();
                    let mask = enrichment.ramp(tip as usize, &ends);
                    let inside = shares
                        .iter()
                        .enumerate()
                        .filter(|(k, _)| mask & (1 << k) != 0);
                    let rho: f64 = inside.map(|(_, (_, share))| share).sum();
                    (one - two) * share * rho
                }
                _ => 0.0,
            };
            if coefficient != 0.0 {
                terms.push((f as u32, coefficient));
            }
        }
    }
    terms
}
