//! Joints that open or close and loads that go off at an event of a motion.
//!
//! An open joint has no rows: its kind is [`JointKind::Free`], so what is measured at its frames keeps its meaning. A joint
//! that closes holds the relative pose that its bodies have then: its frame on body B becomes that on body A,
//!
//! ```text
//! s_B = R_Bᵀ (r_A + R_A s_A − r_B),     e_B = R_Bᵀ R_A e_A,
//! ```
//!
//! and a rod keeps the distance of its points. So no body moves when a joint closes. A drive that comes on goes on from
//! where its joint is: its course is shifted by a constant.

use super::controller::{Coordinate, Regime};
use super::{Drive, Joint, JointKind, LoadKind, Model, TimeFunction};
use crate::math::{Mat3, Scalar, Vec3, rotation};

impl<S: Scalar> Model<S> {
    /// Opens a joint. Its drives, the loads that act through it, and the feedback by it go with it: its coordinates depend on
    /// the choice of its frames once its bodies have turned apart.
    pub fn open(&mut self, joint: usize) {
        let own = &mut self.joints[joint];
        own.kind = JointKind::Free;
        own.drives.clear();
        for load in &mut self.loads {
            if load.kind.joint() == Some(joint) {
                load.kind.switch_off();
            } else if let LoadKind::Controller(own) = &mut load.kind {
                for own in &mut own.feedback {
                    if matches!(own.coordinate, Coordinate::Joint { joint: by, .. } if by == joint)
                    {
                        (own.proportional, own.derivative) = (S::zero(), S::zero());
                    }
                }
            }
        }
    }

    /// Lets the functions of time of loads and drives count from `start` \[s\]; see [`TimeFunction::since`].
    pub fn begin_at(&mut self, start: S) {
        let drives = self.joints.iter_mut().flat_map(|joint| &mut joint.drives);
        for drive in drives {
            drive.course = drive.course.since(start);
        }
        for load in &mut self.loads {
            match &mut load.kind {
                LoadKind::Force { magnitude, .. } | LoadKind::Torque { magnitude, .. } => {
                    *magnitude = magnitude.since(start);
                }
                LoadKind::Distributed(own) => own.magnitude = own.magnitude.since(start),
                LoadKind::Cable(own) => own.length = own.length.since(start),
                LoadKind::Controller(own) => {
                    let courses = own.feedback.iter_mut().map(|own| &mut own.reference);
                    for course in courses.chain([&mut own.feed_forward]) {
                        *course = course.since(start);
                    }
                }
                LoadKind::Spring { .. }
                | LoadKind::TorsionSpring { .. }
                | LoadKind::Damping { .. }
                | LoadKind::BallDamping { .. }
                | LoadKind::Bushing { .. }
                | LoadKind::Friction { .. }
                | LoadKind::Drag { .. }
                | LoadKind::JointStop { .. }
                | LoadKind::DistanceStop { .. }
                | LoadKind::Contact(_) => {}
            }
        }
    }

    /// Shifts the courses of the drives of a joint so that they begin where the poses of its bodies are.
    pub fn resume_drives(&mut self, joint: usize) {
        let own = &self.joints[joint];
        let place =
            |drive: &Drive<S>| self.place_of(own, drive.dof) - drive.course.value(S::zero());
        let shifts: Vec<S> = own.drives.iter().map(place).collect();
        for (drive, by) in self.joints[joint].drives.iter_mut().zip(shifts) {
            drive.course = drive.course.shifted(by);
        }
    }

    /// Closes a joint at the poses of its bodies. Its coordinates are zero there, and its loads count turns from there.
    pub fn close(&mut self, joint: usize) {
        let pose = |body: Option<usize>| match body {
            Some(body) => {
                let body = &self.bodies[body];
                (body.position, rotation::matrix(&body.orientation))
            }
            None => (Vec3::zeros(), Mat3::identity()),
        };
        let Joint { body_a, body_b, .. } = self.joints[joint];
        let ((r_a, turned_a), (r_b, turned_b)) = (pose(Some(body_a)), pose(body_b));
        let own = &mut self.joints[joint];
        let point = r_a + turned_a * own.frame_a.point;
        if own.kind == JointKind::Rod {
            let d = point - (r_b + turned_b * own.frame_b.point);
            own.frame_a.length = d.dot(&d).sqrt();
            return;
        }
        own.frame_b.point = turned_b.tr_mul(&(point - r_b));
        own.frame_b.axes = own.frame_a.axes.map(|e| turned_b.tr_mul(&(turned_a * e)));
        for load in &self.loads {
            for (_, counter) in load.kind.counters().filter(|own| own.0 == joint) {
                self.bodies[counter].position.x = S::zero();
            }
        }
    }
}

impl<S: Scalar> LoadKind<S> {
    /// Takes the strength from a load: it has neither force nor energy.
    pub fn switch_off(&mut self) {
        let zero = S::zero();
        match self {
            LoadKind::Force { magnitude, .. } | LoadKind::Torque { magnitude, .. } => {
                *magnitude = TimeFunction::constant(zero);
            }
            LoadKind::Distributed(own) => own.magnitude = TimeFunction::constant(zero),
            LoadKind::Spring {
                stiffness,
                cubic,
                damping,
                tables,
                ..
            }
            | LoadKind::TorsionSpring {
                stiffness,
                cubic,
                damping,
                tables,
                ..
            } => {
                (*stiffness, *cubic, *damping) = (zero, zero, zero);
                tables
                    .iter_mut()
                    .flatten()
                    .for_each(|own| own.forces.fill(zero));
            }
            LoadKind::Damping {
                coefficient, table, ..
            } => {
                *coefficient = zero;
                table.iter_mut().for_each(|own| own.forces.fill(zero));
            }
            LoadKind::BallDamping { coefficient, .. } => *coefficient = zero,
            LoadKind::Drag {
                coefficient, plate, ..
            } => {
                *coefficient = zero;
                plate.iter_mut().for_each(|own| own.coefficient = zero);
            }
            LoadKind::Bushing {
                stiffness,
                damping,
                friction,
                ..
            } => {
                stiffness.fill(zero);
                damping.fill(zero);
                friction.iter_mut().for_each(|own| own.coefficient = zero);
            }
            LoadKind::Friction { size, .. } => *size = zero,
            LoadKind::JointStop { law, .. } | LoadKind::DistanceStop { law, .. } => {
                law.stiffness = zero;
            }
            LoadKind::Contact(own) => own.law.stiffness = zero,
            LoadKind::Cable(own) => own.law.stiffness = zero,
            LoadKind::Controller(own) => own.regime = Regime::Off,
        }
    }
}
