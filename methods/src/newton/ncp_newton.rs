//! Newton's method on the smoothed min function of Coulomb's cone (Chen–Harker–Kanzow–Smale).
//!
//! Chen & Harker, SIAM J. Matrix Anal. Appl. 14 (1993) 1168, and Kanzow, SIAM J. Matrix Anal. Appl. 17 (1996) 851; on
//! second-order cones Fukushima, Luo & Tseng, SIAM J. Optim. 12 (2002) 436; for frictional contact Acary, Brémond & Huber, in
//! Advanced Topics in Nonsmooth Dynamics (2018) 375.
//!
//! ```text
//! x = (μ P_n, P_t),   y = r_t ((g + μ|d|)/μ, d)        De Saxcé: x ∈ L, y ∈ L, x∘y = 0 are the contact laws
//! L = { x : |x̄| <= x₀ },   x∘y = (x·y, x₀ ȳ + y₀ x̄)    second-order cone and its Jordan product
//!
//! Φ = ½ (x + y − (z² + 4 ε² e)^½),  z = x − y        e = (1, 0), z² = z∘z; for ε = 0: x − proj_L(z), the natural map
//! V (δP, δv) = −Φ,   v = (g, d) = q + W P + Q β,   Qᵀ P = c
//! δ(w^½) = L(w^½)⁻¹ δw/2,   L(a) b = a∘b
//! ```
//! Points without friction have the scalar function of x = P_n, y = r_n g. The eigenvalues of w = z² + 4 ε² e are sums of
//! squares in the frame of w̄, so that the root loses no digits next to the cone's boundary:
//! λ± = (z₀ ± z̄·û)² + |z̄ − û û·z̄|² + 4 ε², û = w̄/|w̄|.
//!
//! Two more of the family have files of their own: with P_n − max(z_n, 0) and P_t − proj_s(z_t) for s = μ max(P_n, 0) (Jean &
//! Moreau; min of each condition) this is `b-newton`, for s = μ max(z_n, 0) (Alart & Curnier) `newton-ac`.
//!
//! # Options
//! `r`: r_n = r/W_nn and r_t = r/mean(W_tt) per point. `max_iterations`. `monolithic`: 1 solves each step on all unknowns
//! of the body. ε is a tenth of what is violated, natural map times reference force per point, and
//! never grows; |d| is smoothed by ε/r_t in the derivative alone.
//!
//! # Guarantees
//! Locally superlinear at solutions where P and ṽ are strictly complementary. Full steps first, a non-monotone line search
//! after a rise of the merit Σ Φ²/r above the last five. No global guarantee: De Saxcé's term makes the problem no
//! programme.
//!
//! # Failure modes
//! With friction near 0 the two entries of y are of different size, g/μ and |d|, which costs steps on the way to the right
//! states; for large μ the merit has minima that are no solutions, and local and global stages (as in LATIN) move the
//! iterate on after 15 steps without progress. On random problems (`stickslip study random`, 200 per entry, tier high)
//! median steps and how many gave up:
//!
//! | μ                | 0  | 0.1 | 0.3 | 0.6 | 1  | 2  | 5     |
//! |------------------|----|-----|-----|-----|----|----|-------|
//! | 2D, this method  | 5  | 10  | 6   | 6   | 7  | 8  | 12    |
//! | 2D, `newton-ac`  | 2  | 3   | 3   | 3   | 3  | 2  | 2     |
//! | 3D, this method  | 6  | 15  | 7   | 7   | 8  | 12 | 22    |
//! | 3D, `newton-ac`  | 3  | 5   | 5   | 6   | 6  | 6, 1 | 6   |
//!
//! # Skips
//! An open crack is one linear solve; without friction there are no tangential rows. No row of a smoothed
//! function reads δP = const, so that open points stay in the dense LU.

#![allow(non_snake_case)]

use crate::condensed::point_row::PointRow;
use crate::condensed::problem::ContactProblem;
use crate::contract::law::{Branch, tangential_norm};
use crate::contract::options::options;
use crate::contract::registry::Method;
use crate::newton::contact_point::ContactPoint;
use crate::newton::iteration::{Newton, scheme_options};
use crate::newton::scheme::Scheme;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "ncp-newton",
    label: "Newton on complementarity functions",
    reference: "Fukushima, Luo & Tseng, SIAM J. Optim. 12 (2002) 436",
    summary: "Newton's method on the smoothed min function of Coulomb's cone and its dual",
    exact: true,
    options: &scheme_options(MAX_ITERATIONS),
    source: include_str!("ncp_newton.rs"),
    build: |options| {
        let scheme = SmoothedMin {
            epsilon: f64::INFINITY,
        };
        Box::new(Newton::new(scheme, options, &MAX_ITERATIONS))
    },
};

options! {
    MAX_ITERATIONS: Whole("max_iterations", 200, 1, 1_000_000): "Newton steps before giving up";
}

/// ε as a fraction of the violation.
const SMOOTHING: f64 = 0.1;
/// Least eigenvalue of a root, relative to its largest: at the tip and on the mantle at once any derivative will do.
const LEAST: f64 = 1e-14;

/// Φ and V; the loop is [`Newton::run`].
struct SmoothedMin {
    /// ε in N (2D: N/m).
    epsilon: f64,
}

/// (x₀, x̄).
type Spin = [f64; 3];

/// ½ (x + y − root).
fn half(x: Spin, y: Spin, root: Spin) -> Spin {
    [0, 1, 2].map(|k| 0.5 * (x[k] + y[k] - root[k]))
}

fn minus(x: Spin, y: Spin) -> Spin {
    [0, 1, 2].map(|k| x[k] - y[k])
}

/// x∘y.
fn product(x: Spin, y: Spin) -> Spin {
    let scalar = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    let vector = |k: usize| x[0] * y[k] + y[0] * x[k];
    [scalar, vector(1), vector(2)]
}

/// An element of the algebra by its eigenvalues and the direction of its vector.
struct Root {
    plus: f64,
    minus: f64,
    direction: [f64; 2],
}

impl Root {
    /// (z² + `square` e)^½.
    fn of_square(z: Spin, square: f64) -> Self {
        let w = product(z, z);
        let direction = [[w[1], w[2]], [z[1], z[2]]];
        let direction = direction.into_iter().find_map(unit).unwrap_or([0.0; 2]);
        let value = |sign: f64| {
            let along = z[1] * direction[0] + z[2] * direction[1];
            let across = z[2] * direction[0] - z[1] * direction[1];
            ((z[0] + sign * along).powi(2) + across * across + square).sqrt()
        };
        Self {
            plus: value(1.0),
            minus: value(-1.0),
            direction,
        }
    }

    fn spin(&self) -> Spin {
        let half = 0.5 * (self.plus - self.minus);
        let [a, b] = self.direction;
        [0.5 * (self.plus + self.minus), half * a, half * b]
    }

    /// L(root)⁻¹ b.
    fn divide(&self, b: Spin) -> Spin {
        let least = LEAST * self.plus.max(self.minus);
        let (plus, minus) = (self.plus.max(least), self.minus.max(least));
        let [u, v] = self.direction;
        let (along, across) = (b[1] * u + b[2] * v, b[2] * u - b[1] * v);
        let (up, down) = ((b[0] + along) / plus, (b[0] - along) / minus);
        let (along, across) = (0.5 * (up - down), 2.0 * across / (plus + minus));
        [
            0.5 * (up + down),
            along * u - across * v,
            along * v + across * u,
        ]
    }
}

/// x/|x|; `None` where it vanishes.
fn unit(x: [f64; 2]) -> Option<[f64; 2]> {
    let size = x[0].hypot(x[1]);
    (size > 0.0).then(|| x.map(|x| x / size))
}

impl SmoothedMin {
    /// x and y of a point.
    fn pair(at: &ContactPoint<'_>) -> (Spin, Spin) {
        let ContactPoint { mu, r, P, v } = *at;
        let (mut x, mut y) = ([0.0; 3], [0.0; 3]);
        x[..P.len()].copy_from_slice(P);
        for k in 0..P.len() {
            y[k] = r[k] * v[k];
        }
        if let Some(r_t) = r.get(1) {
            x[0] = mu * P[0];
            y[0] = r_t * (v[0] / mu + tangential_norm(v));
        }
        (x, y)
    }

    fn root(&self, x: Spin, y: Spin) -> Root {
        Root::of_square(minus(x, y), 4.0 * (self.epsilon * self.epsilon))
    }
}

/// Φ'(x, y; δx, δy).
fn derivative(root: &Root, (x, y): (Spin, Spin), (dx, dy): (Spin, Spin)) -> Spin {
    half(dx, dy, root.divide(product(minus(x, y), minus(dx, dy))))
}

impl Scheme for SmoothedMin {
    type Piece = Branch;

    fn equations(&self, at: &ContactPoint<'_>) -> [f64; 3] {
        let (x, y) = Self::pair(at);
        half(x, y, self.root(x, y).spin())
    }

    /// For the history alone: Φ has one piece.
    fn piece(&self, at: &ContactPoint<'_>) -> Branch {
        at.branch()
    }

    fn linearise(&self, at: &ContactPoint<'_>, _: Branch, rows: &mut [PointRow; 3]) {
        let ContactPoint { mu, r, P, v } = *at;
        let (x, y) = Self::pair(at);
        let root = self.root(x, y);
        // Of |d|, smoothed.
        let last = r.len() - 1;
        let length = tangential_norm(v).hypot(self.epsilon / r[last]);
        for l in 0..P.len() {
            let (mut dx, mut dy) = ([0.0; 3], [0.0; 3]);
            dx[l] = if l == 0 && last > 0 { mu } else { 1.0 };
            dy[l] = r[l];
            if l > 0 && length > 0.0 {
                dy[0] = r[l] * v[l] / length;
            } else if l == 0 && last > 0 {
                dy[0] = r[last] / mu;
            }
            let by_force = derivative(&root, (x, y), (dx, [0.0; 3]));
            let by_jump = derivative(&root, (x, y), ([0.0; 3], dy));
            for k in 0..P.len() {
                rows[k].a[l] = by_force[k];
                rows[k].c[l] = by_jump[k];
            }
        }
    }

    fn begin(&mut self) {
        self.epsilon = f64::INFINITY;
    }

    fn prepare(&mut self, problem: &ContactProblem<'_>, violation: f64) -> bool {
        let points = problem.rows.points() as f64;
        let force = problem.reference_force() / points.sqrt();
        let before = self.epsilon;
        self.epsilon = before.min(SMOOTHING * violation * force);
        self.epsilon != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        /// Away from the kinks, differences are the derivative. |d| is smoothed in the derivative alone.
        #[test]
        fn rows_are_the_derivative_of_the_equations(
            smoothed: bool, size in 1..=3_usize, mu in 0.1..3.0_f64, r in prop::array::uniform2(0.5..2.0_f64),
            P in prop::array::uniform3(-2.0..2.0_f64), v in prop::array::uniform3(-2.0..2.0_f64), l in 0..3_usize,
        ) {
            let l = l % size;
            let f = SmoothedMin { epsilon: if smoothed && size == 1 { 0.3 } else { 0.0 } };
            let r = [r[0], r[1], r[1]];
            let at = ContactPoint { mu, r: &r[..size], P: &P[..size], v: &v[..size] };
            let (x, y) = SmoothedMin::pair(&at);
            let root = f.root(x, y);
            prop_assume!(root.minus.min(root.plus) > 0.1 && (size == 1 || tangential_norm(&v[..size]) > 0.1));
            let mut rows = PointRow::reading([0.0; 3]);
            f.linearise(&at, Branch::Open, &mut rows);
            let h = 1e-6;
            let moved = |dp: f64, dv: f64| {
                let (mut P, mut v) = (P, v);
                P[l] += dp;
                v[l] += dv;
                f.equations(&ContactPoint { P: &P[..size], v: &v[..size], ..at })
            };
            let (p_up, p_down, v_up, v_down) = (moved(h, 0.0), moved(-h, 0.0), moved(0.0, h), moved(0.0, -h));
            for k in 0..size {
                let (a, c) = ((p_up[k] - p_down[k]) / (2.0 * h), (v_up[k] - v_down[k]) / (2.0 * h));
                prop_assert!((rows[k].a[l] - a).abs() < 1e-6, "{} {a}", rows[k].a[l]);
                prop_assert!((rows[k].c[l] - c).abs() < 1e-5, "{} {c}", rows[k].c[l]);
            }
        }

        /// Without smoothing the function vanishes where the laws hold, and nowhere else.
        #[test]
        fn the_function_vanishes_where_the_laws_hold(
            state in 0..3_usize, mu in 0.05..3.0_f64, angle in 0.0..6.3_f64,
            p_n in 0.1..10.0_f64, size in 0.01..10.0_f64,
        ) {
            let f = SmoothedMin { epsilon: 0.0 };
            let e = [angle.cos(), angle.sin()];
            let (P, v) = match state {
                0 => ([0.0; 3], [size, e[0], e[1]]),
                1 => ([p_n, 0.9 * mu * p_n * e[0], 0.9 * mu * p_n * e[1]], [0.0; 3]),
                _ => ([p_n, -mu * p_n * e[0], -mu * p_n * e[1]], [0.0, size * e[0], size * e[1]]),
            };
            let worst = |P: [f64; 3], v: [f64; 3]| {
                let H = f.equations(&ContactPoint { mu, r: &[1.0; 3], P: &P, v: &v });
                H.iter().fold(0.0, |m: f64, h| m.max(h.abs()))
            };
            prop_assert!(worst(P, v) < 1e-13 * (p_n + size) * (mu + 1.0 / mu), "{:e}", worst(P, v));
            // A force across a gap.
            let (P, v) = match state {
                0 => ([0.1, 0.0, 0.0], v),
                _ => (P, [0.1, v[1], v[2]]),
            };
            prop_assert!(worst(P, v) > 1e-4 * mu.min(1.0), "{:e}", worst(P, v));
        }
    }
}
