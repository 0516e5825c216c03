//! References, errors and observed orders of mesh sequences.
//!
//! e(h) ≈ C h^p: p by least squares of ln e over ln h on a mesh and the two before it, the order over the last two halvings.
//! Theoretical orders of bilinear elements with and without enriched tips: Laborde, Pommier, Renard, Salaün, Int. J. Numer.
//! Meth. Engng 64 (2005) 354.

use std::collections::BTreeMap;

use super::limit::{limit, slope};
use super::{Measured, Regularity, Sample, Seconds, Variant};
use crate::case::named;
use crate::run::verdict::Verdict;

/// Differences of a quantity below this fraction of its size are the tolerance of the runs, not the discretisation.
const RESOLVED: f64 = 1e-8;

/// Relative errors below are round-off: they neither fall nor say anything about an order.
pub const ROUND_OFF: f64 = 1e-12;

named! {
    /// What an error is measured against.
    pub enum Kind {
        /// A closed form.
        Exact = "exact",
        /// The limit extrapolated from the three finest meshes, which are thus correlated with it.
        Richardson = "richardson",
        /// The finest mesh: the sequence has no power law, or fewer than three meshes were solved.
        Finest = "finest",
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
    /// Error, without closed form relative to [`Value::norm`](super::Value::norm) on the finest mesh; NaN on the mesh that
    /// is itself the reference.
    pub error: f64,
    /// What the reference is; none where there is no error.
    pub kind: Option<Kind>,
    /// Order over this mesh and the two before; NaN where one of the three has no error, or none above [`ROUND_OFF`].
    pub order: f64,
    /// Times.
    pub seconds: Seconds,
}

/// One quantity of one sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderRow {
    /// Which sequence.
    pub variant: Variant,
    /// Quantity.
    pub quantity: String,
    /// Place and component; empty: the whole body.
    pub at: String,
    /// What the errors are measured against.
    pub kind: Kind,
    /// Meshes with an honest verdict.
    pub meshes: usize,
    /// Cell size of the finest of them [m].
    pub finest_h: f64,
    /// Its reference.
    pub reference: f64,
    /// Uncertainty of the reference; 0 of a closed form, NaN where unknown.
    pub error_bar: f64,
    /// Error on the finest mesh that has one.
    pub error: f64,
    /// Order over the last two halvings; NaN where there is none.
    pub order: f64,
    /// Order that theory promises; none where it is silent.
    pub theory: Option<f64>,
    /// Dimension of the body: the unknowns grow like h^−dim.
    pub dim: usize,
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

/// One quantity of one honest run, before it has a reference.
struct Point<'a> {
    sample: &'a Sample,
    found: f64,
    /// Closed form and error.
    exact: Option<(f64, f64)>,
    /// What errors without closed form are relative to.
    norm: f64,
    /// Whether it is more than rounding.
    counts: bool,
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
        for ((quantity, at), points) in sequences(&own) {
            let (found, order) = sequence(&quantity, &at, &points);
            errors.extend(found);
            orders.extend(order);
        }
    }
    (errors, orders)
}

/// Honest points by quantity and place, from coarse to fine. Quantities that vanish on every mesh are left out.
fn sequences<'a>(own: &[&'a Sample]) -> BTreeMap<(String, String), Vec<Point<'a>>> {
    let mut all: BTreeMap<(String, String), Vec<Point<'a>>> = BTreeMap::new();
    for &sample in own {
        let mut add = |quantity: &str, at: &str, point| {
            let key = (quantity.to_owned(), at.to_owned());
            all.entry(key).or_default().push(point);
        };
        match &sample.measured {
            Measured::Nothing => {}
            Measured::Exact(deviations) => deviations.iter().for_each(|d| {
                let point = Point {
                    sample,
                    found: d.found,
                    exact: Some((d.exact, d.error)),
                    norm: f64::NAN,
                    counts: true,
                };
                add(&d.quantity, &d.at, point);
            }),
            Measured::Values(values) => values.iter().for_each(|v| {
                let point = Point {
                    sample,
                    found: v.value,
                    exact: None,
                    norm: v.norm,
                    counts: v.value.abs() > RESOLVED * v.scale,
                };
                add(&v.quantity, &v.at, point);
            }),
        }
    }
    all.retain(|_, points| points.iter().any(|point| point.counts));
    all
}

/// Rows of one quantity: every mesh, and the sequence.
fn sequence(quantity: &str, at: &str, points: &[Point<'_>]) -> (Vec<ErrorRow>, Option<OrderRow>) {
    let place = |p: &Point<'_>| [p.sample.h, p.found];
    let Some(finest) = points.last() else {
        return (Vec::new(), None);
    };
    let extrapolated = match points {
        // What the runs do not resolve has no limit.
        [.., a, b, c]
            if [(a, b), (b, c)]
                .iter()
                .all(|(x, y)| resolved(x, y, finest.norm)) =>
        {
            limit(&[place(a), place(b), place(c)])
        }
        _ => None,
    };
    let relative = |found: f64, reference: f64| (found - reference).abs() / finest.norm;
    let mut rows: Vec<ErrorRow> = points
        .iter()
        .map(|point| {
            let (kind, reference, error_bar, error) = match (point.exact, &extrapolated) {
                (Some((exact, error)), _) => (Kind::Exact, exact, 0.0, error),
                (None, Some(limit)) => {
                    let error = relative(point.found, limit.value);
                    (Kind::Richardson, limit.value, limit.error_bar, error)
                }
                (None, None) => {
                    let itself = std::ptr::eq(point, finest);
                    let error = relative(point.found, finest.found);
                    let error = if itself { f64::NAN } else { error };
                    (Kind::Finest, finest.found, f64::NAN, error)
                }
            };
            ErrorRow {
                quantity: quantity.to_owned(),
                at: at.to_owned(),
                found: point.found,
                reference,
                error_bar,
                error,
                kind: Some(kind),
                ..unmeasured_row(point.sample)
            }
        })
        .collect();
    for last in 2..rows.len() {
        let three = &rows[last - 2..=last];
        // Against its own finest mesh a sequence always seems to converge.
        let measured = rows[last].kind != Some(Kind::Finest);
        if measured && three.iter().all(|row| row.error >= ROUND_OFF) {
            let points: Vec<[f64; 2]> = three.iter().map(|row| [row.h, row.error]).collect();
            rows[last].order = slope(&points);
        }
    }
    let order = rows.last().and_then(|last| {
        let with_error = rows.iter().rev().find(|row| row.error.is_finite());
        Some(OrderRow {
            variant: last.variant.clone(),
            quantity: quantity.to_owned(),
            at: at.to_owned(),
            kind: last.kind?,
            meshes: rows.len(),
            finest_h: last.h,
            reference: last.reference,
            error_bar: last.error_bar,
            error: with_error.map_or(f64::NAN, |row| row.error),
            order: last.order,
            theory: theoretical_order(quantity, finest.sample.regularity),
            dim: finest.sample.dim,
        })
    });
    (rows, order)
}

/// Whether two values differ by more than the tolerance of the runs.
fn resolved(a: &Point<'_>, b: &Point<'_>, norm: f64) -> bool {
    (a.found - b.found).abs() > RESOLVED * norm
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
        error: f64::NAN,
        kind: None,
        order: f64::NAN,
        seconds: sample.seconds,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Deviation, Value};
    use super::*;
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
            seconds: Seconds::NONE,
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

    /// Goal: the reference is the limit, its error bar holds the truth, and a failed mesh is a row without error.
    #[test]
    fn values_are_measured_against_their_limit() {
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
        let norm = 2.0 - 0.125f64.powf(0.75);
        for row in &solved {
            assert_eq!(row.kind, Some(Kind::Richardson));
            assert!((row.reference + 2.0).abs() < 1e-6 * row.error_bar);
            assert!(
                (row.error * norm - row.h.powf(0.75)).abs() < 1e-7,
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
        assert_eq!(
            (order.meshes, order.finest_h, order.theory),
            (4, 0.125, None)
        );
        assert!((order.order - 0.75).abs() < 1e-6 && order.error == solved[3].error);
    }

    /// Goal: too few meshes or no power law show as such, and claim no order.
    #[test]
    fn without_a_limit_the_finest_mesh_is_the_reference() {
        let to_and_fro = |h: f64| vec![value("dissipation", 1.0 + (3.0 / h).cos())];
        let settled = |_: f64| vec![value("dissipation", 1.0)];
        let two = values(&[1, 2], |h| vec![value("dissipation", 1.0 + h)]);
        for samples in [
            two,
            values(&[1, 2, 4, 8], to_and_fro),
            values(&[1, 2, 4], settled),
        ] {
            let (errors, orders) = rows(&samples);
            assert!(
                errors
                    .iter()
                    .all(|r| r.kind == Some(Kind::Finest) && r.order.is_nan())
            );
            let (last, before) = errors.split_last().expect("rows");
            assert!(last.error.is_nan() && before.iter().all(|r| r.error.is_finite()));
            assert_eq!(last.reference, last.found);
            assert!(orders[0].order.is_nan() && orders[0].error_bar.is_nan());
            assert_eq!(orders[0].error, before[before.len() - 1].error);
        }
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
            assert_eq!(found[3].order.to_bits(), orders[0].order.to_bits());
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
