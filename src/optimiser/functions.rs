//! A program given by closures.

use crate::linear::jacobian::Jacobian;
use crate::nlp::{Evaluation, EvaluationFailure, Gradients, Nlp};

type Objective<'f> = Box<dyn FnMut(&[f64]) -> (f64, Vec<f64>) + 'f>;
type Rows<'f> = Box<dyn FnMut(&[f64]) -> (Vec<f64>, Jacobian) + 'f>;

/// A program given by closures that return values and derivatives together.
///
/// ```
/// use flexbody_optimiser::{Functions, Jacobian, Options, Silent, solve};
///
/// // Minimise (x − 2)² + y² in the unit disc.
/// let mut disc = Functions::new(&[0.0, 0.5], |x| {
///     let f = (x[0] - 2.0).powi(2) + x[1] * x[1];
///     (f, vec![2.0 * (x[0] - 2.0), 2.0 * x[1]])
/// })
/// .rows(&[f64::NEG_INFINITY], &[1.0], |x| {
///     let c = x[0] * x[0] + x[1] * x[1];
///     (vec![c], Jacobian::dense(1, 2, vec![2.0 * x[0], 2.0 * x[1]]))
/// });
/// let outcome = solve(&mut disc, &Options::default(), &mut Silent);
/// assert!(outcome.converged());
/// assert!((outcome.objective - 1.0).abs() < 1e-6);
/// ```
pub struct Functions<'f> {
    start: Vec<f64>,
    bounds: (Vec<f64>, Vec<f64>),
    row_bounds: (Vec<f64>, Vec<f64>),
    objective: Objective<'f>,
    rows: Option<Rows<'f>>,
}

impl<'f> Functions<'f> {
    /// A program without bounds and rows. `objective` returns f and ∇f.
    pub fn new(
        start: &[f64],
        objective: impl FnMut(&[f64]) -> (f64, Vec<f64>) + 'f,
    ) -> Functions<'f> {
        let n = start.len();
        Functions {
            start: start.to_vec(),
            bounds: (vec![f64::NEG_INFINITY; n], vec![f64::INFINITY; n]),
            row_bounds: (Vec::new(), Vec::new()),
            objective: Box::new(objective),
            rows: None,
        }
    }

    /// Bounds of the variables; an infinite one is absent.
    #[must_use]
    pub fn bounds(mut self, lower: &[f64], upper: &[f64]) -> Functions<'f> {
        self.bounds = (lower.to_vec(), upper.to_vec());
        self
    }

    /// Rows c_L ≤ c(x) ≤ c_U. `rows` returns c and ∂c/∂x.
    #[must_use]
    pub fn rows(
        mut self,
        lower: &[f64],
        upper: &[f64],
        rows: impl FnMut(&[f64]) -> (Vec<f64>, Jacobian) + 'f,
    ) -> Functions<'f> {
        self.row_bounds = (lower.to_vec(), upper.to_vec());
        self.rows = Some(Box::new(rows));
        self
    }
}

impl Nlp for Functions<'_> {
    fn variables(&self) -> usize {
        self.start.len()
    }

    fn constraints(&self) -> usize {
        self.row_bounds.0.len()
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.bounds.clone()
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.row_bounds.clone()
    }

    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        Ok(Evaluation {
            objective: (self.objective)(x).0,
            constraints: self.rows.as_mut().map_or(Vec::new(), |rows| rows(x).0),
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let jacobian = match &mut self.rows {
            Some(rows) => rows(x).1,
            None => Jacobian::sparse(0, x.len(), []),
        };
        Ok(Gradients {
            objective: (self.objective)(x).1,
            jacobian,
        })
    }
}
