//! Small systems with known answers, and the way tests run methods on them.

use std::fmt::Debug;
use std::ops::Deref;
use std::sync::Arc;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, SupportedConeT};
use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};
use stickslip_methods::*;

/// Dense matrix by rows.
pub type Rows = Vec<Vec<f64>>;

/// A body from dense K and B.
pub fn elastic(
    dim: usize,
    k: &Rows,
    b: &Rows,
    floating: Vec<Vec<f64>>,
    frictionless: bool,
) -> Arc<Elastic> {
    Elastic::new(parts(dim, k, b, floating, frictionless)).unwrap()
}

/// Parts from dense K and B; structural zeros are left out.
pub fn parts(
    dim: usize,
    k: &Rows,
    b: &Rows,
    floating: Vec<Vec<f64>>,
    frictionless: bool,
) -> ElasticParts {
    let n = k.len();
    let (mut row_ptr, mut col_idx, mut entries) = (vec![0], vec![], vec![]);
    for row in b {
        for (j, &x) in row.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            col_idx.push(j);
            entries.push(x);
        }
        row_ptr.push(col_idx.len());
    }
    ElasticParts {
        dim,
        stiffness: sparse(k),
        jump: JumpOperator::new(b.len(), n, row_ptr, col_idx, entries).unwrap(),
        weight: vec![1.0; b.len() / dim],
        order: (0..n).collect(),
        floating,
        frictionless: vec![frictionless; b.len() / dim],
        traction: None,
    }
}

/// Lower half of a symmetric matrix, without its structural zeros.
pub fn sparse(a: &Rows) -> SquareMatrix {
    let (mut col_ptr, mut row_idx, mut values) = (vec![0], vec![], vec![]);
    for j in 0..a.len() {
        for i in (j..a.len()).filter(|&i| i == j || a[i][j] != 0.0) {
            row_idx.push(i);
            values.push(a[i][j]);
        }
        col_ptr.push(row_idx.len());
    }
    SquareMatrix::symmetric(a.len(), col_ptr, row_idx, values).unwrap()
}

/// A diagonal matrix.
pub fn diagonal(entries: &[f64]) -> Rows {
    let n = entries.len();
    let row = |i: usize| (0..n).map(move |j| if i == j { entries[i] } else { 0.0 });
    (0..n).map(|i| row(i).collect()).collect()
}

/// A system with the same friction everywhere.
pub fn system(elastic: &Arc<Elastic>, mu: f64) -> ContactSystem {
    ContactSystem::new(elastic.clone(), vec![mu; elastic.points()]).unwrap()
}

/// A load without offset.
pub fn force(system: &ContactSystem, f: &[f64]) -> Load {
    load(f.to_vec(), vec![0.0; system.dim() * system.points()])
}

/// A load of forces and gaps.
pub fn load(force: Vec<f64>, offset: Vec<f64>) -> Load {
    Load {
        force,
        offset,
        traction: vec![],
    }
}

/// A load of gaps alone, for bodies known by their Delassus operator.
pub fn free_jump(q: &[f64]) -> Load {
    load(vec![0.0; q.len()], q.to_vec())
}

/// Runs one increment from the unloaded state.
pub fn run(
    method: &Method,
    options: &[(&str, f64)],
    system: &ContactSystem,
    load: &Load,
    tol: f64,
) -> Outcome {
    let start = ContactState::zero(system);
    let rest = Load::zero(system.elastic());
    let increment = increment(system, load, &rest, &start, tol);
    build(method, options)
        .solve(&increment, &mut Silent)
        .unwrap()
}

/// As [`run`], if the method claims to have solved it, as those listed must.
#[track_caller]
pub fn solved(
    method: &Method,
    options: &[(&str, f64)],
    system: &ContactSystem,
    load: &Load,
    tol: f64,
) -> Option<Outcome> {
    let outcome = run(method, options, system, load, tol);
    converged(method, &outcome).then_some(outcome)
}

/// Runs methods on a toy: those that claim to have solved it, as all that are listed must.
pub fn claims<'a>(
    methods: impl Iterator<Item = Candidate> + 'a,
    system: &'a ContactSystem,
    load: &'a Load,
    tol: f64,
) -> impl Iterator<Item = (Candidate, Outcome)> + 'a {
    let run = move |m: Candidate| {
        let outcome = run(&m, &m.given, system, load, tol);
        (m, outcome)
    };
    methods.map(run).filter(|(m, found)| converged(m, found))
}

/// Demands that two states are one within a tolerance relative to the larger entries.
#[track_caller]
pub fn assert_same(found: &ContactState, exact: &ContactState, tol: f64, at: impl Debug) {
    let u = difference(&found.u, &exact.u);
    let p = difference(&found.p, &exact.p);
    assert!(u < tol && p < tol, "{at:?}: {u:.1e} {p:.1e}");
}

/// Demands a number within a tolerance.
#[track_caller]
pub fn assert_near(found: f64, exact: f64, tol: f64, at: impl Debug) {
    assert!((found - exact).abs() < tol, "{at:?}: {found} {exact}");
}

/// An increment.
pub fn increment<'a>(
    system: &'a ContactSystem,
    load: &'a Load,
    start_load: &'a Load,
    start: &'a ContactState,
    tolerance: f64,
) -> Increment<'a> {
    Increment {
        system,
        load,
        start_load,
        start,
        guess: None,
        index: 0,
        tolerance,
    }
}

/// Builds a method with options.
pub fn build(method: &Method, options: &[(&str, f64)]) -> Box<dyn Enforcement> {
    let given: Vec<(String, f64)> = options.iter().map(|(n, v)| (n.to_string(), *v)).collect();
    (method.build)(&Options::new(method.options, &given).unwrap())
}

/// Judges an outcome of an increment from the unloaded state.
pub fn judge(system: &ContactSystem, load: &Load, state: &ContactState) -> Residuals {
    let start = ContactState::zero(system);
    let rest = Load::zero(system.elastic());
    residuals(&increment(system, load, &rest, &start, 1e-9), state).unwrap()
}

/// All methods of the package.
pub fn methods() -> impl Iterator<Item = &'static Method> {
    Registry::standard().iter().collect::<Vec<_>>().into_iter()
}

/// The method of that name.
pub fn method(name: &str) -> Option<&'static Method> {
    Registry::standard().get(name)
}

/// Methods known to solve every toy. One that is not listed may give up: a fair failure is a result, and only a wrong claim,
/// a crash, a wrong size or different bits from the same input fail a test.
const SOLVES_EVERY_TOY: [&str; 18] = [
    "b-newton",
    "newton-ac",
    "pdas",
    "gnm",
    "ncp-newton",
    "hybrid",
    "interior-point",
    "ipm-anm",
    "augmented-lagrangian",
    "latin",
    "admm",
    "nsgs",
    "projection",
    "socp",
    "tresca",
    "penalty",
    "barrier",
    "nitsche",
];

/// Whether a method claims to have solved a toy, as those listed must.
pub fn converged(method: &Method, outcome: &Outcome) -> bool {
    let (name, status) = (method.name, outcome.status);
    let claims = status == Status::Converged;
    assert!(claims || !solves_every_toy(method), "{name}: {status}");
    claims
}

/// Whether a method may not give up on a toy.
pub fn solves_every_toy(method: &Method) -> bool {
    SOLVES_EVERY_TOY.contains(&method.name)
}

/// A method with the options it is given, and the accuracy to ask for.
pub struct Candidate {
    pub method: &'static Method,
    pub given: Vec<(&'static str, f64)>,
    pub accuracy: f64,
}

impl Deref for Candidate {
    type Target = Method;

    fn deref(&self) -> &Method {
        self.method
    }
}

/// Methods that solve the contact laws themselves.
pub fn exact() -> impl Iterator<Item = Candidate> {
    general().filter(|m| m.exact)
}

/// Methods that need nothing but K and B: a toy has no stress that a traction operator could stand for.
pub fn general() -> impl Iterator<Item = Candidate> {
    let general = methods().filter(|m| !build(m, &[]).needs().traction);
    general.map(|method| Candidate {
        method,
        given: vec![],
        accuracy: if method.exact { 1e-8 } else { 1e-5 },
    })
}

/// Those methods, with options that make the inexact ones good to about 1e-6.
pub fn all() -> impl Iterator<Item = Candidate> {
    general().map(|mut m| {
        let sharp = [
            ("normal", 1e7),
            ("tangential", 1e7),
            ("gap", 1e-7),
            ("slip", 1e-7),
        ];
        let has = |name: &str| !m.exact && m.options.iter().any(|o| o.name() == name);
        m.given = sharp.into_iter().filter(|(name, _)| has(name)).collect();
        m
    })
}

/// Repeatable pseudo-random numbers (SplitMix64).
pub struct Random(pub u64);

impl Random {
    /// Uniform in [−1, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A vector of them.
    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// A random coupled body: `points` contact points, `interior` further unknowns, K = MᵀM/n + shift·I.
pub fn random_body(
    rng: &mut Random,
    dim: usize,
    points: usize,
    interior: usize,
    shift: f64,
) -> (Rows, Rows) {
    let (m, n) = (dim * points, dim * points + interior);
    let M: Rows = (0..n).map(|_| rng.vector(n)).collect();
    let k = (0..n)
        .map(|i| {
            let entry = |j: usize| (0..n).map(|l| M[l][i] * M[l][j]).sum::<f64>() / n as f64;
            (0..n)
                .map(|j| entry(j) + if i == j { shift } else { 0.0 })
                .collect()
        })
        .collect();
    let b = (0..m)
        .map(|i| {
            (0..n)
                .map(|j| if i == j { 1.0 } else { 0.3 * rng.next() })
                .collect()
        })
        .collect();
    (k, b)
}

/// A x.
pub fn mul(a: &Rows, x: &[f64]) -> Vec<f64> {
    a.iter()
        .map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum())
        .collect()
}

/// A⁻¹ b.
pub fn solve(a: &Rows, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let lu = PartialPivLu::new(Mat::from_fn(n, n, |i, j| a[i][j]).as_ref());
    let x = lu.solve(Mat::from_fn(n, 1, |i, _| b[i]));
    (0..n).map(|i| x[(i, 0)]).collect()
}

/// B K⁻¹ Bᵀ.
pub fn delassus(k: &Rows, b: &Rows) -> Rows {
    let columns: Rows = b.iter().map(|row| mul(b, &solve(k, row))).collect();
    (0..b.len())
        .map(|i| (0..b.len()).map(|j| columns[j][i]).collect())
        .collect()
}

/// All solutions of a 2D problem v = q + W P with rows (n, t) per point, by trying every state of every point.
pub fn enumerate(W: &Rows, q: &[f64], mu: f64) -> Vec<Vec<f64>> {
    let m = q.len();
    let points = m / 2;
    let mut found = Vec::new();
    for code in 0..4usize.pow(points as u32) {
        let state = |i: usize| code / 4usize.pow(i as u32) % 4;
        // open: P = 0; stick: v = 0; slip ±: g = 0, P_t = ∓ μ P_n with d of sign ±.
        let (mut A, mut rhs): (Rows, Vec<f64>) = (vec![vec![0.0; m]; m], vec![0.0; m]);
        for i in 0..points {
            for k in [2 * i, 2 * i + 1] {
                let law = match (state(i), k % 2) {
                    (0, _) => Some((1.0, 0.0)),
                    (2, 1) => Some((1.0, mu)),
                    (3, 1) => Some((1.0, -mu)),
                    _ => None,
                };
                match law {
                    Some((t, n)) => {
                        A[k][2 * i] += n;
                        A[k][k] += t;
                    }
                    None => {
                        A[k].clone_from(&W[k]);
                        rhs[k] = -q[k];
                    }
                }
            }
        }
        let P = solve(&A, &rhs);
        if P.iter().any(|p| !p.is_finite()) {
            continue;
        }
        let v: Vec<f64> = mul(W, &P).iter().zip(q).map(|(w, q)| w + q).collect();
        let holds = (0..points).all(|i| {
            let (p, t, g, d) = (P[2 * i], P[2 * i + 1], v[2 * i], v[2 * i + 1]);
            match state(i) {
                0 => g >= 0.0,
                1 => p >= 0.0 && t.abs() <= mu * p,
                2 => p >= 0.0 && d > 0.0,
                _ => p >= 0.0 && d < 0.0,
            }
        });
        if holds {
            found.push(P);
        }
    }
    found
}

/// Largest |a − b| relative to the largest |b|.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(1e-300, |m: f64, x| m.max(x.abs()));
    a.iter()
        .zip(b)
        .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
        / size
}

/// One 2D pair on springs: K = diag(k_n, k_t), B = I.
pub fn spring_pair(k_n: f64, k_t: f64) -> Arc<Elastic> {
    elastic(
        2,
        &diagonal(&[k_n, k_t]),
        &diagonal(&[1.0, 1.0]),
        vec![],
        false,
    )
}

/// A block of three bars, base nodes (0, 0) and (2a, 0) on the ground, top node (a, h); unknowns (x, y) per node.
///
/// A spring `lateral` holds the top node in x; without it the block floats in all three rigid motions, with it in two.
pub fn block(a: f64, h: f64, bar: f64, lateral: f64) -> Arc<Elastic> {
    let nodes = [[0.0, 0.0], [2.0 * a, 0.0], [a, h]];
    let mut k = vec![vec![0.0; 6]; 6];
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let d = [nodes[j][0] - nodes[i][0], nodes[j][1] - nodes[i][1]];
        let l = d[0].hypot(d[1]);
        for (p, sp) in [(i, -1.0), (j, 1.0)] {
            for (q, sq) in [(i, -1.0), (j, 1.0)] {
                for r in 0..2 {
                    for c in 0..2 {
                        k[2 * p + r][2 * q + c] += sp * sq * bar * d[r] * d[c] / (l * l);
                    }
                }
            }
        }
    }
    k[4][4] += lateral;
    // Row order (n, a) = (y, x).
    let mut b = vec![vec![0.0; 6]; 4];
    for i in 0..2 {
        b[2 * i][2 * i + 1] = 1.0;
        b[2 * i + 1][2 * i] = 1.0;
    }
    let along_y = vec![0.0, 1.0, 0.0, 1.0, 0.0, 1.0];
    let about_top: Vec<f64> = nodes.iter().flat_map(|p| [-(p[1] - h), p[0] - a]).collect();
    let mut modes = vec![along_y, about_top];
    if lateral == 0.0 {
        modes.push(vec![1.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
    }
    elastic(2, &k, &b, modes, false)
}

/// A dense matrix as clarabel takes it.
fn csc(rows: &Rows) -> CscMatrix<f64> {
    let (m, n) = (rows.len(), rows[0].len());
    let (mut colptr, mut rowval, mut nzval) = (vec![0], vec![], vec![]);
    for j in 0..n {
        for (i, row) in rows.iter().enumerate().filter(|(_, row)| row[j] != 0.0) {
            rowval.push(i);
            nzval.push(row[j]);
        }
        colptr.push(rowval.len());
    }
    CscMatrix::new(m, n, colptr, rowval, nzval)
}

/// min ½ x·H x + g·x subject to right − A x in the cones, by clarabel.
pub fn minimise(
    hessian: &Rows,
    linear: &[f64],
    (a, right, cones): (&Rows, &[f64], &[SupportedConeT<f64>]),
    accuracy: f64,
) -> DefaultSolution<f64> {
    let mut upper = hessian.clone();
    (0..upper.len()).for_each(|i| upper[i][..i].fill(0.0));
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: accuracy,
        tol_gap_rel: accuracy,
        tol_feas: accuracy,
        ..DefaultSettings::default()
    };
    let (hessian, a) = (csc(&upper), csc(a));
    let mut solver = DefaultSolver::new(&hessian, linear, &a, right, cones, settings).unwrap();
    solver.solve();
    solver.solution
}
