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

use std::fmt::Display;
use std::ops::Range;
use std::path::PathBuf;

use stickslip_methods::Tier;

use error::Source;

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

/// Kinematics of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// ε_zz = 0; quad4, quantities per metre of thickness.
    PlaneStrain,
    /// σ_zz = 0; quad4, quantities per metre of thickness.
    PlaneStress,
    /// Three-dimensional; hex8.
    Solid,
}

impl Model {
    /// Space dimension, 2 or 3.
    pub fn dim(self) -> usize {
        if self == Model::Solid { 3 } else { 2 }
    }
}

/// Isotropic linear elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus E > 0 [Pa].
    pub young: f64,
    /// Poisson's ratio, 0 <= ν < 0.5 (the upper end is excluded: the solid is then incompressible).
    pub poisson: f64,
}

/// A structured box mesh. Unused third entries (2D) are zero and one cell.
#[derive(Debug, Clone)]
pub struct MeshSpec {
    /// Where `mesh` stands in the file.
    pub span: Span,
    /// Grid-line coordinates per axis, strictly increasing, at least two each; `dim` axes [m].
    pub lines: Vec<Vec<f64>>,
    /// Bends the second family of grid lines so that it follows a straight line.
    pub follow: Option<Follow>,
    /// Turns the grid lines about the centre; after following, 2D only.
    pub twist: Option<Twist>,
    /// Moves the inner nodes at random; after everything else, 2D only.
    pub distort: Option<Distort>,
}

/// Grid lines turned about the centre of a 2D box by angle × w(x) w(y), w(s) = (1 − s²)² with s = ±1 on the border: the
/// border and the directions of the lines there stay.
#[derive(Debug, Clone)]
pub struct Twist {
    /// Where the table stands in the file.
    pub span: Span,
    /// Turn at the centre, counter-clockwise [rad], less than 180 degrees either way.
    pub angle: f64,
}

/// Inner nodes moved along every axis by up to amplitude × the narrower interval between grid lines beside them.
#[derive(Debug, Clone)]
pub struct Distort {
    /// Where the table stands in the file.
    pub span: Span,
    /// Largest move in intervals, 0 <= amplitude < 0.5.
    pub amplitude: f64,
    /// Seed of the moves; every node has a stream of its own.
    pub seed: u64,
}

/// Grid lines that follow a straight line inside the body and stay straight on its border.
///
/// The last coordinate (y in 2D, z in 3D) of a grid point is shifted by s(x) · r: s(x) = (x − x₀) tan(angle) within
/// `half_length` of the point (measured along x), returning linearly to 0 at the sides x = min, max; r falls linearly
/// from 1 on the row (or grid line) that holds the point to 0 at the two ends of that axis. The parser has checked that
/// every cell keeps a positive height.
#[derive(Debug, Clone)]
pub struct Follow {
    /// Where the table stands in the file.
    pub span: Span,
    /// A point of the line [m], inside the box.
    pub point: [f64; 3],
    /// Angle from the x axis [rad], less than 80 degrees either way.
    pub angle: f64,
    /// Half of the followed extent along x [m], less than the distance to either side; infinite: the line is followed
    /// from side to side.
    pub half_length: f64,
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

/// Geometry of a crack.
#[derive(Debug, Clone, PartialEq)]
pub enum CrackShape {
    /// 2D chain of straight segments through at least two points [m]; n is the tangent turned by +90 degrees.
    Polyline(Vec<[f64; 2]>),
    /// 2D circular arc, counter-clockwise for `to > from` [rad]; n is the tangent turned by +90 degrees, towards the
    /// centre of a counter-clockwise arc. |to − from| = 2π: a closed circle.
    Arc {
        /// Centre [m].
        centre: [f64; 2],
        /// Radius [m].
        radius: f64,
        /// Angle of the first end from the x axis [rad].
        from: f64,
        /// Angle of the second end [rad].
        to: f64,
    },
    /// Flat elliptic crack inside a solid; a disc if both half axes are equal.
    Ellipse {
        /// Centre [m].
        centre: [f64; 3],
        /// Unit normal, from side 2 to side 1.
        normal: [f64; 3],
        /// Unit direction of the first half axis, perpendicular to the normal; the local axis a.
        axis: [f64; 3],
        /// Half axes along `axis` and along normal × axis [m].
        half_axes: [f64; 2],
    },
    /// 3D plane through the whole body: a point [m] and a unit normal n (normalised by the parser).
    Plane {
        /// A point of the plane [m].
        point: [f64; 3],
        /// Unit normal, from side 2 to side 1.
        normal: [f64; 3],
    },
}

/// Tip enrichment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tip {
    /// No tip functions: the crack ends at the last cell edge it crosses.
    None,
    /// Four branch functions on the nodes of the cells with the tip (topological enrichment).
    Branch,
    /// Four branch functions on all nodes within a radius of the tip [m] (geometric enrichment).
    Radius(f64),
}

/// Contact space of a crack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactSpace {
    /// One point pair per crossed mesh edge, point forces (the founding paper's).
    EdgePairs,
    /// One multiplier per crossed mesh edge, linear in between, integrated over the crack.
    Facet,
    /// One multiplier per star of crossed edges, integrated over the crack: stable.
    Star,
    /// One constant multiplier per cut cell.
    P0,
}

impl ContactSpace {
    /// All spaces.
    pub const ALL: [Self; 4] = [Self::EdgePairs, Self::Facet, Self::Star, Self::P0];

    /// The space of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|space| space.name() == name)
    }

    /// Name in case files and tables.
    pub fn name(self) -> &'static str {
        match self {
            ContactSpace::EdgePairs => "edge-pairs",
            ContactSpace::Facet => "facet",
            ContactSpace::Star => "star",
            ContactSpace::P0 => "p0",
        }
    }
}

/// Quadrature of cut cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quadrature {
    /// Sub-cells on both sides of the crack: exact for the cut integrand on affine cells.
    SubCells,
    /// `gauss-N`: N points per direction on the whole cut cell, sides told apart point by point. Inexact; only to
    /// reproduce published numbers, and marked so in every report.
    Gauss(usize),
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
