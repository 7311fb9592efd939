//! The mechanical model: bodies, joints and gravity with their parameters, and nothing that moves.
//!
//! Parameters are generic in the scalar, so that the same model carries values (`f64`), complex
//! steps or dual numbers. A model of zeros in `f64` also serves as the cotangent of a model:
//! every parameter's place then holds the derivative of a function with respect to it.

pub mod joint;
pub mod rigid_body;

pub use joint::{ConstraintRow, Joint, JointFrame, JointKind};
pub use rigid_body::RigidBody;

use crate::math::{Mat3, Scalar, Vec3};

/// Bodies, joints and gravity of a scene.
#[derive(Clone, Debug)]
pub struct Model<S> {
    /// Gravitational acceleration in ground axes [m/s²].
    pub gravity: Vec3<S>,
    /// Bodies in the order of the problem file.
    pub bodies: Vec<RigidBody<S>>,
    /// Joints in the order of the problem file.
    pub joints: Vec<Joint<S>>,
}

impl<S: Scalar> Model<S> {
    /// All parameters in one fixed order (gravity, bodies, joints).
    pub fn parameters(&self) -> Vec<S> {
        let mut all = Vec::with_capacity(3 + 23 * self.bodies.len() + 24 * self.joints.len());
        all.extend(self.gravity.iter());
        for body in &self.bodies {
            all.push(body.mass);
            all.extend(body.inertia.iter());
            all.extend(body.position.iter());
            all.extend(body.orientation);
            all.extend(body.velocity.iter());
            all.extend(body.angular_velocity.iter());
        }
        for joint in &self.joints {
            for frame in [&joint.frame_a, &joint.frame_b] {
                all.extend(frame.point.iter());
                all.extend(frame.axes.iter().flat_map(|axis| axis.iter()));
            }
        }
        all
    }

    /// The cotangent of this model: same bodies and joints, every parameter zero.
    pub fn zero_cotangent(&self) -> Model<f64> {
        Model {
            gravity: Vec3::zeros(),
            bodies: self
                .bodies
                .iter()
                .map(|body| RigidBody {
                    name: body.name.clone(),
                    mass: 0.0,
                    inertia: Mat3::zeros(),
                    position: Vec3::zeros(),
                    orientation: [0.0; 4],
                    velocity: Vec3::zeros(),
                    angular_velocity: Vec3::zeros(),
                })
                .collect(),
            joints: self
                .joints
                .iter()
                .map(|joint| Joint {
                    name: joint.name.clone(),
                    kind: joint.kind,
                    body_a: joint.body_a,
                    body_b: joint.body_b,
                    frame_a: JointFrame::zero(),
                    frame_b: JointFrame::zero(),
                })
                .collect(),
        }
    }
}
