//! Contact surfaces integrated over the crack: the space `star`.
//!
//! ```text
//!   (B u)_k = (1/w_k) ∫ φ_k F(x) [[u]] dΓ,   w_k = ∫ φ_k dΓ,   P_k = w_k λ_k,   F = (n, a[, b])ᵀ
//! ```
//!
//! φ_k are the functions of the multiplier space. To the methods a multiplier is a contact point like any other: the mean
//! jump of its function in, the force of its function out.

use std::collections::BTreeMap;

use crate::cut::crack::Crack;
use crate::enrichment::facets::CrackFacets;
use crate::geometry::{Point, add_scaled, cross, dot, unit};
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

use super::free_jumps::FreeJumps;
use super::multipliers::{Multipliers, star_space};
use super::pairs::{ContactPoint, ContactSurface, CrackSurface, SurfaceCorner};
use super::surface_point::SurfacePoint;
use super::surface_rule::surface_points;

/// Contact surface of the `index`-th crack. `held` tells the prescribed unknowns.
pub fn integrated(
    integrator: &CellIntegrator<'_>,
    index: usize,
    held: impl Fn(usize) -> bool,
) -> Result<ContactSurface, CellError> {
    let crack = &integrator.cracks[index];
    let mut free = FreeJumps::new(integrator, index, held);
    let multipliers = star_space(&mut free);
    let facets = &free.facets;
    let quadrature = surface_points(integrator, index, facets, &multipliers)?;
    let mut points = vec![Moments::default(); multipliers.count];
    for q in &quadrature {
        let terms = q.jump_terms(integrator);
        for &(k, share) in &q.shares {
            points[k as usize].add(q, share * q.weight, &terms);
        }
    }
    let points: Vec<ContactPoint> = points.into_iter().map(|m| m.point(crack)).collect();
    Ok(assemble(&points, facets, &multipliers, quadrature))
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

    fn point(self, crack: &Crack) -> ContactPoint {
        let scale = |v: &Point| v.map(|c| c / self.weight);
        let x = scale(&self.x);
        ContactPoint {
            crack: crack.number,
            x,
            s: crack.abscissa(&x),
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
    points: &[ContactPoint],
    facets: &CrackFacets,
    multipliers: &Multipliers,
    quadrature: Vec<SurfacePoint>,
) -> ContactSurface {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| points[i].compare(&points[j]));
    let mut number = vec![0; points.len()];
    for (position, &old) in order.iter().enumerate() {
        number[old] = position as u32;
    }
    let mut corners: Vec<SurfaceCorner> = Vec::new();
    let mut known: BTreeMap<(usize, Vec<(u32, u64)>), usize> = BTreeMap::new();
    let mut faces = Vec::new();
    for (facet, shares) in facets.facets.iter().zip(&multipliers.shares) {
        if shares.iter().any(Vec::is_empty) {
            continue;
        }
        let face = facet.corners.iter().zip(shares).map(|(&corner, own)| {
            let mut shares = own.clone();
            shares.sort_by_key(|share| share.0);
            let bits = shares.iter().map(|&(k, v)| (k, v.to_bits()));
            let key = (corner, bits.collect());
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
    let mut surface = CrackSurface {
        corners,
        facets: faces,
        quadrature,
    };
    surface.renumber(|k| number[k as usize]);
    ContactSurface {
        points: order.into_iter().map(|old| points[old].clone()).collect(),
        surface,
    }
}
