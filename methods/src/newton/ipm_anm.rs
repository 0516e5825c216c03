//! Interior-point method that follows its path by power series.
//!
//! Nguyen, Acary & Armand, asymptotic numerical method in interior-point methods for frictional contact (2025); the series:
//! Cochelin, Damil & Potier-Ferry, Int. J. Numer. Meth. Engng 37 (1994) 1187. Written here for the cones of `interior-point`.
//!
//! ```text
//! F(x) = (v − q − W P − Q β,  Qᵀ P − c,  P_n g,  (P_n, P_t/μ) ∘ (λ, d)),  x = (P, β, v, λ)      quadratic in x; F = 0: the laws
//! F(x(a)) = σ(a)²/σ² F(x)                    a path from x inside the cones, where σ = 1, to a solution, σ = 0; it never leaves them
//!
//! x(a) = x + Σ aᵏ x_k,  σ(a) = σ + Σ aᵏ σ_k   by arc length a: ⟨x_1, x_1⟩ + σ_1² = 1,  ⟨x_k, x_1⟩ + σ_k σ_1 = 0
//! F'(x) x_k − 2σ_k/σ F(x) = Σ_{0<i<k} (σ_i σ_{k−i}/σ² F(x) − B(x_i, x_{k−i}))               B: the quadratic part
//! a = (ε |x_1| / |x_N|)^(1/(N−1))            where the last term is ε of the first
//! ```
//! One LU a step for all N terms. Every step follows the path through the iterate, so that there is nothing to correct; it ends
//! where products of a point are further than 0.3 from their share. By arc length the path may turn back in σ, as it does where
//! friction lets solutions vanish; a method that lowers σ stalls there. In σ², not σ, points that neither press nor open at the solution
//! leave the path smooth. ⟨·,·⟩ is taken in units of the reference force and jump. Whenever σ has fallen to a tenth, Newton's method
//! with active sets (see `pdas`) is tried from the path, and given up after 8 steps without progress.
//!
//! # Options
//! `order`: N. `accuracy`: ε. `max_iterations`: steps.
//!
//! # Guarantees
//! F' is regular along the path but for turns, which the arc length takes, and a path that stays bounded ends in a solution. Redundant
//! points are no obstacle: inside the cones the matrix is regular. `stickslip study random` with seed 1, 200 problems for each of
//! seven μ from 0 to 5 in 2D and 3D, tier high: all 2800 solved, in 10 steps in the median and 156 at most. It takes hundreds where the path winds: 330 on RockPile
//! of the Siconos benchmark (463 points, μ = 1). A step costs about four of a Newton method on few points, hardly more than one on many.
//!
//! # Failure modes
//! A path that runs away to infinity is left for one from deeper inside. Ends with `max-iterations` where paths wind for longer, or
//! always run away: no solution need exist.
//!
//! # Skips
//! Points without friction have no cone. No line search, no switching of branches.

use crate::algebra::dense::dot;
use crate::condensed::branches::Branches;
use crate::condensed::forces::{End, Ended};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{Check, ContactProblem, Limits};
use crate::contract::options::options;
use crate::contract::registry::{Method, Needs};
use crate::contract::state::{Monitor, Status};
use crate::newton::central_path::Products;
use crate::newton::interior_point::cross_over;
use crate::newton::path_equations::{Iterate, Lack, PathEquations};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "ipm-anm",
    label: "Interior point by series",
    reference: "Nguyen, Acary & Armand (2025); Cochelin, Damil & Potier-Ferry, Int. J. Numer. Meth. Engng 37 (1994) 1187",
    summary: "follows the path of an interior-point method by power series in its arc length, around turns",
    exact: true,
    options: IpmAnm::OPTIONS,
    source: include_str!("ipm_anm.rs"),
    build: |options| Box::new(IpmAnm::new(options)),
};

options! {
    IpmAnm {
        order: Count(SERIES.0 as i64, 2, 100), "terms of the series of a step";
        accuracy: Real(SERIES.1, 1e-14, 0.1), "last term of a step, relative to the first";
        max_iterations: Count(2000, 1, 1_000_000), "steps before giving up";
    }
}

/// Terms and accuracy by default.
pub(crate) const SERIES: (usize, f64) = (20, 1e-5);
/// σ below which Newton's method is tried from the path, and again each time that it has fallen to this part.
const NEAR: f64 = 1e-2;
const AGAIN: f64 = 0.1;
/// Newton steps without progress after which the path is taken up again.
const PATIENCE: usize = 8;
/// A path with a violation above this runs away; another begins deeper inside the cones.
const FAR: f64 = 1e6;
const DEEPER: f64 = 10.0;
/// Distance from the path that a step may end at, relative to the products there.
const NEIGHBOURHOOD: f64 = 0.3;
/// A step that leaves this neighbourhood or σ > 0 is shortened by this factor.
const SHORTER: f64 = 0.8;
/// Most often that a step is shortened: then rounding has taken over.
const MOST_CUTS: usize = 100;
/// Longest step: of a series that ends, as without friction, the last term is no bound.
const LONGEST: f64 = 1e6;
/// The step to the end of the path leaves at most this part of σ.
const LEFT: f64 = 1e-3;

impl CondensedMethod for IpmAnm {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let limits = Limits::new(self.max_iterations, usize::MAX / 2);
        along_series(problem, (self.order, self.accuracy), limits, monitor)
    }
}

/// The loop, from the start of the increment until it ends.
pub(crate) fn along_series(
    problem: &mut ContactProblem<'_>,
    (order, accuracy): (usize, f64),
    limits: Limits,
    monitor: &mut dyn Monitor,
) -> Ended {
    let (mut at, mut v, mut depth) = (problem.start(), Vec::new(), 1.0);
    let (mut path, mut branches) = (Path::from(problem, depth), Branches::default());
    let mut cross = NEAR;
    let status = loop {
        problem.jump_into(&at.p, &at.beta, &mut v);
        let changes = branches.changes(problem, &at.p, &v);
        let violation = problem.violation(&at.p, &v);
        match problem.check(violation, (&at.p, &at.beta), changes, limits, monitor)? {
            Check::GoOn => {}
            Check::Corrected => continue,
            Check::End(status) => break status,
        }
        if violation > FAR {
            depth *= DEEPER;
            (path, cross) = (Path::from(problem, depth), NEAR);
        }
        problem.counters.factorisations += 1;
        if !path.expand(problem, order) {
            break problem.singular();
        }
        if !path.advance(problem, accuracy) {
            break Status::Stalled;
        }
        path.here.x.forces(problem, &mut at);
        if path.here.sigma < cross {
            cross = AGAIN * path.here.sigma;
            let limits = Limits::new(limits.iterations, PATIENCE);
            let end = cross_over(problem, &at, limits, monitor)?;
            if end.is_final() {
                return Ok(end);
            }
        }
    };
    Ok(End { status, at })
}

/// A place on the path, a term of its series, or its tangent.
#[derive(Clone, Default)]
struct Place {
    x: Iterate,
    sigma: f64,
}

/// Where the path stands, and its series there.
struct Path {
    here: Place,
    /// −F(x) here.
    lack: Lack,
    /// Terms from x_1 on.
    series: Vec<Place>,
    /// Its direction at the end of the last step.
    tangent: Option<Place>,
    equations: PathEquations,
}

impl Path {
    /// From the start of the increment, moved so deep inside the cones.
    fn from(problem: &ContactProblem<'_>, depth: f64) -> Self {
        let (mut x, start) = (Iterate::default(), problem.start());
        let jump = problem.jump(&start.p, &start.beta);
        x.begin(problem, &start, &jump, depth);
        Self {
            here: Place { x, sigma: 1.0 },
            lack: Lack::default(),
            series: Vec::new(),
            tangent: None,
            equations: PathEquations::default(),
        }
    }

    /// The series at this place; false if the matrix is singular.
    fn expand(&mut self, problem: &ContactProblem<'_>, order: usize) -> bool {
        let Place { x, sigma } = &self.here;
        self.lack.read(problem, x);
        if !self.equations.factor(problem, x) {
            return false;
        }
        // x_k = σ_k y + z_k,  F' y = 2/σ F(x).
        let (mut y, mut right) = (Iterate::default(), self.lack.times(-2.0 / sigma));
        if !(self.equations).direction(problem, x, &right, &mut y) {
            return false;
        }
        let square = 1.0 + product(problem, &y, &y);
        let ahead = (self.tangent.as_ref()).map_or(-1.0, |t| product(problem, &y, &t.x) + t.sigma);
        let mut first = Place {
            x: y.clone(),
            sigma: 1.0,
        };
        first.scale(square.sqrt().recip().copysign(ahead));
        self.series.clear();
        self.series.push(first);
        for _ in 2..=order {
            let pairs = || self.series.iter().zip(self.series.iter().rev());
            let squares: f64 = pairs().map(|(a, b)| a.sigma * b.sigma).sum();
            right = self.lack.times(-squares / (sigma * sigma));
            for (a, b) in pairs() {
                for (i, own) in right.products.iter_mut().enumerate() {
                    let pair = a.x.at(problem, i).products_with(&b.x.at(problem, i));
                    *own = own.plus(-1.0, &pair);
                }
            }
            let mut term = Place::default();
            if !(self.equations).direction(problem, x, &right, &mut term.x) {
                return false;
            }
            term.sigma = -product(problem, &term.x, &y) / square;
            term.x.move_along(term.sigma, &y);
            self.series.push(term);
        }
        true
    }

    /// Along the series as far as it is accurate, inside the cones and above σ = 0; false if that is nowhere.
    fn advance(&mut self, problem: &ContactProblem<'_>, accuracy: f64) -> bool {
        let (Some(first), Some(last)) = (self.series.first(), self.series.last()) else {
            return false;
        };
        let size = |term: &Place| (product(problem, &term.x, &term.x) + term.sigma.powi(2)).sqrt();
        let ratio = accuracy * size(first) / size(last);
        let mut a = ratio
            .powf(1.0 / (self.series.len() - 1) as f64)
            .min(LONGEST);
        for _ in 0..MOST_CUTS {
            if self.sigma(a) <= 0.0 {
                a = self.before_the_end(a);
            }
            let next = self.at(a);
            if self.is_near(problem, &next) {
                self.tangent = Some(self.derivative(a));
                self.here = next;
                return true;
            }
            a *= SHORTER;
        }
        false
    }

    /// Whether a place is inside the cones, its products within [`NEIGHBOURHOOD`] of those on the path.
    fn is_near(&self, problem: &ContactProblem<'_>, place: &Place) -> bool {
        let part = (place.sigma / self.here.sigma).powi(2);
        let is_near = |(i, lack): (usize, &Products)| {
            let point = place.x.at(problem, i);
            let off = point.products().plus(part, lack);
            let [a, b] = off.vector;
            point.is_inside()
                && off.normal.abs() <= -NEIGHBOURHOOD * part * lack.normal
                && off.scalar.hypot(a).hypot(b) <= -NEIGHBOURHOOD * part * lack.scalar
        };
        self.lack.products.iter().enumerate().all(is_near)
    }

    /// x(a), σ(a).
    fn at(&self, a: f64) -> Place {
        let terms = self.series.iter().rev().chain([&self.here]);
        Place::horner(a, terms.map(|term| (1.0, term)))
    }

    /// The derivatives of both.
    fn derivative(&self, a: f64) -> Place {
        let powers = 1..=self.series.len();
        let terms = powers.rev().zip(self.series.iter().rev());
        Place::horner(a, terms.map(|(k, term)| (k as f64, term)))
    }

    fn sigma(&self, a: f64) -> f64 {
        let terms = self.series.iter().rev().chain([&self.here]);
        terms.fold(0.0, |sum, term| a * sum + term.sigma)
    }

    /// Shortly before the first a in sight where σ = 0.
    fn before_the_end(&self, a: f64) -> f64 {
        let (mut begin, mut end) = (0.0, a);
        while self.sigma(begin) > LEFT * self.here.sigma && end - begin > f64::EPSILON * a {
            let middle = 0.5 * (begin + end);
            if self.sigma(middle) > 0.0 {
                begin = middle;
            } else {
                end = middle;
            }
        }
        begin
    }
}

impl Place {
    /// Σ aᵏ c_k x_k from factors and terms, the last first.
    fn horner<'a>(a: f64, terms: impl Iterator<Item = (f64, &'a Place)>) -> Self {
        let mut terms = terms.map(|(factor, term)| (factor, term.clone()));
        let Some((factor, mut sum)) = terms.next() else {
            return Self::default();
        };
        sum.scale(factor);
        for (factor, term) in terms {
            sum.scale(a);
            sum.x.move_along(factor, &term.x);
            sum.sigma += factor * term.sigma;
        }
        sum
    }

    fn scale(&mut self, factor: f64) {
        self.x.scale(factor);
        self.sigma *= factor;
    }
}

/// ⟨x, y⟩ in units of the reference force and jump.
fn product(problem: &ContactProblem<'_>, x: &Iterate, y: &Iterate) -> f64 {
    let force = problem.reference_force();
    let jump = force / problem.operator.rho;
    dot(&x.P, &y.P) / (force * force)
        + (dot(&x.v, &y.v) + dot(&x.lambda, &y.lambda)) / (jump * jump)
}
