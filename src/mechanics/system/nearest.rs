//! The consistent positions and velocities nearest to the placement, in any scalar. They are solved
//! in real numbers, and to first order in the infinitesimal part by the implicit function theorem.
//!
//! The equations are those of [`super::initial`],
//!
//! ```text
//! F(q, s; p) = (E_y + Gᵀ s, Φ) = 0,     (M (v − v_g) + Gᵀ σ, G v + Φ_t) = 0.
//! ```
//!
//! Let (q, s) be a real solution for the real parameters. For the parameters p + ε ṗ it changes by
//! −F_(q,s)⁻¹ F(q, s; p + ε ṗ). This takes one solution with the real matrix; the residual is
//! computed in the scalar.

use super::assembly::{add_displacement, displacement_metric};
use super::bodies::{self, BodyMotion};
use super::failure::AssemblyFailure;
use super::flexible;
use super::in_motion::InMotion;
use super::initial::{self, InitialState};
use super::joints;
use super::kkt::{Metric, SaddlePoint};
use super::numbering::Numbering;
use super::placement::guess;
use super::redundant_rows::RedundantRows;
use super::{rank, redundancy};
use crate::math::{Parameters, Scalar};
use crate::model::Model;

/// Positions and velocities of a model's bodies.
#[derive(Clone, Debug)]
pub struct Nearest<S> {
    /// Positions q.
    pub q: Vec<S>,
    /// Velocities v.
    pub v: Vec<S>,
}

/// The consistent positions and velocities nearest to the placement of `model`. Redundant rows are
/// found and left out.
///
/// # Errors
/// [`AssemblyFailure`] names the joint that cannot be closed, or the singular part.
pub fn nearest<S: Scalar>(model: &Model<S>) -> Result<Nearest<S>, AssemblyFailure> {
    let numbering = Numbering::new(model);
    let mut real = model.map(&mut |x| x.re());
    redundancy::leave_out(&mut real);
    let mut placed = Placed::of(&real, &numbering)?;
    let mut solver = FirstOrder {
        model,
        real: &real,
        numbering: &numbering,
        placed: &mut placed,
    };
    let q = solver.positions()?;
    let v = solver.velocities(&q)?;
    Ok(Nearest { q, v })
}

/// The consistent state at a placement.
pub(super) struct Placed {
    state: InitialState<f64>,
    saddle: SaddlePoint<f64>,
    /// Whether `saddle` has the factors for changes of positions.
    factorised: bool,
}

impl Placed {
    /// Of a model whose redundant rows are left out.
    ///
    /// # Errors
    /// As [`nearest`].
    pub(super) fn of(model: &Model<f64>, numbering: &Numbering) -> Result<Self, AssemblyFailure> {
        let mut saddle = SaddlePoint::new(model, numbering);
        Ok(Self {
            state: initial::solve(model, numbering, &mut saddle)?,
            saddle,
            factorised: false,
        })
    }
}

impl std::fmt::Debug for Placed {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "the consistent state {:?}", self.state.q)
    }
}

/// The real part of the solution with the infinitesimal part of the placement.
fn shifted<S: Scalar>(guess: &[S], real: &[f64]) -> Vec<S> {
    let pairs = guess.iter().zip(real);
    pairs.map(|(&guess, &x)| guess + (x - guess.re())).collect()
}

/// Data for the change of a real solution.
pub(super) struct FirstOrder<'a, S> {
    pub model: &'a Model<S>,
    /// Its real part, whose redundant rows are left out, and the consistent state of that.
    pub real: &'a Model<f64>,
    pub numbering: &'a Numbering,
    pub placed: &'a mut Placed,
}

impl<S: Scalar> FirstOrder<'_, S> {
    fn singular(&self) -> AssemblyFailure {
        rank::explain(self.real, &self.placed.state.q)
    }

    fn motions(&self) -> Vec<BodyMotion<f64>> {
        let mut motions = Vec::new();
        let state = &self.placed.state;
        BodyMotion::all(self.numbering, &state.q, &state.v, &mut motions);
        motions
    }

    /// The change of velocities or tangent positions that cancels the residual.
    fn change(&mut self, residual: &[S]) -> Vec<S> {
        let mut change: Vec<f64> = residual.iter().map(|x| -x.infinitesimal()).collect();
        self.placed.saddle.solve(&mut change);
        change.truncate(self.numbering.velocities());
        change.into_iter().map(S::of_infinitesimal).collect()
    }

    /// Positions q.
    pub(super) fn positions(&mut self) -> Result<Vec<S>, AssemblyFailure> {
        let (model, numbering) = (self.model, self.numbering);
        let mut q = shifted(&guess(model).0, &self.placed.state.q);
        if !S::INFINITESIMAL {
            return Ok(q);
        }
        let mut increment = vec![S::zero(); q.len()];
        bodies::normalise(numbering, &mut q, &mut increment);
        let still = vec![S::zero(); numbering.velocities()];
        let (mut motions, mut gradients) = (Vec::new(), Vec::new());
        BodyMotion::all(numbering, &q, &still, &mut motions);
        let at = InMotion::new(model, numbering, &motions, S::zero());
        joints::gradients(&at, &mut gradients);
        let mut residual = still;
        add_displacement(model, numbering, &q, &mut residual);
        let s: Vec<S> = self.placed.state.s.iter().map(|&s| s.into()).collect();
        joints::add_reactions(model, numbering, &gradients, &s, &mut residual);
        let mut values = vec![S::zero(); numbering.constraints()];
        joints::values(&at, &mut values);
        residual.extend(values);
        if residual.iter().all(|x| x.infinitesimal() == 0.0) {
            return Ok(q);
        }
        if !self.placed.factorised {
            let here = self.motions();
            let Placed { state, saddle, .. } = &mut *self.placed;
            let metric = displacement_metric(self.real, numbering, &state.q);
            saddle.leave_out(&RedundantRows::of(self.real, numbering));
            let at = InMotion::new(self.real, numbering, &here, 0.0);
            let made = saddle.factorise(&at, &state.s, metric, Metric::Displacement);
            made.map_err(|_| self.singular())?;
            self.placed.factorised = true;
        }
        let change = self.change(&residual);
        bodies::advance(numbering, &mut q, &mut increment, &change);
        Ok(q)
    }

    /// Velocities v at positions q.
    fn velocities(&mut self, q: &[S]) -> Result<Vec<S>, AssemblyFailure> {
        let (model, numbering) = (self.model, self.numbering);
        let (_, given) = guess(model);
        let mut v = shifted(&given, &self.placed.state.v);
        if !S::INFINITESIMAL {
            return Ok(v);
        }
        let (mut motions, mut gradients) = (Vec::new(), Vec::new());
        BodyMotion::all(numbering, q, &v, &mut motions);
        let at = InMotion::new(model, numbering, &motions, S::zero());
        joints::gradients(&at, &mut gradients);
        let by: Vec<S> = v.iter().zip(&given).map(|(&v, &g)| v - g).collect();
        let mut residual = vec![S::zero(); numbering.velocities()];
        bodies::mass_product(model, numbering, &by, &mut residual);
        flexible::add_mass_product(model, numbering, &motions, &by, &mut residual);
        let sigma = self.placed.state.sigma.iter();
        let sigma: Vec<S> = sigma.map(|&s| s.into()).collect();
        joints::add_reactions(model, numbering, &gradients, &sigma, &mut residual);
        let mut rates = vec![S::zero(); numbering.constraints()];
        joints::rates(&at, &mut rates);
        residual.extend(rates);

        let here = self.motions();
        let zeros = vec![0.0; numbering.constraints()];
        let Placed {
            state,
            saddle,
            factorised,
        } = &mut *self.placed;
        *factorised = false;
        saddle.leave_out(&state.left_out);
        let metric = initial::mass(self.real);
        let at = InMotion::new(self.real, numbering, &here, 0.0);
        let made = saddle.factorise(&at, &zeros, metric, Metric::Mass);
        made.map_err(|_| self.singular())?;
        let change = self.change(&residual);
        v.iter_mut().zip(&change).for_each(|(v, &by)| *v += by);
        Ok(v)
    }
}
