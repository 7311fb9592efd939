//! Linear systems in the unknowns u of v = B u. Vectors are reduced to Bᵀ x and expanded to B u;
//! matrices are emitted as Bᵀ A B.
//!
//! A vector or matrix has some parts in velocity numbering (one for the index-1 equations; two,
//! positions and velocities, for the stabilised ones), then entries of constraint rows, which do
//! not change. B has orthonormal columns, so u = Bᵀ x for x = B u.

use super::bodies::{add7, positions_of, velocities_of};
use super::numbering::Numbering;
use crate::linalg::Emit;
use crate::math::rotation::{self, Quat};
use crate::math::scalar::along;
use crate::math::{Scalar, Vec3};

/// Reduces `x` in place: its first entries become Bᵀ of each of the `parts`, then the rest. Returns
/// the reduced length.
pub fn compress<S: Scalar>(numbering: &Numbering, parts: usize, x: &mut [S]) -> usize {
    if !numbering.is_reduced() {
        return x.len();
    }
    let (nv, nu) = (numbering.velocities(), numbering.unknowns());
    for part in 0..parts {
        for body in 0..numbering.bodies() {
            // Entries are written before the place of the next read.
            let (linear, angular) = velocities_of(&x[part * nv + numbering.velocity(body)..]);
            let to = part * nu + numbering.unknown(body);
            numbering
                .mobility(body)
                .reduce(&linear, &angular, &mut x[to..]);
        }
    }
    x.copy_within(parts * nv.., parts * nu);
    x.len() - parts * (nv - nu)
}

/// The inverse of [`compress`]: expands the reduced form in the first entries of `x` to B u of each
/// of the `parts`, then the rest.
pub fn expand<S: Scalar>(numbering: &Numbering, parts: usize, x: &mut [S]) {
    if !numbering.is_reduced() {
        return;
    }
    let (nv, nu) = (numbering.velocities(), numbering.unknowns());
    let rest = x.len() - parts * nv;
    x.copy_within(parts * nu..parts * nu + rest, parts * nv);
    for part in (0..parts).rev() {
        for body in (0..numbering.bodies()).rev() {
            let from = part * nu + numbering.unknown(body);
            let at = part * nv + numbering.velocity(body);
            let (linear, angular) = numbering.mobility(body).expand(&x[from..]);
            x[at..at + 3].copy_from_slice(linear.as_slice());
            x[at + 3..at + 6].copy_from_slice(angular.as_slice());
        }
    }
}

/// Bᵀ x of one part.
pub fn compressed<S: Scalar>(numbering: &Numbering, mut x: Vec<S>) -> Vec<S> {
    let n = compress(numbering, 1, &mut x);
    x.truncate(n);
    x
}

/// B u of one part.
pub fn expanded<S: Scalar>(numbering: &Numbering, mut u: Vec<S>) -> Vec<S> {
    u.resize(numbering.velocities(), S::zero());
    expand(numbering, 1, &mut u);
    u
}

/// Applies `solve` in place to the reduced form of `x`.
pub fn through<S: Scalar>(
    numbering: &Numbering,
    parts: usize,
    x: &mut [S],
    solve: impl FnOnce(&mut [S]),
) {
    let n = compress(numbering, parts, x);
    solve(&mut x[..n]);
    expand(numbering, parts, x);
}

/// Projects the velocities `x` onto what the mobilities admit, B Bᵀ x.
pub fn project<S: Scalar>(numbering: &Numbering, x: &mut [S]) {
    through(numbering, 1, x, |_| {});
}

/// Keeps only the tangent positions that stay as placed: all of a body that cannot move, and the
/// rotation of a body that cannot rotate.
pub fn constrain_cotangent(numbering: &Numbering, y: &mut [f64]) {
    for body in 0..numbering.bodies() {
        let at = numbering.velocity(body);
        let mobility = numbering.mobility(body);
        let moves = match mobility.has_rotation() {
            true => 6,
            false => 3 * mobility.translation.free().min(1),
        };
        y[at..at + moves].fill(0.0);
    }
}

/// Removes from the increments (dq, dv) from a state (q0, v0) to (q, v) what the mobilities do not
/// admit. The reduced equations do not act on such round-off; by extrapolation it would grow from
/// step to step.
pub fn project_increments<S: Scalar>(
    numbering: &Numbering,
    (q0, v0): (&[S], &[S]),
    (q, dq): (&mut [S], &mut [S]),
    (v, dv): (&mut [S], &mut [S]),
) {
    if !numbering.is_reduced() {
        return;
    }
    project(numbering, dv);
    for ((v, &v0), &dv) in v.iter_mut().zip(v0).zip(&*dv) {
        *v = v0 + dv;
    }
    for body in 0..numbering.bodies() {
        let mobility = numbering.mobility(body);
        if mobility.unknowns() == 6 {
            continue;
        }
        let at = numbering.position(body);
        let own = at..at + 7;
        let (dr, dp) = positions_of(&dq[own.clone()]);
        let dr = mobility.translation.project(&dr);
        let dp = match mobility.rotation.free() {
            0 => [S::zero(); 4],
            1 => {
                let (_, p0) = positions_of(&q0[own.clone()]);
                turn_about(&p0, &dp, mobility.rotation.axis(0))
            }
            _ => dp,
        };
        dq[own.clone()].fill(S::zero());
        add7(&mut dq[own.clone()], &dr, &dp);
        for k in own {
            q[k] = q0[k] + dq[k];
        }
    }
}

/// The increment of the unit Euler parameters p0 that is nearest to dp among the rotations about
/// the body axis n.
fn turn_about<S: Scalar>(p0: &Quat<S>, dp: &Quat<S>, n: &Vec3<f64>) -> Quat<S> {
    let back = [p0[0], -p0[1], -p0[2], -p0[3]];
    let turn = rotation::compose(&back, dp);
    // 1 + back ∘ dp; the scalar and the component along n are kept.
    let (w, x) = (
        S::one() + turn[0],
        along(&Vec3::new(turn[1], turn[2], turn[3]), n),
    );
    let length = (w * w + x * x).sqrt();
    let (w, x) = (w / length, x / length);
    // w − 1 without cancellation.
    let less = if w.re() > 0.0 {
        -(x * x) / (S::one() + w)
    } else {
        w - S::one()
    };
    rotation::compose(p0, &[less, x * n[0], x * n[1], x * n[2]])
}

/// An unreduced index of the same body or row as a reduced one, for messages.
pub fn unreduced(numbering: &Numbering, parts: usize, place: usize) -> usize {
    let (nv, nu) = (numbering.velocities(), numbering.unknowns());
    match place.checked_div(nu) {
        Some(part) if part < parts => part * nv + numbering.velocity_of_unknown(place % nu),
        _ => place + parts * (nv - nu),
    }
}

/// Calls `assemble` with an `Emit` that takes entries in unreduced numbering and emits them
/// reduced.
pub fn emit_reduced<S: Scalar>(
    numbering: &Numbering,
    parts: usize,
    emit: &mut dyn Emit<S>,
    assemble: impl FnOnce(&mut dyn Emit<S>),
) {
    if numbering.is_reduced() {
        assemble(&mut Reduced {
            numbering,
            parts,
            emit,
        });
    } else {
        assemble(emit);
    }
}

/// Emits Bᵀ A B for the entries of A.
struct Reduced<'a, S> {
    numbering: &'a Numbering,
    parts: usize,
    emit: &'a mut dyn Emit<S>,
}

/// A row of B: the reduced indices of an unreduced one, each with its coefficient.
pub fn shares(numbering: &Numbering, parts: usize, place: usize) -> [(usize, f64); 2] {
    let (nv, nu) = (numbering.velocities(), numbering.unknowns());
    let part = place / nv.max(1);
    if part >= parts {
        return [(place - parts * (nv - nu), 1.0), (0, 0.0)];
    }
    let own = numbering.row(place - part * nv);
    own.map(|(place, share)| (part * nu + place, share))
}

impl<S: Scalar> Emit<S> for Reduced<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        // The shares do not depend on values: the same entries are always omitted.
        let columns = shares(self.numbering, self.parts, column);
        for (i, x) in shares(self.numbering, self.parts, row) {
            for (j, y) in columns {
                if x * y != 0.0 {
                    self.emit.add(i, j, value * (x * y));
                }
            }
        }
    }
}
