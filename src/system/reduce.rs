//! Linear systems in the unknowns u of v = B u: vectors are brought to Bᵀ x and back to B u, and
//! matrices are emitted as Bᵀ A B.
//!
//! A vector or matrix consists of some parts in velocity numbering (one for the index-1 equations,
//! two, of positions and of velocities, for the stabilised ones) followed by entries of constraint
//! rows, which stay as they are. B has orthonormal columns, so that x = B u has u = Bᵀ x.

use super::bodies::{add7, positions_of};
use super::constraint::RowGradient;
use super::numbering::Numbering;
use crate::linalg::Emit;
use crate::math::rotation::{self, Quat};
use crate::math::{Scalar, Vec3};
use crate::model::{Mobility, RigidBody};

/// aᵀ b of a constant vector b.
pub fn along<S: Scalar>(a: &Vec3<S>, b: &Vec3<f64>) -> S {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// Replaces `x` by its reduced form, which stands at its head: Bᵀ of each of the `parts`, then the
/// rest. Returns its length.
pub fn compress<S: Scalar>(numbering: &Numbering, parts: usize, x: &mut [S]) -> usize {
    if !numbering.is_reduced() {
        return x.len();
    }
    let (nv, nu) = (numbering.velocities(), numbering.unknowns());
    for part in 0..parts {
        for body in 0..numbering.bodies() {
            let at = part * nv + numbering.velocity(body);
            let to = part * nu + numbering.unknown(body);
            // What is written stands before what is yet to be read.
            match numbering.mobility(body) {
                Mobility::Spatial => x.copy_within(at..at + 6, to),
                Mobility::Point => x.copy_within(at..at + 3, to),
                Mobility::Fixed => {}
                Mobility::PlanarPoint {
                    along: [t1, t2], ..
                } => {
                    let linear = Vec3::new(x[at], x[at + 1], x[at + 2]);
                    x[to] = along(&linear, t1);
                    x[to + 1] = along(&linear, t2);
                }
                Mobility::Planar {
                    along: [t1, t2],
                    normal,
                } => {
                    let linear = Vec3::new(x[at], x[at + 1], x[at + 2]);
                    let angular = Vec3::new(x[at + 3], x[at + 4], x[at + 5]);
                    x[to] = along(&linear, t1);
                    x[to + 1] = along(&linear, t2);
                    x[to + 2] = along(&angular, normal);
                }
            }
        }
    }
    x.copy_within(parts * nv.., parts * nu);
    x.len() - parts * (nv - nu)
}

/// The inverse of [`compress`]: the reduced form at the head of `x` becomes B u of each of the
/// `parts`, then the rest.
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
            match numbering.mobility(body) {
                Mobility::Spatial => x.copy_within(from..from + 6, at),
                Mobility::Point => {
                    x.copy_within(from..from + 3, at);
                    x[at + 3..at + 6].fill(S::zero());
                }
                Mobility::Fixed => x[at..at + 6].fill(S::zero()),
                Mobility::PlanarPoint {
                    along: [t1, t2], ..
                } => {
                    let u = [x[from], x[from + 1]];
                    for k in 0..3 {
                        x[at + k] = u[0] * t1[k] + u[1] * t2[k];
                    }
                    x[at + 3..at + 6].fill(S::zero());
                }
                Mobility::Planar {
                    along: [t1, t2],
                    normal,
                } => {
                    let u = [x[from], x[from + 1], x[from + 2]];
                    for k in 0..3 {
                        x[at + k] = u[0] * t1[k] + u[1] * t2[k];
                        x[at + 3 + k] = u[2] * normal[k];
                    }
                }
            }
        }
    }
}

/// Lets `solve` work in place on the reduced form of `x`.
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

/// Leaves of the velocities `x` the part that the mobilities admit, B Bᵀ x.
pub fn project<S: Scalar>(numbering: &Numbering, x: &mut [S]) {
    through(numbering, 1, x, |_| {});
}

/// Leaves of tangent positions those that stay as the bodies are placed: all of a body that cannot
/// move, and the rotation of one that cannot turn.
pub fn keep_placed(numbering: &Numbering, y: &mut [f64]) {
    for body in 0..numbering.bodies() {
        let at = numbering.velocity(body);
        let moves = match numbering.mobility(body) {
            Mobility::Fixed => 0,
            Mobility::Point | Mobility::PlanarPoint { .. } => 3,
            Mobility::Spatial | Mobility::Planar { .. } => 6,
        };
        y[at..at + moves].fill(0.0);
    }
}

/// Takes what the mobilities do not admit out of the increments (dq, dv) from a state (q0, v0) to
/// (q, v). The reduced equations do not see such round-off, so that it would grow from step to step
/// by extrapolation.
pub fn hold<S: Scalar>(
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
        let at = numbering.position(body);
        let own = at..at + 7;
        let (dr, dp) = positions_of(&dq[own.clone()]);
        let (dr, dp) = match numbering.mobility(body) {
            Mobility::Spatial => continue,
            Mobility::Fixed => (Vec3::zeros(), [S::zero(); 4]),
            Mobility::Point => (dr, [S::zero(); 4]),
            Mobility::Planar {
                along: plane,
                normal,
            } => {
                let (_, p0) = positions_of(&q0[own.clone()]);
                (in_plane(&dr, plane), turn_about(&p0, &dp, normal))
            }
            Mobility::PlanarPoint { along: plane, .. } => (in_plane(&dr, plane), [S::zero(); 4]),
        };
        dq[own.clone()].fill(S::zero());
        add7(&mut dq[own.clone()], &dr, &dp);
        for k in own {
            q[k] = q0[k] + dq[k];
        }
    }
}

/// The part of x along two orthonormal directions.
fn in_plane<S: Scalar>(x: &Vec3<S>, [t1, t2]: &[Vec3<f64>; 2]) -> Vec3<S> {
    let (u1, u2) = (along(x, t1), along(x, t2));
    Vec3::from_fn(|k, _| u1 * t1[k] + u2 * t2[k])
}

/// The increment of Euler parameters p0, of unit length, that is nearest to dp among the turns about
/// the body axis n.
fn turn_about<S: Scalar>(p0: &Quat<S>, dp: &Quat<S>, n: &Vec3<f64>) -> Quat<S> {
    let back = [p0[0], -p0[1], -p0[2], -p0[3]];
    let turn = rotation::compose(&back, dp);
    // 1 + back ∘ dp, of which the scalar and the part along n are kept.
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

/// The place in unreduced numbering that stands for a reduced one in messages.
pub fn unreduced(numbering: &Numbering, parts: usize, place: usize) -> usize {
    let (nv, nu) = (numbering.velocities(), numbering.unknowns());
    match place.checked_div(nu) {
        Some(part) if part < parts => part * nv + numbering.velocity_of_unknown(place % nu),
        _ => place + parts * (nv - nu),
    }
}

/// Bᵀ M B of a body; where that is of order two, one stands behind it, so that it can be decomposed in
/// order three.
pub(super) fn inertia<S: Scalar, const N: usize>(
    body: &RigidBody<S>,
    mobility: &Mobility,
) -> [[S; N]; N] {
    let mut out = [[S::zero(); N]; N];
    let linear = match mobility {
        Mobility::Fixed => 0,
        Mobility::Planar { .. } | Mobility::PlanarPoint { .. } => 2,
        Mobility::Spatial | Mobility::Point => 3,
    };
    for (i, row) in out.iter_mut().enumerate().take(linear) {
        row[i] = body.mass;
    }
    match mobility {
        Mobility::Spatial => {
            for i in 0..3 {
                for k in 0..3 {
                    out[3 + i][3 + k] = body.inertia[(i, k)];
                }
            }
        }
        Mobility::Planar { normal, .. } => {
            let about = body.inertia * normal.map(S::from);
            out[2][2] = along(&about, normal);
        }
        Mobility::PlanarPoint { .. } => out[2][2] = S::one(),
        Mobility::Point | Mobility::Fixed => {}
    }
    out
}

/// A row of G B on its side A or B.
pub(super) fn reduced<S: Scalar, const N: usize>(
    g: &RowGradient<S>,
    side_a: bool,
    mobility: &Mobility,
) -> [S; N] {
    let (f, t) = match side_a {
        true => (g.force, &g.torque_a),
        false => (-g.force, &g.torque_b),
    };
    let mut out = [S::zero(); N];
    match mobility {
        Mobility::Planar {
            along: [t1, t2],
            normal,
        } => {
            out[0] = along(&f, t1);
            out[1] = along(&f, t2);
            out[2] = along(t, normal);
        }
        Mobility::PlanarPoint {
            along: [t1, t2], ..
        } => {
            out[0] = along(&f, t1);
            out[1] = along(&f, t2);
        }
        Mobility::Point => out[..3].copy_from_slice(f.as_slice()),
        Mobility::Fixed => {}
        Mobility::Spatial => {
            out[..3].copy_from_slice(f.as_slice());
            out[3..].copy_from_slice(t.as_slice());
        }
    }
    out
}

/// Calls `assemble` with what takes entries in unreduced numbering and emits them reduced.
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

/// The reduced places that an unreduced one has a share in, and its shares: a row of B.
pub fn shares(numbering: &Numbering, parts: usize, place: usize) -> [(usize, f64); 2] {
    let (nv, nu) = (numbering.velocities(), numbering.unknowns());
    let part = place / nv.max(1);
    if part >= parts {
        return [(place - parts * (nv - nu), 1.0), (0, 0.0)];
    }
    let within = place % nv;
    let (body, k) = (within / 6, within % 6);
    let at = part * nu + numbering.unknown(body);
    match numbering.mobility(body) {
        Mobility::Spatial => [(at + k, 1.0), (0, 0.0)],
        Mobility::Point if k < 3 => [(at + k, 1.0), (0, 0.0)],
        Mobility::Planar {
            along: [t1, t2], ..
        }
        | Mobility::PlanarPoint {
            along: [t1, t2], ..
        } if k < 3 => [(at, t1[k]), (at + 1, t2[k])],
        Mobility::Planar { normal, .. } => [(at + 2, normal[k - 3]), (0, 0.0)],
        Mobility::PlanarPoint { .. } | Mobility::Point | Mobility::Fixed => [(0, 0.0), (0, 0.0)],
    }
}

impl<S: Scalar> Emit<S> for Reduced<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        // The shares do not depend on values: an entry without one is never emitted.
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
