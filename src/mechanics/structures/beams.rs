//! Beams of a structure: from its numbers to elements and motions of elements, and back.

use super::beam::{BEAM_NODES, Beam, BeamMotion};
use super::shell::{ElementMatrix, Terms};
use super::state::{Configuration, Cotangent, NodalMotion};
use crate::math::Scalar;

impl<S: Scalar> NodalMotion<S> {
    pub fn of_beam(&self, element: &[usize; BEAM_NODES]) -> BeamMotion<S> {
        BeamMotion {
            displacement: element.map(|node| self.displacement[node]),
            rotation: element.map(|node| self.rotation[node]),
        }
    }

    /// Transpose of [`NodalMotion::of_beam`].
    pub fn add_of_beam_transpose(&mut self, element: &[usize; BEAM_NODES], bar: &BeamMotion<S>) {
        for (a, &node) in element.iter().enumerate() {
            self.displacement[node] += bar.displacement[a];
            self.rotation[node] += bar.rotation[a];
        }
    }
}

impl<S: Scalar> Configuration<'_, S> {
    /// Nodes of each beam, with its number.
    pub fn beams(&self) -> impl Iterator<Item = (usize, &[usize; BEAM_NODES])> {
        self.structure.topology.mesh.beams.iter().enumerate()
    }

    pub fn beam(&self, index: usize) -> Beam<S> {
        let (structure, topology) = (self.structure, &self.structure.topology);
        Beam {
            points: topology.mesh.beams[index].map(|node| structure.nodes[node]),
            orientation: structure.orientations[index],
            section: structure.sections[index],
            offset: structure.offsets[index],
            material: structure.materials[topology.beam_material[index]],
            line_mass: structure.line_mass[index],
        }
    }

    /// Transpose of the derivative of [`Configuration::beam`].
    pub fn add_beam_transpose(&self, index: usize, bar: &Beam<S>, to: &mut Cotangent<S>) {
        let topology = &self.structure.topology;
        for (a, &node) in topology.mesh.beams[index].iter().enumerate() {
            to.structure.nodes[node] += bar.points[a];
        }
        to.structure.orientations[index] += bar.orientation;
        to.structure.sections[index].add(&bar.section);
        for k in 0..2 {
            to.structure.offsets[index][k] += bar.offset[k];
        }
        to.structure.line_mass[index] += bar.line_mass;
        to.structure.materials[topology.beam_material[index]].add(&bar.material);
    }

    /// Strain energy of the beams \[J\].
    pub fn beam_energy(&self, motion: &NodalMotion<S>, terms: Terms) -> S {
        self.beams().fold(S::zero(), |sum, (index, element)| {
            let v = motion.of_beam(element);
            sum + self.beam(index).energy(&v, terms.von_karman)
        })
    }

    /// Adds the derivatives of each beam: by the motion to `force`, by the beam to `to`.
    pub fn add_beams_transpose(
        &self,
        motion: &NodalMotion<S>,
        force: &mut NodalMotion<S>,
        to: &mut Cotangent<S>,
        add: impl Fn(&Beam<S>, &BeamMotion<S>, &mut BeamMotion<S>, &mut Beam<S>),
    ) {
        for (index, element) in self.beams() {
            let beam = self.beam(index);
            let (mut f, mut bar) = (BeamMotion::zeros(), beam.zeros());
            add(&beam, &motion.of_beam(element), &mut f, &mut bar);
            force.add_of_beam_transpose(element, &f);
            self.add_beam_transpose(index, &bar, to);
        }
    }

    /// The tangent of a beam at a motion.
    pub fn beam_tangent(
        &self,
        index: usize,
        motion: &NodalMotion<S>,
        terms: Terms,
        matrix: &mut ElementMatrix<S>,
    ) {
        let v = motion.of_beam(&self.structure.topology.mesh.beams[index]);
        self.beam(index).tangent(&v, terms.von_karman, matrix);
    }
}
