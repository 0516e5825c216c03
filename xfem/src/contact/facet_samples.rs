//! Sample points of the crack surface, evenly spaced on every facet up to its corners: where the faces are asked whether they
//! overlap between contact points.
//!
//! ```text
//!   segment (2D)    x = p + t (q − p),  t = 0, 1/9, … 1                            10 points
//!   polygon (3D)    fan of the centroid c and the edges p q, on every triangle
//!                   x = (i c + j p + k q)/3,  i + j + k = 3, shared points once    1 + 6 points per edge
//! ```

use crate::cut::crack::Geometry;
use crate::enrichment::facets::CrackFacets;
use crate::geometry::curve::Curve;
use crate::geometry::{Point, add_scaled};
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

use super::surface_point::SurfacePoint;

/// Samples of a segment.
const ALONG: usize = 10;
/// Parts of the edges of a triangle of the fan.
const PARTS: usize = 3;

/// Samples of all cracks through cells, crack by crack and facet by facet. They stand for places only: no weight, no
/// multiplier.
///
/// # Errors
/// A sample without a reference position in its cell.
pub fn facet_samples(integrator: &CellIntegrator<'_>) -> Result<Vec<SurfacePoint>, CellError> {
    let CellIntegrator {
        mesh,
        cracks,
        enrichment,
        ..
    } = integrator;
    let mut samples = Vec::new();
    for (index, crack) in cracks.iter().enumerate() {
        let facets = CrackFacets::new(mesh, index, crack, enrichment);
        for facet in &facets.facets {
            for x in places(&facets.polygon(facet)) {
                let mut sample = SurfacePoint::on_facet(integrator, index, facet, x)?;
                // Chords stand for the arc: what slides along it does not overlap.
                if let Geometry::Curve(curve @ Curve::Arc { .. }) = &crack.geometry {
                    sample.frame = curve.frame(&x);
                }
                samples.push(sample);
            }
        }
    }
    Ok(samples)
}

/// Places on a facet.
fn places(corners: &[Point]) -> Vec<Point> {
    let mean = |parts: &[(usize, &Point)]| {
        let sum: usize = parts.iter().map(|(part, _)| part).sum();
        parts.iter().fold([0.0; 3], |x, (part, corner)| {
            add_scaled(&x, *part as f64 / sum as f64, corner)
        })
    };
    if let [p, q] = corners {
        let last = ALONG - 1;
        return (0..ALONG).map(|i| mean(&[(last - i, p), (i, q)])).collect();
    }
    let all: Vec<(usize, &Point)> = corners.iter().map(|corner| (1, corner)).collect();
    let centre = mean(&all);
    let mut places = vec![centre];
    for (i, p) in corners.iter().enumerate() {
        let q = &corners[(i + 1) % corners.len()];
        for away in 1..=PARTS {
            // The side towards q is the next triangle's.
            places
                .extend((0..away).map(|j| mean(&[(PARTS - away, &centre), (away - j, p), (j, q)])));
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{norm, sub};

    fn holds(places: &[Point], x: &Point) -> usize {
        let near = |p: &&Point| norm(&sub(p, x)) < 1e-12;
        places.iter().filter(near).count()
    }

    /// Goal: corners, centroid and points on the edges once each, the centroid of the samples that of a regular polygon.
    #[test]
    fn a_polygon_has_its_corners_and_centroid_once() {
        for count in [3, 4, 6] {
            let corner = |i: usize| {
                let (s, c) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
                [2.0 + c, s - 1.0, 0.5 * c]
            };
            let corners: Vec<Point> = (0..count).map(corner).collect();
            let found = places(&corners);
            assert_eq!(found.len(), 1 + 6 * count);
            assert!(found.iter().all(|x| holds(&found, x) == 1));
            assert!(corners.iter().all(|x| holds(&found, x) == 1));
            let third = add_scaled(&corners[0], 1.0 / 3.0, &sub(&corners[1], &corners[0]));
            assert_eq!(holds(&found, &third), 1);
            let sum = found
                .iter()
                .fold([0.0; 3], |sum, x| add_scaled(&sum, 1.0, x));
            let mean = sum.map(|v| v / found.len() as f64);
            assert!(norm(&sub(&mean, &[2.0, -1.0, 0.0])) < 1e-12);
        }
    }
}
