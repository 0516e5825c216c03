//! Which tips, fronts and corners carry branch functions, on which nodes, and how the cracks divide the cells.
//!
//! The first branch function jumps along the line behind its tip, as far as that goes. So only nodes carry it whose cells
//! hold no part of that line but the crack itself: a bend, another crack, the other end are the end of a tip's room. A tip
//! without that room for its own cells ends like one without branch functions, on the last cell edge it crosses; short
//! cracks take functions of both ends at once.
//!
//! The radius is no larger than the room. A zone that no crack but its own enters is sought from the given radius downwards, to the
//! smallest ramp, which others may enter.

pub mod corners;
mod ends;
mod pairs;
mod room;
mod solid;

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use self::corners::Corner;
use self::pairs::Pair;
use crate::cut::arrangement::{Arrangement, Chain};
use crate::cut::crack::{Crack, Tip};
use crate::cut::part::Face;
use crate::cut::partition::{BorderPiece, Partition};
use crate::cut::regions;
use crate::geometry::boxes::Boxes;
use crate::geometry::curve::turned;
use crate::geometry::segments::Segments;
use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, dot, norm, sub};
use crate::mesh::neighbours::Neighbours;
use crate::mesh::{Facet, Lengths, Mesh};

use super::basis::{Function, FunctionKind};
use super::error::EnrichmentError;
use super::supports::Joiner;
use super::zone::Zone;

/// The radius that the program chooses, in parts of the room around a tip: its crack, other cracks, the border.
const SHARE: f64 = 0.25;

/// A line farther than this from a cell, in diagonals, is not on it: rounding.
const GRAZING: f64 = 1e-12;

/// A line that is no longer than this in a cell, in diagonals, only touches it.
const LONGER: f64 = 1e-6;

/// Cells longer than this times their width take no branch functions by themselves …
const SLENDER: f64 = 6.0;
/// … and longer ones none at all.
const SLENDEREST: f64 = 30.0;

/// An arm shorter than this, in diagonals of the cell of its tip, is none: its functions drown in the rounding of the others.
const SHORTEST: f64 = 0.01;

/// The cells that cracks divide and the tips that carry branch functions.
#[derive(Debug, Default)]
pub struct Tips {
    /// Divided cells.
    pub partitions: BTreeMap<usize, Partition>,
    /// Pieces of mesh edges (lower node first) between places of cracks, by their number from the lower node on, that cracks run along.
    pub parted: BTreeSet<([u32; 2], usize)>,
    /// Cells that a crack divides up to its end and that are left whole, because the end carries no branch functions.
    pub endings: BTreeMap<usize, Partition>,
    /// Tips and fronts inside the body that carry branch functions.
    pub frames: Vec<TipFrame>,
    /// Cells with a tip in their closure or a front inside: (cell, tip number), sorted.
    pub cells: Vec<(usize, usize)>,
    /// Nodes around each of them.
    pub zones: Vec<Zone>,
    /// Branch functions.
    pub functions: BTreeSet<Function>,
    /// Corners with branch functions.
    pub corners: Vec<Corner>,
    /// Tips of plane bodies that go without the ramp they ask for.
    pub narrow: Vec<Narrow>,
}

/// A tip that goes without the ramp it asks for.
#[derive(Debug, Clone)]
pub struct Narrow {
    /// Its crack in the case, from 0.
    pub crack: usize,
    /// Length that the crack seems shorter for it [m].
    pub lost: f64,
}

/// What a tip without ramp costs, in widths of its cell: measured on straight cracks of 5 to 18 cells, whose dissipation it takes
/// 0.4 h/L of where both go without. One that ends on the cell edge before it is half a cell shorter, and that counts twice.
const WITHOUT_RAMP: f64 = 0.2;
const WITHOUT_FUNCTIONS: f64 = 1.0;

impl Tips {
    /// Divides the cells of a 2D body.
    ///
    /// # Errors
    /// Cracks that leave a cell no clean parts.
    pub fn flat(
        mesh: &Mesh,
        lengths: &Lengths,
        arms: &[Crack],
        arrangement: &Arrangement,
    ) -> Result<Self, EnrichmentError> {
        let ends = |&facet: &Facet| {
            let nodes: Vec<usize> = mesh.facet_nodes(facet).collect();
            [0, 1].map(|i| mesh.nodes[nodes[i]])
        };
        let mut search = Search {
            mesh,
            lengths,
            near: Neighbours::new(mesh),
            arms,
            arrangement,
            kept: arrangement
                .tips
                .iter()
                .map(|t| arms[t.arm].tip != Tip::None)
                .collect(),
            pairs: Vec::new(),
            paired: BTreeSet::new(),
            partitions: BTreeMap::new(),
            parted: BTreeSet::new(),
            extents: Boxes::new(arms.iter().map(Crack::extents)),
            paths: (arms.iter())
                .map(|arm| Segments::path(arm.path.iter().map(|v| v.x)))
                .collect(),
            border: Segments::new(mesh.sides.values().flatten().map(ends).collect()),
            tips_by_place: Boxes::new(arrangement.tips.iter().map(|tip| [tip.x; 2])),
            tips_of: vec![Vec::new(); arms.len()],
            chains_of: vec![Vec::new(); arms.len()],
            straight: (0..arms.len()).collect(),
        };
        for arm in 1..arms.len() {
            if search.goes_on(arm - 1, arm) {
                search.straight[arm] = search.straight[arm - 1];
            }
        }
        for (number, tip) in arrangement.tips.iter().enumerate() {
            search.tips_of[tip.arm].push(number);
        }
        for (&cell, chains) in &arrangement.chains {
            let own = chains.iter().map(|chain| (cell, chain));
            own.for_each(|chain| search.chains_of[chain.1.arm].push(chain));
        }
        // Every round takes at least one tip its functions.
        while search.round()? {}
        if search.add_pairs() {
            search.divide()?;
        }
        let mut tips = Tips {
            endings: search.endings(),
            ..Tips::default()
        };
        let without = (0..search.kept.len()).filter(|&t| !search.kept[t]);
        tips.narrow = without
            .filter_map(|t| search.narrow(t, WITHOUT_FUNCTIONS))
            .collect();
        let mut kept: Vec<usize> = (0..search.kept.len()).filter(|&t| search.kept[t]).collect();
        kept.sort_by_key(|&t| lengths.from_middle(&arrangement.tips[t].x));
        let found = kept.into_par_iter().map(|number| {
            let tip = &arrangement.tips[number];
            let end = search.end(number);
            let zone = search.zone(tip, &end);
            let beyond = search.beyond(tip, &end, &zone);
            let narrow = zone
                .core
                .is_empty()
                .then(|| search.narrow(number, WITHOUT_RAMP));
            (tip, end, zone, beyond, narrow.flatten())
        });
        for (tip, end, zone, beyond, narrow) in found.collect::<Vec<_>>() {
            tips.narrow.extend(narrow);
            tips.add(end.frame.clone(), &tip.cells, zone);
            if let Some(zone) = beyond {
                tips.add(end.frame, &[], zone);
            }
        }
        for pair in &search.pairs {
            let (frame, at_ends, zone) = search.pair_zone(pair);
            tips.add(frame, &at_ends, zone);
        }
        search.add_corners(&mut tips);
        (tips.partitions, tips.parted) = (search.partitions, search.parted);
        tips.cells.sort_unstable();
        Ok(tips)
    }

    /// Adds the branch functions of a tip or front with the given cells around it.
    fn add(&mut self, frame: TipFrame, cells: &[usize], zone: Zone) {
        let tip = self.frames.len();
        self.cells.extend(cells.iter().map(|&cell| (cell, tip)));
        let nodes = zone.nodes.iter();
        self.functions
            .extend(nodes.flat_map(|&node| branches(node, tip, 4)));
        self.frames.push(frame);
        self.zones.push(zone);
    }
}

/// The first branch functions of a tip at a node.
fn branches(node: u32, tip: usize, count: u8) -> impl Iterator<Item = Function> {
    (0..count).map(move |order| {
        let kind = FunctionKind::Branch {
            tip: tip as u32,
            order,
        };
        Function { node, kind }
    })
}

/// The search for the tips of a 2D body that can carry branch functions.
struct Search<'a> {
    mesh: &'a Mesh,
    lengths: &'a Lengths,
    near: Neighbours<'a>,
    arms: &'a [Crack],
    arrangement: &'a Arrangement,
    /// By tip: whether it does, so far.
    kept: Vec<bool>,
    /// Short cracks with functions of both ends, and their arms.
    pairs: Vec<Pair>,
    paired: BTreeSet<usize>,
    /// The border of the body, and the tips by place.
    border: Segments,
    tips_by_place: Boxes,
    /// By arm: a box around it, its path, its tips, its chains with their cells.
    extents: Boxes,
    paths: Vec<Segments>,
    tips_of: Vec<Vec<usize>>,
    chains_of: Vec<Vec<(usize, &'a Chain)>>,
    /// By arm: the first of those of its crack that go straight on through meetings.
    straight: Vec<usize>,
    partitions: BTreeMap<usize, Partition>,
    /// See [`Tips::parted`].
    parted: BTreeSet<([u32; 2], usize)>,
}

impl Search<'_> {
    /// Divides the cells, and takes the functions from tips without room; whether there were any.
    fn round(&mut self) -> Result<bool, EnrichmentError> {
        self.divide()?;
        let kept: Vec<bool> = (0..self.kept.len())
            .into_par_iter()
            .map(|tip| self.kept[tip] && self.has_room(tip))
            .collect();
        let fewer = kept != self.kept;
        self.kept = kept;
        Ok(fewer)
    }

    /// Whether a chain divides its cell: one with a free end only where that carries functions.
    fn divides(&self, chain: &Chain) -> bool {
        (0..2).all(|end| !chain.tip[end] || self.keeps(chain.arm, end))
    }

    /// A tip that asks for more than it has, and costs so many widths of its cell.
    fn narrow(&self, number: usize, widths: f64) -> Option<Narrow> {
        let tip = &self.arrangement.tips[number];
        let crack = self.arms[tip.arm].number;
        let asks = self.asks(tip.arm) && !self.paired.contains(&tip.arm);
        let size = |&cell: &usize| self.mesh.map(cell).diagonal() * std::f64::consts::FRAC_1_SQRT_2;
        let lost = widths * tip.cells.iter().map(size).fold(0.0, f64::max);
        asks.then_some(Narrow { crack, lost })
    }

    /// Whether the tips of an arm ask for a ramp.
    fn asks(&self, arm: usize) -> bool {
        matches!(self.arms[arm].tip, Tip::Auto | Tip::Radius(_))
    }

    fn keeps(&self, arm: usize, end: usize) -> bool {
        let mut tips = self.tips_of[arm].iter();
        self.paired.contains(&arm)
            || tips.any(|&t| self.kept[t] && self.arrangement.tips[t].end == end)
    }

    fn divide(&mut self) -> Result<(), EnrichmentError> {
        self.partitions.clear();
        self.parted.clear();
        for (&cell, chains) in &self.arrangement.chains {
            let own: Vec<&Chain> = (chains.iter())
                .filter(|chain| chain.along.is_none() && self.divides(chain))
                .collect();
            if !own.is_empty() {
                let partition = self.divided(cell, &own)?;
                if partition.parts.len() > 1 {
                    self.partitions.insert(cell, partition);
                }
            }
        }
        let arrangement = self.arrangement;
        let chains = arrangement.chains.iter();
        let along = chains.flat_map(|(&cell, own)| own.iter().map(move |chain| (cell, chain)));
        for (cell, chain) in along {
            if let Some((edge, other)) = chain.along.filter(|_| self.divides(chain)) {
                self.part_edge(edge, [cell, other], chain)?;
            }
        }
        Ok(())
    }

    /// The regions of a cell between chains through it.
    fn divided(&self, cell: usize, chains: &[&Chain]) -> Result<Partition, EnrichmentError> {
        let straight = |arm: usize| self.straight[arm];
        let found = regions::divide(self.mesh, cell, self.arrangement, chains, straight);
        found.map_err(|reason| EnrichmentError::Partition {
            crack: chains.last().map_or(0, |chain| self.arms[chain.arm].number),
            reason,
            at: self.mesh.centre(cell),
        })
    }

    /// Parts two cells by a chain along the edge between them, piece by piece where continuations end on it.
    fn part_edge(
        &mut self,
        edge: [u32; 2],
        cells: [usize; 2],
        chain: &Chain,
    ) -> Result<(), EnrichmentError> {
        let [from, to] = [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]].map(|v| v.x);
        let along = chain.directions[0];
        let at = |x: &Point| dot(&sub(x, &from), &along);
        let length = at(&to);
        let mut pieces = [Vec::new(), Vec::new()];
        for ((cell, side), pieces) in cells.into_iter().zip([1.0, -1.0]).zip(&mut pieces) {
            if !self.partitions.contains_key(&cell) {
                let whole = self.divided(cell, &[])?;
                self.partitions.insert(cell, whole);
            }
            let (nodes, partition) = (self.mesh.cell(cell), self.partitions.get_mut(&cell));
            let Some(Partition { parts, border, .. }) = partition else {
                continue;
            };
            let on_edge = |piece: &&BorderPiece| {
                let ends = [piece.edge, (piece.edge + 1) % nodes.len()];
                let middle = 0.5 * (at(&piece.ends[0]) + at(&piece.ends[1]));
                ends.iter().all(|&i| edge.contains(&nodes[i])) && (0.0..length).contains(&middle)
            };
            for piece in border.iter().filter(on_edge) {
                let own = &mut parts[piece.region].sides;
                own.retain(|other| other.0 != chain.arm);
                own.insert(0, (chain.arm, side));
                pieces.push(piece.clone());
            }
            if side < 0.0 {
                pieces.reverse();
            }
        }
        let [left, right] = &pieces;
        let nodes = self.mesh.cell(cells[0]);
        let mut faces = Vec::new();
        let (mut i, mut j, mut x) = (0, 0, from);
        // The left cell lies to the left of its outline, the right one of the way back.
        while let (Some(one), Some(two)) = (left.get(i), right.get(j)) {
            let (end, other) = (one.ends[1], two.ends[0]);
            let next = if at(&end) <= at(&other) { end } else { other };
            (i, j) = (i + usize::from(end == next), j + usize::from(other == next));
            let ends = [one.edge, (one.edge + 1) % nodes.len()];
            let corner = |x: Point| {
                let node = ends
                    .into_iter()
                    .find(|&i| self.mesh.nodes[nodes[i] as usize] == x);
                (x, Some(node.map_or(ends, |node| [node, node])))
            };
            faces.push(Face {
                crack: chain.arm,
                corners: vec![corner(x), corner(next)],
                sides: [(cells[0], one.region), (cells[1], two.region)],
                frame: [turned(&along), along, [0.0, 0.0, 1.0]],
            });
            x = next;
        }
        if let Some(partition) = self.partitions.get_mut(&cells[0]) {
            partition.faces.extend(faces);
        }
        let lower = &self.mesh.nodes[edge[0] as usize];
        let away = |x: &Point| norm(&sub(x, lower));
        let nearer = away(&from).min(away(&to));
        let before = self
            .arrangement
            .on_edge(edge)
            .filter(|(_, x)| away(x) <= nearer);
        self.parted.insert((edge, before.count()));
        Ok(())
    }

    /// Shape of the cells left whole with their cracks up to the ends.
    fn endings(&self) -> BTreeMap<usize, Partition> {
        let through = |chain: &&Chain| chain.along.is_none();
        let whole = self.arrangement.chains.iter().filter(|(cell, chains)| {
            let mut through = chains.iter().filter(through);
            !self.partitions.contains_key(cell) && through.any(|c| c.tip != [false; 2])
        });
        whole
            .filter_map(|(&cell, chains)| {
                let own: Vec<&Chain> = chains.iter().filter(through).collect();
                Some((cell, self.divided(cell, &own).ok()?))
            })
            .collect()
    }

    /// Cells that an arm runs through, along or ends in for no less than a length [m].
    fn cells_of(&self, arm: usize, least: f64) -> Vec<usize> {
        let own = self.chains_of[arm].iter();
        let own = own.filter(|(_, chain)| chain.range[1] - chain.range[0] >= least);
        let beside =
            |(cell, chain): &(usize, &Chain)| [Some(*cell), chain.along.map(|along| along.1)];
        let mut cells: Vec<usize> = own.flat_map(beside).flatten().collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    fn joiner(&self) -> Joiner<'_> {
        Joiner {
            mesh: self.mesh,
            cracks: &[],
            arrangement: self.arrangement,
            partitions: &self.partitions,
            parted: &self.parted,
        }
    }

    /// Length of an arm inside the body [m].
    fn inside(&self, arm: usize) -> f64 {
        let own = self.chains_of[arm].iter();
        own.map(|(_, c)| c.range[1] - c.range[0]).sum()
    }

    /// Whether one of some cells is longer than so many of its widths: it holds nothing of a tip, and functions become dependent.
    fn is_slender(&self, cells: &[usize], longest: f64) -> bool {
        let mut aspects = cells.iter().map(|&cell| self.mesh.map(cell).aspect());
        aspects.any(|aspect| aspect > longest)
    }

    /// Whether the cells of a tip can carry its functions.
    fn has_room(&self, number: usize) -> bool {
        let tip = &self.arrangement.tips[number];
        let divided = |cell: &usize| self.partitions.get(cell);
        // A tip inside a cell divides it.
        let parted = tip.cells.len() > 1
            || divided(&tip.cells[0]).is_some_and(|p| p.faces.iter().any(|f| f.crack == tip.arm));
        let nodes = self.mesh.nodes_of(self.cells_beside(&tip.x));
        let least = SHORTEST * self.mesh.map(tip.cells[0]).diagonal();
        let parted = parted && self.inside(tip.arm) > least;
        let longest = match self.arms[tip.arm].tip {
            Tip::Auto => SLENDER,
            _ => SLENDEREST,
        };
        if !parted || self.is_slender(&tip.cells, longest) {
            return false;
        }
        let end = self.end(number);
        end.room > least && !self.is_blocked(&end, &nodes, &self.cut_off(&end, &nodes))
    }
}
