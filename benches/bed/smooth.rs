//! Valleys, degenerate minima, vanishing objectives and bad scales, without rows. The functions are
//! those of Jamil & Yang (2013), *A literature survey of benchmark functions for global optimization
//! problems*, by their names there, or sums whose minima are seen at once.

use crate::case::{Case, Truth, case, known};
use crate::problems::dual::Dual;
use crate::problems::problem::{INF, Problem};

fn sq(x: Dual) -> Dual {
    x.powi(2)
}

fn rosenbrock(x: &[Dual]) -> Dual {
    100.0 * sq(x[1] - sq(x[0])) + sq(1.0 - x[0])
}

fn chained(n: usize, weight: f64) -> impl Fn(&[Dual]) -> Dual {
    move |x| {
        (1..n)
            .map(|i| weight * sq(x[i] - sq(x[i - 1])) + sq(1.0 - x[i - 1]))
            .sum()
    }
}

pub fn cases() -> Vec<Case> {
    let mut all = valleys();
    all.extend(several_minima());
    all.extend(degenerate());
    all.extend(vanishing());
    all.extend(scales());
    all.extend(towards_bounds());
    all.extend(wide());
    all
}

fn valleys() -> Vec<Case> {
    let start = |n: usize, a: f64, b: f64| -> Vec<f64> {
        (0..n).map(|i| if i % 2 == 0 { a } else { b }).collect()
    };
    [
        Problem::new("Rosenbrock", &[-1.2, 1.0], 0.0, rosenbrock),
        Problem::new("Rosenbrock far", &[-30.0, 40.0], 0.0, rosenbrock),
        Problem::new(
            "Rosenbrock chain 10",
            &start(10, -1.2, 1.0),
            0.0,
            chained(10, 100.0),
        ),
        Problem::new(
            "Rosenbrock chain 40",
            &start(40, 1.2, 1.0),
            0.0,
            chained(40, 100.0),
        ),
        Problem::new("Rosenbrock steep", &[-1.2, 1.0], 0.0, |x| {
            1e4 * sq(x[1] - sq(x[0])) + sq(1.0 - x[0])
        }),
        Problem::new("Rosenbrock pairs 60", &start(60, -1.2, 1.0), 0.0, |x| {
            (0..30).map(|k| rosenbrock(&x[2 * k..2 * k + 2])).sum()
        }),
        Problem::new("Cube", &[-1.2, -1.0], 0.0, |x| {
            100.0 * sq(x[1] - x[0].powi(3)) + sq(1.0 - x[0])
        }),
        Problem::new("Chebyshev valley 4", &[-1.0, 1.0, 1.0, 1.0], 0.0, |x| {
            let links: Dual = (1..4).map(|i| sq(x[i] - 2.0 * sq(x[i - 1]) + 1.0)).sum();
            0.25 * sq(x[0] - 1.0) + links
        }),
        Problem::new("Dixon-Price 10", &[1.5; 10], 0.0, |x| {
            let links: Dual = (1..10)
                .map(|i| (i as f64 + 1.0) * sq(2.0 * sq(x[i]) - x[i - 1]))
                .sum();
            sq(x[0] - 1.0) + links
        }),
        Problem::new("Zakharov 10", &[3.0; 10], 0.0, |x| {
            let linear: Dual = (0..10).map(|i| 0.5 * (i as f64 + 1.0) * x[i]).sum();
            x.iter().map(|v| sq(*v)).sum::<Dual>() + sq(linear) + linear.powi(4)
        }),
        Problem::new("spiral valley", &[5.0, 0.0], 6.558573e-6, |x| {
            let r = (sq(x[0]) + sq(x[1]) + 1e-4).sqrt();
            sq(x[0] - r * r.cos()) + sq(x[1] - r * r.sin()) + 0.01 * sq(r - 0.01)
        }),
        Problem::new("banana in a box", &[1.5, -0.5], 0.0, rosenbrock).all_within(-2.0, 2.0),
    ]
    .into_iter()
    .map(|p| case("valley", p))
    .collect()
}

fn several_minima() -> Vec<Case> {
    vec![
        case(
            "minima",
            Problem::new("Himmelblau", &[0.0, 0.0], 0.0, |x| {
                sq(sq(x[0]) + x[1] - 11.0) + sq(x[0] + sq(x[1]) - 7.0)
            }),
        ),
        case(
            "minima",
            Problem::new("Goldstein-Price", &[0.1, -0.8], 3.0, |x| {
                let (a, b) = (x[0], x[1]);
                let p = 19.0 - 14.0 * a + 3.0 * sq(a) - 14.0 * b + 6.0 * a * b + 3.0 * sq(b);
                let q = 18.0 - 32.0 * a + 12.0 * sq(a) + 48.0 * b - 36.0 * a * b + 27.0 * sq(b);
                (1.0 + sq(a + b + 1.0) * p) * (30.0 + sq(2.0 * a - 3.0 * b) * q)
            }),
        ),
        case(
            "minima",
            Problem::new("six-hump camel", &[0.5, -0.3], -1.031628453, |x| {
                let (a, b) = (sq(x[0]), sq(x[1]));
                (4.0 - 2.1 * a + sq(a) / 3.0) * a + x[0] * x[1] + (4.0 * b - 4.0) * b
            }),
        ),
        known(
            "minima",
            Truth::Stationary,
            Problem::new("three-hump camel", &[2.0, -1.0], 0.0, |x| {
                let a = sq(x[0]);
                2.0 * a - 1.05 * sq(a) + a.powi(3) / 6.0 + x[0] * x[1] + sq(x[1])
            }),
        ),
        case(
            "minima",
            Problem::new(
                "Styblinski-Tang 5",
                &[-1.0; 5],
                -39.16616570377142 * 5.0,
                |x| {
                    x.iter()
                        .map(|v| 0.5 * (v.powi(4) - 16.0 * sq(*v) + 5.0 * *v))
                        .sum()
                },
            ),
        ),
        known(
            "minima",
            Truth::Stationary,
            Problem::new("cosines 6", &[0.4; 6], 0.0, |x| {
                x.iter().map(|v| 0.1 * sq(*v) - (5.0 * *v).cos()).sum()
            }),
        ),
    ]
}

fn degenerate() -> Vec<Case> {
    [
        Problem::new("quartic 10", &[0.0; 10], 0.0, |x| {
            (0..10).map(|i| (x[i] - (i as f64 + 1.0)).powi(4)).sum()
        }),
        Problem::new("Powell singular 20", &[3.0; 20], 0.0, |x| {
            (0..5)
                .map(|k| {
                    let x = &x[4 * k..4 * k + 4];
                    sq(x[0] + 10.0 * x[1])
                        + 5.0 * sq(x[2] - x[3])
                        + (x[1] - 2.0 * x[2]).powi(4)
                        + 10.0 * (x[0] - x[3]).powi(4)
                })
                .sum()
        }),
        Problem::new("sixth powers 5", &[1.0; 5], 0.0, |x| {
            x.iter().map(|v| v.powi(6)).sum()
        }),
        Problem::new("product squared", &[1.0, 2.0], 0.0, |x| sq(x[0] * x[1])),
        Problem::new("Hilbert 10", &[1.0; 10], 0.0, |x| {
            (0..100)
                .map(|k| x[k / 10] * x[k % 10] / ((k / 10 + k % 10) as f64 + 1.0))
                .sum()
        }),
        Problem::new("one direction of five", &[2.0; 5], 0.0, |x| {
            sq(x.iter().copied().sum::<Dual>() - 1.0)
        }),
        Problem::new("even powers", &[1.0, 1.0, 1.0], 0.0, |x| {
            sq(x[0]) + x[1].powi(4) + x[2].powi(8)
        }),
    ]
    .into_iter()
    .map(|p| case("degenerate", p))
    .collect()
}

fn vanishing() -> Vec<Case> {
    [
        Problem::new("small Rosenbrock", &[-1.2, 1.0], 0.0, |x| {
            1e-8 * rosenbrock(x)
        }),
        Problem::new("large Rosenbrock", &[-1.2, 1.0], 0.0, |x| {
            1e8 * rosenbrock(x)
        }),
        Problem::new("bell", &[1.5, 1.5], 0.0, |x| {
            1.0 - (-(0.5 * (sq(x[0]) + sq(x[1])))).exp()
        }),
        Problem::new("exponential tail", &[0.0], 0.0, |x| (-x[0]).exp()),
        Problem::new("steep sum 6", &[50.0; 6], 0.0, |x| {
            (0..6).map(|i| 10.0_f64.powi(i as i32) * x[i].powi(4)).sum()
        }),
        Problem::new("residual of a root", &[3.0, 3.0], 0.0, |x| {
            sq(sq(x[0]) + sq(x[1]) - 2.0) + sq((x[0] - 1.0).exp() + x[1].powi(3) - 2.0)
        }),
        Problem::new("powers from far", &[1e3, -1e3], 0.0, |x| {
            x[0].powi(4) + x[1].powi(4) + sq(x[0] + x[1])
        }),
    ]
    .into_iter()
    .map(|p| case("vanishing", p))
    .collect()
}

fn scales() -> Vec<Case> {
    [
        Problem::new("ill-conditioned 20", &[1.0; 20], 0.0, |x| {
            (0..20)
                .map(|i| 10.0_f64.powf(6.0 * i as f64 / 19.0) * sq(x[i]))
                .sum()
        }),
        Problem::new("units of variables", &[2e6, 3e-3], 0.0, |x| {
            sq(1e-6 * x[0] - 1.0) + sq(1e3 * x[1] - 1.0) + sq(1e-6 * x[0] - 1e3 * x[1])
        }),
        Problem::new("wide and narrow", &[1e9, 1.0], 0.0, |x| {
            sq(1e-9 * x[0] - 3.0) + sq(x[1] - 2.0)
        })
        .bounds(&[0.0, -10.0], &[1e10, 10.0]),
        Problem::new("large constant", &[-1.2, 1.0], 1e10, |x| {
            1e10 + rosenbrock(x)
        }),
        Problem::new("large optimum", &[0.0, 0.0], 0.0, |x| {
            sq(x[0] - 1e5) + sq(x[1] + 1e4) * 1e-2
        }),
        Problem::new("distant valley", &[500.0, 0.0], 0.0, |x| {
            rosenbrock(&[x[0] * 1e-2, x[1] * 1e-3])
        }),
    ]
    .into_iter()
    .map(|p| case("scales", p))
    .collect()
}

fn towards_bounds() -> Vec<Case> {
    [
        Problem::new("squares at zero 10", &[1.0; 10], 0.0, |x| {
            x.iter().map(|v| sq(*v)).sum()
        })
        .all_within(0.0, INF),
        Problem::new("cube at zero", &[1.0], 0.0, |x| x[0].powi(3)).all_within(0.0, INF),
        Problem::new("fourth power at zero", &[1.0, 2.0], 0.0, |x| {
            x[0].powi(4) + x[1].powi(4)
        })
        .all_within(0.0, INF),
        Problem::new("root at zero", &[1.0; 3], 0.0, |x| {
            x.iter().map(|v| v.powf(1.5)).sum()
        })
        .all_within(0.0, INF),
        Problem::new("product of two", &[0.5, 0.7], 0.0, |x| x[0] * x[1]).all_within(0.0, 1.0),
        Problem::new("no force at the bound", &[1.0, 1.0], 0.0, |x| {
            sq(x[0]) + sq(x[1] - 1.0)
        })
        .all_within(0.0, 5.0),
        Problem::new("weak force at the bound", &[0.5, 3.0], 1e-8, |x| {
            1e-8 * x[0] + sq(x[1] - 1.0) + 1e-8
        })
        .all_within(0.0, 10.0),
        Problem::new("reciprocals 5", &[0.5; 5], 5.0, |x| {
            x.iter().map(|v| 1.0 / *v).sum()
        })
        .all_within(0.01, 1.0),
        Problem::new("corner 30", &[0.5; 30], -(465.0), |x| {
            (0..30).map(|i| -(i as f64 + 1.0) * x[i]).sum()
        })
        .all_within(0.0, 1.0),
        Problem::new("sharp corner", &[0.7, 0.7], 0.0, |x| {
            x[0] + 1e4 * x[1] + 1e2 * x[0] * x[1]
        })
        .all_within(0.0, 1.0),
    ]
    .into_iter()
    .map(|p| case("bound", p))
    .collect()
}

fn wide() -> Vec<Case> {
    let target = |i: usize| 1.5 * (0.7 * i as f64).sin();
    let boxed: f64 = (0..300)
        .map(|i| (1.0 + i as f64) * (target(i) - target(i).clamp(-1.0, 1.2)).powi(2))
        .sum();
    [
        Problem::new("Laplace 50", &[0.0; 50], -1.0, |x| {
            let inner: Dual = (1..50).map(|i| sq(x[i] - x[i - 1])).sum();
            0.5 * (inner + sq(x[0]) + sq(x[49])) - x[0] - x[49]
        }),
        Problem::new("Trid 10", &[0.0; 10], -210.0, |x| {
            let links: Dual = (1..10).map(|i| x[i] * x[i - 1]).sum();
            x.iter().map(|v| sq(*v - 1.0)).sum::<Dual>() - links
        })
        .all_within(-100.0, 100.0),
        Problem::new("box 300", &[0.5; 300], boxed, move |x| {
            (0..300)
                .map(|i| (1.0 + i as f64) * sq(x[i] - target(i)))
                .sum()
        })
        .all_within(-1.0, 1.2),
    ]
    .into_iter()
    .map(|p| case("wide", p))
    .collect()
}
