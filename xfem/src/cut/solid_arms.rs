//! Arms of planes and ellipses in solids: their parts between the planes that they meet.

use crate::mesh::Mesh;

use super::crack::{Crack, Geometry, Parent};
use super::is_split;

/// Parts cracks where they cross earlier planes; the arms of a crack follow each other.
pub fn solid_arms(cracks: &[Crack], mesh: &Mesh) -> Vec<Crack> {
    let mut done: Vec<Crack> = Vec::new();
    for crack in cracks {
        done.extend(plane_arms(crack, &done, mesh));
    }
    done
}

/// Arms of a plane or ellipse: its parts on both sides of the earlier planes that it crosses inside the body.
fn plane_arms(crack: &Crack, earlier: &[Crack], mesh: &Mesh) -> Vec<Crack> {
    let mut parts = vec![crack.clone()];
    for (index, other) in earlier.iter().enumerate() {
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

/// True if some cell is cut by both planes.
fn meet(crack: &Crack, other: &Crack, mesh: &Mesh) -> bool {
    crack.cells().iter().any(|&cell| {
        let inside = |c: &Crack| is_split(&c.cell_phi(mesh, cell));
        let map = mesh.map(cell);
        inside(crack) && inside(other) && crack.jumps_at(&map.centre(), -map.diagonal())
    })
}
