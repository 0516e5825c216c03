//! Linear algebra below the contact problem: the sparse factor of K, the Delassus operator, small dense systems.

pub(crate) mod delassus;
pub(crate) mod dense;
pub(crate) mod factor;
pub(crate) mod floating;
pub(crate) mod global;
pub(crate) mod ordering;
pub(crate) mod spectrum;
