//! Contact on the crack faces: contact spaces, their points, traction, samples of the faces.

pub mod conforming;
pub mod edge_pairs;
pub mod facet_rule;
pub mod facet_samples;
pub mod integrated;
pub mod multipliers;
pub mod pairs;
pub mod space;
pub mod star_forest;
pub mod surface_point;
pub mod traction;

pub use space::ContactSpace;
