//! The Python door: contact problems as NumPy arrays in, judged answers out.

mod arrays;
mod case;
mod own;
mod problem;

use std::ffi::OsString;
use std::path::PathBuf;

use pyo3::prelude::*;
use serde_json::{Value, json};
use stickslip::run::registry;
use stickslip_methods::{Method, OptionSpec, Registry};

/// See `stickslip.methods`: as JSON.
#[pyfunction]
fn methods() -> String {
    let option = |spec: &OptionSpec| {
        json!({
            "name": spec.name(), "default": spec.default().number(), "allowed": spec.allowed(), "meaning": spec.help(),
        })
    };
    let method = |own: &&Method| {
        json!({
            "name": own.name, "summary": own.summary, "reference": own.reference, "exact": own.exact,
            "options": own.options.iter().map(option).collect::<Vec<_>>(),
        })
    };
    Value::from_iter(registry::methods().iter().map(method)).to_string()
}

/// The command-line program: arguments with its name first, and the file that starts it again.
#[pyfunction]
fn program(py: Python<'_>, arguments: Vec<OsString>, file: Option<PathBuf>) -> u8 {
    let file = file.ok_or_else(|| "the script `stickslip` is not where Python is".to_owned());
    py.detach(|| stickslip::cli::program_of(Registry::standard(), arguments, file))
}

/// Panics as a method might, for the test of the border.
#[pyfunction]
fn _panic(py: Python<'_>) -> PyResult<()> {
    problem::guarded(py, || panic!("planted"))
}

#[pymodule]
fn _stickslip(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<problem::Problem>()?;
    module.add_class::<case::Case>()?;
    module.add_function(wrap_pyfunction!(methods, module)?)?;
    module.add_function(wrap_pyfunction!(program, module)?)?;
    module.add_function(wrap_pyfunction!(_panic, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
