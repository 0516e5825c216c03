//! The judge of the mesh: silent on sound bodies, and it speaks for every fault planted in one.

use std::path::Path;

use crate::common::*;
use stickslip::model::body::Body;
use stickslip_xfem::contact::surface_point::SurfacePoint;
use stickslip_xfem::discretisation::mesh_checks::{UNIFORM, mesh_checks};
use stickslip_xfem::geometry::add_scaled;

/// A slanted crack with a zone of branch functions, crossed by another.
const CROSSED: &str = r#"
title = "crossed"
model = "plane-strain"
[material]
young_pa = 1e9
poisson = 0.3
[mesh.box]
min_m = [0.0, 0.0]
max_m = [1.0, 1.0]
cells = [12, 11]
[[crack]]
points_m = [[0.21, 0.33], [0.77, 0.62]]
friction = 0.5
tip = { branch_radius_m = 0.1 }
[[crack]]
points_m = [[0.52, 0.22], [0.43, 0.81]]
friction = 0.5
[[support]]
on = "bottom"
displacement_m = [0.0, 0.0]
[[support]]
on = "top"
displacement_m = [0.0, -1e-3]
"#;

/// Relative size of the planted faults: a thousand times what the judge lets pass.
const FAULT: f64 = 1e3 * UNIFORM;

/// A change of a sound body.
type Plant = fn(&mut Body);

/// Findings of the judge after a change of a sound body.
fn after(change: impl FnOnce(&mut Body)) -> (f64, Option<String>) {
    let mut body = body(CROSSED);
    assert_below(mesh_checks(&body).uniform, 1e-12, "sound");
    assert!(mesh_checks(&body).reason().is_none());
    change(&mut body);
    let found = mesh_checks(&body);
    (found.uniform, found.reason())
}

/// A place of the surface where functions jump and a multiplier acts.
fn carried(body: &mut Body) -> &mut SurfacePoint {
    let mut points = body.surface.quadrature.iter_mut();
    let own = points.find(|q| !q.shares.is_empty() && q.weight > 1e-3);
    own.expect("a point with a multiplier")
}

/// Goal: a part of a facet lost from its partition, the wrong side of a facet, a normal the wrong way round, a facet whose
/// multiplier is missing, branch functions that do not start at the tip of the crack: each leaves a residual of uniform stress
/// and a reason that names the place.
#[test]
fn every_planted_fault_is_told() {
    let faults: [(&str, Plant); 6] = [
        ("partition", |b| carried(b).weight *= 1.0 + FAULT),
        ("side", |b| carried(b).sides.reverse()),
        ("orientation", |b| {
            let n = &mut carried(b).frame[0];
            *n = n.map(|v| -v);
        }),
        ("rank", |b| carried(b).shares.clear()),
        ("zone", |b| {
            let tip = &mut b.enrichment.tips[0];
            tip.position = add_scaled(&tip.position, FAULT, &tip.ahead);
        }),
        ("stiffness", |b| {
            let other = body(&CROSSED.replace("0.62]", "0.620001]"));
            b.stiffness = other.discrete.stiffness;
        }),
    ];
    for (name, plant) in faults {
        let (residual, reason) = after(plant);
        println!("{name} {residual:.1e}");
        assert!(residual > UNIFORM, "{name}: {residual:.1e}");
        let reason = reason.unwrap_or_else(|| panic!("{name}: no reason"));
        assert!(reason.contains("uniform stress is off by"), "{reason}");
    }
}

/// Goal: where two pieces of a crack share all displacements, no force can be told from the other: refused at the crack, with
/// what would do.
#[test]
fn forces_that_nothing_tells_apart_are_refused() {
    let text = r#"
title = "short pieces"
model = "plane-stress"
[material]
young_pa = 7.0
poisson = 0.42
[mesh.box]
min_m = [-0.009243, 0.002679]
max_m = [0.016857, 0.013968]
cells = [11, 3]
[mesh.distort]
amplitude = 0.06978818568496144
seed = 60
[[crack]]
points_m = [[0.00077257, 0.01038711], [0.00026469, 0.00696933], [0.00436015, 0.00756945]]
friction = 0.5
tip = "none"
[[support]]
on = "bottom"
displacement_m = [0.0, 0.0]
[[support]]
on = "top"
displacement_m = [0.0, -1e-6]
"#;
    let error = try_body(text).err().expect("a refusal").to_string();
    assert!(error.contains("nothing tells the force on it"), "{error}");
    assert!(
        error.contains("longer pieces, or cells of at most"),
        "{error}"
    );
    assert!(error.contains("crack[1].points_m"), "{error}");
}

/// Goal: a layer between two cracks too thin for the digits of the stiffness is suspect, with how many digits are left; twenty
/// thousand times as thick it is sound.
#[test]
fn a_layer_that_holds_too_few_digits_is_suspect() {
    let between = |thickness: f64| {
        let other = [-0.21 - 0.6 * thickness, 0.13 + 0.8 * thickness];
        let layer = [[-0.21, 0.13], other]
            .map(|[x, y]| crack([x - 2.4, y - 1.8], [x + 2.4, y + 1.8], 0.9, "none"));
        let supports = [
            support("\"left\"", "[0.0, \"free\"]"),
            support("\"bottom\"", "[\"free\", 0.0]"),
            support("\"right\"", "[-3e-4, \"free\"]"),
            support("\"top\"", "[\"free\", -3.1e-4]"),
        ];
        let text = plane(
            [-1.0, -1.0],
            [1.0, 1.0],
            [20, 20],
            &(layer.concat() + &supports.concat()),
        );
        let results = run(&parse(&text), &["hybrid"]);
        let last = results.answers.into_iter().next_back().expect("a run");
        last.record.found.increments[0].clone()
    };
    let (thin, thick) = (between(5e-7), between(1e-2));
    let told = thin.verdict.to_string();
    println!(
        "{told}; sway {:.1e} and {:.1e}",
        thin.judge.sway, thick.judge.sway
    );
    assert!(told.starts_with("suspect mesh: slender parts"), "{told}");
    assert_eq!(thick.verdict.to_string(), "solved");
    assert!(thick.judge.sway < 1e-4 * thin.judge.sway);
}

/// Goal: a piece that its crack cuts off with too few contact points is refused at the crack, not at the supports.
#[test]
fn a_piece_that_no_contact_point_feels_is_refused_at_its_crack() {
    let text = r#"
[[crack]]
points_m = [[0.15, 1.75], [0.35, 1.5]]
friction = 0.1
[[support]]
on = "bottom"
displacement_m = [0.0, 0.0]
"#;
    let text = plane([-1.272147, 0.733396], [0.305327, 1.683271], [8, 5], text);
    let error = try_body(&text).err().expect("a refusal").to_string();
    assert!(
        error.contains("crack[1].points_m: crack 1 has too few contact points"),
        "{error}"
    );
    assert!(error.contains(", or cells of at most 4"), "{error}");
}

/// Source: uniform stress on faces that stick, which overlap nowhere. Goal: three planes that nearly cross in one cell leave a
/// sliver, 1e-7 of the others in weight, whose displacements hold as many digits as all others. Tolerance: they were off
/// by 1e-6 of the largest, are by 1e-13.
#[test]
fn a_sliver_between_three_planes_lies_where_its_own_forces_put_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/sliver.toml");
    let results = run(&parse(&std::fs::read_to_string(path).unwrap()), &["hybrid"]);
    let overlap = value(&results, |_| true, ["max_penetration_sampled", "", ""]);
    let (strain, size) = (2.7e6 / 8.9e10, 3e-3);
    assert_below(overlap, 1e-9 * strain * size, "overlap");
}
