//! Displacement of a plane body as bands on its deformed shape: u_x and u_y side by side, one above the other for flat bodies.

use super::axis::{Axis, prefixed, range};
use super::bands::{self, Bands, Levels};
use super::canvas::*;
use super::colour::{BLACK, MIDDLE};
use super::contact::States;
use super::figure::{draw_labels, room_for_labels};
use super::mesh::{Box2, DISPLACEMENT, conforming, deformed, fail, outline, point_vector, stroke};
use super::panel::{Place, draw_panel};
use super::series::Panel;
use crate::model::field_mesh::{CellShape, FieldCell, FieldMesh, FieldStep};
use crate::report::ReportError;
use crate::report::number::significant;
use rayon::prelude::*;
use stickslip_xfem::geometry::polygon;

/// Least and greatest height of a colour bar, and room right of a body for it [mm].
const BAR_MM: [f64; 2] = [32.0, 60.0];
const RIGHT: f64 = 19.0;
/// Room above and below a body [mm].
const ABOVE: f64 = 5.0;
const BELOW: f64 = 10.0;
/// Width of an undeformed crack, and room for what its tints mean [mm].
const STRIP_MM: f64 = 0.8;
const LEGEND_MM: f64 = 4.0;

/// A scalar field on the points of a picture, in the unit of its label.
struct Field {
    values: Vec<f64>,
    levels: Levels,
    label: String,
}

/// Displacement components u_x and u_y of a plane body as filled bands on the deformed shape, its cracks undeformed in the tints of
/// their status.
///
/// Needs the point vector `displacement_m`. Boundary and crack faces are drawn black, the undeformed outline grey; `run` is
/// small text above the panels.
///
/// # Errors
/// [`ReportError::FieldMesh`] when the picture is not plane, has no area, or lacks the vector.
pub fn displacement(step: &FieldStep, run: &str) -> Result<String, ReportError> {
    let picture = &step.body;
    let u = point_vector(picture, DISPLACEMENT)?;
    let field = |c: usize| {
        let (low, high) = range(u.iter().map(|u| u[c])).unwrap_or((0.0, 0.0));
        let (factor, unit) = prefixed(low.abs().max(high.abs()), "m");
        Field {
            values: u.iter().map(|u| u[c] * factor).collect(),
            levels: Levels::new(low * factor, high * factor),
            label: format!("{}{} [{unit}]", italic("u"), subscript(["x", "y"][c])),
        }
    };
    let lengths = u.iter().map(|u| u[0].hypot(u[1])).filter(|u| u.is_finite());
    let largest = told(lengths.fold(0.0, f64::max), "m");
    let states = States::new(&step.crack)?;
    let mut title = format!("Displacement, at most {largest}");
    if !step.crack.cells.is_empty() {
        title = format!("{}; displacement at most {largest}", states.title());
    }
    contours(step, &states, &[field(0), field(1)], &title, run)
}

fn told(value: f64, unit: &str) -> String {
    let (factor, unit) = prefixed(value, unit);
    format!("{} {unit}", significant(value * factor, 3))
}

/// The drawing, the same in all panels.
struct Body<'a> {
    faces: Vec<Vec<usize>>,
    outline: Vec<[usize; 2]>,
    /// Undeformed and deformed places [m].
    places: [Vec<[f64; 2]>; 2],
    /// The cracks, undeformed.
    crack: &'a FieldMesh,
    states: &'a States,
}

/// Two fields as panels.
fn contours(
    step: &FieldStep,
    states: &States,
    fields: &[Field; 2],
    title: &str,
    run: &str,
) -> Result<String, ReportError> {
    let picture = &step.body;
    if picture.dim != 2 {
        let reason = format!("{} dimensions, contours need 2", picture.dim);
        return fail("picture", &reason);
    }
    let (moved, factor) = deformed(picture)?;
    let places = [&picture.points, &moved];
    let places = places.map(|points| points.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>());
    let mut faces = conforming(picture, faces(picture, &places[1])?);
    for face in &mut faces {
        let corners: Vec<[f64; 3]> = face.iter().map(|p| moved[*p]).collect();
        if polygon::area(&corners) < 0.0 {
            face.reverse();
        }
    }
    let outline = outline(&faces).into_iter().collect();
    let Some(shown) = Box2::around(places.iter().flatten().copied()) else {
        return fail(DISPLACEMENT, "no finite values");
    };
    let body = Body {
        faces,
        outline,
        places,
        crack: &step.crack,
        states,
    };
    let stacked = shown.width() > 2.5 * shown.height();
    let share = if stacked { PAGE } else { PAGE / 2.0 };
    let axis = |c: usize| Axis::linear(&format!("{} [m]", italic(["x", "y"][c])));
    let fitted = |c: usize| axis(c).fitted([shown.low[c], shown.high[c]], 5);
    let (Some(x), Some(y)) = (fitted(0), fitted(1)) else {
        return fail(DISPLACEMENT, "no finite values");
    };
    let left = room_for_labels(&y);
    let scale = ((share - left - RIGHT) / x.span()).min(90.0 / y.span());
    let size = [scale * x.span(), scale * y.span()];
    let panel = Panel::new(x, y, size[1]);
    let caption = format!("{run}, deformation ×{}", significant(factor, 1));
    let head = Head::new(title, &caption, PAGE);
    // A flat body leaves room for a readable colour bar all the same.
    let height = ABOVE + size[1].max(BAR_MM[0]) + BELOW;
    let rows = if stacked { 2.0 } else { 1.0 };
    let drawn = head.height() + rows * height;
    let legend = if step.crack.cells.is_empty() {
        0.0
    } else {
        LEGEND_MM
    };
    let mut canvas = Canvas::new(PAGE, drawn + legend);
    head.draw(&mut canvas);
    states.legend(&mut canvas, [left, drawn + 1.0], false);
    let panels = fields.par_iter().enumerate().map(|(index, field)| {
        let [right, down] = if stacked { [0.0, height] } else { [share, 0.0] };
        let left = left + index as f64 * right;
        let bottom = head.height() + height - BELOW + index as f64 * down;
        let place = Place {
            x: [left, left + size[0]],
            y: [bottom - size[1], bottom],
        };
        let bands = body.bands(field, |p| pixel(place.at(&panel, p)));
        (field, place, bands)
    });
    for (field, place, bands) in panels.collect::<Vec<_>>() {
        draw_panel(&mut canvas, &panel, &[], &place);
        draw_labels(&mut canvas, &panel, &place, [true, true]);
        body.draw(&mut canvas, (field, &bands), |p| pixel(place.at(&panel, p)));
        let bar = [place.x[1] + 3.0, place.y[1]];
        let height = size[1].clamp(BAR_MM[0], BAR_MM[1]);
        bands::colour_bar(&mut canvas, &field.levels, bar, height, &field.label);
    }
    canvas.finish(&format!("{title}: {run}"))
}

impl Body<'_> {
    /// Bands of a field on the deformed shape.
    fn bands(&self, field: &Field, paper: impl Fn([f64; 2]) -> Pixel) -> Bands {
        let pixels: Vec<Pixel> = self.places[1].iter().map(|x| paper(*x)).collect();
        let corner = |p: usize| (pixels[p], field.values[p]);
        bands::bands(&self.faces, corner, &field.levels)
    }

    /// They, between the undeformed and the deformed outline.
    fn draw(
        &self,
        canvas: &mut Canvas,
        (field, bands): (&Field, &Bands),
        paper: impl Fn([f64; 2]) -> Pixel,
    ) {
        let place = |which: usize, point: usize| paper(self.places[which][point]);
        stroke(canvas, &self.outline, |p| place(0, p), MIDDLE, 0.2);
        bands::fill(canvas, bands, &field.levels, 0.05);
        stroke(canvas, &self.outline, |p| place(1, p), BLACK, 0.2);
        self.draw_states(canvas, paper);
    }

    /// The cracks before deformation: half of every facet in the state of its end.
    fn draw_states(&self, canvas: &mut Canvas, paper: impl Fn([f64; 2]) -> Pixel) {
        let lines = self
            .crack
            .cells
            .iter()
            .filter(|c| c.shape == CellShape::Line);
        let lines: Vec<&FieldCell> = lines.collect();
        let at = |point: usize| [0, 1].map(|c| self.crack.points[point][c]);
        for edge in [true, false] {
            for line in &lines {
                let [Some(&a), Some(&b)] = [line.points.first(), line.points.last()] else {
                    continue;
                };
                let middle = [0, 1].map(|c| (at(a)[c] + at(b)[c]) / 2.0);
                for point in [a, b] {
                    let half = vec![paper(at(point)), paper(middle)];
                    let (colour, width) = if edge {
                        (BLACK, STRIP_MM + 0.3)
                    } else {
                        (self.states.tint(point), STRIP_MM)
                    };
                    canvas.pixel_line(half, colour, width);
                }
            }
        }
    }
}

/// All plane cells whose points have a finite place.
fn faces(picture: &FieldMesh, places: &[[f64; 2]]) -> Result<Vec<Vec<usize>>, ReportError> {
    let mut faces = Vec::new();
    for cell in &picture.cells {
        let corners = cell.points.iter().map(|p| places.get(*p));
        let Some(corners) = corners.collect::<Option<Vec<_>>>() else {
            return fail("cells", &format!("a point beyond {}", places.len()));
        };
        use CellShape::{Polygon, Quad, Triangle};
        let plane = matches!(cell.shape, Triangle | Polygon | Quad);
        if plane && corners.into_iter().flatten().all(|c| c.is_finite()) {
            faces.push(cell.points.clone());
        }
    }
    if faces.is_empty() {
        fail("cells", "no triangle, polygon or quad to draw")
    } else {
        Ok(faces)
    }
}
