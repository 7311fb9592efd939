//! Problems 61 to 86 of Hock & Schittkowski (1981).

use super::dual::Dual;
use super::problem::{INF, Problem};

pub fn problems() -> Vec<Problem> {
    let mut all = three_variables();
    all.extend(four_variables());
    all.extend(five_variables());
    all.extend(colville());
    all
}

fn three_variables() -> Vec<Problem> {
    vec![
        Problem::new("HS61", &[0.0; 3], -143.6461422, |x| {
            4.0 * x[0].powi(2) + 2.0 * x[1].powi(2) + 2.0 * x[2].powi(2) - 33.0 * x[0] + 16.0 * x[1]
                - 24.0 * x[2]
        })
        .rows(0, 2, |x| {
            vec![
                3.0 * x[0] - 2.0 * x[1].powi(2) - 7.0,
                4.0 * x[0] - x[2].powi(2) - 11.0,
            ]
        }),
        Problem::new("HS62", &[0.7, 0.2, 0.1], -26272.51448, |x| {
            let (a, b, c) = (x[0] + x[1] + x[2] + 0.03, x[1] + x[2] + 0.03, x[2] + 0.03);
            let (p, q, r) = (
                0.09 * x[0] + x[1] + x[2] + 0.03,
                0.07 * x[1] + x[2] + 0.03,
                0.13 * x[2] + 0.03,
            );
            -32.174 * (255.0 * (a / p).ln() + 280.0 * (b / q).ln() + 290.0 * (c / r).ln())
        })
        .all_within(0.0, 1.0)
        .rows(0, 1, |x| vec![x[0] + x[1] + x[2] - 1.0]),
        Problem::new("HS63", &[2.0; 3], 961.7151721, |x| {
            1000.0 - x[0].powi(2) - 2.0 * x[1].powi(2) - x[2].powi(2) - x[0] * x[1] - x[0] * x[2]
        })
        .all_within(0.0, INF)
        .rows(0, 2, |x| {
            vec![
                8.0 * x[0] + 14.0 * x[1] + 7.0 * x[2] - 56.0,
                x[0].powi(2) + x[1].powi(2) + x[2].powi(2) - 25.0,
            ]
        }),
        Problem::new("HS64", &[1.0; 3], 6299.842428, |x| {
            5.0 * x[0]
                + 50000.0 / x[0]
                + 20.0 * x[1]
                + 72000.0 / x[1]
                + 10.0 * x[2]
                + 144000.0 / x[2]
        })
        .all_within(1e-5, INF)
        .rows(1, 0, |x| {
            vec![1.0 - 4.0 / x[0] - 32.0 / x[1] - 120.0 / x[2]]
        }),
        Problem::new("HS65", &[-5.0, 5.0, 0.0], 0.9535288567, |x| {
            (x[0] - x[1]).powi(2) + (x[0] + x[1] - 10.0).powi(2) / 9.0 + (x[2] - 5.0).powi(2)
        })
        .bounds(&[-4.5, -4.5, -5.0], &[4.5, 4.5, 5.0])
        .rows(1, 0, |x| {
            vec![48.0 - x[0].powi(2) - x[1].powi(2) - x[2].powi(2)]
        }),
        Problem::new("HS66", &[0.0, 1.05, 2.9], 0.5181632741, |x| {
            0.2 * x[2] - 0.8 * x[0]
        })
        .bounds(&[0.0; 3], &[100.0, 100.0, 10.0])
        .rows(2, 0, |x| vec![x[1] - x[0].exp(), x[2] - x[1].exp()]),
    ]
}

fn four_variables() -> Vec<Problem> {
    vec![
        Problem::new("HS71", &[1.0, 5.0, 5.0, 1.0], 17.0140173, |x| {
            x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]
        })
        .all_within(1.0, 5.0)
        .rows(1, 1, |x| {
            let squares: Dual = x.iter().map(|v| v.powi(2)).sum();
            vec![x[0] * x[1] * x[2] * x[3] - 25.0, squares - 40.0]
        }),
        Problem::new("HS72", &[1.0; 4], 727.67937, |x| {
            1.0 + x.iter().copied().sum::<Dual>()
        })
        .bounds(&[0.001; 4], &[4e5, 3e5, 2e5, 1e5])
        .rows(2, 0, |x| {
            let sum = |c: [f64; 4]| -> Dual { (0..4).map(|i| c[i] / x[i]).sum() };
            vec![
                0.0401 - sum([4.0, 2.25, 1.0, 0.25]),
                0.010085 - sum([0.16, 0.36, 0.64, 0.64]),
            ]
        }),
        Problem::new("HS73", &[1.0; 4], 29.89437816, |x| {
            24.55 * x[0] + 26.75 * x[1] + 39.0 * x[2] + 40.5 * x[3]
        })
        .all_within(0.0, INF)
        .rows(2, 1, |x| {
            let variance = 0.28 * x[0].powi(2)
                + 0.19 * x[1].powi(2)
                + 20.5 * x[2].powi(2)
                + 0.62 * x[3].powi(2);
            vec![
                2.3 * x[0] + 5.6 * x[1] + 11.1 * x[2] + 1.3 * x[3] - 5.0,
                12.0 * x[0] + 11.9 * x[1] + 41.8 * x[2] + 52.1 * x[3]
                    - 21.0
                    - 1.645 * variance.sqrt(),
                x[0] + x[1] + x[2] + x[3] - 1.0,
            ]
        }),
        network("HS74", 0.55, 5126.4981),
        network("HS75", 0.48, 5174.4127),
        Problem::new("HS76", &[0.5; 4], -4.681818182, |x| {
            x[0].powi(2) + 0.5 * x[1].powi(2) + x[2].powi(2) + 0.5 * x[3].powi(2) - x[0] * x[2]
                + x[2] * x[3]
                - x[0]
                - 3.0 * x[1]
                + x[2]
                - x[3]
        })
        .all_within(0.0, INF)
        .rows(3, 0, |x| {
            vec![
                5.0 - x[0] - 2.0 * x[1] - x[2] - x[3],
                4.0 - 3.0 * x[0] - x[1] - 2.0 * x[2] + x[3],
                x[1] + 4.0 * x[2] - 1.5,
            ]
        }),
    ]
}

/// Problems 74 and 75, which differ in the largest difference of phase.
fn network(name: &'static str, a: f64, best: f64) -> Problem {
    Problem::new(name, &[0.0; 4], best, |x| {
        3.0 * x[0] + 1e-6 * x[0].powi(3) + 2.0 * x[1] + 2e-6 / 3.0 * x[1].powi(3)
    })
    .bounds(&[0.0, 0.0, -a, -a], &[1200.0, 1200.0, a, a])
    .rows(2, 3, move |x| {
        let wave = |v: Dual| 1000.0 * (v - 0.25).sin();
        vec![
            x[3] - x[2] + a,
            x[2] - x[3] + a,
            wave(-x[2]) + wave(-x[3]) + 894.8 - x[0],
            wave(x[2]) + wave(x[2] - x[3]) + 894.8 - x[1],
            wave(x[3]) + wave(x[3] - x[2]) + 1294.8,
        ]
    })
}

/// Rows that problems 78, 80 and 81 share.
fn powell(x: &[Dual]) -> Vec<Dual> {
    let squares: Dual = x.iter().map(|v| v.powi(2)).sum();
    vec![
        squares - 10.0,
        x[1] * x[2] - 5.0 * x[3] * x[4],
        x[0].powi(3) + x[1].powi(3) + 1.0,
    ]
}

fn product(x: &[Dual]) -> Dual {
    x.iter().copied().product()
}

fn five_variables() -> Vec<Problem> {
    let root = 2.0_f64.sqrt();
    let box_80 = [2.3, 2.3, 3.2, 3.2, 3.2];
    let below = box_80.map(|v| -v);
    vec![
        Problem::new("HS77", &[2.0; 5], 0.24150513, |x| {
            (x[0] - 1.0).powi(2)
                + (x[0] - x[1]).powi(2)
                + (x[2] - 1.0).powi(2)
                + (x[3] - 1.0).powi(4)
                + (x[4] - 1.0).powi(6)
        })
        .rows(0, 2, move |x| {
            vec![
                x[0].powi(2) * x[3] + (x[3] - x[4]).sin() - 2.0 * root,
                x[1] + x[2].powi(4) * x[3].powi(2) - 8.0 - root,
            ]
        }),
        Problem::new("HS78", &[-2.0, 1.5, 2.0, -1.0, -1.0], -2.91970041, product)
            .rows(0, 3, powell),
        Problem::new("HS79", &[2.0; 5], 0.0787768209, |x| {
            (x[0] - 1.0).powi(2)
                + (x[0] - x[1]).powi(2)
                + (x[1] - x[2]).powi(2)
                + (x[2] - x[3]).powi(4)
                + (x[3] - x[4]).powi(4)
        })
        .rows(0, 3, move |x| {
            vec![
                x[0] + x[1].powi(2) + x[2].powi(3) - 2.0 - 3.0 * root,
                x[1] - x[2].powi(2) + x[3] + 2.0 - 2.0 * root,
                x[0] * x[4] - 2.0,
            ]
        }),
        Problem::new("HS80", &[-2.0, 2.0, 2.0, -1.0, -1.0], 0.0539498478, |x| {
            product(x).exp()
        })
        .bounds(&below, &box_80)
        .rows(0, 3, powell),
        Problem::new("HS81", &[-2.0, 2.0, 2.0, -1.0, -1.0], 0.0539498478, |x| {
            product(x).exp() - 0.5 * (x[0].powi(3) + x[1].powi(3) + 1.0).powi(2)
        })
        .bounds(&below, &box_80)
        .rows(0, 3, powell),
        Problem::new("HS83", &[78.0, 33.0, 27.0, 27.0, 27.0], -30665.53867, |x| {
            5.3578547 * x[2].powi(2) + 0.8356891 * x[0] * x[4] + 37.293239 * x[0] - 40792.141
        })
        .bounds(
            &[78.0, 33.0, 27.0, 27.0, 27.0],
            &[102.0, 45.0, 45.0, 45.0, 45.0],
        )
        .rows(3, 0, |x| {
            vec![
                85.334407 + 0.0056858 * x[1] * x[4] + 0.0006262 * x[0] * x[3]
                    - 0.0022053 * x[2] * x[4],
                80.51249
                    + 0.0071317 * x[1] * x[4]
                    + 0.0029955 * x[0] * x[1]
                    + 0.0021813 * x[2].powi(2),
                9.300961
                    + 0.0047026 * x[2] * x[4]
                    + 0.0012547 * x[0] * x[2]
                    + 0.0019085 * x[2] * x[3],
            ]
        })
        .row_bounds(&[0.0, 90.0, 20.0], &[92.0, 110.0, 25.0]),
        Problem::new("HS84", &[2.52, 2.0, 37.5, 9.25, 6.8], -5280335.133, |x| {
            24345.0 - x[0] * weighted(x, &SUGAR[0])
        })
        .bounds(&[0.0, 1.2, 20.0, 9.0, 6.5], &[1000.0, 2.4, 60.0, 9.3, 7.0])
        .rows(3, 0, |x| {
            (1..4).map(|k| x[0] * weighted(x, &SUGAR[k])).collect()
        })
        .row_bounds(&[0.0; 3], &[294000.0, 294000.0, 277200.0]),
    ]
}

/// Coefficients of problem 84: of the objective, then of the rows.
const SUGAR: [[f64; 5]; 4] = [
    [
        -8720288.849,
        150512.5253,
        -156.6950325,
        476470.3222,
        729482.8271,
    ],
    [-145421.402, 2931.1506, -40.427932, 5106.192, 15711.36],
    [-155011.1084, 4360.53352, 12.9492344, 10236.884, 13176.786],
    [-326669.5104, 7390.68412, -27.8986976, 16643.076, 30988.146],
];

fn weighted(x: &[Dual], c: &[f64; 5]) -> Dual {
    (1..5).map(|i| c[i] * x[i]).sum::<Dual>() + c[0]
}

pub const COLVILLE_E: [f64; 5] = [-15.0, -27.0, -36.0, -18.0, -12.0];
pub const COLVILLE_D: [f64; 5] = [4.0, 8.0, 10.0, 6.0, 2.0];
pub const COLVILLE_C: [[f64; 5]; 5] = [
    [30.0, -20.0, -10.0, 32.0, -10.0],
    [-20.0, 39.0, -6.0, -31.0, 32.0],
    [-10.0, -6.0, 10.0, -6.0, -10.0],
    [32.0, -31.0, -6.0, 39.0, -20.0],
    [-10.0, 32.0, -10.0, -20.0, 30.0],
];
pub const COLVILLE_A: [[f64; 5]; 10] = [
    [-16.0, 2.0, 0.0, 1.0, 0.0],
    [0.0, -2.0, 0.0, 0.4, 2.0],
    [-3.5, 0.0, 2.0, 0.0, 0.0],
    [0.0, -2.0, 0.0, -4.0, -1.0],
    [0.0, -9.0, -2.0, 1.0, -2.8],
    [2.0, 0.0, -4.0, 0.0, 0.0],
    [-1.0, -1.0, -1.0, -1.0, -1.0],
    [-1.0, -2.0, -3.0, -2.0, -1.0],
    [1.0, 2.0, 3.0, 4.0, 5.0],
    [1.0, 1.0, 1.0, 1.0, 1.0],
];
pub const COLVILLE_B: [f64; 10] = [-40.0, -2.0, -0.25, -4.0, -4.0, -1.0, -40.0, -60.0, 5.0, 1.0];

fn colville() -> Vec<Problem> {
    vec![
        Problem::new("HS86", &[0.0, 0.0, 0.0, 0.0, 1.0], -32.34867897, |x| {
            (0..5)
                .map(|j| {
                    let row: Dual = (0..5).map(|i| COLVILLE_C[i][j] * x[i]).sum();
                    COLVILLE_E[j] * x[j] + row * x[j] + COLVILLE_D[j] * x[j].powi(3)
                })
                .sum()
        })
        .all_within(0.0, INF)
        .rows(10, 0, |x| {
            let row = |k: usize| (0..5).map(|i| COLVILLE_A[k][i] * x[i]).sum::<Dual>();
            (0..10).map(|k| row(k) - COLVILLE_B[k]).collect()
        }),
    ]
}
