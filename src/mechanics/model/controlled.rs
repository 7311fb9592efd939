//! The controllers of a model, and the bodies of their states.

use super::controller::{Controller, Coordinate, Regime};
use super::{Load, LoadKind, Mobility, Model, RigidBody, Role};
use crate::math::Scalar;

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

    /// Whether controllers are settled that have states.
    pub fn is_settled(&self) -> bool {
        let settled = |own: &Controller<S>| own.regime == Regime::Settled;
        self.controllers()
            .any(|own| settled(own) && own.states().next().is_some())
    }

    /// Lets settled controllers run: their states can change, and no drives hold the joints that integrals do.
    pub fn run(&mut self) {
        for load in &mut self.loads {
            let LoadKind::Controller(own) = &mut load.kind else {
                continue;
            };
            if own.regime != Regime::Settled {
                continue;
            }
            own.regime = Regime::Running;
            for state in own.states() {
                self.bodies[state].mobility = Mobility::carrier(1);
            }
            if let (Some(_), Coordinate::Joint { joint, dof, .. }) =
                (&own.integral, &own.feedback[0].coordinate)
            {
                let drives = &mut self.joints[*joint].drives;
                drives.retain(|drive| drive.dof != *dof);
            }
        }
    }

    /// Gives controllers the bodies of their states, which start with zero. Those of settled ones stay.
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
                body.mobility = match own.regime {
                    Regime::Settled => Mobility::fixed(),
                    Regime::Running | Regime::Off => Mobility::carrier(1),
                };
                body.role = Role::State;
                *state = self.bodies.len();
                self.bodies.push(body);
            }
        }
    }
}
