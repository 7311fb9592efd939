//! The map from a design to a scene, analytic in the design.

use super::aggregates::rho_of;
use super::controllers::{add_rotors, turned};
use super::couplings;
use super::flexible::{FlexibleBodies, HeldPlace};
use super::loads::stopped;
use super::mass::mass_properties;
use super::phases;
use super::placement::Assembly;
use super::quantities::FunctionBuilder;
use super::start_rates;
use super::starts::Starts;
use crate::functions::{Function, Scene, TerminalEvent};
use crate::math::rotation::matrix;
use crate::math::scalar::lift3;
use crate::math::{Scalar, Vec3};
use crate::model::{DegreeOfFreedom, Mobility, Model, RigidBody, Role};
use crate::quantity::{Vector, vector};
use crate::schema::Document;
use crate::schema::events::When;
use crate::schema::flexible::Start;
use crate::schema::functions::OfMotion;
use crate::schema::loads::Load;
use crate::schema::mechanics::{Body, Shape};
use crate::schema::modes::DampingRatio;
use crate::schema::statics::Frequency;
use crate::structures::modes::BEYOND;
use crate::system::Numbering;
use crate::system::equilibrium::{Follow, Request, Turning, Vibrations, WantedModes, settle};
use crate::system::failure::AssemblyFailure;
use crate::system::placement::guess;
use std::collections::BTreeMap;

/// Default gravity \[m/s²\].
pub const GRAVITY: [f64; 3] = [0.0, -9.81, 0.0];

/// The scene of a checked document at the design `x`; bodies are placed in `order`.
pub fn scene<S: Scalar>(document: &Document, order: &[usize], x: &[S]) -> Scene<S> {
    with_places(document, order, x).0
}

/// The same, with the places that joints, loads and functions hold on flexible bodies.
pub fn with_places<S: Scalar>(
    document: &Document,
    order: &[usize],
    x: &[S],
) -> (Scene<S>, Vec<HeldPlace<S>>) {
    let assembly = Assembly::new(document, order, x);
    let gravity = match &document.gravity {
        Some(gravity) => vector(gravity, x),
        None => lift3(&Vec3::from(GRAVITY)),
    };
    let bodies = (0..document.bodies.len()).map(|index| body(document, &assembly, index, x));
    let mut model = Model {
        gravity,
        bodies: bodies.collect(),
        joints: super::joints::joints(document, &assembly),
        loads: super::loads::loads(document, &assembly),
        flexible: Vec::new(),
    };
    if !document.events.is_empty() {
        phases::open_at_start(document, &mut model);
    }
    let numbers = FlexibleBodies::weigh(document, &mut model, x);
    let mut unstarted = start(document, &assembly, &mut model, x).err();
    let mut flexible = FlexibleBodies::add(document, &assembly, &mut model, numbers, x);
    let mut builder = FunctionBuilder {
        document,
        assembly: &assembly,
        gravity,
        flexible: &flexible,
        mass: (model.bodies.iter()).fold(S::zero(), |sum, body| sum + body.mass),
        ends: (model.joints.iter())
            .map(|joint| (joint.body_a, joint.body_b))
            .collect(),
        frames: (model.joints.iter())
            .map(|joint| joint.frame_a.axes)
            .collect(),
        coupled: Vec::new(),
        counted: BTreeMap::new(),
        vibrations: Vibrations::default(),
        followed: followed(document),
        x,
    };
    builder.coupled = couplings::couple(document, &assembly, &mut model);
    add_rotors(document, &assembly, &mut model);
    count_turns(document, &builder, &mut model);
    model.add_states();
    // Later phases begin as those before them end.
    let sought = document
        .sought()
        .filter(|_| document.phase.is_none_or(|phase| phase == 0));
    if let (Some(sought), None) = (sought, &unstarted) {
        let request = Request {
            sought,
            turning: turning(document, x),
            modes: wanted_modes(document, &builder.followed),
            followed: builder.followed.clone(),
        };
        let mobilities: Vec<Mobility> = model.bodies.iter().map(|body| body.mobility).collect();
        if document.is_rest() {
            without_spin(document, &mut model);
        }
        match settle(&mut model, &document.known_starts, &request) {
            Ok(vibrations) => builder.vibrations = vibrations,
            Err(failure) => unstarted = Some(failure),
        }
        for (body, mobility) in model.bodies.iter_mut().zip(mobilities) {
            body.mobility = mobility;
        }
        if document.is_rest() {
            let all = model.loads.iter().flat_map(|load| load.kind.counters());
            let counted =
                all.map(|(joint, counter)| (joint, model.bodies[counter].position.x.re()));
            builder.counted = counted.collect();
        }
    }
    let mut functions: Vec<Function<S>> = document
        .functions
        .values()
        .map(|f| builder.function(f))
        .collect();
    let simulation = document.simulation.as_ref();
    let simulation = simulation.expect("a scene has a simulation, which is checked before");
    let (until, duration) = match document.next_event().map(|(_, event)| &event.when) {
        None => (simulation.until.as_ref(), &simulation.duration),
        Some(When::Reaches(until)) => (Some(&**until), &simulation.duration),
        Some(When::At(own)) => (None, &own.time),
    };
    let mut until = until
        .map(|until| TerminalEvent::new(builder.quantity(&until.measure), until.reaches.get(x)));
    flexible.move_functions(&mut model, &mut functions, &mut until);
    let apart = flexible.apart.take();
    let unstarted = unstarted.or(apart.map(|body| AssemblyFailure::MovedApart { body }));
    let scene = Scene {
        model,
        duration: duration.get(x),
        until,
        functions,
        unstarted,
    };
    (scene, flexible.places)
}

/// Keeps point masses from turning, which nothing resists or sees.
pub fn without_spin<S: Scalar>(document: &Document, model: &mut Model<S>) {
    for (body, written) in model.bodies.iter_mut().zip(document.bodies.values()) {
        if let Some(Shape::Point) = written.shape {
            body.mobility = Mobility::point();
        }
    }
}

/// The modes about rest that functions need.
fn wanted_modes(document: &Document, followed: &[Follow]) -> WantedModes {
    let mut wanted = WantedModes::default();
    for function in document.functions.values() {
        match function.of_motion() {
            Some(OfMotion::Frequency(own)) if !own.damped => {
                wanted.count = wanted.count.max(own.mode);
            }
            Some(OfMotion::Frequency(Frequency { mode, .. }))
            | Some(OfMotion::DampingRatio(DampingRatio { mode, .. })) => {
                wanted.damped = wanted.damped.max(*mode);
            }
            Some(OfMotion::CriticalSpeed(own)) => {
                wanted.critical = wanted.critical.max(own.number);
            }
            Some(OfMotion::LowestFrequency(own)) => {
                let rho = rho_of(own.rho);
                // The smaller one, or the one that is known.
                wanted.rho = Some(wanted.rho.map_or(rho, |other: f64| other.min(rho)));
            }
            _ => {}
        }
    }
    if !followed.is_empty() {
        wanted.beyond = BEYOND;
    }
    wanted
}

/// The modes that functions follow by their shapes.
fn followed(document: &Document) -> Vec<Follow> {
    let mut all: Vec<Follow> = Vec::new();
    for function in document.functions.values() {
        let own = function.of_motion().and_then(|own| follow(&own));
        all.extend(own.filter(|own| !all.contains(own)));
    }
    all
}

/// The mode that a function follows, if it does.
fn follow(function: &OfMotion) -> Option<Follow> {
    let (mode, damped, follows) = match function {
        OfMotion::Frequency(own) => (own.mode, own.damped, own.follow),
        OfMotion::DampingRatio(own) => (own.mode, true, own.follow),
        _ => return None,
    };
    let number = mode - 1;
    follows.then_some(Follow { number, damped })
}

/// The steady rotation of a machine.
pub(super) fn turning<S: Scalar>(document: &Document, x: &[S]) -> Option<Turning<S>> {
    let own = document.turning.as_ref()?;
    let axis = Vec3::from(own.axis).normalize();
    Some(Turning {
        axis: lift3(&axis),
        point: own.at.as_ref().map_or(Vec3::zeros(), |at| vector(at, x)),
        speed: own.speed.get(x),
    })
}

/// Gives torsion springs, stops of angles and controllers counters of turns, which start as the angles of their joints do.
fn count_turns<S: Scalar>(document: &Document, builder: &FunctionBuilder<S>, model: &mut Model<S>) {
    let numbering = Numbering::new(model);
    let (q, _) = guess(model);
    for (k, load) in document.loads.values().enumerate() {
        let joints = match load {
            Load::TorsionSpring(spring) => vec![&spring.joint],
            Load::Stop(stop) if stopped(document, stop) == Some(DegreeOfFreedom::Rotation) => {
                stop.joint.iter().collect()
            }
            Load::Controller(own) => turned(document, own),
            _ => continue,
        };
        let angle = |joint: &String| {
            let rotation = builder.joint_angle(joint);
            let twist = rotation.angle(&numbering, &q).re();
            twist + rotation.first_turns(twist)
        };
        model.count_turns(k, &joints.into_iter().map(angle).collect::<Vec<f64>>());
    }
}

/// A body at rest as placed.
fn body<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    index: usize,
    x: &[S],
) -> RigidBody<S> {
    let (name, body) = &document
        .bodies
        .get_index(index)
        .expect("the index counts the bodies");
    let pose = &assembly.poses[index];
    let properties = mass_properties(body, x);
    RigidBody {
        name: (*name).clone(),
        mass: properties.mass,
        inertia: properties.inertia,
        position: pose.position(),
        orientation: pose.orientation,
        velocity: Vec3::zeros(),
        angular_velocity: Vec3::zeros(),
        mobility: Mobility::spatial(),
        role: Role::Solid,
    }
}

/// Moves the bodies to the starts of their joints and sets their velocities. If this fails, the
/// bodies stay as placed and have the velocities of the file.
fn start<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    model: &mut Model<S>,
    x: &[S],
) -> Result<(), AssemblyFailure> {
    let give = |model: &mut Model<S>| {
        for (body, written) in model.bodies.iter_mut().zip(document.bodies.values()) {
            let [velocity, omega] = written_velocity(document, written, &body.position, x);
            body.velocity = velocity;
            body.angular_velocity = matrix(&body.orientation).tr_mul(&omega);
        }
    };
    let Some(starts) = Starts::of(document, assembly, model) else {
        give(model);
        return Ok(());
    };
    let mut moved = model.clone();
    let found = starts.place(&mut moved).and_then(|()| {
        give(&mut moved);
        if document.couplings.is_empty() {
            return start_rates::set(&starts, &mut moved);
        }
        // Rates of joints move those that are coupled with them.
        let mut coupled = moved.clone();
        couplings::couple(document, assembly, &mut coupled);
        start_rates::set(&starts.coupled(&coupled), &mut coupled)?;
        for (body, found) in moved.bodies.iter_mut().zip(&coupled.bodies) {
            body.velocity = found.velocity;
            body.angular_velocity = found.angular_velocity;
        }
        Ok(())
    });
    match found {
        Ok(()) => *model = moved,
        Err(_) => give(model),
    }
    found
}

/// Velocity \[m/s\] of the centre of mass at `position`, and angular velocity \[rad/s\], that a
/// file gives a body; ground axes.
fn written_velocity<S: Scalar>(
    document: &Document,
    body: &Body,
    position: &Vec3<S>,
    x: &[S],
) -> [Vec3<S>; 2] {
    let given = |components: &Option<Vector>| {
        components
            .as_ref()
            .map_or(Vec3::zeros(), |components| vector(components, x))
    };
    let (velocity, omega) = match (&body.velocity, &document.initial_velocity) {
        (Some(own), _) => (given(&own.linear), given(&own.angular)),
        (None, Some(all)) => {
            let omega = given(&all.angular);
            let arm = position - given(&all.about);
            (given(&all.linear) + omega.cross(&arm), omega)
        }
        (None, None) => (Vec3::zeros(), Vec3::zeros()),
    };
    match &body.shape {
        Some(Shape::Point) => [velocity, Vec3::zeros()],
        _ => [velocity, omega],
    }
}

/// By body: its own velocities, if the file gives them and starts of joints may replace them; see
/// [`written_velocity`].
pub fn own_velocities(document: &Document, x: &[f64]) -> Vec<Option<[Vec3<f64>; 2]>> {
    let follows = document.start != Start::Given && !document.drives.is_empty();
    let started = follows || (document.joints.values()).any(|joint| joint.start().is_some());
    let own = |body: &Body| {
        body.velocity.as_ref().filter(|_| started)?;
        Some(written_velocity(document, body, &Vec3::zeros(), x))
    };
    document.bodies.values().map(own).collect()
}
