//! Inf-sup numbers of the contact spaces under refinement, a panel per crack.

use super::kind::Kind;
use crate::case::ContactSpace;
use crate::report::plot::{Axis, Figure, Panel, Series, Style, italic};
use crate::report::{Bundle, ReportError};
use crate::studies::spaces::infsup::{LEAST_SHARE, SCENES, Scene, Sequence};

/// What it is.
pub static KIND: Kind = Kind {
    file: "infsup.svg",
    question: "Which contact spaces stay stable under refinement, however the crack lies in the grid?",
    shows: "Inf-sup number β of every contact space against the cell size on tied cracks in the unit square and \
            cube; a stable space keeps it above a constant. Dots: the share of star's β on a crack along the grid \
            that a stable space must keep.",
};

/// β below this stands on the level of this number.
const FLOOR: f64 = 1e-4;

/// The figure of all cracks.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, sequences: &[Sequence]) -> Result<(), ReportError> {
    let points = |share: f64, space: ContactSpace, of: &dyn Fn(&Scene) -> bool| -> Vec<[f64; 2]> {
        let own = sequences.iter().filter(|s| s.space == space && of(s.scene));
        let samples = own.flat_map(|s| &s.samples);
        samples
            .map(|p| [p.h, (share * p.beta).max(FLOOR)])
            .collect()
    };
    let mut panels = Vec::new();
    let measured = |scene: &&Scene| sequences.iter().any(|s| s.scene.name == scene.name);
    for scene in SCENES.iter().filter(measured) {
        let x = Axis::log(&format!("cell size {}, {}D [m]", italic("h"), scene.dim));
        let y = Axis::log(&format!("inf-sup number {} [-]", italic("β")));
        let mut panel = Panel::new(x, y.through(&[FLOOR]), 31.0);
        panel.heading = scene.name.to_owned();
        for (index, space) in ContactSpace::stable_first().into_iter().enumerate() {
            let own = points(1.0, space, &|other| other.name == scene.name);
            let series = Series::new(space.name(), Style::curve(index), own);
            panel.series.push(series);
        }
        let reference = |other: &Scene| other.is_reference && other.dim == scene.dim;
        let bound = points(LEAST_SHARE, ContactSpace::Star, &reference);
        let label = format!("{LEAST_SHARE} of star, crack along the grid");
        panel.series.push(Series::new(label, Style::limit(), bound));
        panels.push(panel);
    }
    let of = |space: ContactSpace| sequences.iter().filter(move |s| s.space == space);
    let stable =
        |space: &ContactSpace| of(*space).count() > 0 && of(*space).all(Sequence::is_stable);
    let always = ContactSpace::ALL.into_iter().filter(stable);
    let always: Vec<&str> = always.map(|space| space.name()).collect();
    let title = match &always[..] {
        [] => "No contact space is stable on every crack".to_owned(),
        [one] => format!("Only {one} is stable on every crack"),
        several => format!("Stable on every crack: {}", several.join(", ")),
    };
    let caption = format!(
        "unit square and cube, tied crack; a stable space keeps {0} above a constant, whatever the mesh; on the \
         lowest level: {0} ≤ {FLOOR:e}",
        italic("β")
    );
    KIND.add(bundle, "", Figure::new(&title, &caption, 5, panels).svg()?)
}
