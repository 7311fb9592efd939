//! Data of a solved design for figures and texts.

use super::{StaticDesign, StaticsFailure, of_modes};
use crate::math::Vec3;
use crate::structures::modes::Modes;
use crate::structures::statics::StaticProblem;

impl StaticDesign {
    /// Modes that were found for some function.
    pub fn some_modes(&self) -> Option<&Modes> {
        let lowest = self.lowest.iter().flatten().map(|found| &found.modes);
        let all = self.modes.iter().chain(lowest);
        all.max_by_key(|modes| modes.vectors.len())
    }

    /// The `count` lowest modes besides rigid motions, or all if there are fewer.
    ///
    /// # Errors
    /// Modes are not found.
    pub fn lowest_modes(&mut self, count: usize) -> Result<Modes, StaticsFailure> {
        let (statics, structure) = (self.statics.clone(), self.scene.structure.clone());
        let modal = of_modes(self.workspace(), &statics, &structure)?;
        let count = count.min(modal.unknowns());
        Ok(modal.solve_at_most(&structure, count)?)
    }

    /// The displacements of the nodes in a mode.
    pub fn motion_of_mode(&self, x: &[f64]) -> Option<Vec<Vec3<f64>>> {
        let workspace = self.shared();
        let modal = workspace.modal.as_ref()?;
        Some(modal.motion(&self.scene.structure, x).displacement)
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        let workspace = self.shared();
        workspace
            .statics
            .as_ref()
            .map_or(0, StaticProblem::unknowns)
    }

    /// Entries of the factor of the stiffness, if it was made.
    pub fn factor_entries(&self) -> Option<usize> {
        let workspace = self.shared();
        workspace
            .statics
            .as_ref()
            .map(StaticProblem::factor_entries)
    }
}
