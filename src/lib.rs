//! Design of flexible multibody systems by gradient.
//!
//! A problem file describes bodies, joints, loads, design variables, functions, an objective and
//! constraints. It defines a scene for each design. The scene is integrated to a motion, which
//! gives the values of the functions. The adjoint of the motion gives their gradients. With these
//! an interior-point method finds the best design.
//!
//! ```
//! use flexbody::{Analysis, Problem, check, simulate};
//!
//! let text = r#"{
//!     "version": 1, "name": "pendulum",
//!     "bodies": {"bar": {"shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 1,
//!                        "points": {"end": [-0.5, 0, 0]}, "place": {"put": "end", "at": [0, 0, 0]}}},
//!     "joints": {"hinge": {"revolute": {"between": ["bar", "ground"], "at": [0, 0, 0],
//!                                       "axis": [0, 0, 1]}}},
//!     "simulation": {"duration": 0.5, "steps": 100},
//!     "functions": {"height": {"final": {"position": {"body": "bar", "direction": [0, 1, 0]}}}},
//!     "variables": {"gravity": {"path": "/gravity/1", "lower": -20, "upper": -1}},
//!     "gravity": [0, -9.81, 0]
//! }"#;
//! let problem = Problem::parse(text, "pendulum.json", &[])?;
//! let motion = simulate(&problem, &problem.start())?;
//! assert!(motion.constraint_drift().1 < 1e-12);
//! let mut analysis = Analysis::new(&problem);
//! let gradients = analysis.at(&problem.start())?.gradients(&[0])?;
//! for derivative in check(&problem, &problem.start())? {
//!     assert!((derivative.complex_step / gradients[0][0] - 1.0).abs() < 1e-11);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A folder imports only from folders above its own in this list (`tests/files/layers.rs` checks
//! it). `mathematics`, `mechanics`, `optimiser`, `document`, `problem`, `report`, `driver` and `figures` are crates of their
//! own, so that they compile beside each other and an edit compiles only what lies below it:
//!
//! | Folder | What lives there |
//! |---|---|
//! | `mathematics/math` | scalars (real, complex, dual), rotations, smooth maxima |
//! | `mathematics/linalg` | static sparsity patterns, sparse LU and Cholesky |
//! | `mechanics/model` | bodies, joints, loads, gravity: parameters without state |
//! | `mechanics/structures` | shells and beams as finite elements: statics, modes, exact gradients |
//! | `mechanics/system` | kinematics, dynamics, constraints, loads with all derivatives; consistent starts |
//! | `mechanics/integrate` | integration methods, explicit and implicit: equations, steps, trajectories |
//! | `mechanics/functions` | functions of interest and their derivatives |
//! | `mechanics/adjoint` | exact gradients: the backward march through each method |
//! | `mechanics/lower` | reductions of a scene before integration, and their conditions |
//! | `optimiser` | nonlinear programs, without mechanics |
//! | `document` | the document of a problem file: structures and schema |
//! | `problem` | the problem file: faults, and the map from a design to a scene |
//! | `report` | records, comparison, text |
//! | `driver` | simulate, check, optimise; estimate errors, measure methods |
//! | `figures` | figures, the page of a result, fields and tables |
//! | `library` | the public interface: simulate, differentiate, check and optimise a problem |
//! | `cli` | the command line |
//! | `mpi` | the command over processes of MPI |

#![warn(missing_docs)]

pub mod cli;
mod library;
#[cfg(feature = "mpi")]
pub mod mpi;

use flexbody_driver as driver;
use flexbody_figures as figures;
use flexbody_mathematics::math;
use flexbody_mechanics::{adjoint, functions, integrate, model, system};
use flexbody_problem as problem;
use flexbody_report as report;

pub use flexbody_mechanics::structures;
pub use flexbody_optimiser as optimiser;

pub use driver::aggregates::Unread;
pub use library::{
    Analysis, BodyState, CaseAtRest, CheckedDerivative, Cotangents, Design, ElasticStates,
    Energies, Interrupt, Iteration, Mode, Motion, OptimisationError, OptimisationOptions, Optimum,
    PageError, Reactions, Rest, SimulationError, check, load, modes, optimise, optimise_with,
    page_of_design, parse, rest, simulate, start_states, unresolved,
};
pub use problem::{Fault, Faults, Override, OverrideError, Problem, Sense, Variable};
