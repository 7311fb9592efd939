//! A sum of squares that gives its residuals.

use flexbody_optimiser::{Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp, Residuals};

use super::dual::Dual;
use super::problem::{INF, Problem};

type Formulas = Box<dyn Fn(&[Dual]) -> Vec<Dual>>;

pub struct Squares {
    pub name: &'static str,
    /// Least sum known.
    pub best: f64,
    start: Vec<f64>,
    bounds: (Vec<f64>, Vec<f64>),
    rows: Option<(Vec<f64>, Vec<f64>, Formulas)>,
    residuals: Formulas,
    /// Numbers of evaluations and of gradients.
    pub counts: (usize, usize),
}

impl Squares {
    pub fn new(
        name: &'static str,
        start: &[f64],
        best: f64,
        residuals: impl Fn(&[Dual]) -> Vec<Dual> + 'static,
    ) -> Squares {
        let n = start.len();
        Squares {
            name,
            best,
            start: start.to_vec(),
            bounds: (vec![-INF; n], vec![INF; n]),
            rows: None,
            residuals: Box::new(residuals),
            counts: (0, 0),
        }
    }

    pub fn bounds(mut self, lower: &[f64], upper: &[f64]) -> Squares {
        self.bounds = (lower.to_vec(), upper.to_vec());
        self
    }

    pub fn rows(
        mut self,
        lower: &[f64],
        upper: &[f64],
        rows: impl Fn(&[Dual]) -> Vec<Dual> + 'static,
    ) -> Squares {
        self.rows = Some((lower.to_vec(), upper.to_vec(), Box::new(rows)));
        self
    }

    /// The same as a program that does not know its residuals.
    pub fn into_problem(self) -> Problem {
        let f = self.residuals;
        Problem::new(self.name, &self.start, self.best, move |x| {
            f(x).into_iter().map(|v| v.powi(2)).sum()
        })
    }

    /// Values and derivatives of `f`, row by row.
    fn derivatives(f: &Formulas, x: &[f64]) -> (Vec<f64>, Jacobian) {
        let n = x.len();
        let along = |i: usize| {
            let x: Vec<Dual> = (0..n)
                .map(|k| Dual {
                    value: x[k],
                    slope: if k == i { 1.0 } else { 0.0 },
                })
                .collect();
            f(&x)
        };
        let columns: Vec<Vec<Dual>> = (0..n).map(along).collect();
        let values: Vec<f64> = columns[0].iter().map(|v| v.value).collect();
        let jacobian = Jacobian::from_fn(values.len(), n, |j, i| columns[i][j].slope);
        (values, jacobian)
    }

    pub fn jacobian(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let (values, jacobian) = Self::derivatives(&self.residuals, x);
        let row = |j: usize| (0..x.len()).map(|i| jacobian[(j, i)]).collect();
        (0..values.len()).map(row).collect()
    }

    pub fn values(&self, x: &[f64]) -> Vec<f64> {
        Self::derivatives(&self.residuals, x).0
    }
}

impl Nlp for Squares {
    fn variables(&self) -> usize {
        self.start.len()
    }

    fn constraints(&self) -> usize {
        self.rows.as_ref().map_or(0, |rows| rows.0.len())
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.bounds.clone()
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let rows = self.rows.as_ref();
        rows.map_or_else(Default::default, |rows| (rows.0.clone(), rows.1.clone()))
    }

    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        self.counts.0 += 1;
        let rows = self
            .rows
            .as_ref()
            .map(|rows| Self::derivatives(&rows.2, x).0);
        Ok(Evaluation {
            objective: self.values(x).iter().map(|r| r * r).sum(),
            constraints: rows.unwrap_or_default(),
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        self.counts.1 += 1;
        let (r, j) = Self::derivatives(&self.residuals, x);
        let twice: Vec<f64> = r.iter().map(|r| 2.0 * r).collect();
        let rows = self
            .rows
            .as_ref()
            .map(|rows| Self::derivatives(&rows.2, x).1);
        Ok(Gradients {
            objective: j.weighted_sum(&twice),
            jacobian: rows.unwrap_or_else(|| Jacobian::sparse(0, x.len(), [])),
        })
    }

    fn residuals(&mut self, x: &[f64]) -> Result<Option<Residuals>, EvaluationFailure> {
        let (values, jacobian) = Self::derivatives(&self.residuals, x);
        Ok(Some(Residuals { values, jacobian }))
    }
}
