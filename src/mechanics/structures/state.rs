//! From the unknowns to the motion of the nodes and of the elements, and back.

use super::shell::{
    Field, Motion, RotationAxes, Shell, ShellCotangent, ShellKind, ShellNodes, Terms,
};
use super::structure::Structure;
use super::supports::{NodeUnknowns, Normal, Rotations, Unknowns};
use crate::math::{Scalar, Vec3};

/// Displacements \[m\] and rotations \[rad\] of the nodes in global axes; or forces \[N\] and moments \[N m\].
#[derive(Clone, Debug, PartialEq)]
pub struct NodalMotion<S> {
    /// u of each node.
    pub displacement: Vec<Vec3<S>>,
    /// θ of each node. On a smooth surface without its part about the director.
    pub rotation: Vec<Vec3<S>>,
}

impl<S: Scalar> NodalMotion<S> {
    /// No motion.
    pub fn zeros(nodes: usize) -> Self {
        Self {
            displacement: vec![Vec3::zeros(); nodes],
            rotation: vec![Vec3::zeros(); nodes],
        }
    }

    /// The motion in another scalar.
    pub fn map<T: Scalar>(&self, mut f: impl FnMut(S) -> T) -> NodalMotion<T> {
        let mut all = |list: &[Vec3<S>]| list.iter().map(|v| v.map(&mut f)).collect();
        NodalMotion {
            displacement: all(&self.displacement),
            rotation: all(&self.rotation),
        }
    }

    /// Adds `factor` times another motion.
    pub fn add_scaled(&mut self, other: &Self, factor: S) {
        let pairs = [
            (&mut self.displacement, &other.displacement),
            (&mut self.rotation, &other.rotation),
        ];
        for (v, w) in pairs
            .into_iter()
            .flat_map(|(to, from)| to.iter_mut().zip(from))
        {
            *v += w * factor;
        }
    }

    pub fn of_element(&self, element: &ShellNodes) -> Motion<S> {
        let all = |of: &[Vec3<S>]| element.gather(Vec3::zeros(), |node| of[node]);
        Motion {
            displacement: all(&self.displacement),
            rotation: all(&self.rotation),
        }
    }

    /// Transpose of [`NodalMotion::of_element`].
    pub fn add_of_element_transpose(&mut self, element: &ShellNodes, bar: &Motion<S>) {
        for (a, &node) in element.iter().enumerate() {
            self.displacement[node] += bar.displacement[a];
            self.rotation[node] += bar.rotation[a];
        }
    }
}

/// A structure with its directors, and the unknowns.
pub struct Configuration<'a, S> {
    pub structure: &'a Structure<S>,
    pub unknowns: &'a Unknowns,
    pub node_unknowns: NodeUnknowns,
    pub directors: Vec<Vec3<S>>,
}

/// Derivatives by the structure while they are collected: by its numbers and by its directors.
pub struct Cotangent<S> {
    pub structure: Structure<S>,
    pub directors: Vec<Vec3<S>>,
}

impl<S: Scalar> Cotangent<S> {
    /// Adds `factor` times another collection.
    pub fn add_scaled(&mut self, other: &Self, factor: S) {
        self.structure.add(&other.structure.map(|x| x * factor));
        for (a, b) in self.directors.iter_mut().zip(&other.directors) {
            *a += b * factor;
        }
    }
}

impl<'a, S: Scalar> Configuration<'a, S> {
    pub fn new(
        structure: &'a Structure<S>,
        unknowns: &'a Unknowns,
        node_unknowns: NodeUnknowns,
    ) -> Self {
        let topology = &structure.topology;
        Self {
            structure,
            unknowns,
            node_unknowns,
            directors: topology.sheets.directors(&topology.mesh, &structure.nodes),
        }
    }

    pub fn cotangent(&self) -> Cotangent<S> {
        Cotangent {
            structure: self.structure.zeros(),
            directors: vec![Vec3::zeros(); self.directors.len()],
        }
    }

    /// Ends a collection: adds the derivatives by the directors to those by the nodes.
    pub fn finish(&self, mut cotangent: Cotangent<S>) -> Structure<S> {
        let topology = &self.structure.topology;
        topology.sheets.add_directors_transpose(
            &topology.mesh,
            &self.structure.nodes,
            &cotangent.directors,
            &mut cotangent.structure.nodes,
        );
        cotangent.structure
    }

    pub fn shell(&self, index: usize) -> Shell<S> {
        let (structure, topology) = (self.structure, &self.structure.topology);
        let (element, corners) = (
            &topology.mesh.shells[index],
            &topology.sheets.corners[index],
        );
        Shell {
            kind: ShellKind::of(element),
            geometry: Field {
                points: element.gather(Vec3::zeros(), |node| structure.nodes[node]),
                directors: corners.gather(Vec3::zeros(), |corner| self.directors[corner]),
            },
            thickness: structure.thickness[index],
            material: structure.materials[topology.material[index]],
            surface_mass: structure.surface_mass[index],
            drilling: self.node_unknowns == NodeUnknowns::Six,
        }
    }

    /// Transpose of the derivative of [`Configuration::shell`].
    pub fn add_shell_transpose(
        &self,
        index: usize,
        bar: &ShellCotangent<S>,
        to: &mut Cotangent<S>,
    ) {
        let topology = &self.structure.topology;
        let (element, corners) = (
            &topology.mesh.shells[index],
            &topology.sheets.corners[index],
        );
        for (a, (&node, &corner)) in element.iter().zip(corners).enumerate() {
            to.structure.nodes[node] += bar.geometry.points[a];
            to.directors[corner] += bar.geometry.directors[a];
        }
        to.structure.thickness[index] += bar.thickness;
        to.structure.surface_mass[index] += bar.surface_mass;
        let material = &mut to.structure.materials[topology.material[index]];
        material.add(&bar.material);
    }

    /// The strain energy of a motion \[J\].
    pub fn strain_energy(&self, motion: &NodalMotion<S>, terms: Terms) -> S {
        let shells = self.structure.topology.mesh.shells.iter().enumerate();
        shells.fold(self.beam_energy(motion, terms), |sum, (index, element)| {
            let v = motion.of_element(element);
            sum + self.shell(index).energy(&v, terms).total()
        })
    }

    /// The director of a node that has one.
    pub fn smooth_director(&self, node: usize) -> Option<&Vec3<S>> {
        let range = self.structure.topology.sheets.of_node[node].clone();
        (range.len() == 1).then(|| &self.directors[range.start])
    }

    /// The director of a node whose rotation about it is that of the surface.
    pub fn surface_director(&self, node: usize) -> Option<usize> {
        match self.unknowns.nodes[node].rotations {
            Rotations::Smooth(_, Normal::Surface) => {
                Some(self.structure.topology.sheets.of_node[node].start)
            }
            Rotations::Smooth(..) | Rotations::Global(_) => None,
        }
    }

    /// The axes of the unknown rotations of a node.
    pub fn axes(&self, node: usize) -> ([Vec3<S>; 3], usize) {
        self.unknowns.nodes[node]
            .rotations
            .axes(self.smooth_director(node))
    }

    pub fn element_axes(&self, index: usize) -> RotationAxes<S> {
        let mut all = RotationAxes::global();
        for (a, &node) in self.structure.topology.mesh.shells[index]
            .iter()
            .enumerate()
        {
            (all.axes[a], all.count[a]) = self.axes(node);
        }
        all
    }

    /// The motion of the nodes that values of the unknowns make.
    pub fn spread(&self, x: &[S]) -> NodalMotion<S> {
        let mut motion = NodalMotion::zeros(self.structure.nodes.len());
        for (node, at) in self.unknowns.nodes.iter().enumerate() {
            for k in 0..3 {
                if let Some(unknown) = at.displacements[k] {
                    motion.displacement[node][k] = x[unknown];
                }
            }
            let (axes, count) = self.axes(node);
            for k in 0..count {
                motion.rotation[node] += axes[k] * x[at.first_rotation + k];
            }
        }
        motion
    }

    /// Transpose of the derivative of [`Configuration::spread`].
    pub fn add_spread_transpose(
        &self,
        x: &[S],
        bar: &NodalMotion<S>,
        to: &mut [S],
        directors: &mut [Vec3<S>],
    ) {
        for (node, at) in self.unknowns.nodes.iter().enumerate() {
            for k in 0..3 {
                if let Some(unknown) = at.displacements[k] {
                    to[unknown] += bar.displacement[node][k];
                }
            }
            let moment = &bar.rotation[node];
            let (axes, count) = self.axes(node);
            for k in 0..count {
                to[at.first_rotation + k] += axes[k].dot(moment);
            }
            if let (Some(d), true) = (self.smooth_director(node), count > 0) {
                let phi = &x[at.first_rotation..at.first_rotation + count];
                let at_director =
                    &mut directors[self.structure.topology.sheets.of_node[node].start];
                let mut bars = [Vec3::zeros(); 3];
                for (bar, &phi) in bars.iter_mut().zip(phi) {
                    *bar = moment * phi;
                }
                *at_director += at.rotations.axes_transpose(d, &bars);
            }
        }
    }
}
