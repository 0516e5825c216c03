//! Supports and loads: from the words of a case to prescribed unknowns and consistent nodal forces.

use std::collections::{BTreeMap, BTreeSet};

use crate::fem::mesh::Facet;
use crate::fem::quadrature::{WeightedPoint, gauss_cell, segment, triangle};
use crate::fem::{Point, cross, norm, sub};
use crate::harness::case::{Case, LoadKind, Region};
use crate::xfem::basis::FunctionKind;
use crate::xfem::cell_matrix::{CellError, CellIntegrator};
use crate::xfem::cut;

/// Gauss points per segment where loads act: exact for linear shape functions times constants, and for facets that
/// carry branch functions an error below 1e-6.
const SEGMENT_POINTS: usize = 3;
const BRANCH_POINTS: usize = 24;

/// A prescribed unknown: its value is `amount × history factor` of the support.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prescribed {
    /// Support number in the case.
    pub support: usize,
    /// Stated displacement [m]; 0 for enriched functions.
    pub amount: f64,
}

/// Nodes of a region, sorted.
pub fn region_nodes(integrator: &CellIntegrator<'_>, region: &Region) -> Vec<usize> {
    let mut nodes = integrator.mesh.meeting_nodes(&region.sides);
    if let Some(condition) = &region.condition {
        nodes.retain(|&node| condition.holds(&integrator.mesh.nodes[node]));
    }
    nodes
}

/// Name of a region in the tables: its sides joined by `+`.
pub fn region_name(region: &Region) -> String {
    region.sides.join("+")
}

/// Prescribed unknowns of all supports by unknown number (function-major). A later support wins.
///
/// A facet supported as a whole keeps its displacement on both sides of a crack: the enriched functions that do not
/// vanish on it are fixed too.
pub fn prescribed(case: &Case, integrator: &CellIntegrator<'_>) -> BTreeMap<usize, Prescribed> {
    let mesh = integrator.mesh;
    let dim = mesh.dim();
    let mut fixed = BTreeMap::new();
    for (number, support) in case.supports.iter().enumerate() {
        let nodes = region_nodes(integrator, &support.on);
        for &node in &nodes {
            for (component, amount) in support.displacement.iter().enumerate() {
                if let Some(amount) = *amount {
                    let value = Prescribed {
                        support: number,
                        amount,
                    };
                    fixed.insert(node * dim + component, value);
                }
            }
        }
        let held: BTreeSet<usize> = nodes.into_iter().collect();
        let supported = |nodes: &[usize]| nodes.iter().all(|n| held.contains(n));
        for side in &support.on.sides {
            for &facet in mesh.sides.get(side).into_iter().flatten() {
                let local = mesh.kind.facets()[facet.local];
                // In 3D a support may hold only an edge of the facet.
                let edges = (0..local.len()).map(|i| vec![local[i], local[(i + 1) % local.len()]]);
                for part in std::iter::once(local.to_vec()).chain(edges) {
                    let part_nodes: Vec<usize> = part
                        .iter()
                        .map(|&i| mesh.cell(facet.cell)[i] as usize)
                        .collect();
                    if !supported(&part_nodes) {
                        continue;
                    }
                    for f in enriched_on(integrator, facet.cell, &part) {
                        for (component, amount) in support.displacement.iter().enumerate() {
                            if amount.is_some() {
                                let value = Prescribed {
                                    support: number,
                                    amount: 0.0,
                                };
                                fixed.insert(f * dim + component, value);
                            }
                        }
                    }
                }
            }
        }
    }
    fixed
}

/// Enriched functions of some nodes of a cell that do not vanish between them.
fn enriched_on(integrator: &CellIntegrator<'_>, cell: usize, local: &[usize]) -> Vec<usize> {
    let (mesh, enrichment) = (integrator.mesh, integrator.enrichment);
    let nodes: Vec<usize> = local.iter().map(|&i| mesh.cell(cell)[i] as usize).collect();
    let mut found = Vec::new();
    for &node in &nodes {
        for f in enrichment.enriched_of(node) {
            let lives = match enrichment.functions[f].kind {
                FunctionKind::Standard => false,
                FunctionKind::Branch { .. } => true,
                // H differs from its value at the node somewhere on the part.
                FunctionKind::Heaviside { crack } => {
                    let phi = &integrator.cracks[crack as usize].phi;
                    enrichment.cell(cell).contains(&(f as u32))
                        && nodes.iter().any(|&n| phi[n] * enrichment.shifts[f] < 0.0)
                }
            };
            if lives {
                found.push(f);
            }
        }
    }
    found
}

/// A region that holds no facet or edge to load.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// No facet or edge lies in the region.
    #[error("the region holds no cell {0}")]
    Empty(&'static str),
    /// A cell could not be integrated.
    #[error(transparent)]
    Cell(#[from] CellError),
}

/// Nodal forces of a load at factor 1, over all unknowns [N, in 2D N/m].
pub fn nodal_forces(
    integrator: &CellIntegrator<'_>,
    kind: &LoadKind,
) -> Result<Vec<f64>, LoadError> {
    let dim = integrator.mesh.dim();
    let mut force = vec![0.0; integrator.enrichment.functions.len() * dim];
    match kind {
        LoadKind::Body(density) => body_force(integrator, density, &mut force)?,
        LoadKind::Traction(region, traction) => {
            facet_force(integrator, region, &mut force, |_| {
                [traction[0], traction[1], third(traction)]
            })?;
        }
        LoadKind::Pressure(region, pressure) => {
            facet_force(integrator, region, &mut force, |n| n.map(|v| -pressure * v))?;
        }
        LoadKind::Line(region, line) => line_force(integrator, region, line, &mut force)?,
    }
    Ok(force)
}

fn third(v: &[f64]) -> f64 {
    v.get(2).copied().unwrap_or(0.0)
}

/// f(φ) += Σ w φ(x) t over points of a cell on one side of its crack.
fn add_points(
    integrator: &CellIntegrator<'_>,
    cell: usize,
    points: &[(WeightedPoint, f64)],
    density: &Point,
    force: &mut [f64],
) -> Result<(), LoadError> {
    let (mesh, dim) = (integrator.mesh, integrator.mesh.dim());
    let functions = integrator.enrichment.cell_basis(mesh, cell);
    let corners = mesh.corners(cell);
    let basis = integrator.basis(cell, &corners, &functions);
    let mut values = vec![0.0; functions.len()];
    let mut gradients = vec![[0.0; 3]; functions.len()];
    for (p, side) in points {
        let Some(xi) = mesh.kind.inverse_map(basis.corners, &p.x) else {
            return Err(LoadError::Cell(CellError {
                at: mesh.centre(cell),
                reason: "a loaded point has no reference position".into(),
            }));
        };
        basis.evaluate(&xi, &p.x, *side, &mut values, &mut gradients);
        for (&f, n) in integrator.enrichment.cell(cell).iter().zip(&values) {
            for a in 0..dim {
                force[f as usize * dim + a] += p.weight * n * density[a];
            }
        }
    }
    Ok(())
}

fn body_force(
    integrator: &CellIntegrator<'_>,
    density: &[f64],
    force: &mut [f64],
) -> Result<(), LoadError> {
    let mesh = integrator.mesh;
    let density = [density[0], density[1], third(density)];
    for cell in 0..mesh.cell_count() {
        let points: Vec<(WeightedPoint, f64)> = if integrator.enrichment.is_plain(mesh, cell) {
            let corners = mesh.corners(cell);
            let corners = &corners[..mesh.kind.nodes()];
            gauss_cell(mesh.dim(), 2)
                .into_iter()
                .map(|(xi, w)| {
                    let weight = w * mesh.kind.gradients(corners, &xi).1;
                    let x = mesh.kind.map(corners, &xi);
                    (WeightedPoint { x, weight }, 1.0)
                })
                .collect()
        } else {
            let points = integrator.points(cell)?;
            let sided = |p: &crate::xfem::cell_matrix::SidedPoint| {
                (
                    WeightedPoint {
                        x: p.x,
                        weight: p.weight,
                    },
                    p.side,
                )
            };
            points.iter().map(sided).collect()
        };
        add_points(integrator, cell, &points, &density, force)?;
    }
    Ok(())
}

/// Traction on the facets of a side; `density(n)` is the force per area for the outward normal n.
fn facet_force(
    integrator: &CellIntegrator<'_>,
    region: &Region,
    force: &mut [f64],
    density: impl Fn(&Point) -> Point,
) -> Result<(), LoadError> {
    let mesh = integrator.mesh;
    let nodes = region_nodes(integrator, region);
    let mut loaded = false;
    for &facet in region
        .sides
        .iter()
        .flat_map(|side| mesh.sides.get(side).into_iter().flatten())
    {
        if !mesh
            .facet_nodes(facet)
            .all(|n| nodes.binary_search(&n).is_ok())
        {
            continue;
        }
        loaded = true;
        for (part, side) in facet_parts(integrator, facet) {
            if mesh.dim() == 2 {
                let (p, q) = (part[0], part[1]);
                let d = sub(&q, &p);
                let length = norm(&d);
                let points = loaded_segment(integrator, facet.cell, &p, &q, side);
                add_points(
                    integrator,
                    facet.cell,
                    &points,
                    &density(&[d[1] / length, -d[0] / length, 0.0]),
                    force,
                )?;
            } else {
                for t in cut::fan(&part) {
                    let normal = cross(&sub(&t[1], &t[0]), &sub(&t[2], &t[0]));
                    let size = norm(&normal);
                    if size > 0.0 {
                        let points: Vec<_> = triangle(&t).into_iter().map(|p| (p, side)).collect();
                        add_points(
                            integrator,
                            facet.cell,
                            &points,
                            &density(&normal.map(|v| v / size)),
                            force,
                        )?;
                    }
                }
            }
        }
    }
    if loaded {
        Ok(())
    } else {
        Err(LoadError::Empty("facet"))
    }
}

/// A facet, or its two parts where the cell is split; oriented with the outward normal.
fn facet_parts(integrator: &CellIntegrator<'_>, facet: Facet) -> Vec<(Vec<Point>, f64)> {
    let mesh = integrator.mesh;
    let local = mesh.kind.facets()[facet.local];
    let corners = mesh.corners(facet.cell);
    let vertices: Vec<Point> = local.iter().map(|&i| corners[i]).collect();
    let Some(crack) = integrator.enrichment.split[facet.cell] else {
        return vec![(vertices, 1.0)];
    };
    let phi = integrator.cracks[crack as usize].cell_phi(mesh, facet.cell);
    let phi: Vec<f64> = local.iter().map(|&i| phi[i]).collect();
    parts(&vertices, &phi)
}

/// Parts of a polygon or segment on both sides.
fn parts(vertices: &[Point], phi: &[f64]) -> Vec<(Vec<Point>, f64)> {
    if let ([p, q], [f, g]) = (vertices, phi) {
        if f * g < 0.0 {
            let c = cut::crossing(p, *f, q, *g);
            return vec![(vec![*p, c], f.signum()), (vec![c, *q], g.signum())];
        }
        let side = if *f < 0.0 || *g < 0.0 { -1.0 } else { 1.0 };
        return vec![(vertices.to_vec(), side)];
    }
    let both = [1.0, -1.0].map(|side| (cut::polygon_part(vertices, phi, side), side));
    both.into_iter()
        .filter(|(part, _)| part.len() > 2)
        .collect()
}

fn loaded_segment(
    integrator: &CellIntegrator<'_>,
    cell: usize,
    p: &Point,
    q: &Point,
    side: f64,
) -> Vec<(WeightedPoint, f64)> {
    let n = if integrator.enrichment.has_branch(cell) {
        BRANCH_POINTS
    } else {
        SEGMENT_POINTS
    };
    segment(p, q, n)
        .into_iter()
        .map(|point| (point, side))
        .collect()
}

/// Force per length on the edge where two sides of a 3D box meet.
fn line_force(
    integrator: &CellIntegrator<'_>,
    region: &Region,
    line: &[f64],
    force: &mut [f64],
) -> Result<(), LoadError> {
    let mesh = integrator.mesh;
    let nodes = region_nodes(integrator, region);
    let density = [line[0], line[1], third(line)];
    let mut loaded = false;
    // Every mesh edge on the box edge belongs to one facet of the first side.
    for &facet in region
        .sides
        .first()
        .and_then(|side| mesh.sides.get(side))
        .into_iter()
        .flatten()
    {
        let local = mesh.kind.facets()[facet.local];
        let cell = mesh.cell(facet.cell);
        let corners = mesh.corners(facet.cell);
        for i in 0..local.len() {
            let ends = [local[i], local[(i + 1) % local.len()]];
            if !ends
                .iter()
                .all(|&k| nodes.binary_search(&(cell[k] as usize)).is_ok())
            {
                continue;
            }
            loaded = true;
            let vertices = ends.map(|k| corners[k]);
            let pieces = match integrator.enrichment.split[facet.cell] {
                Some(crack) => {
                    let phi = integrator.cracks[crack as usize].cell_phi(mesh, facet.cell);
                    parts(&vertices, &ends.map(|k| phi[k]))
                }
                None => vec![(vertices.to_vec(), 1.0)],
            };
            for (part, side) in pieces {
                let points = loaded_segment(integrator, facet.cell, &part[0], &part[1], side);
                add_points(integrator, facet.cell, &points, &density, force)?;
            }
        }
    }
    if loaded {
        Ok(())
    } else {
        Err(LoadError::Empty("edge"))
    }
}
