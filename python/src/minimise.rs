//! The optimiser alone, on functions of Python.

use crate::arrays::{array, numbers};
use flexbody::optimiser::{
    Evaluation, EvaluationFailure, Gradients, Jacobian, Method, Nlp, Observer, Options, Outcome,
    Row, solve,
};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyArithmeticError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::cell::RefCell;
use std::ops::ControlFlow;

/// A program whose functions are Python's.
struct Program<'a, 'py> {
    py: Python<'py>,
    start: Vec<f64>,
    bounds: [Vec<f64>; 2],
    row_bounds: [Vec<f64>; 2],
    names: [Vec<String>; 2],
    evaluate: Bound<'py, PyAny>,
    gradients: Bound<'py, PyAny>,
    /// An exception that ends the run.
    raised: &'a RefCell<Option<PyErr>>,
}

/// A Jacobian as Python gives it: full, or compressed rows.
#[derive(FromPyObject)]
enum GivenJacobian<'py> {
    Dense(PyReadonlyArray2<'py, f64>),
    Sparse(
        PyReadonlyArray1<'py, i64>,
        PyReadonlyArray1<'py, i64>,
        PyReadonlyArray1<'py, f64>,
    ),
}

impl<'py> Program<'_, 'py> {
    /// An exception as a failure from which the optimiser backs off; others are kept and end the run.
    fn failure(&self, what: &str, error: PyErr) -> EvaluationFailure {
        let backs_off = error.is_instance_of::<PyArithmeticError>(self.py) || {
            let class = self.py.import("flexbody.errors");
            let class = class.and_then(|module| module.getattr("SimulationError"));
            class.is_ok_and(|class| error.matches(self.py, class).unwrap_or(false))
        };
        let reason = error.value(self.py).to_string();
        if !backs_off {
            self.raised.borrow_mut().get_or_insert(error);
        }
        EvaluationFailure {
            what: what.to_owned(),
            reason,
        }
    }

    fn values(&self, x: &[f64]) -> PyResult<Evaluation> {
        self.py.check_signals()?;
        let found = self.evaluate.call1((array(self.py, x.to_vec()),))?;
        let (objective, rows): (f64, PyReadonlyArray1<'py, f64>) = found.extract()?;
        Ok(Evaluation {
            objective,
            constraints: numbers(&rows),
        })
    }

    fn derivatives(&self, x: &[f64]) -> PyResult<Gradients> {
        self.py.check_signals()?;
        let found = self.gradients.call1((array(self.py, x.to_vec()),))?;
        let (objective, given): (PyReadonlyArray1<'py, f64>, GivenJacobian<'py>) =
            found.extract()?;
        let (m, n) = (self.row_bounds[0].len(), self.start.len());
        let jacobian = match given {
            GivenJacobian::Dense(all) => {
                let all = all.as_array();
                if all.dim() != (m, n) {
                    return Err(PyValueError::new_err(format!(
                        "found a Jacobian of shape {:?}, expected {:?}",
                        all.dim(),
                        (m, n)
                    )));
                }
                Jacobian::dense(m, n, all.iter().copied().collect())
            }
            GivenJacobian::Sparse(starts, columns, values) => {
                sparse((m, n), &starts, &columns, &numbers(&values))?
            }
        };
        Ok(Gradients {
            objective: numbers(&objective),
            jacobian,
        })
    }
}

/// The matrix of compressed rows.
fn sparse(
    (m, n): (usize, usize),
    starts: &PyReadonlyArray1<'_, i64>,
    columns: &PyReadonlyArray1<'_, i64>,
    values: &[f64],
) -> PyResult<Jacobian> {
    let index = |all: &PyReadonlyArray1<'_, i64>| -> Option<Vec<usize>> {
        let all = all.as_array();
        all.iter().map(|&i| usize::try_from(i).ok()).collect()
    };
    let wrong = || {
        let what = "found a sparse Jacobian whose indices are not those of compressed rows";
        PyValueError::new_err(format!("{what} of shape {:?}", (m, n)))
    };
    let starts = index(starts).ok_or_else(wrong)?;
    let columns = index(columns).ok_or_else(wrong)?;
    let fits = starts.len() == m + 1
        && starts.windows(2).all(|pair| pair[0] <= pair[1])
        && starts.last() == Some(&columns.len())
        && columns.len() == values.len()
        && columns.iter().all(|&i| i < n);
    if !fits {
        return Err(wrong());
    }
    let entries = (0..m).flat_map(|j| {
        let of_row = starts[j]..starts[j + 1];
        let (columns, values) = (&columns, &values);
        of_row.map(move |k| (j, columns[k], values[k]))
    });
    Ok(Jacobian::sparse(m, n, entries))
}

impl Nlp for Program<'_, '_> {
    fn variables(&self) -> usize {
        self.start.len()
    }

    fn constraints(&self) -> usize {
        self.row_bounds[0].len()
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (self.bounds[0].clone(), self.bounds[1].clone())
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (self.row_bounds[0].clone(), self.row_bounds[1].clone())
    }

    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn variable_name(&self, i: usize) -> String {
        self.names[0][i].clone()
    }

    fn constraint_name(&self, j: usize) -> String {
        self.names[1][j].clone()
    }

    fn is_interrupted(&self) -> bool {
        self.raised.borrow().is_some()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        if self.is_interrupted() {
            return Err(ended());
        }
        let found = self.values(x);
        found.map_err(|error| self.failure("the functions", error))
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        if self.is_interrupted() {
            return Err(ended());
        }
        let found = self.derivatives(x);
        found.map_err(|error| self.failure("the gradients", error))
    }
}

fn ended() -> EvaluationFailure {
    EvaluationFailure {
        what: "the run".to_owned(),
        reason: "an exception has ended it".to_owned(),
    }
}

/// Calls Python's callback with every iteration.
struct Callback<'a, 'py> {
    py: Python<'py>,
    callback: Option<Bound<'py, PyAny>>,
    raised: &'a RefCell<Option<PyErr>>,
}

impl Callback<'_, '_> {
    fn stops(&self, own: &Row<'_>) -> PyResult<bool> {
        let Some(callback) = &self.callback else {
            return Ok(false);
        };
        let row = PyDict::new(self.py);
        row.set_item("iteration", own.iteration)?;
        row.set_item("evaluations", own.evaluations)?;
        row.set_item("objective", own.objective)?;
        row.set_item("infeasibility", own.infeasibility)?;
        row.set_item("optimality", own.optimality)?;
        row.set_item("barrier", own.barrier)?;
        row.set_item("step", own.step)?;
        row.set_item("x", array(self.py, own.x.to_vec()))?;
        row.set_item("constraints", array(self.py, own.constraints.to_vec()))?;
        let stops = callback.call1((row,))?;
        Ok(!stops.is_none() && stops.is_truthy()?)
    }
}

impl Observer for Callback<'_, '_> {
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        if self.raised.borrow().is_some() {
            return ControlFlow::Break(());
        }
        match self.stops(row) {
            Ok(false) => ControlFlow::Continue(()),
            Ok(true) => ControlFlow::Break(()),
            Err(error) => {
                self.raised.borrow_mut().get_or_insert(error);
                ControlFlow::Break(())
            }
        }
    }
}

/// Options by name.
fn options(given: &Bound<'_, PyDict>) -> PyResult<Options> {
    let mut own = Options::default();
    for (key, value) in given {
        let key: String = key.extract()?;
        match key.as_str() {
            "method" => {
                own.method = match value.extract::<String>()?.as_str() {
                    "interior_point" => Method::InteriorPoint,
                    "trust_region" => Method::TrustRegion,
                    "auto" => Method::Auto,
                    other => {
                        return Err(PyValueError::new_err(format!(
                            "found the method \"{other}\", expected \"interior_point\", \"trust_region\" or \"auto\""
                        )));
                    }
                }
            }
            "tolerance" => own.tolerance = value.extract()?,
            "constraint_tolerance" => own.constraint_tolerance = value.extract()?,
            "max_iterations" => own.max_iterations = value.extract()?,
            "max_evaluations" => own.max_evaluations = value.extract()?,
            "max_seconds" => own.max_seconds = value.extract()?,
            "unbounded_below" => own.unbounded_below = value.extract()?,
            "scale_variables" => own.scale_variables = value.extract()?,
            "memory" => own.memory = value.extract()?,
            "dense_limit" => own.dense_limit = value.extract()?,
            other => {
                return Err(PyValueError::new_err(format!(
                    "found the option \"{other}\", expected one of method, tolerance, constraint_tolerance, \
                     max_iterations, max_evaluations, max_seconds, unbounded_below, scale_variables, memory, \
                     dense_limit"
                )));
            }
        }
    }
    Ok(own)
}

/// Minimises f(x) subject to bounds and rows; see `flexbody.minimise`.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "each has a name in Python")]
pub(crate) fn minimise<'py>(
    py: Python<'py>,
    x0: PyReadonlyArray1<'py, f64>,
    lower: PyReadonlyArray1<'py, f64>,
    upper: PyReadonlyArray1<'py, f64>,
    c_lower: PyReadonlyArray1<'py, f64>,
    c_upper: PyReadonlyArray1<'py, f64>,
    variable_names: Vec<String>,
    constraint_names: Vec<String>,
    evaluate: Bound<'py, PyAny>,
    gradients: Bound<'py, PyAny>,
    callback: Option<Bound<'py, PyAny>>,
    options: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let raised = RefCell::new(None);
    let options = self::options(&options)?;
    let mut program = Program {
        py,
        start: numbers(&x0),
        bounds: [numbers(&lower), numbers(&upper)],
        row_bounds: [numbers(&c_lower), numbers(&c_upper)],
        names: [variable_names, constraint_names],
        evaluate,
        gradients,
        raised: &raised,
    };
    let (n, m) = (program.start.len(), program.row_bounds[0].len());
    let fits = |all: &[Vec<f64>; 2], count: usize| all.iter().all(|own| own.len() == count);
    if !fits(&program.bounds, n)
        || !fits(&program.row_bounds, m)
        || program.names[0].len() != n
        || program.names[1].len() != m
    {
        let what = "found bounds and names of other lengths than x0 and the rows";
        return Err(PyValueError::new_err(what));
    }
    let mut observer = Callback {
        py,
        callback,
        raised: &raised,
    };
    let outcome = solve(&mut program, &options, &mut observer);
    let last = match raised.borrow_mut().take() {
        Some(error) => return Err(error),
        None => outcome.x.clone(),
    };
    // The gradient of the objective at the end, for the result.
    let slope = match outcome.objective.is_finite() {
        true => program.derivatives(&last).map(|own| own.objective),
        false => Ok(Vec::new()),
    };
    result(py, &outcome, slope.unwrap_or_default())
}

fn result<'py>(
    py: Python<'py>,
    outcome: &Outcome,
    slope: Vec<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let (word, sentence) = outcome.status.verdict();
    let out = PyDict::new(py);
    out.set_item("status", word)?;
    out.set_item("message", sentence)?;
    out.set_item("success", outcome.converged())?;
    out.set_item("x", array(py, outcome.x.clone()))?;
    out.set_item("fun", outcome.objective)?;
    out.set_item("constraints", array(py, outcome.constraints.clone()))?;
    out.set_item("jac", array(py, slope))?;
    let multipliers = PyDict::new(py);
    let own = &outcome.multipliers;
    multipliers.set_item("constraints", array(py, own.constraints.clone()))?;
    multipliers.set_item("lower", array(py, own.lower_bounds.clone()))?;
    multipliers.set_item("upper", array(py, own.upper_bounds.clone()))?;
    out.set_item("multipliers", multipliers)?;
    out.set_item("violation", outcome.kkt.violation)?;
    out.set_item("stationarity", outcome.kkt.stationarity)?;
    out.set_item("complementarity", outcome.kkt.complementarity)?;
    out.set_item("optimality", outcome.kkt.scaled)?;
    out.set_item("nit", outcome.counts.iterations)?;
    out.set_item("nfev", outcome.counts.evaluations)?;
    out.set_item("njev", outcome.counts.gradients)?;
    out.set_item("nfail", outcome.counts.failures)?;
    out.set_item("seconds", outcome.counts.seconds)?;
    let method = match outcome.method {
        Method::InteriorPoint => "interior_point",
        Method::TrustRegion => "trust_region",
        Method::Auto => "auto",
    };
    out.set_item("method", method)?;
    Ok(out)
}
