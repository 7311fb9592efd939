//! Rest of a whole machine: positions q and reactions λ with
//!
//! ```text
//! −f(q, 0) + G(q)ᵀ λ = 0,     Φ(q) = 0
//! ```
//!
//! by a descent ([`super::descent`]), its stability, and its derivative.

use super::equations::State;
use super::matrix::{Factors, RigidMetric};
use super::pencil::{At, Matrices};
use super::ritz::ritz_vectors;
use super::{KnownStarts, Solver, Sought, at_solution};
use crate::math::slices::{add_scaled, dot};
use crate::model::{Model, Role};
use crate::system::bodies::BodyMotion;
use crate::system::failure::AssemblyFailure;
use crate::system::flexible;

/// The smallest σ of factors, relative to the rate of the placement.
pub(super) const FLOOR: f64 = 1e-6;
/// A motion with a smaller stiffness, relative to the rate, is free.
pub(super) const FREE: f64 = 1e-10;
/// A motion deforms bodies if elastic coordinates have this part of the inertia of it.
const DEFORMS: f64 = 1e-2;
/// Round-off of a stiffness, relative to the largest.
const NOISE: f64 = 1e-12;
/// The largest rate of a machine that nothing loads, relative to that.
const UNLOADED: f64 = 1e-4;
/// The least stiffness of a vibration among soft motions, relative to the largest: less is a trace of it in a free one.
const ELASTIC: f64 = 1e-7;
/// So many soft motions are looked at for a rate.
const MANY: usize = 48;
/// A body takes part in a free motion if it moves by this part of the largest.
const MOVES: f64 = 0.05;
/// Inverse iterations of a free motion.
const INVERSE: usize = 4;
/// Largest part of the right side that the derivative of a solution leaves.
const UNSOLVED: f64 = 1e-6;
/// Round-off of forces, relative to the mass of the machine times its rate and its size, and of the stiffness along one motion,
/// relative to the stiffest.
pub(super) const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

/// A free motion of unit length in the metric, and its product with that.
pub(super) type FreeMotion = [Vec<f64>; 2];

/// Whether rest is stable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stability {
    /// The fastest growth \[1/s\] of a motion away from rest without damping, √−λ with K y = λ M̃ y; `None` if none grows.
    pub growth: Option<f64>,
    /// Names of bodies that can move without stiffness: rest is neutral, and they are where they were placed.
    pub free: Vec<String>,
    /// Whether the way from the placement led through positions that are not stable, as of an arch that snaps through.
    pub snapped: bool,
    /// Whether round-off hides motions that are not free: the bending of plates that are very thin has as little of the stiffness of
    /// their stretch.
    pub hides_bending: bool,
}

/// The stability of rest of `model`, whose bodies are placed and undeformed.
///
/// # Errors
/// If there is no rest.
pub fn stability(model: &Model<f64>, known: &KnownStarts) -> Result<Stability, AssemblyFailure> {
    at_solution(model, known, Sought::Rest, |solver, factors, found| {
        let mut out = solver.stability(factors, found)?;
        // The forces of controllers have no potential: the stiffness does not tell what grows.
        if model.is_controlled()
            && let Some(growth) = solver.growth_of_all(found, model.is_settled())?
        {
            out.growth = growth;
        }
        Ok(out)
    })
}

impl Solver<'_> {
    /// The smallest σ \[1/s²\] of factors at a solution; zero of a start.
    pub(super) fn least_shift(&self, found: &State<f64>) -> f64 {
        FLOOR * found.rate
    }

    /// Makes the factors at a solution, with the smallest σ.
    pub(super) fn factorise_at(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
    ) -> Result<(), AssemblyFailure> {
        self.factorise_with(factors, found, self.least_shift(found))
    }

    /// Makes the factors at a solution with a σ.
    pub(super) fn factorise_with(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
        shift: f64,
    ) -> Result<(), AssemblyFailure> {
        let made = factors.make(self.layout, self.model, (found, shift));
        made.map_err(|_| AssemblyFailure::Singular)
    }

    /// The unknowns of the motion that grows fastest from an equilibrium; `None` if it is stable. Makes the factors there.
    pub(super) fn growing(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
    ) -> Result<Option<Vec<f64>>, AssemblyFailure> {
        self.factorise_at(factors, found)?;
        let soft = self.soft_motions(factors, found)?;
        let least = soft.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let growing = least.filter(|(stiffness, _)| *stiffness < -FREE * found.rate);
        Ok(growing.map(|(_, mut along)| {
            along.resize(self.layout.order(), 0.0);
            along
        }))
    }

    /// `change`, if it solves the equations for the right side; else positions do not follow from the numbers of the model.
    ///
    /// # Errors
    /// Bodies that nothing holds against a change of loads.
    pub(super) fn determined(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
        right: &[f64],
        mut change: Vec<f64>,
    ) -> Result<Vec<f64>, AssemblyFailure> {
        let along = self.layout.along(self.model, self.given, found);
        let mut rest = along.product(&change);
        rest.iter_mut().zip(right).for_each(|(r, b)| *r = b - *r);
        let [.., lambda, _, _] = self.layout.groups();
        // Reactions count as the positions that they change by the first shift.
        let of_reactions = 1.0 / (self.mass * found.rate * self.scale);
        let sizes = [rest, right.to_vec()].map(|mut x| {
            factors.solve(&mut x);
            let reactions = x[lambda.clone()].iter();
            let largest = reactions.fold(0.0_f64, |most, x| most.max(x.abs()));
            self.moved(found, &x).max(of_reactions * largest)
        });
        // Round-off of springs without tension, which do not push along free motions.
        let force = self.mass * found.rate * self.scale;
        let pushes = (right[self.layout.groups()[0].clone()].iter())
            .any(|x| x.abs() > ROUND_OFF * force * self.scale.max(1.0));
        if sizes[0] <= UNSOLVED * sizes[1] || !pushes && sizes[0].is_finite() {
            self.keep_as_placed(factors, found, &mut change)?;
            return Ok(change);
        }
        self.not_held(factors, found)?;
        Err(AssemblyFailure::Singular)
    }

    /// Removes free motions from a change: along them the least σ alone leaves round-off.
    pub(super) fn keep_as_placed(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
        change: &mut [f64],
    ) -> Result<(), AssemblyFailure> {
        let n = self.layout.numbering.unknowns();
        for own in self.free_motions(factors, found)? {
            remove(&own, &mut change[..n]);
        }
        Ok(())
    }

    /// Fails by the names of bodies that can move without stiffness, if there are some, with factors there.
    pub(super) fn not_held(
        &self,
        factors: &mut Factors,
        at: &State<f64>,
    ) -> Result<(), AssemblyFailure> {
        let free = self.stability(factors, at)?.free;
        match free.is_empty() {
            true => Ok(()),
            false => Err(AssemblyFailure::NotHeld {
                bodies: free.join(", "),
            }),
        }
    }

    /// The stability of a solution by its stiffness, with its factors.
    pub(super) fn stability(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
    ) -> Result<Stability, AssemblyFailure> {
        let mut out = Stability {
            snapped: found.snapped,
            ..Stability::default()
        };
        for (stiffness, y) in self.soft_motions(factors, found)? {
            if stiffness < -FREE * found.rate {
                let rate = (-stiffness).sqrt();
                out.growth = Some(out.growth.map_or(rate, |other| other.max(rate)));
            } else if stiffness <= FREE * found.rate {
                match self.deforms_shells(found, &y) {
                    true => out.hides_bending = true,
                    false => self.name_moving(&y, &mut out.free),
                }
            }
        }
        Ok(out)
    }

    /// A free motion without its parts along others, which inverse iteration makes smaller by σ / (λ + σ) each time.
    fn purified(
        &self,
        factors: &mut Factors,
        motions: &[BodyMotion<f64>],
        mut y: Vec<f64>,
    ) -> Vec<f64> {
        for _ in 0..INVERSE {
            let mut next = self.metric_product(motions, &y);
            next.resize(self.layout.order(), 0.0);
            factors.solve(&mut next);
            next.truncate(y.len());
            let size = dot(&next, &next).sqrt();
            y = next.into_iter().map(|x| x / size).collect();
        }
        y
    }

    /// The free motions at a solution, orthogonal in the metric, with its factors. They become known.
    pub(super) fn free_motions(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
    ) -> Result<Vec<FreeMotion>, AssemblyFailure> {
        if let Some(known) = self.known.free(&self.numbers) {
            return Ok(known);
        }
        let motions = self.layout.at_rest(&found.q);
        let mut free: Vec<FreeMotion> = Vec::new();
        for (stiffness, y) in self.soft_motions(factors, found)? {
            if stiffness.abs() > FREE * found.rate || self.deforms_shells(found, &y) {
                continue;
            }
            let mut y = self.purified(factors, &motions, y);
            free.iter().for_each(|own| remove(own, &mut y));
            let heavy = self.metric_product(&motions, &y);
            let size = dot(&y, &heavy).sqrt();
            if size > 0.0 {
                free.push([y, heavy].map(|x| x.into_iter().map(|x| x / size).collect()));
            }
        }
        self.known.keep_free(&self.numbers, &free);
        Ok(free)
    }

    /// Whether a motion deforms bodies, in a machine with shells. A free motion does not.
    fn deforms_shells(&self, found: &State<f64>, y: &[f64]) -> bool {
        if !flexible::has_shells(self.model) {
            return false;
        }
        let motions = self.layout.at_rest(&found.q);
        let whole = dot(&self.metric_product(&motions, y), y);
        self.elastic_inertia(&motions, self.layout.expanded(y.to_vec())) > DEFORMS * whole
    }

    /// yᵀ M y of the elastic coordinates of an expanded motion, with the others at zero.
    fn elastic_inertia(&self, motions: &[BodyMotion<f64>], mut y: Vec<f64>) -> f64 {
        for (body, six) in self.model.bodies.iter().zip(y.chunks_exact_mut(6)) {
            if body.role != Role::Elastic {
                six.fill(0.0);
            }
        }
        let elastic = self.layout.compressed(y);
        let heavy = self.layout.mass_product(self.model, motions, &elastic);
        dot(&heavy, &elastic)
    }

    /// A rate \[1/s²\] of a machine that nothing loads, of the size of its softest vibration; `None` if its loads of the rate
    /// `loaded` are more than round-off of its stiffness.
    ///
    /// # Errors
    /// Singular equations.
    pub(super) fn rate_of_stiffness(
        &self,
        factors: &mut Factors,
        (placed, loaded): (&State<f64>, f64),
    ) -> Result<Option<f64>, AssemblyFailure> {
        let matrices = Matrices::new(At::rest(self.layout, self.model, placed, None), false);
        let stiffest = matrices.stiffest();
        if loaded > NOISE * stiffest {
            return Ok(None);
        }
        if stiffest == 0.0 {
            return Ok(Some(1.0));
        }
        let mut at = placed.clone();
        at.rate = stiffest;
        self.factorise_at(factors, &at)?;
        let soft = self.softest_motions(factors, &at, MANY)?;
        // Thin plates have thousands of soft vibrations.
        let vibrations = (soft.iter()).filter(|(rate, _)| *rate > f64::EPSILON * stiffest);
        let largest = match 2 * vibrations.count() < MANY {
            true => UNLOADED,
            false => ELASTIC,
        };
        let rates = soft.into_iter().map(|(rate, _)| rate);
        let elastic = rates.filter(|&rate| rate > ELASTIC * stiffest);
        Ok(Some(elastic.fold(largest * stiffest, f64::min)))
    }

    /// Motions y with K y = λ M̃ y on G y = 0 and their λ, those with λ below the least σ, with the factors of a solution.
    fn soft_motions(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
    ) -> Result<Vec<(f64, Vec<f64>)>, AssemblyFailure> {
        self.softest_motions(factors, found, usize::MAX)
    }

    /// The softest of them, at least `most` if there are as many.
    fn softest_motions(
        &self,
        factors: &mut Factors,
        found: &State<f64>,
        most: usize,
    ) -> Result<Vec<(f64, Vec<f64>)>, AssemblyFailure> {
        let layout = self.layout;
        let n = layout.numbering.unknowns();
        // Beyond the motions that the joints allow there is round-off alone.
        let allowed = At::rest(layout, self.model, found, None).freedom();
        if allowed == 0 {
            return Ok(Vec::new());
        }
        let motions = layout.at_rest(&found.q);
        let weighted = |y: &[f64]| self.metric_product(&motions, y);
        let shift = self.least_shift(found);
        let softened = |y: &[f64]| {
            let mut right = weighted(y);
            right.resize(layout.order(), 0.0);
            factors.solve(&mut right);
            right.truncate(n);
            right
        };
        // 1 / (λ + σ) is negative, or about 1 / σ and more, where λ is not positive.
        let counts = |value: f64, _: f64| value < 0.0 || value * shift > 0.5;
        let soft = ritz_vectors(softened, weighted, (n, allowed.min(most)), counts)
            .ok_or(AssemblyFailure::Singular)?;
        let along = layout.along(self.model, self.given, found);
        let stiffness = |(_, y): (f64, Vec<f64>)| {
            let mut change = y.clone();
            change.resize(layout.order(), 0.0);
            let held = &along.product(&change)[..n];
            (dot(held, &y) / dot(&weighted(&y), &y), y)
        };
        Ok(soft.into_iter().map(stiffness).collect())
    }

    /// Largest change of a position at x, rotations in radians, displacements relative to the length of the scene. Elastic
    /// coordinates are displacements and angles, of nodes and of modes. They count by the mean square of what they move over
    /// the mass of the machine.
    pub(super) fn moved(&self, x: &State<f64>, change: &[f64]) -> f64 {
        // NaN stays.
        let larger = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
        let layout = self.layout;
        let y = layout.expanded(change[layout.groups()[0].clone()].to_vec());
        let mut size = 0.0;
        let all = self.model.bodies.iter().zip(y.chunks_exact(6));
        for (i, (body, six)) in all.enumerate() {
            if body.role != Role::Elastic {
                size = larger(size, layout.moved_of(i, six, self.scale));
            }
        }
        if self.model.flexible.is_empty() {
            return size;
        }
        let elastic = self.elastic_inertia(&layout.at_rest(&x.q), y);
        larger(size, (elastic / self.mass).sqrt() / self.scale)
    }

    /// M̃ y, both for unknowns of velocity.
    pub(super) fn metric_product(&self, motions: &[BodyMotion<f64>], y: &[f64]) -> Vec<f64> {
        let layout = self.layout;
        let metric = RigidMetric::of(self.model);
        let mut out = layout.expanded(layout.mass_product(self.model, motions, y));
        let y = layout.expanded(y.to_vec());
        for (i, body) in self.model.bodies.iter().enumerate() {
            let (o, [mass, inertia]) = (layout.numbering.velocity(i), metric.of_body(body));
            add_scaled(&mut out[o..o + 3], mass - body.mass, &y[o..o + 3]);
            add_scaled(&mut out[o + 3..o + 6], inertia, &y[o + 3..o + 6]);
        }
        layout.compressed(out)
    }

    /// Adds the names of bodies that a motion moves.
    pub(super) fn name_moving(&self, y: &[f64], names: &mut Vec<String>) {
        let layout = self.layout;
        let all = layout.expanded(y.to_vec());
        let size = |i: usize| {
            let six = &all[layout.numbering.velocity(i)..][..6];
            layout.moved_of(i, six, self.scale)
        };
        let bodies = || (0..self.model.bodies.len()).filter(|&i| !self.model.is_internal(i));
        let largest = bodies().map(size).fold(0.0, f64::max);
        for i in bodies().filter(|&i| size(i) > MOVES * largest) {
            let name = &self.model.bodies[i].name;
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
    }
}

/// Removes the part of a vector along a free motion.
pub(super) fn remove([y, with_metric]: &FreeMotion, from: &mut [f64]) {
    let along = dot(with_metric, from);
    add_scaled(from, -along, y);
}
