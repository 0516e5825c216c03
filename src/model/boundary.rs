//! Regions and supports: from the words of a case to nodes and prescribed unknowns.

use std::collections::{BTreeMap, BTreeSet};

use stickslip_xfem::contact::free_jumps::FreeJumps;
use stickslip_xfem::cut::crack::{Crack, first_on};
use stickslip_xfem::enrichment::basis::FunctionKind;
use stickslip_xfem::enrichment::cell_facets::pieces;
use stickslip_xfem::geometry::{Point, add_scaled};
use stickslip_xfem::mesh::Mesh;
use stickslip_xfem::stiffness::cell_matrix::CellIntegrator;

use crate::case::{Amount, Case, Region};

/// A prescribed unknown: a number times the history factor of the support, or the value the closed form gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prescribed {
    /// Support number in the case.
    pub support: usize,
    /// Stated displacement [m]; 0 for enriched functions beside stated numbers.
    pub amount: Amount,
}

/// Nodes of a region, sorted.
pub fn region_nodes(integrator: &CellIntegrator<'_>, region: &Region) -> Vec<usize> {
    nodes_of(integrator.mesh, region)
}

fn nodes_of(mesh: &Mesh, region: &Region) -> Vec<usize> {
    let mut nodes = mesh.meeting_nodes(&region.sides);
    if let Some(condition) = &region.condition {
        nodes.retain(|&node| condition.holds(&mesh.nodes[node]));
    }
    nodes
}

/// Places beside nodes that lie on a crack and on a support, on the side of the crack where the facets that the support
/// holds are; none where it holds facets of both sides. The other side touches the support in a point, which holds nothing.
pub fn held_sides(case: &Case, mesh: &Mesh, cracks: &[Crack]) -> BTreeMap<u32, Point> {
    let on_crack = first_on(cracks);
    // By node: a facet below its first crack, and one above.
    let mut found: BTreeMap<u32, [Option<Point>; 2]> = BTreeMap::new();
    for support in &case.supports {
        let held: BTreeSet<usize> = nodes_of(mesh, &support.on).into_iter().collect();
        let sides = support.on.sides.iter();
        for &facet in sides.flat_map(|side| mesh.sides.get(side).into_iter().flatten()) {
            let nodes: Vec<usize> = mesh.facet_nodes(facet).collect();
            if !nodes.iter().all(|n| held.contains(n)) {
                continue;
            }
            let part = 1.0 / nodes.len() as f64;
            let centre = nodes
                .iter()
                .fold([0.0; 3], |sum, &n| add_scaled(&sum, part, &mesh.nodes[n]));
            for &node in &nodes {
                if let Some(crack) = on_crack.get(&(node as u32)).map(|&k| &cracks[k]) {
                    let above = crack.distance(&centre) > 0.0;
                    found.entry(node as u32).or_default()[usize::from(above)] = Some(centre);
                }
            }
        }
    }
    let of_one_side = |(node, sides): (u32, [Option<Point>; 2])| match sides {
        [Some(place), None] | [None, Some(place)] => Some((node, place)),
        _ => None,
    };
    found.into_iter().filter_map(of_one_side).collect()
}

/// Name of a region in the tables: its sides joined by `+`.
pub fn region_name(region: &Region) -> String {
    region.sides.join("+")
}

/// Prescribed unknowns of all supports by unknown number (function-major). A later support wins.
///
/// A facet supported as a whole has its displacement prescribed on both sides of a crack: the enriched functions that do
/// not vanish on it are fixed too. They are 0 where a number is stated. Under the closed form a piece function takes the
/// value that interpolates both sides; branch functions are 0, which leaves the interpolation of the standard ones.
pub fn prescribed(case: &Case, integrator: &CellIntegrator<'_>) -> BTreeMap<usize, Prescribed> {
    let mesh = integrator.mesh;
    let dim = mesh.dim();
    let mut fixed = BTreeMap::new();
    for (number, support) in case.supports.iter().enumerate() {
        let nodes = region_nodes(integrator, &support.on);
        let mut fix = |function: usize, amount_of: &dyn Fn(Amount) -> Amount| {
            for (component, amount) in support.displacement.iter().enumerate() {
                if let Some(amount) = *amount {
                    let value = Prescribed {
                        support: number,
                        amount: amount_of(amount),
                    };
                    fixed.insert(function * dim + component, value);
                }
            }
        };
        for &node in &nodes {
            fix(node, &|amount| amount);
        }
        let held: BTreeSet<usize> = nodes.into_iter().collect();
        let supported = |nodes: &[usize]| nodes.iter().all(|n| held.contains(n));
        for side in &support.on.sides {
            for &facet in mesh.sides.get(side).into_iter().flatten() {
                let local = mesh.kind.facets()[facet.local];
                // In 3D a support may hold only an edge of the facet.
                let edges = (0..local.len()).map(|i| vec![local[i], local[(i + 1) % local.len()]]);
                for part in std::iter::once(local.to_vec()).chain(edges) {
                    let part_nodes: Vec<usize> = part
                        .iter()
                        .map(|&i| mesh.cell(facet.cell)[i] as usize)
                        .collect();
                    if !supported(&part_nodes) {
                        continue;
                    }
                    for f in enriched_on(integrator, facet.cell, &part) {
                        let kind = integrator.enrichment.functions[f].kind;
                        let jumps = matches!(kind, FunctionKind::Piece { .. });
                        fix(f, &|amount| match amount {
                            Amount::Exact if jumps => Amount::Exact,
                            _ => Amount::Number(0.0),
                        });
                    }
                }
            }
        }
    }
    hold_unguarded(integrator, &mut fixed);
    fixed
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
                    fixed.entry(f * dim + a).or_insert(Prescribed {
                        support: held.support,
                        amount: Amount::Number(0.0),
                    });
                }
            }
        }
    }
}

/// Enriched functions of some nodes of a cell that do not vanish between them.
fn enriched_on(integrator: &CellIntegrator<'_>, cell: usize, local: &[usize]) -> Vec<usize> {
    let CellIntegrator {
        mesh, enrichment, ..
    } = integrator;
    let nodes: Vec<u32> = local.iter().map(|&i| mesh.cell(cell)[i]).collect();
    let functions = enrichment.cell(cell);
    let steps = enrichment.steps(cell);
    let regions: Vec<usize> = pieces(mesh, integrator.cracks, enrichment, cell, local)
        .into_iter()
        .map(|(_, region)| region)
        .collect();
    let lives = |i: usize, f: u32| match enrichment.functions[f as usize].kind {
        FunctionKind::Standard => false,
        FunctionKind::Branch { .. } => true,
        // Its piece holds some of the part.
        FunctionKind::Piece { .. } => regions
            .iter()
            .any(|r| steps[r * functions.len() + i] != 0.0),
    };
    functions
        .iter()
        .enumerate()
        .filter(|&(i, &f)| nodes.contains(&enrichment.functions[f as usize].node) && lives(i, f))
        .map(|(_, &f)| f as usize)
        .collect()
}
