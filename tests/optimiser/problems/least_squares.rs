//! Sums of squares of Moré, Garbow & Hillstrom (1981), *Testing Unconstrained Optimization Software*,
//! ACM Transactions on Mathematical Software 7, with the starts and the least sums given there.

use crate::problems::dual::Dual;
use crate::problems::problem::Problem;
use crate::problems::squares::Squares;

fn squares(
    name: &'static str,
    start: &[f64],
    best: f64,
    f: impl Fn(&[Dual]) -> Vec<Dual> + 'static,
) -> Squares {
    Squares::new(name, start, best, f)
}

/// All of them, as sums alone.
pub fn least_squares() -> Vec<Problem> {
    let all = sums_of_squares().into_iter();
    all.map(Squares::into_problem).collect()
}

/// All of them with their residuals.
pub fn sums_of_squares() -> Vec<Squares> {
    let mut all = with_data();
    all.extend(badly_scaled());
    all.extend(of_any_size());
    all.extend(linear());
    all
}

fn with_data() -> Vec<Squares> {
    const BARD: [f64; 15] = [
        0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39,
    ];
    const KOWALIK: [(f64, f64); 11] = [
        (0.1957, 4.0),
        (0.1947, 2.0),
        (0.1735, 1.0),
        (0.1600, 0.5),
        (0.0844, 0.25),
        (0.0627, 0.167),
        (0.0456, 0.125),
        (0.0342, 0.1),
        (0.0323, 0.0833),
        (0.0235, 0.0714),
        (0.0246, 0.0625),
    ];
    const GAUSS: [f64; 8] = [
        0.0009, 0.0044, 0.0175, 0.0540, 0.1295, 0.2420, 0.3521, 0.3989,
    ];
    vec![
        squares("BARD", &[1.0; 3], 8.214877e-3, |x| {
            let row = |i: usize| {
                let (u, v) = (i as f64 + 1.0, 15.0 - i as f64);
                BARD[i] - (x[0] + u / (v * x[1] + u.min(v) * x[2]))
            };
            (0..15).map(row).collect()
        }),
        squares("KOWOSB", &[0.25, 0.39, 0.415, 0.39], 3.075056e-4, |x| {
            let row =
                |&(y, u): &(f64, f64)| y - x[0] * (u * u + u * x[1]) / (u * u + u * x[2] + x[3]);
            KOWALIK.iter().map(row).collect()
        }),
        squares("GAUSSIAN", &[0.4, 1.0, 0.0], 1.127933e-8, |x| {
            let row = |i: usize| {
                let t = (7.0 - i as f64) / 2.0;
                x[0] * (-0.5 * x[1] * (t - x[2]).powi(2)).exp() - GAUSS[i.min(14 - i)]
            };
            (0..15).map(row).collect()
        }),
        squares("BOX3", &[0.0, 10.0, 20.0], 0.0, |x| {
            let row = |i: i32| {
                let t = 0.1 * f64::from(i);
                (-t * x[0]).exp() - (-t * x[1]).exp() - x[2] * ((-t).exp() - (-10.0 * t).exp())
            };
            (1..=10).map(row).collect()
        }),
        squares("WATSON6", &[0.0; 6], 2.287670e-3, |x| {
            let row = |i: i32| {
                let t = f64::from(i) / 29.0;
                let slope: Dual = (1..6).map(|j| j as f64 * t.powi(j as i32 - 1) * x[j]).sum();
                let value: Dual = (0..6).map(|j| t.powi(j as i32) * x[j]).sum();
                slope - value.powi(2) - 1.0
            };
            let mut all: Vec<Dual> = (1..=29).map(row).collect();
            all.extend([x[0], x[1] - x[0].powi(2) - 1.0]);
            all
        }),
    ]
}

fn badly_scaled() -> Vec<Squares> {
    vec![
        squares("BROWNBS", &[1.0, 1.0], 0.0, |x| {
            vec![x[0] - 1e6, x[1] - 2e-6, x[0] * x[1] - 2.0]
        }),
        squares("POWELLBSLS", &[0.0, 1.0], 0.0, |x| {
            vec![
                1e4 * x[0] * x[1] - 1.0,
                (-x[0]).exp() + (-x[1]).exp() - 1.0001,
            ]
        }),
        squares("BROWNDEN", &[25.0, 5.0, -5.0, -1.0], 85822.20162636, |x| {
            let row = |i: i32| {
                let t = f64::from(i) / 5.0;
                (x[0] + t * x[1] - t.exp()).powi(2) + (x[2] + t.sin() * x[3] - t.cos()).powi(2)
            };
            (1..=20).map(row).collect()
        }),
        squares("JENSMP", &[0.3, 0.4], 124.3621823556, |x| {
            let row = |i: i32| {
                let i = f64::from(i);
                2.0 + 2.0 * i - ((i * x[0]).exp() + (i * x[1]).exp())
            };
            (1..=10).map(row).collect()
        }),
    ]
}

fn of_any_size() -> Vec<Squares> {
    const N: usize = 10;
    let h = 1.0 / (N as f64 + 1.0);
    let place = move |i: usize| (i as f64 + 1.0) * h;
    let line: Vec<f64> = (0..N).map(|i| place(i) * (place(i) - 1.0)).collect();
    let ramp: Vec<f64> = (1..=N).map(|j| 1.0 - j as f64 / N as f64).collect();
    let pairs: Vec<f64> = (0..10).flat_map(|_| [-1.2, 1.0]).collect();
    vec![
        squares("VARDIM10", &ramp, 0.0, |x| {
            let sum: Dual = (0..N).map(|j| (j as f64 + 1.0) * (x[j] - 1.0)).sum();
            let mut all: Vec<Dual> = x.iter().map(|v| *v - 1.0).collect();
            all.extend([sum, sum.powi(2)]);
            all
        }),
        squares("PENALTY1", &[1.0, 2.0, 3.0, 4.0], 2.249978e-5, |x| {
            let mut all: Vec<Dual> = x.iter().map(|v| 1e-5_f64.sqrt() * (*v - 1.0)).collect();
            all.push(x.iter().map(|v| v.powi(2)).sum::<Dual>() - 0.25);
            all
        }),
        squares("PENALTY2", &[0.5; 4], 9.376293e-6, |x| {
            let a = 1e-5_f64.sqrt();
            let e = |j: usize| (0.1 * x[j]).exp();
            let y = |i: f64| (0.1 * i).exp() + (0.1 * (i - 1.0)).exp();
            let mut all = vec![x[0] - 0.2];
            all.extend((1..4).map(|i| a * (e(i) + e(i - 1) - y(i as f64 + 1.0))));
            all.extend((1..4).map(|i| a * (e(i) - (-0.1_f64).exp())));
            all.push(
                (0..4)
                    .map(|j| (4.0 - j as f64) * x[j].powi(2))
                    .sum::<Dual>()
                    - 1.0,
            );
            all
        }),
        squares("EXTROSN20", &pairs, 0.0, |x| {
            let pair = |k: usize| {
                let (a, b) = (x[2 * k], x[2 * k + 1]);
                [10.0 * (b - a.powi(2)), 1.0 - a]
            };
            (0..10).flat_map(pair).collect()
        }),
        squares("MOREBV", &line, 0.0, move |x| {
            let at = |i: Option<usize>| i.and_then(|i| x.get(i).copied()).unwrap_or(0.0.into());
            let row = |i: usize| {
                let bend = 2.0 * x[i] - at(i.checked_sub(1)) - at(Some(i + 1));
                bend + 0.5 * h * h * (x[i] + place(i) + 1.0).powi(3)
            };
            (0..N).map(row).collect()
        }),
    ]
}

/// Ten rows in five variables, of full rank and of rank one.
fn linear() -> Vec<Squares> {
    vec![
        squares("ARGLINA", &[1.0; 5], 5.0, |x| {
            let sum: Dual = x.iter().copied().sum();
            let row = |i: usize| {
                let own = if i < 5 { x[i] } else { 0.0.into() };
                own - 0.2 * sum - 1.0
            };
            (0..10).map(row).collect()
        }),
        squares("ARGLINB", &[1.0; 5], 15.0 / 7.0, |x| {
            let sum: Dual = (0..5).map(|j| (j as f64 + 1.0) * x[j]).sum();
            (1..=10).map(|i| f64::from(i) * sum - 1.0).collect()
        }),
    ]
}
