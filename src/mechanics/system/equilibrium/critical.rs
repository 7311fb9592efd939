//! Critical speeds of a machine in steady rotation: where a forward whirl has the frequency of the rotation in the fixed
//! frame, so that an unbalance, which turns with the machine, excites it. The turning frame sees it at rest:
//!
//! ```text
//! [K(Ω), Gᵀ; G, 0] [y; μ] = 0,     K(Ω) = K_0 + Ω² N    at given positions and reactions,
//! ```
//!
//! without damping, by the even part of K in Ω. This is the problem of [`super::krylov`] with −N as mass and s = i Ω. The
//! rotation moves the equilibrium, so the speed is found by iteration; its derivative follows from lᵀ K(x, Ω) r = 0:
//!
//! ```text
//! dΩ = −lᵀ dK_x r / (lᵀ K_Ω r)
//! ```
//!
//! with the changes of the equilibrium by x and by Ω. A round shaft has two such motions, in two planes. Both keep one speed
//! if their matrix of derivatives is a multiple of the unit matrix; else the speed has no derivative.

use super::contracted::{Between, contracted};
use super::eigenpairs::{Cluster, cluster, groups};
use super::equations::State;
use super::krylov::lowest;
use super::pencil::{At, Matrices};
use super::rest::{FLOOR, FREE};
use super::turning::Turning;
use super::unresisted::unresisted;
use super::{Held, KnownStarts, Sought, in_scalar, with_solution};
use crate::math::{Complex64, Dual, Parameters, Scalar};
use crate::model::Model;
use crate::system::failure::AssemblyFailure;
use crate::system::numbering::Numbering;
use nalgebra::DMatrix;

const ITERATIONS: usize = 40;
/// The inertia of a motion without stiffness, relative to that at the speed; squares of speeds are larger by the second factor.
const LEAST: f64 = 1e-11;
const ABOVE: f64 = 1e4;
/// Speeds that are found with less round-off, relative to the speed at which N is, and to the lowest one.
const LARGEST: f64 = 1e6;
/// Number of speeds that are known.
const KEPT: usize = 8;
/// Relative change of a speed by which it is found.
const CLOSE: f64 = 1e-13;
/// The same where changes do not become smaller.
const STAGNANT: f64 = 1e-11;
/// A rate counts as i Ω if its real part is below this part of it.
const IMAGINARY: f64 = 1e-7;
/// Part of the derivatives of a pair by which their matrix may differ from a multiple of the unit matrix.
const ALIKE: f64 = 1e-8;
/// A relative change of the speed below this part of the least of a parameter is round-off.
const ROUND_OFF: f64 = 1e-11;

/// A critical speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalSpeed<S> {
    /// Ω \[rad/s\].
    pub speed: S,
    /// Whether a change of the design divides it into several, so that it has no derivative.
    pub divides: bool,
}

/// A model without spin of point masses, its numbering, and the starts that are known.
pub(super) type Machine<'a, S> = (&'a Model<S>, &'a Numbering, &'a KnownStarts);

fn none<T>(why: String) -> Result<T, AssemblyFailure> {
    Err(AssemblyFailure::NoModes { why })
}

/// The critical speed of this number, counted from 1.
///
/// # Errors
/// No equilibrium, or fewer speeds.
pub(super) fn critical_speed<S: Scalar>(
    (model, numbering, known): Machine<S>,
    turning: &Turning<S>,
    number: usize,
) -> Result<CriticalSpeed<S>, AssemblyFailure> {
    let mut numbers = vec![number as f64];
    let mut noted = |x: S| {
        numbers.push(x.re());
        x.re()
    };
    let real = model.map(&mut noted);
    // The speed in the file does not matter.
    let axis = turning.at_speed(S::zero()).map(&mut noted);
    let (speed, own) = match known.critical(&numbers) {
        Some(known) => known,
        None => {
            let own = found((&real, numbering, known), &axis, number)?;
            known.keep_critical(numbers, &own);
            own
        }
    };
    let mut out = CriticalSpeed {
        speed: S::from(speed),
        divides: false,
    };
    if !S::INFINITESIMAL {
        return Ok(out);
    }
    let machine = (model, numbering, known);
    let by_design = slopes(machine, &turning.at_speed(S::from(speed)), &own)?;
    let dual = real.map(&mut |x| Dual::new(x, 0.0));
    let axis = axis.map(&mut |x| Dual::new(x, 0.0));
    let moved = axis.at_speed(Dual::new(speed, 1.0));
    let by_speed = slopes((&dual, numbering, known), &moved, &own)?;
    let Some(inverse) = by_speed.try_inverse() else {
        return none("a critical speed does not depend on the speed".into());
    };
    let changes = -(inverse * by_design);
    let count = own.values.len();
    let mean = changes.trace() / Complex64::new(count as f64, 0.0);
    let rest = &changes - DMatrix::identity(count, count) * mean;
    let least = ROUND_OFF * speed * least_change(model, turning);
    out.divides = rest.norm() > (ALIKE * changes.norm()).max(least);
    out.speed += S::of_infinitesimal(mean.re);
    Ok(out)
}

/// The least relative infinitesimal part of the parameters that have one. The largest may be that of the round-off of zero.
fn least_change<S: Scalar>(model: &Model<S>, turning: &Turning<S>) -> f64 {
    let mut least = f64::INFINITY;
    let mut look = |x: S| {
        let change = (x.infinitesimal() / x.re()).abs();
        if change > 0.0 {
            least = least.min(change);
        }
        x.re()
    };
    model.map(&mut look);
    turning.at_speed(S::zero()).map(&mut look);
    if least.is_finite() { least } else { 0.0 }
}

/// A speed, and the motions that it excites.
pub(super) type Excited = (f64, Cluster);

/// The speed of this number.
fn found(
    machine: Machine<f64>,
    axis: &Turning<f64>,
    number: usize,
) -> Result<Excited, AssemblyFailure> {
    let from_soft = found_from(machine, axis, (number, true));
    from_soft.or_else(|why| found_from(machine, axis, (number, false)).map_err(|_| why))
}

/// The same from the softest vibration, or from that of the rate of the machine.
fn found_from(
    machine: Machine<f64>,
    axis: &Turning<f64>,
    (number, soft): (usize, bool),
) -> Result<Excited, AssemblyFailure> {
    let mut at = 0.0;
    let mut before: Option<(f64, f64)> = None;
    let mut seen = Seen {
        soft,
        ..Seen::default()
    };
    for _ in 0..ITERATIONS {
        let (next, own) = at_equilibrium(machine, axis, (at, number), &mut seen)?;
        let off = next - at;
        let stagnant = before.is_some_and(|(_, last)| off.abs() > 0.5 * last.abs());
        if off.abs() <= CLOSE * next || stagnant && off.abs() <= STAGNANT * next {
            return Ok((next, own));
        }
        // Secants, from the second speed on.
        let secant = match before {
            Some((last, off_last)) if at > 0.0 && off != off_last => {
                at - off * (at - last) / (off - off_last)
            }
            _ => next,
        };
        before = Some((at, off));
        at = if secant > 0.5 * next && secant < 2.0 * next {
            secant
        } else {
            next
        };
    }
    none(format!("critical speed {number} does not converge"))
}

/// What the search at standstill leaves to those at speed.
#[derive(Default)]
struct Seen {
    /// Whether it begins at the softest vibration.
    soft: bool,
    /// A speed at which N is found with least round-off.
    firm: f64,
    /// The critical speeds below the wanted one, which a search near it may leave out.
    below: Vec<f64>,
}

/// The critical speed of this number if positions and reactions stay as they are at a speed.
fn at_equilibrium(
    (model, numbering, known): Machine<f64>,
    axis: &Turning<f64>,
    (speed, number): (f64, usize),
    seen: &mut Seen,
) -> Result<Excited, AssemblyFailure> {
    let turning = axis.at_speed(speed);
    let of = (model, numbering, Sought::Rest);
    with_solution(of, Some(&turning), known, |_, solver, found| {
        let layout = solver.layout;
        // All with the pattern of rotation.
        let of = |speed: f64| {
            let turning = axis.at_speed(speed);
            Matrices::new(At::rest(layout, solver.model, found, Some(&turning)), false)
        };
        let mut matrices = of(0.0);
        let still = matrices.stiffness.values.clone();
        if speed == 0.0 {
            seen.firm = found.rate.sqrt();
        }
        // A speed of the size of the vibrations: that of 1 rad/s would leave N with the round-off of K.
        let scale = speed.max(seen.firm);
        let [forward, backward] = [scale, -scale].map(|speed| of(speed).stiffness.values);
        let parts = forward.iter().zip(&backward);
        let turned = parts.zip(&still);
        let turned: Vec<f64> = turned
            .map(|((a, b), k)| (k - 0.5 * (a + b)) / (scale * scale))
            .collect();
        let allowed = At::rest(layout, solver.model, found, None).freedom();
        let mut rate = found.rate;
        let (free, unresisted) = loop {
            // Motions without stiffness at any speed, such as a free spin, have some inertia then.
            let least = match speed > 0.0 {
                true => LEAST * speed * speed,
                false => FLOOR * rate,
            };
            let inertia = matrices.mass.values.iter();
            let entries = still.iter().zip(inertia).map(|(k, m)| k + least * m);
            matrices.stiffness.values = entries.collect();
            let free = (FREE * rate).max(ABOVE * least);
            let unresisted = unresisted(&matrices, &turned, (rate, free, least), allowed)?;
            match unresisted.softest {
                // The rate is that of a light part. A heavy one on it vibrates far more slowly.
                Some(softest) if seen.soft && speed == 0.0 && softest < rate => rate = softest,
                _ => break (free, unresisted),
            }
        };
        let allowed = allowed - unresisted.motions.len();
        matrices.left_out = unresisted.motions;
        matrices.mass.values = turned;
        // A motion along the axis has no part in N but its round-off, with a speed above these.
        let scales = (rate.sqrt(), free.sqrt()..LARGEST * scale);
        let hidden = seen.below.iter().filter(|&&own| own <= free.sqrt());
        let hidden = hidden.count();
        let number = number - hidden;
        let mut count = 2 * number + 2;
        loop {
            let own = lowest(&matrices, scales.clone(), (count, allowed))?;
            let mut speeds: Vec<Complex64> = (own.values.iter().copied())
                .filter(|s| s.re.abs() <= IMAGINARY * s.norm())
                .collect();
            let highest = LARGEST * speeds.first().map_or(0.0, |s| s.norm());
            speeds.retain(|s| s.norm() < highest);
            let all = groups(&speeds);
            // The last cluster may not be whole.
            let there = if own.all {
                all.len()
            } else {
                all.len().saturating_sub(1)
            };
            if there >= number {
                if speed == 0.0 && seen.soft {
                    let below = all[..number - 1].iter();
                    seen.below = below.map(|own| own[0].im).collect();
                }
                let own = cluster(&matrices, &all[number - 1])?;
                let mean = own.values.iter().map(|s| s.im).sum::<f64>() / own.values.len() as f64;
                return Ok((mean, own));
            }
            if own.all {
                let sought = format!("critical speed {} is not found", number + hidden);
                let about = format!("about rest at {speed:.4} rad/s");
                return none(match there + hidden {
                    0 => format!("{sought}: {about} there is none"),
                    all => format!("{sought}: {about} there are {all}"),
                });
            }
            count *= 2;
        }
    })
}

/// The matrix of lᵀ dK r of the motions at a critical speed, K with the rows of constraints.
fn slopes<S: Scalar>(
    (model, numbering, known): Machine<S>,
    turning: &Turning<S>,
    own: &Cluster,
) -> Result<DMatrix<Complex64>, AssemblyFailure> {
    let of = (model, numbering, Sought::Rest);
    with_solution(of, Some(turning), known, |given, solver, found| {
        // At this speed nothing holds the machine against an unbalance, along the motions that it excites.
        let held = Held::ButForFree;
        let state: State<S> = in_scalar(model, given, (solver, found), held)?;
        let back = turning.at_speed(-turning.speed);
        let ways = [turning, &back];
        let sums =
            ways.map(|way| contractions(At::rest(solver.layout, model, &state, Some(way)), own));
        let count = own.values.len();
        let entry = |i: usize, j: usize| {
            let k = i * count + j;
            (sums[0][k] + sums[1][k]) * 0.5
        };
        Ok(DMatrix::from_fn(count, count, entry))
    })
}

/// lᵀ dK r by left and right vector.
fn contractions<S: Scalar>(at: At<S>, own: &Cluster) -> Vec<Complex64> {
    let (zero, one) = (Complex64::new(0.0, 0.0), Complex64::new(1.0, 0.0));
    let lefts = own.left.iter();
    let pairs: Vec<Between> = lefts
        .flat_map(|left| {
            own.right.iter().map(move |right| Between {
                left,
                right,
                factors: [one, zero, zero],
            })
        })
        .collect();
    let sums = contracted(at, &pairs);
    let one = |[re, im]: [S; 2]| Complex64::new(re.infinitesimal(), im.infinitesimal());
    sums.into_iter().map(one).collect()
}

impl KnownStarts {
    fn critical(&self, numbers: &[f64]) -> Option<Excited> {
        let known = self.0.lock().ok()?;
        let mut all = known.critical.iter();
        all.find(|(own, _)| own == numbers)
            .map(|(_, own)| own.clone())
    }

    fn keep_critical(&self, numbers: Vec<f64>, own: &Excited) {
        if let Ok(mut known) = self.0.lock() {
            if known.critical.len() == KEPT {
                known.critical.remove(0);
            }
            known.critical.push((numbers, own.clone()));
        }
    }
}
