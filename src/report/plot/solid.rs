//! One displacement component on the deformed boundary of a solid, seen along the diagonal of the axes.
//!
//! The boundary is drawn from back to front (painter's algorithm), patches that look away are left out. The
//! view is isometric: x points to the lower left, y to the lower right, z up.

use super::axis::{prefixed, range};
use super::bands::{self, Levels, Triangle};
use super::canvas::{
    Anchor, CAPTION_PT, Canvas, Width, caption_height, italic, pixel, subscript, wrapped,
};
use super::chart::TICK_PT;
use super::colour::BLACK;
use super::contour::{
    Box2, DISPLACEMENT, Magnification, full_caption, point_vector, split, stroke, unfit,
};
use super::outline::Weld;
use super::surface::{self, Patch};
use crate::harness::record::Picture;
use crate::report::ReportError;

/// Component of a vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis3 {
    /// First.
    X,
    /// Second.
    Y,
    /// Third.
    Z,
}

impl Axis3 {
    fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

/// Height of the colour bar [mm].
const BAR_MM: f64 = 40.0;
/// Room for the axes below it [mm].
const TRIAD_MM: f64 = 16.0;

/// One component of `displacement_m` of a 3D picture as filled bands on the deformed boundary.
///
/// # Errors
/// [`ReportError::Picture`] when the picture is not 3D, has no solid cells, or lacks the vector.
pub fn solid_displacement(
    picture: &Picture,
    component: Axis3,
    magnification: Magnification,
    caption: &str,
) -> Result<String, ReportError> {
    if picture.dim != 3 {
        return Err(unfit(
            "picture",
            format!("{} dimensions, a solid needs 3", picture.dim),
        ));
    }
    let displacement = point_vector(picture, DISPLACEMENT)?;
    let patches = surface::boundary(picture, &Weld::new(picture, displacement))?;
    let length = |u: &[f64; 3]| u.iter().map(|c| c * c).sum::<f64>().sqrt();
    let diagonal: [f64; 3] = std::array::from_fn(|c| {
        range(picture.points.iter().map(|p| p[c])).map_or(0.0, |(low, high)| high - low)
    });
    let largest = displacement
        .iter()
        .map(length)
        .filter(|u| u.is_finite())
        .fold(0.0, f64::max);
    let factor = magnification.factor(length(&diagonal), largest);
    let places: Vec<[f64; 3]> = picture
        .points
        .iter()
        .zip(displacement)
        .map(|(x, u)| std::array::from_fn(|c| x[c] + factor * u[c]))
        .collect();
    let Some(shown) = Box2::around(places.iter().map(|p| project(*p))) else {
        return Err(unfit(DISPLACEMENT, "no finite values".into()));
    };

    let width = Width::Column.mm();
    let scale = ((width - 24.0) / shown.width()).min(70.0 / shown.height());
    let body = [scale * shown.width(), scale * shown.height()];
    let caption = full_caption(caption, factor);
    let lines = wrapped(&caption, CAPTION_PT, width - 3.0);
    let top = caption_height(&lines) + 4.0;
    let (left, bottom) = (3.0, top + body[1].max(BAR_MM + TRIAD_MM));
    let paper = |p: [f64; 3]| {
        let [x, y] = project(p);
        [
            left + scale * (x - shown.low[0]),
            bottom - scale * (y - shown.low[1]),
        ]
    };
    let c = component as usize;
    let (low, high) = range(displacement.iter().map(|u| u[c])).unwrap_or((0.0, 0.0));
    let (unit_factor, unit) = prefixed(low.abs().max(high.abs()), "m");
    let levels = Levels::new(low * unit_factor, high * unit_factor);

    let mut canvas = Canvas::new(width, bottom + 4.0);
    let mut visible: Vec<(f64, &Patch)> = patches
        .iter()
        .filter(|patch| !patch.outline.is_empty())
        .filter(|patch| patch.faces.iter().flatten().all(|p| finite(places[*p])))
        .filter(|patch| faces_viewer(patch.faces[0].iter().map(|p| project(places[*p]))))
        .map(|patch| {
            let corners = patch.outline.iter().flatten();
            let total: f64 = corners.map(|p| depth(places[*p])).sum();
            (total / (2 * patch.outline.len()) as f64, patch)
        })
        .collect();
    visible.sort_by(|a, b| a.0.total_cmp(&b.0));
    let corner = |p: usize| (pixel(paper(places[p])), displacement[p][c] * unit_factor);
    for (_, patch) in visible {
        let triangles: Vec<Triangle> = patch
            .faces
            .iter()
            .flat_map(|face| split(face, corner))
            .collect();
        bands::fill(&mut canvas, &triangles, &levels, 0.0);
        // The mesh line also covers the hairline between neighbouring patches.
        stroke(&mut canvas, &patch.outline, |p| corner(p).0, BLACK, 0.05);
    }

    canvas.caption(&lines);
    let label = format!("{}{} [{unit}]", italic("u"), subscript(component.name()));
    let bar = [width - 15.0, bottom - TRIAD_MM];
    bands::colour_bar(&mut canvas, &levels, bar, BAR_MM, &label);
    draw_triad(&mut canvas, [width - 10.5, bottom - 3.0]);
    canvas.finish(&format!("Displacement {}: {caption}", component.name()))
}

fn finite(place: [f64; 3]) -> bool {
    place.iter().all(|c| c.is_finite())
}

/// Isometric projection: right and up on the paper [m].
fn project([x, y, z]: [f64; 3]) -> [f64; 2] {
    [(y - x) / 2f64.sqrt(), (2.0 * z - x - y) / 6f64.sqrt()]
}

/// Distance towards the viewer.
fn depth([x, y, z]: [f64; 3]) -> f64 {
    (x + y + z) / 3f64.sqrt()
}

/// Whether a projected outline runs counterclockwise, that is whether its outward normal points to the viewer.
fn faces_viewer(corners: impl Iterator<Item = [f64; 2]>) -> bool {
    let corners: Vec<[f64; 2]> = corners.collect();
    let n = corners.len();
    let twice_area: f64 = (0..n)
        .map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % n]);
            a[0] * b[1] - b[0] * a[1]
        })
        .sum();
    twice_area > 0.0
}

/// The three axes with their names.
fn draw_triad(canvas: &mut Canvas, origin: [f64; 2]) {
    const LENGTH: f64 = 5.0;
    for (direction, name) in [
        ([1.0, 0.0, 0.0], "x"),
        ([0.0, 1.0, 0.0], "y"),
        ([0.0, 0.0, 1.0], "z"),
    ] {
        let [x, y] = project(direction);
        let at = |length: f64| [origin[0] + length * x, origin[1] - length * y];
        canvas.line(&[origin, at(LENGTH)], BLACK, 0.25);
        canvas.text(
            &italic(name),
            at(LENGTH + 2.0),
            TICK_PT,
            Anchor::Middle,
            BLACK,
        );
    }
}
