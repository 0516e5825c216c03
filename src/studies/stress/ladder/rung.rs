//! What a ladder is made of.

use crate::studies::stress::truth::Truth;

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Name in tables.
    pub name: String,
    /// What changes, with its unit.
    pub parameter: String,
    /// Method and name of the option that changes; none of a ladder of the scene.
    pub option: Option<(&'static str, &'static str)>,
    /// Values and scenes.
    pub(super) rungs: Vec<(f64, Content)>,
}

/// A case and what its answer is held to.
#[derive(Debug, Clone, PartialEq)]
pub struct Content {
    /// The case, as TOML.
    pub text: String,
    /// Space dimension.
    pub dim: usize,
    /// What its answer is held to.
    pub truth: Truth,
    /// The method whose option changes, with it.
    pub method: Option<String>,
}

impl Ladder {
    pub(super) fn new(
        name: &str,
        parameter: &str,
        values: impl IntoIterator<Item = f64>,
        content: impl Fn(f64) -> Content,
    ) -> Self {
        Ladder {
            name: name.into(),
            parameter: parameter.into(),
            option: None,
            rungs: values.into_iter().map(|v| (v, content(v))).collect(),
        }
    }
}

/// 10^from, …, 10^to.
pub(super) fn decades(from: i32, to: i32) -> Vec<f64> {
    let step = if from <= to { 1 } else { -1 };
    let count = (to - from).abs() + 1;
    (0..count).map(|k| power(from + step * k)).collect()
}

/// 10^k, correctly rounded.
pub(super) fn power(k: i32) -> f64 {
    format!("1e{k}").parse().unwrap_or(f64::NAN)
}

/// Both signs of 1, 0.1, …, 1e-14, and 0.
pub(super) fn from_both_sides() -> Vec<f64> {
    let below = decades(0, -14).into_iter().map(|v| -v);
    let above = decades(-14, 0);
    below.chain([0.0]).chain(above).collect()
}
