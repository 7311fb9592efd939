//! A structure: a mesh with the numbers that a design may move.

use std::sync::Arc;

use super::material::Material;
use super::mesh::Mesh;
use super::quality::{MeshFault, faults};
use super::sheets::{FOLD_ANGLE, Sheets};
use crate::math::{Scalar, Vec3};

/// What a structure is made of that no design moves.
#[derive(Clone, Debug)]
pub struct Topology {
    /// The mesh.
    pub mesh: Mesh,
    /// Which director each corner of each element has.
    pub sheets: Sheets,
    /// Index of the material of each shell.
    pub material: Vec<usize>,
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
            materials: self.materials.iter().map(|m| m.map(&mut f)).collect(),
        }
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
        let found = faults(&mesh, &nodes);
        if !found.is_empty() {
            return Err(found);
        }
        let shells = mesh.shells.len();
        Ok(Self {
            topology: Arc::new(Topology {
                sheets: Sheets::new(&mesh, &nodes, FOLD_ANGLE),
                mesh,
                material: vec![0; shells],
            }),
            nodes,
            thickness: vec![thickness; shells],
            surface_mass: vec![0.0; shells],
            materials: vec![material],
        })
    }
}
