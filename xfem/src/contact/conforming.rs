//! A crack of cell facets, by name only: doubled nodes, one contact point per pair. The founding paper's Model II.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::arrangement::Arrangement;
use crate::cut::crack::{Crack, Geometry};
use crate::cut::is_split;
use crate::enrichment::EnrichmentError;
use crate::geometry::Point;
use crate::geometry::ellipse::Ellipse;
use crate::mesh::{Facet, Mesh};

use super::pairs::{ContactPoint, ContactSurface, vertex_weights};

/// Splits the mesh along a crack of facets, from node to node or to the border, and returns its contact surface. Side 1 gets
/// the new nodes. `arms`: the crack as it is arranged.
///
/// The standard function of a node has the node's number, so the points' terms name nodes.
///
/// # Errors
/// A crack that runs through a cell, or ends between nodes.
pub fn split(
    mesh: &mut Mesh,
    arms: &[Crack],
    arrangement: &Arrangement,
) -> Result<ContactSurface, EnrichmentError> {
    let crack = &arms[0];
    let off = |at: Point| EnrichmentError::OffFacets {
        crack: crack.number,
        at,
    };
    // A node has one frame: a bend is no place for a pair.
    let bends = arms.iter().skip(1).map(|arm| arm.path[0].x);
    let bends = bends.chain(crack.path.windows(3).map(|w| w[1].x));
    let ends = arrangement.tips.iter().map(|tip| tip.x);
    let mut loose = bends.chain(ends.filter(|x| !mesh.nodes.contains(x)));
    if let Some(x) = loose.next() {
        return Err(off(x));
    }
    let facets = match mesh.dim() {
        2 => edges_along(mesh, arrangement).map_err(off)?,
        _ => faces_along(mesh, crack).map_err(off)?,
    };
    if facets.is_empty() {
        return Err(EnrichmentError::Outside(crack.number));
    }
    let mut weight: BTreeMap<usize, f64> = BTreeMap::new();
    let mut uses: BTreeMap<usize, usize> = BTreeMap::new();
    for &facet in &facets {
        let nodes: Vec<usize> = mesh.facet_nodes(facet).collect();
        let positions: Vec<Point> = nodes.iter().map(|&n| mesh.nodes[n]).collect();
        for (node, w) in nodes.into_iter().zip(vertex_weights(&positions)) {
            *weight.entry(node).or_default() += w;
            *uses.entry(node).or_default() += 1;
        }
    }
    // The crack front keeps its nodes: in 2D a node with one crack edge, unless the crack leaves the body there.
    let border: BTreeSet<usize> = mesh
        .sides
        .keys()
        .flat_map(|side| mesh.side_nodes(side))
        .collect();
    let doubled = |node: usize| mesh.dim() == 3 || uses[&node] > 1 || border.contains(&node);
    let nodes: Vec<usize> = weight.keys().copied().filter(|&n| doubled(n)).collect();
    let mut twin = BTreeMap::new();
    let mut points = Vec::new();
    for node in nodes {
        let new = mesh.nodes.len();
        mesh.nodes.push(mesh.nodes[node]);
        mesh.grid.push(mesh.grid[node]);
        twin.insert(node as u32, new as u32);
        let x = mesh.nodes[node];
        let terms = [(new as u32, 1.0), (node as u32, -1.0)];
        points.push((node, ContactPoint::of(crack, x, weight[&node], &terms)));
    }
    let faces = facets
        .iter()
        .map(|&facet| mesh.facet_nodes(facet).collect());
    let surface = ContactSurface::new(points, faces.collect());
    for &cell in crack.cells() {
        if crack.distance(&mesh.centre(cell)) > 0.0 {
            for node in mesh.cell_mut(cell) {
                if let Some(&new) = twin.get(node) {
                    *node = new;
                }
            }
        }
    }
    Ok(surface)
}

/// Edges of side-2 cells along a plane crack; where it runs through a cell instead.
fn edges_along(mesh: &Mesh, arrangement: &Arrangement) -> Result<Vec<Facet>, Point> {
    let mut found = Vec::new();
    for (&cell, chains) in &arrangement.chains {
        for chain in chains {
            let Some((edge, cell)) = chain.along else {
                return Err(mesh.centre(cell));
            };
            let nodes = mesh.cell(cell);
            let facets = mesh.kind.facets().iter();
            let local = facets
                .enumerate()
                .filter(|(_, own)| own.iter().all(|&i| edge.contains(&nodes[i])));
            found.extend(local.map(|(local, _)| Facet { cell, local }));
        }
    }
    Ok(found)
}

/// Facets of side-2 cells on a plane that a side-1 cell shares: those not on the border; where it runs through a cell instead.
fn faces_along(mesh: &Mesh, crack: &Crack) -> Result<Vec<Facet>, Point> {
    if let Geometry::Ellipse(Ellipse { centre, .. }) = crack.geometry {
        return Err(centre);
    }
    let cut = |cell: &&usize| is_split(&crack.cell_phi(mesh, **cell));
    if let Some(&cell) = crack.cells().iter().find(cut) {
        return Err(mesh.centre(cell));
    }
    let on_border = |facet: &Facet| mesh.sides.values().flatten().any(|b| b == facet);
    let mut found = Vec::new();
    for &cell in crack.cells() {
        if crack.distance(&mesh.centre(cell)) > 0.0 {
            continue;
        }
        let phi = crack.cell_phi(mesh, cell);
        let facets = mesh.kind.facets().iter().enumerate();
        let on = facets.filter(|(_, nodes)| nodes.iter().all(|&i| phi[i] == 0.0));
        let on = on.map(|(local, _)| Facet { cell, local });
        found.extend(on.filter(|facet| !on_border(facet)));
    }
    Ok(found)
}
