//! The exceptions of the package, which its file `errors.py` defines.

use flexbody::{Faults, OptimisationError, SimulationError, Unread};
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyValueError};
use pyo3::prelude::*;

/// An exception of the module `flexbody.errors`.
fn of_package(py: Python<'_>, name: &str, arguments: impl for<'py> IntoPyObject<'py>) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let class = py.import("flexbody.errors")?.getattr(name)?;
        Ok(PyErr::from_value(class.call1((arguments,))?))
    };
    made().unwrap_or_else(|error| error)
}

/// The faults of a problem file.
fn faults(py: Python<'_>, faults: &Faults) -> PyErr {
    let all: Vec<_> = faults
        .list
        .iter()
        .map(|fault| {
            let place = (fault.path.clone(), fault.line, fault.column);
            let what = (fault.found.clone(), fault.expected.clone());
            (place, what, fault.hint.clone(), fault.to_string())
        })
        .collect();
    of_package(py, "ProblemError", all)
}

/// A problem that cannot be read, or whose aggregates are not known.
pub(crate) fn unread(py: Python<'_>, unread: &Unread) -> PyErr {
    match unread {
        Unread::Faults(wrong) => faults(py, wrong),
        Unread::NotChosen { pointer, reason } => {
            let place = (pointer.clone(), 0_u32, 0_u32);
            let what = (reason.clone(), "a number \"rho\"".to_owned());
            let all = vec![(place, what, None::<String>, unread.to_string())];
            of_package(py, "ProblemError", all)
        }
    }
}

/// A design without values or gradients.
pub(crate) fn simulation(py: Python<'_>, error: &SimulationError) -> PyErr {
    of_package(py, "SimulationError", error.to_string())
}

/// A bug of the library.
pub(crate) fn internal(py: Python<'_>, what: &str) -> PyErr {
    of_package(py, "InternalError", what)
}

/// An optimisation without a result.
pub(crate) fn optimisation(py: Python<'_>, error: OptimisationError) -> PyErr {
    let text = error.to_string();
    match error {
        // Options of the command line are arguments here.
        OptimisationError::Input(_) => PyValueError::new_err(text.replace("--", "")),
        OptimisationError::Undefined(_) => of_package(py, "SimulationError", text),
        OptimisationError::Interrupted => PyKeyboardInterrupt::new_err(text),
        OptimisationError::File(_) | OptimisationError::Page(_) => PyOSError::new_err(text),
    }
}

/// A design whose values or gradients mean nothing.
pub(crate) fn undefined(py: Python<'_>, why: &str) -> PyErr {
    of_package(py, "SimulationError", why)
}

/// An end by a signal.
pub(crate) fn interrupted() -> PyErr {
    PyKeyboardInterrupt::new_err("interrupted")
}
