//! Modes of a machine for people: frequencies, damping, whirl and shapes.
//!
//! A mode y e^{iωt} that a frame sees which turns with Ω moves the complex displacement z = u_1 + i u_2 across the axis by
//! two parts that circle in opposite senses,
//!
//! ```text
//! z = ½ (y_1 + i y_2) e^{iωt} + ½ (ȳ_1 + i ȳ_2) e^{−iωt},
//! ```
//!
//! which the fixed frame sees at the rates Ω + ω and Ω − ω. Where one of them is larger by far, its rate is the frequency
//! of the mode in the fixed frame, and its sign tells forward from backward whirl.

use super::critical::Machine;
use super::damped::Spectrum;
use super::equations::State;
use super::turning::Turning;
use super::{KnownStarts, Solver, Sought, WantedModes, with_solution, without_spin};
use crate::math::{Complex64, Vec3};
use crate::model::Model;
use crate::system::bodies::BodyMotion;
use crate::system::failure::AssemblyFailure;
use crate::system::numbering::Numbering;
use std::f64::consts::PI;

/// One sense of circling is that of a mode if it has this part of the squares of displacements across the axis.
const CIRCLES: f64 = 0.9;
/// Displacements across the axis count if they have this part of all.
const ACROSS: f64 = 0.5;

/// The sense in which a mode circles the axis of rotation in the fixed frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whirl {
    /// As the machine turns.
    Forward,
    /// Against the rotation.
    Backward,
}

/// A mode of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineMode {
    /// Frequency |Im s| / 2π as the machine, or the turning frame, sees it \[Hz\].
    pub frequency: f64,
    /// Damping ratio −Re s / |s|.
    pub damping_ratio: f64,
    /// Whirl, with its frequency in the fixed frame \[Hz\]; `None` without rotation, or if the mode does not circle the axis.
    pub whirl: Option<(Whirl, f64)>,
    /// Small changes of the positions of all bodies, as velocities are numbered, of any size and phase.
    pub shape: Vec<Complex64>,
}

/// The lowest modes of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineModes {
    /// The modes, the lowest |s| first.
    pub modes: Vec<MachineMode>,
    /// The fastest growth of a motion \[1/s\], of machines with many coordinates among these modes and motions of their sizes that do
    /// not oscillate; `None` if none grows.
    pub growth: Option<f64>,
}

/// The modes of a machine about rest, or about steady rotation, at most `count`, the lowest |s| first. The bodies of `model` are placed and
/// undeformed.
///
/// # Errors
/// No rest, or a rest that is not stable.
pub fn modes_of_machine(
    model: &Model<f64>,
    known: &KnownStarts,
    (turning, count): (Option<&Turning<f64>>, usize),
) -> Result<MachineModes, AssemblyFailure> {
    let own = without_spin(model);
    let numbering = Numbering::new(&own);
    let machine: Machine<f64> = (&own, &numbering, known);
    let of = (machine.0, machine.1, Sought::Rest);
    with_solution(of, turning, known, |_, solver, found| {
        let wanted = WantedModes {
            count,
            ..WantedModes::default()
        };
        let spectrum = solver.spectrum(found, &wanted, (true, false))?;
        Ok(MachineModes {
            growth: solver.fastest_growth(found, &spectrum)?,
            modes: solver.machine_modes(found, &spectrum),
        })
    })
}

impl Solver<'_> {
    fn machine_modes(&self, found: &State<f64>, spectrum: &Spectrum) -> Vec<MachineMode> {
        let layout = self.layout;
        let motions = layout.at_rest(&found.q);
        let one = |(c, k): (usize, usize)| {
            let own = &spectrum.clusters[c];
            let (s, right) = (own.values[k], &own.right[k]);
            let part = |of: fn(&Complex64) -> f64| {
                let n = layout.numbering.unknowns();
                layout.expanded(right[..n].iter().map(of).collect::<Vec<f64>>())
            };
            let [re, im] = [part(|x| x.re), part(|x| x.im)];
            let shape: Vec<Complex64> = (re.iter().zip(&im))
                .map(|(&re, &im)| Complex64::new(re, im))
                .collect();
            MachineMode {
                frequency: s.im / (2.0 * PI),
                damping_ratio: -s.re / s.norm(),
                whirl: (self.given.turning.as_ref())
                    .and_then(|turning| self.whirl((turning, s.im), &motions, &shape)),
                shape,
            }
        };
        spectrum.order().into_iter().map(one).collect()
    }

    /// The whirl of a mode with the rate ω in the turning frame.
    fn whirl(
        &self,
        (turning, rate): (&Turning<f64>, f64),
        motions: &[BodyMotion<f64>],
        shape: &[Complex64],
    ) -> Option<(Whirl, f64)> {
        let (speed, axis) = (turning.speed, turning.axis);
        if speed <= 0.0 {
            return None;
        }
        let first = axis.cross(&Vec3::ith(axis.iamin(), 1.0)).normalize();
        let second = axis.cross(&first);
        let i = Complex64::new(0.0, 1.0);
        let (mut circling, mut along) = ([0.0; 2], 0.0);
        for body in (0..self.model.bodies.len()).filter(|&i| !self.model.is_carrier(i)) {
            let o = self.layout.numbering.velocity(body);
            let three = |at: usize| Vec3::from_fn(|j, _| shape[at + j]);
            let rotation = motions[body].rotation.map(|x| Complex64::new(x, 0.0));
            // Rotations as displacements at the length of the scene.
            let parts = [(three(o), 1.0), (rotation * three(o + 3), self.scale)];
            for (own, size) in parts {
                let by = |axis: &Vec3<f64>| {
                    let parts = own.iter().zip(axis.iter());
                    parts.map(|(x, a)| x * a).sum::<Complex64>() * size
                };
                let (y, z) = (by(&first), by(&second));
                circling[0] += (y + i * z).norm_sqr() / 2.0;
                circling[1] += (y - i * z).norm_sqr() / 2.0;
                along += by(&axis).norm_sqr();
            }
        }
        let across = circling[0] + circling[1];
        if across < ACROSS * (across + along) || circling[0].max(circling[1]) < CIRCLES * across {
            return None;
        }
        let fixed = if circling[0] > circling[1] {
            speed + rate
        } else {
            speed - rate
        };
        let whirl = if fixed < 0.0 {
            Whirl::Backward
        } else {
            Whirl::Forward
        };
        Some((whirl, fixed.abs() / (2.0 * PI)))
    }
}
