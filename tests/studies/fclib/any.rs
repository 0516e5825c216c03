//! Random problems.

use proptest::prelude::*;
use stickslip::files::interchange::{
    GlobalEquality, GlobalProblem, Info, LocalEquality, LocalProblem, Solution, SparseMatrix,
};

/// Finite numbers of all sizes, and a few that lose their sign or tail when copied carelessly.
fn real() -> impl Strategy<Value = f64> {
    use prop::num::f64::{NORMAL, SUBNORMAL};
    prop_oneof![NORMAL | SUBNORMAL, Just(-0.0), Just(0.1), Just(f64::MAX)]
}

fn matrix(rows: usize, cols: usize) -> impl Strategy<Value = SparseMatrix> {
    // A matrix without columns has no place for an entry.
    let most = if cols == 0 { 1 } else { 20 };
    let place = (0..rows.max(1), 0..cols.max(1));
    let entries = prop::collection::btree_map(place, real(), 0..most);
    entries.prop_map(move |map| {
        let triplets = map.into_iter().map(|((i, j), v)| (i, j, v));
        SparseMatrix::from_triplets(rows, cols, triplets).unwrap()
    })
}

fn symmetric(size: usize) -> impl Strategy<Value = SparseMatrix> {
    matrix(size, size).prop_map(move |lower| {
        let half: Vec<_> = lower.entries().filter(|e| e.0 >= e.1).collect();
        let mirror = half
            .iter()
            .filter(|e| e.0 > e.1)
            .map(|&(i, j, v)| (j, i, v));
        SparseMatrix::from_triplets(size, size, half.iter().copied().chain(mirror)).unwrap()
    })
}

fn vector(len: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(real(), len)
}

fn solution(v: usize, r: usize, l: usize) -> impl Strategy<Value = Solution> {
    (vector(v), vector(r), vector(r), vector(l)).prop_map(|(v, u, r, l)| Solution { v, u, r, l })
}

fn info() -> impl Strategy<Value = Info> {
    let text = || prop::option::of("[a-zµ ]{1,12}");
    (text(), text(), text()).prop_map(|(title, description, math_info)| Info {
        title,
        description,
        math_info,
    })
}

fn friction(points: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![Just(0.0), 1e-3..5.0_f64], points)
}

pub fn any_local() -> impl Strategy<Value = LocalProblem> {
    (2..=3usize, 1..4usize, 0..3usize).prop_flat_map(|(dim, points, extra)| {
        let m = dim * points;
        let equality = (matrix(m, extra), matrix(extra, extra), vector(extra))
            .prop_map(move |(v, r, s)| (extra > 0).then_some(LocalEquality { v, r, s }));
        let solutions = (
            prop::option::of(solution(0, m, extra)),
            prop::collection::vec(solution(0, m, extra), 0..3),
        );
        (
            symmetric(m),
            vector(m),
            friction(points),
            equality,
            info(),
            solutions,
        )
            .prop_map(move |(w, q, mu, equality, info, (solution, guesses))| {
                LocalProblem {
                    dim,
                    w,
                    q,
                    mu,
                    equality,
                    info,
                    solution,
                    guesses,
                }
            })
    })
}

pub fn any_global() -> impl Strategy<Value = GlobalProblem> {
    (2..=3usize, 1..4usize, 1..9usize, 0..3usize).prop_flat_map(|(dim, points, n, extra)| {
        let m = dim * points;
        let equality = (matrix(n, extra), vector(extra))
            .prop_map(move |(g, b)| (extra > 0).then_some(GlobalEquality { g, b }));
        let solution = prop::option::of(solution(n, m, extra));
        let vectors = (vector(n), vector(m), friction(points));
        (
            symmetric(n),
            matrix(n, m),
            vectors,
            equality,
            info(),
            solution,
        )
            .prop_map(
                move |(m, h, (f, w, mu), equality, info, solution)| GlobalProblem {
                    dim,
                    m,
                    h,
                    f,
                    w,
                    mu,
                    equality,
                    info,
                    solution,
                    guesses: Vec::new(),
                },
            )
    })
}
