//! Consecutive designs: values and exact gradients on kept steps.

use super::SimulationError;
use super::response::{Motion, has_one_motion};
use crate::driver::integration::Integration;
use crate::driver::{Analysed, AnalysisFailure, Evaluated};
use crate::integrate::WorkCounts;
use crate::problem::Problem;
use std::sync::Arc;

/// Simulates consecutive designs and differentiates them.
///
/// It keeps the time steps from design to design. So values are smooth in the design, and gradients
/// are exact. It chooses new steps if their error has grown.
#[derive(Clone)]
pub struct Analysis {
    problem: Arc<Problem>,
    integration: Integration,
}

impl Analysis {
    /// An analysis of all functions of `problem`.
    pub fn new(problem: &Problem) -> Self {
        let all: Vec<usize> = (0..problem.functions().len()).collect();
        // Parts on which no function depends are not simulated.
        let problem = problem.focused(&all).unwrap_or_else(|| problem.clone());
        Self {
            integration: Integration::of(&problem, Some(&all), true),
            problem: Arc::new(problem),
        }
    }

    /// Simulates the design `x`: one number per variable.
    ///
    /// # Errors
    /// The joints cannot be closed, or the motion cannot be integrated to its end.
    pub fn at(&mut self, x: &[f64]) -> Result<Design, SimulationError> {
        let all: Vec<usize> = (0..self.problem.functions().len()).collect();
        let (evaluated, _) = Analysed::with(&mut self.integration, &self.problem, x, &all)?;
        Ok(Design {
            problem: self.problem.clone(),
            evaluated,
        })
    }

    /// Simulates the design `x` and samples the whole motion.
    ///
    /// # Errors
    /// As of [`Analysis::at`], or the problem is one of structures without a motion.
    pub fn motion(&mut self, x: &[f64]) -> Result<Motion, SimulationError> {
        has_one_motion(&self.problem)?;
        let evaluate = |integration: &mut Integration| {
            let found = Evaluated::with(integration, &self.problem, x);
            found.map_err(AnalysisFailure::from)
        };
        // A motion that is sampled throughout would choose other steps than the values do.
        if self.integration.chosen().is_none() {
            evaluate(&mut self.integration)?;
        }
        let sampled = |integration: &Integration| {
            let mut whole = integration.clone();
            whole.see_whole();
            evaluate(&mut whole)
        };
        let evaluated = match sampled(&self.integration)? {
            (evaluated, None) => evaluated,
            // The steps in use do not suit this design.
            (_, Some(_)) => {
                evaluate(&mut self.integration)?;
                sampled(&self.integration)?.0
            }
        };
        Ok(Motion::new(self.problem.clone(), evaluated))
    }

    /// Chooses the time steps anew at the next design.
    pub fn forget_steps(&mut self) {
        let all: Vec<usize> = (0..self.problem.functions().len()).collect();
        self.integration = Integration::of(&self.problem, Some(&all), true);
    }
}

/// A simulated design, with values and gradients.
pub struct Design {
    problem: Arc<Problem>,
    evaluated: Analysed,
}

impl Design {
    /// Value of every function, in the order of [`Problem::functions`].
    pub fn values(&self) -> Vec<f64> {
        let count = self.problem.functions().len();
        (0..count).map(|f| self.evaluated.value(f)).collect()
    }

    /// Exact gradients of the functions with the indices `which`: one row per function, one number
    /// per variable. The discrete adjoint of the time integration computes them in one backward
    /// march.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn gradients(&self, which: &[usize]) -> Result<Vec<Vec<f64>>, SimulationError> {
        Ok(self.gradients_and_work(which)?.0)
    }

    /// Values of the functions with the indices `which`.
    ///
    /// # Errors
    /// A value is not finite.
    pub fn finite_values(&self, which: &[usize]) -> Result<Vec<f64>, SimulationError> {
        Ok(self.evaluated.finite_values(&self.problem, which)?)
    }

    /// As [`Design::gradients`], of functions that have finite derivatives here.
    ///
    /// # Errors
    /// Also if a function has a kink here, or a derivative is not finite.
    pub fn finite_gradients(&self, which: &[usize]) -> Result<Vec<Vec<f64>>, SimulationError> {
        Ok(self.evaluated.finite_gradients(&self.problem, which)?)
    }

    /// Why gradients of the functions `which` mean nothing, if so: the steps do not resolve them.
    pub fn unresolved(&self, which: &[usize], gradients: &[Vec<f64>]) -> Option<String> {
        self.evaluated.refused(&self.problem, which, gradients)
    }

    /// [`Design::gradients`], and their work.
    ///
    /// # Errors
    /// The equations of a step are singular.
    pub fn gradients_and_work(
        &self,
        which: &[usize],
    ) -> Result<(Vec<Vec<f64>>, WorkCounts), SimulationError> {
        Ok(self.evaluated.gradients(&self.problem, which)?)
    }

    /// Work of the simulation.
    pub fn work(&self) -> WorkCounts {
        self.evaluated.counts()
    }
}
