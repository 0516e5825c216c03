//! Contact status on the crack inside a solid, with arrows for the slip.
//!
//! The view is that of [`super::solid`]. Where the crack parts the solid, what is in front of it is drawn as an outline and
//! what is behind it as a body; otherwise the whole solid is an outline. Status is told by tint and marker.

use super::axis::prefixed;
use super::bands::Region;
use super::canvas::*;
use super::colour::{BLACK, GREY, Rgb};
use super::mesh::{Box2, DISPLACEMENT, dot, fail, point_vector, sides, stroke};

use super::solid::{OpenedSolid, Plane, normal, project, sum};
use super::style::{MARKER_MM, draw_marker, status_marker};
use crate::model::field_mesh::{CellShape, FieldMesh, FieldStep};
use crate::report::ReportError;
use crate::report::number::{fixed, significant};

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
/// Jumps below this fraction of the crack's size, and tangential tractions below the other of the largest traction, are what
/// the tolerance of a method leaves.
const ROUND_OFF: f64 = 1e-10;
const NO_TRACTION: f64 = 1e-9;
const LEGEND_MM: f64 = 5.0;

/// Open, stick and slip on the crack of a solid with arrows for its tangential jump, or for the tangential contact traction
/// on side 1 where nothing slips; `run` is small text above.
///
/// # Errors
/// [`ReportError::FieldMesh`] when the body is not 3D, the crack has no facets, or either lacks a field.
pub fn contact_status(step: &FieldStep, run: &str) -> Result<String, ReportError> {
    let crack = &step.crack;
    let Some(plane) = Plane::of(crack) else {
        return fail("crack", "no facets");
    };
    let solid = OpenedSolid::new(&step.body, &plane)?;
    let face = Face::new(crack, &plane)?;
    let Some(shown) = Box2::around(solid.places.iter().map(|p| project(*p))) else {
        return fail(DISPLACEMENT, "no finite values");
    };
    let scale = ((COLUMN - 6.0) / shown.width()).min(75.0 / shown.height());
    let title = face.states.title();
    let factor = significant(solid.factor, 1);
    let head = Head::new(&title, &format!("{run}, deformation ×{factor}"), COLUMN);
    let bottom = head.height() + 2.0 + scale * shown.height();
    let left = 0.5 * (COLUMN - scale * shown.width());
    let paper = |place: [f64; 3]| {
        let [x, y] = project(place);
        let [x, y] = [x - shown.low[0], y - shown.low[1]];
        [left + scale * x, bottom - scale * y]
    };
    let places: Vec<[f64; 3]> = crack.points.iter().map(|x| solid.moved(*x)).collect();
    // Beside or below the body, whichever corner it leaves free.
    let triad = [COLUMN - 9.0, bottom + 1.0];
    let legend = bottom + 4.0;
    let rows = if face.largest > 0.0 { 2.0 } else { 1.0 };
    let mut canvas = Canvas::new(COLUMN, (legend + LEGEND_MM * rows).max(triad[1] + 4.0));
    head.draw(&mut canvas);
    let corner = |p: usize| pixel(paper(solid.places[p]));
    let edges = |seen: bool| -> Vec<[usize; 2]> {
        let own = solid.edges.iter().filter(|edge| edge.1 == seen);
        own.map(|edge| edge.0).collect()
    };
    for edge in edges(false) {
        let ends = edge.map(|p| paper(solid.places[p]));
        canvas.dashed(&ends, GREY, 0.1, &[0.6, 0.6]);
    }
    for points in &solid.body {
        let corners = points.iter().map(|p| corner(*p)).collect();
        let grey = shade(normal(&solid.places, points));
        canvas.fill_region(&[corners], grey);
        let edges: Vec<[usize; 2]> = sides(points).collect();
        stroke(&mut canvas, &edges, corner, GREY, 0.05);
    }
    face.fill(&mut canvas, |p| paper(places[p]));
    stroke(&mut canvas, &edges(true), corner, GREY, 0.15);
    face.marks(&mut canvas, &places, paper, scale);
    face.legend(&mut canvas, [3.0, legend]);
    for (c, name) in ["x", "y", "z"].into_iter().enumerate() {
        let [x, y] = project(std::array::from_fn(|d| f64::from(u8::from(c == d))));
        let at = |length: f64| [triad[0] + length * x, triad[1] - length * y];
        canvas.line(&[triad, at(5.0)], BLACK, 0.25);
        canvas.text(&italic(name), at(7.0), TICK_PT, Anchor::Middle, BLACK);
    }
    canvas.finish(&format!("{title}: {run}"))
}

/// Open, stick or slip by point of the cracks: index in [`STATUS`].
pub(super) struct States(Vec<usize>);

impl States {
    pub(super) fn new(crack: &FieldMesh) -> Result<Self, ReportError> {
        let status = crack.point_scalars.iter().find(|(n, _)| n == "status");
        let status = status.map_or(&[][..], |(_, values)| values);
        if status.len() != crack.points.len() {
            let (found, points) = (status.len(), crack.points.len());
            return fail("status", &format!("{found} values for {points} points"));
        }
        let index = |value: &f64| (*value as usize).min(STATUS.len() - 1);
        Ok(Self(status.iter().map(index).collect()))
    }

    pub(super) fn tint(&self, point: usize) -> Rgb {
        STATUS[self.0[point]].1
    }

    /// How much of the cracks is in which status, by points.
    pub(super) fn title(&self) -> String {
        let count = |index: usize| self.0.iter().filter(|s| **s == index).count();
        let verbs = [(2, "slips"), (1, "sticks"), (0, "is open")];
        let share = |n: usize| fixed(100.0 * n as f64 / self.0.len().max(1) as f64, 0);
        let told = verbs.into_iter().filter(|(index, _)| count(*index) > 0);
        let told: Vec<String> = told
            .map(|(i, verb)| format!("{} % {verb}", share(count(i))))
            .collect();
        match &told[..] {
            [_] => format!("The whole crack {}", told[0].trim_start_matches("100 % ")),
            _ => format!("Of the crack {}", told.join(", ")),
        }
    }

    /// The states that occur, in a row.
    pub(super) fn legend(&self, canvas: &mut Canvas, [left, top]: [f64; 2], marked: bool) {
        let mut x = left;
        for (index, (name, tint)) in STATUS.into_iter().enumerate() {
            if self.0.contains(&index) {
                canvas.boxed([x, top - 1.6], [x + 6.0, top + 1.6], tint, 0.1);
                if marked {
                    let marker = status_marker(name);
                    draw_marker(canvas, [x + 3.0, top], marker, MARKER_MM, BLACK);
                }
                canvas.text(name, [x + 7.5, top], TICK_PT, Anchor::Start, BLACK);
                x += 19.0;
            }
        }
    }
}

/// The crack surface with what is drawn on it.
struct Face<'a> {
    crack: &'a FieldMesh,
    states: States,
    /// Tangential vector per point.
    arrows: Vec<[f64; 3]>,
    /// Length of the longest.
    largest: f64,
    /// Name of the arrows in the legend.
    label: String,
}

impl<'a> Face<'a> {
    fn new(crack: &'a FieldMesh, plane: &Plane) -> Result<Self, ReportError> {
        let states = States::new(crack)?;
        let tangential = |name: &str| -> Result<Vec<[f64; 3]>, ReportError> {
            Ok(point_vector(crack, name)?
                .iter()
                .map(|v| plane.tangential(*v))
                .collect())
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
            (
                tangential("contact_traction_pa")?,
                "tangential traction on side 1",
                "Pa",
            )
        };
        let tractions = longest(point_vector(crack, "contact_traction_pa")?);
        let open = states.0.iter().all(|status| *status == 0);
        let noise = unit == "Pa" && (open || longest(&arrows) <= NO_TRACTION * tractions);
        let largest = if noise { 0.0 } else { longest(&arrows) };
        let (factor, unit) = prefixed(largest, unit);
        let label = format!(
            "{what}, longest {} {unit}",
            significant(largest * factor, 3)
        );
        Ok(Self {
            crack,
            states,
            arrows,
            largest,
            label,
        })
    }

    /// Fills the facets: the part of a facet at each corner has that corner's status.
    fn fill(&self, canvas: &mut Canvas, at: impl Fn(usize) -> [f64; 2]) {
        let mut regions: [Region; 3] = std::array::from_fn(|_| Region::default());
        for facet in self
            .crack
            .cells
            .iter()
            .filter(|c| c.shape == CellShape::Polygon)
        {
            let corners: Vec<[f64; 2]> = facet.points.iter().map(|p| at(*p)).collect();
            let n = corners.len();
            let mean = |points: &[[f64; 2]]| -> [f64; 2] {
                [0, 1].map(|c| points.iter().map(|p| p[c]).sum::<f64>() / points.len() as f64)
            };
            for (i, point) in facet.points.iter().enumerate() {
                let before = mean(&[corners[i], corners[(i + n - 1) % n]]);
                let after = mean(&[corners[i], corners[(i + 1) % n]]);
                let part: Vec<Pixel> = [before, corners[i], after, mean(&corners)]
                    .map(pixel)
                    .to_vec();
                regions[self.states.0[*point]].add(&part);
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

    /// Markers and arrows, few enough to be told apart; `scale`: millimetres per metre.
    fn marks(
        &self,
        canvas: &mut Canvas,
        places: &[[f64; 3]],
        paper: impl Fn([f64; 3]) -> [f64; 2],
        scale: f64,
    ) {
        let mut taken: Vec<[f64; 2]> = Vec::new();
        let unit = ARROW_MM / scale / self.largest.max(f64::MIN_POSITIVE);
        for (point, place) in places.iter().enumerate() {
            let at = paper(*place);
            if taken
                .iter()
                .any(|other| (at[0] - other[0]).hypot(at[1] - other[1]) < APART_MM)
            {
                continue;
            }
            taken.push(at);
            let v = self.arrows[point];
            if dot(v, v).sqrt() >= SHORTEST * self.largest && self.largest > 0.0 {
                canvas.arrow(at, paper(sum(*place, unit, v)));
            }
            draw_marker(
                canvas,
                at,
                status_marker(STATUS[self.states.0[point]].0),
                MARKER_MM,
                BLACK,
            );
        }
    }

    /// Status in the first row, the arrow in the second.
    fn legend(&self, canvas: &mut Canvas, [left, top]: [f64; 2]) {
        self.states.legend(canvas, [left, top], true);
        if self.largest > 0.0 {
            let y = top + LEGEND_MM;
            canvas.arrow([left + 0.5, y], [left + 5.5, y]);
            canvas.text(&self.label, [left + 7.5, y], SMALL_PT, Anchor::Start, BLACK);
        }
    }
}

/// Grey of a face: light from above, a little from the right.
fn shade(normal: [f64; 3]) -> Rgb {
    let light = 205.0 + 12.0 * normal[1].max(0.0) + 38.0 * normal[2].max(0.0);
    [light.round() as u8; 3]
}
