//! Kept factors in the axes of bodies that have turned since.
//!
//! Where a whole scene turns by Q, its iteration matrix changes by the axes of its vectors alone,
//! K' = T K Tᵀ. T turns vectors in ground axes: the translations of bodies, and the rows and
//! multipliers of points that coincide. It leaves elastic coordinates and rotations, which are in
//! the axes of bodies. So T K⁻¹ Tᵀ, each body with its own turn Q = R' Rᵀ, serves longer than K⁻¹
//! where flexible bodies turn.

use super::ggl::Equations;
use crate::math::{Mat3, Scalar, Vec3, rotation};
use crate::model::{ConstraintRow, Model};
use crate::system::bodies::positions_of;
use crate::system::{Numbering, RedundantRows};

/// Three ground components in a row.
const GROUND: [ConstraintRow; 3] = [
    ConstraintRow::Coincident(0),
    ConstraintRow::Coincident(1),
    ConstraintRow::Coincident(2),
];

/// The turns since the factors were made.
#[derive(Debug, Default)]
pub struct Turned {
    /// Bodies that move and turn in space.
    bodies: Vec<usize>,
    /// First rows of joints that hold two points together, and their body A.
    points: Vec<(usize, usize)>,
    /// First entries of the vectors in residuals and in unknowns, each with its turn.
    turns: Vec<(usize, Mat3<f64>)>,
}

impl Turned {
    /// Plans the turns of a model, none yet.
    pub fn new<S: Scalar>(model: &Model<S>, numbering: &Numbering) -> Self {
        let in_space = |body: &usize| {
            let mobility = numbering.mobility(*body);
            mobility.translation.free() == 3 && mobility.has_rotation()
        };
        let bodies: Vec<usize> = (0..numbering.bodies()).filter(in_space).collect();
        let joints = model.joints.iter().enumerate();
        let points = joints.filter(|(_, joint)| {
            bodies.binary_search(&joint.body_a).is_ok() && joint.rows().take(3).eq(GROUND)
        });
        Self {
            points: points
                .map(|(j, joint)| (numbering.rows(j).start, joint.body_a))
                .collect(),
            bodies,
            turns: Vec::new(),
        }
    }

    /// No turns: the factors are new.
    pub fn clear(&mut self) {
        self.turns.clear();
    }

    /// Sets the turns from the positions `made`, where the factors were made, to `now`. Rows that are left
    /// out are no vectors.
    pub fn set<S: Scalar>(
        &mut self,
        numbering: &Numbering,
        (made, now): (&[S], &[S]),
        left_out: &RedundantRows,
    ) {
        self.turns.clear();
        let matrix = |q: &[S], body: usize| {
            let (_, p) = positions_of(&q[numbering.position(body)..]);
            rotation::matrix(&p.map(|x| x.re()))
        };
        let turn = |body: usize| matrix(now, body) * matrix(made, body).transpose();
        let (nv, nc) = (numbering.velocities(), numbering.constraints());
        for &body in &self.bodies {
            let (at, turn) = (numbering.velocity(body), turn(body));
            self.turns.extend([(at, turn), (nv + at, turn)]);
        }
        for &(row, body) in &self.points {
            if (row..row + 3).any(|i| left_out.contains(i)) {
                continue;
            }
            let (at, turn) = (2 * nv + row, turn(body));
            self.turns.extend([(at, turn), (nc + at, turn)]);
        }
    }

    /// T K⁻¹ Tᵀ x in place; `solve` applies K⁻¹ to the reduced form of a residual.
    pub fn through<S: Scalar, T: Scalar>(
        &self,
        equations: &Equations<S>,
        x: &mut [T],
        solve: impl FnOnce(&mut [T]),
    ) {
        self.back(x);
        equations.through(x, solve);
        self.forth(x);
    }

    /// Turns a residual back, Tᵀ x.
    pub fn back<T: Scalar>(&self, x: &mut [T]) {
        for (at, turn) in &self.turns {
            turn_by(&turn.transpose(), &mut x[*at..*at + 3]);
        }
    }

    /// Turns an update, T x.
    pub fn forth<T: Scalar>(&self, x: &mut [T]) {
        for (at, turn) in &self.turns {
            turn_by(turn, &mut x[*at..*at + 3]);
        }
    }
}

fn turn_by<T: Scalar>(turn: &Mat3<f64>, x: &mut [T]) {
    let turned = turn.map(T::from) * Vec3::new(x[0], x[1], x[2]);
    x.copy_from_slice(turned.as_slice());
}
