//! Problems 1 to 30 of Hock & Schittkowski (1981), *Test Examples for Nonlinear Programming
//! Codes*, Lecture Notes in Economics and Mathematical Systems 187. Index i is i − 1 here.

use std::f64::consts::PI;

use super::dual::Dual;
use super::problem::{INF, Problem};

fn rosenbrock(x: &[Dual]) -> Dual {
    100.0 * (x[1] - x[0].powi(2)).powi(2) + (1.0 - x[0]).powi(2)
}

pub fn problems() -> Vec<Problem> {
    let mut all = small();
    all.extend(two_variables());
    all.extend(three_variables());
    all
}

fn small() -> Vec<Problem> {
    vec![
        Problem::new("HS1", &[-2.0, 1.0], 0.0, rosenbrock).bounds(&[-INF, -1.5], &[INF, INF]),
        Problem::new("HS2", &[-2.0, 1.0], 0.0504261879, rosenbrock)
            .bounds(&[-INF, 1.5], &[INF, INF]),
        Problem::new("HS3", &[10.0, 1.0], 0.0, |x| {
            x[1] + 1e-5 * (x[1] - x[0]).powi(2)
        })
        .bounds(&[-INF, 0.0], &[INF, INF]),
        Problem::new("HS4", &[1.125, 0.125], 8.0 / 3.0, |x| {
            (x[0] + 1.0).powi(3) / 3.0 + x[1]
        })
        .bounds(&[1.0, 0.0], &[INF, INF]),
        Problem::new(
            "HS5",
            &[0.0, 0.0],
            -(3.0_f64.sqrt()) / 2.0 - PI / 3.0,
            |x| (x[0] + x[1]).sin() + (x[0] - x[1]).powi(2) - 1.5 * x[0] + 2.5 * x[1] + 1.0,
        )
        .bounds(&[-1.5, -3.0], &[4.0, 3.0]),
        Problem::new("HS6", &[-1.2, 1.0], 0.0, |x| (1.0 - x[0]).powi(2))
            .rows(0, 1, |x| vec![10.0 * (x[1] - x[0].powi(2))]),
        Problem::new("HS7", &[2.0, 2.0], -(3.0_f64.sqrt()), |x| {
            (1.0 + x[0].powi(2)).ln() - x[1]
        })
        .rows(0, 1, |x| {
            vec![(1.0 + x[0].powi(2)).powi(2) + x[1].powi(2) - 4.0]
        }),
        Problem::new("HS8", &[2.0, 1.0], -1.0, |x| 0.0 * x[0] - 1.0).rows(0, 2, |x| {
            vec![x[0].powi(2) + x[1].powi(2) - 25.0, x[0] * x[1] - 9.0]
        }),
        Problem::new("HS9", &[0.0, 0.0], -0.5, |x| {
            (PI * x[0] / 12.0).sin() * (PI * x[1] / 16.0).cos()
        })
        .rows(0, 1, |x| vec![4.0 * x[0] - 3.0 * x[1]]),
        Problem::new("HS10", &[-10.0, 10.0], -1.0, |x| x[0] - x[1]).rows(1, 0, |x| {
            vec![-3.0 * x[0].powi(2) + 2.0 * x[0] * x[1] - x[1].powi(2) + 1.0]
        }),
        Problem::new("HS11", &[4.9, 0.1], -8.498464223, |x| {
            (x[0] - 5.0).powi(2) + x[1].powi(2) - 25.0
        })
        .rows(1, 0, |x| vec![x[1] - x[0].powi(2)]),
        Problem::new("HS12", &[0.0, 0.0], -30.0, |x| {
            0.5 * x[0].powi(2) + x[1].powi(2) - x[0] * x[1] - 7.0 * x[0] - 7.0 * x[1]
        })
        .rows(1, 0, |x| vec![25.0 - 4.0 * x[0].powi(2) - x[1].powi(2)]),
    ]
}

fn two_variables() -> Vec<Problem> {
    let root = 3.0_f64.sqrt();
    vec![
        Problem::new("HS13", &[-2.0, -2.0], 1.0, |x| {
            (x[0] - 2.0).powi(2) + x[1].powi(2)
        })
        .all_within(0.0, INF)
        .rows(1, 0, |x| vec![(1.0 - x[0]).powi(3) - x[1]]),
        Problem::new("HS14", &[2.0, 2.0], 9.0 - 2.875 * 7.0_f64.sqrt(), |x| {
            (x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2)
        })
        .rows(1, 1, |x| {
            vec![
                1.0 - 0.25 * x[0].powi(2) - x[1].powi(2),
                x[0] - 2.0 * x[1] + 1.0,
            ]
        }),
        Problem::new("HS15", &[-2.0, 1.0], 306.5, rosenbrock)
            .bounds(&[-INF, -INF], &[0.5, INF])
            .rows(2, 0, |x| vec![x[0] * x[1] - 1.0, x[0] + x[1].powi(2)]),
        Problem::new("HS16", &[-2.0, 1.0], 0.25, rosenbrock)
            .bounds(&[-0.5, -INF], &[0.5, 1.0])
            .rows(2, 0, |x| vec![x[0] + x[1].powi(2), x[0].powi(2) + x[1]]),
        Problem::new("HS17", &[-2.0, 1.0], 1.0, rosenbrock)
            .bounds(&[-0.5, -INF], &[0.5, 1.0])
            .rows(2, 0, |x| vec![x[1].powi(2) - x[0], x[0].powi(2) - x[1]]),
        Problem::new("HS18", &[2.0, 2.0], 5.0, |x| {
            0.01 * x[0].powi(2) + x[1].powi(2)
        })
        .bounds(&[2.0, 0.0], &[50.0, 50.0])
        .rows(2, 0, |x| {
            vec![x[0] * x[1] - 25.0, x[0].powi(2) + x[1].powi(2) - 25.0]
        }),
        Problem::new("HS19", &[20.1, 5.84], -6961.813875580, |x| {
            (x[0] - 10.0).powi(3) + (x[1] - 20.0).powi(3)
        })
        .bounds(&[13.0, 0.0], &[100.0, 100.0])
        .rows(2, 0, |x| {
            vec![
                (x[0] - 5.0).powi(2) + (x[1] - 5.0).powi(2) - 100.0,
                82.81 - (x[1] - 5.0).powi(2) - (x[0] - 6.0).powi(2),
            ]
        }),
        Problem::new("HS20", &[-2.0, 1.0], 81.5 - 25.0 * root, rosenbrock)
            .bounds(&[-0.5, -INF], &[0.5, INF])
            .rows(3, 0, |x| {
                vec![
                    x[0] + x[1].powi(2),
                    x[0].powi(2) + x[1],
                    x[0].powi(2) + x[1].powi(2) - 1.0,
                ]
            }),
        Problem::new("HS21", &[-1.0, -1.0], -99.96, |x| {
            0.01 * x[0].powi(2) + x[1].powi(2) - 100.0
        })
        .bounds(&[2.0, -50.0], &[50.0, 50.0])
        .rows(1, 0, |x| vec![10.0 * x[0] - x[1] - 10.0]),
        Problem::new("HS22", &[2.0, 2.0], 1.0, |x| {
            (x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2)
        })
        .rows(2, 0, |x| vec![2.0 - x[0] - x[1], x[1] - x[0].powi(2)]),
        Problem::new("HS23", &[3.0, 1.0], 2.0, |x| x[0].powi(2) + x[1].powi(2))
            .all_within(-50.0, 50.0)
            .rows(5, 0, |x| {
                let (a, b) = (x[0].powi(2), x[1].powi(2));
                vec![
                    x[0] + x[1] - 1.0,
                    a + b - 1.0,
                    9.0 * a + b - 9.0,
                    a - x[1],
                    b - x[0],
                ]
            }),
        Problem::new("HS24", &[1.0, 0.5], -1.0, move |x| {
            ((x[0] - 3.0).powi(2) - 9.0) * x[1].powi(3) / (27.0 * root)
        })
        .all_within(0.0, INF)
        .rows(3, 0, move |x| {
            let sum = x[0] + root * x[1];
            vec![x[0] / root - x[1], sum, 6.0 - sum]
        }),
    ]
}

fn three_variables() -> Vec<Problem> {
    vec![
        Problem::new("HS25", &[100.0, 12.5, 3.0], 0.0, |x| {
            let term = |i: usize| {
                let share = 0.01 * i as f64;
                let u = 25.0 + (-50.0 * share.ln()).powf(2.0 / 3.0);
                ((-((u - x[1]).pow(x[2])) / x[0]).exp() - share).powi(2)
            };
            (1..100).map(term).sum()
        })
        .bounds(&[0.1, 0.0, 0.0], &[100.0, 25.6, 5.0]),
        Problem::new("HS26", &[-2.6, 2.0, 2.0], 0.0, |x| {
            (x[0] - x[1]).powi(2) + (x[1] - x[2]).powi(4)
        })
        .rows(0, 1, |x| {
            vec![(1.0 + x[1].powi(2)) * x[0] + x[2].powi(4) - 3.0]
        }),
        Problem::new("HS27", &[2.0, 2.0, 2.0], 0.04, |x| {
            0.01 * (x[0] - 1.0).powi(2) + (x[1] - x[0].powi(2)).powi(2)
        })
        .rows(0, 1, |x| vec![x[0] + x[2].powi(2) + 1.0]),
        Problem::new("HS28", &[-4.0, 1.0, 1.0], 0.0, |x| {
            (x[0] + x[1]).powi(2) + (x[1] + x[2]).powi(2)
        })
        .rows(0, 1, |x| vec![x[0] + 2.0 * x[1] + 3.0 * x[2] - 1.0]),
        Problem::new("HS29", &[1.0, 1.0, 1.0], -16.0 * 2.0_f64.sqrt(), |x| {
            -(x[0] * x[1] * x[2])
        })
        .rows(1, 0, |x| {
            vec![48.0 - x[0].powi(2) - 2.0 * x[1].powi(2) - 4.0 * x[2].powi(2)]
        }),
        Problem::new("HS30", &[1.0, 1.0, 1.0], 1.0, |x| {
            x[0].powi(2) + x[1].powi(2) + x[2].powi(2)
        })
        .bounds(&[1.0, -10.0, -10.0], &[10.0, 10.0, 10.0])
        .rows(1, 0, |x| vec![x[0].powi(2) + x[1].powi(2) - 1.0]),
    ]
}
