//! Crack geometry and level sets: straight cracks in 2D, planes through the body in 3D.
//!
//! ```text
//!   φ(x) = n · (x − x₁)   signed distance, side 1 is φ >= 0 (H = +1)
//!   s(x) = a · (x − x₁)   abscissa along a 2D crack; the crack is φ = 0, 0 <= s <= L
//!
//!   2D: a = (x₂ − x₁)/L, n = a turned by +90°        3D: (n, a, b) right-handed, a from the axis least along n
//! ```

use crate::fem::mesh::Mesh;
use crate::fem::{Point, add_scaled, cross, dot, norm, sub, unit};
use crate::harness::case::{CrackShape, CrackSpec, Tip};

/// A node closer to the crack than this, in units of its shortest edge, lies on it: φ = 0 exactly.
///
/// Far above rounding of coordinates (1e-16 of the body, about 1e-13 h), far below any cut that matters to stiffness.
pub const ON_CRACK: f64 = 1e-10;

/// A crack with its level set at the nodes.
#[derive(Debug, Clone)]
pub struct Crack {
    /// Number in the case file, from 0.
    pub number: usize,
    /// First point of a 2D crack, a point of a 3D plane [m].
    pub origin: Point,
    /// Local frame: n, a and (3D) b.
    pub frame: [Point; 3],
    /// Length L of a 2D crack; infinite for a plane [m].
    pub length: f64,
    /// Enrichment of tips inside the body.
    pub tip: Tip,
    /// φ at the nodes, snapped to 0 within [`ON_CRACK`] [m].
    pub phi: Vec<f64>,
}

impl Crack {
    /// Places a crack in a mesh.
    pub fn new(number: usize, spec: &CrackSpec, mesh: &Mesh) -> Self {
        let (origin, frame, length) = match spec.geometry {
            CrackShape::Polyline(ref points) => {
                let (p, q) = (points[0], points[points.len() - 1]);
                let (p, q) = ([p[0], p[1], 0.0], [q[0], q[1], 0.0]);
                let a = unit(&sub(&q, &p));
                (
                    p,
                    [[-a[1], a[0], 0.0], a, [0.0, 0.0, 1.0]],
                    norm(&sub(&q, &p)),
                )
            }
            CrackShape::Arc { .. } | CrackShape::Ellipse { .. } => unimplemented!(),
            CrackShape::Plane { point, normal } => {
                let n = unit(&normal);
                // The axis least along n; the first of equals, so that n = e_z gives a = e_x, b = e_y.
                let mut axis = 0;
                for k in 1..3 {
                    if n[k].abs() < n[axis].abs() - 1e-12 {
                        axis = k;
                    }
                }
                let mut e = [0.0; 3];
                e[axis] = 1.0;
                let a = unit(&add_scaled(&e, -n[axis], &n));
                (point, [n, a, cross(&n, &a)], f64::INFINITY)
            }
        };
        let mut crack = Crack {
            number,
            origin,
            frame,
            length,
            tip: spec.tip,
            phi: Vec::new(),
        };
        crack.phi = mesh
            .nodes
            .iter()
            .zip(mesh.node_sizes())
            .map(|(x, h)| {
                let phi = crack.distance(x);
                if phi.abs() <= ON_CRACK * h { 0.0 } else { phi }
            })
            .collect();
        crack
    }

    /// φ(x), signed distance to the crack's line or plane [m].
    pub fn distance(&self, x: &Point) -> f64 {
        dot(&self.frame[0], &sub(x, &self.origin))
    }

    /// s(x), abscissa along the crack [m]; meaningful in 2D.
    pub fn abscissa(&self, x: &Point) -> f64 {
        dot(&self.frame[1], &sub(x, &self.origin))
    }

    /// Level set at the nodes of a cell.
    pub fn cell_phi(&self, mesh: &Mesh, cell: usize) -> [f64; 8] {
        let mut phi = [0.0; 8];
        for (value, &node) in phi.iter_mut().zip(mesh.cell(cell)) {
            *value = self.phi[node as usize];
        }
        phi
    }

    /// H at a node: +1 on side 1 and on the crack, −1 on side 2.
    pub fn side_of(&self, node: usize) -> f64 {
        if self.phi[node] >= 0.0 { 1.0 } else { -1.0 }
    }

    /// The two ends of a 2D crack: position and unit direction pointing out of the crack.
    pub fn ends(&self) -> [(Point, Point); 2] {
        let a = self.frame[1];
        let end = add_scaled(&self.origin, self.length, &a);
        [(self.origin, [-a[0], -a[1], -a[2]]), (end, a)]
    }
}
