//! Extended finite elements: cracks, enrichment, cut cells, contact points.

pub mod basis;
pub mod cell_matrix;
pub mod conforming;
pub mod crack;
pub mod cut;
pub mod enrichment;
pub mod pairs;
pub mod pieces;
pub mod traction;
