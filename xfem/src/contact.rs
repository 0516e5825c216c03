//! Contact on the crack faces: contact spaces, their points, traction, samples of the faces.
//!
//! A space is a function that says where its points lie and what they stand for, a variant of [`ContactSpace`] with its
//! name, and a line of [`surface`].

pub mod conforming;
pub mod edge_pairs;
pub mod facet_samples;
pub mod free_jumps;
pub mod integrated;
pub mod multipliers;
pub mod pairs;
pub mod rank;
pub mod star_forest;
pub mod surface_point;
pub mod surface_rule;
pub mod traction;

use crate::stiffness::cell_matrix::{CellError, CellIntegrator};

use self::edge_pairs::edge_pairs;
use self::integrated::integrated;
use self::pairs::ContactSurface;

/// Contact space of a crack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactSpace {
    /// One point pair per crossed mesh edge, point forces (the founding paper's).
    EdgePairs,
    /// One multiplier per star of crossed edges, integrated over the crack: stable.
    Star,
    /// One point per pair of nodes of a crack along cell facets; by name only.
    NodePairs,
}

impl ContactSpace {
    /// Those of cracks through cells, the stable one first.
    pub const ALL: [Self; 2] = [Self::Star, Self::EdgePairs];

    /// The space of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|space| space.name() == name)
    }

    /// Name in case files and tables.
    pub fn name(self) -> &'static str {
        match self {
            ContactSpace::EdgePairs => "edge-pairs",
            ContactSpace::Star => "star",
            ContactSpace::NodePairs => "node-pairs",
        }
    }

    /// Whether contact points are means over multiplier functions, not places.
    pub fn is_integrated(self) -> bool {
        self == ContactSpace::Star
    }
}

/// Contact surface of the `index`-th crack. `held` tells the prescribed unknowns.
///
/// # Errors
/// A point of the crack without a place in its cell.
pub fn surface(
    integrator: &CellIntegrator<'_>,
    index: usize,
    space: ContactSpace,
    held: impl Fn(usize) -> bool,
) -> Result<ContactSurface, CellError> {
    match space {
        ContactSpace::EdgePairs => edge_pairs(integrator, index, held),
        ContactSpace::Star => integrated(integrator, index, held),
        ContactSpace::NodePairs => Ok(ContactSurface::default()),
    }
}
