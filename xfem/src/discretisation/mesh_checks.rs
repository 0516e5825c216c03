//! The judge of the mesh: cheap tests on a body before anything is solved on it.
//!
//! ```text
//!   uniform stress    u = ε x, no jumps:  r_f = (K u)_f + ∫_Γ [[φ_f]] σ n dΓ = 0 for every function f of a cell near a
//!                     crack that vanishes on the border of the body;  largest |r_f| / √(K_ff σ:ε V), V: mean measure of these cells, σ = C ε, all unit ε
//! ```
//!
//! K u integrates the gradients over the parts of the cells, the other term the jumps over the facets that carry multipliers:
//! a part lost or counted twice, a wrong side or normal, a function that jumps where there is no crack, a facet without
//! multiplier leave a residual. It bounds the error of a uniform stress in the energy of a cell. On a sliver N_k is a
//! difference of coordinates: what their rounding ε_x makes of the jumps, 4 (ε_x/h) |σ| ∫_Γ dΓ over the facets where φ_f
//! jumps, counts as none.

use std::collections::BTreeSet;

use crate::geometry::{Point, add_scaled, dot, norm};
use crate::material::stress;
use crate::quadrature::measure;
use rayon::prelude::*;

use super::Discretisation;

/// A body whose uniform stress is off by more than this is suspect, unless its coordinates hold fewer digits.
pub const UNIFORM: f64 = 1e-9;

/// Steps from coordinates to N_k on a crack, each of which rounds: its place, where it crosses an edge, ξ, N.
const STEPS: f64 = 4.0;

/// Where contact forces move slender parts this many times as far as they deform stiff cells, displacements carry the
/// rounding of the stiffness, 2e-16, times it: layers between cracks were off by 1e-13 to 1e-9 below 1e7, one of 2e7 by 4e-8,
/// by 1e-9 to 1e-7 above 1e8.
const SWAY: f64 = 1e7;

/// Findings of the tests on a body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeshChecks {
    /// Residual of uniform stress [-].
    pub uniform: f64,
    /// Where it is largest: the node of the function, in the coordinates of the case file [m].
    pub at: Point,
    /// Rounding of the coordinates in shortest edges: far from the origin a cell holds no more digits.
    pub rounding: f64,
}

impl MeshChecks {
    /// Fault of the mesh, if there is one.
    pub fn reason(&self) -> Option<String> {
        // NaN passes no comparison.
        let exact = self.uniform <= UNIFORM.max(self.rounding);
        let ([x, y, z], off) = (self.at, self.uniform);
        (!exact)
            .then(|| format!("uniform stress is off by {off:.1e} near ({x:.6}, {y:.6}, {z:.6})"))
    }
}

/// Fault of a body whose slender parts sway so far, if there is one.
pub fn swaying(sway: f64) -> Option<String> {
    let digits = -(f64::EPSILON * sway).log10();
    (sway > SWAY).then(|| {
        format!("slender parts between cracks move {sway:.0e} times as far as cells deform: displacements hold {digits:.0} digits")
    })
}

/// Tests a body.
pub fn mesh_checks(body: &Discretisation) -> MeshChecks {
    let (mesh, dim, lame) = (&body.mesh, body.mesh.dim(), body.lame);
    let (_, centre) = mesh.extent();
    let enriched = |cell: &usize| !body.enrichment.is_plain(mesh, *cell);
    let cells: Vec<usize> = (0..mesh.cell_count()).filter(enriched).collect();
    let volume: f64 = cells.iter().map(|&c| measure(&mesh.map(c))).sum();
    let cell = volume / cells.len().max(1) as f64;
    let tested = tested_functions(body, &cells);
    let columns = neighbours(body, &tested);
    let jumps = jump_moments(body);
    let rounding = mesh.rounding() / mesh.smallest_edge();
    let strains: Vec<_> = (0..dim)
        .flat_map(|a| (0..=a).map(move |b| (a, b)))
        .collect();
    // Largest residual and its function; NaN is the worst.
    let worse = |x: (f64, usize), y: (f64, usize)| {
        if y.0 <= x.0 || x.0.is_nan() { x } else { y }
    };
    let of_strain = |&(a, b): &(usize, usize)| {
        let mut strain = [[0.0; 3]; 3];
        strain[a][b] += 0.5;
        strain[b][a] += 0.5;
        let sigma = stress(lame, dim, &strain);
        let energy: f64 = sigma.iter().zip(&strain).map(|(s, e)| dot(s, e)).sum();
        let mut u = vec![0.0; body.numbers.len()];
        for &node in columns.iter().filter(|&&f| f < mesh.nodes.len()) {
            let from = add_scaled(&mesh.nodes[node], -1.0, &centre);
            for c in 0..dim {
                u[node * dim + c] = dot(&strain[c], &from);
            }
        }
        let wanted = |f: usize| tested[f];
        let force = (body.stiffness).mul_at(columns.iter().copied(), wanted, &u);
        let residual = |f: usize| {
            let scale = |i: usize| (body.stiffness.diagonal_at(i) * energy * cell).sqrt();
            let of = |c: usize| {
                let i = f * dim + c;
                let (moment, area) = &jumps[f];
                let missing = (force[i] + dot(&sigma[c], moment)).abs();
                let lost = STEPS * rounding * norm(&sigma[c]) * area;
                if scale(i) > 0.0 && (missing > lost || missing.is_nan()) {
                    missing / scale(i)
                } else {
                    0.0
                }
            };
            (0..dim).map(of).fold(0.0, f64::max)
        };
        let of_tested = columns.iter().filter(|&&f| tested[f]);
        let residuals = of_tested.map(|&f| (residual(f), f));
        residuals.fold((0.0, 0), worse)
    };
    let worst: Vec<(f64, usize)> = strains.par_iter().map(of_strain).collect();
    let (uniform, function) = worst.into_iter().fold((0.0, 0), worse);
    let node = body.enrichment.functions[function].node as usize;
    MeshChecks {
        uniform,
        at: body.place(&mesh.nodes[node]),
        rounding,
    }
}

/// ∫ [[φ_f]] n dΓ over the facets that carry multipliers, and the area of those where φ_f jumps, by function.
fn jump_moments(body: &Discretisation) -> Vec<(Point, f64)> {
    let integrator = body.integrator();
    let mut moments = vec![([0.0; 3], 0.0); body.enrichment.functions.len()];
    let quadrature = body.surface.quadrature.par_iter();
    let terms: Vec<_> = quadrature.map(|q| q.jump_terms(&integrator)).collect();
    for (q, terms) in body.surface.quadrature.iter().zip(terms) {
        let carried: f64 = q.shares.iter().map(|share| share.1).sum();
        for (f, jump) in terms {
            let (moment, area) = &mut moments[f as usize];
            *moment = add_scaled(moment, carried * q.weight * jump, &q.frame[0]);
            *area += q.weight;
        }
    }
    moments
}

/// Functions of the cells near cracks that vanish on the border of the body and on cracks along cell facets: in plain cells
/// uniform stress holds on any mesh.
fn tested_functions(body: &Discretisation, cells: &[usize]) -> Vec<bool> {
    let mesh = &body.mesh;
    let functions = &body.enrichment.functions;
    let mut tested = vec![false; functions.len()];
    for &function in cells.iter().flat_map(|&cell| body.enrichment.cell(cell)) {
        tested[function as usize] = true;
    }
    let mut border: BTreeSet<u32> = BTreeSet::new();
    for facet in mesh.sides.values().flatten() {
        border.extend(mesh.facet_nodes(*facet).map(|n| n as u32));
    }
    for point in body.points.iter() {
        let standard = |f: &u32| (*f as usize) < mesh.nodes.len();
        border.extend(point.terms.iter().map(|(f, _)| *f).filter(standard));
    }
    for (tested, function) in tested.iter_mut().zip(functions) {
        *tested = *tested && !border.contains(&function.node);
    }
    tested
}

/// Functions that share a cell with a tested one, ascending.
fn neighbours(body: &Discretisation, tested: &[bool]) -> Vec<usize> {
    let mut shared = vec![false; tested.len()];
    for cell in 0..body.mesh.cell_count() {
        let functions = body.enrichment.cell(cell);
        if functions.iter().any(|&f| tested[f as usize]) {
            functions.iter().for_each(|&f| shared[f as usize] = true);
        }
    }
    (0..shared.len()).filter(|&f| shared[f]).collect()
}
