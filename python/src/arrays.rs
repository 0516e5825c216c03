//! Arrays that come in: real and finite numbers of the right shape, or an exception that names the array, the index, the value
//! and what is allowed.

use numpy::{
    PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use stickslip::files::interchange::SparseMatrix;
use stickslip::studies::exchange::ROUNDING;
use stickslip_methods::{MethodError, SquareMatrix};

/// Rows and columns of a tile that the cache holds twice.
const TILE: usize = 32;

/// An array that is not what it has to be.
pub fn refused(what: &str, got: impl std::fmt::Display, allowed: &str) -> PyErr {
    PyValueError::new_err(format!("{what}: got {got}, allowed: {allowed}"))
}

/// What a method or a system says of its input.
pub fn failed(error: &MethodError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// An array of float64, that of the caller where it is one.
fn real<'py>(name: &str, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let allowed = "an array of real numbers";
    let other =
        |got: String| PyTypeError::new_err(format!("{name}: got {got}, allowed: {allowed}"));
    if x.get_type().name()? == "MaskedArray" {
        return Err(other("a masked array".into()));
    }
    if let Ok(array) = x.cast::<PyArrayDyn<f64>>() {
        return Ok(array.clone());
    }
    let ragged = |e: PyErr| refused(name, e.value(x.py()), allowed);
    let numpy = x.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (x,)).map_err(ragged)?;
    let dtype = array.getattr("dtype")?;
    if !"iuf".contains(&dtype.getattr("kind")?.extract::<String>()?) {
        return Err(other(format!("dtype {dtype}")));
    }
    let array = array.call_method1("astype", ("float64",))?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?)
}

/// The entries of an array, row after row.
pub fn vector(name: &str, x: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = real(name, x)?;
    let shape = array.shape().to_vec();
    if !(1..=2).contains(&shape.len()) {
        return Err(refused(
            name,
            format!("shape {shape:?}"),
            "a vector, or a row per point",
        ));
    }
    let view = array.try_readonly()?;
    let values: Vec<f64> = view.as_array().iter().copied().collect();
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(values),
        Some(k) => Err(not_finite(name, &place(k, &shape), values[k])),
    }
}

fn place(k: usize, shape: &[usize]) -> String {
    match shape {
        [_, columns] => format!("[{}, {}]", k / columns, k % columns),
        _ => format!("[{k}]"),
    }
}

fn not_finite(name: &str, at: &str, value: f64) -> PyErr {
    refused(&format!("{name}{at}"), value, "finite numbers")
}

/// A vector of so many entries.
pub fn vector_of(name: &str, x: &Bound<'_, PyAny>, length: usize) -> PyResult<Vec<f64>> {
    let values = vector(name, x)?;
    if values.len() == length {
        return Ok(values);
    }
    let got = format!("{} numbers", values.len());
    Err(refused(name, got, &format!("{length}, as many as q has")))
}

/// Columns of a matrix with so many rows; one column may come as a vector.
pub fn columns(name: &str, x: &Bound<'_, PyAny>, rows: usize) -> PyResult<Vec<Vec<f64>>> {
    let array = real(name, x)?;
    let shape = array.shape().to_vec();
    if shape.first() != Some(&rows) || shape.len() > 2 {
        let allowed = format!("{rows} rows, as many as q has numbers");
        return Err(refused(name, format!("shape {shape:?}"), &allowed));
    }
    let values = vector(name, array.as_any())?;
    let count = values.len().checked_div(rows).unwrap_or(0);
    let column = |j: usize| (0..rows).map(|i| values[i * count + j]).collect();
    Ok((0..count).map(column).collect())
}

/// W from a NumPy array or a SciPy matrix: half of it where it is symmetric up to rounding, all of it otherwise.
pub fn operator(w: &Bound<'_, PyAny>, rows: usize) -> PyResult<SquareMatrix> {
    if w.hasattr("tocoo")? {
        return sparse(w, rows);
    }
    let array = real("W", w)?;
    square(array.shape(), rows)?;
    let array: PyReadonlyArray2<'_, f64> = array.cast::<PyArray2<f64>>()?.try_readonly()?;
    let view = array.as_array();
    let all = view.as_standard_layout();
    let all = all.as_slice().unwrap_or_default();
    let infinite = || {
        let first = all.iter().position(|v| !v.is_finite());
        first.map(|k| not_finite("W", &place(k, view.shape()), all[k]))
    };
    // NaN equals nothing.
    let symmetric = is_exactly_symmetric(all, rows)
        || infinite().map_or_else(|| is_nearly_symmetric(all, rows), Err)?;
    let most = if symmetric {
        rows * (rows + 1) / 2
    } else {
        rows * rows
    };
    let (mut ends, mut at) = (vec![0], Vec::with_capacity(most));
    let mut values = Vec::with_capacity(most);
    for j in 0..rows {
        let mut keep = |i: usize, value: f64| {
            if i == j || value != 0.0 {
                at.push(i);
                values.push(value);
            }
        };
        let row = &all[j * rows..(j + 1) * rows];
        match symmetric {
            true => (j..rows).for_each(|i| keep(i, row[i])),
            false => (0..rows).for_each(|i| keep(i, all[i * rows + j])),
        }
        ends.push(at.len());
    }
    let new = if symmetric {
        SquareMatrix::symmetric
    } else {
        SquareMatrix::general
    };
    new(rows, ends, at, values).map_err(|e| infinite().unwrap_or_else(|| failed(&e)))
}

fn is_exactly_symmetric(all: &[f64], rows: usize) -> bool {
    // In tiles: rows of one side are columns of the other.
    let tiles = || (0..rows).step_by(TILE);
    let mut exactly = true;
    for (tile, other) in tiles().flat_map(|tile| tiles().map(move |other| (tile, other))) {
        for i in tile..rows.min(tile + TILE) {
            let columns = all[other * rows + i..].iter().step_by(rows);
            let row = &all[i * rows + other.min(i + 1)..i * rows + (i + 1).min(other + TILE)];
            let pairs = row.iter().zip(columns);
            exactly &= pairs.fold(true, |same, (a, b)| same & (a == b));
        }
    }
    exactly
}

/// Whether a matrix is symmetric up to rounding; of one that is, the upper triangle stands for both.
fn is_nearly_symmetric(all: &[f64], rows: usize) -> PyResult<bool> {
    let (mut largest, mut asymmetry) = (0.0_f64, 0.0_f64);
    let (mut lower, mut upper) = (false, false);
    for i in 0..rows {
        for j in 0..=i {
            let (below, above) = (all[i * rows + j], all[j * rows + i]);
            asymmetry = asymmetry.max((below - above).abs());
            largest = largest.max(below.abs()).max(above.abs());
            lower |= below != 0.0 && i != j;
            upper |= above != 0.0 && i != j;
        }
    }
    one_triangle(lower, upper)?;
    Ok(asymmetry <= ROUNDING * largest)
}

fn sparse(w: &Bound<'_, PyAny>, rows: usize) -> PyResult<SquareMatrix> {
    square(&w.getattr("shape")?.extract::<Vec<usize>>()?, rows)?;
    let all = w.call_method0("tocoo")?;
    let data = vector("W.data", &all.getattr("data")?)?;
    let [at, of] = ["row", "col"].map(|name| -> PyResult<Vec<i64>> {
        let array = all.getattr(name)?.call_method1("astype", ("int64",))?;
        Ok(array.cast::<PyArray1<i64>>()?.to_vec()?)
    });
    // A negative one lies outside too.
    let entries = at?.into_iter().zip(of?).zip(data);
    let entries = entries.map(|((i, j), value)| (i as usize, j as usize, value));
    let matrix = SparseMatrix::from_triplets(rows, rows, entries);
    let matrix = matrix.ok_or_else(|| refused("W", "entries outside of it", "a SciPy matrix"))?;
    let [upper, lower] = matrix.sides();
    one_triangle(lower, upper)?;
    let all = matrix.as_square().map_err(|e| failed(&e))?;
    match all.asymmetry() {
        ..=ROUNDING => matrix.symmetric_part().map_err(|e| failed(&e)),
        _ => Ok(all),
    }
}

fn square(shape: &[usize], rows: usize) -> PyResult<()> {
    if shape == [rows, rows] {
        return Ok(());
    }
    let allowed = format!("({rows}, {rows}), as many rows and columns as q has numbers");
    Err(refused("W", format!("shape {shape:?}"), &allowed))
}

fn one_triangle(lower: bool, upper: bool) -> PyResult<()> {
    if lower == upper {
        return Ok(());
    }
    Err(refused(
        "W",
        "one triangle",
        "the whole matrix, e.g. W + np.tril(W, -1).T",
    ))
}
