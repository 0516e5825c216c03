//! Mass matrix of the enriched functions, for norms of displacements.
//!
//! ```text
//!   M[(p,a),(q,b)] = δ_ab ∫ φ_p φ_q dx                u·M u = ∫ |u_h|² dx
//! ```
//!
//! Every part of a divided cell is integrated by itself, with the points that errors are measured at: exact for products of
//! two Heaviside functions on affine cells in 2D, of degree 5 per tetrahedron in 3D, graded towards tips and fronts. All
//! weights but those of bent parts about a tip are positive and lie in their part, so that a sliver has the mass of a sliver.

use nalgebra::{DMatrix, DVectorView};
use rayon::prelude::*;
use stickslip::model::body::Body;
use stickslip_xfem::enrichment::basis::FunctionKind;
use stickslip_xfem::fields::sampling::comparison_points;
use stickslip_xfem::stiffness::assembly::Assembly;
use stickslip_xfem::stiffness::block_matrix::BlockMatrix;
use stickslip_xfem::stiffness::cell_matrix::CellIntegrator;

use crate::common::*;

/// Points per direction without and with branch functions: degree 6 in triangles, for φ_p φ_q of degree 4; about a tip
/// φ_p φ_q has the factor r, and degree 13 in √r with the measure; between the ends of a short crack it is no polynomial.
const RULES: [usize; 2] = [4, 10];

/// Mass matrix over all unknowns for density 1 [m^dim], on the pattern of the stiffness.
pub fn mass(integrator: &CellIntegrator<'_>) -> BlockMatrix {
    let cells: Vec<DMatrix<f64>> = (0..integrator.mesh.cell_count())
        .into_par_iter()
        .map(|cell| cell_mass(integrator, cell))
        .collect();
    let assembly = Assembly::new(integrator.mesh.dim(), integrator.enrichment);
    assembly.sum(|cell| cells[cell].as_view())
}

fn cell_mass(integrator: &CellIntegrator<'_>, cell: usize) -> DMatrix<f64> {
    let dim = integrator.mesh.dim();
    let mut functions = integrator.functions(cell);
    let n = functions.numbers.len();
    let mut scalar = DMatrix::zeros(n, n);
    let tips = &integrator.enrichment.tips;
    let rule = RULES[usize::from(integrator.enrichment.has_branch(cell))];
    for p in comparison_points(integrator, cell, tips, rule).unwrap() {
        let p = p.point;
        functions.evaluate(&p.xi, &p.x, p.region);
        let values = DVectorView::from_slice(&functions.values, n);
        scalar.ger(p.weight, &values, &values, 1.0);
    }
    scalar.kronecker(&DMatrix::identity(dim, dim))
}

/// A unit square with one crack.
fn square(cells: usize, ends: [[f64; 2]; 2], tip: &str) -> Body {
    let rest = crack(ends[0], ends[1], 0.3, tip) + &clamped(2);
    body(&plane([0.0, 0.0], [1.0, 1.0], [cells, cells], &rest))
}

/// u·M u of u = (1, 2[, 3]) s on side 1 and 0 on side 2, s = 1 or x.
fn found(body: &Body, linear: bool) -> f64 {
    let dim = body.mesh.dim();
    let (crack, enrichment) = (&body.cracks[0], &body.enrichment);
    let mut u = vec![0.0; enrichment.functions.len() * dim];
    for (f, function) in enrichment.functions.iter().enumerate() {
        let x = &body.mesh.nodes[function.node as usize];
        let size = if linear { body.place(x)[0] } else { 1.0 };
        // 1 on side 1: N_i of the nodes there, and the pieces of the others that lie there
        let amount = match function.kind {
            FunctionKind::Piece { .. } if crack.distance(x) >= 0.0 => -0.5,
            FunctionKind::Piece { .. } => 0.5,
            _ if crack.distance(x) >= 0.0 => 1.0,
            _ => 0.0,
        };
        for a in 0..dim {
            u[f * dim + a] = amount * size * (a + 1) as f64;
        }
    }
    let m = mass(&body.integrator());
    m.mul(&u).iter().zip(&u).map(|(a, b)| a * b).sum()
}

/// Source: ∫ over the upper part of a body cut by a plane, in closed form. Goal: the mass matrix integrates constant and
/// linear displacements of one side to rounding, slivers included.
#[test]
fn one_side_of_a_cut_body_has_its_own_mass() {
    let square = square(3, [[-1.0, 0.4], [2.0, 0.7]], "none");
    // The line y = 0.5 + x/10: 1 − y above.
    let [constant, linear] = [0.5 - 0.05, 0.5 / 3.0 - 0.1 / 4.0].map(|v| 5.0 * v);
    for (linear, exact) in [(false, constant), (true, linear)] {
        let error = found(&square, linear) / exact - 1.0;
        assert!(error.abs() < 1e-12, "2D, {linear}: {error:e}");
    }
    let sliver = ([0.0, 0.0, 0.667], [0.0, 0.0, 1.0], 0.3);
    let cube = body(&solid([1.0; 3], [3; 3], &[sliver], &clamped(3)));
    let height = 1.0 - 0.667;
    for (linear, exact) in [(false, 14.0 * height), (true, 14.0 / 3.0 * height)] {
        let error = found(&cube, linear) / exact - 1.0;
        assert!(error.abs() < 1e-12, "3D, {linear}: {error:e}");
    }
}

/// Goal: branch functions, too: u·M u of one of them is ∫ N² (g − g_k)² found with 16 points per direction.
#[test]
fn branch_functions_are_integrated_to_six_digits() {
    let body = square(5, [[0.31, 0.42], [0.69, 0.58]], "branch");
    let integrator = body.integrator();
    let m = mass(&integrator);
    let mut worst: f64 = 0.0;
    for (f, function) in body.enrichment.functions.iter().enumerate() {
        if !matches!(function.kind, FunctionKind::Branch { .. }) {
            continue;
        }
        let mut unit = vec![0.0; body.enrichment.functions.len() * 2];
        unit[2 * f] = 1.0;
        let mut fine = 0.0;
        for cell in 0..body.mesh.cell_count() {
            let functions = integrator.enrichment.cell(cell);
            let Some(i) = functions.iter().position(|&g| g as usize == f) else {
                continue;
            };
            for p in comparison_points(&integrator, cell, &body.enrichment.tips, 16).unwrap() {
                let p = p.point;
                let mut functions = integrator.functions(cell);
                functions.evaluate(&p.xi, &p.x, p.region);
                let v = functions.values[i];
                fine += p.weight * v * v;
            }
        }
        let error = m.mul(&unit)[2 * f] / fine - 1.0;
        worst = worst.max(error.abs());
    }
    assert!(worst > 0.0 && worst < 1e-6, "{worst:e}");
}
