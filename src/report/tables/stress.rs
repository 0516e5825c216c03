//! The stress suite: causes, invariances, methods, scenes.

use super::words::*;
use crate::report::table::{Column, Row, columns};
use crate::studies::stress::finding::Cause;
use crate::studies::stress::summary::{CauseRow, InvarianceRow, MethodRow, SceneRow};

const FAMILY: &str = "`patch-2d`, `patch-3d`: uniform compression, all cracks stick, the answer is known; `slip-2d`, `slip-3d`: pushed and sheared with friction";
const CAUSE: &str = "`right`, or the worst that was found";
const MINIMAL: &str =
    "smallest case found that fails for the same cause, as a file beside this table";

fn name(cause: Option<Cause>) -> String {
    cause.map_or("right", Cause::name).into()
}

impl Row for CauseRow {
    const NAME: &'static str = "stress_causes";
    const TITLE: &'static str = "Random scenes by what became of them";
    const QUESTION: &'static str = "How often does the program fail, and why?";
    const NOTES: &'static str = "A scene counts once, by the worst that was found. `refused` scenes are refused at a place in their file, with the remedy; `beyond the mesh` are those that no mesh of such cells carries by construction (cracks along each other within 1e-6 of a cell; without tip functions shorter than two cells).";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "family" "" .key() = r.family.name(), FAMILY;
            "cause" "" .key() = name(r.cause), CAUSE;
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
    const NOTES: &'static str = "An exact method is done where its answer is `solved` to the tier `high`, asked for at 1e-12; an approximate one where it keeps its claim. Scenes are those with an answer; those that a method declines are left out.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "dimension" "" .key().named("dim") = r.dimension, DIMENSION;
            "method" "" .key() = r.method.clone(), METHOD;
            "kind" "" .shown() = if r.exact { "exact" } else { "approximate" }, "whether the method's limit are the contact laws";
            "scenes" "" .shown() = r.scenes, "scenes tried";
            "done" "" .shown() = r.done, "of these, done what the method is for";
            "false_claims" "" .shown() = r.losses[0], "claims that the judge refuted";
            "factorisation" "" .shown() = r.losses[1], "a factorisation failed with an error";
            "several_solutions" "" .shown() = r.losses[2], "lost where two exact methods found different answers that both hold";
            "singular_tangent" "" .shown() = r.losses[3], "a matrix of the method cannot be factored";
            "cycling" "" .shown() = r.losses[4], "the violation of the contact laws repeats, with a period of up to 12 iterations";
            "diverged" "" .shown() = r.losses[5], "the numbers grew without bound";
            "floor" "" .shown() = r.losses[6], "came to rest within 1000 times the tolerance asked for, 1e-12";
            "slow" "" .shown() = r.losses[7], "still converges at the limit of iterations: the violation halved over their last half";
            "stalled" "" .shown() = r.losses[8], "stopped for no cause named here";
            "iterations_median" "" .shown().named("iterations, median") = r.iterations[0], "median where done";
            "iterations_max" "" .shown().named("largest") = r.iterations[1], "largest number where done";
            "friction_max" "–" .shown().significant(3).named("largest μ") = r.friction, "largest friction coefficient at which it was done";
            "sway_max" "–" .shown().significant(2).named("largest sway") = r.sway, "largest condition, as `sway` of `runs.csv`, at which it was done";
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
            "cause" "" .shown() = r.cause.name(), CAUSE;
            "reason" "" .shown() = r.reason.clone(), "in one line";
            "error" "–" .residual() = r.error, "largest error of the default method against the closed form, or of the energy identity";
            "scene_s" "s" .time() = r.seconds, "time of the scene with all methods and transformations";
            "minimal" "" .shown() = r.minimal.clone().unwrap_or_default(), MINIMAL;
        }
    }
}
