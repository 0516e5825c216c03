//! The stress suite: scenes are right, faults are told, what is broken is found, made small, and not measured twice.

use std::collections::BTreeSet;

use crate::common::*;
use stickslip::run::verdict::Verdict;
use stickslip::studies::lab::Inside;
use stickslip::studies::stress::find::{DEFAULT, Effort, find};
use stickslip::studies::stress::finding::{Fault, Finding};
use stickslip::studies::stress::rungs::{Answer, Rung, judge};
use stickslip::studies::stress::suite;
use stickslip::studies::stress::transform::Transform;
use stickslip::studies::stress::{Family, Scene, places, scene, summary};

/// Seed of the scenes here; those of reports are others.
const SEED: u64 = 20_261_122;

/// Course of scenes in this process.
fn found(scenes: &[Scene], effort: Effort) -> Vec<Finding> {
    let halves = scenes.chunks(scenes.len().div_ceil(2).max(1));
    // Threads of their own: a worker of rayon that waits would begin another scene in the middle of one.
    std::thread::scope(|scope| {
        let work = |half: &'_ [Scene]| {
            let half = half.to_vec();
            // Enough for the recursion of the reader of TOML in unoptimised frames.
            let thread = std::thread::Builder::new().stack_size(16 << 20);
            let own = thread.spawn_scoped(scope, move || {
                find(&mut Inside::default(), &half, effort).expect("nothing is kept")
            });
            own.expect("a thread")
        };
        let threads: Vec<_> = halves.map(work).collect();
        let all = threads.into_iter().map(|own| own.join().expect("no panic"));
        all.flatten().collect()
    })
}

fn one(scene: Scene, effort: Effort) -> Finding {
    found(&[scene], effort).remove(0)
}

/// Findings on the first scenes of a family.
fn first(family: Family, count: u64, effort: Effort) -> Vec<Finding> {
    let scenes: Vec<Scene> = (0..count).map(|k| scene(family, SEED, k)).collect();
    found(&scenes, effort)
}

/// No fault of the program, few refusals, and the default method solves what has one answer.
#[track_caller]
fn hold(findings: &[Finding]) {
    let told: Vec<String> = (findings.iter())
        .filter_map(|f| Some(format!("{} {} {}", f.scene.number, f.fault?, f.reason)))
        .collect();
    let count = |fault: Fault| findings.iter().filter(|f| f.fault == Some(fault)).count();
    assert!(summary::as_expected(findings), "{told:#?}");
    assert!(20 * count(Fault::Refused) <= findings.len(), "{told:#?}");
}

/// Source: uniform stress. Goal: what is solved is right, in whatever units, wherever the body lies, and errors name a place
/// in the file. Tolerance: 1e-9 of the largest stress, displacement and of the energy, far above rounding and far below a
/// fault.
#[test]
fn random_plane_bodies_in_uniform_stress_are_solved_as_the_closed_form_says() {
    hold(&first(Family::Patch2d, 120, Effort::Default));
    hold(&first(Family::Patch2d, 18, Effort::All));
}

/// As in 2D.
#[test]
fn random_solids_in_uniform_stress_are_solved_as_the_closed_form_says() {
    hold(&first(Family::Patch3d, 11, Effort::Default));
    hold(&first(Family::Patch3d, 2, Effort::All));
}

/// Goal: with friction the energy identity holds, exact methods agree, and nothing depends on units and place.
#[test]
fn random_plane_bodies_with_friction_keep_their_energy() {
    hold(&first(Family::Slip2d, 9, Effort::All));
}

/// Goal: a scene can be made again alone, to the last bit, and every category has its turn.
#[test]
fn scenes_are_reproducible_and_take_turns() {
    for family in Family::ALL.into_iter().filter(|f| f.is_random()) {
        let kinds = if scene(family, 7, 0).dim == 2 { 18 } else { 11 };
        let mut categories = BTreeSet::new();
        for k in 0..kinds {
            let [first, again] = [0, 1].map(|_| scene(family, 7, k));
            assert_eq!(first, again);
            assert_ne!(first.text, scene(family, 8, k).text);
            categories.insert(first.category);
        }
        assert_eq!(categories.len() as u64, kinds);
    }
}

/// All steps of some ladders.
fn steps(of: impl Fn(&places::Ladder) -> bool) -> Vec<Scene> {
    let own = (0..places::count(true)).filter(|number| of(places::step(*number).1));
    own.map(|number| scene(Family::Ladder, 0, number)).collect()
}

/// Goal: what a plain crack does in uniform stress depends neither on its angle or a crack along it, nor on units and place:
/// every step of these ladders is right, but for what is refused with a place.
#[test]
fn ladders_of_plain_cracks_are_right_at_every_step() {
    let plane = steps(|ladder| ladder.dim == 2 && ladder.compared.is_none());
    let mut others = Vec::new();
    for finding in found(&plane, Effort::Default) {
        let value = places::step(finding.scene.number).2.value;
        let allowed = match finding.scene.category.as_str() {
            "mesh twisted" if value.abs() > 110.0 => Some(Fault::Refused),
            "unit of stress" if value < 1e-23 => Some(Fault::Refused),
            _ => None,
        };
        if finding.fault.is_some() && finding.fault != allowed {
            let Finding { scene, reason, .. } = finding;
            others.push(format!("{} {value:e}: {reason}", scene.category));
        }
    }
    assert!(others.is_empty(), "{others:#?}");
}

/// Goal: where a crack ends, bends or meets another beside a side, an edge or a node decides nothing, whether cracks
/// stick or slip, at distances down to 1e-13 of a cell, and whatever the digits of its coordinates. Tolerance: 1e-3 from one
/// step to the next, of what a crack of six cells changes where it is moved by 1e-3 of one.
#[test]
fn answers_do_not_jump_where_cracks_are_moved_past_the_mesh() {
    let cracks = ["end past side", "crossing past edge", "mouth past node"];
    let loads = cracks.map(|name| ["sticks", "slips"].map(|load| format!("{name}, {load}")));
    let mut scenes = steps(|ladder| loads.as_flattened().contains(&ladder.name));
    scenes.retain(|own| places::step(own.number).2.usual);
    let findings = suite::run(&mut Inside::default(), &scenes).expect("nothing is kept");
    let rows = summary::of_ladders(&findings);
    assert_eq!(rows.len(), 6);
    for row in rows {
        assert_eq!((row.ended[0], row.steps), (24, 24), "{row:?}");
        // Both rules had something to compare.
        let [near, far] = row.apart.map(|own| own.0);
        assert!(near <= 1e-3 && (0.0..0.02).contains(&far), "{row:?}");
    }
}

/// Goal: the judge of ladders sees what is planted: a jump of 2e-3 of one quantity of one crack at the step where it is, also
/// over a step without an answer and between digits; a difference from other cells, but where these join another end.
#[test]
fn jumps_that_are_planted_are_found_where_they_are() {
    let answer = |factor: f64| Answer {
        cracks: vec![[3.0, -4.0, 1e-5, 2.0], [300.0, 0.0, factor * 1e-6, 200.0]],
        joined: 0,
    };
    let values = [-1.0, -1e-6, -1e-9, 0.0, 1e-9, 1e-6, 1.0, 16.0, 9.0, 2.0];
    let rungs = values.map(|value| Rung {
        value,
        near: ![-1.0, 1.0, 2.0].contains(&value),
        answers: [Some(answer(1.0)), None],
    });
    let faults = |slips: bool, change: &dyn Fn(&mut [Rung])| {
        let mut rungs = rungs.to_vec();
        change(&mut rungs);
        let judged = judge(&rungs, slips).into_iter().zip(values);
        let told = judged.filter_map(|((fault, _), value)| Some((fault?, value)));
        told.collect::<Vec<_>>()
    };
    let from = |place: usize, to: usize, factor: f64| {
        move |rungs: &mut [Rung]| {
            for rung in &mut rungs[place..to] {
                rung.answers[0] = Some(answer(factor));
            }
        }
    };
    assert_eq!(faults(true, &from(4, 6, 1.0005)), []);
    assert_eq!(faults(true, &from(4, 6, 1.002)), [(Fault::Jump, 1e-9)]);
    // Beyond 1e-3 of a cell neighbours may differ, and cracks that stick have no slip.
    assert_eq!(faults(true, &from(6, 7, 1.5)), []);
    assert_eq!(faults(false, &from(4, 6, 1.5)), []);
    assert_eq!(faults(true, &from(8, 9, 0.998)), [(Fault::Jump, 9.0)]);
    let hidden = |rungs: &mut [Rung]| {
        from(5, 6, 1.002)(rungs);
        rungs[4].answers[0] = None;
    };
    assert_eq!(faults(true, &hidden), [(Fault::Jump, 1e-6)]);
    let other = |joined: usize, force: f64| {
        move |rungs: &mut [Rung]| {
            let mut other = answer(1.0);
            (other.joined, other.cracks[1][0]) = (joined, force);
            rungs[6].answers[1] = Some(other);
        }
    };
    assert_eq!(faults(false, &other(0, 340.0)), [(Fault::OtherCells, 1.0)]);
    assert_eq!(faults(false, &other(1, 340.0)), []);
    assert_eq!(faults(false, &other(0, 320.0)), []);
}

/// A scene of cracks that end inside, with branch functions or not: right as it is.
fn sound() -> Scene {
    scene(Family::Patch2d, SEED, 0)
}

fn changed(from: &str, to: &str) -> Finding {
    let scene = sound();
    assert!(scene.text.contains(from), "{}", scene.text);
    let text = scene.text.replace(from, to);
    one(Scene { text, ..scene }, Effort::All)
}

/// Goal: the suite itself sees a wrong answer, an error without a place and a refusal, each as what it is: what is planted in
/// the case stands for a fault of the program.
#[test]
fn what_is_planted_is_found_for_what_it_is() {
    assert_eq!(one(sound(), Effort::All).fault, None);
    // Friction that does not stick: the closed form of sticking cracks is missed.
    let text = sound().text;
    let line = text.lines().find(|l| l.starts_with("friction")).unwrap();
    let slippery = changed(line, "friction = 0.0");
    let reason = &slippery.reason;
    assert_eq!(slippery.fault, Some(Fault::WrongPatch), "{reason}");
    let refused = changed("[material]", "[colour]\n[material]");
    let reason = &refused.reason;
    assert_eq!(refused.fault, Some(Fault::Refused), "{reason}");
    assert!(reason.starts_with("scene.toml:"), "{reason}");
    let beyond = Scene {
        beyond: true,
        text: text.replace("[material]", "[colour]\n[material]"),
        ..sound()
    };
    assert_eq!(one(beyond, Effort::All).fault, Some(Fault::Beyond));
}

/// Goal: every method is tried on every scene, and the default one is first.
#[test]
fn every_method_has_its_record() {
    let finding = one(sound(), Effort::All);
    let methods = finding.records.iter().map(|own| own.found.method.as_str());
    let methods: Vec<&str> = methods.collect();
    assert_eq!(methods[0], DEFAULT);
    let known = stickslip::run::registry::methods().iter().map(|m| m.name);
    let known: BTreeSet<&str> = known.collect();
    assert_eq!(methods.into_iter().collect::<BTreeSet<_>>(), known);
    // Four transformations a scene, of eleven: neighbours of one number have them all.
    assert_eq!(finding.seen.len(), 4);
    let next = |number: u64| one(Scene { number, ..sound() }, Effort::All).seen;
    let names = (0..3).flat_map(next).map(|own| own.transformation);
    let names: BTreeSet<String> = names.collect();
    // One crack has one order.
    assert!(names.len() >= 10, "{names:?}");
}

/// A crack along the diagonal of a body whose upper side is held ends at the corner of the support. Moved by a
/// thousand sizes the file states it 1e-12 of a cell beside the corner; the piece below must not hang on the node.
#[test]
fn a_crack_that_ends_where_a_support_ends_does_so_wherever_the_body_lies() {
    let text = "title = \"t\"\nmodel = \"plane-stress\"\ntolerance = 1e-12\n\
         material = { young_pa = 54.559785694589685, poisson = 0.06620393066179478 }\n\
         mesh = { box = { min_m = [-0.20204568588666033, -0.0762717981933992], \
         max_m = [0.11854454230143646, 0.45804524878676217], cells = [6, 10] } }\n\
         [[crack]]\npoints_m = [[-0.843226142262854, -1.1449058921537218], \
         [0.75972499867763, 1.5266793427470848]]\nfriction = 0.5451060469186785\n\
         [[support]]\non = \"bottom\"\ndisplacement_m = [0, 0]\n\
         [[support]]\non = \"top\"\n\
         displacement_m = [5.614076928936276e-5, -6.423364087246463e-5]\n";
    let far = Transform::Shift(1e3);
    let all = Transform::ALL.into_iter().cycle();
    let takes = |n: &u64| {
        all.clone()
            .skip(4 * *n as usize)
            .take(4)
            .any(|own| own == far)
    };
    let scene = Scene {
        family: Family::Slip2d,
        number: (0..11).find(takes).expect("every view has its turn"),
        category: "planted".into(),
        dim: 2,
        text: text.into(),
        beyond: false,
    };
    let finding = one(scene, Effort::All);
    let moved = finding
        .seen
        .iter()
        .find(|own| own.transformation == far.name());
    let change = moved.and_then(|own| own.change).expect("it was seen so");
    assert!(
        change.force.is_some_and(|force| force < 1e-9) && change.energy < 1e-9,
        "{change:?}"
    );
}

/// Source: Coulomb. A crack whose friction is a ten-millionth below what sticking asks for slips by as little: an error
/// of 1e-9 to 1e-6 that is the same in every unit, and no rounding.
#[test]
fn a_small_error_that_no_unit_changes_is_not_taken_for_rounding() {
    let [p, q] = [2.0_f64, 1.0];
    // n = (−3, 4)/5 on a crack along (4, 3): |τ| / σ_n.
    let (n, t) = ([-0.6, 0.8], [0.8, 0.6]);
    let (pressure, shear) = (
        p * n[0] * n[0] + q * n[1] * n[1],
        p * n[0] * t[0] + q * n[1] * t[1],
    );
    let friction = (shear / pressure).abs() * (1.0 - 1e-7);
    let text = format!(
        "title = \"t\"\nmodel = \"plane-strain\"\ntolerance = 1e-12\n\
         material = {{ young_pa = 1000, poisson = 0.3 }}\n\
         mesh = {{ box = {{ min_m = [0, 0], max_m = [4, 4], cells = [9, 9] }} }}\n\
         [[crack]]\npoints_m = [[1, 1.1], [3, 2.6]]\nfriction = {friction:?}\ntip = \"none\"\n\
         [[support]]\non = \"left\"\ndisplacement_m = [0, \"free\"]\n\
         [[support]]\non = \"bottom\"\ndisplacement_m = [\"free\", 0]\n\
         [[load]]\non = \"right\"\npressure_pa = {p:?}\n\
         [[load]]\non = \"top\"\npressure_pa = {q:?}\n"
    );
    let scene = Scene {
        family: Family::Patch2d,
        number: 0,
        category: "planted".into(),
        dim: 2,
        text,
        beyond: false,
    };
    let finding = one(scene, Effort::Default);
    let error = finding.error();
    assert!((1e-9..1e-6).contains(&error), "{error:e}");
    assert_eq!(finding.fault, Some(Fault::WrongPatch), "{}", finding.reason);
}

/// Goal: cracks keep their friction when their order changes.
#[test]
fn friction_goes_with_its_crack() {
    let finding = first(Family::Slip2d, 60, Effort::Default).into_iter();
    let several = finding.filter(|own| own.scene.text.matches("[[crack]]").count() > 1);
    let solved = |own: &Finding| {
        let main = own.records.first();
        main.is_some_and(|main| main.found.verdict == Verdict::Solved)
    };
    let scene = several
        .filter(solved)
        .map(|own| own.scene)
        .next()
        .expect("one of sixty");
    let order = Transform::ALL
        .iter()
        .position(|own| *own == Transform::Order)
        .unwrap();
    let number = (0..11)
        .find(|n| (0..4).any(|k| (4 * n + k) % 11 == order))
        .unwrap() as u64;
    let finding = one(Scene { number, ..scene }, Effort::All);
    let seen = finding
        .seen
        .iter()
        .find(|own| own.transformation == Transform::Order.name());
    let energy = seen.expect("several cracks have an order").energy();
    assert!(energy < 1e-6, "{energy:e}");
}

/// Goal: a case that fails is made smaller as long as it fails for the same fault, and stands in the report; a second run measures
/// nothing again.
#[test]
fn a_failing_scene_is_made_small_and_kept() {
    let dir = tempfile::tempdir().unwrap();
    let arguments = [
        "stress", "--family", "patch-2d", "--scenes", "12", "--seed", "2", "--jobs", "2",
    ];
    let (_, shown, _) = stickslip(&arguments, dir.path());
    assert!(shown.contains("12 of 12 scenes"), "{shown}");
    let results = dir.path().join("results/stress");
    let table = std::fs::read_to_string(results.join("stress_scenes.csv")).unwrap();
    let rows = csv_rows(&table);
    let refused = rows.iter().find(|r| r["fault"] == "refused").unwrap();
    let small = std::fs::read_to_string(results.join(&refused["minimal"])).unwrap();
    let first = refused["numbers"].split(' ').next().unwrap();
    let number: u64 = first.parse().unwrap();
    assert!(small.len() < scene(Family::Patch2d, 5, number).text.len() + 400);
    // It is a case like any other.
    let file = results.join(&refused["minimal"]).display().to_string();
    let (_, told) = ends_with(2, &["check", &file], dir.path());
    assert!(told.contains("error: "), "{told}");
    let records = || {
        let folder = std::fs::read_dir(results.join("records")).unwrap();
        let sizes = folder.map(|own| own.unwrap().metadata().unwrap().len());
        sizes.sum::<u64>()
    };
    let before = records();
    let (_, again, _) = stickslip(&arguments, dir.path());
    assert_eq!(records(), before);
    assert!(again.contains("12 of 12 scenes"), "{again}");
}
