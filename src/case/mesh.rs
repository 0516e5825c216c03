//! `[mesh]` and `[sweep]` of a case file: grid lines, the line they follow, refinement.

use std::collections::BTreeSet;

use stickslip_xfem::mesh::box_mesh::{GridSpec, Motion};
use stickslip_xfem::mesh::grid_motion::{Distort, Follow, Twist};

use super::crack::friction;
use super::error::{CaseError, Span};
use super::reader::{Table, Value};

/// `[mesh]`: a structured box mesh.
#[derive(Debug, Clone)]
pub struct MeshSpec {
    /// Where `mesh` stands in the file.
    pub span: Span,
    /// Grid lines and what moves their points.
    pub grid: GridSpec,
    /// Where the motions of the grid points stand in the file.
    pub motion_spans: Vec<(Motion, Span)>,
}

impl MeshSpec {
    /// Where a motion of the grid points stands in the file; of one that is not in the file, where `mesh` stands.
    pub fn motion_span(&self, motion: Motion) -> &Span {
        let spans = &self.motion_spans;
        let found = spans.iter().find(|(own, _)| *own == motion);
        found.map_or(&self.span, |(_, span)| span)
    }
}

/// Parameter sweep; no value occurs twice.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Friction coefficients; empty: every crack keeps its own.
    pub friction: Vec<f64>,
    /// Mesh refinement factors >= 1, at least one: every cell of the base mesh is divided by this number in each direction.
    pub refine: Vec<usize>,
}

/// Largest number of cells, also after refinement: beyond it the matrix does not fit the machines meant here.
const MAX_CELLS: usize = 20_000_000;

/// Largest refinement factor.
pub(super) const MAX_REFINE: usize = 1000;

/// Smallest width of a cell relative to its coordinates; below it neighbouring grid lines are rounding errors apart.
const MIN_WIDTH: f64 = 64.0 * f64::EPSILON;

/// Steepest line grid lines may follow [degrees]; cells are sheared by its tangent.
const MAX_ANGLE: f64 = 80.0;

/// Largest turn of grid lines [degrees].
const MAX_TURN: f64 = 180.0;

/// Largest seed: every integer up to it is written and read the same everywhere.
const MAX_SEED: usize = u32::MAX as usize;

/// `[mesh]`.
pub(super) fn mesh(root: &Table<'_>, dim: usize) -> Result<MeshSpec, CaseError> {
    let table = root
        .required("mesh")?
        .table(&["box", "lines_m", "follow", "twist", "distort"])?;
    let lines = match table.exactly_one(&["box", "lines_m"])? {
        ("box", value) => box_lines(value, dim)?,
        (_, value) => given_lines(value, dim)?,
    };
    let grid = GridSpec {
        follow: table.optional("follow", |v| follow(v, dim, &lines))?,
        lines,
        twist: table.optional("twist", |v| twist(v, dim))?,
        distort: table.optional("distort", |v| distort(v, dim))?,
    };
    let keys = [
        ("follow", Motion::Follow),
        ("twist", Motion::Twist),
        ("distort", Motion::Distort),
    ];
    let spans = keys.map(|(key, motion)| Some((motion, table.get(key)?.span())));
    let motion_spans = spans.into_iter().flatten().collect();
    Ok(MeshSpec {
        span: table.span(),
        grid,
        motion_spans,
    })
}

/// `[mesh.twist]`.
fn twist(value: Value<'_>, dim: usize) -> Result<Twist, CaseError> {
    let table = value.table(&["angle_deg"])?;
    if dim != 2 {
        return Err(value.refuse("a 2D model", "grid lines are turned in the plane only"));
    }
    let allowed = "-180 < angle_deg < 180";
    let degrees = table.number_if("angle_deg", allowed, |a| a.abs() < MAX_TURN)?;
    Ok(Twist {
        angle: degrees.to_radians(),
    })
}

/// `[mesh.distort]`.
fn distort(value: Value<'_>, dim: usize) -> Result<Distort, CaseError> {
    let table = value.table(&["amplitude", "seed"])?;
    if dim != 2 {
        let message = "hexahedra can be cut only while their faces are planar";
        return Err(value.refuse("a 2D model", message));
    }
    let allowed = "0 <= amplitude < 0.5";
    let amplitude = table.number_if("amplitude", allowed, |a| (0.0..0.5).contains(&a))?;
    let seed = table.optional("seed", |v| v.integer(0..=MAX_SEED))?;
    Ok(Distort {
        amplitude,
        seed: seed.unwrap_or(1) as u64,
    })
}

/// `[mesh.box]`: evenly spaced grid lines.
fn box_lines(value: Value<'_>, dim: usize) -> Result<Vec<Vec<f64>>, CaseError> {
    let table = value.table(&["min_m", "max_m", "cells"])?;
    let min = table.required("min_m")?.numbers(dim)?;
    let mut max = Vec::new();
    for (value, low) in table.required("max_m")?.list_of(dim)?.iter().zip(&min) {
        max.push(value.number_if(&format!("more than min_m = {low}"), |high| high > *low)?);
    }
    let given = table.required("cells")?;
    let cells = given.list_of(dim)?.into_iter();
    let cells = cells
        .map(|v| v.integer(1..=MAX_CELLS))
        .collect::<Result<Vec<_>, _>>()?;
    count_cells(given, &cells, 1)?;
    let narrow = (0..dim).find(|&i| !wide_enough(min[i], max[i], cells[i]));
    if let Some(axis) = narrow {
        return Err(without_width(
            given,
            &format!("axis {} has cells", axis + 1),
        ));
    }
    let line = |i: usize| even_lines(min[i], max[i], cells[i]);
    Ok((0..dim).map(line).collect())
}

/// Grid lines of so many even cells. Weighted from both ends: a box symmetric about zero gets grid lines that are.
pub fn even_lines(min: f64, max: f64, cells: usize) -> Vec<f64> {
    let n = cells as f64;
    let inner = (1..cells).map(|k| k as f64);
    let inner = inner.map(|k| (min * (n - k) + max * k) / n);
    std::iter::once(min).chain(inner).chain([max]).collect()
}

/// `lines_m`: grid lines one by one.
fn given_lines(value: Value<'_>, dim: usize) -> Result<Vec<Vec<f64>>, CaseError> {
    let mut lines = Vec::new();
    for axis in value.list_of(dim)? {
        let entries = axis.list()?;
        if entries.len() < 2 {
            return Err(axis.refuse("at least 2 grid lines per axis", "empty mesh"));
        }
        let mut line: Vec<f64> = Vec::new();
        for entry in entries {
            let low = line.last().copied();
            let allowed = low.map_or("a finite number".to_string(), |low| {
                format!("more than {low} (strictly increasing)")
            });
            line.push(entry.number_if(&allowed, |x| low.is_none_or(|low| wide_enough(low, x, 1)))?);
        }
        lines.push(line);
    }
    let cells: Vec<usize> = lines.iter().map(|l| l.len() - 1).collect();
    count_cells(value, &cells, 1)?;
    Ok(lines)
}

fn count_cells(value: Value<'_>, cells: &[usize], factor: usize) -> Result<(), CaseError> {
    let total: f64 = cells.iter().map(|n| *n as f64 * factor as f64).product();
    if total <= MAX_CELLS as f64 {
        return Ok(());
    }
    let allowed = format!("at most {MAX_CELLS} cells");
    Err(value.refuse(allowed, format_args!("{total:.0} cells in total")))
}

fn without_width(value: Value<'_>, what: &str) -> CaseError {
    let message = format!("{what} without width");
    value.refuse("cells that double precision can tell apart", message)
}

/// Whether an interval can be divided into that many cells. A width that overflows counts as too narrow.
fn wide_enough(low: f64, high: f64, parts: usize) -> bool {
    let width = (high - low) / parts as f64;
    width.is_finite() && width > MIN_WIDTH * low.abs().max(high.abs())
}

/// `[mesh.follow]`.
fn follow(value: Value<'_>, dim: usize, lines: &[Vec<f64>]) -> Result<Follow, CaseError> {
    let table = value.table(&["point_m", "angle_deg", "half_length_m"])?;
    let mut point = [0.0; 3];
    for (i, entry) in table.required("point_m")?.list_of(dim)?.iter().enumerate() {
        let (low, high) = ends(&lines[i]);
        point[i] = entry.number_if(&format!("between {low} and {high}, inside the body"), |x| {
            low < x && x < high
        })?;
    }
    let angle_value = table.required("angle_deg")?;
    let degrees = angle_value.number_if("-80 < angle_deg < 80", |a| a.abs() < MAX_ANGLE)?;
    let (left, right) = ends(&lines[0]);
    let (before, after) = (point[0] - left, right - point[0]);
    let half_length = match table.get("half_length_m") {
        None => f64::INFINITY,
        Some(v) => {
            let room = before.min(after);
            let allowed = format!("0 < half_length_m < {room}, or leave it out");
            v.number_if(&allowed, |l| 0.0 < l && l < room)?
        }
    };
    let angle = degrees.to_radians();
    // The rows beside the point are shifted as a whole; every cell above and below must keep some height.
    let column = &lines[dim - 1];
    let height = point[dim - 1];
    let (bottom, top) = ends(column);
    let heights = || column.iter().copied();
    let below = heights().filter(|y| *y <= height).fold(bottom, f64::max) - bottom;
    let above = top - heights().filter(|y| *y >= height).fold(top, f64::min);
    let shift = |length: f64| length.min(half_length) * angle.tan();
    let (fall, rise) = (-shift(before), shift(after));
    let (lowest, highest) = (fall.min(rise), fall.max(rise));
    if below + lowest <= 0.0 || above - highest <= 0.0 {
        let message =
            format!("the line shifts grid lines by {lowest} to {highest} m, out of the body");
        return Err(angle_value.refuse(
            format_args!("shifts between {} and {above} m", -below),
            message,
        ));
    }
    Ok(Follow {
        point,
        angle,
        half_length,
    })
}

fn ends(line: &[f64]) -> (f64, f64) {
    let end = |x: Option<&f64>| x.copied().unwrap_or_default();
    (end(line.first()), end(line.last()))
}

/// `[sweep]`.
pub(super) fn sweep(root: &Table<'_>, mesh: &MeshSpec) -> Result<Sweep, CaseError> {
    let Some(value) = root.get("sweep") else {
        return Ok(Sweep {
            friction: Vec::new(),
            refine: vec![1],
        });
    };
    let table = value.table(&["friction", "refine"])?;
    let cells: Vec<usize> = mesh.grid.lines.iter().map(|l| l.len() - 1).collect();
    let factor = |v: Value<'_>| {
        let factor = v.integer(1..=MAX_REFINE)?;
        count_cells(v, &cells, factor)?;
        let mut gaps = mesh.grid.lines.iter().flat_map(|line| line.windows(2));
        let narrow = gaps.any(|w| !wide_enough(w[0], w[1], factor));
        if narrow {
            Err(without_width(v, "cells"))
        } else {
            Ok(factor)
        }
    };
    let frictions = table.optional("friction", |v| {
        // Adding 0 makes -0 the 0 that it equals.
        distinct(v, friction, |mu| (mu + 0.0).to_bits())
    })?;
    let refine = table.optional("refine", |v| distinct(v, factor, |factor| *factor))?;
    Ok(Sweep {
        friction: frictions.unwrap_or_default(),
        refine: refine.unwrap_or_else(|| vec![1]),
    })
}

/// A non-empty list without repetitions, which equal keys are.
fn distinct<T, K: Ord>(
    value: Value<'_>,
    read: impl Fn(Value<'_>) -> Result<T, CaseError>,
    key: impl Fn(&T) -> K,
) -> Result<Vec<T>, CaseError> {
    let (mut found, mut keys) = (Vec::new(), BTreeSet::new());
    for entry in value.list()? {
        let item = read(entry)?;
        if !keys.insert(key(&item)) {
            return Err(entry.refuse("each value once", "repeated value"));
        }
        found.push(item);
    }
    if found.is_empty() {
        return Err(value.refuse("at least one value", "empty sweep"));
    }
    Ok(found)
}
