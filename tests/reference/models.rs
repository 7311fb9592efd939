//! General models: full inertias, skew axes, no symmetry that hides a term.

use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_mechanics::model::{Joint, JointFrame, JointKind, Mobility, Model, RigidBody, Role};

/// All kinds of joint.
pub const KINDS: [JointKind; 8] = [
    JointKind::Spherical,
    JointKind::Revolute,
    JointKind::Prismatic,
    JointKind::Planar,
    JointKind::Cylindrical,
    JointKind::Universal,
    JointKind::Rod,
    JointKind::Weld,
];

/// Pseudo-random numbers, the same in every run (SplitMix64, Steele, Lea & Flood 2014).
pub struct Numbers(pub u64);

impl Numbers {
    /// The next number, in [−1, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// The next three numbers.
    pub fn vector(&mut self) -> Vec3<f64> {
        Vec3::new(self.next(), self.next(), self.next())
    }

    /// The next `n` numbers.
    pub fn list(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }

    /// Euler parameters of any rotation.
    pub fn orientation(&mut self) -> [f64; 4] {
        rotation::from_axis_angle(&self.vector(), 3.0 * self.next())
    }

    /// Any body of about 2 kg and 1 m.
    pub fn body(&mut self, name: &str) -> RigidBody<f64> {
        let squares = self.vector().map(|x| 0.2 + 0.1 * x);
        let turn = rotation::matrix(&self.orientation());
        let moments = Mat3::from_diagonal(&(Vec3::repeat(squares.sum()) - squares));
        RigidBody {
            name: name.into(),
            mass: 2.0 + self.next(),
            inertia: turn * moments * turn.transpose(),
            position: self.vector(),
            orientation: self.orientation(),
            velocity: self.vector(),
            angular_velocity: self.vector() * 2.0,
            mobility: Mobility::spatial(),
            role: Role::Solid,
        }
    }
}

/// A model of one body that nothing holds or pulls.
pub fn alone(body: RigidBody<f64>) -> Model<f64> {
    Model {
        gravity: Vec3::zeros(),
        bodies: vec![body],
        joints: Vec::new(),
        loads: Vec::new(),
        flexible: Vec::new(),
    }
}

/// Axes e1, e2, e3 of a joint along `axis`.
pub fn axes_along(axis: &Vec3<f64>) -> [Vec3<f64>; 3] {
    let axis = axis.normalize();
    let e1 = axis.cross(&Vec3::new(0.3, -0.5, 0.2)).normalize();
    [e1, axis.cross(&e1), axis]
}

/// A joint at a ground point and along a ground axis, closed in the placement; `None` is ground. A
/// rod is 0.75 m long and ends at the point.
pub fn joint(
    bodies: &[RigidBody<f64>],
    (name, kind): (&str, JointKind),
    (body_a, body_b): (usize, Option<usize>),
    point: &Vec3<f64>,
    axis: &Vec3<f64>,
) -> Joint<f64> {
    let axes = axes_along(axis);
    let on = |body: usize| {
        let r = rotation::matrix(&bodies[body].orientation);
        JointFrame {
            point: r.tr_mul(&(point - bodies[body].position)),
            axes: axes.map(|e| r.tr_mul(&e)),
            length: 0.0,
        }
    };
    let mut frame_a = on(body_a);
    if kind == JointKind::Rod {
        frame_a.point += Vec3::new(0.25, 0.5, -0.5);
        frame_a.length = 0.75;
    }
    Joint {
        drives: Vec::new(),
        redundant: Vec::new(),
        fit: Default::default(),
        trivial_rows: Vec::new(),
        modes: None,
        name: name.into(),
        kind,
        body_a,
        body_b,
        frame_a,
        frame_b: body_b.map_or(
            JointFrame {
                point: *point,
                axes,
                length: 0.0,
            },
            on,
        ),
    }
}

/// A rod along x of 1 m and `mass`, its centre at `x`.
pub fn rod(name: &str, mass: f64, x: f64) -> RigidBody<f64> {
    RigidBody {
        name: name.into(),
        mass,
        inertia: Mat3::from_diagonal(&Vec3::new(0.01, 0.1, 0.1)),
        position: Vec3::new(x, 0.0, 0.0),
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity: Vec3::zeros(),
        angular_velocity: Vec3::zeros(),
        mobility: Mobility::spatial(),
        role: Role::Solid,
    }
}

/// Two free bodies with one joint between them, without gravity. Their velocities violate the
/// joint, so the start must be made consistent first.
pub fn free_pair(kind: JointKind, seed: u64) -> Model<f64> {
    let mut numbers = Numbers(seed);
    let bodies = vec![numbers.body("first"), numbers.body("second")];
    let (point, axis) = (numbers.vector(), numbers.vector());
    let between = (0, Some(1));
    Model {
        gravity: Vec3::zeros(),
        joints: vec![joint(&bodies, ("joint", kind), between, &point, &axis)],
        bodies,
        loads: Vec::new(),
        flexible: Vec::new(),
    }
}
