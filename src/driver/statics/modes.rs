//! Modes of structures at a design: the lowest ones, aggregates of them, and those that are followed by their shapes.

use super::{StaticDesign, StaticsFailure, of_modes};
use crate::problem::{Asked, Problem};
use crate::structures::modes::{BEYOND, LIKE, ModalFailure, lowest_frequency};

impl StaticDesign {
    /// Finds the modes that the functions `which` need.
    pub(super) fn find_modes(
        &mut self,
        problem: &Problem,
        which: &[usize],
    ) -> Result<(), StaticsFailure> {
        let statics = self.statics.clone();
        let lowest = which.iter().filter_map(|&f| match statics.functions[f] {
            Asked::LowestFrequency(rho) => Some((f, rho)),
            _ => None,
        });
        for (f, rho) in lowest {
            let structure = self.scene.structure.clone();
            let modal = of_modes(self.workspace(), &statics, &structure)?;
            let found = lowest_frequency(modal, &structure, rho)?;
            self.counts.factorisations += found.modes.work.factorisations;
            self.counts.solves += found.modes.work.solves;
            self.lowest[f] = Some(found);
        }
        let single = which.iter().filter_map(|&f| match statics.functions[f] {
            Asked::Frequency { mode, follow } => Some((f, mode, follow)),
            _ => None,
        });
        let single: Vec<(usize, usize, bool)> = single.collect();
        let Some(highest) = single.iter().map(|own| own.1).max() else {
            return Ok(());
        };
        let follows = single.iter().any(|own| own.2);
        let structure = self.scene.structure.clone();
        let modal = of_modes(self.workspace(), &statics, &structure)?;
        // A derivative needs the next mode too, if there is one.
        let beyond = if follows { BEYOND } else { 0 };
        let found = modal.solve_at_most(&structure, highest + 2 + beyond)?;
        let (asked, there) = (highest + 1, found.eigenvalues.len());
        if there < asked {
            return Err(ModalFailure::TooMany { asked, there }.into());
        }
        self.counts.factorisations += found.work.factorisations;
        self.counts.solves += found.work.solves;
        if follows {
            self.remember_first(problem, &found.vectors)?;
        }
        let first = statics.first_shapes.get().map_or(&[][..], |own| own);
        for (f, mode, _) in single.into_iter().filter(|own| own.2) {
            let modal = of_modes(self.workspace(), &statics, &structure)?;
            let shape = first.get(mode).ok_or(ModalFailure::TooMany {
                asked: mode + 1,
                there: first.len(),
            })?;
            // Those whose derivative is known: the last one may be one of several.
            let known = match found.all {
                true => &found.vectors[..],
                false => &found.vectors[..there - 1],
            };
            let all = modal.assurances(shape, known).into_iter().enumerate();
            let (place, assurance) = all
                .max_by(|a, b| a.1.total_cmp(&b.1))
                .expect("there are modes");
            if assurance < LIKE {
                let mode = mode + 1;
                return Err(ModalFailure::Unlike { mode, assurance }.into());
            }
            self.places[f] = Some(place);
        }
        self.modes = Some(found);
        Ok(())
    }

    /// Keeps the modes of the start.
    fn remember_first(
        &self,
        problem: &Problem,
        present: &[Vec<f64>],
    ) -> Result<(), StaticsFailure> {
        let statics = &self.statics;
        if statics.first_shapes.get().is_some() {
            return Ok(());
        }
        let start = problem.start();
        if self.x == start {
            statics.first_shapes.get_or_init(|| present.to_vec());
            return Ok(());
        }
        let follows = |own: &Asked| matches!(own, Asked::Frequency { follow: true, .. });
        let all = statics.functions.iter().enumerate();
        let which: Vec<usize> = all
            .filter(|(_, own)| follows(own))
            .map(|own| own.0)
            .collect();
        Self::of(problem, statics, &start, Some(&which)).map(|_| ())
    }

    /// The number from 0 of the mode whose frequency a function is.
    ///
    /// # Panics
    /// The function is no frequency.
    pub(super) fn mode_of(&self, f: usize) -> usize {
        match (self.places[f], &self.statics.functions[f]) {
            (Some(place), _) => place,
            (None, Asked::Frequency { mode, .. }) => *mode,
            _ => unreachable!("only frequencies have a mode"),
        }
    }
}
