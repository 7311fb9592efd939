//! Equalities that fix all variables: after a step the point is exact, and the multipliers alone have to move.

use crate::problems::problem::Problem;
use flexbody_optimiser::{Method, Options, Silent, solve};

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];

/// min (x/u)² + 2 x/u where x/u = b, with bounds, in any unit u: x/u = b, and the multiplier of the row is −(2 b + 2).
#[test]
fn one_variable_that_a_row_fixes() {
    for method in METHODS {
        for unit in [1e-3, 1.0, 1e3] {
            for place in [0.3, 0.0, -1.7, 2.9] {
                for upper in [3.0, f64::INFINITY] {
                    let best = place * place + 2.0 * place;
                    let mut program = Problem::new("fixed", &[0.0], best, move |x| {
                        (x[0] / unit).powi(2) + x[0] / unit * 2.0
                    })
                    .bounds(&[-5.0 * unit], &[upper * unit])
                    .rows(0, 1, move |x| vec![x[0] / unit - place]);
                    let options = Options {
                        method,
                        ..Options::default()
                    };
                    let found = solve(&mut program, &options, &mut Silent);
                    let at = format!("{method:?}, {unit}, {place}, {upper}: {:?}", found.status);
                    assert!(found.converged(), "{at}");
                    assert!((found.x[0] / unit - place).abs() < 1e-9, "{at}");
                    let multiplier = found.multipliers.constraints[0];
                    let expected = -(2.0 * place + 2.0);
                    assert!(
                        (multiplier - expected).abs() < 1e-5 * expected.abs(),
                        "{at}: {multiplier} {expected}"
                    );
                    assert!(
                        found.counts.evaluations <= 12,
                        "{at}: {}",
                        found.counts.evaluations
                    );
                }
            }
        }
    }
}

/// Two rows fix two variables: x + y = 1, x − y = 0.2.
#[test]
fn two_variables_that_rows_fix() {
    for method in METHODS {
        let mut program = Problem::new("fixed", &[0.0, 0.0], 1.28, |x| {
            x[0].powi(2) + x[1].powi(2) * 2.0 + x[0]
        })
        .bounds(&[-5.0, -5.0], &[3.0, 4.0])
        .rows(0, 2, |x| vec![x[0] + x[1] - 1.0, x[0] - x[1] - 0.2]);
        let options = Options {
            method,
            ..Options::default()
        };
        let found = solve(&mut program, &options, &mut Silent);
        assert!(found.converged(), "{method:?}: {:?}", found.status);
        // ∇f = (2.2, 1.6) = −Aᵀ y
        let [sum, difference] = found.multipliers.constraints[..] else {
            panic!("two multipliers");
        };
        assert!((sum + 1.9).abs() < 1e-5, "{method:?}: {sum}");
        assert!((difference + 0.3).abs() < 1e-5, "{method:?}: {difference}");
    }
}
