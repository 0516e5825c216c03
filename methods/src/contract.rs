//! What a method is given, what it returns, and who judges it: body, increment, state, laws, judge, options, registry.

pub(crate) mod barrier_law;
pub mod elastic;
pub mod judge;
pub mod law;
pub mod operator;
pub mod options;
pub mod point_status;
pub mod registry;
pub mod state;
pub mod system;
pub mod tier;
pub(crate) mod tractions;
