//! Delassus operators that are not symmetric, or not semi-definite: solved as they stand, or refused with the reason.

use crate::toys::*;
use stickslip_methods::*;

/// W = Mᵀ M/m + I/5 plus `skew` times an antisymmetric matrix of the same size: x·W x does not see the latter.
fn skewed(rng: &mut Random, m: usize, skew: f64) -> Rows {
    let a: Rows = (0..m).map(|_| rng.vector(m)).collect();
    let c: Rows = (0..m).map(|_| rng.vector(m)).collect();
    let entry = |i: usize, j: usize| {
        let square: f64 = (0..m).map(|k| a[k][i] * a[k][j]).sum::<f64>() / m as f64;
        square + if i == j { 0.2 } else { 0.0 } + skew * (c[i][j] - c[j][i])
    };
    (0..m)
        .map(|i| (0..m).map(|j| entry(i, j)).collect())
        .collect()
}

/// The same numbers as a general matrix.
fn square(w: &Rows) -> SquareMatrix {
    let m = w.len();
    let values = (0..m).flat_map(|j| w.iter().map(move |row| row[j]));
    let (ends, rows) = ((0..=m).map(|j| j * m), (0..m * m).map(|k| k % m));
    SquareMatrix::general(m, ends.collect(), rows.collect(), values.collect()).unwrap()
}

fn transposed(w: &Rows) -> Rows {
    (0..w.len())
        .map(|i| w.iter().map(|row| row[i]).collect())
        .collect()
}

fn body(dim: usize, w: &Rows) -> std::sync::Arc<Elastic> {
    Elastic::from_delassus(dim, square(w), vec![]).unwrap()
}

/// Methods that take any W.
fn takers() -> impl Iterator<Item = Candidate> {
    all().filter(|m| build(m, &[]).needs().operator == OperatorKind::Any)
}

/// Source: every state of every point tried. Tolerance: the accuracy that the method was asked for, times a condition of 100.
#[test]
fn the_only_solution_is_found_row_by_row() {
    let mut rng = Random(17);
    let mut compared = 0;
    for _ in 0..20 {
        let w = skewed(&mut rng, 8, 0.15);
        let q: Vec<f64> = (rng.vector(8).iter().enumerate())
            .map(|(k, q)| q - if k % 2 == 0 { 0.7 } else { 0.0 })
            .collect();
        let mu = 0.4;
        let (exact, mirrored) = (enumerate(&w, &q, mu), enumerate(&transposed(&w), &q, mu));
        let ([exact], [mirrored]) = (&exact[..], &mirrored[..]) else {
            continue;
        };
        // Rows taken for columns would show.
        if difference(exact, mirrored) < 1e-2 {
            continue;
        }
        compared += 1;
        let body = body(2, &w);
        let s = system(&body, mu);
        for (m, outcome) in claims(takers(), &s, &free_jump(&q), 1e-9) {
            let found = difference(&outcome.state.p, exact);
            let most = 100.0 * m.accuracy;
            assert!(found <= most, "{}: {found:e}", m.name);
        }
    }
    assert!(compared >= 10, "{compared}");
}

/// In space, and with rigid motions: the judge takes W itself.
#[test]
fn space_and_floating_bodies_are_solved_as_the_judge_sees_them() {
    let mut rng = Random(23);
    let m = 15;
    let w = skewed(&mut rng, m, 0.1);
    // One motion that opens all points, and one that shears them.
    let lift: Vec<f64> = (0..m).map(|k| f64::from(u8::from(k % 3 == 0))).collect();
    let shear: Vec<f64> = (0..m).map(|k| f64::from(u8::from(k % 3 == 1))).collect();
    for motions in [vec![], vec![lift, shear]] {
        let body = Elastic::from_delassus(3, square(&w), motions.clone()).unwrap();
        let s = system(&body, 0.4);
        let q: Vec<f64> = rng.vector(m);
        // Pressed together, and sheared by less than friction holds.
        let press = |k: usize| [-1.0, 0.1, 0.0][k % 3];
        let load = match motions.len() {
            0 => free_jump(&q.iter().map(|q| q - 0.5).collect::<Vec<_>>()),
            _ => load((0..m).map(press).collect(), q),
        };
        for (candidate, outcome) in claims(takers(), &s, &load, 1e-9) {
            let at = (candidate.name, motions.len());
            let found = judge(&s, &load, &outcome.state);
            let (held, most) = (found.violation, candidate.accuracy.max(1e-9));
            assert!(
                held <= most && found.equilibrium <= 1e-12,
                "{at:?}: {found:?}"
            );
            assert!(outcome.state.p.iter().any(|&p| p != 0.0), "{at:?}");
        }
    }
}

/// Source: the same numbers held as a full matrix, which explicit zeros make of them. Tolerance: the accuracy that the method was asked
/// for, times the condition. A chain of 70 points in space, some without friction, held and floating.
#[test]
fn an_operator_of_few_entries_is_solved_as_a_full_one() {
    let (mut rng, m) = (Random(29), 210);
    let mut chain = skewed(&mut rng, m, 0.01);
    for (i, row) in chain.iter_mut().enumerate() {
        // Points beside each other alone: diagonally dominant.
        let far = |j: usize| (i / 3).abs_diff(j / 3) > 1;
        (0..m).filter(|j| far(*j)).for_each(|j| row[j] = 0.0);
        row[i] += 3.0;
    }
    let entries = |j: usize| (0..m).filter(move |i| (i / 3).abs_diff(j / 3) <= 1);
    let rows: Vec<usize> = (0..m).flat_map(entries).collect();
    let values = (0..m).flat_map(|j| entries(j).map(move |i| (i, j)));
    let values = values.map(|(i, j)| chain[i][j]).collect();
    let ends = (0..m).map(|j| entries(j).count()).scan(0, |end, count| {
        *end += count;
        Some(*end)
    });
    let few =
        SquareMatrix::general(m, std::iter::once(0).chain(ends).collect(), rows, values).unwrap();
    let lift: Vec<f64> = (0..m).map(|k| f64::from(u8::from(k % 3 == 0))).collect();
    let q: Vec<f64> = rng.vector(m).iter().map(|q| q - 0.3).collect();
    for motions in [vec![], vec![lift]] {
        let press: Vec<f64> = (0..m).map(|k| [-0.4, 0.1, 0.0][k % 3]).collect();
        let load = load(press, q.clone());
        let [few, full] = [few.clone(), square(&chain)].map(|w| {
            let body = Elastic::from_delassus(3, w, motions.clone()).unwrap();
            let mu = (0..70).map(|i| [0.4, 0.0, 0.7][i % 3]).collect();
            ContactSystem::new(body, mu).unwrap()
        });
        let mut compared = 0;
        for (m, outcome) in claims(takers(), &few, &load, 1e-9) {
            let full = run(&m, &m.given, &full, &load, 1e-9);
            let found = difference(&outcome.state.p, &full.state.p);
            assert!(found <= 1e3 * m.accuracy, "{}: {found:e}", m.name);
            let held = judge(&few, &load, &outcome.state).violation;
            assert!(held <= m.accuracy.max(1e-9), "{}: {held:e}", m.name);
            compared += 1;
        }
        assert!(compared >= 10, "{compared}");
    }
}

/// The solution with the symmetric part of W does not pass for one with W.
#[test]
fn the_judge_does_not_take_the_symmetric_part_for_w() {
    let mut rng = Random(3);
    let w = skewed(&mut rng, 12, 1e-3);
    let mean = |i: usize, j: usize| 0.5 * (w[i][j] + w[j][i]);
    let part: Rows = (0..12)
        .map(|i| (0..12).map(|j| mean(i, j)).collect())
        .collect();
    let load = free_jump(&rng.vector(12).iter().map(|q| q - 0.5).collect::<Vec<_>>());
    let symmetric = Elastic::from_delassus(3, sparse(&part), vec![]).unwrap();
    let newton = method("newton-ac").unwrap();
    let outcome = solved(newton, &[], &system(&symmetric, 0.4), &load, 1e-12).unwrap();
    let given = body(3, &w);
    let s = system(&given, 0.4);
    // Displacements of W for these forces, so that equilibrium holds.
    let mut u = outcome.state.p.clone();
    given.solve(&mut u).unwrap();
    let p = outcome.state.p;
    let found = judge(&s, &load, &ContactState { u, p }).violation;
    assert!((1e-5..1e-2).contains(&found), "{found:e}");
}

#[test]
fn what_a_method_needs_of_w_is_the_reason_of_its_refusal() {
    let mut rng = Random(8);
    let w = skewed(&mut rng, 6, 1e-3);
    let unsymmetric = body(3, &w);
    let mut indefinite = diagonal(&[1.0; 6]);
    (indefinite[0][1], indefinite[1][0]) = (1.5, 1.5);
    let indefinite = Elastic::from_delassus(3, sparse(&indefinite), vec![]).unwrap();
    let relative = square(&w).asymmetry();
    assert_eq!(unsymmetric.asymmetry(), relative);
    for (body, why) in [
        (unsymmetric, format!("W is unsymmetric by {relative:.1e} relative, the method needs a symmetric W")),
        (indefinite, "W has an eigenvalue below -1e-9 of its largest entry, the method needs a positive semi-definite W".into()),
    ] {
        let s = system(&body, 0.3);
        let mut refused = Vec::new();
        for m in general() {
            let solver = build(&m, &[]);
            match solver.refuses(&s) {
                None => assert_eq!(solver.needs().operator, OperatorKind::Any, "{}", m.name),
                Some(reason) => {
                    assert_eq!(reason, why, "{}", m.name);
                    refused.push(m.name);
                }
            }
        }
        // They minimise.
        assert!(refused.contains(&"socp") && refused.contains(&"tresca"), "{refused:?}");
        assert!(refused.len() < general().count());
    }
}

/// W of redundant points has eigenvalues 0, and rounding may leave them below.
#[test]
fn rounding_does_not_make_w_indefinite() {
    let singular = |i: usize, j: usize| {
        f64::from(u8::from(i % 2 == j % 2)) * (1.0 + 1e-13 * i as f64 * j as f64)
    };
    let w: Rows = (0..8)
        .map(|i| {
            (0..8)
                .map(|j| singular(i, j) - if i == j { 1e-12 } else { 0.0 })
                .collect()
        })
        .collect();
    let body = Elastic::from_delassus(2, sparse(&w), vec![]).unwrap();
    assert!(!body.indefinite());
    let empty = Elastic::from_delassus(2, sparse(&diagonal(&[0.0; 4])), vec![]).unwrap();
    assert!(!empty.indefinite());
}

#[test]
fn the_local_form_takes_an_unsymmetric_operator_as_it_is_and_no_stiffness_does() {
    let w = skewed(&mut Random(4), 4, 0.1);
    let s = ContactSystem::new(body(2, &w), vec![0.3; 2]).unwrap();
    let (load, start) = (Load::zero(s.elastic()), ContactState::zero(&s));
    let form = increment(&s, &load, &load, &start, 1e-9).local_form();
    assert_eq!(form.unwrap().w, square(&w));
    let parts = ElasticParts {
        stiffness: square(&w),
        ..parts(2, &w, &diagonal(&[1.0; 4]), vec![], false)
    };
    let error = Elastic::new(parts).err();
    assert_eq!(error, Some(MethodError::UnsymmetricStiffness));
}
