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
mod load;
mod mesh;
pub(crate) mod parse;
pub(crate) mod reader;
mod schema;

pub use condition::Condition;
pub use error::CaseError;
pub use exact::ExactSpec;
pub use load::{Amount, CrackSide, History, Linear, LoadKind, LoadSpec, Region, SupportSpec};
pub use parse::{parse, parse_with, read};
pub use stickslip_xfem::contact::ContactSpace;
pub use stickslip_xfem::cut::crack::Tip;
pub use stickslip_xfem::geometry::crack_shape::CrackShape;
pub use stickslip_xfem::material::{Material, Model};
pub use stickslip_xfem::quadrature::Quadrature;

use std::fmt::Display;
use std::ops::Range;
use std::path::PathBuf;

use error::Source;
use stickslip_methods::Tier;
use stickslip_xfem::mesh::box_mesh::{GridSpec, Motion};

/// Byte range of a key's value in the case file, for error messages.
pub type Span = Range<usize>;

/// One checked case file.
#[derive(Debug, Clone)]
pub struct Case {
    /// File stem, the identifier in every table.
    pub name: String,
    /// File as given on the command line.
    pub file: PathBuf,
    /// Full text of the file; spans index into it.
    pub source: String,
    /// One-line title.
    pub title: String,
    /// Kinematics: plane strain, plane stress or a 3D solid.
    pub model: Model,
    /// Isotropic linear elasticity.
    pub material: Material,
    /// Structured mesh.
    pub mesh: MeshSpec,
    /// Cracks, in file order.
    pub cracks: Vec<CrackSpec>,
    /// Prescribed displacements, in file order; at a node and component named twice the later one wins.
    pub supports: Vec<SupportSpec>,
    /// Loads, in file order; they add up.
    pub loads: Vec<LoadSpec>,
    /// The closed form the case has, if it names one.
    pub exact: Option<ExactSpec>,
    /// Quadrature of cut cells.
    pub quadrature: Quadrature,
    /// Load path.
    pub path: PathSpec,
    /// What the case is run for.
    pub sweep: Sweep,
    /// Methods the case runs when the command line names none: (registry name, options as `key=value` pairs).
    pub methods: Vec<MethodSpec>,
    /// Default tier of the case.
    pub tier: Tier,
    /// Natural map the methods must reach, at most that of the tier; tighter where a closed form is held to more digits.
    pub tolerance: f64,
    /// Named places whose displacement is recorded.
    pub probes: Vec<ProbeSpec>,
    /// Numbers the case must reproduce.
    pub expects: Vec<Expect>,
}

impl Case {
    /// The source text at a span, for error messages.
    pub fn text(&self, span: &Span) -> &str {
        self.source.get(span.clone()).unwrap_or_default()
    }

    /// Error about the value at `span`, found later than by the parser (e.g. a crack wholly outside the mesh).
    ///
    /// `value` is what was found, `allowed` what would be accepted; key, line and column follow from the span.
    pub fn error(
        &self,
        span: &Span,
        value: impl Display,
        allowed: impl Display,
        message: impl Display,
    ) -> CaseError {
        Source {
            file: &self.file,
            text: &self.source,
        }
        .error(span, value, allowed, message)
    }
}

/// `[mesh]`: a structured box mesh.
#[derive(Debug, Clone)]
pub struct MeshSpec {
    /// Where `mesh` stands in the file.
    pub span: Span,
    /// Grid lines and what moves their points.
    pub grid: GridSpec,
    /// Where the motions of the grid points stand in the file.
    pub motion_spans: Vec<(Motion, Span)>,
}

impl MeshSpec {
    /// Where a motion of the grid points stands in the file; of one that is not in the file, where `mesh` stands.
    pub fn motion_span(&self, motion: Motion) -> &Span {
        let spans = &self.motion_spans;
        let found = spans.iter().find(|(own, _)| *own == motion);
        found.map_or(&self.span, |(_, span)| span)
    }
}

/// One crack.
#[derive(Debug, Clone)]
pub struct CrackSpec {
    /// Where the crack's table stands in the file.
    pub span: Span,
    /// Where the geometry (the value of `points_m`, `arc`, `plane`, ...) stands in the file.
    pub geometry_span: Span,
    /// Place and shape.
    pub geometry: CrackShape,
    /// Coulomb friction coefficient μ >= 0, for runs without a friction sweep.
    pub friction: f64,
    /// Enrichment at tips inside the body.
    pub tip: Tip,
    /// Where `tip` stands in the file, or the crack's table.
    pub tip_span: Span,
    /// Contact space.
    pub contact: ContactSpace,
}

/// Load path: times t_k = end · k / increments, k = 1..=increments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathSpec {
    /// Number of increments >= 1.
    pub increments: usize,
    /// Final time > 0 (no physical meaning: quasi-static).
    pub end: f64,
}

impl PathSpec {
    /// Time at the end of an increment, counted from 1.
    pub fn time(&self, increment: usize) -> f64 {
        self.end * increment as f64 / self.increments as f64
    }
}

/// Parameter sweep; no value occurs twice.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Friction coefficients; empty: every crack keeps its own.
    pub friction: Vec<f64>,
    /// Mesh refinement factors >= 1, at least one: every cell of the base mesh is divided by this number in each
    /// direction.
    pub refine: Vec<usize>,
}

/// A method with options.
#[derive(Debug, Clone)]
pub struct MethodSpec {
    /// Where it stands in the file.
    pub span: Span,
    /// Registry name.
    pub name: String,
    /// Options by name, in file order.
    pub options: Vec<(String, f64)>,
    /// Where the value of each option stands in the file, in the same order.
    pub option_spans: Vec<Span>,
}

/// A named place: the mesh node at it is recorded.
#[derive(Debug, Clone)]
pub struct ProbeSpec {
    /// Where it stands in the file.
    pub span: Span,
    /// Name in `quantities.csv`; differs from every side, crack and other probe.
    pub name: String,
    /// Place [m]; must coincide with a node.
    pub point: [f64; 3],
}

/// One expected number.
#[derive(Debug, Clone)]
pub struct Expect {
    /// Where it stands in the file.
    pub span: Span,
    /// Quantity name as in `quantities.csv`.
    pub quantity: String,
    /// Place (`at` column): a side, a probe or a crack (`crack-1`); empty: the whole body.
    pub at: String,
    /// Component (`component` column), e.g. `y`; empty: none.
    pub component: String,
    /// Only for this friction coefficient.
    pub friction: Option<f64>,
    /// Only for this refinement factor.
    pub refine: Option<usize>,
    /// Only for this method; otherwise every exact method (not `penalty`).
    pub method: Option<String>,
    /// Increment, counted from 1; otherwise the last.
    pub increment: Option<usize>,
    /// Expected value, in SI units.
    pub value: f64,
    /// Unit of the value, as in `quantities.csv`.
    pub unit: String,
    /// |found − value| <= tolerance.
    pub tolerance: Tolerance,
    /// Where the number comes from.
    pub kind: ExpectKind,
    /// Book, paper, table, derivation.
    pub source: String,
    /// What had to be assumed.
    pub assumptions: Vec<String>,
    /// True for a documented limitation: the number must be found outside its tolerance.
    pub missed: bool,
}

/// Tolerance of an expected number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Relative to |value|.
    Relative(f64),
    /// In the unit of the value.
    Absolute(f64),
}

/// Origin of an expected number, strongest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExpectKind {
    /// Closed form.
    Analytic,
    /// Printed in a publication.
    Published,
    /// Another code.
    Independent,
    /// This code, earlier; certifies nothing but stability.
    Snapshot,
}
