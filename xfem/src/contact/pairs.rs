//! Contact points, the crack surface they stand for, and their jump operator.
//!
//! The jump at a point is a linear combination of the unknowns: of one place (edge pairs, doubled nodes) or a mean over a
//! part of the crack (integrated spaces). P is the force on side 1; the tributary length or area `weight` turns it into a
//! mean traction.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::cut::crack::Crack;
use crate::geometry::{Point, cross, mean, norm, sub};

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
    /// A place on a crack where the jump is a sum of functions times coefficients.
    pub fn of(crack: &Crack, x: Point, weight: f64, jump: &[(u32, f64)]) -> Self {
        let frame = crack.frame(&x);
        let rows = |c: f64| frame.map(|axis| axis.map(|v| c * v));
        ContactPoint {
            crack: crack.number,
            x,
            s: crack.abscissa(&x),
            frame,
            weight,
            terms: jump.iter().map(|&(f, c)| (f, rows(c))).collect(),
        }
    }

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

/// Splits the measure of a facet among its vertices: half of each triangle (centroid, v_i, v_{i+1}) to either vertex.
pub fn vertex_weights(vertices: &[Point]) -> Vec<f64> {
    let n = vertices.len();
    if n == 2 {
        return vec![0.5 * norm(&sub(&vertices[1], &vertices[0])); 2];
    }
    let centre = mean(vertices);
    let mut weights = vec![0.0; n];
    for i in 0..n {
        let j = (i + 1) % n;
        let [p, q] = [i, j].map(|k| sub(&vertices[k], &centre));
        let area = 0.5 * norm(&cross(&p, &q));
        weights[i] += 0.5 * area;
        weights[j] += 0.5 * area;
    }
    weights
}

impl SurfacePoint {
    /// Contact traction λ_h on side 1 in the local frame [Pa]; `p`: contact forces, `dim` per point.
    pub fn traction(&self, dim: usize, points: &[ContactPoint], p: &[f64]) -> [f64; 3] {
        let mut traction = [0.0; 3];
        for &(point, share) in &self.shares {
            let i = point as usize;
            for (t, force) in traction.iter_mut().zip(&p[i * dim..(i + 1) * dim]) {
                *t += share * force / points[i].weight;
            }
        }
        traction
    }
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

impl CrackSurface {
    /// Gives the contact points other numbers; parts of points that become one are summed.
    pub fn renumber(&mut self, number: impl Fn(u32) -> u32) {
        let corners = self.corners.iter_mut().map(|corner| &mut corner.shares);
        let quadrature = self.quadrature.iter_mut().map(|q| &mut q.shares);
        for shares in corners.chain(quadrature) {
            let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
            for &(k, share) in shares.iter() {
                *sum.entry(number(k)).or_default() += share;
            }
            *shares = sum.into_iter().collect();
        }
    }
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
        let numbers = points.iter().enumerate().map(|(i, (key, _))| (key, i));
        let number: BTreeMap<&K, usize> = numbers.collect();
        let known = |key: &K| number.get(key).copied();
        let facets = facets
            .iter()
            .map(|facet| facet.iter().filter_map(known).collect())
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
        let points = self.points.into_iter().enumerate();
        let kept = points.filter(|(_, point)| keep(point)).collect();
        ContactSurface::new(kept, faces)
    }

    /// Adds another surface behind this one.
    pub fn append(&mut self, mut other: ContactSurface) {
        let (points, corners) = (self.points.len() as u32, self.surface.corners.len());
        other.surface.renumber(|k| k + points);
        self.points.extend(other.points);
        let (own, other) = (&mut self.surface, other.surface);
        own.corners.extend(other.corners);
        let facets = other.facets.into_iter();
        let moved = facets.map(|f| f.into_iter().map(|i| i + corners).collect());
        own.facets.extend(moved);
        own.quadrature.extend(other.quadrature);
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
