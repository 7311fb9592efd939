//! The mechanical model: bodies, joints, loads and gravity with their parameters, without state.
//!
//! Parameters are generic in the scalar: a model has values (`f64`), complex steps or dual numbers.
//! A model of zeros in `f64` also serves as a cotangent: it holds the derivative of a function in
//! each parameter.

pub mod axes;
pub mod cable;
pub mod contact;
mod controlled;
pub mod controller;
pub mod coupling;
pub mod distributed;
pub mod drive;
pub mod element_operators;
pub mod finite;
pub mod flexible;
pub mod force_table;
pub mod height_field;
pub mod joint;
pub mod load;
pub mod mobility;
pub mod normal_law;
pub mod reduced;
pub mod rigid_body;
pub mod s_curve;
pub mod shapes;
pub mod shell_kind;
mod switched;
pub mod table;
pub mod time_function;

pub use axes::Axes;
pub use cable::{Cable, CablePoint};
pub use contact::{Contact, Friction, Shape, Stribeck, Surface};
pub use coupling::CoupledMotion;
pub use distributed::{Air, DistributedLoad, Spread};
pub use drive::{DegreeOfFreedom, Drive};
pub use flexible::{FlexibleBody, Form, Inertia, Modes};
pub use force_table::ForceTable;
pub use height_field::HeightField;
pub use joint::{ConstraintRow, Fit, Joint, JointFrame, JointKind};
pub use load::{Load, LoadKind};
pub use mobility::Mobility;
pub use normal_law::NormalLaw;
pub use rigid_body::{RigidBody, Role};
pub use s_curve::SCurve;
pub use table::{Interpolation, Smoothness};
pub use time_function::TimeFunction;

use crate::math::{Scalar, Vec3, parameters, rotation};

/// Bodies, joints, loads and gravity of a scene.
#[derive(Clone, Debug)]
pub struct Model<S> {
    /// Gravitational acceleration in ground axes \[m/s²\].
    pub gravity: Vec3<S>,
    /// Bodies in the order of the problem file, then those without mass that flexible bodies, couplings, torsion springs and
    /// stops need, then the states of controllers.
    pub bodies: Vec<RigidBody<S>>,
    /// Joints in the order of the problem file, then the attachments of flexible bodies and the coupled motions.
    pub joints: Vec<Joint<S>>,
    /// Loads in the order of the problem file.
    pub loads: Vec<Load<S>>,
    /// Flexible bodies; the frame of each is one of the bodies.
    pub flexible: Vec<FlexibleBody<S>>,
}

parameters!(struct Model {; gravity, bodies, joints, loads, flexible });

impl<S: Scalar> Model<S> {
    /// Whether loads or drives may supply energy.
    pub fn is_fed(&self) -> bool {
        let feeds = |load: &Load<S>| {
            let supplies = match &load.kind {
                LoadKind::Cable(own) => Some(!own.is_fixed()),
                LoadKind::Distributed(own) => Some(own.spread.supplies()),
                _ => None,
            };
            let feeds = matches!(
                load.kind,
                LoadKind::Force { .. } | LoadKind::Torque { .. } | LoadKind::Controller(_)
            );
            supplies.unwrap_or(feeds)
        };
        let driven = self.joints.iter().any(|joint| !joint.drives.is_empty());
        driven || self.loads.iter().any(feeds)
    }

    /// Whether every load keeps energy or takes it, or is judged as what feeds the motion. Bushings with damping may be of any kind.
    pub fn is_passive(&self) -> bool {
        let takes = |load: &Load<S>| match &load.kind {
            LoadKind::Spring {
                damping, tables, ..
            }
            | LoadKind::TorsionSpring {
                damping, tables, ..
            } => damping.re() >= 0.0 && tables[1].is_none(),
            LoadKind::Damping {
                coefficient, table, ..
            } => coefficient.re() >= 0.0 && table.is_none(),
            LoadKind::BallDamping { coefficient, .. } => coefficient.re() >= 0.0,
            LoadKind::Bushing { damping, .. } => damping.iter().all(|x| x.re() == 0.0),
            LoadKind::Friction { .. }
            | LoadKind::Drag { .. }
            | LoadKind::JointStop { .. }
            | LoadKind::DistanceStop { .. }
            | LoadKind::Contact(_)
            | LoadKind::Cable(_)
            | LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Controller(_) => true,
            LoadKind::Distributed(own) => own.spread.supplies(),
        };
        self.loads.iter().all(takes)
    }

    /// Whether energy is conserved: only springs and gravity do work.
    pub fn conserves_energy(&self) -> bool {
        let conserves = |load: &Load<S>| match &load.kind {
            LoadKind::Spring {
                damping, tables, ..
            }
            | LoadKind::TorsionSpring {
                damping, tables, ..
            } => damping.re() == 0.0 && tables[1].is_none(),
            LoadKind::Damping {
                coefficient, table, ..
            } => coefficient.re() == 0.0 && table.is_none(),
            LoadKind::BallDamping { coefficient, .. } => coefficient.re() == 0.0,
            LoadKind::Drag {
                coefficient, plate, ..
            } => coefficient.re() == 0.0 && plate.is_none(),
            LoadKind::Bushing {
                damping, friction, ..
            } => damping.iter().all(|x| x.re() == 0.0) && friction.is_none(),
            LoadKind::Friction { size, .. } => size.re() == 0.0,
            LoadKind::JointStop { law, .. } | LoadKind::DistanceStop { law, .. } => {
                law.dissipation.re() == 0.0
            }
            LoadKind::Contact(own) => {
                let friction = &own.friction;
                let slides = friction.coefficient.re() == 0.0 && friction.stribeck.is_none();
                own.law.dissipation.re() == 0.0 && slides
            }
            LoadKind::Cable(own) => own.law.dissipation.re() == 0.0,
            // They are judged as what feeds the motion.
            LoadKind::Force { .. } | LoadKind::Torque { .. } | LoadKind::Controller(_) => true,
            LoadKind::Distributed(own) => own.spread.supplies(),
        };
        let undamped = |body: &FlexibleBody<S>| match &body.form {
            Form::Modal(modal) => {
                let viscous = modal.strain_damping().is_some_and(|beta| beta.re() != 0.0);
                !viscous && modal.damping.iter().all(|x| x.re() == 0.0)
            }
            Form::Finite(finite) => {
                let mut all = finite.damping.iter().flatten();
                all.all(|x| x.re() == 0.0)
            }
        };
        !self.is_fed() && self.loads.iter().all(conserves) && self.flexible.iter().all(undamped)
    }

    /// How far redundant rows may be open, relative to a length or as an angle \[rad\]: the tolerance of
    /// the input if rows fit only within it, and otherwise zero.
    pub fn slack(&self) -> f64 {
        let rounded = self.joints.iter().filter(|joint| joint.fit.rounded);
        rounded.fold(0.0, |slack, joint| slack.max(joint.fit.tolerance))
    }

    /// Whether its parts hang together in ways that reductions do not look through: flexible bodies, couplings, controllers or
    /// cables.
    pub fn is_entangled(&self) -> bool {
        let cables = |load: &Load<S>| matches!(load.kind, LoadKind::Cable(_));
        let joined = self.is_coupled() || self.is_controlled();
        joined || !self.flexible.is_empty() || self.loads.iter().any(cables)
    }

    /// Whether a body carries elastic coordinates, the coordinate of a coupling or the state of a controller, or counts turns.
    pub fn is_carrier(&self, body: usize) -> bool {
        self.bodies[body].role == Role::Elastic || self.holds_angles(body)
    }

    /// Whether the position of a body is no place: it counts turns, or is the coordinate of a coupling or a controller.
    pub fn holds_angles(&self, body: usize) -> bool {
        self.bodies[body].role.is_abstract()
    }

    /// Gives a load bodies that count the turns of its joints, whose angles start so: one of a torsion spring or a stop; of a
    /// controller one for each joint whose rotation it measures.
    pub fn count_turns(&mut self, load: usize, angles: &[f64]) {
        let Load { name, kind } = &mut self.loads[load];
        let counters: Vec<&mut Option<usize>> = match kind {
            LoadKind::TorsionSpring { counter, .. } | LoadKind::JointStop { counter, .. } => {
                vec![counter]
            }
            LoadKind::Controller(own) => own.rotations().collect(),
            _ => Vec::new(),
        };
        for (counter, angle) in counters.into_iter().zip(angles) {
            *counter = Some(self.bodies.len());
            let mut own = RigidBody::massless(format!("{name}, turns"));
            own.mobility = Mobility::fixed();
            own.role = Role::Counter;
            own.position.x = S::from(*angle);
            self.bodies.push(own);
        }
    }

    /// Whether a body is the frame, a carrier or an interface of a flexible body.
    pub fn is_of_flexible(&self, body: usize) -> bool {
        let frame = self.flexible.iter().any(|flexible| flexible.frame == body);
        frame || self.is_internal(body)
    }

    /// Whether a body is not in the problem file.
    pub fn is_internal(&self, body: usize) -> bool {
        self.bodies[body].role != Role::Solid
    }

    /// Adds a flexible body whose frame is body `frame`, with the start of its coordinates and
    /// their rates; its index among the flexible ones. The carriers follow all present bodies.
    pub fn add_flexible(
        &mut self,
        frame: usize,
        (elastic, elastic_rate): (&[S], &[S]),
        form: Form<S>,
    ) -> usize {
        let name = self.bodies[frame].name.clone();
        let carriers = self.bodies.len();
        let mut at = 0;
        for count in flexible::carriers(elastic.len()) {
            let mut carrier = RigidBody::massless(format!("{name}, coordinates from {}", at + 1));
            carrier.mobility = Mobility::carrier(count);
            carrier.role = Role::Elastic;
            for k in 0..count {
                carrier.position[k] = elastic[at + k];
                carrier.velocity[k] = elastic_rate[at + k];
            }
            at += count;
            self.bodies.push(carrier);
        }
        self.flexible.push(FlexibleBody {
            name,
            frame,
            carriers,
            inertia: Inertia::Full,
            form,
        });
        self.flexible.len() - 1
    }

    /// Adds an interface of flexible body `flexible` at a place X of the undeformed body that all of some nodes
    /// follow, and the joints that hold it to each: the index of the body. Each joint has its frame at the
    /// node, in axes of the body, and the rows that it leaves out.
    pub fn tie(
        &mut self,
        flexible: usize,
        name: &str,
        point: Vec3<S>,
        nodes: Vec<(JointFrame<S>, Modes<S>, Vec<ConstraintRow>)>,
    ) -> usize {
        let still = (Vec::new(), Vec::new());
        let joint = self.interface(flexible, name, point, still, Some(&[]));
        for (frame, modes, trivial_rows) in nodes {
            let mut own = joint.clone();
            own.frame_a = frame;
            own.frame_b = frame;
            own.frame_b.point = frame.point - point;
            own.modes = Some(modes);
            own.trivial_rows = trivial_rows;
            self.joints.push(own);
        }
        self.bodies.len() - 1
    }

    /// Adds the interface of a point X of flexible body `flexible` with the displacements N_I and the
    /// rotations Θ_I there, by the coordinates of `indices` or by all of them, and the joint that holds it:
    /// the index of the body. It starts where the deformed point does, its axes turned by the section.
    pub fn attach(
        &mut self,
        flexible: usize,
        name: &str,
        point: Vec3<S>,
        modes: (Vec<Vec3<S>>, Vec<Vec3<S>>),
        indices: Option<&[usize]>,
    ) -> usize {
        let joint = self.interface(flexible, name, point, modes, indices);
        self.joints.push(joint);
        self.bodies.len() - 1
    }

    /// Adds the body of [`Model::attach`]; gives the joint that holds it.
    fn interface(
        &mut self,
        flexible: usize,
        name: &str,
        point: Vec3<S>,
        (displacement, rotation): (Vec<Vec3<S>>, Vec<Vec3<S>>),
        indices: Option<&[usize]>,
    ) -> Joint<S> {
        let body = &self.flexible[flexible];
        let frame = body.frame;
        let places: Vec<(usize, usize)> = match indices {
            Some(indices) => {
                let all: Vec<(usize, usize)> = body.places().collect();
                indices.iter().map(|&i| all[i]).collect()
            }
            None => body.places().collect(),
        };
        let sum = |modes: &[Vec3<S>], of: fn(&RigidBody<S>) -> &Vec3<S>| {
            let all = modes.iter().zip(&places);
            all.fold(Vec3::zeros(), |sum: Vec3<S>, (mode, &(carrier, k))| {
                sum + mode * of(&self.bodies[carrier])[k]
            })
        };
        let place = point + sum(&displacement, |carrier| &carrier.position);
        let speed = sum(&displacement, |carrier| &carrier.velocity);
        let spin = sum(&rotation, |carrier| &carrier.velocity);
        let host = &self.bodies[frame];
        let turned = rotation::matrix(&host.orientation);
        let mut interface = RigidBody::massless(format!("{}, {name}", host.name));
        interface.role = Role::Interface;
        interface.position = host.position + turned * place;
        interface.orientation = host.orientation;
        interface.velocity = host.velocity + turned * (host.angular_velocity.cross(&place) + speed);
        interface.angular_velocity = host.angular_velocity + spin;
        let axis = |k: usize| {
            let mut axis = Vec3::zeros();
            axis[k] = S::one();
            axis
        };
        let at = |point: Vec3<S>| JointFrame {
            point,
            axes: [axis(0), axis(1), axis(2)],
            length: S::zero(),
        };
        self.bodies.push(interface);
        Joint {
            name: self.bodies[self.bodies.len() - 1].name.clone(),
            kind: JointKind::Attachment,
            body_a: frame,
            body_b: Some(self.bodies.len() - 1),
            frame_a: at(point),
            frame_b: at(Vec3::zeros()),
            drives: Vec::new(),
            redundant: Vec::new(),
            fit: Fit::default(),
            trivial_rows: Vec::new(),
            modes: Some(Modes {
                places,
                displacement,
                rotation,
                profile: None,
            }),
        }
    }
}
