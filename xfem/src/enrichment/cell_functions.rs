//! The functions of one cell, evaluated point by point.

use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, sub};
use crate::mesh::Mesh;
use crate::mesh::cell::CellMap;

use super::Enrichment;
use super::basis::{FunctionKind, Region};

/// One scalar function of one cell.
#[derive(Debug, Clone, Copy)]
struct CellFunction {
    /// Local node.
    local: usize,
    /// Kind.
    kind: FunctionKind,
    /// g_l(x_k) of a branch function.
    shift: f64,
    /// Local nodes i of the cell over which the ramp ρ = Σ N_i of a branch function runs, one bit each; all: ρ = 1.
    ramp: u8,
}

/// The functions of one cell with their values and gradients at the point evaluated last.
#[derive(Debug)]
pub struct CellFunctions<'a> {
    /// Map from the reference cell.
    pub map: CellMap,
    /// Numbers of the functions, the standard ones first.
    pub numbers: &'a [u32],
    /// Values of the functions.
    pub values: Vec<f64>,
    /// Gradients of the functions [1/m].
    pub gradients: Vec<Point>,
    functions: Vec<CellFunction>,
    /// ∂ξ/∂x of an affine cell.
    inverse: Option<[Point; 3]>,
    steps: &'a [f64],
    tips: &'a [TipFrame],
}

impl<'a> CellFunctions<'a> {
    /// Functions of a cell.
    pub fn new(mesh: &Mesh, enrichment: &'a Enrichment, cell: usize) -> Self {
        let nodes = mesh.cell(cell);
        let of = |&f: &u32| {
            let function = enrichment.functions[f as usize];
            let local = nodes.iter().position(|&n| n == function.node);
            CellFunction {
                // Every function of the cell belongs to one of its nodes.
                local: local.unwrap_or_default(),
                kind: function.kind,
                shift: enrichment.shifts[f as usize],
                ramp: match function.kind {
                    FunctionKind::Branch { tip, .. } => enrichment.ramp(tip as usize, nodes),
                    _ => u8::MAX,
                },
            }
        };
        let numbers = enrichment.cell(cell);
        let map = mesh.map(cell);
        CellFunctions {
            inverse: map.constant_inverse(),
            map,
            numbers,
            values: vec![0.0; numbers.len()],
            gradients: vec![[0.0; 3]; numbers.len()],
            functions: numbers.iter().map(of).collect(),
            steps: enrichment.steps(cell),
            tips: &enrichment.tips,
        }
    }

    /// Local node of every function and its constant in a region, see [`Enrichment::steps`].
    pub fn steps(&self, region: Region) -> impl Iterator<Item = (usize, f64)> + '_ {
        let count = self.functions.len();
        let steps = &self.steps[region * count..(region + 1) * count];
        self.functions
            .iter()
            .map(|f| f.local)
            .zip(steps.iter().copied())
    }

    /// Whether each function is a branch function.
    pub fn are_branches(&self) -> Vec<bool> {
        let kinds = self.functions.iter().map(|f| f.kind);
        kinds
            .map(|kind| matches!(kind, FunctionKind::Branch { .. }))
            .collect()
    }

    /// Evaluates all functions at ξ (position x) in a region of the cell.
    pub fn evaluate(&mut self, xi: &Point, x: &Point, region: Region) {
        let n = self.map.kind.shape(xi);
        let dn = match &self.inverse {
            Some(inverse) => self.map.gradients_by(xi, inverse),
            None => self.map.gradients(xi).0,
        };
        let mut cached: Option<Branches> = None;
        let count = self.functions.len();
        let steps = &self.steps[region * count..(region + 1) * count];
        let out = self.values.iter_mut().zip(&mut self.gradients);
        for ((f, step), (value, gradient)) in self.functions.iter().zip(steps).zip(out) {
            let (ni, dni) = (n[f.local], dn[f.local]);
            match f.kind {
                FunctionKind::Standard => (*value, *gradient) = (ni, dni),
                FunctionKind::Piece { .. } => {
                    (*value, *gradient) = (ni * step, dni.map(|d| d * step));
                }
                FunctionKind::Branch { tip, order } => {
                    if cached.as_ref().is_some_and(|known| known.tip != tip) {
                        cached = None;
                    }
                    let branches = cached.get_or_insert_with(|| {
                        let side = (*step != 0.0).then_some(*step);
                        let (values, gradients) = self.tips[tip as usize].branch(x, side);
                        let (ramp, ramp_gradient) = ramp(f.ramp, &n, &dn);
                        Branches {
                            tip,
                            values,
                            gradients,
                            ramp,
                            ramp_gradient,
                        }
                    });
                    let l = order as usize;
                    let (rho, h) = (branches.ramp, branches.values[l] - f.shift);
                    *value = ni * h * rho;
                    for a in 0..3 {
                        let slope = branches.gradients[l][a] * rho + h * branches.ramp_gradient[a];
                        gradient[a] = dni[a] * h * rho + ni * slope;
                    }
                }
            }
        }
    }

    /// Displacement [m] and its gradient ∂u_a/∂x_b at ξ (position x) in a region, from all unknowns (function-major).
    pub fn field(
        &mut self,
        xi: &Point,
        x: &Point,
        region: Region,
        u: &[f64],
    ) -> (Point, [Point; 3]) {
        self.evaluate(xi, x, region);
        let dim = self.map.kind.dim();
        let (mut v, mut h) = ([0.0; 3], [[0.0; 3]; 3]);
        for ((&f, value), g) in self.numbers.iter().zip(&self.values).zip(&self.gradients) {
            for a in 0..dim {
                let amount = u[f as usize * dim + a];
                v[a] += value * amount;
                for b in 0..dim {
                    h[a][b] += amount * g[b];
                }
            }
        }
        (v, h)
    }

    /// Jump u₁ − u₂ between two regions at ξ (position x), from all unknowns [m].
    pub fn jump(&mut self, xi: &Point, x: &Point, regions: [Region; 2], u: &[f64]) -> Point {
        let [one, two] = regions.map(|region| self.field(xi, x, region, u).0);
        sub(&one, &two)
    }
}

/// Branch functions of one tip and their ramp at one point.
struct Branches {
    tip: u32,
    values: [f64; 4],
    gradients: [Point; 4],
    ramp: f64,
    ramp_gradient: Point,
}

/// ρ = Σ N_i over the nodes of a mask, and its gradient; exactly 1 over all of them.
fn ramp(mask: u8, n: &[f64], dn: &[Point]) -> (f64, Point) {
    let inside = |i: usize| mask & (1 << i) != 0;
    if (0..n.len()).all(inside) {
        return (1.0, [0.0; 3]);
    }
    let nodes = (0..n.len()).filter(|&i| inside(i));
    nodes.fold((0.0, [0.0; 3]), |(rho, slope), i| {
        (rho + n[i], [0, 1, 2].map(|a| slope[a] + dn[i][a]))
    })
}
