//! Natural frequencies of a machine about its rest, without damping: motions y with
//!
//! ```text
//! K y + Gᵀ μ = ω² M y,     G y = 0,     K = −∂f/∂q + ∂(Gᵀ λ)/∂q
//! ```
//!
//! K is symmetric if the loads have a potential; else see [`super::damped`]. If it is so but for motions that the joints do not allow,
//! the multipliers of Kᵀ are others than μ. The largest eigenvalues 1 / (ω² + σ) of [K + σ M̃, Gᵀ; G, 0]⁻¹ M by
//! Lanczos, then Rayleigh and Ritz with K itself in their space. With yᵀ M y = 1 an eigenvalue has the derivative
//!
//! ```text
//! dω² = yᵀ (dK − ω² dM) y + (μ + μ_L)ᵀ dG y,     Kᵀ y + Gᵀ μ_L = ω² M y,
//! ```
//!
//! along the change of rest, so it is exact to first order where y and μ stay.

use super::contracted::{Between, contracted};
use super::equations::{Layout, State};
use super::matrix::Factors;
use super::pencil::At;
use super::rest::{FLOOR, Stability};
use super::{KnownStarts, Solver};
use crate::math::slices::{add_scaled, any_vector, dot};
use crate::math::{Complex64, Scalar};
use crate::structures::modes::{
    Basis, MOST_MODES, NEGLIGIBLE, Operator, REPEATED, dense_pencil, largest,
};
use crate::system::bodies::BodyMotion;
use crate::system::failure::AssemblyFailure;
use nalgebra::DMatrix;

/// Modes beyond the requested ones, whose space improves these.
const SPARE: usize = 3;
/// Part of the stiffness that may be asymmetric by round-off.
const ASYMMETRIC: f64 = 1e-7;
/// The difference of left and right shapes with yᵀ M y = 1 that is round-off.
const DIFFERENT: f64 = 1e-9;
/// Relative distance of eigenvalues that are equal.
const SAME: f64 = 1e-9;

/// σ is raised to that of the lowest mode if it is below this part of it.
const SMALL_SHIFT: f64 = 1e-2;
/// Where nothing is free, σ is lowered if it is this number of times that of the highest mode, or by the second factor if no mode
/// converges, down to a part of the least one of rest.
const LARGE_SHIFT: f64 = 1e2;
const LOWER: f64 = 1e-3;
const LEAST_SHIFT: f64 = 1e-10;

/// Steps that refine modes, and the largest change of one with yᵀ M y = 1. Where a larger one is left, the space lacks parts of
/// the mode.
const REFINEMENTS: usize = 2;
const REFINED: f64 = 1e-6;
/// Part of ω² that round-off of the stiffest motions may be after these.
const HIDDEN: f64 = 1e-6;
const ROUND_OFF: &str =
    "round-off of the stiffest motions hides the lowest modes, as of plates that are very thin";

/// First number of modes of an aggregate.
const FIRST: usize = 6;

/// The modes that functions need.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WantedModes {
    /// So many of the lowest.
    pub count: usize,
    /// So many more, if there are, among which followed modes are sought.
    pub beyond: usize,
    /// All up to ρ (f − f_1) = 38, beyond which their weights are round-off; the smallest ρ \[s\].
    pub rho: Option<f64>,
    /// So many with damping.
    pub damped: usize,
    /// So many critical speeds.
    pub critical: usize,
}

impl WantedModes {
    /// Whether no undamped ones are wanted.
    pub(super) fn none_undamped(&self) -> bool {
        self.count == 0 && self.rho.is_none()
    }

    /// Those of a machine whose vibrations are all damped ones.
    pub(super) fn all_damped(&self) -> Self {
        Self {
            count: self.count.max(self.damped),
            ..*self
        }
    }

    /// The damped ones alone.
    pub(super) fn damped_alone(&self) -> Self {
        Self {
            count: self.damped,
            rho: None,
            ..*self
        }
    }

    pub(super) fn least(&self) -> usize {
        (self.count + self.beyond).max(if self.rho.is_some() { FIRST } else { 0 })
    }

    fn suffice(&self, modes: &[Mode]) -> bool {
        let frequency = |mode: &Mode| mode.rate() / (2.0 * std::f64::consts::PI);
        self.reach(&modes.iter().map(frequency).collect::<Vec<f64>>())
    }

    /// Whether an aggregate needs no frequencies beyond these.
    pub(super) fn reach(&self, frequencies: &[f64]) -> bool {
        let (Some(rho), Some(first), Some(last)) =
            (self.rho, frequencies.first(), frequencies.last())
        else {
            return true;
        };
        let reach = rho * (last - first);
        // A ρ that is still to be chosen is not a number.
        reach.is_nan() || reach > NEGLIGIBLE
    }
}

/// A mode of the machine.
#[derive(Clone, Debug)]
pub(super) struct Mode {
    /// ω² \[1/s²\].
    square: f64,
    /// y and μ, with yᵀ M y = 1.
    pub shape: Vec<f64>,
    /// y and the multipliers of Kᵀ y + Gᵀ μ_L = ω² M y, if they are others. Loads that follow a body may have a potential in all
    /// motions that the joints allow, and none in others.
    left: Option<Vec<f64>>,
    /// Whether another one has the same frequency, so that it has no derivative.
    repeated: bool,
}

impl Mode {
    /// ω \[rad/s\].
    fn rate(&self) -> f64 {
        self.square.max(0.0).sqrt()
    }
}

/// (K + σ M̃)⁻¹ M on the motions that the joints allow.
struct Softened<'a> {
    solver: &'a Solver<'a>,
    motions: &'a [BodyMotion<f64>],
    factors: &'a mut Factors,
}

impl Operator for Softened<'_> {
    fn order(&self) -> usize {
        self.solver.layout.numbering.unknowns()
    }

    fn mass(&self, x: &[f64], y: &mut [f64]) {
        let Solver { layout, model, .. } = self.solver;
        y.copy_from_slice(&layout.mass_product(model, self.motions, x));
    }

    fn solve(&mut self, b: &mut [f64]) {
        let n = self.order();
        for column in b.chunks_exact_mut(n.max(1)) {
            let x = self.solved(column);
            column.copy_from_slice(&x[..n]);
        }
    }
}

impl Softened<'_> {
    /// (K + σ M̃)⁻¹ b on the motions that the joints allow, with the multipliers.
    fn solved(&mut self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        x.resize(self.solver.layout.order(), 0.0);
        self.factors.solve(&mut x);
        x
    }

    /// The eigenvectors of the largest eigenvalues, at least `count` of them if there are as many, without those that are
    /// `known`; and whether there are no others.
    fn largest(&mut self, known: &Basis, count: usize) -> (Vec<Vec<f64>>, bool) {
        let mut known = Basis {
            vectors: known.vectors.clone(),
            products: known.products.clone(),
        };
        let found = largest(self, &known, count, 1);
        let mut least = f64::INFINITY;
        let mut all = found.vectors;
        for y in &all {
            least = least.min(self.quotient(y));
            known.push(self, y.clone(), 0.0);
        }
        // Copies of an eigenvalue beyond the size of a block are missed.
        for seed in 2.. {
            let more = largest(self, &known, 1, seed).vectors.pop();
            let Some(y) = more.filter(|_| found.exhausted || all.len() >= count) else {
                break;
            };
            if !found.exhausted && self.quotient(&y) < least * (1.0 - SAME) {
                break;
            }
            known.push(self, y.clone(), 0.0);
            all.push(y);
        }
        (all, found.exhausted)
    }

    /// The Rayleigh quotient of (K + σ M̃)⁻¹ M.
    fn quotient(&mut self, y: &[f64]) -> f64 {
        let mut heavy = vec![0.0; y.len()];
        self.mass(y, &mut heavy);
        let mut softened = heavy.clone();
        self.solve(&mut softened);
        dot(&heavy, &softened) / dot(&heavy, y)
    }
}

/// Why modes about a rest of this stability are refused.
pub(super) fn without_modes(stability: &Stability) -> Option<&'static str> {
    match stability {
        Stability {
            growth: Some(_), ..
        } => Some("it is not stable"),
        Stability {
            hides_bending: true,
            ..
        } => Some(ROUND_OFF),
        _ => None,
    }
}

impl Solver<'_> {
    /// The lowest and the highest rate ω \[rad/s\] of the modes that are wanted; `None` if they are not found, or beside free
    /// motions.
    ///
    /// # Errors
    /// Round-off of the stiffest motions hides them.
    pub(super) fn reach_of_modes(
        &self,
        found: &State<f64>,
        wanted: &WantedModes,
    ) -> Result<Option<[f64; 2]>, AssemblyFailure> {
        let free = self.with_factors(found, |factors| self.free_motions(factors, found))??;
        if !free.is_empty() {
            return Ok(None);
        }
        let modes = match self.known.modes(&self.numbers) {
            Some(modes) => modes,
            None => {
                match self.with_factors(found, |factors| self.modes(factors, found, wanted))? {
                    Err(AssemblyFailure::NoModes { why }) if why != ROUND_OFF => None,
                    modes => modes?,
                }
            }
        };
        let ends = modes.as_ref().map(|own| [own.first(), own.last()]);
        Ok(match ends {
            Some([Some(first), Some(last)]) => Some([first.rate(), last.rate()]),
            _ => None,
        })
    }

    /// The lowest modes at a solution that are wanted, with its factors; `None` if loads have no potential, or σ hides modes.
    /// Free motions do not count.
    ///
    /// # Errors
    /// Rest is not stable, or there are fewer modes.
    pub(super) fn modes(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
        wanted: &WantedModes,
    ) -> Result<Option<Vec<Mode>>, AssemblyFailure> {
        let motions = self.layout.at_rest(&found.q);
        let mut softened = Softened {
            solver: self,
            motions: &motions,
            factors,
        };
        if let Some(why) = without_modes(&self.stability(softened.factors, found)?) {
            return Err(AssemblyFailure::NoModes { why: why.into() });
        }
        let least = self.least_shift(found);
        let mut shift = least;
        let out = self.search_modes(&mut softened, found, wanted, &mut shift);
        // Kept factors are the same as new ones.
        if shift != least {
            self.factorise_at(softened.factors, found)?;
        }
        out
    }

    /// The same by factors with σ = `shift`, which it moves.
    fn search_modes(
        &self,
        softened: &mut Softened,
        found: &State<f64>,
        wanted: &WantedModes,
        shift: &mut f64,
    ) -> Result<Option<Vec<Mode>>, AssemblyFailure> {
        let none = |why: String| Err(AssemblyFailure::NoModes { why });
        let mut free = Basis::default();
        for [mut y, _] in self.free_motions(softened.factors, found)? {
            free.orthogonalise(&mut y);
            free.push(softened, y, 0.0);
        }
        // Beyond the motions that the joints allow there is round-off alone.
        let rows = self.layout.numbering.constraints() - self.layout.left_out.numbers().count();
        let allowed = (softened.order().saturating_sub(rows)).saturating_sub(free.len());
        let mut count = wanted.least();
        let mut out = loop {
            let (mut space, mut all) = match allowed {
                0 => (Vec::new(), true),
                _ => softened.largest(&free, (count + SPARE).min(allowed)),
            };
            all |= space.len() >= allowed;
            space.truncate(allowed);
            let there = space.len();
            if there < if all { wanted.count.max(1) } else { count } {
                // Lanczos converges for symmetric matrices.
                if !all && !self.is_symmetric(softened, found) {
                    return Ok(None);
                }
                if !all && free.len() == 0 && *shift > LEAST_SHIFT * self.least_shift(found) {
                    *shift *= LOWER;
                    self.factorise_with(softened.factors, found, *shift)?;
                    continue;
                }
                return none(match all {
                    true => format!(
                        "mode {} is asked for, and there are {there}",
                        wanted.count.max(1)
                    ),
                    false => format!("only {there} modes converge"),
                });
            }
            let Some(mut modes) = self.ritz(softened, found, space)? else {
                return Ok(None);
            };
            // A large σ hides what the space lacks.
            let highest = modes.last().map_or(0.0, |own| own.square);
            let lower = highest.max(LEAST_SHIFT * self.least_shift(found));
            if free.len() == 0 && *shift > LARGE_SHIFT * lower {
                *shift = lower;
                self.factorise_with(softened.factors, found, *shift)?;
                continue;
            }
            let Some(good) = self.refine(softened, found, (&free, &mut modes)) else {
                return none(ROUND_OFF.into());
            };
            modes.truncate(count);
            // Solutions have round-off along free motions, which a small σ magnifies.
            let lowest = modes.first().map_or(0.0, |own| own.square);
            if free.len() > 0 && *shift < SMALL_SHIFT * FLOOR * lowest {
                *shift = FLOOR * lowest;
                self.factorise_with(softened.factors, found, *shift)?;
                continue;
            }
            // σ M̃ hides modes of light bodies in large scenes. The search for damped ones is slower, and needs no M̃.
            if good < modes.len() {
                return Ok(None);
            }
            if all || wanted.suffice(&modes) {
                break modes;
            }
            if count >= MOST_MODES {
                return none(format!(
                    "more than {MOST_MODES} modes are within reach of ρ; a larger one needs fewer"
                ));
            }
            count = (2 * count).min(MOST_MODES);
        };
        let symmetric = (self.model.loads.iter()).all(|load| load.kind.has_potential())
            || self.find_left(softened, *shift, (&free, &mut out));
        Ok(symmetric.then_some(out))
    }

    /// Finds the left multipliers of modes, by the factors of K + σ M̃; false if left shapes differ from the right ones.
    fn find_left(
        &self,
        softened: &mut Softened,
        shift: f64,
        (free, modes): (&Basis, &mut [Mode]),
    ) -> bool {
        let (layout, model) = (self.layout, self.model);
        let n = layout.numbering.unknowns();
        modes.iter_mut().all(|mode| {
            let y = &mode.shape[..n];
            let heavy = layout.mass_product(model, softened.motions, y);
            let mut left = self.metric_product(softened.motions, y);
            left.iter_mut().for_each(|x| *x *= shift);
            add_scaled(&mut left, mode.square, &heavy);
            left.resize(layout.order(), 0.0);
            softened.factors.solve_transposed(&mut left);
            let mut apart: Vec<f64> = left.iter().zip(y).map(|(l, y)| l - y).collect();
            free.orthogonalise(&mut apart);
            let moved = layout.mass_product(model, softened.motions, &apart);
            let alike = dot(&moved, &apart) <= DIFFERENT * DIFFERENT;
            left[..n].copy_from_slice(y);
            mode.left = Some(left);
            alike
        })
    }

    /// Whether K is symmetric, by two motions of low frequencies.
    fn is_symmetric(&self, softened: &mut Softened, found: &State<f64>) -> bool {
        let along = self.layout.along(self.model, self.given, found);
        let n = self.layout.numbering.unknowns();
        let [a, b] = [2.3, 3.7].map(|seed| {
            let mut y = any_vector(n, seed);
            y.resize(self.layout.order(), 0.0);
            softened.factors.solve(&mut y);
            let stiff = along.product(&y);
            [y, stiff]
        });
        let work = |x: &[Vec<f64>; 2], y: &[Vec<f64>; 2]| dot(&x[0][..n], &y[1][..n]);
        let size = (work(&a, &a) * work(&b, &b)).abs().sqrt();
        (work(&a, &b) - work(&b, &a)).abs() <= ASYMMETRIC * size
    }

    /// The modes in the space of some motions; `None` if K is not symmetric.
    fn ritz(
        &self,
        softened: &mut Softened,
        found: &State<f64>,
        space: Vec<Vec<f64>>,
    ) -> Result<Option<Vec<Mode>>, AssemblyFailure> {
        let (layout, model) = (self.layout, self.model);
        let n = layout.numbering.unknowns();
        let along = layout.along(model, self.given, found);
        // Shapes with their multipliers, K y + Gᵀ μ and M y.
        let columns: Vec<[Vec<f64>; 3]> = (space.into_iter())
            .map(|y| {
                let shape = softened.solved(&layout.mass_product(model, softened.motions, &y));
                let stiff = along.product(&shape)[..n].to_vec();
                let heavy = layout.mass_product(model, softened.motions, &shape[..n]);
                let size = dot(&shape[..n], &heavy).sqrt();
                [shape, stiff, heavy].map(|x| x.into_iter().map(|x| x / size).collect())
            })
            .collect();
        let there = columns.len();
        // Gᵀ μ does no work in motions with G y = 0.
        let gram = |which: usize| {
            let product = |i: usize, j: usize| dot(&columns[i][0][..n], &columns[j][which]);
            DMatrix::from_fn(there, there, product)
        };
        let (stiffness, mass) = (gram(1), gram(2));
        if (&stiffness - stiffness.transpose()).norm() > ASYMMETRIC * stiffness.norm() {
            return Ok(None);
        }
        let (squares, parts) = dense_pencil(&stiffness, mass).ok_or(AssemblyFailure::Singular)?;
        let near = |a: usize, b: usize| match (squares.get(a), squares.get(b)) {
            (Some(a), Some(b)) => (b - a).abs() <= REPEATED * b.abs(),
            _ => false,
        };
        let one = |(k, &square): (usize, &f64)| {
            let mut shape = vec![0.0; layout.order()];
            for (own, part) in columns.iter().zip(parts.column(k).iter()) {
                add_scaled(&mut shape, *part, &own[0]);
            }
            Mode {
                square,
                shape,
                left: None,
                repeated: near(k, k + 1) || k > 0 && near(k - 1, k),
            }
        };
        Ok(Some(squares.iter().enumerate().map(one).collect()))
    }

    /// Refines modes by their residuals r = K y + Gᵀ μ − ω² M y. Lanczos and Ritz leave round-off of the extreme eigenvalues
    /// in all vectors. The error along another mode is y_jᵀ r / (ω_j² − ω²); the rest of it falls by (K + σ M̃)⁻¹ r.
    /// What it adds along free motions is round-off, and a large change is no refinement. Returns how many of the first modes
    /// need no larger change; `None` if round-off of the stiffest motions is more than the stiffness of a mode.
    fn refine(
        &self,
        softened: &mut Softened,
        found: &State<f64>,
        (free, modes): (&Basis, &mut [Mode]),
    ) -> Option<usize> {
        let (layout, model) = (self.layout, self.model);
        let n = layout.numbering.unknowns();
        let along = layout.along(model, self.given, found);
        let mut good = modes.len();
        for refinement in 1..=REFINEMENTS {
            let (mut heavy, mut rests) = (Vec::new(), Vec::new());
            for mode in &mut *modes {
                let own = layout.mass_product(model, softened.motions, &mode.shape[..n]);
                let mut rest = along.product(&mode.shape);
                mode.square = dot(&mode.shape[..n], &rest[..n]) / dot(&mode.shape[..n], &own);
                add_scaled(&mut rest[..n], -mode.square, &own);
                heavy.push(own);
                rests.push(rest);
            }
            let known = modes.to_vec();
            for (k, (mode, rest)) in modes.iter_mut().zip(rests).enumerate() {
                let mut change = rest.clone();
                softened.factors.solve(&mut change);
                for (other, heavy) in known.iter().zip(&heavy) {
                    let apart = other.square - mode.square;
                    let along = match apart.abs() > REPEATED * mode.square.abs() {
                        true => dot(&other.shape[..n], &rest[..n]) / apart,
                        false => 0.0,
                    };
                    let there = dot(heavy, &change[..n]);
                    add_scaled(&mut change, along - there, &other.shape);
                }
                free.orthogonalise(&mut change[..n]);
                let moved = layout.mass_product(model, softened.motions, &change[..n]);
                let size = dot(&moved, &change[..n]).max(0.0).sqrt();
                if size.is_nan() || size > REFINED {
                    good = good.min(k);
                    continue;
                }
                // What the residual still makes of ω².
                let error = dot(&rest[..n], &change[..n]).abs();
                let is_last = refinement == REFINEMENTS && free.len() == 0;
                if is_last && error > HIDDEN * mode.square.abs() {
                    return None;
                }
                add_scaled(&mut mode.shape, -1.0, &change);
                let heavy = layout.mass_product(model, softened.motions, &mode.shape[..n]);
                let size = dot(&mode.shape[..n], &heavy).sqrt();
                mode.shape.iter_mut().for_each(|x| *x /= size);
            }
        }
        Some(good)
    }
}

/// A vibration about rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration<S> {
    /// Natural frequency \[Hz\].
    pub frequency: S,
    /// Whether another one has the same, so that it has no derivative of its own; sums over both have one.
    pub repeated: bool,
}

/// The vibrations of modes in any scalar, at a solution in it, exact to first order.
pub(super) fn vibrations<S: Scalar>(
    layout: &Layout,
    at: At<S>,
    modes: &[Mode],
) -> Vec<Vibration<S>> {
    let mut changes = vec![0.0; modes.len()];
    if S::INFINITESIMAL {
        let real = |x: f64| Complex64::new(x, 0.0);
        let [y, _, _, lambda, ..] = layout.groups();
        let complex = |shape: &[f64]| -> Vec<Complex64> {
            let both = shape[y.clone()].iter().chain(&shape[lambda.clone()]);
            both.map(|&x| real(x)).collect()
        };
        let sides = |mode: &Mode| {
            let left = mode.left.as_ref().unwrap_or(&mode.shape);
            [left, &mode.shape].map(|own| complex(own))
        };
        let shapes: Vec<_> = modes.iter().map(sides).collect();
        let pairs = shapes
            .iter()
            .zip(modes)
            .map(|([left, right], mode)| Between {
                left,
                right,
                factors: [real(1.0), real(0.0), real(-mode.square)],
            });
        let pairs: Vec<Between> = pairs.collect();
        // The real parts are zero but for what is not converged.
        let sums = contracted(at, &pairs).into_iter();
        changes = sums.map(|[re, _]| re.infinitesimal()).collect();
    }
    let one = |(mode, change): (&Mode, f64)| {
        let square = S::from(mode.square) + S::of_infinitesimal(change);
        Vibration {
            frequency: square.sqrt() / S::from(2.0 * std::f64::consts::PI),
            repeated: mode.repeated,
        }
    };
    modes.iter().zip(changes).map(one).collect()
}

impl KnownStarts {
    /// The known modes of these numbers. One document always wants the same.
    pub(super) fn modes(&self, numbers: &[f64]) -> Option<Option<Vec<Mode>>> {
        let known = self.0.lock().ok()?;
        let (own, modes) = known.modes.as_ref()?;
        (own == numbers).then(|| modes.clone())
    }

    pub(super) fn keep_modes(&self, numbers: &[f64], modes: &Option<Vec<Mode>>) {
        if let Ok(mut known) = self.0.lock() {
            known.modes = Some((numbers.to_vec(), modes.clone()));
        }
    }
}
