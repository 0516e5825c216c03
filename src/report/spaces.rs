//! The files of the study of contact spaces.

use std::collections::BTreeMap;

use super::plot::{Lattice, SmallPanel, italic, lattice};
use super::tables::spaces::{InfSupRow, InfSupSummary, PatchSummary};
use super::{Bundle, Provenance, ReportError, table};
use crate::case::ContactSpace;
use crate::studies::spaces::infsup::{LEAST_SHARE, SCENES, Sequence};
use crate::studies::spaces::patch::PatchRow;

/// β below this stands on the lower edge of the figure.
const FLOOR: f64 = 1e-4;

/// Inf-sup numbers and patch tests, every one and summed up, the figure, provenance.
///
/// # Errors
/// Those of [`table::add`] and of the figure.
pub fn bundle(
    sequences: &[Sequence],
    patches: &[PatchRow],
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    table::add(&mut bundle, &InfSupRow::of(sequences), "")?;
    table::add(
        &mut bundle,
        &sequences.iter().map(InfSupSummary).collect::<Vec<_>>(),
        "",
    )?;
    table::add(&mut bundle, patches, "")?;
    table::add(&mut bundle, &PatchSummary::of(patches), "")?;
    bundle.add("figures/infsup.svg", figure(sequences)?)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

/// β against h, a panel per crack.
///
/// # Errors
/// [`ReportError::Figure`] without any β > 0.
pub fn figure(sequences: &[Sequence]) -> Result<String, ReportError> {
    let mut bounds: BTreeMap<usize, Vec<[f64; 2]>> = BTreeMap::new();
    for s in sequences {
        if s.scene.is_reference && s.space == ContactSpace::Star {
            let points = s.samples.iter().map(|p| [p.h, LEAST_SHARE * p.beta]);
            bounds.insert(s.scene.dim, points.collect());
        }
    }
    let curve = |name: &str, space: ContactSpace| -> Vec<[f64; 2]> {
        let own = sequences
            .iter()
            .filter(|s| s.scene.name == name && s.space == space);
        own.flat_map(|s| s.samples.iter().map(|p| [p.h, p.beta]))
            .collect()
    };
    let group = |dim: usize| -> Vec<SmallPanel> {
        let scenes = SCENES.iter().filter(|scene| scene.dim == dim);
        scenes
            .map(|scene| SmallPanel {
                heading: heading(scene.name),
                curves: ContactSpace::ALL
                    .map(|space| curve(scene.name, space))
                    .to_vec(),
                bound: bounds.get(&dim).cloned().unwrap_or_default(),
            })
            .collect()
    };
    let beta = italic("β");
    lattice(&Lattice {
        title: "Inf-sup numbers of the contact spaces".into(),
        caption: format!(
            "Unit square and cube, tied crack; a stable space keeps {beta} above a constant, whatever the mesh; on the lower edge: {beta} < {FLOOR:e} or 0"
        ),
        columns: 5,
        curves: ContactSpace::ALL
            .map(|space| space.name().to_owned())
            .to_vec(),
        bound: format!("{LEAST_SHARE} of star, crack along the grid"),
        x_label: "cell size h [m]".into(),
        y_label: format!("inf-sup number {beta} [-]"),
        floor: FLOOR,
        groups: vec![group(2), group(3)],
    })
}

/// A name in two lines, broken at a comma that is not inside brackets.
fn heading(name: &str) -> Vec<String> {
    match name.rsplit_once(", ") {
        Some((first, second)) if !second.ends_with(')') => vec![first.into(), second.into()],
        _ => vec![name.into()],
    }
}
