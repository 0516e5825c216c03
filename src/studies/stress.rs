//! The stress suite: random scenes that cluster where discretisations break, each run by every method and judged.
//!
//! A scene is the text of a case, so that whatever is found can be looked at with `stickslip run`. Scenes in uniform stress
//! are held to the closed form, the others to their energy; all must agree between exact methods and under changes of
//! units, place and names. Whatever fails has one [`Cause`](finding::Cause) and is made as small as it can be.

pub mod conduct;
pub mod examine;
pub mod finding;
mod invariance;
pub mod ladder;
mod referee;
pub mod rungs;
mod scene;
mod shrink;
pub mod summary;
mod transform;
mod trial;
mod truth;
mod uniform;

pub use scene::{Family, Scene, scene};
pub use truth::Truth;
