//! How exact methods grow with the number of contact unknowns and with friction, on [bodies] of given sizes: right answers at
//! the finest tier alone.
//!
//! ```text
//!   time ~ N^a, iterations ~ N^b     a, b: least squares of the logarithms over all bodies with more than 50 unknowns N
//! ```

use stickslip_methods::Tier;

use super::accuracy::seconds;
use super::{compare_methods, has_defaults, is_correct, method_time, published_times};
use crate::studies::convergence::slope;
use crate::studies::record::Record;
use crate::studies::sources::bodies;
use crate::studies::statistics::median;

/// Fewer unknowns say nothing about growth.
const FEWEST: f64 = 50.0;

/// A right answer on a body of given size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a> {
    /// Dimension of the body.
    pub dim: usize,
    /// Method.
    pub method: &'a str,
    /// Name of the body.
    pub body: &'a str,
    /// Contact points asked for.
    pub points: usize,
    /// Friction coefficient.
    pub friction: f64,
    /// Contact unknowns.
    pub unknowns: f64,
    /// Iterations.
    pub iterations: f64,
    /// Time of the method [s]; NaN without times.
    pub time: f64,
    /// Its part in the whole run, discretisation and factorisation included; NaN without times.
    pub share: f64,
}

/// Measurements of a sample.
pub type Quantity = fn(&Sample<'_>) -> f64;

/// All samples, in the order of the methods and by size.
pub fn samples(records: &[Record]) -> Vec<Sample<'_>> {
    let own = records.iter().filter_map(|record| {
        let points = asked(record)?;
        let size = record.found.problem.as_ref()?;
        let time = published_times(record).map_or(f64::NAN, |spent| method_time(spent).median_s);
        let fits = record.found.exact && is_correct(record, Tier::High);
        fits.then(|| Sample {
            dim: size.dim,
            method: &record.found.method,
            body: &record.asked.case,
            points,
            friction: record.asked.mu(),
            unknowns: size.unknowns as f64,
            iterations: record.found.sum(|i| i.iterations) as f64,
            time,
            share: time / seconds(record, records).iter().sum::<f64>(),
        })
    });
    let mut all: Vec<Sample> = own.collect();
    all.sort_by(|a, b| {
        let methods = compare_methods(a.method, b.method);
        methods.then(a.unknowns.total_cmp(&b.unknowns))
    });
    all
}

/// Contact points asked for, of a cell at the finest tier with default options on such a body.
fn asked(record: &Record) -> Option<usize> {
    let cell = &record.asked;
    let fits = has_defaults(cell) && cell.tolerance == Tier::High.tolerance();
    bodies::points_of(&cell.case).filter(|_| fits)
}

/// Medians of a quantity by size, over the medians of the contact unknowns.
pub fn medians(samples: &[&Sample<'_>], quantity: Quantity) -> Vec<[f64; 2]> {
    let mut sizes: Vec<usize> = samples.iter().map(|s| s.points).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let point = |size: usize| {
        let own = || samples.iter().filter(move |s| s.points == size);
        [
            median(own().map(|s| s.unknowns)),
            median(own().map(|s| quantity(s))),
        ]
    };
    let points = sizes.into_iter().map(point);
    points.filter(|p| p[1].is_finite()).collect()
}

/// The friction coefficient of most samples.
pub fn common_friction(all: &[Sample<'_>]) -> Option<f64> {
    let mut values: Vec<f64> = all.iter().map(|s| s.friction).collect();
    values.sort_by(f64::total_cmp);
    let groups = values.chunk_by(|a, b| a == b);
    groups.max_by_key(|group| group.len()).map(|group| group[0])
}

/// Exponent a of y ~ N^a; none where sizes differ by less than a factor 3.
pub fn exponent<'s>(
    samples: impl Iterator<Item = &'s Sample<'s>>,
    quantity: Quantity,
) -> Option<f64> {
    let large = samples.filter(|s| s.unknowns > FEWEST && quantity(s) > 0.0);
    let points: Vec<[f64; 2]> = large.map(|s| [s.unknowns, quantity(s)]).collect();
    let ends = points.iter().map(|p| p[0]);
    let (least, most) = (
        ends.clone().fold(f64::INFINITY, f64::min),
        ends.fold(0.0, f64::max),
    );
    (most > 3.0 * least).then(|| slope(&points))
}

/// A method on the bodies of a dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct Growth {
    /// Dimension.
    pub dim: usize,
    /// Method.
    pub method: String,
    /// Bodies it was given, with the friction coefficient that most have.
    pub bodies: usize,
    /// Number right at the finest tier.
    pub correct: usize,
    /// Fewest and most contact unknowns of right answers.
    pub unknowns: [f64; 2],
    /// Exponents of time and iterations; NaN where they are not known.
    pub exponents: [f64; 2],
    /// Largest number of contact points asked for with right answers, and there the median part of the method in the whole run.
    pub largest: (usize, f64),
}

/// Of every method with a right answer.
pub fn growth(records: &[Record]) -> Vec<Growth> {
    let mut all = samples(records);
    let Some(common) = common_friction(&all) else {
        return Vec::new();
    };
    all.retain(|s| s.friction == common);
    let mut found = Vec::new();
    for dim in [2, 3] {
        let of_dim: Vec<Sample> = all.iter().copied().filter(|s| s.dim == dim).collect();
        for own in of_dim.chunk_by(|a, b| a.method == b.method) {
            let of_method = |r: &&Record| r.found.method == own[0].method && r.asked.mu() == common;
            let given = |r: &&Record| {
                asked(r).is_some() && bodies::dimension_of(&r.asked.case) == Some(dim)
            };
            let largest = own.iter().map(|s| s.points).max().unwrap_or(0);
            let there = own.iter().filter(|s| s.points == largest);
            let ends = own.iter().map(|s| s.unknowns);
            let quantities: [Quantity; 2] = [|s| s.time, |s| s.iterations];
            found.push(Growth {
                dim,
                method: own[0].method.to_owned(),
                bodies: records.iter().filter(of_method).filter(given).count(),
                correct: own.len(),
                unknowns: [
                    ends.clone().fold(f64::INFINITY, f64::min),
                    ends.fold(0.0, f64::max),
                ],
                exponents: quantities.map(|q| exponent(own.iter(), q).unwrap_or(f64::NAN)),
                largest: (largest, median(there.map(|s| s.share))),
            });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::support::{end_with, of_case, record, timed};
    use super::*;
    use crate::studies::sources::bodies::Sized;

    /// A body of so many points whose method takes N² µs and √N iterations.
    fn body(points: usize, method: &str) -> Record {
        let name = Sized {
            dim: 2,
            points,
            seed: 1,
            number: 0,
        };
        let time = 1e-6 * (4 * points * points) as f64;
        let mut own = of_case(timed(record("x", method, 1e-9), time), &name.name());
        own.found.increments[0].iterations = ((2 * points) as f64).sqrt().round() as usize;
        if let Some(size) = &mut own.found.problem {
            (size.points, size.unknowns) = (points, 2 * points);
        }
        own
    }

    #[test]
    fn exponents_are_those_of_a_power_law() {
        let mut records: Vec<Record> = [8, 128, 512, 2048].map(|p| body(p, "pdas")).into();
        records.push(record("plate", "pdas", 1e-9));
        let mut lost = body(5000, "pdas");
        end_with(&mut lost, "timed-out");
        records.push(lost);
        let found = growth(&records);
        let [one] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!((one.dim, one.bodies, one.correct), (2, 5, 4));
        assert_eq!((one.unknowns, one.largest.0), ([16.0, 4096.0], 2048));
        assert!((one.exponents[0] - 2.0).abs() < 1e-9, "{one:?}");
        assert!((one.exponents[1] - 0.5).abs() < 1e-9, "{one:?}");
        assert!(one.largest.1 > 0.8 && one.largest.1 < 1.0);
    }

    #[test]
    fn one_size_has_no_exponent() {
        let records = [body(100, "pdas"), body(100, "nsgs")];
        let found = growth(&records);
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|own| own.exponents[0].is_nan()));
    }
}
