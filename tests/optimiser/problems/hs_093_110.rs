//! Problems 93 to 110 of Hock & Schittkowski (1981).

use super::dual::Dual;
use super::problem::{INF, Problem};

pub fn problems() -> Vec<Problem> {
    let mut all = six_variables();
    all.extend(seven_variables());
    all.extend(more_variables());
    all
}

fn six_variables() -> Vec<Problem> {
    let transformer = Problem::new(
        "HS93",
        &[5.54, 4.4, 12.02, 11.82, 0.702, 0.852],
        135.075961,
        |x| {
            let (p, q) = (
                x[0] * x[3] * (x[0] + x[1] + x[2]),
                x[1] * x[2] * (x[0] + 1.57 * x[1] + x[3]),
            );
            0.0204 * p + 0.0187 * q + 0.0607 * p * x[4].powi(2) + 0.0437 * q * x[5].powi(2)
        },
    )
    .all_within(0.0, INF)
    .rows(2, 0, |x| {
        let (p, q) = (
            x[0] * x[3] * (x[0] + x[1] + x[2]),
            x[1] * x[2] * (x[0] + 1.57 * x[1] + x[3]),
        );
        vec![
            0.001 * x.iter().copied().product::<Dual>() - 2.07,
            1.0 - 0.00062 * p * x[4].powi(2) - 0.00058 * q * x[5].powi(2),
        ]
    });
    vec![
        transformer,
        blend("HS95", [4.97, -1.88, -29.08, -78.02], 0.015619514),
        blend("HS96", [4.97, -1.88, -69.08, -118.02], 0.015619514),
        blend("HS97", [32.97, 25.12, -29.08, -78.02], 3.1358091),
        blend("HS98", [32.97, 25.12, -124.08, -173.02], 3.1358091),
    ]
}

/// Problems 95 to 98, which differ in their right-hand sides.
fn blend(name: &'static str, b: [f64; 4], best: f64) -> Problem {
    Problem::new(name, &[0.0; 6], best, |x| {
        let cost = [4.3, 31.8, 63.3, 15.8, 68.5, 4.7];
        (0..6).map(|i| cost[i] * x[i]).sum()
    })
    .bounds(&[0.0; 6], &[0.31, 0.046, 0.068, 0.042, 0.028, 0.0134])
    .rows(4, 0, move |x| {
        let sum = |c: [f64; 6]| (0..6).map(|i| c[i] * x[i]).sum::<Dual>();
        vec![
            sum([17.1, 38.2, 204.2, 212.3, 623.4, 1495.5])
                - 169.0 * x[0] * x[2]
                - 3580.0 * x[2] * x[4]
                - 3810.0 * x[3] * x[4]
                - 18500.0 * x[3] * x[5]
                - 24300.0 * x[4] * x[5]
                - b[0],
            sum([17.9, 36.8, 113.9, 169.7, 337.8, 1385.2])
                - 139.0 * x[0] * x[2]
                - 2450.0 * x[3] * x[4]
                - 16600.0 * x[3] * x[5]
                - 17200.0 * x[4] * x[5]
                - b[1],
            26000.0 * x[3] * x[4] - 273.0 * x[1] - 70.0 * x[3] - 819.0 * x[4] - b[2],
            sum([159.9, -311.0, 0.0, 587.0, 391.0, 2198.0]) - 14000.0 * x[0] * x[5] - b[3],
        ]
    })
}

/// Range, height and speed of the rocket of problem 99.
fn ascent(x: &[Dual]) -> (Dual, Dual, Dual) {
    let thrust = [50.0, 50.0, 75.0, 75.0, 75.0, 100.0, 100.0];
    let time = [0.0, 25.0, 50.0, 100.0, 150.0, 200.0, 290.0, 380.0];
    let zero = Dual::from(0.0);
    let (mut range, mut height, mut speed) = (zero, zero, zero);
    for i in 0..7 {
        let dt: f64 = time[i + 1] - time[i];
        let lift = thrust[i] * x[i].sin() - 32.0;
        range = range + thrust[i] * dt * x[i].cos();
        height = height + 0.5 * dt * dt * lift + dt * speed;
        speed = speed + dt * lift;
    }
    (range, height, speed)
}

fn seven_variables() -> Vec<Problem> {
    vec![
        Problem::new("HS99", &[0.5; 7], -831079891.5, |x| -(ascent(x).0.powi(2)))
            .all_within(0.0, 1.58)
            .rows(0, 2, |x| {
                let (_, height, speed) = ascent(x);
                vec![height - 1e5, speed - 1e3]
            }),
        Problem::new(
            "HS100",
            &[1.0, 2.0, 0.0, 4.0, 0.0, 1.0, 1.0],
            680.6300573,
            |x| {
                (x[0] - 10.0).powi(2)
                    + 5.0 * (x[1] - 12.0).powi(2)
                    + x[2].powi(4)
                    + 3.0 * (x[3] - 11.0).powi(2)
                    + 10.0 * x[4].powi(6)
                    + 7.0 * x[5].powi(2)
                    + x[6].powi(4)
                    - 4.0 * x[5] * x[6]
                    - 10.0 * x[5]
                    - 8.0 * x[6]
            },
        )
        .rows(4, 0, |x| {
            vec![
                127.0
                    - 2.0 * x[0].powi(2)
                    - 3.0 * x[1].powi(4)
                    - x[2]
                    - 4.0 * x[3].powi(2)
                    - 5.0 * x[4],
                282.0 - 7.0 * x[0] - 3.0 * x[1] - 10.0 * x[2].powi(2) - x[3] + x[4],
                196.0 - 23.0 * x[0] - x[1].powi(2) - 6.0 * x[5].powi(2) + 8.0 * x[6],
                3.0 * x[0] * x[1]
                    - 4.0 * x[0].powi(2)
                    - x[1].powi(2)
                    - 2.0 * x[2].powi(2)
                    - 5.0 * x[5]
                    + 11.0 * x[6],
            ]
        }),
        geometric("HS101", -0.25, 1809.76476),
        geometric("HS102", 0.125, 911.880571),
        geometric("HS103", 0.5, 543.667958),
    ]
}

/// c Π x_i^p_i.
fn monomial(x: &[Dual], c: f64, powers: &[f64]) -> Dual {
    let used = powers.iter().zip(x).filter(|(p, _)| **p != 0.0);
    c * used.map(|(p, x)| x.powf(*p)).product::<Dual>()
}

/// Problems 101 to 103, which differ in one exponent of the objective.
fn geometric(name: &'static str, a: f64, best: f64) -> Problem {
    let third = 1.0 / 3.0;
    let cost = move |x: &[Dual]| {
        monomial(x, 10.0, &[1.0, -1.0, 0.0, 2.0, 0.0, -3.0, a])
            + monomial(x, 15.0, &[-1.0, -2.0, 1.0, 1.0, -1.0, 0.0, -0.5])
            + monomial(x, 20.0, &[-2.0, 1.0, 0.0, -1.0, -2.0, 1.0, 0.0])
            + monomial(x, 25.0, &[2.0, 2.0, -1.0, 0.0, 0.5, -2.0, 1.0])
    };
    Problem::new(name, &[6.0; 7], best, cost)
        .bounds(&[0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.01], &[10.0; 7])
        .rows(5, 0, move |x| {
            vec![
                1.0 - monomial(x, 0.5, &[0.5, 0.0, -1.0, 0.0, 0.0, -2.0, 1.0])
                    - monomial(x, 0.7, &[3.0, 1.0, -2.0, 0.0, 0.0, 1.0, 0.5])
                    - monomial(x, 0.2, &[0.0, -1.0, 1.0, -0.5, 0.0, 2.0 * third, 0.25]),
                1.0 - monomial(x, 1.3, &[-0.5, 1.0, -1.0, 0.0, -1.0, 1.0, 0.0])
                    - monomial(x, 0.8, &[0.0, 0.0, 1.0, -1.0, -1.0, 2.0, 0.0])
                    - monomial(x, 3.1, &[-1.0, 0.5, 0.0, -2.0, -1.0, third, 0.0]),
                1.0 - monomial(x, 2.0, &[1.0, 0.0, -1.5, 0.0, 1.0, -1.0, third])
                    - monomial(x, 0.1, &[0.0, 1.0, -0.5, 0.0, 1.0, -1.0, -0.5])
                    - monomial(x, 1.0, &[-1.0, 1.0, 0.5, 0.0, 1.0, 0.0, 0.0])
                    - monomial(x, 0.65, &[0.0, -2.0, 1.0, 0.0, 1.0, -1.0, 1.0]),
                1.0 - monomial(x, 0.2, &[-2.0, 1.0, 0.0, -1.0, 0.5, 0.0, third])
                    - monomial(x, 0.3, &[0.5, 2.0, 1.0, third, -2.0 * third, 0.0, 0.25])
                    - monomial(x, 0.4, &[-3.0, -2.0, 1.0, 0.0, 1.0, 0.0, 0.75])
                    - monomial(x, 0.5, &[0.0, 0.0, -2.0, 1.0, 0.0, 0.0, 0.5]),
                cost(x),
            ]
        })
        .row_bounds(&[0.0, 0.0, 0.0, 0.0, 100.0], &[INF, INF, INF, INF, 3000.0])
}

fn more_variables() -> Vec<Problem> {
    vec![
        Problem::new(
            "HS104",
            &[6.0, 3.0, 0.4, 0.2, 6.0, 6.0, 1.0, 0.5],
            3.9511634396,
            reactor_cost,
        )
        .all_within(0.1, 10.0)
        .rows(5, 0, |x| {
            vec![
                1.0 - 0.0588 * x[4] * x[6] - 0.1 * x[0],
                1.0 - 0.0588 * x[5] * x[7] - 0.1 * x[0] - 0.1 * x[1],
                reactor_stage(x[2], x[4], x[6]),
                reactor_stage(x[3], x[5], x[7]),
                reactor_cost(x),
            ]
        })
        .row_bounds(&[0.0, 0.0, 0.0, 0.0, 1.0], &[INF, INF, INF, INF, 4.2]),
        Problem::new(
            "HS105",
            &[0.1, 0.2, 100.0, 125.0, 175.0, 11.2, 13.2, 15.8],
            1136.307304,
            mixture,
        )
        .bounds(
            &[0.001, 0.001, 100.0, 130.0, 170.0, 5.0, 5.0, 5.0],
            &[0.499, 0.499, 180.0, 210.0, 240.0, 25.0, 25.0, 25.0],
        )
        .rows(1, 0, |x| vec![1.0 - x[0] - x[1]]),
        Problem::new(
            "HS106",
            &[5000.0, 5000.0, 5000.0, 200.0, 350.0, 150.0, 225.0, 425.0],
            7049.248020,
            |x| x[0] + x[1] + x[2],
        )
        .bounds(
            &[100.0, 1000.0, 1000.0, 10.0, 10.0, 10.0, 10.0, 10.0],
            &[1e4, 1e4, 1e4, 1000.0, 1000.0, 1000.0, 1000.0, 1000.0],
        )
        .rows(6, 0, |x| {
            vec![
                1.0 - 0.0025 * (x[3] + x[5]),
                1.0 - 0.0025 * (x[4] + x[6] - x[3]),
                1.0 - 0.01 * (x[7] - x[4]),
                x[0] * x[5] - 833.33252 * x[3] - 100.0 * x[0] + 83333.333,
                x[1] * x[6] - 1250.0 * x[4] - x[1] * x[3] + 1250.0 * x[3],
                x[2] * x[7] - 1.25e6 - x[2] * x[4] + 2500.0 * x[4],
            ]
        }),
        Problem::new("HS108", &[1.0; 9], -0.8660254038, |x| {
            -0.5 * (x[0] * x[3] - x[1] * x[2] + x[2] * x[8] - x[4] * x[8] + x[4] * x[7]
                - x[5] * x[6])
        })
        .bounds(
            &[-INF, -INF, -INF, -INF, -INF, -INF, -INF, -INF, 0.0],
            &[INF; 9],
        )
        .rows(13, 0, |x| {
            let unit = |a: Dual, b: Dual| 1.0 - a.powi(2) - b.powi(2);
            vec![
                unit(x[2], x[3]),
                1.0 - x[8].powi(2),
                unit(x[4], x[5]),
                unit(x[0], x[1] - x[8]),
                unit(x[0] - x[4], x[1] - x[5]),
                unit(x[0] - x[6], x[1] - x[7]),
                unit(x[2] - x[4], x[3] - x[5]),
                unit(x[2] - x[6], x[3] - x[7]),
                unit(x[6], x[7] - x[8]),
                x[0] * x[3] - x[1] * x[2],
                x[2] * x[8],
                -(x[4] * x[8]),
                x[4] * x[7] - x[5] * x[6],
            ]
        }),
        Problem::new("HS110", &[9.0; 10], -45.77846971, |x| {
            let squares: Dual = x
                .iter()
                .map(|v| (*v - 2.0).ln().powi(2) + (10.0 - *v).ln().powi(2))
                .sum();
            squares - x.iter().copied().product::<Dual>().powf(0.2)
        })
        .all_within(2.001, 9.999),
    ]
}

fn reactor_cost(x: &[Dual]) -> Dual {
    0.4 * (x[0] / x[6]).powf(0.67) + 0.4 * (x[1] / x[7]).powf(0.67) + 10.0 - x[0] - x[1]
}

fn reactor_stage(a: Dual, b: Dual, c: Dual) -> Dual {
    1.0 - 4.0 * a / b - 2.0 / (a.powf(0.71) * b) - 0.0588 * c / a.powf(1.3)
}

/// Values and how often they occur, of problem 105.
const SAMPLE: [(f64, f64); 30] = [
    (95.0, 1.0),
    (105.0, 1.0),
    (110.0, 4.0),
    (115.0, 4.0),
    (120.0, 15.0),
    (125.0, 15.0),
    (130.0, 15.0),
    (135.0, 13.0),
    (140.0, 21.0),
    (145.0, 12.0),
    (150.0, 17.0),
    (155.0, 4.0),
    (160.0, 20.0),
    (165.0, 8.0),
    (170.0, 17.0),
    (175.0, 8.0),
    (180.0, 6.0),
    (185.0, 6.0),
    (190.0, 7.0),
    (195.0, 4.0),
    (200.0, 3.0),
    (205.0, 3.0),
    (210.0, 8.0),
    (215.0, 1.0),
    (220.0, 6.0),
    (230.0, 5.0),
    (235.0, 1.0),
    (240.0, 7.0),
    (245.0, 1.0),
    (250.0, 2.0),
];

/// Negative logarithm of the likelihood of three normal distributions, problem 105.
fn mixture(x: &[Dual]) -> Dual {
    let density = |y: f64, share: Dual, mean: Dual, width: Dual| {
        let z = (y - mean) / width;
        share / width * (-0.5 * z.powi(2)).exp()
    };
    let root = (2.0 * std::f64::consts::PI).sqrt();
    let term = |&(y, count): &(f64, f64)| {
        let sum = density(y, x[0], x[2], x[5])
            + density(y, x[1], x[3], x[6])
            + density(y, 1.0 - x[0] - x[1], x[4], x[7]);
        -count * (sum / root).ln()
    };
    SAMPLE.iter().map(term).sum()
}
