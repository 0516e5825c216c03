//! Cracks along facets of a solid: faces between two cells.
//!
//! All nodes of such a facet lie on the crack, and its cells on either side. Where other cracks divide those, the face is what the
//! regions of both leave of the facet.

use std::collections::{BTreeMap, BTreeSet};

use crate::geometry::{Point, mean};
use crate::mesh::Mesh;

use super::crack::{Crack, crossings};
use super::is_split;
use super::part::{Face, FaceCorner, Place};
use super::partition::{Partition, lives};
use super::placement::{Along, along_places};

/// A facet along which an arm runs.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Arm.
    pub arm: usize,
    /// The cells on side 1 and side 2 of it.
    pub cells: [usize; 2],
    /// Nodes of the facet, local in the first cell.
    facet: &'static [usize],
    /// How it lies along the arm.
    pub along: Along,
}

/// The facet of a cell all of whose nodes lie on a crack, where that does not split the cell: local nodes.
pub fn facet_on(mesh: &Mesh, crack: &Crack, cell: usize) -> Option<&'static [usize]> {
    let phi = crack.cell_phi(mesh, cell);
    let mut facets = mesh.kind.facets().iter().copied();
    let on = |facet: &&[usize]| facet.iter().all(|&i| phi[i] == 0.0);
    (!is_split(&phi)).then(|| facets.find(on))?
}

/// Facets between two cells along which an arm runs. On the border of the body it parts nothing.
pub fn sheets(mesh: &Mesh, arm: usize, crack: &Crack) -> Vec<Sheet> {
    let mut beside: BTreeMap<BTreeSet<u32>, Vec<(usize, &'static [usize])>> = BTreeMap::new();
    for &cell in crack.cells() {
        if let Some(facet) = facet_on(mesh, crack, cell) {
            let nodes = facet.iter().map(|&i| mesh.cell(cell)[i]);
            let key = nodes.collect();
            beside.entry(key).or_default().push((cell, facet));
        }
    }
    let both = beside.into_values().filter(|cells| cells.len() == 2);
    let sheet = both.map(|mut cells| {
        cells.sort_by_key(|&(cell, _)| crack.cell_phi(mesh, cell).iter().any(|&phi| phi < 0.0));
        let (first, facet) = cells[0];
        let map = mesh.map(first);
        Sheet {
            arm,
            cells: [first, cells[1].0],
            facet,
            along: along_places(crack, facet.iter().map(|&i| &map[i])),
        }
    });
    sheet.filter(|sheet| sheet.along != Along::Away).collect()
}

/// The numbers of two cracks among arms in a cell that lie in one place there.
pub fn overlap(mesh: &Mesh, arms: &[Crack], cell: usize, own: &[usize]) -> Option<[usize; 2]> {
    let places = |arm: &usize| {
        let corners = crossings(&mesh.map(cell), &arms[*arm].cell_phi(mesh, cell));
        let mut places: Vec<Point> = corners.iter().map(|corner| corner.0).collect();
        places.push(mean(&places));
        places
    };
    own.iter().enumerate().find_map(|(k, one)| {
        let places = (k + 1 < own.len()).then(|| places(one))?;
        let both = |arm: &Crack, x: &Point| arms[*one].beyond(x).max(arm.beyond(x)) < 0.0;
        let on = |arm: &Crack| {
            let along = places.iter().all(|x| arm.level(x) == 0.0);
            along && places.iter().any(|x| both(arm, x))
        };
        let mut others = own[k + 1..].iter().map(|two| &arms[*two]);
        let first = arms[*one].number;
        let second = others.find(|two| two.number != first && on(two))?.number;
        Some([first.min(second), first.max(second)])
    })
}

/// Adds the faces of sheets to the first cells of theirs. Of the arms of a crack that differ by cracks which are not there alone the first
/// has a face.
pub fn add_faces(
    mesh: &Mesh,
    arms: &[Crack],
    sheets: &[&Sheet],
    partitions: &mut BTreeMap<usize, Partition>,
) {
    let mut taken: BTreeSet<(usize, [Place; 2])> = BTreeSet::new();
    for sheet in sheets {
        let crack = &arms[sheet.arm];
        let map = mesh.map(sheet.cells[0]);
        let corner = |&i: &usize| -> FaceCorner { (map[i], Some([i, i])) };
        let whole: Vec<FaceCorner> = sheet.facet.iter().map(corner).collect();
        let clipped = |cell: usize, region: usize, polygon| match partitions.get(&cell) {
            None => polygon,
            Some(own) if lives(arms, crack, &own.parts[region]) => {
                own.clipped(arms, region, polygon)
            }
            Some(_) => Vec::new(),
        };
        let regions = |cell: usize| partitions.get(&cell).map_or(1, |own| own.parts.len());
        let mut faces = Vec::new();
        for one in 0..regions(sheet.cells[0]) {
            let left = clipped(sheet.cells[0], one, whole.clone());
            for two in 0..regions(sheet.cells[1]) {
                let corners = clipped(sheet.cells[1], two, left.clone());
                let sides = [(sheet.cells[0], one), (sheet.cells[1], two)];
                if corners.len() > 2 && taken.insert((crack.number, sides)) {
                    faces.push(Face {
                        crack: sheet.arm,
                        corners,
                        sides,
                        frame: crack.frame(&map[0]),
                    });
                }
            }
        }
        if !faces.is_empty() {
            let own = partitions.entry(sheet.cells[0]);
            own.or_insert_with(|| Partition::whole(&map))
                .faces
                .extend(faces);
        }
    }
}
