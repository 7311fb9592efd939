//! A motion for Python.

use crate::arrays::{Array, Matrix, array, matrix, numbers};
use crate::errors::{simulation, undefined};
use crate::run::{Stop, run};
use flexbody::{Cotangents, SimulationError};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

/// A simulated design.
#[pyclass(frozen, module = "flexbody._flexbody")]
pub(crate) struct Motion {
    motion: Arc<flexbody::Motion>,
    variables: usize,
    functions: usize,
    /// The functions whose derivatives the steps are known to resolve.
    judged: Judged,
    stop: Stop,
}

/// Functions of a problem whose derivatives the steps in use are known to resolve.
pub(crate) type Judged = Arc<Mutex<BTreeSet<usize>>>;

/// By function: its index and the weights of its quantity; and the weights of the instants.
type Weights<'py> = (
    Vec<(usize, PyReadonlyArray1<'py, f64>)>,
    Option<PyReadonlyArray1<'py, f64>>,
);

impl Motion {
    pub(crate) fn new(
        motion: flexbody::Motion,
        problem: &flexbody::Problem,
        (judged, stop): (&Judged, &Stop),
    ) -> Self {
        Self {
            motion: Arc::new(motion),
            variables: problem.variables().len(),
            functions: problem.functions().len(),
            judged: judged.clone(),
            stop: stop.clone(),
        }
    }

    /// Rows of derivatives that mean something.
    fn resolved<'py>(
        &self,
        py: Python<'py>,
        found: Result<(Vec<Vec<f64>>, Option<String>), SimulationError>,
    ) -> PyResult<Matrix<'py>> {
        match found.map_err(|error| simulation(py, &error))? {
            (_, Some(why)) => Err(undefined(py, &why)),
            (rows, None) => matrix(py, &rows, self.variables),
        }
    }

    fn with<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&flexbody::Motion) -> T + Send + 'static,
    ) -> PyResult<T> {
        let motion = self.motion.clone();
        run(py, &self.stop, move || work(&motion))
    }
}

/// Why derivatives of the functions `which` mean nothing, if so; each is judged once.
fn unresolved(
    motion: &flexbody::Motion,
    judged: &Judged,
    which: impl Iterator<Item = usize>,
) -> Result<Option<String>, SimulationError> {
    let known = judged
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .clone();
    let open: Vec<usize> = which.filter(|f| !known.contains(f)).collect();
    if open.is_empty() {
        return Ok(None);
    }
    let why = motion.unresolved(&open)?;
    if why.is_none() {
        let mut judged = judged.lock().unwrap_or_else(PoisonError::into_inner);
        judged.extend(open);
    }
    Ok(why)
}

#[pymethods]
impl Motion {
    fn times<'py>(&self, py: Python<'py>) -> Array<'py> {
        array(py, self.motion.times())
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.motion.duration()
    }

    #[getter]
    fn method(&self) -> String {
        self.motion.method()
    }

    /// Steps, rejected steps, evaluations, Newton iterations, factorisations.
    #[getter]
    fn work(&self) -> [usize; 5] {
        let own = self.motion.work();
        [
            own.steps,
            own.rejected,
            own.evaluations,
            own.newton_iterations,
            own.factorisations,
        ]
    }

    fn values<'py>(&self, py: Python<'py>) -> Array<'py> {
        array(py, self.motion.values())
    }

    fn gradients<'py>(&self, py: Python<'py>) -> PyResult<Matrix<'py>> {
        let which: Vec<usize> = (0..self.functions).collect();
        let judged = self.judged.clone();
        let found = self.with(py, move |motion| {
            let why = unresolved(motion, &judged, which.iter().copied())?;
            Ok((motion.gradients(&which)?, why))
        })?;
        self.resolved(py, found)
    }

    /// Values and the estimated error between samples; `None` for functions without a history.
    fn history<'py>(
        &self,
        py: Python<'py>,
        function: usize,
    ) -> PyResult<Option<(Array<'py>, f64)>> {
        let both = self.with(py, move |motion| {
            Some((motion.history(function)?, motion.history_error(function)?))
        })?;
        Ok(both.map(|(values, error)| (array(py, values), error)))
    }

    /// One row for each set of weights.
    fn pull_back<'py>(&self, py: Python<'py>, all: Vec<Weights<'py>>) -> PyResult<Matrix<'py>> {
        let cotangents = |(functions, times): &Weights<'py>| Cotangents {
            functions: functions.iter().map(|(f, w)| (*f, numbers(w))).collect(),
            times: times.as_ref().map(numbers).unwrap_or_default(),
        };
        let all: Vec<Cotangents> = all.iter().map(cotangents).collect();
        let judged = self.judged.clone();
        let found = self.with(py, move |motion| {
            let which = all
                .iter()
                .flat_map(|own| own.functions.iter().map(|(f, _)| *f));
            let rows = motion.pull_back(&all)?;
            Ok((rows, unresolved(motion, &judged, which)?))
        })?;
        self.resolved(py, found)
    }

    fn bodies(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, flexbody::Motion::bodies)
    }

    fn joints(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, flexbody::Motion::joints)
    }

    fn flexible_bodies(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, flexbody::Motion::flexible_bodies)
    }

    /// Position, orientation, velocity and angular velocity of a body.
    fn states<'py>(&self, py: Python<'py>, body: String) -> PyResult<Option<[Matrix<'py>; 4]>> {
        let Some(states) = self.with(py, move |motion| motion.states(&body))? else {
            return Ok(None);
        };
        let position: Vec<_> = states.iter().map(|own| own.position).collect();
        let orientation: Vec<_> = states.iter().map(|own| own.orientation).collect();
        let velocity: Vec<_> = states.iter().map(|own| own.velocity).collect();
        let spin: Vec<_> = states.iter().map(|own| own.angular_velocity).collect();
        Ok(Some([
            matrix(py, &position, 3)?,
            matrix(py, &orientation, 4)?,
            matrix(py, &velocity, 3)?,
            matrix(py, &spin, 3)?,
        ]))
    }

    /// Elastic coordinates and their rates.
    fn elastic<'py>(&self, py: Python<'py>, body: String) -> PyResult<Option<[Matrix<'py>; 2]>> {
        let Some(found) = self.with(py, move |motion| motion.elastic(&body))? else {
            return Ok(None);
        };
        let count = found.coordinates.first().map_or(0, Vec::len);
        Ok(Some([
            matrix(py, &found.coordinates, count)?,
            matrix(py, &found.rates, count)?,
        ]))
    }

    /// Kinetic and potential energy, momentum and angular momentum.
    fn energies<'py>(&self, py: Python<'py>) -> PyResult<([Array<'py>; 2], [Matrix<'py>; 2])> {
        let found = self.with(py, flexbody::Motion::energies)?;
        Ok((
            [array(py, found.kinetic), array(py, found.potential)],
            [
                matrix(py, &found.momentum, 3)?,
                matrix(py, &found.angular_momentum, 3)?,
            ],
        ))
    }

    /// Largest change of the energy, and largest violations of constraints on positions and velocities.
    fn drift(&self, py: Python<'_>) -> PyResult<(f64, f64, f64)> {
        self.with(py, |motion| {
            let (position, velocity) = motion.constraint_drift();
            (motion.energy_drift(), position, velocity)
        })
    }

    /// Force and torque of a joint.
    fn reactions<'py>(&self, py: Python<'py>, joint: String) -> PyResult<Option<[Matrix<'py>; 2]>> {
        let Some(found) = self.with(py, move |motion| motion.reactions(&joint))? else {
            return Ok(None);
        };
        Ok(Some([
            matrix(py, &found.force, 3)?,
            matrix(py, &found.torque, 3)?,
        ]))
    }

    /// The largest stress of bodies whose stresses are known.
    fn stresses<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Array<'py>)>> {
        let found = self.with(py, flexbody::Motion::stresses)?;
        let named = |(name, values)| (name, array(py, values));
        Ok(found.into_iter().map(named).collect())
    }
}
