//! Ladders: one parameter of a simple scene at a time, through its decades, and every parameter of every method.
//!
//! Random scenes say how often something breaks; a ladder says where it begins to. A rung is a scene like any other.

mod sheared;
mod uniform;

use std::sync::LazyLock;

use super::scene::{Family, Scene, Truth};

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
    rungs: Vec<(f64, Content)>,
}

/// A case and what its answer is held to.
#[derive(Debug, Clone, PartialEq)]
struct Content {
    text: String,
    dim: usize,
    truth: Truth,
    method: Option<String>,
}

/// All: of plane bodies that stick, of plane bodies that slip, of solids, of methods.
static LADDERS: LazyLock<Vec<Ladder>> = LazyLock::new(|| {
    let mut all = uniform::places();
    all.extend(uniform::units());
    all.extend(sheared::slips());
    all.extend(uniform::solids());
    all.extend(sheared::options());
    all
});

/// Rungs by number.
static RUNGS: LazyLock<Vec<(&Ladder, &(f64, Content))>> = LazyLock::new(|| {
    let of = |ladder: &'static Ladder| ladder.rungs.iter().map(move |rung| (ladder, rung));
    LADDERS.iter().flat_map(of).collect()
});

/// All ladders.
pub fn ladders() -> &'static [Ladder] {
    &LADDERS
}

/// Number of rungs of all ladders.
pub fn count() -> u64 {
    RUNGS.len() as u64
}

/// The ladder of a rung with a number below [`count`], and the value of its parameter there.
pub fn rung(number: u64) -> (&'static Ladder, f64) {
    let (ladder, rung) = find(number);
    (ladder, rung.0)
}

/// Its scene.
pub fn scene(number: u64) -> Scene {
    let (ladder, (_, content)) = find(number);
    Scene {
        family: Family::Ladder,
        number,
        category: ladder.name.clone(),
        dim: content.dim,
        text: content.text.clone(),
        truth: content.truth.clone(),
        methods: content.method.clone().into_iter().collect(),
        beyond: false,
    }
}

/// A ladder and its rung; of a number beyond the last, that.
fn find(number: u64) -> (&'static Ladder, &'static (f64, Content)) {
    RUNGS[(number as usize).min(RUNGS.len() - 1)]
}

impl Ladder {
    fn new(
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
fn decades(from: i32, to: i32) -> Vec<f64> {
    let step = if from <= to { 1 } else { -1 };
    let count = (to - from).abs() + 1;
    (0..count).map(|k| power(from + step * k)).collect()
}

/// 10^k, correctly rounded.
fn power(k: i32) -> f64 {
    format!("1e{k}").parse().unwrap_or(f64::NAN)
}

/// Both signs of 1, 0.1, …, 1e-14, and 0.
fn from_both_sides() -> Vec<f64> {
    let below = decades(0, -14).into_iter().map(|v| -v);
    let above = decades(-14, 0);
    below.chain([0.0]).chain(above).collect()
}
