//! Fields on a mesh made for pictures: cut cells are split and nodes on crack faces are doubled, so that the jump is visible.

use std::collections::HashMap;

use rayon::prelude::*;
use stickslip_methods::PointStatus;
use stickslip_xfem::contact::pairs::SurfaceCorner;
use stickslip_xfem::cut::crack::Parent;
use stickslip_xfem::cut::part::Part;
use stickslip_xfem::cut::partition::Partition;
use stickslip_xfem::geometry::clip::{Side, crossing};
use stickslip_xfem::geometry::{Point, add_scaled, cross, dot, mean, norm, polygon, sub};
use stickslip_xfem::material;
use stickslip_xfem::mesh::cell::{CellKind, CellMap};

use crate::model::body::Body;
use crate::model::snapshot::{Snapshot, tangential};

/// A mesh with fields for pictures: cut cells are split and nodes on the faces are doubled, so the jump is visible.
#[derive(Debug, Clone, Default)]
pub struct FieldMesh {
    /// Space dimension of the body.
    pub dim: usize,
    /// Points, reference position [m]; third entry 0 in 2D.
    pub points: Vec<[f64; 3]>,
    /// Cells by point numbers.
    pub cells: Vec<FieldCell>,
    /// Point vectors, one per point: name with unit (e.g. `displacement_m`), values.
    pub point_vectors: Vec<(String, Vec<[f64; 3]>)>,
    /// Point scalars.
    pub point_scalars: Vec<(String, Vec<f64>)>,
    /// Cell scalars, e.g. `stress_xx_pa`, `von_mises_pa`, `side`.
    pub cell_scalars: Vec<(String, Vec<f64>)>,
}

/// Shape of a picture cell; numbering as in VTK.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellShape {
    /// VTK 1.
    Vertex,
    /// VTK 3.
    Line,
    /// VTK 5.
    Triangle,
    /// VTK 7.
    Polygon,
    /// VTK 9.
    Quad,
    /// VTK 10.
    Tetra,
    /// VTK 12.
    Hexahedron,
}

/// One cell of a picture.
#[derive(Debug, Clone)]
pub struct FieldCell {
    /// Shape.
    pub shape: CellShape,
    /// Point numbers.
    pub points: Vec<usize>,
}

/// Body and crack faces of one increment.
#[derive(Debug, Clone, Default)]
pub struct FieldStep {
    /// Time of the increment.
    pub time: f64,
    /// The body.
    pub body: FieldMesh,
    /// The crack surfaces with jump, traction, gap, slip, pressure, shear, status (0 open, 1 stick, 2 slip), number of the crack and distance along
    /// it (0 in 3D) as point data.
    pub crack: FieldMesh,
}

/// Body and crack faces at one increment.
pub fn field_step(body: &Body, now: &Snapshot) -> FieldStep {
    FieldStep {
        time: now.time,
        body: body_picture(body, now),
        crack: crack_picture(body, now),
    }
}

/// Stress of the strain, without an initial one, by name, row and column in 2D and 3D.
const STRESS: [&[(&str, usize, usize)]; 2] = [
    &[
        ("stress_xx_pa", 0, 0),
        ("stress_yy_pa", 1, 1),
        ("stress_xy_pa", 0, 1),
    ],
    &[
        ("stress_xx_pa", 0, 0),
        ("stress_yy_pa", 1, 1),
        ("stress_zz_pa", 2, 2),
        ("stress_yz_pa", 1, 2),
        ("stress_xz_pa", 0, 2),
        ("stress_xy_pa", 0, 1),
    ],
];

/// The body. Cells share the mesh nodes on their own side of a crack; the faces have points of their own.
fn body_picture(body: &Body, now: &Snapshot) -> FieldMesh {
    let (mesh, dim) = (&body.mesh, body.mesh.dim());
    let mut cells = Vec::new();
    let mut vertices = Vertices::new(body, now);
    // Cell and region of every cell of the picture, and the place in it where its stress is taken.
    let mut taken: Vec<(usize, usize, Point)> = Vec::new();
    let mut sides = Vec::new();
    let whole = match mesh.kind {
        CellKind::Quad4 => CellShape::Quad,
        CellKind::Hex8 => CellShape::Hexahedron,
    };
    for cell in 0..mesh.cell_count() {
        let map = mesh.map(cell);
        let Some(partition) = body.enrichment.partition(cell) else {
            let points = if vertices.near_cell(cell).is_empty() {
                mesh.cell(cell).iter().map(|&node| node as usize).collect()
            } else {
                map.iter().map(|x| vertices.of(cell, x, 0, now)).collect()
            };
            cells.push(FieldCell {
                shape: whole,
                points,
            });
            taken.push((cell, 0, [0.0; 3]));
            sides.push(0.0);
            continue;
        };
        for (region, part) in partition.parts.iter().enumerate() {
            for (shape, part) in pieces_of(body, cell, &map, partition, part) {
                let points = part.iter().map(|x| vertices.of(cell, x, region, now));
                let points = points.collect();
                cells.push(FieldCell { shape, points });
                let xi = map.inverse(&mean(&part)).unwrap_or_default();
                taken.push((cell, region, xi));
                sides.push(partition.parts[region].sides.first().map_or(0.0, |s| s.1));
            }
        }
    }
    let mut cell_scalars = stresses(body, now, &taken);
    cell_scalars.push(("side".into(), sides));
    FieldMesh {
        dim,
        points: vertices.points.iter().map(|x| body.place(x)).collect(),
        cells,
        point_vectors: vec![("displacement_m".into(), vertices.displacement)],
        point_scalars: Vec::new(),
        cell_scalars,
    }
}

/// Stress at places in cells, by name.
fn stresses(
    body: &Body,
    now: &Snapshot,
    taken: &[(usize, usize, Point)],
) -> Vec<(String, Vec<f64>)> {
    let (mesh, dim, integrator) = (&body.mesh, body.mesh.dim(), body.integrator());
    let axes = STRESS[usize::from(dim == 3)];
    let of_cell = |places: &[(usize, usize, Point)]| -> Vec<Option<[Point; 3]>> {
        if let [(cell, 0, [0.0, 0.0, 0.0])] = *places
            && let Some(gradient) = integrator.central_gradient(cell, &now.u)
        {
            return vec![Some(gradient)];
        }
        let map = mesh.map(places[0].0);
        // As its stiffness, which was integrated: no number is no stress.
        let mut own = integrator.stress(places[0].0).ok();
        let mut gradient = |&(_, region, xi): &(usize, usize, Point)| {
            let own = own.as_mut()?;
            Some(own.field(&xi, &map.at(&xi), region, &now.u).1)
        };
        places.iter().map(&mut gradient).collect()
    };
    let cells: Vec<&[(usize, usize, Point)]> = taken.chunk_by(|a, b| a.0 == b.0).collect();
    let gradients = cells.into_par_iter().flat_map_iter(of_cell);
    let gradients: Vec<Option<[Point; 3]>> = gradients.collect();
    let of = |value: &dyn Fn(&[Point; 3]) -> f64| {
        let values = gradients.iter().map(|h| h.as_ref().map_or(f64::NAN, value));
        values.collect()
    };
    let mut all: Vec<(String, Vec<f64>)> = Vec::new();
    for &(name, a, b) in axes {
        let values = of(&|h| material::stress(body.lame, dim, h)[a][b]);
        all.push((name.to_owned(), values));
    }
    let von_mises = of(&|h| body.lame.von_mises(h, dim));
    all.push(("von_mises_pa".to_owned(), von_mises));
    all
}

/// Faces of cracks that a point lies on: crack, and whether on side 1.
type Faces = Vec<(usize, bool)>;

/// Points of the picture, one per place and faces.
struct Vertices<'a> {
    body: &'a Body,
    points: Vec<Point>,
    displacement: Vec<Point>,
    /// Number by place in quanta and faces, for the points that are no mesh nodes.
    found: HashMap<([i64; 3], Faces), usize>,
    /// Length below which places are equal [m]: far below a cell, far above rounding.
    quantum: f64,
    /// Cracks that may touch a cell.
    near: HashMap<usize, Vec<usize>>,
}

impl<'a> Vertices<'a> {
    fn new(body: &'a Body, now: &Snapshot) -> Self {
        let dim = body.mesh.dim();
        let nodal = now.u[..body.mesh.nodes.len() * dim].chunks_exact(dim);
        let displacement = nodal.map(|u| [u[0], u[1], u.get(2).copied().unwrap_or(0.0)]);
        let mut near = HashMap::<usize, Vec<usize>>::new();
        for (k, crack) in body.cracks.iter().enumerate() {
            (crack.cells().iter()).for_each(|cell| near.entry(*cell).or_default().push(k));
        }
        Vertices {
            near,
            body,
            points: body.mesh.nodes.clone(),
            displacement: displacement.collect(),
            found: HashMap::new(),
            quantum: 1e-7 * body.mesh.smallest_edge(),
        }
    }

    /// Number of a vertex of a region of a cell: that of the node if it is one on its own side, otherwise one of its own.
    fn of(&mut self, cell: usize, x: &Point, region: usize, now: &Snapshot) -> usize {
        let body = self.body;
        let nodes = body.mesh.cell(cell).iter().map(|&n| n as usize);
        let node = nodes.into_iter().find(|&n| body.mesh.nodes[n] == *x);
        let faces = match body.enrichment.partition(cell) {
            Some(partition) => self.cut_faces(cell, &partition.parts[region], x),
            None => node.map_or_else(Vec::new, |node| self.reached_faces(cell, node)),
        };
        if let Some(node) = node {
            let own = |&(crack, upper): &(usize, bool)| {
                (body.cracks[crack].side_of(&body.mesh, node) > 0.0) == upper
            };
            if faces.iter().all(own) {
                return node;
            }
        }
        let key = (x.map(|v| (v / self.quantum).round() as i64), faces);
        *self.found.entry(key).or_insert_with(|| {
            let u = body.integrator().displacement(cell, x, region, &now.u);
            self.points.push(*x);
            self.displacement.push(u.unwrap_or([f64::NAN; 3]));
            self.points.len() - 1
        })
    }

    /// True between the ends of a crack: ahead of a tip, and beyond a crack that it ends on, the two sides are one.
    fn jumps(&self, crack: usize, x: &Point) -> bool {
        let crack = &self.body.cracks[crack];
        let beyond = |p: &Parent| self.body.cracks[p.crack].distance(x) * p.side < -self.quantum;
        crack.jumps_at(x, self.quantum) && !crack.parents.iter().any(beyond)
    }

    fn near_cell(&self, cell: usize) -> &[usize] {
        self.near.get(&cell).map_or(&[], Vec::as_slice)
    }

    /// Faces of a part of a cut cell at a point; also those of cracks that cut no more of the cell than this point, as where
    /// cracks cross at a node: the cells around it must name the same faces.
    fn cut_faces(&self, cell: usize, part: &Part, x: &Point) -> Faces {
        let on = |&crack: &usize| {
            self.body.cracks[crack].distance(x).abs() <= self.quantum && self.jumps(crack, x)
        };
        let side = |crack: usize| match part.sides.iter().find(|own| own.0 == crack) {
            Some(&(_, side)) => side,
            None if part.polygon.is_empty() => {
                let corners: Vec<Point> = part.tetrahedra.iter().flatten().copied().collect();
                self.body.cracks[crack].distance(&mean(&corners))
            }
            None => self.body.cracks[crack].distance(&mean(&part.polygon)),
        };
        (self.near_cell(cell).iter().copied())
            .filter(on)
            .map(|crack| (crack, side(crack) > 0.0))
            .collect()
    }

    /// Faces of a whole cell at a node that lies on a crack.
    fn reached_faces(&self, cell: usize, node: usize) -> Faces {
        let body = self.body;
        let x = &body.mesh.nodes[node];
        let centre = body.mesh.centre(cell);
        (self.near_cell(cell).iter().copied())
            .filter(|&k| body.cracks[k].holds(node as u32) && self.jumps(k, x))
            .filter(|_| !body.enrichment.enriched_of(node).is_empty())
            .map(|k| (k, body.cracks[k].distance(&centre) > 0.0))
            .collect()
    }
}

/// Shapes that a part of a cut cell is drawn as: a polygon in 2D, triangles if it is not convex; in 3D a hexahedron where one
/// crack parts two opposite faces, tetrahedra elsewhere.
fn pieces_of(
    body: &Body,
    cell: usize,
    map: &CellMap,
    partition: &Partition,
    part: &Part,
) -> Vec<(CellShape, Vec<Point>)> {
    if body.mesh.dim() == 2 {
        let mut polygon = part.polygon.clone();
        for &(_, tip) in body.enrichment.tip_cells.iter().filter(|(c, _)| *c == cell) {
            insert_on_border(&mut polygon, &body.enrichment.tips[tip].position);
        }
        if polygon::is_convex(&polygon) {
            return vec![(CellShape::Polygon, polygon)];
        }
        let triangles = polygon::triangles(&polygon).into_iter();
        return triangles
            .map(|t| (CellShape::Polygon, t.to_vec()))
            .collect();
    }
    if let (&[(crack, side)], 2) = (part.sides.as_slice(), partition.parts.len()) {
        let phi = body.cracks[crack].cell_phi(&body.mesh, cell);
        if let Some(hexahedron) = hexahedron(map, &phi, side) {
            return vec![(CellShape::Hexahedron, hexahedron)];
        }
    }
    let parts = part.tetrahedra.iter();
    parts.map(|t| (CellShape::Tetra, t.to_vec())).collect()
}

/// One side of a cell of which a crack parts two opposite faces.
fn hexahedron(map: &CellMap, phi: &[f64], side: Side) -> Option<Vec<Point>> {
    let kind = map.kind;
    (0..3).find_map(|axis| {
        let level = phi[0].signum() * kind.corner(0)[axis];
        if !(0..8).all(|i| phi[i] * level * kind.corner(i)[axis] > 0.0) {
            return None;
        }
        let opposite = |i: usize| {
            (0..8)
                .find(|&j| (0..3).all(|a| (kind.corner(i)[a] != kind.corner(j)[a]) == (a == axis)))
        };
        let part = (0..8).map(|i| match opposite(i) {
            Some(j) if phi[i] * side < 0.0 => crossing(&map[i], phi[i], &map[j], phi[j]),
            _ => map[i],
        });
        Some(part.collect())
    })
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
fn crack_picture(body: &Body, now: &Snapshot) -> FieldMesh {
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
    let crack = |corner: &SurfaceCorner| {
        let first = corner.shares.first();
        first.map_or(f64::NAN, |&(point, _)| {
            body.points[point as usize].crack as f64 + 1.0
        })
    };
    let weight = |i: usize| body.points[i].weight;
    let cells = body
        .surface
        .facets
        .iter()
        .filter(|facet| facet.len() >= dim)
        .map(|facet| FieldCell {
            shape: if dim == 2 {
                CellShape::Line
            } else {
                CellShape::Polygon
            },
            points: facet.clone(),
        })
        .collect();
    FieldMesh {
        dim,
        points: corners.iter().map(|corner| body.place(&corner.x)).collect(),
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
            ("slip_m".into(), scalar(&|i| tangential(&now.jump, dim, i))),
            (
                "pressure_pa".into(),
                scalar(&|i| now.p[i * dim] / weight(i)),
            ),
            (
                "shear_pa".into(),
                scalar(&|i| tangential(&now.p, dim, i) / weight(i)),
            ),
            ("status".into(), corners.iter().map(leading).collect()),
            ("crack".into(), corners.iter().map(crack).collect()),
            ("s_m".into(), scalar(&|i| body.points[i].s)),
        ],
        cell_scalars: Vec::new(),
    }
}
