//! Fields of solutions over the elements, for pictures and files.

use super::beam::{BEAM_NODES, Beam};
use super::functions::Solved;
use super::shell::STRESS_POINTS;

impl Solved<'_, f64> {
    /// σ_v / σ_yield of each shell in a load case, at both faces of its Gauss points.
    pub fn stress_field(&self, case: usize) -> Vec<[f64; STRESS_POINTS]> {
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

    /// Each beam in a load case, with the displacement and the rotation of each of its nodes in turn.
    pub fn beam_fields(&self, case: usize) -> Vec<(Beam<f64>, [f64; 6 * BEAM_NODES])> {
        let configuration = self.configuration();
        let motion = configuration.spread(&self.solutions[case]);
        let one = |(index, element): (usize, &[usize; BEAM_NODES])| {
            let own = motion.of_beam(element);
            let q = std::array::from_fn(|i| match i % 6 {
                k @ 0..3 => own.displacement[i / 6][k],
                k => own.rotation[i / 6][k - 3],
            });
            (configuration.beam(index), q)
        };
        configuration.beams().map(one).collect()
    }
}
