//! Programs of collections other than that of Hock & Schittkowski: minimax problems (Lukšan & Vlček
//! 2000, *Test Problems for Nonsmooth Unconstrained and Linearly Constrained Optimization*),
//! equality constraints (Boggs & Tolle 1989), and others by their names in CUTEst (Gould, Orban &
//! Toint 2015), with the least objectives given there.

use crate::problems::dual::Dual;
use crate::problems::problem::{INF, Problem};

/// Minimise u subject to f_i(x) ≤ u, where `f` returns `m` functions; u starts at 0.
fn minimax(
    name: &'static str,
    start: &[f64],
    best: f64,
    m: usize,
    f: impl Fn(&[Dual]) -> Vec<Dual> + 'static,
) -> Problem {
    let n = start.len();
    let start = [start, &[0.0]].concat();
    Problem::new(name, &start, best, move |x| x[n]).rows(m, 0, move |x| {
        f(&x[..n]).into_iter().map(|v| x[n] - v).collect()
    })
}

fn sq(x: Dual) -> Dual {
    x.powi(2)
}

/// All programs, each with a finite least objective.
pub fn collected() -> Vec<Problem> {
    let mut all = minimax_problems();
    all.extend(equality_constrained());
    all.extend(others());
    all
}

fn minimax_problems() -> Vec<Problem> {
    vec![
        minimax("CB2", &[2.0, 2.0], 1.952224494, 3, |x| {
            let (a, b) = (x[0], x[1]);
            vec![
                sq(a) + b.powi(4),
                sq(2.0 - a) + sq(2.0 - b),
                2.0 * (b - a).exp(),
            ]
        }),
        minimax("CB3", &[2.0, 2.0], 2.0, 3, |x| {
            let (a, b) = (x[0], x[1]);
            vec![
                a.powi(4) + sq(b),
                sq(2.0 - a) + sq(2.0 - b),
                2.0 * (b - a).exp(),
            ]
        }),
        minimax("MADSEN", &[3.0, 1.0], 0.6164324356, 6, |x| {
            let f = [sq(x[0]) + sq(x[1]) + x[0] * x[1], x[0].sin(), x[1].cos()];
            f.iter().flat_map(|v| [*v, -*v]).collect()
        }),
        minimax("DEM", &[1.0, 1.0], -3.0, 3, |x| {
            let bowl = sq(x[0]) + sq(x[1]) + 4.0 * x[1];
            vec![5.0 * x[0] + x[1], -5.0 * x[0] + x[1], bowl]
        }),
        minimax("LQ", &[-0.5, -0.5], -(2.0_f64.sqrt()), 2, |x| {
            let plane = -x[0] - x[1];
            vec![plane, plane + sq(x[0]) + sq(x[1]) - 1.0]
        }),
        minimax("POLAK1", &[50.0, 0.05], 1.0_f64.exp(), 2, |x| {
            let f = |shift: f64| (0.001 * sq(x[0]) + sq(x[1] + shift)).exp();
            vec![f(-1.0), f(1.0)]
        }),
        minimax("KIWCRESC", &[-1.5, 2.0], 0.0, 2, |x| {
            let ring = sq(x[0]) + sq(x[1] - 1.0);
            vec![ring + x[1] - 1.0, -ring + x[1] + 1.0]
        }),
        minimax("MIFFLIN1", &[0.8, 0.6], -1.0, 2, |x| {
            vec![-x[0], -x[0] + 20.0 * (sq(x[0]) + sq(x[1]) - 1.0)]
        }),
        minimax("SPIRAL", &[1.411831, -4.79462], 0.0, 2, |x| {
            let square = sq(x[0]) + sq(x[1]);
            let r = square.sqrt();
            let f = |x: Dual, turn: Dual| sq(x - r * turn) + 0.005 * square;
            vec![f(x[0], r.cos()), f(x[1], r.sin())]
        }),
        minimax("ROSENMMX", &[0.0; 4], -44.0, 4, |x| {
            let squares = |w: [f64; 4]| (0..4).map(|i| w[i] * sq(x[i])).sum::<Dual>();
            let linear = |w: [f64; 4]| (0..4).map(|i| w[i] * x[i]).sum::<Dual>();
            let f = squares([1.0, 1.0, 2.0, 1.0]) + linear([-5.0, -5.0, -21.0, 7.0]);
            let a = squares([1.0; 4]) + linear([1.0, -1.0, 1.0, -1.0]) - 8.0;
            let b = squares([1.0, 2.0, 1.0, 2.0]) + linear([-1.0, 0.0, 0.0, -1.0]) - 10.0;
            let c = squares([1.0, 1.0, 1.0, 0.0]) + linear([2.0, -1.0, 0.0, -1.0]) - 5.0;
            vec![f, f + 10.0 * a, f + 10.0 * b, f + 10.0 * c]
        }),
    ]
}

fn equality_constrained() -> Vec<Problem> {
    vec![
        Problem::new("BT1", &[0.08, 0.06], -1.0, |x| {
            100.0 * sq(x[0]) + 100.0 * sq(x[1]) - x[0] - 100.0
        })
        .rows(0, 1, |x| vec![sq(x[0]) + sq(x[1]) - 1.0]),
        Problem::new("BT2", &[10.0; 3], 0.03256820025, |x| {
            sq(x[0] - 1.0) + sq(x[0] - x[1]) + (x[1] - x[2]).powi(4)
        })
        .rows(0, 1, |x| {
            vec![x[0] * (1.0 + sq(x[1])) + x[2].powi(4) - 8.2426407]
        }),
        Problem::new("BT4", &[4.0382, -2.9470, -0.09115], -45.51055, |x| {
            x[0] - x[1] + x[1].powi(3)
        })
        .rows(0, 2, |x| {
            vec![
                sq(x[0]) + sq(x[1]) + sq(x[2]) - 25.0,
                x[0] + x[1] + x[2] - 1.0,
            ]
        }),
        Problem::new("BYRDSPHR", &[5.0, 1e-4, -1e-4], -4.68330013, |x| {
            -x[0] - x[1] - x[2]
        })
        .rows(0, 2, |x| {
            let rest = sq(x[1]) + sq(x[2]);
            vec![sq(x[0]) + rest - 9.0, sq(x[0] - 1.0) + rest - 9.0]
        }),
        Problem::new("POWELLBS", &[0.0, 1.0], 0.0, |x| 0.0 * x[0]).rows(0, 2, |x| {
            vec![
                1e4 * x[0] * x[1] - 1.0,
                (-x[0]).exp() + (-x[1]).exp() - 1.0001,
            ]
        }),
        Problem::new("BROYDN3D", &[-1.0; 10], 0.0, |x| 0.0 * x[0]).rows(0, 10, |x| {
            let before = |i: usize| if i > 0 { x[i - 1] } else { Dual::from(0.0) };
            let after = |i: usize| if i < 9 { x[i + 1] } else { Dual::from(0.0) };
            let row = |i: usize| (3.0 - 2.0 * x[i]) * x[i] + 1.0 - before(i) - 2.0 * after(i);
            (0..10).map(row).collect()
        }),
    ]
}

fn others() -> Vec<Problem> {
    vec![
        // Wächter & Biegler (2000): line searches that satisfy the linearised rows fail.
        Problem::new("WB", &[-2.0, 3.0, 1.0], 1.0, |x| x[0])
            .bounds(&[-INF, 0.0, 0.0], &[INF; 3])
            .rows(0, 2, |x| vec![sq(x[0]) - x[1] - 1.0, x[0] - x[2] - 0.5]),
        Problem::new("TWOBARS", &[1.0, 1.0], 1.50865242, |x| {
            x[0] * (1.0 + sq(x[1])).sqrt()
        })
        .bounds(&[0.2, 0.1], &[4.0, 1.6])
        .rows(2, 0, |x| {
            let length = 0.124 * (1.0 + sq(x[1])).sqrt();
            let (a, b) = (8.0 / x[0], 1.0 / (x[0] * x[1]));
            vec![1.0 - length * (a + b), 1.0 - length * (a - b)]
        }),
        Problem::new("BEALE", &[1.0, 1.0], 0.0, |x| {
            let term = |c: f64, k: i32| sq(c - x[0] * (1.0 - x[1].powi(k)));
            term(1.5, 1) + term(2.25, 2) + term(2.625, 3)
        }),
        Problem::new("POWELLSG", &[3.0, -1.0, 0.0, 1.0], 0.0, |x| {
            let linear = sq(x[0] + 10.0 * x[1]) + 5.0 * sq(x[2] - x[3]);
            linear + (x[1] - 2.0 * x[2]).powi(4) + 10.0 * (x[0] - x[3]).powi(4)
        }),
        Problem::new("DENSCHNE", &[2.0, 3.0, -8.0], 0.0, |x| {
            sq(x[0]) + sq(x[1] + sq(x[1])) + sq(x[2].exp() - 1.0)
        }),
        Problem::new("ROSEN50", &[-1.2; 50], 0.0, |x| {
            let link = |i: usize| 100.0 * sq(x[i + 1] - sq(x[i])) + sq(1.0 - x[i]);
            (0..49).map(link).sum()
        }),
    ]
}
