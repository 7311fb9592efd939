//! Frequencies and damping ratios of a machine about its state at an instant, see [`crate::system::equilibrium`].

use crate::math::Scalar;
use crate::system::equilibrium::DampedVibration;
use std::f64::consts::PI;

/// What is told of a vibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VibrationPart {
    /// Frequency |Im s| / 2π \[Hz\].
    Frequency,
    /// Damping ratio −Re s / |s|.
    DampingRatio,
}

/// A number of a vibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OfVibration {
    /// Its number from 0, the lowest |s| first.
    pub mode: usize,
    /// The number.
    pub part: VibrationPart,
}

impl OfVibration {
    /// The number of a vibration.
    pub(super) fn of<S: Scalar>(self, vibration: &DampedVibration<S>) -> S {
        match self.part {
            VibrationPart::Frequency => vibration.frequency(),
            VibrationPart::DampingRatio => vibration.damping_ratio(),
        }
    }

    /// Its derivatives by Re s and Im s.
    pub(super) fn slopes(self, vibration: &DampedVibration<f64>) -> [f64; 2] {
        let (growth, speed) = (vibration.growth, vibration.speed);
        let cube = growth.hypot(speed).powi(3);
        match self.part {
            VibrationPart::Frequency => [0.0, 0.5 / PI],
            VibrationPart::DampingRatio => [-speed * speed / cube, growth * speed / cube],
        }
    }
}
