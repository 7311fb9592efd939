//! Displacements of elastic coordinates from the start, which the assembly makes least.

use super::coordinates::slots;
use super::form::{emit_block, pull_weights, weights};
use crate::linalg::Emit;
use crate::math::Scalar;
use crate::model::Model;
use crate::model::flexible::Form;
use crate::system::finite;
use crate::system::flexing::Block;
use crate::system::numbering::Numbering;

/// Adds the gradient of ½ Σ w_I (q_I − q_I')², q' the start, to tangent positions; `q` are positions.
pub(crate) fn add_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    q: &[S],
    out: &mut [S],
) {
    for body in &model.flexible {
        for ((carrier, k), weight) in body.places().zip(weights(&body.form)) {
            let moved = q[numbering.position(carrier) + k] - model.bodies[carrier].position[k];
            out[numbering.velocity(carrier) + k] += weight * moved;
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
                emit_block(&slots, &block, (0, 0), S::one(), emit);
            }
            Form::Finite(own) => finite::emit_weights(own, &slots, emit),
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
            let psi = psi[numbering.velocity(carrier) + k];
            by.push(psi * moved);
            cot.bodies[carrier].position[k] -= psi * weight;
        }
        pull_weights(&body.form, &by, &mut own.form);
    }
}
