//! The stress suite: random scenes that cluster where discretisations break, each run by every method and judged.
//!
//! A scene is the text of a case, so that whatever is found can be looked at with `stickslip run`. Scenes in uniform stress
//! are held to the closed form, the others to their energy; all must agree between exact methods and under changes of
//! units, place and names. Whatever fails has one [`Fault`](finding::Fault) and is made as small as it can be.

pub mod check;
pub mod energy;
pub mod find;
pub mod finding;
mod pairs;
pub mod places;
pub mod rungs;
mod scene;
mod shrink;
pub mod suite;
pub mod summary;
pub mod transform;
pub mod twin;
mod uniform;

pub use scene::{Family, Scene, scene};
