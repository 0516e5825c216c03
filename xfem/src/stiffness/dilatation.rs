//! Mean dilatation: what keeps quadrilaterals and hexahedra from locking as ν → ½.
//!
//! With V the measure of a region r (a whole cell, or one of the parts that cracks divide it into) and ε full:
//!
//! ```text
//!   θ = V⁻¹ ∫_r tr ε,     σ = λ θ I + 2 μ ε
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
//!
//! Where a cell has branch functions the dilatation that they are there for is singular: tr ε of Williams' fields is
//! r^−½ cos θ/2 and r^−½ sin θ/2, whose means would cost the branch functions their accuracy. There tr ε is projected in L² on
//! these two besides the constant, as Legrain et al. enrich the pressure: θ = Σ_m q_m ∫_r q_m tr ε with q_m orthonormal. Only
//! close to the tip: farther away they differ from constants by too little to be missed.

use crate::cut::part::Region;
use crate::enrichment::basis::{ABSENT, FunctionKind};
use crate::geometry::clip::Side;
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, dot};
use crate::material::Lame;

use super::cell_matrix::{CellIntegrator, SidedPoint};
use super::consistent::EvaluatedPoint;

/// A mode is dropped if less than this part of its square lies outside the span of those before it: all but those in the cells
/// next to a tip, about 1 cell away. Three pressures in every cell with branch functions lock again: the sliding crack of
/// `inclined_crack` at ν = 0.4999 on 10 × 10 cells has K_II off by 19 % with 1e-6 here, 11 % with 0.02, 0.3 % with 0.06.
const DROPPED: f64 = 0.06;

/// A tip with branch functions in a cell, and the side of its crack by region; `None`: by position.
type Tip<'a> = (&'a TipFrame, Vec<Option<Side>>);

/// An orthonormal mode q of the dilatation in a region.
#[derive(Debug, Clone)]
struct Mode {
    /// Its coefficients of 1 and the singular functions.
    coefficients: Vec<f64>,
    /// ∫ q ∇φ by function.
    integrals: Vec<Point>,
}

/// The dilatation of a cell as the stiffness takes it.
#[derive(Debug, Clone)]
pub struct ProjectedDilatation<'a> {
    lame: Lame,
    dim: usize,
    tips: Vec<Tip<'a>>,
    /// Modes by region.
    regions: Vec<Vec<Mode>>,
}

impl<'a> ProjectedDilatation<'a> {
    /// Means and modes over the regions of a cell, by the points of its stiffness.
    pub fn of(integrator: &CellIntegrator<'a>, cell: usize, evaluated: &[EvaluatedPoint]) -> Self {
        let mut projected = ProjectedDilatation {
            lame: integrator.lame,
            dim: integrator.mesh.dim(),
            tips: tips(integrator, cell),
            regions: Vec::new(),
        };
        let count = integrator.enrichment.cell(cell).len();
        for region in 0..integrator.enrichment.regions(cell) {
            let own = evaluated.iter().filter(|p| p.at.region == region);
            let points: Vec<&SidedPoint> = own.clone().map(|p| &p.at).collect();
            let mut modes = projected.orthonormal(region, &points);
            for mode in &mut modes {
                mode.integrals = vec![[0.0; 3]; count];
            }
            for p in own {
                let shapes = projected.shapes(region, &p.at.x);
                for mode in &mut modes {
                    let factor = p.at.weight * mode.at(&shapes);
                    for (sum, g) in mode.integrals.iter_mut().zip(&p.gradients) {
                        *sum = [0, 1, 2].map(|a| sum[a] + factor * g[a]);
                    }
                }
            }
            projected.regions.push(modes);
        }
        projected
    }

    /// 1 and, for every tip, r^−½ sin θ/2 and r^−½ cos θ/2; for both ends of a crack Im Z and Re Z − 1, the slopes of its first
    /// branch function.
    fn shapes(&self, region: Region, x: &Point) -> Vec<f64> {
        let mut shapes = vec![1.0];
        for (tip, sides) in &self.tips {
            let (values, gradients) = tip.branch(x, sides[region]);
            if let FrontShape::Pair { .. } = tip.shape {
                shapes.extend([&tip.ahead, &tip.normal].map(|axis| dot(&gradients[0], axis)));
                continue;
            }
            // √r sin θ/2, √r cos θ/2, …
            let [s, c, ..] = values;
            let r = s * s + c * c;
            shapes.extend([s, c].map(|g| if r > 0.0 { g / r } else { 0.0 }));
        }
        shapes
    }

    /// Orthonormal modes over the points of a region; none over no points.
    fn orthonormal(&self, region: Region, points: &[&SidedPoint]) -> Vec<Mode> {
        let values: Vec<Vec<f64>> = points.iter().map(|p| self.shapes(region, &p.x)).collect();
        let product = |f: &[f64], g: &[f64]| -> f64 {
            let at = |c: &[f64], v: &[f64]| -> f64 { c.iter().zip(v).map(|(c, v)| c * v).sum() };
            let terms = points.iter().zip(&values);
            terms.map(|(p, v)| p.weight * at(f, v) * at(g, v)).sum()
        };
        let count = 1 + 2 * self.tips.len();
        let mut modes: Vec<Mode> = Vec::with_capacity(count);
        for k in 0..count {
            let mut mode = vec![0.0; count];
            mode[k] = 1.0;
            let whole = product(&mode, &mode);
            // Twice for orthogonality.
            for _ in 0..2 {
                for known in &modes {
                    let part = product(&mode, &known.coefficients);
                    let pairs = mode.iter_mut().zip(&known.coefficients);
                    pairs.for_each(|(c, k)| *c -= part * k);
                }
            }
            let square = product(&mode, &mode);
            if square > DROPPED * whole {
                let factor = 1.0 / square.sqrt();
                modes.push(Mode {
                    coefficients: mode.iter().map(|c| c * factor).collect(),
                    integrals: Vec::new(),
                });
            }
        }
        modes
    }

    /// ∫ q ∂_a φ of all modes of all regions, by function and component.
    pub fn integrals(&self) -> Vec<Vec<f64>> {
        let modes = self.regions.iter().flatten();
        let flat = |mode: &Mode| {
            let all = mode.integrals.iter();
            all.flat_map(|g| g[..self.dim].iter().copied()).collect()
        };
        modes.map(flat).collect()
    }

    /// The gradients of all functions, so many, at x as the dilatation takes them.
    pub fn gradients(&self, region: Region, x: &Point, count: usize) -> Vec<Point> {
        let shapes = self.shapes(region, x);
        let mut found = vec![[0.0; 3]; count];
        for mode in &self.regions[region] {
            let q = mode.at(&shapes);
            for (sum, g) in found.iter_mut().zip(&mode.integrals) {
                *sum = [0, 1, 2].map(|a| sum[a] + q * g[a]);
            }
        }
        found
    }

    /// The gradient whose stress by Hooke's law is λ θ I + 2 μ ε, from that of the displacement at x,
    /// h + λ / (d λ + 2 μ) (θ − tr h) I; `functions`: numbers of the cell's functions, `u`: all unknowns.
    pub fn projected(
        &self,
        region: Region,
        x: &Point,
        functions: &[u32],
        u: &[f64],
        mut h: [Point; 3],
    ) -> [Point; 3] {
        let (dim, Lame { lambda, mu, .. }) = (self.dim, self.lame);
        let mut excess = -(0..dim).map(|a| h[a][a]).sum::<f64>();
        let gradients = self.gradients(region, x, functions.len());
        for (&f, g) in functions.iter().zip(&gradients) {
            let own = &u[f as usize * dim..][..dim];
            excess += own.iter().zip(g).map(|(u, g)| u * g).sum::<f64>();
        }
        for (a, row) in h.iter_mut().enumerate().take(dim) {
            row[a] += lambda / (dim as f64 * lambda + 2.0 * mu) * excess;
        }
        h
    }
}

impl Mode {
    fn at(&self, shapes: &[f64]) -> f64 {
        self.coefficients
            .iter()
            .zip(shapes)
            .map(|(c, s)| c * s)
            .sum()
    }
}

/// The tips whose branch functions live in a cell.
fn tips<'a>(integrator: &CellIntegrator<'a>, cell: usize) -> Vec<Tip<'a>> {
    let enrichment = integrator.enrichment;
    let (functions, steps) = (enrichment.cell(cell), enrichment.steps(cell));
    let mut numbers: Vec<u32> = Vec::new();
    let mut found = Vec::new();
    for (i, &f) in functions.iter().enumerate() {
        let FunctionKind::Branch { tip, .. } = enrichment.functions[f as usize].kind else {
            continue;
        };
        if numbers.contains(&tip) {
            continue;
        }
        numbers.push(tip);
        let side = |region: Region| {
            let step = steps[region * functions.len() + i];
            (step != 0.0 && step != ABSENT).then_some(step)
        };
        let sides = (0..enrichment.regions(cell)).map(side).collect();
        found.push((&enrichment.tips[tip as usize], sides));
    }
    found
}
