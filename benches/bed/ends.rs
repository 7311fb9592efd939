//! Programs without an optimum, or whose functions end or lie.

use flexbody::optimiser::{Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp};

use crate::case::{Case, Truth, case, known};
use crate::problems::dual::Dual;
use crate::problems::hard;
use crate::problems::problem::{INF, Problem};

fn sq(x: Dual) -> Dual {
    x.powi(2)
}

fn nan_if(condition: bool, x: Dual) -> Dual {
    if condition { x * f64::NAN } else { x }
}

pub fn cases() -> Vec<Case> {
    let mut all = unbounded();
    all.extend(infeasible());
    all.extend(hard_to_reach());
    all.extend(undefined());
    all.extend(wrong());
    all
}

fn unbounded() -> Vec<Case> {
    [
        hard::unbounded_linear(),
        hard::unbounded_concave(),
        Problem::new("cube", &[-1.0], 0.0, |x| x[0].powi(3)),
        Problem::new("exponential", &[0.0, 1.0], 0.0, |x| sq(x[1]) - x[0].exp()),
        Problem::new("saddle", &[1.0, 1e-3], 0.0, |x| sq(x[0]) - sq(x[1])),
        Problem::new("ray", &[0.0, 0.0], 0.0, |x| -x[0]).rows(1, 0, |x| vec![1.0 - x[0] + x[1]]),
        Problem::new("logarithm of a square", &[1.0], 0.0, |x| {
            -((1.0 + sq(x[0])).ln())
        }),
        Problem::new("large logarithm", &[1.0], 0.0, |x| {
            -1e7 * (1.0 + sq(x[0])).ln()
        }),
        Problem::new("root", &[1.0, 2.0], 0.0, |x| sq(x[1]) - x[0].sqrt())
            .bounds(&[0.0, -INF], &[INF, INF]),
        Problem::new("parabola on a line", &[1.0, 0.5], 0.0, |x| -(x[0] * x[1]))
            .rows(0, 1, |x| vec![x[0] - x[1]]),
    ]
    .into_iter()
    .map(|p| known("unbounded", Truth::Unbounded, p))
    .collect()
}

fn infeasible() -> Vec<Case> {
    [
        hard::contradiction(),
        hard::without_root(),
        Problem::new("row above zero", &[2.0], 0.0, |x| x[0]).rows(1, 0, |x| vec![-1.0 - sq(x[0])]),
        Problem::new(
            "two rows that exclude each other",
            &[0.0],
            0.0,
            |x| sq(x[0]),
        )
        .rows(2, 0, |x| vec![x[0] - 2.0, 1.0 - x[0]]),
        Problem::new("two discs apart", &[0.0, 2.0], 0.0, |x| x[0] + x[1]).rows(2, 0, |x| {
            vec![1.0 - sq(x[0]) - sq(x[1]), 1.0 - sq(x[0] - 3.0) - sq(x[1])]
        }),
        Problem::new("sine of two", &[0.5], 0.0, |x| sq(x[0]))
            .rows(0, 1, |x| vec![x[0].sin() - 2.0]),
        Problem::new("shares too large", &[0.5; 10], 0.0, |x| sq(x[0]))
            .all_within(0.2, INF)
            .rows(0, 1, |x| vec![x.iter().copied().sum::<Dual>() - 1.0]),
        Problem::new("parabola without a root", &[5.0, 5.0], 0.0, |x| x[0])
            .rows(0, 2, |x| vec![x[1] - sq(x[0]), x[0] + x[1] + 1.0]),
        Problem::new("infeasible far away", &[100.0, -50.0], 0.0, |x| sq(x[0])).rows(0, 1, |x| {
            vec![1.0 + (-(1e-4 * (sq(x[0]) + sq(x[1])))).exp()]
        }),
        Problem::new("infeasible along a valley", &[-1.2, 1.0], 0.0, |x| sq(x[0])).rows(
            0,
            3,
            |x| vec![10.0 * (x[1] - sq(x[0])), 1.0 - x[0], x[0] + x[1]],
        ),
    ]
    .into_iter()
    .map(|p| known("infeasible", Truth::Infeasible, p))
    .collect()
}

/// Feasible, but the violation has other stationary points or falls slowly.
fn hard_to_reach() -> Vec<Case> {
    let mut root = -2.6_f64;
    for _ in 0..50 {
        root -= (root.powi(3) - 3.0 * root + 10.0) / (3.0 * root * root - 3.0);
    }
    [
        Problem::new(
            "beyond a minimum of the violation",
            &[1.2],
            root * root,
            |x| sq(x[0]),
        )
        .rows(0, 1, |x| vec![x[0].powi(3) - 3.0 * x[0] + 10.0]),
        Problem::new("long way", &[-1.0, 1.0, 1.0, 1.0], 0.0, |x| 0.0 * x[0]).rows(0, 4, |x| {
            let mut rows: Vec<Dual> = (1..4).map(|i| x[i] - 2.0 * sq(x[i - 1]) + 1.0).collect();
            rows.push(0.5 * (x[0] - 1.0));
            rows
        }),
        Problem::new("maximum of the violation", &[0.0, 0.0], 1.0, |x| {
            sq(x[0]) + sq(x[1])
        })
        .rows(1, 0, |x| vec![sq(x[0]) + sq(x[1]) - 1.0]),
        Problem::new("flat far away", &[8.0, 0.0], 0.0, |x| sq(x[1]))
            .rows(0, 1, |x| vec![1.0 - (-(0.5 * sq(x[0] - 1.0))).exp() + x[1]]),
        Problem::new("steep valley of rows", &[-3.0, -4.0], 0.0, |x| 0.0 * x[0])
            .rows(0, 2, |x| vec![100.0 * (x[1] - x[0].powi(3)), 1.0 - x[0]]),
    ]
    .into_iter()
    .map(|p| case("reach", p))
    .collect()
}

fn undefined() -> Vec<Case> {
    vec![
        case("undefined", hard::logarithm()),
        case(
            "undefined",
            Problem::new("two logarithms", &[0.01], 2.0 * 2.0_f64.ln(), |x| {
                -(x[0].ln()) - (1.0 - x[0]).ln()
            }),
        ),
        case(
            "undefined",
            Problem::new("half ball", &[0.5, 0.5], -(3.0_f64.sqrt()), |x| {
                -(x[0] + x[1] + (1.0 - sq(x[0]) - sq(x[1])).sqrt())
            }),
        ),
        case(
            "undefined",
            Problem::new("power without bound", &[1.0], 0.0, |x| x[0].powf(1.5)),
        ),
        case(
            "undefined",
            Problem::new("analytic centre", &[0.9, 0.05], 3.0 * 3.0_f64.ln(), |x| {
                -(x[0].ln()) - x[1].ln() - (1.0 - x[0] - x[1]).ln()
            }),
        ),
        case(
            "undefined",
            Problem::new("valley beside a region", &[-1.2, 1.0], 0.0, |x| {
                let f = 100.0 * sq(x[1] - sq(x[0])) + sq(1.0 - x[0]);
                nan_if(x[1].value < sq(x[0]).value - 0.5, f)
            }),
        ),
        known(
            "undefined",
            Truth::Hopeless,
            Problem::new("edge", &[3.0, 2.0], 1.0, |x| {
                nan_if(x[0].value < 1.0, x[0] + sq(x[1]))
            }),
        ),
        known(
            "undefined",
            Truth::Hopeless,
            Problem::new("edge of a bowl", &[0.0, 0.0], 1.0, |x| {
                nan_if(x[0].value > 1.0, sq(x[0] - 2.0) + sq(x[1] - 1.0))
            }),
        ),
        known(
            "undefined",
            Truth::Hopeless,
            Problem::new("edge with a row", &[0.0, 0.0], 1.0, |x| {
                nan_if(x[0].value > 1.0, sq(x[0] - 2.0) + sq(x[1] - 1.0))
            })
            .rows(0, 1, |x| vec![x[0] - x[1]]),
        ),
    ]
}

/// How derivatives or lists are wrong.
#[derive(Clone, Copy)]
enum Lie {
    Sign,
    Twice,
    Missing,
    Constant,
    Noise(f64),
    LongGradient,
    ShortConstraints,
    WideJacobian,
    /// Gradients fail from this call on.
    FailFrom(usize),
}

struct Liar {
    inner: Problem,
    lie: Lie,
    calls: usize,
}

impl Nlp for Liar {
    crate::problems::inner!(
        variables,
        constraints,
        variable_bounds,
        constraint_bounds,
        start
    );

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let mut values = self.inner.evaluate(x)?;
        if let Lie::ShortConstraints = self.lie {
            values.constraints.pop();
        }
        Ok(values)
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let mut slopes = self.inner.gradients(x)?;
        self.calls += 1;
        let g = &mut slopes.objective;
        match self.lie {
            Lie::Sign => g.iter_mut().for_each(|v| *v = -*v),
            Lie::Twice => g.iter_mut().for_each(|v| *v *= 2.0),
            Lie::Missing => g[0] = 0.0,
            Lie::Constant => g.fill(1.0),
            Lie::Noise(part) => {
                for (i, v) in g.iter_mut().enumerate() {
                    let phase = (1e3 * x.iter().sum::<f64>() + i as f64).sin();
                    *v *= 1.0 + part * phase;
                }
            }
            Lie::LongGradient => g.push(0.0),
            Lie::WideJacobian => {
                slopes.jacobian = Jacobian::dense(1, 3, vec![0.0; 3]);
            }
            Lie::FailFrom(call) if self.calls >= call => {
                return Err(EvaluationFailure {
                    what: "the gradient".into(),
                    reason: "the adjoint failed".into(),
                });
            }
            Lie::ShortConstraints | Lie::FailFrom(_) => {}
        }
        Ok(slopes)
    }
}

fn bowl() -> Problem {
    Problem::new("bowl", &[3.0, -2.0], 0.0, |x| {
        sq(x[0] - 1.0) + 4.0 * sq(x[1] - 1.0)
    })
}

fn bowl_with_row() -> Problem {
    bowl().rows(1, 0, |x| vec![1.5 - x[0] - x[1]])
}

fn rosenbrock() -> Problem {
    Problem::new("Rosenbrock", &[-1.2, 1.0], 0.0, |x| {
        100.0 * sq(x[1] - sq(x[0])) + sq(1.0 - x[0])
    })
}

fn wrong() -> Vec<Case> {
    let flat = Problem::new("flat", &[3.0, -2.0], 0.0, |x| 0.0 * x[0]);
    [
        ("gradient of wrong sign", Truth::Hopeless, Lie::Sign, bowl()),
        (
            "gradient of wrong sign, row",
            Truth::Hopeless,
            Lie::Sign,
            bowl_with_row(),
        ),
        (
            "gradient twice too large",
            Truth::Optimum(0.0),
            Lie::Twice,
            bowl(),
        ),
        (
            "gradient twice too large, valley",
            Truth::Optimum(0.0),
            Lie::Twice,
            rosenbrock(),
        ),
        (
            "derivative forgotten",
            Truth::Hopeless,
            Lie::Missing,
            rosenbrock(),
        ),
        (
            "derivative forgotten, row",
            Truth::Hopeless,
            Lie::Missing,
            bowl_with_row(),
        ),
        ("constant gradient", Truth::Hopeless, Lie::Constant, bowl()),
        ("constant objective", Truth::Hopeless, Lie::Constant, flat),
        (
            "gradient with noise of 1e-8",
            Truth::Optimum(0.0),
            Lie::Noise(1e-8),
            rosenbrock(),
        ),
        (
            "gradient with noise of 1e-3",
            Truth::Optimum(0.0),
            Lie::Noise(1e-3),
            rosenbrock(),
        ),
        (
            "gradient too long",
            Truth::IllPosed,
            Lie::LongGradient,
            bowl(),
        ),
        (
            "constraints too short",
            Truth::IllPosed,
            Lie::ShortConstraints,
            bowl_with_row(),
        ),
        (
            "Jacobian too wide",
            Truth::IllPosed,
            Lie::WideJacobian,
            bowl_with_row(),
        ),
        (
            "gradients fail from the sixth on",
            Truth::Hopeless,
            Lie::FailFrom(6),
            rosenbrock(),
        ),
        (
            "gradients fail from the third on",
            Truth::Hopeless,
            Lie::FailFrom(3),
            bowl_with_row(),
        ),
    ]
    .into_iter()
    .map(|(name, truth, lie, inner)| Case {
        group: "wrong",
        name: name.to_string(),
        truth,
        nlp: Box::new(Liar {
            inner,
            lie,
            calls: 0,
        }),
    })
    .collect()
}
