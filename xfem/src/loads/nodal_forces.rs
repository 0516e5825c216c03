//! Consistent nodal forces of loads.
//!
//! ```text
//!   f(φ e_a) = ∫_side t_a φ dA + ∫_edge l_a φ ds + ∫_body b_a φ dV − ∫_body σ₀_ab ∂_b φ dV
//! ```
//!
//! φ runs over all functions of the body, enriched ones too; split facets and cells are integrated side by side, and of facets
//! and edges what lies in the region of the load.

use crate::contact::pairs::ContactPoint;
use crate::cut::part::Region as CellRegion;
use crate::enrichment::cell_facets::{Piece, pieces};
use crate::geometry::clip::fan;
use crate::geometry::{Point, cross, dot, norm, sub};
use crate::quadrature::{WeightedPoint, gauss_map, segment, triangle, triangle_collapsed};
use crate::stiffness::border::outward;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator, SidedPoint};

use super::border::{Border, BorderPart, Parts, Region};

/// Gauss points per segment where loads act: exact for linear shape functions times quadratic densities, for closed forms
/// (smooth on the border of the body), and for facets that carry branch functions, an error below 1e-6.
const SEGMENT_POINTS: usize = 3;
const EXACT_POINTS: usize = 8;
const BRANCH_POINTS: usize = 24;

/// Points per direction of collapsed rules on the triangles of loaded 3D facets, for closed forms: degree 8.
const EXACT_TRIANGLE: usize = 5;

/// Gauss points per direction in whole cells for body forces of closed forms: degree 7.
const EXACT_CELL: usize = 4;

/// A loaded point.
pub struct Place<'a> {
    /// Cell.
    pub cell: usize,
    /// Position [m].
    pub x: &'a Point,
    /// Region of the cell.
    pub region: CellRegion,
    /// Outward normal on facets, 0 elsewhere.
    pub normal: &'a Point,
}

/// Force per area, length or volume at a point [Pa, N/m, N/m³].
pub type Density<'a> = &'a dyn Fn(&Place<'_>) -> Point;

/// Domain that a density acts on.
#[derive(Clone, Copy)]
pub enum Domain<'a> {
    /// Facets of a side.
    Facets(Region<'a>),
    /// Edges where two sides of a solid meet.
    Edges(Region<'a>),
    /// All cells.
    Cells,
}

/// Rule for what is integrated.
#[derive(Clone, Copy, PartialEq)]
pub enum Rule {
    /// Polynomials of second degree.
    Fixed,
    /// Smooth functions: closed forms.
    Exact,
}

/// A load that cannot be integrated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// No facet or edge lies in the region.
    #[error("the region holds no cell {0}")]
    Empty(&'static str),
    /// A cell could not be integrated.
    #[error(transparent)]
    Cell(#[from] CellError),
}

/// Adds the nodal forces of a density over all unknowns [N, in 2D N/m].
///
/// # Errors
/// A region that holds no facet or edge, a loaded point without a place in its cell.
pub fn add_forces(
    integrator: &CellIntegrator<'_>,
    border: &Border<'_>,
    on: Domain<'_>,
    rule: Rule,
    density: Density<'_>,
    force: &mut [f64],
) -> Result<(), LoadError> {
    let loaded = |region| Loaded {
        integrator,
        border,
        region,
    };
    match on {
        Domain::Facets(region) => loaded(region).facet_force(rule, density, force),
        Domain::Edges(region) => loaded(region).edge_force(density, force),
        Domain::Cells => {
            for cell in 0..integrator.mesh.cell_count() {
                let points = body_points(integrator, cell, rule)?;
                add_points(integrator, cell, [0.0; 3], &points, density, force)?;
            }
            Ok(())
        }
    }
}

/// Nothing acts, over all unknowns.
pub fn no_force(integrator: &CellIntegrator<'_>) -> Vec<f64> {
    vec![0.0; integrator.enrichment.functions.len() * integrator.mesh.dim()]
}

/// f(φ) += Σ w φ(x) t(x) over points of a cell, each in a region of the cell.
fn add_points(
    integrator: &CellIntegrator<'_>,
    cell: usize,
    normal: Point,
    points: &[(WeightedPoint, CellRegion)],
    density: Density<'_>,
    force: &mut [f64],
) -> Result<(), LoadError> {
    let dim = integrator.mesh.dim();
    let mut functions = integrator.functions(cell);
    for (p, region) in points {
        let Some(xi) = functions.map.inverse(&p.x) else {
            return Err(LoadError::Cell(CellError {
                at: functions.map.centre(),
                reason: "a loaded point has no reference position".into(),
            }));
        };
        let t = density(&Place {
            cell,
            x: &p.x,
            region: *region,
            normal: &normal,
        });
        functions.evaluate(&xi, &p.x, *region);
        for (&f, n) in functions.numbers.iter().zip(&functions.values) {
            for a in 0..dim {
                force[f as usize * dim + a] += p.weight * n * t[a];
            }
        }
    }
    Ok(())
}

/// Points of a cell for a body force times its functions.
fn body_points(
    integrator: &CellIntegrator<'_>,
    cell: usize,
    rule: Rule,
) -> Result<Vec<(WeightedPoint, CellRegion)>, LoadError> {
    let (mesh, enrichment) = (integrator.mesh, integrator.enrichment);
    let map = mesh.map(cell);
    let whole = |n: usize| gauss_map(&map, n).map(|(_, p)| (p, 0)).collect();
    if enrichment.is_plain(mesh, cell) {
        return Ok(whole(if rule == Rule::Exact { EXACT_CELL } else { 2 }));
    }
    if rule == Rule::Exact && !enrichment.has_branch(cell) {
        let Some(partition) = enrichment.partition(cell) else {
            return Ok(whole(EXACT_CELL));
        };
        let parts = partition
            .parts
            .iter()
            .enumerate()
            .flat_map(|(region, part)| {
                let points = part.fine_points(&map);
                points.into_iter().map(move |p| (p, region))
            });
        return Ok(parts.collect());
    }
    let points = integrator.points(cell)?.into_iter().map(|p| {
        let SidedPoint {
            x, weight, region, ..
        } = p;
        (WeightedPoint { x, weight }, region)
    });
    Ok(points.collect())
}

/// Adds f(φ e_a) = −∫ σ₀_ab ∂_b φ of a uniform stress [Pa], by the rule the stiffness is integrated with: both then vanish on
/// the same modes.
///
/// # Errors
/// A cell that cannot be integrated.
pub fn add_initial_stress(
    integrator: &CellIntegrator<'_>,
    stress: &[Point; 3],
    force: &mut [f64],
) -> Result<(), LoadError> {
    let dim = integrator.mesh.dim();
    for cell in 0..integrator.mesh.cell_count() {
        let functions = integrator.enrichment.cell(cell);
        for p in integrator.evaluated(cell)? {
            for (&f, g) in functions.iter().zip(&p.gradients) {
                for a in 0..dim {
                    force[f as usize * dim + a] -= p.at.weight * dot(&stress[a], g);
                }
            }
        }
    }
    Ok(())
}

/// Forces on side 1 at the contact points that a uniform stress implies: −w e·σ n for every axis e of the local frame, `dim` per
/// point [N, in 2D N/m].
pub fn implied_forces(dim: usize, points: &[ContactPoint], stress: &[Point; 3]) -> Vec<f64> {
    let forces = points.iter().flat_map(|point| {
        let on_normal = stress.map(|row| dot(&row, &point.frame[0]));
        (0..dim).map(move |e| -point.weight * dot(&point.frame[e], &on_normal))
    });
    forces.collect()
}

/// The part of the border that a load acts on.
struct Loaded<'a> {
    integrator: &'a CellIntegrator<'a>,
    border: &'a Border<'a>,
    region: Region<'a>,
}

impl Loaded<'_> {
    /// Part of a piece of the border that the region holds.
    fn inside(&self, piece: Vec<Point>) -> Parts {
        let [inside, _] = self.border.split(&self.region, piece);
        inside
    }

    /// Facets of the side, or edges where two sides meet, of which the region holds something.
    fn parts(&self, name: &'static str) -> Result<Vec<BorderPart>, LoadError> {
        let mut parts = self.border.parts(&self.region);
        parts.retain(|part| !self.inside(self.border.corners(part)).is_empty());
        if parts.is_empty() {
            Err(LoadError::Empty(name))
        } else {
            Ok(parts)
        }
    }

    /// Pieces of a facet or edge in the region, divided among the regions of its cell.
    fn pieces(&self, part: &BorderPart) -> Vec<Piece> {
        let CellIntegrator {
            mesh,
            cracks,
            enrichment,
            ..
        } = self.integrator;
        let all = pieces(mesh, cracks, enrichment, part.cell, &part.local).into_iter();
        let own = all.flat_map(|(piece, r)| self.inside(piece).into_iter().map(move |p| (p, r)));
        own.collect()
    }

    /// Forces on the facets of a side.
    fn facet_force(
        &self,
        rule: Rule,
        density: Density<'_>,
        force: &mut [f64],
    ) -> Result<(), LoadError> {
        let integrator = self.integrator;
        for facet in self.parts("facet")? {
            let cell = facet.cell;
            if integrator.enrichment.has_branch(cell) && rule == Rule::Fixed {
                // The points with which the gradients of branch functions are in balance.
                let normal = outward(&integrator.mesh.map(cell), &facet.local);
                let mut functions = integrator.functions(cell);
                let (dim, numbers) = (integrator.mesh.dim(), functions.numbers);
                let inside = |piece| self.inside(piece);
                integrator.visit_border(
                    cell,
                    &facet.local,
                    &inside,
                    &mut functions,
                    |f, p, region, value| {
                        let t = density(&Place {
                            cell,
                            x: &p.x,
                            region,
                            normal: &normal,
                        });
                        let own = &mut force[numbers[f] as usize * dim..][..dim];
                        own.iter_mut()
                            .zip(t)
                            .for_each(|(f, t)| *f += p.weight * value * t);
                    },
                )?;
                continue;
            }
            for (part, region) in self.pieces(&facet) {
                let mut add = |normal: Point, points: Vec<(WeightedPoint, CellRegion)>| {
                    add_points(integrator, cell, normal, &points, density, force)
                };
                if integrator.mesh.dim() == 2 {
                    let (p, q) = (part[0], part[1]);
                    let d = sub(&q, &p);
                    let length = norm(&d);
                    let points = loaded_segment(integrator, rule, cell, [&p, &q], region);
                    add([d[1] / length, -d[0] / length, 0.0], points)?;
                    continue;
                }
                for t in fan(&part) {
                    let normal = cross(&sub(&t[1], &t[0]), &sub(&t[2], &t[0]));
                    let size = norm(&normal);
                    if size > 0.0 {
                        let points = match rule {
                            Rule::Fixed => triangle(&t),
                            Rule::Exact => triangle_collapsed(&t, EXACT_TRIANGLE),
                        };
                        let points = points.into_iter().map(|p| (p, region));
                        add(normal.map(|v| v / size), points.collect())?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Forces on the edges where two sides of a solid meet.
    fn edge_force(&self, density: Density<'_>, force: &mut [f64]) -> Result<(), LoadError> {
        let integrator = self.integrator;
        for edge in self.parts("edge")? {
            for (part, region) in self.pieces(&edge) {
                let ends = [&part[0], &part[1]];
                let points = loaded_segment(integrator, Rule::Fixed, edge.cell, ends, region);
                add_points(integrator, edge.cell, [0.0; 3], &points, density, force)?;
            }
        }
        Ok(())
    }
}

fn loaded_segment(
    integrator: &CellIntegrator<'_>,
    rule: Rule,
    cell: usize,
    [p, q]: [&Point; 2],
    region: CellRegion,
) -> Vec<(WeightedPoint, CellRegion)> {
    let n = if integrator.enrichment.has_branch(cell) {
        BRANCH_POINTS
    } else if rule == Rule::Exact {
        EXACT_POINTS
    } else {
        SEGMENT_POINTS
    };
    segment(p, q, n)
        .into_iter()
        .map(|point| (point, region))
        .collect()
}
