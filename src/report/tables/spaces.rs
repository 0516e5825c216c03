//! The contact spaces: inf-sup numbers and patch tests, every one and summed up.

use std::collections::BTreeMap;

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::spaces::infsup::{Sample, Sequence};
use crate::studies::spaces::patch::{Loaded, PASSED, PatchRow, State};

/// One contact space on one mesh of one body.
pub struct InfSupRow<'a> {
    sequence: &'a Sequence,
    sample: &'a Sample,
}

impl<'a> InfSupRow<'a> {
    /// A row per mesh.
    pub fn of(sequences: &'a [Sequence]) -> Vec<Self> {
        let of = |sequence: &'a Sequence| {
            let samples = sequence.samples.iter();
            samples.map(move |sample| Self { sequence, sample })
        };
        sequences.iter().flat_map(of).collect()
    }
}

fn stable(sequence: &Sequence) -> &'static str {
    if sequence.is_stable() {
        "stable"
    } else {
        "not stable"
    }
}

const CRACK: &str = "how the crack lies in the grid; offsets along its normal, from a grid line or the centre of the body, in cell sizes h";
const SLOPE: &str = "d log β / d log h, least squares over the meshes of this crack and space; `inf` if some β is 0";
const SHARE: &str = "least β over the meshes, each divided by that of `star` on the same mesh with a crack along the grid (`horizontal, offset 0.3h`, `normal (0, 0, 1)`)";
const STABLE: &str = "`stable` if slope <= 0.25 and share >= 0.1, else `not stable`; of all meshes of this crack and space together";

impl Row for InfSupRow<'_> {
    const NAME: &'static str = "infsup";
    const TITLE: &'static str =
        "The numerical inf-sup test of the contact spaces (Chapelle & Bathe 1993), mesh by mesh";
    const QUESTION: &'static str = "What becomes of the inf-sup number on finer meshes?";
    const NOTES: &'static str = "The body is a unit square (plane strain) or cube with ν = 0.3 and a tied crack, without supports: β² = least eigenvalue of G A⁻¹ Gᵀ x = β² C x, G_k u = ∫ φ_k [[u]] dΓ, A = K/E + M/L², C = h ∫ φ_i φ_j dΓ, for edge pairs h × tributary lengths or areas. A finite sample proves no bound; it can only show that there is none. β of edge pairs is measured in a norm of point values and compares with the others up to a constant (1.7 to 1.9 on cracks along the grid).";
    const READABLE: bool = false;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "dimension" "" .key() = r.sequence.scene.dim, DIMENSION;
            "crack" "" .key() = r.sequence.scene.name, CRACK;
            "space" "" .key() = r.sequence.space.name(), "contact space";
            "cells" "" .key() = r.sample.cells, "cells per axis";
            "h_m" "m" .digits(3) = r.sample.h, "cell size";
            "dofs" "" = r.sample.unknowns, "displacement unknowns";
            "points" "" = r.sample.points, "multipliers, of as many components as dimensions";
            "beta" "–" .significant(4).named("β").digits(3) = r.sample.beta, "inf-sup number β, 4 significant digits; 0 where β² is below 1e-12 of the largest eigenvalue, which is rounding";
            "kernel" "" .shown() = r.sample.kernel, "how many tractions no displacement feels: eigenvalues that are rounding";
            "slope" "–" .significant(4) = r.sequence.slope, SLOPE;
            "share" "–" .significant(4) = r.sequence.share, SHARE;
            "verdict" "" .shown() = stable(r.sequence), STABLE;
        }
    }
}

/// One contact space on all meshes of one body.
pub struct InfSupSummary<'a>(pub &'a Sequence);

impl InfSupSummary<'_> {
    fn beta(&self, sample: Option<&Sample>) -> f64 {
        sample.map_or(f64::NAN, |sample| sample.beta)
    }
}

impl Row for InfSupSummary<'_> {
    const NAME: &'static str = "infsup_by_space";
    const TITLE: &'static str = "Inf-sup numbers β of the contact spaces: a stable space keeps β above a constant on every mesh";
    const QUESTION: &'static str = "Which contact space is stable on which crack?";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "dimension" "" .named("dim") = r.0.scene.dim, DIMENSION;
            "crack" "" .shown() = r.0.scene.name, CRACK;
            "space" "" .shown() = r.0.space.name(), "contact space";
            "meshes" "" .shown() = r.0.samples.len(), "meshes";
            "beta_coarsest" "–" .significant(4).named("β, coarsest").digits(3) = r.beta(r.0.samples.first()), "inf-sup number on the coarsest mesh";
            "beta_finest" "–" .significant(4).named("β, finest").digits(3) = r.beta(r.0.samples.last()), "inf-sup number on the finest mesh";
            "kernel" "" .shown() = r.0.samples.iter().map(|sample| sample.kernel).max().unwrap_or(0), "largest number of tractions that no displacement feels";
            "slope" "–" .significant(4).fixed(2) = r.0.slope, SLOPE;
            "share" "–" .significant(4).digits(2) = r.0.share, SHARE;
            "verdict" "" .shown() = stable(r.0), STABLE;
        }
    }
}

/// An error; rounding is 0, so that the same table comes out on every machine.
fn error(x: f64) -> f64 {
    if x <= PASSED { 0.0 } else { x }
}

fn passed(passed: bool) -> &'static str {
    if passed { "pass" } else { "fail" }
}

const PATCH: &str = "`hydrostatic` (no friction), `stick`, `open`; `block slides` and `block sticks`: a confined block parted from side to side";
const BOUNDARY: &str = "`displacement` on all sides, or `traction` with just enough supports";
const ANGLE: &str =
    "angle from the x axis, normal of a plane, or shape; `T` and `X`: two cracks that meet";
const MOVED: &str = "`regular`, or how far grid points are moved";
const PATCH_SPACE: &str = "contact space";
const TRACTION: &str = "largest difference of P/w from the exact traction over the contact points, over the largest stress component; 0 up to 1e-10, `NaN` without an answer";
const DISPLACEMENT: &str = "largest difference of displacements at nodes and of jumps on the crack, over the largest displacement; 0 up to 1e-10, `NaN` without an answer";

impl Row for PatchRow {
    const NAME: &'static str = "patch";
    const TITLE: &'static str = "Patch tests of the contact spaces: a body in uniform stress, whose contact tractions and displacements are known";
    const QUESTION: &'static str =
        "Does a contact space represent uniform stress wherever the crack lies between the nodes?";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| {
        let key = |row: &Self| (row.dimension, row.state, row.loaded);
        key(a)
            .cmp(&key(b))
            .then_with(|| (&a.crack, &a.mesh).cmp(&(&b.crack, &b.mesh)))
            .then_with(|| b.distance.total_cmp(&a.distance))
            .then_with(|| a.space.cmp(&b.space))
    });

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "patch" "" .shown() = r.state.name(), PATCH;
            "boundary" "" .shown() = r.loaded.name(), BOUNDARY;
            "dimension" "" .shown() = r.dimension, DIMENSION;
            "crack" "" .shown() = r.crack.clone(), ANGLE;
            "mesh" "" .shown() = r.mesh.clone(), MOVED;
            "distance" "–" .shown() = r.distance, "distance of the crack from a node in cell sizes, positive with the node on side 2";
            "space" "" .shown() = r.space.clone(), PATCH_SPACE;
            "points" "" = r.points, "contact points; 0 where the discretisation refuses the body";
            // The place in a case file that nobody has says nothing.
            "run" "" = r.verdict.to_string().lines().next().unwrap_or_default(), "verdict on the run, or why there is no body";
            "traction_error" "–" .significant(3).power(3) = error(r.traction), TRACTION;
            "displacement_error" "–" .significant(3).power(3) = error(r.displacement), DISPLACEMENT;
            "verdict" "" .shown() = passed(r.passed()), "`pass`: both errors are at most 1e-10";
        }
    }
}

/// One patch test over all distances of the crack from a node.
pub struct PatchSummary<'a>(Vec<&'a PatchRow>);

impl<'a> PatchSummary<'a> {
    /// A row per patch, boundary, crack, mesh and space.
    pub fn of(rows: &'a [PatchRow]) -> Vec<Self> {
        type Group<'a> = (usize, State, Loaded, &'a str, &'a str, &'a str);
        let mut groups: BTreeMap<Group<'a>, Vec<&'a PatchRow>> = BTreeMap::new();
        for row in rows {
            let names = (row.crack.as_str(), row.mesh.as_str(), row.space.as_str());
            let group = (
                row.dimension,
                row.state,
                row.loaded,
                names.0,
                names.1,
                names.2,
            );
            groups.entry(group).or_default().push(row);
        }
        groups.into_values().map(Self).collect()
    }

    /// What all tests of the group share.
    fn first(&self) -> &'a PatchRow {
        self.0[0]
    }

    /// The largest of what has an answer.
    fn worst(&self, of: fn(&PatchRow) -> f64) -> f64 {
        error(self.0.iter().map(|row| of(row)).fold(f64::NAN, f64::max))
    }

    fn passed(&self) -> usize {
        self.0.iter().filter(|row| row.passed()).count()
    }
}

impl Row for PatchSummary<'_> {
    const NAME: &'static str = "patch_by_space";
    const TITLE: &'static str =
        "Patch tests: largest errors over all distances of the crack from a node";
    const QUESTION: &'static str = "Which contact space passes which patch test?";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "patch" "" .shown() = r.first().state.name(), PATCH;
            "boundary" "" .shown() = r.first().loaded.name(), BOUNDARY;
            "dimension" "" .named("dim") = r.first().dimension, DIMENSION;
            "crack" "" .shown() = r.first().crack.clone(), ANGLE;
            "mesh" "" .shown() = r.first().mesh.clone(), MOVED;
            "space" "" .shown() = r.first().space.clone(), PATCH_SPACE;
            "traction_error" "–" .significant(3).power(3) = r.worst(|row| row.traction), TRACTION;
            "displacement_error" "–" .significant(3).power(3) = r.worst(|row| row.displacement), DISPLACEMENT;
            "tests" "" .shown() = r.0.len(), "distances tried";
            "passed" "" .shown() = r.passed(), "tests with both errors at most 1e-10";
            "without_answer" "" .shown() = r.0.iter().filter(|row| row.traction.is_nan()).count(), "tests whose run has no answer";
            "verdict" "" .shown() = passed(r.passed() == r.0.len()), "`pass`: all tests";
        }
    }
}
