//! Samples inside a step, and the weights of sums over the motion.
//!
//! A step is divided into cells of equal size. Each cell has the nodes and weights of Kronrod's
//! extension of the four-node Lobatto rule (Gander & Gautschi 2000, section 3), which is exact for
//! polynomials of degree 9. Fractions of a step move with it, so sums are smooth in the design.
//! Equally spaced samples have the weights of Gregory's rule of order 6, others those of the
//! trapezoidal rule.

/// Nodes of a cell, as fractions of it.
pub const NODES: [f64; 7] = [
    0.0,
    0.091_751_709_536_136_98,
    0.276_393_202_250_021,
    0.5,
    0.723_606_797_749_979,
    0.908_248_290_463_863,
    1.0,
];
/// Weights of the nodes; their sum is one.
pub const WEIGHTS: [f64; 7] = [
    77.0 / 2940.0,
    432.0 / 2940.0,
    625.0 / 2940.0,
    672.0 / 2940.0,
    625.0 / 2940.0,
    432.0 / 2940.0,
    77.0 / 2940.0,
];
/// Weights of the Lobatto rule at four of the nodes, exact for polynomials of degree 5.
pub const LOBATTO: [f64; 7] = [
    1.0 / 12.0,
    0.0,
    5.0 / 12.0,
    0.0,
    5.0 / 12.0,
    0.0,
    1.0 / 12.0,
];
/// Number of nodes that a cell adds.
pub const ADDED: usize = NODES.len() - 1;

/// Weights of the first and last equally spaced samples in Gregory's rule.
const GREGORY: [f64; 5] = [
    95.0 / 288.0,
    317.0 / 240.0,
    23.0 / 30.0,
    793.0 / 720.0,
    157.0 / 160.0,
];
/// Instants are equally spaced up to this fraction of an interval.
const EQUAL: f64 = 1e-6;

/// Fractions with a smaller distance are the same instant; covers their round-off.
const SAME: f64 = 1e-15;

/// Instants at which a run samples the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// The ends of the steps.
    StepEnds,
    /// This many intervals of equal size (between kinks, see [`Grid::intervals`](super::Grid)). Inside
    /// steps the method's polynomial gives the motion.
    /// One-stage formulas always use the ends of their steps.
    Uniform(usize),
    /// The nodes of the [`cells`](super::Grid::cells) of each step and, for display, the ends of
    /// this many intervals of equal size, if any.
    Quadrature(usize),
}

/// Weights of samples at these fractions; their sum is one. Sums do not reach across `kinks` at which
/// samples lie. None of a run that ended before its first sample.
pub fn weights(instants: &[f64], kinks: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; instants.len()];
    if instants.is_empty() {
        return all;
    }
    let mut from = 0;
    let at = |kink: &f64| {
        instants
            .iter()
            .position(|at| (at - kink).abs() < EQUAL * EQUAL)
    };
    let last = instants.len() - 1;
    for end in kinks.iter().filter_map(at).chain([last]) {
        let (start, width) = (instants[from], instants[end] - instants[from]);
        let part = &instants[from..=end];
        let own = match (start, width) {
            (0.0, 1.0) => of_part(part),
            _ => of_part(
                &part
                    .iter()
                    .map(|at| (at - start) / width)
                    .collect::<Vec<f64>>(),
            ),
        };
        for (weight, own) in all[from..].iter_mut().zip(own) {
            *weight += own * width;
        }
        from = end;
    }
    all
}

/// Weights of samples at these fractions of a part of the motion.
fn of_part(instants: &[f64]) -> Vec<f64> {
    let last = instants.len() - 1;
    let trapezoidal = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        0.5 * (instants[after] - instants[before])
    };
    let mut all: Vec<f64> = (0..=last).map(trapezoidal).collect();
    if order(instants) > 2 {
        for (i, weight) in GREGORY.into_iter().enumerate() {
            all[i] = weight / last as f64;
            all[last - i] = weight / last as f64;
        }
    }
    all
}

/// Order of the sums with these [`weights`].
pub fn order(instants: &[f64]) -> usize {
    let count = instants.len() - 1;
    let place = |(k, at): (usize, &f64)| (at * count as f64 - k as f64).abs() < EQUAL;
    match count >= 2 * GREGORY.len() && instants.iter().enumerate().all(place) {
        true => 6,
        false => 2,
    }
}

/// A step between two fractions of the duration, with its number of cells. Without cells the
/// trapezoidal rule uses its two ends.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Start.
    pub from: f64,
    /// End.
    pub end: f64,
    /// Number of cells.
    pub cells: usize,
}

impl Step {
    /// Number of nodes without the first.
    pub fn nodes(&self) -> usize {
        (ADDED * self.cells).max(1)
    }

    /// Weight of its start.
    pub fn first_weight(&self) -> f64 {
        match self.cells {
            0 => 0.5 * (self.end - self.from),
            cells => WEIGHTS[0] * (self.end - self.from) / cells as f64,
        }
    }

    /// Fraction and weight of node i = 1 … [`Step::nodes`].
    fn node(&self, i: usize) -> (f64, f64) {
        let width = self.end - self.from;
        if i == self.nodes() {
            return (self.end, self.first_weight());
        }
        let cells = self.cells as f64;
        let (cell, j) = (i / ADDED, i % ADDED);
        let weight = if j == 0 { 2.0 * WEIGHTS[0] } else { WEIGHTS[j] };
        let at = self.from + width * ((cell as f64 + NODES[j]) / cells);
        (at, weight * width / cells)
    }
}

/// An instant at which the motion is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Due {
    /// Fraction of the duration.
    pub at: f64,
    /// Weight in sums over the motion; zero if it is not known yet.
    pub weight: f64,
    /// Whether tables and figures show it.
    pub shown: bool,
}

/// Intervals at whose ends a motion is sampled.
#[derive(Clone, Debug)]
pub struct Intervals {
    count: usize,
    /// Parts of the motion with their numbers of equal intervals; none if all intervals are equal.
    parts: Vec<([f64; 2], usize)>,
}

impl Intervals {
    /// This many equal ones.
    pub(super) fn equal(count: usize) -> Self {
        Self {
            count,
            parts: Vec::new(),
        }
    }

    /// So many equal ones in each part.
    pub(super) fn between(parts: Vec<([f64; 2], usize)>) -> Self {
        Self {
            count: parts.iter().map(|(_, own)| own).sum(),
            parts,
        }
    }

    /// The end of interval i ≥ 1.
    fn end(&self, i: usize) -> f64 {
        let mut before = 0;
        for &([from, end], own) in &self.parts {
            match i - before {
                last if last == own => return end,
                j if j < own => return from + (end - from) * (j as f64 / own as f64),
                _ => before += own,
            }
        }
        i as f64 / self.count as f64
    }
}

impl Samples {
    /// Number of equal intervals.
    pub(super) fn intervals(self) -> usize {
        match self {
            Samples::StepEnds => 0,
            Samples::Uniform(count) | Samples::Quadrature(count) => count,
        }
    }
}

/// Whether `samples` requires an instant inside a step with so many `cells` that ends at `end`.
/// `next` is the number of the next of the `intervals`.
pub(super) fn looks_inside(
    samples: Samples,
    (next, intervals): (usize, &Intervals),
    (end, cells): (f64, usize),
) -> bool {
    let count = intervals.count;
    let before = count > 0 && next <= count && !within(end, intervals.end(next));
    match samples {
        Samples::StepEnds => !within(end, 1.0),
        Samples::Uniform(_) => before,
        Samples::Quadrature(_) => cells > 0 || before || !within(end, 1.0),
    }
}

/// The instants of `samples` in a step, in ascending order without its start. `next` is the number
/// of the next of the `intervals`.
pub(super) fn due<'a>(
    samples: Samples,
    (next, intervals): (&'a mut usize, &'a Intervals),
    step: Step,
) -> impl Iterator<Item = Due> + use<'a> {
    let nodes = match samples {
        Samples::StepEnds => 1,
        Samples::Uniform(_) => 0,
        Samples::Quadrature(_) => step.nodes(),
    };
    let equal = intervals.count;
    let weighed = matches!(samples, Samples::Quadrature(_));
    let mut node = 1;
    std::iter::from_fn(move || {
        let shown = (*next <= equal && equal > 0)
            .then(|| intervals.end(*next))
            .filter(|&at| within(at, step.end));
        let summed = (node <= nodes).then(|| match weighed {
            true => step.node(node),
            false => (step.end, 0.0),
        });
        let (at, weight, is_shown) = match (summed, shown) {
            (None, None) => return None,
            (Some((at, weight)), None) => (at, weight, !weighed),
            (None, Some(at)) => (at, 0.0, true),
            (Some((at, weight)), Some(shown)) if is_same(at, shown) => (at, weight, true),
            (Some((at, weight)), Some(shown)) if at < shown => (at, weight, false),
            (Some(_), Some(shown)) => {
                *next += 1;
                return Some(Due {
                    at: shown,
                    weight: 0.0,
                    shown: true,
                });
            }
        };
        node += usize::from(summed.is_some());
        *next += usize::from(is_shown && shown.is_some());
        Some(Due {
            at,
            weight,
            shown: is_shown,
        })
    })
}

/// Whether two fractions are the same instant.
pub fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME
}

/// Whether the fraction `at` belongs to a step that ends at `end`.
pub fn within(at: f64, end: f64) -> bool {
    at <= end + SAME
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of f over [0, 1] with these ends of steps and this number of cells.
    fn sum(ends: &[f64], cells: usize, f: impl Fn(f64) -> f64) -> f64 {
        let (mut next, intervals) = (1, Intervals::equal(7));
        let mut total = 0.0;
        for pair in ends.windows(2) {
            let (from, end) = (pair[0], pair[1]);
            let step = Step { from, end, cells };
            total += step.first_weight() * f(from);
            for Due { at, weight, .. } in due(Samples::Quadrature(7), (&mut next, &intervals), step)
            {
                total += weight * f(at);
            }
        }
        assert_eq!(next, 8, "all equal intervals were taken");
        total
    }

    #[test]
    fn cells_sum_polynomials_of_degree_9_exactly() {
        let ends = [0.0, 0.07, 0.31, 0.65, 1.0];
        for cells in [1, 2, 5] {
            for degree in 0..=9 {
                let found = sum(&ends, cells, |t| t.powi(degree));
                let exact = 1.0 / f64::from(degree + 1);
                assert!((found - exact).abs() < 2e-15, "{cells} {degree}: {found}");
            }
        }
        let lobatto: f64 = NODES.iter().zip(LOBATTO).map(|(x, w)| w * x.powi(5)).sum();
        assert!((lobatto - 1.0 / 6.0).abs() < 1e-16);
    }

    #[test]
    fn equal_samples_sum_with_order_6_and_others_with_order_2() {
        let error = |instants: Vec<f64>| {
            let terms = weights(&instants, &[]).into_iter().zip(&instants);
            (terms.map(|(w, t)| w * t.exp()).sum::<f64>() - (1.0_f64.exp() - 1.0)).abs()
        };
        let equal = |n: usize| (0..=n).map(|k| k as f64 / n as f64).collect::<Vec<f64>>();
        let uneven = |n: usize| equal(n).into_iter().map(|t| t * (0.5 + 0.5 * t)).collect();
        let gain = |coarse: f64, fine: f64| (coarse / fine).log2();
        assert!(gain(error(equal(20)), error(equal(40))) > 5.5);
        let rate = gain(error(uneven(20)), error(uneven(40)));
        assert!((rate - 2.0).abs() < 0.1, "{rate}");
    }

    #[test]
    fn samples_that_are_shown_and_summed_are_one() {
        let step = Step {
            from: 0.0,
            end: 0.5,
            cells: 1,
        };
        let (mut next, intervals) = (1, Intervals::equal(4));
        let all: Vec<Due> = due(Samples::Quadrature(4), (&mut next, &intervals), step).collect();
        assert_eq!(all.len(), ADDED);
        assert_eq!(all.iter().filter(|due| due.shown).count(), 2);
        assert!(all.iter().all(|due| due.weight > 0.0));
        assert!(all.windows(2).all(|pair| pair[0].at < pair[1].at));
    }
}
