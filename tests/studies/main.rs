//! The studies, random bodies, and the files other programs read and write.

#[path = "../common/mod.rs"]
mod common;

mod atlas;
mod collections;
mod converge;
mod fclib;
mod fuzz;
mod interchange;
mod measure;
mod outside;
mod planted;
mod random;
mod robustness;
mod stress;
mod sweep;
mod sweep_files;
mod timings;
mod together;
