//! The convergence study: errors of every mesh, observed beside theoretical orders.

use std::cmp::Ordering;

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::convergence::orders::{ErrorRow, Kind, OrderRow, ROUND_OFF};
use crate::studies::convergence::{NoBar, Variant};

/// Column of both tables.
const NO_BAR: &str = "why the finest value has no error bar: `one mesh`; `vanishes` on the two finest meshes; `largest gap`, whose place moves from mesh to mesh; empty where there is one";

/// A row about one quantity on one mesh of a sequence.
pub trait OfError {
    /// The quantity with its error.
    fn error(&self) -> &ErrorRow;
}

impl OfError for ErrorRow {
    fn error(&self) -> &ErrorRow {
        self
    }
}

impl OfError for OrderRow {
    fn error(&self) -> &ErrorRow {
        &self.finest
    }
}

/// The columns of a sequence, then those of the row.
fn of_variant<R: OfError>(own: Vec<Column<R>>) -> Vec<Column<R>> {
    let mut columns = columns! { r: R,
        "case" "" .shown() = r.error().variant.case.clone(), CASE;
        "space" "" .shown() = r.error().variant.space.clone(), SPACE;
        "tip" "" .shown() = r.error().variant.tip.clone(), "enrichment of the tips: `none`, `branch`, or the radius in m; `no-tips` where no crack ends inside the body";
        "method" "" = r.error().variant.method.clone(), METHOD;
        "friction" "–" .named("μ") = r.error().variant.friction, FRICTION;
    };
    columns.extend(own);
    columns
}

fn compare_variants(a: &Variant, b: &Variant) -> Ordering {
    (&a.case, &a.space, &a.tip, &a.method)
        .cmp(&(&b.case, &b.space, &b.tip, &b.method))
        .then(a.friction.total_cmp(&b.friction))
}

/// An error without round-off, which would differ between machines.
fn above_round_off(error: f64) -> f64 {
    if error < ROUND_OFF { 0.0 } else { error }
}

/// The columns of `convergence.csv`.
pub fn of_error<R: OfError>() -> Vec<Column<R>> {
    of_variant(columns! { r: R,
        "mesh" "" = r.error().mesh.clone(), MESH;
        "refine" "" = r.error().refine, "refinement factor";
        "h_m" "m" .digits(4) = r.error().h, CELL_WIDTH;
        "dofs" "" .named("unknowns") = r.error().dofs, DOFS;
        "points" "" .shown() = r.error().points, POINTS;
        "verdict" "" .shown() = &r.error().verdict, "verdict on the last increment reached, as in `runs.csv`";
        "quantity" "" .shown() = r.error().quantity.clone(), "quantity; empty where the verdict is not honest";
        "at" "" .shown() = r.error().at.clone(), "place and component, e.g. `top y`; empty: the whole body";
        "found" "SI" = r.error().found, "value of the run";
        "reference" "SI" = r.error().reference, "what it is measured against";
        "error_bar" "SI" .significant(4) = r.error().error_bar, "uncertainty of the reference: 0 of a closed form; of the finest value 1.5 times the largest of its change from the mesh before, a third of the change before that, and the median change of the quantities of its kind; twice as much with tips without branch functions in a fixed radius, and where the program does not know the tips (docs/accuracy.md); `NaN` where unknown";
        "no_bar" "" = r.error().no_bar.map_or("", NoBar::name), NO_BAR;
        "error" "" .significant(4).power(3) = above_round_off(r.error().error), "against a closed form as the quantity defines it; otherwise the distance from the reference, relative to the length of the reaction vector at its place or to the size of the quantity, on the finest mesh; `0` below 1e-12, which is round-off; `NaN` on the finest mesh, which is the reference";
        "kind" "" .shown() = r.error().kind.map_or("", Kind::name), "reference: `exact` (closed form), `finest` (the value on the finest mesh) or `estimate` (its strain energy)";
        "order" "–" .significant(4).fixed(2) = r.error().order, "observed order in h over the last two halvings, on this mesh and the two before: against a closed form the slope of the errors by least squares, otherwise that of the steps between the values; no error bar relies on it; `NaN` where errors are below 1e-12, or values differ by less than the tolerance of the runs or approach no limit";
        "total_s" "s" .time().digits(2) = r.error().seconds.iter().sum::<f64>(), "sum of the six that follow: what this run alone would have taken; one run each, after one that is not counted";
        "setup_s" "s" .time() = r.error().seconds[0], SETUP_S;
        "assembly_s" "s" .time() = r.error().seconds[1], ASSEMBLY_S;
        "factorisation_s" "s" .time() = r.error().seconds[2], FACTORISATION_S;
        "condensation_s" "s" .time() = r.error().seconds[3], CONDENSATION_S;
        "prepare_s" "s" .time() = r.error().seconds[4], PREPARE_S;
        "solve_s" "s" .time() = r.error().seconds[5], "solution of all increments";
    })
}

impl Row for ErrorRow {
    const NAME: &'static str = "convergence";
    const TITLE: &'static str = "Errors on sequences of meshes";
    const QUESTION: &'static str =
        "How large is the error of a mesh, and what does it cost to have it smaller?";
    const NOTES: &'static str = "One row per case, contact space, tip enrichment, friction coefficient, mesh and quantity, at the end of the load path. Only runs with an honest verdict are measured: a mesh without one has a single row without quantity. Quantities are those of the closed form where the case names one. Otherwise they are `reaction`, `contact_force`, `strain_energy`, `dissipation`, `mean_slip`, `max_slip` and `max_gap` of `quantities.csv`, `stress_intensity` and `energy_release_rate`, those left out that vanish on every mesh, and the reference is the value on the finest mesh; `energy` is an estimate of the relative error in the energy norm, √(4/3 |ΔE|/E) on halved cells, on the finest mesh from that before it; with friction it is 0.5 to 1.2 of the true one. Against closed forms in solids `slip_direction` is the angle [rad] of the mean slip of the crack (weighted with its area) from the local axis a towards b, and its error the angle between the mean slip of the run and the exact one, also in rad; no row where nothing slips.";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| {
        compare_variants(&a.variant, &b.variant)
            .then(a.refine.cmp(&b.refine))
            .then_with(|| (&a.quantity, &a.at).cmp(&(&b.quantity, &b.at)))
    });

    fn columns() -> Vec<Column<Self>> {
        of_error()
    }

    fn is_honest(&self) -> bool {
        self.verdict.is_honest()
    }
}

impl Row for OrderRow {
    const NAME: &'static str = "orders";
    const PRINTED: bool = true;
    const TITLE: &'static str = "Observed beside theoretical orders of convergence over the last two halvings (reference exact: closed form; finest: value on the finest mesh, with its error bar)";
    const QUESTION: &'static str =
        "Do the errors fall as fast as theory promises, and to which limit, whatever the mesh?";
    const NOTES: &'static str = "Of `stickslip paper`: the reaction of the plate, beside what Table 1 prints. `edge-pairs` with enriched tip cells are the paper's own discretisation; `--full` has `star` multipliers with branch functions within 1.5 m of the tips too, on three meshes, `plate_mesh1_turned` beneath the same crack turned by 20 degrees at its centre; the corners of the plate alone keep these from converging.";
    const ORDER: Order<Self> = Order::By(|a, b| {
        let (a, b) = (&a.finest, &b.finest);
        compare_variants(&a.variant, &b.variant)
            .then_with(|| (&a.quantity, &a.at).cmp(&(&b.quantity, &b.at)))
    });

    fn columns() -> Vec<Column<Self>> {
        of_variant(columns! { r: Self,
            "quantity" "" .shown() = r.finest.quantity.clone(), "as in `convergence.csv`, like the two that follow";
            "at" "" .shown() = r.finest.at.clone(), "place and component";
            "kind" "" .shown() = r.finest.kind.map_or("", Kind::name), "kind of reference";
            "meshes" "" = r.meshes, "meshes with an honest verdict";
            "finest_h_m" "m" = r.finest.h, "cell size of the finest of them";
            "reference" "SI" .digits(7) = r.finest.reference, "its reference";
            "printed" "SI" .digits(5) = r.printed, "what the founding paper prints for the case; empty where it prints nothing";
            "printed_difference" "–" .significant(3).named("printed − reference").percent(2) = r.printed_difference(), "printed / reference − 1";
            "error_bar" "SI" .significant(4).digits(2) = r.finest.error_bar, "as in `convergence.csv`";
            "no_bar" "" .named("no bar") = r.finest.no_bar.map_or("", NoBar::name), NO_BAR;
            "error" "" .significant(4).named("finest error").power(3) = above_round_off(r.error), "error on the finest mesh that has one";
            "order" "–" .significant(4).fixed(2) = r.finest.order, "observed order over the last two halvings; `NaN` where there is none";
            "theoretical_order" "–" .named("theory").digits(2) = r.theory.unwrap_or(f64::NAN), "order that theory promises, of tractions a lower bound; `NaN` where it is silent. Without tips: energy norm 1, displacement in L² 2, traction 1. With tips the energy norm has 1/2, or 1 where they are enriched within a fixed radius (Laborde, Pommier, Renard & Salaün 2005)";
        })
    }
}
