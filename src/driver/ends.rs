//! The designs that figures and pages show, by what they are.

use super::analysed::Simulated;
use super::optimise::Optimisation;
use super::simulate::Simulation;
use super::statics::StaticDesign;
use crate::optimiser::Status;

/// Designs with their titles, such as `optimal design`: those in motion, and structures at rest.
#[derive(Default)]
pub struct Ends<'a> {
    pub motions: Vec<(&'a str, &'a Simulation)>,
    pub structures: Vec<(&'a str, &'a StaticDesign)>,
}

impl<'a> Ends<'a> {
    /// The start and the end of an optimisation, as far as they could be simulated; the end is an optimum if the
    /// optimisation `converged`.
    pub fn new(start: Option<&'a Simulated>, end: Option<&'a Simulated>, converged: bool) -> Self {
        let last = match converged {
            true => "optimal design",
            false => "last design",
        };
        let mut all = Self::default();
        for (title, end) in [("initial design", start), (last, end)] {
            match end {
                Some(Simulated::Motion(own)) => all.motions.push((title, own)),
                Some(Simulated::Statics(own)) => all.structures.push((title, own)),
                None => {}
            }
        }
        all
    }

    /// The ends of an optimisation.
    pub fn of_optimisation(done: &'a Optimisation) -> Self {
        let converged = done.outcome.status == Status::Converged;
        Self::new(done.start.as_ref(), done.end.as_ref(), converged)
    }

    /// A motion alone.
    pub fn of_motion(own: &'a Simulation) -> Self {
        Self {
            motions: vec![("", own)],
            structures: Vec::new(),
        }
    }

    /// A structure alone.
    pub fn of_structure(own: &'a StaticDesign) -> Self {
        Self {
            motions: Vec::new(),
            structures: vec![("", own)],
        }
    }
}
