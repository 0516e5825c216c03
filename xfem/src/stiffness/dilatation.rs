//! Mean dilatation: what keeps quadrilaterals and hexahedra from locking as ν → ½.
//!
//! With V the measure of a region r (a whole cell, or one of the parts that cracks divide it into) and ε full:
//!
//! ```text
//!   θ_r = V⁻¹ ∫_r tr ε,     σ = λ θ_r I + 2 μ ε
//!
//!   K[(k,a),(l,b)] = Σ_r λ V⁻¹ ∫_r ∂_a φ_k ∫_r ∂_b φ_l + μ G[(k,b),(l,a)] + μ δ_ab Σ_c G[(k,c),(l,c)]
//! ```
//!
//! A cell of 2 × 2 or 2 × 2 × 2 points has 4 or 8 conditions tr ε = 0 for the 2 or 3 unknowns that it adds to the mesh; here
//! it has one. Nagtegaal, Parks & Rice, Comput. Meth. Appl. Mech. Engng 4 (1974) 153; reduced integration of the λ term
//! is the same, and a mixed method with constant pressures: Malkus & Hughes, ibid. 15 (1978) 63; as a strain operator:
//! Hughes, Int. J. Numer. Meth. Engng 15 (1980) 1413; one pressure per side of a cut cell: Legrain, Moës & Huerta, Comput.
//! Meth. Appl. Mech. Engng 197 (2008) 1835. Uniform strains in a region are their own mean: patch tests stay exact. As 2 μ ε
//! is full, no mode is without energy but rigid motions.

use crate::enrichment::basis::Region;
use crate::geometry::Point;
use crate::material::{Dilatation, Lame};

use super::cell_matrix::{CellError, CellIntegrator};

/// Means of the gradients of a cell's functions.
#[derive(Debug, Clone)]
pub struct MeanGradients {
    lame: Lame,
    dim: usize,
    /// Region by region, function by function [1/m]; empty: the dilatation is that of the gradient.
    means: Vec<Vec<Point>>,
}

impl MeanGradients {
    /// The means over the regions of a cell, by the rule of its stiffness.
    ///
    /// # Errors
    /// A cell that cannot be integrated.
    pub fn new(integrator: &CellIntegrator<'_>, cell: usize) -> Result<Self, CellError> {
        let (lame, dim) = (integrator.lame, integrator.mesh.dim());
        let mut means = Vec::new();
        if lame.dilatation == Dilatation::Mean {
            let mut functions = integrator.functions(cell);
            let zero = vec![[0.0; 3]; functions.numbers.len()];
            let mut measures = vec![0.0; integrator.enrichment.regions(cell)];
            means = vec![zero; measures.len()];
            for p in integrator.points(cell)? {
                functions.evaluate(&p.xi, &p.x, p.region);
                measures[p.region] += p.weight;
                for (mean, g) in means[p.region].iter_mut().zip(&functions.gradients) {
                    *mean = [0, 1, 2].map(|a| mean[a] + p.weight * g[a]);
                }
            }
            for (own, measure) in means.iter_mut().zip(measures) {
                // A region without points of an inexact rule has no stiffness either.
                let factor = if measure > 0.0 { 1.0 / measure } else { 0.0 };
                own.iter_mut().for_each(|g| *g = g.map(|v| v * factor));
            }
        }
        Ok(MeanGradients { lame, dim, means })
    }

    /// Gradients of the functions as the dilatation takes them: the means over a region, or `point` itself.
    pub fn of<'g>(&'g self, region: Region, point: &'g [Point]) -> &'g [Point] {
        self.means.get(region).map_or(point, Vec::as_slice)
    }

    /// The gradient whose stress by Hooke's law is λ θ_r I + 2 μ ε, from that of the displacement,
    /// h + λ / (d λ + 2 μ) (θ_r − tr h) I; `functions`: numbers of the cell's functions, `u`: all unknowns.
    pub fn assumed(
        &self,
        region: Region,
        functions: &[u32],
        u: &[f64],
        mut h: [Point; 3],
    ) -> [Point; 3] {
        let Some(means) = self.means.get(region) else {
            return h;
        };
        let (dim, Lame { lambda, mu, .. }) = (self.dim, self.lame);
        let mut excess = 0.0;
        for (&f, g) in functions.iter().zip(means) {
            excess += (0..dim)
                .map(|a| u[f as usize * dim + a] * g[a])
                .sum::<f64>();
        }
        excess -= (0..dim).map(|a| h[a][a]).sum::<f64>();
        for (a, row) in h.iter_mut().enumerate().take(dim) {
            row[a] += lambda / (dim as f64 * lambda + 2.0 * mu) * excess;
        }
        h
    }
}
