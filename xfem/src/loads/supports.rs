//! Supports: from prescribed displacements to prescribed unknowns.
//!
//! ```text
//!   copy p of node j:  ū_j + 2 b_jp,  its own:  ū_j                      cracks part the support of a node into pieces
//!   own copy held by support o, copy p by s:  ū_j = u_o(x_j),  b_jp = ½ (u_s(x_j) − u_o(x_j))
//! ```
//!
//! A support holds the copies that live on the pieces of its side which its region holds wholly, and of a node on a crack those
//! that its region touches: one lip where it begins at the crack. A facet of which no region holds anything is held by its nodes,
//! if all of them are: then what is prescribed there is the interpolation of their displacements.

use std::collections::{BTreeMap, BTreeSet};

use crate::contact::free_jumps::FreeJumps;
use crate::cut::arrangement::DELTA;
use crate::cut::crack::{Crack, first_on};
use crate::cut::part::Region as CellRegion;
use crate::enrichment::Enrichment;
use crate::enrichment::basis::{FunctionKind, STEP};
use crate::enrichment::cell_facets::pieces;
use crate::geometry::clip::Side;
use crate::geometry::{Point, diameter, mean, norm, sub};
use crate::mesh::Mesh;
use crate::stiffness::cell_matrix::CellIntegrator;

use super::border::{Border, BorderPart, Region};

/// A support.
pub struct Support<'a> {
    /// Where it acts.
    pub on: Region<'a>,
    /// Prescribed values, `dim` components; `None`: free.
    pub displacement: Vec<Option<Amount<'a>>>,
    /// The lip that nodes on a crack belong to, where the region does not tell.
    pub lip: Option<Side>,
}

/// A prescribed component of the displacement.
pub enum Amount<'a> {
    /// At the place of the node, times the history factor [m].
    Stated(Box<dyn Fn(&Point) -> f64 + 'a>),
    /// The closed form at the node.
    Exact,
}

/// Why a support cannot be held, with its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SupportError {
    /// Its region holds no node.
    #[error("the support holds nothing")]
    Empty(usize),
    /// It holds a node on a crack and no part of the side beside it, and names no lip.
    #[error("holds a node on a crack, where two lips part, and no lip")]
    NoLip(usize),
    /// It names a lip where its region tells the lips apart.
    #[error("the region tells itself what it holds")]
    NeedlessLip(usize),
    /// It holds one lip of a crack where another support holds the other in other components.
    #[error("another support holds the other lip of a node on a crack in other components")]
    OtherLip(usize),
}

/// A prescribed unknown: numbers times the history factors of supports, or the value the closed form gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prescribed {
    /// Support in force.
    pub support: usize,
    /// Its share [m]; `None`: the closed form.
    pub amount: Option<f64>,
    /// Support that holds the node's own copy, where another holds this one, and its share, to be subtracted [m].
    pub less: Option<(usize, f64)>,
}

/// Components, one bit each.
type Components = u8;

/// Supports on a mesh.
pub struct Supports<'a> {
    all: &'a [Support<'a>],
    mesh: &'a Mesh,
    /// Border of the mesh.
    pub border: Border<'a>,
    /// Supports of every held node, in their order.
    of: BTreeMap<usize, Vec<usize>>,
}

/// Copies of nodes that supports hold; a copy goes by its function, the node's own by the standard one.
#[derive(Default)]
struct Held {
    by: BTreeMap<usize, BTreeSet<usize>>,
    /// Copies on facets that are held by their nodes.
    between: BTreeMap<usize, Components>,
    branches: BTreeMap<usize, Components>,
    /// Copies of nodes on a crack: the side of it where they live.
    lips: BTreeMap<usize, Side>,
}

impl<'a> Supports<'a> {
    /// Finds the nodes of all supports.
    ///
    /// # Errors
    /// A support that holds none, or names a lip needlessly.
    pub fn new(all: &'a [Support<'a>], mesh: &'a Mesh) -> Result<Self, SupportError> {
        let border = Border::new(mesh);
        let mut of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (number, support) in all.iter().enumerate() {
            let nodes = border.nodes(&support.on);
            if nodes.is_empty() {
                return Err(SupportError::Empty(number));
            }
            if support.lip.is_some() {
                let inside = |part| border.split(&support.on, border.corners(&part));
                if border
                    .parts(&support.on)
                    .into_iter()
                    .any(|part| !inside(part)[0].is_empty())
                {
                    return Err(SupportError::NeedlessLip(number));
                }
            }
            for node in nodes {
                of.entry(node).or_default().push(number);
            }
        }
        Ok(Supports {
            all,
            mesh,
            border,
            of,
        })
    }

    fn spec(&self, support: usize) -> &Support<'a> {
        &self.all[support]
    }

    fn of(&self, node: usize) -> &[usize] {
        self.of.get(&node).map_or(&[], Vec::as_slice)
    }

    fn components(&self, support: usize) -> Components {
        let components = self.spec(support).displacement.iter().enumerate();
        let stated = components.filter(|(_, amount)| amount.is_some());
        stated.fold(0, |bits, (a, _)| bits | 1 << a)
    }

    /// Supports that hold nodes of a part and whose sides hold all of it.
    fn acting(&self, part: &BorderPart) -> BTreeSet<usize> {
        let sides = self.border.sides_of(part);
        let all = self.border.nodes_of(part).flat_map(|n| self.of(n)).copied();
        all.filter(|&s| self.border.bits(&self.spec(s).on) & !sides == 0)
            .collect()
    }

    /// Components that supports on its side hold at all nodes of a part.
    fn at_all_nodes(&self, part: &BorderPart) -> Components {
        let sides = self.border.sides_of(part);
        let on_side = |&&s: &&usize| self.border.bits(&self.spec(s).on) & sides != 0;
        let at = |n: usize| {
            let own = self.of(n).iter().filter(on_side);
            own.fold(0, |bits, &s| bits | self.components(s))
        };
        self.border
            .nodes_of(part)
            .fold(Components::MAX, |bits, n| bits & at(n))
    }

    /// Places beside nodes on a crack, on the side of it where more components are held: there a node's own piece has to be, for
    /// only what its own copy prescribes can be held on another. None where both sides are alike.
    pub fn beside(&self, cracks: &[Crack]) -> BTreeMap<u32, Point> {
        type Found = [(Components, Point); 2];
        let on_crack = first_on(cracks);
        let crack_at = |node: usize| on_crack.get(&(node as u32)).map(|&k| &cracks[k]);
        // By node: what regions hold beside it, and what is held by nodes, below its first crack and above.
        let mut found: BTreeMap<usize, [Found; 2]> = BTreeMap::new();
        let near = |cell: usize| {
            self.mesh
                .cell(cell)
                .iter()
                .any(|&n| crack_at(n as usize).is_some())
        };
        for part in self.border.parts_where(near) {
            let corners = self.border.corners(&part);
            let middle = mean(&corners);
            let acting = self.acting(&part);
            for (node, x) in self.border.nodes_of(&part).zip(&corners) {
                let Some(crack) = crack_at(node) else {
                    continue;
                };
                let mut put = |kind: usize, bits: Components, place: Point| {
                    let sides = &mut found.entry(node).or_default()[kind];
                    let side = &mut sides[usize::from(crack.distance(&place) > 0.0)];
                    *side = (side.0 | bits, place);
                };
                for &s in &acting {
                    let inside = self.border.split(&self.spec(s).on, corners.clone());
                    let size = DELTA * diameter(&corners);
                    let near = |own: &&Vec<Point>| {
                        diameter(own) > size && own.iter().any(|p| norm(&sub(p, x)) <= size)
                    };
                    for own in inside[0].iter().filter(near) {
                        put(0, self.components(s), mean(own));
                    }
                }
                for &s in self.of(node) {
                    let lip = self.spec(s).lip;
                    if lip.is_some_and(|side| side * crack.distance(&middle) > 0.0) {
                        put(0, self.components(s), middle);
                    }
                }
                put(1, self.at_all_nodes(&part), middle);
            }
        }
        let chosen = |(node, [regions, nodes]): (usize, [Found; 2])| {
            let held = |[below, above]: &Found| below.0 | above.0 != 0;
            let [below, above] = if held(&regions) { regions } else { nodes };
            let place = match below.0.count_ones().cmp(&above.0.count_ones()) {
                std::cmp::Ordering::Less => above.1,
                std::cmp::Ordering::Greater => below.1,
                std::cmp::Ordering::Equal => return None,
            };
            Some((node as u32, place))
        };
        found.into_iter().filter_map(chosen).collect()
    }

    /// Prescribed unknowns by number (function-major). A later support wins.
    ///
    /// Under the closed form a piece function takes the value that interpolates both sides, and 0 beside a stated number; branch
    /// functions on what is held are 0, which leaves the interpolation of the standard ones; those whose ramp is zero there are
    /// free.
    ///
    /// # Errors
    /// A support that does not tell which lip of a crack it holds.
    pub fn prescribed(
        &self,
        integrator: &CellIntegrator<'_>,
    ) -> Result<BTreeMap<usize, Prescribed>, SupportError> {
        let dim = self.mesh.dim();
        let enrichment = integrator.enrichment;
        let mut held = self.held(integrator);
        let mut fixed = BTreeMap::new();
        for (&node, holders) in &self.of {
            let copies: Vec<usize> = enrichment.pieces_of(node).collect();
            let parted = !copies.is_empty() && enrichment.jumps_at(node);
            for &s in holders {
                self.choose_lip(s, parted.then_some(node), &copies, &mut held)?;
            }
            let last = |copy: usize, a: usize| {
                let states = |s: &usize| self.states(*s, a);
                if copy == node && !parted {
                    return holders.iter().copied().rfind(states);
                }
                held.by.get(&copy)?.iter().copied().rfind(states)
            };
            for a in 0..dim {
                let own = last(node, a);
                if let Some(support) = own {
                    fixed.insert(node * dim + a, self.stated(support, a, node));
                }
                for &copy in &copies {
                    let between = held
                        .between
                        .get(&copy)
                        .is_some_and(|bits| bits & 1 << a != 0);
                    match (last(copy, a), own) {
                        (Some(s), Some(own)) => {
                            fixed.insert(copy * dim + a, self.difference(s, own, a, node));
                        }
                        (None, Some(own)) if between => {
                            fixed.insert(copy * dim + a, self.difference(own, own, a, node));
                        }
                        // No unknown holds one copy alone where the node's own is free. In a corner of the body both are
                        // held, as without crack.
                        (Some(s), None) if parted => {
                            let mut by = held.by.get(&node).into_iter().flatten();
                            let bits = |s: usize| self.border.bits(&self.spec(s).on);
                            if by.any(|&other| bits(other) & bits(s) != 0) {
                                return Err(SupportError::OtherLip(s));
                            }
                            fixed.insert(node * dim + a, self.stated(s, a, node));
                            fixed.insert(copy * dim + a, self.difference(s, s, a, node));
                        }
                        _ => {}
                    }
                }
            }
        }
        for (&f, components) in &held.branches {
            let node = enrichment.functions[f].node as usize;
            for a in (0..dim).filter(|a| components & 1 << a != 0) {
                if let Some(&Prescribed { support, .. }) = fixed.get(&(node * dim + a)) {
                    fixed.insert(f * dim + a, at_rest(support));
                }
            }
        }
        hold_unguarded(integrator, &mut fixed);
        Ok(fixed)
    }

    /// Nodes that every support holds beside cracks.
    fn held(&self, integrator: &CellIntegrator<'_>) -> Held {
        let (mesh, cracks, enrichment) = (self.mesh, integrator.cracks, integrator.enrichment);
        let mut held = Held::default();
        let on_crack = first_on(cracks);
        // Also where a node's own copy lives: there none of its enriched functions need to.
        let is_enriched = |&n: &u32| !enrichment.enriched_of(n as usize).is_empty();
        for part in self
            .border
            .parts_where(|cell| mesh.cell(cell).iter().any(is_enriched))
        {
            let nodes: Vec<usize> = self.border.nodes_of(&part).collect();
            let acting = self.acting(&part);
            if nodes.iter().all(|&n| self.of(n).is_empty()) {
                continue;
            }
            let mut touched = false;
            // Components held on all pieces.
            let mut whole = Components::MAX;
            let pieces = pieces(mesh, cracks, enrichment, part.cell, &part.local);
            // Within bounds what a crack leaves of a part a hair beside a node is none.
            let bounded = acting.iter().any(|&s| self.spec(s).on.condition.is_some());
            let hair = DELTA * diameter(&self.border.corners(&part));
            for (piece, region) in &pieces {
                if bounded && diameter(piece) <= hair {
                    continue;
                }
                let mut on_piece = 0;
                for &s in &acting {
                    let [inside, outside] = self.border.split(&self.spec(s).on, piece.clone());
                    touched |= !inside.is_empty();
                    on_piece |= if outside.is_empty() {
                        self.components(s)
                    } else {
                        0
                    };
                    for &n in &nodes {
                        let near = |x: &Point| norm(&sub(x, &mesh.nodes[n])) <= hair;
                        let beside = || inside.iter().flatten().any(near);
                        if outside.is_empty() || beside() {
                            let copy = copy_at(enrichment, n, part.cell, *region);
                            held.by.entry(copy).or_default().insert(s);
                        }
                    }
                }
                whole &= on_piece;
                for &n in &nodes {
                    if let Some(&k) = on_crack.get(&(n as u32)) {
                        let crack = &cracks[k];
                        let side = crack.distance(&mean(piece)).signum();
                        held.lips
                            .insert(copy_at(enrichment, n, part.cell, *region), side);
                    }
                }
            }
            if !touched {
                whole = self.at_all_nodes(&part);
                for (n, (_, region)) in nodes
                    .iter()
                    .flat_map(|n| pieces.iter().map(move |p| (n, p)))
                {
                    let copy = copy_at(enrichment, *n, part.cell, *region);
                    *held.between.entry(copy).or_default() |= whole;
                }
            }
            let corners: Vec<u32> = nodes.iter().map(|&n| n as u32).collect();
            for &f in enrichment.cell(part.cell) {
                let function = &enrichment.functions[f as usize];
                // Where its ramp is zero a branch function holds nothing.
                let rises = |tip: u32| enrichment.ramp(tip as usize, &corners) != 0;
                let branch =
                    matches!(function.kind, FunctionKind::Branch { tip, .. } if rises(tip));
                if branch && nodes.contains(&(function.node as usize)) {
                    *held.branches.entry(f as usize).or_default() |= whole;
                }
            }
        }
        held
    }

    /// Settles which copies of a node on a crack a support holds that touches no side of it: those of the stated lip, or those
    /// that are held by their nodes. `parted`: the node, if it lies on a crack.
    fn choose_lip(
        &self,
        support: usize,
        parted: Option<usize>,
        copies: &[usize],
        held: &mut Held,
    ) -> Result<(), SupportError> {
        let all = || parted.iter().chain(copies).copied();
        let holds = |copy: usize| held.by.get(&copy).is_some_and(|by| by.contains(&support));
        if parted.is_none() || all().any(holds) {
            return Ok(());
        }
        let chosen: Vec<usize> = match &self.spec(support).lip {
            Some(lip) => all().filter(|c| held.lips.get(c) == Some(lip)).collect(),
            None => all()
                .filter(|c| held.between.get(c).is_some_and(|&bits| bits != 0))
                .collect(),
        };
        if chosen.is_empty() {
            return Err(SupportError::NoLip(support));
        }
        for copy in chosen {
            held.by.entry(copy).or_default().insert(support);
        }
        Ok(())
    }

    fn states(&self, support: usize, component: usize) -> bool {
        self.spec(support).displacement[component].is_some()
    }

    /// Displacement that a support states at a node [m]; `None`: the closed form, or nothing.
    fn amount(&self, support: usize, component: usize, node: usize) -> Option<f64> {
        match &self.spec(support).displacement[component] {
            Some(Amount::Stated(value)) => Some(value(&self.mesh.nodes[node])),
            Some(Amount::Exact) | None => None,
        }
    }

    /// An unknown that takes what a support states at a node.
    fn stated(&self, support: usize, component: usize, node: usize) -> Prescribed {
        Prescribed {
            support,
            amount: self.amount(support, component, node),
            less: None,
        }
    }

    /// The unknown of a copy that a support holds, another holding the node's own.
    fn difference(&self, support: usize, own: usize, component: usize, node: usize) -> Prescribed {
        match [support, own].map(|s| self.amount(s, component, node)) {
            [None, None] => self.stated(support, component, node),
            [Some(here), Some(there)] if support != own => Prescribed {
                support,
                amount: Some(here / STEP),
                less: Some((own, there / STEP)),
            },
            _ => at_rest(support),
        }
    }
}

/// An unknown that a support keeps at 0.
fn at_rest(support: usize) -> Prescribed {
    Prescribed {
        support,
        amount: Some(0.0),
        less: None,
    }
}

/// The copy of a node that lives in a region of a cell.
fn copy_at(enrichment: &Enrichment, node: usize, cell: usize, region: CellRegion) -> usize {
    let mut pieces = enrichment.pieces_of(node);
    pieces
        .find(|&f| enrichment.step((cell, region), f) != 0.0)
        .unwrap_or(node)
}

/// Holds wholly what supports hold in part and no multiplier can resist.
fn hold_unguarded(integrator: &CellIntegrator<'_>, fixed: &mut BTreeMap<usize, Prescribed>) {
    let dim = integrator.mesh.dim();
    let mut enriched = integrator.mesh.nodes.len()..integrator.enrichment.functions.len();
    let holder = |fixed: &BTreeMap<usize, Prescribed>, f: usize| {
        let mut components = (0..dim).map(|a| fixed.get(&(f * dim + a)));
        components.find_map(|held| held.copied())
    };
    let in_part = |f: usize| (0..dim).any(|a| !fixed.contains_key(&(f * dim + a)));
    if !enriched.any(|f| holder(fixed, f).is_some() && in_part(f)) {
        return;
    }
    for index in 0..integrator.cracks.len() {
        let free = FreeJumps::new(integrator, index, |i| fixed.contains_key(&i));
        for f in free.unguarded() {
            if let Some(held) = holder(fixed, f) {
                for a in 0..dim {
                    fixed.entry(f * dim + a).or_insert(at_rest(held.support));
                }
            }
        }
    }
}
