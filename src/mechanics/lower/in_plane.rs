//! The conditions of [`super::planar`]: whether a model moves in a plane.

use super::characteristic_length::{Reach, largest};
use super::examine::{ConditionChecker, Verdict};
use super::fixed::is_void;
use super::planar::{Plane, Turned, points, used};
use crate::math::scalar::{along, lift3};
use crate::math::{Scalar, Vec3};
use crate::model::controller::Coordinate;
use crate::model::{Axes, DegreeOfFreedom, Form, JointKind, LoadKind, Model, Shape, Surface};

/// The largest angular velocity of the bodies \[rad/s\], by value or by a `change` of the variable.
/// Speeds count by their ratio to the body's length. The round-off of a slow body scales with it.
fn fastest<S: Scalar>(model: &Model<S>, characteristic_length: &Reach, change: f64) -> f64 {
    let size = |v: &Vec3<S>| {
        v.iter().fold(0.0_f64, |m, x| {
            m.max(x.re().abs()).max(x.infinitesimal().abs() * change)
        })
    };
    let bodies = model.bodies.iter().enumerate();
    let bodies = bodies.filter(|(i, _)| !model.is_carrier(*i));
    bodies.fold(0.0, |most, (i, body)| {
        let swing = size(&body.velocity) / characteristic_length.of([Some(i), None]);
        most.max(size(&body.angular_velocity)).max(swing)
    })
}

/// Shapes of flexible bodies that leave the plane: their integrals across it, and displacements and
/// rotations of attachments.
fn shapes<S: Scalar>(model: &Model<S>, turned: &Turned<S>, examiner: &mut ConditionChecker) {
    for body in &model.flexible {
        let (name, n) = (&body.name, turned.normals[body.frame]);
        let what = || {
            let what = format!("the deformation of body \"{name}\" leaves the plane");
            (what, "kg m²")
        };
        let inertia = match &body.form {
            Form::Modal(modal) => &modal.inertia,
            Form::Finite(_) => {
                // Shells bend in all directions.
                examiner.zero(S::one(), 1.0, what);
                continue;
            }
        };
        let moments = || std::iter::once(&inertia.centre).chain(&inertia.static_moments);
        let scale = moments().map(largest).fold(0.0, f64::max);
        for p in moments() {
            examiner.zero(n.dot(p), scale, what);
        }
        let products = || inertia.with_position.iter().chain(&inertia.products);
        let entries = products().flat_map(|s| s.iter().map(|x| x.re().abs()));
        let scale = entries.fold(0.0, f64::max);
        for s in products() {
            examiner.vanishes((s * n).as_slice(), scale, what);
            examiner.vanishes(s.tr_mul(&n).as_slice(), scale, what);
        }
    }
    for joint in &model.joints {
        let modes = joint.modes.as_ref().filter(|_| !joint.is_coupled());
        let Some(modes) = modes else { continue };
        let (name, n) = (&joint.name, turned.normals[joint.body_a]);
        let what = || {
            (
                format!("the deformation at \"{name}\" leaves the plane"),
                "m",
            )
        };
        let of = |all: &[Vec3<S>]| all.iter().map(largest).fold(0.0, f64::max);
        let scale = of(&modes.displacement);
        for shape in &modes.displacement {
            examiner.zero(n.dot(shape), scale, what);
        }
        let scale = of(&modes.rotation);
        for shape in &modes.rotation {
            examiner.vanishes((shape - n * n.dot(shape)).as_slice(), scale, what);
        }
    }
}

impl Plane {
    /// Examines whether `model` moves in this plane. A derivative is examined for a `change` of the
    /// variable.
    ///
    /// # Errors
    /// The violated conditions.
    pub fn holds<S: Scalar>(&self, model: &Model<S>, change: f64) -> Verdict {
        let turned = Turned::new(model, &self.normal);
        let mut examiner = ConditionChecker::new(change);
        let characteristic_length = Reach::new(model);
        self.joints(model, &turned, &characteristic_length, &mut examiner);
        let rate = fastest(model, &characteristic_length, change);
        self.bodies(
            model,
            &turned,
            (&characteristic_length, rate),
            &mut examiner,
        );
        self.loads(model, &turned, &characteristic_length, &mut examiner);
        shapes(model, &turned, &mut examiner);
        self.upright(model, &characteristic_length, &mut examiner);
        examiner.verdict()
    }

    fn bodies<S: Scalar>(
        &self,
        model: &Model<S>,
        turned: &Turned<S>,
        (characteristic_length, rate): (&Reach, f64),
        examiner: &mut ConditionChecker,
    ) {
        let gravity = largest(&model.gravity);
        examiner.zero(along(&model.gravity, &self.normal), gravity, || {
            ("gravity leaves the plane".into(), "m/s²")
        });
        let bodies = model.bodies.iter().enumerate();
        for (i, body) in bodies.filter(|(i, _)| !model.is_carrier(*i)) {
            let (normal, height) = &self.bodies[i];
            let own: Vec3<S> = lift3(normal);
            let name = &body.name;
            let what = || (format!("body \"{name}\" is turned out of the plane"), "rad");
            examiner.vanishes((turned.normals[i] - own).as_slice(), 1.0, what);
            let above = along(&body.position, &self.normal) - *height;
            let what = || (format!("body \"{name}\" is moved across the plane"), "m");
            examiner.zero(above, characteristic_length.of([Some(i), None]), what);
            let scale = body
                .inertia
                .iter()
                .fold(0.0_f64, |m, x| m.max(x.re().abs()));
            for (about, inertia) in [
                (body.inertia * own, body.inertia),
                (body.inertia.tr_mul(&own), body.inertia.transpose()),
            ] {
                let off = about - own * own.dot(&(inertia * own));
                let what = || {
                    let what = "the normal is off the principal axes of inertia of body";
                    (format!("{what} \"{name}\""), "kg m²")
                };
                examiner.vanishes(off.as_slice(), scale, what);
            }
            let what = || {
                (
                    format!("the velocity of body \"{name}\" leaves the plane"),
                    "m/s",
                )
            };
            let speed =
                largest(&body.velocity).max(rate * characteristic_length.of([Some(i), None]));
            examiner.zero(along(&body.velocity, &self.normal), speed, what);
            let omega = &body.angular_velocity;
            let what = || {
                let what = "is off the normal";
                (
                    format!("the angular velocity of body \"{name}\" {what}"),
                    "rad/s",
                )
            };
            let spin = largest(omega).max(rate);
            examiner.vanishes((omega - own * own.dot(omega)).as_slice(), spin, what);
        }
    }

    fn joints<S: Scalar>(
        &self,
        model: &Model<S>,
        turned: &Turned<S>,
        characteristic_length: &Reach,
        examiner: &mut ConditionChecker,
    ) {
        for (j, joint) in model.joints.iter().enumerate() {
            if is_void(joint) {
                continue;
            }
            let own = &self.joints[j];
            let name = &joint.name;
            let frames = self.frames(joint, j);
            let bodies = [Some(joint.body_a), joint.body_b];
            let length = characteristic_length.of(bodies);
            for (side, used) in used(joint).into_iter().enumerate() {
                let normal = turned.normal(bodies[side]);
                for axis in (0..3).filter(|&axis| used[axis]) {
                    let e = &frames[side].axes[axis];
                    let part = normal.dot(e);
                    if part.re().abs() > 0.5 {
                        let what = || {
                            (
                                format!("the axis of joint \"{name}\" is off the normal"),
                                "rad",
                            )
                        };
                        examiner.vanishes((e - normal * part).as_slice(), 1.0, what);
                    } else {
                        let what = || {
                            (
                                format!("the axis of joint \"{name}\" leaves the plane"),
                                "rad",
                            )
                        };
                        examiner.zero(part, 1.0, what);
                    }
                }
            }
            let coupled = match joint.kind {
                JointKind::Coupled(dof) => Some(dof),
                _ => None,
            };
            for dof in joint.drives.iter().map(|drive| drive.dof).chain(coupled) {
                let normal = turned.normal(Some(joint.body_a));
                let e = &frames[0].axes[2];
                let part = normal.dot(e);
                let what = || (format!("joint \"{name}\" is moved out of the plane"), "");
                match dof {
                    DegreeOfFreedom::Rotation => {
                        examiner.vanishes((e - normal * part).as_slice(), 1.0, what);
                    }
                    DegreeOfFreedom::Translation => examiner.zero(part, 1.0, what),
                }
            }
            if self.trivial_rows(joint, turned, j) != own.trivial_rows {
                examiner.tell(format!("joint \"{name}\" is turned"));
            }
            let mut heights = [S::zero(); 2];
            for (side, frame) in frames.iter().enumerate() {
                let above = turned.normal(bodies[side]).dot(&frame.point);
                let what = || {
                    (
                        format!("a point of joint \"{name}\" is moved across the plane"),
                        "m",
                    )
                };
                examiner.zero(above - own.heights[side], length, what);
                let centre = bodies[side].map_or(0.0, |body| self.bodies[body].1);
                heights[side] = above + centre;
            }
            let what = || {
                let what = "are not equally high above the plane";
                (format!("the points of joint \"{name}\" {what}"), "m")
            };
            examiner.zero(heights[0] - heights[1], length, what);
        }
    }

    fn loads<S: Scalar>(
        &self,
        model: &Model<S>,
        turned: &Turned<S>,
        characteristic_length: &Reach,
        examiner: &mut ConditionChecker,
    ) {
        for (load, heights) in model.loads.iter().zip(&self.loads) {
            let name = &load.name;
            let (mut ends, mut longest) = ([None; 2], 0.0_f64);
            for (k, at) in points(&load.kind).into_iter().enumerate() {
                let Some((body, point)) = at else { continue };
                let above = turned.normal(body).dot(&point);
                let what = || {
                    (
                        format!("a point of load \"{name}\" is moved across the plane"),
                        "m",
                    )
                };
                let length = characteristic_length.of([body, None]) + largest(&point);
                longest = longest.max(length);
                examiner.zero(above - heights[k], length, what);
                ends[k] = Some(above + body.map_or(0.0, |body| self.bodies[body].1));
            }
            let what = || (format!("load \"{name}\" leaves the plane"), "");
            if let [Some(a), Some(b)] = ends {
                examiner.zero(a - b, longest, what);
            }
            let normal = |body: &usize, axes: &Axes| match axes {
                Axes::Ground => turned.ground,
                Axes::Body => turned.normals[*body],
            };
            // The part in the plane of the axis about which a joint turns.
            let tilt = |joint: usize| {
                let joint = &model.joints[joint];
                let n = turned.normals[joint.body_a];
                let e = &joint.frame_a.axes[2];
                e - n * n.dot(e)
            };
            match &load.kind {
                LoadKind::Force {
                    body,
                    direction,
                    axes,
                    ..
                } => {
                    let part = normal(body, axes).dot(direction);
                    examiner.zero(part, largest(direction), what);
                }
                LoadKind::Torque {
                    body,
                    direction,
                    axes,
                    ..
                } => {
                    let n = normal(body, axes);
                    examiner.vanishes(
                        (direction - n * n.dot(direction)).as_slice(),
                        largest(direction),
                        what,
                    );
                }
                LoadKind::TorsionSpring { joint, .. }
                | LoadKind::Damping {
                    joint,
                    dof: DegreeOfFreedom::Rotation,
                    ..
                }
                | LoadKind::Friction {
                    joint,
                    dof: DegreeOfFreedom::Rotation,
                    ..
                }
                | LoadKind::JointStop {
                    joint,
                    dof: DegreeOfFreedom::Rotation,
                    ..
                } => {
                    examiner.vanishes(tilt(*joint).as_slice(), 1.0, what);
                }
                LoadKind::Contact(own) => {
                    let n = turned.normal(own.body_b);
                    if matches!(own.surface, Surface::Box { .. } | Surface::Field { .. }) {
                        // Whether faces and heights are across the plane is not looked for.
                        examiner.zero(S::one(), 1.0, what);
                    }
                    for direction in own.surface.directions() {
                        examiner.zero(n.dot(direction), largest(direction), what);
                    }
                    let n = turned.normal(Some(own.body_a));
                    match &own.shape {
                        Shape::Sphere => {}
                        Shape::Wheel { axis, .. } => {
                            examiner.vanishes(n.cross(axis).as_slice(), 1.0, what);
                        }
                        Shape::Capsule { half, .. } => {
                            examiner.zero(n.dot(half), largest(half), what)
                        }
                    }
                }
                // Flexible bodies that carry it, and stiffnesses, have no plane but by chance, which is not looked for.
                LoadKind::Distributed(_) | LoadKind::Bushing { .. } | LoadKind::Cable(_) => {
                    examiner.zero(S::one(), 1.0, what)
                }
                LoadKind::Controller(own) => {
                    for own in &own.feedback {
                        match &own.coordinate {
                            Coordinate::Joint {
                                joint,
                                dof: DegreeOfFreedom::Rotation,
                                ..
                            } => {
                                examiner.vanishes(tilt(*joint).as_slice(), 1.0, what);
                            }
                            Coordinate::Joint {
                                dof: DegreeOfFreedom::Translation,
                                ..
                            } => {}
                            // It is not looked for.
                            Coordinate::Distance { .. } => examiner.zero(S::one(), 1.0, what),
                        }
                    }
                }
                LoadKind::Drag {
                    body,
                    plate: Some(own),
                    ..
                } => {
                    let n = turned.normal(Some(*body));
                    examiner.zero(n.dot(&own.normal), 1.0, what);
                }
                LoadKind::Spring { .. }
                | LoadKind::Drag { plate: None, .. }
                | LoadKind::BallDamping { .. }
                | LoadKind::Damping {
                    dof: DegreeOfFreedom::Translation,
                    ..
                }
                | LoadKind::Friction {
                    dof: DegreeOfFreedom::Translation,
                    ..
                }
                | LoadKind::JointStop {
                    dof: DegreeOfFreedom::Translation,
                    ..
                }
                | LoadKind::DistanceStop { .. } => {}
            }
        }
    }

    /// Bodies that no joint holds upright: external forces on their group must act at the height of
    /// their centres of mass.
    fn upright<S: Scalar>(
        &self,
        model: &Model<S>,
        characteristic_length: &Reach,
        examiner: &mut ConditionChecker,
    ) {
        let group = |body: Option<usize>| body.and_then(|body| self.groups[body]);
        let mut level = vec![None; model.bodies.len()];
        for (i, body) in model.bodies.iter().enumerate() {
            let Some(own) = self.groups[i] else { continue };
            let height = self.bodies[i].1;
            let first: f64 = *level[own].get_or_insert(height);
            let name = &body.name;
            let what = || {
                (
                    format!("body \"{name}\" tilts: its centre of mass is off the others'"),
                    "m",
                )
            };
            examiner.zero(
                height - first,
                characteristic_length.of([Some(i), None]),
                what,
            );
        }
        let mut acts =
            |body: Option<usize>, height: f64, what: &dyn Fn() -> (String, &'static str)| {
                if let (Some(own), Some(body)) = (group(body), body) {
                    let off = self.bodies[body].1 + height - level[own].unwrap_or(0.0);
                    examiner.zero(off, characteristic_length.of([Some(body), None]), what);
                }
            };
        for (joint, own) in model.joints.iter().zip(&self.joints) {
            let bodies = [Some(joint.body_a), joint.body_b];
            if group(bodies[0]) == group(bodies[1]) {
                continue;
            }
            let name = &joint.name;
            let what = || {
                (
                    format!("joint \"{name}\" tilts a body: it is off its centre of mass"),
                    "m",
                )
            };
            for (body, height) in bodies.into_iter().zip(own.heights) {
                acts(body, height, &what);
            }
        }
        for (load, heights) in model.loads.iter().zip(&self.loads) {
            let name = &load.name;
            let what = || {
                (
                    format!("load \"{name}\" tilts a body: it is off its centre of mass"),
                    "m",
                )
            };
            for (at, height) in points(&load.kind).into_iter().zip(heights) {
                if let Some((body, _)) = at {
                    acts(body, *height, &what);
                }
            }
        }
    }
}
