//! Which nodes carry which enriched functions, and which functions live in each cell.

use std::collections::BTreeSet;

use crate::fem::mesh::Mesh;
use crate::fem::{Point, add_scaled, norm, sub};
use crate::harness::case::Tip;

use super::basis::{CellFunction, FunctionKind, TipFrame};
use super::crack::Crack;
use super::cut::{self, Side};

/// Lengths along the crack are equal within this, in units of the cell's diagonal: a tip this close to an edge is on it.
const ON_EDGE: f64 = 1e-9;

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
    /// Two cracks cut the same cell.
    #[error("cracks {} and {} cut the same cell, near {at:?}", first + 1, second + 1)]
    Crossing {
        /// Earlier crack, from 0.
        first: usize,
        /// Later crack, from 0.
        second: usize,
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
    /// Tips inside the body that carry branch functions.
    pub tips: Vec<TipFrame>,
    /// Crack that splits each cell (tip cells included), if any.
    pub split: Vec<Option<u32>>,
    /// Cells with a tip in their closure: (cell, tip number), sorted.
    pub tip_cells: Vec<(usize, usize)>,
    cell_ptr: Vec<usize>,
    cell_functions: Vec<u32>,
    /// Per entry of `cell_functions`: the side of the function's crack that the whole cell lies on, if it lies on one.
    cell_sides: Vec<Option<Side>>,
    node_ptr: Vec<usize>,
    /// Nodes with φ = 0 for some crack.
    on_crack: Vec<bool>,
    standard: usize,
}

/// How a 2D cell that the crack's line splits lies along the crack.
enum Along {
    /// Beyond an end.
    Away,
    /// The crack runs through.
    Through,
    /// The crack ends inside.
    Ends,
}

impl Enrichment {
    /// Enriches the nodes around the given cracks; none of them may run along cell facets.
    pub fn new(mesh: &Mesh, cracks: &[Crack]) -> Result<Self, EnrichmentError> {
        let mut split: Vec<Option<u32>> = vec![None; mesh.cell_count()];
        let mut enriched: BTreeSet<Function> = BTreeSet::new();
        let mut tips = Vec::new();
        let mut tip_cells = Vec::new();
        for (index, crack) in cracks.iter().enumerate() {
            let claim = |split: &mut Vec<Option<u32>>, cell: usize| match split[cell] {
                Some(other) if other as usize != index => Err(EnrichmentError::Crossing {
                    first: cracks[other as usize].number,
                    second: crack.number,
                    at: mesh.centre(cell),
                }),
                _ => {
                    split[cell] = Some(index as u32);
                    Ok(())
                }
            };
            let mut through = BTreeSet::new();
            let mut touched = false;
            for cell in 0..mesh.cell_count() {
                let phi = crack.cell_phi(mesh, cell);
                if !cut::is_split(mesh.kind, &phi) {
                    continue;
                }
                match along(mesh, crack, cell, &phi) {
                    Along::Away => {}
                    Along::Through => {
                        touched = true;
                        claim(&mut split, cell)?;
                        through.insert(cell);
                    }
                    Along::Ends => touched = true,
                }
            }
            if !touched {
                return Err(EnrichmentError::Outside {
                    crack: crack.number,
                });
            }
            // Nodes where the jump must close (no tip functions) or is left to the branch functions.
            let mut closing: BTreeSet<u32> = BTreeSet::new();
            for (position, ahead) in ends_inside(mesh, crack) {
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
                for cell in cells_at(mesh, &position) {
                    if crack.tip != Tip::None {
                        if cut::is_split(mesh.kind, &crack.cell_phi(mesh, cell)) {
                            claim(&mut split, cell)?;
                        }
                        tip_cells.push((cell, tip));
                        for &node in mesh.cell(cell) {
                            closing.insert(node);
                            enriched.extend(branch(node));
                        }
                    } else if !through.contains(&cell) {
                        closing.extend(mesh.cell(cell));
                    }
                }
                if let Tip::Radius(radius) = crack.tip {
                    let near = |x: &Point| norm(&sub(x, &position)) <= radius;
                    let nodes = (0..mesh.nodes.len()).filter(|&n| near(&mesh.nodes[n]));
                    enriched.extend(nodes.flat_map(|n| branch(n as u32)));
                }
                if crack.tip != Tip::None {
                    tips.push(TipFrame {
                        crack: index,
                        position,
                        ahead,
                        normal: crack.frame[0],
                    });
                }
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
                FunctionKind::Heaviside { crack } => {
                    cracks[crack as usize].side_of(f.node as usize)
                }
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
            split,
            tip_cells,
            cell_ptr: vec![0],
            cell_functions: Vec::new(),
            cell_sides: Vec::new(),
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
            self.cell_functions.extend_from_slice(nodes);
            self.cell_sides.extend(nodes.iter().map(|_| None));
            for &node in nodes {
                for f in self.enriched_of(node as usize) {
                    let side = match self.functions[f].kind {
                        FunctionKind::Heaviside { crack } if self.split[cell] != Some(crack) => {
                            let side = whole_side(&cracks[crack as usize], nodes);
                            if side == self.shifts[f] {
                                continue;
                            }
                            Some(side)
                        }
                        // On the crack itself a branch function takes the value of the cell's side.
                        FunctionKind::Branch { tip, .. } => {
                            let index = self.tips[tip as usize].crack;
                            let phi = cracks[index].cell_phi(mesh, cell);
                            let apart = self.split[cell] != Some(index as u32)
                                && !cut::is_split(mesh.kind, &phi);
                            apart.then(|| whole_side(&cracks[index], nodes))
                        }
                        _ => None,
                    };
                    self.cell_functions.push(f as u32);
                    self.cell_sides.push(side);
                }
            }
            self.cell_ptr.push(self.cell_functions.len());
        }
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
        let sides = &self.cell_sides[self.cell_ptr[cell]..self.cell_ptr[cell + 1]];
        self.cell(cell)
            .iter()
            .zip(sides)
            .map(|(&f, &whole)| {
                let function = self.functions[f as usize];
                CellFunction {
                    // Every function of the cell belongs to one of its nodes.
                    local: nodes
                        .iter()
                        .position(|&n| n == function.node)
                        .unwrap_or_default(),
                    kind: function.kind,
                    shift: self.shifts[f as usize],
                    whole,
                }
            })
            .collect()
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

/// Side of a crack that a cell it does not split lies on.
fn whole_side(crack: &Crack, nodes: &[u32]) -> Side {
    if nodes.iter().any(|&n| crack.phi[n as usize] < 0.0) {
        -1.0
    } else {
        1.0
    }
}

/// Where a split cell lies along the crack.
fn along(mesh: &Mesh, crack: &Crack, cell: usize, phi: &[f64]) -> Along {
    if crack.length.is_infinite() {
        return Along::Through;
    }
    let corners = mesh.corners(cell);
    let facet = cut::facet(mesh.kind, &corners[..mesh.kind.nodes()], phi);
    let tolerance = ON_EDGE * norm(&sub(&corners[0], &corners[2]));
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (x, _) in &facet {
        let s = crack.abscissa(x);
        low = low.min(s);
        high = high.max(s);
    }
    if high <= tolerance || low >= crack.length - tolerance {
        Along::Away
    } else if low >= -tolerance && high <= crack.length + tolerance {
        Along::Through
    } else {
        Along::Ends
    }
}

/// Ends of a 2D crack strictly inside the body: position and direction ahead. An end on the outer boundary is no tip.
pub fn ends_inside(mesh: &Mesh, crack: &Crack) -> Vec<(Point, Point)> {
    if crack.length.is_infinite() {
        return Vec::new();
    }
    crack
        .ends()
        .into_iter()
        .filter(|(x, ahead)| {
            let Some(&cell) = cells_at(mesh, x).first() else {
                return false;
            };
            let corners = mesh.corners(cell);
            let step = 1e-6 * norm(&sub(&corners[0], &corners[2]));
            !cells_at(mesh, &add_scaled(x, step, ahead)).is_empty()
        })
        .collect()
}

/// Cells whose closure contains a point, within 1e-9 of their diagonal.
pub fn cells_at(mesh: &Mesh, x: &Point) -> Vec<usize> {
    (0..mesh.cell_count())
        .filter(|&cell| reference_position(mesh, cell, x, ON_EDGE).is_some())
        .collect()
}

/// Reference position of a point in the closure of a cell, give or take `slack` diagonals; `None` if it lies outside.
pub fn reference_position(mesh: &Mesh, cell: usize, x: &Point, slack: f64) -> Option<Point> {
    let corners = mesh.corners(cell);
    let corners = &corners[..mesh.kind.nodes()];
    let margin = slack * norm(&sub(&corners[0], &corners[2]));
    let outside = (0..mesh.dim()).any(|a| {
        corners.iter().all(|c| c[a] < x[a] - margin) || corners.iter().all(|c| c[a] > x[a] + margin)
    });
    if outside {
        return None;
    }
    let xi = mesh.kind.inverse_map(corners, x)?;
    xi.iter()
        .all(|v| v.abs() <= 1.0 + 4.0 * slack)
        .then_some(xi)
}
