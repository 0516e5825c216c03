//! Contact surfaces integrated over the crack: spaces `facet`, `star`, `p0`.
//!
//! ```text
//!   (B u)_k = (1/w_k) ∫ φ_k F(x) [[u]] dΓ,   w_k = ∫ φ_k dΓ,   P_k = w_k λ_k,   F = (n, a[, b])ᵀ
//! ```
//!
//! φ_k are the functions of the multiplier space. To the methods a multiplier is a contact point like any other: the mean
//! jump of its function in, the force of its function out.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::crack::{Crack, Geometry};
use crate::enrichment::basis::FunctionKind;
use crate::enrichment::facets::{CrackFacets, Facet};
use crate::geometry::{Point, add_scaled, cross, dot, unit};
use crate::quadrature::rational::rational_order;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

use super::edge_pairs::AT_TIP;
use super::facet_rule::{
    FacetPoint, Integrand, front_facet, graded_facet, polygon_points, segment_points,
};
use super::multipliers::{Crossing, Multipliers, constant_space, facet_space, star_space};
use super::pairs::{ContactPoint, ContactSurface, CrackSurface, SurfaceCorner};
use super::space::ContactSpace;
use super::surface_point::SurfacePoint;

/// A facet smaller than this, in units of its cell's size to the power of its dimension, has no multiplier of its own.
const SLIVER: f64 = 1e-10;

/// Contact surface of the `index`-th crack in an integrated space. `held` tells the functions with a prescribed component.
pub fn integrated_surface(
    integrator: &CellIntegrator<'_>,
    index: usize,
    space: ContactSpace,
    held: impl Fn(u32) -> bool,
) -> Result<ContactSurface, CellError> {
    let CellIntegrator {
        mesh, enrichment, ..
    } = integrator;
    let crack = &integrator.cracks[index];
    let facets = CrackFacets::new(mesh, index, crack, enrichment);
    let free = FreeJumps::new(integrator, index, held);
    let multipliers = match space {
        ContactSpace::P0 => constant_space(&facets, |f| free.carries(&facets, f)),
        ContactSpace::Facet => facet_space(&facets, &free.crossings(&facets)),
        ContactSpace::Star | ContactSpace::EdgePairs => {
            star_space(&facets, &free.crossings(&facets))
        }
    };
    let quadrature = surface_points(integrator, index, &facets, &multipliers)?;
    let mut points = vec![Moments::default(); multipliers.count];
    for q in &quadrature {
        let terms = jump_terms(integrator, q);
        for &(k, share) in &q.shares {
            points[k as usize].add(q, share * q.weight, &terms);
        }
    }
    let points = points
        .into_iter()
        .map(|m| m.point(mesh.dim(), crack))
        .collect();
    Ok(assemble(points, &facets, &multipliers, quadrature))
}

/// Nodes whose displacement jumps across a crack and is free to do so.
struct FreeJumps<'a> {
    integrator: &'a CellIntegrator<'a>,
    crack: &'a Crack,
    nodes: BTreeSet<u32>,
    sizes: Vec<f64>,
}

impl<'a> FreeJumps<'a> {
    fn new(integrator: &'a CellIntegrator<'a>, index: usize, held: impl Fn(u32) -> bool) -> Self {
        let enrichment = integrator.enrichment;
        let jumps = |kind: FunctionKind| match kind {
            FunctionKind::Heaviside { crack } => crack as usize == index,
            FunctionKind::Branch { tip, order: 0 } => enrichment.tips[tip as usize].crack == index,
            _ => false,
        };
        FreeJumps {
            integrator,
            crack: &integrator.cracks[index],
            nodes: (0..enrichment.functions.len() as u32)
                .filter(|&f| jumps(enrichment.functions[f as usize].kind) && !held(f))
                .map(|f| enrichment.functions[f as usize].node)
                .collect(),
            sizes: integrator.mesh.node_sizes(),
        }
    }

    /// What happens at every corner; `None` where no multiplier can live: inside cells, at tips, where all is held.
    fn crossings(&self, facets: &CrackFacets) -> Vec<Option<Crossing>> {
        let tips = &self.integrator.enrichment.tips;
        facets
            .corners
            .iter()
            .map(|corner| {
                let [i, j] = corner.nodes?;
                let size = self.sizes[i as usize].min(self.sizes[j as usize]);
                if tips
                    .iter()
                    .any(|tip| tip.distance(&corner.x) <= AT_TIP * size)
                {
                    return None;
                }
                let free = |node: u32| self.nodes.contains(&node).then_some(node);
                let ends = [free(i), if i == j { None } else { free(j) }];
                let (fi, fj) = (
                    self.crack.phi[i as usize].abs(),
                    self.crack.phi[j as usize].abs(),
                );
                ends.iter().any(Option::is_some).then_some(Crossing {
                    ends,
                    fraction: if i == j { 0.0 } else { fi / (fi + fj) },
                })
            })
            .collect()
    }

    /// Whether a facet can carry a constant multiplier: a free jump, and an area worth an equation.
    fn carries(&self, facets: &CrackFacets, facet: usize) -> bool {
        let mesh = self.integrator.mesh;
        let cell = facets.facets[facet].cell;
        let area: f64 = super::pairs::vertex_weights(&facets.polygon(&facets.facets[facet]))
            .iter()
            .sum();
        let size = mesh
            .cell(cell)
            .iter()
            .map(|&n| self.sizes[n as usize])
            .fold(f64::INFINITY, f64::min);
        area > SLIVER * size.powi(mesh.dim() as i32 - 1)
            && mesh.cell(cell).iter().any(|n| self.nodes.contains(n))
    }
}

/// Quadrature points of the facets that carry a multiplier.
pub fn surface_points(
    integrator: &CellIntegrator<'_>,
    index: usize,
    facets: &CrackFacets,
    multipliers: &Multipliers,
) -> Result<Vec<SurfacePoint>, CellError> {
    let crack = &integrator.cracks[index];
    let kind = integrator.mesh.kind;
    let mut points = Vec::new();
    for (facet, shares) in facets.facets.iter().zip(&multipliers.shares) {
        if shares.iter().any(Vec::is_empty) {
            continue;
        }
        let corners = integrator.mesh.corners(facet.cell);
        for point in facet_points(integrator, index, facets, facet) {
            let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
            for (hat, own) in point.hats.iter().zip(shares) {
                for &(k, share) in own {
                    *sum.entry(k).or_default() += hat * share;
                }
            }
            let Some(xi) = kind.inverse_map(&corners[..kind.nodes()], &point.x) else {
                return Err(CellError {
                    at: point.x,
                    reason: "a point of the crack has no reference position".into(),
                });
            };
            points.push(SurfacePoint {
                crack: crack.number,
                cell: facet.cell,
                x: point.x,
                xi,
                weight: point.weight,
                regions: facet.regions,
                frame: facet.frame,
                shares: sum.into_iter().filter(|(_, share)| *share != 0.0).collect(),
            });
        }
    }
    Ok(points)
}

/// Rule of one facet by what lives in its cell.
fn facet_points(
    integrator: &CellIntegrator<'_>,
    index: usize,
    facets: &CrackFacets,
    facet: &Facet,
) -> Vec<FacetPoint> {
    let CellIntegrator {
        mesh, enrichment, ..
    } = integrator;
    let corners = mesh.corners(facet.cell);
    let polygon = facets.polygon(facet);
    let affine = mesh.kind.is_affine(&corners[..mesh.kind.nodes()]);
    let branch = enrichment.has_branch(facet.cell);
    if let &[p, q] = polygon.as_slice() {
        let own = enrichment.tips.iter().filter(|tip| tip.crack == index);
        let tips: Vec<Point> = own.map(|tip| tip.position).collect();
        let integrand = match (branch, affine) {
            (true, _) => Integrand::Root(&tips),
            (false, true) => Integrand::Polynomial,
            (false, false) => {
                let corners = &corners[..mesh.kind.nodes()];
                Integrand::Rational(rational_order(mesh.kind, corners, [&p, &q]))
            }
        };
        return segment_points(&[p, q], integrand);
    }
    match (&integrator.cracks[index].geometry, branch, &facet.front) {
        (Geometry::Ellipse(ellipse), true, Some(cut)) => front_facet(ellipse, cut, &polygon),
        (Geometry::Ellipse(ellipse), true, None) => {
            let distance = |x: &Point| ellipse.nearest(x).psi.abs();
            graded_facet(&polygon, distance)
        }
        _ => polygon_points(&polygon, affine),
    }
}

/// [[φ_f]] of the functions of a cell at a point of the crack.
pub fn jump_terms(integrator: &CellIntegrator<'_>, q: &SurfacePoint) -> Vec<(u32, f64)> {
    let values = q
        .regions
        .map(|region| integrator.values(q.cell, &q.xi, &q.x, region));
    let functions = integrator.enrichment.cell(q.cell);
    functions
        .iter()
        .enumerate()
        .map(|(i, &f)| (f, values[0][i] - values[1][i]))
        .filter(|(_, jump)| *jump != 0.0)
        .collect()
}

/// ∫ φ_k (…) dΓ of one multiplier.
#[derive(Debug, Clone, Default)]
struct Moments {
    weight: f64,
    x: Point,
    frame: [Point; 3],
    jump: BTreeMap<u32, [Point; 3]>,
}

impl Moments {
    fn add(&mut self, q: &SurfacePoint, weight: f64, terms: &[(u32, f64)]) {
        self.weight += weight;
        self.x = add_scaled(&self.x, weight, &q.x);
        for (sum, axis) in self.frame.iter_mut().zip(&q.frame) {
            *sum = add_scaled(sum, weight, axis);
        }
        for &(f, jump) in terms {
            let rows = self.jump.entry(f).or_default();
            for (row, axis) in rows.iter_mut().zip(&q.frame) {
                *row = add_scaled(row, weight * jump, axis);
            }
        }
    }

    fn point(self, dim: usize, crack: &Crack) -> ContactPoint {
        let scale = |v: &Point| v.map(|c| c / self.weight);
        let x = scale(&self.x);
        ContactPoint {
            crack: crack.number,
            x,
            s: if dim == 2 { crack.abscissa(&x) } else { 0.0 },
            frame: mean_frame(&self.frame),
            weight: self.weight,
            terms: self
                .jump
                .iter()
                .map(|(&f, rows)| (f, rows.map(|row| scale(&row))))
                .collect(),
        }
    }
}

/// Right-handed frame around a mean normal; its first tangent closest to the mean of the tangents.
fn mean_frame(sums: &[Point; 3]) -> [Point; 3] {
    let n = unit(&sums[0]);
    let a = unit(&add_scaled(&sums[1], -dot(&sums[1], &n), &n));
    [n, a, cross(&n, &a)]
}

/// Numbers the points along the crack and gathers the surface.
fn assemble(
    points: Vec<ContactPoint>,
    facets: &CrackFacets,
    multipliers: &Multipliers,
    mut quadrature: Vec<SurfacePoint>,
) -> ContactSurface {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| points[i].compare(&points[j]));
    let mut number = vec![0; points.len()];
    for (position, &old) in order.iter().enumerate() {
        number[old] = position as u32;
    }
    let renumbered = |shares: &[(u32, f64)]| -> Vec<(u32, f64)> {
        let mut shares: Vec<_> = shares
            .iter()
            .map(|&(k, v)| (number[k as usize], v))
            .collect();
        shares.sort_by_key(|share| share.0);
        shares
    };
    for q in &mut quadrature {
        q.shares = renumbered(&q.shares);
    }
    let mut corners: Vec<SurfaceCorner> = Vec::new();
    let mut known: BTreeMap<(usize, Vec<(u32, u64)>), usize> = BTreeMap::new();
    let mut faces = Vec::new();
    for (facet, shares) in facets.facets.iter().zip(&multipliers.shares) {
        if shares.iter().any(Vec::is_empty) {
            continue;
        }
        let face = facet.corners.iter().zip(shares).map(|(&corner, own)| {
            let shares = renumbered(own);
            let key = (
                corner,
                shares.iter().map(|&(k, v)| (k, v.to_bits())).collect(),
            );
            *known.entry(key).or_insert_with(|| {
                corners.push(SurfaceCorner {
                    x: facets.corners[corner].x,
                    shares,
                });
                corners.len() - 1
            })
        });
        faces.push(face.collect());
    }
    let mut slots: Vec<Option<ContactPoint>> = points.into_iter().map(Some).collect();
    ContactSurface {
        points: order
            .into_iter()
            .filter_map(|old| slots[old].take())
            .collect(),
        surface: CrackSurface {
            corners,
            facets: faces,
            quadrature,
        },
    }
}
