//! The optimiser alone, on functions of Python. It works on a thread of the package and asks the caller's
//! thread for values, gradients and the callback.

use crate::arrays::{array, numbers};
use crate::run::{Stop, start};
use flexbody::optimiser::{
    Evaluation, EvaluationFailure, Gradients, Jacobian, Method, Nlp, Observer, Options, Outcome,
    Row, Status, solve,
};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyArithmeticError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::mpsc::{Sender, channel};

/// Points whose gradients are kept for the result.
const REMEMBERED: usize = 8;
/// Largest settings of memory.
const MOST_PAIRS: usize = 10_000;
const MOST_DENSE: usize = 5_000;

/// What the optimiser asks its caller, with where the answer is awaited.
enum Ask {
    Values(Vec<f64>, Sender<Result<Evaluation, EvaluationFailure>>),
    Gradients(Vec<f64>, Sender<Result<Gradients, EvaluationFailure>>),
    Iteration(Snapshot, Sender<bool>),
}

/// One iteration.
struct Snapshot {
    counts: [usize; 2],
    numbers: [f64; 5],
    x: Vec<f64>,
    constraints: Vec<f64>,
}

/// The data of a program.
struct Given {
    start: Vec<f64>,
    bounds: [Vec<f64>; 2],
    row_bounds: [Vec<f64>; 2],
    names: [Vec<String>; 2],
}

/// A program whose functions are asked of another thread.
struct Program<'a> {
    given: Given,
    tell: &'a dyn Fn(Ask),
    /// Whether the caller answers no more.
    is_left: bool,
    /// The latest gradients of the objective, by point.
    slopes: VecDeque<(Vec<f64>, Vec<f64>)>,
}

impl Program<'_> {
    fn ask<T>(
        &mut self,
        x: &[f64],
        ask: fn(Vec<f64>, Sender<Result<T, EvaluationFailure>>) -> Ask,
    ) -> Result<T, EvaluationFailure> {
        let (answer, answered) = channel();
        if !self.is_left {
            (self.tell)(ask(x.to_vec(), answer));
            if let Ok(found) = answered.recv() {
                return found;
            }
            self.is_left = true;
        }
        Err(EvaluationFailure {
            what: "the run".to_owned(),
            reason: "an exception has ended it".to_owned(),
        })
    }

    /// The gradient of the objective at a point, known or asked for once more.
    fn slope(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        if let Some((_, slope)) = self.slopes.iter().find(|(known, _)| known == x) {
            return Some(slope.clone());
        }
        self.gradients(x).ok().map(|own| own.objective)
    }
}

impl Nlp for Program<'_> {
    fn variables(&self) -> usize {
        self.given.start.len()
    }

    fn constraints(&self) -> usize {
        self.given.row_bounds[0].len()
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let [lower, upper] = &self.given.bounds;
        (lower.clone(), upper.clone())
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let [lower, upper] = &self.given.row_bounds;
        (lower.clone(), upper.clone())
    }

    fn start(&self) -> Vec<f64> {
        self.given.start.clone()
    }

    fn variable_name(&self, i: usize) -> String {
        self.given.names[0][i].clone()
    }

    fn constraint_name(&self, j: usize) -> String {
        self.given.names[1][j].clone()
    }

    fn is_interrupted(&self) -> bool {
        self.is_left
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        self.ask(x, Ask::Values)
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let found = self.ask(x, Ask::Gradients)?;
        if self.slopes.len() == REMEMBERED {
            self.slopes.pop_front();
        }
        self.slopes.push_back((x.to_vec(), found.objective.clone()));
        Ok(found)
    }
}

/// Tells every iteration to the caller.
struct Callback<'a> {
    tell: &'a dyn Fn(Ask),
    is_wanted: bool,
}

impl Observer for Callback<'_> {
    fn iteration(&mut self, row: &Row<'_>) -> ControlFlow<()> {
        if !self.is_wanted {
            return ControlFlow::Continue(());
        }
        let (answer, answered) = channel();
        let snapshot = Snapshot {
            counts: [row.iteration, row.evaluations],
            numbers: [
                row.objective,
                row.infeasibility,
                row.optimality,
                row.barrier,
                row.step,
            ],
            x: row.x.to_vec(),
            constraints: row.constraints.to_vec(),
        };
        (self.tell)(Ask::Iteration(snapshot, answer));
        match answered.recv() {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) | Err(_) => ControlFlow::Break(()),
        }
    }
}

/// The functions of Python, on the thread of the caller.
struct Functions<'py> {
    py: Python<'py>,
    shape: (usize, usize),
    evaluate: Bound<'py, PyAny>,
    gradients: Bound<'py, PyAny>,
    callback: Option<Bound<'py, PyAny>>,
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

impl<'py> Functions<'py> {
    /// Answers a question. Without an answer the run ends.
    fn answer(&self, ask: Ask) -> PyResult<()> {
        // Who asked may have ended by another way.
        match ask {
            Ask::Values(x, answer) => {
                let found = self.or_failure("a value", self.values(x))?;
                let _ = answer.send(found);
            }
            Ask::Gradients(x, answer) => {
                let found = self.or_failure("the gradient", self.derivatives(x))?;
                let _ = answer.send(found);
            }
            Ask::Iteration(snapshot, answer) => {
                let _ = answer.send(!self.stops(snapshot)?);
            }
        }
        Ok(())
    }

    /// An exception as a failure from which the optimiser backs off; others are raised.
    fn or_failure<T>(
        &self,
        what: &str,
        found: PyResult<T>,
    ) -> PyResult<Result<T, EvaluationFailure>> {
        let error = match found {
            Ok(found) => return Ok(Ok(found)),
            Err(error) => error,
        };
        let failed = || {
            self.py
                .import("flexbody.errors")?
                .getattr("SimulationError")
        };
        let backs_off = error.is_instance_of::<PyArithmeticError>(self.py)
            || error.matches(self.py, failed()?)?;
        match backs_off {
            true => Ok(Err(EvaluationFailure {
                what: what.to_owned(),
                reason: error.value(self.py).to_string(),
            })),
            false => Err(error),
        }
    }

    fn values(&self, x: Vec<f64>) -> PyResult<Evaluation> {
        let found = self.evaluate.call1((array(self.py, x),))?;
        let (objective, rows): (f64, PyReadonlyArray1<'py, f64>) = found.extract()?;
        Ok(Evaluation {
            objective,
            constraints: numbers(&rows),
        })
    }

    fn derivatives(&self, x: Vec<f64>) -> PyResult<Gradients> {
        let found = self.gradients.call1((array(self.py, x),))?;
        let (objective, given): (PyReadonlyArray1<'py, f64>, GivenJacobian<'py>) =
            found.extract()?;
        let (m, n) = self.shape;
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

    fn stops(&self, own: Snapshot) -> PyResult<bool> {
        let Some(callback) = &self.callback else {
            return Ok(false);
        };
        let row = PyDict::new(self.py);
        for (name, count) in ["iteration", "evaluations"].into_iter().zip(own.counts) {
            row.set_item(name, count)?;
        }
        let names = [
            "objective",
            "infeasibility",
            "optimality",
            "barrier",
            "step",
        ];
        for (name, number) in names.into_iter().zip(own.numbers) {
            row.set_item(name, number)?;
        }
        row.set_item("x", array(self.py, own.x))?;
        row.set_item("constraints", array(self.py, own.constraints))?;
        let stops = callback.call1((row,))?;
        Ok(!stops.is_none() && stops.is_truthy()?)
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

/// An option, or a fault that names it.
fn option<'py, T: FromPyObjectOwned<'py>>(key: &str, value: &Bound<'py, PyAny>) -> PyResult<T> {
    value.extract::<T>().map_err(|_| {
        let kind = std::any::type_name::<T>();
        let expected = match kind {
            "usize" => "a whole number of at least 0",
            "bool" => "True or False",
            _ => "a number",
        };
        PyTypeError::new_err(format!(
            "found {value} for the option \"{key}\", expected {expected}"
        ))
    })
}

/// Options by name.
fn options(given: &Bound<'_, PyDict>) -> PyResult<Options> {
    let mut own = Options::default();
    for (key, value) in given {
        let key: String = key.extract()?;
        let name = key.as_str();
        match name {
            "method" => {
                own.method = match value.to_string().as_str() {
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
            "tolerance" => own.tolerance = option(name, &value)?,
            "constraint_tolerance" => own.constraint_tolerance = option(name, &value)?,
            "max_iterations" => own.max_iterations = option(name, &value)?,
            "max_evaluations" => own.max_evaluations = option(name, &value)?,
            "max_seconds" if value.is_none() => own.max_seconds = None,
            "max_seconds" => own.max_seconds = Some(option(name, &value)?),
            "unbounded_below" => own.unbounded_below = option(name, &value)?,
            "scale_variables" => own.scale_variables = option(name, &value)?,
            "memory" => own.memory = at_most(name, option(name, &value)?, MOST_PAIRS)?,
            "dense_limit" => own.dense_limit = at_most(name, option(name, &value)?, MOST_DENSE)?,
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

fn at_most(name: &str, found: usize, most: usize) -> PyResult<usize> {
    match found <= most {
        true => Ok(found),
        false => Err(PyValueError::new_err(format!(
            "found {found} for the option \"{name}\", expected at most {most}"
        ))),
    }
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
    let options = self::options(&options)?;
    let given = Given {
        start: numbers(&x0),
        bounds: [numbers(&lower), numbers(&upper)],
        row_bounds: [numbers(&c_lower), numbers(&c_upper)],
        names: [variable_names, constraint_names],
    };
    let (n, m) = (given.start.len(), given.row_bounds[0].len());
    let fits = |all: &[Vec<f64>; 2], count: usize| all.iter().all(|own| own.len() == count);
    if !fits(&given.bounds, n)
        || !fits(&given.row_bounds, m)
        || given.names[0].len() != n
        || given.names[1].len() != m
    {
        let what = "found bounds and names of other lengths than x0 and the rows";
        return Err(PyValueError::new_err(what));
    }
    let functions = Functions {
        py,
        shape: (m, n),
        evaluate,
        gradients,
        callback,
    };
    let is_wanted = functions.callback.is_some();
    let work = move |tell: &dyn Fn(Ask)| {
        let mut program = Program {
            given,
            tell,
            is_left: false,
            slopes: VecDeque::new(),
        };
        let mut observer = Callback { tell, is_wanted };
        let outcome = solve(&mut program, &options, &mut observer);
        let slope = match outcome.objective.is_finite() {
            true => program.slope(&outcome.x),
            false => None,
        };
        (outcome, slope.unwrap_or_else(|| vec![f64::NAN; n]))
    };
    let (outcome, slope) =
        start(py, &Stop::default(), work)?.wait(py, |ask| functions.answer(ask))?;
    match &outcome.status {
        Status::IllPosed { what } => Err(PyValueError::new_err(what.clone())),
        _ => result(py, &outcome, slope),
    }
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
        Method::LeastSquares => "least_squares",
        Method::Auto => "auto",
    };
    out.set_item("method", method)?;
    Ok(out)
}
