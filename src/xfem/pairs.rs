//! Contact points and their jump operator.
//!
//! One point per crossed mesh edge (the founding paper's pairs), merged at a node the crack runs through; or one per
//! doubled node. The jump at a point is a combination of functions with scalar coefficients,
//!
//! ```text
//!   [[u]](x_c) = 2 Σ N_j(x_c) b_j + 2 √r Σ N_k(x_c) c_k1      (paper, Eq. 14)      or      u₁ − u₂ of the two nodes
//! ```
//!
//! so the rows of B are frame vectors times coefficients. P is a point force on side 1; the tributary length or area
//! `weight` turns it into a mean traction.

use std::collections::BTreeMap;

use crate::fem::mesh::Mesh;
use crate::fem::{Point, add_scaled, cross, norm, sub};

use super::basis::FunctionKind;
use super::crack::Crack;
use super::cut;
use super::enrichment::Enrichment;

/// A point closer to a tip than this, in units of the shortest edge at its nodes, is at the tip: the branch function jumps
/// by 2 √r there, and a force that has to act through a jump this small grows like r^−½ without meaning anything.
const AT_TIP: f64 = 1e-3;

/// A contact point.
#[derive(Debug, Clone)]
pub struct ContactPoint {
    /// Crack number, from 0, in the case file.
    pub crack: usize,
    /// Position [m].
    pub x: Point,
    /// Abscissa along a 2D crack; 0 in 3D [m].
    pub s: f64,
    /// Local frame n, a, b.
    pub frame: [Point; 3],
    /// Tributary length [m] or area [m²].
    pub weight: f64,
    /// Jump = Σ coefficient × value of the function.
    pub terms: Vec<(u32, f64)>,
}

/// Splits the measure of a facet among its vertices: half of each triangle (centroid, v_i, v_{i+1}) to either vertex.
pub fn vertex_weights(vertices: &[Point]) -> Vec<f64> {
    let n = vertices.len();
    if n == 2 {
        return vec![0.5 * norm(&sub(&vertices[1], &vertices[0])); 2];
    }
    let mut centre = [0.0; 3];
    for v in vertices {
        centre = add_scaled(&centre, 1.0 / n as f64, v);
    }
    let mut weights = vec![0.0; n];
    for i in 0..n {
        let j = (i + 1) % n;
        let area = 0.5
            * norm(&cross(
                &sub(&vertices[i], &centre),
                &sub(&vertices[j], &centre),
            ));
        weights[i] += 0.5 * area;
        weights[j] += 0.5 * area;
    }
    weights
}

/// Contact points of one or more cracks and the facets of the crack surface between them.
#[derive(Debug, Clone, Default)]
pub struct ContactSurface {
    /// Points.
    pub points: Vec<ContactPoint>,
    /// Facets by point numbers: two points (2D) or a polygon (3D).
    pub facets: Vec<Vec<usize>>,
}

impl ContactSurface {
    /// A surface from points and facets whose vertices have keys; vertices without a point are left out.
    pub fn new<K: Ord>(mut points: Vec<(K, ContactPoint)>, facets: Vec<Vec<K>>) -> Self {
        // Along a 2D crack, by position in 3D.
        points.sort_by(|(_, p), (_, q)| {
            p.s.total_cmp(&q.s)
                .then(p.x[2].total_cmp(&q.x[2]))
                .then(p.x[1].total_cmp(&q.x[1]))
                .then(p.x[0].total_cmp(&q.x[0]))
        });
        let number: BTreeMap<&K, usize> = points
            .iter()
            .enumerate()
            .map(|(i, (key, _))| (key, i))
            .collect();
        let facets = facets
            .iter()
            .map(|facet| {
                facet
                    .iter()
                    .filter_map(|key| number.get(key).copied())
                    .collect()
            })
            .collect();
        ContactSurface {
            facets,
            points: points.into_iter().map(|(_, point)| point).collect(),
        }
    }

    /// Adds another surface behind this one.
    pub fn append(&mut self, other: ContactSurface) {
        let shift = self.points.len();
        self.points.extend(other.points);
        let moved = other.facets.into_iter();
        self.facets
            .extend(moved.map(|f| f.into_iter().map(|i| i + shift).collect()));
    }

    /// Keeps the points that fulfil a condition.
    pub fn retain(&mut self, keep: impl Fn(&ContactPoint) -> bool) {
        let mut number = Vec::with_capacity(self.points.len());
        let mut count = 0;
        for point in &self.points {
            let kept = keep(point);
            number.push(kept.then_some(count));
            count += usize::from(kept);
        }
        self.points.retain(keep);
        for facet in &mut self.facets {
            *facet = facet.iter().filter_map(|&i| number[i]).collect();
        }
    }
}

/// Rows of the jump operator over all unknowns: point by point (n, a[, b]), as (unknown, coefficient).
pub fn jump_rows(dim: usize, points: &[ContactPoint]) -> Vec<Vec<(usize, f64)>> {
    let mut rows = Vec::with_capacity(points.len() * dim);
    for point in points {
        for axis in &point.frame[..dim] {
            let mut row = Vec::with_capacity(point.terms.len() * dim);
            for &(f, c) in &point.terms {
                for (a, component) in axis.iter().enumerate().take(dim) {
                    if *component != 0.0 {
                        row.push((f as usize * dim + a, c * component));
                    }
                }
            }
            row.sort_by_key(|entry| entry.0);
            rows.push(row);
        }
    }
    rows
}

/// Contact surface of a crack through cells: the `index`-th of the enrichment.
pub fn edge_pairs(
    mesh: &Mesh,
    index: usize,
    crack: &Crack,
    enrichment: &Enrichment,
) -> ContactSurface {
    let sizes = mesh.node_sizes();
    let mut found: BTreeMap<[u32; 2], ContactPoint> = BTreeMap::new();
    let mut facets = Vec::new();
    for cell in 0..mesh.cell_count() {
        if enrichment.split[cell] != Some(index as u32) {
            continue;
        }
        let corners = mesh.corners(cell);
        let nodes = mesh.cell(cell);
        let phi = crack.cell_phi(mesh, cell);
        let facet = cut::facet(mesh.kind, &corners[..mesh.kind.nodes()], &phi);
        let mut kept = Vec::with_capacity(facet.len());
        let mut lost = 0.0;
        for (x, [i, j], weight) in weighted_vertices(crack, &facet, &corners) {
            let (a, b) = (nodes[i], nodes[j]);
            let key = [a.min(b), a.max(b)];
            let at_tip = AT_TIP * sizes[a as usize].min(sizes[b as usize]);
            let terms = jump_terms(index, crack, enrichment, key, &x, at_tip);
            if terms.is_empty() {
                lost += weight;
                continue;
            }
            found.entry(key).or_insert_with(|| ContactPoint {
                crack: crack.number,
                x,
                s: if mesh.dim() == 2 {
                    crack.abscissa(&x)
                } else {
                    0.0
                },
                frame: crack.frame,
                weight: 0.0,
                terms,
            });
            kept.push((key, weight));
        }
        // What belongs to a vertex without a point is carried by the others of its facet.
        let share = lost / kept.len().max(1) as f64;
        for (key, weight) in &kept {
            if let Some(point) = found.get_mut(key) {
                point.weight += weight + share;
            }
        }
        facets.push(kept.into_iter().map(|(key, _)| key).collect());
    }
    ContactSurface::new(found.into_iter().collect(), facets)
}

/// Vertices of a facet that carry a point, with their share of the facet inside the crack.
fn weighted_vertices(
    crack: &Crack,
    facet: &[(Point, [usize; 2])],
    corners: &[Point; 8],
) -> Vec<(Point, [usize; 2], f64)> {
    let positions: Vec<Point> = facet.iter().map(|v| v.0).collect();
    if crack.length.is_infinite() {
        let weights = vertex_weights(&positions);
        return facet
            .iter()
            .zip(weights)
            .map(|(v, w)| (v.0, v.1, w))
            .collect();
    }
    // A vertex at a tip has no jump; beyond it there is no crack. The rest of a tip cell's segment goes to the entry.
    let tolerance = 1e-9 * norm(&sub(&corners[0], &corners[2]));
    let s: Vec<f64> = positions.iter().map(|x| crack.abscissa(x)).collect();
    let (low, high) = s
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| {
            (l.min(v), h.max(v))
        });
    let length = (high.min(crack.length) - low.max(0.0)).max(0.0);
    let inside: Vec<usize> = (0..facet.len())
        .filter(|&i| s[i] >= -tolerance && s[i] <= crack.length + tolerance)
        .collect();
    inside
        .iter()
        .map(|&i| (facet[i].0, facet[i].1, length / inside.len() as f64))
        .collect()
}

/// Coefficients of the functions that jump at a point between two nodes (equal: at the node); a point closer than
/// `at_tip` to a tip lies at the tip.
fn jump_terms(
    index: usize,
    crack: &Crack,
    enrichment: &Enrichment,
    nodes: [u32; 2],
    x: &Point,
    at_tip: f64,
) -> Vec<(u32, f64)> {
    let [i, j] = nodes.map(|n| n as usize);
    let shares = if i == j {
        vec![(i, 1.0)]
    } else {
        // N_i = |φ_j| / (|φ_i| + |φ_j|) on the edge
        let (fi, fj) = (crack.phi[i].abs(), crack.phi[j].abs());
        vec![(i, fj / (fi + fj)), (j, fi / (fi + fj))]
    };
    let mut terms = Vec::new();
    for (node, share) in shares {
        for f in enrichment.enriched_of(node) {
            let coefficient = match enrichment.functions[f].kind {
                FunctionKind::Heaviside { crack } if crack as usize == index => 2.0 * share,
                FunctionKind::Branch { tip, order: 0 }
                    if enrichment.tips[tip as usize].crack == index =>
                {
                    // At the tip nothing jumps; rounding in r must not make a pair with a coefficient of 1e-8.
                    let r = norm(&sub(x, &enrichment.tips[tip as usize].position));
                    if r > at_tip {
                        2.0 * r.sqrt() * share
                    } else {
                        0.0
                    }
                }
                _ => 0.0,
            };
            if coefficient > 0.0 {
                terms.push((f as u32, coefficient));
            }
        }
    }
    terms
}
