//! A test problem, given by formulas in dual numbers.

use flexbody_optimiser::{Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp};

use super::dual::Dual;

pub const INF: f64 = f64::INFINITY;

type Formula = Box<dyn Fn(&[Dual]) -> Dual>;
type Formulas = Box<dyn Fn(&[Dual]) -> Vec<Dual>>;

pub struct Problem {
    pub name: &'static str,
    /// Least objective known.
    pub best: f64,
    start: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    row_lower: Vec<f64>,
    row_upper: Vec<f64>,
    objective: Formula,
    rows: Formulas,
}

impl Problem {
    pub fn new(
        name: &'static str,
        start: &[f64],
        best: f64,
        objective: impl Fn(&[Dual]) -> Dual + 'static,
    ) -> Problem {
        Problem {
            name,
            best,
            start: start.to_vec(),
            lower: vec![-INF; start.len()],
            upper: vec![INF; start.len()],
            row_lower: Vec::new(),
            row_upper: Vec::new(),
            objective: Box::new(objective),
            rows: Box::new(|_| Vec::new()),
        }
    }

    /// Bounds of each variable.
    pub fn bounds(mut self, lower: &[f64], upper: &[f64]) -> Problem {
        self.lower = lower.to_vec();
        self.upper = upper.to_vec();
        self
    }

    /// The same bounds for every variable.
    pub fn all_within(mut self, lower: f64, upper: f64) -> Problem {
        self.lower.fill(lower);
        self.upper.fill(upper);
        self
    }

    /// Rows, of which the first `inequalities` must be ≥ 0 and the other `equalities` = 0.
    pub fn rows(
        mut self,
        inequalities: usize,
        equalities: usize,
        rows: impl Fn(&[Dual]) -> Vec<Dual> + 'static,
    ) -> Problem {
        let m = inequalities + equalities;
        self.row_lower = vec![0.0; m];
        self.row_upper = (0..m)
            .map(|j| if j < inequalities { INF } else { 0.0 })
            .collect();
        self.rows = Box::new(rows);
        self
    }

    /// Replaces the bounds of the rows.
    pub fn row_bounds(mut self, lower: &[f64], upper: &[f64]) -> Problem {
        self.row_lower = lower.to_vec();
        self.row_upper = upper.to_vec();
        self
    }
}

fn dual(x: &[f64], direction: usize) -> Vec<Dual> {
    let slope = |i| if i == direction { 1.0 } else { 0.0 };
    x.iter()
        .enumerate()
        .map(|(i, &value)| Dual {
            value,
            slope: slope(i),
        })
        .collect()
}

impl Nlp for Problem {
    fn variables(&self) -> usize {
        self.start.len()
    }

    fn constraints(&self) -> usize {
        self.row_lower.len()
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (self.lower.clone(), self.upper.clone())
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (self.row_lower.clone(), self.row_upper.clone())
    }

    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let x = dual(x, usize::MAX);
        let constraints = (self.rows)(&x).iter().map(|c| c.value).collect();
        Ok(Evaluation {
            objective: (self.objective)(&x).value,
            constraints,
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let n = x.len();
        let mut objective = vec![0.0; n];
        let m = self.row_lower.len();
        let mut jacobian = vec![0.0; m * n];
        for i in 0..n {
            let x = dual(x, i);
            objective[i] = (self.objective)(&x).slope;
            for (j, c) in (self.rows)(&x).iter().enumerate() {
                jacobian[j * n + i] = c.slope;
            }
        }
        Ok(Gradients {
            objective,
            jacobian: Jacobian::dense(m, n, jacobian),
        })
    }
}
