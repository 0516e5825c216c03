//! The crack surface inside the cut cells: polygons (2D: segments) whose corners lie on mesh edges, at nodes or inside cells.

use std::collections::BTreeMap;

use crate::fem::mesh::Mesh;
use crate::fem::{Point, add_scaled, norm, sub};

use super::crack::Crack;
use super::cut;
use super::enrichment::Enrichment;

/// Corner of facets.
#[derive(Debug, Clone, Copy)]
pub struct Corner {
    /// Position [m].
    pub x: Point,
    /// Ends of the mesh edge it lies on, lower number first; equal at a node; `None` inside a cell.
    pub nodes: Option<[u32; 2]>,
}

/// The part of a crack inside one cell.
#[derive(Debug, Clone)]
pub struct Facet {
    /// Cell.
    pub cell: usize,
    /// Corners: two (2D) or a convex polygon in cyclic order.
    pub corners: Vec<usize>,
}

/// All facets of one crack.
#[derive(Debug, Clone, Default)]
pub struct CrackFacets {
    /// Corners, those on mesh edges shared between cells.
    pub corners: Vec<Corner>,
    /// Facets in the order of their cells.
    pub facets: Vec<Facet>,
}

impl CrackFacets {
    /// Facets of the `index`-th crack of the enrichment, up to its tips.
    pub fn new(mesh: &Mesh, index: usize, crack: &Crack, enrichment: &Enrichment) -> Self {
        let mut found = CrackFacets::default();
        let mut number: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for cell in 0..mesh.cell_count() {
            if enrichment.split[cell] != Some(index as u32) {
                continue;
            }
            let corners = mesh.corners(cell);
            let nodes = mesh.cell(cell);
            let phi = crack.cell_phi(mesh, cell);
            let facet = cut::facet(mesh.kind, &corners[..mesh.kind.nodes()], &phi);
            let polygon: Vec<Corner> = facet
                .iter()
                .map(|&(x, [i, j])| Corner {
                    x,
                    nodes: Some([nodes[i].min(nodes[j]), nodes[i].max(nodes[j])]),
                })
                .collect();
            let tolerance = 1e-9 * norm(&sub(&corners[0], &corners[2]));
            let inside = within(crack, &polygon, tolerance);
            if inside.len() < mesh.dim() {
                continue;
            }
            let corners = inside
                .into_iter()
                .map(|corner| {
                    let fresh = found.corners.len();
                    let known = corner.nodes.map(|key| *number.entry(key).or_insert(fresh));
                    let position = known.unwrap_or(fresh);
                    if position == fresh {
                        found.corners.push(corner);
                    }
                    position
                })
                .collect();
            found.facets.push(Facet { cell, corners });
        }
        found
    }

    /// Positions of the corners of a facet.
    pub fn polygon(&self, facet: &Facet) -> Vec<Point> {
        facet.corners.iter().map(|&c| self.corners[c].x).collect()
    }
}

/// The part of a facet between the ends of a 2D crack; its new corners are the tips.
fn within(crack: &Crack, polygon: &[Corner], tolerance: f64) -> Vec<Corner> {
    if crack.length.is_infinite() || polygon.len() != 2 {
        return polygon.to_vec();
    }
    let s: Vec<f64> = polygon.iter().map(|c| crack.abscissa(&c.x)).collect();
    let cut_off = |i: usize| {
        let end = s[i].clamp(0.0, crack.length);
        if (s[i] - end).abs() <= tolerance {
            return polygon[i];
        }
        Corner {
            x: add_scaled(&crack.origin, end, &crack.frame[1]),
            nodes: None,
        }
    };
    let (a, b) = (cut_off(0), cut_off(1));
    if norm(&sub(&a.x, &b.x)) <= tolerance {
        return Vec::new();
    }
    vec![a, b]
}
