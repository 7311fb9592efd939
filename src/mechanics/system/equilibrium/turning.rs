//! Steady rotation of a whole machine about an axis: rest in a frame that turns with it.
//!
//! With the angular velocity Ω, a point c of the axis, and the rotation R of a body,
//!
//! ```text
//! ṙ = V = Ω × (r − c),     ω = Rᵀ Ω,     r̈ = A = Ω × (Ω × (r − c)),     ω̇ = 0,
//! ```
//!
//! and elastic coordinates are at rest. Let y be small motions as the turning frame sees them, and w = Rᵀ Ω. Velocities and
//! accelerations change by
//!
//! ```text
//! δv = V_y y + ẏ,           V_y = diag(Ω̃, w̃)
//! δv̇ = A_y y + A_1 ẏ + ÿ,   A_y = diag(Ω̃ Ω̃, 0),   A_1 = diag(2 Ω̃, w̃)
//! ```
//!
//! so the equations of the machine themselves give centrifugal and gyroscopic terms: no other formulas do.
//!
//! At an instant of a motion each body sees them in its own frame, with Ω and Ω̇ of the body. Then
//! A_y = diag(Ω̃ Ω̃ + skew(Ω̇), skew(ω̇)).

use crate::linalg::Emit;
use crate::math::rotation::matrix;
use crate::math::scalar::skew;
use crate::math::{Mat3, Parameters, Scalar, Vec3};
use crate::model::Model;
use crate::system::bodies::positions_of;
use crate::system::numbering::Numbering;

/// The steady rotation of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Turning<S> {
    /// Direction of the axis, a unit vector in ground axes.
    pub axis: Vec3<S>,
    /// A point of the axis \[m\].
    pub point: Vec3<S>,
    /// Speed \[rad/s\].
    pub speed: S,
}

impl<S: Scalar> Turning<S> {
    pub(super) fn map<T: Scalar>(&self, of: &mut dyn FnMut(S) -> T) -> Turning<T> {
        Turning {
            axis: Parameters::map(&self.axis, of),
            point: Parameters::map(&self.point, of),
            speed: of(self.speed),
        }
    }

    /// Angular velocity Ω, ground axes \[rad/s\].
    fn omega(&self) -> Vec3<S> {
        self.axis * self.speed
    }

    /// The rotation at another speed.
    #[must_use]
    pub fn at_speed(&self, speed: S) -> Self {
        Self {
            speed,
            ..self.clone()
        }
    }

    /// Velocities and accelerations of all bodies at positions q.
    pub(super) fn velocities(
        &self,
        model: &Model<S>,
        numbering: &Numbering,
        q: &[S],
    ) -> [Vec<S>; 2] {
        let mut v = vec![S::zero(); numbering.velocities()];
        let mut a = v.clone();
        let omega = self.omega();
        for i in (0..model.bodies.len()).filter(|&i| !model.is_carrier(i)) {
            let (position, orientation) = positions_of(&q[numbering.position(i)..]);
            let o = numbering.velocity(i);
            let linear = omega.cross(&(position - self.point));
            let angular = matrix(&orientation).tr_mul(&omega);
            v[o..o + 3].copy_from_slice(linear.as_slice());
            v[o + 3..o + 6].copy_from_slice(angular.as_slice());
            a[o..o + 3].copy_from_slice(omega.cross(&linear).as_slice());
        }
        [v, a]
    }
}

/// Blocks of V_y, A_y and A_1 of a body, each for its displacement and its rotation.
type Blocks<S> = [[Mat3<S>; 2]; 3];

/// The frames in which small motions are seen, by body. Those of carriers of elastic coordinates do not turn.
pub(super) struct Frames<S>(Vec<Blocks<S>>);

impl<S: Scalar> Frames<S> {
    /// One frame that turns with the machine.
    pub(super) fn turning(of: (&Model<S>, &Numbering, &[S]), turning: &Turning<S>) -> Self {
        let (omega, still) = (turning.omega(), Vec3::zeros());
        Self::new(of, |_, rotation| {
            let own = rotation.tr_mul(&omega);
            ([omega, own], [still, still])
        })
    }

    /// The frames of the bodies themselves, which move so. Point masses have that of ground.
    pub(super) fn of_bodies(of: (&Model<S>, &Numbering, &[S]), v: &[S], a: &[S]) -> Self {
        let numbering = of.1;
        let three = |x: &[S], at: usize| Vec3::new(x[at], x[at + 1], x[at + 2]);
        Self::new(of, |i, rotation| {
            let o = numbering.velocity(i) + 3;
            let [speed, faster] = [three(v, o), three(a, o)];
            ([rotation * speed, speed], [rotation * faster, faster])
        })
    }

    /// `rates` gives the angular velocity of a frame and the angular acceleration, each in ground axes and in those of the
    /// body.
    fn new(
        (model, numbering, q): (&Model<S>, &Numbering, &[S]),
        rates: impl Fn(usize, &Mat3<S>) -> ([Vec3<S>; 2], [Vec3<S>; 2]),
    ) -> Self {
        let one = |i: usize| {
            if model.is_carrier(i) {
                return [[Mat3::zeros(); 2]; 3];
            }
            let (_, orientation) = positions_of(&q[numbering.position(i)..]);
            let (speeds, faster) = rates(i, &matrix(&orientation));
            let [turned, own] = speeds.map(|x| skew(&x));
            let [turned_faster, own_faster] = faster.map(|x| skew(&x));
            [
                [turned, own],
                [turned * turned + turned_faster, own_faster],
                [turned * S::from(2.0), own],
            ]
        };
        Self((0..model.bodies.len()).map(one).collect())
    }
}

/// Factors of y, ẏ and ÿ in the equations of small motions: of K, D and M.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights<S> {
    pub stiffness: S,
    pub damping: S,
    pub mass: S,
}

impl<S: Scalar> Weights<S> {
    /// Those of K + s D + s² M.
    pub(super) fn at(s: S) -> Self {
        Self {
            stiffness: S::one(),
            damping: s,
            mass: s * s,
        }
    }

    /// Those of K alone.
    pub(super) fn stiffness() -> Self {
        Self::at(S::zero())
    }
}

/// Columns of velocities and accelerations, which it adds to those of positions.
pub(super) struct Steady<'a, S> {
    /// First columns of velocities and of accelerations.
    columns: [usize; 2],
    /// By body, its displacement and its rotation: the factors of y for velocities and accelerations.
    blocks: Option<Vec<[[Mat3<S>; 2]; 2]>>,
    /// Those of frames that do not turn.
    factors: [S; 2],
    emit: &'a mut dyn Emit<S>,
}

impl<'a, S: Scalar> Steady<'a, S> {
    pub(super) fn new(
        frames: Option<Frames<S>>,
        (weights, columns): (Weights<S>, [usize; 2]),
        emit: &'a mut dyn Emit<S>,
    ) -> Self {
        let Weights {
            stiffness,
            damping,
            mass,
        } = weights;
        let unit = Mat3::<S>::identity();
        let of = |[by_y, by_rest, by_rate]: Blocks<S>| {
            [
                [0, 1].map(|k| by_y[k] * stiffness + unit * damping),
                [0, 1].map(|k| by_rest[k] * stiffness + by_rate[k] * damping + unit * mass),
            ]
        };
        let blocks = frames.map(|own| own.0.into_iter().map(of).collect());
        Self {
            columns,
            blocks,
            factors: [damping, mass],
            emit,
        }
    }
}

impl<S: Scalar> Emit<S> for Steady<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        let which = match column {
            _ if column >= self.columns[1] => 1,
            _ if column >= self.columns[0] => 0,
            _ => return self.emit.add(row, column, value),
        };
        let at = column - self.columns[which];
        let Some(blocks) = &self.blocks else {
            return self.emit.add(row, at, value * self.factors[which]);
        };
        let (body, k) = (at / 6, at % 6);
        let block = &blocks[body][which][k / 3];
        for j in 0..3 {
            let column = 6 * body + 3 * (k / 3) + j;
            self.emit.add(row, column, value * block[(k % 3, j)]);
        }
    }
}
