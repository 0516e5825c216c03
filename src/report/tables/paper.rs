//! The founding paper's tables, the plate over one parameter, and method against method.

use std::cmp::Ordering;

use super::words::*;
use crate::report::table::{Column, Order, Pivot, Row, columns};
use crate::run::verdict::Verdict;
use crate::studies::paper::comparison::ComparisonRow;
use crate::studies::paper::penalty::PenaltyRow;
use crate::studies::paper::printed_tables::{PRINTED, Table1Row, Table2Row};

/// The printed line comes before the computed ones.
fn compare_methods(a: &str, b: &str) -> Ordering {
    (a != PRINTED, a).cmp(&(b != PRINTED, b))
}

impl Row for Table1Row {
    const NAME: &'static str = "table1";
    const PRINTED: bool = true;
    const TITLE: &'static str =
        "Table 1 of the founding paper: vertical reaction at the top of the plate";
    const QUESTION: &'static str = "Do all methods find the reactions that the paper prints?";
    const ORDER: Order<Self> = Order::By(|a, b| {
        a.mesh
            .cmp(&b.mesh)
            .then(a.friction.total_cmp(&b.friction))
            .then_with(|| compare_methods(&a.method, &b.method))
    });
    const PIVOT: Option<Pivot> = Some(Pivot {
        rows: &["mesh", "friction", "printed_mn_per_m"],
        across: "method",
        cell: "reaction_mn_per_m",
    });

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "mesh" "" .shown() = r.mesh.clone(), "`I` or `II`";
            "friction" "–" .shown() = r.friction, FRICTION;
            "method" "" .shown() = r.method.clone(), METHOD;
            "reaction_mn_per_m" "MN/m" .fixed(3) = r.reaction_mn_per_m, "computed; empty where the method found no solution";
            "printed_mn_per_m" "MN/m" .fixed(1) = r.printed_mn_per_m, "printed in the paper; empty where it has none";
            "relative_difference" "–" .significant(3).power(2) = r.relative_difference, "(computed − printed) / printed";
            "verdict" "" .shown() = Verdict::or_not_run(r.verdict.as_ref()), VERDICT;
        }
    }
}

impl Row for Table2Row {
    const NAME: &'static str = "table2";
    const PRINTED: bool = true;
    const TITLE: &'static str =
        "Table 2 of the founding paper: displacement of the points P1 to P7 of the beam";
    const QUESTION: &'static str = "Do all methods find the displacements that the paper prints?";
    const NOTES: &'static str = "The lines with the method `printed` repeat the paper.";
    const ORDER: Order<Self> = Order::By(|a, b| {
        (&a.model, &a.variant, &a.component)
            .cmp(&(&b.model, &b.variant, &b.component))
            .then_with(|| compare_methods(&a.method, &b.method))
    });
    const PIVOT: Option<Pivot> = Some(Pivot {
        rows: &["model", "variant", "component", "largest_printed_mm"],
        across: "method",
        cell: "max_difference_mm",
    });

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "model" "" .shown() = r.model.clone(), "`I` or `II`";
            "variant" "" .shown() = r.variant.clone(), "`as-printed` (μ = 0) or `as-stated` (μ = 0.1)";
            "component" "" .named("comp.") = r.component.clone(), "`x`, `y` or `z`";
            "method" "" .shown() = r.method.clone(), "method, or `printed`";
            "p1_mm" "mm" .named("P1").fixed(7) = r.p_mm[0], "displacement of P1; `NaN` where the method found no solution";
            "p2_mm" "mm" .named("P2").fixed(7) = r.p_mm[1], "displacement of P2";
            "p3_mm" "mm" .named("P3").fixed(7) = r.p_mm[2], "displacement of P3";
            "p4_mm" "mm" .named("P4").fixed(7) = r.p_mm[3], "displacement of P4";
            "p5_mm" "mm" .named("P5").fixed(7) = r.p_mm[4], "displacement of P5";
            "p6_mm" "mm" .named("P6").fixed(7) = r.p_mm[5], "displacement of P6";
            "p7_mm" "mm" .named("P7").fixed(7) = r.p_mm[6], "displacement of P7";
            "max_difference_mm" "mm" .named("largest difference from the print").significant(3).power(2) = r.max_difference_mm, "largest absolute difference from the printed line";
            "verdict" "" .shown() = if r.method == PRINTED { String::new() } else { Verdict::or_not_run(r.verdict.as_ref()) }, VERDICT;
            "largest_printed_mm" "mm" .named("largest printed") = r.largest_printed_mm(), "the displacement of largest size in the printed line";
        }
    }
}

impl Row for PenaltyRow {
    const NAME: &'static str = "penalty";
    const TITLE: &'static str = "Penalty method, plate Mesh I: error against its parameter";
    const QUESTION: &'static str = "How stiff must penalty springs be for a wanted accuracy?";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "friction" "–" .key() = r.friction, FRICTION;
            "parameter" "–" .key().named("k/ρ") = r.parameter, "stiffness k of the contact springs in multiples of the natural scale ρ";
            "reaction_mn_per_m" "MN/m" .fixed(4) = r.reaction_mn_per_m, "reaction at the top";
            "relative_error" "–" .significant(3).power(2) = r.relative_error, "relative difference from the exact solution on the same mesh";
            "max_penetration_m" "m" .significant(3).named("max. penetration").power(2) = r.max_penetration_m, "largest penetration";
            "natural_map" "–" .residual().power(2) = r.natural_map, NATURAL_MAP;
            "verdict" "" .shown() = Verdict::or_not_run(r.verdict.as_ref()), VERDICT;
        }
    }
}

impl Row for ComparisonRow {
    const NAME: &'static str = "comparison";
    const PRINTED: bool = true;
    const TITLE: &'static str = "Every case by every method, plate and beam by variants of them too: all meshes, friction coefficients and increments together";
    const QUESTION: &'static str = "Which method solves which case, and at what cost?";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "case" "" .key() = r.case.clone(), CASE;
            "method" "" .key() = r.method.clone(), METHOD;
            "increments" "" .shown() = r.increments, "increments run";
            "verdict" "" .named("verdict, worst") = &r.verdict, "the worst of the increments: `solved`, `approximate: high`, `mid`, `low`, `none`, `refused: …`, `gave-up: …`, `out-of-memory`, `crashed: …`, `false-claim`, from best to worst; of equally bad ones the first by name";
            "natural_map" "–" .residual().named("natural map, largest").power(2) = r.natural_map, "largest residual of the contact conditions, found by the judge; `NaN` if one increment left nothing to judge";
            "iterations" "" .shown() = r.iterations, "iterations in all";
            "tangent_factorisations" "–" .named("dense factorisations") = r.tangent_factorisations, "dense factorisations of condensed matrices in all";
            "local_solves" "–" = r.local_solves, "evaluations of the contact law at one point in all";
            "solve_s" "s" .time().digits(3) = r.solve_s, "solution of all increments; `NaN` unless every one has an honest verdict";
        }
    }

    fn is_honest(&self) -> bool {
        self.verdict.is_honest()
    }
}
