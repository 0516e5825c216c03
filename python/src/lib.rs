//! The Python door: contact problems as NumPy arrays in, judged answers out.

mod arrays;
mod case;
mod own;
mod problem;

use std::ffi::OsString;
use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stickslip::run::registry;
use stickslip_methods::Registry;

/// See `stickslip.methods`.
#[pyfunction]
fn methods(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let all = PyList::empty(py);
    for method in registry::methods() {
        let (row, options) = (PyDict::new(py), PyList::empty(py));
        row.set_item("name", method.name)?;
        row.set_item("summary", method.summary)?;
        row.set_item("reference", method.reference)?;
        row.set_item("exact", method.exact)?;
        for spec in method.options {
            let option = PyDict::new(py);
            option.set_item("name", spec.name())?;
            option.set_item("default", spec.default().number())?;
            option.set_item("allowed", spec.allowed())?;
            option.set_item("meaning", spec.help())?;
            options.append(option)?;
        }
        row.set_item("options", options)?;
        all.append(row)?;
    }
    Ok(all)
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
    module.add_class::<case::Results>()?;
    module.add_function(wrap_pyfunction!(methods, module)?)?;
    module.add_function(wrap_pyfunction!(program, module)?)?;
    module.add_function(wrap_pyfunction!(_panic, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
