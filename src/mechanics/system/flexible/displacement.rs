//! Displacements of elastic coordinates from the start, which the assembly makes least.

use super::coordinates::slots;
use super::form::{pull_weights, weights};
use crate::linalg::Emit;
use crate::math::slices::dot;
use crate::math::{Scalar, Vec3};
use crate::model::Model;
use crate::model::finite::ElementMesh;
use crate::model::flexible::{FlexibleBody, Form};
use crate::system::finite;
use crate::system::flexing::Block;
use crate::system::numbering::Numbering;

/// Weight of deformations beside motions of bodies, so that joints are closed by motions where these can.
/// Derivatives keep their digits.
const DEFORMATION: f64 = 1e7;

/// The mean square of the displacement of a body over its mass, as a quadratic form of its elastic coordinates:
/// ∫ |Σ x_I N_I|² dm / m of modes, and the part of its diagonal of finite elements.
#[derive(Clone, Debug)]
pub struct MeanSquare {
    /// The body that carries each coordinate, and the component of its position.
    places: Vec<(usize, usize)>,
    form: Weights,
}

#[derive(Clone, Debug)]
enum Weights {
    /// By rows.
    Full(Vec<f64>),
    Diagonal(Vec<f64>),
}

impl MeanSquare {
    /// The forms of all flexible bodies.
    pub fn all<S: Scalar>(model: &Model<S>) -> Vec<Self> {
        let one = |body: &FlexibleBody<S>| {
            let mass = model.bodies[body.frame].mass.re();
            let form = match &body.form {
                Form::Modal(modal) => {
                    let (inertia, m) = (&modal.inertia, body.modes());
                    let trace = |i, j| inertia.products[inertia.place(i, j).0].trace().re() / mass;
                    Weights::Full((0..m * m).map(|k| trace(k / m, k % m)).collect())
                }
                Form::Finite(_) => {
                    let all = weights(&body.form);
                    Weights::Diagonal(all.into_iter().map(|w| w.re() / mass).collect())
                }
            };
            Self {
                places: body.places().collect(),
                form,
            }
        };
        model.flexible.iter().map(one).collect()
    }

    /// Its value; `of` gives the component of a carrier.
    pub fn value(&self, of: impl Fn(usize, usize) -> f64) -> f64 {
        let x = |i: usize| of(self.places[i].0, self.places[i].1);
        let count = self.places.len();
        match &self.form {
            Weights::Diagonal(all) => (0..count).map(|i| all[i] * x(i) * x(i)).sum(),
            Weights::Full(all) => {
                let row = |i: usize| -> f64 { (0..count).map(|j| all[i * count + j] * x(j)).sum() };
                let sum: f64 = (0..count).map(|i| x(i) * row(i)).sum();
                // Round-off may leave a negative sum; NaN stays.
                if sum < 0.0 { 0.0 } else { sum }
            }
        }
    }

    /// The bodies that carry its coordinates, each as often as it carries one.
    pub fn carriers(&self) -> impl Iterator<Item = usize> + '_ {
        self.places.iter().map(|&(body, _)| body)
    }
}

/// Weights of the elastic coordinates of a body in the displacement that the assembly makes least \[kg\]: of shells
/// those of nodes, of other shapes the diagonal of their mass matrix.
fn start_weights<S: Scalar>(model: &Model<S>, body: &FlexibleBody<S>) -> Vec<S> {
    match parts_of_mass(&body.form) {
        Some(parts) => {
            let mass = model.bodies[body.frame].mass;
            let all = parts.into_iter();
            all.map(|part| mass * S::from(part * DEFORMATION)).collect()
        }
        None => {
            let all = weights(&body.form).into_iter();
            all.map(|weight| weight * S::from(DEFORMATION)).collect()
        }
    }
}

/// The weights of the coordinates of shells over the mass of the body, \[1\] or \[m²\] by the unit of the coordinate:
/// equal parts for nodes, for rotations times the mean square of their distance from the centre. Directors have so
/// little mass that their rotation would close the joints. `None` of other shapes.
fn parts_of_mass<S: Scalar>(form: &Form<S>) -> Option<Vec<f64>> {
    match form {
        Form::Finite(own) => Some(parts_of_nodes(&own.mesh)),
        Form::Modal(modal) => {
            let shells = modal.shells.as_ref()?;
            let parts = parts_of_nodes(&shells.elements.mesh);
            let square = |v: &Vec<f64>| v.iter().zip(&parts).map(|(v, part)| part * v * v).sum();
            Some(shells.basis.vectors.iter().map(square).collect())
        }
    }
}

fn parts_of_nodes(mesh: &ElementMesh) -> Vec<f64> {
    let part = 1.0 / mesh.nodes.len() as f64;
    let centre = mesh.nodes.iter().sum::<Vec3<f64>>() * part;
    let squares = mesh.nodes.iter().map(|x| (x - centre).norm_squared());
    let mut out = vec![squares.sum::<f64>() * part * part; mesh.coordinates];
    let displacements = mesh.displacements.iter().flatten().flatten();
    displacements.for_each(|&i| out[i] = part);
    out
}

/// Adds the gradient of ½ Σ w_I (q_I − q_I')², q' the start and w the weights of deformations, to tangent
/// positions; `q` are positions.
pub fn add_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    q: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        for ((carrier, k), weight) in body.places().zip(start_weights(model, body)) {
            let moved = q[numbering.position(carrier) + k] - model.bodies[carrier].position[k];
            out[numbering.velocity(carrier) + k] += weight * moved;
        }
    }
}

/// Emits the second derivative of that.
pub fn emit_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    emit: &mut dyn Emit<S>,
) {
    for body in &model.flexible {
        let slots = slots(numbering, body);
        let weights = start_weights(model, body);
        match &body.form {
            Form::Modal(_) => {
                // Entries come in the order of those of the mass matrix.
                let mut block = Block::zero(body.modes());
                for (i, weight) in weights.into_iter().enumerate() {
                    block.add(6 + i, 6 + i, weight);
                }
                block.emit(&slots, (0, 0), S::one(), emit);
            }
            Form::Finite(own) => finite::emit_diagonal(own, &slots, weights, emit),
        }
    }
}

/// Pulls ψ · [`add_displacement`] back to the start and to the weights.
pub fn pull_displacement(
    model: &Model<f64>,
    numbering: &Numbering,
    (q, psi): (&[f64], &[f64]),
    cot: &mut Model<f64>,
) {
    for (f, body) in model.flexible.iter().enumerate() {
        let mut by = Vec::with_capacity(body.modes());
        for ((carrier, k), weight) in body.places().zip(start_weights(model, body)) {
            let moved = q[numbering.position(carrier) + k] - model.bodies[carrier].position[k];
            let psi = psi[numbering.velocity(carrier) + k];
            by.push(psi * moved * DEFORMATION);
            cot.bodies[carrier].position[k] -= psi * weight;
        }
        match parts_of_mass(&body.form) {
            Some(parts) => cot.bodies[body.frame].mass += dot(&by, &parts),
            None => pull_weights(&by, &mut cot.flexible[f].form),
        }
    }
}
