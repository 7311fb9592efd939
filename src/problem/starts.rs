//! Initial positions of joints: moves the placed bodies so that the joints have the angles and
//! displacements of the file.
//!
//! The blocks of joints are processed from ground outwards (see [`crate::system::blocks`]). A joint in no
//! loop moves all bodies behind it as one rigid body,
//!
//! ```text
//! x ↦ P + R(e, φ) (x − P) + σ e,     P its point on the far body, e its axis on the near body.
//! ```
//!
//! Bodies in loops go to the nearest position at which the joints have a fraction of φ and σ. The
//! fraction grows in [`STEPS`] steps, and the root of the block is held. Bodies behind a loop move
//! with it. Joints that are open in the placement are closed last, all together.

use super::hinge::{Hinge, Move, hinge, place};
use super::placement::Assembly;
use super::starting_angles::led;
use crate::math::rotation::{compose, conjugate, from_axis_angle, matrix};
use crate::math::{Parameters, Scalar, Vec3};
use crate::model::{
    DegreeOfFreedom, Drive, Joint, Mobility, Model, Modes, RigidBody, TimeFunction,
};
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::flexible::Start;
use crate::schema::joints::{Ends, Joint as WrittenJoint, JointPlace};
use crate::schema::mechanics::Shape;
use crate::system::blocks::{Block, Blocks};
use crate::system::bodies::positions_of;
use crate::system::failure::AssemblyFailure;
use crate::system::nearest::nearest;
use crate::system::redundancy;

/// Least and largest number of steps in which the joints of loops go to their starts, and the largest turn in one \[rad\].
const STEPS: usize = 16;
const MOST_STEPS: f64 = 4096.0;
const MOST_TURN: f64 = 1.25;
/// Drives that start beyond this angle \[rad\] turn their bodies as a start of the joint does. Nearer ones are closed by
/// the assembly.
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

/// A part has them.
const OWN: &str = "a part has the bodies of its joints";

/// Both degrees of freedom of a joint.
pub(super) const DOFS: [DegreeOfFreedom; 2] =
    [DegreeOfFreedom::Rotation, DegreeOfFreedom::Translation];

/// The start of one motion of a joint in the file.
#[derive(Clone, Debug)]
struct Given<S> {
    joint: usize,
    dof: DegreeOfFreedom,
    /// Angle \[rad\] or displacement \[m\], and its rate.
    values: [Option<S>; 2],
}

/// What is prescribed of a joint: position or rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    Place,
    Rate,
}

/// The starts of the joints of a scene.
#[derive(Clone, Debug)]
pub struct Starts<S> {
    given: Vec<Given<S>>,
    pub(super) blocks: Blocks,
    /// By joint: whether it is closed in every placement.
    closed: Vec<bool>,
    /// By body: whether the file gives it a velocity.
    moving: Vec<bool>,
}

impl<S: Scalar> Starts<S> {
    /// The starts of a checked document with the joints of `model`; `None` if it has none.
    pub fn of(document: &Document, assembly: &Assembly<S>, model: &Model<S>) -> Option<Self> {
        let mut given = Vec::new();
        for (joint, (name, written)) in document.joints.iter().enumerate() {
            for dof in DOFS {
                let values = written.start().and_then(|start| start.of(dof));
                let get = |value: Option<Quantity>| value.map(|value| assembly.quantity(&value));
                let mut values = match values {
                    Some(values) => Some(values.map(get)),
                    None => driven(document, &model.joints[joint], dof),
                };
                if values.as_ref().is_none_or(|values| values[0].is_none())
                    && let Some(place) = led(document, assembly, (name, dof))
                {
                    let rate = values.and_then(|values| values[1]);
                    values = Some([Some(place), rate]);
                }
                given.extend(values.map(|values| Given { joint, dof, values }));
            }
        }
        if given.is_empty() {
            return None;
        }
        let moving = |body: &crate::schema::mechanics::Body| {
            body.velocity.is_some() || document.initial_velocity.is_some()
        };
        let joints = document.joints.values();
        Some(Self {
            given,
            blocks: Blocks::of(model),
            closed: joints.map(|joint| closes(document, joint)).collect(),
            moving: document.bodies.values().map(moving).collect(),
        })
    }

    /// The same starts of a model whose joints are coupled as placed.
    pub fn coupled(&self, model: &Model<S>) -> Self {
        let mut own = self.clone();
        own.blocks = Blocks::of(model);
        own.closed.resize(model.joints.len(), false);
        own.moving.resize(model.bodies.len(), false);
        own
    }

    /// Value that the file or a drive prescribes for a joint.
    pub(super) fn value(
        &self,
        model: &Model<S>,
        joint: usize,
        dof: DegreeOfFreedom,
        asked: Asked,
    ) -> Option<S> {
        let written = self.written(joint, dof, asked);
        written.or_else(|| {
            let mut drives = model.joints[joint].drives.iter();
            let drive = drives.find(|drive| drive.dof == dof)?;
            Some(drive.course.derivatives(S::zero())[asked as usize])
        })
    }

    fn written(&self, joint: usize, dof: DegreeOfFreedom, asked: Asked) -> Option<S> {
        let mut given = self.given.iter();
        let given = given.find(|given| given.joint == joint && given.dof == dof)?;
        given.values[asked as usize]
    }

    /// The starts that the file gives these joints.
    fn given<'a>(
        &'a self,
        joints: &'a [usize],
        asked: Asked,
    ) -> impl Iterator<Item = (usize, DegreeOfFreedom, S)> + 'a {
        let here = move |given: &Given<S>| {
            let joint = joints.iter().position(|&joint| joint == given.joint)?;
            Some((joint, given.dof, given.values[asked as usize]?))
        };
        self.given.iter().filter_map(here)
    }

    /// Groups of connected bodies in which the file gives such a start: bodies and joints. Ground
    /// does not connect bodies.
    pub(super) fn groups(&self, model: &Model<S>, asked: Asked) -> Vec<(Vec<usize>, Vec<usize>)> {
        let group = &self.blocks.group;
        let mut firsts: Vec<usize> = (self.given.iter())
            .filter(|given| given.values[asked as usize].is_some())
            .map(|given| group[model.joints[given.joint].body_a])
            .collect();
        firsts.sort_unstable();
        firsts.dedup();
        let members = |first: usize| {
            let bodies = (0..group.len()).filter(|&body| group[body] == first);
            let joints =
                (0..model.joints.len()).filter(|&joint| group[model.joints[joint].body_a] == first);
            (bodies.collect(), joints.collect())
        };
        firsts.into_iter().map(members).collect()
    }

    /// Whether the joints of a group are closed at every start: they form no loop.
    fn is_closed(&self, joints: &[usize]) -> bool {
        let loops = self
            .blocks
            .list
            .iter()
            .filter(|block| block.joints.len() > 1);
        joints.iter().all(|&joint| self.closed[joint])
            && !loops
                .flat_map(|block| &block.joints)
                .any(|joint| joints.contains(joint))
    }

    /// Whether velocities from rates need no projection.
    pub(super) fn is_consistent(&self, bodies: &[usize], joints: &[usize]) -> bool {
        self.is_closed(joints) && !bodies.iter().any(|&body| self.moving[body])
    }

    /// Moves the bodies of `model` to the starts of their joints.
    ///
    /// # Errors
    /// The joint that cannot start as given.
    pub fn place(&self, model: &mut Model<S>) -> Result<(), AssemblyFailure> {
        let groups = self.groups(model, Asked::Place);
        let mut moves: Vec<Option<Move<S>>> = vec![None; model.bodies.len()];
        for block in &self.blocks.list {
            if !groups
                .iter()
                .any(|(_, joints)| joints.contains(&block.joints[0]))
            {
                continue;
            }
            let own = match (&block.joints[..], &block.bodies[..]) {
                (&[joint], &[body]) => vec![self.turned(model, joint, body)],
                _ => self.closed_loops(model, block)?,
            };
            let root = block.root.and_then(|root| moves[root]);
            for (&body, own) in block.bodies.iter().zip(own) {
                moves[body] = match (root, own) {
                    (Some(root), Some(own)) => Some(root.after(&own)),
                    (root, own) => root.or(own),
                };
            }
        }
        for (body, moved) in model.bodies.iter_mut().zip(moves) {
            if let Some(moved) = moved {
                moved.apply(body);
            }
        }
        for (bodies, joints) in groups {
            if !self.is_closed(&joints) {
                let mut part = self.part(model, (None, &bodies), &joints);
                self.drive(&mut part, &joints, Asked::Place, 1.0);
                let q = nearest(&part)?.q;
                put(model, &bodies, &q);
            }
        }
        Ok(())
    }

    /// Motion of the body `beyond` a joint in no loop; `None` if the joint has no start.
    fn turned(&self, model: &Model<S>, joint: usize, beyond: usize) -> Option<Move<S>> {
        let [angle, shift] = DOFS.map(|dof| self.value(model, joint, dof, Asked::Place));
        if angle.is_none() && shift.is_none() {
            return None;
        }
        let Hinge { axis, point, sign } = hinge(model, joint, beyond);
        let by = |x: Option<S>| x.unwrap_or(S::zero()) * sign;
        let turn = from_axis_angle(&axis, by(angle));
        let rotation = matrix(&turn);
        Some(Move {
            turn,
            shift: point - rotation * point + axis * by(shift),
            rotation,
        })
    }

    /// Motions of the bodies of a loop; `None` if no joint has a start.
    fn closed_loops(
        &self,
        model: &Model<S>,
        block: &Block,
    ) -> Result<Vec<Option<Move<S>>>, AssemblyFailure> {
        if self.given(&block.joints, Asked::Place).next().is_none() {
            return Ok(vec![None; block.bodies.len()]);
        }
        let mut part = self.part(model, (block.root, &block.bodies), &block.joints);
        self.check_free(&part, &block.joints, Asked::Place)?;
        let own: Vec<usize> = (0..block.bodies.len()).collect();
        let driven = part.joints.clone();
        let turns = self.given(&block.joints, Asked::Place);
        let turns = turns.filter(|(_, dof, _)| *dof == DegreeOfFreedom::Rotation);
        let most = turns.fold(0.0_f64, |most, (.., angle)| most.max(angle.re().abs()));
        let steps = (most / MOST_TURN).ceil().clamp(STEPS as f64, MOST_STEPS);
        for step in 1..=steps as usize {
            part.joints.clone_from(&driven);
            self.drive(&mut part, &block.joints, Asked::Place, step as f64 / steps);
            let q = nearest(&part)?.q;
            put(&mut part, &own, &q);
        }
        let bodies = block.bodies.iter().zip(&part.bodies);
        let moved = |(&body, to): (&usize, &RigidBody<S>)| {
            let from = &model.bodies[body];
            let turn = compose(&to.orientation, &conjugate(&from.orientation));
            let rotation = matrix(&turn);
            Some(Move {
                turn,
                shift: to.position - rotation * from.position,
                rotation,
            })
        };
        Ok(bodies.map(moved).collect())
    }

    /// A part of the model: the `bodies`, then the fixed body `root`, and the `joints`.
    pub(super) fn part(
        &self,
        model: &Model<S>,
        (root, bodies): (Option<usize>, &[usize]),
        joints: &[usize],
    ) -> Model<S> {
        let all: Vec<usize> = bodies.iter().copied().chain(root).collect();
        let number = |body: usize| all.iter().position(|&other| other == body);
        let joint = |&joint: &usize| {
            let joint = &model.joints[joint];
            Joint {
                body_a: number(joint.body_a).expect(OWN),
                body_b: joint.body_b.and_then(number),
                modes: joint.modes.as_ref().map(|modes| {
                    let place = |&(body, k): &(usize, usize)| (number(body).expect(OWN), k);
                    Modes {
                        places: modes.places.iter().map(place).collect(),
                        ..modes.clone()
                    }
                }),
                ..joint.clone()
            }
        };
        let mut part = Model {
            gravity: Vec3::zeros(),
            bodies: all.iter().map(|&body| model.bodies[body].clone()).collect(),
            joints: joints.iter().map(joint).collect(),
            loads: Vec::new(),
            flexible: Vec::new(),
        };
        let (moving, held) = part.bodies.split_at_mut(bodies.len());
        for held in held {
            held.mobility = Mobility::fixed();
            (held.velocity, held.angular_velocity) = (Vec3::zeros(), Vec3::zeros());
        }
        // Point masses do not rotate.
        for body in moving {
            if body.is_point() {
                body.mobility = Mobility::point();
            }
        }
        part
    }

    /// Adds drives that prescribe the starts of a part's joints: a fraction of their positions, or
    /// their rates at the present position. A drive of the file is there already; a fraction takes its place.
    pub(super) fn drive(&self, part: &mut Model<S>, joints: &[usize], asked: Asked, fraction: f64) {
        for (joint, dof, value) in self.given(joints, asked) {
            let coefficients = match asked {
                Asked::Place => vec![value * fraction],
                Asked::Rate => vec![place(part, joint, dof), value],
            };
            let course = TimeFunction::Polynomial(coefficients);
            let drives = &mut part.joints[joint].drives;
            match (drives.iter_mut().find(|drive| drive.dof == dof), asked) {
                (None, _) => drives.push(Drive { dof, course }),
                (Some(own), Asked::Place) => own.course = course,
                (Some(_), Asked::Rate) => {}
            }
        }
    }

    /// Rejects a start that other joints of a part, their drives and earlier starts determine.
    pub(super) fn check_free(
        &self,
        part: &Model<S>,
        joints: &[usize],
        asked: Asked,
    ) -> Result<(), AssemblyFailure> {
        // With infinitesimal parts: the same design was checked in values.
        if S::INFINITESIMAL {
            return Ok(());
        }
        let mut model = part.map(&mut |x| x.re());
        let Some(before) = redundancy::redundant_rows(&model) else {
            return Ok(());
        };
        let more =
            |model: &Model<f64>| redundancy::redundant_rows(model).is_some_and(|n| n > before);
        let mut held = |(joint, dof): (usize, DegreeOfFreedom)| {
            let drives = &model.joints[joint].drives;
            if drives.iter().any(|drive| drive.dof == dof) {
                return None;
            }
            let at = place(&model, joint, dof);
            model.joints[joint].drives.push(Drive {
                dof,
                course: TimeFunction::Polynomial(vec![at]),
            });
            more(&model).then(|| model.joints[joint].name.clone())
        };
        let given = self.given(joints, asked);
        match given
            .map(|(joint, dof, _)| (joint, dof))
            .find_map(&mut held)
        {
            Some(joint) => Err(AssemblyFailure::Determined { joint }),
            None => Ok(()),
        }
    }
}

/// The start that a drive gives a joint: an angle beyond a quarter turn, which the assembly cannot reach, and the rate
/// with which the bodies of a start in equilibrium move.
fn driven<S: Scalar>(
    document: &Document,
    joint: &Joint<S>,
    dof: DegreeOfFreedom,
) -> Option<[Option<S>; 2]> {
    let drive = joint.drives.iter().find(|drive| drive.dof == dof)?;
    let [place, rate, ..] = drive.course.derivatives(S::zero());
    // What follows a joint by a coupling is placed where the joint starts.
    let far =
        dof == DegreeOfFreedom::Rotation && place.re().abs() > QUARTER || document.is_coupled();
    let follows = document.start != Start::Given;
    (far || follows).then_some([far.then_some(place), follows.then_some(rate)])
}

/// Whether a joint is closed in every placement of its bodies.
fn closes(document: &Document, joint: &WrittenJoint) -> bool {
    let is_point = |body: &String| {
        let body = document.bodies.get(body);
        body.is_some_and(|body| matches!(body.shape, Some(Shape::Point)))
    };
    let points = joint.between().iter().any(is_point);
    match (joint, joint.place()) {
        (WrittenJoint::Rod(rod), _) => match &rod.at {
            Ends::Ground(_) | Ends::Each(_) => rod.length.is_none() && !points,
        },
        (_, Some(JointPlace::Each(_)) | None) => false,
        (_, Some(JointPlace::Named(_) | JointPlace::Coordinates(_))) => !points,
    }
}

/// Sets the positions of bodies from q.
pub(super) fn put<S: Scalar>(model: &mut Model<S>, bodies: &[usize], q: &[S]) {
    for (&body, q) in bodies.iter().zip(q.chunks(7)) {
        let body = &mut model.bodies[body];
        (body.position, body.orientation) = positions_of(q);
    }
}
