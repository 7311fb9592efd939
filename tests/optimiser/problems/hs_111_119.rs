//! Problems 111 to 119 of Hock & Schittkowski (1981).

use super::dual::Dual;
use super::hs_061_086::{COLVILLE_A, COLVILLE_B, COLVILLE_C, COLVILLE_D, COLVILLE_E};
use super::problem::{INF, Problem};

pub fn problems() -> Vec<Problem> {
    let mut all = ten_variables();
    all.extend(more_variables());
    all
}

/// Free energies of problems 111 and 112.
const ENERGY: [f64; 10] = [
    -6.089, -17.164, -34.054, -5.914, -24.721, -14.986, -24.100, -10.708, -26.662, -22.179,
];

/// Balance of the elements of problems 111 and 112.
fn balance(x: &[Dual]) -> Vec<Dual> {
    vec![
        x[0] + 2.0 * x[1] + 2.0 * x[2] + x[5] + x[9] - 2.0,
        x[3] + 2.0 * x[4] + x[5] + x[6] - 1.0,
        x[2] + x[6] + x[7] + 2.0 * x[8] + x[9] - 1.0,
    ]
}

fn ten_variables() -> Vec<Problem> {
    let exponentials = |x: &[Dual]| x.iter().map(|v| v.exp()).collect::<Vec<_>>();
    vec![
        Problem::new("HS111", &[-2.3; 10], -47.76109026, move |x| {
            let e = exponentials(x);
            let sum = e.iter().copied().sum::<Dual>().ln();
            (0..10).map(|j| e[j] * (ENERGY[j] + x[j] - sum)).sum()
        })
        .all_within(-100.0, 100.0)
        .rows(0, 3, move |x| balance(&exponentials(x))),
        Problem::new("HS112", &[0.1; 10], -47.76109026, |x| {
            let sum: Dual = x.iter().copied().sum();
            (0..10)
                .map(|j| x[j] * (ENERGY[j] + (x[j] / sum).ln()))
                .sum()
        })
        .all_within(1e-6, INF)
        .rows(0, 3, balance),
        Problem::new(
            "HS113",
            &[2.0, 3.0, 5.0, 5.0, 1.0, 2.0, 7.0, 3.0, 6.0, 10.0],
            24.30620907,
            |x| {
                x[0].powi(2) + x[1].powi(2) + x[0] * x[1] - 14.0 * x[0] - 16.0 * x[1]
                    + (x[2] - 10.0).powi(2)
                    + 4.0 * (x[3] - 5.0).powi(2)
                    + (x[4] - 3.0).powi(2)
                    + 2.0 * (x[5] - 1.0).powi(2)
                    + 5.0 * x[6].powi(2)
                    + 7.0 * (x[7] - 11.0).powi(2)
                    + 2.0 * (x[8] - 10.0).powi(2)
                    + (x[9] - 7.0).powi(2)
                    + 45.0
            },
        )
        .rows(8, 0, |x| {
            vec![
                105.0 - 4.0 * x[0] - 5.0 * x[1] + 3.0 * x[6] - 9.0 * x[7],
                8.0 * x[1] - 10.0 * x[0] + 17.0 * x[6] - 2.0 * x[7],
                8.0 * x[0] - 2.0 * x[1] - 5.0 * x[8] + 2.0 * x[9] + 12.0,
                120.0
                    - 3.0 * (x[0] - 2.0).powi(2)
                    - 4.0 * (x[1] - 3.0).powi(2)
                    - 2.0 * x[2].powi(2)
                    + 7.0 * x[3],
                40.0 - 5.0 * x[0].powi(2) - 8.0 * x[1] - (x[2] - 6.0).powi(2) + 2.0 * x[3],
                30.0 - 0.5 * (x[0] - 8.0).powi(2) - 2.0 * (x[1] - 4.0).powi(2) - 3.0 * x[4].powi(2)
                    + x[5],
                2.0 * x[0] * x[1] - x[0].powi(2) - 2.0 * (x[1] - 2.0).powi(2) - 14.0 * x[4]
                    + 6.0 * x[5],
                6.0 * x[1] * -1.0 + 3.0 * x[0] - 12.0 * (x[8] - 8.0).powi(2) + 7.0 * x[9],
            ]
        }),
        Problem::new(
            "HS114",
            &[
                1745.0, 12000.0, 110.0, 3048.0, 1974.0, 89.2, 92.8, 8.0, 3.6, 145.0,
            ],
            -1768.80696,
            |x| 5.04 * x[0] + 0.035 * x[1] + 10.0 * x[2] + 3.36 * x[4] - 0.063 * x[3] * x[6],
        )
        .bounds(
            &[1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 85.0, 90.0, 3.0, 1.2, 145.0],
            &[
                2000.0, 16000.0, 120.0, 5000.0, 2000.0, 93.0, 95.0, 12.0, 4.0, 162.0,
            ],
        )
        .rows(8, 3, alkylation),
    ]
}

/// Rows of problem 114.
fn alkylation(x: &[Dual]) -> Vec<Dual> {
    let (a, b) = (0.99, 0.9);
    let g1 = 35.82 - 0.222 * x[9] - b * x[8];
    let g2 = 3.0 * x[6] - a * x[9] - 133.0;
    let g5 = 1.12 * x[0] + 0.13167 * x[0] * x[7] - 0.00667 * x[0] * x[7].powi(2) - a * x[3];
    let g6 = 57.425 + 1.098 * x[7] - 0.038 * x[7].powi(2) + 0.325 * x[5] - a * x[6];
    vec![
        g1,
        g2,
        x[8] * (1.0 / b - b) - g1,
        (1.0 / a - a) * x[9] - g2,
        g5,
        g6,
        (1.0 / a - a) * x[3] - g5,
        (1.0 / a - a) * x[6] - g6,
        1.22 * x[3] - x[0] - x[4],
        98000.0 * x[2] / (x[3] * x[8] + 1000.0 * x[2]) - x[5],
        (x[1] + x[4]) / x[0] - x[7],
    ]
}

fn more_variables() -> Vec<Problem> {
    let mut dual_start = [0.001; 15];
    dual_start[6] = 60.0;
    vec![
        membranes(),
        Problem::new("HS117", &dual_start, 32.34867897, |x| {
            let y = &x[10..15];
            let linear: Dual = (0..10).map(|k| -COLVILLE_B[k] * x[k]).sum();
            let pairs = (0..25).map(|p| (p / 5, p % 5));
            let quadratic: Dual = pairs.map(|(k, j)| COLVILLE_C[k][j] * y[k] * y[j]).sum();
            let cubic: Dual = (0..5).map(|j| 2.0 * COLVILLE_D[j] * y[j].powi(3)).sum();
            linear + quadratic + cubic
        })
        .all_within(0.0, INF)
        .rows(5, 0, |x| {
            let y = &x[10..15];
            (0..5)
                .map(|j| {
                    let force: Dual = (0..5).map(|k| 2.0 * COLVILLE_C[k][j] * y[k]).sum();
                    let rows: Dual = (0..10).map(|k| COLVILLE_A[k][j] * x[k]).sum();
                    force + 3.0 * COLVILLE_D[j] * y[j].powi(2) + COLVILLE_E[j] - rows
                })
                .collect()
        }),
        production(),
        Problem::new("HS119", &[10.0; 16], 244.899698, |x| {
            let p: Vec<Dual> = x.iter().map(|v| v.powi(2) + *v + 1.0).collect();
            PAIRS
                .iter()
                .enumerate()
                .map(|(i, row)| row.iter().map(|&j| p[i] * p[j - 1]).sum::<Dual>())
                .sum()
        })
        .all_within(0.0, 5.0)
        .rows(0, 8, |x| {
            let row = |i: usize| (0..16).map(|j| COLUMNS[j][i] * x[j]).sum::<Dual>();
            (0..8).map(|i| row(i) - TARGET[i]).collect()
        }),
    ]
}

/// Columns of the non-zero entries of each row of the matrix of problem 119.
const PAIRS: [&[usize]; 16] = [
    &[1, 4, 7, 8, 16],
    &[2, 3, 7, 10],
    &[3, 7, 9, 10, 14],
    &[4, 7, 11, 15],
    &[5, 6, 10, 12, 16],
    &[6, 8, 15],
    &[7, 11, 13],
    &[8, 10, 15],
    &[9, 12, 16],
    &[10, 14],
    &[11, 13],
    &[12, 14],
    &[13, 14],
    &[14],
    &[15],
    &[16],
];
const TARGET: [f64; 8] = [2.5, 1.1, -3.1, -3.5, 1.3, 2.1, 2.3, -1.5];
/// Columns of the constraint matrix of problem 119.
const COLUMNS: [[f64; 8]; 16] = [
    [0.22, -1.46, 1.29, -1.10, 0.0, 0.0, 1.12, 0.0],
    [0.20, 0.0, -0.89, -1.06, 0.0, -1.72, 0.0, 0.45],
    [0.19, -1.30, 0.0, 0.95, 0.0, -0.33, 0.0, 0.26],
    [0.25, 1.82, 0.0, -0.54, -1.43, 0.0, 0.31, -1.10],
    [0.15, -1.15, -1.16, 0.0, 1.51, 1.62, 0.0, 0.58],
    [0.11, 0.0, -0.96, -1.78, 0.59, 1.24, 0.0, 0.0],
    [0.12, 0.80, 0.0, -0.41, -0.33, 0.21, 1.12, -1.03],
    [0.13, 0.0, -0.49, 0.0, -0.43, -0.26, 0.0, 0.10],
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.36, 0.0],
    [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];

/// Problem 116: three-stage membrane separation.
fn membranes() -> Problem {
    let start = [
        0.5, 0.8, 0.9, 0.1, 0.14, 0.5, 489.0, 80.0, 650.0, 450.0, 150.0, 150.0, 150.0,
    ];
    let lower = [
        0.1, 0.1, 0.1, 1e-4, 0.1, 0.1, 0.1, 0.1, 500.0, 0.1, 1.0, 1e-4, 1e-4,
    ];
    let upper = [
        1.0, 1.0, 1.0, 0.1, 0.9, 0.9, 1000.0, 1000.0, 1000.0, 500.0, 150.0, 150.0, 150.0,
    ];
    let mut above = [INF; 14];
    above[13] = 250.0;
    let mut below = [0.0; 14];
    below[13] = 50.0;
    Problem::new("HS116", &start, 97.58750956, |x| x[10] + x[11] + x[12])
        .bounds(&lower, &upper)
        .rows(14, 0, |x| {
            let stage = |a: Dual, b: Dual| a - 0.03475 * b - 0.975 * a * b + 0.00975 * b.powi(2);
            let pump = |a: Dual, b: Dual, c: Dual| a - 1.262626 * b + 1.231059 * c * b;
            vec![
                x[2] - x[1],
                x[1] - x[0],
                1.0 - 0.002 * x[6] + 0.002 * x[7],
                pump(x[12], x[9], x[2]),
                stage(x[4], x[1]),
                stage(x[5], x[2]),
                x[4] * x[6] - x[0] * x[7] - x[3] * x[6] + x[3] * x[7],
                1.0 - 0.002 * (x[1] * x[8] + x[4] * x[7] - x[0] * x[7] - x[5] * x[8]) - x[4] - x[5],
                x[1] * x[8] - x[2] * x[9] - x[5] * x[8] - 500.0 * x[1] + 500.0 * x[5] + x[1] * x[9],
                x[1] - 0.9 - 0.002 * (x[1] * x[9] - x[2] * x[9]),
                stage(x[3], x[0]),
                pump(x[10], x[7], x[0]),
                pump(x[11], x[8], x[1]),
                x[10] + x[11] + x[12],
            ]
        })
        .row_bounds(&below, &above)
}

/// Problem 118: production plan over five periods.
fn production() -> Problem {
    let start = [
        20.0, 55.0, 15.0, 20.0, 60.0, 20.0, 20.0, 60.0, 20.0, 20.0, 60.0, 20.0, 20.0, 60.0, 20.0,
    ];
    let mut lower = [0.0; 15];
    lower[..3].copy_from_slice(&[8.0, 43.0, 3.0]);
    let mut upper = [0.0; 15];
    upper[..3].copy_from_slice(&[21.0, 57.0, 16.0]);
    for k in 1..5 {
        upper[3 * k..3 * k + 3].copy_from_slice(&[90.0, 120.0, 60.0]);
    }
    let demand = [60.0, 50.0, 70.0, 85.0, 100.0];
    let mut above = vec![INF; 17];
    for k in 0..4 {
        above[3 * k..3 * k + 3].copy_from_slice(&[13.0, 14.0, 13.0]);
    }
    Problem::new("HS118", &start, 664.8204500, |x| {
        let cost = [(2.3, 0.0001), (1.7, 0.0001), (2.2, 0.00015)];
        (0..15)
            .map(|i| cost[i % 3].0 * x[i] + cost[i % 3].1 * x[i].powi(2))
            .sum()
    })
    .bounds(&lower, &upper)
    .rows(17, 0, move |x| {
        let mut rows: Vec<Dual> = (3..15).map(|i| x[i] - x[i - 3] + 7.0).collect();
        rows.extend((0..5).map(|k| x[3 * k] + x[3 * k + 1] + x[3 * k + 2] - demand[k]));
        rows
    })
    .row_bounds(&[0.0; 17], &above)
}
