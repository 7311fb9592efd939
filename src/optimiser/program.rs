//! The program that the algorithms see: scaled, without fixed variables and free rows.

use std::ops::ControlFlow;
use std::time::Instant;

use nalgebra::DVector;

use crate::linear::jacobian::Jacobian;
use crate::nlp::{EvaluationFailure, Nlp};
use crate::observer::{Observer, Phase, Row};
use crate::options::{Method, Options};
use crate::outcome::{Counts, FailedDesign};
use crate::state::Scaling;
use crate::status::Status;

/// Values of the scaled functions at a scaled point.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub x: DVector<f64>,
    pub f: f64,
    pub c: DVector<f64>,
}

/// Derivatives of the scaled functions.
#[derive(Clone, Debug)]
pub(crate) struct Derivatives {
    pub g: DVector<f64>,
    pub a: Jacobian,
    /// Derivatives in the fixed variables, in the user's units of these.
    pub fixed_g: DVector<f64>,
    pub fixed_a: Jacobian,
}

impl Derivatives {
    /// Whether neither objective nor rows depend on a variable here, for each of them.
    pub(crate) fn idle(&self) -> Vec<bool> {
        let touched = self.a.touched().into_iter();
        touched
            .zip(self.g.iter())
            .map(|(touched, g)| !touched && *g == 0.0)
            .collect()
    }
}

/// Why an evaluation gave no value.
#[derive(Clone, Debug)]
pub(crate) enum EarlyExit {
    /// The functions are undefined here. Another point may do.
    Failed(EvaluationFailure),
    /// The run must end.
    Halt(Status),
}

impl From<EarlyExit> for Status {
    fn from(exit: EarlyExit) -> Status {
        match exit {
            EarlyExit::Failed(_) => Status::Stalled,
            EarlyExit::Halt(status) => status,
        }
    }
}

/// The data of an iteration besides its point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Progress {
    pub optimality: f64,
    pub barrier: f64,
    pub step: f64,
    pub regularisation: f64,
    pub primal_step: f64,
    pub dual_step: f64,
    pub trials: usize,
    pub phase: Phase,
}

/// Iterations and evaluations after which a method must end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowed {
    pub iterations: usize,
    pub evaluations: usize,
}

/// The scaled program.
pub(crate) struct Program<'a> {
    pub(super) nlp: &'a mut dyn Nlp,
    observer: &'a mut dyn Observer,
    pub options: &'a Options,
    /// Variables whose bounds differ, and those whose bounds coincide.
    pub free: Vec<usize>,
    pub fixed: Vec<usize>,
    /// Rows that have at least one bound.
    pub rows: Vec<usize>,
    /// Bounds of the scaled variables and rows.
    pub lower: DVector<f64>,
    pub upper: DVector<f64>,
    pub row_lower: DVector<f64>,
    pub row_upper: DVector<f64>,
    user_lower: Vec<f64>,
    user_upper: Vec<f64>,
    pub(crate) user_row_lower: Vec<f64>,
    pub(crate) user_row_upper: Vec<f64>,
    template: Vec<f64>,
    pub scaling: Scaling,
    /// Factor by which the units of all variables were changed during the run.
    pub length: f64,
    pub counts: Counts,
    pub failed: Vec<FailedDesign>,
    /// Evaluations that failed since the last one that did not.
    pub(super) failures_in_succession: usize,
    /// The work done when failures were forgiven.
    pub(super) forgiven: Counts,
    started: Instant,
    /// One unit of each variable of `nlp`, in the unit in which forces on it are judged. That is
    /// the unit of the user, or a smaller one if both the scale and the start of the variable are
    /// below it.
    pub units_judged: Vec<f64>,
    /// Norms ‖∇f‖∞ of all points so far, in the units of the user. A repeated point counts once.
    pub gradient_norms: Vec<f64>,
    /// Sizes of the rows at the newest derivatives, in the units of the user.
    pub(crate) row_sizes: Vec<f64>,
    pub(crate) largest_rows: Vec<f64>,
    /// Σ |∂c/∂x_i x_i| of the rows there, in the same units.
    pub(crate) row_changes: Vec<f64>,
    /// Iterations and evaluations allowed to the running method.
    pub(super) allowed: Allowed,
    /// First point reported, and its objective in the units of the user.
    pub(crate) first: Option<(DVector<f64>, f64)>,
    /// Distance from the first point, relative to its size, up to which the way was followed.
    pub(crate) followed: f64,
    /// Best point reported: feasible with the least objective, or least infeasible.
    pub best: Option<Point>,
    /// How a method ended whose end another one replaces, or could not.
    pub other: Option<Status>,
}

impl<'a> Program<'a> {
    /// Takes the bounds from `nlp`; scale factors are 1 until [`Program::scale`] is called.
    pub(crate) fn new(
        nlp: &'a mut dyn Nlp,
        options: &'a Options,
        observer: &'a mut dyn Observer,
    ) -> Program<'a> {
        let (lower, upper) = nlp.variable_bounds();
        let (row_lower, row_upper) = nlp.constraint_bounds();
        let (n, m) = (nlp.variables(), nlp.constraints());
        let (free, fixed): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| lower[i] < upper[i]);
        let rows: Vec<usize> = (0..m)
            .filter(|&j| row_lower[j].is_finite() || row_upper[j].is_finite())
            .collect();
        let mut template = nlp.start();
        for i in 0..n {
            template[i] = template[i].clamp(lower[i], upper[i].max(lower[i]));
        }
        let mut scaling = Scaling {
            objective: 1.0,
            constraints: vec![1.0; m],
            variables: vec![1.0; n],
            ..Scaling::default()
        };
        if options.scale_variables {
            for &i in &free {
                let width = upper[i] - lower[i];
                if width.is_finite() {
                    scaling.variables[i] = width;
                }
            }
        }
        let judged = |i: usize| {
            let unit = nlp.variable_unit(i);
            unit / unit.max((template[i] * unit).abs()).min(1.0)
        };
        let units_judged = (0..n).map(judged).collect();
        let pick = |v: &[f64], index: &[usize]| {
            DVector::from_iterator(index.len(), index.iter().map(|&i| v[i]))
        };
        let unit = |i: usize| scaling.variables[i];
        let scaled =
            |v: &[f64]| DVector::from_iterator(free.len(), free.iter().map(|&i| v[i] / unit(i)));
        Program {
            lower: scaled(&lower),
            upper: scaled(&upper),
            row_lower: pick(&row_lower, &rows),
            row_upper: pick(&row_upper, &rows),
            user_lower: lower,
            user_upper: upper,
            user_row_lower: row_lower,
            user_row_upper: row_upper,
            nlp,
            observer,
            options,
            free,
            fixed,
            rows,
            template,
            scaling,
            length: 1.0,
            counts: Counts::default(),
            failed: Vec::new(),
            failures_in_succession: 0,
            forgiven: Counts::default(),
            started: Instant::now(),
            units_judged,
            gradient_norms: Vec::new(),
            row_sizes: vec![f64::INFINITY; m],
            largest_rows: vec![0.0; m],
            row_changes: vec![0.0; m],
            allowed: Allowed {
                iterations: options.max_iterations,
                evaluations: options.max_evaluations,
            },
            first: None,
            followed: 1.0,
            best: None,
            other: None,
        }
    }

    /// Scaled size of a unit force on variable `i` of `nlp`, given in the units in which forces are
    /// judged.
    pub(crate) fn unit_of_force(&self, i: usize) -> f64 {
        self.scaling.objective * self.scaling.variables[i] * self.units_judged[i]
    }

    /// Scaled start of the user.
    pub(crate) fn start(&self) -> DVector<f64> {
        self.to_scaled(&self.template)
    }

    /// Scaled free variables of a point of the user.
    pub(crate) fn to_scaled(&self, x: &[f64]) -> DVector<f64> {
        let unit = |&i: &usize| x[i] / self.scaling.variables[i];
        DVector::from_iterator(self.free.len(), self.free.iter().map(unit))
    }

    /// Point of the user, with the fixed variables; never outside the bounds by rounding.
    pub(crate) fn to_user(&self, x: &DVector<f64>) -> Vec<f64> {
        let mut full = self.template.clone();
        for (k, &i) in self.free.iter().enumerate() {
            let value = x[k] * self.scaling.variables[i];
            full[i] = value.clamp(self.user_lower[i], self.user_upper[i]);
        }
        full
    }

    /// The nearest point between the bounds.
    pub(crate) fn within_bounds(&self, x: DVector<f64>) -> DVector<f64> {
        DVector::from_fn(x.len(), |i, _| x[i].clamp(self.lower[i], self.upper[i]))
    }

    /// Wall time since the start of the run \[s\].
    pub(crate) fn seconds(&self) -> f64 {
        self.nlp.seconds_since(self.started)
    }

    /// Allows the running method these shares of all iterations and evaluations.
    pub(crate) fn set_budget(&mut self, iterations: f64, evaluations: f64) {
        let part = |share: f64, all: usize| (share * all as f64).ceil() as usize;
        self.allowed = Allowed {
            iterations: part(iterations, self.options.max_iterations),
            evaluations: part(evaluations, self.options.max_evaluations),
        };
    }

    /// Name of constraint `j` of the user.
    pub(crate) fn constraint_name(&self, j: usize) -> String {
        self.nlp.constraint_name(j)
    }

    /// The method that runs first.
    pub(crate) fn first_method(&self) -> Method {
        match self.options.method {
            Method::TrustRegion => Method::TrustRegion,
            Method::LeastSquares => Method::LeastSquares,
            Method::InteriorPoint | Method::Auto => Method::InteriorPoint,
        }
    }

    /// The program of the user.
    pub(crate) fn nlp(&self) -> &dyn Nlp {
        self.nlp
    }

    /// The best point reported, if it is feasible.
    pub(crate) fn feasible_best(&self) -> Option<Point> {
        let best = self.best.clone();
        best.filter(|best| self.is_feasible(&best.c))
    }

    fn keep_best(&mut self, point: &Point) {
        let rank = |p: &Point| (self.relative_violation(&p.c).max(1.0), p.f);
        let better = match &self.best {
            None => true,
            Some(best) => {
                let (new, old) = (rank(point), rank(best));
                new.0 < old.0 || (new.0 == old.0 && new.1 < old.1)
            }
        };
        if better {
            self.best = Some(point.clone());
        }
    }

    /// Starts from the design `x` instead of that of the user.
    pub(crate) fn start_from(&mut self, x: &[f64]) {
        for &i in &self.free {
            self.template[i] = x[i].clamp(self.user_lower[i], self.user_upper[i]);
        }
    }

    /// Values of all rows in the units of the user; zero for rows without bounds.
    pub(crate) fn user_constraints(&self, c: &DVector<f64>) -> Vec<f64> {
        let mut constraints = vec![0.0; self.scaling.constraints.len()];
        for (k, &j) in self.rows.iter().enumerate() {
            constraints[j] = c[k] / self.scaling.constraints[j];
        }
        constraints
    }

    /// Tells the observer of an iteration.
    pub(crate) fn report(&mut self, point: &Point, progress: &Progress) -> Result<(), EarlyExit> {
        self.keep_best(point);
        let f = point.f / self.scaling.objective;
        self.first.get_or_insert_with(|| (point.x.clone(), f));
        let x = self.to_user(&point.x);
        let constraints = self.user_constraints(&point.c);
        let row = Row {
            iteration: self.counts.iterations,
            objective: f,
            infeasibility: self.worst_violation(&point.c).0,
            optimality: progress.optimality,
            barrier: progress.barrier,
            step: progress.step,
            regularisation: progress.regularisation,
            primal_step: progress.primal_step,
            dual_step: progress.dual_step,
            trials: progress.trials,
            evaluations: self.counts.evaluations,
            phase: progress.phase,
            x: &x,
            constraints: &constraints,
        };
        match self.observer.iteration(&row) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(EarlyExit::Halt(Status::Interrupted)),
        }
    }

    /// Counts an iteration and checks the limits before it.
    pub(crate) fn next_iteration(&mut self) -> Result<(), EarlyExit> {
        self.check_limits()?;
        if self.counts.iterations >= self.allowed.iterations {
            return Err(EarlyExit::Halt(Status::IterationLimit));
        }
        self.counts.iterations += 1;
        Ok(())
    }
}
