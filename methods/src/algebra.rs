//! Linear algebra below the contact problem: matrices, the factored stiffness, the Delassus operator, rigid motions.

pub(crate) mod condensation;
pub(crate) mod delassus;
pub(crate) mod dense;
pub(crate) mod factor;
pub(crate) mod floating;
pub(crate) mod gmres;
pub(crate) mod loads;
pub mod matrix;
pub mod memory;
pub(crate) mod multifrontal;
pub(crate) mod plain;
pub(crate) mod rows;
pub(crate) mod sparse;
pub(crate) mod spectrum;
pub(crate) mod stiffness;
pub(crate) mod strips;
pub(crate) mod tied;
