//! Converged reactions of the paper's plate: stable multipliers, tips enriched within a fixed radius, on three meshes.
//!
//! Body, crack and supports are those of Table 1. Star multipliers hold the faces between the crossed edges too, and branch
//! functions within 1.5 m of the tips take the √r field at any cell width: more than the coarsest cell, 0.91 m, so that
//! every mesh enriches several rings of nodes, and far from the other tip, 13.5 m, and the sides, 5.2 m. What is left are the
//! corners of the plate, where a held side meets a free one, with stresses like r^(λ−1) and reactions that converge like
//! h^2λ:
//!
//! ```text
//!   sin²(λ π/2) = (4 (1 − ν)² − λ²) / (3 − 4ν)      plane strain, ν = 0.3: λ = 0.711, order 1.42
//! ```
//!
//! Williams, J. Appl. Mech. 19 (1952) 526. The third mesh is Mesh I turned by 20 degrees at its centre: the crack crosses its
//! cells in every way.

use stickslip_xfem::mesh::grid_motion::Twist;

use crate::case::{Case, ContactSpace, Tip};
use crate::run::run_case::Progress;
use crate::run::verdict::Verdict;
use crate::studies::convergence::orders::{self, Kind};
use crate::studies::convergence::{self, ConvergencePlan};
use crate::studies::paper::lookup::{PaperError, as_printed, case, choice};
use crate::studies::paper::printed_tables::Table1Row;

/// Radius of the tip enrichment [m].
const RADIUS: f64 = 1.5;
/// Turn of the third mesh at its centre [degrees].
const TURN: f64 = 20.0;
/// Method.
const METHOD: &str = "hybrid";
/// Case, mesh in tables, whether it is turned, refinement factors: even ones would put the crack of Mesh II on a grid line.
const MESHES: [(&str, &str, bool, &[usize]); 3] = [
    ("plate_mesh1", "I", false, &[1, 2, 4, 8, 16]),
    ("plate_mesh2", "II", false, &[1, 3, 7, 15]),
    ("plate_mesh1", "I turned", true, &[1, 2, 4, 8, 16]),
];

/// Reaction of the plate on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceRow {
    /// Mesh: `I`, `II` or `I turned`.
    pub mesh: String,
    /// Mesh label.
    pub cells: String,
    /// Largest distance of neighbouring grid lines [m].
    pub h_m: f64,
    /// Friction coefficient [-].
    pub friction: f64,
    /// Free displacement unknowns.
    pub dofs: usize,
    /// Contact points.
    pub points: usize,
    /// Reaction at the top [MN/m]; NaN where the run is not solved.
    pub reaction_mn_per_m: f64,
    /// Observed order over the last two halvings; NaN where there is none.
    pub order: f64,
    /// Claim × check.
    pub verdict: Verdict,
}

/// Limit of the reaction on one kind of mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvergedRow {
    /// Friction coefficient [-].
    pub friction: f64,
    /// Mesh: `I`, `II` or `I turned`.
    pub mesh: String,
    /// Cell size of the finest mesh [m].
    pub finest_h_m: f64,
    /// Observed order; NaN without a limit.
    pub order: f64,
    /// Limit for h → 0 [MN/m]; NaN where the meshes show none.
    pub limit_mn_per_m: f64,
    /// Its uncertainty [MN/m].
    pub error_bar_mn_per_m: f64,
    /// Reaction that Table 1 prints for this mesh [MN/m]; none where it has none.
    pub printed_mn_per_m: Option<f64>,
}

impl ConvergedRow {
    /// (printed − limit) / limit [-].
    pub fn printed_difference(&self) -> Option<f64> {
        self.printed_mn_per_m
            .map(|printed| (printed - self.limit_mn_per_m) / self.limit_mn_per_m)
    }
}

/// What the limits of all meshes say for one friction coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Friction coefficient [-].
    pub friction: f64,
    /// Number of meshes.
    pub meshes: usize,
    /// Mean of the limits [MN/m].
    pub mean_mn_per_m: f64,
    /// Largest distance of two limits [MN/m].
    pub spread_mn_per_m: f64,
    /// Smallest error bar [MN/m].
    pub smallest_bar_mn_per_m: f64,
}

impl Agreement {
    /// Whether every limit lies within the error bar of every other.
    pub fn holds(&self) -> bool {
        self.spread_mn_per_m <= self.smallest_bar_mn_per_m
    }
}

/// Agreement of the meshes, by rising friction coefficient. A limit that is missing makes all numbers NaN.
pub fn agreements(rows: &[ConvergedRow]) -> Vec<Agreement> {
    let mut frictions: Vec<f64> = rows.iter().map(|row| row.friction).collect();
    frictions.sort_by(f64::total_cmp);
    frictions.dedup();
    let agreement = |friction: f64| {
        let own: Vec<&ConvergedRow> = rows.iter().filter(|r| r.friction == friction).collect();
        let limits = || own.iter().map(|row| row.limit_mn_per_m);
        let bars = || own.iter().map(|row| row.error_bar_mn_per_m);
        // `min` and `max` would drop a NaN.
        let all = limits().chain(bars()).all(f64::is_finite);
        let known = |x: f64| if all { x } else { f64::NAN };
        let highest = limits().fold(f64::NEG_INFINITY, f64::max);
        let lowest = limits().fold(f64::INFINITY, f64::min);
        Agreement {
            friction,
            meshes: own.len(),
            mean_mn_per_m: limits().sum::<f64>() / own.len() as f64,
            spread_mn_per_m: known(highest - lowest),
            smallest_bar_mn_per_m: known(bars().fold(f64::INFINITY, f64::min)),
        }
    };
    frictions.into_iter().map(agreement).collect()
}

/// Reactions on every mesh, and their limits beside the printed numbers of Table 1.
pub fn converged_reactions(
    printed: &[Table1Row],
    progress: &dyn Progress,
) -> Result<(Vec<SequenceRow>, Vec<ConvergedRow>), PaperError> {
    let mut sequences = Vec::new();
    let mut limits = Vec::new();
    for (name, mesh, turned, factors) in MESHES {
        let plate = plate(name, turned)?;
        let plan = ConvergencePlan {
            refine: Some(factors.to_vec()),
            spaces: Some(vec![ContactSpace::Star]),
            tips: Some(vec![Tip::Radius(RADIUS)]),
            choice: choice(METHOD, &[])?,
        };
        let samples = convergence::run(&plate, &plan, &convergence::closed_form, progress)?;
        let (errors, orders) = orders::rows(&samples);
        // A mesh that is not solved has a row without quantity.
        let wanted = |quantity: &str, at: &str| (quantity, at) == ("reaction", "top y");
        let own = errors
            .iter()
            .filter(|row| wanted(&row.quantity, &row.at) || row.kind.is_none());
        sequences.extend(own.map(|row| SequenceRow {
            mesh: mesh.into(),
            cells: row.mesh.clone(),
            h_m: row.h,
            friction: row.variant.friction,
            dofs: row.dofs,
            points: row.points,
            reaction_mn_per_m: as_printed(row.found),
            order: row.order,
            verdict: row.verdict.clone(),
        }));
        for &friction in &plate.sweep.friction {
            let found = orders.iter().find(|row| {
                row.variant.friction == friction
                    && wanted(&row.quantity, &row.at)
                    && row.kind == Kind::Richardson
            });
            let printed = printed
                .iter()
                .find(|row| !turned && row.mesh == mesh && row.friction == friction)
                .and_then(|row| row.printed_mn_per_m);
            limits.push(ConvergedRow {
                friction,
                mesh: mesh.into(),
                finest_h_m: found.map_or(f64::NAN, |row| row.finest_h),
                order: found.map_or(f64::NAN, |row| row.order),
                limit_mn_per_m: found.map_or(f64::NAN, |row| as_printed(row.reference)),
                error_bar_mn_per_m: found.map_or(f64::NAN, |row| row.error_bar / 1e6),
                printed_mn_per_m: printed,
            });
        }
    }
    Ok((sequences, limits))
}

/// The plate on one of the meshes.
fn plate(name: &str, turned: bool) -> Result<Case, PaperError> {
    let mut plate = case(name)?;
    plate.expects.clear();
    if turned {
        plate.mesh.grid.twist = Some(Twist {
            angle: TURN.to_radians(),
        });
    }
    Ok(plate)
}
