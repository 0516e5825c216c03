//! Pictures of a body: cells with the displacement on them, cut cells split so that the jump is visible.

use stickslip_methods::PointStatus;

use crate::fem::Point;
use crate::fem::cell::CellKind;
use crate::harness::body::Body;
use crate::harness::quantities::Snapshot;
use crate::harness::record::{FieldStep, Picture, PictureCell, PictureShape};
use crate::xfem::cut::{self, SubCells};

/// Body and crack faces at one increment.
pub fn field_step(body: &Body, now: &Snapshot) -> FieldStep {
    FieldStep {
        time: now.time,
        body: body_picture(body, now),
        crack: crack_picture(body, now),
    }
}

/// The body; uncut cells share the mesh nodes, every part of a cut cell has points of its own.
fn body_picture(body: &Body, now: &Snapshot) -> Picture {
    let (mesh, dim) = (&body.mesh, body.mesh.dim());
    let integrator = body.integrator();
    let mut points = mesh.nodes.clone();
    let mut displacement: Vec<[f64; 3]> = (0..points.len())
        .map(|n| {
            let mut u = [0.0; 3];
            u[..dim].copy_from_slice(&now.u[n * dim..(n + 1) * dim]);
            u
        })
        .collect();
    let mut cells = Vec::new();
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
                points: mesh.cell(cell).iter().map(|&n| n as usize).collect(),
            });
            let h = integrator.displacement_gradient(cell, &[0.0; 3], 1.0, &now.u);
            stress.push(body.lame.von_mises(&h, dim));
            sides.push(0.0);
            continue;
        };
        let phi = body.cracks[crack as usize].cell_phi(mesh, cell);
        for side in [1.0, -1.0] {
            for (shape, part) in cell_parts(mesh.kind, corners, &phi, side) {
                let first = points.len();
                for x in &part {
                    points.push(*x);
                    displacement.push(integrator.displacement(cell, x, side, &now.u).unwrap_or([f64::NAN; 3]));
                }
                cells.push(PictureCell {
                    shape,
                    points: (first..points.len()).collect(),
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
        points,
        cells,
        point_vectors: vec![("displacement_m".into(), displacement)],
        point_scalars: Vec::new(),
        cell_scalars: vec![("von_mises_pa".into(), stress), ("side".into(), sides)],
    }
}

/// Parts of a cut cell on one side: a polygon in 2D, tetrahedra in 3D.
fn cell_parts(kind: CellKind, corners: &[Point], phi: &[f64], side: f64) -> Vec<(PictureShape, Vec<Point>)> {
    match kind {
        CellKind::Quad4 => {
            let polygon = cut::polygon_part(corners, &phi[..kind.nodes()], side);
            vec![(PictureShape::Polygon, polygon)]
        }
        CellKind::Hex8 => SubCells::of(kind, corners, phi, side)
            .tetrahedra
            .iter()
            .map(|t| (PictureShape::Tetra, t.to_vec()))
            .collect(),
    }
}

/// The contact points with their fields, joined along a 2D crack.
fn crack_picture(body: &Body, now: &Snapshot) -> Picture {
    let dim = body.mesh.dim();
    let count = body.points.len();
    let local = |values: &[f64], c: usize| -> Vec<f64> {
        (0..count).map(|i| if c < dim { values[i * dim + c] } else { 0.0 }).collect()
    };
    let in_space = |values: &[f64]| -> Vec<[f64; 3]> {
        (0..count)
            .map(|i| {
                let mut v = [0.0; 3];
                for (axis, value) in body.points[i].frame.iter().zip(&values[i * dim..(i + 1) * dim]) {
                    for a in 0..3 {
                        v[a] += axis[a] * value;
                    }
                }
                v
            })
            .collect()
    };
    let size = |values: &[f64]| -> Vec<f64> {
        (0..count)
            .map(|i| values[i * dim + 1..(i + 1) * dim].iter().map(|v| v * v).sum::<f64>().sqrt())
            .collect()
    };
    let status = now
        .status
        .iter()
        .map(|s| match s {
            PointStatus::Open => 0.0,
            PointStatus::Stick => 1.0,
            PointStatus::Slip => 2.0,
        })
        .collect();
    let cells = body
        .facets
        .iter()
        .filter(|facet| facet.len() >= dim)
        .map(|facet| PictureCell {
            shape: if dim == 2 { PictureShape::Line } else { PictureShape::Polygon },
            points: facet.clone(),
        })
        .collect();
    Picture {
        dim,
        points: body.points.iter().map(|p| p.x).collect(),
        cells,
        point_vectors: vec![
            ("jump_m".into(), in_space(&now.jump)),
            ("contact_force".into(), in_space(&now.p)),
        ],
        point_scalars: vec![
            ("gap_m".into(), local(&now.jump, 0)),
            ("slip_m".into(), size(&now.jump)),
            ("p_n".into(), local(&now.p, 0)),
            ("p_t".into(), size(&now.p)),
            ("weight".into(), body.points.iter().map(|p| p.weight).collect()),
            ("status".into(), status),
        ],
        cell_scalars: Vec::new(),
    }
}
