//! Extended finite elements: cracks, enrichment, cut cells, contact points.

pub mod basis;
pub mod cell_matrix;
pub mod conforming;
pub mod crack;
pub mod cut;
pub mod edge_pairs;
pub mod ellipse;
pub mod enrichment;
pub mod facet_rule;
pub mod facets;
pub mod front;
pub mod front_facet;
pub mod graded;
pub mod integrated;
pub mod intensity;
pub mod interaction;
pub mod multipliers;
pub mod pairs;
pub mod pieces;
pub mod sampling;
pub mod slice;
pub mod star_forest;
pub mod surface_point;
pub mod traction;
pub mod williams;
