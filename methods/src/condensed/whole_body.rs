//! The linear problem of a Newton step on all unknowns of the body: W is not formed, memory and work are those of a few factors of K.
//! ```text
//! A δP + C δv = −h at every point,   K δu = Bᵀ δP,   δv = B δu
//! ```
//! By generalised minimal residuals in the rows, each vector preconditioned from the right by a body whose points stand on springs
//! that stand for the law: symmetric and positive definite, so that its factor is that of K a little fuller, in one order that is
//! analysed once.
//! ```text
//! L = A + C/κ,   S = the symmetric part of L⁻¹C, normal and tangential alone, without what is negative
//! (K + Bᵀ S B) δu = Bᵀ L⁻¹ ρ,   δP = L⁻¹ ρ − S B δu        so K δu = Bᵀ δP whatever S
//! ```
//! A point that sticks stands on κ, far above its own stiffness, one that slips on κ along the normal alone, an open one on
//! nothing; what friction couples is left to the iteration. As long as few points change S, its factor serves again.
//!
//! Springs of κ leave K δu = Bᵀ δP to rounding times κ: what δv = W δP, one solve with K, leaves of the rows is solved for again.
//!
//! A body that floats is pinned by springs, too; that they carry nothing is one equation more each.

#![allow(non_snake_case)]

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::algebra::dense::{DenseLu, add, larger, minus, norm};
use crate::algebra::factor::Factor;
use crate::algebra::floating::Balance;
use crate::algebra::gmres::gmres;
use crate::algebra::matrix::SquareMatrix;
use crate::algebra::multifrontal::Analysis;
use crate::algebra::rows::RowSet;
use crate::condensed::pair::Pair;
use crate::condensed::point_row::PointRow;
use crate::condensed::problem::ContactProblem;
use crate::contract::elastic::Elastic;
use crate::contract::system::ContactSystem;
use crate::error::MethodError;

/// κ as a multiple of a row's stiffness with all else held: the larger, the fewer steps and the more rounding.
const STIFF: f64 = 1e2;
/// Residual of a step over its right-hand side, and that of one round of vectors.
const SOLVED: f64 = 1e-12;
const ROUND: f64 = 1e-6;
/// Most rounds, and the residual that is left to rounding where there are no more.
const ROUNDS: usize = 8;
const ROUNDING: f64 = 1e-6;
/// Most vectors of a step; with the factor of other springs, where one of its own may take fewer.
const MOST: usize = 400;
const MOST_BORROWED: usize = 8;

/// A block of a point.
type Block = [[f64; 3]; 3];

/// The body of one system.
pub(crate) struct WholeBody {
    elastic: Arc<Elastic>,
    set: RowSet,
    /// K on the pattern of K + Bᵀ S B, and with springs.
    plain: Vec<f64>,
    sprung: SquareMatrix,
    analysis: Analysis,
    points: Vec<Point>,
    /// Pinned unknowns, where their diagonal entries stand, and their springs.
    pins: Vec<(usize, usize, f64)>,
    /// S by point, and the factor of its matrix.
    factored: Option<(Vec<Block>, Factor)>,
}

/// A contact point in the body.
struct Point {
    start: usize,
    size: usize,
    /// Unknowns with their coefficients in the rows of the point.
    b: Vec<(usize, [f64; 3])>,
    /// Where every pair of them, the first not before the second, stands among the values.
    places: Vec<usize>,
    /// κ by row.
    stiff: [f64; 3],
}

/// What the rows of a step ask of a point: L⁻¹ and S.
struct Spring {
    inverse: Block,
    s: Block,
}

impl WholeBody {
    /// Analyses the body of a system.
    pub fn new(system: &ContactSystem) -> Result<Self, MethodError> {
        let (elastic, set) = (system.elastic(), system.row_set());
        let K = elastic.stiffness().ok_or(MethodError::NoStiffness)?;
        let factor = elastic.factor()?;
        let point = |own: std::ops::Range<usize>| {
            let (mut columns, mut local) = (BTreeMap::<usize, [f64; 3]>::new(), [0.0; 3]);
            for (l, k) in own.clone().enumerate() {
                for (j, value) in elastic.jump().row(set.source[k]) {
                    columns.entry(j).or_default()[l] += value;
                    local[l] += value * value / K.diagonal(j);
                }
            }
            Point {
                start: own.start,
                size: own.len(),
                b: columns.into_iter().collect(),
                places: Vec::new(),
                stiff: local.map(|local| STIFF / local),
            }
        };
        let mut points: Vec<Point> = set.iter().map(point).collect();
        let sprung = widened(K, &points)?;
        for point in &mut points {
            let all = point.pairs().map(|(i, j, ..)| {
                let begin = sprung.col_ptr()[j];
                begin + sprung.row_idx()[begin..sprung.col_ptr()[j + 1]].partition_point(|&r| r < i)
            });
            point.places = all.collect();
        }
        let order = &factor.ordering.forward;
        Ok(Self {
            analysis: Analysis::new(&sprung, order),
            pins: (factor.pins.iter())
                .map(|&j| (j, sprung.col_ptr()[j], K.diagonal(j)))
                .collect(),
            plain: sprung.values().to_vec(),
            elastic: elastic.clone(),
            set: set.clone(),
            sprung,
            points,
            factored: None,
        })
    }

    /// Whether it is that of this system.
    pub fn belongs_to(&self, system: &ContactSystem) -> bool {
        Arc::ptr_eq(system.elastic(), &self.elastic) && *system.row_set() == self.set
    }

    /// The step from contact forces P that fulfils the rows, with its jump and amplitudes; `None` if the tangent is singular.
    pub fn step(
        &mut self,
        problem: &mut ContactProblem<'_>,
        P: &[f64],
        rows: &mut [[PointRow; 3]],
    ) -> Result<Option<Pair>, MethodError> {
        // Without balance there is no equilibrium to linearise: step from the nearest balanced forces P + Q (c − Qᵀ P).
        let (mut lack, mut response) = (vec![0.0; P.len()], vec![0.0; P.len()]);
        if problem.modes() > 0 {
            problem.operator.modes.add(&problem.missing(P), &mut lack);
            problem.operator.w.apply_add(&lack, &mut response);
        }
        for (own, of_point) in problem.rows.iter().zip(rows.iter_mut()) {
            for row in of_point.iter_mut().take(own.len()) {
                for (l, k) in own.clone().enumerate() {
                    row.h += row.a[l] * lack[k] + row.c[l] * response[k];
                }
            }
        }
        let mut found = self.balanced(problem, rows)?;
        if let Some(Pair { p, v, .. }) = &mut found {
            add(1.0, &lack, p);
            add(1.0, &response, v);
        }
        Ok(found)
    }

    /// The step of balanced forces, by the factor at hand or else by its own.
    fn balanced(
        &mut self,
        problem: &mut ContactProblem<'_>,
        rows: &[[PointRow; 3]],
    ) -> Result<Option<Pair>, MethodError> {
        let springs = self.points.iter().zip(rows).map(|(p, rows)| p.spring(rows));
        let Some(springs) = springs.collect::<Option<Vec<Spring>>>() else {
            return Ok(None);
        };
        let same = |s: &[Block]| s.iter().zip(&springs).all(|(s, own)| *s == own.s);
        if let Some((s, factor)) = &self.factored {
            let most = if same(s) { MOST } else { MOST_BORROWED };
            let found = self.solve(problem, (s, factor), &springs, rows, most);
            if found.is_some() || most == MOST {
                return Ok(found);
            }
        }
        problem.counters.global_factorisations += 1;
        // Freed before another is made.
        self.factored = None;
        let s: Vec<Block> = springs.iter().map(|spring| spring.s).collect();
        let Some(factor) = self.factorise(&s)? else {
            return Ok(None);
        };
        let found = self.solve(problem, (&s, &factor), &springs, rows, MOST);
        self.factored = Some((s, factor));
        Ok(found)
    }

    /// The factor of K + Bᵀ S B; `None` if rounding has made it indefinite.
    fn factorise(&mut self, s: &[Block]) -> Result<Option<Factor>, MethodError> {
        let values = self.sprung.values_mut();
        values.copy_from_slice(&self.plain);
        for (point, s) in self.points.iter().zip(s) {
            for (&place, (_, _, b, d)) in point.places.iter().zip(point.pairs()) {
                let sum = (0..3).map(|k| b[k] * (0..3).map(|l| s[k][l] * d[l]).sum::<f64>());
                values[place] += sum.sum::<f64>();
            }
        }
        for &(_, place, spring) in &self.pins {
            values[place] += spring;
        }
        let held = Arc::new(Balance::new(&self.sprung, &[], &[]));
        match Factor::new(&self.sprung, &self.analysis, Vec::new(), held) {
            Ok(factor) => Ok(Some(factor)),
            Err(MethodError::NotPositiveDefinite { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The step on a factor; `None` if `most` vectors a round do not suffice.
    fn solve(
        &self,
        problem: &ContactProblem<'_>,
        on: (&[Block], &Factor),
        springs: &[Spring],
        rows: &[[PointRow; 3]],
        most: usize,
    ) -> Option<Pair> {
        let m = self.set.len();
        // With what the pins carry behind the forces.
        let (mut P, mut v) = (vec![0.0; m + self.pins.len()], vec![0.0; m]);
        let mut beta = vec![0.0; problem.modes()];
        let (mut last, mut size) = (f64::INFINITY, 0.0);
        for _ in 0..ROUNDS {
            let mut left: Vec<f64> = P.iter().map(|p| -p).collect();
            for (point, rows) in self.points.iter().zip(rows) {
                let own = point.start..point.start + point.size;
                let image = of_rows(rows, &P[own.clone()], &v[own.clone()]);
                (0..point.size).for_each(|k| left[own.start + k] = -rows[k].h - image[k]);
            }
            let found = norm(&left);
            size = larger(size, found);
            if found <= SOLVED * size || found > 0.5 * last {
                P.truncate(m);
                return (found <= ROUNDING * size).then_some(Pair { p: P, v, beta });
            }
            last = found;
            let (dP, dv) = self.round(&left, on, springs, rows, most)?;
            add(1.0, &dP, &mut P);
            add(1.0, &dv, &mut v);
            (v, beta) = followed(problem, &P[..m], &v);
        }
        None
    }

    /// (δP, δv) of one round of vectors, δP with what the pins carry.
    fn round(
        &self,
        left: &[f64],
        (s, factor): (&[Block], &Factor),
        springs: &[Spring],
        rows: &[[PointRow; 3]],
        most: usize,
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let (mut forces, mut jumps) = (Vec::new(), Vec::new());
        let mut work = vec![0.0; self.sprung.size()];
        let y = gmres(left, ROUND, most, |residual| {
            let mut dP = residual.to_vec();
            let mut du = vec![0.0; self.sprung.size()];
            for (point, spring) in self.points.iter().zip(springs) {
                let own = times(&spring.inverse, &residual[point.start..][..point.size]);
                dP[point.start..][..point.size].copy_from_slice(&own[..point.size]);
                for &(j, b) in &point.b {
                    du[j] += (0..3).map(|k| b[k] * own[k]).sum::<f64>();
                }
            }
            let pinned = self.pins.iter().zip(&residual[self.set.len()..]);
            pinned.for_each(|(pin, force)| du[pin.0] += force);
            factor.solve_scaled(&mut du, &mut work);
            let (mut image, mut dv) = (vec![0.0; left.len()], vec![0.0; self.set.len()]);
            for ((point, s), rows) in self.points.iter().zip(s).zip(rows) {
                let own = point.start..point.start + point.size;
                let v = (point.b.iter()).fold([0.0; 3], |v, &(j, b)| {
                    [0, 1, 2].map(|k| v[k] + b[k] * du[j])
                });
                dv[own.clone()].copy_from_slice(&v[..point.size]);
                let pushed = times(s, &v[..point.size]);
                let P = &mut dP[own.clone()];
                P.iter_mut().zip(pushed).for_each(|(P, s)| *P -= s);
                image[own].copy_from_slice(&of_rows(rows, P, &v)[..point.size]);
            }
            for (k, &(j, _, spring)) in self.pins.iter().enumerate() {
                let k = self.set.len() + k;
                dP[k] -= spring * du[j];
                image[k] = dP[k];
            }
            forces.push(dP);
            jumps.push(dv);
            Some(image)
        })?;
        let sum = |vectors: &[Vec<f64>]| {
            let mut sum = vec![0.0; vectors.first().map_or(0, Vec::len)];
            let pairs = y.iter().zip(vectors);
            pairs.for_each(|(y, vector)| add(*y, vector, &mut sum));
            sum
        };
        Some((sum(&forces), sum(&jumps)))
    }
}

impl Point {
    /// Pairs of unknowns, the first not before the second, with their coefficients.
    fn pairs(&self) -> impl Iterator<Item = (usize, usize, [f64; 3], [f64; 3])> + '_ {
        let b = &self.b;
        (b.iter().enumerate())
            .flat_map(move |(k, &(j, d))| b[k..].iter().map(move |&(i, b)| (i, j, b, d)))
    }

    /// L⁻¹ and S; `None` where L is singular.
    fn spring(&self, rows: &[PointRow; 3]) -> Option<Spring> {
        let n = self.size;
        let l = faer::Mat::from_fn(n, n, |k, l| rows[k].a[l] + rows[k].c[l] / self.stiff[l]);
        let lu = DenseLu::new(&l)?;
        let mut inverse = [[0.0; 3]; 3];
        for l in 0..n {
            let unit: Vec<f64> = (0..n).map(|k| f64::from(u8::from(k == l))).collect();
            let column = lu.solve(&unit)?;
            (0..n).for_each(|k| inverse[k][l] = column[k]);
        }
        let entry = |k: usize, l: usize| (0..n).map(|p| inverse[k][p] * rows[p].c[l]).sum();
        let s = positive([0, 1, 2].map(|k| [0, 1, 2].map(|l| entry(k, l))));
        Some(Spring { inverse, s })
    }
}

/// The symmetric part of a block, normal and tangential alone, without negative eigenvalues.
fn positive(d: Block) -> Block {
    let (a, b, c) = (d[1][1], 0.5 * (d[1][2] + d[2][1]), d[2][2]);
    let (mean, half) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
    // By the projectors on both eigenvectors.
    let [low, high] = [mean - half, mean + half].map(|e| e.max(0.0));
    let (sum, turn) = (
        0.5 * (low + high),
        if half > 0.0 {
            0.5 * (high - low) / half
        } else {
            0.0
        },
    );
    let [tilt, shear] = [0.5 * (a - c) * turn, b * turn];
    [
        [d[0][0].max(0.0), 0.0, 0.0],
        [0.0, sum + tilt, shear],
        [0.0, shear, sum - tilt],
    ]
}

/// A P + C v of the rows of a point.
fn of_rows(rows: &[PointRow; 3], P: &[f64], v: &[f64]) -> [f64; 3] {
    let sum = |row: &PointRow| {
        let pairs = P.iter().zip(v).enumerate();
        pairs.map(|(l, (P, v))| row.a[l] * P + row.c[l] * v).sum()
    };
    [0, 1, 2].map(|k| sum(&rows[k]))
}

fn times(block: &Block, x: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|k| block[k].iter().zip(x).map(|(b, x)| b * x).sum())
}

/// K with room for what springs at the points couple.
fn widened(K: &SquareMatrix, points: &[Point]) -> Result<SquareMatrix, MethodError> {
    let pairs = points.iter().flat_map(Point::pairs);
    let mut coupled: Vec<(usize, usize)> = pairs.map(|(i, j, ..)| (j, i)).collect();
    coupled.sort_unstable();
    coupled.dedup();
    let mut more = coupled.into_iter().peekable();
    let (mut begin, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..K.size() {
        for (i, value) in K.column(j) {
            while let Some((_, new)) = more.next_if(|own| *own < (j, i)) {
                rows.push(new);
                values.push(0.0);
            }
            more.next_if(|own| *own == (j, i));
            rows.push(i);
            values.push(value);
        }
        while let Some((_, new)) = more.next_if(|own| own.0 == j) {
            rows.push(new);
            values.push(0.0);
        }
        begin.push(rows.len());
    }
    SquareMatrix::symmetric(K.size(), begin, rows, values)
}

/// W δP + Q δβ with the rigid motion of what is held to be δv, δβ = Qᵀ (δv − W δP); and δβ.
fn followed(problem: &ContactProblem<'_>, dP: &[f64], dv: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut v = vec![0.0; dP.len()];
    problem.operator.w.apply_add(dP, &mut v);
    let modes = &problem.operator.modes;
    let beta = modes.components(&minus(dv, &v));
    modes.add(&beta, &mut v);
    (v, beta)
}
