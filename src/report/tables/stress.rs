//! The stress suite: causes, invariances, methods, scenes.

use super::words::*;
use crate::report::table::{Column, Row, columns};
use crate::studies::stress::finding::Cause;
use crate::studies::stress::rungs::{LadderRow, OptionRow, RungRow};
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
    const NOTES: &'static str = "A scene counts once, by the worst that was found. `refused` scenes are refused at a place in their file, with the remedy; `beyond the mesh` are those that no mesh of such cells carries by construction (cracks along each other within 1e-6 of a cell; without tip functions shorter than two cells). `no equilibrium`: no force within the cones of friction balances the load on a floating piece, as a certificate proves; `limit of friction`: the same for nine tenths of the friction, and no exact method finds an answer. `floor of the arithmetic`: solved, with an error up to 1e-6 that is another one in other units of length.";

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
    const NOTES: &'static str = "An exact method is done where its answer is `solved` to the tier `high`, asked for at 1e-12; an approximate one where it keeps its claim. Scenes are those with an answer: without those that a method declines, and without those where no force within the cones of friction balances the load.";

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
            "swaying" "" .shown() = r.losses[8], "stopped where slender parts sway more than 100 times as far as cells deform";
            "wandering" "" .shown() = r.losses[9], "its iterates neither settle nor repeat";
            "stalled" "" .shown() = r.losses[10], "came to rest for no cause named here";
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
    const QUESTION: &'static str = "How far can a parameter go before digits or methods are lost?";
    const NOTES: &'static str = "Plates and cubes with plain cracks. Where all cracks stick in uniform compression the error is that against the closed form; where they slip it is the error of the energy identity; on the ladder of loads it is the change of contact forces, and over the change of the load it is their Lipschitz constant. Every value: `stress_rungs.csv`.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "ladder" "" .key() = r.ladder.clone(), "name";
            "parameter" "" .shown() = r.parameter.clone(), "what changes, with its unit";
            "least" "" .shown().significant(3) = r.range[0], "least value, in the unit of the parameter";
            "largest" "" .shown().significant(3) = r.range[1], "largest value";
            "values" "" .shown() = r.rungs, "values tried";
            "right" "" .shown() = r.right, "values at which the default method's answer was right";
            "others" "" .shown() = r.others.clone(), "the other values with their causes";
            "error" "–" .shown().residual() = r.error, "largest error where it was right";
            "iterations" "" .shown() = r.iterations, "most iterations of the default method where it was right";
            "lost" "" .shown() = r.lost.clone(), "methods that did not do what they are for, each with the number of values";
        }
    }
}

impl Row for OptionRow {
    const NAME: &'static str = "stress_options";
    const TITLE: &'static str = "Safe windows of the options of the methods";
    const QUESTION: &'static str = "How wrong may a parameter of a method be?";
    const NOTES: &'static str = "A sheared plate with two cracks of friction 0.3; from a 10 000th to 10 000 times the default, as far as an option is allowed. Limits of iterations are left out.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "method" "" .key() = r.method, METHOD;
            "option" "" .key() = r.option, "name of the option";
            "default" "" .shown().significant(3) = r.default, "its default";
            "safe_from" "" .shown().significant(3).named("safe from") = r.safe[0], "least value, next to each other about the default, at which the method did what it is for";
            "safe_to" "" .shown().significant(3).named("to") = r.safe[1], "largest such value";
            "tried_from" "" .shown().significant(3).named("tried from") = r.tried[0], "least value tried";
            "tried_to" "" .shown().significant(3).named("tried to") = r.tried[1], "largest value tried";
            "iterations" "" .shown() = r.iterations, "at the default";
            "fewest" "" .shown() = r.fewest.0, "fewest of all values tried";
            "fewest_at" "" .shown().significant(3).named("at") = r.fewest.1, "the value that took them";
        }
    }
}

impl Row for RungRow {
    const NAME: &'static str = "stress_rungs";
    const TITLE: &'static str = "Every value of every parameter";
    const QUESTION: &'static str = "At which value does what happen?";
    const NOTES: &'static str = "See `stress_ladders` and `stress_options`.";
    const READABLE: bool = false;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "ladder" "" .key() = r.ladder.clone(), "name; of an option its method and name";
            "parameter" "" = r.parameter.clone(), "what changes, with its unit";
            "value" "" .key() = r.value, "the value";
            "cause" "" = name(r.cause), CAUSE;
            "reason" "" = r.reason.clone(), "in one line";
            "error" "–" .residual() = r.error, "against the closed form, or of the energy identity; of the ladder of loads the change of contact forces";
            "iterations" "" = r.iterations, "of the default method, or of the method whose option it is";
            "done" "" = r.done[0], "methods that did what they are for";
            "tried" "" = r.done[1], "methods tried";
            "lost" "" = r.lost.join("; "), "the others, with causes";
            "sway" "–" .residual() = r.sway, "condition, as in `runs.csv`";
            "overlap" "–" .residual() = r.overlap, "deepest overlap of the faces over the largest jump or displacement";
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
