//! How a joint's frame moves on its body.

use super::marker::RelativeMotion;
use crate::math::Scalar;
use crate::model::JointFrame;

/// First and second derivative in time of a frame, and its virtual rate, in the axes of its body.
#[derive(Clone, Debug)]
pub struct FrameMotion<S> {
    /// First derivative.
    pub rate: JointFrame<S>,
    /// Second derivative.
    pub acceleration: JointFrame<S>,
    /// The rate that virtual velocities make.
    pub virtual_rate: JointFrame<S>,
}

impl<S: Scalar> FrameMotion<S> {
    /// All zero.
    pub fn zero() -> Self {
        Self {
            rate: JointFrame::zero(),
            acceleration: JointFrame::zero(),
            virtual_rate: JointFrame::zero(),
        }
    }

    /// The motion of axis i.
    pub fn axis(&self, i: usize) -> RelativeMotion<S> {
        RelativeMotion {
            rate: self.rate.axes[i],
            acceleration: self.acceleration.axes[i],
            virtual_rate: self.virtual_rate.axes[i],
        }
    }

    /// The motion of the point.
    pub fn point(&self) -> RelativeMotion<S> {
        RelativeMotion {
            rate: self.rate.point,
            acceleration: self.acceleration.point,
            virtual_rate: self.virtual_rate.point,
        }
    }
}
