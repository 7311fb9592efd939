//! Assembly: the positions nearest to the placement that satisfy all constraints, by E_y + Gᵀ s =
//! 0, Φ(q, 0) = 0; or the joint that cannot be closed. The distance E is the mean square
//! displacement of the mass,
//!
//! ```text
//! E = ½ Σ ∫ |x(q) − x(q_g)|² dm = Σ ½ m |r − r_g|² + tr(S) − tr(R S R_gᵀ),     S = ½ tr(J) 1 − J
//! ```
//!
//! It does not depend on units. Welded bodies count as a single one would.

use super::bodies::{self, BodyMotion, positions_of};
use super::failure::AssemblyFailure;
use super::flexible;
use super::in_motion::InMotion;
use super::joints;
use super::kkt::{BodyBlocks, Metric, SaddlePoint};
use super::numbering::Numbering;
use super::placement::length_scale;
use super::redundancy;
use super::side::sides;
use crate::linalg::SolveScalar;
use crate::math::rotation::{self, Quat};
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::{Joint, Model};

const ITERATIONS: usize = 50;
/// Joints are closed up to this gap relative to the length scale.
const CLOSED: f64 = 1e-13;

/// Rows that are left out are redundant up to this gap relative to the length scale.
const FOLLOWS: f64 = 1e-9;

/// Up to this gap relative to the length scale, a singular start is attributed to its constraints.
const NEARLY_CLOSED: f64 = 0.05;

/// Finds the nearest assembled positions by Newton's method: (q, s, iterations).
pub(super) fn assemble<S: SolveScalar>(
    model: &Model<S>,
    numbering: &Numbering,
    saddle: &mut SaddlePoint<S>,
    q_guess: &[S],
    v_guess: &[S],
) -> Result<(Vec<S>, Vec<S>, usize), AssemblyFailure> {
    let (nv, nc) = (numbering.velocities(), numbering.constraints());
    let scale = length_scale(model);
    let mut q = q_guess.to_vec();
    let mut increment = vec![S::zero(); q.len()];
    bodies::normalise(numbering, &mut q, &mut increment);
    let mut s = vec![S::zero(); nc];
    let mut motions = Vec::new();
    let mut phi = vec![S::zero(); nc];
    let mut gradients = Vec::new();
    let mut closed_before = false;
    // The conditions with the smallest gap so far, for the message of a failure.
    let mut best = Vec::new();
    let mut least = f64::INFINITY;
    for iteration in 0..ITERATIONS {
        BodyMotion::all(numbering, &q, v_guess, &mut motions);
        let at = InMotion::new(model, numbering, &motions, S::zero());
        joints::values(&at, &mut phi);
        saddle.left_out().clear(&mut phi);
        let gap = phi.iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
        if gap < least {
            least = gap;
            best.clone_from(&phi);
        }
        joints::gradients(&at, &mut gradients);
        let mut rhs = vec![S::zero(); nv];
        add_displacement(model, numbering, &q, &mut rhs);
        joints::add_reactions(model, numbering, &gradients, &s, &mut rhs);
        rhs.extend(&phi);
        for x in &mut rhs {
            *x = -*x;
        }
        let metric = displacement_metric(model, numbering, &q);
        saddle
            .factorise(&at, &s, metric, Metric::Displacement)
            .map_err(|_| {
                // Joints that are redundant seldom meet exactly before assembly.
                let meet = least <= NEARLY_CLOSED * scale && iteration == 0;
                if meet || least <= CLOSED * scale.max(1.0) {
                    super::rank::explain(model, &q)
                } else {
                    // A body that spins without inertia is singular in any position.
                    match super::rank::explain(model, &q) {
                        loose @ AssemblyFailure::WithoutInertia { .. } => loose,
                        _ => open(model, numbering, &best, iteration),
                    }
                }
            })?;
        saddle.solve(&mut rhs);
        if !finite(&rhs) {
            return Err(open(model, numbering, &best, iteration));
        }
        bodies::advance(numbering, &mut q, &mut increment, &rhs[..nv]);
        for (s, step) in s.iter_mut().zip(&rhs[nv..]) {
            *s += *step;
        }
        // One more step after the real part has converged, so that an infinitesimal part converges
        // too.
        let moved = rhs[..nv].iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
        let closed = gap <= CLOSED * scale.max(1.0) && moved <= 1e-10 * scale.max(1.0);
        if closed && closed_before {
            check_turned(model, &motions)?;
            check_left_out(model, &motions, scale, iteration)?;
            return Ok((q, s, iteration));
        }
        closed_before = closed;
    }
    Err(open(model, numbering, &best, ITERATIONS))
}

/// Second moment S = ∫ s sᵀ dm = ½ tr(J) 1 − J of a body with inertia J. For a thin rod, the
/// difference of the moments about two axes is computed first, so that S keeps all digits.
pub(super) fn second_moment<S: Scalar>(inertia: &Mat3<S>) -> Mat3<S> {
    let moment = |k: usize| inertia[(k, k)];
    Mat3::from_fn(|k, l| {
        if k != l {
            return -inertia[(k, l)];
        }
        let (i, j) = (moment((k + 1) % 3), moment((k + 2) % 3));
        let (less, more) = if i.re() < j.re() { (i, j) } else { (j, i) };
        ((more - moment(k)) + less) * S::from(0.5)
    })
}

/// The vector w with tr(ω̃ X) = −ω · w for all ω.
pub(super) fn axial<S: Scalar>(x: &Mat3<S>) -> Vec3<S> {
    Vec3::new(
        x[(2, 1)] - x[(1, 2)],
        x[(0, 2)] - x[(2, 0)],
        x[(1, 0)] - x[(0, 1)],
    )
}

/// The rotation R_gᵀ R(p) of a body from its placement.
pub(super) fn turned_by<S: Scalar>(placed: &Quat<S>, p: &Quat<S>) -> Mat3<S> {
    rotation::matrix(placed).transpose() * rotation::matrix(p)
}

/// Adds E_y, the gradient of the displacement E in the tangent positions: m (r − r_g), w(S R_gᵀ R).
pub(super) fn add_displacement<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    q: &[S],
    out: &mut [S],
) {
    for (i, body) in model.bodies.iter().enumerate() {
        let (r, p) = positions_of(&q[numbering.position(i)..]);
        let turned = second_moment(&body.inertia) * turned_by(&body.orientation, &p);
        let linear = (r - body.position) * body.mass;
        bodies::add6(&mut out[numbering.velocity(i)..], &linear, &axial(&turned));
    }
    flexible::add_displacement(model, numbering, q, out);
}

/// E_yy: m, and tr(X) 1 − Xᵀ with X = S R_gᵀ R. The latter is computed as J + tr(Y) 1 − Yᵀ with
/// Y = S (R_gᵀ R − 1), so that the smallest moment of inertia keeps its digits.
pub(super) fn displacement_metric<'a, S: Scalar>(
    model: &'a Model<S>,
    numbering: &'a Numbering,
    q: &'a [S],
) -> impl Fn(usize) -> BodyBlocks<S> + 'a {
    |index| {
        let (_, p) = positions_of(&q[numbering.position(index)..]);
        let body = &model.bodies[index];
        let turned = turned_by(&body.orientation, &p) - Mat3::identity();
        let moved = second_moment(&body.inertia) * turned;
        BodyBlocks {
            linear: body.mass,
            angular: body.inertia + Mat3::identity() * moved.trace() - moved.transpose(),
        }
    }
}

/// The joint and row with the largest gap.
fn open<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    phi: &[S],
    iterations: usize,
) -> AssemblyFailure {
    let worst = (0..phi.len())
        .reduce(|w, i| {
            if phi[i].re().abs() > phi[w].re().abs() {
                i
            } else {
                w
            }
        })
        .unwrap_or(0);
    let number = numbering.joint_of_row(worst);
    let joint = &model.joints[number];
    let row = joint.rows().nth(worst - numbering.rows(number).start);
    AssemblyFailure::Open {
        joint: joint.name.clone(),
        row: row.map_or("row", |row| row.describe()).to_string(),
        gap: phi[worst].re().abs(),
        iterations,
    }
}

/// Rejects positions at which rows that were left out are not redundant.
fn check_left_out<S: Scalar>(
    model: &Model<S>,
    motions: &[BodyMotion<S>],
    scale: f64,
    iterations: usize,
) -> Result<(), AssemblyFailure> {
    match redundancy::open(model, (motions, S::zero()), FOLLOWS * scale.max(1.0)) {
        Some(widest) => Err(AssemblyFailure::Open {
            joint: model.joints[widest.joint].name.clone(),
            row: widest.row.describe().to_string(),
            gap: widest.gap,
            iterations,
        }),
        None => Ok(()),
    }
}

/// Rejects the spurious solution of the orientation rows in which one frame is turned by 180°.
fn check_turned<S: Scalar>(
    model: &Model<S>,
    motions: &[BodyMotion<S>],
) -> Result<(), AssemblyFailure> {
    let at = (motions, S::zero());
    match model.joints.iter().find(|joint| is_turned(joint, at)) {
        None => Ok(()),
        Some(joint) => Err(AssemblyFailure::Turned {
            joint: joint.name.clone(),
        }),
    }
}

/// A driven or coupled joint at the spurious solution of its rows, in which a frame is turned by 180°, with
/// the motions and the time `at`. Steps of half a turn lead there.
pub fn turned<'a, S: Scalar>(
    model: &'a Model<S>,
    at: (&[BodyMotion<S>], S),
) -> Option<&'a Joint<S>> {
    let turns = |joint: &&Joint<S>| !joint.drives.is_empty() || joint.is_coupled();
    let driven = model.joints.iter().filter(turns);
    driven.into_iter().find(|joint| is_turned(joint, at))
}

fn is_turned<S: Scalar>(joint: &Joint<S>, (motions, time): (&[BodyMotion<S>], S)) -> bool {
    let ground = BodyMotion::ground();
    let (a, b) = sides(joint, motions, &ground, time);
    let opposite = |&axis: &usize| a.axis(axis).dot(&b.axis(axis)).re() < 0.0;
    joint.common_axes().iter().any(opposite)
}

pub(super) fn finite<S: Scalar>(x: &[S]) -> bool {
    x.iter().all(|x| x.is_finite())
}
