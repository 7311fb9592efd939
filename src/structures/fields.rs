//! Fields of solutions over the elements, for pictures and files.

use super::functions::Solved;
use super::shell::STRESS_POINTS;

impl Solved<'_, f64> {
    /// σ_v / σ_yield of each shell in a load case, at both faces of its Gauss points.
    pub(crate) fn stress_field(&self, case: usize) -> Vec<[f64; STRESS_POINTS]> {
        let configuration = self.configuration();
        let motion = configuration.spread(&self.solutions[case]);
        let shells = self.structure.topology.mesh.shells.iter().enumerate();
        shells
            .map(|(index, element)| {
                let v = motion.of_element(element);
                configuration.shell(index).stress_ratios(&v, self.terms)
            })
            .collect()
    }
}
