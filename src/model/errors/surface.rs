//! Norms over the crack surface: contact traction and jump, and the direction of the slip.
//!
//! ```text
//!   point k at a place x_k:            exact values λ(x_k), [[u]](x_k)
//!   point k of an integrated space:    (1/w_k) ∫ φ_k λ dΓ,  (1/w_k) ∫ φ_k [[u]] dΓ,   w_k = ∫ φ_k dΓ
//! ```
//!
//! A point of an integrated space holds the mean of the jump over its function φ_k. Near a tip the mean of √r differs from
//! the value at the centroid by percents, however exact the field is: like is compared with like.

use stickslip_xfem::contact::surface_point::SurfacePoint;
use stickslip_xfem::exact::Field;
use stickslip_xfem::geometry::{Point, add_scaled};

use crate::model::body::Body;
use crate::model::snapshot::Snapshot;

use super::deviation::{Deviation, Scales, ZERO, norm_row};

/// Found and exact values at one place, in the local frame, with a weight.
struct Sample {
    weight: f64,
    found: [f64; 3],
    exact: [f64; 3],
}

/// Rows of traction, slip and gap.
pub(super) fn rows(
    body: &Body,
    surface: &[SurfacePoint],
    field: &dyn Field,
    now: &Snapshot,
    scales: &Scales,
) -> Vec<Deviation> {
    let dim = body.mesh.dim();
    let integrator = body.integrator();
    let mut rows = Vec::new();
    if !surface.is_empty() {
        let over = |found: &dyn Fn(&SurfacePoint) -> [f64; 3],
                    exact: &dyn Fn(&Point) -> [f64; 3]| {
            let sample = |p: &SurfacePoint| Sample {
                weight: p.weight,
                found: found(p),
                exact: exact(&p.x),
            };
            surface.iter().map(sample).collect::<Vec<_>>()
        };
        let tractions = over(&|p| p.traction(dim, &body.points, &now.p), &|x| {
            field.traction(x)
        });
        let length: f64 = surface.iter().map(|p| p.weight).sum();
        let scale = scales.stress * length.sqrt();
        rows.push(norm_row("traction", squares(&tractions), scale));
        let jumps = over(&|p| p.local(&p.jump(&integrator, &now.u)), &|x| {
            field.jump(x)
        });
        rows.extend(largest(["slip", "gap"], &jumps, scales.displacement));
        rows.extend(direction(&jumps, scales.displacement).filter(|_| dim == 3));
    }
    if body.points.is_empty() {
        return rows;
    }
    // Of a force over the weight of its point, or of a jump as it is.
    let at_points = |values: &[f64], divisor: &dyn Fn(usize) -> f64, exact: Vec<[f64; 3]>| {
        let sample = |(i, exact): (usize, [f64; 3])| {
            let mut found = [0.0; 3];
            for (v, value) in found.iter_mut().zip(&values[i * dim..(i + 1) * dim]) {
                *v = value / divisor(i);
            }
            Sample {
                weight: 1.0 / body.points.len() as f64,
                found,
                exact,
            }
        };
        let samples = exact.into_iter().enumerate().map(sample);
        samples.collect::<Vec<_>>()
    };
    let exact = exact_at_points(body, &|x| field.traction(x));
    let tractions = at_points(&now.p, &|i| body.points[i].weight, exact);
    rows.push(norm_row("traction_rms", squares(&tractions), scales.stress));
    let exact = exact_at_points(body, &|x| field.jump(x));
    let jumps = at_points(&now.jump, &|_| 1.0, exact);
    let names = ["slip_points", "gap_points"];
    rows.extend(largest(names, &jumps, scales.displacement));
    rows
}

/// Values of an exact surface field at the contact points: its mean over the function of a point, or its value there.
fn exact_at_points(body: &Body, field: &dyn Fn(&Point) -> [f64; 3]) -> Vec<[f64; 3]> {
    let mut sums = vec![([0.0; 3], 0.0); body.points.len()];
    let quadrature = body.surface.quadrature.iter();
    for q in quadrature.filter(|q| body.integrated[q.crack]) {
        let value = field(&q.x);
        for &(k, share) in &q.shares {
            let (sum, weight) = &mut sums[k as usize];
            *sum = add_scaled(sum, share * q.weight, &value);
            *weight += share * q.weight;
        }
    }
    let points = body.points.iter().zip(sums);
    points
        .map(|(point, (sum, weight))| {
            if body.integrated[point.crack] {
                sum.map(|v| v / weight)
            } else {
                field(&point.x)
            }
        })
        .collect()
}

/// Angle between the found and the exact mean slip [rad]; `None` where the exact one is zero and has no direction.
///
/// Sums in local frames are means only where the crack is flat: closed forms in 3D are those of plane cracks.
fn direction(samples: &[Sample], scale: f64) -> Option<Deviation> {
    let mean = |of: &dyn Fn(&Sample) -> [f64; 3]| {
        samples.iter().fold([0.0; 2], |sum, s| {
            let [_, a, b] = of(s);
            [sum[0] + s.weight * a, sum[1] + s.weight * b]
        })
    };
    let (found, exact) = (mean(&|s| s.found), mean(&|s| s.exact));
    let area: f64 = samples.iter().map(|s| s.weight).sum();
    if square(&exact).sqrt() <= ZERO * scale * area {
        return None;
    }
    // Sine and cosine, both by the product of the lengths: no branch at ±π.
    let sine = exact[0] * found[1] - exact[1] * found[0];
    let cosine = exact[0] * found[0] + exact[1] * found[1];
    let angle = |[a, b]: [f64; 2]| b.atan2(a);
    Some(Deviation {
        quantity: "slip_direction".into(),
        at: String::new(),
        found: angle(found),
        exact: angle(exact),
        error: sine.atan2(cosine).abs(),
    })
}

fn square(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum()
}

fn difference(sample: &Sample) -> [f64; 3] {
    [0, 1, 2].map(|k| sample.found[k] - sample.exact[k])
}

/// Weighted sums of squares: found, exact, difference.
fn squares(samples: &[Sample]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for sample in samples {
        sums[0] += sample.weight * square(&sample.found);
        sums[1] += sample.weight * square(&sample.exact);
        sums[2] += sample.weight * square(&difference(sample));
    }
    sums
}

/// Largest tangential and normal error of the jump, over the largest exact jump.
fn largest(names: [&'static str; 2], samples: &[Sample], scale: f64) -> [Deviation; 2] {
    let over = |f: &dyn Fn(&Sample) -> f64| samples.iter().map(f).fold(0.0, f64::max);
    let size = over(&|s| square(&s.exact).sqrt());
    let [tangential, normal] = [1..3, 0..1];
    [(names[0], tangential), (names[1], normal)].map(|(name, part)| {
        let found = over(&|s| square(&s.found[part.clone()]).sqrt());
        let exact = over(&|s| square(&s.exact[part.clone()]).sqrt());
        let error = over(&|s| square(&difference(s)[part.clone()]).sqrt());
        Deviation::new(name, String::new(), [found, exact], error, size, scale)
    })
}
