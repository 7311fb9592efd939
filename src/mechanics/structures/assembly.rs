//! Assembly of the stiffness of a structure, into slots that are recorded once.

use super::beam::BEAM_NODES;
use super::lumped_mass::LumpedMass;
use super::mesh::{Mesh, UnknownSet};
use super::shell::{ElementMatrix, Motion, ShellCotangent, ShellNodes, Terms};
use super::state::{Configuration, Cotangent, NodalMotion};
use super::structure::Structure;
use super::supports::{NodeUnknowns, Rotations, Support, Unknowns};
use crate::linalg::cholesky::{SymmetricPattern, fill_reducing_order};
use crate::math::Scalar;
use rayon::prelude::*;

/// Number of shells above which their matrices are computed in parallel.
const SIDE_BY_SIDE: usize = 64;
/// Matrices of elements that each processor makes before they are added.
const AT_ONCE: usize = 16;

/// A slot of an unknown that is fixed.
const FIXED: u32 = u32::MAX;

/// Data of mesh and supports alone: the unknowns, the pattern of the stiffness, and the slots of
/// the entries of each element.
#[derive(Clone, Debug)]
pub struct Assembly {
    pub unknowns: Unknowns,
    pub node_unknowns: NodeUnknowns,
    pub pattern: SymmetricPattern,
    /// Slots of the lower part of each element's matrix, row by row.
    slots: Vec<Vec<u32>>,
}

impl Assembly {
    pub fn new(
        structure: &Structure<f64>,
        supports: &[Support],
        node_unknowns: NodeUnknowns,
    ) -> Result<Self, UnknownSet> {
        let mesh = &structure.topology.mesh;
        let order = fill_reducing_order(&neighbours(mesh));
        let unknowns = Unknowns::new(structure, supports, node_unknowns, &order)?;
        let numbers: Vec<Vec<Option<usize>>> = mesh
            .shells
            .iter()
            .map(|element| element_unknowns(&unknowns, element))
            .chain(mesh.beams.iter().map(|beam| beam_unknowns(&unknowns, beam)))
            .collect();
        let pattern = pattern(unknowns.count, &numbers);
        let slots = numbers.iter().map(|list| record(&pattern, list)).collect();
        Ok(Self {
            unknowns,
            node_unknowns,
            pattern,
            slots,
        })
    }

    pub fn configuration<'a, S: Scalar>(
        &'a self,
        structure: &'a Structure<S>,
    ) -> Configuration<'a, S> {
        Configuration::new(structure, &self.unknowns, self.node_unknowns)
    }

    /// Writes the tangent stiffness at a motion into `values`.
    pub fn tangent(
        &self,
        configuration: &Configuration<f64>,
        motion_all: &NodalMotion<f64>,
        terms: Terms,
        values: &mut [f64],
    ) {
        values.fill(0.0);
        let shells = &configuration.structure.topology.mesh.shells;
        self.add_shells(shells.len(), values, |index, matrix| {
            let axes = configuration.element_axes(index);
            let motion = motion_all.of_element(&shells[index]);
            configuration
                .shell(index)
                .tangent(&axes, &motion, terms, matrix);
        });
        let mut matrix = ElementMatrix::new();
        for (index, _) in configuration.beams() {
            configuration.beam_tangent(index, motion_all, terms, &mut matrix);
            self.scatter(shells.len() + index, &matrix, values);
        }
    }

    /// Writes the mass matrix into `values`.
    pub fn mass(&self, configuration: &Configuration<f64>, values: &mut [f64]) {
        values.fill(0.0);
        let topology = &configuration.structure.topology;
        self.add_shells(topology.mesh.shells.len(), values, |index, matrix| {
            let axes = configuration.element_axes(index);
            configuration.shell(index).mass_matrix(&axes, matrix);
        });
        let mut matrix = ElementMatrix::new();
        for (index, _) in configuration.beams() {
            configuration.beam(index).mass_matrix(&mut matrix);
            self.scatter(topology.mesh.shells.len() + index, &matrix, values);
        }
        for (mass, &node) in configuration
            .structure
            .masses
            .iter()
            .zip(&topology.mass_nodes)
        {
            self.add_lumped(configuration, node, mass, values);
        }
    }

    /// Adds a lumped mass m u̇·u̇ and θ̇·J θ̇ at a node.
    fn add_lumped(
        &self,
        configuration: &Configuration<f64>,
        node: usize,
        mass: &LumpedMass<f64>,
        values: &mut [f64],
    ) {
        let mut add = |i: usize, j: usize, value: f64| {
            if let Some(slot) = self.pattern.slot(i.max(j), i.min(j)) {
                values[slot] += value;
            }
        };
        for unknown in self.unknowns.nodes[node].displacements.iter().flatten() {
            add(*unknown, *unknown, mass.mass);
        }
        let (axes, _) = configuration.axes(node);
        for (k, i) in self.unknowns.rotations_of(node).enumerate() {
            for (l, j) in self.unknowns.rotations_of(node).enumerate().take(k + 1) {
                add(i, j, axes[k].dot(&mass.momentum(&axes[l])));
            }
        }
    }

    /// Adds the matrices of all shells. They are computed in parallel, some at a time, and added in
    /// order, so the sums are the same on any number of processors.
    fn add_shells(
        &self,
        count: usize,
        values: &mut [f64],
        make: impl Fn(usize, &mut ElementMatrix<f64>) + Sync,
    ) {
        let threads = rayon::current_num_threads();
        if threads == 1 || count < SIDE_BY_SIDE {
            let mut matrix = ElementMatrix::new();
            for index in 0..count {
                make(index, &mut matrix);
                self.scatter(index, &matrix, values);
            }
            return;
        }
        let mut matrices: Vec<ElementMatrix<f64>> = Vec::new();
        matrices.resize_with((AT_ONCE * threads).min(count), ElementMatrix::new);
        for first in (0..count).step_by(matrices.len()) {
            let some = matrices.len().min(count - first);
            let made = matrices[..some].par_iter_mut().with_min_len(4).enumerate();
            made.for_each(|(k, matrix)| make(first + k, matrix));
            for (k, matrix) in matrices[..some].iter().enumerate() {
                self.scatter(first + k, matrix, values);
            }
        }
    }

    fn scatter(&self, index: usize, matrix: &ElementMatrix<f64>, values: &mut [f64]) {
        let mut slots = self.slots[index].iter();
        for (i, row) in matrix.rows.iter().enumerate().take(matrix.order) {
            for (&value, &slot) in row[..=i].iter().zip(&mut slots) {
                if slot != FIXED {
                    values[slot as usize] += value;
                }
            }
        }
    }
}

/// Adds the derivatives of the strain energy of a motion: by the motion to `force`, by the structure
/// to `to`.
pub fn add_energy_transpose<S: Scalar>(
    configuration: &Configuration<S>,
    motion: &NodalMotion<S>,
    terms: Terms,
    force: &mut NodalMotion<S>,
    to: &mut Cotangent<S>,
) {
    for (index, element) in configuration
        .structure
        .topology
        .mesh
        .shells
        .iter()
        .enumerate()
    {
        let (mut f, mut bar) = (Motion::zeros(), ShellCotangent::zeros());
        let v = motion.of_element(element);
        configuration
            .shell(index)
            .add_energy_transpose(&v, terms, &mut f, &mut bar);
        force.add_of_element_transpose(element, &f);
        configuration.add_shell_transpose(index, &bar, to);
    }
    configuration.add_beams_transpose(motion, force, to, |beam, v, f, bar| {
        beam.add_energy_transpose(v, terms.von_karman, f, bar);
    });
}

/// Neighbours i > j of each node j: those that share an element.
fn neighbours(mesh: &Mesh) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new(); mesh.nodes];
    for element in mesh.elements() {
        for &j in element {
            all[j].extend(element.iter().copied().filter(|&i| i > j));
        }
    }
    for list in &mut all {
        list.sort_unstable();
        list.dedup();
    }
    all
}

/// The unknowns of an element in the order of its matrix; `None` where fixed.
fn element_unknowns(unknowns: &Unknowns, element: &ShellNodes) -> Vec<Option<usize>> {
    let mut all = Vec::new();
    for &node in element {
        all.extend(unknowns.nodes[node].displacements);
    }
    for &node in element {
        all.extend(unknowns.rotations_of(node).map(Some));
    }
    all
}

/// The unknowns of a beam in the order of its matrix; its nodes have rotations about global axes.
fn beam_unknowns(unknowns: &Unknowns, element: &[usize; BEAM_NODES]) -> Vec<Option<usize>> {
    let mut all: Vec<Option<usize>> = element
        .iter()
        .flat_map(|&node| unknowns.nodes[node].displacements)
        .collect();
    for &node in element {
        let Rotations::Global(free) = unknowns.nodes[node].rotations else {
            unreachable!("nodes on beams have global rotations")
        };
        let mut numbers = unknowns.rotations_of(node);
        all.extend(free.map(|free| free.then(|| numbers.next()).flatten()));
    }
    all
}

fn pattern(count: usize, numbers: &[Vec<Option<usize>>]) -> SymmetricPattern {
    let mut columns: Vec<Vec<usize>> = (0..count).map(|j| vec![j]).collect();
    for list in numbers {
        for &j in list.iter().flatten() {
            columns[j].extend(list.iter().flatten().copied().filter(|&i| i > j));
        }
        // Elements share most entries of a column: do not let it grow.
        for &j in list.iter().flatten() {
            if columns[j].len() > 400 {
                columns[j].sort_unstable();
                columns[j].dedup();
            }
        }
    }
    for column in &mut columns {
        column.sort_unstable();
        column.dedup();
    }
    SymmetricPattern::new(&columns)
}

fn record(pattern: &SymmetricPattern, list: &[Option<usize>]) -> Vec<u32> {
    let mut slots = Vec::with_capacity(list.len() * (list.len() + 1) / 2);
    for (row, i) in list.iter().enumerate() {
        for j in &list[..=row] {
            let slot = match (i, j) {
                (Some(i), Some(j)) => pattern.slot(*i.max(j), *i.min(j)),
                _ => None,
            };
            slots.push(slot.map_or(FIXED, |slot| slot as u32));
        }
    }
    slots
}
