//! Why a run gave up. Causes are asked in the order of [`Cause`]; the first whose measurement says yes is the one.
//!
//! The problem comes first where nothing could have solved it, then what the run itself shows, then the problem again: a
//! cycle on a problem with several solutions is a cycle, and the number of solutions stands beside it.

use serde::{Deserialize, Serialize};

use super::active::{loaded, tangent};
use super::answers::{Answers, Proof};
use super::watch::{RING, State, Watch};
use crate::files::nan;
use crate::run::verdict::Verdict;
use stickslip_methods::Status;

/// Periods of a cycle that must be seen.
const PERIODS: usize = 3;
/// Longest period looked for: three fit into what is kept. Newton methods give up after 60 iterations without progress,
/// three periods of 20.
const LONGEST: usize = RING / PERIODS;
/// Relative change of the violation over a period that counts as repetition.
const REPEATS: f64 = 1e-2;
/// Ratio of violations within a period, or at the end, from which they vary where no state changes.
const VARIES: f64 = 1.1;
/// Smallest singular value over the largest at which a tangent counts as singular.
const SINGULAR: f64 = 1e-10;
/// Multiple of the rounding of v = q + W P that counts as the floor.
const FLOOR: f64 = 100.0;
/// Iterates at the end whose least violation is what the run came to.
const TAIL: usize = 20;
/// Iterations over which a rate is observed: the last half, and at least so many.
const LEAST: usize = 8;
/// Condition number of W on the loaded rows from which it is bad.
const CONDITION: f64 = 1e4;
/// A rate is explained by the condition κ if 1 − rate <= this / √κ: no gradient method does better than 1 − 2/√κ.
const EXPLAINED: f64 = 4.0;

macro_rules! causes {
    ($($(#[$doc:meta])* $cause:ident = $name:literal,)*) => {
        /// Why a run gave up, in the order in which they are asked.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum Cause {
            $($(#[$doc])* $cause,)*
        }

        impl Cause {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$cause),*];

            /// Name in tables.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$cause => $name,)*
                }
            }
        }
    };
}

causes! {
    /// No exact method finds a solution, and it is proved that there is none. Measure: combinations of states tried, nothing
    /// where no force within the cones of friction balances the load.
    NoSolution = "no-solution",
    /// The method met a matrix that it could not factor, and the tangent on the last states is singular. Measure: its
    /// smallest singular value over the largest.
    SingularTangent = "singular-tangent",
    /// An inner iteration did not converge: the method ended at a limit of iterations that is not its own. Measure: iterations
    /// up to there.
    Inner = "inner-iteration",
    /// The violation came to rest within 100 times the rounding of v = q + W P. Measure: over that rounding.
    Floor = "floor",
    /// The states of the points repeat with a period of at least 2, and the violation with them; or no state changes and the
    /// violation alone repeats. Measure: least violation at the end.
    Cycle = "cycle",
    /// Still converging, at a rate that the condition of W on the loaded rows explains. Measure: that condition. Or at rest, and
    /// what is missing to the nearest solution known is what W hardly feels. Measure: λ_max |ΔP|² / ΔPᵀ W ΔP, the condition
    /// along ΔP.
    Conditioning = "conditioning",
    /// Still converging. Measure: least violation.
    Slow = "slow",
    /// Several solutions are known. Measure: largest difference of forces between them, over the largest force.
    SeveralSolutions = "several-solutions",
    /// Points keep changing their states, or the violation rises and falls, without a period. Measure: how many points change.
    Wandering = "wandering",
    /// None of these. Measure: least violation at the end.
    Unexplained = "unexplained",
}

impl Cause {
    /// The change to make.
    pub fn advice(self) -> &'static str {
        match self {
            Self::NoSolution => "no method can: other loads, supports or friction",
            Self::SingularTangent => "a method without a tangent, e.g. nsgs or admm, or hybrid",
            Self::Inner => "more inner iterations, or a method without them, e.g. hybrid",
            Self::Floor => "a lower tier: rounding allows no more",
            Self::Cycle => "another starting scale (option r), or hybrid",
            Self::Conditioning => {
                "a Newton method, e.g. hybrid: first-order ones feel the condition of W"
            }
            Self::Slow => {
                "more iterations (option max_iterations), or a Newton method, e.g. hybrid"
            }
            Self::SeveralSolutions => "smaller increments: several solutions are known",
            Self::Wandering | Self::Unexplained => "hybrid or interior-point",
        }
    }
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// Observations that a cause is decided from.
pub struct Evidence<'a> {
    /// How the run ended.
    pub verdict: &'a Verdict,
    /// Whether the method's limit are the contact laws.
    pub exact: bool,
    /// Violation asked for.
    pub tolerance: f64,
    /// The method's own limit of iterations, if it has one.
    pub limit: Option<f64>,
    /// Course of its iterates.
    pub watch: &'a Watch<'a>,
    /// Solutions of the problem.
    pub answers: &'a Answers,
}

/// A cause with what decided.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// The cause.
    pub cause: Cause,
    /// Iterations after which a cycle repeats.
    pub period: Option<usize>,
    /// Points that change their state within a cycle, from 0.
    pub flips: Vec<usize>,
    /// Measure that decides the cause, see [`Cause`].
    #[serde(with = "nan")]
    pub measure: f64,
    /// Factor by which an iteration reduces the violation, where it still falls; of an approximate method that by which the
    /// change of forces falls.
    pub rate: Option<f64>,
    /// Iterations that are left at that rate.
    pub more: Option<f64>,
}

impl Diagnosis {
    /// The first cause that holds.
    pub fn of(e: &Evidence<'_>) -> Self {
        let none = Diagnosis {
            cause: Cause::Unexplained,
            period: None,
            flips: Vec::new(),
            measure: least(e.watch),
            rate: None,
            more: None,
        };
        if let Some(proof) = e.answers.none {
            let measure = match proof {
                Proof::Certificate => f64::NAN,
                Proof::Enumeration(pieces) => pieces as f64,
            };
            return Diagnosis {
                cause: Cause::NoSolution,
                measure,
                ..none
            };
        }
        if let Some(measure) = singular(e) {
            return Diagnosis {
                cause: Cause::SingularTangent,
                measure,
                ..none
            };
        }
        let steps = e.watch.seen().len() as f64 - 1.0;
        let at_a_limit = *e.verdict == Verdict::GaveUp(Status::MaxIterations);
        if at_a_limit && e.limit.is_some_and(|limit| steps < limit) {
            return Diagnosis {
                cause: Cause::Inner,
                measure: steps,
                ..none
            };
        }
        let last = e.watch.states().back().zip(e.watch.last());
        if let (true, Some((_, (p, _)))) = (e.exact, last) {
            let above = none.measure / e.watch.gauge.floor(p);
            if above <= FLOOR {
                return Diagnosis {
                    cause: Cause::Floor,
                    measure: above,
                    ..none
                };
            }
        }
        if let Some((period, flips)) = cycle(e.watch) {
            return Diagnosis {
                cause: Cause::Cycle,
                period: Some(period),
                flips,
                ..none
            };
        }
        if let (Some((rate, left)), Some((states, _))) = (falling(e), last) {
            let found = Diagnosis {
                cause: Cause::Slow,
                rate: Some(rate),
                more: Some((left / rate.ln()).abs().ceil()),
                ..none
            };
            let condition = loaded(e.watch.gauge, states).map(|s| s.condition());
            return match condition.filter(|&k| explains(k, rate)) {
                Some(measure) => Diagnosis {
                    cause: Cause::Conditioning,
                    measure,
                    ..found
                },
                None => found,
            };
        }
        if e.answers.solutions > 1 {
            return Diagnosis {
                cause: Cause::SeveralSolutions,
                measure: e.answers.apart,
                ..none
            };
        }
        if let Some(flips) = wandering(e.watch) {
            return Diagnosis {
                cause: Cause::Wandering,
                measure: flips.len() as f64,
                flips,
                ..none
            };
        }
        match along_error(e).filter(|&k| k >= CONDITION) {
            Some(measure) => Diagnosis {
                cause: Cause::Conditioning,
                measure,
                ..none
            },
            None => none,
        }
    }
}

/// Least violation of the last iterates; NaN of none.
fn least(watch: &Watch<'_>) -> f64 {
    let tail = watch.seen().iter().rev().take(TAIL);
    tail.map(|seen| seen.violation).fold(f64::NAN, f64::min)
}

/// Distance of the tangent from singular, where it is and the method said so.
fn singular(e: &Evidence<'_>) -> Option<f64> {
    let said = [Status::SingularTangent, Status::Mechanism].map(Verdict::GaveUp);
    let (states, at) = (e.watch.states().back()?, e.watch.last()?);
    let spectrum = said
        .contains(e.verdict)
        .then(|| tangent(e.watch.gauge, states, at))??;
    let distance = spectrum.distance();
    (distance <= SINGULAR).then_some(distance)
}

/// Period of the last iterates, and the points that change within it.
fn cycle(watch: &Watch<'_>) -> Option<(usize, Vec<usize>)> {
    let violations: Vec<f64> = watch.seen().iter().map(|seen| seen.violation).collect();
    let states: Vec<&Vec<State>> = watch.states().iter().collect();
    let violations = violations.get(violations.len() - states.len()..)?;
    (2..=LONGEST).find_map(|period| {
        let count = PERIODS * period;
        let from = states.len().checked_sub(count)?;
        let (states, violations) = (&states[from..], &violations[from..]);
        let same = |k: usize| {
            let (a, b) = (violations[k], violations[k - period]);
            states[k] == states[k - period] && (a - b).abs() <= REPEATS * b
        };
        if !(period..count).all(same) {
            return None;
        }
        let one = &states[count - period..];
        let flips = changing(one);
        (!flips.is_empty() || varies(&violations[count - period..])).then_some((period, flips))
    })
}

/// Points whose states are not all the same.
fn changing(states: &[&Vec<State>]) -> Vec<usize> {
    let points = 0..states.first().map_or(0, |first| first.len());
    let changes = |i: &usize| states.windows(2).any(|two| two[0][*i] != two[1][*i]);
    points.filter(changes).collect()
}

/// Whether the largest exceeds the least by more than rounding and slow drift.
fn varies(violations: &[f64]) -> bool {
    let largest = violations.iter().copied().fold(0.0, f64::max);
    let least = violations.iter().copied().fold(f64::INFINITY, f64::min);
    largest > VARIES * least
}

/// Points that change in the last iterates, if some do in at least every second of them or the violation varies.
fn wandering(watch: &Watch<'_>) -> Option<Vec<usize>> {
    let states: Vec<&Vec<State>> = watch.states().iter().collect();
    let tail = &states[states.len().saturating_sub(TAIL)..];
    let moved = tail.windows(2).filter(|two| two[0] != two[1]).count();
    let seen = watch.seen();
    let last = &seen[seen.len().saturating_sub(TAIL)..];
    let violations: Vec<f64> = last.iter().map(|seen| seen.violation).collect();
    let restless = 2 * moved + 1 >= tail.len() || varies(&violations);
    (restless && tail.len() == TAIL).then(|| changing(tail))
}

/// Rate of linear convergence over the last half of the run, and ln(target / what there is at the end): by a line through
/// the logarithms, which must have halved. Without a violation to bring to zero the change of forces is taken. Methods stop
/// at half of what is asked for.
fn falling(e: &Evidence<'_>) -> Option<(f64, f64)> {
    let seen = e.watch.seen();
    let of = |k: usize| {
        if e.exact {
            seen[k].violation
        } else {
            seen[k].force_change
        }
    };
    let from = (seen.len() / 2).min(seen.len().checked_sub(LEAST)?);
    let points: Vec<(f64, f64)> = (from..seen.len())
        .map(|k| (k as f64, of(k).ln()))
        .filter(|(_, y)| y.is_finite())
        .collect();
    let count = points.len() as f64;
    let mean = |get: fn(&(f64, f64)) -> f64| points.iter().map(get).sum::<f64>() / count;
    let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = points.iter().map(|(x, y)| (x - x0) * (y - y0)).sum();
    let variance: f64 = points.iter().map(|(x, _)| (x - x0).powi(2)).sum();
    let slope = covariance / variance;
    let steps = (seen.len() - from) as f64;
    let here = of(seen.len().checked_sub(1)?).ln();
    let falls = slope * steps <= -std::f64::consts::LN_2;
    falls.then(|| (slope.exp(), ((0.5 * e.tolerance).ln() - here).min(0.0)))
}

/// λ_max |ΔP|² / ΔPᵀ W ΔP with ΔP from the last iterate to the nearest solution, λ_max that of W on the loaded rows. Both balance
/// the load, so that no choice of pins changes it.
fn along_error(e: &Evidence<'_>) -> Option<f64> {
    let (gauge, states, (p, _)) = (e.watch.gauge, e.watch.states().back()?, e.watch.last()?);
    let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let to = |solution: &Vec<f64>| -> Vec<f64> {
        let solution = gauge.rows().restrict(solution);
        solution.iter().zip(p).map(|(s, p)| s - p).collect()
    };
    let steps = e.answers.found.iter().map(to);
    let step = steps.min_by(|a, b| square(a).total_cmp(&square(b)))?;
    let columns = gauge.columns();
    let product = |(column, x): (&Vec<f64>, &f64)| -> f64 {
        x * column.iter().zip(&step).map(|(w, x)| w * x).sum::<f64>()
    };
    let energy: f64 = columns.iter().zip(&step).map(product).sum();
    let largest = loaded(gauge, states)?.largest;
    (energy > 0.0).then(|| largest * square(&step) / energy)
}

/// Whether a condition number is bad, and a rate no better than it allows.
fn explains(condition: f64, rate: f64) -> bool {
    condition >= CONDITION && 1.0 - rate <= EXPLAINED / condition.sqrt()
}
