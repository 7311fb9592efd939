//! Flexible bodies that are generic on purpose: bodies of points with masses, whose shapes are any
//! displacements of these, so that all integrals are sums.

use super::models::{Numbers, axes_along, joint};
use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_mechanics::model::flexible::{
    Form, Modal, ModalInertia, ModalStiffness, Quadratic, Strain,
};
use flexbody_mechanics::model::{Axes, JointKind, Load, LoadKind, Model, TimeFunction};
use flexbody_mechanics::system::bodies::BodyMotion;
use flexbody_mechanics::system::flexible;

/// Points with masses, and their displacements by each mode.
pub struct Points {
    pub masses: Vec<f64>,
    pub places: Vec<Vec3<f64>>,
    pub shapes: Vec<Vec<Vec3<f64>>>,
}

impl Points {
    /// Any `count` points with `modes` shapes.
    pub fn any(numbers: &mut Numbers, count: usize, modes: usize) -> Self {
        Self {
            masses: (0..count).map(|_| 0.3 + 0.2 * numbers.next()).collect(),
            places: (0..count).map(|_| numbers.vector()).collect(),
            shapes: (0..modes)
                .map(|_| (0..count).map(|_| numbers.vector() * 0.6).collect())
                .collect(),
        }
    }

    /// Σ m x yᵀ.
    fn product(&self, x: &[Vec3<f64>], y: &[Vec3<f64>]) -> Mat3<f64> {
        let terms = self.masses.iter().zip(x.iter().zip(y));
        terms.fold(Mat3::zeros(), |sum, (m, (x, y))| {
            sum + x * y.transpose() * *m
        })
    }

    fn first(&self, x: &[Vec3<f64>]) -> Vec3<f64> {
        let terms = self.masses.iter().zip(x);
        terms.fold(Vec3::zeros(), |sum, (m, x)| sum + x * *m)
    }

    /// Mass and inertia about the origin.
    pub fn rigid(&self) -> (f64, Mat3<f64>) {
        let s = self.product(&self.places, &self.places);
        (self.masses.iter().sum(), Mat3::identity() * s.trace() - s)
    }

    /// The integrals of the shapes.
    pub fn inertia(&self) -> ModalInertia<f64> {
        let mut products = Vec::new();
        for (i, shape) in self.shapes.iter().enumerate() {
            for other in &self.shapes[i..] {
                products.push(self.product(shape, other));
            }
        }
        let with = |shape: &Vec<Vec3<f64>>| self.product(&self.places, shape);
        ModalInertia {
            centre: self.first(&self.places),
            static_moments: self.shapes.iter().map(|shape| self.first(shape)).collect(),
            with_position: self.shapes.iter().map(with).collect(),
            products,
        }
    }
}

/// A body of shapes.
pub fn modal(
    inertia: ModalInertia<f64>,
    stiffness: ModalStiffness<f64>,
    damping: Vec<f64>,
) -> Form<f64> {
    Form::Modal(Modal {
        inertia,
        stiffness,
        damping,
        viscosity: None,
        shells: None,
        sections: [].into(),
    })
}

/// The shapes of a body that has some.
pub fn modal_of(form: &mut Form<f64>) -> &mut Modal<f64> {
    match form {
        Form::Modal(modal) => modal,
        Form::Finite(_) => panic!("the body has shapes"),
    }
}

/// Any symmetric positive definite matrix.
fn definite(numbers: &mut Numbers, order: usize, size: f64) -> Vec<f64> {
    let a: Vec<f64> = numbers.list(order * order);
    let mut out = vec![0.0; order * order];
    for i in 0..order {
        for j in 0..order {
            let dot: f64 = (0..order)
                .map(|k| a[i * order + k] * a[j * order + k])
                .sum();
            out[i * order + j] = size * (dot + if i == j { 0.5 } else { 0.0 });
        }
    }
    out
}

fn form(numbers: &mut Numbers, modes: usize) -> Quadratic<f64> {
    Quadratic {
        linear: numbers.list(modes),
        squares: (0..2)
            .map(|_| (1.0 + 0.3 * numbers.next(), numbers.list(modes)))
            .collect(),
    }
}

/// Any stiffness with quadratic strains.
pub fn stiffness(numbers: &mut Numbers, modes: usize, size: f64) -> ModalStiffness<f64> {
    let strain = |numbers: &mut Numbers| Strain {
        axial: true,
        weight: size * (1.0 + 0.5 * numbers.next()),
        strain: form(numbers, modes),
    };
    ModalStiffness {
        linear: definite(numbers, modes, size),
        strains: (0..3).map(|_| strain(numbers)).collect(),
    }
}

/// Any form in the coordinates.
pub fn quadratic(numbers: &mut Numbers, modes: usize) -> Quadratic<f64> {
    form(numbers, modes)
}

/// A flexible body of five coordinates on a spherical joint in its origin; a rigid body on a revolute
/// joint at its tip; a spring and a force at two of its points.
pub fn swing(seed: u64) -> Model<f64> {
    swing_of(seed, 5, 300.0)
}

/// The same with this many coordinates, of this stiffness (N/m).
pub fn swing_of(seed: u64, modes: usize, size: f64) -> Model<f64> {
    swing_from(seed, modes, size, 1.0)
}

/// The same with the start of the coordinates and of their rates multiplied by `start`.
pub fn swing_from(seed: u64, modes: usize, size: f64, start: f64) -> Model<f64> {
    let deformed = start;
    let mut numbers = Numbers(seed);
    let points = Points::any(&mut numbers, 12, modes);
    let mut frame = numbers.body("arm");
    (frame.mass, frame.inertia) = points.rigid();
    let load = numbers.body("load");
    let origin = frame.position;
    let mut model = Model {
        gravity: Vec3::new(1.0, -9.0, 2.0),
        bodies: vec![frame, load],
        joints: Vec::new(),
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    let axis = numbers.vector();
    let ball = ("ball", JointKind::Spherical);
    model
        .joints
        .push(joint(&model.bodies, ball, (0, None), &origin, &axis));
    let (q, rate) = (numbers.list(modes), numbers.list(modes));
    let start = |x: &[f64], scale: f64| -> Vec<f64> { x.iter().map(|x| x * scale).collect() };
    let stiff = stiffness(&mut numbers, modes, size);
    let damping = definite(&mut numbers, modes, 0.5);
    model.add_flexible(
        0,
        (&start(&q, 0.05 * deformed), &start(&rate, 0.2 * deformed)),
        modal(points.inertia(), stiff, damping),
    );
    let mut attach = |name: &str, model: &mut Model<f64>| {
        let list = |numbers: &mut Numbers| (0..modes).map(|_| numbers.vector() * 0.5).collect();
        let point = numbers.vector();
        let shapes = (list(&mut numbers), list(&mut numbers));
        model.attach(0, name, point, shapes, None)
    };
    let tip = attach("tip", &mut model);
    let side = attach("side", &mut model);
    let place = model.bodies[tip].position;
    let axis = axes_along(&Vec3::new(0.3, 0.8, -0.4))[2];
    let hinge = ("hinge", JointKind::Revolute);
    model
        .joints
        .push(joint(&model.bodies, hinge, (1, Some(tip)), &place, &axis));
    add_loads(&mut model, side, tip);
    model
}

/// Loads of a swing: a spring from ground to the interface `side`, and a force on the interface `tip`.
pub fn add_loads(model: &mut Model<f64>, side: usize, tip: usize) {
    let r = rotation::matrix(&model.bodies[side].orientation);
    let anchor = model.bodies[side].position + r * Vec3::new(0.4, 1.1, -0.3);
    model.loads.push(Load {
        name: "spring".into(),
        kind: LoadKind::Spring {
            body_a: side,
            body_b: None,
            point_a: Vec3::new(0.05, -0.02, 0.03),
            point_b: anchor,
            rest_length: 0.8,
            stiffness: 20.0,
            cubic: 3.0,
            damping: 0.4,
            tables: [None, None],
        },
    });
    model.loads.push(Load {
        name: "push".into(),
        kind: LoadKind::Force {
            body: tip,
            point: Vec3::new(0.1, 0.0, 0.05),
            direction: Vec3::new(0.5, -1.0, 0.8),
            axes: Axes::Body,
            magnitude: TimeFunction::constant(3.0),
        },
    });
}

/// Kinetic energy, strain energy, momentum and angular momentum about the origin of a model whose only
/// flexible body has frame 0 and which has no other mass.
pub fn totals(model: &Model<f64>, motions: &[BodyMotion<f64>]) -> (f64, f64, Vec3<f64>, Vec3<f64>) {
    let held = flexible::held(model, motions);
    let (body, motion) = (&model.bodies[0], &motions[0]);
    let spin = body.inertia * motion.omega;
    let kinetic =
        held.kinetic + 0.5 * (body.mass * motion.velocity.norm_squared() + spin.dot(&motion.omega));
    let angular = held.angular_momentum
        + motion.position.cross(&motion.velocity) * body.mass
        + motion.rotation * spin;
    let momentum = held.momentum + motion.velocity * body.mass;
    (kinetic, held.potential, momentum, angular)
}

/// A swing of which everything lies and moves in the plane across z, with a rigid body on a hinge at its
/// tip and a spring.
pub fn planar_swing(seed: u64, modes: usize) -> Model<f64> {
    let mut numbers = Numbers(seed);
    let flat = |v: Vec3<f64>| Vec3::new(v.x, v.y, 0.0);
    let along = |v: Vec3<f64>| Vec3::new(0.0, 0.0, v.z);
    let mut points = Points::any(&mut numbers, 12, modes);
    points.places.iter_mut().for_each(|x| *x = flat(*x));
    points
        .shapes
        .iter_mut()
        .flatten()
        .for_each(|x| *x = flat(*x));
    let mut body = |name: &str| {
        let mut body = numbers.body(name);
        body.inertia = Mat3::from_diagonal(&Vec3::new(0.3, 0.4, 0.6));
        body.orientation = rotation::from_axis_angle(&Vec3::z(), 2.0 * numbers.next());
        body.position = flat(body.position);
        body.velocity = flat(body.velocity);
        body.angular_velocity = along(body.angular_velocity);
        body
    };
    let (mut frame, load) = (body("arm"), body("load"));
    (frame.mass, frame.inertia) = points.rigid();
    let origin = frame.position;
    let mut model = Model {
        gravity: Vec3::new(1.0, -9.0, 0.0),
        bodies: vec![frame, load],
        joints: Vec::new(),
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    let ball = ("ball", JointKind::Spherical);
    let ball = joint(&model.bodies, ball, (0, None), &origin, &Vec3::x());
    model.joints.push(ball);
    let small = |x: Vec<f64>, by: f64| -> Vec<f64> { x.iter().map(|x| x * by).collect() };
    let start = (
        small(numbers.list(modes), 0.05),
        small(numbers.list(modes), 0.2),
    );
    let stiff = stiffness(&mut numbers, modes, 100.0);
    let damping = definite(&mut numbers, modes, 0.5);
    model.add_flexible(
        0,
        (&start.0, &start.1),
        modal(points.inertia(), stiff, damping),
    );
    let displacement = (0..modes).map(|_| flat(numbers.vector()) * 0.5).collect();
    let turning = (0..modes).map(|_| along(numbers.vector()) * 0.5).collect();
    let point = flat(numbers.vector());
    let tip = model.attach(0, "tip", point, (displacement, turning), None);
    let place = model.bodies[tip].position;
    let hinge = ("hinge", JointKind::Revolute);
    let hinge = joint(&model.bodies, hinge, (1, Some(tip)), &place, &Vec3::z());
    model.joints.push(hinge);
    model.loads.push(Load {
        name: "spring".into(),
        kind: LoadKind::Spring {
            body_a: tip,
            body_b: None,
            point_a: Vec3::new(0.05, -0.02, 0.0),
            point_b: place + Vec3::new(0.4, 1.1, 0.0),
            rest_length: 0.8,
            stiffness: 20.0,
            cubic: 3.0,
            damping: 0.4,
            tables: [None, None],
        },
    });
    model
}
