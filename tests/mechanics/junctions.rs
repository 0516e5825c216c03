//! Several cracks in one body: crossing, branching, bent ones.

use crate::common::bodies::{motion_of, motions, piecewise};
use crate::common::*;
use stickslip::model::body::{Body, Needs};
use stickslip_xfem::enrichment::cell_facets::region_at;
use stickslip_xfem::enrichment::pieces::pieces;
use stickslip_xfem::geometry::{add_scaled, norm, sub};

/// A polyline crack.
fn bent(points: &str, tip: &str) -> String {
    format!("[[crack]]\npoints_m = {points}\nfriction = 0.3\ntip = {tip}\ncontact = \"star\"\n")
}

/// Bodies with their number of pieces.
fn bodies() -> Vec<(&'static str, Body, usize)> {
    let plate = |cells: [usize; 2], cracks: String| {
        let rest = cracks + &support("\"bottom\"", "[0, 0]") + &support("\"top\"", "[0, -1e-3]");
        let case = parse(&plane([-1.0, -1.0], [1.0, 1.0], cells, &rest));
        Body::new(&case, 1, &Needs::default()).unwrap_or_else(|e| panic!("{e}"))
    };
    let through = "\"none\"";
    let level = bent("[[-1.1, -0.13], [1.1, 0.21]]", through);
    let crossing = level.clone() + &bent("[[-0.27, -1.1], [0.31, 1.1]]", through);
    let branching = level + &bent("[[0.0, 0.04], [0.31, 1.1]]", through);
    let three = bent("[[-0.6, -0.1], [0.62, 0.13]]", "\"branch\"")
        + &bent("[[-0.07, -0.6], [0.11, 0.57]]", "\"branch\"")
        + &bent(
            "[[0.4, -0.7], [0.55, -0.3], [0.3, 0.06967213]]",
            "{ branch_radius_m = 0.2 }",
        );
    let kinked = bent(
        "[[-1.1, -0.3], [-0.23, 0.34], [0.4, -0.17], [1.1, 0.3]]",
        through,
    );
    let arc = bent("", through).replace(
        "points_m = ",
        "arc = { centre_m = [-1, -1], radius_m = 1.37, from_deg = -5, to_deg = 95 }",
    );
    vec![
        ("crossing", plate([9, 8], crossing), 4),
        ("branching", plate([9, 8], branching), 3),
        ("three, one bent, with tips", plate([21, 21], three), 1),
        ("bent through the body", plate([10, 10], kinked), 2),
        ("arc", plate([10, 10], arc), 2),
    ]
}

/// Source: conformity. Goal: whatever the unknowns, the displacement on an edge is the same from both cells, region by
/// region: cracks cut cells, nothing else does. Tolerance: rounding.
#[test]
fn displacements_are_continuous_across_cell_edges() {
    let mut random = Random(41);
    for (name, body, _) in bodies() {
        let integrator = body.integrator();
        let u = random.vector(body.numbers.len());
        let mut seen = std::collections::BTreeMap::new();
        let mut compared = 0;
        for cell in 0..body.mesh.cell_count() {
            for &[i, j] in body.mesh.kind.edges() {
                let nodes = body.mesh.cell(cell);
                let key = [nodes[i].min(nodes[j]), nodes[i].max(nodes[j])];
                // From the lower node, so that both cells take the same points.
                let [p, q] = key.map(|n| body.mesh.nodes[n as usize]);
                let found = [0.03, 0.21, 0.44, 0.67, 0.83, 0.98].map(|t| {
                    let x = add_scaled(&p, t, &sub(&q, &p));
                    let partition = body.enrichment.partition(cell);
                    let region = partition.map_or(0, |d| region_at(&body.cracks, d, &x));
                    integrator.displacement(cell, &x, region, &u).unwrap()
                });
                let Some(other) = seen.insert(key, found) else {
                    continue;
                };
                for (v, w) in found.iter().zip(&other) {
                    let gap = norm(&sub(v, w));
                    assert!(gap < 1e-12, "{name}: {gap:e} between {p:?} and {q:?}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 300, "{name}: {compared}");
    }
}

/// Source: geometry, area. Goal: the parts of all cells fill the body; crossing cracks leave four pieces, branching ones three;
/// every piece moves rigidly without energy and jumps against its neighbours only.
/// Tolerance: rounding against the energy of a random motion.
#[test]
fn parts_fill_their_cells_and_pieces_between_cracks_move_freely() {
    let mut random = Random(43);
    for (name, body, count) in bodies() {
        let integrator = body.integrator();
        let cells = 0..body.mesh.cell_count();
        let points = cells
            .clone()
            .flat_map(|cell| integrator.points(cell).unwrap());
        let area: f64 = points.map(|p| p.weight).sum();
        assert_near(area, 4.0, 1e-6, name);
        let most = match name {
            "crossing" | "three, one bent, with tips" => 4,
            "branching" => 3,
            _ => 2,
        };
        let parts = cells.map(|cell| body.enrichment.regions(cell)).max();
        assert_eq!(parts, Some(most), "{name}");
        let found = pieces(&body.mesh, &body.enrichment).extents;
        assert_eq!(found.len(), count, "{name}");
        let noise = random.vector(body.numbers.len());
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let size = dot(&noise, &body.stiffness.mul(&noise)) / dot(&noise, &noise);
        for r in motions(2) {
            for piece in 0..count {
                let u = motion_of(&body, |p| p == piece, &r);
                let force = body.stiffness.mul(&u);
                let worst = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
                assert!(worst < 1e-11 * size, "{name}, piece {piece}: {worst:e}");
            }
            // All together nothing jumps.
            let whole = piecewise(&body, |_, x| r(x));
            assert!(body.jump(&whole).iter().all(|j| j.abs() < 1e-12), "{name}");
        }
    }
}
