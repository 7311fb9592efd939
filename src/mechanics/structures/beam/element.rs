//! The numbers of a beam, and its motion.

use super::BEAM_NODES;
use super::section::Section;
use crate::math::{Scalar, Vec3};
use crate::structures::material::Material;

/// The numbers of a beam; or derivatives by them.
#[derive(Clone, Copy, Debug)]
pub struct Beam<S> {
    /// Nodes \[m\].
    pub points: [Vec3<S>; BEAM_NODES],
    /// A vector in the plane of the beam and axis 2 of its section.
    pub orientation: Vec3<S>,
    /// The section.
    pub section: Section<S>,
    /// Offset of the centre of the section from the nodes along axes 2 and 3 \[m\].
    pub offset: [S; 2],
    /// The material.
    pub material: Material<S>,
    /// Non-structural mass per length [kg/m], at the centre of the section.
    pub line_mass: S,
}

/// Displacements \[m\] and rotations \[rad\] of the nodes in global axes; or forces \[N\] and moments [N m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamMotion<S> {
    /// u_a.
    pub displacement: [Vec3<S>; BEAM_NODES],
    /// θ_a.
    pub rotation: [Vec3<S>; BEAM_NODES],
}

impl<S: Scalar> BeamMotion<S> {
    /// No motion.
    pub fn zeros() -> Self {
        let zero = [Vec3::zeros(); BEAM_NODES];
        Self {
            displacement: zero,
            rotation: zero,
        }
    }
}
