//! Filled contour bands of a piecewise linear field on triangles.
//!
//! For every level the part of each triangle above it is cut out; shared edges of neighbours cancel, so a band is a few
//! large outlines instead of one polygon per triangle. That leaves no hairlines between triangles in any viewer. All
//! corners are pixels: cut points of a shared edge are computed in one order and agree exactly.

use super::axis::{multiples, number};
use super::canvas::{Anchor, Canvas, LABEL_PT, Pixel, SMALL_PT};
use super::colour::{BLACK, Rgb};
use super::style;
use crate::report::number::significant;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// A corner in pixels with the field there: rounding to pixels may flatten a face, and its edges still cancel those of its
/// neighbours.
pub type Corner = (Pixel, f64);

/// About how many bands a field gets.
const BANDS: f64 = 10.0;

/// Levels of a field and their colours.
#[derive(Debug, Clone)]
pub struct Levels {
    low: f64,
    high: f64,
    /// Strictly between `low` and `high`, evenly spaced.
    inner: Vec<f64>,
    step: f64,
}

impl Levels {
    /// Round levels for a field between `low` and `high`.
    pub fn new(low: f64, high: f64) -> Self {
        let span = high - low;
        let mut levels = Self {
            low,
            high,
            inner: Vec::new(),
            step: 0.0,
        };
        // A constant field has one band; its round-off is no contour.
        if span > 1e-9 * low.abs().max(high.abs()) {
            levels.step = level_step(span / BANDS);
            levels.inner = multiples(levels.step, low, high);
            let inside = |level: &f64| *level > low + 1e-6 * span && *level < high - 1e-6 * span;
            levels.inner.retain(inside);
        }
        levels
    }

    /// Decimals that all levels need.
    fn decimals(&self) -> usize {
        let whole = |d: &usize| {
            let scaled = self.step * 10f64.powi(*d as i32);
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        };
        (0..12).find(whole).unwrap_or(3)
    }

    /// Colour of the band above the n-th level; band 0 lies below the first.
    fn colour(&self, band: usize) -> Rgb {
        style::field((band as f64 + 0.5) / (self.inner.len() + 1) as f64)
    }
}

/// The closest to `raw` of 1, 2, 2.5, 5 × 10ⁿ.
fn level_step(raw: f64) -> f64 {
    let power = 10f64.powi(raw.log10().floor() as i32);
    let off = |step: &f64| (step * power / raw).ln().abs();
    [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .unwrap_or(1.0)
        * power
}

/// Closed outlines of what lies above every level, the first of which is below all.
pub type Bands = Vec<Vec<Vec<Pixel>>>;

/// Fills bands and draws the contour lines.
pub fn fill(canvas: &mut Canvas, bands: &Bands, levels: &Levels, line_mm: f64) {
    for (band, loops) in bands.iter().enumerate() {
        canvas.fill_region(loops, levels.colour(band));
    }
    for mut line in bands.iter().flatten().cloned() {
        line.extend(line.first().copied());
        canvas.pixel_line(line, BLACK, line_mm);
    }
}

/// The bands of some faces, all in the same sense of rotation: of most no edge is left, since their neighbours lie above the same
/// levels. `corner`: the pixel of a point with the field there.
pub fn bands(faces: &[Vec<usize>], corner: impl Fn(usize) -> Corner, levels: &Levels) -> Bands {
    let lowest = std::iter::once(f64::NEG_INFINITY);
    let levels: Vec<f64> = lowest.chain(levels.inner.iter().copied()).collect();
    let mut regions: Vec<Region> = levels.iter().map(|_| Region::default()).collect();
    // Edges with the number of levels that all of what they bound is above.
    let mut whole = Vec::new();
    let mut pixels: Vec<Pixel> = Vec::new();
    let mut add = |part: &[Corner]| {
        let above = levels.iter().take_while(|level| is_above(part, **level));
        let above = above.count();
        pixels.clear();
        pixels.extend(part.iter().map(|corner| corner.0));
        whole.extend(Region::edges(&pixels).map(|(edge, sign)| (edge, sign, above)));
    };
    let mut corners = Vec::new();
    for face in faces {
        corners.clear();
        corners.extend(face.iter().map(|point| corner(*point)));
        let is_cut =
            |level: &f64| corners.iter().any(|c| c.1 >= *level) && !is_above(&corners, *level);
        if !levels.iter().any(is_cut) {
            add(&corners);
            continue;
        }
        for triangle in split(&corners) {
            add(&triangle);
            for (region, level) in regions.iter_mut().zip(&levels) {
                if !is_above(&triangle, *level) {
                    let part = part_above(&triangle, *level);
                    region.edges.extend(Region::edges(&part));
                }
            }
        }
    }
    whole.par_sort_unstable();
    for equal in whole.chunk_by(|a, b| a.0 == b.0) {
        let most = equal.iter().map(|own| own.2).max().unwrap_or(0);
        for (band, region) in regions.iter_mut().enumerate().take(most) {
            let own = equal.iter().filter(|own| own.2 > band);
            match own.map(|own| own.1).sum() {
                0 => {}
                count => region.edges.push((equal[0].0, count)),
            }
        }
    }
    let loops = regions.into_par_iter().map(|mut region| region.loops());
    loops.collect()
}

/// A vertical colour bar with its label on top: lower left corner, height, in millimetres.
pub fn colour_bar(
    canvas: &mut Canvas,
    levels: &Levels,
    [x, bottom]: [f64; 2],
    height: f64,
    label: &str,
) {
    const WIDTH: f64 = 3.0;
    let span = if levels.high > levels.low {
        levels.high - levels.low
    } else {
        1.0
    };
    let place = |value: f64| bottom - (value - levels.low) / span * height;
    let top = bottom - height;
    let inner = levels.inner.iter().map(|level| place(*level));
    let edges: Vec<f64> = std::iter::once(bottom).chain(inner).chain([top]).collect();
    for (band, pair) in edges.windows(2).enumerate() {
        canvas.boxed([x, pair[1]], [x + WIDTH, pair[0]], levels.colour(band), 0.0);
    }
    let corners = [
        [x, top],
        [x, bottom],
        [x + WIDTH, bottom],
        [x + WIDTH, top],
        [x, top],
    ];
    canvas.line(&corners, BLACK, 0.15);
    let mut text = |at: f64, text: String| {
        canvas.text(&text, [x + WIDTH + 1.3, at], SMALL_PT, Anchor::Start, BLACK);
    };
    if levels.inner.is_empty() {
        text(
            bottom - 0.5 * height,
            significant(levels.low, 3).replace('-', "−"),
        );
    }
    for level in &levels.inner {
        text(place(*level), number(*level, levels.decimals()));
    }
    for level in &levels.inner {
        let at = place(*level);
        canvas.line(&[[x + WIDTH, at], [x + WIDTH + 0.8, at]], BLACK, 0.15);
    }
    canvas.text(label, [x, top - 3.0], LABEL_PT, Anchor::Start, BLACK);
}

/// Whether the field is at least the level at all corners.
fn is_above(corners: &[Corner], level: f64) -> bool {
    corners.iter().all(|corner| corner.1 >= level)
}

/// A face as triangles: itself, or a fan around its middle, where the field is the mean (for a bilinear quad exactly so).
fn split(corners: &[Corner]) -> Vec<[Corner; 3]> {
    if let [a, b, c] = *corners {
        return vec![[a, b, c]];
    }
    let n = corners.len() as f64;
    let mean = |c: usize| corners.iter().map(|(p, _)| f64::from(p[c])).sum::<f64>() / n;
    let value = corners.iter().map(|(_, v)| v).sum::<f64>() / n;
    let middle = ([mean(0).round() as i32, mean(1).round() as i32], value);
    let next = corners.iter().cycle().skip(1);
    (corners.iter().zip(next))
        .map(|(a, b)| [*a, *b, middle])
        .collect()
}

/// The part of a triangle where the field is at least the level.
fn part_above(triangle: &[Corner; 3], level: f64) -> Vec<Pixel> {
    let mut polygon = Vec::with_capacity(4);
    for index in 0..3 {
        let (a, b) = (triangle[index], triangle[(index + 1) % 3]);
        if a.1 >= level {
            polygon.push(a.0);
        }
        if (a.1 >= level) != (b.1 >= level) {
            polygon.push(cut(a, b, level));
        }
    }
    polygon
}

/// Where the field reaches the level between two corners.
fn cut(a: (Pixel, f64), b: (Pixel, f64), level: f64) -> Pixel {
    // The same order in both triangles that share the edge, for the same rounding.
    let (a, b) = if (a.0, a.1) <= (b.0, b.1) {
        (a, b)
    } else {
        (b, a)
    };
    let t = (level - a.1) / (b.1 - a.1);
    std::array::from_fn(|c| {
        let (from, to) = (f64::from(a.0[c]), f64::from(b.0[c]));
        (from + t * (to - from)).round() as i32
    })
}

/// Union of polygons by their outline: directed edges, of which opposite ones cancel.
#[derive(Default)]
pub struct Region {
    /// Ends in order, and how often the edge runs that way, or back (−).
    edges: Vec<([Pixel; 2], i32)>,
}

impl Region {
    /// Adds a polygon, whatever its sense.
    pub fn add(&mut self, polygon: &[Pixel]) {
        let area: i64 = edges_of(polygon)
            .map(|(a, b)| i64::from(a[0]) * i64::from(b[1]) - i64::from(b[0]) * i64::from(a[1]))
            .sum();
        let sense = if area < 0 { -1 } else { 1 };
        self.edges
            .extend(Self::edges(polygon).map(|(edge, sign)| (edge, sense * sign)));
    }

    /// The edges of a polygon.
    fn edges(polygon: &[Pixel]) -> impl Iterator<Item = ([Pixel; 2], i32)> + '_ {
        let of = |(a, b): (Pixel, Pixel)| {
            (a != b).then_some(if a < b { ([a, b], 1) } else { ([b, a], -1) })
        };
        edges_of(polygon).filter_map(of)
    }

    /// Closed outlines; every remaining edge is walked as often as it is counted.
    pub fn loops(&mut self) -> Vec<Vec<Pixel>> {
        self.edges.sort_unstable();
        let mut next: BTreeMap<Pixel, Vec<Pixel>> = BTreeMap::new();
        for equal in self.edges.chunk_by(|a, b| a.0 == b.0) {
            let [a, b] = equal[0].0;
            let count: i32 = equal.iter().map(|(_, sign)| sign).sum();
            let (from, to) = if count > 0 { (a, b) } else { (b, a) };
            for _ in 0..count.abs() {
                next.entry(from).or_default().push(to);
            }
        }
        let mut loops = Vec::new();
        while let Some((&start, _)) = next.first_key_value() {
            let mut ring = vec![start];
            let mut at = start;
            while let Some(to) = take(&mut next, at) {
                if to == start {
                    break;
                }
                ring.push(to);
                at = to;
            }
            loops.push(straightened(ring));
        }
        loops
    }
}

fn edges_of(polygon: &[Pixel]) -> impl Iterator<Item = (Pixel, Pixel)> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

fn take(next: &mut BTreeMap<Pixel, Vec<Pixel>>, from: Pixel) -> Option<Pixel> {
    let targets = next.get_mut(&from)?;
    let to = targets.pop();
    if targets.is_empty() {
        next.remove(&from);
    }
    to
}

/// Without corners that lie on the straight line between their neighbours.
fn straightened(ring: Vec<Pixel>) -> Vec<Pixel> {
    let n = ring.len();
    let turns = |i: usize| {
        let (a, b, c) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
        let [dx, dy] = [i64::from(b[0] - a[0]), i64::from(b[1] - a[1])];
        let [ex, ey] = [i64::from(c[0] - b[0]), i64::from(c[1] - b[1])];
        dx * ey != dy * ex
    };
    (0..n).filter(|i| turns(*i)).map(|i| ring[i]).collect()
}

/// Undirected edges joined into lines as long as possible.
pub fn chains(edges: &BTreeSet<[Pixel; 2]>) -> Vec<Vec<Pixel>> {
    let mut links: BTreeMap<Pixel, BTreeSet<Pixel>> = BTreeMap::new();
    for [a, b] in edges {
        links.entry(*a).or_default().insert(*b);
        links.entry(*b).or_default().insert(*a);
    }
    // Open lines first, from their ends; closed ones remain.
    let ends = links.iter().filter(|(_, l)| l.len() == 1);
    let ends: Vec<Pixel> = ends.map(|(p, _)| *p).collect();
    let ends = ends.into_iter().map(|end| walk(&mut links, end));
    let mut lines: Vec<Vec<Pixel>> = ends.collect();
    while let Some((&start, _)) = links.first_key_value() {
        lines.push(walk(&mut links, start));
    }
    lines.retain(|line| line.len() > 1);
    lines
}

fn walk(links: &mut BTreeMap<Pixel, BTreeSet<Pixel>>, start: Pixel) -> Vec<Pixel> {
    let mut line = vec![start];
    let mut at = start;
    while let Some(to) = links.get_mut(&at).and_then(BTreeSet::pop_first) {
        if let Some(back) = links.get_mut(&to) {
            back.remove(&at);
        }
        for end in [at, to] {
            if links.get(&end).is_some_and(BTreeSet::is_empty) {
                links.remove(&end);
            }
        }
        line.push(to);
        at = to;
    }
    links.remove(&start);
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square_of_triangles() -> Vec<[Corner; 3]> {
        let corner = |x: i32, y: i32| ([x * 100, y * 100], f64::from(x));
        vec![
            [corner(0, 0), corner(1, 0), corner(1, 1)],
            [corner(0, 0), corner(1, 1), corner(0, 1)],
        ]
    }

    #[test]
    fn shared_edges_cancel() {
        let mut region = Region::default();
        for triangle in square_of_triangles() {
            region.add(&triangle.map(|(pixel, _)| pixel));
        }
        let loops = region.loops();
        assert_eq!(loops.len(), 1);
        assert_eq!(loops[0].len(), 4, "the diagonal is gone: {loops:?}");
    }

    #[test]
    fn the_part_above_a_level_ends_at_it() {
        let mut region = Region::default();
        for triangle in square_of_triangles() {
            region.add(&part_above(&triangle, 0.25));
        }
        let mut corners = region.loops().concat();
        corners.sort_unstable();
        assert_eq!(corners, [[25, 0], [25, 100], [100, 0], [100, 100]]);
    }
}
