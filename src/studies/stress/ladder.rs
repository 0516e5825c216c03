//! Ladders: one parameter of a simple scene at a time, through its decades, and every parameter of every method.
//!
//! Random scenes say how often something breaks; a ladder says where it begins to. A rung is a scene like any other.

pub mod rung;
mod sheared;
mod uniform;

use std::sync::LazyLock;

use rung::{Content, Ladder};

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

/// The ladder of a rung, and its case.
pub fn case(number: u64) -> (&'static Ladder, &'static Content) {
    let (ladder, rung) = find(number);
    (ladder, &rung.1)
}

/// A ladder and its rung; of a number beyond the last, that.
fn find(number: u64) -> (&'static Ladder, &'static (f64, Content)) {
    RUNGS[(number as usize).min(RUNGS.len() - 1)]
}
