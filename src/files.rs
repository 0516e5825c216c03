//! Files: contact problems that other programs read and write, and folders written as a whole.

pub mod bundle;
pub mod claim;
pub mod digest;
pub mod interchange;
pub mod nan;
pub(crate) mod regular;
pub(crate) mod visible;
