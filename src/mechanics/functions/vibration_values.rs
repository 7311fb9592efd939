//! Values of vibrations about the state of a snapshot, and their derivatives.

use super::snapshot::{Snapshot, SnapshotCotangent};
use super::vibration::OfVibration;
use crate::math::Scalar;
use crate::system::equilibrium::{DampedVibration, InstantState};

impl OfVibration {
    fn state<'a, S: Scalar>(at: &'a Snapshot<S>) -> Option<InstantState<'a, S>> {
        Some(InstantState {
            model: at.model,
            numbering: at.numbering,
            left_out: at.reactions.left_out?,
            q: at.q,
            v: at.v,
            a: at.reactions.accelerations,
            lambda: at.reactions.lambda,
            time: at.time,
        })
    }

    /// Its value; not a number if there is no such vibration, or none that its derivative tells where two have one rate.
    pub(super) fn value<S: Scalar>(self, at: &Snapshot<S>) -> S {
        let found = Self::state(at).and_then(|state| state.vibration(self.mode).ok());
        let Some(vibration) = found else {
            return S::from(f64::NAN);
        };
        let value = self.of(&vibration);
        match vibration.repeated {
            true => value + S::of_infinitesimal(f64::NAN),
            false => value,
        }
    }

    /// Adds `weight` times its derivative.
    pub(super) fn pull_back(self, at: &Snapshot<f64>, weight: f64, out: &mut SnapshotCotangent) {
        let slopes = |own: &DampedVibration<f64>| self.slopes(own).map(|slope| weight * slope);
        let found = Self::state(at).and_then(|state| state.gradient(self.mode, slopes).ok());
        let Some(found) = found else {
            out.y.fill(f64::NAN);
            return;
        };
        let add = |to: &mut [f64], by: &[f64]| to.iter_mut().zip(by).for_each(|(to, by)| *to += by);
        let [y, v, a] = &found.by_state;
        add(out.y, y);
        add(out.v, v);
        add(&mut out.reactions.accelerations, a);
        add(&mut out.reactions.lambda, &found.by_lambda);
        *out.time += found.by_time;
        out.modes.push(found.by_model);
    }
}
