//! Cases, their runs and their increments as arrays.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use numpy::ToPyArray;
use pyo3::exceptions::{PyFileNotFoundError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::case::{self, Case as Body, shipped};
use stickslip::files::interchange::{Problem, SparseMatrix, fclib};
use stickslip::model::body::{self, Needs};
use stickslip::model::cost::predicted;
use stickslip::report::{Bundle, standard, sweep};
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::run::provenance::Provenance;
use stickslip::run::verdict::Accuracy;
use stickslip::studies::axes::{Axes, Subject, friction_values, named};
use stickslip::studies::cases::{Fields, Settings, Why, run_case};
use stickslip::studies::exchange::export::{Request, export};
use stickslip::studies::expect;
use stickslip::studies::measure::{Bench, Repeats, here};
use stickslip::studies::record::Record;
use stickslip::studies::task::Looks;

use crate::arrays::refused;
use crate::own::choice;
use crate::problem::{Raised, guarded, interruptible, taken, tolerance};

fn told(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A case: a body, its cracks, supports and loads.
#[pyclass(frozen, module = "stickslip")]
pub struct Case(Body);

#[pymethods]
impl Case {
    /// The name of a shipped case, the path of a file, or the text of one as JSON.
    #[new]
    #[pyo3(signature = (name, json = None))]
    fn new(name: &str, json: Option<&str>) -> PyResult<Self> {
        let case = match (json, shipped::find(name)) {
            (Some(json), _) => {
                let value: toml::Value = serde_json::from_str(json).map_err(told)?;
                let text = toml::to_string(&value).map_err(told)?;
                case::parse(name, text)
            }
            (None, Some(case)) => case,
            (None, None) if !Path::new(name).exists() => {
                let text =
                    format!("case: got {name:?}, allowed: a file, or a name of `stickslip show`");
                return Err(PyFileNotFoundError::new_err(text));
            }
            (None, None) => case::read(name),
        };
        let case = case.map_err(told)?;
        expect::check(&case).map_err(told)?;
        Ok(Self(case))
    }

    /// Name in tables.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Number of load increments.
    #[getter]
    fn increments(&self) -> usize {
        self.0.path.increments
    }

    /// Discretises the case on its first mesh: sizes, residual of uniform stress [-], and what a run by `hybrid` will take.
    fn check<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let refine = self.0.sweep.refine.first().copied().unwrap_or(1);
        let body = guarded(py, || body::Body::new(&self.0, refine, &Needs::default()))?;
        let body = body.map_err(told)?;
        let all = PyDict::new(py);
        all.set_item("mesh", &body.label)?;
        all.set_item("space", &body.space)?;
        all.set_item("cells", body.mesh.cell_count())?;
        all.set_item("unknowns", body.elastic.unknowns())?;
        all.set_item("points", body.points.len())?;
        all.set_item("uniform_stress", body.checks.uniform)?;
        let runs = friction_values(&self.0).len() * self.0.path.increments;
        if let Some(cost) = guarded(py, || predicted(&body, runs))? {
            all.set_item("seconds", cost.seconds)?;
            all.set_item("gigabytes", cost.gb)?;
        }
        Ok(all)
    }

    /// See `stickslip.Case.run`: files by name.
    fn run<'py>(
        &self,
        py: Python<'py>,
        methods: Methods<'py>,
        seconds: Option<f64>,
    ) -> PyResult<Files> {
        let settings = Settings {
            fields: Fields::First,
            why: Why::Cause,
            ..Settings::PLAIN
        };
        asked(py, methods, seconds, |choices| {
            let results =
                run_case(&self.0, choices, settings, &Quiet).map_err(|e| e.to_string())?;
            standard::bundle(&results, &Provenance::collect(1)).map_err(|e| e.to_string())
        })
    }

    /// See `stickslip.Case.study`: files by name.
    fn study<'py>(
        &self,
        py: Python<'py>,
        methods: Methods<'py>,
        tolerances: Vec<f64>,
        seconds: Option<f64>,
    ) -> PyResult<Files> {
        let accuracies = tolerances
            .into_iter()
            .map(|tol| tolerance(tol).map(Accuracy::exactly));
        let accuracies = accuracies.collect::<PyResult<Vec<_>>>()?;
        asked(py, methods, seconds, |choices| {
            let looks = Looks {
                error: true,
                ..Looks::default()
            };
            let (axes, mut bench) = (Axes::of(&self.0), Bench::default());
            let tasks = Subject::given(&self.0).tasks(&axes, &named(choices), &accuracies, looks);
            let repeats = Some(Repeats::DEFAULT);
            let answers = here(
                &mut bench,
                &tasks,
                choices,
                1,
                repeats,
                &Quiet,
                &mut |_, _| (),
            );
            let answers = answers.map_err(|e| e.to_string())?.into_iter();
            let records: Vec<Record> = answers.map(|own| own.record).collect();
            let bundle = sweep::bundle(&records, records.len(), &Provenance::collect(1));
            let mut bundle = bundle.map_err(|e| e.to_string())?;
            let lines = records
                .iter()
                .map(|own| serde_json::to_string(own).map(|line| line + "\n"));
            let lines = lines
                .collect::<Result<String, _>>()
                .map_err(|e| e.to_string())?;
            bundle
                .add("records/records.jsonl", lines)
                .map_err(|e| e.to_string())?;
            Ok(bundle)
        })
    }

    /// See `stickslip.Case.increment`: matrices as (shape, rows, columns, values).
    fn increment<'py>(
        &self,
        py: Python<'py>,
        increment: usize,
        friction: Option<f64>,
        method: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let request = Request {
            increment: Some(increment),
            friction,
            refine: None,
            choice: choice(method, None, &Raised::default())?,
        };
        let exported = guarded(py, || export(&self.0, &request))?;
        let exported = exported.map_err(|e| told(e.to_string().replace("--", "")))?;
        let all = PyDict::new(py);
        for (end, bytes) in exported.files {
            match fclib::from_bytes(Path::new(end), bytes).map_err(told)? {
                Problem::Local(problem) => {
                    all.set_item("dim", problem.dim)?;
                    all.set_item("W", coordinates(py, &problem.w)?)?;
                    all.set_item("q", problem.q.to_pyarray(py))?;
                    all.set_item("mu", problem.mu.to_pyarray(py))?;
                    all.set_item("P", problem.solution.map(|s| s.r.to_pyarray(py)))?;
                    if let Some(own) = problem.equality {
                        all.set_item("V", coordinates(py, &own.v)?)?;
                        all.set_item("s", own.s.to_pyarray(py))?;
                    }
                }
                Problem::Global(problem) => {
                    all.set_item("K", coordinates(py, &problem.m)?)?;
                    all.set_item("B", coordinates(py, &problem.h.transposed())?)?;
                    all.set_item("f", problem.f.to_pyarray(py))?;
                    all.set_item("offset", problem.w.to_pyarray(py))?;
                }
            }
        }
        Ok(all)
    }
}

/// Shape, rows, columns and values.
fn coordinates<'py>(py: Python<'py>, m: &SparseMatrix) -> PyResult<Bound<'py, PyAny>> {
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j, value) in m.entries() {
        rows.push(i as i64);
        columns.push(j as i64);
        values.push(value);
    }
    let [rows, columns] = [rows, columns].map(|own| own.to_pyarray(py));
    let parts = ((m.rows(), m.cols()), rows, columns, values.to_pyarray(py));
    Ok(parts.into_pyobject(py)?.into_any())
}

/// Names and functions.
type Methods<'py> = Vec<Bound<'py, PyAny>>;
/// Files by name.
type Files = BTreeMap<String, Cow<'static, [u8]>>;

/// Files that somebody makes by some methods, in a thread that Ctrl-C ends at the next iteration.
fn asked(
    py: Python<'_>,
    methods: Methods<'_>,
    seconds: Option<f64>,
    make: impl FnOnce(&[Choice]) -> Result<Bundle, String> + Send,
) -> PyResult<Files> {
    let (raised, stop) = (Raised::default(), Arc::new(AtomicBool::new(false)));
    let mut choices = Vec::new();
    for method in &methods {
        let mut own = choice(method, seconds, &raised)?;
        own.stop = stop.clone();
        if choices
            .iter()
            .any(|known: &Choice| known.label == own.label)
        {
            let named = "each once, functions by stickslip.method(function, name)";
            return Err(refused("methods", format!("{} twice", own.label), named));
        }
        choices.push(own);
    }
    let bundle = interruptible(py, &stop, || make(&choices))?;
    taken(&raised)?;
    let bundle = bundle.map_err(told)?;
    let file = |(name, bytes): (&str, &[u8])| (name.to_owned(), Cow::Owned(bytes.to_vec()));
    Ok(bundle.files().map(file).collect())
}
