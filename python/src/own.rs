//! Methods by name, and Python functions as methods: (W, q, mu, tol) -> P, where pieces float
//! (W, q, mu, tol, V, s) -> (P, λ) with u = W P + V λ + q and Vᵀ P + s = 0.

use std::sync::{Arc, PoisonError};
use std::time::Instant;

use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, ToPyArray};
use pyo3::exceptions::{PyException, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use stickslip::run::choice::Choice;
use stickslip::run::outside::{ASKED, known, outcome};
use stickslip_methods::{
    Enforcement, Increment, LocalForm, MethodError, Monitor, Needs, Outcome, SquareMatrix, Status,
};

use crate::arrays::vector;
use crate::problem::Raised;

/// A method: `NAME`, `NAME:option=value,…`, `exec:PROGRAM` or a function.
pub fn choice(
    method: &Bound<'_, PyAny>,
    seconds: Option<f64>,
    raised: &Raised,
) -> PyResult<Choice> {
    let choice = if let Ok(name) = method.extract::<String>() {
        Choice::parse(&name).map_err(|e| PyValueError::new_err(e.to_string()))?
    } else if method.is_callable() {
        let (function, raised) = (Arc::new(method.clone().unbind()), raised.clone());
        let build = move || -> Box<dyn Enforcement> {
            Box::new(Function {
                call: function.clone(),
                raised: raised.clone(),
                reported_s: None,
            })
        };
        let name = method
            .getattr("name")
            .or_else(|_| method.getattr("__name__"));
        let name = name.and_then(|name| name.extract::<String>());
        Choice::own(name.as_deref().unwrap_or("function"), Arc::new(build))
    } else {
        let text = format!(
            "method: got {}, allowed: a name or a function",
            method.get_type()
        );
        return Err(PyTypeError::new_err(text));
    };
    match seconds {
        None => Ok(choice),
        Some(limit) if limit > 0.0 => Ok(choice.limited(limit, None)),
        Some(limit) => Err(crate::arrays::refused("seconds", limit, "> 0")),
    }
}

/// A function as a method. Its time is that of the call; what arrays cost is the seam's.
struct Function {
    call: Arc<Py<PyAny>>,
    raised: Raised,
    reported_s: Option<f64>,
}

impl Enforcement for Function {
    fn solve(
        &mut self,
        increment: &Increment<'_>,
        eyes: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError> {
        self.reported_s = None;
        if !eyes.step(0, f64::NAN) {
            return outcome(increment, Status::Stopped, 0, None);
        }
        let form = increment.local_form()?;
        if let Some(known) = known(increment, &form) {
            return known;
        }
        let found =
            Python::attach(|py| self.ask(py, increment, &form).map_err(|e| self.of(py, e)))?;
        match found {
            Some((p, rigid)) => outcome(increment, Status::Converged, 1, Some((&p, &rigid))),
            None => outcome(increment, Status::Unexplained, 1, None),
        }
    }

    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn reported_s(&self) -> Option<f64> {
        self.reported_s
    }
}

impl Function {
    fn ask(
        &mut self,
        py: Python<'_>,
        increment: &Increment<'_>,
        form: &LocalForm,
    ) -> PyResult<Option<(Vec<f64>, Vec<f64>)>> {
        let (w, q, call) = (
            dense(py, &form.w),
            form.q.to_pyarray(py),
            self.call.bind(py),
        );
        let mu = increment.system.friction().to_pyarray(py);
        let tol = ASKED * increment.tolerance;
        let (rows, motions) = (form.q.len(), form.modes.len());
        let v = Array2::from_shape_fn((rows, motions), |(i, j)| form.modes[j][i]).into_pyarray(py);
        let s: Vec<f64> = form.balance.iter().map(|c| -c).collect();
        let clock = Instant::now();
        let found = match motions {
            0 => call.call1((w, q, mu, tol))?,
            _ => call.call1((w, q, mu, tol, v, s.into_pyarray(py)))?,
        };
        self.reported_s = Some(clock.elapsed().as_secs_f64());
        if found.is_none() {
            return Ok(None);
        }
        let (p, rigid) = match found.cast::<PyTuple>() {
            Ok(pair) if pair.len() == 2 && motions > 0 => {
                (pair.get_item(0)?, vector("rigid", &pair.get_item(1)?)?)
            }
            _ => (found, Vec::new()),
        };
        Ok(Some((vector("P", &p)?, rigid)))
    }

    /// An exception of the function is a crash of the method; Ctrl-C and the like end the run.
    fn of(&self, py: Python<'_>, error: PyErr) -> MethodError {
        let reason = error.to_string();
        if !error.is_instance_of::<PyException>(py) {
            *self.raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        }
        MethodError::Failed { reason }
    }
}

/// A square matrix in full.
fn dense<'py>(py: Python<'py>, w: &SquareMatrix) -> Bound<'py, PyArray2<f64>> {
    let mut all = Array2::zeros((w.size(), w.size()));
    for (j, (i, value)) in (0..w.size()).flat_map(|j| w.column(j).map(move |entry| (j, entry))) {
        all[[i, j]] = value;
        if w.is_symmetric() {
            all[[j, i]] = value;
        }
    }
    all.into_pyarray(py)
}
