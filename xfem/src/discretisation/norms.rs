//! Norms of a discrete solution and its difference from a closed form over the body: energy and displacement.

use crate::enrichment::basis::FunctionKind;
use crate::exact::Field;
use crate::fields::sampling::comparison_points;
use crate::geometry::{Point, dot, sub};
use crate::material::{double_dot, strain, stress};
use crate::stiffness::cell_matrix::CellError;
use rayon::prelude::*;

use super::Discretisation;
use super::tips::fronts;

/// Points per direction of the rule for errors: doubling it changes them by less than 1e-3 of themselves.
pub const RULE: usize = 4;

/// Integrals over the body, all of squares.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bulk {
    /// Area [m²] or volume [m³].
    pub measure: f64,
    /// ∫ σ:C⁻¹:σ, exact [J, in 2D J/m].
    pub energy: f64,
    /// ∫ σ_h:C⁻¹:σ_h.
    pub energy_found: f64,
    /// ∫ (σ_h − σ):C⁻¹:(σ_h − σ).
    pub energy_error: f64,
    /// ∫ |u|², exact [m^(2 + dim)].
    pub displacement: f64,
    /// ∫ |u_h|².
    pub displacement_found: f64,
    /// ∫ |u_h − u|².
    pub displacement_error: f64,
    /// ∫ σ:σ, exact [Pa² m^dim].
    pub stress: f64,
}

impl Bulk {
    fn add(&mut self, other: &Bulk) {
        self.measure += other.measure;
        self.energy += other.energy;
        self.energy_found += other.energy_found;
        self.energy_error += other.energy_error;
        self.displacement += other.displacement;
        self.displacement_found += other.displacement_found;
        self.displacement_error += other.displacement_error;
        self.stress += other.stress;
    }
}

/// Integrals of the discrete field of all unknowns u, of the exact one and of their difference, with `rule` points per
/// direction.
///
/// # Errors
/// [`CellError`] of a cell that cannot be integrated.
pub fn bulk(
    body: &Discretisation,
    field: &dyn Field,
    u: &[f64],
    rule: usize,
) -> Result<Bulk, CellError> {
    let integrator = body.integrator();
    let (lame, dim) = (body.lame, body.mesh.dim());
    let fronts = fronts(body);
    let of_cell = |cell: usize| -> Result<Bulk, CellError> {
        let mut discrete = integrator.stress(cell)?;
        let mut sums = Bulk::default();
        for at in comparison_points(&integrator, cell, &fronts, rule)? {
            let p = at.point;
            let side = at.side.unwrap_or_else(|| side_of(body, &p.x));
            let (v, h) = discrete.field(&p.xi, &p.x, p.region, u);
            let found = stress(lame, dim, &h);
            let exact = field.stress(&p.x, side);
            let error = [0, 1, 2].map(|a| sub(&found[a], &exact[a]));
            let energy = |s: &[Point; 3]| double_dot(s, &strain(lame, dim, s));
            let exact_v = field.displacement(&p.x, side);
            let square = |v: &Point| v.iter().map(|x| x * x).sum::<f64>();
            sums.add(&Bulk {
                measure: p.weight,
                energy: p.weight * energy(&exact),
                energy_found: p.weight * energy(&found),
                energy_error: p.weight * energy(&error),
                displacement: p.weight * square(&exact_v),
                displacement_found: p.weight * square(&v),
                displacement_error: p.weight * square(&sub(&v, &exact_v)),
                stress: p.weight * double_dot(&exact, &exact),
            });
        }
        Ok(sums)
    };
    // Summed in the order of the cells, whatever thread a part comes from.
    let parts: Vec<Bulk> = (0..body.mesh.cell_count())
        .into_par_iter()
        .map(of_cell)
        .collect::<Result<_, _>>()?;
    let mut total = Bulk::default();
    for part in &parts {
        total.add(part);
    }
    Ok(total)
}

/// Side of the crack that a point off the crack lies on; 1 in a body without cracks. A closed form belongs to one crack.
pub fn side_of(body: &Discretisation, x: &Point) -> f64 {
    let distance = match (body.cracks.first(), body.points.first()) {
        (Some(crack), _) => crack.distance(x),
        // A crack along cell edges has no level set, but points.
        (None, Some(point)) => dot(&point.frame[0], &sub(x, &point.x)),
        (None, None) => 0.0,
    };
    if distance < 0.0 { -1.0 } else { 1.0 }
}

/// Branch functions of a node on their crack, with their values on a side of it: elsewhere they vanish at their nodes.
fn on_faces(body: &Discretisation, node: u32, side: f64) -> Vec<(usize, f64)> {
    let enrichment = &body.enrichment;
    let value = |f: usize| {
        let FunctionKind::Branch { tip, order } = enrichment.functions[f].kind else {
            return None;
        };
        let frame = &enrichment.tips[tip as usize];
        let on =
            body.cracks[frame.crack].holds(node) && enrichment.ramp(tip as usize, &[node]) & 1 == 1;
        on.then(|| {
            let g = frame.branch(&body.mesh.nodes[node as usize], Some(side)).0;
            (f, g[order as usize] - enrichment.shifts[f])
        })
    };
    enrichment
        .enriched_of(node as usize)
        .filter_map(value)
        .collect()
}

/// Mean squares of the displacement at the nodes: found, exact, difference [m²].
pub fn nodal_displacement(body: &Discretisation, field: &dyn Field, u: &[f64]) -> [f64; 3] {
    let dim = body.mesh.dim();
    // Both nodes of a doubled pair lie on the crack: their side is the sign with which they enter the jump.
    let mut pair_side = vec![None; body.mesh.nodes.len()];
    for point in &body.points {
        for (f, rows) in &point.terms {
            let function = body.enrichment.functions[*f as usize];
            if function.kind == FunctionKind::Standard {
                let coefficient = dot(&rows[0], &point.frame[0]);
                pair_side[function.node as usize] = Some(f64::signum(coefficient));
            }
        }
    }
    let mut sums = [0.0; 3];
    for (node, x) in body.mesh.nodes.iter().enumerate() {
        let side = pair_side[node].unwrap_or_else(|| match body.cracks.first() {
            Some(crack) => crack.side_of(&body.mesh, node),
            None => side_of(body, x),
        });
        let exact = field.displacement(x, side);
        let own = on_faces(body, node as u32, side);
        for a in 0..dim {
            let branches = own.iter().map(|(f, value)| value * u[f * dim + a]);
            let found = u[node * dim + a] + branches.sum::<f64>();
            sums[0] += found * found;
            sums[1] += exact[a] * exact[a];
            sums[2] += (found - exact[a]).powi(2);
        }
    }
    sums.map(|s| s / body.mesh.nodes.len() as f64)
}
