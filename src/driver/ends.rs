//! The designs that figures and pages show, by what they are.

use super::analysed::{InCases, Simulated};
use super::optimise::Optimisation;
use super::simulate::Simulation;
use super::statics::StaticDesign;
use crate::optimiser::Status;
use crate::problem::Case;

/// Designs with their titles, such as `optimal design`: those in motion, and structures at rest; or those of each case.
#[derive(Default)]
pub struct Ends<'a> {
    pub motions: Vec<(&'a str, &'a Simulation)>,
    pub structures: Vec<(&'a str, &'a StaticDesign)>,
    pub cases: Vec<(&'a Case, Ends<'a>)>,
    /// The last design in all cases, if there are some.
    pub in_cases: Option<&'a InCases<Simulated>>,
}

impl<'a> Ends<'a> {
    /// The start and the end of an optimisation, as far as they could be simulated; the end is an optimum if the
    /// optimisation `converged`.
    pub fn new(start: Option<&'a Simulated>, end: Option<&'a Simulated>, converged: bool) -> Self {
        let last = match converged {
            true => "optimal design",
            false => "last design",
        };
        Self::titled(&[("initial design", start), (last, end)])
    }

    /// A design alone.
    pub fn of(own: &'a Simulated) -> Self {
        Self::titled(&[("", Some(own))])
    }

    fn titled(designs: &[(&'a str, Option<&'a Simulated>)]) -> Self {
        let mut all = Self::default();
        for &(title, design) in designs {
            match design {
                Some(Simulated::Motion(own)) => all.motions.push((title, own)),
                Some(Simulated::Statics(own)) => all.structures.push((title, own)),
                Some(Simulated::Cases(own)) => all.in_cases = Some(own),
                None => {}
            }
        }
        let Some(last) = all.in_cases else {
            return all;
        };
        let in_case = |c: usize, design: Option<&'a Simulated>| match design {
            Some(Simulated::Cases(own)) => own.list[c].as_ref(),
            _ => None,
        };
        let of_case = |(c, case): (usize, &'a Case)| {
            let designs = designs.iter();
            let designs: Vec<_> = designs
                .map(|&(title, own)| (title, in_case(c, own)))
                .collect();
            (case, Self::titled(&designs))
        };
        all.cases = last.cases.list.iter().enumerate().map(of_case).collect();
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
            ..Self::default()
        }
    }

    /// A structure alone.
    pub fn of_structure(own: &'a StaticDesign) -> Self {
        Self {
            structures: vec![("", own)],
            ..Self::default()
        }
    }
}
