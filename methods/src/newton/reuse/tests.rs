//! Steps with earlier factors against the factored system.

use super::*;
use crate::algebra::matrix::SquareMatrix;
use crate::condensed::fixture::with_contact;
use crate::condensed::point_row::{Bordered, Law};
use crate::contract::elastic::Elastic;

/// More rows than plain loops factor.
const POINTS: usize = 17;
const ROWS: usize = 3 * POINTS;

fn number(i: usize, j: usize) -> f64 {
    (12.9 * (i + 1) as f64 + 78.2 * ((i * j + 3 * j) as f64).sqrt()).sin()
}

/// Regular rows that are neither symmetric nor those of any law.
fn law(seed: usize) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let rows = |seed: usize| {
        let unit = |k: usize, l: usize| if k % 3 == l { 3.0 } else { 0.0 };
        let entry = |k: usize, l: usize| number(k + seed, l) + unit(k, l);
        (0..ROWS).map(|k| [0, 1, 2].map(|l| entry(k, l))).collect()
    };
    (rows(seed), rows(seed + 70))
}

/// With a body of which `source[k]` names the row that row k moves like, and that has these rigid motions.
fn with_body(
    source: impl Fn(usize) -> usize,
    motions: Vec<Vec<f64>>,
    test: impl FnOnce(&ContactProblem<'_>),
) {
    let entry = |i: usize, j: usize| {
        let (i, j) = (source(i.max(j)), source(i.min(j)));
        let (i, j) = (i.max(j), i.min(j));
        if i == j { 12.0 } else { number(i, j) / 9.0 }
    };
    let (mut col_ptr, mut row_idx, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..ROWS {
        row_idx.extend(j..ROWS);
        values.extend((j..ROWS).map(|i| entry(i, j)));
        col_ptr.push(values.len());
    }
    let w = SquareMatrix::symmetric(ROWS, col_ptr, row_idx, values).unwrap();
    let body = Elastic::from_delassus(3, w, motions).unwrap();
    let load = (vec![-1.0; ROWS], vec![0.0; ROWS]);
    with_contact(&body, vec![0.3; POINTS], load, |_, problem| test(&problem));
}

fn rows_of<'a>(
    problem: &'a ContactProblem<'_>,
    active: &'a [usize],
    (a, c): (Blocks<'a>, Blocks<'a>),
) -> Rows<'a> {
    let w = &*problem.operator.w;
    Rows { w, active, a, c }
}

fn remembered(rows: Rows<'_>) -> Factored {
    let mut factored = Factored::default();
    factored.remember(rows);
    factored
}

/// Source: the dense system of the step itself, factored. Tolerance: rounding, times its condition.
#[test]
fn changed_new_and_left_rows_are_solved_for_with_earlier_factors() {
    let motion = |j: usize| (0..ROWS).map(|k| number(k, j)).collect::<Vec<f64>>();
    for motions in [vec![], vec![motion(3), motion(4)]] {
        steps_with_earlier_factors(motions);
    }
}

fn steps_with_earlier_factors(motions: Vec<Vec<f64>>) {
    with_body(
        |k| k,
        motions,
        |problem| {
            let (mut a, mut c) = law(1);
            let without =
                |out: &[usize]| -> Vec<usize> { (0..ROWS).filter(|k| !out.contains(k)).collect() };
            let first = without(&[4, 5, 16]);
            let base = Bordered::new(problem, &first, &Law::Rows { a: &a, c: &c }).unwrap();
            let rows = rows_of(problem, &first, (&a, &c));
            let mut earlier = remembered(rows);
            let f: Vec<f64> = (0..ROWS).map(|k| number(k, 2)).collect();
            let others = law(5);
            for (changed, active) in [
                (vec![], first.clone()),
                (vec![], without(&[4, 5, 16, 7])),
                (vec![2, 11], first),
                (vec![2, 12, 13], without(&[0, 7, 26])),
                (vec![20], without(&[])),
            ] {
                for k in changed {
                    (a[k], c[k]) = (others.0[k], others.1[k]);
                }
                let rows = rows_of(problem, &active, (&a, &c));
                let (law, f) = (Law::Rows { a: &a, c: &c }, &f[..active.len()]);
                let (changes, balance) = (earlier.changes(rows), &[0.7, -0.2][..problem.modes()]);
                let right = [f, balance].concat();
                let found =
                    earlier.solve_changed(problem, base.factors().unwrap(), rows, &changes, &right);
                let mut whole = Bordered::new(problem, &active, &law).unwrap();
                let (mut exact, beta) = whole.solve(f, balance).unwrap();
                exact.extend(beta.iter().map(|beta| beta * problem.operator.rho));
                let off = largest(&minus(&found.unwrap(), &exact));
                assert!(off < 1e-11 * largest(&exact), "{}: {off:e}", changes.len());
            }
            // Every column was solved for once.
            let solved: Vec<Unknown> = earlier.solved.into_keys().collect();
            let slack = [0, 2, 7, 11, 12, 13, 20, 26].map(Unknown::Slack);
            let new = [4, 5, 16].map(Unknown::New);
            assert_eq!(solved, [&slack[..], &new].concat());
        },
    );
}

/// Goal: where points are redundant the tangent is singular, and a right-hand side that one of its many solutions fulfils
/// does not hide it.
#[test]
fn a_tangent_that_has_become_singular_is_told() {
    let twin = |k: usize| if k >= ROWS - 3 { k - 3 } else { k };
    with_body(twin, vec![], |problem| {
        let (a, c) = (
            vec![[0.0; 3]; ROWS],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].repeat(POINTS),
        );
        let all: Vec<usize> = (0..ROWS).collect();
        let first = &all[..ROWS - 3];
        let law = Law::Rows { a: &a, c: &c };
        assert!(Bordered::new(problem, &all, &law).is_none());
        let base = Bordered::new(problem, first, &law).unwrap();
        let mut earlier = remembered(rows_of(problem, first, (&a, &c)));
        let rows = rows_of(problem, &all, (&a, &c));
        let f: Vec<f64> = (0..ROWS).map(|k| number(twin(k), 2)).collect();
        let changes = earlier.changes(rows);
        let found = earlier.solve_changed(problem, base.factors().unwrap(), rows, &changes, &f);
        assert!(found.is_none(), "{found:?}");
    });
}

/// Goal: a piece of which all rows have opened is loose, also where its rows were closed when the tangent was factored.
#[test]
fn a_piece_that_gets_loose_is_told() {
    let rows_of_piece = 6;
    let motion = (0..ROWS).map(|k| f64::from(u8::from(k < rows_of_piece)));
    with_body(
        |k| k,
        vec![motion.collect()],
        |problem| {
            let (a, c) = law(1);
            let all: Vec<usize> = (0..ROWS).collect();
            let law = Law::Rows { a: &a, c: &c };
            let base = Bordered::new(problem, &all, &law).unwrap();
            let of = |active| rows_of(problem, active, (&a, &c));
            let mut earlier = remembered(of(&all));
            for (first, regular) in [(rows_of_piece - 1, true), (rows_of_piece, false)] {
                let rows = of(&all[first..]);
                let right: Vec<f64> = (first..=ROWS).map(|k| number(k, 2)).collect();
                let changes = earlier.changes(rows);
                let found =
                    earlier.solve_changed(problem, base.factors().unwrap(), rows, &changes, &right);
                let whole = Bordered::new(problem, rows.active, &law);
                assert_eq!(
                    (found.is_some(), whole.is_some()),
                    (regular, regular),
                    "{first}"
                );
            }
        },
    );
}

/// Goal: few changes are worth it, many are not, and what is solved for already counts no more.
#[test]
fn a_step_costs_at_most_half_of_a_factorisation() {
    with_body(
        |k| k,
        vec![],
        |problem| {
            let (a, c) = law(1);
            let all: Vec<usize> = (0..ROWS).collect();
            let rows = rows_of(problem, &all, (&a, &c));
            let mut earlier = remembered(rows);
            assert!(earlier.is_of(rows));
            let lu = TiedLu::default();
            let found = earlier.solve(problem, &lu, rows, &[0.0; ROWS]);
            assert!(matches!(found, Solved::TooManyChanges), "too few rows");
            let slack = |most: usize| (0..most).map(Unknown::Slack).collect::<Vec<_>>();
            assert!(earlier.is_worth(&slack(6), ROWS));
            assert!(!earlier.is_worth(&slack(10), ROWS));
            for known in slack(10) {
                earlier.solved.insert(known, vec![0.0; ROWS]);
            }
            assert!(earlier.is_worth(&slack(10), ROWS));
            assert!(!earlier.is_worth(&slack(30), ROWS));
        },
    );
}
