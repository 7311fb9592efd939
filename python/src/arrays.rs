//! Arrays between Python and Rust.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;

/// An array of numbers, and one with rows.
pub(crate) type Array<'py> = Bound<'py, PyArray1<f64>>;
pub(crate) type Matrix<'py> = Bound<'py, PyArray2<f64>>;

/// The numbers of an array with any strides.
pub(crate) fn numbers(array: &PyReadonlyArray1<'_, f64>) -> Vec<f64> {
    array.as_array().iter().copied().collect()
}

/// An array that owns these numbers.
pub(crate) fn array(py: Python<'_>, numbers: Vec<f64>) -> Array<'_> {
    PyArray1::from_vec(py, numbers)
}

/// A matrix of rows with `columns` numbers each.
pub(crate) fn matrix<'py>(
    py: Python<'py>,
    rows: &[impl AsRef<[f64]>],
    columns: usize,
) -> PyResult<Matrix<'py>> {
    let mut all = Vec::with_capacity(rows.len() * columns);
    for row in rows {
        all.extend_from_slice(row.as_ref());
    }
    PyArray1::from_vec(py, all).reshape([rows.len(), columns])
}
