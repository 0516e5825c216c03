//! Sweeps: many cells (case × mesh × space × friction × method × tolerance), each measured by itself and kept as a record.

pub mod cell;
pub mod record;
pub mod statistics;
