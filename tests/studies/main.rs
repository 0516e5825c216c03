//! The studies, random bodies, and the files other programs read and write.

#[path = "../common/mod.rs"]
mod common;

mod causes;
mod collections;
mod converge;
mod estimate;
mod fclib;
mod fuzz;
mod interchange;
mod limits;
mod measure;
mod outside;
mod pipeline;
mod planted;
mod random;
mod stress;
mod sweep_files;
