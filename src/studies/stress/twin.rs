//! Effect of a transformation: a case is solved as it is and changed, and forces and energies are compared.

use serde::{Deserialize, Serialize};

use super::check::magnitude;
use super::energy::{Energies, Found};
use super::transform::Transform;
use crate::case::Case;
use crate::model::quantities::PointState;

/// Change by a transformation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Largest change of contact forces, over the largest force [-]; none where the contact points are others.
    pub force: Option<f64>,
    /// Change of strain energy and dissipation, over their sum [-]; 1 where it is not finite.
    pub energy: f64,
}

/// The change from an answer to that of the case transformed. `text`: the case as it is.
pub fn change(
    transform: &Transform,
    case: &Case,
    text: &str,
    as_it_is: Found<'_>,
    changed: Found<'_>,
) -> Change {
    let factor = transform.energy(case.model.dim());
    let energy = Energies::of(case, as_it_is).change(changed, factor);
    Change {
        force: force(transform, case, text, as_it_is.points, changed.points),
        energy: if energy.is_finite() { energy } else { 1.0 },
    }
}

/// Largest change of pressure and shear over the contact points, over the largest force; none where the points are others.
fn force(
    transform: &Transform,
    case: &Case,
    text: &str,
    base: &[PointState],
    other: &[PointState],
) -> Option<f64> {
    /// Points closer than this part of the weight of one are the same.
    const SAME: f64 = 1e-3;
    let dim = case.model.dim();
    let size = base.iter().map(magnitude).fold(0.0, f64::max);
    if base.len() != other.len() {
        return None;
    }
    if size == 0.0 {
        return Some(other.iter().map(magnitude).fold(0.0, f64::max).min(1.0));
    }
    let places = transform.places(text)?;
    let shear = |p: &PointState| p.p_a.hypot(p.p_b);
    let mut largest: f64 = 0.0;
    for p in base {
        let x = places.point([p.x_m, p.y_m, p.z_m]);
        let crack = transform.crack(p.crack, case.cracks.len());
        let away = |q: &&PointState| {
            let d = [q.x_m - x[0], q.y_m - x[1], q.z_m - x[2]];
            d.iter().map(|v| v * v).sum::<f64>().sqrt()
        };
        let own = other.iter().filter(|q| q.crack == crack);
        let q = own.min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let width = p.weight.powf(1.0 / (dim as f64 - 1.0)) * transform.length();
        if away(&q) > SAME * width {
            return None;
        }
        let factor = transform.force(dim);
        let normal = (q.p_n / factor - p.p_n).abs();
        largest = largest.max(normal.max((shear(q) / factor - shear(p)).abs()) / size);
    }
    Some(largest)
}
