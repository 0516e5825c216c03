//! The methods on small systems: one program, so that it is built and started once.

#![allow(missing_docs, non_snake_case)]

mod agreement;
mod allocations;
mod closed_form;
mod conformance;
mod honesty;
mod invariance;
mod judge;
mod linear;
mod local_form;
mod monolithic;
mod outside;
mod paradox;
mod registry;
mod robustness;
mod toys;
mod tresca;
mod unsymmetric;
