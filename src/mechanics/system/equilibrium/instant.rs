//! Vibrations of a machine about its state at an instant of a motion, drives held: small motions y e^{st} of
//! [`super::pencil`] with the positions, velocities, accelerations and reactions of that instant, as if they stayed so. Each
//! body sees them in its own frame. So they are those of rest where the machine rests, and those of steady rotation where it
//! turns as a whole; else they tell what is fast beside the motion.
//!
//! The rate s has the derivative of [`super::damped`], where K, D and M change with the state and with the parameters:
//!
//! ```text
//! ds = −lᵀ (dK + s dD + s² dM) r
//! ```

use super::contracted::contracted;
use super::damped::{DampedVibration, Spectrum, damped_vibrations};
use super::eigenpairs::{Cluster, clusters};
use super::krylov::lowest;
use super::pencil::{At, Matrices, Moves};
use super::rest::FREE;
use crate::math::{Complex64, Dual, Parameters, Scalar};
use crate::model::Model;
use crate::system::bodies::{self, velocities_of};
use crate::system::failure::AssemblyFailure;
use crate::system::numbering::Numbering;
use crate::system::placement::extent;
use crate::system::redundant_rows::RedundantRows;

/// Vibrations beyond the wanted one, so that a cluster is seen as a whole.
const SPARE: usize = 1;

/// A machine at an instant of a motion. Velocities and accelerations are in velocity numbering, λ has all rows.
#[derive(Clone, Copy)]
pub struct InstantState<'a, S> {
    /// The model.
    pub model: &'a Model<S>,
    /// Its numbering.
    pub numbering: &'a Numbering,
    /// Rows of constraints that follow from others.
    pub left_out: &'a RedundantRows,
    /// Positions.
    pub q: &'a [S],
    /// Velocities.
    pub v: &'a [S],
    /// Accelerations, of the index-1 equations.
    pub a: &'a [S],
    /// Multipliers of the constraints, of the same equations.
    pub lambda: &'a [S],
    /// Time \[s\].
    pub time: S,
}

impl<'a, S: Scalar> InstantState<'a, S> {
    fn at(&self) -> At<'a, S> {
        At {
            model: self.model,
            numbering: self.numbering,
            left_out: self.left_out,
            q: self.q,
            lambda: self.lambda,
            moves: Moves::AtInstant {
                v: self.v,
                a: self.a,
                time: self.time,
            },
        }
    }

    /// The vibration of this number from 0, the lowest |s| first. Motions that do not oscillate do not count.
    ///
    /// # Errors
    /// Singular equations, or fewer vibrations.
    pub fn vibration(&self, number: usize) -> Result<DampedVibration<S>, AssemblyFailure> {
        let model = self.model.map(&mut |x: S| x.re());
        let numbers = Numbers::of(self, |x| x.re());
        let real = numbers.state(&model, (self.numbering, self.left_out));
        let spectrum = spectrum(&real, number)?;
        let all = damped_vibrations(self.at(), &spectrum);
        Ok(all[number])
    }
}

/// The spectrum up to a vibration.
fn spectrum(state: &InstantState<f64>, number: usize) -> Result<Spectrum, AssemblyFailure> {
    let at = state.at();
    let matrices = Matrices::new(at, true).with_strains(at, true);
    let rate = rate(state);
    let scales = (rate.sqrt(), (FREE * rate).sqrt()..f64::INFINITY);
    let count = number + 1 + SPARE;
    let found = lowest(&matrices, scales, (count, at.freedom()))?;
    let values: Vec<Complex64> = found.values.into_iter().take(count).collect();
    if values.len() <= number {
        let (asked, there) = (number + 1, values.len());
        return Err(AssemblyFailure::NoModes {
            why: format!("mode {asked} is asked for, and there are {there}"),
        });
    }
    Ok(Spectrum::of_instant(clusters(&matrices, &values)?))
}

/// A rate \[1/s²\] of the motion: accelerations and squares of speeds by the extent of the machine.
fn rate(state: &InstantState<f64>) -> f64 {
    let InstantState {
        model, numbering, ..
    } = state;
    let length = extent(model);
    let bodies = (0..model.bodies.len()).filter(|&i| !model.is_carrier(i));
    let of_bodies = bodies.map(|i| {
        let o = numbering.velocity(i);
        let (velocity, omega) = velocities_of(&state.v[o..]);
        let (acceleration, faster) = velocities_of(&state.a[o..]);
        let square = velocity.norm_squared() / (length * length);
        let linear = acceleration.norm() / length;
        square
            .max(linear)
            .max(omega.norm_squared())
            .max(faster.norm())
    });
    match of_bodies.fold(model.gravity.norm() / length, f64::max) {
        0.0 => 1.0,
        rate => rate,
    }
}

/// The numbers of a state, without the model.
#[derive(Clone, Debug)]
struct Numbers<S> {
    q: Vec<S>,
    v: Vec<S>,
    a: Vec<S>,
    lambda: Vec<S>,
    time: S,
}

impl<S: Scalar> Numbers<S> {
    /// Those of a state in another scalar.
    fn of<T: Scalar>(state: &InstantState<T>, map: impl Fn(T) -> S) -> Self {
        let all = |x: &[T]| x.iter().map(|&x| map(x)).collect();
        Self {
            q: all(state.q),
            v: all(state.v),
            a: all(state.a),
            lambda: all(state.lambda),
            time: map(state.time),
        }
    }

    /// The state of a model.
    fn state<'a>(
        &'a self,
        model: &'a Model<S>,
        (numbering, left_out): (&'a Numbering, &'a RedundantRows),
    ) -> InstantState<'a, S> {
        InstantState {
            model,
            numbering,
            left_out,
            q: &self.q,
            v: &self.v,
            a: &self.a,
            lambda: &self.lambda,
            time: self.time,
        }
    }
}

/// The part of a derivative that comes from the parameters of the model: Re(w Σ lᵀ (dK + s dD + s² dM) r) at a fixed state.
#[derive(Clone, Debug)]
pub struct FrozenMode {
    numbering: Numbering,
    left_out: RedundantRows,
    numbers: Numbers<Dual>,
    cluster: Cluster,
    weight: Complex64,
}

impl FrozenMode {
    /// The derivative along a change of the model, whose real part is that of the state.
    pub fn along(&self, model: &Model<Dual>) -> f64 {
        self.change(model, &self.numbers)
    }

    fn change(&self, model: &Model<Dual>, numbers: &Numbers<Dual>) -> f64 {
        let state = numbers.state(model, (&self.numbering, &self.left_out));
        let sums = contracted(state.at(), &self.cluster.change(self.weight, 1.0));
        sums.iter().map(|[re, _]| re.infinitesimal()).sum()
    }
}

/// The derivative of a number of a vibration in the state, and that in the parameters at a fixed state.
pub struct InstantGradient {
    /// In tangent positions, velocities and accelerations, all in velocity numbering.
    pub by_state: [Vec<f64>; 3],
    /// In the multipliers.
    pub by_lambda: Vec<f64>,
    /// In the time.
    pub by_time: f64,
    /// In the parameters.
    pub by_model: FrozenMode,
}

impl InstantState<'_, f64> {
    /// The derivative of a number that `slopes` gives by Re s and Im s. Not a number where several vibrations have one rate.
    ///
    /// # Errors
    /// As of [`InstantState::vibration`].
    pub fn gradient(
        &self,
        number: usize,
        slopes: impl Fn(&DampedVibration<f64>) -> [f64; 2],
    ) -> Result<InstantGradient, AssemblyFailure> {
        let mut spectrum = spectrum(self, number)?;
        let own = damped_vibrations(self.at(), &spectrum)[number];
        let (cluster, _) = spectrum.order()[number];
        let [growth, speed] = match own.repeated {
            true => [f64::NAN; 2],
            false => slopes(&own),
        };
        let by_model = FrozenMode {
            numbering: self.numbering.clone(),
            left_out: self.left_out.clone(),
            numbers: Numbers::of(self, Dual::from),
            cluster: spectrum.clusters.swap_remove(cluster),
            // Re(w ds) is growth · Re ds + speed · Im ds.
            weight: Complex64::new(growth, -speed),
        };
        let model = self.model.map(&mut |x| Dual::new(x, 0.0));
        let along = |change: &dyn Fn(&mut Numbers<Dual>)| {
            let mut moved = by_model.numbers.clone();
            change(&mut moved);
            by_model.change(&model, &moved)
        };
        let unit = |i: usize| {
            let mut y = vec![Dual::new(0.0, 0.0); self.v.len()];
            y[i].du = 1.0;
            y
        };
        let positions = |i: usize| {
            along(&|moved| {
                let mut increment = vec![Dual::new(0.0, 0.0); moved.q.len()];
                bodies::advance(self.numbering, &mut moved.q, &mut increment, &unit(i));
            })
        };
        let all = 0..self.v.len();
        let by_state = [
            all.clone().map(positions).collect(),
            (all.clone().map(|i| along(&|moved| moved.v[i].du = 1.0))).collect(),
            all.map(|i| along(&|moved| moved.a[i].du = 1.0)).collect(),
        ];
        let by_lambda = (0..self.lambda.len())
            .map(|i| along(&|moved| moved.lambda[i].du = 1.0))
            .collect();
        let by_time = along(&|moved| moved.time.du = 1.0);
        Ok(InstantGradient {
            by_state,
            by_lambda,
            by_time,
            by_model,
        })
    }
}
