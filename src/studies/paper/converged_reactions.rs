//! Reactions of the paper's plate under refinement, with the error bars of the finest: by edge pairs with enriched tip cells as
//! in the paper, and by stable multipliers with tips enriched within a fixed radius.
//!
//! Body, crack and supports are those of Table 1. Star multipliers hold the faces between the crossed edges too, and branch
//! functions within 1.5 m of the tips take the √r field at any cell width: more than the coarsest cell, 0.91 m, so that
//! every mesh enriches several rings of nodes, and far from the other tip, 13.5 m, and the sides, 5.2 m. What is left are the
//! corners of the plate, where a held side meets a free one, with stresses like r^(λ−1) and reactions that converge like h^2λ:
//!
//! ```text
//!   sin²(λ π/2) = (4 (1 − ν)² − λ²) / (3 − 4ν)      plane strain, ν = 0.3: λ = 0.711, order 1.42
//! ```
//!
//! Williams, J. Appl. Mech. 19 (1952) 526. Their third mesh is Mesh I turned by 20 degrees at its centre: the crack crosses its
//! cells in every way.

use crate::case::{self, Case, ContactSpace, Tip};
use crate::run::progress::Progress;
use crate::studies::convergence::orders::{self, ErrorRow, OrderRow};
use crate::studies::convergence::{self, ConvergencePlan};
use crate::studies::paper::lookup;
use crate::studies::paper::lookup::{PaperError, choice};
use crate::studies::paper::printed_tables::Table1Row;

/// Radius of the tip enrichment of stable multipliers [m].
const RADIUS: f64 = 1.5;
/// Turn of the third mesh at its centre [degrees].
const TURN: f64 = 20.0;
/// Method.
const METHOD: &str = "hybrid";

/// Case, its mesh in Table 1, whether it is turned, refinement factors: even ones would put the crack of Mesh II on a grid line.
type Family = (&'static str, &'static str, bool, &'static [usize]);
/// Meshes of the paper's own discretisation.
const EDGE_PAIRS: [Family; 2] = [
    ("plate_mesh1", "I", false, &[1, 2, 4, 8]),
    ("plate_mesh2", "II", false, &[1, 3, 5, 7]),
];
/// Meshes of the other.
const STAR: [Family; 3] = [
    ("plate_mesh1", "I", false, &[1, 2, 4, 8, 16]),
    ("plate_mesh2", "II", false, &[1, 3, 7, 15]),
    ("plate_mesh1", "I", true, &[1, 2, 4, 8, 16]),
];

/// Reactions on every mesh, and the finest ones beside the printed numbers of Table 1: by edge pairs, and by star multipliers
/// if they are wanted.
///
/// # Errors
/// Of the cases or their discretisation.
pub fn converged_reactions(
    star: bool,
    printed: &[Table1Row],
    progress: &dyn Progress,
) -> Result<(Vec<ErrorRow>, Vec<OrderRow>), PaperError> {
    let mut sequences = Vec::new();
    let mut finest = Vec::new();
    let edge_pairs = EDGE_PAIRS.map(|family| (ContactSpace::EdgePairs, None, family));
    let star = STAR.into_iter().filter(|_| star);
    let star = star.map(|family| (ContactSpace::Star, Some(vec![Tip::Radius(RADIUS)]), family));
    for (space, tips, (name, mesh, turned, factors)) in edge_pairs.into_iter().chain(star) {
        let plate = plate(name, turned)?;
        let plan = ConvergencePlan {
            refine: Some(factors.to_vec()),
            spaces: Some(vec![space]),
            tips,
            choice: choice(METHOD, &[])?,
        };
        let samples = convergence::run(&plate, &plan, progress)?;
        let (errors, orders) = orders::rows(&samples);
        // A mesh that is not solved has a row without quantity.
        let wanted = |quantity: &str, at: &str| (quantity, at) == ("reaction", "top y");
        let own = |row: &ErrorRow| wanted(&row.quantity, &row.at) || row.kind.is_none();
        sequences.extend(errors.into_iter().filter(own));
        for order in orders {
            let row = &order.finest;
            let alike = |other: &&Table1Row| {
                !turned && other.mesh == mesh && other.friction == row.variant.friction
            };
            let printed = printed.iter().find(alike);
            let printed = printed.and_then(|row| row.printed_mn_per_m);
            if wanted(&row.quantity, &row.at) {
                // Printed against the direction of the push.
                let printed = printed.map(|mn_per_m| -1e6 * mn_per_m);
                finest.push(OrderRow { printed, ..order });
            }
        }
    }
    Ok((sequences, finest))
}

/// The plate on one of the meshes.
fn plate(name: &str, turned: bool) -> Result<Case, PaperError> {
    let mut plate = lookup::case(name)?;
    plate.expects.clear();
    if turned {
        let text = format!("{}\n[mesh.twist]\nangle_deg = {TURN}\n", plate.source);
        plate = case::parse(&plate.file, text)?;
        plate.expects.clear();
        plate.name += "_turned";
    }
    Ok(plate)
}
