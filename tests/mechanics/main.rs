//! The whole chain against mechanics: closed forms, patch tests, invariance, published numbers.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod arrangement;
mod conforming;
mod corners;
mod energy;
mod errors;
mod exact;
mod exact_curve;
mod few_cells;
mod fronts;
mod geometries;
mod incompressible;
mod inf_sup;
mod intensity;
mod invariance;
mod junctions;
mod load_path;
mod loads;
mod mass;
mod mesh_judge;
mod nitsche;
mod parts_of_sides;
mod patch;
mod penetration;
mod published;
mod robust;
mod skips;
mod spaces;
mod tips;
mod tolerances;
mod traction;
