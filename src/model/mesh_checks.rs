//! The judge of the mesh: cheap tests on a body before anything is solved on it.
//!
//! ```text
//!   uniform stress    u = ε x, no jumps:  r_f = (K u)_f + ∫_Γ [[φ_f]] σ n dΓ = 0 for every function f that vanishes on the
//!                     border of the body;  largest |r_f| / √(K_ff σ:ε V), V: mean measure of a cell, σ = C ε, all unit ε
//! ```
//!
//! K u integrates the gradients over the parts of the cells, the other term the jumps over the facets that carry multipliers:
//! a part lost or counted twice, a wrong side or normal, a function that jumps where there is no crack, a facet without
//! multiplier leave a residual. It bounds the error of a uniform stress in the energy of a cell.

use std::collections::BTreeSet;

use rayon::prelude::*;
use stickslip_xfem::geometry::{Point, add_scaled, dot};
use stickslip_xfem::material::stress;
use stickslip_xfem::quadrature::measure;

use crate::model::body::Body;

/// A body whose uniform stress is off by more than this is suspect, unless its coordinates hold fewer digits.
pub const UNIFORM: f64 = 1e-9;

/// What the tests on a body found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeshChecks {
    /// Residual of uniform stress [-].
    pub uniform: f64,
    /// Where it is largest: the node of the function [m].
    pub at: Point,
    /// Rounding of the coordinates in shortest edges: far from the origin a cell holds no more digits.
    pub rounding: f64,
}

impl MeshChecks {
    /// What is wrong with the mesh, if anything is.
    pub fn reason(&self) -> Option<String> {
        // NaN passes no comparison.
        let exact = self.uniform <= UNIFORM.max(self.rounding);
        (!exact).then(|| {
            let [x, y, z] = self.at;
            let off = self.uniform;
            format!("uniform stress is off by {off:.1e} near ({x:.6}, {y:.6}, {z:.6})")
        })
    }
}

/// Tests a body.
pub fn mesh_checks(body: &Body) -> MeshChecks {
    let (mesh, dim, lame) = (&body.mesh, body.mesh.dim(), body.lame);
    let (_, centre) = mesh.extent();
    let volume: f64 = (0..mesh.cell_count()).map(|c| measure(&mesh.map(c))).sum();
    let cell = volume / mesh.cell_count() as f64;
    let outside = border_functions(body);
    let diagonal = body.stiffness.diagonal();
    let jumps = jump_moments(body);
    let mut found = MeshChecks {
        uniform: 0.0,
        at: centre,
        rounding: mesh.rounding() / mesh.smallest_edge(),
    };
    for (a, b) in (0..dim).flat_map(|a| (0..=a).map(move |b| (a, b))) {
        let mut strain = [[0.0; 3]; 3];
        strain[a][b] += 0.5;
        strain[b][a] += 0.5;
        let sigma = stress(lame, dim, &strain);
        let energy: f64 = sigma.iter().zip(&strain).map(|(s, e)| dot(s, e)).sum();
        let mut u = vec![0.0; body.numbers.len()];
        for (node, x) in mesh.nodes.iter().enumerate() {
            let from = add_scaled(x, -1.0, &centre);
            for c in 0..dim {
                u[node * dim + c] = dot(&strain[c], &from);
            }
        }
        let force = body.stiffness.mul(&u);
        let residual = |f: usize| {
            let scale = |i: usize| (diagonal[i] * energy * cell).sqrt();
            let of = |c: usize| {
                let i = f * dim + c;
                let missing = force[i] + dot(&sigma[c], &jumps[f]);
                if scale(i) > 0.0 {
                    (missing / scale(i)).abs()
                } else {
                    0.0
                }
            };
            (0..dim).map(of).fold(0.0, f64::max)
        };
        let functions = (0..body.enrichment.functions.len()).into_par_iter();
        let worst = functions
            .filter(|f| !outside[*f])
            .map(|f| (residual(f), f))
            .reduce(
                || (0.0, 0),
                |x, y| if y.0 > x.0 || x.0.is_nan() { y } else { x },
            );
        if worst.0 > found.uniform || worst.0.is_nan() {
            found.uniform = worst.0;
            found.at = mesh.nodes[body.enrichment.functions[worst.1].node as usize];
        }
    }
    found
}

/// ∫ [[φ_f]] n dΓ over the facets that carry multipliers, by function.
fn jump_moments(body: &Body) -> Vec<Point> {
    let mut moments = vec![[0.0; 3]; body.enrichment.functions.len()];
    let integrator = body.integrator();
    for q in &body.surface.quadrature {
        let carried: f64 = q.shares.iter().map(|share| share.1).sum();
        for (f, jump) in q.jump_terms(&integrator) {
            let moment = &mut moments[f as usize];
            *moment = add_scaled(moment, carried * q.weight * jump, &q.frame[0]);
        }
    }
    moments
}

/// Functions that do not vanish on the border of the body or on a crack along cell facets.
fn border_functions(body: &Body) -> Vec<bool> {
    let mesh = &body.mesh;
    let mut nodes: BTreeSet<u32> = BTreeSet::new();
    for facet in mesh.sides.values().flatten() {
        nodes.extend(mesh.facet_nodes(*facet).map(|n| n as u32));
    }
    for point in body.points.iter() {
        let standard = |f: &u32| (*f as usize) < mesh.nodes.len();
        nodes.extend(point.terms.iter().map(|(f, _)| *f).filter(standard));
    }
    let functions = body.enrichment.functions.iter();
    functions.map(|f| nodes.contains(&f.node)).collect()
}
