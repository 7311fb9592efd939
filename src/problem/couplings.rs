//! Makes the couplings of a model from those of a file.
//!
//! Wheels with the unit axes n_1, n_2 and the angles φ_1, φ_2 about these against one carrier, and a rack with the
//! displacement s against it, move so that
//!
//! ```text
//! gear, crossed belt     z_1 φ_1 + z_2 (n_1·n_2) φ_2 = const       z: teeth, radii, or 1 and the ratio
//! inner gear, belt       z_1 φ_1 − z_2 (n_1·n_2) φ_2 = const
//! bevel                  (w·t_1) φ_1 − (w·t_2) φ_2 = const         t_i = n_i × (P − o_i), w = t_1/|t_1|
//! rack and pinion        s − (u·t) φ = const                       u the direction of the slide s
//! screw                  s − (l / 2π) φ = const
//! cam                    y − f(x) = 0                              of any two motions
//! ```
//!
//! with P the place where the teeth meet and o_i a point of the axis, all as placed.

use super::cams::{dof, written_profile};
use super::placement::{Assembly, GROUND};
use super::starting_angles::starting_angle;
use crate::functions::whole_turns;
use crate::math::rotation::matrix;
use crate::math::scalar::{length, unit};
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::{
    CoupledMotion, DegreeOfFreedom, Joint as ModelJoint, JointFrame, Model, TimeFunction,
};
use crate::schema::Document;
use crate::schema::couplings::{
    Bevel, Cam, Coupling, OfCoupling, RackAndPinion, Relation, Term, Wheels,
};
use crate::schema::joints::Joint;
use crate::schema::loads::Motion;
use crate::schema::mechanics::Location;
use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::TAU;

/// A joint on the way from one body to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passed {
    /// Its place in the file.
    pub joint: usize,
    /// 1 if its motion is that of the far body against the near one, or −1.
    pub sign: f64,
}

/// The bodies of a joint in the order of its motion: the first against the second, which ground is if it is one.
pub(super) fn ordered(joint: &Joint) -> [&str; 2] {
    match joint.between().each_ref().map(String::as_str) {
        [GROUND, b] => [b, GROUND],
        both => both,
    }
}

/// The joints on the shortest way from a body to another, of those that no event switches; `None` if there is none.
pub(super) fn way(document: &Document, from: &str, to: &str) -> Option<Vec<Passed>> {
    let mut came: BTreeMap<&str, Option<(&str, Passed)>> = BTreeMap::from([(from, None)]);
    let mut next = VecDeque::from([from]);
    while let Some(at) = next.pop_front() {
        for (joint, (name, written)) in document.joints.iter().enumerate() {
            if document.is_switched(name) {
                continue;
            }
            let [a, b] = ordered(written);
            let (far, sign) = match at {
                _ if at == b => (a, 1.0),
                _ if at == a => (b, -1.0),
                _ => continue,
            };
            if !came.contains_key(far) {
                came.insert(far, Some((at, Passed { joint, sign })));
                next.push_back(far);
            }
        }
    }
    let (mut all, mut at) = (Vec::new(), to);
    while let Some((near, passed)) = *came.get(at)? {
        all.push(passed);
        at = near;
    }
    all.reverse();
    Some(all)
}

/// The carrier of two bodies: the given one, or the only one to which both are joined; `None` if there is none or several.
pub(super) fn carrier<'a>(
    document: &'a Document,
    given: Option<&'a String>,
    bodies: [&str; 2],
) -> Option<&'a str> {
    if let Some(given) = given {
        return Some(given);
    }
    let beside = |body: &str| {
        let joined = document.joints.iter();
        let joined = joined.filter(|(name, _)| !document.is_switched(name));
        let joined = joined.map(|(_, joint)| ordered(joint));
        let mut all: Vec<&str> = joined
            .filter_map(|[a, b]| match body {
                _ if a == body => Some(b),
                _ if b == body => Some(a),
                _ => None,
            })
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let [first, second] = bodies.map(beside);
    let mut both = first.into_iter().filter(|body| second.contains(body));
    both.next().filter(|_| both.next().is_none())
}

/// A wheel on its carrier.
pub(super) struct Wheel<S> {
    /// n, ground axes as placed.
    pub axis: Vec3<S>,
    /// o, a point of the axis, ground axes as placed \[m\].
    pub point: Vec3<S>,
    /// The joints on the way from the carrier.
    way: Vec<Passed>,
    /// The one among them whose axis it is.
    hinge: Passed,
    /// The largest sine of the angle between its axis and those on the way.
    pub skew: f64,
}

/// Whether a joint turns a wheel.
pub(super) fn turns(joint: &Joint) -> bool {
    matches!(joint, Joint::Revolute(_) | Joint::Cylindrical(_))
}

/// Whether a joint is that of a rack.
fn slides(joint: &Joint) -> bool {
    matches!(joint, Joint::Prismatic(_) | Joint::Cylindrical(_))
}

impl<S: Scalar> Wheel<S> {
    /// The wheel of a checked document; `None` if no joint turns it.
    pub(super) fn of(
        document: &Document,
        assembly: &Assembly<S>,
        carrier: &str,
        body: &str,
    ) -> Option<Self> {
        let way = way(document, carrier, body)?;
        let joint = |passed: &Passed| &document.joints[passed.joint];
        let axis = |passed: &Passed| Some(unit(assembly.axis(joint(passed).axes()[0]?)));
        let turning = || way.iter().filter(|passed| turns(joint(passed)));
        let hinge = *turning().next_back()?;
        let own = axis(&hinge)?;
        let sine = |axis: Vec3<S>| axis.cross(&own).map(|x| x.re()).norm();
        Some(Self {
            axis: own,
            point: point(document, assembly, hinge.joint),
            skew: turning().filter_map(axis).map(sine).fold(0.0, f64::max),
            way,
            hinge,
        })
    }

    /// Its rotation against its carrier.
    fn motion(&self, model: &Model<S>, name: &str, factor: S) -> CoupledMotion<S> {
        CoupledMotion {
            joint: against_carrier(model, &self.way, self.hinge, name),
            dof: DegreeOfFreedom::Rotation,
            factor,
        }
    }

    /// t = n × (P − o).
    pub(super) fn path(&self, at: &Vec3<S>) -> Vec3<S> {
        self.axis.cross(&(at - self.point))
    }
}

/// The frames of a body and its carrier at the end and the start of the way between them, with the axis of a joint on it. The
/// bodies are those that the joints of the model hold: sections, on flexible bodies.
fn against_carrier<S: Scalar>(
    model: &Model<S>,
    way: &[Passed],
    hinge: Passed,
    name: &str,
) -> ModelJoint<S> {
    let far = |passed: Passed| {
        let joint = &model.joints[passed.joint];
        match passed.sign > 0.0 {
            true => (Some(joint.body_a), joint.frame_a),
            false => (joint.body_b, joint.frame_b),
        }
    };
    let near = |passed: Passed| {
        far(Passed {
            sign: -passed.sign,
            ..passed
        })
        .0
    };
    let pose = |body: Option<usize>| match body.map(|body| &model.bodies[body]) {
        Some(body) => (body.position, matrix(&body.orientation)),
        None => (Vec3::zeros(), Mat3::identity()),
    };
    let (turning, frame) = far(hinge);
    let (place, turn) = pose(turning);
    let (point, axes) = (
        place + turn * frame.point,
        frame.axes.map(|axis| turn * axis),
    );
    let on = |body: Option<usize>| {
        let (place, turn) = pose(body);
        JointFrame {
            point: turn.tr_mul(&(point - place)),
            axes: axes.map(|axis| turn.tr_mul(&axis)),
            length: S::zero(),
        }
    };
    let [first, last] = [way.first(), way.last()].map(|own| *own.unwrap_or(&hinge));
    let (body_a, body_b) = (far(last).0, near(first));
    ModelJoint {
        name: name.to_owned(),
        body_a: body_a.expect("a coupled body is not ground, which is checked"),
        body_b,
        frame_a: on(body_a),
        frame_b: on(body_b),
        ..model.joints[hinge.joint].clone()
    }
}

/// The point of a joint on its first body, ground axes as placed \[m\].
fn point<S: Scalar>(document: &Document, assembly: &Assembly<S>, joint: usize) -> Vec3<S> {
    let joint = &document.joints[joint];
    let body = &joint.between()[0];
    let pose = assembly.pose(body);
    let place = joint
        .place()
        .expect("a joint that turns or slides has a place");
    pose.origin + pose.rotation * super::joints::at(assembly, place, body, 0)
}

/// A place in ground coordinates as placed \[m\].
fn place<S: Scalar>(assembly: &Assembly<S>, at: &Location) -> Vec3<S> {
    match at {
        Location::Named(text) => assembly.named(text),
        Location::Coordinates(point) => assembly.ground(point),
    }
}

/// Both wheels of a coupling.
pub(super) fn pair<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    wheels: &Wheels,
) -> Option<[Wheel<S>; 2]> {
    let bodies = wheels.bodies.each_ref().map(String::as_str);
    let carrier = carrier(document, wheels.carrier, bodies)?;
    let [a, b] = bodies.map(|body| Wheel::of(document, assembly, carrier, body));
    Some([a?, b?])
}

/// Sizes of two wheels: teeth, radii, or 1 and the ratio.
fn sizes<S: Scalar>(assembly: &Assembly<S>, wheels: &Wheels) -> Option<[S; 2]> {
    let both = wheels.teeth.or(wheels.radii);
    let both = both.map(|both| both.map(|own| assembly.quantity(&own)));
    both.or_else(|| Some([S::one(), assembly.quantity(&wheels.ratio?)]))
}

/// The paths of the teeth of bevel gears where they meet.
pub(super) fn bevel_paths<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    (coupling, own): (&Coupling, &Bevel),
) -> Option<[Vec3<S>; 2]> {
    let at = place(assembly, &own.at);
    let wheels = pair(document, assembly, &coupling.wheels()?)?;
    Some(wheels.map(|wheel| wheel.path(&at)))
}

/// A rack on its carrier with its pinion.
pub(super) struct Rack<S> {
    pub pinion: Wheel<S>,
    /// The joints on the way from the carrier to the rack, and the one along which it slides.
    way: Vec<Passed>,
    slide: Passed,
    /// u, ground axes as placed.
    pub along: Vec3<S>,
    /// The path t of the pinion's teeth where they meet.
    pub path: Vec3<S>,
}

/// The rack of a coupling; `None` if joints do not hold it so.
pub(super) fn rack<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    own: &RackAndPinion,
) -> Option<Rack<S>> {
    let carrier = carrier(document, own.carrier.as_ref(), [&own.rack, &own.pinion])?;
    let pinion = Wheel::of(document, assembly, carrier, &own.pinion)?;
    let way = way(document, carrier, &own.rack)?;
    let mut all = way.iter();
    let slide = *all.find(|passed| slides(&document.joints[passed.joint]))?;
    let axis = document.joints[slide.joint].axes()[0]?;
    Some(Rack {
        along: unit(assembly.axis(axis)),
        path: pinion.path(&place(assembly, &own.at)),
        pinion,
        way,
        slide,
    })
}

/// The motions of a coupling of a checked document with their factors.
fn motions<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    model: &Model<S>,
    coupling: &Coupling,
) -> Option<Vec<CoupledMotion<S>>> {
    let joint = |name: &String| Some(model.joints[document.joints.get_index_of(name)?].clone());
    let motion = |name: &String, dof, factor| {
        let joint = joint(name)?;
        Some(CoupledMotion { joint, dof, factor })
    };
    let (turn, slide) = (DegreeOfFreedom::Rotation, DegreeOfFreedom::Translation);
    let wheels = coupling.wheels();
    if let Some(wheels) = &wheels {
        let [a, b] = pair(document, assembly, wheels)?;
        let [first, second] = factors(assembly, (coupling, wheels), [&a, &b])?;
        let [of_a, of_b] = wheels.bodies;
        let both = [(a, of_a, first), (b, of_b, second)];
        return Some(
            both.map(|(own, name, factor)| own.motion(model, name, factor))
                .into(),
        );
    }
    match coupling {
        // They have wheels.
        Coupling::Gear(_) | Coupling::Bevel(_) | Coupling::Belt(_) => None,
        Coupling::RackAndPinion(own) => {
            let found = rack(document, assembly, own)?;
            let speed = found.path.dot(&found.along);
            let speed = match &own.radius {
                Some(radius) => assembly.quantity(radius) * speed.re().signum(),
                None => speed,
            };
            let slides = CoupledMotion {
                joint: against_carrier(model, &found.way, found.slide, &own.rack),
                dof: slide,
                factor: S::one(),
            };
            Some(vec![
                found.pinion.motion(model, &own.pinion, -speed),
                slides,
            ])
        }
        Coupling::Screw(own) => {
            let lead = assembly.quantity(&own.lead) / TAU;
            let both = [(turn, -lead), (slide, S::one())];
            both.into_iter()
                .map(|(dof, factor)| motion(&own.joint, dof, factor))
                .collect()
        }
        Coupling::Cam(own) => [&own.cam, &own.follower]
            .into_iter()
            .map(|of| motion(of.joint(), dof(of), S::one()))
            .collect(),
        Coupling::Relation(own) => {
            let of = |term: &Term| {
                let (dof, factor) = match (&term.turn, &term.slide) {
                    (Some(factor), _) => (turn, factor),
                    (None, factor) => (slide, factor.as_ref()?),
                };
                motion(&term.joint, dof, assembly.quantity(factor))
            };
            own.terms.iter().map(of).collect()
        }
    }
}

/// The factors of the angles of two wheels.
fn factors<S: Scalar>(
    assembly: &Assembly<S>,
    (coupling, wheels): (&Coupling, &Wheels),
    [a, b]: [&Wheel<S>; 2],
) -> Option<[S; 2]> {
    let given = sizes(assembly, wheels);
    let same_way = match coupling {
        Coupling::Gear(own) => own.inner,
        Coupling::Belt(own) => !own.crossed,
        Coupling::Bevel(own) => {
            let at = place(assembly, &own.at);
            let (first, second) = (a.path(&at), b.path(&at));
            let across = second.dot(&unit(first));
            let [first, second] = given.unwrap_or([length(&first), across]);
            let sense = if across.re() > 0.0 { -1.0 } else { 1.0 };
            let size = if second.re() < 0.0 { -second } else { second };
            return Some([first, size * sense]);
        }
        Coupling::RackAndPinion(_)
        | Coupling::Screw(_)
        | Coupling::Relation(_)
        | Coupling::Cam(_) => return None,
    };
    let [first, second] = given?;
    let parallel = a.axis.dot(&b.axis).re().signum();
    Some([first, second * if same_way { -parallel } else { parallel }])
}

/// A motion of a coupling in a model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Followed<S> {
    /// The joint by which it follows.
    pub joint: usize,
    pub dof: DegreeOfFreedom,
    /// Its axis on the first body of the joint.
    pub axis: Vec3<S>,
}

/// By how much the placement misses the constant of a relation that has one.
fn miss<S: Scalar>(
    assembly: &Assembly<S>,
    relation: &Relation,
    placed: impl Fn(&str, DegreeOfFreedom) -> S,
) -> S {
    let Some(constant) = &relation.constant else {
        return S::zero();
    };
    let (turn, slide) = (DegreeOfFreedom::Rotation, DegreeOfFreedom::Translation);
    let of = |term: &Term| {
        let both = [(&term.turn, turn), (&term.slide, slide)];
        let own = both
            .into_iter()
            .find_map(|(own, dof)| Some((own.as_ref()?, dof)));
        own.map_or(S::zero(), |(factor, dof)| {
            assembly.quantity(factor) * placed(&term.joint, dof)
        })
    };
    let terms = relation.terms.iter();
    let placed = terms.fold(S::zero(), |sum, term| sum + of(term));
    assembly.quantity(constant) - placed
}

/// The profile of a cam between motions that count from the placement.
fn profile<S: Scalar>(
    assembly: &Assembly<S>,
    cam: &Cam,
    placed: impl Fn(&str, DegreeOfFreedom) -> S,
) -> TimeFunction<S> {
    let [from, start] = [&cam.cam, &cam.follower].map(|of| placed(of.joint(), dof(of)));
    written_profile(assembly, cam).since(from).shifted(-start)
}

/// The angle or displacement of a joint as placed, as functions measure it.
fn placed<S: Scalar>(
    (document, assembly): (&Document, &Assembly<S>),
    model: &Model<S>,
    name: &str,
    dof: DegreeOfFreedom,
) -> S {
    let joint = document.joints.get_index_of(name);
    let place = model.place_of(&model.joints[joint.expect("joints are checked")], dof);
    match dof {
        DegreeOfFreedom::Translation => place,
        DegreeOfFreedom::Rotation => {
            let first = starting_angle(document, assembly, name);
            let first = first.map_or(0.0, |first| whole_turns(first - place.re()));
            place + first
        }
    }
}

/// Couples the bodies of a model as they are placed: their motions.
pub(super) fn couple<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    model: &mut Model<S>,
) -> Vec<Vec<Followed<S>>> {
    let one = |(name, coupling): (&String, &Coupling)| {
        let motions = motions(document, assembly, model, coupling);
        let motions = motions.expect("a coupling has its motions, which is checked");
        let placed = |joint: &str, dof| placed((document, assembly), model, joint, dof);
        let joints = match (coupling, &motions[..]) {
            (Coupling::Cam(own), [cam, follower]) => {
                let profile = profile(assembly, own, placed);
                model.add_cam(name, [cam, follower], profile)
            }
            (Coupling::Relation(own), _) => {
                let miss = miss(assembly, own, placed);
                model.couple(name, &motions, miss)
            }
            _ => model.couple(name, &motions, S::zero()),
        };
        let followed = |(motion, joint): (&CoupledMotion<S>, usize)| Followed {
            joint,
            dof: motion.dof,
            axis: motion.joint.frame_a.axes[2],
        };
        motions.iter().zip(joints).map(followed).collect()
    };
    document.couplings.iter().map(one).collect()
}

/// The motions of a coupling, in the order of the model: the wheel, rack or joint of each, and how it moves.
pub(super) fn moved(coupling: &Coupling) -> Vec<(&String, Motion)> {
    let wheels = coupling.wheels();
    let wheels = wheels
        .iter()
        .flat_map(|own| own.bodies)
        .map(|own| (own, Motion::Turn));
    match coupling {
        Coupling::Gear(_) | Coupling::Bevel(_) | Coupling::Belt(_) => wheels.collect(),
        Coupling::RackAndPinion(own) => {
            vec![(&own.pinion, Motion::Turn), (&own.rack, Motion::Slide)]
        }
        Coupling::Screw(own) => vec![(&own.joint, Motion::Turn), (&own.joint, Motion::Slide)],
        Coupling::Cam(own) => [&own.cam, &own.follower]
            .map(|of| (of.joint(), of.motion()))
            .into(),
        Coupling::Relation(own) => {
            let motion = |term: &Term| match term.turn {
                Some(_) => Motion::Turn,
                None => Motion::Slide,
            };
            let terms = own.terms.iter();
            terms.map(|term| (&term.joint, motion(term))).collect()
        }
    }
}

/// The place among the motions of a coupling of the one that a function observes; `None` if it has no such motion.
pub(super) fn observed(coupling: &Coupling, of: &OfCoupling) -> Option<usize> {
    moved(coupling).iter().position(|(name, motion)| {
        let is_named = of.on.as_ref().is_none_or(|on| on == *name);
        is_named && of.motion.is_none_or(|own| own == *motion)
    })
}

/// How the last motion of each coupling follows the others in a model of the document, for messages.
pub(super) fn described(document: &Document, model: &Model<f64>) -> Vec<String> {
    let mut joints = model.joints.iter().filter(|joint| joint.is_coupled());
    let mut all = Vec::new();
    for (name, coupling) in &document.couplings {
        let moved = moved(coupling);
        let own: Vec<&ModelJoint<f64>> = joints.by_ref().take(moved.len()).collect();
        let (Some((last, others)), Some(joint)) = (moved.split_last(), own.last()) else {
            continue;
        };
        let word = |(of, motion): &(&String, Motion)| match motion {
            Motion::Turn => format!("turn of \"{of}\""),
            Motion::Slide => format!("slide of \"{of}\""),
        };
        let modes = joint.modes.iter();
        let factors = modes.flat_map(|own| own.displacement.iter().zip(&own.rotation));
        let terms = factors.zip(others).map(|((n, t), other)| {
            let (factor, of) = (n.z + t.z, word(other));
            format!("{factor:.6} {of}")
        });
        let terms: Vec<String> = terms.collect();
        let (key, follows) = (coupling.key(), word(last));
        let by = match coupling {
            Coupling::Cam(own) => {
                let (of, count) = (others.iter().map(word), own.profile.at.len());
                format!("f({}), of {count} points", of.collect::<String>())
            }
            _ => terms.join(" + "),
        };
        all.push(format!("{name} ({key}): {follows} = {by}"));
    }
    all
}
