//! The program as its users meet it: verbs, case files, refusals, scripts.

#[path = "../common/mod.rs"]
mod common;

mod case_files;
mod program;
mod refusals;
