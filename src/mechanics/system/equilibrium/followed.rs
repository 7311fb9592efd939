//! Modes that are followed by their shapes while the design changes: of those at a design, the one whose shape y is most like
//! the shape r that the mode had at the first design,
//!
//! ```text
//! MAC = |rᴴ M y|² / ((rᴴ M r) (yᴴ M y))     (Allemang & Brown 1982)
//! ```
//!
//! with the mass M of the design. So its frequency is smooth where it crosses that of another mode.

use super::damped::{DampedVibration, Spectrum};
use super::equations::State;
use super::modes::{Mode, Vibration};
use super::{KnownStarts, Solver};
use crate::math::{Complex64, Scalar};
use crate::structures::modes::{LIKE, ModalFailure};
use crate::system::failure::AssemblyFailure;
use std::f64::consts::PI;

/// A mode that is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follow {
    /// Its number from 0 at the first design.
    pub number: usize,
    /// Whether it is one with damping.
    pub damped: bool,
}

/// The shape of a followed mode at the first design, by unknowns of velocity.
#[derive(Clone, Debug)]
pub(super) struct FirstShape {
    of: Follow,
    shape: Vec<Complex64>,
}

/// The shapes of modes, without multipliers.
pub(super) fn shapes_of_modes(modes: &[Mode], unknowns: usize) -> Vec<Vec<Complex64>> {
    let one = |mode: &Mode| {
        let shape = mode.shape[..unknowns].iter();
        shape.map(|&y| Complex64::new(y, 0.0)).collect()
    };
    modes.iter().map(one).collect()
}

/// The shapes of a spectrum in its order.
pub(super) fn shapes_of_spectrum(spectrum: &Spectrum, unknowns: usize) -> Vec<Vec<Complex64>> {
    let order = spectrum.order().into_iter();
    order
        .map(|(c, k)| spectrum.clusters[c].right[k][..unknowns].to_vec())
        .collect()
}

/// A natural vibration as one without decay.
pub(super) fn as_damped<S: Scalar>(own: &Vibration<S>) -> DampedVibration<S> {
    DampedVibration {
        growth: S::zero(),
        speed: own.frequency * (2.0 * PI),
        repeated: own.repeated,
    }
}

impl Solver<'_> {
    /// The place of a followed mode among those of these shapes. At the first design its number tells it, and its shape
    /// becomes known.
    ///
    /// # Errors
    /// No mode is like it.
    pub(super) fn follow(
        &self,
        found: &State<f64>,
        of: Follow,
        shapes: &[Vec<Complex64>],
    ) -> Result<usize, AssemblyFailure> {
        let Some(first) = self.known.first_shape(of, shapes) else {
            return Ok(of.number);
        };
        let motions = self.layout.at_rest(&found.q);
        let heavy = |shape: &[Complex64]| -> Vec<Complex64> {
            let part = |of: fn(&Complex64) -> f64| {
                let y: Vec<f64> = shape.iter().map(of).collect();
                self.layout.mass_product(self.model, &motions, &y)
            };
            let [re, im] = [part(|x| x.re), part(|x| x.im)];
            re.into_iter()
                .zip(im)
                .map(|(re, im)| Complex64::new(re, im))
                .collect()
        };
        let between = |a: &[Complex64], b: &[Complex64]| -> Complex64 {
            a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
        };
        let heavy_first = heavy(&first);
        let size = between(&first, &heavy_first).re;
        let assurance = |shape: &Vec<Complex64>| {
            between(shape, &heavy_first).norm_sqr() / (size * between(shape, &heavy(shape)).re)
        };
        let all = shapes.iter().map(assurance).enumerate();
        let best = all.max_by(|a, b| a.1.total_cmp(&b.1));
        match best {
            Some((k, like)) if like >= LIKE => Ok(k),
            _ => {
                let unlike = ModalFailure::Unlike {
                    mode: of.number + 1,
                    assurance: best.map_or(0.0, |own| own.1),
                };
                Err(AssemblyFailure::NoModes {
                    why: unlike.to_string(),
                })
            }
        }
    }
}

impl KnownStarts {
    /// The first shape of a followed mode; `None` if these are the first ones.
    fn first_shape(&self, of: Follow, shapes: &[Vec<Complex64>]) -> Option<Vec<Complex64>> {
        let own = shapes.get(of.number)?;
        let mut known = self.0.lock().ok()?;
        let same = |first: &&FirstShape| first.of == of && first.shape.len() == own.len();
        if let Some(first) = known.first_shapes.iter().find(same) {
            return Some(first.shape.clone());
        }
        let shape = own.clone();
        known.first_shapes.push(FirstShape { of, shape });
        None
    }
}
