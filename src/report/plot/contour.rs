//! Contours on the deformed shape of a plane body: u_x and u_y side by side, or von Mises' stress.

use super::axis::{Axis, range};
use super::bands::{self, Pixel, Triangle, chains};
use super::canvas::{
    Anchor, CAPTION_PT, Canvas, LABEL_PT, TICK_PT, Width, caption_height, italic, pixel, wrapped,
};
use super::colour::{BLACK, LIGHT};
use super::field::{DISPLACEMENT, Field, Magnification, STRESS, full_caption, point_vector};
use super::outline::{Face, Weld, cell_scalar, outline};
use super::surface::SIDE;
use crate::model::field_mesh::{CellShape, FieldMesh};
use crate::report::ReportError;
use std::collections::BTreeSet;

/// Faces below this size on paper are not refined [pixels].
const SMALL: i32 = 12;
/// Least and greatest height of a colour bar [mm].
const BAR_MM: [f64; 2] = [32.0, 60.0];

/// Displacement components u_x and u_y of a 2D picture as filled bands on the deformed shape.
///
/// Needs the point vector `displacement_m`. Boundary edges, crack faces with doubled nodes among them, are drawn black,
/// the undeformed outline grey. `caption` is small text above the panels.
///
/// # Errors
/// [`ReportError::FieldMesh`] when the picture is not 2D, has no area, or lacks the vector.
pub fn displacement_contours(
    picture: &FieldMesh,
    magnification: Magnification,
    caption: &str,
) -> Result<String, ReportError> {
    let displacement = point_vector(picture, DISPLACEMENT)?;
    let fields = [0, 1].map(|component| Field::displacement(displacement, component));
    contours(picture, &fields, magnification, "Displacement", caption)
}

/// von Mises' equivalent stress of a 2D picture as filled bands on the deformed shape, see [`displacement_contours`];
/// needs the cell scalar `von_mises_pa` too, of which points show the mean over their cells.
///
/// # Errors
/// Those of [`displacement_contours`].
pub fn von_mises_contours(
    picture: &FieldMesh,
    magnification: Magnification,
    caption: &str,
) -> Result<String, ReportError> {
    let field = Field::von_mises(picture)?;
    let caption = format!("{caption}, {STRESS}");
    contours(picture, &[field], magnification, "Stress", &caption)
}

/// One or two fields as panels.
fn contours(
    picture: &FieldMesh,
    fields: &[Field],
    magnification: Magnification,
    title: &str,
    caption: &str,
) -> Result<String, ReportError> {
    if picture.dim != 2 {
        let reason = format!("{} dimensions, contours need 2", picture.dim);
        return Err(ReportError::field_mesh("picture", reason));
    }
    let displacement = point_vector(picture, DISPLACEMENT)?;
    let size = Box2::around(picture.points.iter().map(|p| [p[0], p[1]]))
        .ok_or_else(|| ReportError::field_mesh("points", "no finite points".into()))?;
    let largest = displacement
        .iter()
        .map(|u| u[0].hypot(u[1]))
        .filter(|u| u.is_finite())
        .fold(0.0, f64::max);
    let factor = magnification.factor(size.diameter(), largest);
    let places: Vec<[f64; 2]> = picture
        .points
        .iter()
        .zip(displacement)
        .map(|(x, u)| [x[0] + factor * u[0], x[1] + factor * u[1]])
        .collect();
    let Some(deformed) = Box2::around(places.iter().copied()) else {
        return Err(ReportError::field_mesh(
            DISPLACEMENT,
            "no finite values".into(),
        ));
    };
    let shown = deformed.joined(&size);
    let faces = plane_faces(picture, &places)?;
    let outline = outline(picture, &faces, &Weld::new(picture, displacement));

    let body = Body {
        picture,
        places,
        outline,
        faces,
        shown,
    };
    let layout = Layout::new(&body.shown, fields.len());
    let caption = full_caption(caption, factor);
    let lines = wrapped(&caption, CAPTION_PT, layout.width - 3.0);
    let top = caption_height(&lines);
    let mut canvas = Canvas::new(layout.width, top + layout.height());
    canvas.caption(&lines);
    for (panel, field) in fields.iter().enumerate() {
        let [x, y] = layout.origin(panel);
        draw_field(&mut canvas, &body, field, [x, top + y], &layout);
    }
    canvas.finish(&format!("{title}: {caption}"))
}

/// What is drawn, the same in all panels.
struct Body<'a> {
    picture: &'a FieldMesh,
    /// Deformed positions [m].
    places: Vec<[f64; 2]>,
    faces: Vec<Face>,
    /// Edges of the boundary and of crack faces.
    outline: Vec<[usize; 2]>,
    /// Undeformed and deformed body together [m].
    shown: Box2,
}

/// Panels side by side, or one above the other for flat bodies; a single one takes a column.
struct Layout {
    panels: usize,
    stacked: bool,
    /// Width of the figure [mm].
    width: f64,
    /// Millimetres on paper per metre.
    scale: f64,
    body: [f64; 2],
}

impl Layout {
    /// Room left of a body for the axis, right of it for the colour bar, above and below it [mm].
    const LEFT: f64 = 13.0;
    const RIGHT: f64 = 20.0;
    const ABOVE: f64 = 6.0;
    const BELOW: f64 = 10.0;

    fn new(shown: &Box2, panels: usize) -> Self {
        let stacked = shown.width() > 2.5 * shown.height();
        let width = match panels {
            1 if !stacked => Width::Column.mm(),
            _ => Width::Page.mm(),
        };
        let panel = if stacked {
            width
        } else {
            width / panels as f64
        };
        let room = [panel - Self::LEFT - Self::RIGHT, 90.0];
        let scale = (room[0] / shown.width()).min(room[1] / shown.height());
        Self {
            panels,
            stacked,
            width,
            scale,
            body: [scale * shown.width(), scale * shown.height()],
        }
    }

    /// A flat body leaves room for a readable colour bar all the same.
    fn panel_height(&self) -> f64 {
        Self::ABOVE + self.body[1].max(BAR_MM[0]) + Self::BELOW
    }

    fn height(&self) -> f64 {
        if self.stacked {
            self.panels as f64 * self.panel_height()
        } else {
            self.panel_height()
        }
    }

    /// Lower left corner of the body in a panel.
    fn origin(&self, panel: usize) -> [f64; 2] {
        let n = panel as f64;
        let bottom = self.panel_height() - Self::BELOW;
        if self.stacked {
            [Self::LEFT, bottom + n * self.panel_height()]
        } else {
            [Self::LEFT + n * self.width / self.panels as f64, bottom]
        }
    }
}

/// Bands of a field, outlines, axes, colour bar.
fn draw_field(
    canvas: &mut Canvas,
    body: &Body<'_>,
    field: &Field,
    origin: [f64; 2],
    layout: &Layout,
) {
    let [left, bottom] = origin;
    let (scale, shown) = (layout.scale, &body.shown);
    let paper = |[x, y]: [f64; 2]| {
        pixel([
            left + scale * (x - shown.low[0]),
            bottom - scale * (y - shown.low[1]),
        ])
    };
    let undeformed = |point: usize| {
        let [x, y, _] = body.picture.points[point];
        paper([x, y])
    };
    let deformed = |point: usize| paper(body.places[point]);
    stroke(canvas, &body.outline, undeformed, LIGHT, 0.15);
    let corner = |point: usize| (deformed(point), field.values[point]);
    let triangles: Vec<Triangle> = body
        .faces
        .iter()
        .flat_map(|face| split(&face.points, corner))
        .collect();
    bands::fill(canvas, &triangles, &field.levels, 0.05);
    stroke(canvas, &body.outline, deformed, BLACK, 0.2);

    draw_axes(canvas, [left - 1.5, bottom + 1.5], shown, scale);
    let bar = [left + layout.body[0] + 4.0, bottom];
    let height = layout.body[1].clamp(BAR_MM[0], BAR_MM[1]);
    bands::colour_bar(canvas, &field.levels, bar, height, &field.label);
}

/// Left and lower axis, a little off the body.
fn draw_axes(canvas: &mut Canvas, origin: [f64; 2], shown: &Box2, scale: f64) {
    // About a tick every 12 mm, fewer on short axes.
    let count = |length: f64| ((scale * length / 12.0) as usize).clamp(2, 5);
    let ticks = |label: &str, c: usize| {
        let (low, high) = (shown.low[c], shown.high[c]);
        Axis::linear(label, [low, high], count(high - low))
    };
    let inside = |c: usize, v: f64| v >= shown.low[c] && v <= shown.high[c];
    let end = [
        origin[0] + 1.5 + scale * shown.width(),
        origin[1] - 1.5 - scale * shown.height(),
    ];
    canvas.line(
        &[[origin[0], end[1]], origin, [end[0], origin[1]]],
        BLACK,
        0.15,
    );
    let (x, y) = (
        ticks(&format!("{} [m]", italic("x")), 0),
        ticks(&format!("{} [m]", italic("y")), 1),
    );
    for (value, label) in x.major.iter().filter(|(v, _)| inside(0, *v)) {
        let at = origin[0] + 1.5 + scale * (value - shown.low[0]);
        canvas.line(&[[at, origin[1]], [at, origin[1] + 0.8]], BLACK, 0.15);
        canvas.text(label, [at, origin[1] + 2.6], TICK_PT, Anchor::Middle, BLACK);
    }
    for (value, label) in y.major.iter().filter(|(v, _)| inside(1, *v)) {
        let at = origin[1] - 1.5 - scale * (value - shown.low[1]);
        canvas.line(&[[origin[0], at], [origin[0] - 0.8, at]], BLACK, 0.15);
        canvas.text(label, [origin[0] - 1.3, at], TICK_PT, Anchor::End, BLACK);
    }
    let middle = 0.5 * (origin[0] + end[0]);
    canvas.text(
        &x.label,
        [middle, origin[1] + 6.3],
        LABEL_PT,
        Anchor::Middle,
        BLACK,
    );
    let middle = 0.5 * (origin[1] + end[1]);
    canvas.text_upwards(&y.label, [origin[0] - 9.0, middle], LABEL_PT, BLACK);
}

/// All plane cells whose points have a finite place.
fn plane_faces(picture: &FieldMesh, places: &[[f64; 2]]) -> Result<Vec<Face>, ReportError> {
    let sides = cell_scalar(picture, SIDE);
    let mut faces = Vec::new();
    for (cell, side) in picture.cells.iter().zip(sides) {
        if let Some(point) = cell.points.iter().find(|p| **p >= places.len()) {
            return Err(ReportError::field_mesh(
                "cells",
                format!("point {point} of {}", places.len()),
            ));
        }
        let drawn = cell
            .points
            .iter()
            .all(|p| places[*p].iter().all(|c| c.is_finite()));
        if let CellShape::Triangle | CellShape::Polygon | CellShape::Quad = cell.shape {
            faces.extend(drawn.then(|| Face {
                points: cell.points.clone(),
                side,
            }));
        }
    }
    if faces.is_empty() {
        return Err(ReportError::field_mesh(
            "cells",
            "no triangle, polygon or quad to draw".into(),
        ));
    }
    Ok(faces)
}

/// A face as triangles: itself, or a fan around its middle, where the field is the mean (for a bilinear quad exactly so).
pub fn split(face: &[usize], corner: impl Fn(usize) -> (Pixel, f64)) -> Vec<Triangle> {
    let corners: Vec<(Pixel, f64)> = face.iter().map(|p| corner(*p)).collect();
    match corners[..] {
        [a, b, c] => return vec![[a, b, c]],
        // Nobody sees the middle of a face that is a fraction of a millimetre wide.
        [a, b, c, d] if extent(&corners) < SMALL => return vec![[a, b, c], [a, c, d]],
        _ => {}
    }
    let n = corners.len();
    let mean = |c: usize| {
        let sum: f64 = corners.iter().map(|(p, _)| f64::from(p[c])).sum();
        (sum / n as f64).round() as i32
    };
    let value = corners.iter().map(|(_, v)| v).sum::<f64>() / n as f64;
    let middle = ([mean(0), mean(1)], value);
    (0..n)
        .map(|i| [corners[i], corners[(i + 1) % n], middle])
        .collect()
}

/// Largest side of the upright rectangle around the corners [pixels].
fn extent(corners: &[(Pixel, f64)]) -> i32 {
    let along = |c: usize| {
        let values = || corners.iter().map(|(p, _)| p[c]);
        values().max().unwrap_or(0) - values().min().unwrap_or(0)
    };
    along(0).max(along(1))
}

/// Lines along edges, joined where they meet.
pub(super) fn stroke(
    canvas: &mut Canvas,
    edges: &[[usize; 2]],
    place: impl Fn(usize) -> Pixel,
    colour: [u8; 3],
    width: f64,
) {
    let edges: BTreeSet<[Pixel; 2]> = edges
        .iter()
        .map(|[a, b]| (place(*a), place(*b)))
        .filter(|(a, b)| a != b)
        .map(|(a, b)| [a.min(b), a.max(b)])
        .collect();
    for line in chains(&edges) {
        canvas.pixel_line(line, colour, width);
    }
}

/// An upright rectangle.
#[derive(Debug, Clone, Copy)]
pub struct Box2 {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Box2 {
    /// The smallest that holds all points; none without finite points or without extent.
    pub fn around(points: impl Iterator<Item = [f64; 2]> + Clone) -> Option<Self> {
        let (x0, x1) = range(points.clone().map(|p| p[0]))?;
        let (y0, y1) = range(points.map(|p| p[1]))?;
        (x1 > x0 && y1 > y0).then_some(Self {
            low: [x0, y0],
            high: [x1, y1],
        })
    }

    fn joined(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|c| self.low[c].min(other.low[c])),
            high: std::array::from_fn(|c| self.high[c].max(other.high[c])),
        }
    }

    pub fn width(&self) -> f64 {
        self.high[0] - self.low[0]
    }

    pub fn height(&self) -> f64 {
        self.high[1] - self.low[1]
    }

    pub fn diameter(&self) -> f64 {
        self.width().hypot(self.height())
    }
}
