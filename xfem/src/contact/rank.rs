//! Contact points that the displacement cannot tell apart, and points merged into one.
//!
//! A force P on the points is felt through B, and the stiffness of what feels it is at most C times its diagonal D, C the
//! number of functions that meet in a cell. So with
//!
//! ```text
//!   S = B D⁻¹ Bᵀ,   Ŝ = diag(S)^−½ S diag(S)^−½           P·W P >= P·S P / C
//! ```
//!
//! a point whose rows are nearly combinations of those before it (a small pivot of the Cholesky factor of Ŝ) has a force
//! that no displacement determines: at tips and junctions, on slivers, beside supports, on cracks of few cells. Forces of
//! many points that nothing resists together (constant ones that change sign from facet to facet around a circle) leave no
//! small pivot but a small eigenvalue; the point that has most of it is such a point too. It is merged with the nearest point
//! of its arm: their multiplier functions add up, so constant tractions stay exact. One rule, from what the rows are, not from where
//! they come from.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::geometry::boxes::{Boxes, no_nearer};
use crate::geometry::{Point, add_scaled, norm, root, sub, unite};
use crate::stiffness::inverse_iteration::smallest_eigenvalue;

use super::pairs::{ContactPoint, ContactSurface};

/// Pivots below the first are zero: the square of what is new in a row of unit length. So are eigenvalues of Ŝ below the second: at
/// most its inverse times rounding is what the forces may be off. With 1e-4 the constant forces of facets around a circle had twice
/// to ten times the error in their tractions.
pub const UNTOLD: [f64; 2] = [1e-2, 1e-3];

/// Pivots and eigenvalues below these are rounding. Between two cracks that nearly touch both fall with their distance.
pub const SINGULAR: [f64; 2] = [1e-10; 2];

/// A row with less than this of the largest square in S moves no displacement that a tolerance tells: on a sliver only functions
/// jump that nearly vanish there.
const WEAK: f64 = 1e-9;

/// Areas below this, in facets of the smallest cell, carry no force of their own.
pub const HAIR: f64 = 1e-3;

/// A row of B over the unknowns of the solver, each divided by the root of its stiffness.
type Row = Vec<(usize, f64)>;

/// Points whose forces no displacement determines beside those of the others, by the least pivot and eigenvalue; `rows(k)`: the rows
/// (n, a[, b]) of a point.
///
/// Arms with few points come first and keep them; of equals those with the larger weights, and each from its end with the
/// larger, however the cracks are read.
pub fn dependent(
    arms: &[std::ops::Range<usize>],
    weight: impl Fn(usize) -> f64,
    rows: impl Fn(usize) -> Vec<Row> + Sync,
    limits: [f64; 2],
) -> Vec<usize> {
    let arms = &ordered(arms, weight);
    let points = arms.par_iter().flatten();
    let rows: BTreeMap<usize, Vec<Row>> = points.map(|&point| (point, rows(point))).collect();
    let squares = rows.values().flatten().map(square);
    let least = WEAK * squares.fold(0.0, f64::max);
    let groups = coupled(arms, &rows).into_par_iter();
    groups
        .flat_map_iter(|group| search_group(&group, &rows, least, limits))
        .collect()
}

fn ordered(arms: &[std::ops::Range<usize>], weight: impl Fn(usize) -> f64) -> Vec<Vec<usize>> {
    let scale: f64 = arms.iter().flat_map(Clone::clone).map(&weight).sum();
    let rounded = |&point: &usize| (-weight(point) / scale * 1e9).round() as i64;
    let mut order: Vec<Vec<usize>> = arms.iter().map(|arm| arm.clone().collect()).collect();
    for arm in &mut order {
        if arm.iter().map(rounded).gt(arm.iter().rev().map(rounded)) {
            arm.reverse();
        }
    }
    order.sort_by_cached_key(|arm| (arm.len(), arm.iter().map(rounded).collect::<Vec<_>>()));
    order
}

/// Arms that share unknowns, directly or through others: what is dependent is so among these.
fn coupled<'a>(arms: &'a [Vec<usize>], rows: &BTreeMap<usize, Vec<Row>>) -> Vec<Vec<&'a [usize]>> {
    let mut parent: Vec<usize> = (0..arms.len()).collect();
    let mut first = BTreeMap::new();
    for (arm, points) in arms.iter().enumerate() {
        for (unknown, _) in points.iter().flat_map(|point| &rows[point]).flatten() {
            unite(&mut parent, *first.entry(*unknown).or_insert(arm), arm);
        }
    }
    let mut groups: BTreeMap<usize, Vec<&[usize]>> = BTreeMap::new();
    for (arm, points) in arms.iter().enumerate() {
        let group = groups.entry(root(&mut parent, arm)).or_default();
        group.push(points);
    }
    groups.into_values().collect()
}

fn search_group(
    arms: &[&[usize]],
    rows: &BTreeMap<usize, Vec<Row>>,
    least: f64,
    [pivot, eigenvalue]: [f64; 2],
) -> Vec<usize> {
    let weak = |row: &Row| !row.is_empty() && square(row) < least;
    let mut factor = Factor::default();
    let mut found = Vec::new();
    // Points by row of the factor.
    let mut owners = Vec::new();
    for arm in arms {
        // A slip direction that supports hold on a whole arm has no force to tell; they hold it, too.
        let void = |k: usize| k > 0 && arm.iter().all(|point| rows[point][k].is_empty());
        let dim = arm.first().map_or(0, |point| rows[point].len());
        let told: Vec<bool> = (0..dim).map(|k| !void(k)).collect();
        for point in *arm {
            let own = rows[point].iter().zip(&told).filter(|row| *row.1);
            let own: Vec<&Row> = own.map(|row| row.0).collect();
            if own.iter().all(|row| !weak(row)) && factor.push(&own, pivot) {
                owners.resize(factor.len(), *point);
            } else {
                found.push(*point);
            }
        }
    }
    if found.is_empty() {
        found.extend(factor.unresisted(eigenvalue).map(|row| owners[row]));
    }
    found
}

fn square(row: &Row) -> f64 {
    row.iter().map(|(_, v)| v * v).sum()
}

/// The Cholesky factor L of the Gram matrix of the rows kept so far: only its entries that may not vanish, so that arms that meet
/// in whatever order cost no more than what couples them.
#[derive(Default)]
struct Factor {
    pivots: Vec<f64>,
    /// Columns of L below the diagonal, as (row, entry). The first row is the next one that the column acts on, its parent in
    /// the elimination tree.
    columns: Vec<Vec<(usize, f64)>>,
    /// By unknown: rows with their entries there.
    users: BTreeMap<usize, Vec<(usize, f64)>>,
    /// By row: a sum, 0 between calls; the last attempt to add one that met it.
    sums: Vec<f64>,
    met: Vec<usize>,
    attempts: usize,
}

impl Factor {
    fn len(&self) -> usize {
        self.pivots.len()
    }

    /// The row with the largest part in the forces that least resists, if that is next to nothing: inverse iteration.
    fn unresisted(&self, least: f64) -> Option<usize> {
        let count = self.len();
        let (eigenvalue, x) = smallest_eigenvalue(count, |x| self.solve(x));
        let largest = (0..count).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs()));
        largest.filter(|_| eigenvalue < least)
    }

    /// x := (L Lᵀ)⁻¹ x.
    fn solve(&self, x: &mut [f64]) {
        let mut sums = vec![0.0; x.len()];
        for (k, column) in self.columns.iter().enumerate() {
            x[k] = (x[k] - sums[k]) / self.pivots[k];
            column.iter().for_each(|&(i, l)| sums[i] += l * x[k]);
        }
        for (k, column) in self.columns.iter().enumerate().rev() {
            let below = column.iter().rev();
            x[k] = below.fold(x[k], |rest, &(i, l)| rest - l * x[i]) / self.pivots[k];
        }
    }

    /// Adds some rows if their pivots reach a least one, all or none.
    fn push(&mut self, rows: &[&Row], least: f64) -> bool {
        let mut added = Vec::new();
        for row in rows {
            match self.push_row(row, least) {
                Some(columns) => added.push((*row, columns)),
                None => {
                    added.into_iter().rev().for_each(|own| self.pop(own));
                    return false;
                }
            }
        }
        true
    }

    /// Takes the last row back, given its columns.
    fn pop(&mut self, (row, columns): (&Row, Vec<usize>)) {
        for column in columns {
            self.columns[column].pop();
        }
        for (unknown, _) in row {
            if let Some(users) = self.users.get_mut(unknown) {
                users.pop();
            }
        }
        self.columns.pop();
        self.pivots.pop();
        self.sums.pop();
        self.met.pop();
    }

    /// Adds a row if its pivot reaches a least one: its columns then.
    fn push_row(&mut self, row: &Row, least: f64) -> Option<Vec<usize>> {
        let length = square(row).sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let row: Row = row
            .iter()
            .map(|&(unknown, v)| (unknown, v / length))
            .collect();
        let i = self.len();
        self.attempts += 1;
        let mut products: BTreeMap<usize, f64> = BTreeMap::new();
        for &(unknown, value) in &row {
            for &(j, other) in self.users.get(&unknown).into_iter().flatten() {
                *products.entry(j).or_default() += value * other;
            }
        }
        // What these columns act on, too (Liu, SIAM J. Matrix Anal. Appl. 11 (1990) 134).
        let mut columns = Vec::new();
        for &j in products.keys() {
            let mut next = Some(j);
            while let Some(k) = next.filter(|&k| self.met[k] < self.attempts) {
                self.met[k] = self.attempts;
                columns.push(k);
                next = self.columns[k].first().map(|below| below.0);
            }
        }
        columns.sort_unstable();
        // L y = s.
        let mut y = Vec::with_capacity(columns.len());
        for &j in &columns {
            let product = products.get(&j).copied().unwrap_or(0.0);
            let own = (product - std::mem::take(&mut self.sums[j])) / self.pivots[j];
            self.columns[j]
                .iter()
                .for_each(|&(k, l)| self.sums[k] += l * own);
            y.push(own);
        }
        let square = 1.0 - y.iter().map(|v| v * v).sum::<f64>();
        if square < least {
            return None;
        }
        for (&j, own) in columns.iter().zip(y) {
            self.columns[j].push((i, own));
        }
        for (unknown, value) in row {
            self.users.entry(unknown).or_default().push((i, value));
        }
        self.pivots.push(square.sqrt());
        self.columns.push(Vec::new());
        self.sums.push(0.0);
        self.met.push(0);
        Some(columns)
    }
}

/// Points on next to nothing of a facet, at most `least` [m^(dim − 1)], between a junction and a mesh edge a hair from it say: their
/// traction would be a rounding over no area.
pub fn hairs(surface: &ContactSurface, arms: &[std::ops::Range<usize>], least: f64) -> Vec<usize> {
    let points = arms.iter().flat_map(|arm| arm.clone());
    points
        .filter(|&k| surface.points[k].weight <= least)
        .collect()
}

/// Points that others may be merged into.
struct Others<'a> {
    surface: &'a ContactSurface,
    numbers: Vec<usize>,
    /// They by place.
    places: Boxes,
}

impl<'a> Others<'a> {
    fn new(
        surface: &'a ContactSurface,
        points: impl Iterator<Item = usize>,
        stays: &[bool],
    ) -> Self {
        let numbers: Vec<usize> = points.filter(|&k| stays[k]).collect();
        let places = Boxes::new(numbers.iter().map(|&k| [surface.points[k].x; 2]));
        Others {
            surface,
            numbers,
            places,
        }
    }

    /// The one nearest to a point, of equals the first.
    fn nearest(&self, point: usize) -> Option<usize> {
        let place = |k: usize| &self.surface.points[k].x;
        let away = |other: usize| norm(&sub(place(point), place(self.numbers[other])));
        let nothing = (f64::INFINITY, usize::MAX);
        let nearest = self
            .places
            .least(|own| no_nearer(place(point), own), away, nothing);
        self.numbers.get(nearest.1).copied()
    }
}

/// Merges points into the nearest others of their arms; what has no other stays. The arms, and how many points went.
pub fn merge(
    surface: &mut ContactSurface,
    arms: &[std::ops::Range<usize>],
    lost: &[usize],
) -> (Vec<std::ops::Range<usize>>, usize) {
    let count = surface.points.len();
    let mut target: Vec<usize> = (0..count).collect();
    let mut stays = vec![true; count];
    lost.iter().for_each(|&k| stays[k] = false);
    let own = arms
        .iter()
        .filter(|arm| !stays[(*arm).clone()].iter().all(|s| *s));
    for arm in own {
        let beside = Others::new(surface, arm.clone(), &stays);
        for k in arm.clone().filter(|&k| !stays[k]) {
            target[k] = beside.nearest(k).unwrap_or(k);
        }
    }
    let kept: Vec<usize> = (0..count).filter(|&k| target[k] == k).collect();
    let mut number = vec![0; count];
    for (new, &old) in kept.iter().enumerate() {
        number[old] = new as u32;
    }
    let numbers: Vec<u32> = target.iter().map(|&t| number[t]).collect();
    let mut points: Vec<_> = kept.iter().map(|&k| surface.points[k].clone()).collect();
    for k in (0..count).filter(|&k| target[k] != k) {
        let into = &mut points[numbers[k] as usize];
        *into = into.with(&surface.points[k]);
    }
    surface.points = points;
    surface.surface.renumber(|k| numbers[k as usize]);
    let place = |k: usize| kept.partition_point(|&old| old < k);
    let arms = arms.iter().map(|arm| place(arm.start)..place(arm.end));
    (arms.collect(), count - kept.len())
}

impl ContactPoint {
    /// A point whose multiplier function is the sum of two: weighted means of place and jump.
    fn with(&self, other: &Self) -> Self {
        let weight = self.weight + other.weight;
        let [a, b] = [self.weight / weight, other.weight / weight];
        let mean = |p: &Point, q: &Point| add_scaled(&p.map(|v| a * v), b, q);
        let mut terms: BTreeMap<u32, [Point; 3]> = BTreeMap::new();
        for (point, share) in [(self, a), (other, b)] {
            for (f, rows) in &point.terms {
                let sum = terms.entry(*f).or_default();
                for (row, own) in sum.iter_mut().zip(rows) {
                    *row = add_scaled(row, share, own);
                }
            }
        }
        ContactPoint {
            x: mean(&self.x, &other.x),
            s: a * self.s + b * other.s,
            frame: self.frame,
            weight,
            terms: terms.into_iter().collect(),
            ..self.clone()
        }
    }
}
