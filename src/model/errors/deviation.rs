//! One quantity, found and exact, and what the errors of all of them are measured with.

use serde::{Deserialize, Deserializer, Serialize};

/// An exact value below this, in units of its natural scale, is zero.
pub const ZERO: f64 = 1e-9;

/// One quantity, found and exact; in a file NaN is `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Name, see [`errors`](super).
    pub quantity: String,
    /// `crack-1 tip-2` for a tip; empty for the whole body.
    pub at: String,
    /// Discrete value; for a field its norm. NaN: the mesh leaves no room to find it.
    #[serde(deserialize_with = "or_nan")]
    pub found: f64,
    /// Exact value; for a field its norm.
    pub exact: f64,
    /// Relative error; where the exact value is zero, relative to the natural scale; of a direction the angle [rad].
    #[serde(deserialize_with = "or_nan")]
    pub error: f64,
}

fn or_nan<'a, D: Deserializer<'a>>(file: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(file)?.unwrap_or(f64::NAN))
}

/// Natural scales of the exact field.
#[derive(Debug, Clone, Copy)]
pub struct Scales {
    /// Root mean square of the displacement [m].
    pub displacement: f64,
    /// Root mean square of the stress [Pa].
    pub stress: f64,
    /// Elastic energy [J, in 2D J/m].
    pub energy: f64,
}

impl Deviation {
    /// A deviation whose difference is measured against the exact size, or the natural scale if that is zero.
    pub fn new(
        quantity: &str,
        at: String,
        [found, exact]: [f64; 2],
        difference: f64,
        size: f64,
        scale: f64,
    ) -> Self {
        let unit = if size > ZERO * scale { size } else { scale };
        Deviation {
            quantity: quantity.to_owned(),
            at,
            found,
            exact,
            // A field that is zero everywhere has no scale: the difference itself, in SI units.
            error: if unit > 0.0 {
                difference / unit
            } else {
                difference
            },
        }
    }
}

/// A row of a norm from the squares of the found one, the exact one and that of the difference.
pub fn norm_row(quantity: &str, squares: [f64; 3], scale: f64) -> Deviation {
    let [found, exact, difference] = squares.map(f64::sqrt);
    Deviation::new(
        quantity,
        String::new(),
        [found, exact],
        difference,
        exact,
        scale,
    )
}
