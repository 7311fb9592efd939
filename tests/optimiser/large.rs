//! Many variables and many rows: the same optima by dense and by sparse matrices, in memory that
//! grows with the size.

use flexbody_optimiser::{
    Evaluation, EvaluationFailure, Functions, Gradients, Jacobian, Method, Nlp, Options, Outcome,
    Silent, Status, solve,
};

use crate::problems::residuals::Residuals;
use crate::problems::separable::{Rows, Separable};
use crate::problems::truss::Truss;

/// A program whose Jacobian is handed over with all its zeros.
struct Full<N: Nlp>(N);

impl<N: Nlp> Nlp for Full<N> {
    fn variables(&self) -> usize {
        self.0.variables()
    }

    fn constraints(&self) -> usize {
        self.0.constraints()
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.0.variable_bounds()
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.0.constraint_bounds()
    }

    fn start(&self) -> Vec<f64> {
        self.0.start()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        self.0.evaluate(x)
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let found = self.0.gradients(x)?;
        let (m, n) = found.jacobian.shape();
        let jacobian = Jacobian::from_fn(m, n, |j, i| found.jacobian[(j, i)]);
        Ok(Gradients { jacobian, ..found })
    }
}

fn run(nlp: &mut dyn Nlp, method: Method, dense_limit: usize) -> Outcome {
    let options = Options {
        method,
        dense_limit,
        ..Options::default()
    };
    solve(nlp, &options, &mut Silent)
}

fn assert_optimal(nlp: &mut dyn Nlp, outcome: &Outcome, context: &str) {
    assert_eq!(outcome.status, Status::Converged, "{context}");
    let found = Residuals::in_unit(nlp, outcome, 1.0);
    let holds = found.violation <= 1e-6
        && found.stationarity <= 2e-6
        && found.complementarity <= 2e-6
        && found.signs;
    assert!(holds, "{context}: {found:?}");
}

#[test]
fn zeros_of_a_jacobian_change_nothing() {
    for (n, rows) in [(9, 3), (40, 7), (90, 30), (400, 20)] {
        for method in [Method::InteriorPoint, Method::TrustRegion] {
            let new = || Separable {
                n,
                rows: Rows::Sparse(rows),
            };
            let sparse = run(&mut new(), method, 20);
            let full = run(&mut Full(new()), method, 20);
            let context = format!("{method:?}, {n} variables");
            assert_optimal(&mut new(), &sparse, &context);
            let difference = (sparse.objective - full.objective).abs();
            assert!(difference <= 1e-6 * full.objective.abs(), "{context}");
        }
    }
}

#[test]
fn limited_memory_ends_where_a_dense_matrix_does() {
    for (n, rows) in [(12, Rows::Two), (60, Rows::Two), (150, Rows::Sparse(50))] {
        let mut nlp = Separable { n, rows };
        let dense = run(&mut nlp, Method::InteriorPoint, 1000);
        let limited = run(&mut nlp, Method::InteriorPoint, 0);
        assert_optimal(&mut nlp, &dense, &format!("dense, {n} variables"));
        assert_optimal(&mut nlp, &limited, &format!("limited, {n} variables"));
        let difference = (dense.objective - limited.objective).abs();
        assert!(
            difference <= 1e-6 * dense.objective,
            "{n} variables: {difference}"
        );
    }
}

#[test]
fn twenty_thousand_variables_need_little_memory() {
    let n = 20_000;
    for rows in [Rows::Two, Rows::Sparse(1000)] {
        let mut nlp = Separable { n, rows };
        let mut outcome = None;
        let memory = allocation_counter::measure(|| {
            outcome = Some(run(&mut nlp, Method::InteriorPoint, 20));
        });
        let outcome = outcome.expect("the run ends");
        assert_optimal(&mut nlp, &outcome, "20,000 variables");
        assert!(outcome.counts.evaluations <= 150, "{:?}", outcome.counts);
        // A matrix of n × n would take 3.2 GB.
        assert!(memory.bytes_max < 120_000_000, "{}", memory.bytes_max);
    }
}

/// Minimise Σ a_i/x_i subject to Σ x_i ≤ n/2: the optimum has x_i in proportion to √a_i. The
/// coefficients are spread over `decades`.
#[test]
fn reciprocal_programs_need_few_evaluations_whatever_their_spread() {
    for n in [30, 300, 3000] {
        for decades in [0.0, 2.0, 6.0] {
            let share = |i: usize| (i as f64 * 0.618_033_988_749_895).fract();
            let a: Vec<f64> = (0..n).map(|i| 10_f64.powf(-decades * share(i))).collect();
            let mut nlp = Functions::new(&vec![0.5; n], |x| {
                let f = a.iter().zip(x).map(|(a, x)| a / x).sum();
                (f, a.iter().zip(x).map(|(a, x)| -a / (x * x)).collect())
            })
            .bounds(&vec![1e-6; n], &vec![100.0; n])
            .rows(&[f64::NEG_INFINITY], &[0.5 * n as f64], |x| {
                (vec![x.iter().sum()], Jacobian::dense(1, n, vec![1.0; n]))
            });
            let outcome = run(&mut nlp, Method::InteriorPoint, 20);
            let context = format!("{n} variables, {decades} decades: {:?}", outcome.counts);
            assert!(outcome.converged(), "{context}");
            let roots: f64 = a.iter().map(|a| a.sqrt()).sum();
            let best = roots * roots / (0.5 * n as f64);
            assert!((outcome.objective - best).abs() <= 1e-6 * best, "{context}");
            assert!(outcome.counts.evaluations <= 50, "{context}");
        }
    }
}

#[test]
fn a_truss_becomes_as_stiff_as_possible() {
    let mut truss = Truss::new(7, 4);
    let options = Options {
        max_iterations: 1000,
        ..Options::default()
    };
    let outcome = solve(&mut truss, &options, &mut Silent);
    assert_optimal(&mut truss, &outcome, "truss");
    // In the stiffest truss all bars between their bounds have the same strain.
    let slopes = truss.gradients(&outcome.x).expect("the truss is stiff");
    let strains = (0..outcome.x.len())
        .filter(|&i| outcome.x[i] > 0.01)
        .map(|i| slopes.objective[i] / slopes.jacobian[(0, i)]);
    let (least, most) = strains.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| {
        (a.min(s), b.max(s))
    });
    assert!((most - least).abs() <= 1e-3 * most.abs(), "{least} {most}");
}

/// The largest ball in a polyhedron of `rows` faces, each of which touches the unit ball.
struct Ball {
    n: usize,
    rows: usize,
    /// Whether the first face comes twice, as equalities.
    pinned: bool,
}

impl Ball {
    fn normal(&self, j: usize) -> Vec<f64> {
        let entry = |i: usize| (((j + 1) * (i + 2)) as f64 * 0.754_877_666).fract() - 0.5;
        let row: Vec<f64> = (0..self.n).map(entry).collect();
        let norm = row.iter().map(|v| v * v).sum::<f64>().sqrt();
        row.iter().map(|v| v / norm).collect()
    }
}

impl Nlp for Ball {
    fn variables(&self) -> usize {
        self.n + 1
    }

    fn constraints(&self) -> usize {
        self.rows + if self.pinned { 2 } else { 0 }
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![-10.0; self.n + 1], vec![10.0; self.n + 1])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let m = self.constraints();
        let lower = (0..m).map(|j| {
            if j < self.rows {
                f64::NEG_INFINITY
            } else {
                0.25
            }
        });
        let upper = (0..m).map(|j| if j < self.rows { 1.0 } else { 0.25 });
        (lower.collect(), upper.collect())
    }

    fn start(&self) -> Vec<f64> {
        let mut start = vec![0.3; self.n];
        start.push(0.0);
        start
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let jacobian = self.gradients(x)?.jacobian;
        let rows = 0..self.constraints();
        Ok(Evaluation {
            objective: -x[self.n],
            constraints: rows
                .map(|j| jacobian.row(j).map(|(i, v)| v * x[i]).sum())
                .collect(),
        })
    }

    fn gradients(&mut self, _x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let mut objective = vec![0.0; self.n + 1];
        objective[self.n] = -1.0;
        let rows = (0..self.constraints()).map(|j| match j {
            j if j < self.rows => [self.normal(j), vec![1.0]].concat(),
            _ => [vec![1.0], vec![0.0; self.n]].concat(),
        });
        let values = rows.collect::<Vec<_>>().concat();
        Ok(Gradients {
            objective,
            jacobian: Jacobian::dense(self.constraints(), self.n + 1, values),
        })
    }
}

#[test]
fn thousands_of_rows_of_few_variables() {
    for (n, rows, pinned) in [
        (3, 400, false),
        (5, 3000, false),
        (4, 150, true),
        (4, 500, true),
        (15, 2000, true),
        (30, 1000, true),
        (40, 2000, true),
    ] {
        let mut ball = Ball { n, rows, pinned };
        let outcome = run(&mut ball, Method::InteriorPoint, 20);
        assert_optimal(&mut ball, &outcome, &format!("{n} variables, {rows} rows"));
        // The faces touch the unit ball, so a ball of radius 1 about the origin fits, or one of at
        // least 3/4 whose centre has a coordinate of 1/4.
        let least = if pinned { 0.75 } else { 1.0 };
        assert!(-outcome.objective >= least - 1e-6, "{}", outcome.objective);
        let own = outcome.counts.seconds - outcome.counts.evaluation_seconds;
        assert!(own < 20.0, "{own} s");
    }
}
