//! A crack of cell facets, by name only: doubled nodes, one contact point per pair. The founding paper's Model II.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::crack::{Crack, Geometry, crossings};
use crate::cut::is_split;
use crate::cut::placement::ends_inside;
use crate::enrichment::EnrichmentError;
use crate::geometry::ellipse::Ellipse;
use crate::geometry::{Point, mean};
use crate::mesh::{Facet, Mesh};

use super::pairs::{ContactPoint, ContactSurface, vertex_weights};

/// Splits the mesh along a crack of facets, from node to node or to the border, and returns its contact surface. Side 1 gets
/// the new nodes.
///
/// The standard function of a node has the node's number, so the points' terms name nodes.
///
/// # Errors
/// A crack that runs through a cell, or ends between nodes.
pub fn split(mesh: &mut Mesh, crack: &Crack) -> Result<ContactSurface, EnrichmentError> {
    let off = |at: Point| EnrichmentError::OffFacets {
        crack: crack.number,
        at,
    };
    // A node has one frame: a bend is no place for a pair.
    let bends = crack.path.windows(3).map(|w| w[1].x);
    let ends = ends_inside(mesh, crack).into_iter().map(|end| end.1);
    let mut loose = bends.chain(ends.filter(|x| mesh.node_at(x).is_none()));
    if let Some(x) = loose.next() {
        return Err(off(x));
    }
    let cut =
        |cell: &usize| is_split(&crack.cell_phi(mesh, *cell)) && centre_on(mesh, crack, *cell);
    if let Some(&cell) = crack.cells().iter().find(|cell| cut(cell)) {
        return Err(off(mesh.centre(cell)));
    }
    let facets = crack_facets(mesh, crack);
    if let Geometry::Ellipse(Ellipse { centre, .. }) = crack.geometry {
        return Err(off(centre));
    }
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

/// Facets of side-2 cells on the crack that a side-1 cell shares: those not on the border.
fn crack_facets(mesh: &Mesh, crack: &Crack) -> Vec<Facet> {
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
        found.extend(on.filter(|f| within(mesh, crack, *f) && !on_border(f)));
    }
    found
}

/// True if a facet on the crack's curve or plane lies between its ends.
fn within(mesh: &Mesh, crack: &Crack, facet: Facet) -> bool {
    let tolerance = 1e-9 * mesh.map(facet.cell).diagonal();
    mesh.facet_nodes(facet)
        .all(|node| crack.jumps_at(&mesh.nodes[node], -tolerance))
}

/// True if the crack inside a split cell has its middle between the ends of the crack.
fn centre_on(mesh: &Mesh, crack: &Crack, cell: usize) -> bool {
    let map = mesh.map(cell);
    let facet = crossings(&map, &crack.cell_phi(mesh, cell));
    let off = |x: &Point| crack.distance(x).abs() >= 1e-6 * map.diagonal();
    let middle = mean(facet.iter().map(|v| &v.0));
    !facet.iter().any(|v| off(&v.0)) && crack.jumps_at(&middle, 0.0)
}
