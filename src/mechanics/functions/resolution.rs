//! The number of quadrature cells per step that sums over the motion need.

use super::{Function, Instant, Operation, Quantity, Reduction, Release, Scene};
use crate::integrate::Trajectory;
use crate::integrate::quadrature::{ADDED, LOBATTO, WEIGHTS};
use crate::model::Model;
use crate::system::placement::length_scale;

/// Below this exponent the weight of a soft maximum is negligible: e^-72 is ε².
const COLD: f64 = -72.0;
/// Largest difference of exponents of neighbouring nodes between which a rule sees a peak.
const RESOLVED: f64 = 3.0;
/// Round-off of a quantity, relative to its natural size.
const NOISE: f64 = 1e3 * f64::EPSILON;
/// Largest number of cells of a step, and largest factor by which it may grow at once.
const MOST: f64 = 256.0;
const GROWTH: f64 = 4.0;
const ACCELERATION: &str = "m/s²";
/// Orders of the two quadrature rules of a cell.
const ORDERS: [f64; 2] = [6.0, 10.0];

/// Errors with the cells in use, and the cells that are needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolution {
    /// Largest estimated error of a sum, relative to the sum of sizes.
    pub error: f64,
    /// Number of cells of each step that keeps the error of every sum below the goal; empty for one each.
    pub cells: Vec<u32>,
}

/// The integrand of a function over the motion.
struct Sum {
    /// Size of the integrand at every sample, relative to the whole.
    sizes: Vec<f64>,
    /// The integrand at every sample, relative to the whole.
    terms: Vec<f64>,
    /// Of a soft maximum the logarithms of the sizes: where they are very small, no cells are needed.
    exponents: Option<Vec<f64>>,
}

impl Sum {
    /// The sum of two integrands.
    fn with(self, other: Sum) -> Sum {
        let add = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Sum {
            sizes: add(self.sizes, other.sizes),
            terms: add(self.terms, other.terms),
            exponents: None,
        }
    }
}

/// The cells that the functions `which` need over a run whose samples are nodes of cells. The error
/// of each sum is below `goal` relative to the sum of sizes, or round-off.
pub fn resolution(
    scene: &Scene<f64>,
    which: &[usize],
    run: &Trajectory<f64>,
    goal: f64,
) -> Resolution {
    let steps = run.grid.steps();
    let nodes: Vec<usize> = (0..=run.last()).filter(|&k| run.weights[k] > 0.0).collect();
    // The nodes at the ends of steps.
    let mut ends = vec![0];
    ends.extend((1..=steps).scan(0, |at, k| {
        *at += run.grid.step(k).nodes();
        Some(*at)
    }));
    let mut found = Resolution {
        error: 0.0,
        cells: vec![0; steps],
    };
    for &f in which {
        let Some(sum) = sum_of(scene, f, (run, &nodes), goal) else {
            // The maximum over the motion needs a cell in each step, but no sum.
            found
                .cells
                .iter_mut()
                .for_each(|cells| *cells = (*cells).max(1));
            continue;
        };
        let share = goal / steps as f64;
        let mut total = 0.0;
        for k in 1..=steps {
            let step = run.grid.step(k);
            let nodes = ends[k - 1]..ends[k] + 1;
            let beside = &ends[k.saturating_sub(2)..(k + 2).min(ends.len())];
            let bound = sum.bound(nodes.clone(), beside);
            let (wanted, error) = sum.step(nodes, (step.end - step.from, bound), step.cells, share);
            total += error;
            found.cells[k - 1] = found.cells[k - 1].max(wanted);
        }
        found.error = found.error.max(total);
    }
    // One cell a step is what a run has that was told of none.
    if run.grid.all_cells().is_empty() && found.cells.iter().all(|&cells| cells == 1) {
        found.cells.clear();
    }
    found
}

impl Sum {
    /// A bound of the sizes in a step of a soft maximum, which may have a peak between its nodes: not higher above them than the
    /// exponents at the ends of steps `beside` it differ.
    fn bound(&self, nodes: std::ops::Range<usize>, beside: &[usize]) -> Option<f64> {
        let exponents = self.exponents.as_ref()?;
        let highest = (exponents[nodes].iter()).fold(f64::NEG_INFINITY, |m, &x| m.max(x));
        let differences = beside
            .windows(2)
            .map(|two| exponents[two[1]] - exponents[two[0]]);
        Some((highest + differences.fold(0.0, |m, x| x.abs().max(m))).exp())
    }

    /// The largest size between two of these nodes of a soft maximum where exponents differ too much for a rule. A peak there is not
    /// higher above two neighbours that rise to it than these differ from theirs.
    fn hidden(&self, nodes: std::ops::Range<usize>) -> f64 {
        let Some(exponents) = &self.exponents else {
            return 0.0;
        };
        let e = &exponents[nodes];
        let beside = |i: usize| {
            let before = (i > 0).then(|| e[i] - e[i - 1]);
            let after = e.get(i + 2).map(|next| e[i + 1] - next);
            let rises = [before, after].into_iter().flatten().all(|x| x >= 0.0);
            let fall = (e[i + 1] - e[i]).abs();
            let margin = [before, after].into_iter().flatten().fold(fall, f64::max);
            let top = e[i].max(e[i + 1]);
            if rises && margin > RESOLVED {
                Some(top + margin)
            } else {
                // As from the end of a motion.
                (fall > RESOLVED).then_some(top)
            }
        };
        let highest = (0..e.len().saturating_sub(1)).filter_map(beside);
        highest.fold(f64::NEG_INFINITY, f64::max).exp().min(1.0)
    }

    /// Number of cells that a step with these nodes needs, and the error of the sum over it. Its sizes are below `bound`, if there is one.
    fn step(
        &self,
        nodes: std::ops::Range<usize>,
        (width, bound): (f64, Option<f64>),
        cells: usize,
        share: f64,
    ) -> (u32, f64) {
        let (sizes, terms) = (&self.sizes[nodes.clone()], &self.terms[nodes.clone()]);
        let least = u32::from(bound.is_none_or(|bound| bound >= COLD.exp()));
        if cells == 0 {
            // Values at the two ends give no estimate: the whole is uncertain.
            let error = 0.5 * width * (sizes[0] + sizes[sizes.len() - 1]);
            return (least, error.max(width * bound.unwrap_or(0.0).min(1.0)));
        }
        let part = width / cells as f64;
        let cell = |i: usize| {
            let at = ADDED * i;
            let rule = |of: &[f64], weights: &[f64; 7]| -> f64 {
                weights.iter().zip(&of[at..]).map(|(w, x)| w * x).sum()
            };
            let difference = (rule(terms, &WEIGHTS) - rule(terms, &LOBATTO)).abs();
            let size = rule(sizes, &WEIGHTS);
            // The difference of both rules is the error of the lower one.
            let relative = (difference / size).powf(ORDERS[1] / ORDERS[0]).min(1.0);
            if size > 0.0 {
                part * size * relative
            } else {
                0.0
            }
        };
        let seen: f64 = (0..cells).map(cell).sum();
        let error = seen.max(part * self.hidden(nodes));
        if least == 0 {
            return (0, error);
        }
        let more = (error / share).powf(1.0 / ORDERS[1]).clamp(1.0, GROWTH);
        let wanted = (cells as f64 * more).ceil().min(MOST);
        // Rounding up must not increase the number at every call.
        let wanted = if error <= share { cells as f64 } else { wanted };
        (wanted as u32, error)
    }
}

/// The size of a quantity with this unit in a motion, from the scene's mass m and length l and the
/// largest speed v, at least √(g l): m v² for an energy or a moment. Zero if it is not known.
fn natural(unit: &str, model: &Model<f64>, run: &Trajectory<f64>) -> f64 {
    let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
    let length = length_scale(model);
    let square = |six: &[f64]| six[..3].iter().map(|x| x * x).sum::<f64>();
    let fastest = (0..model.bodies.len()).flat_map(|body| {
        let o = run.numbering.velocity(body);
        (0..=run.last()).map(move |k| square(&run.v(k)[o..]))
    });
    let square = fastest.fold(model.gravity.norm() * length, f64::max);
    let speed = square.sqrt();
    match unit {
        "m" => length,
        "m/s" => speed,
        ACCELERATION => square / length,
        "m²/s²" => square,
        "rad" | "1" => 1.0,
        "rad/s" => speed / length,
        "kg m/s" => mass * speed,
        "kg m²/s" => mass * speed * length,
        "J" | "N m" => mass * square,
        "N" => mass * square / length,
        "W" => mass * square * speed / length,
        _ => 0.0,
    }
}

/// The size below which a quantity is zero but for round-off, over `goal`: as accurate as its unit in this motion. Inside steps
/// accelerations are less accurate than the motion. Zero if it is not known.
fn least(whole: &Quantity<f64>, at: (&Model<f64>, &Trajectory<f64>), goal: f64) -> f64 {
    let (operation, of) = match whole {
        Quantity::Of(instant) => {
            let size = natural(instant.unit(), at.0, at.1);
            return match instant.unit() {
                ACCELERATION => size,
                _ => NOISE / goal * size,
            };
        }
        Quantity::Combined { operation, of } => (operation, of),
    };
    let mut own = of.iter().map(|own| least(own, at, goal));
    match operation {
        Operation::Sum | Operation::Difference | Operation::Absolute { .. } => {
            own.fold(0.0, f64::max)
        }
        Operation::Square => own.next().map_or(0.0, |own| own * own),
        Operation::Product => {
            let size = natural(&whole.unit(), at.0, at.1);
            own.product::<f64>().max(NOISE / goal * size)
        }
        // A difference of round-off over the distance of nodes.
        Operation::Rate => own.next().unwrap_or(0.0) * at.1.last() as f64 / at.1.duration,
        Operation::Quotient => 0.0,
    }
}

/// The integrand of function f at the nodes of a run; `None` if the function is no sum.
fn sum_of(
    scene: &Scene<f64>,
    f: usize,
    (run, nodes): (&Trajectory<f64>, &[usize]),
    goal: f64,
) -> Option<Sum> {
    let (of, rho) = match scene.function(f) {
        // Polynomials between the samples stand for the quantity in a window.
        Function::Reduced {
            of,
            during: Some(_),
            ..
        } => (of.clone(), None),
        Function::Reduced { of, reduction, .. } => match *reduction {
            Reduction::Final => return None,
            Reduction::Integral | Reduction::Mean | Reduction::Damage { .. } => (of.clone(), None),
            Reduction::Ks { rho, .. } | Reduction::InducedExponential { rho } => {
                (of.clone(), Some(rho))
            }
        },
        Function::Clearance { release, .. } => match release {
            Release::Final => return None,
            &Release::Best {
                rho,
                projectile,
                gate,
            } => (Quantity::Of(Instant::Range { projectile, gate }), Some(rho)),
        },
        // Values at the times of data are those of polynomials, each quantity in its own size.
        Function::Misfit { series } => {
            let parts: Vec<Sum> = series
                .iter()
                .map(|own| sum_over(scene, (&own.of, None), (run, nodes), goal))
                .collect();
            return parts.into_iter().reduce(Sum::with);
        }
        Function::Duration | Function::LowestFrequency { .. } | Function::OfDesign { .. } => {
            return None;
        }
    };
    Some(sum_over(scene, (&of, rho), (run, nodes), goal))
}

/// A quantity as an integrand, or its exponential.
fn sum_over(
    scene: &Scene<f64>,
    (of, rho): (&Quantity<f64>, Option<f64>),
    (run, nodes): (&Trajectory<f64>, &[usize]),
    goal: f64,
) -> Sum {
    let all = of.sample(&scene.model, run);
    let values: Vec<f64> = nodes.iter().map(|&k| all[k]).collect();
    let top = values.iter().fold(f64::NEG_INFINITY, |m, &g| m.max(g));
    let exponents = rho.map(|rho| values.iter().map(|g| rho * (g - top)).collect::<Vec<f64>>());
    let terms: Vec<f64> = match &exponents {
        None => values,
        Some(exponents) => exponents.iter().map(|x| x.exp()).collect(),
    };
    let weighed = terms.iter().zip(nodes);
    let total: f64 = weighed.map(|(x, &k)| x.abs() * run.weights[k]).sum();
    let floor = match (of, rho) {
        (_, None) => least(of, (&scene.model, run), goal),
        (of, Some(rho)) if of.unit() == ACCELERATION => {
            rho * natural(ACCELERATION, &scene.model, run)
        }
        (_, Some(_)) => 0.0,
    };
    let total = total.max(floor);
    let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
    Sum {
        sizes: terms.iter().map(|x| x.abs() * scale).collect(),
        terms: terms.iter().map(|x| x * scale).collect(),
        exponents: exponents.map(|all| all.into_iter().map(|x| x + scale.ln()).collect()),
    }
}
