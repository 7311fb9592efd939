//! Derivatives of programs, compared with differences.

use flexbody_optimiser::{Nlp, derivative_errors};

use crate::problems::hock_schittkowski;

#[test]
fn the_derivatives_of_all_problems_agree_with_differences() {
    for mut problem in hock_schittkowski() {
        // Away from the start, where some functions have kinks.
        let (lower, upper) = problem.variable_bounds();
        let x: Vec<f64> = (problem.start().iter().enumerate())
            .map(|(i, x)| (x + 1e-2 * (1.0 + i as f64).sin()).clamp(lower[i], upper[i]))
            .collect();
        let Ok(found) = derivative_errors(&mut problem, &x) else {
            continue;
        };
        assert_eq!(found.len(), 1 + problem.constraints());
        let size = problem
            .evaluate(&x)
            .map_or(1.0, |e| e.objective.abs().max(1.0));
        for error in found {
            // A difference of large values keeps few digits of a small derivative.
            let rounding = (error.given - error.difference).abs() <= 1e-9 * size;
            assert!(
                error.relative <= 1e-5 || rounding,
                "{}: {error:?}",
                problem.name
            );
        }
    }
}

#[test]
fn a_wrong_derivative_is_named() {
    use flexbody_optimiser::{Functions, Jacobian};
    for place in 0..6 {
        let wrong = |k: usize, v: f64| {
            if k == place {
                v + 1e-3 * (1.0 + v.abs())
            } else {
                v
            }
        };
        let objective = |x: &[f64]| {
            let f = x[0] * x[1] + x[2].sin();
            (
                f,
                vec![wrong(0, x[1]), wrong(1, x[0]), wrong(2, x[2].cos())],
            )
        };
        let rows = |x: &[f64]| {
            let c = x[0].powi(2) * x[1] + x[2];
            let row = vec![
                wrong(3, 2.0 * x[0] * x[1]),
                wrong(4, x[0].powi(2)),
                wrong(5, 1.0),
            ];
            (vec![c], Jacobian::dense(1, 3, row))
        };
        let mut nlp = Functions::new(&[1.0; 3], objective).rows(&[0.0], &[1.0], rows);
        let found = derivative_errors(&mut nlp, &[0.7, -1.3, 0.4]).expect("is defined");
        let bad = &found[place / 3];
        assert!(bad.relative > 1e-4, "{bad:?}");
        assert_eq!(bad.variable, format!("x[{}]", place % 3));
        assert!(found[1 - place / 3].relative < 1e-7, "{found:?}");
    }
}
