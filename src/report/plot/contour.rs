//! Contours on the deformed shape of a plane body: u_x and u_y side by side, or von Mises' stress.

use super::axis::{Axis, prefixed, range};
use super::bands::{self, Levels, Triangle};
use super::canvas::{
    Anchor, COLUMN, Canvas, Head, LABEL_PT, PAGE, Pixel, TICK_PT, italic, pixel, subscript,
};
use super::mesh::{Box2, DISPLACEMENT, deformed, outline, point_vector, stroke};
use super::style::{BLACK, LIGHT};
use crate::model::field_mesh::{CellShape, FieldMesh};
use crate::report::ReportError;
use crate::report::number::significant;

/// Name of the cell scalar with von Mises' equivalent stress.
const VON_MISES: &str = "von_mises_pa";
/// Part of the body that a colour bar covers for certain: the stress at a tip has no bound.
const COVERED: f64 = 0.98;
/// A largest value up to this factor above that part is covered too.
const NEAR: f64 = 1.5;
/// Faces below this size on paper are not refined [pixels].
const SMALL: i32 = 12;
/// Least and greatest height of a colour bar [mm].
const BAR_MM: [f64; 2] = [32.0, 60.0];
/// Room left of a body for the axis, right of it for the colour bar, above and below it [mm].
const LEFT: f64 = 13.0;
const RIGHT: f64 = 20.0;
const ABOVE: f64 = 6.0;
const BELOW: f64 = 10.0;

/// A scalar field on the points of a picture, in the unit of its label.
struct Field {
    values: Vec<f64>,
    levels: Levels,
    label: String,
}

/// Displacement components u_x and u_y of a plane picture as filled bands on the deformed shape.
///
/// Needs the point vector `displacement_m`. Boundary and crack faces are drawn black, the undeformed outline grey; `run` is
/// small text above the panels.
///
/// # Errors
/// [`ReportError::FieldMesh`] when the picture is not plane, has no area, or lacks the vector.
pub fn displacement(picture: &FieldMesh, run: &str) -> Result<String, ReportError> {
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
    let (largest, unit) = told(lengths.fold(0.0, f64::max), "m");
    let title = format!("Displacement, at most {largest} {unit}");
    contours(picture, &[field(0), field(1)], &title, run)
}

/// von Mises' equivalent stress of a plane picture as filled bands on the deformed shape, see [`displacement`]; needs the
/// cell scalar `von_mises_pa` too.
///
/// Points show the mean over their cells, weighted by size; those on the two faces of a crack are two, so nothing is
/// averaged across it. The colour bar ends where all but a fiftieth of the body lies below, if the largest value is far
/// above that.
///
/// # Errors
/// Those of [`displacement`].
pub fn von_mises(picture: &FieldMesh, run: &str) -> Result<String, ReportError> {
    let given = picture.cell_scalars.iter().find(|(n, _)| n == VON_MISES);
    let stress = given.map_or(&[][..], |(_, values)| values);
    if stress.len() != picture.cells.len() {
        let reason = format!("{} values for {} cells", stress.len(), picture.cells.len());
        return Err(ReportError::field_mesh(VON_MISES, reason));
    }
    let mut sums = vec![[0.0; 2]; picture.points.len()];
    for (cell, stress) in picture
        .cells
        .iter()
        .zip(stress)
        .filter(|(_, s)| s.is_finite())
    {
        let x = |i: usize| {
            cell.points
                .get(i % cell.points.len())
                .and_then(|p| picture.points.get(*p))
        };
        let part = |i: usize| {
            x(i).zip(x(i + 1))
                .map_or(0.0, |(a, b)| a[0] * b[1] - b[0] * a[1])
        };
        let size = 0.5 * (0..cell.points.len()).map(part).sum::<f64>().abs();
        for point in &cell.points {
            if let Some([sum, weight]) = sums.get_mut(*point) {
                (*sum, *weight) = (*sum + size * stress, *weight + size);
            }
        }
    }
    let mut means: Vec<[f64; 2]> = sums
        .iter()
        .map(|[sum, weight]| [sum / weight, *weight])
        .collect();
    let values: Vec<f64> = means.iter().map(|mean| mean[0]).collect();
    let (low, high) = range(values.iter().copied()).unwrap_or((0.0, 0.0));
    means.retain(|mean| mean[0].is_finite());
    means.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut left = COVERED * means.iter().map(|mean| mean[1]).sum::<f64>();
    let covered = means.iter().find(|mean| {
        left -= mean[1];
        left <= 0.0
    });
    let covered = covered.map_or(0.0, |mean| mean[0]);
    let end = if high > NEAR * covered { covered } else { high };
    let (factor, unit) = prefixed(end, "Pa");
    let field = Field {
        values: values.iter().map(|value| value * factor).collect(),
        levels: Levels::new(low * factor, end * factor).reaching(high * factor),
        label: format!("{}{} [{unit}]", italic("σ"), subscript("vM")),
    };
    let (most, unit) = told(covered, "Pa");
    let title = format!("Von Mises stress, below {most} {unit} in 98 % of the body");
    contours(picture, &[field], &title, run)
}

fn told(value: f64, unit: &str) -> (String, String) {
    let (factor, unit) = prefixed(value, unit);
    (significant(value * factor, 3), unit)
}

/// What is drawn, the same in all panels.
struct Body {
    faces: Vec<Vec<usize>>,
    outline: Vec<[usize; 2]>,
    /// Undeformed and deformed places [m].
    places: [Vec<[f64; 2]>; 2],
    /// Undeformed and deformed body together [m].
    shown: Box2,
    /// Millimetres on paper per metre.
    scale: f64,
}

/// One or two fields as panels side by side, one above the other for flat bodies; a single one takes a column.
fn contours(
    picture: &FieldMesh,
    fields: &[Field],
    title: &str,
    run: &str,
) -> Result<String, ReportError> {
    if picture.dim != 2 {
        let reason = format!("{} dimensions, contours need 2", picture.dim);
        return Err(ReportError::field_mesh("picture", reason));
    }
    let (moved, factor) = deformed(picture)?;
    let plane = |points: &[[f64; 3]]| {
        points
            .iter()
            .map(|p| [p[0], p[1]])
            .collect::<Vec<[f64; 2]>>()
    };
    let places = [plane(&picture.points), plane(&moved)];
    let shown = Box2::around(places.iter().flatten().copied())
        .ok_or_else(|| ReportError::field_mesh(DISPLACEMENT, "no finite values".into()))?;
    let faces = faces(picture, &places[1])?;
    let stacked = shown.width() > 2.5 * shown.height();
    let count = fields.len() as f64;
    let width = if count == 1.0 && !stacked {
        COLUMN
    } else {
        PAGE
    };
    let panel = if stacked { width } else { width / count };
    let scale = ((panel - LEFT - RIGHT) / shown.width()).min(90.0 / shown.height());
    let outline = outline(picture, &faces);
    let body = Body {
        faces,
        outline,
        places,
        shown,
        scale,
    };
    let head = Head::new(
        title,
        &format!("{run}, deformation ×{}", significant(factor, 1)),
        width,
    );
    // A flat body leaves room for a readable colour bar all the same.
    let height = ABOVE + (scale * shown.height()).max(BAR_MM[0]) + BELOW;
    let mut canvas = Canvas::new(
        width,
        head.height() + if stacked { count * height } else { height },
    );
    head.draw(&mut canvas);
    for (index, field) in fields.iter().enumerate() {
        let bottom = head.height() + height - BELOW;
        let n = index as f64;
        let origin = if stacked {
            [LEFT, bottom + n * height]
        } else {
            [LEFT + n * panel, bottom]
        };
        body.draw(&mut canvas, field, origin);
    }
    canvas.finish(&format!("{title}: {run}"))
}

impl Body {
    /// Bands of a field, outlines, axes, colour bar; the lower left corner of the body is at the origin [mm].
    fn draw(&self, canvas: &mut Canvas, field: &Field, [left, bottom]: [f64; 2]) {
        let (low, scale) = (self.shown.low, self.scale);
        let paper =
            |[x, y]: [f64; 2]| pixel([left + scale * (x - low[0]), bottom - scale * (y - low[1])]);
        let place = |which: usize, point: usize| paper(self.places[which][point]);
        stroke(canvas, &self.outline, |p| place(0, p), LIGHT, 0.15);
        let corner = |p: usize| (place(1, p), field.values[p]);
        let triangles = self.faces.iter().flat_map(|face| split(face, corner));
        bands::fill(canvas, &triangles.collect::<Vec<_>>(), &field.levels, 0.05);
        stroke(canvas, &self.outline, |p| place(1, p), BLACK, 0.2);
        self.draw_axes(canvas, [left, bottom]);
        let size = [scale * self.shown.width(), scale * self.shown.height()];
        let height = size[1].clamp(BAR_MM[0], BAR_MM[1]);
        bands::colour_bar(
            canvas,
            &field.levels,
            [left + size[0] + 4.0, bottom],
            height,
            &field.label,
        );
    }

    /// Left and lower axis, a little off the body.
    fn draw_axes(&self, canvas: &mut Canvas, [left, bottom]: [f64; 2]) {
        let Box2 { low, high } = self.shown;
        let end = [0, 1].map(|c| self.scale * (high[c] - low[c]));
        let origin = [left - 1.5, bottom + 1.5];
        canvas.line(
            &[
                [origin[0], bottom - end[1]],
                origin,
                [left + end[0], origin[1]],
            ],
            BLACK,
            0.15,
        );
        for c in [0, 1] {
            // About a tick every 12 mm, fewer on short axes.
            let count = ((end[c] / 12.0) as usize).clamp(2, 5);
            let axis = Axis::linear(&format!("{} [m]", italic(["x", "y"][c])));
            let Some(axis) = axis.fitted([low[c], high[c]], count) else {
                continue;
            };
            for (value, label) in axis
                .major
                .iter()
                .filter(|(v, _)| *v >= low[c] && *v <= high[c])
            {
                let along = self.scale * (value - low[c]);
                let (at, out, text, anchor) = if c == 0 {
                    let at = [left + along, origin[1]];
                    (
                        at,
                        [at[0], at[1] + 0.8],
                        [at[0], at[1] + 2.6],
                        Anchor::Middle,
                    )
                } else {
                    let at = [origin[0], bottom - along];
                    (at, [at[0] - 0.8, at[1]], [at[0] - 1.3, at[1]], Anchor::End)
                };
                canvas.line(&[at, out], BLACK, 0.15);
                canvas.text(label, text, TICK_PT, anchor, BLACK);
            }
            let (at, anchor) = match c {
                0 => ([left + 0.5 * end[0], origin[1] + 6.3], Anchor::Middle),
                _ => ([origin[0] - 9.0, bottom - 0.5 * end[1]], Anchor::Upwards),
            };
            canvas.text(&axis.label, at, LABEL_PT, anchor, BLACK);
        }
    }
}

/// All plane cells whose points have a finite place.
fn faces(picture: &FieldMesh, places: &[[f64; 2]]) -> Result<Vec<Vec<usize>>, ReportError> {
    let mut faces = Vec::new();
    for cell in &picture.cells {
        if let Some(point) = cell.points.iter().find(|p| **p >= places.len()) {
            let reason = format!("point {point} of {}", places.len());
            return Err(ReportError::field_mesh("cells", reason));
        }
        let plane = matches!(
            cell.shape,
            CellShape::Triangle | CellShape::Polygon | CellShape::Quad
        );
        if plane
            && cell
                .points
                .iter()
                .all(|p| places[*p].iter().all(|c| c.is_finite()))
        {
            faces.push(cell.points.clone());
        }
    }
    match faces.is_empty() {
        true => Err(ReportError::field_mesh(
            "cells",
            "no triangle, polygon or quad to draw".into(),
        )),
        false => Ok(faces),
    }
}

/// A face as triangles: itself, or a fan around its middle, where the field is the mean (for a bilinear quad exactly so).
fn split(face: &[usize], corner: impl Fn(usize) -> (Pixel, f64)) -> Vec<Triangle> {
    let corners: Vec<(Pixel, f64)> = face.iter().map(|p| corner(*p)).collect();
    let extent = |c: usize| {
        let values = || corners.iter().map(|(p, _)| p[c]);
        values().max().unwrap_or(0) - values().min().unwrap_or(0)
    };
    match corners[..] {
        [a, b, c] => return vec![[a, b, c]],
        // Nobody sees the middle of a face that is a fraction of a millimetre wide.
        [a, b, c, d] if extent(0).max(extent(1)) < SMALL => return vec![[a, b, c], [a, c, d]],
        _ => {}
    }
    let n = corners.len() as f64;
    let mean =
        |c: usize| (corners.iter().map(|(p, _)| f64::from(p[c])).sum::<f64>() / n).round() as i32;
    let middle = (
        [mean(0), mean(1)],
        corners.iter().map(|(_, v)| v).sum::<f64>() / n,
    );
    (0..corners.len())
        .map(|i| [corners[i], corners[(i + 1) % corners.len()], middle])
        .collect()
}
