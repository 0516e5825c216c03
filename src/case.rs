//! A case: one problem of mechanics with its sweep and its expected numbers, as read from a TOML file.
//!
//! [`read`] turns a file into a checked [`Case`]; everything after it may rely on the ranges stated here. What only the
//! discretisation can find wrong (a crack outside the mesh, a piece without support) is reported through
//! [`Case::error`] at the same file, line and column. The format is documented for users in `docs/case-format.md`.

mod condition;
mod crack;
pub(crate) mod error;
mod exact;
mod expect;
mod frame;
mod load;
mod mesh;
mod named;
pub(crate) mod parse;
mod polynomial;
pub(crate) mod reader;
mod settings;
pub mod shipped;

pub use condition::{Condition, Parts};
pub use crack::CrackSpec;
pub use error::{CaseError, Span};
pub use exact::ExactSpec;
pub use expect::{Expect, ExpectKind, ProbeSpec, Tolerance};
pub use load::{Amount, CrackSide, History, LoadKind, LoadSpec, Region, SupportSpec};
pub use mesh::{MeshSpec, Sweep, even_lines};
pub(crate) use named::named;
pub use parse::{Case, parse, parse_with, read};
pub use polynomial::Polynomial;
pub use settings::{MethodSpec, PathSpec, Target};
pub use stickslip_xfem::contact::ContactSpace;
pub use stickslip_xfem::cut::crack::Tip;
pub use stickslip_xfem::geometry::crack_shape::CrackShape;
pub use stickslip_xfem::material::{Material, Model};
pub use stickslip_xfem::quadrature::Quadrature;
