//! What field figures draw: a scalar at every point of a picture, in its unit and with its levels.

use super::axis::{nice_step, prefixed, range};
use super::bands::Levels;
use super::canvas::{italic, plain, subscript};
use super::outline::cell_scalar;
use crate::model::field_mesh::{CellShape, FieldCell, FieldMesh};
use crate::report::ReportError;

/// Name of the point vector that deforms a body.
pub const DISPLACEMENT: &str = "displacement_m";
/// Name of the cell scalar with von Mises' equivalent stress.
pub const VON_MISES: &str = "von_mises_pa";

/// What a figure of it says in its caption.
pub const STRESS: &str = "von Mises stress";

/// Part of the body that a colour bar covers for certain: the stress at a tip has no bound.
const COVERED: f64 = 0.98;
/// A largest value up to this factor above that part is covered too.
const NEAR: f64 = 1.5;

/// Factor by which displacements are enlarged in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Magnification {
    /// A round factor that makes the largest displacement about a twentieth of the body.
    Auto,
    /// This factor.
    Factor(f64),
}

impl Magnification {
    /// The factor for a body of this diameter (m) and this largest displacement (m).
    pub fn factor(self, diameter: f64, displacement: f64) -> f64 {
        match self {
            Self::Factor(factor) => factor,
            Self::Auto if displacement > 0.0 && diameter > 0.0 => {
                nice_step(0.02 * diameter / displacement)
            }
            Self::Auto => 1.0,
        }
    }
}

/// A scalar field on the points of a picture.
pub struct Field {
    /// One value per point, in the unit of the label.
    pub values: Vec<f64>,
    pub levels: Levels,
    /// Label of the colour bar, with unit.
    pub label: String,
}

impl Field {
    /// Component 0, 1 or 2 of the displacement.
    pub fn displacement(displacement: &[[f64; 3]], component: usize) -> Self {
        let values = displacement.iter().map(|u| u[component]);
        let (low, high) = range(values.clone()).unwrap_or((0.0, 0.0));
        let (factor, unit) = prefixed(low.abs().max(high.abs()), "m");
        Self {
            values: values.map(|u| u * factor).collect(),
            levels: Levels::new(low * factor, high * factor),
            label: format!(
                "{}{} [{unit}]",
                italic("u"),
                subscript(["x", "y", "z"][component])
            ),
        }
    }

    /// von Mises' equivalent stress: at a point the mean over the cells that have it, weighted by their size. Points on
    /// the two faces of a crack are two, so nothing is averaged across it. The colour bar ends where all but a fiftieth of
    /// the body lies below, if the largest value is far above that.
    ///
    /// # Errors
    /// [`ReportError::FieldMesh`] when the picture has no such cell scalar, or not one value per cell.
    pub fn von_mises(picture: &FieldMesh) -> Result<Self, ReportError> {
        let given = picture.cell_scalars.iter().find(|(n, _)| n == VON_MISES);
        let count = given.map_or(0, |(_, values)| values.len());
        if count != picture.cells.len() {
            let reason = format!("{count} values for {} cells", picture.cells.len());
            return Err(ReportError::field_mesh(VON_MISES, reason));
        }
        let stress = cell_scalar(picture, VON_MISES);
        let mut sums = vec![(0.0, 0.0); picture.points.len()];
        for (cell, stress) in picture.cells.iter().zip(stress) {
            let size = measure(picture, cell);
            for point in cell.points.iter().filter(|_| stress.is_finite()) {
                if let Some((sum, weight)) = sums.get_mut(*point) {
                    *sum += size * stress;
                    *weight += size;
                }
            }
        }
        let means = sums.into_iter().map(|(sum, weight)| (sum / weight, weight));
        let means: Vec<(f64, f64)> = means.collect();
        let (low, high) = range(means.iter().map(|(value, _)| *value)).unwrap_or((0.0, 0.0));
        let covered = quantile(&means, COVERED);
        let end = if high > NEAR * covered { covered } else { high };
        let (factor, unit) = prefixed(end, "Pa");
        Ok(Self {
            values: means.iter().map(|(value, _)| value * factor).collect(),
            levels: Levels::new(low * factor, end * factor).reaching(high * factor),
            label: format!("{}{} [{unit}]", italic("σ"), subscript("vM")),
        })
    }
}

/// The value below which this part of the weights lies.
fn quantile(values: &[(f64, f64)], part: f64) -> f64 {
    let mut sorted: Vec<(f64, f64)> = values.to_vec();
    sorted.retain(|(value, _)| value.is_finite());
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = sorted.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    let found = sorted.iter().find(|(_, weight)| {
        below += weight;
        below >= part * total
    });
    found.map_or(0.0, |(value, _)| *value)
}

/// Area or volume of a cell; 0 for lines and vertices.
fn measure(picture: &FieldMesh, cell: &FieldCell) -> f64 {
    let x = |i: usize| cell.points.get(i).and_then(|p| picture.points.get(*p));
    let edge = |from: usize, to: usize| -> [f64; 3] {
        let (Some(a), Some(b)) = (x(from), x(to)) else {
            return [0.0; 3];
        };
        std::array::from_fn(|c| b[c] - a[c])
    };
    let product = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|c| {
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            a[d] * b[e] - a[e] * b[d]
        })
    };
    let dot = |a: [f64; 3], b: [f64; 3]| -> f64 { (0..3).map(|c| a[c] * b[c]).sum() };
    let tetrahedron = |a, b, c| dot(product(edge(0, a), edge(0, b)), edge(0, c)).abs() / 6.0;
    match cell.shape {
        CellShape::Vertex | CellShape::Line => 0.0,
        CellShape::Triangle | CellShape::Polygon | CellShape::Quad => {
            let fan = 2..cell.points.len().max(2);
            let sum = fan.fold([0.0; 3], |sum: [f64; 3], i| {
                let part = product(edge(0, i - 1), edge(0, i));
                std::array::from_fn(|c| sum[c] + 0.5 * part[c])
            });
            dot(sum, sum).sqrt()
        }
        CellShape::Tetra => tetrahedron(1, 2, 3),
        // Around the diagonal from corner 0 to corner 6.
        CellShape::Hexahedron => {
            let ring = [1, 2, 3, 7, 4, 5];
            let part = |i: usize| tetrahedron(ring[i], ring[(i + 1) % 6], 6);
            (0..6).map(part).sum()
        }
    }
}

/// The caption with the magnification.
pub fn full_caption(caption: &str, factor: f64) -> String {
    let deformation = format!("deformation ×{}", crate::report::number::value(factor));
    match plain(caption) {
        text if text.is_empty() => deformation,
        text => format!("{text}, {deformation}"),
    }
}

/// The values of a point vector.
///
/// # Errors
/// [`ReportError::FieldMesh`] when it is missing or has not one value per point.
pub fn point_vector<'a>(picture: &'a FieldMesh, name: &str) -> Result<&'a [[f64; 3]], ReportError> {
    let found = picture.point_vectors.iter().find(|(n, _)| n == name);
    let Some((_, values)) = found else {
        return Err(ReportError::field_mesh(
            name,
            "the picture has no such point vector".into(),
        ));
    };
    if values.len() != picture.points.len() {
        let reason = format!(
            "{} values for {} points",
            values.len(),
            picture.points.len()
        );
        return Err(ReportError::field_mesh(name, reason));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(shape: CellShape, points: Vec<[f64; 3]>) -> FieldMesh {
        let cell = FieldCell {
            shape,
            points: (0..points.len()).collect(),
        };
        FieldMesh {
            dim: 3,
            points,
            cells: vec![cell],
            ..FieldMesh::default()
        }
    }

    #[test]
    fn cells_have_their_area_or_volume() {
        let plane = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [1.0, 2.0], [0.0, 1.0]];
        let pentagon = picture(CellShape::Polygon, plane.map(|[x, y]| [x, y, 0.0]).to_vec());
        assert_eq!(measure(&pentagon, &pentagon.cells[0]), 5.5);
        let corner = |i: usize| {
            let one = |inside: bool| f64::from(u8::from(inside));
            // A sheared brick 2 x 1 x 3.
            let z = 3.0 * one(i > 3);
            let x = 2.0 * one([1, 2, 5, 6].contains(&i)) + 0.5 * z;
            [x, one([2, 3, 6, 7].contains(&i)), z]
        };
        let brick = picture(CellShape::Hexahedron, (0..8).map(corner).collect());
        assert_eq!(measure(&brick, &brick.cells[0]), 6.0);
        let tetra = picture(CellShape::Tetra, [0, 1, 3, 4].map(corner).to_vec());
        assert_eq!(measure(&tetra, &tetra.cells[0]), 1.0);
    }

    /// Two squares of unequal size, the smaller one under five times the stress; a point of both takes the mean by area.
    #[test]
    fn stress_at_a_point_is_the_mean_over_its_cells() {
        let mut picture = picture(
            CellShape::Quad,
            vec![[0.0; 3], [3.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        );
        picture.points.extend([[4.0, 0.0, 0.0], [4.0, 1.0, 0.0]]);
        picture.cells.push(FieldCell {
            shape: CellShape::Quad,
            points: vec![1, 4, 5, 2],
        });
        assert!(Field::von_mises(&picture).is_err(), "no stress");
        let stress = vec![1e6, 5e6];
        picture.cell_scalars.push((VON_MISES.into(), stress));
        let field = Field::von_mises(&picture).expect("a field");
        assert_eq!(field.values, [1.0, 2.0, 2.0, 1.0, 5.0, 5.0]);
        assert!(field.label.ends_with("[MPa]"), "{}", field.label);
    }

    #[test]
    fn a_quantile_weighs_its_values() {
        let values = [(3.0, 1.0), (1.0, 97.0), (f64::NAN, 50.0), (2.0, 2.0)];
        assert_eq!(quantile(&values, 0.9), 1.0);
        assert_eq!(quantile(&values, 0.98), 2.0);
        assert_eq!(quantile(&[], 0.5), 0.0);
    }
}
