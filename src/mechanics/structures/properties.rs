//! Checks of the properties of a structure: sections that can be built, inertias of solids.

use super::beam::SectionFault;
use super::lumped_mass::LumpedMass;
use super::structure::Structure;
use crate::math::Mat3;
use crate::model::rigid_body::is_inertia_of_solid;

/// A property that no real structure has.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PropertyFault {
    /// A section.
    #[error("beam {beam} has a section with {fault}")]
    Section {
        /// The beam.
        beam: usize,
        /// The fault.
        fault: SectionFault,
    },
    /// An inertia.
    #[error("the mass at node {node} has the inertia of no solid")]
    Inertia {
        /// The node.
        node: usize,
    },
}

impl LumpedMass<f64> {
    /// Whether its inertia is that of a solid: principal moments are not negative, and none is above the sum of
    /// the others.
    pub fn is_of_solid(&self) -> bool {
        let [xx, yy, zz, xy, yz, zx] = self.inertia;
        is_inertia_of_solid(&Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz), 0.0)
    }
}

impl Structure<f64> {
    /// The first impossible property.
    pub fn property_fault(&self) -> Option<PropertyFault> {
        let sections = self.sections.iter().enumerate();
        let mut wrong = sections.filter_map(|(beam, section)| {
            let fault = section.fault()?;
            Some(PropertyFault::Section { beam, fault })
        });
        let inertia = || {
            let k = self.masses.iter().position(|mass| !mass.is_of_solid())?;
            let node = self.topology.mass_nodes[k];
            Some(PropertyFault::Inertia { node })
        };
        wrong.next().or_else(inertia)
    }
}
