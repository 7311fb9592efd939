//! Bodies in motion: kinematics q̇ = T(q) v, and dynamics M v̇ = f(v) with gravity only, with their
//! derivatives. Other forces are in `loads`.
//!
//! Rigid body, reference point at the centre of mass, ω and torques in body axes:
//!
//! ```text
//! ṙ = v                      m v̇ = m g
//! ṗ = ½ L(p)ᵀ ω              J ω̇ + ω × J ω = 0
//! ```

use super::numbering::Numbering;
use crate::math::rotation::{self, Quat};
use crate::math::scalar::skew;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::{Model, RigidBody};

/// Position, velocity and, if needed, acceleration of a body.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion<S> {
    /// Centre of mass r, ground axes \[m\].
    pub position: Vec3<S>,
    /// Euler parameters p.
    pub orientation: Quat<S>,
    /// Rotation matrix R(p), body axes to ground.
    pub rotation: Mat3<S>,
    /// Velocity ṙ, ground axes \[m/s\].
    pub velocity: Vec3<S>,
    /// Angular velocity ω, body axes \[rad/s\].
    pub omega: Vec3<S>,
    /// Acceleration r̈, ground axes \[m/s²\]; zero unless set by [`BodyMotion::accelerated`].
    pub acceleration: Vec3<S>,
    /// Angular acceleration ω̇, body axes \[rad/s²\]; zero unless set by
    /// [`BodyMotion::accelerated`].
    pub alpha: Vec3<S>,
    /// Virtual velocity, ground axes; zero unless set by [`BodyMotion::virtually`].
    pub virtual_velocity: Vec3<S>,
    /// Virtual angular velocity, body axes; zero unless set by [`BodyMotion::virtually`].
    pub virtual_omega: Vec3<S>,
}

impl<S: Scalar> BodyMotion<S> {
    /// The ground: at rest in the origin.
    pub fn ground() -> Self {
        let (zero, one) = (S::zero(), S::one());
        Self {
            position: Vec3::zeros(),
            orientation: [one, zero, zero, zero],
            rotation: Mat3::identity(),
            velocity: Vec3::zeros(),
            omega: Vec3::zeros(),
            acceleration: Vec3::zeros(),
            alpha: Vec3::zeros(),
            virtual_velocity: Vec3::zeros(),
            virtual_omega: Vec3::zeros(),
        }
    }

    /// Motion of `body` in the state (q, v).
    pub fn of(numbering: &Numbering, body: usize, q: &[S], v: &[S]) -> Self {
        let q = &q[numbering.position(body)..];
        let orientation = [q[3], q[4], q[5], q[6]];
        let (velocity, omega) = velocities_of(&v[numbering.velocity(body)..]);
        Self {
            position: Vec3::new(q[0], q[1], q[2]),
            orientation,
            rotation: rotation::matrix(&orientation),
            velocity,
            omega,
            acceleration: Vec3::zeros(),
            alpha: Vec3::zeros(),
            virtual_velocity: Vec3::zeros(),
            virtual_omega: Vec3::zeros(),
        }
    }

    /// The same motion with accelerations from six coordinates.
    pub fn accelerated(mut self, a: &[S]) -> Self {
        (self.acceleration, self.alpha) = velocities_of(a);
        self
    }

    /// The same motion with virtual velocities from six coordinates.
    pub fn virtually(mut self, w: &[S]) -> Self {
        (self.virtual_velocity, self.virtual_omega) = velocities_of(w);
        self
    }

    /// All bodies in the state (q, v).
    pub fn all(numbering: &Numbering, q: &[S], v: &[S], out: &mut Vec<Self>) {
        out.clear();
        out.extend((0..numbering.bodies()).map(|body| Self::of(numbering, body, q, v)));
    }

    /// All bodies in the state (q, v), with normalised Euler parameters.
    pub fn all_normalised(numbering: &Numbering, q: &[S], v: &[S], out: &mut Vec<Self>) {
        out.clear();
        out.extend((0..numbering.bodies()).map(|body| {
            let (position, p) = positions_of(&q[numbering.position(body)..]);
            let (velocity, omega) = velocities_of(&v[numbering.velocity(body)..]);
            let orientation = rotation::unit(&p);
            Self {
                position,
                orientation,
                rotation: rotation::matrix(&orientation),
                velocity,
                omega,
                acceleration: Vec3::zeros(),
                alpha: Vec3::zeros(),
                virtual_velocity: Vec3::zeros(),
                virtual_omega: Vec3::zeros(),
            }
        }));
    }

    /// Position of the point `s` (from the centre of mass, body axes) in ground axes \[m\].
    pub fn point(&self, s: &Vec3<S>) -> Vec3<S> {
        self.position + self.rotation * s
    }

    /// Velocity of the point `s` in ground axes \[m/s\].
    pub fn point_velocity(&self, s: &Vec3<S>) -> Vec3<S> {
        self.velocity + self.rotation * self.omega.cross(s)
    }
}

/// The linear and angular parts of six velocity (or tangent) coordinates.
#[inline]
pub fn velocities_of<S: Scalar>(v: &[S]) -> (Vec3<S>, Vec3<S>) {
    let v = &v[..6];
    (Vec3::new(v[0], v[1], v[2]), Vec3::new(v[3], v[4], v[5]))
}

/// The position and the Euler parameters of seven position coordinates.
#[inline]
pub fn positions_of<S: Scalar>(q: &[S]) -> (Vec3<S>, Quat<S>) {
    let q = &q[..7];
    (Vec3::new(q[0], q[1], q[2]), [q[3], q[4], q[5], q[6]])
}

/// Adds a linear and an angular part to six coordinates.
#[inline]
pub fn add6<S: Scalar>(out: &mut [S], linear: &Vec3<S>, angular: &Vec3<S>) {
    let out = &mut out[..6];
    for i in 0..3 {
        out[i] += linear[i];
        out[3 + i] += angular[i];
    }
}

/// Adds a position and Euler parameters to seven coordinates.
#[inline]
pub fn add7<S: Scalar>(out: &mut [S], position: &Vec3<S>, orientation: &Quat<S>) {
    let out = &mut out[..7];
    for i in 0..3 {
        out[i] += position[i];
    }
    for i in 0..4 {
        out[3 + i] += orientation[i];
    }
}

/// Adds the tangent step δy (length n_v) to the positions `q` (n_q); Euler parameters keep unit
/// length. Adds the same change to `increment` (n_q), which keeps its relative accuracy.
pub fn advance<S: Scalar>(numbering: &Numbering, q: &mut [S], increment: &mut [S], step: &[S]) {
    for body in 0..numbering.bodies() {
        let o = numbering.position(body);
        let (dr, dtheta) = velocities_of(&step[numbering.velocity(body)..]);
        let (_, p) = positions_of(&q[o..]);
        let dp = rotation::retraction(&p, &dtheta);
        add7(&mut q[o..], &dr, &dp);
        add7(&mut increment[o..], &dr, &dp);
    }
}

/// Normalises the Euler parameters in `q` and adds the change to `increment`.
pub fn normalise<S: Scalar>(numbering: &Numbering, q: &mut [S], increment: &mut [S]) {
    for body in 0..numbering.bodies() {
        let o = numbering.position(body);
        let dp = rotation::normalisation(&positions_of(&q[o..]).1);
        add7(&mut q[o..], &Vec3::zeros(), &dp);
        add7(&mut increment[o..], &Vec3::zeros(), &dp);
    }
}

/// Replaces the Euler parameters in `q` by p / |p|.
pub fn bring_to_unit<S: Scalar>(numbering: &Numbering, q: &mut [S]) {
    for body in 0..numbering.bodies() {
        let o = numbering.position(body);
        let p = rotation::unit(&positions_of(&q[o..]).1);
        q[o + 3..o + 7].copy_from_slice(&p);
    }
}

/// Rates of the positions, q̇ = T(q) v.
pub fn rates<S: Scalar>(numbering: &Numbering, q: &[S], v: &[S], out: &mut [S]) {
    for body in 0..numbering.bodies() {
        let (_, p) = positions_of(&q[numbering.position(body)..]);
        let (velocity, omega) = velocities_of(&v[numbering.velocity(body)..]);
        let out = &mut out[numbering.position(body)..][..7];
        out[..3].copy_from_slice(velocity.as_slice());
        out[3..].copy_from_slice(&rotation::rates(&p, &omega));
    }
}

/// Velocity coordinates of position rates, P(q) q̇ = (ṙ, 2 L(p) ṗ), the left inverse of T.
pub fn velocity_of_rates<S: Scalar>(numbering: &Numbering, q: &[S], rates: &[S], out: &mut [S]) {
    for body in 0..numbering.bodies() {
        let (_, p) = positions_of(&q[numbering.position(body)..]);
        let (rdot, pdot) = positions_of(&rates[numbering.position(body)..]);
        let out = &mut out[numbering.velocity(body)..][..6];
        out[..3].copy_from_slice(rdot.as_slice());
        out[3..].copy_from_slice(rotation::angular_velocity(&p, &pdot).as_slice());
    }
}

/// Derivative of 2 L(p) ṗ in the tangent δθ of p at constant ṗ: the matrix −L(ṗ) L(p)ᵀ.
pub fn angular_velocity_by_theta<S: Scalar>(p: &Quat<S>, pdot: &Quat<S>) -> Mat3<S> {
    let mut out = Mat3::zeros();
    for j in 0..3 {
        let mut unit = Vec3::zeros();
        unit[j] = S::one();
        let column = rotation::rate_product(pdot, &rotation::rate_transposed(p, &unit));
        out.set_column(j, &-column);
    }
    out
}

/// L(p) L(p')ᵀ: maps the tangent rotation rate at the positions `other` of a body to its angular
/// velocity at the positions `q`.
pub fn turn_between<S: Scalar>(q: &[S], other: &[S]) -> Mat3<S> {
    let (p, other) = (positions_of(q).1, positions_of(other).1);
    let mut out = Mat3::zeros();
    for j in 0..3 {
        let mut unit = Vec3::zeros();
        unit[j] = S::one();
        let column = rotation::rate_product(&p, &rotation::rate_transposed(&other, &unit));
        out.set_column(j, &column);
    }
    out
}

/// Cotangent of the tangent from a cotangent of q: T(q)ᵀ g, per body (g_r, ½ L(p) g_p).
pub fn tangent_of_cotangent<S: Scalar>(numbering: &Numbering, q: &[S], g: &[S], out: &mut [S]) {
    for body in 0..numbering.bodies() {
        let (_, p) = positions_of(&q[numbering.position(body)..]);
        let (gr, gp) = positions_of(&g[numbering.position(body)..]);
        let out = &mut out[numbering.velocity(body)..][..6];
        out[..3].copy_from_slice(gr.as_slice());
        out[3..].copy_from_slice((rotation::rate_product(&p, &gp) * S::from(0.5)).as_slice());
    }
}

/// Cotangent of q̇ from a cotangent of the velocity coordinates: P(q)ᵀ ψ, per body (ψ_r, 2 L(p)ᵀ
/// ψ_θ).
pub fn rates_cotangent<S: Scalar>(numbering: &Numbering, q: &[S], psi: &[S], out: &mut [S]) {
    for body in 0..numbering.bodies() {
        let (_, p) = positions_of(&q[numbering.position(body)..]);
        let (linear, angular) = velocities_of(&psi[numbering.velocity(body)..]);
        let out = &mut out[numbering.position(body)..][..7];
        out[..3].copy_from_slice(linear.as_slice());
        out[3..].copy_from_slice(&rotation::rate_transposed(&p, &(angular * S::from(2.0))));
    }
}

/// Pulls the cotangent of q̇ = T(q) v back to q and v.
pub fn pull_rates(
    numbering: &Numbering,
    (q, v): (&[f64], &[f64]),
    qdot_bar: &[f64],
    (q_bar, v_bar): (&mut [f64], &mut [f64]),
) {
    for body in 0..numbering.bodies() {
        let (o, u) = (numbering.position(body), numbering.velocity(body));
        let (_, p) = positions_of(&q[o..]);
        let (_, omega) = velocities_of(&v[u..]);
        let (by_r, by_p) = positions_of(&qdot_bar[o..]);
        // ½ L(p)ᵀ ω = A(ω) p with a skew matrix A.
        let turned = rotation::rates(&by_p, &omega).map(|x| -x);
        add7(&mut q_bar[o..], &Vec3::zeros(), &turned);
        let by_omega = rotation::rate_product(&p, &by_p) * 0.5;
        add6(&mut v_bar[u..], &by_r, &by_omega);
    }
}

/// Adds the cotangent of positions from that of the tangent (`y`) at their normalised Euler
/// parameters.
pub fn add_unit_cotangent(numbering: &Numbering, q: &[f64], y: &[f64], out: &mut [f64]) {
    for body in 0..numbering.bodies() {
        let o = numbering.position(body);
        let six = &y[numbering.velocity(body)..][..6];
        if six.iter().all(|&x| x == 0.0) {
            continue;
        }
        let (_, p) = positions_of(&q[o..]);
        let (by_r, by_theta) = velocities_of(six);
        add7(
            &mut out[o..],
            &by_r,
            &rotation::unit_pull_back(&p, &by_theta),
        );
    }
}

/// Inertial minus applied forces M v̇ − f(q, v) of a rigid body: (m (v̇ − g), J ω̇ + ω × J ω).
/// What is no place has no weight g.
pub fn force_balance<S: Scalar>(
    body: &RigidBody<S>,
    gravity: &Vec3<S>,
    omega: &Vec3<S>,
    acceleration: &Vec3<S>,
    alpha: &Vec3<S>,
) -> (Vec3<S>, Vec3<S>) {
    let gyroscopic = omega.cross(&(body.inertia * omega));
    let falling = match body.role.is_abstract() {
        true => *acceleration,
        false => acceleration - gravity,
    };
    (falling * body.mass, body.inertia * alpha + gyroscopic)
}

/// Derivative of the torque balance in ω: ω̃ J − (J ω)~.
pub fn torque_by_omega<S: Scalar>(body: &RigidBody<S>, omega: &Vec3<S>) -> Mat3<S> {
    skew(omega) * body.inertia - skew(&(body.inertia * omega))
}

/// Pulls the cotangent ψ = (ψ_r, ψ_θ) of [`force_balance`] back to ω (returned) and to the
/// parameters (`cot` and `gravity_cot`).
fn pull_force_balance(
    body: &RigidBody<f64>,
    gravity: &Vec3<f64>,
    omega: &Vec3<f64>,
    (acceleration, alpha): (&Vec3<f64>, &Vec3<f64>),
    (psi_r, psi_theta): (&Vec3<f64>, &Vec3<f64>),
    cot: &mut RigidBody<f64>,
    gravity_cot: &mut Vec3<f64>,
) -> Vec3<f64> {
    if body.role.is_abstract() {
        cot.mass += psi_r.dot(acceleration);
    } else {
        cot.mass += psi_r.dot(&(acceleration - gravity));
        *gravity_cot -= psi_r * body.mass;
    }
    let turned = psi_theta.cross(omega);
    cot.inertia += psi_theta * alpha.transpose() + turned * omega.transpose();
    (body.inertia * omega).cross(psi_theta) + body.inertia.tr_mul(&turned)
}

/// The product M x, transposed: per body (m x_r, Jᵀ x_θ).
pub fn mass_product<S: Scalar>(model: &Model<S>, numbering: &Numbering, x: &[S], out: &mut [S]) {
    for (i, body) in model.bodies.iter().enumerate() {
        let o = numbering.velocity(i);
        let (linear, angular) = velocities_of(&x[o..]);
        out[o..o + 3].copy_from_slice((linear * body.mass).as_slice());
        out[o + 3..o + 6].copy_from_slice(body.inertia.tr_mul(&angular).as_slice());
    }
}

/// Pulls ψᵀ times the force balances of all bodies at the accelerations `a` back to the parameters, and to the
/// velocities if wanted.
pub fn pull_force_balances(
    (model, numbering): (&Model<f64>, &Numbering),
    (motions, a): (&[BodyMotion<f64>], &[f64]),
    psi: &[f64],
    mut v: Option<&mut [f64]>,
    cot: &mut Model<f64>,
) {
    for (i, body) in model.bodies.iter().enumerate() {
        let o = numbering.velocity(i);
        let (a, alpha) = velocities_of(&a[o..]);
        let (psi_r, psi_theta) = velocities_of(&psi[o..]);
        let by_omega = pull_force_balance(
            body,
            &model.gravity,
            &motions[i].omega,
            (&a, &alpha),
            (&psi_r, &psi_theta),
            &mut cot.bodies[i],
            &mut cot.gravity,
        );
        if let Some(v) = v.as_deref_mut() {
            for k in 0..3 {
                v[o + 3 + k] += by_omega[k];
            }
        }
    }
}

/// Inertial minus applied forces of all bodies; `out` has length n_v.
pub fn all_force_balances<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    motions: &[BodyMotion<S>],
    accelerations: &[S],
    out: &mut [S],
) {
    for (i, (body, motion)) in model.bodies.iter().zip(motions).enumerate() {
        let o = numbering.velocity(i);
        let (a, alpha) = velocities_of(&accelerations[o..]);
        let (force, torque) = force_balance(body, &model.gravity, &motion.omega, &a, &alpha);
        out[o..o + 3].copy_from_slice(force.as_slice());
        out[o + 3..o + 6].copy_from_slice(torque.as_slice());
    }
}
