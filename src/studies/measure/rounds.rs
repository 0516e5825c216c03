//! Times of several methods on one problem, taken in turn: a round has every method follow the load path once, so that drift
//! of the machine meets all of them alike.
//!
//! In every round a method is built and prepared anew and solves every increment from the state in which the first round
//! began it; only these calls are timed. A round that ends in other bits than the first is an error of the method: the same
//! increment twice must give the same bits.

use stickslip_methods::{ContactState, Increment, Load};

use super::bench::Scene;
use crate::run::choice::Choice;
use crate::run::loads::Posed;
use crate::run::path::Solver;
use crate::run::verdict::Verdict;
use crate::studies::record::Times;
use crate::studies::statistics::Timing;
use crate::studies::task::Asked;

/// How often a cell is repeated for its times.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Repeats {
    /// At least so often, unless `patience_s` is spent.
    pub least: usize,
    /// At most so often.
    pub most: usize,
    /// Until so much time was spent in the repetitions [s].
    pub seconds: f64,
    /// Never longer than this, apart from the repetition that crosses it [s].
    pub patience_s: f64,
}

impl Repeats {
    /// Seven for an interval of the median, more while they cost little.
    pub const DEFAULT: Self = Self {
        least: 7,
        most: 200,
        seconds: 0.05,
        patience_s: 2.0,
    };

    fn enough(&self, done: usize, spent_s: f64) -> bool {
        done >= self.most
            || (done >= self.least && spent_s >= self.seconds)
            || (done > 0 && spent_s >= self.patience_s)
    }
}

/// Times of some tasks on one problem with their methods, all with an honest answer; the verdict is on a method that errs or
/// finds other bits when asked again.
pub fn in_turn(
    scene: &Scene<'_>,
    tasks: &[(&Asked, &Choice)],
    repeats: Repeats,
) -> Vec<Result<Times, Verdict>> {
    let posed = scene.posed();
    let path = Path {
        posed,
        rest: ContactState::zero(posed.system),
    };
    let mut runners: Vec<Runner> = tasks.iter().copied().map(Runner::new).collect();
    while runners.iter().any(|own| own.goes_on(repeats)) {
        for own in runners.iter_mut().filter(|own| own.goes_on(repeats)) {
            own.broken = own.round(&path).err();
        }
    }
    runners.into_iter().map(Runner::times).collect()
}

/// The path that all methods follow.
struct Path<'a> {
    posed: Posed<'a>,
    rest: ContactState,
}

/// One method.
struct Runner<'a> {
    asked: &'a Asked,
    choice: &'a Choice,
    /// At the end of every increment, found in the first round.
    states: Vec<ContactState>,
    /// Preparation, solution, enforcement, and that by the account of a program from outside, by round [s].
    samples: [Vec<f64>; 4],
    /// Preparation and solution of all rounds [s].
    spent_s: f64,
    broken: Option<Verdict>,
}

impl<'a> Runner<'a> {
    fn new((asked, choice): (&'a Asked, &'a Choice)) -> Self {
        Runner {
            asked,
            choice,
            states: Vec::new(),
            samples: Default::default(),
            spent_s: 0.0,
            broken: None,
        }
    }

    fn goes_on(&self, repeats: Repeats) -> bool {
        self.broken.is_none() && !repeats.enough(self.samples[0].len(), self.spent_s)
    }

    fn round(&mut self, path: &Path<'_>) -> Result<(), Verdict> {
        let Posed { system, loads } = path.posed;
        let mut solver = Solver::new(self.choice, system)?;
        let mut sums = [solver.prepare_s, 0.0, 0.0, 0.0];
        let mut start_load: Load = loads.before();
        for (index, number) in (loads.first()..=loads.last()).enumerate() {
            let load = loads.at(number);
            let problem = Increment {
                system,
                load: &load,
                start_load: &start_load,
                start: index.checked_sub(1).map_or(&path.rest, |i| &self.states[i]),
                guess: self.asked.cold.then_some(&path.rest.p[..]),
                index,
                tolerance: self.asked.accuracy().asked,
            };
            let (outcome, seconds) = solver.solve(&problem);
            sums[1] += seconds.total_s;
            sums[2] += seconds.enforcement_s;
            sums[3] += seconds.reported_s.unwrap_or(f64::NAN);
            let state = outcome?.state;
            match self.states.get(index) {
                None => self.states.push(state),
                Some(first) if *first == state => {}
                Some(_) => {
                    let message = "the same increment gave other bits when it was solved again";
                    return Err(Verdict::Crashed(message.into()));
                }
            }
            start_load = load;
        }
        self.spent_s += sums[0] + sums[1];
        (self.samples.iter_mut().zip(sums)).for_each(|(own, sum)| own.push(sum));
        Ok(())
    }

    fn times(self) -> Result<Times, Verdict> {
        if let Some(broken) = self.broken {
            return Err(broken);
        }
        let [prepare, solve, enforcement, reported] = self.samples.map(|own| Timing::of(&own));
        let times = prepare.zip(solve).zip(enforcement);
        let times = times.map(|((prepare, solve), enforcement)| Times {
            prepare,
            solve,
            enforcement,
            reported,
        });
        times.ok_or_else(|| Verdict::Crashed("a time that is not finite".into()))
    }
}
