//! Fields over the body: displacement, stress and strain of a solution, mass.

pub mod mass;
pub mod sampling;
