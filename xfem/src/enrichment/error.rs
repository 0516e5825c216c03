//! Cracks that a mesh cannot carry.

use crate::cut::arrangement::ArrangementError;
use crate::cut::crack::Crack;
use crate::cut::partition::PartitionError;
use crate::geometry::{Point, add_scaled};
use crate::mesh::Lengths;

/// Fault of a crack in a mesh; crack numbers are from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EnrichmentError {
    /// The crack cuts no cell.
    #[error("crack {} lies wholly outside the mesh", .0 + 1)]
    Outside(usize),
    /// Both tips in one cell, or in neighbours that share all contact: no contact point is left.
    #[error("crack {} is too short for this mesh, near {at:?}: no cell edge between its tips can carry contact", crack + 1)]
    TooShort {
        /// Crack number, from 0.
        crack: usize,
        /// Its middle [m].
        at: Point,
        /// Half the shortest edge: those at hand do not do [m].
        cell: f64,
    },
    /// Pieces of it share all displacements: no contact force can be told from another.
    #[error("crack {} has a piece between its bends, junctions and ends, near {at:?}, that is too short for this mesh: nothing tells the force on it from those beside it", crack + 1)]
    Undetermined {
        /// Crack number, from 0.
        crack: usize,
        /// Where [m].
        at: Point,
        /// Edge of cells that the piece crosses often enough [m].
        cell: f64,
    },
    /// It cuts off a piece that can move without any of its contact points telling.
    #[error("crack {} has too few contact points on this mesh for the piece that it cuts off near {at:?}: it can move freely", crack + 1)]
    Loose {
        /// Crack number, from 0.
        crack: usize,
        /// A place of the crack beside the piece [m].
        at: Point,
        /// Edge of cells with enough points around the piece [m].
        cell: f64,
    },
    /// The stiffness is singular to working precision beyond the motions of pieces, or those are not rigid: what was made one bent it.
    #[error("crack {} nearly touches another, itself or a side of the body, near {at:?}: this mesh does not tell how what lies between them moves", crack + 1)]
    Singular {
        /// Crack number, from 0.
        crack: usize,
        /// A node there [m].
        at: Point,
        /// Edge of cells that may tell [m].
        cell: f64,
    },
    /// Two cracks in one place, or a crack that is a point.
    #[error(transparent)]
    Arrangement(#[from] ArrangementError),
    /// A cell cannot be divided.
    #[error("crack {}: {reason}, near {at:?}", crack + 1)]
    Partition {
        /// Crack number, from 0.
        crack: usize,
        /// The fault, in words.
        reason: PartitionError,
        /// Centre of the cell [m].
        at: Point,
    },
    /// A crack of node pairs that is not made of facets.
    #[error("crack {} does not follow cell facets from node to node, near {at:?}", crack + 1)]
    OffFacets {
        /// Crack number, from 0.
        crack: usize,
        /// Where it runs through a cell, or ends [m].
        at: Point,
    },
}

impl EnrichmentError {
    /// Refuses a crack, given its arms.
    pub fn too_short(arms: &[Crack], crack: usize, lengths: &Lengths) -> Self {
        let own: Vec<&Crack> = arms.iter().filter(|arm| arm.number == crack).collect();
        let at = own
            .get(own.len() / 2)
            .map_or([f64::NAN; 3], |arm| arm.middle());
        let cell = 0.5 * lengths.smallest;
        Self::TooShort { crack, at, cell }
    }

    /// The same with its place in other coordinates, larger by `by` [m].
    pub fn moved(mut self, by: &Point) -> Self {
        match &mut self {
            Self::Arrangement(
                ArrangementError::Overlap { at, .. } | ArrangementError::Point { at, .. },
            )
            | Self::TooShort { at, .. }
            | Self::Undetermined { at, .. }
            | Self::Loose { at, .. }
            | Self::Singular { at, .. }
            | Self::Partition { at, .. }
            | Self::OffFacets { at, .. } => *at = add_scaled(at, 1.0, by),
            Self::Outside(_) => {}
        }
        self
    }
}
