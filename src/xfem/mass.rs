//! Mass matrix of the enriched functions.
//!
//! ```text
//!   M[(p,a),(q,b)] = δ_ab ∫ φ_p φ_q dx                u·M u = ∫ |u_h|² dx
//! ```
//!
//! Every part of a divided cell is integrated by itself, with the points that errors are measured at: exact for products of
//! two Heaviside functions on affine cells in 2D, of degree 5 per tetrahedron in 3D, graded towards tips and fronts. All
//! weights but those of bent parts about a tip are positive and lie in their part, so that a sliver has the mass of a sliver.

use rayon::prelude::*;

use crate::fem::assembly::{Cells, Scatter};
use crate::fem::block_matrix::BlockMatrix;
use crate::fem::elasticity::CellMatrix;

use super::cell_matrix::{CellError, CellIntegrator};
use super::enrichment::Enrichment;
use super::sampling::comparison_points;

/// Points per direction without and with branch functions: degree 6 in triangles, for φ_p φ_q of degree 4; about a tip
/// φ_p φ_q has the factor r, and degree 13 in √r with the measure.
const RULES: [usize; 2] = [4, 6];

/// Mass matrices of all cells.
struct Masses<'a> {
    enrichment: &'a Enrichment,
    users: &'a [Vec<u32>],
    cells: Vec<CellMatrix>,
}

impl Cells for Masses<'_> {
    fn functions(&self, cell: usize) -> &[u32] {
        self.enrichment.cell(cell)
    }
    fn users(&self, function: usize) -> &[u32] {
        &self.users[function]
    }
    fn matrix(&self, cell: usize) -> &CellMatrix {
        &self.cells[cell]
    }
}

/// Mass matrix over all unknowns for density 1 [m^dim], on the pattern of the stiffness.
///
/// # Errors
/// A part of a cell that cannot be integrated.
pub fn mass(integrator: &CellIntegrator<'_>) -> Result<BlockMatrix, CellError> {
    let (mesh, enrichment) = (integrator.mesh, integrator.enrichment);
    let users = enrichment.users();
    let mut matrix = BlockMatrix::pattern(mesh.dim(), &users, |cell| enrichment.cell(cell));
    let cells = (0..mesh.cell_count())
        .into_par_iter()
        .map(|cell| cell_mass(integrator, cell))
        .collect::<Result<_, _>>()?;
    let masses = Masses {
        enrichment,
        users: &users,
        cells,
    };
    Scatter::new(&matrix, &masses, mesh.cell_count()).assemble(&mut matrix, &masses);
    Ok(matrix)
}

fn cell_mass(integrator: &CellIntegrator<'_>, cell: usize) -> Result<CellMatrix, CellError> {
    let dim = integrator.mesh.dim();
    let n = integrator.enrichment.cell(cell).len();
    let mut scalar = CellMatrix::zero(n);
    let tips = &integrator.enrichment.tips;
    let rule = RULES[usize::from(integrator.enrichment.has_branch(cell))];
    for p in comparison_points(integrator, cell, tips, rule)? {
        let p = p.point;
        let values = integrator.values(cell, &p.xi, &p.x, p.region);
        for i in 0..n {
            for j in 0..n {
                scalar.add(i, j, p.weight * values[i] * values[j]);
            }
        }
    }
    let mut full = CellMatrix::zero(n * dim);
    for i in 0..n {
        for j in 0..n {
            for a in 0..dim {
                full.set(i * dim + a, j * dim + a, scalar.get(i, j));
            }
        }
    }
    Ok(full)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::body::{Body, Needs};
    use crate::harness::case;
    use crate::xfem::basis::FunctionKind;

    /// A body cut through, held by its bottom and top.
    fn body(model: &str, mesh: &str, crack: &str, still: &str) -> Body {
        let text = format!(
            "title = \"t\"\nmodel = \"{model}\"\nmaterial = {{ young_pa = 1, poisson = 0.3 }}\nmesh = {{ box = {mesh} }}\n\
             [[crack]]\n{crack}\nfriction = 0\n\
             [[support]]\non = \"bottom\"\ndisplacement_m = {still}\n\
             [[support]]\non = \"top\"\ndisplacement_m = {still}\n"
        );
        let case = case::parse("t.toml", text.as_str()).unwrap();
        Body::new(&case, 1, Needs::default()).unwrap()
    }

    /// u·M u of u = (1, 2[, 3]) s on side 1 and 0 on side 2, s = 1 or x.
    fn found(body: &Body, linear: bool) -> f64 {
        let dim = body.mesh.dim();
        let (crack, enrichment) = (&body.cracks[0], &body.enrichment);
        let mut u = vec![0.0; enrichment.functions.len() * dim];
        for (f, function) in enrichment.functions.iter().enumerate() {
            let x = &body.mesh.nodes[function.node as usize];
            let size = if linear { x[0] } else { 1.0 };
            // ½ (1 + H) = Σ N_i ½ (1 + H_i) + Σ N_i ½ (H − H_i)
            let amount = match function.kind {
                FunctionKind::Heaviside { .. } => 0.5,
                _ if crack.distance(x) >= 0.0 => 1.0,
                _ => 0.0,
            };
            for a in 0..dim {
                u[f * dim + a] = amount * size * (a + 1) as f64;
            }
        }
        let m = mass(&body.integrator()).unwrap();
        m.mul(&u).iter().zip(&u).map(|(a, b)| a * b).sum()
    }

    /// Source: ∫ over the upper part of a body cut by a plane, in closed form. Goal: the mass matrix integrates constant and
    /// linear displacements of one side to rounding, slivers included.
    #[test]
    fn one_side_of_a_cut_body_has_its_own_mass() {
        let square = body(
            "plane-strain",
            "{ min_m = [0, 0], max_m = [1, 1], cells = [3, 3] }",
            "points_m = [[-1, 0.4], [2, 0.7]]",
            "[0, 0]",
        );
        // The line y = 0.5 + x/10: 1 − y above.
        let [constant, linear] = [0.5 - 0.05, 0.5 / 3.0 - 0.1 / 4.0].map(|v| 5.0 * v);
        for (linear, exact) in [(false, constant), (true, linear)] {
            let error = found(&square, linear) / exact - 1.0;
            assert!(error.abs() < 1e-12, "2D, {linear}: {error:e}");
        }
        let cube = body(
            "solid",
            "{ min_m = [0, 0, 0], max_m = [1, 1, 1], cells = [3, 3, 3] }",
            "plane = { point_m = [0, 0, 0.667], normal = [0, 0, 1] }",
            "[0, 0, 0]",
        );
        let height = 1.0 - 0.667;
        for (linear, exact) in [(false, 14.0 * height), (true, 14.0 / 3.0 * height)] {
            let error = found(&cube, linear) / exact - 1.0;
            assert!(error.abs() < 1e-12, "3D, {linear}: {error:e}");
        }
    }

    /// Goal: branch functions, too: u·M u of one of them is ∫ N² (g − g_k)² found with 16 points per direction.
    #[test]
    fn branch_functions_are_integrated_to_six_digits() {
        let body = body(
            "plane-strain",
            "{ min_m = [0, 0], max_m = [1, 1], cells = [5, 5] }",
            "points_m = [[0.31, 0.42], [0.69, 0.58]]\ntip = \"branch\"",
            "[0, 0]",
        );
        let integrator = body.integrator();
        let m = mass(&integrator).unwrap();
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
                    let v = integrator.values(cell, &p.xi, &p.x, p.region)[i];
                    fine += p.weight * v * v;
                }
            }
            let error = m.mul(&unit)[2 * f] / fine - 1.0;
            worst = worst.max(error.abs());
        }
    }
}
