//! Test problems with known optima.

/// Methods of [`flexbody_optimiser::Nlp`] that the field `inner` answers.
macro_rules! inner {
    ($($method:ident),*) => { $($crate::problems::inner!(@ $method);)* };
    (@ variables) => {
        fn variables(&self) -> usize {
            self.inner.variables()
        }
    };
    (@ constraints) => {
        fn constraints(&self) -> usize {
            self.inner.constraints()
        }
    };
    (@ variable_bounds) => {
        fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
            self.inner.variable_bounds()
        }
    };
    (@ constraint_bounds) => {
        fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
            self.inner.constraint_bounds()
        }
    };
    (@ start) => {
        fn start(&self) -> Vec<f64> {
            self.inner.start()
        }
    };
    (@ evaluate) => {
        fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
            self.inner.evaluate(x)
        }
    };
    (@ gradients) => {
        fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
            self.inner.gradients(x)
        }
    };
}
pub(crate) use inner;

pub mod allowed;
pub mod collected;
pub mod dual;
pub mod faulty;
pub mod hard;
mod hs_001_030;
mod hs_031_060;
mod hs_061_086;
mod hs_093_110;
mod hs_111_119;
pub mod least_squares;
pub mod nist;
pub mod problem;
pub mod recorded;
pub mod residuals;
pub mod scaled;
pub mod separable;
pub mod sized_truss;
pub mod squares;
pub mod truss;

use problem::Problem;

/// All problems of Hock & Schittkowski (1981) that are coded here.
pub fn hock_schittkowski() -> Vec<Problem> {
    let mut all = hs_001_030::problems();
    all.extend(hs_031_060::problems());
    all.extend(hs_061_086::problems());
    all.extend(hs_093_110::problems());
    all.extend(hs_111_119::problems());
    all
}
