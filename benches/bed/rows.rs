//! Programs with rows: designs of the literature, degenerate rows, curved rows, many rows.

use std::f64::consts::PI;

use crate::case::{Case, Truth, case, known};
use crate::problems::dual::Dual;
use crate::problems::hard;
use crate::problems::problem::{INF, Problem};

fn sq(x: Dual) -> Dual {
    x.powi(2)
}

pub fn cases() -> Vec<Case> {
    let mut all = designs();
    all.extend(degenerate());
    all.extend(without_multipliers());
    all.extend(curved());
    all.extend(linear());
    all.extend(shares());
    all
}

/// Designs of Rao (2009), *Engineering Optimization*, Arora (2004), *Introduction to Optimum
/// Design*, Golinski (1970) and Svanberg (1987), with continuous variables.
// Golinski's 0.7854 is as published.
#[allow(clippy::approx_constant)]
fn designs() -> Vec<Case> {
    let loads = [61.0_f64, 37.0, 19.0, 7.0, 1.0];
    let roots: f64 = loads.iter().map(|a| a.powf(0.25)).sum();
    [
        Problem::new(
            "cantilever of five",
            &[5.0; 5],
            0.0624 * roots.powf(4.0 / 3.0),
            |x| 0.0624 * x.iter().copied().sum::<Dual>(),
        )
        .all_within(0.01, 100.0)
        .rows(1, 0, move |x| {
            let bend: Dual = (0..5).map(|i| loads[i] / x[i].powi(3)).sum();
            vec![1.0 - bend]
        }),
        Problem::new(
            "pressure vessel",
            &[1.0, 1.0, 50.0, 100.0],
            5885.3327736,
            |x| {
                0.6224 * x[0] * x[2] * x[3]
                    + 1.7781 * x[1] * sq(x[2])
                    + 3.1661 * sq(x[0]) * x[3]
                    + 19.84 * sq(x[0]) * x[2]
            },
        )
        .bounds(
            &[0.0625, 0.0625, 10.0, 10.0],
            &[6.1875, 6.1875, 200.0, 200.0],
        )
        .rows(3, 0, |x| {
            let volume = PI * sq(x[2]) * x[3] + 4.0 * PI / 3.0 * x[2].powi(3);
            vec![
                x[0] - 0.0193 * x[2],
                x[1] - 0.00954 * x[2],
                volume - 1_296_000.0,
            ]
        }),
        Problem::new("spring", &[0.1, 0.5, 10.0], 0.012665232788, |x| {
            (x[2] + 2.0) * x[1] * sq(x[0])
        })
        .bounds(&[0.05, 0.25, 2.0], &[2.0, 1.3, 15.0])
        .rows(4, 0, |x| {
            let (d, w, n) = (x[0], x[1], x[2]);
            let shear = (4.0 * sq(w) - d * w) / (12566.0 * (w * d.powi(3) - d.powi(4)));
            vec![
                w.powi(3) * n / (71785.0 * d.powi(4)) - 1.0,
                1.0 - shear - 1.0 / (5108.0 * sq(d)),
                140.45 * d / (sq(w) * n) - 1.0,
                1.5 - w - d,
            ]
        }),
        Problem::new("three bars", &[0.5, 0.5], 263.89584338, |x| {
            100.0 * (8.0_f64.sqrt() * x[0] + x[1])
        })
        .all_within(1e-3, 1.0)
        .rows(3, 0, |x| {
            let r = 2.0_f64.sqrt();
            let below = r * sq(x[0]) + 2.0 * x[0] * x[1];
            vec![
                2.0 - 2.0 * (r * x[0] + x[1]) / below,
                2.0 - 2.0 * x[1] / below,
                2.0 - 2.0 / (x[0] + r * x[1]),
            ]
        }),
        Problem::new(
            "speed reducer",
            &[3.2, 0.75, 20.0, 8.0, 8.0, 3.5, 5.2],
            2994.4710662,
            |x| {
                let body = 3.3333 * sq(x[2]) + 14.9334 * x[2] - 43.0934;
                let shafts = sq(x[5]) + sq(x[6]);
                0.7854 * x[0] * sq(x[1]) * body - 1.508 * x[0] * shafts
                    + 7.4777 * (x[5].powi(3) + x[6].powi(3))
                    + 0.7854 * (x[3] * sq(x[5]) + x[4] * sq(x[6]))
            },
        )
        .bounds(
            &[2.6, 0.7, 17.0, 7.3, 7.3, 2.9, 5.0],
            &[3.6, 0.8, 28.0, 8.3, 8.3, 3.9, 5.5],
        )
        .rows(11, 0, |x| {
            let teeth = x[1] * x[2];
            let stress = |l: Dual, d: Dual, c: f64, limit: f64| {
                1.0 - (sq(745.0 * l / teeth) + c).sqrt() / (limit * d.powi(3))
            };
            vec![
                1.0 - 27.0 / (x[0] * sq(x[1]) * x[2]),
                1.0 - 397.5 / (x[0] * sq(teeth)),
                1.0 - 1.93 * x[3].powi(3) / (teeth * x[5].powi(4)),
                1.0 - 1.93 * x[4].powi(3) / (teeth * x[6].powi(4)),
                stress(x[3], x[5], 16.9e6, 110.0),
                stress(x[4], x[6], 157.5e6, 85.0),
                1.0 - teeth / 40.0,
                1.0 - 5.0 * x[1] / x[0],
                1.0 - x[0] / (12.0 * x[1]),
                1.0 - (1.5 * x[5] + 1.9) / x[3],
                1.0 - (1.1 * x[6] + 1.9) / x[4],
            ]
        }),
        Problem::new("largest box", &[2.0, 1.0, 0.5], -1.0, |x| {
            -(x[0] * x[1] * x[2])
        })
        .all_within(0.0, INF)
        .rows(1, 0, |x| {
            vec![6.0 - 2.0 * (x[0] * x[1] + x[1] * x[2] + x[2] * x[0])]
        }),
        Problem::new("posynomial", &[0.5, 1.5, 0.2], 1.0, |x| {
            1.0 / (x[0] * x[1] * x[2])
        })
        .all_within(1e-6, INF)
        .rows(1, 0, |x| vec![3.0 - x[0] - x[1] - x[2]]),
        Problem::new(
            "three points in a square",
            &[0.0, 0.1, 0.9, 0.2, 0.3, 0.9, 0.1],
            -(6.0_f64.sqrt() - 2.0_f64.sqrt()),
            |x| -x[6],
        )
        .all_within(0.0, 1.0)
        .bounds(&[0.0; 7], &[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0])
        .rows(3, 0, |x| {
            let apart = |i: usize, j: usize| {
                sq(x[2 * i] - x[2 * j]) + sq(x[2 * i + 1] - x[2 * j + 1]) - sq(x[6])
            };
            vec![apart(0, 1), apart(1, 2), apart(2, 0)]
        }),
        Problem::new(
            "four charges",
            &[
                1.0, 0.1, 0.0, 0.2, 1.0, 0.0, 0.0, 0.1, 1.0, -0.5, -0.5, -0.6,
            ],
            6.0 / (8.0_f64 / 3.0).sqrt(),
            |x| {
                let pair = |i: usize, j: usize| {
                    let d: Dual = (0..3).map(|k| sq(x[3 * i + k] - x[3 * j + k])).sum();
                    1.0 / d.sqrt()
                };
                pair(0, 1) + pair(0, 2) + pair(0, 3) + pair(1, 2) + pair(1, 3) + pair(2, 3)
            },
        )
        .rows(0, 4, |x| {
            let ball = |i: usize| sq(x[3 * i]) + sq(x[3 * i + 1]) + sq(x[3 * i + 2]) - 1.0;
            (0..4).map(ball).collect()
        }),
    ]
    .into_iter()
    .map(|p| case("design", p))
    .collect()
}

fn degenerate() -> Vec<Case> {
    [
        hard::maratos(),
        hard::cart_pole(),
        hard::complementarity(),
        hard::rank_deficient(),
        hard::redundant(),
        hard::scaled_row(),
        Problem::new("vertex of five rows", &[0.2, 0.1], -2.0, |x| -x[0] - x[1]).rows(5, 0, |x| {
            vec![
                2.0 - x[0] - x[1],
                3.0 - x[0] - 2.0 * x[1],
                3.0 - 2.0 * x[0] - x[1],
                1.0 - x[0],
                1.0 - x[1],
            ]
        }),
        Problem::new("complementary pair", &[0.4, 0.9], 0.0, |x| {
            sq(x[0] - 1.0) + sq(x[1])
        })
        .all_within(0.0, INF)
        .rows(0, 1, |x| vec![x[0] * x[1]]),
        Problem::new("weakly active row", &[-1.0, 0.0], 0.0, |x| {
            sq(x[0] - 1.0) + sq(x[1] - 2.0)
        })
        .rows(1, 0, |x| vec![1.0 - x[0]]),
        Problem::new("two tangent discs", &[3.0, 1.0], 0.0, |x| sq(x[1])).rows(2, 0, |x| {
            vec![1.0 - sq(x[0]) - sq(x[1]), 9.0 - sq(x[0] - 1.0) - sq(x[1])]
        }),
        Problem::new("squared row", &[2.0, 2.0], 0.5, |x| {
            0.5 * (sq(x[0]) + sq(x[1] - 1.0)) + 0.0
        })
        .rows(1, 0, |x| vec![x[0] - 1.0]),
        Problem::new("small row", &[2.0, -1.0], -2.0, |x| x[0] + x[1])
            .rows(0, 1, |x| vec![1e-8 * (sq(x[0]) + sq(x[1]) - 2.0)]),
        Problem::new("feasible point alone", &[3.0, 1.0], 0.0, |x| 0.0 * x[0])
            .rows(0, 2, |x| vec![sq(x[0]) + sq(x[1]) - 5.0, x[0] - 2.0 * x[1]]),
    ]
    .into_iter()
    .map(|p| case("rows", p))
    .collect()
}

fn without_multipliers() -> Vec<Case> {
    [
        Problem::new("square of a row", &[1.0], 0.0, |x| x[0]).rows(0, 1, |x| vec![sq(x[0])]),
        Problem::new("cusp", &[2.0, 1.0], 0.0, |x| x[0])
            .rows(2, 0, |x| vec![x[0].powi(3) - x[1], x[1]]),
        Problem::new("two discs that touch", &[1.0, 1.0], 0.0, |x| x[1]).rows(2, 0, |x| {
            vec![
                1.0 - sq(x[0] - 1.0) - sq(x[1]),
                1.0 - sq(x[0] + 1.0) - sq(x[1]),
            ]
        }),
    ]
    .into_iter()
    .map(|p| {
        let best = p.best;
        known("no multipliers", Truth::WithoutMultipliers(best), p)
    })
    .collect()
}

fn curved() -> Vec<Case> {
    [
        Problem::new("ellipsoid", &[0.5, 0.1, 0.1], -7.0 / 6.0, |x| {
            -(x[0] + x[1] + x[2])
        })
        .rows(0, 1, |x| {
            vec![sq(x[0]) + 4.0 * sq(x[1]) + 9.0 * sq(x[2]) - 1.0]
        }),
        Problem::new("least eigenvalue", &[0.35; 8], 1.0, |x| {
            (0..8).map(|i| (i as f64 + 1.0) * sq(x[i])).sum()
        })
        .rows(0, 1, |x| vec![x.iter().map(|v| sq(*v)).sum::<Dual>() - 1.0]),
        Problem::new("helix", &[1.0, 0.0, 0.0], -10.0, |x| -x[2])
            .bounds(&[-INF; 3], &[INF, INF, 10.0])
            .rows(0, 2, |x| vec![x[0] - x[2].cos(), x[1] - x[2].sin()]),
        Problem::new("wave", &[-5.0, 0.0], 0.0, |x| 1e-2 * sq(x[0] - 5.0))
            .rows(0, 1, |x| vec![x[1] - 10.0 * x[0].sin()]),
        Problem::new("circle from its centre", &[0.0, 0.0], -1.0, |x| x[0])
            .rows(0, 1, |x| vec![sq(x[0]) + sq(x[1]) - 1.0]),
        Problem::new("saddle of a row", &[1.0, 0.0], 1.0, |x| sq(x[0]) + sq(x[1])).rows(
            1,
            0,
            |x| vec![sq(x[1]) - sq(x[0]) - 1.0],
        ),
        Problem::new("large circle", &[2e4, 1e3], -1e4, |x| x[0])
            .rows(0, 1, |x| vec![sq(x[0]) + sq(x[1]) - 1e8]),
        Problem::new("root of Rosenbrock", &[-1.2, 1.0], 0.0, |x| 0.0 * x[0])
            .rows(0, 2, |x| vec![10.0 * (x[1] - sq(x[0])), 1.0 - x[0]]),
        Problem::new("valley on a curve", &[-1.2, 1.0, 0.0], 0.0, |x| {
            100.0 * sq(x[1] - sq(x[0])) + sq(1.0 - x[0])
        })
        .rows(0, 1, |x| vec![x[2] - x[0] * x[1]]),
        Problem::new("ring", &[3.0, 0.5], -2.0, |x| x[0]).rows(2, 0, |x| {
            vec![4.0 - sq(x[0]) - sq(x[1]), sq(x[0]) + sq(x[1]) - 1.0]
        }),
        Problem::new("around a hole", &[2.0, 0.01], 0.0, |x| {
            sq(x[0] + 2.0) + sq(x[1])
        })
        .rows(1, 0, |x| vec![sq(x[0]) + sq(x[1]) - 1.0]),
        Problem::new(
            "chain of parabolas",
            &[-1.0, 1.0, 1.0, 1.0, 1.0],
            0.0,
            |x| sq(x[0] - 1.0),
        )
        .rows(0, 4, |x| {
            (1..5).map(|i| x[i] - 2.0 * sq(x[i - 1]) + 1.0).collect()
        }),
    ]
    .into_iter()
    .map(|p| case("curved", p))
    .collect()
}

fn linear() -> Vec<Case> {
    let directions = |j: usize| 2.0 * PI * j as f64 / 200.0;
    [
        Problem::new("Beale's cycle", &[1.0; 4], -1.25, |x| {
            -0.75 * x[0] + 20.0 * x[1] - 0.5 * x[2] + 6.0 * x[3]
        })
        .all_within(0.0, INF)
        .rows(3, 0, |x| {
            vec![
                -0.25 * x[0] + 8.0 * x[1] + x[2] - 9.0 * x[3],
                -0.5 * x[0] + 12.0 * x[1] + 0.5 * x[2] - 3.0 * x[3],
                1.0 - x[2],
            ]
        }),
        Problem::new("Klee-Minty 3", &[1.0; 3], -1e4, |x| {
            -(100.0 * x[0] + 10.0 * x[1] + x[2])
        })
        .all_within(0.0, INF)
        .rows(3, 0, |x| {
            vec![
                1.0 - x[0],
                100.0 - 20.0 * x[0] - x[1],
                1e4 - 200.0 * x[0] - 20.0 * x[1] - x[2],
            ]
        }),
        Problem::new("polygon of 200 sides", &[0.1, 0.2], -1.0, |x| -x[0]).rows(200, 0, move |x| {
            (0..200)
                .map(|j| 1.0 - directions(j).cos() * x[0] - directions(j).sin() * x[1])
                .collect()
        }),
        Problem::new("fit of a cubic", &[0.0, 0.0, 0.0, 1.0], 0.25, |x| x[3]).rows(202, 0, |x| {
            (0..202)
                .map(|k| {
                    let t = (k / 2) as f64 / 50.0 - 1.0;
                    let error = x[0] + x[1] * t + x[2] * (t * t) - t * t * t;
                    if k % 2 == 0 {
                        x[3] - error
                    } else {
                        x[3] + error
                    }
                })
                .collect()
        }),
    ]
    .into_iter()
    .map(|p| case("linear", p))
    .collect()
}

/// Many variables that share one sum.
fn shares() -> Vec<Case> {
    // The projection of (1/20, …, 1) on the simplex keeps the k largest entries above t.
    let p = |i: usize| (i as f64 + 1.0) / 20.0;
    let (mut sum, mut t) = (0.0, 0.0);
    for k in 1..=20 {
        sum += p(20 - k);
        let trial = (sum - 1.0) / k as f64;
        if p(20 - k) > trial {
            t = trial;
        }
    }
    let projection: f64 = (0..20)
        .map(|i| 0.5 * (p(i) - t).max(0.0).powi(2) - (p(i) - t).max(0.0) * p(i))
        .sum();
    let weight = |i: usize| 1.0 + 9.0 * (i as f64 * 0.37).sin().powi(2);
    // The optimal areas are λ √a between their bounds; their sum fixes λ.
    let area = move |i: usize, lambda: f64| (lambda * weight(i).sqrt()).clamp(0.01, 1.0);
    let (mut low, mut high) = (0.0_f64, 10.0_f64);
    for _ in 0..200 {
        let mid = 0.5 * (low + high);
        let total: f64 = (0..300).map(|i| area(i, mid)).sum();
        if total > 150.0 { high = mid } else { low = mid }
    }
    let compliance: f64 = (0..300).map(|i| weight(i) / area(i, low)).sum();
    [
        Problem::new("simplex 20", &[0.5; 20], projection, move |x| {
            (0..20).map(|i| 0.5 * sq(x[i]) - p(i) * x[i]).sum()
        })
        .all_within(0.0, INF)
        .rows(0, 1, |x| vec![x.iter().copied().sum::<Dual>() - 1.0]),
        Problem::new("entropy 10", &[0.5; 10], -(10.0_f64.ln()), |x| {
            x.iter().map(|v| *v * v.ln()).sum()
        })
        .all_within(0.0, INF)
        .rows(0, 1, |x| vec![x.iter().copied().sum::<Dual>() - 1.0]),
        Problem::new("roots on a simplex", &[0.01; 5], -(5.0_f64.sqrt()), |x| {
            -(x.iter().map(|v| v.sqrt()).sum::<Dual>())
        })
        .all_within(0.0, INF)
        .rows(1, 0, |x| vec![1.0 - x.iter().copied().sum::<Dual>()]),
        Problem::new("sizes with two idle", &[1.0; 5], 36.0 + 2e-6, |x| {
            x.iter().copied().sum()
        })
        .all_within(1e-6, 1e3)
        .rows(1, 0, |x| vec![1.0 - 1.0 / x[0] - 4.0 / x[2] - 9.0 / x[4]]),
        Problem::new("areas 300", &[0.5; 300], compliance, move |x| {
            (0..300).map(|i| weight(i) / x[i]).sum()
        })
        .all_within(0.01, 1.0)
        .rows(1, 0, |x| vec![150.0 - x.iter().copied().sum::<Dual>()]),
    ]
    .into_iter()
    .map(|p| case("shares", p))
    .collect()
}
