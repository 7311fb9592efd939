//! Controllers: efforts (forces or torques) that make a joint or a distance follow a reference.
//!
//! Let x_k be angles or displacements of joints or distances of points, r_k(t) their references and e_k = r_k − x_k. The first
//! is that on which the effort F acts, positive where it increases x_0. With an integral I and a lag,
//!
//! ```text
//! u  = Σ_k (p_k e_k + d_k ė_k) + I + f(t) + g(q)        the demand; f a feed-forward
//! g  = −Σ_i m_i γᵀ ∂r_i/∂x_0                            weights of points r_i that are balanced, γ the gravity
//! İ  = k e_0 + (s − u) / T_a                            without anti-windup the second term is missing
//! F  = s,   or   T Ḟ = s − F                            s the demand within the limits of the motor
//! ```
//!
//! with σ(z) = z (1 + z⁸)^(−1/8), which is z but for z⁹/8 and stays within ±1, the motor's limit L, stall torque A and
//! no-load speed W, the ratio n of the gear, and the most power P,
//!
//! ```text
//! s_1 = n L σ(u / (n L))
//! s_2 = n A (σ(y) − n ẋ_0 / W),   y = s_1 / (n A) + n ẋ_0 / W
//! s   = s_2 (1 + z⁸)^(−1/8),      z = s_2 ẋ_0 / P
//! ```
//!
//! s_2 is the torque of a motor of direct current whose voltage is limited. A limit that is not given is left out. The
//! product of the gains p and d with several joints is state feedback: a row of its matrix is a controller.
//!
//! I and F of a lag are states: velocities of bodies of unit mass, each with one unknown, that nothing else acts on. Their
//! positions are integrals that act on nothing. The weights of these bodies are balanced too.

use super::drive::DegreeOfFreedom;
use super::time_function::TimeFunction;
use crate::math::{Vec3, parameters};

/// An angle, a displacement or a distance.
#[derive(Clone, Debug)]
pub enum Coordinate<S> {
    /// Of a joint, about or along its axis.
    Joint {
        /// The joint.
        joint: usize,
        /// Its degree of freedom.
        dof: DegreeOfFreedom,
        /// The body whose first coordinate has the turns of a rotation, as of a torsion spring.
        counter: Option<usize>,
    },
    /// The distance of points of two bodies, which must stay apart.
    Distance {
        /// Body A.
        body_a: usize,
        /// Body B; `None` is ground.
        body_b: Option<usize>,
        /// Point of A, from the centre of mass in body axes \[m\].
        point_a: Vec3<S>,
        /// Point of B, from the centre of mass in body axes (on ground: from the origin) \[m\].
        point_b: Vec3<S>,
    },
}

/// Proportional and derivative feedback of a coordinate.
#[derive(Clone, Debug)]
pub struct Feedback<S> {
    /// x.
    pub coordinate: Coordinate<S>,
    /// r(t) \[rad or m\].
    pub reference: TimeFunction<S>,
    /// p: effort per error.
    pub proportional: S,
    /// d: effort per rate of the error.
    pub derivative: S,
}

/// The integral of the error.
#[derive(Clone, Debug)]
pub struct Integral<S> {
    /// The body whose velocity is I.
    pub state: usize,
    /// k: effort per error and time.
    pub gain: S,
    /// T_a \[s\]; `None` without anti-windup.
    pub tracking: Option<S>,
}

/// A lag of first order.
#[derive(Clone, Debug)]
pub struct Lag<S> {
    /// The body whose velocity is F.
    pub state: usize,
    /// T \[s\].
    pub time: S,
}

/// A point whose weight is balanced. It moves with body A of the joint.
#[derive(Clone, Debug)]
pub struct Weight<S> {
    /// The body.
    pub body: usize,
    /// The point, from the centre of mass in body axes \[m\].
    pub point: Vec3<S>,
    /// m \[kg\].
    pub mass: S,
}

/// Limits of a motor. Those that are `None` do not act.
#[derive(Clone, Debug)]
pub struct Limits<S> {
    /// n: turns of the motor for one of the joint, or the angle for a displacement of one metre.
    pub ratio: S,
    /// L: largest effort of the motor \[N m, or N without a gear\].
    pub effort: Option<S>,
    /// A and W: the effort at which it stalls, and the speed at which it has none.
    pub line: Option<[S; 2]>,
    /// P \[W\].
    pub power: Option<S>,
}

/// What a controller does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// Its effort acts, and its states change.
    Running,
    /// The machine is at rest: a lag has settled, and an integral has the effort of a drive that holds the joint, so that the
    /// controller adds none.
    Settled,
    /// Its effort is zero, and its states stay.
    Off,
}

/// A controller with its motor.
#[derive(Clone, Debug)]
pub struct Controller<S> {
    /// What it does.
    pub regime: Regime,
    /// The coordinates that it measures; F acts on the first.
    pub feedback: Vec<Feedback<S>>,
    /// The integral of the first error.
    pub integral: Option<Integral<S>>,
    /// f(t) \[N or N m\].
    pub feed_forward: TimeFunction<S>,
    /// Points whose weight it balances.
    pub weights: Vec<Weight<S>>,
    /// Limits of the motor.
    pub limits: Limits<S>,
    /// The lag of the motor.
    pub lag: Option<Lag<S>>,
}

parameters!(enum Coordinate {
    Joint { joint, dof, counter; },
    Distance { body_a, body_b; point_a, point_b },
});
parameters!(struct Feedback {; coordinate, reference, proportional, derivative });
parameters!(struct Integral { state; gain, tracking });
parameters!(struct Lag { state; time });
parameters!(struct Weight { body; point, mass });
parameters!(struct Limits {; ratio, effort, line, power });
parameters!(struct Controller { regime; feedback, integral, feed_forward, weights, limits, lag });

impl<S> Coordinate<S> {
    /// The joint that is measured and the body that counts its turns, if they are counted.
    pub fn counted(&self) -> Option<(usize, usize)> {
        match self {
            Self::Joint { joint, counter, .. } => Some((*joint, (*counter)?)),
            Self::Distance { .. } => None,
        }
    }
}

impl<S> Controller<S> {
    /// The bodies whose velocities are I and F.
    pub fn states(&self) -> impl Iterator<Item = usize> {
        let integral = self.integral.as_ref().map(|own| own.state);
        integral
            .into_iter()
            .chain(self.lag.as_ref().map(|own| own.state))
    }

    /// Places of the counters of the joints whose rotation is measured.
    pub fn rotations(&mut self) -> impl Iterator<Item = &mut Option<usize>> {
        self.feedback
            .iter_mut()
            .filter_map(|own| match &mut own.coordinate {
                Coordinate::Joint {
                    dof: DegreeOfFreedom::Rotation,
                    counter,
                    ..
                } => Some(counter),
                Coordinate::Joint { .. } | Coordinate::Distance { .. } => None,
            })
    }

    /// The functions of time: references and the feed-forward.
    pub fn courses(&self) -> impl Iterator<Item = &TimeFunction<S>> {
        let references = self.feedback.iter().map(|own| &own.reference);
        references.chain([&self.feed_forward])
    }
}
