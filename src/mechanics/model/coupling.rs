//! Couplings: linear relations between relative motions of bodies, as of gears, racks, screws and belts.
//!
//! ```text
//! Σ c_i x_i = C       x_i an angle about an axis of two bodies or a displacement along it, over any number of turns
//! ```
//!
//! x_1 … x_{n−1} are states: coordinates of bodies without mass, each with one unknown. A row for each makes its bodies
//! follow, and one makes the last two follow all of them,
//!
//! ```text
//! sin(x_i − θ_i(q)) = 0  or  x_i − s_i(q) = 0,       x_n = (C − Σ c_i x_i) / c_n
//! ```
//!
//! So the number of turns is part of the state and never guessed, the relation holds after any number of them, and its
//! derivative in c_i has the whole angle. Each row is that of a [drive](super::drive) whose course is linear in
//! coordinates instead of a function of time: the frame on body B turns about e3 or moves along it.
//! Coordinates are zero at the start.
//!
//! A cam is a follower whose motion is a function of the coordinate: with frame B moved by the profile f,
//!
//! ```text
//! y = f(x),   ẏ = f' ẋ,   ÿ = f' ẍ + f'' ẋ²
//! ```
//!
//! The rotor of a motor has a coordinate whose mass is its inertia n² J, seen through a gear of the ratio n. It has neither
//! weight nor momentum.

use super::drive::DegreeOfFreedom;
use super::flexible::Modes;
use super::joint::{Joint, JointFrame, JointKind};
use super::{Mobility, Model, RigidBody, Role, TimeFunction};
use crate::math::{Mat3, Scalar, Vec3, rotation};
use std::ops::Range;

/// A relative motion of two bodies in a coupling.
#[derive(Clone, Debug)]
pub struct CoupledMotion<S> {
    /// The bodies and frames, as of a joint, and the name.
    pub joint: Joint<S>,
    /// The rotation about e3 or the displacement along it.
    pub dof: DegreeOfFreedom,
    /// c.
    pub factor: S,
}

impl<S: Scalar> Model<S> {
    /// Whether motions of joints are coupled.
    pub fn is_coupled(&self) -> bool {
        self.joints.iter().any(Joint::is_coupled)
    }

    /// The bodies that carry coordinates of couplings and states of controllers, with counters between them; empty without.
    pub fn coordinates(&self) -> Range<usize> {
        let holds = |body: &RigidBody<S>| matches!(body.role, Role::Coordinate | Role::State);
        let first = self.bodies.iter().position(holds);
        let last = self.bodies.iter().rposition(holds);
        first
            .zip(last)
            .map_or(0..0, |(first, last)| first..last + 1)
    }

    /// The bodies of each coupling: those of its joints (`None` is ground), and those that carry its coordinates.
    pub fn ties(&self) -> Vec<Vec<Option<usize>>> {
        let mut ties: Vec<Vec<Option<usize>>> = Vec::new();
        for joint in self.joints.iter().filter(|joint| joint.is_coupled()) {
            let places = joint.modes.iter().flat_map(|own| &own.places);
            let carriers: Vec<Option<usize>> = places.map(|own| Some(own.0)).collect();
            let mut own = carriers.clone();
            own.extend([Some(joint.body_a), joint.body_b]);
            ties.retain(|tie| {
                let apart = !tie.iter().any(|body| carriers.contains(body));
                if !apart {
                    own.extend(tie);
                }
                apart
            });
            own.sort_unstable();
            own.dedup();
            ties.push(own);
        }
        ties
    }

    /// Couples motions, which the bodies' placement satisfies up to `miss`, C − Σ c_i x_i there: the joint of each motion
    /// that is added. The factor of the last motion is not zero.
    pub fn couple(&mut self, name: &str, motions: &[CoupledMotion<S>], miss: S) -> Vec<usize> {
        let Some((last, others)) = motions.split_last() else {
            return Vec::new();
        };
        let first = self.bodies.len();
        for motion in others {
            self.add_coordinate(name, motion, S::zero());
        }
        let follows = others.iter().enumerate();
        let follows = follows.map(|(i, own)| (first + i, -own.factor / last.factor));
        self.follow(name, last, miss / last.factor, follows.collect());
        let added = self.joints.len();
        (added - motions.len()..added).collect()
    }

    /// Lets a motion follow the profile f of another, which both count from the placement: the joints that are added.
    pub fn add_cam(
        &mut self,
        name: &str,
        [cam, follower]: [&CoupledMotion<S>; 2],
        profile: TimeFunction<S>,
    ) -> Vec<usize> {
        let first = self.joints.len();
        let coordinate = self.add_coordinate(name, cam, S::zero());
        self.follow(name, follower, S::zero(), vec![(coordinate, S::one())]);
        if let Some(modes) = self.joints.last_mut().and_then(|own| own.modes.as_mut()) {
            modes.profile = Some(profile);
        }
        (first..self.joints.len()).collect()
    }

    /// Adds a body whose coordinate follows a motion, with an inertia \[kg m² of a rotation, kg of a displacement\]: its index.
    pub fn add_coordinate(&mut self, name: &str, motion: &CoupledMotion<S>, inertia: S) -> usize {
        let body = self.bodies.len();
        let mut own = RigidBody::massless(format!("{name}, motion of {}", motion.joint.name));
        own.mass = inertia;
        // An inertia that lags behind would take part in a jump at the start.
        own.velocity.x = self.rate_of(&motion.joint, motion.dof);
        own.mobility = Mobility::carrier(1);
        own.role = Role::Coordinate;
        self.bodies.push(own);
        self.follow(name, motion, S::zero(), vec![(body, S::one())]);
        body
    }

    /// Adds the row by which a motion, counted from `shift` beyond the placement, follows Σ f_k x_k of coordinates with
    /// their carriers.
    fn follow(
        &mut self,
        name: &str,
        motion: &CoupledMotion<S>,
        shift: S,
        factors: Vec<(usize, S)>,
    ) {
        let joint = &motion.joint;
        let along = |factor: S| Vec3::new(S::zero(), S::zero(), factor);
        let (mut displacement, mut turn) = (Vec::new(), Vec::new());
        for &(_, factor) in &factors {
            let (slides, turns) = match motion.dof {
                DegreeOfFreedom::Rotation => (Vec3::zeros(), along(factor)),
                DegreeOfFreedom::Translation => (along(factor), Vec3::zeros()),
            };
            displacement.push(slides);
            turn.push(turns);
        }
        let own = Joint {
            name: format!("{name} ({})", joint.name),
            kind: JointKind::Coupled(motion.dof),
            frame_b: self.placed_frame(joint, motion.dof, shift),
            drives: Vec::new(),
            redundant: Vec::new(),
            trivial_rows: Vec::new(),
            modes: Some(Modes {
                places: factors.iter().map(|&(carrier, _)| (carrier, 0)).collect(),
                displacement,
                rotation: turn,
                profile: None,
            }),
            ..joint.clone()
        };
        self.joints.push(own);
    }

    /// Frame B of a joint, turned or shifted by `shift` from where the motion is zero at the placement.
    fn placed_frame(&self, joint: &Joint<S>, dof: DegreeOfFreedom, shift: S) -> JointFrame<S> {
        let mut frame = joint.frame_b;
        let [e1, e2, e3] = frame.axes;
        let place = self.place_of(joint, dof) + shift;
        match dof {
            DegreeOfFreedom::Rotation => {
                let (sine, cosine) = place.sin_cos();
                frame.axes = [e1 * cosine + e2 * sine, e2 * cosine - e1 * sine, e3];
            }
            DegreeOfFreedom::Translation => frame.point += e3 * place,
        }
        frame
    }

    /// The rate of [`Model::place_of`] \[rad/s or m/s\].
    fn rate_of(&self, joint: &Joint<S>, dof: DegreeOfFreedom) -> S {
        let motion = |body: Option<usize>, point: &Vec3<S>| match body.map(|b| &self.bodies[b]) {
            Some(own) => {
                let turned = rotation::matrix(&own.orientation);
                let (arm, spin) = (turned * point, turned * own.angular_velocity);
                (own.position + arm, own.velocity + spin.cross(&arm), spin)
            }
            None => (*point, Vec3::zeros(), Vec3::zeros()),
        };
        let (a, speed_a, spin_a) = motion(Some(joint.body_a), &joint.frame_a.point);
        let (b, speed_b, spin_b) = motion(joint.body_b, &joint.frame_b.point);
        let turned = rotation::matrix(&self.bodies[joint.body_a].orientation);
        let axis = turned * joint.frame_a.axes[2];
        match dof {
            DegreeOfFreedom::Rotation => axis.dot(&(spin_a - spin_b)),
            DegreeOfFreedom::Translation => {
                axis.dot(&(speed_a - speed_b)) + spin_a.cross(&axis).dot(&(a - b))
            }
        }
    }

    /// Where frame A of a joint is in frame B at the placement: its angle about e3 in (−π, π] \[rad\], or how far it is along e3
    /// \[m\].
    pub fn place_of(&self, joint: &Joint<S>, dof: DegreeOfFreedom) -> S {
        let a = &self.bodies[joint.body_a];
        let (origin, turned) = match joint.body_b.map(|body| &self.bodies[body]) {
            Some(b) => (b.position, rotation::matrix(&b.orientation)),
            None => (Vec3::zeros(), Mat3::identity()),
        };
        let turn_a = rotation::matrix(&a.orientation);
        let [e1, e2, _] = joint.frame_b.axes;
        match dof {
            DegreeOfFreedom::Rotation => {
                let seen = turned.tr_mul(&(turn_a * joint.frame_a.axes[0]));
                e2.dot(&seen).atan2(e1.dot(&seen))
            }
            DegreeOfFreedom::Translation => {
                let point_a = a.position + turn_a * joint.frame_a.point;
                let d = point_a - origin - turned * joint.frame_b.point;
                (turn_a * joint.frame_a.axes[2]).dot(&d)
            }
        }
    }
}
