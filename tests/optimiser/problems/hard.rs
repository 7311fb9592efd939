//! Small programs, each hard for one reason.

use crate::problems::dual::Dual;
use crate::problems::problem::{INF, Problem};

/// The full step towards the solution raises both objective and violation (Maratos 1978; Nocedal &
/// Wright 2006, example 15.4).
pub fn maratos() -> Problem {
    let angle = 1.2_f64;
    Problem::new("Maratos", &[angle.cos(), angle.sin()], -1.0, |x| {
        2.0 * (x[0].powi(2) + x[1].powi(2) - 1.0) - x[0]
    })
    .rows(0, 1, |x| vec![x[0].powi(2) + x[1].powi(2) - 1.0])
}

/// Complementarity constraints: no feasible point satisfies the Mangasarian–Fromovitz condition.
pub fn complementarity() -> Problem {
    Problem::new("complementarity", &[0.8, 0.3], 1.0, |x| {
        (x[0] - 1.0).powi(2) + (x[1] - 1.0).powi(2)
    })
    .all_within(0.0, INF)
    .rows(1, 0, |x| vec![-(x[0] * x[1])])
}

/// At the optimum both rows have the gradient (1, −1) or a multiple of it.
pub fn rank_deficient() -> Problem {
    Problem::new("rank deficient", &[3.0, -1.0], 0.5, |x| {
        (x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2)
    })
    .rows(0, 2, |x| vec![x[0] - x[1], (x[0] - x[1]) * x[0]])
}

/// One equality, three times.
pub fn redundant() -> Problem {
    Problem::new("redundant", &[4.0, 4.0, -1.0], 4.0 / 3.0, |x| {
        x[0].powi(2) + x[1].powi(2) + x[2].powi(2)
    })
    .rows(0, 3, |x| {
        let sum = x[0] + x[1] + x[2] - 2.0;
        vec![sum, 2.0 * sum, -1.0 * sum]
    })
}

/// A linear row out of reach of the bounds by 1.
pub fn contradiction() -> Problem {
    Problem::new("contradiction", &[1.0, 1.0], 0.0, |x| x[0].powi(2) + x[1])
        .all_within(0.0, 1.0)
        .rows(1, 0, |x| vec![x[0] + x[1] - 3.0])
}

/// An equality without a root, violated by at least 0.5.
pub fn without_root() -> Problem {
    Problem::new("no root", &[2.0, 1.0], 0.0, |x| x[0] + x[1].powi(2))
        .rows(0, 1, |x| vec![x[0].powi(2) + x[1].powi(2) + 0.5])
}

/// Unbounded along a ray, with a linear objective.
pub fn unbounded_linear() -> Problem {
    Problem::new("linear", &[1.0, 1.0], 0.0, |x| x[0] + x[1]).rows(1, 0, |x| vec![1.0 - x[0]])
}

/// Unbounded, concave.
pub fn unbounded_concave() -> Problem {
    Problem::new("concave", &[1.0], 0.0, |x| -(x[0].powi(2)))
}

/// Steps overshoot into x ≤ 0, where the functions are not numbers. The optimum x = 1e-3 is near it.
pub fn logarithm() -> Problem {
    Problem::new("logarithm", &[0.9, 0.0], 1.0 + 1e3_f64.ln(), |x| {
        1e3 * x[0] - x[0].ln() + (x[1] - 1.0).powi(2)
    })
    .rows(1, 0, |x| vec![x[0].sqrt() + x[1]])
}

/// The objective is not a number at the start.
pub fn undefined_start() -> Problem {
    Problem::new("undefined start", &[-1.0], 1.0, |x| x[0] - x[0].ln()).all_within(-5.0, 5.0)
}

/// HS71 with one row 1e8 times larger than its neighbour.
pub fn scaled_row() -> Problem {
    Problem::new("scaled row", &[1.0, 5.0, 5.0, 1.0], 17.0140173, |x| {
        x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]
    })
    .all_within(1.0, 5.0)
    .rows(1, 1, |x| {
        let squares: Dual = x.iter().map(|v| v.powi(2)).sum();
        vec![1e8 * (x[0] * x[1] * x[2] * x[3] - 25.0), squares - 40.0]
    })
}

/// `n` variables and n/2 constraints, half of them equalities; the optimum is not known in advance.
pub fn large(n: usize) -> Problem {
    let start = vec![0.5; n];
    Problem::new("large", &start, f64::NAN, move |x| {
        let target = |i: usize| 1.5 * ((i as f64) * 0.7).sin();
        let pull: Dual = (0..n).map(|i| (x[i] - target(i)).powi(2)).sum();
        let chain: Dual = (1..n).map(|i| (x[i] - x[i - 1]).powi(4)).sum();
        pull + 0.1 * chain
    })
    .all_within(-1.0, 1.2)
    .rows(n / 4, n / 4, move |x| {
        let disc = |k: usize| 1.5 - x[4 * k].powi(2) - x[4 * k + 1].powi(2);
        let curve = |k: usize| x[4 * k + 2] + x[4 * k + 3] * x[4 * k] - 0.2;
        (0..n / 4).map(disc).chain((0..n / 4).map(curve)).collect()
    })
}

/// The swing-up of a pole on a cart in two seconds by 41 nodes of a linear force within 11 N, from rest to rest
/// a metre away, with the least integral of the squared force (Kelly 2017, SIAM Review 59(4), section 6).
pub fn cart_pole() -> Problem {
    let start: Vec<f64> = (0..41)
        .map(|k| 6.0 * (std::f64::consts::PI * f64::from(k) / 20.0).cos())
        .collect();
    Problem::new("cart-pole", &start, 58.2173366, |u| {
        let pairs = u.windows(2);
        pairs.fold(Dual::from(0.0), |sum, p| {
            sum + 0.05 / 3.0 * (p[0] * p[0] + p[0] * p[1] + p[1] * p[1])
        })
    })
    .all_within(-11.0, 11.0)
    .rows(0, 4, |u| {
        let rates = |x: [Dual; 4], force: Dual| {
            let (sin, cos) = (x[1].sin(), x[1].cos());
            let pull = 0.15 * sin * x[3] * x[3] + force;
            let mass = 1.0 + 0.3 * sin * sin;
            let cart = (pull + 0.3 * 9.81 * cos * sin) / mass;
            [x[2], x[3], cart, -2.0 * (cos * cart + 9.81 * sin)]
        };
        let mut x = [Dual::from(0.0); 4];
        for step in 0..80 {
            let (h, pair) = (0.025, &u[step / 2..step / 2 + 2]);
            let at = |share: f64| {
                let share = 0.5 * ((step % 2) as f64 + share);
                pair[0] + share * (pair[1] - pair[0])
            };
            let moved = |by: f64, k: [Dual; 4]| std::array::from_fn(|i| x[i] + by * k[i]);
            let a = rates(x, at(0.0));
            let b = rates(moved(0.5 * h, a), at(0.5));
            let c = rates(moved(0.5 * h, b), at(0.5));
            let d = rates(moved(h, c), at(1.0));
            x = std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        vec![x[0] - 1.0, x[1] - std::f64::consts::PI, x[2], x[3]]
    })
}
