//! The stress suite: faults, invariances, ladders.

use super::words::*;
use crate::report::table::{Column, Row, columns};
use crate::studies::stress::finding::Fault;
use crate::studies::stress::summary::{FaultRow, InvarianceRow, LadderRow};

const FAMILY: &str = "`patch-2d`, `patch-3d`: uniform compression, all cracks stick, the answer is known; `slip-2d`, `slip-3d`: pushed and sheared with friction";
const FAULT: &str = "`right`, or the worst that was found";
const MINIMAL: &str =
    "smallest case found that fails for the same fault, as a file beside this table";

fn name(fault: Option<Fault>) -> String {
    fault.map_or("right", Fault::name).into()
}

impl FaultRow {
    fn numbers(&self) -> String {
        let numbers: Vec<String> = self.numbers.iter().map(u64::to_string).collect();
        numbers.join(" ")
    }
}

impl Row for FaultRow {
    const NAME: &'static str = "stress_scenes";
    const TITLE: &'static str = "Random scenes by what became of them";
    const QUESTION: &'static str = "How often does the program fail, why, and how is it run again?";
    const NOTES: &'static str = "`stickslip stress --seed SEED --family FAMILY --only NUMBER` runs a scene again and writes its case file; `cases/` has the smallest case that fails for the same fault. A scene counts once, by the worst that was found. `refused` scenes are refused at a place in their file, with the remedy; `beyond the mesh` are those that no mesh of such cells carries by construction (cracks along each other within 1e-6 of a cell; without tip functions shorter than two cells). `no equilibrium`: no force within the cones of friction balances the load on a floating piece, as a certificate proves; `limit of friction`: the same for nine tenths of the friction, and no exact method finds an answer. `floor of the arithmetic`: solved, with an error up to 1e-6 that is another one in other units of length.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "family" "" .key() = r.family.name(), FAMILY;
            "fault" "" .key() = name(r.fault), FAULT;
            "scenes" "" .shown() = r.scenes, "how many";
            "share" "–" .significant(4).percent(2) = r.share, "of all scenes of the family";
            "numbers" "" .shown() = r.numbers(), "their numbers in the family, from 0; empty of right ones";
            "reason" "" = r.reason.clone(), "what is wrong with the first, in one line";
            "error" "–" .residual().power(2) = r.error, "largest error of the default method against the closed form, or of the energy identity; `NaN` where it has no answer";
            "minimal" "" .shown() = r.minimal.clone().unwrap_or_default(), MINIMAL;
        }
    }
}

impl Row for InvarianceRow {
    const NAME: &'static str = "stress_invariances";
    const TITLE: &'static str = "What leaves the answer as it is, and to how many digits";
    const QUESTION: &'static str =
        "Does the answer depend on units, place, or on what sides and faces are called?";
    const NOTES: &'static str = "Digits: change of pressure and shear at the contact points, over the largest force, of scenes that are right and have one answer. Rounded coordinates and other names of sides, faces and axes may make the program choose other contact points, or the other of two cells that share a tip: such answers differ by the error of the mesh, which the change of energy measures.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "dimension" "" .key().named("dim") = r.dimension, DIMENSION;
            "transformation" "" .key() = r.transformation.clone(), "what was done to the case";
            "exact" "" .shown() = if r.exact { "exact" } else { "rounds or renames" }, "`exact`: every number of the case is what it was, or a power of two times that; the others round coordinates, of which a crack 1e-14 of a cell beside a node keeps little, or give sides, faces and axes other names";
            "scenes" "" .shown() = r.scenes, "scenes it was tried on";
            "same_points" "" .shown() = r.same, "of these, with contact points in the same places";
            "kept" "" .shown().named("9 digits") = r.kept, "of these, with at least 9 digits kept";
            "digits_median" "–" .shown().significant(3).named("digits, median") = r.median, "digits that half of the scenes with the same points kept at least";
            "digits_fewest" "–" .shown().significant(3).named("fewest") = r.fewest, "digits kept by the worst of them";
            "energy" "–" .shown().significant(2).power(2) = r.energy, "largest change of strain energy and dissipation of any scene, over their sum";
            "worst" "" .shown() = r.worst.clone(), "that scene";
        }
    }
}

impl Row for LadderRow {
    const NAME: &'static str = "stress_ladders";
    const TITLE: &'static str = "One parameter at a time";
    const QUESTION: &'static str =
        "How far can a parameter go before digits are lost, and where do answers jump?";
    const NOTES: &'static str = "Plates and cubes with plain cracks; those that stick are in uniform compression, and the error is that against the closed form, otherwise that of the energy. `A past B`: feature A of cracks at ±1, ±1/3, … 3⁻²⁷ of a cell and 0 from B, and at 0 with all coordinates rounded to 16 to 2 digits, by the default method. Compared are the force, the mean slip and the dissipation of every crack: up to 1e-3 of a cell with those of the neighbour, over the larger of both (more than 1e-3 is a jump); beyond with those in 1.39 times as many cells, over the largest of all cracks (more than 10 % is a fault), where both join as many ends with what they nearly touch. Other tips and spaces than the default may step where a tip leaves a cell: their jumps are no fault.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "ladder" "" .key() = r.ladder.clone(), "name";
            "parameter" "" .shown() = r.parameter.clone(), "what changes, with its unit";
            "least" "" .shown().significant(3) = r.range[0], "least value, in the unit of the parameter";
            "largest" "" .shown().significant(3) = r.range[1], "largest value";
            "values" "" .shown() = r.steps, "values tried";
            "right" "" .shown() = r.ended[0], "values at which the default method's answer was right";
            "refused" "" .shown() = r.ended[1], "refused at a place in the file";
            "jumps" "" .shown() = r.ended[2], "differs from a neighbour";
            "wrong" "" .shown() = r.ended[3], "the closed form or the energy is missed; of pairs by more than 1e-7 of the energy, or 1e-5 of anything else";
            "other_cells" "" .shown().named("other cells") = r.ended[4], "other than in other cells";
            "suspect" "" .shown() = r.ended[5], "the judge doubts the mesh";
            "crashed" "" .shown() = r.ended[6], "no answer for another reason";
            "error" "–" .shown().residual() = r.error, "largest error where it was right";
            "neighbour" "–" .shown().significant(2).power(2) = r.apart[0].0, "largest difference of neighbours; `NaN` where nothing is compared";
            "neighbour_at" "" .shown().significant(3).named("at") = r.apart[0].1, "value of that step";
            "mesh" "–" .shown().significant(2).power(2) = r.apart[1].0, "largest difference from other cells";
            "mesh_at" "" .shown().significant(3).named("at") = r.apart[1].1, "value of that step";
            "beyond" "" .shown().named("> 2 %") = r.beyond, "how many differ by more than 2 % from other cells: the mesh may leave as much";
            "others" "" = r.others.clone(), "values that are not right, by fault";
        }
    }
}
