//! The arrangement of cracks and mesh: what it promises to all who read it, on random scenes typed near grid lines.

use std::collections::BTreeSet;

use crate::common::Random;
use stickslip_xfem::cut::arrangement::{Arrangement, DELTA, On};
use stickslip_xfem::cut::crack::{Crack, Tip};
use stickslip_xfem::enrichment::Enrichment;
use stickslip_xfem::geometry::crack_shape::CrackShape;
use stickslip_xfem::geometry::polygon::segment_distance;
use stickslip_xfem::geometry::{Point, norm, sub};
use stickslip_xfem::mesh::Mesh;
use stickslip_xfem::mesh::box_mesh::{GridSpec, box_mesh};

/// Cells a side of the square [−1, 1]².
const CELLS: usize = 12;

/// Points of the cracks of a scene [m].
type Scene = Vec<Vec<[f64; 2]>>;

fn mesh() -> Mesh {
    let line: Vec<f64> = (0..=CELLS)
        .map(|k| 2.0 * k as f64 / CELLS as f64 - 1.0)
        .collect();
    box_mesh(&GridSpec::new(vec![line.clone(), line])).unwrap()
}

/// Cracks of two to four points, many on grid lines, nodes and each other, all off by up to 1e-13 .. 1e-3 of a cell; they neither
/// run along each other nor end so near to something that they are joined with it.
fn scene(random: &mut Random) -> Scene {
    let index = |random: &mut Random, n: usize| (random.next() * n as f64) as usize;
    let mut cracks: Scene = Vec::new();
    let count = 1 + index(random, 5);
    for _ in 0..count {
        let points = (0..2 + index(random, 3)).map(|_| {
            [0, 1].map(|_| {
                let place = random.between(-0.9, 0.9);
                let on_grid = (place * CELLS as f64 / 2.0).round() * 2.0 / CELLS as f64;
                let off = 10f64.powf(random.between(-14.0, -4.0)) * random.between(-1.0, 1.0);
                [on_grid + off, place][index(random, 2)]
            })
        });
        // No crack crosses itself.
        let mut points: Vec<[f64; 2]> = points.collect();
        points.sort_by(|p, q| p[0].total_cmp(&q[0]));
        points.dedup_by(|q, p| q[0] - p[0] < 1e-3);
        if points.len() > 1 {
            cracks.push(points);
        }
    }
    cracks
}

fn arranged(mesh: &Mesh, scene: &Scene) -> Option<(Arrangement, Vec<Crack>)> {
    let lengths = mesh.lengths();
    let shapes = scene
        .iter()
        .map(|points| CrackShape::Polyline(points.clone()));
    let whole: Vec<Crack> = (shapes.enumerate())
        .map(|(k, shape)| Crack::new(k, &shape, Tip::Auto, mesh, &lengths))
        .collect();
    Arrangement::new(mesh, &lengths, &whole).ok()
}

/// All scenes that can be arranged.
fn scenes(count: usize) -> impl Iterator<Item = (Scene, Arrangement, Vec<Crack>)> {
    let (mesh, mut random) = (mesh(), Random(64));
    let all = (0..2 * count).filter_map(move |_| {
        let scene = scene(&mut random);
        let (arrangement, arms) = arranged(&mesh, &scene)?;
        Some((scene, arrangement, arms))
    });
    all.take(count)
}

fn used(arrangement: &Arrangement) -> BTreeSet<usize> {
    let chains = arrangement.chains.values().flatten();
    chains
        .flat_map(|chain| &chain.vertices)
        .map(|v| v.vertex)
        .collect()
}

/// Goal: vertices are apart by δ, or by δ/30 where a crack crosses an edge beside a node or another crack; seen from a segment that is
/// not its own a crossing lies as far away but for the slope of that. Abscissas rise. All regions fit their cells.
#[test]
fn features_are_one_or_apart() {
    let mesh = mesh();
    let least = DELTA / 30.0 * mesh.smallest_edge() * (1.0 - 1e-6);
    let mut enriched = 0;
    for (scene, arrangement, arms) in scenes(150) {
        let places = used(&arrangement);
        let at = |v: &usize| arrangement.vertices[*v].x;
        for chain in arrangement.chains.values().flatten() {
            assert!(chain.range[0] < chain.range[1], "{scene:?}");
            for w in chain.vertices.windows(2) {
                assert!(norm(&sub(&w[0].x, &w[1].x)) >= least, "{scene:?}");
                for v in places
                    .iter()
                    .filter(|v| w.iter().all(|own| own.vertex != **v))
                {
                    let away = segment_distance(&at(v), &w[0].x, &w[1].x);
                    assert!(away >= 0.1 * least, "{away:e}: {:?} {w:?} {scene:?}", at(v));
                }
            }
        }
        let placed = (arms.as_slice(), arrangement);
        let found = Enrichment::new(&mesh, &mesh.lengths(), placed, &Default::default());
        enriched += usize::from(found.is_ok());
    }
    println!("enriched {enriched} of 150");
    assert!(enriched > 130, "{enriched}");
}

/// Goal: what was arranged is arranged: its own output moves by nothing.
#[test]
fn an_arrangement_of_its_own_output_moves_nothing() {
    let mesh = mesh();
    for (scene, _, arms) in scenes(150) {
        let again: Scene = (0..scene.len())
            .map(|k| {
                let own: Vec<&Crack> = arms.iter().filter(|arm| arm.number == k).collect();
                let first = own.iter().take(1).map(|arm| arm.path[0].x);
                let others = own.iter().flat_map(|arm| arm.path[1..].iter().map(|v| v.x));
                first.chain(others).map(|x| [x[0], x[1]]).collect()
            })
            .collect();
        let (found, _) = arranged(&mesh, &again).unwrap();
        let far = (found.moved.iter()).map(|m| norm(&sub(&m.from, &m.to)) / mesh.smallest_edge());
        assert!(
            far.fold(0.0, f64::max) < 1e-12,
            "{:?} {scene:?}",
            found.moved
        );
    }
}

/// What a graph is, wherever it lies: places of its vertices with what they lie on, ways through cells and along edges, tips.
fn graph(arrangement: &Arrangement, map: impl Fn(&Point) -> [f64; 2]) -> Vec<(u8, [i64; 2])> {
    let round = |x: &Point| map(x).map(|v| (v * 1e9).round() as i64);
    let of_vertex = |v: usize| {
        let vertex = &arrangement.vertices[v];
        let kind = match vertex.on {
            On::Node(_) => 0,
            On::Edge(_) => 1,
            On::Cell(_) => 2,
            On::Outside => 3,
        };
        (kind, round(&vertex.x))
    };
    let mut all: Vec<(u8, [i64; 2])> = used(arrangement).into_iter().map(of_vertex).collect();
    for chain in arrangement.chains.values().flatten() {
        let [x, y] = [0, 1].map(|a| {
            let own = chain.vertices.iter();
            own.map(|v| map(&v.x)[a]).sum::<f64>() / chain.vertices.len() as f64
        });
        all.push((4 + u8::from(chain.along.is_some()), round_pair([x, y])));
    }
    all.extend(arrangement.tips.iter().map(|tip| (6, round(&tip.x))));
    all.sort_unstable();
    all
}

fn round_pair(x: [f64; 2]) -> [i64; 2] {
    x.map(|v| (v * 1e9).round() as i64)
}

/// Where a point goes.
type Motion = fn(f64, f64) -> [f64; 2];

/// Goal: a body mirrored, turned, its cracks renumbered and read backwards has the same graph.
#[test]
fn the_graph_is_that_of_the_body_however_it_is_told() {
    let mesh = mesh();
    let moves: [(&str, Motion, Motion); 3] = [
        ("mirrored", |x, y| [-x, y], |x, y| [-x, y]),
        ("swapped", |x, y| [y, x], |x, y| [y, x]),
        ("turned", |x, y| [-y, x], |x, y| [y, -x]),
    ];
    let same = |a: &[(u8, [i64; 2])], b: &[(u8, [i64; 2])]| {
        // Rounding may put one place beside another of the same kind.
        let near = |p: &(u8, [i64; 2]), q: &(u8, [i64; 2])| {
            p.0 == q.0 && (0..2).all(|k| p.1[k].abs_diff(q.1[k]) <= 1)
        };
        a.len() == b.len() && a.iter().all(|p| b.iter().any(|q| near(p, q)))
    };
    for (scene, arrangement, _) in scenes(100) {
        let right = graph(&arrangement, |x| [x[0], x[1]]);
        for (name, there, back) in moves {
            let moved = scene
                .iter()
                .map(|c| c.iter().map(|p| there(p[0], p[1])).collect());
            let (found, _) = arranged(&mesh, &moved.collect()).unwrap();
            let found = graph(&found, |x| back(x[0], x[1]));
            assert!(same(&right, &found), "{name} {scene:?}");
        }
        let mut renumbered = scene.clone();
        renumbered.reverse();
        let backwards = scene.iter().map(|c| c.iter().rev().copied().collect());
        for other in [renumbered, backwards.collect()] {
            let (found, _) = arranged(&mesh, &other).unwrap();
            let found = graph(&found, |x| [x[0], x[1]]);
            assert!(same(&right, &found), "renumbered or backwards {scene:?}");
        }
    }
}
