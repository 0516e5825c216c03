//! Extended finite elements: cracks, enrichment, cut cells, contact points.

pub mod basis;
pub mod cell_matrix;
pub mod conforming;
pub mod crack;
pub mod cut;
pub mod ellipse;
pub mod enrichment;
pub mod front;
pub mod front_facet;
pub mod graded;
pub mod pairs;
pub mod pieces;
pub mod slice;
pub mod traction;
