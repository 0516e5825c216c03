//! Quadrature points of the crack surface with the multipliers that act there.

use std::collections::BTreeMap;

use crate::enrichment::facet_rule::facet_points;
use crate::enrichment::facets::CrackFacets;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

use super::multipliers::Multipliers;
use super::surface_point::SurfacePoint;

/// Quadrature points of the facets that carry a multiplier.
pub fn surface_points(
    integrator: &CellIntegrator<'_>,
    index: usize,
    facets: &CrackFacets,
    multipliers: &Multipliers,
) -> Result<Vec<SurfacePoint>, CellError> {
    let mut points = Vec::new();
    for (facet, shares) in facets.facets.iter().zip(&multipliers.shares) {
        if shares.iter().any(Vec::is_empty) {
            continue;
        }
        let crack = &integrator.cracks[index];
        for point in facet_points(integrator.mesh, crack, integrator.enrichment, facets, facet) {
            let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
            for (hat, own) in point.hats.iter().zip(shares) {
                for &(k, share) in own {
                    *sum.entry(k).or_default() += hat * share;
                }
            }
            points.push(SurfacePoint {
                weight: point.weight,
                shares: sum.into_iter().filter(|(_, share)| *share != 0.0).collect(),
                ..SurfacePoint::on_facet(integrator, index, facet, point.x)?
            });
        }
    }
    Ok(points)
}
