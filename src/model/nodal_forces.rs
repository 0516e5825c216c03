//! Loads: from the words of a case to consistent nodal forces.
//!
//! ```text
//!   f(φ e_a) = ∫_side t_a φ dA + ∫_edge l_a φ ds + ∫_body b_a φ dV − ∫_body σ₀_ab ∂_b φ dV
//! ```
//!
//! φ runs over all functions of the body, enriched ones too; split facets and cells are integrated side by side, and of facets
//! and edges what lies in the region of the load.

use stickslip_xfem::enrichment::basis::Region as CellRegion;
use stickslip_xfem::enrichment::cell_facets::{Piece, pieces};
use stickslip_xfem::exact::Field;
use stickslip_xfem::geometry::clip::fan;
use stickslip_xfem::geometry::{Point, cross, dot, norm, sub};
use stickslip_xfem::quadrature::{WeightedPoint, gauss_map, segment, triangle, triangle_collapsed};
use stickslip_xfem::stiffness::cell_matrix::{CellError, CellIntegrator, SidedPoint};
use stickslip_xfem::stiffness::consistent::outward;

use crate::case::{LoadKind, Parts, Region};
use crate::model::border::{Border, BorderPart};
use crate::model::sides::Sides;

/// Gauss points per segment where loads act: exact for linear shape functions times quadratic densities, for closed forms
/// (smooth on the border of the body), and for facets that carry branch functions, an error below 1e-6.
const SEGMENT_POINTS: usize = 3;
const EXACT_POINTS: usize = 8;
const BRANCH_POINTS: usize = 24;

/// Points per direction of collapsed rules on the triangles of loaded 3D facets, for closed forms: degree 8.
const EXACT_TRIANGLE: usize = 5;

/// Gauss points per direction in whole cells for body forces of closed forms: degree 7.
const EXACT_CELL: usize = 4;

/// A density at a point in a region of a cell.
type Density<'a> = &'a dyn Fn(usize, &Point, CellRegion) -> Point;

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

/// Adds the nodal forces of a load at factor 1, over all unknowns [N, in 2D N/m]; nothing of those that the closed form gives.
///
/// `sides` is needed by loads on one side of a crack only.
pub fn add_fixed_forces(
    integrator: &CellIntegrator<'_>,
    border: &Border<'_>,
    sides: Option<&Sides>,
    kind: &LoadKind,
    force: &mut [f64],
) -> Result<(), LoadError> {
    let on = |region| Loaded {
        integrator,
        border,
        region,
    };
    match kind {
        LoadKind::Body(density, side) => {
            let density = [density[0], density[1], third(density)];
            let own = side.as_ref().map(|s| s.side).zip(sides);
            let on_side = |cell, x: &Point, split| match own {
                Some((side, sides)) if sides.of_point(integrator, cell, x, split) != side => {
                    [0.0; 3]
                }
                _ => density,
            };
            body_force(integrator, Rule::Fixed, &on_side, force)
        }
        LoadKind::Traction(region, traction) => {
            let at = |x: &Point| {
                let mut t = [0.0; 3];
                for (t, polynomial) in t.iter_mut().zip(traction) {
                    *t = polynomial.at(x);
                }
                t
            };
            on(region).facet_force(Rule::Fixed, force, |_, x, _, _| at(x))
        }
        LoadKind::Pressure(region, pressure) => {
            on(region).facet_force(Rule::Fixed, force, |_, x, _, n| {
                n.map(|v| -pressure.at(x) * v)
            })
        }
        LoadKind::Line(region, line) => on(region).line_force(line, force),
        LoadKind::InitialStress(stress) => initial_stress(integrator, stress, force),
        LoadKind::ExactTraction(_) | LoadKind::ExactBody => Ok(()),
    }
}

/// Adds the nodal forces that a load takes from the closed form, over all unknowns [N, in 2D N/m].
pub fn add_exact_forces(
    integrator: &CellIntegrator<'_>,
    border: &Border<'_>,
    sides: &Sides,
    kind: &LoadKind,
    field: &dyn Field,
    force: &mut [f64],
) -> Result<(), LoadError> {
    let side = |cell, x: &Point, split| sides.of_point(integrator, cell, x, split);
    match kind {
        LoadKind::ExactTraction(region) => {
            let loaded = Loaded {
                integrator,
                border,
                region,
            };
            loaded.facet_force(Rule::Exact, force, |cell, x, split, n| {
                let stress = field.stress(x, side(cell, x, split));
                stress.map(|row| dot(&row, n))
            })
        }
        LoadKind::ExactBody => {
            let density = |cell, x: &Point, split| field.body_force(x, side(cell, x, split));
            body_force(integrator, Rule::Exact, &density, force)
        }
        _ => Ok(()),
    }
}

/// Nothing acts, over all unknowns.
pub fn no_force(integrator: &CellIntegrator<'_>) -> Vec<f64> {
    vec![0.0; integrator.enrichment.functions.len() * integrator.mesh.dim()]
}

/// Rule for what is integrated.
#[derive(Clone, Copy, PartialEq)]
enum Rule {
    /// Polynomials of second degree.
    Fixed,
    /// Smooth functions.
    Exact,
}

fn third(v: &[f64]) -> f64 {
    v.get(2).copied().unwrap_or(0.0)
}

/// f(φ) += Σ w φ(x) t(x) over points of a cell, each in a region of the cell.
fn add_points(
    integrator: &CellIntegrator<'_>,
    cell: usize,
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
        let t = density(cell, &p.x, *region);
        functions.evaluate(&xi, &p.x, *region);
        for (&f, n) in functions.numbers.iter().zip(&functions.values) {
            for a in 0..dim {
                force[f as usize * dim + a] += p.weight * n * t[a];
            }
        }
    }
    Ok(())
}

fn body_force(
    integrator: &CellIntegrator<'_>,
    rule: Rule,
    density: Density<'_>,
    force: &mut [f64],
) -> Result<(), LoadError> {
    for cell in 0..integrator.mesh.cell_count() {
        let points = body_points(integrator, cell, rule)?;
        add_points(integrator, cell, &points, density, force)?;
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

/// f(φ e_a) −= ∫ σ₀_ab ∂_b φ, by the rule the stiffness is integrated with: both then vanish on the same modes.
fn initial_stress(
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

/// The part of the border that a load acts on.
struct Loaded<'a> {
    integrator: &'a CellIntegrator<'a>,
    border: &'a Border<'a>,
    region: &'a Region,
}

impl Loaded<'_> {
    /// What the region holds of a piece of the border.
    fn inside(&self, piece: Vec<Point>) -> Parts {
        let [inside, _] = self.border.split(self.region, piece);
        inside
    }

    /// Facets of the side, or edges where two sides meet, of which the region holds something.
    fn parts(&self, name: &'static str) -> Result<Vec<BorderPart>, LoadError> {
        let mut parts = self.border.parts(self.region);
        parts.retain(|part| !self.inside(self.border.corners(part)).is_empty());
        match parts.is_empty() {
            true => Err(LoadError::Empty(name)),
            false => Ok(parts),
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

    /// Traction on the facets of a side; `density(cell, x, region, n)` is the force per area for the outward normal n.
    fn facet_force(
        &self,
        rule: Rule,
        force: &mut [f64],
        density: impl Fn(usize, &Point, CellRegion, &Point) -> Point,
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
                        let t = density(cell, &p.x, region, &normal);
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
                    let density = |cell, x: &Point, region| density(cell, x, region, &normal);
                    add_points(integrator, cell, &points, &density, force)
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

    /// Force per length on the edge where two sides of a 3D box meet.
    fn line_force(&self, line: &[f64], force: &mut [f64]) -> Result<(), LoadError> {
        let density = [line[0], line[1], third(line)];
        for edge in self.parts("edge")? {
            for (part, region) in self.pieces(&edge) {
                let ends = [&part[0], &part[1]];
                let points = loaded_segment(self.integrator, Rule::Fixed, edge.cell, ends, region);
                add_points(
                    self.integrator,
                    edge.cell,
                    &points,
                    &|_, _, _| density,
                    force,
                )?;
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
