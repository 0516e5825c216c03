//! The linear kernel on real elasticity: hex8 boxes with a crack patch of doubled nodes.

use std::collections::BTreeMap;

use crate::toys::*;
use stickslip_methods::*;

/// Stiffness of the unit cube, E = 1, ν = 0.3, 2 × 2 × 2 points; nodes in (x, y, z) binary order.
fn cube() -> Vec<[f64; 24]> {
    let (nu, g) = (0.3, 0.5 / 3.0_f64.sqrt());
    let (lame, shear) = (nu / (1.3 * 0.4), 0.5 / 1.3);
    let corner = |a: usize, k: usize| (a >> k & 1) as f64;
    let mut k = vec![[0.0; 24]; 24];
    for point in 0..8 {
        let x: Vec<f64> = (0..3)
            .map(|d| 0.5 + g * (2.0 * corner(point, d) - 1.0))
            .collect();
        let n = |a: usize, d: usize| (1.0 - corner(a, d)) + (2.0 * corner(a, d) - 1.0) * x[d];
        let slope = |a: usize, d: usize| {
            let others: f64 = (0..3).filter(|e| *e != d).map(|e| n(a, e)).product();
            (2.0 * corner(a, d) - 1.0) * others
        };
        for a in 0..8 {
            for b in 0..8 {
                let dot: f64 = (0..3).map(|d| slope(a, d) * slope(b, d)).sum();
                for i in 0..3 {
                    for j in 0..3 {
                        let same = if i == j { shear * dot } else { 0.0 };
                        k[3 * a + i][3 * b + j] += (lame * slope(a, i) * slope(b, j)
                            + shear * slope(a, j) * slope(b, i)
                            + same)
                            / 8.0;
                    }
                }
            }
        }
    }
    k
}

/// n × n × n cubes on a fixed bottom; grid nodes of the mid-plane within `patch` of its centre are doubled and form
/// the contact points (n = z).
fn cracked_box(n: usize, patch: usize, floating: bool) -> ElasticParts {
    let half = n / 2;
    let grid = |p: [usize; 3]| (p[2] * (n + 1) + p[1]) * (n + 1) + p[0];
    let in_patch = |p: [usize; 3]| {
        p[2] == half && p[0].abs_diff(half) <= patch && p[1].abs_diff(half) <= patch
    };
    let total = (n + 1).pow(3);
    let mut upper: BTreeMap<usize, usize> = BTreeMap::new();
    let mut coordinates: Vec<[usize; 3]> = Vec::new();
    for z in 0..=n {
        for y in 0..=n {
            for x in 0..=n {
                coordinates.push([x, y, z]);
            }
        }
    }
    for p in coordinates.clone() {
        if in_patch(p) {
            upper.insert(grid(p), total + upper.len());
            coordinates.push(p);
        }
    }
    // Unknowns: all components of free nodes.
    let fixed = |p: [usize; 3]| p[2] == 0;
    let mut unknown = vec![usize::MAX; coordinates.len()];
    let mut count = 0;
    for (i, p) in coordinates.iter().enumerate() {
        if !fixed(*p) {
            unknown[i] = count;
            count += 3;
        }
    }
    let mut columns: Vec<BTreeMap<usize, f64>> = vec![BTreeMap::new(); count];
    let element = cube();
    for z in 0..n {
        for y in 0..n {
            for x in 0..n {
                let node = |a: usize| {
                    let p = [x + (a & 1), y + (a >> 1 & 1), z + (a >> 2)];
                    let base = grid(p);
                    if z >= half {
                        *upper.get(&base).unwrap_or(&base)
                    } else {
                        base
                    }
                };
                for a in 0..8 {
                    for b in 0..8 {
                        let (i, j) = (unknown[node(a)], unknown[node(b)]);
                        if i != usize::MAX && j != usize::MAX {
                            for r in 0..3 {
                                for c in 0..3 {
                                    if i + r >= j + c {
                                        *columns[j + c].entry(i + r).or_default() +=
                                            element[3 * a + r][3 * b + c];
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    let (mut col_ptr, mut row_idx, mut values) = (vec![0], vec![], vec![]);
    for column in &columns {
        row_idx.extend(column.keys());
        values.extend(column.values());
        col_ptr.push(row_idx.len());
    }
    let stiffness = SquareMatrix::symmetric(count, col_ptr, row_idx, values).unwrap();
    let (mut col_idx, mut entries) = (vec![], vec![]);
    for (below, above) in &upper {
        for component in [2, 0, 1] {
            col_idx.extend([unknown[*above] + component, unknown[*below] + component]);
            entries.extend([1.0, -1.0]);
        }
    }
    let rows = 3 * upper.len();
    let row_ptr = (0..=rows).map(|r| 2 * r).collect();
    let jump = JumpOperator::new(rows, count, row_ptr, col_idx, entries).unwrap();
    // From the top down: another order than that of the unknowns.
    let order = (0..count).rev().collect();
    // A patch that cuts right through leaves the upper half with its six rigid motions.
    let floating = if floating {
        let centre = n as f64 / 2.0;
        let motion = |f: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let mut r = vec![0.0; count];
            for (i, p) in coordinates.iter().enumerate() {
                if unknown[i] != usize::MAX && (p[2] > half || i >= total) {
                    let u = f(p.map(|x| x as f64 - centre));
                    r[unknown[i]..unknown[i] + 3].copy_from_slice(&u);
                }
            }
            r
        };
        vec![
            motion(&|_| [1.0, 0.0, 0.0]),
            motion(&|_| [0.0, 1.0, 0.0]),
            motion(&|_| [0.0, 0.0, 1.0]),
            motion(&|p| [0.0, -p[2], p[1]]),
            motion(&|p| [p[2], 0.0, -p[0]]),
            motion(&|p| [-p[1], p[0], 0.0]),
        ]
    } else {
        vec![]
    };
    let weight = vec![1.0; upper.len()];
    ElasticParts {
        dim: 3,
        stiffness,
        jump,
        weight,
        order,
        floating,
        frictionless: vec![],
        traction: None,
    }
}

#[test]
fn solve_reaches_the_equilibrium_that_the_judge_demands() {
    let parts = cracked_box(6, 1, false);
    let n = parts.stiffness.size();
    let body = Elastic::new(parts).unwrap();
    let f = Random(1).vector(n);
    let mut u = f.clone();
    body.solve(&mut u).unwrap();
    let mut ku = vec![0.0; n];
    body.stiffness().unwrap().mul(&u, &mut ku);
    assert!(difference(&ku, &f) < 1e-12);
    let counters = body.counters();
    assert_eq!((counters.factorisations, counters.condensations), (1, 0));
}

/// Findings of the judge on an answer to 1e-9.
fn judged(m: &Method, s: &ContactSystem, load: &Load, outcome: &Outcome) -> f64 {
    let judged = judge(s, load, &outcome.state);
    let holds = judged.violation <= 1e-9 && judged.equilibrium < 1e-12;
    assert!(holds, "{}: {judged:?}", m.name);
    judged.violation
}

/// Methods see W, the judge sees the jump of u: their natural maps agree only if W is right.
#[test]
fn condensed_answers_agree_with_the_uncondensed_body() {
    // None, all, and every other point.
    for nth in [usize::MAX, 1, 2] {
        let mut parts = cracked_box(5, 1, false);
        let points = 0..parts.weight.len();
        parts.frictionless = points.map(|i| (i + 1) % nth == 0).collect();
        let mu = parts
            .frictionless
            .iter()
            .map(|own| if *own { 0.0 } else { 0.3 });
        let (f, mu) = (Random(2).vector(parts.stiffness.size()), mu.collect());
        let body = Elastic::new(parts).unwrap();
        let s = ContactSystem::new(body.clone(), mu).unwrap();
        // Rows of W are those in use, no more.
        assert_eq!(body.rank().unwrap(), Some(s.rows()));
        let load = force(&s, &f);
        for (m, outcome) in claims(exact(), &s, &load, 1e-9) {
            let last = outcome.history.last().unwrap().violation;
            assert_near(judged(&m, &s, &load, &outcome), last, 1e-11, m.name);
            let closed = outcome.state.p.iter().any(|&p| p > 0.0);
            assert!(closed, "the case must close");
        }
    }
}

#[test]
fn floating_upper_half_is_held_by_contact_alone() {
    let parts = cracked_box(4, 4, true);
    let n = parts.stiffness.size();
    let s = system(&Elastic::new(parts).unwrap(), 0.5);
    // Weight on every unknown in z, a push in x below the friction limit.
    let f: Vec<f64> = (0..n).map(|j| [2e-3, 0.0, -1e-2][j % 3]).collect();
    let load = force(&s, &f);
    let mut first = None;
    for (m, outcome) in claims(exact(), &s, &load, 1e-9) {
        judged(&m, &s, &load, &outcome);
        let first = first.get_or_insert_with(|| outcome.state.u.clone());
        assert!(difference(&outcome.state.u, first) < 1e-6, "{}", m.name);
    }
}

/// Other bases of the same rigid motions choose other pins and another W; what is reported must not notice.
#[test]
fn residuals_of_a_floating_body_do_not_depend_on_the_pins() {
    let parts = cracked_box(3, 3, true);
    let n = parts.stiffness.size();
    let mut mixed = parts.clone();
    for j in 0..n {
        let r: Vec<f64> = parts.floating.iter().map(|r| r[j]).collect();
        for (mode, entry) in mixed.floating.iter_mut().enumerate() {
            entry[j] = r[mode] + 0.7 * r[(mode + 1) % 6] - 0.4 * r[(mode + 3) % 6];
        }
    }
    let systems = [parts, mixed].map(|p| system(&Elastic::new(p).unwrap(), 0.4));
    let f: Vec<f64> = (0..n).map(|j| [3e-3, 0.0, -1e-2][j % 3]).collect();
    let load = force(&systems[0], &f);
    // Far from converged, so that the natural map is no rounding.
    let three = [("max_iterations", 3.0)];
    let state = run(method("latin").unwrap(), &three, &systems[0], &load, 1e-9).state;
    let found = systems.map(|s| {
        claims(exact(), &s, &load, 1e-10).for_each(drop);
        let judged = judge(&s, &load, &state);
        assert!(
            judged.violation > 1e-4 && judged.equilibrium < 1e-12,
            "{judged:?}"
        );
        judged.violation
    });
    assert_near(found[0] / found[1], 1.0, 1e-9, found);
}

#[test]
fn wrong_rigid_motions_are_refused_with_their_number() {
    use MethodError::*;
    let refusal = |change: &dyn Fn(&mut ElasticParts)| {
        let mut parts = cracked_box(2, 2, true);
        change(&mut parts);
        match Elastic::new(parts) {
            Ok(body) => body.solve(&mut vec![0.0; body.unknowns()]).unwrap_err(),
            Err(error) => error,
        }
    };
    let no_contact = |p: &mut ElasticParts| {
        p.jump = JumpOperator::new(0, p.stiffness.size(), vec![0], vec![], vec![]).unwrap();
        p.weight.clear();
    };
    #[rustfmt::skip]
    let refused = [
        matches!(refusal(&|p| p.floating[4][7] += 1.0), NotRigid { mode: 4, .. }),
        matches!(refusal(&|p| p.floating[2] = p.floating[0].clone()), DependentModes { .. }),
        matches!(refusal(&|p| p.floating.truncate(5)), NotPositiveDefinite { .. }),
        matches!(refusal(&|p| p.floating.clear()), NotPositiveDefinite { .. }),
        matches!(refusal(&no_contact), FreeRigidMotion { modes: 6 }),
        matches!(refusal(&|p| p.order[1] = p.order[0]), Pattern { index: 1, .. }),
        matches!(refusal(&|p| p.weight[3] = 0.0), Range { index: 3, .. }),
    ];
    assert_eq!(refused, [true; 7]);
}
