//! References, errors and observed orders of mesh sequences.
//!
//! e(h) ≈ C h^p: p by least squares of ln e over ln h on a mesh and the two before it, the order over the last two halvings.
//! Without a closed form the finest value is the reference, see [`error_bar`](super::error_bar) for how far it may be off, and
//! p is that of the steps between three meshes. Theoretical orders of bilinear elements with and without enriched tips:
//! Laborde, Pommier, Renard, Salaün, Int. J. Numer. Meth. Engng 64 (2005) 354.

use std::collections::BTreeMap;

use super::error_bar::{Course, NoBar, error_bars};
use super::power_law::{order_of_steps, slope};
use super::{Measured, Sample, Variant};
use crate::case::named;
use crate::run::verdict::Verdict;
use crate::studies::followed::Value;
use crate::studies::tips::Regularity;

/// Differences of a quantity below this fraction of its size are the tolerance of the runs, not the discretisation.
const RESOLVED: f64 = 1e-8;

/// Relative errors below are round-off: they neither fall nor say anything about an order.
pub const ROUND_OFF: f64 = 1e-12;

named! {
    /// Reference of an error.
    pub enum Kind {
        /// A closed form.
        Exact = "exact",
        /// The value on the finest mesh.
        Finest = "finest",
        /// The strain energy on the finest mesh, for the energy norm.
        Estimate = "estimate",
    }
}

/// One quantity on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorRow {
    /// Which sequence.
    pub variant: Variant,
    /// Mesh label.
    pub mesh: String,
    /// Refinement factor.
    pub refine: usize,
    /// Largest distance of neighbouring grid lines [m].
    pub h: f64,
    /// Free displacement unknowns.
    pub dofs: usize,
    /// Contact points.
    pub points: usize,
    /// Claim × check.
    pub verdict: Verdict,
    /// Quantity; empty where the verdict is not honest.
    pub quantity: String,
    /// Place and component; empty: the whole body.
    pub at: String,
    /// Value of the run.
    pub found: f64,
    /// Value it is measured against.
    pub reference: f64,
    /// Uncertainty of the reference; 0 of a closed form, NaN where unknown.
    pub error_bar: f64,
    /// Why it is unknown.
    pub no_bar: Option<NoBar>,
    /// Error, without closed form relative to [`Value::norm`](super::Value::norm) on the finest mesh; NaN on the mesh that
    /// is itself the reference.
    pub error: f64,
    /// Kind of the reference; none where there is no error.
    pub kind: Option<Kind>,
    /// Order over this mesh and the two before; NaN where one of the three has no error above [`ROUND_OFF`], or without a
    /// closed form where they do not differ by more than the tolerance of the runs.
    pub order: f64,
    /// Times.
    pub seconds: [f64; 6],
}

/// One quantity of one sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderRow {
    /// The finest mesh with an honest verdict: the reference, its error bar, and the order over the last two halvings.
    pub finest: ErrorRow,
    /// Meshes with an honest verdict.
    pub meshes: usize,
    /// Error on the finest mesh that has one.
    pub error: f64,
    /// Order that theory promises; none where it is silent.
    pub theory: Option<f64>,
    /// Dimension of the body: the unknowns grow like h^−dim.
    pub dim: usize,
    /// Number that the founding paper prints for the case; none where it prints nothing.
    pub printed: Option<f64>,
}

impl OrderRow {
    /// (printed − reference) / reference [-].
    pub fn printed_difference(&self) -> Option<f64> {
        self.printed
            .map(|printed| printed / self.finest.reference - 1.0)
    }
}

/// Order in h that theory promises; of contact tractions a lower bound.
///
/// Without tips: energy norm 1, displacement in L² 2, traction at least 1. With tips the energy norm has 1/2 where
/// they are not enriched or only in cells that shrink, 1 where they are enriched within a fixed radius.
pub fn theoretical_order(quantity: &str, regularity: Regularity) -> Option<f64> {
    let is = |name: &str| quantity.starts_with(name);
    match regularity {
        Regularity::Smooth if is("displacement") => Some(2.0),
        Regularity::Smooth if is("energy") || is("traction") => Some(1.0),
        Regularity::FixedRadius if is("energy") => Some(1.0),
        Regularity::Tip if is("energy") => Some(0.5),
        _ => None,
    }
}

/// One quantity of one honest run; without closed form it has no reference yet.
struct Point<'a> {
    sample: &'a Sample,
    row: ErrorRow,
    /// Without closed form.
    value: Option<&'a Value>,
}

impl Point<'_> {
    /// Whether it is more than rounding.
    fn counts(&self) -> bool {
        (self.value).is_none_or(|v| v.value.abs() > RESOLVED * v.scale)
    }

    fn place(&self) -> [f64; 2] {
        [self.row.h, self.row.found]
    }
}

/// Rows by mesh and by sequence, in the order of the samples.
pub fn rows(samples: &[Sample]) -> (Vec<ErrorRow>, Vec<OrderRow>) {
    let mut errors = Vec::new();
    let mut orders = Vec::new();
    for (index, Sample { variant, .. }) in samples.iter().enumerate() {
        if samples[..index]
            .iter()
            .any(|before| before.variant == *variant)
        {
            continue;
        }
        let mut own: Vec<&Sample> = samples.iter().filter(|s| s.variant == *variant).collect();
        own.sort_by(|a, b| b.h.total_cmp(&a.h));
        let unmeasured = own.iter().filter(|s| s.measured == Measured::Nothing);
        errors.extend(unmeasured.map(|sample| unmeasured_row(sample)));
        if let Some(points) = energy_norm(&own) {
            let (found, order) = sequence(points, Ok(f64::NAN));
            errors.extend(found);
            orders.push(order);
        }
        let sequences = sequences(&own);
        let courses: Vec<Course<'_>> = sequences.iter().map(|points| course(points)).collect();
        let bars = error_bars(&courses, own[0].regularity);
        for (points, bar) in sequences.into_iter().zip(bars) {
            let (found, order) = sequence(points, bar);
            errors.extend(found);
            orders.push(order);
        }
    }
    (errors, orders)
}

/// Relative errors in the energy norm where there is no closed form, from the strain energies E of the meshes h₁ < h₂ …:
///
/// ```text
///   ‖u − u_h‖/‖u‖ ≈ √(|E − E₁|/E₁ / (1 − (h₁/h)²))       on the finest that of h₂ times (h₁/h₂)^p, p = 1/2 where tips limit it
/// ```
///
/// None where there is one mesh, or no energy.
fn energy_norm<'a>(own: &[&'a Sample]) -> Option<Vec<Point<'a>>> {
    let energy = |&sample: &&'a Sample| match &sample.measured {
        Measured::Values(values) => {
            let own = values.iter().find(|v| v.quantity == "strain_energy");
            own.map(|v| (sample, v.value))
        }
        _ => None,
    };
    let mut all: Vec<(&Sample, f64)> = own.iter().filter_map(energy).collect();
    let (finest, last) = all.pop().filter(|(_, energy)| *energy > 0.0)?;
    let error = |&(sample, energy): &(&Sample, f64)| {
        ((energy - last).abs() / last / (1.0 - (finest.h / sample.h).powi(2))).sqrt()
    };
    let mut errors: Vec<f64> = all.iter().map(error).collect();
    let power = if finest.regularity == Regularity::Tip {
        0.5
    } else {
        1.0
    };
    errors.push(errors.last()? * (finest.h / all.last()?.0.h).powf(power));
    all.push((finest, last));
    let point = |((sample, energy), error): ((&'a Sample, f64), f64)| Point {
        sample,
        row: ErrorRow {
            quantity: "energy".into(),
            found: (2.0 * energy).sqrt(),
            reference: (2.0 * last).sqrt(),
            kind: Some(Kind::Estimate),
            error,
            ..unmeasured_row(sample)
        },
        value: None,
    };
    Some(all.into_iter().zip(errors).map(point).collect())
}

/// Honest points by quantity and place, from coarse to fine. Quantities that vanish on every mesh are left out.
fn sequences<'a>(own: &[&'a Sample]) -> Vec<Vec<Point<'a>>> {
    let mut all: BTreeMap<[&str; 2], Vec<Point<'_>>> = BTreeMap::new();
    for &sample in own {
        let mut add = |row: ErrorRow, key: [&'a str; 2], value| {
            let row = ErrorRow {
                quantity: key[0].to_owned(),
                at: key[1].to_owned(),
                ..row
            };
            all.entry(key)
                .or_default()
                .push(Point { sample, row, value });
        };
        let row = unmeasured_row(sample);
        match &sample.measured {
            Measured::Nothing => {}
            Measured::Exact(deviations) => deviations.iter().for_each(|d| {
                let row = ErrorRow {
                    found: d.found,
                    reference: d.exact,
                    error_bar: 0.0,
                    error: d.error,
                    kind: Some(Kind::Exact),
                    ..row.clone()
                };
                add(row, [&d.quantity, &d.at], None);
            }),
            Measured::Values(values) => values.iter().for_each(|v| {
                let row = ErrorRow {
                    found: v.value,
                    kind: Some(Kind::Finest),
                    ..row.clone()
                };
                add(row, [&v.quantity, &v.at], Some(v));
            }),
        }
    }
    all.retain(|_, points| points.iter().any(Point::counts));
    all.into_values().collect()
}

/// The ingredients of error bars.
fn course<'a>(points: &'a [Point<'_>]) -> Course<'a> {
    let finest = points.last();
    Course {
        quantity: finest.map_or("", |point| &point.row.quantity),
        points: points.iter().map(Point::place).collect(),
        counts: points.iter().rev().take(2).any(Point::counts),
        scale: finest.and_then(|p| p.value).map_or(f64::NAN, |v| v.scale),
    }
}

/// Rows of one quantity, on at least one mesh: every mesh, and the sequence.
fn sequence(mut points: Vec<Point<'_>>, bar: Result<f64, NoBar>) -> (Vec<ErrorRow>, OrderRow) {
    let finest = points.len() - 1;
    let Point { sample, row, value } = &points[finest];
    let (sample, value, reference) = (*sample, *value, row.found);
    for (index, Point { row, .. }) in points.iter_mut().enumerate() {
        if let Some(value) = value {
            row.reference = reference;
            (row.error_bar, row.no_bar) = (bar.unwrap_or(f64::NAN), bar.err());
            if index < finest {
                row.error = (row.found - reference).abs() / value.norm;
            }
        }
    }
    let places: Vec<[f64; 2]> = points.iter().map(Point::place).collect();
    let mut rows: Vec<ErrorRow> = points.into_iter().map(|point| point.row).collect();
    for (first, three) in places.windows(3).enumerate() {
        let own = &rows[first..first + 3];
        let order = match (value, three) {
            // Differences that the runs do not resolve have no order.
            (Some(value), &[a, b, c]) => {
                let resolved =
                    |[_, v]: [f64; 2], [_, w]: [f64; 2]| (v - w).abs() > RESOLVED * value.norm;
                (resolved(a, b) && resolved(b, c)).then(|| order_of_steps([a, b, c]))
            }
            // That of the energies: the error on the finest mesh follows from the one before.
            (None, &[a, b, c]) if own[0].kind == Some(Kind::Estimate) => {
                Some(order_of_steps([a, b, c].map(|[h, norm]| [h, norm * norm])) / 2.0)
            }
            _ => own.iter().all(|row| row.error >= ROUND_OFF).then(|| {
                let errors: Vec<[f64; 2]> = own.iter().map(|row| [row.h, row.error]).collect();
                slope(&errors)
            }),
        };
        rows[first + 2].order = order.unwrap_or(f64::NAN);
    }
    let with_error = rows.iter().rev().find(|row| row.error.is_finite());
    let order = OrderRow {
        finest: rows[finest].clone(),
        meshes: rows.len(),
        error: with_error.map_or(f64::NAN, |row| row.error),
        theory: theoretical_order(&rows[finest].quantity, sample.regularity),
        dim: sample.dim,
        printed: None,
    };
    (rows, order)
}

/// A row without quantity.
fn unmeasured_row(sample: &Sample) -> ErrorRow {
    ErrorRow {
        variant: sample.variant.clone(),
        mesh: sample.mesh.clone(),
        refine: sample.refine,
        h: sample.h,
        dofs: sample.dofs,
        points: sample.points,
        verdict: sample.verdict.clone(),
        quantity: String::new(),
        at: String::new(),
        found: f64::NAN,
        reference: f64::NAN,
        error_bar: f64::NAN,
        no_bar: None,
        error: f64::NAN,
        kind: None,
        order: f64::NAN,
        seconds: sample.seconds,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::errors::Deviation;
    use stickslip_methods::Status;

    fn sample(refine: usize, regularity: Regularity, measured: Measured) -> Sample {
        Sample {
            variant: Variant {
                case: "case".into(),
                space: "star".into(),
                tip: "branch".into(),
                method: "hybrid".into(),
                friction: 0.3,
            },
            regularity,
            mesh: format!("{refine}x{refine}"),
            refine,
            h: 1.0 / refine as f64,
            dim: 2,
            dofs: 2 * refine * refine,
            points: refine,
            verdict: match measured {
                Measured::Nothing => Verdict::GaveUp(Status::Stalled),
                _ => Verdict::Solved,
            },
            seconds: [f64::NAN; 6],
            measured,
        }
    }

    fn value(quantity: &str, value: f64) -> Value {
        Value {
            quantity: quantity.into(),
            at: String::new(),
            value,
            norm: value.abs(),
            scale: 1.0,
        }
    }

    fn values(meshes: &[usize], of: impl Fn(f64) -> Vec<Value>) -> Vec<Sample> {
        let sample = |&refine: &usize| {
            let measured = Measured::Values(of(1.0 / refine as f64));
            sample(refine, Regularity::Tip, measured)
        };
        meshes.iter().map(sample).collect()
    }

    /// Goal: the reference is the finest value, its error bar holds the truth, the order is that of the steps, and a failed
    /// mesh is a row without error.
    #[test]
    fn values_are_measured_against_the_finest() {
        let mut samples = values(&[8, 1, 4, 2], |h| {
            vec![
                value("reaction", -2.0 + h.powf(0.75)),
                value("max_gap", 1e-17 * h),
            ]
        });
        samples.push(sample(16, Regularity::Tip, Measured::Nothing));
        let (errors, orders) = rows(&samples);
        // Vanishing gaps are left out.
        assert_eq!((errors.len(), orders.len()), (5, 1));
        let failed: Vec<&ErrorRow> = errors.iter().filter(|r| r.kind.is_none()).collect();
        assert_eq!((failed.len(), failed[0].refine), (1, 16));
        assert!(failed[0].error.is_nan() && failed[0].verdict == Verdict::GaveUp(Status::Stalled));
        let solved: Vec<&ErrorRow> = errors.iter().filter(|r| r.kind.is_some()).collect();
        assert_eq!(
            solved.iter().map(|r| r.refine).collect::<Vec<_>>(),
            [1, 2, 4, 8]
        );
        let left = 0.125f64.powf(0.75);
        for row in &solved {
            assert_eq!((row.kind, row.no_bar), (Some(Kind::Finest), None));
            assert_eq!(row.reference, left - 2.0);
            assert!(
                left < row.error_bar && row.error_bar < 5.0 * left,
                "{row:?}"
            );
            let error = (row.h.powf(0.75) - left) / (2.0 - left);
            assert_eq!(row.error.is_nan(), row.refine == 8);
            assert!(
                row.refine == 8 || (row.error - error).abs() < 1e-12,
                "{row:?}"
            );
        }
        assert!(solved[..2].iter().all(|row| row.order.is_nan()));
        assert!(
            solved[2..]
                .iter()
                .all(|row| (row.order - 0.75).abs() < 1e-6)
        );
        let order = &orders[0];
        assert_eq!((order.meshes, order.theory), (4, None));
        assert!(order.finest.refine == 8 && order.error == solved[2].error);
    }

    /// Goal: one mesh shows no bar and says why; values that go to and fro, or have settled, show no order.
    #[test]
    fn what_the_meshes_do_not_show_is_not_claimed() {
        let to_and_fro = |h: f64| vec![value("dissipation", 1.0 + (3.0 / h).cos())];
        let settled = |_: f64| vec![value("dissipation", 1.0)];
        let orders_of = |samples: &[Sample]| {
            let (errors, orders) = rows(samples);
            assert!(errors.iter().all(|row| row.order.is_nan()));
            orders
        };
        let one = orders_of(&values(&[1], settled));
        assert_eq!(one[0].finest.no_bar, Some(NoBar::OneMesh));
        assert!(one[0].finest.error_bar.is_nan() && one[0].error.is_nan());
        let moving = orders_of(&values(&[1, 2, 4, 8], to_and_fro));
        assert!(moving[0].finest.error_bar > 0.0);
        let still = orders_of(&values(&[1, 2, 4], settled));
        assert_eq!((still[0].finest.error_bar, still[0].error), (0.0, 0.0));
    }

    /// Goal: a patch test has no order, nor has a sequence that sinks into round-off.
    #[test]
    fn round_off_has_no_order() {
        let orders_of = |errors: [f64; 4]| -> Vec<f64> {
            let sample = |(i, error): (usize, f64)| {
                let refine = 1 << i;
                let deviation = Deviation {
                    quantity: "energy".into(),
                    at: String::new(),
                    found: 1.0,
                    exact: 1.0,
                    error,
                };
                sample(refine, Regularity::Smooth, Measured::Exact(vec![deviation]))
            };
            let samples: Vec<Sample> = errors.into_iter().enumerate().map(sample).collect();
            let (found, orders) = rows(&samples);
            assert_eq!(found[3].order.to_bits(), orders[0].finest.order.to_bits());
            found[2..].iter().map(|row| row.order).collect()
        };
        let patch = orders_of([1e-15, 4e-15, 1.6e-14, 6.4e-14]);
        assert!(patch.iter().all(|order| order.is_nan()), "{patch:?}");
        let sinking = orders_of([1e-6, 1e-8, 1e-10, 1e-13]);
        assert!((sinking[0] - 100f64.log2()).abs() < 1e-9 && sinking[1].is_nan());
        let fine = orders_of([8e-12, 4e-12, 2e-12, 1e-12]);
        assert!(
            fine.iter().all(|order| (order - 1.0).abs() < 1e-9),
            "{fine:?}"
        );
    }

    /// Source: Laborde, Pommier, Renard, Salaün (2005).
    #[test]
    fn tips_limit_the_order_unless_enriched_within_a_fixed_radius() {
        let order = |regularity| theoretical_order("energy", regularity);
        let found = [Regularity::Smooth, Regularity::FixedRadius, Regularity::Tip].map(order);
        assert_eq!(found, [Some(1.0), Some(1.0), Some(0.5)]);
        assert_eq!(
            theoretical_order("displacement", Regularity::Smooth),
            Some(2.0)
        );
        assert_eq!(theoretical_order("traction", Regularity::Smooth), Some(1.0));
        assert_eq!(theoretical_order("traction", Regularity::Tip), None);
        assert_eq!(theoretical_order("strain_energy", Regularity::Smooth), None);
    }
}
