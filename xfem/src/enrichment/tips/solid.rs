//! Fronts of solids that carry branch functions, and how the cracks divide the cells.

use std::collections::{BTreeMap, BTreeSet};

use crate::cut::arrangement::{ArrangementError, WITHIN};
use crate::cut::crack::{Crack, Tip};
use crate::cut::partition::Partition;
use crate::cut::placement::{Along, along, front_frame};
use crate::cut::sheets::{Sheet, add_faces, overlap, sheets};
use crate::cut::solid_arms::reaches;
use crate::geometry::tip_frame::FrontShape;
use crate::mesh::neighbours::Neighbours;
use crate::mesh::{Lengths, Mesh};

use super::super::zone::{Zone, front_room};
use super::{SHARE, Tips};

impl Tips {
    /// Divides the cells of a solid.
    ///
    /// # Errors
    /// Two cracks in one place.
    pub fn solid(mesh: &Mesh, lengths: &Lengths, arms: &[Crack]) -> Result<Self, ArrangementError> {
        let mut inside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut ending: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let arms_of = arms.iter().enumerate();
        let sheets: Vec<Sheet> = arms_of
            .flat_map(|(index, crack)| sheets(mesh, index, crack))
            .filter(|sheet| reaches(mesh, arms, &arms[sheet.arm], sheet.cells[0]))
            .collect();
        let through = |sheet: &&Sheet| sheet.along == Along::Through;
        for sheet in sheets.iter().filter(through) {
            for cell in sheet.cells {
                inside.entry(cell).or_default().push(sheet.arm);
            }
        }
        for (index, crack) in arms.iter().enumerate() {
            let cells = crack.cells().iter().copied();
            for cell in cells.filter(|&cell| reaches(mesh, arms, crack, cell)) {
                let list = match along(mesh, crack, cell) {
                    Along::Through => &mut inside,
                    Along::Ends => &mut ending,
                    Along::Away => continue,
                };
                list.entry(cell).or_default().push(index);
            }
        }
        // Where an arm ends: in a cell, or on a facet of two.
        let in_cells = ending
            .iter()
            .flat_map(|(&cell, own)| own.iter().map(move |&arm| (cell, arm)));
        let on_facets = sheets.iter().filter(|sheet| !through(sheet));
        let on_facets = on_facets.flat_map(|sheet| sheet.cells.map(|cell| (cell, sheet.arm)));
        let ends: Vec<(usize, usize)> = in_cells.chain(on_facets).collect();
        let mut present = inside.clone();
        for &(cell, arm) in &ends {
            present.entry(cell).or_default().push(arm);
        }
        for (cell, own) in present {
            if let Some(cracks) = overlap(mesh, arms, cell, &own) {
                let at = mesh.centre(cell);
                return Err(ArrangementError::Overlap { cracks, at });
            }
        }
        let mut tips = Tips::default();
        // All arms of an ellipse have one front.
        let mut fronts: BTreeMap<usize, (usize, BTreeSet<usize>)> = BTreeMap::new();
        for (cell, index) in ends.into_iter().filter(|end| arms[end.1].tip != Tip::None) {
            let front = fronts.entry(arms[index].number);
            let own = front.or_insert_with(|| (index, BTreeSet::new()));
            own.1.insert(cell);
        }
        for (&cell, own) in &ending {
            let (with, without): (Vec<usize>, Vec<usize>) =
                own.iter().partition(|&&i| arms[i].tip != Tip::None);
            if !with.is_empty() {
                inside.entry(cell).or_default().extend(with);
            }
            if !without.is_empty() {
                let mut all = inside.get(&cell).cloned().unwrap_or_default();
                all.extend(without);
                all.sort_unstable();
                tips.endings
                    .insert(cell, Partition::solid(mesh, cell, arms, &all, &[]));
            }
        }
        for (cell, mut own) in inside {
            own.sort_unstable();
            let ends = ending.get(&cell).map_or(&[][..], Vec::as_slice);
            tips.partitions
                .insert(cell, Partition::solid(mesh, cell, arms, &own, ends));
        }
        let kept = |sheet: &&Sheet| through(sheet) || arms[sheet.arm].tip != Tip::None;
        let kept: Vec<&Sheet> = sheets.iter().filter(kept).collect();
        add_faces(mesh, arms, &kept, &mut tips.partitions);
        let mut near = None;
        for (index, cells) in fronts.into_values() {
            let Some(frame) = front_frame(index, &arms[index]) else {
                continue;
            };
            let cells: Vec<usize> = cells.into_iter().collect();
            let at_front = mesh.nodes_of(cells.iter().copied());
            let radius = match (arms[index].tip, &frame.shape) {
                (Tip::Radius(radius), _) => Some(radius),
                (Tip::Auto, FrontShape::Ellipse(e)) => {
                    Some(SHARE * front_room(mesh, arms, &arms[index], e))
                }
                _ => None,
            };
            let own = |cell: &usize| {
                let divided = tips.partitions.get(cell);
                let mut faces = divided.iter().flat_map(|p| &p.faces);
                faces.all(|f| arms[f.crack].number == arms[index].number)
            };
            let mut zone = match radius {
                Some(radius) => {
                    let near = near.get_or_insert_with(|| Neighbours::new(mesh));
                    let free = |cells: &BTreeSet<usize>, _: &_, _| {
                        cells.iter().all(own).then(BTreeSet::new)
                    };
                    let at_front = (at_front, WITHIN * lengths.smallest);
                    Zone::widest(mesh, near, &frame, radius, at_front, free)
                }
                None => Zone::plain(at_front),
            };
            let shared = |&arm: &usize| arms[arm].number == arms[index].number;
            zone.arms = (0..arms.len()).filter(shared).collect();
            tips.add(frame, &cells, zone);
        }
        tips.cells.sort_unstable();
        Ok(tips)
    }
}
