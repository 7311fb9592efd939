//! Beams and lumped masses as parts of a body that moves: points with masses between them, and strains, by the
//! unknowns of their nodes.

use super::beam::{BEAM_NODES, Beam, BeamStrain};
use super::floating::NodeMotion;
use super::lumped_mass::LumpedMass;
use crate::math::scalar::lift3;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::finite::Part;
use crate::model::shapes::{ModalInertia, ModalStiffness, Quadratic, Strain};

/// The coordinates of the unknowns of some nodes: of each its displacements, then its rotations.
pub fn coordinates(nodes: &[NodeMotion]) -> Vec<usize> {
    let of_node = |node: &NodeMotion| -> Vec<usize> {
        let rotations = node.rotations.iter().map(|(coordinate, _)| *coordinate);
        node.displacements
            .into_iter()
            .flatten()
            .chain(rotations)
            .collect()
    };
    nodes.iter().flat_map(of_node).collect()
}

/// How an unknown moves its node.
#[derive(Clone, Copy)]
enum Move {
    /// Displacement along an axis.
    Along(usize),
    /// Rotation.
    About(Vec3<f64>),
}

/// The unknowns in the order of [`coordinates`]: the node of each, and how it moves it.
fn moves(nodes: &[NodeMotion]) -> Vec<(usize, Move)> {
    let of_node = |(a, node): (usize, &NodeMotion)| {
        let free = (0..3).filter(|&k| node.displacements[k].is_some());
        let along: Vec<Move> = free.map(Move::Along).collect();
        let about = node.rotations.iter().map(|(_, axis)| Move::About(*axis));
        let all: Vec<Move> = along.into_iter().chain(about).collect();
        all.into_iter().map(move |own| (a, own))
    };
    nodes.iter().enumerate().flat_map(of_node).collect()
}

/// Points with masses between them: the position of each node, then vectors that turn with it, `kinds` in all.
struct Points<S> {
    kinds: usize,
    nodes: usize,
    /// X_k: point k is of kind k / nodes at node k % nodes.
    places: Vec<Vec3<S>>,
    /// The points that each unknown moves, and how.
    shapes: Vec<Vec<(usize, Vec3<S>)>>,
}

impl<S: Scalar> Points<S> {
    /// `vectors` are those of each kind at each node.
    fn new(nodes: &[NodeMotion], vectors: &[Vec<Vec3<S>>]) -> Self {
        let count = nodes.len();
        let positions = nodes.iter().map(|node| lift3(&node.place));
        let places: Vec<Vec3<S>> = positions.chain(vectors.iter().flatten().copied()).collect();
        let kinds = vectors.len() + 1;
        let shape = |(a, own): (usize, Move)| match own {
            Move::Along(k) => {
                vec![(a, Vec3::ith(k, S::one()))]
            }
            Move::About(axis) => {
                let axis = lift3::<S>(&axis);
                let turned = (1..kinds).map(|kind| kind * count + a);
                turned.map(|k| (k, axis.cross(&places[k]))).collect()
            }
        };
        Self {
            kinds,
            nodes: count,
            shapes: moves(nodes).into_iter().map(shape).collect(),
            places,
        }
    }

    /// The part with the masses m_kl and these strains.
    fn part(&self, mass: impl Fn(usize, usize) -> S, stiffness: ModalStiffness<S>) -> Part<S> {
        let (m, all) = (self.shapes.len(), self.kinds * self.nodes);
        // Σ_l m_kl X_l of the undeformed points and of each shape.
        let weighed_places: Vec<Vec3<S>> = (0..all)
            .map(|k| {
                let points = self.places.iter().enumerate();
                points.fold(Vec3::zeros(), |sum, (l, x)| sum + x * mass(k, l))
            })
            .collect();
        let weigh = |shape: &Vec<(usize, Vec3<S>)>| -> Vec<Vec3<S>> {
            let of = |k: usize| {
                let points = shape.iter();
                points.fold(Vec3::zeros(), |sum, (l, x)| sum + x * mass(k, *l))
            };
            (0..all).map(of).collect()
        };
        let weighed: Vec<Vec<Vec3<S>>> = self.shapes.iter().map(weigh).collect();
        let total = |of: &[Vec3<S>]| {
            let positions = of[..self.nodes].iter();
            positions.fold(Vec3::zeros(), |sum: Vec3<S>, x| sum + x)
        };
        let mut products = Vec::with_capacity(m * (m + 1) / 2);
        for (i, shape) in self.shapes.iter().enumerate() {
            for other in &weighed[i..] {
                let points = shape.iter();
                let sum = points.fold(Mat3::zeros(), |sum, (k, x)| sum + x * other[*k].transpose());
                products.push(sum);
            }
        }
        let with_position = |other: &Vec<Vec3<S>>| {
            let points = self.places.iter().zip(other);
            points.fold(Mat3::zeros(), |sum, (x, w)| sum + x * w.transpose())
        };
        let mut sum = S::zero();
        for k in 0..self.nodes {
            for l in 0..self.nodes {
                sum += mass(k, l);
            }
        }
        Part {
            mass: sum,
            second: with_position(&weighed_places),
            inertia: ModalInertia {
                centre: total(&weighed_places),
                static_moments: weighed.iter().map(|own| total(own)).collect(),
                with_position: weighed.iter().map(with_position).collect(),
                products,
            },
            stiffness,
        }
    }
}

/// A beam with these nodes. The rotary inertia of its sections is interpolated between those at the nodes.
pub fn of_beam<S: Scalar>(nodes: &[NodeMotion; BEAM_NODES], beam: &Beam<S>) -> Part<S> {
    let masses = beam.masses();
    let vectors = [0, 1].map(|k| masses.axes.iter().map(|axes| axes[k]).collect());
    let points = Points::new(nodes, &vectors);
    let mass = |k: usize, l: usize| {
        let share = masses.shares[k % BEAM_NODES][l % BEAM_NODES];
        share * masses.per_length[k / BEAM_NODES][l / BEAM_NODES]
    };
    let count = points.shapes.len();
    let stiffness = ModalStiffness {
        linear: vec![S::zero(); count * count],
        strains: strains(nodes, beam),
    };
    points.part(mass, stiffness)
}

/// The strains of a beam, those of one point after those of the other, by the unknowns of its nodes.
pub fn strains<S: Scalar>(nodes: &[NodeMotion; BEAM_NODES], beam: &Beam<S>) -> Vec<Strain<S>> {
    let moves = moves(nodes);
    // A row over all displacements and rotations of the nodes, as one over the unknowns.
    let row = |row: &[S]| -> Vec<S> {
        let of = |(a, own): &(usize, Move)| match own {
            Move::Along(k) => row[3 * a + k],
            Move::About(axis) => {
                let own = &row[3 * (BEAM_NODES + a)..][..3];
                own[0] * axis.x + own[1] * axis.y + own[2] * axis.z
            }
        };
        moves.iter().map(of).collect()
    };
    let one = |strain: BeamStrain<S>| Strain {
        weight: strain.weight,
        axial: strain.axial,
        strain: Quadratic {
            linear: row(&strain.linear),
            squares: (strain.squares.iter()).map(|(c, g)| (*c, row(g))).collect(),
        },
    };
    beam.strains().into_iter().map(one).collect()
}

/// A mass at a node. Its second moments are Σ s_ij e_i e_jᵀ with s = ½ tr(J) 1 − J.
pub fn of_mass<S: Scalar>(node: &NodeMotion, own: &LumpedMass<S>) -> Part<S> {
    let axes = [0, 1, 2].map(|k| Vec3::ith(k, S::one()));
    let points = Points::new(std::slice::from_ref(node), &axes.map(|axis| vec![axis]));
    let [xx, yy, zz, xy, yz, zx] = own.inertia;
    let inertia = Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
    let second = Mat3::identity() * (inertia.trace() * 0.5) - inertia;
    let mass = |k: usize, l: usize| match (k, l) {
        (0, 0) => own.mass,
        (0, _) | (_, 0) => S::zero(),
        _ => second[(k - 1, l - 1)],
    };
    let count = points.shapes.len();
    let stiffness = ModalStiffness {
        linear: vec![S::zero(); count * count],
        strains: Vec::new(),
    };
    points.part(mass, stiffness)
}
