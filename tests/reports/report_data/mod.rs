//! Made-up results of realistic shape and size: a plate with a crack at 45 degrees, a beam in two halves.

// Every test program uses a part of this.
#![allow(dead_code)]

pub mod figures;

use stickslip::model::field_mesh::*;
use stickslip::model::quantities::{PointState, Quantity};
use stickslip::run::judged::{Seconds, Work};
use stickslip::run::verdict::Verdict;
use stickslip::studies::analysis::success::{FAILURES, SuccessRow};
use stickslip::studies::measure::Answer;
use stickslip::studies::origin::Origin;
use stickslip::studies::record::{Found, Judge, ProblemSize, Record, Spent, Step};
use stickslip::studies::results::Results;
use stickslip::studies::rows::*;
use stickslip::studies::task::{Asked, Looks};

pub const METHODS: [&str; 4] = ["augmented-lagrangian", "b-newton", "latin", "penalty"];
pub const FRICTIONS: [f64; 3] = [0.1, 0.8, 1.2];
/// Half length of the crack over √2, and of the plate [m].
const CRACK: f64 = 4.8;
const PLATE: f64 = 10.0;
const CELLS: usize = 22;

pub fn key(method: &str, friction: f64) -> RunKey {
    RunKey {
        case: "plate_mesh1".into(),
        mesh: "22x22".into(),
        space: "edge-pairs".into(),
        method: method.into(),
        friction,
        increment: 1,
    }
}

/// Rows of all methods of the registry for one friction coefficient.
pub fn results_of_all_methods() -> Results {
    let mut results = Results::default();
    for method in stickslip::run::registry::methods().iter().rev() {
        add_run(&mut results, key(method.name, 0.1));
    }
    results
}

/// All rows, in an order that is not the sorted one.
pub fn results() -> Results {
    let mut results = Results::default();
    for friction in FRICTIONS {
        for method in METHODS.iter().rev() {
            add_run(&mut results, key(method, friction));
        }
    }
    let step = plate_step();
    let half = FieldStep {
        time: 0.5,
        ..step.clone()
    };
    let mut runs = results.answers.iter_mut();
    let own = runs.find(|own| own.record.found.method == "b-newton");
    own.expect("a run").fields = vec![half, step];
    results
}

/// An increment that is solved at once.
pub fn solved(increment: usize) -> Step {
    Step {
        increment,
        verdict: Verdict::Solved,
        iterations: 0,
        solves: 0,
        tangent_factorisations: 0,
        global_factorisations: 0,
        local_solves: 0,
        judge: Judge::of(None),
        overlap_m: f64::NAN,
        state_changes: 0,
        final_changes: 0,
        states: [0; 3],
        quantities: Vec::new(),
    }
}

/// A run that was asked for 1e-9.
pub fn answer(key: &RunKey, increments: Vec<Step>) -> Answer {
    let asked = Asked {
        case: key.case.clone(),
        refine: 1,
        friction: vec![key.friction],
        increments: 1,
        method: key.method.clone(),
        tolerance: 1e-9,
        ..Asked::default()
    };
    let solve = Seconds {
        total_s: 4.567_891e-4,
        enforcement_s: 1.234e-4,
        ..Seconds::default()
    };
    let work = Work {
        factorisations: 1,
        factorisation_s: 0.002_345_678,
        condensation_s: 0.000_345_678_9,
        prepare_s: 1.234e-5,
        solve,
        traction: false,
    };
    let verdict = increments.last().expect("an increment").verdict.clone();
    let exact = stickslip::run::registry::method(&key.method).is_some_and(|own| own.exact);
    let found = Found {
        problem: Some(ProblemSize {
            mesh: key.mesh.clone(),
            space: key.space.clone(),
            dofs: 1016,
            points: 11,
            unknowns: 22,
            uniform_stress: 2e-15,
            ..ProblemSize::default()
        }),
        increments,
        ..Found::only(verdict, key.method.clone(), exact)
    };
    let record = Record {
        id: asked.id(),
        asked,
        class: String::new(),
        looks: Looks::default(),
        origin: Origin::here(),
        limits: None,
        found,
        spent: Spent::of([0.000_123_45, 0.001_234_567], &[work]),
        beside: None,
    };
    Answer {
        record,
        histories: Vec::new(),
        points: Vec::new(),
        fields: Vec::new(),
        jumps: Vec::new(),
        solution: None,
    }
}

fn add_run(results: &mut Results, key: RunKey) {
    let (iterations, rate) = match key.method.as_str() {
        "b-newton" => (6, 1e-2),
        "latin" => (160, 0.86),
        "penalty" => (9, 0.04),
        _ => (34, 0.5),
    };
    let wobble = |i: usize| 1.0 + 0.3 * (i as f64 * 1.7).sin();
    let residual = |i: usize| 0.4 * f64::powi(rate, i as i32) * wobble(i);
    let reaction = |(component, value): (&str, f64)| Quantity {
        unit: "N/m".into(),
        ..Quantity::new(["reaction", "top", component], value, 2)
    };
    let step = Step {
        iterations,
        solves: iterations + 12,
        tangent_factorisations: 3,
        local_solves: 33,
        judge: Judge {
            natural_map: residual(iterations),
            violation: residual(iterations),
            equilibrium: 3.2e-14,
            claimed_equilibrium: 3.2e-14,
            claimed: residual(iterations),
            penetration: 0.5 * residual(iterations),
            adhesion: 0.0,
            complementarity: 0.1 * residual(iterations),
            cone: 0.0,
            reference_force: 1e8,
            reference_jump_m: 0.1,
            sway: 12.5,
        },
        overlap_m: 1.5e-7,
        quantities: [("y", -973_543_210.987_65), ("x", -0.0)]
            .map(reaction)
            .into(),
        ..solved(1)
    };
    results.answers.push(Answer {
        histories: vec![(0..=iterations).map(residual).collect()],
        points: vec![points(&key.method, key.friction)],
        ..answer(&key, vec![step])
    });
    results.expectations.push(ExpectRow {
        key,
        quantity: "reaction".into(),
        at: "top".into(),
        component: "y".into(),
        expected: -973.3e6,
        found: -973.543e6,
        allowed: 973.3e3,
        unit: "N/m".into(),
        kind: "published".into(),
        source: "Table 1, \"Mesh I\"; printed 50 % too, small".into(),
        verdict: "met".into(),
    });
}

/// Rates of all methods in both dimensions, some below 100 %, one method declining everything in 2D.
pub fn rates() -> Vec<SuccessRow> {
    let mut rows = Vec::new();
    for (place, class) in ["2d", "3d", "disks", "spheres"].into_iter().enumerate() {
        for (index, method) in stickslip::run::registry::methods().iter().enumerate() {
            let correct = match (index + place) % 8 {
                6 => 7000,
                7 => 7997,
                _ => 8000,
            };
            let mut failures = [0; FAILURES.len()];
            failures[2] = 8000 - correct;
            rows.push(SuccessRow {
                class: class.into(),
                method: method.name.into(),
                exact: method.exact,
                defaults: true,
                tier: stickslip_methods::Tier::High,
                cells: 8000,
                claimed: correct,
                correct,
                several: 0,
                failures,
                iterations: [5.0, 8.0, 9.0],
            });
        }
    }
    rows
}

/// 11 points along the crack: the left end open, the middle slipping, the right end sticking.
pub fn points(method: &str, friction: f64) -> Vec<PointState> {
    let length = CRACK * 2f64.sqrt() * 2.0;
    let point = |i: usize| {
        let s = length * (i as f64 + 0.5) / 11.0;
        let shift = METHODS.iter().position(|m| *m == method).unwrap_or(0) as f64;
        let bump = (s * (length - s)).sqrt() / length;
        let pressure = if i < 2 {
            0.0
        } else {
            2.6e7 * (1.0 + 0.3 * bump) * (1.0 + 1e-3 * shift)
        };
        let status = match i {
            0 | 1 => "open",
            2..=8 => "slip",
            _ => "stick",
        };
        let sliding = if status == "stick" { 0.8 } else { 1.0 };
        PointState {
            crack: 1,
            number: i + 1,
            x_m: -CRACK + s / 2f64.sqrt(),
            y_m: -CRACK + s / 2f64.sqrt(),
            z_m: 0.0,
            s_m: s,
            weight: length / 11.0,
            gap_m: if i < 2 { 2e-4 } else { 1e-19 },
            slip_a_m: if status == "stick" {
                0.0
            } else {
                0.07 * bump * (1.2 - friction / 2.0)
            },
            slip_b_m: 0.0,
            p_n: pressure * length / 11.0,
            p_a: -sliding * friction * pressure * length / 11.0,
            p_b: 0.0,
            force_unit: "N/m".into(),
            status: status.into(),
        }
    };
    (0..11).rev().map(point).collect()
}

/// Displacement of a compressed plate whose crack slips; `side` is +1 above and left of the crack.
fn displacement(x: f64, y: f64, side: f64) -> [f64; 3] {
    let (along, off) = ((x + y) / 2f64.sqrt(), (y - x) / 2f64.sqrt());
    let half = CRACK * 2f64.sqrt();
    let inside = (1.0 - (along / half).powi(2)).max(0.0).sqrt();
    let slip = -0.02 * inside * side * (-off.abs() / half).exp();
    let fixed = (1.0 - (y / PLATE).powi(2)).max(0.0);
    let lateral = 0.006 * (x / PLATE) * fixed;
    let shear = slip / 2f64.sqrt() * fixed;
    [lateral + shear, -0.05 * (y + PLATE) / PLATE + shear, 0.0]
}

/// 22 × 22 squares, those on the crack split along the diagonal, nodes inside the crack doubled.
pub fn plate() -> FieldMesh {
    let mut picture = FieldMesh {
        dim: 2,
        ..FieldMesh::default()
    };
    let mut u = Vec::new();
    let mut stress = Vec::new();
    let at = |i: usize| -PLATE + 2.0 * PLATE * i as f64 / CELLS as f64;
    let cracked = |i: usize| at(i).abs() < CRACK;
    for j in 0..=CELLS {
        for i in 0..=CELLS {
            let side = if j >= i { 1.0 } else { -1.0 };
            picture.points.push([at(i), at(j), 0.0]);
            u.push(displacement(at(i), at(j), side));
        }
    }
    let node = |i: usize, j: usize| j * (CELLS + 1) + i;
    let mut twins = vec![None; CELLS + 1];
    for i in (0..=CELLS).filter(|i| cracked(*i)) {
        twins[i] = Some(picture.points.len());
        picture.points.push([at(i), at(i), 0.0]);
        u.push(displacement(at(i), at(i), -1.0));
    }
    // Nodes of the crack as seen from below.
    let below = |i: usize, j: usize| {
        if i == j {
            twins[i].unwrap_or(node(i, j))
        } else {
            node(i, j)
        }
    };
    for j in 0..CELLS {
        for i in 0..CELLS {
            let mut add = |shape, points| {
                picture.cells.push(FieldCell { shape, points });
                stress.push(1e8 + 1e6 * (i * j) as f64);
            };
            let crossed = i == j && (cracked(i) || cracked(i + 1));
            if crossed {
                let upper = vec![node(i, j), node(i + 1, j + 1), node(i, j + 1)];
                let lower = vec![below(i, j), node(i + 1, j), below(i + 1, j + 1)];
                add(CellShape::Triangle, upper);
                add(CellShape::Triangle, lower);
            } else {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                let pick = |(a, b)| if i > j { below(a, b) } else { node(a, b) };
                add(CellShape::Quad, corners.map(pick).to_vec());
            }
        }
    }
    let sides = picture
        .points
        .iter()
        .map(|p| if p[1] >= p[0] { 1.0 } else { 2.0 })
        .collect();
    picture.point_vectors.push(("displacement_m".into(), u));
    picture.point_scalars.push(("side".into(), sides));
    picture.cell_scalars.push(("von_mises_pa".into(), stress));
    picture
}

/// The crack as a line of segments with contact fields.
pub fn crack_line() -> FieldMesh {
    let rows = points("b-newton", 0.1);
    let mut picture = FieldMesh {
        dim: 2,
        ..FieldMesh::default()
    };
    for row in rows.iter().rev() {
        picture.points.push([row.x_m, row.y_m, 0.0]);
    }
    for i in 1..rows.len() {
        picture.cells.push(FieldCell {
            shape: CellShape::Line,
            points: vec![i - 1, i],
        });
    }
    let scalar = |of: &dyn Fn(&PointState) -> f64| rows.iter().rev().map(of).collect::<Vec<f64>>();
    let status = |row: &PointState| match row.status.as_str() {
        "open" => 0.0,
        "stick" => 1.0,
        _ => 2.0,
    };
    picture
        .point_scalars
        .push(("gap_m".into(), scalar(&|row| row.gap_m)));
    picture
        .point_scalars
        .push(("p_n".into(), scalar(&|row| row.p_n)));
    picture
        .point_scalars
        .push(("status".into(), scalar(&status)));
    picture
}

/// The plate with its crack.
pub fn plate_step() -> FieldStep {
    FieldStep {
        time: 1.0,
        body: plate(),
        crack: crack_line(),
    }
}

/// 6 × 18 × 10 bricks of a beam 2 × 6 × 3 m, the two halves apart at mid-height, bent downwards and twisted.
pub fn beam() -> FieldMesh {
    let cells = [6, 18, 10];
    let size = [2.0, 6.0, 3.0];
    let mut picture = FieldMesh {
        dim: 3,
        ..FieldMesh::default()
    };
    let mut u = Vec::new();
    let half = cells[2] / 2;
    // Levels of nodes: mid-height appears twice.
    let levels: Vec<usize> = (0..=half).chain(half..=cells[2]).collect();
    for (level, k) in levels.iter().enumerate() {
        for j in 0..=cells[1] {
            for i in 0..=cells[0] {
                let index = [i, j, *k];
                let x: [f64; 3] =
                    std::array::from_fn(|c| size[c] * index[c] as f64 / cells[c] as f64);
                let upper = level > half;
                let t = (x[1] / size[1]).powi(2);
                let slide = if upper { 3e-4 * x[1] / size[1] } else { 0.0 };
                picture.points.push(x);
                u.push([
                    -1.7e-3 * t,
                    0.4e-3 * t * (x[2] - 1.5) + slide,
                    -1.4e-3 * t * (1.0 + 0.1 * x[0]),
                ]);
            }
        }
    }
    let node = |i: usize, j: usize, level: usize| (level * (cells[1] + 1) + j) * (cells[0] + 1) + i;
    for level in (0..levels.len() - 1).filter(|level| *level != half) {
        for j in 0..cells[1] {
            for i in 0..cells[0] {
                let ring = |l: usize| {
                    [
                        node(i, j, l),
                        node(i + 1, j, l),
                        node(i + 1, j + 1, l),
                        node(i, j + 1, l),
                    ]
                };
                let points = ring(level).into_iter().chain(ring(level + 1)).collect();
                picture.cells.push(FieldCell {
                    shape: CellShape::Hexahedron,
                    points,
                });
            }
        }
    }
    picture.point_vectors.push(("displacement_m".into(), u));
    // 100 to 400 kPa along the beam, 2 MPa in one of its 1080 cells, at a corner.
    let stress = picture.cells.iter().map(|cell| {
        let x = picture.points[cell.points[0]];
        1e5 + 5e4 * x[1]
    });
    let mut stress: Vec<f64> = stress.collect();
    stress[0] = 2e6;
    picture.cell_scalars.push(("von_mises_pa".into(), stress));
    picture
}

/// The beam with its crack at mid-height: open, sticking and sliding along y from end to end.
pub fn beam_step() -> FieldStep {
    let cells = [6, 18];
    let mut crack = FieldMesh {
        dim: 3,
        ..FieldMesh::default()
    };
    let (mut jump, mut traction, mut status) = (Vec::new(), Vec::new(), Vec::new());
    for j in 0..=cells[1] {
        for i in 0..=cells[0] {
            let y = 6.0 * j as f64 / cells[1] as f64;
            crack
                .points
                .push([2.0 * i as f64 / cells[0] as f64, y, 1.5]);
            jump.push([0.0, 3e-4 * y / 6.0, if j < 6 { 1e-4 } else { 0.0 }]);
            traction.push([0.0, -1e5, 1e6]);
            status.push([0.0, 1.0, 2.0][j / 7]);
        }
    }
    let node = |i: usize, j: usize| j * (cells[0] + 1) + i;
    for j in 0..cells[1] {
        for i in 0..cells[0] {
            crack.cells.push(FieldCell {
                shape: CellShape::Polygon,
                points: vec![
                    node(i, j),
                    node(i + 1, j),
                    node(i + 1, j + 1),
                    node(i, j + 1),
                ],
            });
        }
    }
    crack.point_vectors.push(("jump_m".into(), jump));
    let tractions = ("contact_traction_pa".into(), traction);
    crack.point_vectors.push(tractions);
    crack.point_scalars.push(("status".into(), status));
    FieldStep {
        time: 1.0,
        body: beam(),
        crack,
    }
}

/// A closed form along the crack of [`points`].
pub fn exact(friction: f64) -> Vec<ExactPoint> {
    let length = CRACK * 2f64.sqrt() * 2.0;
    let row = |i: usize| {
        let s = length * i as f64 / 40.0;
        let pressure = 2.6e7 * (1.0 + 0.3 * (s * (length - s)).max(0.0).sqrt() / length);
        let key = RunKey {
            mesh: String::new(),
            space: String::new(),
            ..key("exact", friction)
        };
        let point = PointState {
            x_m: -CRACK + s / 2f64.sqrt(),
            y_m: -CRACK + s / 2f64.sqrt(),
            s_m: s,
            weight: 1.0,
            gap_m: 0.0,
            slip_a_m: 0.07 * (s * (length - s)).max(0.0).sqrt() / length,
            p_n: pressure,
            p_a: -friction * pressure,
            ..points("exact", friction)[0].clone()
        };
        ExactPoint { key, point }
    };
    (0..=40).rev().map(row).collect()
}

/// Mean slip and contact force over a cycle of 12 increments that turns back after the fourth and the eighth, by two exact
/// methods and a third that ends early: shear up to 3 kN/m in the first two increments, then slip of 1 mm in two more.
pub fn cycle() -> Results {
    let path = [
        [0.0, 1.5e3],
        [0.0, 3e3],
        [5e-4, 3e3],
        [1e-3, 3e3],
        [1e-3, 0.0],
        [1e-3, -3e3],
        [5e-4, -3e3],
        [0.0, -3e3],
        [0.0, 3e3],
        [1e-3, 3e3],
        [1e-3, -3e3],
        [0.0, -3e3],
    ];
    let mut results = Results::default();
    for (method, count) in [("latin", 12), ("b-newton", 12), ("nsgs", 7)] {
        let quantity = |name: &str, value: f64, unit: &str| Quantity {
            unit: unit.into(),
            ..Quantity::new([name, "crack-1", "a"], value, 2)
        };
        let path = path.iter().take(count).enumerate();
        let steps = path.map(|(index, [slip, shear])| Step {
            // The force on side 1 opposes what shears it.
            quantities: vec![
                quantity("mean_slip", *slip, "m"),
                quantity("contact_force", -shear, "N/m"),
            ],
            ..solved(index + 1)
        });
        results
            .answers
            .push(answer(&key(method, 0.3), steps.collect()));
    }
    results
}
