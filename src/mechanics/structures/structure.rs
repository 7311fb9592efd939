//! A structure: a mesh with the numbers that a design may change.

use std::sync::Arc;

use super::beam::{Section, SectionValues};
use super::lumped_mass::LumpedMass;
use super::material::Material;
use super::mesh::Mesh;
use super::quality::{MeshFault, faults, orientation_faults};
use super::sheets::Sheets;
use crate::math::{Scalar, Vec3};

/// Data of a structure that no design changes.
#[derive(Clone, Debug)]
pub struct Topology {
    /// The mesh.
    pub mesh: Mesh,
    /// Which director each corner of each element has.
    pub sheets: Sheets,
    /// Index of the material of each shell.
    pub material: Vec<usize>,
    /// Index of the material of each beam.
    pub beam_material: Vec<usize>,
    /// The node of each lumped mass.
    pub mass_nodes: Vec<usize>,
}

impl Topology {
    /// A mesh of shells and beams with their materials and the nodes of masses; sheets are found in
    /// the given places of the nodes.
    pub fn new(
        mesh: Mesh,
        nodes: &[Vec3<f64>],
        [material, beam_material]: [Vec<usize>; 2],
        mass_nodes: Vec<usize>,
    ) -> Self {
        Self {
            sheets: Sheets::new(&mesh, nodes),
            mesh,
            material,
            beam_material,
            mass_nodes,
        }
    }
}

/// The numbers of a structure. A structure of zeros collects the derivatives by them.
#[derive(Clone, Debug)]
pub struct Structure<S> {
    /// Mesh and materials of the elements by index.
    pub topology: Arc<Topology>,
    /// Places of the nodes \[m\].
    pub nodes: Vec<Vec3<S>>,
    /// Thickness of each shell \[m\].
    pub thickness: Vec<S>,
    /// Non-structural mass per area of each shell [kg/m²].
    pub surface_mass: Vec<S>,
    /// Section of each beam.
    pub sections: Vec<Section<S>>,
    /// A vector in the plane of each beam and axis 2 of its section.
    pub orientations: Vec<Vec3<S>>,
    /// Offset of the centre of each section from the nodes, along its axes 2 and 3 \[m\].
    pub offsets: Vec<[S; 2]>,
    /// Non-structural mass per length of each beam [kg/m].
    pub line_mass: Vec<S>,
    /// Lumped masses.
    pub masses: Vec<LumpedMass<S>>,
    /// The materials.
    pub materials: Vec<Material<S>>,
}

impl<S: Scalar> Structure<S> {
    /// The structure in another scalar.
    pub fn map<T: Scalar>(&self, mut f: impl FnMut(S) -> T) -> Structure<T> {
        Structure {
            topology: self.topology.clone(),
            nodes: self.nodes.iter().map(|x| x.map(&mut f)).collect(),
            thickness: self.thickness.iter().map(|&h| f(h)).collect(),
            surface_mass: self.surface_mass.iter().map(|&m| f(m)).collect(),
            sections: self.sections.iter().map(|x| x.map(&mut f)).collect(),
            orientations: self.orientations.iter().map(|x| x.map(&mut f)).collect(),
            offsets: self.offsets.iter().map(|x| x.map(&mut f)).collect(),
            line_mass: self.line_mass.iter().map(|&m| f(m)).collect(),
            masses: self.masses.iter().map(|m| m.map(&mut f)).collect(),
            materials: self.materials.iter().map(|m| m.map(&mut f)).collect(),
        }
    }

    /// All numbers, in the order in which [`Structure::map`] takes them.
    pub fn values(&self) -> Vec<S> {
        let mut all = Vec::new();
        self.map(|x| {
            all.push(x);
            x
        });
        all
    }

    /// Joins a mass to a node.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn add_mass(&mut self, node: usize, mass: LumpedMass<S>) {
        assert!(node < self.nodes.len());
        Arc::make_mut(&mut self.topology).mass_nodes.push(node);
        self.masses.push(mass);
    }

    /// Adds the numbers of a structure of the same topology.
    pub fn add(&mut self, other: &Self) {
        let mut next = other.values().into_iter();
        *self = self.map(|x| x + next.next().unwrap_or_else(S::zero));
    }

    /// Zeros in the place of every number.
    pub fn zeros(&self) -> Self {
        self.map(|_| S::zero())
    }
}

impl Structure<f64> {
    /// A structure of shells of one thickness \[m\] and one material.
    ///
    /// # Errors
    /// All [`MeshFault`]s of the mesh.
    pub fn uniform(
        mesh: Mesh,
        nodes: Vec<Vec3<f64>>,
        thickness: f64,
        material: Material<f64>,
    ) -> Result<Self, Vec<MeshFault>> {
        // Without beams no section is ever used.
        let none = Section::Given(SectionValues::zeros());
        Self::with_beams(mesh, nodes, thickness, none, Vec::new(), material)
    }

    /// A structure of beams of one section and one material, and of shells of one thickness \[m\] if the
    /// mesh has some. Each beam has its orientation.
    ///
    /// # Errors
    /// All [`MeshFault`]s of the mesh, those of orientations among them.
    pub fn with_beams(
        mesh: Mesh,
        nodes: Vec<Vec3<f64>>,
        thickness: f64,
        section: Section<f64>,
        orientations: Vec<Vec3<f64>>,
        material: Material<f64>,
    ) -> Result<Self, Vec<MeshFault>> {
        let mut found = faults(&mesh, &nodes);
        if found.is_empty() {
            found = orientation_faults(&mesh, &nodes, &orientations);
        }
        if !found.is_empty() {
            return Err(found);
        }
        let (shells, beams) = (mesh.shells.len(), mesh.beams.len());
        Ok(Self {
            topology: Arc::new(Topology::new(
                mesh,
                &nodes,
                [vec![0; shells], vec![0; beams]],
                Vec::new(),
            )),
            nodes,
            thickness: vec![thickness; shells],
            surface_mass: vec![0.0; shells],
            sections: vec![section; beams],
            orientations,
            offsets: vec![[0.0; 2]; beams],
            line_mass: vec![0.0; beams],
            masses: Vec::new(),
            materials: vec![material],
        })
    }
}
