//! Cases, their runs and their increments as arrays.

use std::path::Path;

use numpy::ToPyArray;
use numpy::ndarray::Array2;
use pyo3::exceptions::{PyFileNotFoundError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::case::{self, Case as Body, shipped};
use stickslip::files::interchange::{Problem, SparseMatrix, fclib};
use stickslip::model::body::{self, Needs};
use stickslip::model::cost::predicted;
use stickslip::report::standard;
use stickslip::report::table::{Row, objects};
use stickslip::report::tables::details::ExpectedNumber;
use stickslip::run::progress::Quiet;
use stickslip::run::provenance::Provenance;
use stickslip::studies::axes::friction_values;
use stickslip::studies::cases::{Fields, Settings, Why, run_case};
use stickslip::studies::exchange::export::{Request, export};
use stickslip::studies::expect;
use stickslip::studies::results;

use crate::own::choice;
use crate::problem::{Raised, guarded, taken};

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

    /// See `stickslip.Case.run`.
    fn run(
        &self,
        py: Python<'_>,
        methods: Vec<Bound<'_, PyAny>>,
        seconds: Option<f64>,
    ) -> PyResult<Results> {
        let raised = Raised::default();
        let choices = methods
            .iter()
            .map(|method| choice(method, seconds, &raised));
        let choices = choices.collect::<PyResult<Vec<_>>>()?;
        let settings = Settings {
            fields: Fields::First,
            why: Why::Cause,
            ..Settings::PLAIN
        };
        let results = guarded(py, || run_case(&self.0, &choices, settings, &Quiet))?;
        taken(&raised)?;
        Ok(Results(results.map_err(told)?))
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
        let exported = guarded(py, || export(&self.0, &request))?.map_err(told)?;
        let all = PyDict::new(py);
        for (end, bytes) in exported.files {
            match fclib::from_bytes(Path::new(end), bytes).map_err(told)? {
                Problem::Local(problem) => {
                    all.set_item("dim", problem.dim)?;
                    all.set_item("W", coordinates(py, &problem.w)?)?;
                    all.set_item("q", problem.q.to_pyarray(py))?;
                    all.set_item("mu", problem.mu.to_pyarray(py))?;
                    all.set_item("P", problem.solution.map(|s| s.r.to_pyarray(py)))?;
                    let pieces = problem.equality.map(|e| {
                        let v = Array2::from_shape_fn((problem.q.len(), e.v.cols()), |(i, j)| {
                            e.v.get(i, j)
                        });
                        (v.to_pyarray(py), e.s.to_pyarray(py))
                    });
                    all.set_item("pieces", pieces)?;
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

    fn __repr__(&self) -> String {
        format!(
            "<case {}, {} increments>",
            self.0.name, self.0.path.increments
        )
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
    let shape = (m.rows(), m.cols());
    let parts = (
        shape,
        rows.to_pyarray(py),
        columns.to_pyarray(py),
        values.to_pyarray(py),
    );
    Ok(parts.into_pyobject(py)?.into_any())
}

/// What runs of a case gave.
#[pyclass(frozen, module = "stickslip")]
pub struct Results(results::Results);

#[pymethods]
impl Results {
    /// A table as JSON, a row an object.
    fn table(&self, name: &str) -> PyResult<String> {
        fn json<R: Row>(rows: &[R]) -> String {
            serde_json::Value::from_iter(objects(rows)).to_string()
        }
        let own = &self.0;
        Ok(match name {
            "runs" => json(&standard::runs(own)),
            "increments" => json(&own.increments()),
            "quantities" => json(&own.quantities()),
            "history" => json(&own.history()),
            "points" => json(&own.points()),
            "expectations" => json(&ExpectedNumber::of(&own.expectations)),
            _ => {
                let known = "runs, increments, quantities, history, points, expectations";
                return Err(told(format!("table: got {name:?}, allowed: {known}")));
            }
        })
    }

    /// The figures of `stickslip run` by file name, as SVG.
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let bundle = guarded(py, || standard::bundle(&self.0, &Provenance::collect(1)))?;
        let bundle = bundle.map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
        let all = PyDict::new(py);
        for (path, bytes) in bundle.files().filter(|(path, _)| path.ends_with(".svg")) {
            let name = path.trim_start_matches("figures/");
            all.set_item(name, String::from_utf8_lossy(bytes))?;
        }
        Ok(all)
    }

    /// One line on all runs.
    fn __repr__(&self) -> String {
        format!("<{}>", standard::summary(&self.0))
    }
}
