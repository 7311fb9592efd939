//! Displacements of elastic coordinates from the start, which the assembly makes least.

use super::coordinates::slots;
use super::form::{pull_weights, weights};
use crate::linalg::Emit;
use crate::math::Scalar;
use crate::model::Model;
use crate::model::flexible::{FlexibleBody, Form};
use crate::system::finite;
use crate::system::flexing::Block;
use crate::system::numbering::Numbering;

/// Weight of deformations beside motions of bodies, so that joints are closed by motions where these can.
/// Derivatives keep their digits.
const DEFORMATION: f64 = 1e6;

/// The mean square of the displacement of a body over its mass, as a quadratic form of its elastic coordinates:
/// ∫ |Σ x_I N_I|² dm / m of modes, and the part of its diagonal of finite elements.
#[derive(Clone, Debug)]
pub(crate) struct MeanSquare {
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
    pub(crate) fn all<S: Scalar>(model: &Model<S>) -> Vec<Self> {
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
    pub(crate) fn value(&self, of: impl Fn(usize, usize) -> f64) -> f64 {
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
    pub(crate) fn carriers(&self) -> impl Iterator<Item = usize> + '_ {
        self.places.iter().map(|&(body, _)| body)
    }
}

/// Adds the gradient of ½ w Σ w_I (q_I − q_I')², q' the start and w the weight of deformations, to tangent
/// positions; `q` are positions.
pub(crate) fn add_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    q: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        for ((carrier, k), weight) in body.places().zip(weights(&body.form)) {
            let moved = q[numbering.position(carrier) + k] - model.bodies[carrier].position[k];
            out[numbering.velocity(carrier) + k] += weight * moved * S::from(DEFORMATION);
        }
    }
}

/// Emits the second derivative of that.
pub(crate) fn emit_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    emit: &mut dyn Emit<S>,
) {
    for body in &model.flexible {
        let slots = slots(numbering, body);
        match &body.form {
            Form::Modal(_) => {
                // Entries come in the order of those of the mass matrix.
                let mut block = Block::zero(body.modes());
                for (i, weight) in weights(&body.form).into_iter().enumerate() {
                    block.add(6 + i, 6 + i, weight);
                }
                block.emit(&slots, (0, 0), S::from(DEFORMATION), emit);
            }
            Form::Finite(own) => finite::emit_weights(own, &slots, S::from(DEFORMATION), emit),
        }
    }
}

/// Pulls ψ · [`add_displacement`] back to the start and to the weights.
pub(crate) fn pull_displacement(
    model: &Model<f64>,
    numbering: &Numbering,
    (q, psi): (&[f64], &[f64]),
    cot: &mut Model<f64>,
) {
    for (body, own) in model.flexible.iter().zip(&mut cot.flexible) {
        let mut by = Vec::with_capacity(body.modes());
        for ((carrier, k), weight) in body.places().zip(weights(&body.form)) {
            let moved = q[numbering.position(carrier) + k] - model.bodies[carrier].position[k];
            let psi = psi[numbering.velocity(carrier) + k] * DEFORMATION;
            by.push(psi * moved);
            cot.bodies[carrier].position[k] -= psi * weight;
        }
        pull_weights(&body.form, &by, &mut own.form);
    }
}
