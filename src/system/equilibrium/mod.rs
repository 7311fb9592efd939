//! Quasi-static start: deformations without velocity and acceleration.
//!
//! Let rigid motions be those with all elastic coordinates at rest. Sought are positions q, rigid velocities v,
//! rigid accelerations a and reactions λ with
//!
//! ```text
//! M(q) a − f(q, v) + G(q)ᵀ λ = 0,     Φ(q) = 0,     G(q) a + bias(q, v) = 0
//! M(q) (v − v_g) + G(q)ᵀ τ ⊥ rigid motions,     G(q) v + Φ_t = 0
//! M(q) T⁺(q − q_g) + G(q)ᵀ σ ⊥ rigid motions,   without the elastic part of q − q_g
//! ```
//!
//! at t = 0. The placement q_g is closed and undeformed. The last two rows keep the bodies, along the motions that the
//! joints allow, where they are placed and with the velocities that they have, in the metric of the mass. Where the
//! joints allow none, this is static equilibrium. Else the inertia of the motion balances gravity and loads
//! (*inertia relief*), and centrifugal forces stretch what turns.
//!
//! Newton's method solves the equations in real numbers. The part ε ṗ of dual numbers follows from the implicit function
//! theorem, as in [`super::nearest`]. The matrix of these steps is exact by its products (dual numbers); the factors of
//! a sparse one, without the derivatives of M and G in the rows of rigid motions, precondition it ([`gmres`]).

mod equations;
mod matrix;
mod stability;

use super::bodies::{positions_of, velocities_of};
use super::failure::AssemblyFailure;
use super::nearest::nearest;
use super::numbering::Numbering;
use super::placement::{guess, length_scale};
use super::reduce;
use super::redundancy;
use super::redundant_rows::RedundantRows;
use crate::linalg::gmres::gmres;
use crate::math::{Parameters, Scalar};
use crate::model::{Mobility, Model};
use equations::{Layout, State};
use matrix::Factors;
pub(crate) use stability::growth;
use std::sync::{Arc, Mutex};

const ITERATIONS: usize = 60;
/// Newton's method stops at this change of positions, relative to the length scale; and at `STAGNANT`, if changes do
/// not become smaller any more.
const CLOSE: f64 = 1e-13;
const STAGNANT: f64 = 1e-8;
/// Largest change of positions in an iteration, relative to the length scale.
const LARGEST: f64 = 0.2;
/// Largest part of the residual that a linear solution leaves in Newton's method, and in derivatives.
const ROUGH: f64 = 1e-6;
const FINE: f64 = 1e-15;
/// Products of a linear solution, and how often one is refined.
const PRODUCTS: usize = 60;
const REFINEMENTS: usize = 3;

/// Number of starts that are kept.
const KEPT: usize = 4;

/// Known real starts, keyed by the numbers of their models. A scene is made repeatedly at one
/// design, for its values and for each derivative.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownStarts(Arc<Mutex<Vec<Known>>>);

#[derive(Clone, Debug)]
struct Known {
    numbers: Vec<f64>,
    state: State<f64>,
}

impl KnownStarts {
    /// The state of these numbers, or a new one.
    fn get(
        &self,
        numbers: Vec<f64>,
        find: impl FnOnce() -> Result<State<f64>, AssemblyFailure>,
    ) -> Result<State<f64>, AssemblyFailure> {
        let known = self.0.lock().ok();
        let found = known.and_then(|all| {
            let mut all = all.iter();
            let same = all.find(|known| known.numbers == numbers);
            same.map(|known| known.state.clone())
        });
        if let Some(state) = found {
            return Ok(state);
        }
        let state = find()?;
        if let Ok(mut all) = self.0.lock() {
            if all.len() == KEPT {
                all.remove(0);
            }
            let state = state.clone();
            all.push(Known { numbers, state });
        }
        Ok(state)
    }
}

/// Moves the bodies of `model`, which are placed and undeformed, to the quasi-static start, and gives them velocities
/// without vibration.
///
/// # Errors
/// Joints that cannot be closed, or no equilibrium.
pub(crate) fn settle<S: Scalar>(
    model: &mut Model<S>,
    known: &KnownStarts,
) -> Result<(), AssemblyFailure> {
    let own = without_spin(model);
    let numbering = Numbering::new(&own);
    let (state, v) = with_solution((&own, &numbering), known, |given, solver, found| {
        let layout = solver.layout;
        let mut state: State<S> = found.map(S::from);
        if S::INFINITESIMAL {
            let residual = layout.residual(&own, given, &state);
            let right: Vec<f64> = residual.iter().map(|x| -x.infinitesimal()).collect();
            let factors = Factors::new(layout, solver.model, found);
            let mut factors = factors.ok_or(AssemblyFailure::Singular)?;
            let change = solver.change(&mut factors, found, &right, FINE);
            let change: Vec<S> = change.into_iter().map(S::of_infinitesimal).collect();
            layout.advance(&mut state, &change);
        }
        let v = layout.of_rigid(&state.v);
        Ok((state, v))
    })?;
    for (i, body) in model.bodies.iter_mut().enumerate() {
        (body.position, body.orientation) = positions_of(&state.q[numbering.position(i)..]);
        if numbering.mobility(i).unknowns() > 0 {
            (body.velocity, body.angular_velocity) = velocities_of(&v[numbering.velocity(i)..]);
        }
    }
    Ok(())
}

/// The model with point masses that do not rotate.
fn without_spin<S: Scalar>(model: &Model<S>) -> Model<S> {
    let mut own = model.clone();
    for body in 0..own.bodies.len() {
        let without = own.bodies[body].inertia.iter().all(|x| x.re() == 0.0);
        if without && !own.is_of_flexible(body) {
            own.bodies[body].mobility = Mobility::point();
        }
    }
    own
}

/// What `of` makes of the real solution for a model [`without_spin`], whose bodies are placed and undeformed.
fn with_solution<S: Scalar, T>(
    (own, numbering): (&Model<S>, &Numbering),
    known: &KnownStarts,
    of: impl FnOnce(&Given<S>, &Solver, &State<f64>) -> Result<T, AssemblyFailure>,
) -> Result<T, AssemblyFailure> {
    let placed = nearest(own)?.q;
    let given = Given::of(own, numbering, placed);
    let mut numbers = vec![numbering.unknowns() as f64, numbering.constraints() as f64];
    let mut real = own.map(&mut |x| {
        numbers.push(x.re());
        x.re()
    });
    redundancy::leave_out(&mut real);
    let left_out = RedundantRows::of(&real, numbering);
    let start = given.map(|x| x.re());
    let layout = Layout::new(&real, numbering, &left_out, &start.q);
    let solver = Solver {
        layout: &layout,
        model: &real,
        given: &start,
        scale: length_scale(&real),
        mass: real.bodies.iter().map(|body| body.mass).sum(),
    };
    let found = known.get(numbers, || solver.solve())?;
    of(&given, &solver, &found)
}

/// The placement of the bodies, and their given velocities.
pub(super) struct Given<S> {
    q: Vec<S>,
    v: Vec<S>,
}

impl<S: Scalar> Given<S> {
    fn of(model: &Model<S>, numbering: &Numbering, q: Vec<S>) -> Self {
        let (_, mut v) = guess(model);
        reduce::project(numbering, &mut v);
        Self { q, v }
    }

    fn map<T>(&self, of: impl Fn(S) -> T) -> Given<T> {
        let all = |x: &[S]| x.iter().map(|&x| of(x)).collect();
        Given {
            q: all(&self.q),
            v: all(&self.v),
        }
    }
}

/// The equations in real numbers.
struct Solver<'a> {
    layout: &'a Layout<'a>,
    model: &'a Model<f64>,
    given: &'a Given<f64>,
    /// Length of the scene \[m\] and mass of all bodies \[kg\].
    scale: f64,
    mass: f64,
}

impl Solver<'_> {
    /// Newton's method from the placement.
    fn solve(&self) -> Result<State<f64>, AssemblyFailure> {
        let mut x = self.layout.start(self.given);
        let none = |iterations| AssemblyFailure::NoEquilibrium { iterations };
        let mut before = f64::INFINITY;
        for iteration in 1..=ITERATIONS {
            let residual = self.layout.residual(self.model, self.given, &x);
            let right: Vec<f64> = residual.iter().map(|x| -x).collect();
            let factors = Factors::new(self.layout, self.model, &x);
            let mut factors = factors.ok_or_else(|| none(iteration))?;
            let change = self.change(&mut factors, &x, &right, ROUGH);
            if !change.iter().all(|x| x.is_finite()) {
                return Err(none(iteration));
            }
            let size = self.layout.moved(&change, self.scale);
            let part = (LARGEST / size).min(1.0);
            let step: Vec<f64> = change.iter().map(|x| part * x).collect();
            self.layout.advance(&mut x, &step);
            if size <= CLOSE || size <= STAGNANT && size > 0.3 * before {
                return Ok(x);
            }
            before = size;
        }
        Err(none(ITERATIONS))
    }

    /// The change of the unknowns by which the residual changes by `right`, to the part `tolerance`.
    fn change(
        &self,
        factors: &mut Factors,
        at: &State<f64>,
        right: &[f64],
        tolerance: f64,
    ) -> Vec<f64> {
        let along = self.layout.along(self.model, self.given, at);
        let mut first = right.to_vec();
        factors.solve(&mut first);
        let scales = self.layout.scales(&first, self.mass);
        let mut out = vec![0.0; right.len()];
        let mut rest = right.to_vec();
        for _ in 0..REFINEMENTS {
            factors.solve(&mut rest);
            let scaled: Vec<f64> = rest.iter().zip(&scales).map(|(x, s)| x / s).collect();
            let product = |z: &[f64]| {
                let x: Vec<f64> = z.iter().zip(&scales).map(|(z, s)| z * s).collect();
                let mut y = along.product(&x);
                factors.solve(&mut y);
                y.iter_mut().zip(&scales).for_each(|(y, s)| *y /= s);
                y
            };
            let z = gmres(product, &scaled, tolerance, PRODUCTS);
            for ((out, z), s) in out.iter_mut().zip(&z).zip(&scales) {
                *out += z * s;
            }
            if tolerance > FINE {
                break;
            }
            rest = along.product(&out);
            for (rest, right) in rest.iter_mut().zip(right) {
                *rest = right - *rest;
            }
        }
        out
    }
}
