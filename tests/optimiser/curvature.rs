//! Programs that give their second derivatives: fewer iterations to the same optima.

use flexbody_optimiser::{
    Curvature, Evaluation, EvaluationFailure, Gradients, Jacobian, Method, Nlp, Options, Outcome,
    Silent, Status, solve,
};
use nalgebra::{DMatrix, DVector};

use crate::problems::residuals::Residuals;
use crate::problems::truss::Truss;

fn dense(matrix: &Jacobian) -> DMatrix<f64> {
    let (m, n) = matrix.shape();
    DMatrix::from_fn(m, n, |j, i| matrix[(j, i)])
}

/// The matrix diag(d) + Gᵀ W⁻¹ G.
fn hessian(curvature: &Curvature) -> DMatrix<f64> {
    let (g, lower) = (dense(&curvature.coupling), dense(&curvature.stiffness));
    let w = &lower + lower.transpose() - DMatrix::from_diagonal(&lower.diagonal());
    let solved = w.cholesky().expect("W is positive definite").solve(&g);
    g.transpose() * solved + DMatrix::from_diagonal(&DVector::from_vec(curvature.diagonal.clone()))
}

#[test]
fn second_derivatives_of_the_truss_agree_with_differences() {
    let mut truss = Truss::new(5, 3);
    truss.with_curvature = true;
    let n = truss.variables();
    let x: Vec<f64> = (0..n).map(|i| 1.0 + 0.5 * (i as f64).sin()).collect();
    let curvature = truss.curvature(&x, &[1.0]).expect("it gives them");
    let matrix = hessian(&curvature);
    let mut slopes = |i: usize, h: f64| {
        let mut moved = x.clone();
        moved[i] += h;
        let g = truss.gradients(&moved).expect("the truss is stiff");
        DVector::from_vec(g.objective)
    };
    for i in 0..n {
        // The error of this difference is of fourth order.
        let mut central = |h: f64| (slopes(i, h) - slopes(i, -h)) / (2.0 * h);
        let difference = (4.0 * central(5e-4) - central(1e-3)) / 3.0;
        let error = (difference - matrix.column(i)).amax();
        assert!(error <= 1e-9 * matrix.amax(), "{i}: {error}");
    }
}

#[test]
fn a_truss_of_a_thousand_bars_needs_forty_iterations() {
    let mut truss = Truss::new(16, 7);
    truss.with_curvature = true;
    let outcome = solve(&mut truss, &Options::default(), &mut Silent);
    assert_eq!(outcome.status, Status::Converged);
    assert!(outcome.counts.iterations <= 40, "{:?}", outcome.counts);
    let found = Residuals::in_unit(&mut truss, &outcome, 1.0);
    assert!(found.stationarity <= 2e-6 && found.signs, "{found:?}");
    // The same without second derivatives, in 193 iterations.
    assert!((outcome.objective - 1.289_888_90).abs() <= 2e-8);
}

/// Maximise Σ x_i subject to Σ x_i² ≤ 1, or minimise Σ x_i⁴ − x_i².
struct Program {
    n: usize,
    ball: bool,
    /// A fault of the second derivatives.
    fault: fn(&mut Curvature),
}

impl Nlp for Program {
    fn variables(&self) -> usize {
        self.n
    }

    fn constraints(&self) -> usize {
        usize::from(self.ball)
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![-10.0; self.n], vec![10.0; self.n])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let m = self.constraints();
        (vec![f64::NEG_INFINITY; m], vec![1.0; m])
    }

    fn start(&self) -> Vec<f64> {
        (0..self.n).map(|i| 0.1 + 0.01 * (i as f64).cos()).collect()
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let quartic = |v: &f64| v.powi(4) - v * v;
        Ok(Evaluation {
            objective: match self.ball {
                true => -x.iter().sum::<f64>(),
                false => x.iter().map(quartic).sum(),
            },
            constraints: match self.ball {
                true => vec![x.iter().map(|v| v * v).sum()],
                false => Vec::new(),
            },
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let row = x.iter().map(|v| 2.0 * v);
        Ok(Gradients {
            objective: match self.ball {
                true => vec![-1.0; self.n],
                false => x.iter().map(|v| 4.0 * v.powi(3) - 2.0 * v).collect(),
            },
            jacobian: match self.ball {
                true => Jacobian::dense(1, self.n, row.collect()),
                false => Jacobian::sparse(0, self.n, []),
            },
        })
    }

    fn curvature(&mut self, x: &[f64], y: &[f64]) -> Option<Curvature> {
        let mut found = Curvature {
            diagonal: match self.ball {
                true => vec![2.0 * y[0]; self.n],
                false => x.iter().map(|v| 12.0 * v * v - 2.0).collect(),
            },
            coupling: Jacobian::sparse(0, self.n, []),
            stiffness: Jacobian::sparse(0, 0, []),
        };
        (self.fault)(&mut found);
        Some(found)
    }
}

fn run(program: &mut Program) -> Outcome {
    solve(program, &Options::default(), &mut Silent)
}

#[test]
fn curvature_of_rows_and_negative_curvature_are_used() {
    for n in [3, 300] {
        for ball in [true, false] {
            let fault = |_: &mut Curvature| {};
            let outcome = run(&mut Program { n, ball, fault });
            let counts = outcome.counts;
            assert!(outcome.converged() && counts.iterations <= 20, "{counts:?}");
            let expected = match ball {
                true => (n as f64).sqrt(),
                false => 0.25 * n as f64,
            };
            let error = (outcome.objective + expected).abs();
            assert!(error <= 1e-6 * expected, "{n} {ball}: {error}");
        }
    }
}

#[test]
fn other_methods_reach_the_same_optimum() {
    let mut truss = Truss::new(5, 3);
    let mut best = Vec::new();
    for (method, with_curvature) in [
        (Method::InteriorPoint, true),
        (Method::InteriorPoint, false),
        (Method::TrustRegion, true),
        (Method::Auto, true),
    ] {
        truss.with_curvature = with_curvature;
        let options = Options {
            method,
            ..Options::default()
        };
        let outcome = solve(&mut truss, &options, &mut Silent);
        assert!(outcome.converged(), "{method:?}");
        best.push(outcome.objective);
    }
    for f in &best {
        assert!((f - best[0]).abs() <= 1e-6 * best[0], "{best:?}");
    }
}

#[test]
fn faults_of_second_derivatives_are_named() {
    type Fault = fn(&mut Curvature);
    let faults: [(Fault, &str); 4] = [
        (|c| c.diagonal.truncate(2), "shapes 2, 0 × 3, (0, 0)"),
        (|c| c.diagonal[1] = f64::NAN, "not finite"),
        (
            |c| c.coupling = Jacobian::sparse(1, 3, [(0, 0, 1.0)]),
            "(0, 0) where 3, k × 3, (k, k)",
        ),
        (
            |c| {
                c.coupling = Jacobian::sparse(2, 3, []);
                c.stiffness = Jacobian::sparse(2, 2, [(0, 1, 1.0)]);
            },
            "above its diagonal",
        ),
    ];
    for (fault, expected) in faults {
        let n = 3;
        let outcome = run(&mut Program {
            n,
            ball: true,
            fault,
        });
        match outcome.status {
            Status::IllPosed { what } => assert!(what.contains(expected), "{what}"),
            other => panic!("{other:?}"),
        }
    }
}
