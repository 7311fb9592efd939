//! Quasi-static start: deformations without velocity and acceleration; and rest, see [`rest`].
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
//! (*inertia relief*), and centrifugal forces stretch what turns. Where the bodies turn or move steadily with their loads,
//! as by a drive, this is relative equilibrium, and they stay deformed so (see [`left_out`]).
//!
//! Newton's method solves the equations in real numbers. The part ε ṗ of dual numbers follows from the implicit function
//! theorem, as in [`super::nearest`]. The matrix of these steps is exact by its products (dual numbers); the factors of
//! a sparse one, without the derivatives of M and G in the rows of rigid motions, precondition it ([`gmres`]).

mod contracted;
mod critical;
mod damped;
mod descent;
mod eigenpairs;
mod equations;
mod followed;
mod instant;
mod krylov;
mod matrix;
mod modes;
mod pencil;
mod released;
mod rest;
mod ritz;
mod sameness;
mod stability;
mod turning;
mod unresisted;
mod unsteady;
mod whirl;

use super::bodies::{positions_of, velocities_of};
use super::failure::AssemblyFailure;
use super::nearest::{FirstOrder, Placed};
use super::numbering::Numbering;
use super::placement::{guess, reach};
use super::reduce;
use super::redundancy;
use super::redundant_rows::RedundantRows;
use crate::linalg::gmres::gmres;
use crate::math::{Parameters, Scalar};
use crate::model::{Mobility, Model};
pub use critical::CriticalSpeed;
use critical::{Excited, critical_speed};
pub use damped::DampedVibration;
use damped::{Spectrum, damped_vibrations, undamped_vibrations};
use equations::{Layout, State};
pub use followed::Follow;
use followed::{FirstShape, as_damped, shapes_of_modes, shapes_of_spectrum};
pub use instant::{FrozenMode, InstantGradient, InstantState};
use matrix::Factors;
use modes::{Mode, vibrations};
pub use modes::{Vibration, WantedModes};
use pencil::At;
use released::Released;
use rest::FreeMotion;
pub use rest::{Stability, stability};
pub use stability::growth;
use std::sync::{Arc, Mutex};
pub use turning::Turning;
pub use unsteady::left_out;
pub use whirl::{MachineMode, MachineModes, Whirl, modes_of_machine};

const ITERATIONS: usize = 60;
/// Newton's method stops at this change of positions, relative to the length scale; and at `STAGNANT`, if changes do
/// not become smaller any more.
const CLOSE: f64 = 1e-13;
const STAGNANT: f64 = 1e-8;
/// Largest change of positions in an iteration, relative to the length scale.
const LARGEST: f64 = 0.2;
/// Largest part of the residual that a linear solution leaves, and its products.
const TOLERANCE: f64 = 1e-6;
const PRODUCTS: usize = 60;
/// Linear solutions for a change in Newton's method; and for a derivative, which they refine to round-off.
const ROUGH: usize = 1;
const FINE: usize = 3;

/// What is sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sought {
    /// The start of a motion: elastic coordinates at rest, rigid motions as placed.
    Start,
    /// Rest of the whole machine.
    Rest,
}

/// Numbers that differ by less, relative to their size, are the same but for round-off; those below the second are absolute.
const NEARBY: f64 = 1e-9;
const SMALL: f64 = 1e-6;
/// Number of starts that are kept.
const KEPT: usize = 12;
/// Number of factors of one start that are kept.
const KEPT_AT_ONCE: usize = 8;

/// Known real starts, keyed by the numbers of their models, and factors of the latest one, for each thread its own. A scene is made
/// repeatedly at one design, for its values and for each derivative.
#[derive(Clone, Debug, Default)]
pub struct KnownStarts(Arc<Mutex<Known>>);

#[derive(Debug, Default)]
struct Known {
    states: Vec<(Vec<f64>, State<f64>)>,
    factors: Vec<(Vec<f64>, Factors)>,
    placed: Vec<(Vec<f64>, Placed)>,
    modes: Option<(Vec<f64>, Option<Vec<Mode>>)>,
    spectra: Vec<(Vec<f64>, Spectrum)>,
    critical: Vec<(Vec<f64>, Excited)>,
    free: Option<(Vec<f64>, Vec<FreeMotion>)>,
    first_shapes: Vec<FirstShape>,
}

impl KnownStarts {
    /// The state of these numbers, with them.
    fn state(&self, numbers: &[f64]) -> Option<(Vec<f64>, State<f64>)> {
        let known = self.0.lock().ok()?;
        known.states.iter().find(|(own, _)| own == numbers).cloned()
    }

    /// The state of numbers that differ from these by round-off, as the real parts of others do. Where several equilibria
    /// are near, it is the same one.
    fn state_nearby(&self, numbers: &[f64]) -> Option<(Vec<f64>, State<f64>)> {
        let known = self.0.lock().ok()?;
        let apart = |own: &[f64]| match own.len() == numbers.len() {
            true => own.iter().zip(numbers).fold(0.0_f64, |most, (a, b)| {
                most.max((a - b).abs() / (a.abs() + b.abs() + SMALL))
            }),
            false => f64::INFINITY,
        };
        let all = known.states.iter().map(|own| (apart(&own.0), own));
        let (apart, nearest) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (apart < NEARBY).then(|| nearest.clone())
    }

    fn keep(&self, numbers: &[f64], state: &State<f64>) {
        if let Ok(mut known) = self.0.lock() {
            if known.states.len() == KEPT {
                known.states.remove(0);
            }
            known.states.push((numbers.to_vec(), state.clone()));
        }
    }

    /// Takes factors of these numbers. Each thread has its own.
    fn take_factors(&self, numbers: &[f64]) -> Option<Factors> {
        take(&mut self.0.lock().ok()?.factors, numbers)
    }

    fn keep_factors(&self, numbers: Vec<f64>, factors: Factors) {
        if let Ok(mut known) = self.0.lock() {
            keep(&mut known.factors, numbers, factors);
        }
    }

    /// Takes the consistent state at the placement that has these numbers.
    fn take_placed(&self, numbers: &[f64]) -> Option<Placed> {
        take(&mut self.0.lock().ok()?.placed, numbers)
    }

    fn keep_placed(&self, numbers: &[f64], placed: Placed) {
        if let Ok(mut known) = self.0.lock() {
            keep(&mut known.placed, numbers.to_vec(), placed);
        }
    }

    fn free(&self, numbers: &[f64]) -> Option<Vec<FreeMotion>> {
        let known = self.0.lock().ok()?;
        let (own, free) = known.free.as_ref()?;
        (own == numbers).then(|| free.clone())
    }

    fn keep_free(&self, numbers: &[f64], free: &[FreeMotion]) {
        if let Ok(mut known) = self.0.lock() {
            known.free = Some((numbers.to_vec(), free.to_vec()));
        }
    }
}

/// Takes one of those of these numbers.
fn take<T>(all: &mut Vec<(Vec<f64>, T)>, numbers: &[f64]) -> Option<T> {
    let at = all.iter().position(|(own, _)| own == numbers)?;
    Some(all.swap_remove(at).1)
}

/// Keeps one of these numbers for each thread, up to some, and no others.
fn keep<T>(all: &mut Vec<(Vec<f64>, T)>, numbers: Vec<f64>, own: T) {
    all.retain(|(others, _)| *others == numbers);
    if all.len() < rayon::current_num_threads().min(KEPT_AT_ONCE) {
        all.push((numbers, own));
    }
}

/// What functions need of vibrations about rest, or about steady rotation.
#[derive(Clone, Debug)]
pub struct Vibrations<S> {
    /// Natural frequencies; of a machine that turns, those with its damping and gyroscopic forces in the turning frame.
    pub undamped: Vec<Vibration<S>>,
    /// Those with damping, the lowest |s| first.
    pub damped: Vec<DampedVibration<S>>,
    /// Those that are followed by their shapes, as requested; without damping where it was not asked for.
    pub followed: Vec<DampedVibration<S>>,
    /// Critical speeds.
    pub critical: Vec<CriticalSpeed<S>>,
}

impl<S> Default for Vibrations<S> {
    fn default() -> Self {
        Self {
            undamped: Vec::new(),
            damped: Vec::new(),
            followed: Vec::new(),
            critical: Vec::new(),
        }
    }
}

/// What is sought, and the vibrations that are wanted there.
#[derive(Clone, Debug)]
pub struct Request<S> {
    /// What is sought.
    pub sought: Sought,
    /// Steady rotation: rest is that in the turning frame.
    pub turning: Option<Turning<S>>,
    /// The vibrations.
    pub modes: WantedModes,
    /// Those of them that are followed by their shapes.
    pub followed: Vec<Follow>,
}

/// Moves the bodies of `model`, which are placed and undeformed, to the quasi-static start, and gives them velocities
/// without vibration; or to rest, also in a turning frame. Gives the vibrations about rest that are wanted.
///
/// # Errors
/// Joints that cannot be closed, no equilibrium, or no such modes.
pub fn settle<S: Scalar>(
    model: &mut Model<S>,
    known: &KnownStarts,
    request: &Request<S>,
) -> Result<Vibrations<S>, AssemblyFailure> {
    let own = without_spin(model);
    let numbering = Numbering::new(&own);
    let of = (&own, &numbering, request.sought);
    let turning = request.turning.as_ref();
    let (state, v, mut vibrations) = with_solution(of, turning, known, |given, solver, found| {
        let state = in_scalar(&own, given, (solver, found), Held::ByAll)?;
        let v = solver.layout.of_rigid(&state.v);
        let vibrations = solver.vibrations((&own, &state, turning), found, request)?;
        Ok((state, v, vibrations))
    })?;
    if let Some(turning) = turning {
        let machine = (&own, &numbering, known);
        for number in 1..=request.modes.critical {
            let speed = critical_speed(machine, turning, number)?;
            vibrations.critical.push(speed);
        }
    }
    for (i, body) in model.bodies.iter_mut().enumerate() {
        (body.position, body.orientation) = positions_of(&state.q[numbering.position(i)..]);
        if numbering.mobility(i).unknowns() > 0 {
            (body.velocity, body.angular_velocity) = velocities_of(&v[numbering.velocity(i)..]);
        }
    }
    Ok(vibrations)
}

/// How positions follow from the numbers of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Held {
    /// Completely, or the change fails.
    ByAll,
    /// But for free motions, which stay as placed.
    ButForFree,
}

/// The solution for a model in any scalar, exact to first order.
fn in_scalar<S: Scalar>(
    model: &Model<S>,
    given: &Given<S>,
    (solver, found): (&Solver, &State<f64>),
    held: Held,
) -> Result<State<S>, AssemblyFailure> {
    let layout = solver.layout;
    let mut state: State<S> = found.map(S::from);
    if S::INFINITESIMAL {
        let residual = layout.residual(model, given, &state);
        let right: Vec<f64> = residual.iter().map(|x| -x.infinitesimal()).collect();
        let change = solver.with_factors(found, |factors| {
            let mut change = solver.change(factors, found, &right, FINE);
            match (layout.is_rest(), held) {
                (false, _) => Ok(change),
                (true, Held::ByAll) => solver.determined(factors, found, &right, change),
                (true, Held::ButForFree) => {
                    solver.keep_as_placed(factors, found, &mut change)?;
                    Ok(change)
                }
            }
        })??;
        let change: Vec<S> = change.into_iter().map(S::of_infinitesimal).collect();
        layout.advance(&mut state, &change);
    }
    Ok(state)
}

/// The model with point masses that do not rotate.
fn without_spin<S: Scalar>(model: &Model<S>) -> Model<S> {
    let mut own = model.clone();
    for body in 0..own.bodies.len() {
        if own.bodies[body].is_point() && !own.is_of_flexible(body) {
            own.bodies[body].mobility = Mobility::point();
        }
    }
    own
}

/// What `of` makes of the real solution of `model` and its factors. The bodies of `model` are placed and undeformed.
fn at_solution<T>(
    model: &Model<f64>,
    known: &KnownStarts,
    sought: Sought,
    of: impl FnOnce(&Solver, &mut Factors, &State<f64>) -> Result<T, AssemblyFailure>,
) -> Result<T, AssemblyFailure> {
    let own = without_spin(model);
    let numbering = Numbering::new(&own);
    let sought = (&own, &numbering, sought);
    with_solution(sought, None, known, |_, solver, found| {
        solver.with_factors(found, |factors| of(solver, factors, found))?
    })
}

/// What `of` makes of the real solution for a model [`without_spin`], whose bodies are placed and undeformed.
fn with_solution<S: Scalar, T>(
    (own, numbering, sought): (&Model<S>, &Numbering, Sought),
    turning: Option<&Turning<S>>,
    known: &KnownStarts,
    of: impl FnOnce(&Given<S>, &Solver, &State<f64>) -> Result<T, AssemblyFailure>,
) -> Result<T, AssemblyFailure> {
    let mut numbers = vec![numbering.unknowns() as f64, numbering.constraints() as f64];
    let mut noted = |x: S| {
        numbers.push(x.re());
        x.re()
    };
    let mut real = own.map(&mut noted);
    if let Some(turning) = turning {
        turning.map(&mut noted);
    }
    redundancy::leave_out(&mut real);
    let mut placed = match known.take_placed(&numbers) {
        Some(placed) => placed,
        None => Placed::of(&real, numbering)?,
    };
    let mut nearest = FirstOrder {
        model: own,
        real: &real,
        numbering,
        placed: &mut placed,
    };
    let q = nearest.positions()?;
    known.keep_placed(&numbers, placed);
    let given = Given::of(own, numbering, (q, turning));
    let left_out = RedundantRows::of(&real, numbering);
    let start = given.map(&mut |x| x.re());
    let layout = Layout::new(&real, numbering, &left_out, (&start, sought));
    let mut solver = Solver {
        layout: &layout,
        model: &real,
        given: &start,
        scale: reach(&real),
        mass: real.bodies.iter().map(|body| body.mass).sum(),
        numbers,
        known,
    };
    let kept = match S::INFINITESIMAL {
        true => known.state_nearby(&solver.numbers),
        false => known.state(&solver.numbers),
    };
    let found = match kept {
        Some((numbers, found)) => {
            solver.numbers = numbers;
            found
        }
        None => match sought {
            Sought::Start => solver.solve()?,
            Sought::Rest => solver.rest()?,
        },
    };
    of(&given, &solver, &found)
}

/// The placement of the bodies, their given velocities, the time of drives and loads, and steady rotation.
pub(super) struct Given<S> {
    q: Vec<S>,
    v: Vec<S>,
    time: S,
    turning: Option<Turning<S>>,
}

impl<S: Scalar> Given<S> {
    fn of(
        model: &Model<S>,
        numbering: &Numbering,
        (q, turning): (Vec<S>, Option<&Turning<S>>),
    ) -> Self {
        let (_, mut v) = guess(model);
        reduce::project(numbering, &mut v);
        Self {
            q,
            v,
            time: S::zero(),
            turning: turning.cloned(),
        }
    }

    fn map<T: Scalar>(&self, of: &mut dyn FnMut(S) -> T) -> Given<T> {
        let mut all = |x: &[S]| x.iter().map(|&x| of(x)).collect();
        let (q, v) = (all(&self.q), all(&self.v));
        Given {
            q,
            v,
            time: of(self.time),
            turning: self.turning.as_ref().map(|own| own.map(of)),
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
    /// All numbers of the model, and the starts that are known.
    numbers: Vec<f64>,
    known: &'a KnownStarts,
}

impl Solver<'_> {
    /// What `of` makes of factors at the solution. New ones and kept ones are the same, so no thread changes a result.
    fn with_factors<T>(
        &self,
        found: &State<f64>,
        of: impl FnOnce(&mut Factors) -> T,
    ) -> Result<T, AssemblyFailure> {
        let mut factors = match self.known.take_factors(&self.numbers) {
            Some(factors) => factors,
            None => {
                let mut factors = Factors::plan(self.layout, self.model, found);
                self.factorise_at(&mut factors, found)?;
                factors
            }
        };
        let out = of(&mut factors);
        self.known.keep_factors(self.numbers.clone(), factors);
        Ok(out)
    }

    /// The lowest modes at a solution, which become known; `None` if loads have no potential.
    fn known_modes(
        &self,
        found: &State<f64>,
        wanted: &WantedModes,
    ) -> Result<Option<Vec<Mode>>, AssemblyFailure> {
        if let Some(modes) = self.known.modes(&self.numbers) {
            return Ok(modes);
        }
        let modes = self.with_factors(found, |factors| self.modes(factors, found, wanted))??;
        self.known.keep_modes(&self.numbers, &modes);
        Ok(modes)
    }

    /// The wanted vibrations about a solution in any scalar, without critical speeds.
    fn vibrations<S: Scalar>(
        &self,
        (model, x, turning): (&Model<S>, &State<S>, Option<&Turning<S>>),
        found: &State<f64>,
        request: &Request<S>,
    ) -> Result<Vibrations<S>, AssemblyFailure> {
        let (layout, mut out) = (self.layout, Vibrations::default());
        let wanted = &request.modes;
        let released = match layout.is_rest() {
            true => Released::of((model, layout.numbering), x)?,
            false => None,
        };
        let at = match &released {
            Some(own) => own.at(),
            None => At::rest(layout, model, x, turning),
        };
        let unknowns = layout.numbering.unknowns();
        let (mut shapes, mut damped_shapes) = (Vec::new(), Vec::new());
        if turning.is_some() || released.is_some() {
            let all = wanted.all_damped();
            if !all.none_undamped() {
                let spectrum = self.spectrum(found, &all, (true, true))?;
                out.damped = damped_vibrations(at, &spectrum);
                out.undamped = out.damped.iter().map(DampedVibration::undamped).collect();
                damped_shapes = shapes_of_spectrum(&spectrum, unknowns);
            }
        } else {
            if !wanted.none_undamped() {
                (out.undamped, shapes) = match self.known_modes(found, wanted)? {
                    Some(modes) => (
                        vibrations(layout, at, &modes),
                        shapes_of_modes(&modes, unknowns),
                    ),
                    None => {
                        let spectrum = self.spectrum(found, wanted, (false, true))?;
                        let all = undamped_vibrations(at, &spectrum);
                        (all, shapes_of_spectrum(&spectrum, unknowns))
                    }
                };
            }
            if wanted.damped > 0 {
                let wanted = wanted.damped_alone();
                let spectrum = self.spectrum(found, &wanted, (true, true))?;
                out.damped = damped_vibrations(at, &spectrum);
                damped_shapes = shapes_of_spectrum(&spectrum, unknowns);
            }
        }
        for &own in &request.followed {
            let damped = own.damped || turning.is_some() || released.is_some();
            let shapes = if damped { &damped_shapes } else { &shapes };
            let place = self.follow(found, own, shapes)?;
            out.followed.push(match damped {
                true => out.damped[place],
                false => as_damped(&out.undamped[place]),
            });
        }
        Ok(out)
    }

    /// Newton's method from the placement. The solution becomes known.
    fn solve(&self) -> Result<State<f64>, AssemblyFailure> {
        let mut x = self.layout.start(self.given);
        let none = |iterations| AssemblyFailure::NoEquilibrium { iterations };
        let mut before = f64::INFINITY;
        let mut factors = Factors::plan(self.layout, self.model, &x);
        for iteration in 1..=ITERATIONS {
            let residual = self.layout.residual(self.model, self.given, &x);
            let right: Vec<f64> = residual.iter().map(|x| -x).collect();
            let made = factors.make(self.layout, self.model, (&x, 0.0));
            made.map_err(|_| none(iteration))?;
            let change = self.change(&mut factors, &x, &right, ROUGH);
            if !change.iter().all(|x| x.is_finite()) {
                return Err(none(iteration));
            }
            let size = self.moved(&x, &change);
            let part = (LARGEST / size).min(1.0);
            let step: Vec<f64> = change.iter().map(|x| part * x).collect();
            self.layout.advance(&mut x, &step);
            // The first change has the loads of the velocities that the iteration starts with, and not those of drives.
            let converged = size <= CLOSE || size <= STAGNANT && size > 0.3 * before;
            if iteration > 1 && converged {
                self.known.keep(&self.numbers, &x);
                return Ok(x);
            }
            before = size;
        }
        Err(none(ITERATIONS))
    }

    /// The change of the unknowns by which the residual changes by `right`, from so many linear
    /// solutions that refine each other.
    fn change(
        &self,
        factors: &mut Factors,
        at: &State<f64>,
        right: &[f64],
        solutions: usize,
    ) -> Vec<f64> {
        let along = self.layout.along(self.model, self.given, at);
        let mut rest = right.to_vec();
        factors.solve(&mut rest);
        let scales = self.layout.scales(&rest, self.mass);
        let mut out = vec![0.0; right.len()];
        for solution in 0..solutions {
            if solution > 0 {
                rest = along.product(&out);
                for (rest, right) in rest.iter_mut().zip(right) {
                    *rest = right - *rest;
                }
                factors.solve(&mut rest);
            }
            let scaled: Vec<f64> = rest.iter().zip(&scales).map(|(x, s)| x / s).collect();
            let product = |z: &[f64]| {
                let x: Vec<f64> = z.iter().zip(&scales).map(|(z, s)| z * s).collect();
                let mut y = along.product(&x);
                factors.solve(&mut y);
                y.iter_mut().zip(&scales).for_each(|(y, s)| *y /= s);
                y
            };
            let z = gmres(product, &scaled, TOLERANCE, PRODUCTS);
            for ((out, z), s) in out.iter_mut().zip(&z).zip(&scales) {
                *out += z * s;
            }
        }
        out
    }
}
