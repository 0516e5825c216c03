//! Extended finite elements: cracks, enrichment, cut cells, contact points.

pub mod basis;
pub mod cell_matrix;
pub mod conforming;
pub mod crack;
pub mod cut;
pub mod enrichment;
pub mod intensity;
pub mod interaction;
pub mod pairs;
pub mod pieces;
pub mod sampling;
pub mod surface_point;
pub mod traction;
pub mod williams;
