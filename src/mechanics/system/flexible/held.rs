//! Energy, momenta and stress of flexible bodies.

use super::coordinates::{add_coordinates, add_part, coordinates};
use super::form::{elastic_energy, first_moment, moving, pull_first_moment, unlike};
use super::truncated::{pull_kinetic, weighed};
use crate::math::slices::dot;
use crate::math::{Scalar, Vec3};
use crate::model::Model;
use crate::model::flexible::{BeamSection, FlexibleBody, Form, Inertia};
use crate::model::shapes::Quadratic;
use crate::structures::turned::{Turned, turned_line};
use crate::system::bodies::BodyMotion;
use crate::system::numbering::Numbering;
use crate::system::{elastic, finite};

/// Energy and momenta of flexible bodies besides those of rigid ones.
#[derive(Clone, Copy, Debug)]
pub struct Held<S> {
    /// Kinetic energy \[J\].
    pub kinetic: S,
    /// Gravity's and strain energy \[J\].
    pub potential: S,
    /// Linear momentum, ground axes \[kg m/s\].
    pub momentum: Vec3<S>,
    /// Angular momentum about the origin, ground axes \[kg m²/s\].
    pub angular_momentum: Vec3<S>,
}

/// Energy and momenta that flexible bodies add to those of the rigid ones.
pub fn held<S: Scalar>(model: &Model<S>, motions: &[BodyMotion<S>]) -> Held<S> {
    let mut out = Held {
        kinetic: S::zero(),
        potential: S::zero(),
        momentum: Vec3::zeros(),
        angular_momentum: Vec3::zeros(),
    };
    for body in &model.flexible {
        let frame = &motions[body.frame];
        let at = weighed(body, motions);
        let nu = frame.rotation.tr_mul(&frame.velocity);
        let moving = moving(&body.form, &at, &nu);
        let momentum = frame.rotation * moving.momentum;
        out.kinetic += moving.kinetic;
        out.momentum += momentum;
        out.angular_momentum += frame.position.cross(&momentum) + frame.rotation * moving.spin;
        let q = coordinates(body, motions);
        let moment = frame.rotation * first_moment(&body.form, &q);
        out.potential += elastic_energy(&body.form, &q) - model.gravity.dot(&moment);
    }
    out
}

/// Strain energy of one flexible body \[J\].
pub fn strain_energy<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> S {
    elastic_energy(&body.form, &coordinates(body, motions))
}

/// Adds `scale` times the derivative of the strain energy of flexible body `i` to tangent positions and
/// parameters.
pub fn pull_strain_energy(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    (i, scale): (usize, f64),
    y: &mut [f64],
    cot: &mut Model<f64>,
) {
    let (body, own) = (&model.flexible[i], &mut cot.flexible[i]);
    let q = coordinates(body, motions);
    let mut by_q = vec![0.0; q.len()];
    match (&body.form, &mut own.form) {
        (Form::Modal(modal), Form::Modal(own)) => {
            elastic::pull_energy(modal, &q, scale, &mut by_q, own);
        }
        (Form::Finite(finite), Form::Finite(own)) => {
            finite::pull_energy(finite, &q, scale, &mut by_q, own);
        }
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
    let still = Vec3::zeros();
    add_part(numbering, body, (&still, &still), &by_q, y);
}

/// A value of each strain of the beams of a body along their axes, where they are quadratic.
fn of_axial_strains<S: Scalar, T>(
    body: &FlexibleBody<S>,
    motions: &[BodyMotion<S>],
    of: impl Fn(&Quadratic<S>, &[S]) -> T,
) -> Vec<T> {
    match (&body.form, body.form.shells()) {
        (_, Some(own)) if own.parts.is_empty() => Vec::new(),
        (_, Some(own)) => finite::of_axial_strains(own, &unknowns(body, motions), of),
        (Form::Modal(modal), None) => {
            let (strains, q) = (modal.stiffness.strains.iter(), coordinates(body, motions));
            let along = strains.filter(|own| own.axial);
            along.map(|own| of(&own.strain, &q)).collect()
        }
        (Form::Finite(_), None) => Vec::new(),
    }
}

/// Strains of the beams of a body along their axes.
pub fn axial_strains<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Vec<S> {
    of_axial_strains(body, motions, Quadratic::value)
}

/// How far a body is turned relative to its frame; `None` of bodies from files, whose points have no
/// surface or line.
pub fn turned(body: &FlexibleBody<f64>, motions: &[BodyMotion<f64>]) -> Option<Turned> {
    if let Some(own) = body.form.shells() {
        return Some(finite::turned(own, &unknowns(body, motions)));
    }
    let Form::Modal(modal) = &body.form else {
        return None;
    };
    let q = coordinates(body, motions);
    let mut sum = Turned::default();
    for (i, section) in modal.sections.iter().enumerate() {
        let square = |row: &Vec<f64>| dot(row, &q).powi(2);
        let slopes = section.slopes.each_ref().map(square);
        let (out, twist) = (slopes[0] + slopes[1], square(&section.twist));
        let quadratic = if section.von_karman { 0.5 * out } else { 0.0 };
        let [stretch, twisted, bent2, bent3] = std::array::from_fn(|k| {
            let strain = dot(&section.strains[k], &q) + if k == 0 { quadratic } else { 0.0 };
            0.5 * section.size * section.stiffness[k] * strain * strain
        });
        let energies = [stretch, bent2 + bent3, twisted];
        sum.add(i, &turned_line(section.size, [out, twist], energies));
    }
    (!modal.sections.is_empty()).then_some(sum)
}

/// The largest bending moment of a beam about its strong axis by that which would buckle it laterally; zero of beams that
/// can buckle, and of other bodies.
pub fn of_lateral_moment(body: &FlexibleBody<f64>, motions: &[BodyMotion<f64>]) -> f64 {
    let Form::Modal(modal) = &body.form else {
        return 0.0;
    };
    if modal
        .sections
        .iter()
        .all(|section| section.lateral.is_none())
    {
        return 0.0;
    }
    let q = coordinates(body, motions);
    let part = |section: &BeamSection| {
        let (strong, critical) = section.lateral?;
        let moment = section.stiffness[strong] * dot(&section.strains[strong], &q);
        Some(moment.abs() / critical)
    };
    modal.sections.iter().filter_map(part).fold(0.0, f64::max)
}

/// The first element of a body of shells that is turned inside out.
pub fn inside_out<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Option<usize> {
    let own = body.form.shells()?;
    finite::inside_out(own, &unknowns(body, motions))
}

/// Von Mises stress by yield stress at the points of some elements of a body of shells; none of others.
pub fn stress_ratios<S: Scalar>(
    body: &FlexibleBody<S>,
    motions: &[BodyMotion<S>],
    elements: &[usize],
) -> Vec<S> {
    match body.form.shells() {
        Some(own) => finite::stress_ratios(own, &unknowns(body, motions), elements),
        None => Vec::new(),
    }
}

/// The unknowns of the nodes of a body of shells.
fn unknowns<S: Scalar>(body: &FlexibleBody<S>, motions: &[BodyMotion<S>]) -> Vec<S> {
    body.form.unknowns(coordinates(body, motions))
}

/// Transpose of the derivative of [`stress_ratios`] of flexible body `i`, for the cotangents `bar`.
pub fn pull_stress_ratios(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    (i, elements, bar): (usize, &[usize], &[f64]),
    y: &mut [f64],
    cot: &mut Model<f64>,
) {
    let (body, own) = (&model.flexible[i], &mut cot.flexible[i]);
    let q = coordinates(body, motions);
    let mut by_q = vec![0.0; q.len()];
    match (&body.form, &mut own.form) {
        (Form::Modal(modal), Form::Modal(cot)) => {
            if let (Some(own), Some(cot)) = (&modal.shells, &mut cot.shells) {
                let unknowns = own.unknowns(&q);
                let mut by = vec![0.0; unknowns.len()];
                let cot = &mut cot.elements;
                finite::pull_stress_ratios(&own.elements, (&unknowns, elements), bar, &mut by, cot);
                own.basis.add_transposed(&by, &mut by_q);
            }
        }
        (Form::Finite(finite), Form::Finite(own)) => {
            finite::pull_stress_ratios(finite, (&q, elements), bar, &mut by_q, own);
        }
        (Form::Modal(_), Form::Finite(_)) | (Form::Finite(_), Form::Modal(_)) => unlike(),
    }
    add_coordinates(numbering, body, &by_q, y);
}

/// Adds the derivatives of the kinetic energy times the first and of the potential energy times the
/// second of `scales`, as in [`held`].
pub fn pull_energies(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    [kinetic, potential]: [f64; 2],
    (y, v): (&mut [f64], &mut [f64]),
    cot: &mut Model<f64>,
) {
    let still = Vec3::zeros();
    for (i, body) in model.flexible.iter().enumerate() {
        let frame = &motions[body.frame];
        let at = weighed(body, motions);
        let nu = frame.rotation.tr_mul(&frame.velocity);
        let own = &mut cot.flexible[i].form;
        let (by, velocity) = pull_kinetic(body, (&at, &nu), kinetic, own);
        add_part(numbering, body, (&still, &by.theta), &by.q, y);
        add_part(numbering, body, (&velocity, &by.omega), &by.rate, v);
        // −g · R p.
        let down = frame.rotation.tr_mul(&model.gravity) * -potential;
        let q = coordinates(body, motions);
        let p = first_moment(&body.form, &q);
        cot.gravity -= frame.rotation * p * potential;
        let mut by_q = vec![0.0; q.len()];
        pull_first_moment(&body.form, (&q, true), &down, &mut by_q, own);
        add_part(numbering, body, (&still, &p.cross(&down)), &by_q, y);
        pull_strain_energy((model, numbering), motions, (i, potential), y, cot);
    }
}

/// Adds the derivatives of the linear momentum of the flexible bodies, as in [`held`], along a vector in
/// ground axes.
pub fn pull_momentum(
    (model, numbering): (&Model<f64>, &Numbering),
    motions: &[BodyMotion<f64>],
    along: &Vec3<f64>,
    (y, v): (&mut [f64], &mut [f64]),
    cot: &mut Model<f64>,
) {
    let still = Vec3::zeros();
    for (body, own) in model.flexible.iter().zip(&mut cot.flexible) {
        let (frame, at) = (&motions[body.frame], weighed(body, motions));
        // R (ω × p + ṗ) · d with p = Σ q_I p_I.
        let own_along = frame.rotation.tr_mul(along);
        let turned = own_along.cross(&at.omega);
        let p = first_moment(&body.form, &at.q);
        let nu = Vec3::zeros();
        let momentum = moving(&body.form, &at, &nu).momentum;
        let (mut by_q, mut by_rate) = (vec![0.0; at.q.len()], vec![0.0; at.q.len()]);
        let form = &mut own.form;
        pull_first_moment(&body.form, (&at.q, true), &turned, &mut by_q, form);
        if body.inertia == Inertia::Paper {
            by_q.fill(0.0);
        }
        pull_first_moment(
            &body.form,
            (&at.rate, false),
            &own_along,
            &mut by_rate,
            form,
        );
        add_part(
            numbering,
            body,
            (&still, &momentum.cross(&own_along)),
            &by_q,
            y,
        );
        add_part(numbering, body, (&still, &p.cross(&own_along)), &by_rate, v);
    }
}
