//! The stress suite: causes, invariances, methods, scenes.

use super::words::*;
use crate::report::table::{Column, Row, columns};
use crate::studies::stress::finding::Fault;
use crate::studies::stress::summary::{FaultRow, InvarianceRow, LadderRow, MethodRow, SceneRow};

const FAMILY: &str = "`patch-2d`, `patch-3d`: uniform compression, all cracks stick, the answer is known; `slip-2d`, `slip-3d`: pushed and sheared with friction";
const FAULT: &str = "`right`, or the worst that was found";
const MINIMAL: &str =
    "smallest case found that fails for the same fault, as a file beside this table";

fn name(fault: Option<Fault>) -> String {
    fault.map_or("right", Fault::name).into()
}

impl Row for FaultRow {
    const NAME: &'static str = "stress_faults";
    const TITLE: &'static str = "Random scenes by what became of them";
    const QUESTION: &'static str = "How often does the program fail, and why?";
    const NOTES: &'static str = "A scene counts once, by the worst that was found. `refused` scenes are refused at a place in their file, with the remedy; `beyond the mesh` are those that no mesh of such cells carries by construction (cracks along each other within 1e-6 of a cell; without tip functions shorter than two cells). `no equilibrium`: no force within the cones of friction balances the load on a floating piece, as a certificate proves; `limit of friction`: the same for nine tenths of the friction, and no exact method finds an answer. `floor of the arithmetic`: solved, with an error up to 1e-6 that is another one in other units of length.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "family" "" .key() = r.family.name(), FAMILY;
            "fault" "" .key() = name(r.fault), FAULT;
            "scenes" "" .shown() = r.scenes, "how many";
            "share" "–" .significant(4).percent(2) = r.share, "of all scenes of the family";
            "example" "" .shown() = r.example, "number of one of them: `stickslip stress --family FAMILY --only NUMBER` runs it again";
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

impl Row for MethodRow {
    const NAME: &'static str = "stress_methods";
    const TITLE: &'static str = "Random scenes: every method, and why it lost";
    const QUESTION: &'static str = "Which method fails on which kind of body, and for what cause?";
    const NOTES: &'static str = "An exact method is done where its answer is `solved` to the tier `high`, asked for at 1e-12; an approximate one where it keeps its claim. Scenes are those with an answer: without those that a method declines, and without those where no force within the cones of friction balances the load.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "dimension" "" .key().named("dim") = r.dimension, DIMENSION;
            "method" "" .key() = r.method.clone(), METHOD;
            "kind" "" .shown() = if r.exact { "exact" } else { "approximate" }, "whether the method's limit are the contact laws";
            "scenes" "" .shown() = r.scenes, "scenes tried";
            "done" "" .shown() = r.done, "of these, done what the method is for";
            "false_claims" "" .shown() = r.false_claims, "claims that the judge refuted";
            "crashed" "" .shown() = r.crashed, "ended with an error, or at a limit of time or memory";
            "max_iterations" "" .shown() = r.gave_up[0], "ended without a claim at the limit of iterations";
            "stalled" "" .shown() = r.gave_up[1], "without progress";
            "singular_tangent" "" .shown() = r.gave_up[2], "at a matrix that cannot be factored";
            "mechanism" "" = r.gave_up[3], "at a body that is held by nothing";
            "diverged" "" .shown() = r.gave_up[5], "with numbers that grew without bound";
            "rounding" "" .shown() = r.gave_up[7], "with forces so large beside what they move that rounding decides";
            "iterations_median" "" .shown().named("iterations, median") = r.iterations[0], "median where done";
            "iterations_max" "" .shown().named("largest") = r.iterations[1], "largest number where done";
            "friction_max" "–" .shown().significant(3).named("largest μ") = r.friction, "largest friction coefficient at which it was done";
            "sway_max" "–" .shown().significant(2).named("largest sway") = r.sway, "largest condition, as `sway` of `runs.csv`, at which it was done";
        }
    }
}

impl Row for LadderRow {
    const NAME: &'static str = "stress_ladders";
    const TITLE: &'static str = "One parameter at a time";
    const QUESTION: &'static str = "How far can a parameter go before digits are lost?";
    const NOTES: &'static str = "Plates and cubes with plain cracks that stick in uniform compression; the error is that against the closed form.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "ladder" "" .key() = r.ladder.clone(), "name";
            "parameter" "" .shown() = r.parameter.clone(), "what changes, with its unit";
            "least" "" .shown().significant(3) = r.range[0], "least value, in the unit of the parameter";
            "largest" "" .shown().significant(3) = r.range[1], "largest value";
            "values" "" .shown() = r.rungs, "values tried";
            "right" "" .shown() = r.right, "values at which the default method's answer was right";
            "others" "" .shown() = r.others.clone(), "the other values with their faults";
            "error" "–" .shown().residual() = r.error, "largest error where it was right";
            "iterations" "" .shown() = r.iterations, "most iterations of the default method where it was right";
        }
    }
}

impl Row for SceneRow {
    const NAME: &'static str = "stress_scenes";
    const TITLE: &'static str = "Scenes that are not right";
    const QUESTION: &'static str = "What remains broken, and how can it be run again?";
    const NOTES: &'static str = "`stickslip stress --seed SEED --family FAMILY --only NUMBER` runs the scene again and writes its case file.";
    const READABLE: bool = false;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "seed" "" = r.seed, "seed of the suite";
            "family" "" .shown() = r.family.name(), FAMILY;
            "number" "" .shown() = r.number, "number in the family, from 0";
            "category" "" .shown() = r.category.clone(), "how its cracks lie";
            "fault" "" .shown() = r.fault.name(), FAULT;
            "reason" "" .shown() = r.reason.clone(), "in one line";
            "error" "–" .residual() = r.error, "largest error of the default method against the closed form, or of the energy identity";
            "minimal" "" .shown() = r.minimal.clone().unwrap_or_default(), MINIMAL;
        }
    }
}
