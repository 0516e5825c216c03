//! Which nodes carry which enriched functions, and which functions live in each cell.

pub mod basis;
pub mod cell_facets;
pub mod facets;
pub mod pieces;

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::crack::{Crack, Parent, Tip};
use crate::cut::is_split;
use crate::cut::partition::{Part, Partition, PartitionError};
use crate::cut::placement::{Along, along, fronts, undisturbed};
use crate::enrichment::basis::{CellFunction, FunctionKind, Region};
use crate::geometry::Point;
use crate::geometry::clip::Side;
use crate::geometry::tip_frame::TipFrame;
use crate::mesh::Mesh;

/// A scalar function of the whole body: a node and a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Function {
    /// Node number.
    pub node: u32,
    /// Kind.
    pub kind: FunctionKind,
}

/// What is wrong with a crack in a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EnrichmentError {
    /// The crack cuts no cell.
    #[error("crack {} lies wholly outside the mesh", crack + 1)]
    Outside {
        /// Crack number, from 0.
        crack: usize,
    },
    /// Both tips in one cell, or in neighbours that share all contact: no contact point is left.
    #[error("crack {} is too short for this mesh: no cell edge between its tips can carry contact", crack + 1)]
    TooShort {
        /// Crack number, from 0.
        crack: usize,
    },
    /// A crack ends in a cell that another one cuts.
    #[error("crack {} ends in a cell that crack {} cuts, near {at:?}: let it end on that crack, or farther away", ending + 1, other + 1)]
    Crowded {
        /// The crack with the tip, from 0.
        ending: usize,
        /// The other crack, from 0.
        other: usize,
        /// Centre of the cell [m].
        at: Point,
    },
    /// A cell cannot be divided.
    #[error("crack {}: {reason}, near {at:?}", crack + 1)]
    Partition {
        /// Crack number, from 0.
        crack: usize,
        /// What is wrong.
        reason: PartitionError,
        /// Centre of the cell [m].
        at: Point,
    },
    /// The crack runs along cell facets in one part and through cells in another.
    #[error("crack {} runs partly along cell edges and partly through cells, near {at:?}", crack + 1)]
    Mixed {
        /// Crack number, from 0.
        crack: usize,
        /// Centre of a cell it cuts [m].
        at: Point,
    },
    /// A crack on cell edges ends inside the body with branch functions asked for.
    #[error("crack {} runs along cell edges and ends inside the body: branch functions need a tip inside a cell", crack + 1)]
    ConformingTip {
        /// Crack number, from 0.
        crack: usize,
    },
}

/// All functions of the body and of every cell.
#[derive(Debug, Clone)]
pub struct Enrichment {
    /// Functions, the standard ones first in node order, then the enriched ones by node and kind.
    pub functions: Vec<Function>,
    /// Shift of every function: H(x_j) or g_l(x_k); 0 for standard ones.
    pub shifts: Vec<f64>,
    /// Tips and fronts inside the body that carry branch functions.
    pub tips: Vec<TipFrame>,
    /// Cells with a tip in their closure or a front inside: (cell, tip number), sorted.
    pub tip_cells: Vec<(usize, usize)>,
    /// Nodes of the ramp of every tip's branch functions; empty: they have none.
    cores: Vec<BTreeSet<u32>>,
    /// Divided cells.
    partitions: BTreeMap<usize, Partition>,
    cell_ptr: Vec<usize>,
    cell_functions: Vec<u32>,
    /// Starts of the step constants of every cell: region by region, function by function.
    step_ptr: Vec<usize>,
    steps: Vec<f64>,
    node_ptr: Vec<usize>,
    /// Nodes with φ = 0 for some crack.
    on_crack: Vec<bool>,
    standard: usize,
}

impl Enrichment {
    /// Enriches the nodes around the given cracks; none of them may run along cell facets.
    pub fn new(mesh: &Mesh, cracks: &[Crack]) -> Result<Self, EnrichmentError> {
        let mut inside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut enriched: BTreeSet<Function> = BTreeSet::new();
        let mut tips = Vec::new();
        let mut cores = Vec::new();
        let mut tip_cells = Vec::new();
        for (index, crack) in cracks.iter().enumerate() {
            let mut through = BTreeSet::new();
            let mut ending = Vec::new();
            for cell in 0..mesh.cell_count() {
                match along(mesh, crack, cell) {
                    Along::Through => {
                        through.insert(cell);
                        inside.entry(cell).or_default().push(index);
                    }
                    Along::Ends => ending.push(cell),
                    Along::Away => {}
                }
            }
            let other_arm = cracks
                .iter()
                .enumerate()
                .any(|(i, c)| i != index && c.number == crack.number);
            if through.is_empty() && ending.is_empty() && !other_arm {
                return Err(EnrichmentError::Outside {
                    crack: crack.number,
                });
            }
            // Nodes where the jump must close (no tip functions) or is left to the branch functions.
            let mut closing: BTreeSet<u32> = BTreeSet::new();
            for (frame, mut cells) in fronts(mesh, index, crack) {
                if frame.shape_is_ellipse() {
                    cells.clone_from(&ending);
                }
                if crack.tip == Tip::None {
                    let beyond = cells.iter().filter(|c| !through.contains(c));
                    closing.extend(beyond.flat_map(|&c| mesh.cell(c)));
                    continue;
                }
                let tip = tips.len();
                let branch = |node: u32| {
                    (0..4).map(move |order| Function {
                        node,
                        kind: FunctionKind::Branch {
                            tip: tip as u32,
                            order,
                        },
                    })
                };
                // Nodes of the ramp; empty: no ramp.
                let mut core: BTreeSet<u32> = BTreeSet::new();
                if matches!(crack.tip, Tip::Radius(_)) {
                    core.extend(cells.iter().flat_map(|&c| mesh.cell(c)));
                }
                for &cell in &cells {
                    if is_split(mesh.kind, &crack.cell_phi(mesh, cell)) {
                        let list = inside.entry(cell).or_default();
                        if !list.contains(&index) {
                            list.push(index);
                        }
                    }
                    tip_cells.push((cell, tip));
                    closing.extend(mesh.cell(cell));
                    enriched.extend(mesh.cell(cell).iter().flat_map(|&n| branch(n)));
                }
                if let Tip::Radius(radius) = crack.tip {
                    let reach = radius.min(undisturbed(crack, &frame));
                    let near = |&n: &usize| frame.distance(&mesh.nodes[n]) <= reach;
                    core.extend((0..mesh.nodes.len()).filter(near).map(|n| n as u32));
                    // The nodes of the tip's cells have no Heaviside function: their cells need ρ = 1, which no kink may hinder.
                    let at_tip: BTreeSet<u32> =
                        cells.iter().flat_map(|&c| mesh.cell(c)).copied().collect();
                    let ring: BTreeSet<u32> = (0..mesh.cell_count())
                        .map(|cell| mesh.cell(cell))
                        .filter(|nodes| nodes.iter().any(|n| at_tip.contains(n)))
                        .flatten()
                        .copied()
                        .collect();
                    let room = undisturbed(crack, &frame);
                    let ramped = ring
                        .iter()
                        .all(|&n| frame.distance(&mesh.nodes[n as usize]) <= room);
                    if ramped {
                        core.extend(ring);
                    }
                    enriched.extend(core.iter().flat_map(|&n| branch(n)));
                    if ramped {
                        for nodes in (0..mesh.cell_count()).map(|cell| mesh.cell(cell)) {
                            if nodes.iter().any(|n| core.contains(n)) {
                                enriched.extend(nodes.iter().flat_map(|&n| branch(n)));
                            }
                        }
                    } else {
                        core.clear();
                    }
                }
                cores.push(core);
                tips.push(frame);
            }
            for &cell in &through {
                for &node in mesh.cell(cell) {
                    if !closing.contains(&node) {
                        let kind = FunctionKind::Heaviside {
                            crack: index as u32,
                        };
                        enriched.insert(Function { node, kind });
                    }
                }
            }
        }
        tip_cells.sort_unstable();
        for &(cell, tip) in &tip_cells {
            let own = tips[tip].crack;
            let others = inside.get(&cell).into_iter().flatten();
            if let Some(&other) = others.into_iter().find(|&&c| c != own) {
                return Err(EnrichmentError::Crowded {
                    ending: cracks[own].number,
                    other: cracks[other].number,
                    at: mesh.centre(cell),
                });
            }
        }
        let mut partitions = BTreeMap::new();
        for (cell, list) in inside {
            let partition = Partition::new(mesh, cell, cracks, &list).map_err(|reason| {
                let crack = list.last().map_or(0, |&c| cracks[c].number);
                EnrichmentError::Partition {
                    crack,
                    reason,
                    at: mesh.centre(cell),
                }
            })?;
            partitions.insert(cell, partition);
        }
        let standard = mesh.nodes.len();
        let functions: Vec<Function> = (0..standard as u32)
            .map(|node| Function {
                node,
                kind: FunctionKind::Standard,
            })
            .chain(enriched)
            .collect();
        let shifts = functions
            .iter()
            .map(|f| match f.kind {
                FunctionKind::Standard => 0.0,
                FunctionKind::Heaviside { crack } => node_step(cracks, crack as usize, f.node),
                FunctionKind::Branch { tip, order } => {
                    let frame: &TipFrame = &tips[tip as usize];
                    let side = cracks[frame.crack].side_of(f.node as usize);
                    frame.branch(&mesh.nodes[f.node as usize], Some(side)).0[order as usize]
                }
            })
            .collect();
        let mut enrichment = Enrichment {
            functions,
            shifts,
            tips,
            tip_cells,
            cores,
            partitions,
            cell_ptr: vec![0],
            cell_functions: Vec::new(),
            step_ptr: vec![0],
            steps: Vec::new(),
            node_ptr: Vec::new(),
            on_crack: (0..standard)
                .map(|node| cracks.iter().any(|crack| crack.phi[node] == 0.0))
                .collect(),
            standard,
        };
        enrichment.index_nodes();
        enrichment.index_cells(mesh, cracks);
        Ok(enrichment)
    }

    /// Starts of the enriched functions of every node.
    fn index_nodes(&mut self) {
        let mut ptr = vec![self.standard; self.standard + 1];
        let mut position = self.standard;
        for node in 0..self.standard {
            ptr[node] = position;
            while position < self.functions.len() && self.functions[position].node as usize == node
            {
                position += 1;
            }
        }
        ptr[self.standard] = position;
        self.node_ptr = ptr;
    }

    /// Function lists of the cells: standard ones, then the enriched ones that do not vanish in the cell.
    ///
    /// A node on the crack counts to side 1, so its Heaviside function reaches into the whole cells of side 2.
    fn index_cells(&mut self, mesh: &Mesh, cracks: &[Crack]) {
        for cell in 0..mesh.cell_count() {
            let nodes = mesh.cell(cell);
            let parts: Vec<Option<&Part>> = match self.partitions.get(&cell) {
                Some(partition) => partition.parts.iter().map(Some).collect(),
                None => vec![None],
            };
            let mut lists: Vec<Vec<f64>> = vec![vec![1.0; nodes.len()]; parts.len()];
            self.cell_functions.extend_from_slice(nodes);
            for &node in nodes {
                for f in self.enriched_of(node as usize) {
                    let steps: Vec<f64> = match self.functions[f].kind {
                        FunctionKind::Heaviside { crack } => {
                            let step = |part: &Option<&Part>| {
                                cell_step(cracks, crack as usize, nodes, *part)
                            };
                            let steps: Vec<f64> =
                                parts.iter().map(|p| step(p) - self.shifts[f]).collect();
                            if steps.iter().all(|&s| s == 0.0) {
                                continue;
                            }
                            steps
                        }
                        // On the crack itself a branch function takes the value of the region's side.
                        FunctionKind::Branch { tip, .. } => {
                            let crack = &cracks[self.tips[tip as usize].crack];
                            let cut = is_split(mesh.kind, &crack.cell_phi(mesh, cell));
                            let side = |part: &Option<&Part>| match part
                                .and_then(|p| p.side(self.tips[tip as usize].crack))
                            {
                                Some(side) => side,
                                None if cut => 0.0,
                                None => whole_side(crack, nodes),
                            };
                            parts.iter().map(side).collect()
                        }
                        FunctionKind::Standard => continue,
                    };
                    self.cell_functions.push(f as u32);
                    for (list, step) in lists.iter_mut().zip(steps) {
                        list.push(step);
                    }
                }
            }
            self.cell_ptr.push(self.cell_functions.len());
            // Cells with standard functions only share the ones in front.
            if lists[0].len() > nodes.len() || lists.len() > 1 {
                self.steps.extend(lists.concat());
            }
            self.step_ptr.push(self.steps.len());
        }
    }

    /// Division of a cell; `None` if no crack cuts it.
    pub fn partition(&self, cell: usize) -> Option<&Partition> {
        self.partitions.get(&cell)
    }

    /// Divided cells in order.
    pub fn cut_cells(&self) -> impl Iterator<Item = (usize, &Partition)> {
        self.partitions
            .iter()
            .map(|(&cell, partition)| (cell, partition))
    }

    /// Number of regions of a cell.
    pub fn regions(&self, cell: usize) -> usize {
        self.partition(cell).map_or(1, |p| p.parts.len())
    }

    /// Side of a crack on which a region lies, if the crack cuts the cell there.
    pub fn side(&self, cell: usize, region: Region, crack: usize) -> Option<Side> {
        self.partition(cell)?.parts[region].side(crack)
    }

    /// Step constants of a cell, see [`super::basis::CellBasis::steps`].
    pub fn steps(&self, cell: usize) -> &[f64] {
        const STANDARD: [f64; 8] = [1.0; 8];
        let own = &self.steps[self.step_ptr[cell]..self.step_ptr[cell + 1]];
        if own.is_empty() { &STANDARD } else { own }
    }

    /// Enriched functions of a node.
    pub fn enriched_of(&self, node: usize) -> std::ops::Range<usize> {
        self.node_ptr[node]..self.node_ptr[node + 1]
    }

    /// True if a node lies on a crack between its ends, so that the displacement jumps there.
    pub fn jumps_at(&self, node: usize) -> bool {
        !self.enriched_of(node).is_empty() && self.on_crack[node]
    }

    /// Functions of a cell, the standard ones first.
    pub fn cell(&self, cell: usize) -> &[u32] {
        &self.cell_functions[self.cell_ptr[cell]..self.cell_ptr[cell + 1]]
    }

    /// Functions of a cell with their local nodes and shifts.
    pub fn cell_basis(&self, mesh: &Mesh, cell: usize) -> Vec<CellFunction> {
        let nodes = mesh.cell(cell);
        let of = |&f: &u32| {
            let function = self.functions[f as usize];
            CellFunction {
                // Every function of the cell belongs to one of its nodes.
                local: nodes
                    .iter()
                    .position(|&n| n == function.node)
                    .unwrap_or_default(),
                kind: function.kind,
                shift: self.shifts[f as usize],
                ramp: match function.kind {
                    FunctionKind::Branch { tip, .. } => self.ramp(tip as usize, nodes),
                    _ => u8::MAX,
                },
            }
        };
        self.cell(cell).iter().map(of).collect()
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.standard
    }

    /// True if the branch functions of a tip reach beyond its cells, with a ramp.
    pub fn is_ramped(&self, tip: usize) -> bool {
        !self.cores[tip].is_empty()
    }

    /// True for a node of the ramp of a tip.
    pub fn in_core(&self, tip: usize, node: u32) -> bool {
        self.cores[tip].contains(&node)
    }

    /// Local nodes of a cell in the ramp of a tip, one bit each.
    pub fn ramp(&self, tip: usize, nodes: &[u32]) -> u8 {
        let core = &self.cores[tip];
        if core.is_empty() {
            return u8::MAX;
        }
        let inside = nodes.iter().enumerate().filter(|(_, n)| core.contains(n));
        inside.fold(0, |mask, (i, _)| mask | 1 << i)
    }

    /// True if the cell carries standard functions only.
    pub fn is_plain(&self, mesh: &Mesh, cell: usize) -> bool {
        self.cell(cell).len() == mesh.kind.nodes()
    }

    /// True if a function of the cell is a branch function.
    pub fn has_branch(&self, cell: usize) -> bool {
        self.cell(cell)
            .iter()
            .any(|&f| matches!(self.functions[f as usize].kind, FunctionKind::Branch { .. }))
    }

    /// Cells that carry each function.
    pub fn users(&self) -> Vec<Vec<u32>> {
        let mut users = vec![Vec::new(); self.functions.len()];
        for cell in 0..self.cell_ptr.len() - 1 {
            for &f in self.cell(cell) {
                users[f as usize].push(cell as u32);
            }
        }
        users
    }
}

/// Step of a crack at a node: its side, 0 beyond a crack it ends on.
fn node_step(cracks: &[Crack], index: usize, node: u32) -> f64 {
    let crack = &cracks[index];
    let beyond = |p: &Parent| cracks[p.crack].side_of(node as usize) != p.side;
    if crack.parents.iter().any(beyond) {
        0.0
    } else {
        crack.side_of(node as usize)
    }
}

/// Step of a crack in a part of a cell, or in a whole one.
fn cell_step(cracks: &[Crack], index: usize, nodes: &[u32], part: Option<&Part>) -> f64 {
    let side = |crack: usize| match part {
        None => whole_side(&cracks[crack], nodes),
        Some(part) => part
            .side(crack)
            .unwrap_or_else(|| 1.0f64.copysign(cracks[crack].distance(&part.middle()))),
    };
    let beyond = |p: &Parent| side(p.crack) != p.side;
    if cracks[index].parents.iter().any(beyond) {
        0.0
    } else {
        side(index)
    }
}

/// Side of a crack that a cell it does not split lies on.
fn whole_side(crack: &Crack, nodes: &[u32]) -> Side {
    if nodes.iter().any(|&n| crack.phi[n as usize] < 0.0) {
        -1.0
    } else {
        1.0
    }
}
