//! The discretisation: sub-cells, rigid motions, stiffness and jump operator.

use crate::common::bodies::{bodies, bodies_like, motion_of, motions};
use crate::common::*;
use nalgebra::{DMatrix, SymmetricEigen};
use stickslip::model::body::{Body, Needs};
use stickslip_xfem::enrichment::basis::FunctionKind;
use stickslip_xfem::enrichment::pieces::pieces;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Source: geometry. Goal: whatever the crack, the points of a cell measure the cell and lie on their side.
/// 3 × 3 m in 6 × 6 cells, evenly spaced, graded, and bent to follow a line; 30 random cracks each; 3D: 20 planes.
/// Tolerance: rounding of a few dozen positive weights.
#[test]
fn points_of_cut_cells_measure_the_cell_and_keep_their_side() {
    let mut random = Random(7);
    let meshes = [
        "mesh = { box = { min_m = [0, 0], max_m = [3, 3], cells = [6, 6] } }",
        "mesh = { lines_m = [[0, 0.1, 0.3, 0.7, 1.5, 3], [0, 1.4, 1.5, 1.52, 2, 3]] }",
        "mesh = { box = { min_m = [0, 0], max_m = [3, 3], cells = [6, 6] }, follow = { point_m = [1.5, 1.4], angle_deg = 20 } }",
    ];
    let mut cut = 0;
    for mesh in meshes {
        for _ in 0..30 {
            let p = [-1.0, random.between(0.2, 2.8)];
            let q = [4.0, random.between(0.2, 2.8)];
            let text = format!(
                "title = \"t\"\nmodel = \"plane-strain\"\nmaterial = {{ young_pa = 1, poisson = 0.3 }}\n{mesh}\n{}{}",
                crack(p, q, 0.0, "none"),
                clamped(2)
            );
            cut += check_points(&body(&text));
        }
    }
    for _ in 0..20 {
        let normal = [
            random.between(-1.0, 1.0),
            random.between(-1.0, 1.0),
            random.between(0.2, 1.0),
        ];
        let planes = [([1.5, 1.5, random.between(1.0, 2.0)], normal, 0.0)];
        let text = solid([3.0, 3.0, 3.0], [3, 3, 3], &planes, &clamped(3));
        cut += check_points(&body(&text));
    }
    assert!(cut > 500, "only {cut} cut cells were seen");
}

/// Checks all cut cells of a body and counts them.
fn check_points(body: &Body) -> usize {
    let integrator = body.integrator();
    let (mut cut, mut total, mut measure) = (0, 0.0, 1.0);
    for cell in 0..body.mesh.cell_count() {
        let points = integrator.points(cell).unwrap();
        let sum: f64 = points.iter().map(|p| p.weight).sum();
        total += sum;
        let Some(partition) = body.enrichment.partition(cell) else {
            continue;
        };
        cut += 1;
        let exact = stickslip_xfem::quadrature::measure(&body.mesh.map(cell));
        assert!((sum - exact).abs() < 1e-13 * exact, "{sum} {exact}");
        for p in &points {
            assert!(p.weight > 0.0);
            for &(crack, side) in &partition.parts[p.region].sides {
                assert!(body.cracks[crack].distance(&p.x) * side > -1e-12);
            }
        }
    }
    for side in 0..body.mesh.dim() {
        let line = body.mesh.nodes.iter().map(|x| x[side]);
        measure *= line.clone().fold(f64::MIN, f64::max) - line.fold(f64::MAX, f64::min);
    }
    assert!((total - measure).abs() < 1e-12 * measure);
    cut
}

/// Source: ε(r) = 0. Goal: the cut body and each of its pieces move rigidly without energy, and no more motions do.
/// Tolerance: energy relative to that of a random motion; rounding times the number of terms.
#[test]
fn rigid_motions_of_the_whole_and_of_every_piece_cost_no_energy() {
    let mut random = Random(11);
    for (name, body) in bodies(Needs::default()) {
        let dim = body.mesh.dim();
        let count = pieces(&body.mesh, &body.enrichment).extents.len();
        let expected = match name {
            "two cracks" | "two planes" => 3,
            "one tip" | "two tips" | "no tip" => 1,
            _ => 2,
        };
        assert_eq!(count, expected, "{name}");
        let noise = random.vector(body.numbers.len());
        let size = dot(&noise, &body.stiffness.mul(&noise)) / dot(&noise, &noise);
        for r in motions(dim) {
            for piece in 0..=count {
                // piece = count: the whole body
                let u = motion_of(&body, |p| piece == count || p == piece, &r);
                let force = body.stiffness.mul(&u);
                let worst = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
                assert!(worst < 1e-11 * size, "{name}, piece {piece}: {worst:e}");
                assert!(dot(&u, &force).abs() < 1e-11 * size * dot(&u, &u), "{name}");
                assert!(dot(&u, &u) > 0.5, "{name}: piece {piece} does not move");
            }
        }
    }
}

/// Source: linear elasticity. Goal: K is symmetric, positive semi-definite, and its kernel are the rigid motions of the
/// pieces and nothing else: no enriched function is redundant, and the mean dilatation of ν = 0.49 adds no motion.
/// Tolerance: with unit diagonal, eigenvalues are either rounding (1e-13) or at least 1e-7 for these cuts.
#[test]
fn the_kernel_of_the_stiffness_are_the_rigid_motions_of_the_pieces() {
    let mean = bodies_like(Needs::default(), |text| of_ratio(text, 0.49));
    for (name, body) in bodies(Needs::default()).into_iter().chain(mean) {
        let dim = body.mesh.dim();
        let n = body.numbers.len();
        if n > 400 {
            continue;
        }
        let mut k = DMatrix::zeros(n, n);
        for j in 0..n {
            let mut e = vec![0.0; n];
            e[j] = 1.0;
            k.set_column(j, &nalgebra::DVector::from_vec(body.stiffness.mul(&e)));
        }
        let asymmetry = (&k - k.transpose()).amax();
        assert!(asymmetry == 0.0, "{name}: {asymmetry:e}");
        let scale: Vec<f64> = (0..n).map(|i| 1.0 / k[(i, i)].sqrt()).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| k[(i, j)] * scale[i] * scale[j]);
        let values = SymmetricEigen::new(scaled).eigenvalues;
        let count = pieces(&body.mesh, &body.enrichment).extents.len();
        let zero = values.iter().filter(|v| v.abs() < 1e-11).count();
        assert_eq!(zero, count * if dim == 2 { 3 } else { 6 }, "{name}");
        let least = values
            .iter()
            .filter(|v| v.abs() >= 1e-11)
            .fold(1.0f64, |m, &v| m.min(v));
        assert!(least > 1e-7, "{name}: {least:e}");
    }
}

/// Source: [[u]] = u₁ − u₂. Goal: a continuous field has no jump; a piece on side 1 that moves jumps by its motion, one
/// on side 2 by the opposite, at every point and in every direction of its frame; the Heaviside coefficient is 2 N.
/// Tolerance: rounding.
#[test]
fn the_jump_operator_sees_relative_motion_and_nothing_else() {
    let mut random = Random(13);
    for (name, body) in bodies(Needs::default()) {
        let dim = body.mesh.dim();
        let mut u = vec![0.0; body.numbers.len()];
        let doubled = body.space == "node-pairs";
        // Equal values at the two nodes of a pair: a field of position.
        for (f, function) in body.enrichment.functions.iter().enumerate() {
            if function.kind == FunctionKind::Standard {
                for a in 0..dim {
                    let x = &body.mesh.nodes[function.node as usize];
                    u[f * dim + a] = if doubled {
                        (1.0 + a as f64 + 3.0 * x[0] - 7.0 * x[1]).sin()
                    } else {
                        random.between(-1.0, 1.0)
                    };
                }
            }
        }
        assert!(body.jump(&u).iter().all(|&j| j == 0.0), "{name}");
        for point in &body.points {
            let steps = |f: u32| {
                matches!(
                    body.enrichment.functions[f as usize].kind,
                    FunctionKind::Piece { .. }
                )
            };
            let sum: f64 = point
                .terms
                .iter()
                .filter(|t| steps(t.0))
                .map(|t| dot(&t.1[0], &point.frame[0]).abs())
                .sum();
            if point.terms.iter().all(|t| steps(t.0)) && !name.contains("tip") {
                assert!((sum - 2.0).abs() < 1e-13, "{name}: {sum}");
            }
        }
        let count = pieces(&body.mesh, &body.enrichment).extents.len();
        if count != 2 {
            continue;
        }
        let upper = upper_piece(&body);
        for r in motions(dim) {
            for (piece, sign) in [(upper, 1.0), (1 - upper, -1.0)] {
                let jump = body.jump(&motion_of(&body, |p| p == piece, &r));
                for (point, found) in body.points.iter().zip(jump.chunks_exact(dim)) {
                    for (axis, j) in point.frame.iter().zip(found) {
                        let exact = sign * dot(axis, &r(&point.x));
                        assert!((j - exact).abs() < 1e-12, "{name}: {j} {exact}");
                    }
                }
            }
        }
    }
}

/// Number of the piece on side 1 of the first crack, found at the node farthest from it on that side.
fn upper_piece(body: &Body) -> usize {
    let pieces = pieces(&body.mesh, &body.enrichment);
    let point = &body.points[0];
    let height = |n: usize| {
        let x = &body.mesh.nodes[n];
        (0..3)
            .map(|a| point.frame[0][a] * (x[a] - point.x[a]))
            .sum::<f64>()
    };
    let node = (0..body.mesh.nodes.len())
        .max_by(|&a, &b| height(a).total_cmp(&height(b)))
        .unwrap();
    pieces.of_node(node)
}

/// Source: virtual work. Goal: P·[[u]] = (Bᵀ P)·u for the operator the methods get and for the one over all unknowns;
/// contact forces on both sides together have no resultant and no moment, and on side 1 alone they are ΣP. Tolerance: rounding.
#[test]
fn contact_forces_do_the_work_of_the_jump_and_balance_themselves() {
    let mut random = Random(17);
    for (name, body) in bodies(Needs::default()) {
        let dim = body.mesh.dim();
        let p = random.vector(body.points.len() * dim);
        let u = random.vector(body.numbers.len());
        let force = contact_force(&body, &p);
        let (inner, outer) = (dot(&p, &body.jump(&u)), dot(&force, &u));
        assert!((inner - outer).abs() < 1e-12 * p.len() as f64, "{name}");
        let b = body.elastic.jump();
        let (free, mut back) = (random.vector(b.cols()), vec![0.0; b.cols()]);
        let mut jump = vec![0.0; b.rows()];
        b.mul(&free, &mut jump);
        b.mul_transpose_add(&p, &mut back);
        let (inner, outer) = (dot(&p, &jump), dot(&back, &free));
        assert!((inner - outer).abs() < 1e-12 * p.len() as f64, "{name}");
        for r in motions(dim) {
            let whole = dot(&force, &motion_of(&body, |_| true, &r));
            assert!(whole.abs() < 1e-12 * p.len() as f64, "{name}: {whole:e}");
        }
    }
}

/// Source: an enriched function with a sliver of support is small in both K and its diagonal.
/// Goal: scaled by its diagonal, K is as well conditioned for a cut at 1e-9 h as for one at 0.3 h.
/// Tolerance: a factor of 3 between the smallest eigenvalues.
#[test]
fn slivers_do_not_spoil_the_scaled_stiffness() {
    let least = |offset: f64| {
        let y = (4.0 + offset) * 0.2;
        let rest = crack([-0.1, y], [1.1, y], 10.0, "none")
            + &support("\"bottom\"", "[\"free\", 0]")
            + &support("[\"left\", \"bottom\"]", "[0, 0]")
            + &support("\"top\"", "[\"free\", -1e-3]");
        let body = body(&plane([0.0, 0.0], [1.0, 2.0], [5, 10], &rest));
        let k = body.elastic.stiffness().unwrap();
        let n = k.size();
        let mut dense = DMatrix::zeros(n, n);
        for j in 0..n {
            for e in k.col_ptr()[j]..k.col_ptr()[j + 1] {
                let i = k.row_idx()[e];
                let value = k.values()[e] / (k.diagonal(i) * k.diagonal(j)).sqrt();
                dense[(i, j)] = value;
                dense[(j, i)] = value;
            }
        }
        let mut values = SymmetricEigen::new(dense).eigenvalues.as_slice().to_vec();
        values.sort_by(f64::total_cmp);
        // The upper part slides along the crack and turns: motions only contact can stop.
        let floating = body.elastic.floating().len();
        assert!(values[..floating].iter().all(|v| v.abs() < 1e-12));
        values[floating]
    };
    let usual = least(0.3);
    for offset in [1e-2, 1e-4, 1e-6, 1e-9] {
        let found = least(offset);
        assert!(found > usual / 3.0, "{offset:e}: {found:e} {usual:e}");
    }
}
