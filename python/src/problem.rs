//! A contact problem of arrays: u = W P + V λ + q, Vᵀ P + s = 0, with the contact laws at every point.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use numpy::IntoPyArray;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use stickslip::run::judged::{JudgedIncrement, Seconds};
use stickslip::run::path::Solver;
use stickslip::run::verdict::Verdict;
use stickslip::studies::exchange::problem_file::MOST_MOTIONS;
use stickslip::studies::exchange::{System, system};
use stickslip::studies::why::answers::Answers;
use stickslip::studies::why::explain;
use stickslip_methods::{
    Claim, ContactState, ContactSystem, Counters, Increment, Load, MethodError, Monitor, Outcome,
    PointStatus, Residuals, Status, point_status, residuals,
};

use crate::arrays::{columns, failed, operator, refused, vector, vector_of};
use crate::own::choice;

/// Time between two looks at signals: each takes the interpreter's lock.
const BETWEEN: Duration = Duration::from_millis(10);

/// What Python raised while a method ran.
pub type Raised = Arc<Mutex<Option<PyErr>>>;

/// The exception, if there is one.
pub fn taken(raised: &Raised) -> PyResult<()> {
    let mut raised = raised.lock().unwrap_or_else(PoisonError::into_inner);
    raised.take().map_or(Ok(()), Err)
}

/// The problem. `stickslip.solve` says what its arrays are.
#[pyclass(frozen)]
pub struct Problem {
    system: ContactSystem,
    loads: [Load; 2],
    /// Contact forces to begin from.
    start: Option<Vec<f64>>,
}

/// What was found: verdict, an outcome with what the judge measured, states of points and jump, and seconds.
type Found = (
    Verdict,
    Option<(Outcome, Residuals, Vec<PointStatus>, Vec<f64>)>,
    Seconds,
);

#[pymethods]
impl Problem {
    #[new]
    fn new(
        w: &Bound<'_, PyAny>,
        q: &Bound<'_, PyAny>,
        mu: &Bound<'_, PyAny>,
        dim: Option<usize>,
        pieces: Option<&Bound<'_, PyAny>>,
        start: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let q = vector("q", q)?;
        let (dim, mu) = friction(mu, dim, q.len())?;
        let w = operator(w, q.len())?;
        let start = start.map(|p| vector_of("start", p, q.len())).transpose()?;
        let pieces = pieces.map(|own| motions(own, q.len())).transpose()?;
        let motions = pieces.as_ref().map(|(v, s)| (v.clone(), s.as_slice()));
        let made = system(dim, w, &q, &mu, motions).map_err(|e| failed(&e))?;
        let System {
            elastic,
            friction,
            load,
        } = made;
        Ok(Self {
            loads: [Load::zero(&elastic), load],
            system: ContactSystem::new(elastic, friction).map_err(|e| failed(&e))?,
            start,
        })
    }

    /// Solves and judges, without the interpreter's lock.
    fn solve<'py>(
        &self,
        py: Python<'py>,
        method: &Bound<'py, PyAny>,
        tol: f64,
        callback: Option<Py<PyAny>>,
        seconds: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (raised, tol) = (Raised::default(), tolerance(tol)?);
        let choice = choice(method, seconds, &raised)?;
        let mut eyes = Eyes {
            callback,
            raised: raised.clone(),
            looked: Instant::now(),
        };
        let solve = || match Solver::new(&choice, &self.system) {
            Err(verdict) => (verdict, None, Seconds::default()),
            Ok(mut solver) => self.with(tol, |increment| {
                let done = solver.judge_before(increment, tol, &mut eyes);
                let JudgedIncrement {
                    verdict,
                    work,
                    judged,
                    ..
                } = done;
                let found = judged.map(|own| {
                    let jump = increment.jump(&own.outcome.state.u);
                    (own.outcome, own.found, own.status, jump)
                });
                (
                    verdict,
                    found,
                    work.map_or_else(Seconds::default, |work| work.solve),
                )
            }),
        };
        let found = guarded(py, solve)?;
        taken(&raised)?;
        told(py, &choice.label, found)
    }

    /// Judges somebody's contact forces and, where pieces float, amplitudes.
    fn judge<'py>(
        &self,
        py: Python<'py>,
        p: &Bound<'py, PyAny>,
        rigid: Option<&Bound<'py, PyAny>>,
        tol: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let tol = tolerance(tol)?;
        let p = vector_of("P", p, self.loads[1].offset.len())?;
        let rigid = rigid
            .map(|own| vector("rigid", own))
            .transpose()?
            .unwrap_or_default();
        let motions = self.system.elastic().floating().len();
        if rigid.len() != motions {
            let allowed = format!("{motions}, one per column of V");
            return Err(refused(
                "rigid",
                format!("{} numbers", rigid.len()),
                &allowed,
            ));
        }
        let judge = |increment: &Increment<'_>| -> Result<Found, MethodError> {
            let outcome = Outcome {
                status: Status::Converged,
                claim: Claim::Exact,
                state: increment.state_of(&p, &rigid)?,
                history: Vec::new(),
                counters: Counters::default(),
            };
            let (found, states) = (
                residuals(increment, &outcome.state)?,
                point_status(increment, &outcome.state)?,
            );
            let jump = increment.jump(&outcome.state.u);
            let verdict = Verdict::of(&outcome, &found, tol);
            Ok((
                verdict,
                Some((outcome, found, states, jump)),
                Seconds::default(),
            ))
        };
        let found = guarded(py, || self.with(tol, judge))?;
        told(py, "given", found.map_err(|e| failed(&e))?)
    }

    /// Why a registered method ended with a verdict, in words, and what solves the problem instead; nothing where nothing is
    /// to be seen.
    fn why(
        &self,
        py: Python<'_>,
        method: &Bound<'_, PyAny>,
        tol: f64,
        verdict: &str,
    ) -> PyResult<Option<(String, String, Option<String>)>> {
        let choice = choice(method, None, &Raised::default())?;
        let verdict: Verdict = verdict.parse().unwrap_or(Verdict::FalseClaim);
        guarded(py, || {
            let mut solver = Solver::new(&choice, &self.system).ok()?;
            self.with(tol, |increment| {
                let answers = Answers::of(increment).ok()?;
                let why =
                    explain(&choice, &mut solver, increment, &verdict, &answers, true).ok()?;
                Some((why.diagnosis.cause.to_string(), why.to_string(), why.remedy))
            })
        })
    }
}

impl Problem {
    fn with<T>(&self, tolerance: f64, call: impl FnOnce(&Increment<'_>) -> T) -> T {
        let [rest, load] = &self.loads;
        call(&Increment {
            system: &self.system,
            load,
            start_load: rest,
            start: &ContactState::zero(&self.system),
            guess: self.start.as_deref(),
            index: 0,
            tolerance,
        })
    }
}

/// Tolerances that can be asked for.
pub fn tolerance(tol: f64) -> PyResult<f64> {
    match tol {
        1e-14..=1e-3 => Ok(tol),
        _ => Err(refused("tol", tol, "1e-14 to 1e-3")),
    }
}

/// Columns of V, and s.
fn motions(pieces: &Bound<'_, PyAny>, rows: usize) -> PyResult<(Vec<Vec<f64>>, Vec<f64>)> {
    let no_pair = |_| refused("pieces", pieces.get_type(), "a pair (V, s)");
    let (v, s): (Bound<'_, PyAny>, Bound<'_, PyAny>) = pieces.extract().map_err(no_pair)?;
    let (v, s) = (columns("V", &v, rows)?, vector("s", &s)?);
    let most = MOST_MOTIONS.min(rows);
    if v.len() > most {
        return Err(refused(
            "V",
            format!("{} columns", v.len()),
            &format!("at most {most}"),
        ));
    }
    if s.len() != v.len() {
        let allowed = format!("{}, one per column of V", v.len());
        return Err(refused("s", format!("{} numbers", s.len()), &allowed));
    }
    Ok((v, s))
}

/// Components of a point and the coefficient of every point.
fn friction(mu: &Bound<'_, PyAny>, dim: Option<usize>, rows: usize) -> PyResult<(usize, Vec<f64>)> {
    let one = mu.extract::<f64>().ok();
    let given = one.map_or_else(|| vector("mu", mu), |mu| Ok(vec![mu]))?;
    if let Some(k) = given.iter().position(|m| !(m.is_finite() && *m >= 0.0)) {
        let at = one.map_or_else(|| format!("[{k}]"), |_| String::new());
        return Err(refused(&format!("mu{at}"), given[k], "finite numbers >= 0"));
    }
    let count = |allowed: &str| refused("mu", format!("{} numbers", given.len()), allowed);
    let dim = match dim {
        Some(dim @ (2 | 3)) => dim,
        Some(other) => return Err(refused("dim", other, "2 or 3")),
        None if one.is_some() => {
            return Err(refused(
                "dim",
                "None",
                "2 or 3, where mu is one number for all points",
            ));
        }
        None => [2, 3]
            .into_iter()
            .find(|dim| dim * given.len() == rows)
            .ok_or_else(|| count(&format!("one per point: {rows} numbers of q over 2 or 3")))?,
    };
    if !rows.is_multiple_of(dim) {
        return Err(refused(
            "q",
            format!("{rows} numbers"),
            &format!("a multiple of dim = {dim}"),
        ));
    }
    match one {
        Some(mu) => Ok((dim, vec![mu; rows / dim])),
        None if given.len() * dim == rows => Ok((dim, given)),
        None => Err(count(&format!("{}, one per point", rows / dim))),
    }
}

/// What was found, in the order of the fields of `stickslip.Answer`.
fn told<'py>(py: Python<'py>, method: &str, found: Found) -> PyResult<Bound<'py, PyAny>> {
    let (verdict, found, seconds) = found;
    let (mut claim, mut states, mut history) = (String::new(), Vec::new(), Vec::new());
    let [mut p, mut jump, mut judged] = [Vec::new(), Vec::new(), Vec::new()];
    let mut work = Counters::default();
    let spent = [f64::NAN, seconds.enforcement_s][usize::from(seconds.total_s > 0.0)];
    if let Some((outcome, r, status, v)) = found {
        claim = match (&outcome.status, outcome.claim) {
            (Status::Converged, Claim::Exact) => "contact laws".into(),
            (Status::Converged, _) => "own laws".into(),
            (status, _) => status.to_string(),
        };
        judged.extend([r.violation, r.natural_map, r.penetration, r.adhesion]);
        judged.extend([r.complementarity, r.cone, r.slip_direction]);
        judged.extend([
            r.equilibrium,
            r.claimed,
            r.reference_force,
            r.reference_jump,
        ]);
        states = status.iter().map(|own| own.as_str()).collect();
        history = outcome.history.iter().map(|own| own.violation).collect();
        (p, jump, work) = (outcome.state.p, v, outcome.counters);
    }
    let [tangents, laws] = [work.factorisations, work.local_solves];
    let answer = (
        (method, verdict.to_string(), verdict.is_solved(), claim),
        (p.into_pyarray(py), jump.into_pyarray(py), states, judged),
        [work.iterations, tangents, work.solves, laws],
        (spent, seconds.reported_s, history.into_pyarray(py)),
    );
    Ok(answer.into_pyobject(py)?.into_any())
}

/// Runs a computation without the interpreter's lock; a panic of it is an exception.
pub fn guarded<T: Send>(py: Python<'_>, call: impl FnOnce() -> T + Send) -> PyResult<T> {
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(call)));
    done.map_err(|panic| internal(&*panic))
}

/// The same in a thread of its own, for what shows no iterations: this one looks for Ctrl-C and sets `stop`.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    call: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    std::thread::scope(|scope| {
        let (done, mut interrupted) =
            (scope.spawn(|| catch_unwind(AssertUnwindSafe(call))), Ok(()));
        while !done.is_finished() {
            py.detach(|| std::thread::sleep(BETWEEN));
            interrupted = interrupted.and_then(|()| py.check_signals());
            stop.store(interrupted.is_err(), Ordering::Relaxed);
        }
        let found = done
            .join()
            .unwrap_or_else(Err)
            .map_err(|panic| internal(&*panic));
        interrupted.and(found)
    })
}

/// A panic as an exception.
fn internal(panic: &(dyn Any + Send)) -> PyErr {
    let literal = panic.downcast_ref::<&str>().copied();
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let what = literal.or(text).unwrap_or("of unknown kind");
    PyRuntimeError::new_err(format!("internal error: {what}"))
}

/// Shows iterations to a callback, and lets Ctrl-C through.
struct Eyes {
    callback: Option<Py<PyAny>>,
    raised: Raised,
    looked: Instant,
}

impl Monitor for Eyes {
    fn step(&mut self, iteration: usize, violation: f64) -> bool {
        if self.callback.is_none() && self.looked.elapsed() < BETWEEN {
            return true;
        }
        self.looked = Instant::now();
        let told = Python::attach(|py| {
            py.check_signals()?;
            match &self.callback {
                Some(callback) => callback.call1(py, (iteration, violation)).map(|_| ()),
                None => Ok(()),
            }
        });
        let goes_on = told.is_ok();
        if let Err(error) = told {
            *self.raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        }
        goes_on
    }
}
