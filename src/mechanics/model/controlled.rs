//! The controllers of a model, and the bodies of their states.

use super::controller::Controller;
use super::{Load, LoadKind, Mobility, Model, RigidBody, Role};
use crate::math::Scalar;
use std::ops::Range;

impl<S: Scalar> Model<S> {
    /// The controllers.
    pub fn controllers(&self) -> impl Iterator<Item = &Controller<S>> {
        self.loads.iter().filter_map(|load| match &load.kind {
            LoadKind::Controller(own) => Some(own),
            _ => None,
        })
    }

    /// Whether loads are controllers.
    pub fn is_controlled(&self) -> bool {
        self.controllers().next().is_some()
    }

    /// The bodies whose velocities are states of controllers, which follow each other; empty without.
    pub fn states(&self) -> Range<usize> {
        let mut all = self.controllers().flat_map(Controller::states);
        let first = all.next();
        let count = 1 + all.count();
        first.map_or(0..0, |first| first..first + count)
    }

    /// Gives controllers the bodies of their states, which start with zero.
    pub fn add_states(&mut self) {
        for Load { name, kind } in &mut self.loads {
            let LoadKind::Controller(own) = kind else {
                continue;
            };
            let integral = own
                .integral
                .as_mut()
                .map(|own| (&mut own.state, "integral"));
            let lag = own.lag.as_mut().map(|own| (&mut own.state, "lag"));
            for (state, what) in integral.into_iter().chain(lag) {
                let mut body = RigidBody::massless(format!("{name}, {what}"));
                body.mass = S::one();
                body.mobility = Mobility::carrier(1);
                body.role = Role::State;
                *state = self.bodies.len();
                self.bodies.push(body);
            }
        }
    }
}
