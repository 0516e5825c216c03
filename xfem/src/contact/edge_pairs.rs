//! The founding paper's contact points: one pair per crossed mesh edge, merged at a node the crack runs through.
//!
//! ```text
//!   [[u]](x_c) = 2 Σ N_j(x_c) b_j + 2 √r Σ N_k(x_c) c_k1      (paper, Eq. 14)
//! ```
//!
//! P is a point force. Off the grid lines the pairs miss the patch test; the integrated spaces do not.

use crate::enrichment::basis::FunctionKind;
use crate::enrichment::facets::CrackFacets;
use crate::geometry::Point;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

use super::facet_rule::surface_points;
use super::multipliers::pair_space;
use super::pairs::{AT_TIP, ContactPoint, ContactSurface, vertex_weights};

/// Contact surface of the `index`-th crack. `held` tells the prescribed unknowns: a pair whose normal jump is prescribed
/// has no contact left to enforce.
pub fn edge_pairs(
    integrator: &CellIntegrator<'_>,
    index: usize,
    held: impl Fn(usize) -> bool,
) -> Result<ContactSurface, CellError> {
    let (mesh, dim) = (integrator.mesh, integrator.mesh.dim());
    let crack = &integrator.cracks[index];
    let sizes = mesh.node_sizes();
    let facets = CrackFacets::new(mesh, index, crack, integrator.enrichment);
    let mut points: Vec<Option<ContactPoint>> = facets
        .corners
        .iter()
        .map(|corner| {
            let nodes = corner.nodes?;
            let at_tip = AT_TIP * sizes[nodes[0] as usize].min(sizes[nodes[1] as usize]);
            let terms = jump_terms(integrator, index, nodes, &corner.x, at_tip);
            (!terms.is_empty()).then(|| ContactPoint::of(crack, corner.x, 0.0, &terms))
        })
        .collect();
    for facet in &facets.facets {
        let weights = vertex_weights(&facets.polygon(facet));
        let carried = |corner: &usize| points[*corner].is_some();
        let kept = facet.corners.iter().filter(|c| carried(c)).count();
        // What belongs to a corner without a point is carried by the others of its facet.
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
    let mut numbers: Vec<usize> = (0..keyed.len()).collect();
    numbers.sort_by(|&i, &j| keyed[i].1.compare(&keyed[j].1));
    let mut number_of = vec![None; facets.corners.len()];
    for (number, &i) in numbers.iter().enumerate() {
        number_of[keyed[i].0] = Some(number as u32);
    }
    let quadrature = surface_points(integrator, index, &facets, &pair_space(&facets, &number_of))?;
    let mut surface = ContactSurface::new(keyed, faces);
    surface.surface.quadrature = quadrature;
    Ok(surface)
}

/// Coefficients of the functions that jump at a point between two nodes (equal: at the node); a point closer than
/// `at_tip` to a tip lies at the tip.
fn jump_terms(
    integrator: &CellIntegrator<'_>,
    index: usize,
    nodes: [u32; 2],
    x: &Point,
    at_tip: f64,
) -> Vec<(u32, f64)> {
    let (crack, enrichment) = (&integrator.cracks[index], integrator.enrichment);
    let [i, j] = nodes.map(|n| n as usize);
    let shares = if i == j {
        vec![(i, 1.0)]
    } else {
        // N_i = |φ_j| / (|φ_i| + |φ_j|) on the edge
        let (fi, fj) = (crack.phi[i].abs(), crack.phi[j].abs());
        vec![(i, fj / (fi + fj)), (j, fi / (fi + fj))]
    };
    let mut terms = Vec::new();
    for &(node, share) in &shares {
        for f in enrichment.enriched_of(node) {
            let coefficient = match enrichment.functions[f].kind {
                FunctionKind::Heaviside { crack } => {
                    share * step_jump(integrator, index, crack as usize, x)
                }
                FunctionKind::Branch { tip, order: 0 }
                    if enrichment.tips[tip as usize].crack == index =>
                {
                    // At the tip nothing jumps; rounding in r must not make a pair with a coefficient of 1e-8.
                    let r = enrichment.tips[tip as usize].distance(x);
                    if r > at_tip {
                        // ρ on the edge, or at the node
                        let ends = if i == j { &nodes[..1] } else { &nodes[..] };
                        let mask = enrichment.ramp(tip as usize, ends);
                        let inside = ends
                            .iter()
                            .enumerate()
                            .filter(|(k, _)| mask & (1 << k) != 0);
                        let rho: f64 = inside.map(|(k, _)| shares[k].1).sum();
                        2.0 * r.sqrt() * share * rho
                    } else {
                        0.0
                    }
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

/// Jump across the `index`-th crack of the step of a crack at a point of the former: its own step changes by 2; that of a
/// crack which ends on it from one side to nothing.
fn step_jump(integrator: &CellIntegrator<'_>, index: usize, stepping: usize, x: &Point) -> f64 {
    let crack = &integrator.cracks[stepping];
    if stepping == index {
        return 2.0;
    }
    let parent = crack.parents.iter().find(|p| p.crack == index);
    parent.map_or(0.0, |p| p.side * 1.0f64.copysign(crack.distance(x)))
}
