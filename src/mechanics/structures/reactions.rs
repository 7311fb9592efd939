//! Reactions: forces and moments of the supports on a set of nodes, and their partial derivatives.
//!
//! R = F(v) − f at the nodes, F the internal forces, f the loads; its work in a rigid motion
//! ψ = (d + m × (x − o), m) is the force along d and the moment about the axis m through o. The
//! adjoint product has the difference of ψ and the adjoint: each jumps at the supports, their
//! difference does not, so nothing cancels.

use super::assembly::{Assembly, add_energy_transpose};
use super::loads::{Load, add_work_transpose};
use super::mesh::UnknownSet;
use super::shell::Terms;
use super::state::{Configuration, Cotangent, NodalMotion};
use super::structure::Structure;
use crate::math::{Dual, Scalar, Vec3};

/// Where reactions are summed, and the rigid motion that they work in.
pub(super) struct Reaction<'a> {
    pub case: usize,
    pub nodes: &'a str,
    /// Direction d.
    pub force: Vec3<f64>,
    /// Axis m.
    pub moment: Vec3<f64>,
    /// Point o \[m\].
    pub about: Vec3<f64>,
}

/// A load case and its solution.
pub(super) struct State<'a, S> {
    pub x: &'a [S],
    pub case: &'a [Load<S>],
    pub terms: Terms,
}

impl Reaction<'_> {
    /// ψ at the nodes of the set, and at all others what their unknowns admit of it. In equilibrium
    /// R vanishes along the unknowns, so this only affects rounding: a motion that jumps at the
    /// border of the set would multiply the rounding of the displacements by the stiffness.
    fn virtual_motion<S: Scalar>(
        &self,
        configuration: &Configuration<S>,
    ) -> Result<NodalMotion<S>, UnknownSet> {
        let structure = configuration.structure;
        let mut psi = NodalMotion::zeros(structure.nodes.len());
        let [force, moment, about] = [self.force, self.moment, self.about].map(|v| v.map(S::from));
        let mut inside = vec![false; structure.nodes.len()];
        for &node in structure.topology.mesh.node_set(self.nodes)? {
            inside[node] = true;
        }
        for (node, place) in structure.nodes.iter().enumerate() {
            let displacement = force + moment.cross(&(place - about));
            if inside[node] {
                psi.displacement[node] = displacement;
                psi.rotation[node] = moment;
                continue;
            }
            let free = configuration.unknowns.nodes[node].displacements;
            for k in (0..3).filter(|&k| free[k].is_some()) {
                psi.displacement[node][k] = displacement[k];
            }
            let (axes, count) = configuration.axes(node);
            for axis in &axes[..count] {
                psi.rotation[node] += axis * (axis.dot(&moment) / axis.dot(axis));
            }
        }
        Ok(psi)
    }

    /// The value in a state of a load case.
    pub fn value<S: Scalar>(
        &self,
        configuration: &Configuration<S>,
        state: &State<S>,
    ) -> Result<S, UnknownSet> {
        let psi = self.virtual_motion(configuration)?;
        let (internal, external) = forces(configuration, state)?;
        let mut sum = S::zero();
        for node in 0..psi.displacement.len() {
            let force = internal.displacement[node] - external.displacement[node];
            let moment = internal.rotation[node] - external.rotation[node];
            sum += psi.displacement[node].dot(&force) + psi.rotation[node].dot(&moment);
        }
        Ok(sum)
    }

    /// Adds to the cotangent of the structure that ψ moves with its nodes and directors; gives ψ for the adjoint
    /// product. At nodes outside the set the forces that ψ works with are in equilibrium, but the moments of
    /// what holds a rotation there are not zero.
    pub fn add_transpose(
        &self,
        configuration: &Configuration<f64>,
        state: &State<f64>,
        to: &mut Cotangent<f64>,
    ) -> Result<NodalMotion<f64>, UnknownSet> {
        let (internal, external) = forces(configuration, state)?;
        let mut inside = vec![false; internal.displacement.len()];
        for &node in configuration.structure.topology.mesh.node_set(self.nodes)? {
            let force = internal.displacement[node] - external.displacement[node];
            to.structure.nodes[node] += force.cross(&self.moment);
            inside[node] = true;
        }
        for node in (0..inside.len()).filter(|&node| !inside[node]) {
            let Some(d) = configuration.smooth_director(node) else {
                continue;
            };
            let held = internal.rotation[node] - external.rotation[node];
            let (axes, count) = configuration.axes(node);
            let mut bars = [Vec3::zeros(); 3];
            // Of a (a·m) / (a·a), times the held moment.
            for (bar, a) in bars.iter_mut().zip(&axes[..count]) {
                let (square, by_m, by_held) = (a.norm_squared(), a.dot(&self.moment), a.dot(&held));
                *bar = (held * by_m + self.moment * by_held) / square
                    - a * (2.0 * by_m * by_held / (square * square));
            }
            let at = configuration.structure.topology.sheets.of_node[node].start;
            let rotations = configuration.unknowns.nodes[node].rotations;
            to.directors[at] += rotations.axes_transpose(d, &bars);
        }
        self.virtual_motion(configuration)
    }
}

/// Internal and external forces of a state, at all nodes.
pub(super) fn forces<S: Scalar>(
    configuration: &Configuration<S>,
    state: &State<S>,
) -> Result<(NodalMotion<S>, NodalMotion<S>), UnknownSet> {
    let motion = configuration.spread(state.x);
    let mut internal = NodalMotion::zeros(motion.displacement.len());
    let mut external = internal.clone();
    let mut to = configuration.cotangent();
    add_energy_transpose(configuration, &motion, state.terms, &mut internal, &mut to);
    for load in state.case {
        let mut load_to = load.map(|_| S::zero());
        add_work_transpose(
            configuration,
            load,
            &motion,
            &mut external,
            &mut to,
            &mut load_to,
        )?;
    }
    Ok((internal, external))
}

/// K ψ, the derivative of ψ·F by the motion.
pub(super) fn stiffness_times(
    structure: &Structure<f64>,
    assembly: &Assembly,
    motion: &NodalMotion<f64>,
    psi: &NodalMotion<f64>,
    terms: Terms,
) -> NodalMotion<f64> {
    let lifted = structure.map(Dual::from);
    let configuration = assembly.configuration(&lifted);
    let mut disturbed = motion.map(Dual::from);
    disturbed.add_scaled(&psi.map(Dual::from), Dual::new(0.0, 1.0));
    let mut force = NodalMotion::zeros(structure.nodes.len());
    let to = &mut configuration.cotangent();
    add_energy_transpose(&configuration, &disturbed, terms, &mut force, to);
    force.map(|x| x.du)
}
