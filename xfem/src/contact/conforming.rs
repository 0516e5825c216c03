//! A crack of cell facets, by name only: doubled nodes, one contact point per pair. The founding paper's Model II.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::crack::{Crack, Geometry};
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
    let cut =
        |cell: &usize| is_split(&crack.cell_phi(mesh, *cell)) && centre_on(mesh, crack, *cell);
    if let Some(&cell) = crack.cells().iter().find(|cell| cut(cell)) {
        return Err(off(mesh.centre(cell)));
    }
    // A node has one frame: a bend is no place for a pair.
    let mut bends = crack
        .path
        .iter()
        .skip(1)
        .take(crack.path.len().saturating_sub(2));
    let mut ends = ends_inside(mesh, crack).into_iter().map(|end| end.1);
    let loose = bends
        .next()
        .map(|v| v.x)
        .or_else(|| ends.find(|x| mesh.node_at(x).is_none()));
    if let Some(x) = loose {
        return Err(off(x));
    }
    let facets = crack_facets(mesh, crack);
    if let Geometry::Ellipse(Ellipse { centre, .. }) = crack.geometry {
        return Err(off(centre));
    }
    if facets.is_empty() {
        return Err(EnrichmentError::Outside {
            crack: crack.number,
        });
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
        .map(|&facet| mesh.facet_nodes(facet).collect())
        .collect();
    let surface = ContactSurface::new(points, faces);
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

/// Facets of side-2 cells on the crack that a side-1 cell shares.
fn crack_facets(mesh: &Mesh, crack: &Crack) -> Vec<Facet> {
    let mut upper: BTreeSet<Vec<usize>> = BTreeSet::new();
    let mut lower: Vec<(Vec<usize>, Facet)> = Vec::new();
    for &cell in crack.cells() {
        let phi = crack.cell_phi(mesh, cell);
        if phi.iter().filter(|&&f| f == 0.0).count() < mesh.dim() {
            continue;
        }
        for (local, nodes) in mesh.kind.facets().iter().enumerate() {
            let facet = Facet { cell, local };
            if nodes.iter().any(|&i| phi[i] != 0.0) || !within(mesh, crack, facet) {
                continue;
            }
            let mut key: Vec<usize> = mesh.facet_nodes(facet).collect();
            key.sort_unstable();
            if crack.distance(&mesh.centre(cell)) > 0.0 {
                upper.insert(key);
            } else {
                lower.push((key, facet));
            }
        }
    }
    lower.retain(|(key, _)| upper.contains(key));
    lower.into_iter().map(|(_, facet)| facet).collect()
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
    let facet = crack.crossings(&map, &crack.cell_phi(mesh, cell));
    let off = |x: &Point| crack.distance(x).abs() >= 1e-6 * map.diagonal();
    let middle = mean(facet.iter().map(|v| &v.0));
    !facet.iter().any(|v| off(&v.0)) && crack.jumps_at(&middle, 0.0)
}
