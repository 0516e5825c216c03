//! Sweeps: many cells (case × mesh × space × friction × method × tolerance), each measured by itself and kept as a record.

pub mod analysis;
pub mod cell;
pub mod compare;
pub mod record;
pub mod statistics;
