//! Inf-sup numbers of the contact spaces under refinement, a panel per crack.

use super::{Bundle, Kind, ReportError};
use crate::case::ContactSpace;
use crate::report::plot::{Axis, Figure, Panel, Series, Style, italic};
use crate::studies::spaces::infsup::{LEAST_SHARE, SCENES, Sequence};

/// What it is.
pub static KIND: Kind = Kind {
    file: "infsup.svg",
    question: "Which contact spaces stay stable under refinement, however the crack lies in the grid?",
    shows: "Inf-sup number β of every contact space against the cell size on tied cracks in the unit square and cube; a stable space \
            keeps it above a constant. Dots: the share of star's β on a crack along the grid that a stable space must keep.",
};

/// β below this stands on the level of this number.
const FLOOR: f64 = 1e-4;

/// The figure of all cracks.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, sequences: &[Sequence]) -> Result<(), ReportError> {
    let points = |share: f64, own: &mut dyn Iterator<Item = &Sequence>| -> Vec<[f64; 2]> {
        own.flat_map(|s| s.samples.iter().map(|p| [p.h, (share * p.beta).max(FLOOR)]))
            .collect()
    };
    let mut panels = Vec::new();
    for scene in SCENES
        .iter()
        .filter(|scene| sequences.iter().any(|s| s.scene.name == scene.name))
    {
        let x = Axis::log(&format!("cell size {}, {}D [m]", italic("h"), scene.dim));
        let y = Axis::log(&format!("inf-sup number {} [-]", italic("β"))).through(FLOOR);
        let mut panel = Panel::new(x, y, 31.0);
        panel.heading = scene.name.to_owned();
        for (index, space) in ContactSpace::ALL.into_iter().enumerate() {
            let own = points(
                1.0,
                &mut sequences
                    .iter()
                    .filter(|s| s.scene.name == scene.name && s.space == space),
            );
            panel
                .series
                .push(Series::new(space.name(), Style::curve(index), own));
        }
        let reference = sequences
            .iter()
            .filter(|s| s.scene.is_reference && s.scene.dim == scene.dim);
        let bound = points(
            LEAST_SHARE,
            &mut reference.filter(|s| s.space == ContactSpace::Star),
        );
        let label = format!("{LEAST_SHARE} of star, crack along the grid");
        panel.series.push(Series::new(label, Style::limit(), bound));
        panels.push(panel);
    }
    let stable = |space: &ContactSpace| {
        let mut own = sequences.iter().filter(|s| s.space == *space).peekable();
        own.peek().is_some() && own.all(Sequence::is_stable)
    };
    let always: Vec<&str> = ContactSpace::ALL
        .iter()
        .filter(|space| stable(space))
        .map(|space| space.name())
        .collect();
    let title = match &always[..] {
        [] => "No contact space is stable on every crack".to_owned(),
        [one] => format!("Only {one} is stable on every crack"),
        several => format!("Stable on every crack: {}", several.join(", ")),
    };
    let beta = italic("β");
    let caption = format!(
        "unit square and cube, tied crack; a stable space keeps {beta} above a constant, whatever the mesh; on the lowest level: \
         {beta} ≤ {FLOOR:e}"
    );
    KIND.add(
        bundle,
        "",
        Figure::new(title, caption, panels).columns(5).svg()?,
    )
}
