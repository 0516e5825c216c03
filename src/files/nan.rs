//! Numbers that do not exist: NaN in memory, `null` in JSON. For `#[serde(with = "nan")]`.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Writes what is not finite as `null`.
///
/// # Errors
/// Those of the format.
pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
    Some(*value).filter(|v| v.is_finite()).serialize(to)
}

/// Reads `null` as NaN.
///
/// # Errors
/// Those of the format.
pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

/// Value of a missing number.
pub fn nothing() -> f64 {
    f64::NAN
}
