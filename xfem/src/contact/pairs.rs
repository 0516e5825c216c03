//! Contact points, the crack surface they stand for, and their jump operator.
//!
//! The jump at a point is a linear combination of the unknowns: of one place (edge pairs, doubled nodes) or a mean over a
//! part of the crack (integrated spaces). P is the force on side 1; the tributary length or area `weight` turns it into a
//! mean traction.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::geometry::{Point, add_scaled, cross, norm, sub};

use super::surface_point::SurfacePoint;

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
    /// Jump in the frame, component k = Σ row_k · (vector unknown of the function), as (function, rows).
    pub terms: Vec<(u32, [Point; 3])>,
}

impl ContactPoint {
    /// True if the normal jump depends on an unknown that is not prescribed; otherwise there is no contact to enforce.
    pub fn acts(&self, dim: usize, held: impl Fn(usize) -> bool) -> bool {
        let free = |f: u32, a: usize| !held(f as usize * dim + a);
        let mut terms = self.terms.iter();
        terms.any(|(f, rows)| (0..dim).any(|a| free(*f, a) && rows[0][a].abs() > 1e-12))
    }

    /// Order of the points of a crack: along it in 2D, by position in 3D.
    pub fn compare(&self, other: &Self) -> Ordering {
        self.s
            .total_cmp(&other.s)
            .then(self.x[2].total_cmp(&other.x[2]))
            .then(self.x[1].total_cmp(&other.x[1]))
            .then(self.x[0].total_cmp(&other.x[0]))
    }
}

/// Rows of scalar jumps: coefficient times frame.
pub fn scalar_terms(frame: &[Point; 3], terms: &[(u32, f64)]) -> Vec<(u32, [Point; 3])> {
    let rows = |c: f64| frame.map(|axis| axis.map(|v| c * v));
    terms.iter().map(|&(f, c)| (f, rows(c))).collect()
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

/// A corner of the facets of a crack, with the contact points that speak for it.
#[derive(Debug, Clone)]
pub struct SurfaceCorner {
    /// Position [m].
    pub x: Point,
    /// Contact points and their parts, which sum to one.
    pub shares: Vec<(u32, f64)>,
}

/// The faces of one or more cracks.
#[derive(Debug, Clone, Default)]
pub struct CrackSurface {
    /// Corners of the facets.
    pub corners: Vec<SurfaceCorner>,
    /// Facets by corner numbers: two (2D) or a polygon (3D).
    pub facets: Vec<Vec<usize>>,
    /// Quadrature points on the facets; none where the crack runs along cell facets.
    pub quadrature: Vec<SurfacePoint>,
}

/// Contact points of one or more cracks, and the crack surface they stand for.
#[derive(Debug, Clone, Default)]
pub struct ContactSurface {
    /// Points.
    pub points: Vec<ContactPoint>,
    /// Faces.
    pub surface: CrackSurface,
}

impl ContactSurface {
    /// A surface from points and facets whose vertices have keys; vertices without a point are left out.
    pub fn new<K: Ord>(mut points: Vec<(K, ContactPoint)>, facets: Vec<Vec<K>>) -> Self {
        points.sort_by(|(_, p), (_, q)| p.compare(q));
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
        let points: Vec<ContactPoint> = points.into_iter().map(|(_, point)| point).collect();
        let corners = points
            .iter()
            .enumerate()
            .map(|(i, point)| SurfaceCorner {
                x: point.x,
                shares: vec![(i as u32, 1.0)],
            })
            .collect();
        ContactSurface {
            points,
            surface: CrackSurface {
                corners,
                facets,
                quadrature: Vec::new(),
            },
        }
    }

    /// The surface of a crack along cell facets without the points that do not fulfil a condition; each corner there is a
    /// point.
    pub fn retain(self, keep: impl Fn(&ContactPoint) -> bool) -> Self {
        let faces = self.surface.facets;
        let kept = |(i, point): (usize, ContactPoint)| keep(&point).then_some((i, point));
        let points = self
            .points
            .into_iter()
            .enumerate()
            .filter_map(kept)
            .collect();
        ContactSurface::new(points, faces)
    }

    /// Adds another surface behind this one.
    pub fn append(&mut self, other: ContactSurface) {
        let (points, own) = (self.points.len() as u32, &mut self.surface);
        let corners = own.corners.len();
        let moved = |shares: Vec<(u32, f64)>| -> Vec<(u32, f64)> {
            shares.into_iter().map(|(k, v)| (k + points, v)).collect()
        };
        let CrackSurface {
            corners: further,
            facets,
            quadrature,
        } = other.surface;
        own.corners
            .extend(further.into_iter().map(|corner| SurfaceCorner {
                shares: moved(corner.shares),
                ..corner
            }));
        own.facets.extend(
            facets
                .into_iter()
                .map(|f| f.into_iter().map(|i| i + corners).collect()),
        );
        own.quadrature
            .extend(quadrature.into_iter().map(|q| SurfacePoint {
                shares: moved(q.shares),
                ..q
            }));
        self.points.extend(other.points);
    }
}

/// Rows of the jump operator over all unknowns: point by point (n, a[, b]), as (unknown, coefficient).
pub fn jump_rows(dim: usize, points: &[ContactPoint]) -> Vec<Vec<(usize, f64)>> {
    let mut rows = Vec::with_capacity(points.len() * dim);
    for point in points {
        for k in 0..dim {
            let mut row = Vec::with_capacity(point.terms.len() * dim);
            for (f, rows) in &point.terms {
                for (a, component) in rows[k].iter().enumerate().take(dim) {
                    if *component != 0.0 {
                        row.push((*f as usize * dim + a, *component));
                    }
                }
            }
            row.sort_by_key(|entry| entry.0);
            rows.push(row);
        }
    }
    rows
}
