//! Problems from files: what a collection holds, and what the methods made of its families.

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::exchange::collection::{FamilyRow, ProblemRow, family};
use crate::studies::exchange::problem_file::Size;

impl ProblemRow {
    /// A number; not-a-number where the problem was refused.
    fn size(&self, of: fn(&Size) -> f64) -> f64 {
        self.found.as_ref().map_or(f64::NAN, of)
    }
}

impl Row for ProblemRow {
    const NAME: &'static str = "problems";
    const TITLE: &'static str = "Problems from files";
    const QUESTION: &'static str =
        "What kind of problems does the collection hold, and which of them are refused?";
    const NOTES: &'static str = "One row per file of `stickslip solve`, and of the `files` of a study. Where the rank is less than the rows, contact points are redundant: contact forces are not unique, their effect is. An asymmetry up to 1e-12 is rounding of the writer, and the symmetric part is taken; beyond it W acts as it stands, and methods that need a symmetric one refuse.";
    const ORDER: Order<Self> = Order::By(|a, b| a.problem.cmp(&b.problem));

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "problem" "" .shown() = r.problem.clone(), "name: folders below the collection and file name, joined by dots";
            "family" "" = family(&r.problem).to_owned(), "folder below the collection, otherwise what precedes the first `-` or `.` of the file name";
            "kind" "" .shown() = r.found.as_ref().map_or("", |size| &size.operator.kind), "`local` (W) or `global` (M and H)";
            "dim" "" .shown() = r.size(|size| size.dim as f64), DIMENSION;
            "points" "" .shown() = r.size(|size| size.points as f64), POINTS;
            "rows" "" .shown() = r.size(|size| size.operator.rows as f64), "rows of W";
            "rank" "" .shown() = r.size(|size| size.operator.rank.map_or(f64::NAN, |rank| rank as f64)), "numerical rank of W: singular values above 1e-10 of the largest; `NaN` with more than 2000 rows";
            "motions" "" = r.size(|size| size.operator.motions as f64), "rigid motions (columns of V)";
            "stored_entries" "" .shown() = r.size(|size| size.operator.entries as f64), "entries of W (global: of M) that the file stores, those at one position once; W is held full when it is solved, 8 rows² bytes";
            "asymmetry" "–" .significant(2).shown() = r.size(|size| size.operator.asymmetry), "max |w_ij − w_ji| / max |w_ij| of W (global: of M) as stored";
            "refused" "" .shown() = r.found.as_ref().err().cloned().unwrap_or_default(), "why no method is asked to solve it; empty where all are";
        }
    }
}

impl Row for FamilyRow {
    const NAME: &'static str = "families";
    const TITLE: &'static str = "Methods on the families of a collection of problems";
    const QUESTION: &'static str =
        "Which method solves which family of problems, in how many iterations?";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "family" "" .shown() = r.family.clone(), "as in `problems.csv`";
            "accuracy" "" .shown() = r.accuracy.clone(), "tier, or violation of the contact laws asked for";
            "method" "" .shown() = r.method.clone(), METHOD;
            "problems" "" .shown() = r.problems, "problems that it was given";
            "honest" "" .shown().named("as claimed") = r.honest, "of these, with the verdict `solved` or `approximate`";
            "refused" "" .shown() = r.refused, "of these, refused";
            "iterations" "" .shown().named("median iterations") = r.iterations, "median of the iterations where it did what it claims";
            "most_iterations" "" .shown() = r.most, "most of them";
        }
    }
}
