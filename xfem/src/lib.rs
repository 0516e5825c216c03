//! Extended finite elements for bodies with cracks in contact: two- and three-dimensional linear elasticity, enrichment
//! around cracks, contact spaces on their faces, stress intensity, closed forms.
//!
//! The modules stand in this order; none uses one that comes later.
//!
//! ```text
//!   geometry    points, curves, convex parts, crack shapes, coordinates of crack tips
//!   material    Hooke's law in plane strain, plane stress or a solid
//!   mesh        cells and their maps, meshes of boxes, elimination order
//!   quadrature  Gauss rules, rules for parts of cells, rules around tips and fronts
//!   cut         cracks in a mesh: level sets, parts of cut cells, where cracks end
//!   enrichment  functions of nodes and cells, pieces of the body, facets of cracks
//!   stiffness   stiffness of enriched cells, assembly, the basis of the solver
//!   fields      points at which solutions are compared over the body
//!   contact     contact spaces and points, traction, samples of the faces
//!   intensity   stress intensity factors: Williams' fields, fit of the jump, interaction integral
//!   exact       closed forms
//!   loads       supports and loads: prescribed unknowns, nodal forces
//!   discretisation  a body from all of these, and the judge of its mesh
//! ```

pub mod contact;
pub mod cut;
pub mod discretisation;
pub mod enrichment;
pub mod exact;
pub mod fields;
pub mod geometry;
pub mod intensity;
pub mod loads;
pub mod material;
pub mod mesh;
pub mod quadrature;
pub mod stiffness;

/// The example of the README is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
