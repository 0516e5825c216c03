//! Contact status on the crack inside a solid, with arrows for the slip.
//!
//! The view is that of [`super::solid`]. Where the crack parts the solid, what is in front of it is drawn as an outline and
//! what is behind it as a body; otherwise the whole solid is an outline. Status is told by tint and marker.

use super::axis::prefixed;
use super::bands::{Pixel, Region};
use super::canvas::{
    Anchor, CAPTION_PT, Canvas, SMALL_PT, TICK_PT, Width, caption_height, pixel, wrapped,
};
use super::colour::{BLACK, GREY, Rgb};
use super::contour::{Box2, stroke};
use super::field::{DISPLACEMENT, Magnification, full_caption, point_vector};
use super::opened_solid::{Lookup, OpenedSolid, Plane, dot, sum};
use super::solid::{Deformed, Sheet, draw_triad, project};
use super::style::{draw_marker, status_marker};
use crate::model::field_mesh::{CellShape, FieldMesh, FieldStep};
use crate::report::ReportError;
use crate::report::number::significant;

/// Status by its value in the point scalar `status`, and its tint; in grey the tints are 1, 0.5 and 0.8.
const STATUS: [(&str, Rgb); 3] = [
    ("open", [255, 255, 255]),
    ("stick", [86, 135, 190]),
    ("slip", [244, 200, 120]),
];

/// Least distance of markers [mm].
const APART_MM: f64 = 3.4;
/// Length of the longest arrow, unless it points to the viewer [mm].
const ARROW_MM: f64 = 5.0;
/// Arrows shorter than this fraction of the longest are left out.
const SHORTEST: f64 = 0.05;
/// Jumps below this fraction of the crack's size are what the tolerance of a method leaves.
const ROUND_OFF: f64 = 1e-10;
const LEGEND_MM: f64 = 5.0;

/// Open, stick and slip on the crack of a solid with arrows for its tangential jump, or for the tangential contact traction
/// on side 1 where nothing slips.
///
/// # Errors
/// [`ReportError::FieldMesh`] when the body is not 3D, the crack has no facets, or either lacks a field.
pub fn contact_status(
    step: &FieldStep,
    magnification: Magnification,
    caption: &str,
) -> Result<String, ReportError> {
    let (body, crack) = (&step.body, &step.crack);
    let shape = Deformed::new(body, magnification)?;
    let displacement = point_vector(body, DISPLACEMENT)?;
    let plane =
        Plane::of(crack).ok_or_else(|| ReportError::field_mesh("crack", "no facets".into()))?;
    let parts = OpenedSolid::new(body, displacement, &shape, &plane);
    let face = Face::new(crack, &plane)?;
    let shown = Box2::around(shape.places.iter().map(|p| project(*p)))
        .ok_or_else(|| ReportError::field_mesh(DISPLACEMENT, "no finite values".into()))?;

    let width = Width::Column.mm();
    let scale = ((width - 6.0) / shown.width()).min(75.0 / shown.height());
    let caption = full_caption(caption, shape.factor);
    let lines = wrapped(&caption, CAPTION_PT, width - 3.0);
    let bottom = caption_height(&lines) + 2.0 + scale * shown.height();
    let sheet = Sheet {
        left: 0.5 * (width - scale * shown.width()),
        bottom,
        shown,
        scale,
    };
    let lookup = Lookup::new(body, displacement, &parts.behind);
    let places: Vec<[f64; 3]> = crack
        .points
        .iter()
        .map(|x| sum(*x, shape.factor, lookup.at(*x)))
        .collect();
    // Beside or below the body, whichever corner it leaves free.
    let triad = [width - 9.0, bottom + 1.0];
    let legend = bottom + 4.0;
    let height = (legend + LEGEND_MM * face.legend_rows() as f64).max(triad[1] + 4.0);
    let mut canvas = Canvas::new(width, height);
    canvas.caption(&lines);

    let corner = |p: usize| pixel(sheet.at(shape.places[p]));
    let hidden = |seen: bool| {
        let edges = parts.edges.iter().filter(move |edge| edge.1 == seen);
        edges.map(|edge| edge.0).collect::<Vec<_>>()
    };
    for [a, b] in hidden(false) {
        let ends = [a, b].map(|p| sheet.at(shape.places[p]));
        canvas.dashed(&ends, GREY, 0.1, &[0.6, 0.6]);
    }
    for patch in &parts.body {
        let normal = plane_normal(&patch.faces[0], &shape.places);
        for points in &patch.faces {
            canvas.fill_region(
                &[points.iter().map(|p| corner(*p)).collect()],
                shade(normal),
            );
        }
        stroke(&mut canvas, &patch.outline, corner, GREY, 0.05);
    }
    face.fill(&mut canvas, |p| sheet.at(places[p]));
    stroke(&mut canvas, &hidden(true), corner, GREY, 0.15);
    face.marks(&mut canvas, &places, &sheet);
    face.legend(&mut canvas, [3.0, legend]);
    draw_triad(&mut canvas, triad);
    canvas.finish(&format!("Contact status: {caption}"))
}

/// The crack surface with what is drawn on it.
struct Face<'a> {
    crack: &'a FieldMesh,
    /// Index in [`STATUS`] per point.
    status: Vec<usize>,
    /// Tangential vector per point.
    arrows: Vec<[f64; 3]>,
    /// Length of the longest.
    largest: f64,
    /// What the arrows are, in the legend.
    label: String,
}

impl<'a> Face<'a> {
    fn new(crack: &'a FieldMesh, plane: &Plane) -> Result<Self, ReportError> {
        let status = crack.point_scalars.iter().find(|(n, _)| n == "status");
        let status = status.map(|(_, values)| values.as_slice()).unwrap_or(&[]);
        if status.len() != crack.points.len() {
            let reason = format!("{} values for {} points", status.len(), crack.points.len());
            return Err(ReportError::field_mesh("status", reason));
        }
        let tangential = |name: &str| -> Result<Vec<[f64; 3]>, ReportError> {
            let vectors = point_vector(crack, name)?.iter();
            Ok(vectors.map(|v| plane.tangential(*v)).collect())
        };
        let longest = |vectors: &[[f64; 3]]| {
            let lengths = vectors.iter().map(|v| dot(*v, *v).sqrt());
            lengths.filter(|l| l.is_finite()).fold(0.0, f64::max)
        };
        let size = crack
            .points
            .iter()
            .flatten()
            .fold(0.0_f64, |m, c| m.max(c.abs()));
        let jump = tangential("jump_m")?;
        let (arrows, what, unit) = if longest(&jump) > ROUND_OFF * size {
            (jump, "slip of side 1 against side 2", "m")
        } else {
            let traction = tangential("contact_traction_pa")?;
            (traction, "tangential traction on side 1", "Pa")
        };
        let largest = longest(&arrows);
        let (factor, unit) = prefixed(largest, unit);
        let number = significant(largest * factor, 3);
        let index = |value: &f64| (*value as usize).min(STATUS.len() - 1);
        Ok(Self {
            crack,
            status: status.iter().map(index).collect(),
            arrows,
            largest,
            label: format!("{what}, longest {number} {unit}"),
        })
    }

    /// Fills the facets: the part of a facet at each corner has that corner's status.
    fn fill(&self, canvas: &mut Canvas, at: impl Fn(usize) -> [f64; 2]) {
        let mut regions: [Region; 3] = std::array::from_fn(|_| Region::default());
        let facets = self
            .crack
            .cells
            .iter()
            .filter(|c| c.shape == CellShape::Polygon);
        for facet in facets {
            let corners: Vec<[f64; 2]> = facet.points.iter().map(|p| at(*p)).collect();
            let n = corners.len();
            let mean = |points: &[[f64; 2]]| -> [f64; 2] {
                std::array::from_fn(|c| {
                    points.iter().map(|p| p[c]).sum::<f64>() / points.len() as f64
                })
            };
            let middle = mean(&corners);
            for (i, point) in facet.points.iter().enumerate() {
                let before = mean(&[corners[i], corners[(i + n - 1) % n]]);
                let after = mean(&[corners[i], corners[(i + 1) % n]]);
                let part: Vec<Pixel> = [before, corners[i], after, middle].map(pixel).to_vec();
                regions[self.status[*point]].add(&part);
            }
        }
        for (region, (_, tint)) in regions.iter_mut().zip(STATUS) {
            let loops = region.loops();
            canvas.fill_region(&loops, tint);
            for mut ring in loops {
                ring.extend(ring.first().copied());
                canvas.pixel_line(ring, BLACK, 0.1);
            }
        }
    }

    /// Markers and arrows, few enough to be told apart.
    fn marks(&self, canvas: &mut Canvas, places: &[[f64; 3]], sheet: &Sheet) {
        let mut taken: Vec<[f64; 2]> = Vec::new();
        let mut chosen = Vec::new();
        for (point, place) in places.iter().enumerate() {
            let at = sheet.at(*place);
            let free = |other: &[f64; 2]| (at[0] - other[0]).hypot(at[1] - other[1]) >= APART_MM;
            if taken.iter().all(free) {
                taken.push(at);
                chosen.push(point);
            }
        }
        let unit = ARROW_MM / sheet.scale / self.largest.max(f64::MIN_POSITIVE);
        for point in chosen {
            let (from, v) = (sheet.at(places[point]), self.arrows[point]);
            if dot(v, v).sqrt() >= SHORTEST * self.largest && self.largest > 0.0 {
                let to = sheet.at(sum(places[point], unit, v));
                canvas.arrow(from, to);
            }
            let (marker, filled) = status_marker(STATUS[self.status[point]].0);
            draw_marker(canvas, from, marker, filled, BLACK);
        }
    }

    fn legend_rows(&self) -> usize {
        if self.largest > 0.0 { 2 } else { 1 }
    }

    /// Status in the first row, the arrow in the second.
    fn legend(&self, canvas: &mut Canvas, [left, top]: [f64; 2]) {
        let mut x = left;
        for (index, (name, tint)) in STATUS.into_iter().enumerate() {
            if !self.status.contains(&index) {
                continue;
            }
            let corners = [
                [x, top - 1.6],
                [x + 6.0, top - 1.6],
                [x + 6.0, top + 1.6],
                [x, top + 1.6],
                [x, top - 1.6],
            ];
            canvas.fill(&corners, tint);
            canvas.line(&corners, BLACK, 0.1);
            let (marker, filled) = status_marker(name);
            draw_marker(canvas, [x + 3.0, top], marker, filled, BLACK);
            canvas.text(name, [x + 7.5, top], TICK_PT, Anchor::Start, BLACK);
            x += 19.0;
        }
        if self.legend_rows() > 1 {
            let y = top + LEGEND_MM;
            canvas.arrow([left + 0.5, y], [left + 5.5, y]);
            let at = [left + 7.5, y];
            canvas.text(&self.label, at, SMALL_PT, Anchor::Start, BLACK);
        }
    }
}

/// Unit normal of a face on its deformed place.
fn plane_normal(face: &[usize], places: &[[f64; 3]]) -> [f64; 3] {
    let edge = |i: usize| sum(places[face[i % face.len()]], -1.0, places[face[0]]);
    let (a, b) = (edge(1), edge(2));
    let normal: [f64; 3] = std::array::from_fn(|c| {
        let (d, e) = ((c + 1) % 3, (c + 2) % 3);
        a[d] * b[e] - a[e] * b[d]
    });
    let length = dot(normal, normal).sqrt().max(f64::MIN_POSITIVE);
    normal.map(|c| c / length)
}

/// Grey of a face: light from above, a little from the right.
fn shade(normal: [f64; 3]) -> Rgb {
    let light = 205.0 + 12.0 * normal[1].max(0.0) + 38.0 * normal[2].max(0.0);
    [light.round() as u8; 3]
}
