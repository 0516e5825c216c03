//! Findings of runs increment by increment: quantities, histories, contact points, expected numbers.

use std::collections::BTreeMap;

use super::words::*;
use crate::report::table::{Column, Row, columns};
use crate::studies::rows::{ExpectRow, HistoryRow, PointRow, QuantityRow, RunKey};

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
of_run!(QuantityRow<'_>, HistoryRow, PointRow<'_>);

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
            "quantity" "" .key() = r.quantity.name.clone(), "`reaction`, `displacement` (of a probe; where supports hold, the mean over the nodes held), `contact_force`, `points_open`, `points_stick`, `points_slip`, `max_gap`, `max_penetration` (over the contact points), `mean_slip` (tangential jump of a crack along `a` and, in 3D, `b`, mean over its surface), `max_slip`, `max_penetration_sampled` (largest slip, deepest overlap of the faces at 10 places along every 2D facet, at 19 or more on every 3D facet, ends and corners included; at the points of a crack along cell facets, where the jump is linear between them), `dissipation` (work of friction since time 0, of all cracks and of each), `strain_energy` (of the strain, without the initial stress), `external_work` (of supports and loads since time 0), `initial_stress_work` (likewise), `path_error` (difference of the work that the faces take by the trapezoid of all components from `dissipation`, relative to it; falls as increments are added), `stress_intensity` (K_I, K_II, in solids K_III at the tips of cracks, at eight points of a closed front), `energy_release_rate` (of these, J = G), `growth_angle` (direction of the largest hoop stress, from ahead towards the normal), `energy_identity` (check of equilibrium: relative residual of the energy identity of the increment)";
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

/// An expected number, held against the runs that should have it.
pub struct ExpectedNumber<'a> {
    /// The farthest from it of the worst verdict.
    worst: &'a ExpectRow,
    not_as_stated: usize,
}

impl<'a> ExpectedNumber<'a> {
    /// A row per `[[expect]]` block, mesh and friction coefficient, of a row per run.
    pub fn of(rows: &'a [ExpectRow]) -> Vec<Self> {
        let mut numbers: BTreeMap<_, Vec<&ExpectRow>> = BTreeMap::new();
        for row in rows {
            let RunKey {
                case, mesh, space, ..
            } = &row.key;
            let run = (case, mesh, space, row.key.friction.to_bits());
            let value = (row.expected.to_bits(), &row.source);
            let number = (row.key.increment, &row.quantity, &row.at, &row.component);
            numbers.entry((run, number, value)).or_default().push(row);
        }
        let number = |runs: Vec<&'a ExpectRow>| {
            let off = |row: &ExpectRow| ((row.found - row.expected) / row.allowed).abs();
            let worse = |a: &&&ExpectRow, b: &&&ExpectRow| {
                let stated = b.as_stated().cmp(&a.as_stated());
                let farther = off(a).total_cmp(&off(b));
                stated
                    .then(farther)
                    .then_with(|| b.key.method.cmp(&a.key.method))
            };
            Self {
                worst: runs.iter().max_by(worse).expect("a run"),
                not_as_stated: runs.iter().filter(|row| !row.as_stated()).count(),
            }
        };
        numbers.into_values().map(number).collect()
    }

    /// Method of the worst run, where that is a fault.
    fn not_by(&self) -> String {
        if self.worst.as_stated() {
            return String::new();
        }
        self.worst.key.method.clone()
    }
}

impl Row for ExpectedNumber<'_> {
    const NAME: &'static str = "expectations";
    const TITLE: &'static str = "Expected and found: one row per `[[expect]]` block";
    const QUESTION: &'static str = "Which closed forms and published numbers are met, how closely?";
    const NOTES: &'static str =
        "By every exact method; what each found stands in `quantities.csv`.";
    const MOST_READ: usize = 60;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "case" "" .key() = r.worst.key.case.clone(), CASE;
            "mesh" "" .key() = r.worst.key.mesh.clone(), MESH;
            "space" "" .key() = r.worst.key.space.clone(), SPACE;
            "friction" "–" .key().named("μ") = r.worst.key.friction, FRICTION;
            "increment" "" .key() = r.worst.key.increment, INCREMENT;
            "quantity" "" .key() = r.worst.quantity.clone(), "as in `quantities.csv`";
            "at" "" .key() = r.worst.at.clone(), AT;
            "component" "" .key() = r.worst.component.clone(), COMPONENT;
            "expected" "`unit`" .digits(6) = r.worst.expected, "expected value";
            "found" "`unit`" .digits(6) = r.worst.found, "value of the run that is farthest from it, not as stated before as stated; `NaN` where it has none";
            "not_by" "" .shown().named("not by") = r.not_by(), "method of that run, if it is not as stated";
            "not_as_stated" "" = r.not_as_stated, "number of runs that neither meet it nor miss it where the case says so";
            "allowed" "`unit`" .digits(2) = r.worst.allowed, "allowed difference";
            "unit" "" .shown() = r.worst.unit.clone(), "unit of the three";
            "kind" "" .shown() = r.worst.kind.clone(), "`analytic`, `published`, `independent` or `snapshot`";
            "source" "" .hidden_key() = r.worst.source.clone(), "where the expected value comes from";
            "verdict" "" .shown() = r.worst.verdict.clone(), "on that run: `met`, `missed`, `missed as documented` (a stated limitation) or `met against the documentation`";
        }
    }
}
