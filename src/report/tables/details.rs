//! Findings of runs increment by increment: quantities, histories, contact points, expected numbers.

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::rows::{
    ExpectRow, HistoryRow, MET, MISSED_AS_DOCUMENTED, PointRow, QuantityRow, RunKey,
};

/// A row about one increment of one run.
trait OfRun {
    fn key(&self) -> &RunKey;
}

macro_rules! of_run {
    ($($row:ty),*) => { $(impl OfRun for $row {
        fn key(&self) -> &RunKey {
            &self.key
        }
    })* };
}
of_run!(QuantityRow<'_>, HistoryRow, PointRow<'_>, ExpectRow);

/// The columns of a run's key, then those of the row.
fn keyed<R: OfRun>(own: Vec<Column<R>>) -> Vec<Column<R>> {
    let mut columns = columns! { r: R,
        "case" "" .key() = r.key().case.clone(), CASE;
        "mesh" "" .key() = r.key().mesh.clone(), MESH;
        "space" "" .key() = r.key().space.clone(), SPACE;
        "method" "" .key() = r.key().method.clone(), METHOD;
        "friction" "–" .key().named("μ") = r.key().friction, FRICTION;
        "increment" "" .key() = r.key().increment, INCREMENT;
    };
    columns.extend(own);
    columns
}

impl Row for QuantityRow<'_> {
    const NAME: &'static str = "quantities";
    const TITLE: &'static str = "Quantities of interest at the end of every increment";
    const QUESTION: &'static str =
        "What does the body do: reactions, displacements, slip, dissipation?";
    const READABLE: bool = false;

    fn columns() -> Vec<Column<Self>> {
        keyed(columns! { r: Self,
            "quantity" "" .key() = r.quantity.name.clone(), "`reaction`, `displacement`, `contact_force`, `points_open`, `points_stick`, `points_slip`, `max_gap`, `max_penetration`, `max_slip` (over the contact points), `mean_slip` (tangential jump of a crack along `a` and, in 3D, `b`, mean over its surface), `max_penetration_sampled` (deepest overlap of the faces at 10 places along every 2D facet, at 19 or more on every 3D facet, ends and corners included; at the points of a crack along cell facets, where the jump is linear between them), `dissipation` (work of friction since time 0, of all cracks and of each), `strain_energy` (of the strain, without the initial stress), `external_work` (of supports and loads since time 0), `initial_stress_work` (likewise), `path_error` (difference of the work that the faces take by the trapezoid of all components from `dissipation`, relative to it; falls as increments are added), `stress_intensity` (K_I, K_II, in solids K_III at the tips of cracks, at eight points of a closed front), `energy_release_rate` (of these, J = G), `growth_angle` (direction of the largest hoop stress, from ahead towards the normal), `energy_identity` (check of equilibrium: relative residual of the energy identity of the increment)";
            "at" "" .key() = r.quantity.at.clone(), AT;
            "component" "" .key() = r.quantity.component.clone(), COMPONENT;
            "value" "`unit`" .digits(6) = r.quantity.value, "value";
            "unit" "" .shown() = r.quantity.unit.clone(), "unit of the value";
            "error_estimate" "`unit`" .significant(2).named("error").digits(2) = r.quantity.error, "estimate of the error of the value; `NaN` where there is none";
            "error_kind" "" .shown().named("kind") = r.quantity.error_kind.clone(), "`exact`: distance from the closed form; `estimate`: from a second mesh (`--error`), holds in 95 of 100 cases; without one, of intensities, the largest difference between domains of the integral and the jump behind the tip, which the error of the mesh is no part of; `not computable: …`, `no estimate: …`; empty: none was asked for";
        })
    }
}

impl Row for HistoryRow {
    const NAME: &'static str = "history";
    const TITLE: &'static str = "Violation of the contact laws by the iterates";
    const QUESTION: &'static str = "How does a method converge?";
    const NOTES: &'static str = "All iterations up to 100, then about 50 per decade, always the last. The numbers of the iterations recorded depend on the number of the last one only.";
    const READABLE: bool = false;

    fn columns() -> Vec<Column<Self>> {
        keyed(columns! { r: Self,
            "iteration" "" .key() = r.iteration, "iteration, 0 is the start";
            "violation" "–" .residual().power(2) = r.violation, "largest of natural map, penetration, adhesion, complementarity and cone of the iterate, as in `increments.csv`; of an approximate method too, where it ends at the modelling error";
        })
    }
}

impl Row for PointRow<'_> {
    const NAME: &'static str = "points";
    const TITLE: &'static str = "Contact points at the end of every increment";
    const QUESTION: &'static str =
        "Where along a crack does it open, stick and slip, and under which forces?";
    const NOTES: &'static str = "Where a case names the closed form of a 2D crack, rows of the method `exact` have it at 161 places from end to end, dense at the ends, those outside the body left out; the same for all meshes, contact spaces and methods. Values below 1e-12 of the largest are 0. A contact point of an integrated space holds the mean over its function, which near a tip differs from the value at its place.";
    const READABLE: bool = false;

    fn columns() -> Vec<Column<Self>> {
        keyed(columns! { r: Self,
            "crack" "" .key() = r.point.crack, "number of the crack, from 1";
            "point" "" .key() = r.point.number, "number of the point within the crack, from 1, ordered along it; 0 of a closed form";
            "x_m" "m" .digits(5) = r.point.x_m, "position";
            "y_m" "m" .digits(5) = r.point.y_m, "position";
            "z_m" "m" .digits(5) = r.point.z_m, "position, 0 in 2D";
            "s_m" "m" = r.point.s_m, "distance along the crack from its first point; 0 in 3D";
            "weight" "m or m²" = r.point.weight, "tributary length (2D) or area (3D); 1 of a closed form";
            "gap_m" "m" .digits(4) = r.point.gap_m, "normal gap";
            "slip_a_m" "m" .digits(4) = r.point.slip_a_m, "tangential jump along a, total";
            "slip_b_m" "m" = r.point.slip_b_m, "tangential jump along b, total; 0 in 2D";
            "p_n" "`force_unit`" .digits(4) = r.point.p_n, "normal contact force; divided by `weight` it is the contact pressure in Pa";
            "p_a" "`force_unit`" .digits(4) = r.point.p_a, "tangential contact force along a";
            "p_b" "`force_unit`" = r.point.p_b, "tangential contact force along b; 0 in 2D";
            "force_unit" "" = r.point.force_unit.clone(), "`N/m` in 2D, `N` in 3D, `Pa` of a closed form";
            "status" "" .shown() = r.point.status.clone(), "`open`, `stick` or `slip`; empty of a closed form";
        })
    }
}

impl Row for ExpectRow {
    const NAME: &'static str = "expectations";
    const TITLE: &'static str = "Expected and found: one row per `[[expect]]` block and run";
    const QUESTION: &'static str =
        "Which closed forms and published numbers are met, by whom, how closely?";
    const READABLE: bool = false;

    fn columns() -> Vec<Column<Self>> {
        keyed(columns! { r: Self,
            "quantity" "" .key() = r.quantity.clone(), "as in `quantities.csv`";
            "at" "" .key() = r.at.clone(), AT;
            "component" "" .key() = r.component.clone(), COMPONENT;
            "expected" "`unit`" .digits(6) = r.expected, "expected value";
            "found" "`unit`" .digits(6) = r.found, "value of the run; `NaN` where it has none";
            "allowed" "`unit`" .digits(2) = r.allowed, "allowed difference";
            "unit" "" .shown() = r.unit.clone(), "unit of the three";
            "kind" "" .key() = r.kind.clone(), "`analytic`, `published`, `independent` or `snapshot`";
            "source" "" .hidden_key() = r.source.clone(), "where the expected value comes from";
            "verdict" "" .shown() = r.verdict.clone(), "`met`, `missed`, `missed as documented` (a stated limitation) or `met against the documentation`";
        })
    }
}

/// Expected numbers of one case, by all exact methods.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectSummary {
    case: String,
    kinds: String,
    numbers: usize,
    met: usize,
    documented: usize,
    worst: f64,
}

impl ExpectSummary {
    /// A row per case.
    pub fn of(rows: &[ExpectRow]) -> Vec<Self> {
        let mut cases: Vec<&str> = rows.iter().map(|row| row.key.case.as_str()).collect();
        cases.sort_unstable();
        cases.dedup();
        let summary = |case: &str| {
            let own = || rows.iter().filter(|row| row.key.case == case);
            let count = |verdict: &str| own().filter(|row| row.verdict == verdict).count();
            let mut kinds: Vec<&str> = own().map(|row| row.kind.as_str()).collect();
            kinds.sort_unstable();
            kinds.dedup();
            let met = own().filter(|row| row.verdict == MET);
            let used = met.map(|row| (row.found - row.expected).abs() / row.allowed);
            Self {
                case: case.to_owned(),
                kinds: kinds.join(", "),
                numbers: own().count(),
                met: count(MET),
                documented: count(MISSED_AS_DOCUMENTED),
                worst: used.fold(0.0, f64::max),
            }
        };
        cases.into_iter().map(summary).collect()
    }
}

impl Row for ExpectSummary {
    const NAME: &'static str = "expectations_by_case";
    const TITLE: &'static str = "Expected numbers by case, all exact methods";
    const QUESTION: &'static str = "Are the expected numbers met?";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "case" "" .shown() = r.case.clone(), CASE;
            "kind" "" .shown() = r.kinds.clone(), "kinds of the expected numbers";
            "numbers" "" .shown() = r.numbers, "expected numbers times exact methods";
            "met" "" .shown() = r.met, "within their tolerance";
            "missed_as_documented" "" .shown() = r.documented, "limitations that the case file states";
            "not_as_stated" "" .shown() = r.numbers - r.met - r.documented, "neither";
            "worst_met" "–" .significant(3).named("worst met, of its tolerance").digits(2) = r.worst, "largest |found − expected| / allowed of those met";
        }
    }
}
