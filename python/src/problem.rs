//! A problem for Python.

use crate::arrays::{Array, Matrix, array, matrix, numbers};
use crate::errors::{interrupted, optimisation, simulation, unread};
use crate::motion::{Judged, Motion};
use crate::optimum::{Optimum, Wanted, optimise};
use crate::run::{Stop, run};
use flexbody::{Analysis, Design, Override, Sense, SimulationError};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A problem and the steps that its designs share.
#[pyclass(frozen, module = "flexbody._flexbody")]
pub(crate) struct Problem {
    problem: Arc<flexbody::Problem>,
    /// The process that it belongs to: a forked one may inherit it locked, and gets another.
    session: Mutex<(u32, Arc<Mutex<Session>>)>,
    stop: Stop,
    file: Option<PathBuf>,
}

/// Steps and the last design.
#[derive(Default)]
struct Session {
    analysis: Option<Analysis>,
    last: Option<(Vec<u64>, Design)>,
    judged: Judged,
}

type Rows = Vec<Vec<f64>>;
/// Name, unit, lower and upper bound, start, scale, paths.
type VariableRow = (String, String, f64, f64, f64, f64, Vec<String>);
/// Function, variable, adjoint, complex step, terms, and whether they agree but for round-off.
type CheckedRow = (usize, usize, f64, f64, f64, bool);
/// Name, displacement, rotation, stresses of shells and of beams.
type CaseRow<'py> = (String, Matrix<'py>, Matrix<'py>, Array<'py>, Array<'py>);
/// Position, orientation, velocity, angular velocity and elastic coordinates of a body.
type StateRow = (String, [f64; 3], [f64; 4], [f64; 3], [f64; 3], Vec<f64>);

impl Session {
    fn analysis(&mut self, problem: &flexbody::Problem) -> &mut Analysis {
        self.analysis.get_or_insert_with(|| Analysis::new(problem))
    }

    /// The simulated design `x`: the last one, or a new one.
    fn design(
        &mut self,
        problem: &flexbody::Problem,
        x: &[f64],
    ) -> Result<&Design, SimulationError> {
        let bits: Vec<u64> = x.iter().map(|x| x.to_bits()).collect();
        let last = self.last.take().filter(|(known, _)| *known == bits);
        let last = match last {
            Some(last) => last,
            None => (bits, self.analysis(problem).at(x)?),
        };
        Ok(&self.last.insert(last).1)
    }

    /// Values and, if wanted, gradients of the functions `which`.
    fn evaluate(
        &mut self,
        problem: &flexbody::Problem,
        (x, which): (&[f64], &[usize]),
        wanted: [bool; 2],
    ) -> Result<Result<(Vec<f64>, Rows), SimulationError>, String> {
        let known = self
            .judged
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        let design = match self.design(problem, x) {
            Ok(design) => design,
            Err(error) => return Ok(Err(error)),
        };
        let values = match wanted[0] {
            true => design.finite_values(which),
            false => Ok(Vec::new()),
        };
        let gradients = match wanted[1] {
            true => design.finite_gradients(which),
            false => Ok(Vec::new()),
        };
        let both = values.and_then(|values| Ok((values, gradients?)));
        if let (true, Ok((_, gradients))) = (wanted[1], &both) {
            let open = which.iter().zip(gradients);
            let open = open.filter(|(f, _)| !known.contains(f));
            let (open, rows): (Vec<usize>, Rows) = open.map(|(f, row)| (*f, row.clone())).unzip();
            if let (false, Some(why)) = (open.is_empty(), design.unresolved(&open, &rows)) {
                return Err(why);
            }
            let mut judged = self.judged.lock().unwrap_or_else(PoisonError::into_inner);
            judged.extend(open);
        }
        Ok(both)
    }
}

impl Problem {
    fn new(mut problem: flexbody::Problem, file: Option<PathBuf>) -> Self {
        let stop = Stop::default();
        stop.interrupt.attach(&mut problem);
        Self {
            problem: Arc::new(problem),
            session: Mutex::new((std::process::id(), Arc::default())),
            stop,
            file,
        }
    }

    /// The session of this process.
    fn session(&self) -> Arc<Mutex<Session>> {
        let mut own = self.session.lock().unwrap_or_else(PoisonError::into_inner);
        let process = std::process::id();
        if own.0 != process {
            let parents = std::mem::replace(&mut *own, (process, Arc::default()));
            // Nobody unlocks it here.
            std::mem::forget(parents);
            self.stop.forget_calls();
        }
        own.1.clone()
    }

    /// The numbers of a design.
    fn design(&self, x: &PyReadonlyArray1<'_, f64>) -> PyResult<Vec<f64>> {
        let x = numbers(x);
        let variables = self.problem.variables();
        if x.len() != variables.len() {
            return Err(PyValueError::new_err(format!(
                "found a design of {} numbers, expected {}: one for each variable",
                x.len(),
                variables.len()
            )));
        }
        let wrong = x.iter().position(|x| !x.is_finite());
        match wrong {
            None => Ok(x),
            Some(i) => Err(PyValueError::new_err(format!(
                "found {} for the variable \"{}\", expected a finite number",
                x[i], variables[i].name
            ))),
        }
    }

    /// Does `work` with the session on a thread of the package.
    fn with_session<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Session, &flexbody::Problem) -> T + Send + 'static,
    ) -> PyResult<T> {
        let (session, problem) = (self.session(), self.problem.clone());
        self.uninterrupted(py, move || {
            let mut session = session.lock().unwrap_or_else(PoisonError::into_inner);
            work(&mut session, &problem)
        })
    }

    /// Does `work` on a thread of the package.
    fn with_problem<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&flexbody::Problem) -> T + Send + 'static,
    ) -> PyResult<T> {
        let problem = self.problem.clone();
        self.uninterrupted(py, move || work(&problem))
    }

    /// Does `work` on a thread of the package. If a signal to another thread ended it, it is raised here, too.
    fn uninterrupted<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> PyResult<T> {
        let stop = self.stop.clone();
        let (found, stopped) = run(py, &self.stop, move || {
            let found = work();
            (found, stop.has_come())
        })?;
        match stopped {
            true => Err(interrupted()),
            false => Ok(found),
        }
    }
}

/// Changes of a document: pairs of a JSON Pointer and JSON.
fn overrides(pairs: Vec<(String, String)>) -> PyResult<Vec<Override>> {
    let one = |(path, text): (String, String)| {
        if !path.starts_with('/') {
            return Err(PyValueError::new_err(format!(
                "found the path {path:?}, expected a JSON Pointer such as /bodies/arm/mass"
            )));
        }
        let value = serde_json::from_str(&text);
        let value = value.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Override { path, value })
    };
    pairs.into_iter().map(one).collect()
}

#[pymethods]
impl Problem {
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, changes: Vec<(String, String)>) -> PyResult<Self> {
        let changes = overrides(changes)?;
        let own = path.clone();
        let read = move || flexbody::load(&own, &changes);
        match run(py, &Stop::default(), read)? {
            Ok(problem) => Ok(Self::new(problem, Some(path))),
            Err(wrong) => Err(unread(py, &wrong)),
        }
    }

    /// `file` stands for the text in faults, and files that it names lie beside it.
    #[staticmethod]
    fn parse(
        py: Python<'_>,
        text: String,
        file: PathBuf,
        changes: Vec<(String, String)>,
    ) -> PyResult<Self> {
        let changes = overrides(changes)?;
        let own = file.clone();
        let read = move || flexbody::parse(&text, &own.display().to_string(), &changes);
        match run(py, &Stop::default(), read)? {
            Ok(problem) => Ok(Self::new(problem, Some(file))),
            Err(wrong) => Err(unread(py, &wrong)),
        }
    }

    #[getter]
    fn name(&self) -> &str {
        self.problem.name()
    }

    /// The document as JSON, with its changes applied.
    #[getter]
    fn document(&self) -> String {
        self.problem.document.to_string()
    }

    #[getter]
    fn variables(&self) -> Vec<VariableRow> {
        let row = |own: &flexbody::Variable| {
            (
                own.name.clone(),
                own.unit.clone(),
                own.lower,
                own.upper,
                own.start,
                own.scale,
                own.paths.clone(),
            )
        };
        self.problem.variables().iter().map(row).collect()
    }

    /// Names and units.
    #[getter]
    fn functions(&self) -> Vec<(String, String)> {
        let names = self.problem.functions().iter().enumerate();
        names
            .map(|(f, name)| (name.clone(), self.problem.function_unit(f)))
            .collect()
    }

    /// Names of its cases.
    #[getter]
    fn cases(&self) -> Vec<String> {
        let names = self.problem.case_names().into_iter();
        names.map(str::to_owned).collect()
    }

    /// The problem of a case, by its name.
    fn case(&self, name: &str) -> PyResult<Self> {
        let own = self.problem.case(name);
        let own = own.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        Ok(Self::new(own.clone(), self.file.clone()))
    }

    /// Index of the function, and whether it is maximised.
    #[getter]
    fn objective(&self) -> Option<(usize, bool)> {
        let objective = self.problem.stated_objective()?;
        Some((objective.function, objective.sense == Sense::Maximise))
    }

    /// Name, index of the function, lower and upper bound.
    #[getter]
    fn constraints(&self) -> Vec<(String, usize, f64, f64)> {
        let all = self.problem.constraints.iter();
        all.map(|own| (own.name.clone(), own.function, own.lower, own.upper))
            .collect()
    }

    #[getter]
    fn is_at_rest(&self) -> bool {
        self.problem.statics.is_some()
    }

    #[getter]
    fn starts_in_equilibrium(&self) -> bool {
        self.problem.without_equilibrium().is_some()
    }

    /// Whether it names files, which lie beside its own.
    #[getter]
    fn names_files(&self) -> bool {
        self.problem.names_files()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.problem.notes_of_input()
    }

    /// Values and gradients, each if wanted.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        which: Vec<usize>,
        wanted: [bool; 2],
    ) -> PyResult<(Array<'py>, Matrix<'py>)> {
        let x = self.design(&x)?;
        let columns = x.len();
        let found = self.with_session(py, move |session, problem| {
            session.evaluate(problem, (&x, &which), wanted)
        })?;
        let (values, gradients) = found
            .map_err(|why| crate::errors::undefined(py, &why))?
            .map_err(|error| simulation(py, &error))?;
        Ok((array(py, values), matrix(py, &gradients, columns)?))
    }

    fn forget_steps(&self, py: Python<'_>) -> PyResult<()> {
        self.with_session(py, |session, _| *session = Session::default())
    }

    /// The motion at instants that are times, or fractions of the duration; or at those of tables.
    fn motion(
        &self,
        py: Python<'_>,
        x: PyReadonlyArray1<'_, f64>,
        times: Option<PyReadonlyArray1<'_, f64>>,
        fractions: Option<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<Motion> {
        let x = self.design(&x)?;
        let (times, fractions) = (times.as_ref().map(numbers), fractions.as_ref().map(numbers));
        let (found, judged) = self.with_session(py, move |session, problem| {
            let found = session.analysis(problem).motion(&x);
            (found, session.judged.clone())
        })?;
        let motion = found.map_err(|error| simulation(py, &error))?;
        let motion = match (times, fractions) {
            (Some(times), _) => motion.at_times(&times),
            (None, Some(fractions)) => motion.at_fractions(&fractions),
            (None, None) => Ok(motion),
        };
        let motion = motion.map_err(PyValueError::new_err)?;
        Ok(Motion::new(motion, &self.problem, (&judged, &self.stop)))
    }

    /// Nodes and cases.
    fn rest<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<(Matrix<'py>, Vec<CaseRow<'py>>)> {
        let x = self.design(&x)?;
        let found = self.with_problem(py, move |problem| flexbody::rest(problem, &x))?;
        let rest = found.map_err(|error| simulation(py, &error))?;
        let case = |own: flexbody::CaseAtRest| {
            Ok((
                own.name,
                matrix(py, &own.displacement, 3)?,
                matrix(py, &own.rotation, 3)?,
                array(py, own.shell_stress),
                array(py, own.beam_stress),
            ))
        };
        let cases = rest.cases.into_iter().map(case).collect::<PyResult<_>>()?;
        Ok((matrix(py, &rest.nodes, 3)?, cases))
    }

    /// Bodies at the start of the motion.
    fn start_states(
        &self,
        py: Python<'_>,
        x: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Vec<StateRow>> {
        let x = self.design(&x)?;
        let found = self.with_problem(py, move |problem| flexbody::start_states(problem, &x))?;
        let states = found.map_err(|error| simulation(py, &error))?;
        let row = |(name, own, elastic): (String, flexbody::BodyState, Vec<f64>)| {
            (
                name,
                own.position,
                own.orientation,
                own.velocity,
                own.angular_velocity,
                elastic,
            )
        };
        Ok(states.into_iter().map(row).collect())
    }

    /// Frequencies, shapes and the number of rigid motions.
    fn modes<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        count: usize,
    ) -> PyResult<(Array<'py>, Vec<Matrix<'py>>, usize)> {
        let x = self.design(&x)?;
        let found = self.with_problem(py, move |problem| flexbody::modes(problem, &x, count))?;
        let (modes, rigid) = found.map_err(|error| simulation(py, &error))?;
        let frequencies = modes.iter().map(|mode| mode.frequency).collect();
        let shapes = modes.iter().map(|mode| matrix(py, &mode.displacement, 3));
        let shapes = shapes.collect::<PyResult<_>>()?;
        Ok((array(py, frequencies), shapes, rigid))
    }

    /// Every derivative twice, and why they mean nothing, if so.
    fn check(
        &self,
        py: Python<'_>,
        x: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<(Vec<CheckedRow>, Vec<String>)> {
        let x = self.design(&x)?;
        let found = self.with_problem(py, move |problem| {
            let unresolved = flexbody::unresolved(problem, &x);
            flexbody::check(problem, &x).map(|all| (all, unresolved))
        })?;
        let (all, unresolved) = found.map_err(|error| simulation(py, &error))?;
        let row = |own: flexbody::CheckedDerivative| {
            let round_off = own.is_round_off() || own.differs_by_round_off();
            let both = (own.adjoint, own.complex_step, own.terms);
            (
                own.function,
                own.variable,
                both.0,
                both.1,
                both.2,
                round_off,
            )
        };
        Ok((all.into_iter().map(row).collect(), unresolved))
    }

    fn optimise(
        &self,
        py: Python<'_>,
        callback: Option<Py<PyAny>>,
        wanted: Wanted,
    ) -> PyResult<Optimum> {
        optimise(
            py,
            (&self.problem, &self.stop),
            self.file.clone(),
            (callback, wanted),
        )
    }

    /// The page of a design.
    fn page(&self, py: Python<'_>, x: PyReadonlyArray1<'_, f64>, by: String) -> PyResult<String> {
        let x = self.design(&x)?;
        let made = self.with_problem(py, move |problem| {
            flexbody::page_of_design(problem, &x, &by)
        })?;
        made.map_err(|error| optimisation(py, error))
    }
}
