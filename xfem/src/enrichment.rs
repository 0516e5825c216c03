//! The functions of a body with cracks: which there are, and which live in each cell.

pub mod basis;
pub mod cell_facets;
pub mod cell_functions;
pub mod error;
pub mod facet_rule;
pub mod facets;
pub mod pieces;
pub mod supports;
pub mod tips;
mod zone;

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::arrangement::Arrangement;
use crate::cut::crack::{Crack, Geometry, on_crack};
use crate::cut::is_split;
use crate::cut::part::{Part, Place, Region};
use crate::cut::partition::Partition;
use crate::cut::placement::cells_at;
use crate::geometry::boxes::{Boxes, around};
use crate::geometry::clip::{Side, snapped};
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, mean};
use crate::mesh::cell::MOST_NODES;
use crate::mesh::{Lengths, Mesh};

use self::basis::{ABSENT, Function, FunctionKind, STEP};
pub use self::error::EnrichmentError;
use self::supports::{Pieces, support_pieces};
use self::tips::corners::Corner;
use self::tips::{Narrow, Tips};
pub use self::zone::Zone;

/// A point closer to a tip than this, in units of the shortest edge at its nodes, is at the tip: the branch function jumps
/// by 2 √r there, and a force that has to act through a jump this small grows like r^−½ without meaning anything.
pub const AT_TIP: f64 = 1e-3;

/// All functions of the body and of every cell.
#[derive(Debug, Clone)]
pub struct Enrichment {
    /// Functions, the standard ones first in node order, then the enriched ones by node and kind.
    pub functions: Vec<Function>,
    /// Shift of every function: g_l(x_k) of branch functions, on their crack the mean of both sides; 0 of others.
    pub shifts: Vec<f64>,
    /// Tips and fronts inside the body that carry branch functions.
    pub tips: Vec<TipFrame>,
    /// Nodes around each of them.
    pub zones: Vec<Zone>,
    /// 2D: tips that go without the ramp they ask for.
    pub narrow: Vec<Narrow>,
    /// Arms of short cracks.
    short: BTreeSet<usize>,
    /// Cells with a tip in their closure or a front inside: (cell, tip number), sorted.
    pub tip_cells: Vec<(usize, usize)>,
    /// Boxes around all that may be at a tip or front other than a corner, with room for rounding, and its number.
    at_tips: (Boxes, Vec<usize>),
    /// 2D: where arms with branch functions bend or meet.
    pub corners: Vec<Corner>,
    /// By arm: those where it is long enough for multipliers of its own.
    corners_of: BTreeMap<usize, Vec<usize>>,
    /// Where branch functions are singular in 2D, and the same by place.
    singular: (Vec<Point>, Boxes),
    /// Divided cells.
    partitions: BTreeMap<usize, Partition>,
    /// 2D: where the cracks lie.
    arrangement: Arrangement,
    /// Cells with the end of a crack that are left whole, divided up to it.
    endings: BTreeMap<usize, Partition>,
    cell_ptr: Vec<usize>,
    cell_functions: Vec<u32>,
    /// Starts of the step constants of every cell: region by region, function by function.
    step_ptr: Vec<usize>,
    steps: Vec<f64>,
    node_ptr: Vec<usize>,
    /// Nodes on cracks.
    on_crack: BTreeSet<u32>,
    /// Lengths of the mesh.
    pub lengths: Lengths,
    /// Divided cells with faces of a crack, by crack.
    cut_by: Vec<Vec<usize>>,
    /// By cell on side 2 of faces between two cells: those on side 1, which have the faces.
    hosts: BTreeMap<usize, BTreeSet<usize>>,
    standard: usize,
}

impl Enrichment {
    /// Enriches the nodes around the given arms. `beside`: places next to nodes on a
    /// crack, on the side of it whose piece is the node's own; by default that is side 1.
    ///
    /// # Errors
    /// A crack wholly outside, two in one place, or one that leaves a cell no clean parts.
    pub fn new(
        mesh: &Mesh,
        lengths: &Lengths,
        (cracks, arrangement): (&[Crack], Arrangement),
        beside: &BTreeMap<u32, Point>,
    ) -> Result<Self, EnrichmentError> {
        let tips = match mesh.dim() {
            2 => Tips::flat(mesh, lengths, cracks, &arrangement)?,
            _ => Tips::solid(mesh, lengths, cracks)?,
        };
        let divided = tips.partitions.values().chain(tips.endings.values());
        let faces = divided.flat_map(|p| &p.faces);
        let present: BTreeSet<usize> = faces.map(|f| cracks[f.crack].number).collect();
        for crack in cracks {
            if !present.contains(&crack.number) {
                return Err(if enters(mesh, crack) {
                    EnrichmentError::too_short(cracks, crack.number, lengths)
                } else {
                    EnrichmentError::Outside(crack.number)
                });
            }
        }
        let mut cut_by = vec![Vec::new(); cracks.len()];
        let mut hosts: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for (&cell, partition) in &tips.partitions {
            let own: BTreeSet<usize> = partition.faces.iter().map(|f| f.crack).collect();
            own.into_iter().for_each(|crack| cut_by[crack].push(cell));
            let others = partition.faces.iter().map(|f| f.sides[1].0);
            for other in others.filter(|&other| other != cell) {
                hosts.entry(other).or_default().insert(cell);
            }
        }
        let pieces = support_pieces(mesh, cracks, &arrangement, &tips, beside);
        let standard = mesh.nodes.len();
        let plain = (0..standard as u32).map(|node| Function {
            node,
            kind: FunctionKind::Standard,
        });
        let mut enriched = tips.functions;
        for (&node, own) in &pieces {
            enriched.extend((0..own.len() as u32).map(|piece| Function {
                node,
                kind: FunctionKind::Piece { piece },
            }));
        }
        let functions: Vec<Function> = plain.chain(enriched).collect();
        let first_of =
            |node: usize| functions[standard..].partition_point(|f| (f.node as usize) < node);
        let node_ptr = (0..=standard)
            .map(|node| standard + first_of(node))
            .collect();
        let shifts = functions
            .iter()
            .map(|f| match f.kind {
                FunctionKind::Standard | FunctionKind::Piece { .. } => 0.0,
                FunctionKind::Branch { tip, order } => {
                    let frame: &TipFrame = &tips.frames[tip as usize];
                    let crack = &cracks[frame.crack];
                    let x = &mesh.nodes[f.node as usize];
                    let at = |side| frame.branch(x, Some(side)).0[order as usize];
                    // On the crack neither side goes first: where a ramp rises, the functions differ by more than a shift.
                    if crack.holds(f.node) {
                        0.5 * (at(1.0) + at(-1.0))
                    } else {
                        at(crack.side_of(mesh, f.node as usize))
                    }
                }
            })
            .collect();
        let mut singular: Vec<Point> = tips.frames.iter().flat_map(TipFrame::tips).collect();
        let mut seen = BTreeSet::new();
        singular.retain(|x| seen.insert(x.map(f64::to_bits)));
        let at_place = Boxes::new(singular.iter().map(|x| [*x; 2]));
        let largest = lengths.of_nodes.iter().copied().fold(0.0, f64::max);
        // At a corner other functions jump, too.
        let own = |&tip: &usize| tips.frames[tip].shape != FrontShape::Corner;
        let ends: Vec<usize> = (0..tips.frames.len()).filter(own).collect();
        let around = ends
            .iter()
            .map(|&tip| tips.frames[tip].extents(2.0 * AT_TIP * largest));
        let at_tips = (Boxes::new(around), ends);
        let mut corners_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (number, corner) in tips.corners.iter().enumerate() {
            let arms: BTreeSet<usize> = corner.long.iter().copied().collect();
            arms.into_iter()
                .for_each(|arm| corners_of.entry(arm).or_default().push(number));
        }
        let pairs = tips.frames.iter().zip(&tips.zones);
        let pairs = pairs.filter(|(frame, _)| matches!(frame.shape, FrontShape::Pair { .. }));
        let mut enrichment = Enrichment {
            short: pairs.flat_map(|(_, zone)| &zone.arms).copied().collect(),
            narrow: tips.narrow,
            node_ptr,
            at_tips,
            corners_of,
            functions,
            shifts,
            singular: (singular, at_place),
            tips: tips.frames,
            zones: tips.zones,
            tip_cells: tips.cells,
            corners: tips.corners,
            partitions: tips.partitions,
            endings: tips.endings,
            arrangement,
            cell_ptr: vec![0],
            cell_functions: Vec::new(),
            step_ptr: vec![0],
            steps: Vec::new(),
            on_crack: cracks.iter().flat_map(Crack::nodes_on).copied().collect(),
            lengths: lengths.clone(),
            cut_by,
            hosts,
            standard,
        };
        enrichment.index_cells(mesh, cracks, &pieces);
        Ok(enrichment)
    }

    /// Function lists of the cells: standard ones, then the enriched ones that do not vanish in the cell.
    fn index_cells(&mut self, mesh: &Mesh, cracks: &[Crack], pieces: &Pieces) {
        // By node and piece: the places it holds.
        let holds = |node: u32, piece: u32, place: &Place| {
            let own = pieces.get(&node).and_then(|own| own.get(piece as usize));
            own.is_some_and(|places| places.binary_search(place).is_ok())
        };
        let rounding = on_crack(self.lengths.smallest, self.lengths.rounding);
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
                        FunctionKind::Piece { piece } => {
                            let inside = |region| holds(node, piece, &(cell, region));
                            let regions = 0..parts.len();
                            let steps = regions.map(|r| if inside(r) { STEP } else { 0.0 });
                            let steps: Vec<f64> = steps.collect();
                            if steps.iter().all(|&s| s == 0.0) {
                                continue;
                            }
                            steps
                        }
                        // On the crack itself a branch function takes the value of the region's side.
                        FunctionKind::Branch { tip, .. } => {
                            let frame = &self.tips[tip as usize];
                            let crack = &cracks[frame.crack];
                            let elsewhere = || beside((mesh, rounding), frame, crack, cell);
                            let jumps = &self.zones[tip as usize].arms;
                            let of_crack = |s: &&(usize, Side)| jumps.contains(&s.0);
                            let side = |part: &Option<&Part>| {
                                part.and_then(|p| p.sides.iter().find(of_crack))
                                    .map(|s| s.1)
                            };
                            let cut_off = &self.zones[tip as usize].cut_off;
                            let step = |(region, part): (usize, &Option<&Part>)| {
                                if cut_off.contains(&(cell, region)) {
                                    ABSENT
                                } else {
                                    side(part).unwrap_or_else(elsewhere)
                                }
                            };
                            // Absent everywhere, too: what the solver makes of it holds functions that are not.
                            parts.iter().enumerate().map(step).collect()
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

    /// Division of a cell that a crack ends in and that is left whole, because the end carries no branch functions.
    pub fn ending(&self, cell: usize) -> Option<&Partition> {
        self.endings.get(&cell)
    }

    /// Division of a cell; `None` if no crack cuts it.
    pub fn partition(&self, cell: usize) -> Option<&Partition> {
        self.partitions.get(&cell)
    }

    /// Where arms cross a mesh edge (2D) [m].
    pub fn places_on(&self, edge: [u32; 2]) -> impl Iterator<Item = Point> {
        self.arrangement.on_edge(edge).map(|place| place.1)
    }

    /// Whether the functions of a tip jump over an arm.
    pub fn jumps_over(&self, tip: usize, arm: usize) -> bool {
        self.zones[tip].arms.contains(&arm)
    }

    /// Divided cells with faces of a crack, in order.
    pub fn cut_by(&self, crack: usize) -> &[usize] {
        &self.cut_by[crack]
    }

    /// Cells that have the faces beside a cell: itself, and others on side 1 of those between two.
    pub fn hosts(&self, cell: usize) -> impl Iterator<Item = usize> {
        let others = self.hosts.get(&cell).into_iter().flatten().copied();
        std::iter::once(cell).chain(others)
    }

    /// Number of regions of a cell.
    pub fn regions(&self, cell: usize) -> usize {
        self.partition(cell).map_or(1, |p| p.parts.len())
    }

    /// Side of a crack on which a region lies, if the crack cuts the cell there.
    pub fn side(&self, cell: usize, region: Region, crack: usize) -> Option<Side> {
        self.partition(cell)?.parts[region].side(crack)
    }

    /// Constants of the functions of a cell, region by region and function by function: [`STEP`] on its piece and 0 elsewhere for a
    /// piece function, the side of its crack for a branch function (0: by position, [`ABSENT`]: none), 1 for a standard one.
    pub fn steps(&self, cell: usize) -> &[f64] {
        const STANDARD: [f64; MOST_NODES] = [1.0; MOST_NODES];
        let own = &self.steps[self.step_ptr[cell]..self.step_ptr[cell + 1]];
        if own.is_empty() { &STANDARD } else { own }
    }

    /// Constant of a function in a region of a cell; where it does not live 0, of a branch function [`ABSENT`].
    pub fn step(&self, (cell, region): Place, function: usize) -> f64 {
        let functions = self.cell(cell);
        let place = functions.iter().position(|&f| f as usize == function);
        let none = [0.0, ABSENT][usize::from(self.is_branch(function))];
        place.map_or(none, |i| self.steps(cell)[region * functions.len() + i])
    }

    /// Constants of a function on side 1 and side 2 of a face, if they differ: what jumps there. Functions of nodes that only one
    /// cell has vanish on the facet between two.
    pub fn step_across(&self, sides: [Place; 2], function: usize) -> Option<[f64; 2]> {
        let node = self.functions[function].node;
        let shared = sides.iter().all(|side| self.cell(side.0).contains(&node));
        let [one, two] = sides.map(|side| self.step(side, function));
        (shared && one != two).then_some([one, two])
    }

    /// Enriched functions of a node.
    pub fn enriched_of(&self, node: usize) -> std::ops::Range<usize> {
        self.node_ptr[node]..self.node_ptr[node + 1]
    }

    /// Piece functions of a node.
    pub fn pieces_of(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let own = self.enriched_of(node);
        own.filter(|&f| matches!(self.functions[f].kind, FunctionKind::Piece { .. }))
    }

    /// True for a branch function.
    pub fn is_branch(&self, function: usize) -> bool {
        matches!(self.functions[function].kind, FunctionKind::Branch { .. })
    }

    /// Whether an arm is one of a short crack, which has functions of both ends.
    pub fn is_short(&self, arm: usize) -> bool {
        self.short.contains(&arm)
    }

    /// True if a node lies on a crack between its ends, so that the displacement jumps there.
    pub fn jumps_at(&self, node: usize) -> bool {
        !self.enriched_of(node).is_empty() && self.on_crack.contains(&(node as u32))
    }

    /// Functions of a cell, the standard ones first.
    pub fn cell(&self, cell: usize) -> &[u32] {
        &self.cell_functions[self.cell_ptr[cell]..self.cell_ptr[cell + 1]]
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.cell_ptr.len() - 1
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.standard
    }

    /// Where branch functions are singular in 2D, the tips and corners that carry them, closer than a distance to the box of some
    /// points [m].
    pub fn singular_points_near(&self, corners: &[Point], distance: f64) -> Vec<Point> {
        let (points, boxes) = &self.singular;
        let near = boxes.meeting(&around(corners, distance));
        near.into_iter().map(|k| points[k]).collect()
    }

    /// Corners at which an arm is long enough for multipliers of its own.
    pub fn corners_of(&self, arm: usize) -> impl Iterator<Item = &Corner> {
        let own = self.corners_of.get(&arm).into_iter().flatten();
        own.map(|&corner| &self.corners[corner])
    }

    /// Whether a place is at a tip or front, see [`AT_TIP`]; `size`: the shortest edge there [m].
    pub fn is_at_tip(&self, x: &Point, size: f64) -> bool {
        let (boxes, tips) = &self.at_tips;
        let mut near = boxes.meeting(&[*x; 2]).into_iter();
        near.any(|k| self.tips[tips[k]].distance(x) <= AT_TIP * size)
    }

    /// Local nodes of a cell in the ramp of a tip, one bit each.
    pub fn ramp(&self, tip: usize, nodes: &[u32]) -> u8 {
        let core = &self.zones[tip].core;
        if core.is_empty() {
            return u8::MAX;
        }
        let inside = nodes.iter().enumerate().filter(|(_, n)| core.contains(n));
        inside.fold(0, |mask, (i, _)| mask | 1 << i)
    }

    /// True if the ramp of some tip falls within a cell of these nodes.
    pub fn ramps_in(&self, nodes: &[u32], cell: usize) -> bool {
        let tips = self.kinds(cell).filter_map(|kind| match kind {
            FunctionKind::Branch { tip, .. } => Some(tip as usize),
            _ => None,
        });
        let tips: BTreeSet<usize> = tips.collect();
        let mut inside = tips.into_iter().map(|tip| self.ramp(tip, nodes));
        inside.any(|inside| !matches!(inside, 0 | 0b1111 | u8::MAX))
    }

    /// True if the cell carries standard functions only.
    pub fn is_plain(&self, mesh: &Mesh, cell: usize) -> bool {
        self.cell(cell).len() == mesh.kind.nodes()
    }

    /// True if a function of the cell is a branch function.
    pub fn has_branch(&self, cell: usize) -> bool {
        self.cell(cell).iter().any(|&f| self.is_branch(f as usize))
    }

    fn kinds(&self, cell: usize) -> impl Iterator<Item = FunctionKind> + '_ {
        let functions = self.cell(cell).iter();
        functions.map(|&f| self.functions[f as usize].kind)
    }

    /// Cells that carry each function.
    pub fn users(&self) -> Vec<Vec<u32>> {
        let mut users = vec![Vec::new(); self.functions.len()];
        for cell in 0..self.cells() {
            for &f in self.cell(cell) {
                users[f as usize].push(cell as u32);
            }
        }
        users
    }
}

/// Side of the line of a tip's crack on which a cell lies that this crack does not divide; 0 where the place tells.
///
/// The line is that along which its functions jump: the crack may bend elsewhere.
fn beside((mesh, rounding): (&Mesh, f64), frame: &TipFrame, crack: &Crack, cell: usize) -> Side {
    let map = mesh.map(cell);
    let level = |(x, &node): (&Point, &u32)| match crack.holds(node) {
        true => 0.0,
        false => snapped(frame.beside(x)[1], rounding),
    };
    let levels: Vec<f64> = map.iter().zip(mesh.cell(cell)).map(level).collect();
    match levels.iter().any(|f| *f < 0.0) {
        _ if is_split(&levels) => 0.0,
        true => -1.0,
        false => 1.0,
    }
}

/// Whether a crack has a part inside the body.
fn enters(mesh: &Mesh, crack: &Crack) -> bool {
    let middles = crack.path.windows(2).map(|w| mean([&w[0].x, &w[1].x]));
    let centre = match &crack.geometry {
        Geometry::Ellipse(ellipse) => Some(ellipse.centre),
        _ => None,
    };
    middles
        .chain(centre)
        .any(|x| !cells_at(mesh, &x).is_empty())
}
