//! Problems from files: what a collection holds, and what the methods made of its families.

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::run::verdict::Verdict;
use crate::studies::analysis::by_problem;
use crate::studies::exchange::problem_file::OperatorSize;
use crate::studies::record::{ProblemSize, Record};
use crate::studies::sources::collection::family;

/// A problem of a file: the first record that knows its size, or any.
pub struct ProblemRow<'a>(&'a Record);

impl ProblemRow<'_> {
    /// A number; not-a-number where the problem was refused.
    fn size(&self, of: fn(&ProblemSize) -> usize) -> f64 {
        let size = self.0.found.problem.as_ref();
        size.map_or(f64::NAN, |size| of(size) as f64)
    }

    fn operator(&self) -> Option<&OperatorSize> {
        self.0.found.problem.as_ref()?.operator.as_ref()
    }

    fn number(&self, of: fn(&OperatorSize) -> f64) -> f64 {
        self.operator().map_or(f64::NAN, of)
    }

    fn refusal(&self) -> String {
        match (self.operator(), &self.0.found.verdict) {
            (Some(_), _) => String::new(),
            (None, Verdict::Refused(reason)) => reason.clone(),
            (None, other) => other.to_string(),
        }
    }
}

impl Row for ProblemRow<'_> {
    const NAME: &'static str = "problems";
    const TITLE: &'static str = "Problems from files";
    const QUESTION: &'static str =
        "What kind of problems does the collection hold, and which of them are refused?";
    const NOTES: &'static str = "One row per file of `stickslip solve`, and of the `files` of a study. Where the rank is less than the rows, contact points are redundant: contact forces are not unique, their effect is. An asymmetry up to 1e-12 is rounding of the writer, and the symmetric part is taken; beyond it W acts as it stands, and methods that need a symmetric one refuse.";
    const ORDER: Order<Self> = Order::By(|a, b| a.0.asked.case.cmp(&b.0.asked.case));

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "problem" "" .shown() = r.0.asked.case.clone(), "name: folders below the collection and file name, joined by dots";
            "family" "" = family(&r.0.asked.case).to_owned(), "folder below the collection, otherwise what precedes the first `-` or `.` of the file name";
            "kind" "" .shown() = r.operator().map_or("", |own| &own.kind), "`local` (W) or `global` (M and H)";
            "dim" "" .shown() = r.size(|size| size.dim), DIMENSION;
            "points" "" .shown() = r.size(|size| size.points), POINTS;
            "rows" "" .shown() = r.number(|own| own.rows as f64), "rows of W";
            "rank" "" .shown() = r.number(|own| own.rank.map_or(f64::NAN, |rank| rank as f64)), "numerical rank of W: singular values above 1e-10 of the largest; `NaN` with more than 2000 rows";
            "motions" "" = r.number(|own| own.motions as f64), "rigid motions (columns of V)";
            "stored_entries" "" .shown() = r.number(|own| own.entries as f64), "entries of W (global: of M) that the file stores, those at one position once; W is held full when it is solved, 8 rows² bytes";
            "asymmetry" "–" .significant(2).shown() = r.number(|own| own.asymmetry), "max |w_ij − w_ji| / max |w_ij| of W (global: of M) as stored";
            "refused" "" .shown() = r.refusal(), "why no method is asked to solve it; empty where all are";
        }
    }
}

/// Those of the files among some records, by name.
pub fn of_files(records: &[Record]) -> Vec<ProblemRow<'_>> {
    let own = by_problem(records.iter().filter(|r| r.asked.is_from_file()));
    own.iter()
        .filter_map(|own| one(own))
        .map(ProblemRow)
        .collect()
}

fn one<'a>(own: &[&'a Record]) -> Option<&'a Record> {
    let mut sized = own.iter().filter(|record| record.found.problem.is_some());
    sized.next().or(own.first()).copied()
}
