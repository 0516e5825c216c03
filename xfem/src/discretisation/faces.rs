//! Contact surfaces of all cracks of a body, without points that no displacement can tell from others.

use rayon::prelude::*;

use crate::contact::pairs::{ContactSurface, jump_rows};
use crate::contact::{self, ContactSpace, rank};
use crate::enrichment::EnrichmentError;
use crate::mesh::Lengths;
use crate::stiffness::cell_matrix::CellIntegrator;

use super::DiscretisationError;

/// Contact surfaces of all cracks, without points that no displacement can tell from others. `doubled`: that of a
/// crack that split the mesh; `scaled`: a row of the jump operator over the free unknowns of the solver, divided by the roots of their
/// stiffness.
pub(super) fn faces(
    spaces: &[ContactSpace],
    integrator: &CellIntegrator<'_>,
    lengths: &Lengths,
    doubled: Option<ContactSurface>,
    numbers: &[Option<u32>],
    scaled: impl Fn(&[(usize, f64)]) -> Vec<(usize, f64)> + Sync,
) -> Result<ContactSurface, DiscretisationError> {
    let (dim, cracks) = (integrator.mesh.dim(), integrator.cracks);
    let held = |unknown: usize| numbers[unknown].is_none();
    let mut surface = match doubled {
        Some(own) => own.retain(|point| point.acts(dim, held)),
        None => ContactSurface::default(),
    };
    // Points of the arms whose space is integrated.
    let mut arms: Vec<std::ops::Range<usize>> = Vec::new();
    // The arms of a crack one after the other.
    let mut order: Vec<usize> = (0..cracks.len()).collect();
    order.sort_by_key(|&index| cracks[index].number);
    let found = order.into_par_iter().map(|index| {
        let space = spaces[cracks[index].number];
        (space, contact::surface(integrator, index, space, held))
    });
    for (space, own) in found.collect::<Vec<_>>() {
        let start = surface.points.len();
        surface.append(own.map_err(|e| DiscretisationError::Cell(e, None))?);
        if space.is_integrated() {
            arms.push(start..surface.points.len());
        }
    }
    let rows = |surface: &ContactSurface, k: usize| {
        let rows = jump_rows(dim, &surface.points[k..=k]);
        rows.iter().map(|row| scaled(row)).collect()
    };
    let size = lengths.smallest.powi(dim as i32 - 1);
    let hairs = rank::hairs(&surface, &arms, rank::HAIR * size);
    arms = rank::merge(&mut surface, &arms, &hairs).0;
    loop {
        let weight = |k: usize| surface.points[k].weight;
        let lost = rank::dependent(&arms, weight, |k| rows(&surface, k), rank::UNTOLD);
        if lost.is_empty() {
            break;
        }
        let (fewer, merged) = rank::merge(&mut surface, &arms, &lost);
        arms = fewer;
        if merged == 0 {
            let lost = rank::dependent(&arms, |_| 1.0, |k| rows(&surface, k), rank::SINGULAR);
            if let Some(&point) = lost.first() {
                let own = arms.iter().find(|arm| arm.contains(&point)).cloned();
                let own = own.unwrap_or_default();
                let measure: f64 = own.map(|k| surface.points[k].weight).sum();
                let (crack, at) = (surface.points[point].crack, surface.points[point].x);
                let third = measure.powf(1.0 / (dim as f64 - 1.0)) / 3.0;
                // Those at hand do not do.
                let cell = third.min(0.5 * lengths.smallest);
                return Err(EnrichmentError::Undetermined { crack, at, cell }.into());
            }
            break;
        }
    }
    let mut found = vec![false; spaces.len()];
    surface
        .points
        .iter()
        .for_each(|point| found[point.crack] = true);
    if let Some(number) = found.iter().position(|found| !found) {
        return Err(EnrichmentError::too_short(cracks, number, lengths).into());
    }
    Ok(surface)
}
