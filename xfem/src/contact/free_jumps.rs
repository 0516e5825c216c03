//! Where on a crack the displacement jumps and is free to do so: what a multiplier can act on.

use std::collections::BTreeSet;

use crate::enrichment::basis::FunctionKind;
use crate::enrichment::facets::{Corner, CrackFacets, Facet};
use crate::stiffness::cell_matrix::CellIntegrator;

use super::pairs::{AT_TIP, vertex_weights};

/// A facet smaller than this, in units of its cell's size to the power of its dimension, has no multiplier of its own.
const SLIVER: f64 = 1e-10;

/// What the displacement does at a crossed mesh edge or node.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Ends of the edge, where they carry a free jump; both ends equal at a node, the second then `None`.
    pub ends: [Option<u32>; 2],
    /// Fraction w of the edge between its first end and the crack.
    pub fraction: f64,
}

/// The facets of a crack, and the nodes whose displacement jumps across it and is free to do so.
pub struct FreeJumps<'a> {
    /// Facets.
    pub facets: CrackFacets,
    integrator: &'a CellIntegrator<'a>,
    index: usize,
    nodes: BTreeSet<u32>,
    sizes: Vec<f64>,
}

impl<'a> FreeJumps<'a> {
    /// Of the `index`-th crack; `held` tells the prescribed unknowns.
    pub fn new(
        integrator: &'a CellIntegrator<'a>,
        index: usize,
        held: impl Fn(usize) -> bool,
    ) -> Self {
        let (mesh, enrichment) = (integrator.mesh, integrator.enrichment);
        let jumps = |kind: FunctionKind| match kind {
            FunctionKind::Heaviside { crack } => crack as usize == index,
            FunctionKind::Branch { tip, order: 0 } => enrichment.tips[tip as usize].crack == index,
            _ => false,
        };
        let dim = mesh.dim();
        let free = |f: usize| (0..dim).all(|a| !held(f * dim + a));
        let functions = enrichment.functions.iter().enumerate();
        FreeJumps {
            facets: CrackFacets::new(mesh, index, &integrator.cracks[index], enrichment),
            integrator,
            index,
            nodes: functions
                .filter(|(f, function)| jumps(function.kind) && free(*f))
                .map(|(_, function)| function.node)
                .collect(),
            sizes: mesh.node_sizes(),
        }
    }

    /// What happens at every corner; `None` where no multiplier can live: inside cells, at tips, where all is held.
    pub fn crossings(&self) -> Vec<Option<Crossing>> {
        let tips = &self.integrator.enrichment.tips;
        let phi = &self.integrator.cracks[self.index].phi;
        let crossing = |corner: &Corner| {
            let [i, j] = corner.nodes?;
            let size = self.sizes[i as usize].min(self.sizes[j as usize]);
            let mut distances = tips.iter().map(|tip| tip.distance(&corner.x));
            if distances.any(|distance| distance <= AT_TIP * size) {
                return None;
            }
            let free = |node: u32| self.nodes.contains(&node).then_some(node);
            let ends = [free(i), if i == j { None } else { free(j) }];
            let [fi, fj] = [i, j].map(|node| phi[node as usize].abs());
            ends.iter().any(Option::is_some).then_some(Crossing {
                ends,
                fraction: if i == j { 0.0 } else { fi / (fi + fj) },
            })
        };
        self.facets.corners.iter().map(crossing).collect()
    }

    /// Whether a facet can carry a constant multiplier: a free jump, and an area worth an equation.
    pub fn carries(&self, facet: &Facet) -> bool {
        let mesh = self.integrator.mesh;
        let nodes = mesh.cell(facet.cell);
        let area: f64 = vertex_weights(&self.facets.polygon(facet)).iter().sum();
        let sizes = nodes.iter().map(|&n| self.sizes[n as usize]);
        let size = sizes.fold(f64::INFINITY, f64::min);
        area > SLIVER * size.powi(mesh.dim() as i32 - 1)
            && nodes.iter().any(|n| self.nodes.contains(n))
    }
}
