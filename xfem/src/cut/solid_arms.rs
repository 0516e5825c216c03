//! Arms of planes and ellipses in solids: their parts between the planes that they meet.

use crate::geometry::crack_shape::plane_frame;
use crate::geometry::{Point, add_scaled, cross, dot, mean, norm, sub, unit};
use crate::mesh::{Lengths, Mesh};

use super::arrangement::{Arrangement, DELTA, Moved};
use super::crack::{Crack, Geometry, Parent};
use super::is_split;
use super::sheets::facet_on;

/// Lays cracks through the nodes beside them and parts them where they cross earlier planes; the arms of a crack follow each other.
pub fn solid_arms(cracks: &[Crack], mesh: &Mesh, lengths: &Lengths) -> (Arrangement, Vec<Crack>) {
    let mut done: Vec<Crack> = Vec::new();
    let mut found = Arrangement::default();
    for crack in cracks {
        let mut crack = crack.clone();
        found.moved.extend(lay(&mut crack, mesh, lengths));
        done.extend(plane_arms(&crack, &done, mesh));
    }
    (found, done)
}

/// Lays the plane of a crack exactly through the nodes that are as good as on it: through three of them far from each other, or turned as
/// little as may be. So it stays flat; it stays as it is where some place of it would move by more than [`DELTA`]. The node that it was
/// moved to farthest.
fn lay(crack: &mut Crack, mesh: &Mesh, lengths: &Lengths) -> Option<Moved> {
    let reach = DELTA * lengths.smallest;
    let nodes = crack.nodes_within(mesh, reach);
    let own = nodes.iter().map(|x| (*x, crack.distance(x)));
    let (to, away) = own.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    if away.abs() <= lengths.rounding {
        return None;
    }
    let normal = crack.frame(&to)[0];
    let farthest = |from: &dyn Fn(&Point) -> f64| {
        let places = nodes.iter().map(|x| (*x, from(x)));
        let found = places.max_by(|a, b| a.1.total_cmp(&b.1));
        found.filter(|found| found.1 > 0.5 * lengths.smallest)
    };
    let middle = mean(&nodes);
    let from = |x: &Point| norm(&sub(x, &middle));
    let p = farthest(&from).map_or(to, |found| found.0);
    let second = farthest(&|x| norm(&sub(x, &p)));
    let along = second.map(|q| unit(&sub(&q.0, &p)));
    let third = along.and_then(|along| farthest(&|x| norm(&cross(&along, &sub(x, &p)))));
    let turned = match (along, third) {
        (Some(along), Some((r, _))) => {
            let turned = unit(&cross(&along, &sub(&r, &p)));
            turned.map(|v| v * dot(&turned, &normal).signum())
        }
        (Some(along), None) => unit(&add_scaled(&normal, -dot(&normal, &along), &along)),
        _ => normal,
    };
    let beside = |x: &Point| dot(&turned, &sub(x, &p));
    let on_plane = |x: &Point| add_scaled(x, -beside(x), &turned);
    let mut laid = crack.geometry.clone();
    match &mut laid {
        Geometry::Plane { origin, frame } => {
            (*origin, *frame) = (on_plane(origin), plane_frame(&turned));
        }
        Geometry::Ellipse(ellipse) => {
            let axis = add_scaled(&ellipse.axis, -dot(&ellipse.axis, &turned), &turned);
            ellipse.centre = on_plane(&ellipse.centre);
            (ellipse.normal, ellipse.axis) = (turned, unit(&axis));
        }
        Geometry::Curve(_) => {}
    }
    let [low, high] = match &crack.geometry {
        Geometry::Ellipse(_) => crack.extents(),
        _ => mesh.extents(),
    };
    let corner = |k: usize| [0, 1, 2].map(|a| if k >> a & 1 == 0 { low[a] } else { high[a] });
    let mut corners = (0..8).map(corner);
    if corners.any(|x| (beside(&x) - crack.distance(&x)).abs() > reach) {
        return None;
    }
    crack.geometry = laid;
    crack.place(mesh, lengths, None);
    Some(Moved {
        crack: crack.number,
        from: add_scaled(&to, -away, &normal),
        to,
        joined: false,
    })
}

/// Whether an arm may lie in a cell: on its side of the cracks that it ends on, where those do not divide the cell.
pub fn reaches(mesh: &Mesh, arms: &[Crack], arm: &Crack, cell: usize) -> bool {
    arm.parents.iter().all(|parent| {
        let phi = arms[parent.crack].cell_phi(mesh, cell);
        is_split(&phi) || phi.iter().any(|phi| phi * parent.side > 0.0)
    })
}

/// Arms of a plane or ellipse: its parts on both sides of the earlier planes that it crosses inside the body.
fn plane_arms(crack: &Crack, earlier: &[Crack], mesh: &Mesh) -> Vec<Crack> {
    let mut parts = vec![crack.clone()];
    // All arms of a plane have its level.
    let first = |k: usize| k == 0 || earlier[k - 1].number != earlier[k].number;
    for index in (0..earlier.len()).filter(|&k| first(k)) {
        let other = &earlier[index];
        if !matches!(other.geometry, Geometry::Plane { .. }) || !meet(crack, other, mesh) {
            continue;
        }
        parts = parts
            .into_iter()
            .flat_map(|part| {
                [1.0, -1.0].map(|side| {
                    let mut arm = part.clone();
                    arm.parents.push(Parent { crack: index, side });
                    arm
                })
            })
            .collect();
    }
    parts
}

/// True if both planes cut some cell, or run along its facets.
fn meet(crack: &Crack, other: &Crack, mesh: &Mesh) -> bool {
    crack.cells().iter().any(|&cell| {
        let inside =
            |c: &Crack| is_split(&c.cell_phi(mesh, cell)) || facet_on(mesh, c, cell).is_some();
        let map = mesh.map(cell);
        inside(crack) && inside(other) && crack.jumps_at(&map.centre(), -map.diagonal())
    })
}
