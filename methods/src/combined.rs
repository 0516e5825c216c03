//! Methods made of others.

pub mod hybrid;
