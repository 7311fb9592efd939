//! An optimisation of a problem for Python.

use crate::arrays::{Array, Matrix, array, matrix};
use crate::errors::{interrupted, optimisation};
use crate::run::{Stop, run, start};
use flexbody::{Iteration, OptimisationOptions};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

/// What is wanted of an optimisation: a dictionary.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Wanted {
    starts: Option<usize>,
    directory: Option<PathBuf>,
    resume: Option<PathBuf>,
    certificate: bool,
}

/// The end of an optimisation.
#[pyclass(frozen, module = "flexbody._flexbody")]
pub(crate) struct Optimum {
    optimum: Arc<Mutex<flexbody::Optimum>>,
    variables: usize,
    constraints: usize,
    stop: Stop,
}

/// An iteration, and where the answer of the callback is awaited: whether the run goes on.
type Asked = (Iteration, Sender<bool>);

/// A row of the history for a callback.
fn row<'py>(py: Python<'py>, own: Iteration) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    row.set_item("iteration", own.number)?;
    row.set_item("evaluations", own.evaluations)?;
    row.set_item("objective", own.objective)?;
    row.set_item("infeasibility", own.infeasibility)?;
    row.set_item("optimality", own.optimality)?;
    row.set_item("x", array(py, own.design))?;
    row.set_item("constraints", array(py, own.constraints))?;
    Ok(row)
}

/// Optimises a problem. The callback is called with every iteration on the thread of the caller.
pub(crate) fn optimise(
    py: Python<'_>,
    (problem, stop): (&Arc<flexbody::Problem>, &Stop),
    file: Option<PathBuf>,
    (callback, wanted): (Option<Py<PyAny>>, Wanted),
) -> PyResult<Optimum> {
    let (own, asked) = (problem.clone(), stop.clone());
    let asks = callback.is_some();
    let work = move |tell: &dyn Fn(Asked)| {
        let options = OptimisationOptions {
            starts: wanted.starts,
            directory: wanted.directory.as_deref(),
            resume: wanted.resume.as_deref(),
            certificate: wanted.certificate,
            file: file.as_deref(),
        };
        let ended = AtomicBool::new(false);
        let mut progress = |iteration: Iteration| {
            if !asks {
                return ControlFlow::Continue(());
            }
            let (answer, answered) = channel();
            tell((iteration, answer));
            match answered.recv() {
                Ok(true) => ControlFlow::Continue(()),
                Ok(false) => ControlFlow::Break(()),
                // Without an answer the caller has given up.
                Err(_) => {
                    ended.store(true, Ordering::Relaxed);
                    ControlFlow::Break(())
                }
            }
        };
        let stopped = || asked.has_come() || ended.load(Ordering::Relaxed);
        let found = flexbody::optimise_with(&own, &options, &stopped, &mut progress);
        (found, asked.has_come())
    };
    let (found, was_stopped) = start(py, stop, work)?.wait(py, |(iteration, answer): Asked| {
        let Some(callback) = &callback else {
            return Ok(());
        };
        let stops = callback.bind(py).call1((row(py, iteration)?,))?;
        let stops = !stops.is_none() && stops.is_truthy()?;
        // The work may have ended by another way.
        let _ = answer.send(!stops);
        Ok(())
    })?;
    // A signal to another thread ends what it interrupts everywhere.
    if was_stopped {
        return Err(interrupted());
    }
    let optimum = found.map_err(|error| optimisation(py, error))?;
    Ok(Optimum {
        optimum: Arc::new(Mutex::new(optimum)),
        variables: problem.variables().len(),
        constraints: problem.constraints.len(),
        stop: stop.clone(),
    })
}

impl Optimum {
    fn with<T>(&self, of: impl FnOnce(&flexbody::Optimum) -> T) -> T {
        of(&self.optimum.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Optimum {
    /// The record as JSON; `None` if a number of it is not finite.
    #[getter]
    fn record(&self) -> Option<String> {
        self.with(flexbody::Optimum::to_json)
    }

    #[getter]
    fn summary(&self) -> String {
        self.with(flexbody::Optimum::summary)
    }

    #[getter]
    fn status(&self) -> (String, String) {
        self.with(|own| (own.status().0.to_owned(), own.status().1.to_owned()))
    }

    #[getter]
    fn objective(&self) -> f64 {
        self.with(flexbody::Optimum::objective)
    }

    fn design<'py>(&self, py: Python<'py>) -> Array<'py> {
        array(py, self.with(flexbody::Optimum::design))
    }

    /// Iterations, evaluations, columns of objective, infeasibility and optimality, designs, constraints.
    fn history<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Vec<[usize; 2]>, Matrix<'py>, Matrix<'py>, Matrix<'py>)> {
        let all: Vec<Iteration> = self.with(|own| own.history().collect());
        let counts = all.iter().map(|own| [own.number, own.evaluations]);
        let column = |own: &Iteration| [own.objective, own.infeasibility, own.optimality];
        let columns: Vec<[f64; 3]> = all.iter().map(column).collect();
        let designs: Vec<&[f64]> = all.iter().map(|own| &own.design[..]).collect();
        let rows: Vec<&[f64]> = all.iter().map(|own| &own.constraints[..]).collect();
        Ok((
            counts.collect(),
            matrix(py, &columns, 3)?,
            matrix(py, &designs, self.variables)?,
            matrix(py, &rows, self.constraints)?,
        ))
    }

    /// Number of the start, number of starts that found it, objective, design.
    fn optima<'py>(&self, py: Python<'py>) -> Vec<(usize, usize, f64, Array<'py>)> {
        self.with(|own| {
            let all = own.optima();
            all.map(|(start, starts, objective, design)| {
                (start, starts, objective, array(py, design.to_vec()))
            })
            .collect()
        })
    }

    fn page(&self, py: Python<'_>, by: String) -> PyResult<String> {
        let optimum = self.optimum.clone();
        let made = run(py, &self.stop, move || {
            let optimum = optimum.lock().unwrap_or_else(PoisonError::into_inner);
            optimum.page(&by)
        })?;
        made.map_err(|error| optimisation(py, error.into()))
    }

    /// Writes the results; returns what could not be drawn.
    fn save(
        &self,
        py: Python<'_>,
        directory: PathBuf,
        page: Option<String>,
    ) -> PyResult<Vec<String>> {
        let optimum = self.optimum.clone();
        let saved = run(py, &self.stop, move || {
            let mut optimum = optimum.lock().unwrap_or_else(PoisonError::into_inner);
            optimum.save(&directory, page.as_deref())
        })?;
        saved.map_err(|error| optimisation(py, error))
    }
}
