//! Formulas of a flexible body by its form: sums over modes, or over finite elements.

use crate::linalg::Emit;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::flexible::FlexibleBody;
use crate::model::flexible::Form;
use crate::system::flexing::{self, Flexing, FlexingCotangent, Generalised, Moving};
use crate::system::{elastic, finite};

/// A cotangent has the form of its body.
pub(super) fn unlike() -> ! {
    unreachable!("a cotangent has the form of its body")
}

/// Inertial forces without those of the rigid body.
pub(super) fn inertial<S: Scalar>(form: &Form<S>, at: &Flexing<S>) -> Generalised<S> {
    match form {
        Form::Modal(modal) => flexing::inertial(&modal.inertia, at),
        Form::Finite(own) => finite::inertial(own, at),
    }
}

/// Transpose of the derivative of [`inertial`].
pub(super) fn pull_inertial(
    form: &Form<f64>,
    at: &Flexing<f64>,
    psi: &Generalised<f64>,
    cot: &mut Form<f64>,
) -> FlexingCotangent<f64> {
    match (form, cot) {
        (Form::Modal(modal), Form::Modal(own)) => {
            flexing::pull_back(&modal.inertia, at, psi, &mut own.inertia)
        }
        (Form::Finite(own), Form::Finite(cot)) => finite::pull_back(own, at, psi, cot),
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
}

/// Kinetic energy and momenta without those of the rigid body.
pub(super) fn moving<S: Scalar>(form: &Form<S>, at: &Flexing<S>, nu: &Vec3<S>) -> Moving<S> {
    match form {
        Form::Modal(modal) => flexing::moving(&modal.inertia, at, nu),
        Form::Finite(own) => finite::moving(own, at, nu),
    }
}

/// Transpose of the derivative of the kinetic energy, times `scale`.
pub(super) fn pull_kinetic(
    form: &Form<f64>,
    at: &Flexing<f64>,
    nu: &Vec3<f64>,
    scale: f64,
    cot: &mut Form<f64>,
) -> (FlexingCotangent<f64>, Vec3<f64>) {
    match (form, cot) {
        (Form::Modal(modal), Form::Modal(own)) => {
            flexing::pull_kinetic(&modal.inertia, at, nu, scale, &mut own.inertia)
        }
        (Form::Finite(own), Form::Finite(cot)) => finite::pull_kinetic(own, at, nu, scale, cot),
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
}

/// Static moment of the deformed body about the frame's origin, axes of the frame \[kg m\].
pub(super) fn first_moment<S: Scalar>(form: &Form<S>, q: &[S]) -> Vec3<S> {
    match form {
        Form::Modal(modal) => flexing::static_moment(&modal.inertia, S::one(), q),
        Form::Finite(own) => finite::first_moment(own, q),
    }
}

/// Pulls w · [`first_moment`] back, of the deformed places if `placed`, else of displacements `q` alone.
pub(super) fn pull_first_moment(
    form: &Form<f64>,
    (q, placed): (&[f64], bool),
    w: &Vec3<f64>,
    by_q: &mut [f64],
    cot: &mut Form<f64>,
) {
    match (form, cot) {
        (Form::Modal(modal), Form::Modal(own)) => {
            if placed {
                own.inertia.centre += w;
            }
            let moments = modal.inertia.static_moments.iter();
            for (((p, by_p), &q), by_q) in moments
                .zip(&mut own.inertia.static_moments)
                .zip(q)
                .zip(by_q)
            {
                *by_q += w.dot(p);
                *by_p += w * q;
            }
        }
        (Form::Finite(own), Form::Finite(cot)) => {
            finite::pull_first_moment(own, (q, placed), w, by_q, cot);
        }
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
}

/// Strain energy at elastic coordinates \[J\].
pub(super) fn elastic_energy<S: Scalar>(form: &Form<S>, q: &[S]) -> S {
    match form {
        Form::Modal(modal) => elastic::energy(modal, q),
        Form::Finite(own) => finite::energy(own, q),
    }
}

/// Emits the mass matrix of a body without that of the rigid body.
pub(super) fn emit_mass_of<S: Scalar>(
    form: &Form<S>,
    (rotation, q): (&Mat3<S>, &[S]),
    slots: &[usize],
    at: (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    match form {
        Form::Modal(modal) => {
            let block = flexing::mass(&modal.inertia, rotation, q);
            block.emit(slots, at, scale, emit);
        }
        Form::Finite(own) => finite::emit_mass(own, (rotation, q), slots, at, scale, emit),
    }
}

/// The diagonal of ∫ N_Iᵀ N_J dm, the mass matrix of the elastic coordinates.
pub(super) fn weights<S: Scalar>(form: &Form<S>) -> Vec<S> {
    match form {
        Form::Modal(modal) => {
            let (inertia, m) = (&modal.inertia, modal.inertia.static_moments.len());
            let trace = |i: usize| inertia.products[inertia.place(i, i).0].trace();
            (0..m).map(trace).collect()
        }
        Form::Finite(own) => finite::weights(own),
    }
}

/// Adds the cotangents `by` of the [`weights`] of modes.
pub(super) fn pull_weights(by: &[f64], cot: &mut Form<f64>) {
    let Form::Modal(own) = cot else { unlike() };
    for (i, by) in by.iter().enumerate() {
        let place = own.inertia.place(i, i).0;
        for d in 0..3 {
            own.inertia.products[place][(d, d)] += by;
        }
    }
}

/// Stiffness and mass of each elastic coordinate by itself, and its damping.
pub fn alone<S: Scalar>(body: &FlexibleBody<S>) -> Vec<[S; 3]> {
    let weights = weights(&body.form);
    match &body.form {
        Form::Modal(modal) => {
            let m = weights.len();
            let own = |i: usize| {
                let diagonal = i * (m + 1);
                let stiffness = modal.stiffness.linear[diagonal];
                let viscous = modal.viscosity.unwrap_or_else(S::zero) * stiffness;
                [stiffness, weights[i], modal.damping[diagonal] + viscous]
            };
            (0..m).map(own).collect()
        }
        Form::Finite(own) => {
            let both = finite::diagonal(own).into_iter().zip(weights);
            let [alpha, beta] = own.damping.unwrap_or([S::zero(); 2]);
            both.map(|(k, m)| [k, m, alpha * m + beta * k]).collect()
        }
    }
}
