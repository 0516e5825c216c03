//! Which nodes carry which enriched functions, and which cells the cracks divide.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::crack::{Crack, Tip};
use crate::cut::is_split;
use crate::cut::placement::{Along, along, fronts, undisturbed};
use crate::geometry::tip_frame::TipFrame;
use crate::mesh::Mesh;

use super::basis::{Function, FunctionKind};
use super::error::EnrichmentError;

/// The nodes and cells around the cracks of a body.
#[derive(Debug, Default)]
pub struct Carriers {
    /// Enriched functions with their nodes.
    pub enriched: BTreeSet<Function>,
    /// Cracks that divide a cell.
    pub inside: BTreeMap<usize, Vec<usize>>,
    /// Tips and fronts inside the body that carry branch functions.
    pub tips: Vec<TipFrame>,
    /// Cells with a tip in their closure or a front inside: (cell, tip number), sorted.
    pub tip_cells: Vec<(usize, usize)>,
    /// Nodes of the ramp of every tip's branch functions; empty: they have none.
    pub cores: Vec<BTreeSet<u32>>,
}

impl Carriers {
    /// Nodes and cells around the given cracks; none of them may run along cell facets.
    ///
    /// # Errors
    /// A crack wholly outside, or one that ends where another one cuts the cell.
    pub fn new(mesh: &Mesh, cracks: &[Crack]) -> Result<Self, EnrichmentError> {
        let mut carriers = Carriers::default();
        for index in 0..cracks.len() {
            carriers.add_crack(mesh, cracks, index)?;
        }
        carriers.tip_cells.sort_unstable();
        for &(cell, tip) in &carriers.tip_cells {
            let own = carriers.tips[tip].crack;
            let mut others = carriers.inside.get(&cell).into_iter().flatten();
            if let Some(&other) = others.find(|&&c| c != own) {
                return Err(EnrichmentError::Crowded {
                    ending: cracks[own].number,
                    other: cracks[other].number,
                    at: mesh.centre(cell),
                });
            }
        }
        Ok(carriers)
    }

    fn add_crack(
        &mut self,
        mesh: &Mesh,
        cracks: &[Crack],
        index: usize,
    ) -> Result<(), EnrichmentError> {
        let crack = &cracks[index];
        let (mut through, mut ending) = (Vec::new(), Vec::new());
        for cell in 0..mesh.cell_count() {
            match along(mesh, crack, cell) {
                Along::Through => through.push(cell),
                Along::Ends => ending.push(cell),
                Along::Away => {}
            }
        }
        let arms = cracks.iter().filter(|c| c.number == crack.number).count();
        if through.is_empty() && ending.is_empty() && arms == 1 {
            return Err(EnrichmentError::Outside {
                crack: crack.number,
            });
        }
        for &cell in &through {
            self.inside.entry(cell).or_default().push(index);
        }
        // Nodes where the jump must close (no tip functions) or is left to the branch functions.
        let mut closing: BTreeSet<u32> = BTreeSet::new();
        for (frame, mut cells) in fronts(mesh, index, crack) {
            if frame.shape_is_ellipse() {
                cells.clone_from(&ending);
            }
            if crack.tip == Tip::None {
                cells.retain(|cell| through.binary_search(cell).is_err());
            } else {
                self.add_tip(mesh, crack, frame, &cells);
            }
            closing.extend(nodes_of(mesh, cells));
        }
        let kind = FunctionKind::Heaviside {
            crack: index as u32,
        };
        let jumping = nodes_of(mesh, through).filter(|node| !closing.contains(node));
        self.enriched
            .extend(jumping.map(|node| Function { node, kind }));
        Ok(())
    }

    /// Adds the branch functions of a tip or front with the given cells around it.
    fn add_tip(&mut self, mesh: &Mesh, crack: &Crack, frame: TipFrame, cells: &[usize]) {
        let tip = self.tips.len();
        for &cell in cells {
            self.tip_cells.push((cell, tip));
            if is_split(&crack.cell_phi(mesh, cell)) {
                let list = self.inside.entry(cell).or_default();
                if !list.contains(&frame.crack) {
                    list.push(frame.crack);
                }
            }
        }
        let at_tip: BTreeSet<u32> = nodes_of(mesh, cells.iter().copied()).collect();
        let mut nodes = at_tip.clone();
        // Nodes of the ramp; empty: no ramp.
        let mut core = BTreeSet::new();
        if let Tip::Radius(radius) = crack.tip {
            let room = undisturbed(crack, &frame);
            let within =
                |node: u32, reach: f64| frame.distance(&mesh.nodes[node as usize]) <= reach;
            let reach = radius.min(room);
            nodes.extend((0..mesh.nodes.len() as u32).filter(|&n| within(n, reach)));
            // The nodes of the tip's cells have no Heaviside function: their cells need ρ = 1, which no kink may hinder.
            let ring = nodes_around(mesh, &at_tip);
            if ring.iter().all(|&n| within(n, room)) {
                core = &nodes | &ring;
                nodes = nodes_around(mesh, &core);
            }
        }
        let branch = |node: u32| {
            (0..4).map(move |order| {
                let tip = tip as u32;
                let kind = FunctionKind::Branch { tip, order };
                Function { node, kind }
            })
        };
        self.enriched.extend(nodes.into_iter().flat_map(branch));
        self.cores.push(core);
        self.tips.push(frame);
    }
}

/// Nodes of some cells.
fn nodes_of(mesh: &Mesh, cells: impl IntoIterator<Item = usize>) -> impl Iterator<Item = u32> {
    cells.into_iter().flat_map(|cell| mesh.cell(cell)).copied()
}

/// Nodes of all cells with one of some nodes.
fn nodes_around(mesh: &Mesh, nodes: &BTreeSet<u32>) -> BTreeSet<u32> {
    let touching = |&cell: &usize| mesh.cell(cell).iter().any(|n| nodes.contains(n));
    nodes_of(mesh, (0..mesh.cell_count()).filter(touching)).collect()
}
