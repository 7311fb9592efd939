//! Bushings: linear forces and torques of all relative motion of the two frames of a joint, and their derivatives.
//!
//! ```text
//! x = (e_1·d, e_2·d, e_3·d, θ_1, θ_2, θ_3),   θ_i = ½ (e_j·e'_k − e_k·e'_j) = n_i sin φ        (i, j, k cyclic)
//! V = ½ xᵀ K x,   ψᵀf = −(K x + C ẋ)ᵀ ẋ(ψ)
//! ```
//!
//! with d = P_A − P_B, e the axes of the frame on A and e' those on B, which are turned by φ about n. A load of which
//! [`of_second`](crate::model::LoadKind::Bushing::of_second) is set has its bodies exchanged: A is the second. The six numbers are
//! those of constraint rows, Sliding and Perpendicular, so that their rates and derivatives are those of joints, and
//! momentum and angular momentum are kept. φ is known up to a quarter turn.

use super::Acting;
use super::bearing::{self, resistance};
use super::power::{along, rate_of};
use super::pull::{Pulled, pull_along};
use crate::math::{Scalar, Vec3};
use crate::model::ConstraintRow;
use crate::model::load::BearingFriction;
use crate::system::bodies::BodyMotion;
use crate::system::constraint;
use crate::system::rows::RowCotangent;
use crate::system::side::JointSide;
use ConstraintRow::{Perpendicular, Sliding};

/// Number of coordinates x.
pub(super) const COORDINATES: usize = 6;

/// The rows whose values give x.
const ROWS: [ConstraintRow; 9] = [
    Sliding { a: 0 },
    Sliding { a: 1 },
    Sliding { a: 2 },
    Perpendicular { a: 1, b: 2 },
    Perpendicular { a: 2, b: 1 },
    Perpendicular { a: 2, b: 0 },
    Perpendicular { a: 0, b: 2 },
    Perpendicular { a: 0, b: 1 },
    Perpendicular { a: 1, b: 0 },
];

type Six<S> = [S; COORDINATES];

/// x from the values of the rows.
fn gathered<S: Scalar>(rows: &[S; 9]) -> Six<S> {
    let half = |i: usize| (rows[i] - rows[i + 1]) * 0.5;
    [rows[0], rows[1], rows[2], half(3), half(5), half(7)]
}

/// The cotangents of the rows from those of x.
fn spread<S: Scalar>(x: &Six<S>) -> [S; 9] {
    let [a, b, c] = [x[3] * 0.5, x[4] * 0.5, x[5] * 0.5];
    [x[0], x[1], x[2], a, -a, b, -b, c, -c]
}

fn values<S: Scalar>(at: &Acting<S>) -> Six<S> {
    gathered(&ROWS.map(|row| constraint::value(row, &at.a, &at.b)))
}

fn rates<S: Scalar>(at: &Acting<S>) -> Six<S> {
    let mut all = [S::zero(); 9];
    constraint::rates(ROWS.into_iter(), &at.a, &at.b, &mut all);
    gathered(&all)
}

/// M x of a matrix by rows.
fn product<S: Scalar>(matrix: &[S], x: &Six<S>) -> Six<S> {
    let row = |i: usize| {
        let row = &matrix[COORDINATES * i..COORDINATES * (i + 1)];
        row.iter()
            .zip(x)
            .fold(S::zero(), |sum, (&m, &x)| sum + m * x)
    };
    std::array::from_fn(row)
}

/// Mᵀ x.
fn transposed<S: Scalar>(matrix: &[S], x: &Six<S>) -> Six<S> {
    std::array::from_fn(|k| {
        (0..COORDINATES).fold(S::zero(), |sum, i| sum + matrix[COORDINATES * i + k] * x[i])
    })
}

fn dot<S: Scalar>(a: &Six<S>, b: &Six<S>) -> S {
    a.iter().zip(b).fold(S::zero(), |sum, (&a, &b)| sum + a * b)
}

/// K x + C ẋ.
fn reaction<S: Scalar>([k, c]: [&[S]; 2], x: &Six<S>, rate: &Six<S>) -> Six<S> {
    let (elastic, viscous) = (product(k, x), product(c, rate));
    std::array::from_fn(|i| elastic[i] + viscous[i])
}

/// K and C, and the friction of a bearing.
pub(super) type Law<'a, S> = ([&'a [S]; 2], Option<&'a BearingFriction<S>>);

/// Force (ground axes) and torque (body axes) on body A and on body B.
pub(super) fn forces<S: Scalar>(
    (law, friction): Law<S>,
    at: &Acting<S>,
) -> [(Vec3<S>, Vec3<S>); 2] {
    let reaction = reaction(law, &values(at), &rates(at));
    let weights = spread(&reaction);
    let none = (Vec3::zeros(), Vec3::zeros());
    let mut on = [none, none];
    for (row, weight) in ROWS.into_iter().zip(weights) {
        let g = constraint::gradient(row, &at.a, &at.b);
        on[0].0 -= g.force * weight;
        on[0].1 -= g.torque_a * weight;
        on[1].0 += g.force * weight;
        on[1].1 -= g.torque_b * weight;
    }
    if let Some(own) = friction {
        let across = [reaction[0], reaction[1]];
        let more = along(at, own.dof, |rate| -resistance(own, across, rate).value);
        for (on, (force, torque)) in on.iter_mut().zip(more) {
            on.0 += force;
            on.1 += torque;
        }
    }
    on
}

/// V \[J\].
pub(super) fn potential<S: Scalar>(stiffness: &[S], at: &Acting<S>) -> S {
    let x = values(at);
    dot(&x, &product(stiffness, &x)) * 0.5
}

/// Adds the pull-back of cotangents of x, ẋ and ẋ(ψ), the virtual velocities of the motions of `at`.
fn pull_rows<S: Scalar>(at: &Acting<S>, [x, rate, virtually]: [&Six<S>; 3], out: &mut Pulled<S>) {
    let [x, rate, virtually] = [spread(x), spread(rate), spread(virtually)];
    let cot = |i: usize| RowCotangent {
        value: x[i],
        rate: rate[i],
        acceleration: S::zero(),
        virtual_rate: virtually[i],
    };
    let (by_a, by_b) = constraint::pull_back(ROWS.into_iter(), cot, &at.a, &at.b);
    out.a.add(&by_a);
    out.b.add(&by_b);
}

/// Adds the derivatives of ψᵀf; `virtually` has the velocities ψ.
pub(super) fn pull<S: Scalar>(
    (law @ [k, c], friction): Law<S>,
    at: &Acting<S>,
    virtually: &Acting<S>,
    out: &mut Pulled<S>,
) {
    let (x, rate, along) = (values(at), rates(at), rates(virtually));
    let reaction = reaction(law, &x, &rate);
    let mut by_reaction = along.map(|x| -x);
    if let Some(own) = friction {
        let by = resistance(own, [reaction[0], reaction[1]], rate_of(at, own.dof));
        let law = |_| (-by.value, -by.by_rate);
        let (_, turned) = pull_along(at, virtually, own.dof, law, out);
        for (by_force, own) in by_reaction.iter_mut().zip(by.by_forces) {
            *by_force -= own * turned;
        }
        out.set_scalars::<{ bearing::PARAMETERS }>(by.by_own.map(|own| -(own * turned)));
    }
    let both = |side: &JointSide<S>, psi: &JointSide<S>| BodyMotion {
        virtual_velocity: psi.motion.velocity,
        virtual_omega: psi.motion.omega,
        ..*side.motion
    };
    let motions = [both(&at.a, &virtually.a), both(&at.b, &virtually.b)];
    let moving = Acting {
        bodies: at.bodies,
        a: JointSide::fixed(&motions[0], at.a.frame),
        b: JointSide::fixed(&motions[1], at.b.frame),
        counted: None,
        part: 0.0,
    };
    let minus = |all: Six<S>| all.map(|x| -x);
    let (by_x, by_rate) = (transposed(k, &by_reaction), transposed(c, &by_reaction));
    let by_along = minus(reaction);
    pull_rows(&moving, [&by_x, &by_rate, &by_along], out);
    out.six = Some([by_reaction, x, rate]);
}

/// Adds the derivatives of `weight` V.
pub(super) fn pull_potential<S: Scalar>(
    stiffness: &[S],
    at: &Acting<S>,
    weight: S,
    out: &mut Pulled<S>,
) {
    let x = values(at);
    let (ahead, back) = (product(stiffness, &x), transposed(stiffness, &x));
    let half = weight * 0.5;
    let zero = [S::zero(); COORDINATES];
    let by_x = std::array::from_fn(|i| (ahead[i] + back[i]) * half);
    pull_rows(at, [&by_x, &zero, &zero], out);
    out.six = Some([x.map(|x| x * half), x, zero]);
}

/// Adds the derivatives in the matrices: a bᵀ and a cᵀ of `six` (a, b, c).
pub(super) fn give(six: &[Six<f64>; 3], stiffness: &mut [f64], damping: &mut [f64]) {
    let [a, b, c] = six;
    for (matrix, columns) in [(stiffness, b), (damping, c)] {
        for (row, a) in matrix.chunks_exact_mut(COORDINATES).zip(a) {
            for (entry, b) in row.iter_mut().zip(columns) {
                *entry += a * b;
            }
        }
    }
}
