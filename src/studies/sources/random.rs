//! Random cracked bodies: plates with one straight crack, blocks parted by one plane, pushed, pulled and sheared.
//!
//! A body is a case file like any other, so that whatever fails on one can be looked at with `stickslip run`. The unit
//! square or cube has E = 1 Pa and a random Poisson's ratio; its bottom is held, its top is moved and one side carries a
//! traction. Problem k of a dimension is load k mod 4 on body k / 4, from rest. Bodies are drawn until one can be discretised, has
//! enough contact points, and enough of its loads close the crack.

use std::fmt::Write;
use std::ops::RangeInclusive;
use std::path::Path;

use stickslip_methods::{Load as Acting, MethodError};
pub use stickslip_xfem::mesh::stream::Stream;

use crate::case::reader::Value;
use crate::case::{self, Case, CaseError};
use crate::model::body::{Body, BodyError, Needs};
use crate::model::loading::Loading;
use crate::studies::sources::bodies::FRICTION;
use crate::studies::sources::{MOST, Problem};

/// Problems on one body.
const LOADS: usize = 4;
/// Loads drawn per body.
const CANDIDATES: usize = 12;
/// Fraction of the points that would overlap without contact forces: with fewer there is little to solve.
const PRESSED: f64 = 0.25;
/// Bodies drawn before giving up; about every second one will do.
const DRAWS: usize = 1000;

/// The bodies of a dimension, and how many contact points they may have.
fn wanted(dim: usize) -> (Kind, RangeInclusive<usize>) {
    let (cells, points) = if dim == 2 {
        (8..=20, 10..=40)
    } else {
        (3..=5, 20..=80)
    };
    let slope = 0.8;
    (Kind { dim, cells, slope }, points)
}

/// Why there is no random problem.
#[derive(Debug, thiserror::Error)]
pub enum RandomError {
    /// A random body broke the discretisation. Refusals are no errors: another body is drawn.
    #[error("a random body in {dim}D cannot be discretised: {source}\n{text}")]
    Body {
        /// Space dimension.
        dim: usize,
        /// The case file.
        text: String,
        /// Why.
        source: BodyError,
    },
    /// The generator gave nothing usable.
    #[error("no usable body in {dim}D among {DRAWS} of number {number}")]
    NoBody {
        /// Space dimension.
        dim: usize,
        /// Body number.
        number: usize,
    },
}

/// `random = { dimension = 2, seed = 1, problems = 20 }`.
///
/// # Errors
/// Numbers out of range, bodies that cannot be drawn.
pub(crate) fn read(value: Value<'_>, _: &Path) -> Result<Vec<Problem>, CaseError> {
    let table = value.table(&["dimension", "seed", "problems"])?;
    let dim = table.required("dimension")?.integer(2..=3)?;
    let seed = table.get("seed");
    let seed = seed.map_or(Ok(1), |v| v.integer(0..=usize::MAX))? as u64;
    let count = table.required("problems")?.integer(1..=MOST)?;
    let cases = problems(dim, seed, count);
    let cases = cases.map_err(|e| value.refuse("another seed", e))?;
    let problem = |case: &Case| {
        let mut problem = Problem::of(case);
        problem.subject.class = format!("{dim}d");
        problem
    };
    Ok(cases.iter().map(problem).collect())
}

/// The first so many problems of a dimension and seed, each the same however many are asked for.
///
/// # Errors
/// [`RandomError`].
pub fn problems(dim: usize, seed: u64, count: usize) -> Result<Vec<Case>, RandomError> {
    let mut all = Vec::new();
    for number in 0..count.div_ceil(LOADS) {
        let (specimen, loads) = body(dim, seed, number)?;
        for (place, load) in loads.into_iter().enumerate() {
            let name = format!("random-{dim}d-seed-{seed}-{:03}", LOADS * number + place);
            let text = specimen.case(&[load], &[FRICTION]);
            let case = case::parse(format!("{name}.toml"), text.as_str());
            all.push(case.map_err(|e| {
                let source = e.into();
                RandomError::Body { dim, text, source }
            })?);
        }
    }
    all.truncate(count);
    Ok(all)
}

/// Body `number` with the loads that are posed on it: the same whatever else is drawn.
fn body(dim: usize, seed: u64, number: usize) -> Result<(Specimen, Vec<usize>), RandomError> {
    let mut stream = Stream::numbered(seed, 4 * number as u64 + dim as u64);
    let (kind, points) = wanted(dim);
    // The same bodies for all methods, also those that need the stress at the crack.
    let needs = Needs {
        frictionless: Vec::new(),
        traction: true,
    };
    for _ in 0..DRAWS {
        let specimen = Specimen::draw(&kind, CANDIDATES, &mut stream);
        let all: Vec<usize> = (0..CANDIDATES).collect();
        let text = specimen.case(&all, &[1.0]);
        let closing = || -> Result<Option<Vec<usize>>, BodyError> {
            let case = case::parse("random.toml", text.as_str())?;
            let body = Body::new(&case, 1, &needs)?;
            if !points.contains(&body.points.len()) {
                return Ok(None);
            }
            // Random cases have no closed form, so friction does not matter.
            let loading = Loading::new(&body, &case, 0.0)?;
            let mut loads = Vec::new();
            for load in all {
                if loads.len() < LOADS && closes(&body, &loading.at(load + 1))? {
                    loads.push(load);
                }
            }
            Ok(Some(loads).filter(|loads| loads.len() == LOADS))
        };
        match closing() {
            Ok(Some(loads)) => return Ok((specimen, loads)),
            // The position asks for something the discretisation refuses, e.g. a crack that misses all edges.
            Ok(None) | Err(BodyError::Case(_)) => {}
            Err(source) => return Err(RandomError::Body { dim, text, source }),
        }
    }
    Err(RandomError::NoBody { dim, number })
}

/// Whether enough points would overlap without contact forces.
fn closes(body: &Body, load: &Acting) -> Result<bool, MethodError> {
    let mut u = load.force.clone();
    body.elastic.solve(&mut u)?;
    let mut jump = vec![0.0; load.offset.len()];
    body.elastic.jump().mul(&u, &mut jump);
    let gaps = jump.iter().zip(&load.offset).step_by(body.mesh.dim());
    let closed = gaps.filter(|(jump, offset)| *jump + *offset < 0.0).count();
    Ok(closed as f64 >= PRESSED * body.points.len() as f64)
}

/// Kind of bodies to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Kind {
    /// 2 or 3.
    pub dim: usize,
    /// Fewest and most cells per axis.
    pub cells: RangeInclusive<usize>,
    /// Steepest slope of the plane of a block along each of x and y. The steeper, the more cell edges are crossed that
    /// share nodes, and the closer the Delassus operator is to singular.
    pub slope: f64,
}

/// A random body with its random loads, before discretisation.
#[derive(Debug, Clone, PartialEq)]
pub struct Specimen {
    /// 2 or 3.
    pub dim: usize,
    poisson: f64,
    cells: Vec<usize>,
    /// The `[[crack]]` table without friction.
    crack: String,
    /// Region of the traction, as keys of `[[load]]`.
    side: String,
    loads: Vec<Load>,
}

/// One load, `dim` components each.
#[derive(Debug, Clone, PartialEq)]
struct Load {
    /// Displacement of the top [m].
    top: Vec<f64>,
    /// Traction on the side [Pa].
    traction: Vec<f64>,
}

impl Specimen {
    /// A plate (2D) or block (3D) with a number of loads.
    pub fn draw(kind: &Kind, loads: usize, stream: &mut Stream) -> Self {
        let dim = kind.dim;
        let poisson = stream.between(0.0, 0.45);
        let cells: Vec<usize> = (0..dim)
            .map(|_| stream.whole(*kind.cells.start(), *kind.cells.end()))
            .collect();
        let (crack, side) = if dim == 2 {
            plate(&cells, stream)
        } else {
            block(&cells, kind.slope, stream)
        };
        let loads = (0..loads).map(|_| Load::draw(dim, stream)).collect();
        Self {
            dim,
            poisson,
            cells,
            crack,
            side,
            loads,
        }
    }

    /// The case file whose increment k is load `loads[k − 1]`, run for each of the friction coefficients.
    pub fn case(&self, loads: &[usize], friction: &[f64]) -> String {
        let dim = self.dim;
        let (model, zeros, ones) = match dim {
            2 => ("plane-strain", "[0, 0]", "[1, 1]"),
            _ => ("solid", "[0, 0, 0]", "[1, 1, 1]"),
        };
        let mut text = format!(
            "title = \"Random body\"\nmodel = \"{model}\"\n\n[material]\nyoung_pa = 1\npoisson = {}\n\n\
             [mesh.box]\nmin_m = {zeros}\nmax_m = {ones}\ncells = {:?}\n\n\
             [[crack]]\n{}friction = {:?}\n\n[[support]]\non = \"bottom\"\ndisplacement_m = {zeros}\n",
            self.poisson,
            self.cells,
            self.crack,
            friction.first().copied().unwrap_or(0.0),
        );
        // One table per component: their histories are independent.
        for a in 0..dim {
            let unit = |other: &str| {
                let entry = |b: usize| if a == b { "1" } else { other };
                (0..dim).map(entry).collect::<Vec<_>>().join(", ")
            };
            let history = |value: &dyn Fn(&Load) -> f64| {
                let point = |(k, &load): (usize, &usize)| {
                    format!("[{}, {:?}]", k + 1, value(&self.loads[load]))
                };
                let points: Vec<String> = loads.iter().enumerate().map(point).collect();
                points.join(", ")
            };
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                "\n[[support]]\non = \"top\"\ndisplacement_m = [{}]\nhistory = [{}]\n\
                 \n[[load]]\n{}traction_pa = [{}]\nhistory = [{}]\n",
                unit("\"free\""),
                history(&|load| load.top[a]),
                self.side,
                unit("0"),
                history(&|load| load.traction[a]),
            );
        }
        text + &format!(
            "\n[path]\nincrements = {0}\nend = {0}\n\n[sweep]\nfriction = {friction:?}\n",
            loads.len()
        )
    }
}

impl Load {
    fn draw(dim: usize, stream: &mut Stream) -> Self {
        let last = dim - 1;
        let top = (0..dim).map(|a| {
            if a == last {
                stream.between(-2e-3, 5e-4)
            } else {
                stream.between(-1.5e-3, 1.5e-3)
            }
        });
        let top = top.collect();
        let traction = (0..dim).map(|_| stream.between(-1e-3, 1e-3)).collect();
        Self { top, traction }
    }
}

/// Contact space of all bodies: stated, so that a study does not move with the default.
const SPACE: &str = "contact = \"edge-pairs\"\n";

/// Crack and loaded region of a plate: the crack lies inside, ends at a side, runs through, or joins grid points.
fn plate(cells: &[usize], stream: &mut Stream) -> (String, String) {
    let (p, q) = match stream.whole(0, 3) {
        0 => {
            let (angle, half) = (
                stream.between(0.0, std::f64::consts::PI),
                stream.between(0.25, 0.45),
            );
            let (x, y) = (stream.between(0.4, 0.6), stream.between(0.4, 0.6));
            let (c, s) = (half * angle.cos(), half * angle.sin());
            ([x - c, y - s], [x + c, y + s])
        }
        1 => (
            [-0.1, stream.between(0.1, 0.9)],
            [stream.between(0.4, 0.9), stream.between(0.1, 0.9)],
        ),
        2 => (
            [-0.1, stream.between(0.1, 0.9)],
            [1.1, stream.between(0.1, 0.9)],
        ),
        _ => {
            let mut node = |a: usize, low: f64, high: f64| {
                (stream.between(low, high) * cells[a] as f64).round() / cells[a] as f64
            };
            (
                [node(0, 0.0, 0.3), node(1, 0.1, 0.9)],
                [node(0, 0.7, 1.0), node(1, 0.1, 0.9)],
            )
        }
    };
    let tip = if stream.chance(0.6) { "branch" } else { "none" };
    let crack = format!("points_m = [{p:?}, {q:?}]\ntip = \"{tip}\"\n{SPACE}");
    let side = if stream.chance(0.5) { "left" } else { "right" };
    (crack, region(side, "y", stream))
}

/// The same for a block, every fifth plane along grid lines.
fn block(cells: &[usize], steepest: f64, stream: &mut Stream) -> (String, String) {
    let (normal, height) = if stream.chance(0.2) {
        let row = stream.whole(1, cells[2] - 1);
        ([0.0, 0.0, 1.0], row as f64 / cells[2] as f64)
    } else {
        let mut slope = || stream.between(-steepest, steepest);
        ([slope(), slope(), 1.0], stream.between(0.35, 0.65))
    };
    let crack =
        format!("plane = {{ point_m = [0.5, 0.5, {height:?}], normal = {normal:?} }}\n{SPACE}");
    let side = ["left", "right", "front", "back"][stream.whole(0, 3)];
    (crack, region(side, "z", stream))
}

/// A side, or its part above a height, as keys of `[[load]]`.
fn region(side: &str, up: &str, stream: &mut Stream) -> String {
    if stream.chance(0.5) {
        format!("on = \"{side}\"\n")
    } else {
        let height = stream.between(0.3, 0.7);
        format!("on = \"{side}\"\nwhere = \"{up} >= {height:?}\"\n")
    }
}
