//! A displacement component or von Mises' stress on the deformed boundary of a solid, seen along the diagonal of the axes.
//!
//! The boundary is drawn from back to front (painter's algorithm), patches that look away are left out. The
//! view is isometric: x points to the lower left, y to the lower right, z up.

use super::axis::range;
use super::bands::{self, Triangle};
use super::canvas::{
    Anchor, CAPTION_PT, Canvas, TICK_PT, Width, caption_height, italic, pixel, wrapped,
};
use super::colour::BLACK;
use super::contour::{Box2, split, stroke};
use super::field::{DISPLACEMENT, Field, Magnification, STRESS, full_caption, point_vector};
use super::outline::Weld;
use super::surface::{self, Patch};
use crate::model::field_mesh::FieldMesh;
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

/// Direction to the viewer.
pub const VIEW: [f64; 3] = [1.0, 1.0, 1.0];
/// Height of the colour bar [mm].
const BAR_MM: f64 = 40.0;
/// Room for the axes below it [mm].
const TRIAD_MM: f64 = 16.0;

/// One component of `displacement_m` of a 3D picture as filled bands on the deformed boundary.
///
/// # Errors
/// [`ReportError::FieldMesh`] when the picture is not 3D, has no solid cells, or lacks the vector.
pub fn solid_displacement(
    picture: &FieldMesh,
    component: Axis3,
    magnification: Magnification,
    caption: &str,
) -> Result<String, ReportError> {
    let displacement = point_vector(picture, DISPLACEMENT)?;
    let field = Field::displacement(displacement, component as usize);
    let title = format!("Displacement {}", component.name());
    solid(picture, &field, magnification, &title, caption)
}

/// von Mises' equivalent stress of a 3D picture as filled bands on the deformed boundary; needs the cell scalar
/// `von_mises_pa`, of which points show the mean over their cells.
///
/// # Errors
/// Those of [`solid_displacement`].
pub fn solid_von_mises(
    picture: &FieldMesh,
    magnification: Magnification,
    caption: &str,
) -> Result<String, ReportError> {
    let field = Field::von_mises(picture)?;
    let caption = format!("{caption}, {STRESS}");
    solid(picture, &field, magnification, "Stress", &caption)
}

/// A field on the deformed boundary.
fn solid(
    picture: &FieldMesh,
    field: &Field,
    magnification: Magnification,
    title: &str,
    caption: &str,
) -> Result<String, ReportError> {
    let shape = Deformed::new(picture, magnification)?;
    let shown = Box2::around(shape.places.iter().map(|p| project(*p)))
        .ok_or_else(|| ReportError::field_mesh(DISPLACEMENT, "no finite values".into()))?;
    let width = Width::Column.mm();
    let scale = ((width - 24.0) / shown.width()).min(70.0 / shown.height());
    let height = scale * shown.height();
    let caption = full_caption(caption, shape.factor);
    let lines = wrapped(&caption, CAPTION_PT, width - 3.0);
    let top = caption_height(&lines) + 4.0;
    let bottom = top + height.max(BAR_MM + TRIAD_MM);
    let sheet = Sheet {
        shown,
        scale,
        left: 3.0,
        bottom,
    };
    let mut canvas = Canvas::new(width, bottom + 4.0);
    let corner = |p: usize| (pixel(sheet.at(shape.places[p])), field.values[p]);
    for patch in shape.visible() {
        let triangles: Vec<Triangle> = patch
            .faces
            .iter()
            .flat_map(|face| split(face, corner))
            .collect();
        bands::fill(&mut canvas, &triangles, &field.levels, 0.0);
        // The mesh line also covers the hairline between neighbouring patches.
        stroke(&mut canvas, &patch.outline, |p| corner(p).0, BLACK, 0.05);
    }

    canvas.caption(&lines);
    let bar = [width - 15.0, bottom - TRIAD_MM];
    bands::colour_bar(&mut canvas, &field.levels, bar, BAR_MM, &field.label);
    draw_triad(&mut canvas, [width - 10.5, bottom - 3.0]);
    canvas.finish(&format!("{title}: {caption}"))
}

/// The boundary of a solid on its deformed shape.
pub struct Deformed {
    /// Magnification of the displacement.
    pub factor: f64,
    /// Deformed positions of the points [m].
    pub places: Vec<[f64; 3]>,
    pub patches: Vec<Patch>,
}

impl Deformed {
    /// # Errors
    /// [`ReportError::FieldMesh`] when the picture is not 3D, has no solid cells, or lacks `displacement_m`.
    pub fn new(picture: &FieldMesh, magnification: Magnification) -> Result<Self, ReportError> {
        if picture.dim != 3 {
            let reason = format!("{} dimensions, a solid needs 3", picture.dim);
            return Err(ReportError::field_mesh("picture", reason));
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
        let moved = picture.points.iter().zip(displacement);
        let places = moved.map(|(x, u)| std::array::from_fn(|c| x[c] + factor * u[c]));
        Ok(Self {
            factor,
            places: places.collect(),
            patches,
        })
    }

    /// Whether a patch has a place and looks at the viewer.
    pub fn faces_viewer(&self, patch: &Patch) -> bool {
        let places = || patch.faces.iter().flatten().map(|p| self.places[*p]);
        let first = patch.faces[0].iter().map(|p| project(self.places[*p]));
        !patch.outline.is_empty() && places().all(finite) && twice_area(first) > 0.0
    }

    /// The patches that look at the viewer, from back to front.
    pub fn visible(&self) -> Vec<&Patch> {
        let mut visible: Vec<(f64, &Patch)> = self
            .patches
            .iter()
            .filter(|patch| self.faces_viewer(patch))
            .map(|patch| {
                let corners = patch.outline.iter().flatten();
                let total: f64 = corners.map(|p| depth(self.places[*p])).sum();
                (total / (2 * patch.outline.len()) as f64, patch)
            })
            .collect();
        visible.sort_by(|a, b| a.0.total_cmp(&b.0));
        visible.into_iter().map(|(_, patch)| patch).collect()
    }
}

/// Where the projection lies on paper.
pub struct Sheet {
    /// What is shown of the projection [m].
    pub shown: Box2,
    /// Millimetres per metre.
    pub scale: f64,
    /// Lower left corner [mm].
    pub left: f64,
    pub bottom: f64,
}

impl Sheet {
    /// A place of the body on paper [mm].
    pub fn at(&self, place: [f64; 3]) -> [f64; 2] {
        let [x, y] = project(place);
        [
            self.left + self.scale * (x - self.shown.low[0]),
            self.bottom - self.scale * (y - self.shown.low[1]),
        ]
    }
}

fn finite(place: [f64; 3]) -> bool {
    place.iter().all(|c| c.is_finite())
}

/// Isometric projection: right and up on the paper [m].
pub fn project([x, y, z]: [f64; 3]) -> [f64; 2] {
    [(y - x) / 2f64.sqrt(), (2.0 * z - x - y) / 6f64.sqrt()]
}

/// Distance towards the viewer.
fn depth([x, y, z]: [f64; 3]) -> f64 {
    (x + y + z) / 3f64.sqrt()
}

/// Twice the area of a projected outline, positive if it runs counterclockwise, that is if its outward normal points to
/// the viewer.
fn twice_area(corners: impl Iterator<Item = [f64; 2]>) -> f64 {
    let corners: Vec<[f64; 2]> = corners.collect();
    let n = corners.len();
    let part = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % n]);
        a[0] * b[1] - b[0] * a[1]
    };
    (0..n).map(part).sum()
}

/// The three axes with their names.
pub fn draw_triad(canvas: &mut Canvas, origin: [f64; 2]) {
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
