//! Amounts of the loads and supports of a case on a mesh: for who checks whether it says what was meant.

use std::collections::BTreeSet;

use stickslip_xfem::geometry::polygon::space_area;
use stickslip_xfem::geometry::{Point, norm, sub};
use stickslip_xfem::loads::border::Border;
use stickslip_xfem::loads::nodal_forces::no_force;

use crate::case::{Case, LoadKind, Polynomial, Region};
use crate::model::body::{Body, BodyError};
use crate::model::boundary::{part, region_name};
use crate::model::loading::Loading;
use crate::model::nodal_forces::Loaded;
use crate::model::refusals::load_error;

/// Resultant of a load.
#[derive(Debug, Clone)]
pub struct LoadExtent {
    /// Number in the case, from 1.
    pub number: usize,
    /// Loads with their places.
    pub what: String,
    /// Sum of the nodal forces, `dim` entries, at history factor 1; of the closed form at the end [N, in 2D N/m].
    pub force: Vec<f64>,
    /// Length, area or volume that it acts on [m^`power`].
    pub measure: f64,
    /// Dimension of what it acts on.
    pub power: usize,
}

/// Extent of a support.
#[derive(Debug, Clone)]
pub struct SupportExtent {
    /// Number in the case, from 1.
    pub number: usize,
    /// Where it acts.
    pub on: String,
    /// Number of nodes held.
    pub nodes: usize,
    /// Lowest and highest coordinates of them, `dim` entries each [m].
    pub ends: [Vec<f64>; 2],
    /// Length or area between held nodes [m^`power`].
    pub measure: f64,
    /// Dimension of what it acts on.
    pub power: usize,
}

/// Resultants of all loads, in case order.
///
/// # Errors
/// A load that acts on nothing.
pub fn load_extents(case: &Case, loading: &Loading<'_>) -> Result<Vec<LoadExtent>, BodyError> {
    let body = loading.body();
    let (integrator, dim) = (body.integrator(), body.mesh.dim());
    let loaded = Loaded::new(case, &integrator);
    let field = loading.exact(loading.increments());
    let mut force = no_force(&integrator);
    // Standard functions sum to one. What a load left is cleared where it can have acted.
    let mut sum = |kind: &LoadKind, region: Option<&Region>| -> Result<Vec<f64>, _> {
        loaded.add(kind, field, &mut force)?;
        let functions: BTreeSet<u32> = match region.map(|on| loaded.border().parts(&part(on))) {
            Some(parts) => {
                let cells = parts
                    .iter()
                    .flat_map(|part| body.enrichment.cell(part.cell));
                cells.copied().collect()
            }
            None => (0..body.enrichment.functions.len() as u32).collect(),
        };
        let mut sums = vec![0.0; dim];
        for f in functions.into_iter().map(|f| f as usize) {
            let own = &mut force[f * dim..(f + 1) * dim];
            if f < body.mesh.nodes.len() {
                sums.iter_mut().zip(own.iter()).for_each(|(s, f)| *s += f);
            }
            own.fill(0.0);
        }
        Ok(sums)
    };
    let mut found = Vec::new();
    for (index, load) in case.loads.iter().enumerate() {
        let unit = || vec![1.0; dim];
        let spread = |on: &Region| LoadKind::Traction(on.clone(), vec![Polynomial::from(1.0); dim]);
        let whole = || LoadKind::Body(unit(), None);
        let (name, region, power, alike) = match &load.kind {
            LoadKind::Traction(on, _) | LoadKind::ExactTraction(on) => {
                ("traction", Some(on), dim - 1, spread(on))
            }
            LoadKind::Pressure(on, _) => ("pressure", Some(on), dim - 1, spread(on)),
            LoadKind::Line(on, _) => ("line load", Some(on), 1, LoadKind::Line(on.clone(), unit())),
            LoadKind::Body(_, side) => {
                let alike = LoadKind::Body(unit(), side.clone());
                ("body force", None, dim, alike)
            }
            LoadKind::ExactBody => ("body force", None, dim, whole()),
            LoadKind::InitialStress(_) => ("initial stress", None, dim, whole()),
        };
        let failed = |e| load_error(case, &load.kind, &load.span, e);
        found.push(LoadExtent {
            number: index + 1,
            what: region.map_or(name.into(), |on| format!("{name} on {}", region_name(on))),
            force: sum(&load.kind, region).map_err(failed)?,
            measure: sum(&alike, region).map_err(failed)?[0],
            power,
        });
    }
    Ok(found)
}

/// Extents of all supports, in case order.
pub fn support_extents(case: &Case, body: &Body) -> Vec<SupportExtent> {
    let dim = body.mesh.dim();
    let border = Border::new(&body.mesh);
    let of = |on: &Region| {
        let nodes = border.nodes(&part(on));
        let mut parts = border.parts(&part(on));
        parts.retain(|part| {
            border
                .nodes_of(part)
                .all(|n| nodes.binary_search(&n).is_ok())
        });
        let measure = |corners: &[Point]| match corners {
            [p, q] => norm(&sub(q, p)),
            _ => space_area(corners),
        };
        let measure = parts
            .iter()
            .map(|part| measure(&border.corners(part)))
            .sum();
        (nodes, measure)
    };
    let supports = case.supports.iter().enumerate();
    let extents = supports.map(|(index, support)| {
        let (nodes, measure) = of(&support.on);
        let places: Vec<Point> = nodes
            .iter()
            .map(|&n| body.place(&body.mesh.nodes[n]))
            .collect();
        let end = |pick: fn(f64, f64) -> f64| {
            let along = |a: usize| places.iter().map(move |x| x[a]).reduce(pick).unwrap_or(0.0);
            (0..dim).map(along).collect()
        };
        SupportExtent {
            number: index + 1,
            on: region_name(&support.on),
            nodes: nodes.len(),
            ends: [end(f64::min), end(f64::max)],
            measure,
            power: dim - support.on.sides.len(),
        }
    });
    extents.collect()
}
