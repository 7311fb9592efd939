//! Settings of the time integration.

use super::grid::Grid;
use super::limits::Limits;
use super::quadrature::{ADDED, Samples};
use crate::system::RedundantRows;

/// The integration method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Explicit Runge–Kutta pair of order 8 of Dormand & Prince on the index-1 equations, projected
    /// onto the constraints after each step (Hairer, Nørsett & Wanner 1993, section II.5; Hairer &
    /// Wanner 1996, section VII.2), for scenes that are not stiff.
    Dop853,
    /// Radau IIA with 2 or 3 stages (order 3 or 5) on the GGL-stabilised equations (Hairer &
    /// Wanner 1996, section IV.5), for stiff scenes.
    Radau {
        /// Number of stages, 2 or 3.
        stages: usize,
    },
    /// Backward differentiation formula on the GGL-stabilised equations.
    Bdf {
        /// Order, 1 to 6.
        order: usize,
        /// Method of the first steps.
        start: Start,
    },
    /// Generalised-α method for first-order systems (Jansen, Whiting & Hulbert 2000) on the
    /// GGL-stabilised equations, of order 2.
    GeneralisedAlpha {
        /// Spectral radius ρ∞ at infinite frequency, 0.5 to 0.9.
        radius: f64,
    },
}

/// How the linear systems of implicit steps of finite elements are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearSolver {
    /// By the factors of a matrix, which are kept while they converge.
    #[default]
    Direct,
    /// By FGMRES with kept factors as preconditioner (Kennedy & Boopathy, section IV). It serves one-stage
    /// formulas; Radau IIA is solved directly.
    Krylov,
}

/// How the equations of implicit steps are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSolver {
    /// Solver of linear systems.
    pub linear: LinearSolver,
    /// Newton's method ends at this error of a step, relative to its largest increments of position, rotation, velocity
    /// and angular velocity. Runs with an infinitesimal part end at round-off, whatever it is.
    pub newton: f64,
}

/// Error at which Newton's method ends, if it has to be that of round-off.
pub const TO_ROUND_OFF: f64 = 1e-13;
/// The same error of steps that follow a tolerance, relative to it, and the largest one. Gradients of flexible scenes are
/// off by up to three hundred times it, so that they keep eight digits (`tests/files/newton_tolerance.rs`).
const OF_TOLERANCE: f64 = 1e-3;
const LARGEST: f64 = 3e-11;

impl Default for StepSolver {
    /// Direct, to round-off.
    fn default() -> Self {
        Self {
            linear: LinearSolver::Direct,
            newton: TO_ROUND_OFF,
        }
    }
}

impl StepSolver {
    /// For the steps of a simulation or an optimisation: Newton's method is as accurate as their tolerance asks. Equal
    /// steps have none.
    pub fn suited(linear: LinearSolver, spacing: &Spacing) -> Self {
        let newton = match spacing {
            Spacing::Tolerance(tolerance) => {
                (OF_TOLERANCE * tolerance).clamp(TO_ROUND_OFF, LARGEST)
            }
            Spacing::Steps(_) | Spacing::Frozen(_) => TO_ROUND_OFF,
        };
        Self { linear, newton }
    }
}

/// Method of the first m − 1 steps of a multistep formula of order m.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Radau IIA with three stages, which keeps the order m.
    Radau,
    /// Step k by the formula of order min(k, m) (Kennedy & Boopathy, section II.A). The order of
    /// the run is then at most 2.
    RisingOrder,
}

impl Method {
    /// Order of convergence.
    pub fn order(self) -> usize {
        match self {
            Method::Dop853 => 8,
            Method::Radau { stages } => 2 * stages - 1,
            Method::Bdf {
                order,
                start: Start::Radau,
            } => order,
            Method::Bdf {
                order,
                start: Start::RisingOrder,
            } => order.min(2),
            Method::GeneralisedAlpha { .. } => 2,
        }
    }

    /// Whether the step size can follow an error estimate.
    pub fn is_adaptive(self) -> bool {
        match self {
            Method::Dop853 | Method::Radau { .. } => true,
            Method::Bdf { .. } | Method::GeneralisedAlpha { .. } => false,
        }
    }

    /// The method with this [`Method::name`].
    pub fn named(name: &str) -> Option<Self> {
        let radius = name
            .strip_prefix("generalised-alpha ")
            .and_then(|x| x.parse().ok());
        let alpha = radius.map(|radius| Method::GeneralisedAlpha { radius });
        let formulas = (1..=6).flat_map(|order| {
            [Start::Radau, Start::RisingOrder].map(|start| Method::Bdf { order, start })
        });
        [Method::Dop853]
            .into_iter()
            .chain([2, 3].map(|stages| Method::Radau { stages }))
            .chain(formulas)
            .chain(alpha)
            .find(|method| method.name() == name)
    }

    /// Name of the method with its parameters.
    pub fn name(self) -> String {
        match self {
            Method::Dop853 => "dop853".into(),
            Method::Radau { stages } => format!("radau{stages}"),
            Method::Bdf {
                order,
                start: Start::Radau,
            } => format!("bdf{order}"),
            Method::Bdf {
                order,
                start: Start::RisingOrder,
            } => format!("bdf{order} with rising order"),
            Method::GeneralisedAlpha { radius } => format!("generalised-alpha {radius}"),
        }
    }
}

/// Ends of the steps.
#[derive(Clone, Debug, PartialEq)]
pub enum Spacing {
    /// This many steps of equal size; none at rest.
    Steps(usize),
    /// Adaptive steps: largest estimated error, relative to the scene's lengths and speeds.
    Tolerance(f64),
    /// Steps of an earlier run, stretched to the duration; those between kinks of loads and drives
    /// only after the last kink.
    Frozen(Grid),
}

impl Spacing {
    /// Whether there is no step: the machine is at rest.
    pub fn is_rest(&self) -> bool {
        match self {
            Spacing::Steps(steps) => *steps == 0,
            Spacing::Frozen(grid) => grid.steps() == 0,
            Spacing::Tolerance(_) => false,
        }
    }

    /// Whether the steps are given and equal, or equal between kinks: their accuracy is the user's
    /// choice.
    pub fn is_equal(&self) -> bool {
        match self {
            Spacing::Steps(_) => true,
            Spacing::Frozen(grid) => grid.is_equal(),
            Spacing::Tolerance(_) => false,
        }
    }

    /// Redundant rows that an earlier run left out, if they fit the present ones in number.
    pub(super) fn left_out(&self, now: &RedundantRows) -> &[(usize, RedundantRows)] {
        match self {
            Spacing::Frozen(grid) if grid.choices().iter().all(|(_, rows)| rows.fits(now)) => {
                grid.choices()
            }
            Spacing::Frozen(_) | Spacing::Steps(_) | Spacing::Tolerance(_) => &[],
        }
    }
}

/// Default memory for gradients \[bytes\].
pub const MEMORY: usize = 1 << 28;

/// Method, steps, samples and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Method.
    pub method: Method,
    /// Solver of the equations of implicit steps.
    pub solver: StepSolver,
    /// Ends of the steps.
    pub spacing: Spacing,
    /// Samples of the motion.
    pub samples: Samples,
    /// Limits of the simulation, and the observer of its progress.
    pub limits: Limits,
    /// Memory for the data of a gradient \[bytes\]; a gradient repeats the other steps. Zero if no
    /// gradient is expected: one that follows repeats the motion in [`MEMORY`].
    pub memory: usize,
    /// Whether derivatives are wanted: adaptive steps then resolve the tangent, explicit ones that of the motion and
    /// implicit ones that of an infinitesimal part.
    pub derivatives: bool,
}

impl Samples {
    /// Largest number of samples in `steps` steps, if their cells are known.
    pub fn count(self, steps: usize, grid: Option<&Grid>) -> usize {
        match self {
            Samples::StepEnds => steps,
            Samples::Uniform(samples) => samples,
            Samples::Quadrature(samples) => {
                let nodes = |grid: &Grid| (1..=steps).map(|k| grid.step(k).nodes()).sum();
                samples + grid.map_or(steps * ADDED, nodes)
            }
        }
    }
}

impl Settings {
    /// `steps` equal steps, sampled at their ends.
    pub fn steps(method: Method, steps: usize) -> Self {
        Self {
            method,
            solver: StepSolver::default(),
            spacing: Spacing::Steps(steps),
            samples: Samples::StepEnds,
            limits: Limits::default(),
            memory: MEMORY,
            derivatives: false,
        }
    }
}
