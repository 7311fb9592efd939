//! The modes that a file asks for.

use super::Problem;
use super::scene::turning;
use crate::math::Vec3;
use crate::schema::modes::ModeTable;
use crate::system::equilibrium::{MachineModes, modes_of_machine};
use crate::system::failure::AssemblyFailure;

impl Problem {
    /// Which modes are told and drawn; `None` if the file does not ask for any.
    pub fn told_modes(&self) -> Option<ModeTable> {
        self.written.told_modes()
    }

    /// Whether the machine turns steadily, so that it is at rest in a turning frame alone.
    pub fn is_turning(&self) -> bool {
        self.written.turning.is_some() && self.is_rest()
    }

    /// The speed of steady rotation at the design `x` \[rad/s\], if the machine turns.
    pub fn speed(&self, x: &[f64]) -> Option<f64> {
        let x = self.extended(x);
        turning(&self.written, &x).map(|own| own.speed)
    }

    /// The axis of steady rotation, a unit vector.
    pub fn axis(&self) -> Option<Vec3<f64>> {
        let own = self.written.turning.as_ref()?;
        Some(Vec3::from(own.axis).normalize())
    }

    /// At most `count` modes of the machine at the design `x` about its rest, the lowest first; at this speed of rotation
    /// \[rad/s\] if it turns.
    ///
    /// # Errors
    /// There is no rest, or it is not stable.
    pub fn modes_of_machine(
        &self,
        x: &[f64],
        (count, speed): (usize, Option<f64>),
    ) -> Result<MachineModes, AssemblyFailure> {
        let placed = self.without_equilibrium();
        let model = placed.as_ref().unwrap_or(self).as_placed(x);
        let turning = turning(&self.written, &self.extended(x))
            .map(|own| speed.map_or(own.clone(), |speed| own.at_speed(speed)));
        let known = &self.written.known_starts;
        modes_of_machine(&model, known, (turning.as_ref(), count))
    }
}
