//! The joints of a planar scene: the quantities of [`super::joints`] from the two components of
//! every marker in the plane.
//!
//! Let J be a quarter turn, A = [R b1, R b2] the body's basis of the plane in that of the scene,
//! and s two components of a vector in the body:
//!
//! ```text
//! ρ = A s,   ρ' = A J s,   ρ̇ = ω ρ',   ρ̈ = α ρ' − ω² ρ,   ∂ρ/∂θ = ρ',   ∂ρ'/∂θ = −ρ
//! ```
//!
//! Rates and second derivatives of the rows do not depend on components across the plane. Values
//! depend on those of the frames, and remain in [`super::joints`].

use super::bodies::BodyMotion;
use super::constraint::RowGradient;
use super::marker::MarkerKinematics;
use super::numbering::Numbering;
use super::rows::{Markers, MarkersUsed, Rows};
use crate::math::scalar::along;
use crate::math::{Scalar, Vec3};
use crate::model::{ConstraintRow, Joint, JointFrame, Model, Role};
use nalgebra::Vector2;
use std::iter::Copied;
use std::slice::Iter;

/// A vector in a plane.
pub(super) type Vec2<S> = Vector2<S>;

/// The joints of a planar scene without drives, and the present motions of its bodies.
#[derive(Clone)]
pub struct PlanarJoints<S> {
    /// Two orthonormal directions of the plane, ground axes.
    pub(super) along: [Vec3<f64>; 2],
    /// The components of the ground axes along them.
    ground: [Vec2<S>; 3],
    /// The planes of the bodies; that of ground is last.
    pub(super) planes: Vec<BodyPlane>,
    pub(super) joints: Vec<PlanarJoint<S>>,
    /// Motions of the bodies; that of ground is last.
    pub(super) motions: Vec<PlanarMotion<S>>,
}

/// The plane of a scene in the axes of a body.
#[derive(Clone, Copy)]
pub(super) struct BodyPlane {
    /// Two orthonormal directions b1, b2 = n × b1.
    pub(super) along: [Vec3<f64>; 2],
    /// The normal n.
    pub(super) normal: Vec3<f64>,
}

/// A joint in the plane.
#[derive(Clone)]
pub(super) struct PlanarJoint<S> {
    pub(super) body_a: usize,
    /// Ground has the number after the last body.
    pub(super) body_b: usize,
    pub(super) a: PlanarFrame<S>,
    pub(super) b: PlanarFrame<S>,
    /// Length of a rod \[m\].
    pub(super) length: S,
    pub(super) rows: Vec<ConstraintRow>,
    /// The markers that the rows use.
    pub(super) used: MarkersUsed,
}

/// Point and axes of a joint's frame, in the plane of its body.
#[derive(Clone, Copy)]
pub(super) struct PlanarFrame<S> {
    pub(super) point: Vec2<S>,
    pub(super) axes: [Vec2<S>; 3],
}

/// Motion of a body in the plane of the scene.
#[derive(Clone, Copy)]
pub(super) struct PlanarMotion<S> {
    position: Vec2<S>,
    /// The columns of A.
    pub(super) turn: [Vec2<S>; 2],
    velocity: Vec2<S>,
    pub(super) omega: S,
    acceleration: Vec2<S>,
    pub(super) alpha: S,
    virtual_velocity: Vec2<S>,
    pub(super) virtual_omega: S,
}

/// A marker in the plane.
pub(super) type PlanarMarker<S> = MarkerKinematics<S, 2>;

impl BodyPlane {
    fn components<S: Scalar>(&self, x: &Vec3<S>) -> Vec2<S> {
        Vec2::new(along(x, &self.along[0]), along(x, &self.along[1]))
    }

    fn frame<S: Scalar>(&self, frame: &JointFrame<S>) -> PlanarFrame<S> {
        PlanarFrame {
            point: self.components(&frame.point),
            axes: frame.axes.map(|axis| self.components(&axis)),
        }
    }
}

/// The vector in space with the components `x` along two directions.
pub(super) fn spatial<S: Scalar>([t1, t2]: &[Vec3<f64>; 2], x: &Vec2<S>) -> Vec3<S> {
    Vec3::new(
        x.x * t1.x + x.y * t2.x,
        x.x * t1.y + x.y * t2.y,
        x.x * t1.z + x.y * t2.z,
    )
}

impl<S: Scalar> PlanarMotion<S> {
    /// At rest at the origin.
    fn ground() -> Self {
        let (zero, one) = (S::zero(), S::one());
        Self {
            position: Vec2::zeros(),
            turn: [Vec2::new(one, zero), Vec2::new(zero, one)],
            velocity: Vec2::zeros(),
            omega: zero,
            acceleration: Vec2::zeros(),
            alpha: zero,
            virtual_velocity: Vec2::zeros(),
            virtual_omega: zero,
        }
    }

    /// ρ and ρ' of a vector in the body.
    pub(super) fn turned(&self, s: &Vec2<S>) -> (Vec2<S>, Vec2<S>) {
        let [c1, c2] = &self.turn;
        (c1 * s.x + c2 * s.y, c2 * s.x - c1 * s.y)
    }

    /// A direction of the body as a marker.
    pub(super) fn direction(&self, s: &Vec2<S>) -> PlanarMarker<S> {
        let (x, across) = self.turned(s);
        PlanarMarker {
            x,
            rate: across * self.omega,
            acceleration: across * self.alpha - x * (self.omega * self.omega),
            virtual_rate: across * self.virtual_omega,
        }
    }

    /// A point of the body as a marker.
    fn point(&self, s: &Vec2<S>) -> PlanarMarker<S> {
        let mut jet = self.direction(s);
        jet.x += self.position;
        jet.rate += self.velocity;
        jet.acceleration += self.acceleration;
        jet.virtual_rate += self.virtual_velocity;
        jet
    }
}

impl<S: Scalar> PlanarJoints<S> {
    /// The joints of `model`, if all its bodies move in one plane and no joint is driven.
    pub fn of(model: &Model<S>) -> Option<Self> {
        let mut plane = None;
        let mut planes = Vec::with_capacity(model.bodies.len() + 1);
        for body in &model.bodies {
            // No joint holds it.
            if matches!(body.role, Role::Counter | Role::State) {
                planes.push(BodyPlane {
                    along: [Vec3::x(), Vec3::y()],
                    normal: Vec3::z(),
                });
                continue;
            }
            let [[t1, t2, _], [normal, first, second]] = body.mobility.plane()?;
            if *plane.get_or_insert([t1, t2]) != [t1, t2] {
                return None;
            }
            planes.push(BodyPlane {
                along: [first, second],
                normal,
            });
        }
        let along = plane?;
        planes.push(BodyPlane {
            along,
            normal: along[0].cross(&along[1]),
        });
        let joint = |joint: &Joint<S>| {
            let body_b = joint.body_b.unwrap_or(model.bodies.len());
            let rows: Vec<ConstraintRow> = joint.rows().collect();
            PlanarJoint {
                body_a: joint.body_a,
                body_b,
                a: planes[joint.body_a].frame(&joint.frame_a),
                b: planes[body_b].frame(&joint.frame_b),
                length: joint.frame_a.length,
                used: MarkersUsed::by(rows.iter().copied()),
                rows,
            }
        };
        let joints = model.joints.iter().map(joint).collect();
        let driven = model.joints.iter().any(|joint| !joint.drives.is_empty());
        (!driven).then(|| Self {
            along,
            ground: std::array::from_fn(|k| Vec2::new(S::from(along[0][k]), S::from(along[1][k]))),
            joints,
            motions: vec![PlanarMotion::ground(); planes.len()],
            planes,
        })
    }

    /// Sets positions and velocities of the bodies. Accelerations and virtual velocities become
    /// zero.
    pub fn set_state(&mut self, motions: &[BodyMotion<S>]) {
        let [t1, t2] = &self.along;
        let plane = |x: &Vec3<S>| Vec2::new(along(x, t1), along(x, t2));
        for ((at, motion), body) in self.motions.iter_mut().zip(motions).zip(&self.planes) {
            *at = PlanarMotion {
                position: plane(&motion.position),
                turn: body
                    .along
                    .map(|b| plane(&(motion.rotation * b.map(S::from)))),
                velocity: plane(&motion.velocity),
                omega: along(&motion.omega, &body.normal),
                ..PlanarMotion::ground()
            };
        }
    }

    /// Sets the velocities; the positions stay.
    pub fn set_velocities(&mut self, numbering: &Numbering, v: &[S]) {
        for body in 0..numbering.bodies() {
            (self.motions[body].velocity, self.motions[body].omega) =
                self.planar(body, &v[numbering.velocity(body)..]);
        }
    }

    /// Sets accelerations and virtual velocities; `None` for zero.
    pub fn set_moving(&mut self, numbering: &Numbering, a: Option<&[S]>, w: Option<&[S]>) {
        let rest = (Vec2::zeros(), S::zero());
        for body in 0..numbering.bodies() {
            let o = numbering.velocity(body);
            let accelerations = a.map_or(rest, |a| self.planar(body, &a[o..]));
            let virtually = w.map_or(rest, |w| self.planar(body, &w[o..]));
            let at = &mut self.motions[body];
            (at.acceleration, at.alpha) = accelerations;
            (at.virtual_velocity, at.virtual_omega) = virtually;
        }
    }

    /// The components in the plane of six velocity coordinates.
    fn planar(&self, body: usize, six: &[S]) -> (Vec2<S>, S) {
        let (linear, angular) = super::bodies::velocities_of(six);
        let [t1, t2] = &self.along;
        let linear = Vec2::new(along(&linear, t1), along(&linear, t2));
        (linear, along(&angular, &self.planes[body].normal))
    }

    /// Gradients of all rows, as in [`super::joints::gradients`], without torques across the
    /// normal.
    pub fn gradients(&self, out: &mut Vec<RowGradient<S>>) {
        out.clear();
        for joint in &self.joints {
            let (ma, mb) = (&self.motions[joint.body_a], &self.motions[joint.body_b]);
            let (ra, across_a) = ma.turned(&joint.a.point);
            let (rb, across_b) = mb.turned(&joint.b.point);
            let d = ma.position + ra - mb.position - rb;
            let torques = |a: S, b: S| {
                let normal = |body: usize| self.planes[body].normal.map(S::from);
                (normal(joint.body_a) * a, normal(joint.body_b) * b)
            };
            let perpendicular = |a: usize, b: usize| {
                let (u, across_u) = ma.turned(&joint.a.axes[a]);
                let (w, across_w) = mb.turned(&joint.b.axes[b]);
                (across_u.dot(&w), u.dot(&across_w))
            };
            for &row in &joint.rows {
                let (force, (torque_a, torque_b)) = match row {
                    ConstraintRow::Coincident(k) => {
                        let e = self.ground[k];
                        let mut force = Vec3::zeros();
                        force[k] = S::one();
                        (force, torques(e.dot(&across_a), -e.dot(&across_b)))
                    }
                    ConstraintRow::Perpendicular { a, b } => {
                        let (on_a, on_b) = perpendicular(a, b);
                        (Vec3::zeros(), torques(on_a, on_b))
                    }
                    ConstraintRow::Aligned { a, b } => {
                        let [one, other] = [(a, b), (b, a)].map(|(a, b)| perpendicular(a, b));
                        let half = |x: S, y: S| (x - y) * 0.5;
                        (
                            Vec3::zeros(),
                            torques(half(one.0, other.0), half(one.1, other.1)),
                        )
                    }
                    ConstraintRow::Sliding { a } => {
                        let (u, across_u) = ma.turned(&joint.a.axes[a]);
                        let by_a = across_u.dot(&d) + u.dot(&across_a);
                        (spatial(&self.along, &u), torques(by_a, -u.dot(&across_b)))
                    }
                    ConstraintRow::Distance => {
                        let u = d / joint.length;
                        let by = torques(u.dot(&across_a), -u.dot(&across_b));
                        (spatial(&self.along, &u), by)
                    }
                };
                out.push(RowGradient {
                    force,
                    torque_a,
                    torque_b,
                    ..RowGradient::zero()
                });
            }
        }
    }

    /// Second derivatives Φ̈ at the accelerations set last. If these are zero, they are the biases.
    pub fn accelerations(&self, numbering: &Numbering, out: &mut [S]) {
        for (j, joint) in self.joints.iter().enumerate() {
            let out = &mut out[numbering.rows(j)];
            self.with_rows(joint, |rows| rows.accelerations(out));
        }
    }

    /// Calls `on_rows` with the rows of a joint and their markers.
    pub(super) fn with_rows<T>(
        &self,
        joint: &PlanarJoint<S>,
        on_rows: impl FnOnce(&Rows<S, Copied<Iter<ConstraintRow>>, 2>) -> T,
    ) -> T {
        let (a, b) = (&self.motions[joint.body_a], &self.motions[joint.body_b]);
        let markers = Markers::of(
            &joint.used,
            || a.point(&joint.a.point).minus(&b.point(&joint.b.point)),
            |i| a.direction(&joint.a.axes[i]),
            |i| b.direction(&joint.b.axes[i]),
        );
        on_rows(&Rows {
            rows: joint.rows.iter().copied(),
            markers: &markers,
            length: joint.length,
            ground: &self.ground,
        })
    }
}
