//! Cracks off the facets of a mesh: nodes on a crack belong to one side of it.
//!
//! A crack along cell facets would divide no cell. All cracks of a body are moved together, by next to nothing, until none
//! runs along a facet: what meets still meets, every node near such a crack lies on one side of it, decided once for the
//! whole body, and the crack is a cut like any other.

use crate::geometry::crack_shape::CrackShape;
use crate::geometry::{Point, mean};
use crate::mesh::{Lengths, Mesh};

use super::crack::{Crack, Tip};

/// A crack that runs along some facet wherever it is tried.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("crack {} runs along a facet near {at:?}, and beside that along others", crack + 1)]
pub struct AlongFacet {
    /// Its number in the case file, from 0.
    pub crack: usize,
    /// Where [m].
    pub at: Point,
}

/// A facet whose nodes are all closer to a crack than this, in units of the shortest edge there, lies along it.
const ALONG: f64 = 1e-10;

/// How far cracks are moved, in the same unit of the whole mesh: slivers of that thickness stay.
const STEP: f64 = 8.0 * ALONG;

/// Where cracks are tried, in steps: along no axis and no diagonal of a grid. Several near one line may need a few.
const PLACES: [Point; 12] = [
    [0.0; 3],
    [0.36, 0.80, 0.48],
    [-0.80, 0.48, 0.36],
    [0.48, -0.36, 0.80],
    [-0.93, -0.31, 0.20],
    [0.20, 0.93, -0.31],
    [1.3, -1.1, 0.7],
    [-0.7, 1.7, -1.2],
    [1.9, 0.5, 1.4],
    [-1.6, -0.9, 2.1],
    [0.6, -2.3, 1.1],
    [2.7, 1.5, -0.8],
];

/// Places cracks of given shapes and tips in a mesh, none of them along a facet.
///
/// # Errors
/// A crack that runs along some facet wherever it is tried.
pub fn off_facets(
    mesh: &Mesh,
    lengths: &Lengths,
    cracks: &[(&CrackShape, Tip)],
) -> Result<Vec<Crack>, AlongFacet> {
    let step = (STEP * lengths.smallest).max(64.0 * lengths.rounding);
    let mut stuck = None;
    for place in PLACES {
        let by = place.map(|x| x * step);
        let at = |(number, (shape, tip)): (usize, &(&CrackShape, Tip))| {
            Crack::new(number, &shape.moved(&by), *tip, mesh, lengths)
        };
        let cracks: Vec<Crack> = cracks.iter().enumerate().map(at).collect();
        let along = |crack: &Crack| Some((crack.number, facet_along(mesh, lengths, crack)?));
        stuck = cracks.iter().find_map(along);
        if stuck.is_none() {
            return Ok(cracks);
        }
    }
    let (crack, at) = stuck.unwrap_or_default();
    Err(AlongFacet { crack, at })
}

/// Where all nodes of a facet lie on a crack or next to it [m].
fn facet_along(mesh: &Mesh, lengths: &Lengths, crack: &Crack) -> Option<Point> {
    crack.cells().iter().find_map(|&cell| {
        let (nodes, phi) = (mesh.cell(cell), crack.cell_phi(mesh, cell));
        let near = |&i: &usize| {
            let size = lengths.of_nodes[nodes[i] as usize];
            phi[i].abs() <= (ALONG * size).max(lengths.rounding)
        };
        let mut facets = mesh.kind.facets().iter();
        let facet = facets.find(|facet| facet.iter().all(near))?;
        Some(mean(facet.iter().map(|&i| &mesh.nodes[nodes[i] as usize])))
    })
}
