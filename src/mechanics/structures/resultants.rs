//! Resultants of loads and of supports, for pictures.

use super::functions::{Solved, zero_load};
use super::loads::add_work_transpose;
use super::mesh::UnknownSet;
use super::reactions::forces;
use super::state::NodalMotion;
use crate::math::Vec3;

/// A force and where it is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Resultant {
    /// The mean of the nodes, weighted by the sizes of their forces \[m\].
    pub point: Vec3<f64>,
    /// The sum of the forces \[N\].
    pub force: Vec3<f64>,
}

impl Resultant {
    fn of(nodes: &[Vec3<f64>], forces: impl Iterator<Item = (usize, Vec3<f64>)>) -> Self {
        let (mut point, mut force, mut sizes) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for (node, f) in forces {
            force += f;
            point += nodes[node] * f.norm();
            sizes += f.norm();
        }
        if sizes > 0.0 {
            point /= sizes;
        }
        Self { point, force }
    }
}

impl Solved<'_, f64> {
    /// The resultant of each load of a case.
    ///
    /// # Errors
    /// [`UnknownSet`] if a load names no set of the mesh.
    pub fn of_loads(&self, case: usize) -> Result<Vec<Resultant>, UnknownSet> {
        let configuration = self.configuration();
        let motion = configuration.spread(&self.solutions[case]);
        let of = |load| {
            let mut force = NodalMotion::zeros(self.structure.nodes.len());
            let mut to = configuration.cotangent();
            let mut load_to = zero_load(load);
            add_work_transpose(
                &configuration,
                load,
                &motion,
                &mut force,
                &mut to,
                &mut load_to,
            )?;
            let all = force.displacement.into_iter().enumerate();
            Ok(Resultant::of(&self.structure.nodes, all))
        };
        self.cases[case].iter().map(of).collect()
    }

    /// The resultant of the supports on each of some sets of nodes; a node counts in the first set that has it.
    ///
    /// # Errors
    /// [`UnknownSet`] if there is no such set.
    pub fn of_supports(&self, case: usize, sets: &[&str]) -> Result<Vec<Resultant>, UnknownSet> {
        let (internal, external) = forces(&self.configuration(), &self.state(case))?;
        let mut counted = vec![false; self.structure.nodes.len()];
        let of = |set: &&str| {
            let nodes = self.structure.topology.mesh.node_set(set)?.iter();
            let new = nodes.filter(|&&node| !std::mem::replace(&mut counted[node], true));
            let forces = new.map(|&node| {
                let force = internal.displacement[node] - external.displacement[node];
                (node, force)
            });
            Ok(Resultant::of(&self.structure.nodes, forces))
        };
        sets.iter().map(of).collect()
    }
}
