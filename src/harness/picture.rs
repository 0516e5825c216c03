//! Pictures of a body: cells with the displacement on them, cut cells split so that the jump is visible.

use std::collections::HashMap;

use stickslip_methods::PointStatus;

use crate::fem::cell::CellKind;
use crate::fem::{Point, add_scaled, cross, dot, norm, sub};
use crate::harness::body::Body;
use crate::harness::quantities::Snapshot;
use crate::harness::record::{FieldStep, Picture, PictureCell, PictureShape};
use crate::xfem::basis::FunctionKind;
use crate::xfem::cut::{self, Side, SubCells};
use crate::xfem::pairs::SurfaceCorner;

/// Body and crack faces at one increment.
pub fn field_step(body: &Body, now: &Snapshot) -> FieldStep {
    FieldStep {
        time: now.time,
        body: body_picture(body, now),
        crack: crack_picture(body, now),
    }
}

/// The body. Cells share the mesh nodes on their own side of a crack; the faces have points of their own.
fn body_picture(body: &Body, now: &Snapshot) -> Picture {
    let (mesh, dim) = (&body.mesh, body.mesh.dim());
    let integrator = body.integrator();
    let mut cells = Vec::new();
    let mut vertices = Vertices::new(body, now);
    let (mut stress, mut sides) = (Vec::new(), Vec::new());
    let whole = match mesh.kind {
        CellKind::Quad4 => PictureShape::Quad,
        CellKind::Hex8 => PictureShape::Hexahedron,
    };
    for cell in 0..mesh.cell_count() {
        let corners = mesh.corners(cell);
        let corners = &corners[..mesh.kind.nodes()];
        let Some(crack) = body.enrichment.split[cell] else {
            cells.push(PictureCell {
                shape: whole,
                points: corners
                    .iter()
                    .map(|x| vertices.of(cell, x, 1.0, now))
                    .collect(),
            });
            let h = integrator.displacement_gradient(cell, &[0.0; 3], 1.0, &now.u);
            stress.push(body.lame.von_mises(&h, dim));
            sides.push(0.0);
            continue;
        };
        let phi = body.cracks[crack as usize].cell_phi(mesh, cell);
        for side in [1.0, -1.0] {
            for (shape, part) in cell_parts(body, cell, corners, &phi, side) {
                cells.push(PictureCell {
                    shape,
                    points: part
                        .iter()
                        .map(|x| vertices.of(cell, x, side, now))
                        .collect(),
                });
                let mut centre = [0.0; 3];
                for x in &part {
                    for a in 0..3 {
                        centre[a] += x[a] / part.len() as f64;
                    }
                }
                let xi = mesh.kind.inverse_map(corners, &centre).unwrap_or_default();
                let h = integrator.displacement_gradient(cell, &xi, side, &now.u);
                stress.push(body.lame.von_mises(&h, dim));
                sides.push(side);
            }
        }
    }
    Picture {
        dim,
        points: vertices.points,
        cells,
        point_vectors: vec![("displacement_m".into(), vertices.displacement)],
        point_scalars: Vec::new(),
        cell_scalars: vec![("von_mises_pa".into(), stress), ("side".into(), sides)],
    }
}

/// Points of the picture, one per place and side.
struct Vertices<'a> {
    body: &'a Body,
    points: Vec<Point>,
    displacement: Vec<Point>,
    /// Number by (place in quanta, side) for the points that are no mesh nodes.
    found: HashMap<([i64; 3], Option<bool>), usize>,
    /// Length below which places are equal [m]: far below a cell, far above rounding.
    quantum: f64,
}

impl<'a> Vertices<'a> {
    fn new(body: &'a Body, now: &Snapshot) -> Self {
        let dim = body.mesh.dim();
        let displacement = now.u[..body.mesh.nodes.len() * dim]
            .chunks_exact(dim)
            .map(|u| [u[0], u[1], u.get(2).copied().unwrap_or(0.0)])
            .collect();
        let smallest = body
            .mesh
            .node_sizes()
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        Vertices {
            body,
            points: body.mesh.nodes.clone(),
            displacement,
            found: HashMap::new(),
            quantum: 1e-7 * smallest,
        }
    }

    /// Number of a vertex of a cell: that of the node if it is one on its own side, otherwise one of its own.
    fn of(&mut self, cell: usize, x: &Point, side: Side, now: &Snapshot) -> usize {
        let body = self.body;
        let nodes = body.mesh.cell(cell);
        let node = nodes
            .iter()
            .map(|&n| n as usize)
            .find(|&n| body.mesh.nodes[n] == *x);
        let across = match body.enrichment.split[cell] {
            Some(crack) => self.jumps(crack as usize, x).then_some(side),
            None => node.and_then(|node| self.reached_side(cell, node)),
        };
        if let Some(node) = node {
            let crack = body.enrichment.split[cell].map(|c| &body.cracks[c as usize]);
            let own = match (across, crack) {
                (Some(side), Some(crack)) => crack.side_of(node) == side,
                (across, _) => across.is_none(),
            };
            if own {
                return node;
            }
        }
        let key = (
            x.map(|v| (v / self.quantum).round() as i64),
            across.map(|side| side > 0.0),
        );
        *self.found.entry(key).or_insert_with(|| {
            let u = body.integrator().displacement(cell, x, side, &now.u);
            self.points.push(*x);
            self.displacement.push(u.unwrap_or([f64::NAN; 3]));
            self.points.len() - 1
        })
    }

    /// True between the ends of a crack: ahead of a tip the two sides are one.
    fn jumps(&self, crack: usize, x: &Point) -> bool {
        let crack = &self.body.cracks[crack];
        let s = crack.abscissa(x);
        crack.length.is_infinite() || (s > self.quantum && s < crack.length - self.quantum)
    }

    /// Side of a whole cell, if a node of it lies on a crack and counts to the other side.
    fn reached_side(&self, cell: usize, node: usize) -> Option<Side> {
        let (mesh, enrichment) = (&self.body.mesh, &self.body.enrichment);
        enrichment.cell_basis(mesh, cell).iter().find_map(|f| {
            let crack = match f.kind {
                FunctionKind::Standard => return None,
                FunctionKind::Heaviside { crack } => crack as usize,
                FunctionKind::Branch { tip, .. } => enrichment.tips[tip as usize].crack,
            };
            let here =
                mesh.cell(cell)[f.local] as usize == node && self.jumps(crack, &mesh.nodes[node]);
            f.whole
                .filter(|&side| here && side != self.body.cracks[crack].side_of(node))
        })
    }
}

/// Parts of a cut cell on one side: a polygon in 2D; in 3D a hexahedron where the crack parts two opposite faces,
/// tetrahedra elsewhere.
fn cell_parts(
    body: &Body,
    cell: usize,
    corners: &[Point],
    phi: &[f64],
    side: Side,
) -> Vec<(PictureShape, Vec<Point>)> {
    let kind = body.mesh.kind;
    if kind == CellKind::Quad4 {
        let mut polygon = cut::polygon_part(corners, &phi[..4], side);
        for &(_, tip) in body.enrichment.tip_cells.iter().filter(|(c, _)| *c == cell) {
            insert_on_border(&mut polygon, &body.enrichment.tips[tip].position);
        }
        return vec![(PictureShape::Polygon, polygon)];
    }
    for axis in 0..3 {
        let level = phi[0].signum() * kind.corner(0)[axis];
        if (0..8).all(|i| phi[i] * level * kind.corner(i)[axis] > 0.0) {
            let opposite = |i: usize| {
                (0..8).find(|&j| {
                    (0..3).all(|a| (kind.corner(i)[a] != kind.corner(j)[a]) == (a == axis))
                })
            };
            let part = (0..8).map(|i| match opposite(i) {
                Some(j) if phi[i] * side < 0.0 => {
                    cut::crossing(&corners[i], phi[i], &corners[j], phi[j])
                }
                _ => corners[i],
            });
            return vec![(PictureShape::Hexahedron, part.collect())];
        }
    }
    let parts = SubCells::of(kind, corners, phi, side).tetrahedra;
    parts
        .iter()
        .map(|t| (PictureShape::Tetra, t.to_vec()))
        .collect()
}

/// Makes a point on an edge of a polygon a vertex of it.
fn insert_on_border(polygon: &mut Vec<Point>, x: &Point) {
    let count = polygon.len();
    let on_edge = (0..count).find(|&i| {
        let (p, q) = (&polygon[i], &polygon[(i + 1) % count]);
        let (edge, to) = (sub(q, p), sub(x, p));
        let t = dot(&to, &edge) / dot(&edge, &edge);
        t > 1e-9 && t < 1.0 - 1e-9 && norm(&cross(&edge, &to)) <= 1e-9 * dot(&edge, &edge)
    });
    if let Some(i) = on_edge {
        polygon.insert(i + 1, *x);
    }
}

/// The crack faces with their fields; every corner shows what the contact points that speak for it say.
fn crack_picture(body: &Body, now: &Snapshot) -> Picture {
    let dim = body.mesh.dim();
    let corners = &body.surface.corners;
    // Σ share · value of the point, component by component in space.
    let in_space = |value: &dyn Fn(usize, usize) -> f64| -> Vec<[f64; 3]> {
        let of_corner = |corner: &SurfaceCorner| {
            let mut v = [0.0; 3];
            for &(point, share) in &corner.shares {
                let point = point as usize;
                for (c, axis) in body.points[point].frame.iter().enumerate().take(dim) {
                    v = add_scaled(&v, share * value(point, c), axis);
                }
            }
            v
        };
        corners.iter().map(of_corner).collect()
    };
    let scalar = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let of_corner = |corner: &SurfaceCorner| {
            let parts = corner.shares.iter();
            parts
                .map(|&(point, share)| share * value(point as usize))
                .sum()
        };
        corners.iter().map(of_corner).collect()
    };
    // A state is not a mean: that of the point with the largest share.
    let leading = |corner: &SurfaceCorner| -> f64 {
        let most = corner.shares.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        most.map_or(f64::NAN, |&(point, _)| match now.status[point as usize] {
            PointStatus::Open => 0.0,
            PointStatus::Stick => 1.0,
            PointStatus::Slip => 2.0,
        })
    };
    let tangential = |values: &[f64], i: usize| {
        values[i * dim + 1..(i + 1) * dim]
            .iter()
            .map(|v| v * v)
            .sum::<f64>()
            .sqrt()
    };
    let weight = |i: usize| body.points[i].weight;
    let cells = body
        .surface
        .facets
        .iter()
        .filter(|facet| facet.len() >= dim)
        .map(|facet| PictureCell {
            shape: if dim == 2 {
                PictureShape::Line
            } else {
                PictureShape::Polygon
            },
            points: facet.clone(),
        })
        .collect();
    Picture {
        dim,
        points: corners.iter().map(|corner| corner.x).collect(),
        cells,
        point_vectors: vec![
            ("jump_m".into(), in_space(&|i, c| now.jump[i * dim + c])),
            (
                "contact_traction_pa".into(),
                in_space(&|i, c| now.p[i * dim + c] / weight(i)),
            ),
        ],
        point_scalars: vec![
            ("gap_m".into(), scalar(&|i| now.jump[i * dim])),
            ("slip_m".into(), scalar(&|i| tangential(&now.jump, i))),
            (
                "pressure_pa".into(),
                scalar(&|i| now.p[i * dim] / weight(i)),
            ),
            (
                "shear_pa".into(),
                scalar(&|i| tangential(&now.p, i) / weight(i)),
            ),
            ("status".into(), corners.iter().map(leading).collect()),
        ],
        cell_scalars: Vec::new(),
    }
}
