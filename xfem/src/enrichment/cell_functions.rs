//! The functions of one cell, evaluated point by point.

use std::array::from_fn;
use std::mem::take;

use crate::cut::part::Region;
use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, Points};
use crate::mesh::Mesh;
use crate::mesh::cell::CellMap;

use super::Enrichment;
use super::basis::{ABSENT, FunctionKind};

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
        // Of one tip after the other.
        let mut known: Option<(u32, u8)> = None;
        let mut ramp = |tip: u32| match known {
            Some((of, mask)) if of == tip => mask,
            _ => {
                let mask = enrichment.ramp(tip as usize, nodes);
                known = Some((tip, mask));
                mask
            }
        };
        let of = |&f: &u32| {
            let function = enrichment.functions[f as usize];
            let local = nodes.iter().position(|&n| n == function.node);
            CellFunction {
                // Every function of the cell belongs to one of its nodes.
                local: local.unwrap_or_default(),
                kind: function.kind,
                shift: enrichment.shifts[f as usize],
                ramp: match function.kind {
                    FunctionKind::Branch { tip, .. } => ramp(tip),
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

    /// Evaluates all functions at ξ (position x) in a region of the cell.
    pub fn evaluate(&mut self, xi: &Point, x: &Point, region: Region) {
        let (mut values, mut gradients) = (take(&mut self.values), take(&mut self.gradients));
        let [xi, x] = [xi, x].map(|at| at.map(|v| [v]));
        self.visit(&xi, &x, region, |f, [value], gradient| {
            (values[f], gradients[f]) = (*value, gradient.map(|[g]| g));
        });
        (self.values, self.gradients) = (values, gradients);
    }

    /// Visits all functions with their values and gradients at L points ξ (positions x) in a region of the cell.
    #[inline(always)]
    pub fn visit<const L: usize>(
        &self,
        xi: &Points<L>,
        x: &Points<L>,
        region: Region,
        mut put: impl FnMut(usize, &[f64; L], &Points<L>),
    ) {
        let n = self.map.kind.shapes(xi);
        let dn = self.map.slopes(xi, self.inverse.as_ref());
        // Tip, branch functions with gradients, ramp with gradient.
        let mut cached: Option<(u32, _, _)> = None;
        let count = self.functions.len();
        let steps = &self.steps[region * count..(region + 1) * count];
        for (place, (f, step)) in self.functions.iter().zip(steps).enumerate() {
            let (ni, dni) = (&n[f.local], &dn[f.local]);
            match f.kind {
                FunctionKind::Standard => put(place, ni, dni),
                FunctionKind::Piece { .. } => {
                    let times = |v: [f64; L]| v.map(|v| v * step);
                    put(place, &times(*ni), &dni.map(times));
                }
                FunctionKind::Branch { .. } if *step == ABSENT => {
                    put(place, &[0.0; L], &[[0.0; L]; 3])
                }
                FunctionKind::Branch { tip, order } => {
                    let (_, (g, dg), (rho, drho)) = match &mut cached {
                        Some(known) if known.0 == tip => &*known,
                        other => {
                            let side = (*step != 0.0).then_some(*step);
                            let branches = self.tips[tip as usize].branches(x, side);
                            let nodes = self.map.len();
                            let ramp = ramp(f.ramp, &n[..nodes], &dn[..nodes]);
                            other.insert((tip, branches, ramp))
                        }
                    };
                    // As values: what is behind references the compiler takes one by one.
                    let (g, dg) = (g[order as usize], dg[order as usize]);
                    let (rho, drho, ni, dni) = (*rho, *drho, *ni, *dni);
                    let h: [f64; L] = from_fn(|q| g[q] - f.shift);
                    let value = from_fn(|q| ni[q] * h[q] * rho[q]);
                    let slope = |a: usize| -> [f64; L] {
                        from_fn(|q| {
                            let slope = dg[a][q] * rho[q] + h[q] * drho[a][q];
                            dni[a][q] * h[q] * rho[q] + ni[q] * slope
                        })
                    };
                    let gradient = [slope(0), slope(1), slope(2)];
                    put(place, &value, &gradient);
                }
            }
        }
    }

    /// Visits the branch functions of a tip, or of all tips, at the nodes of a mask with their values at L points ξ (positions x)
    /// in a region of the cell: on a face the others vanish.
    #[inline(always)]
    pub fn visit_branches<const L: usize>(
        &self,
        (xi, x): (&Points<L>, &Points<L>),
        region: Region,
        (only, nodes): (Option<u32>, u8),
        mut put: impl FnMut(usize, &[f64; L]),
    ) {
        let n = self.map.kind.shapes(xi);
        let mut cached: Option<(u32, [[f64; L]; 4], [f64; L])> = None;
        let count = self.functions.len();
        let steps = &self.steps[region * count..(region + 1) * count];
        for (place, (f, step)) in self.functions.iter().zip(steps).enumerate() {
            let FunctionKind::Branch { tip, order } = f.kind else {
                continue;
            };
            let elsewhere = only.is_some_and(|only| only != tip) || nodes & (1 << f.local) == 0;
            if elsewhere || *step == ABSENT {
                continue;
            }
            let (_, g, rho) = match &mut cached {
                Some(known) if known.0 == tip => known,
                other => {
                    let side = (*step != 0.0).then_some(*step);
                    let g = self.tips[tip as usize].branch_values(x, side);
                    other.insert((tip, g, ramp_value(f.ramp, &n[..self.map.len()])))
                }
            };
            let (g, ni, rho) = (g[order as usize], n[f.local], *rho);
            put(place, &from_fn(|q| ni[q] * (g[q] - f.shift) * rho[q]));
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
}

/// ρ = Σ N_i over the nodes of a mask; exactly 1 over all of them.
#[inline(always)]
fn ramp_value<const L: usize>(mask: u8, n: &[[f64; L]]) -> [f64; L] {
    let inside = |i: usize| mask & (1 << i) != 0;
    if (0..n.len()).all(inside) {
        return [1.0; L];
    }
    let mut rho = [0.0; L];
    for n in (0..n.len()).filter(|&i| inside(i)).map(|i| &n[i]) {
        (0..L).for_each(|q| rho[q] += n[q]);
    }
    rho
}

/// ρ and its gradient.
#[inline(always)]
fn ramp<const L: usize>(mask: u8, n: &[[f64; L]], dn: &[Points<L>]) -> ([f64; L], Points<L>) {
    let inside = |i: usize| mask & (1 << i) != 0;
    let mut slope = [[0.0; L]; 3];
    if !(0..n.len()).all(inside) {
        for dn in (0..n.len()).filter(|&i| inside(i)).map(|i| &dn[i]) {
            for a in 0..3 {
                (0..L).for_each(|q| slope[a][q] += dn[a][q]);
            }
        }
    }
    (ramp_value(mask, n), slope)
}
