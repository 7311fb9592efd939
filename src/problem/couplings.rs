//! Makes the couplings of a model from those of a file.
//!
//! The angle of a wheel against its carrier is a sum of angles of the joints on the way from the carrier to it. Wheels
//! with the unit axes n_1, n_2 and the angles φ_1, φ_2 about these against one carrier move so that
//!
//! ```text
//! gear, crossed belt     z_1 φ_1 + z_2 (n_1·n_2) φ_2 = const       z: teeth, radii, or 1 and the ratio
//! inner gear, belt       z_1 φ_1 − z_2 (n_1·n_2) φ_2 = const
//! bevel                  (w·t_1) φ_1 − (w·t_2) φ_2 = const         t_i = n_i × (P − o_i), w = t_1/|t_1|
//! rack and pinion        s − (u·t) φ = const                       u the direction of the slide s
//! screw                  s − (l / 2π) φ = const
//! ```
//!
//! with P the place where the teeth meet and o_i a point of the axis, all as placed.

use super::placement::{Assembly, GROUND};
use super::quantities::FunctionBuilder;
use crate::functions::Rotation;
use crate::math::scalar::{length, unit};
use crate::math::{Scalar, Vec3};
use crate::model::{CoupledMotion, DegreeOfFreedom, Model};
use crate::schema::Document;
use crate::schema::couplings::{
    Bevel, CoupledMotion as Motion, Coupling, OfCoupling, RackAndPinion, Wheels,
};
use crate::schema::joints::Joint;
use crate::schema::mechanics::Location;
use crate::system::placement::guess;
use crate::system::{BodyMotion, Numbering, measures};
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

/// The joints on the shortest way from a body to another; `None` if there is none.
pub(super) fn way(document: &Document, from: &str, to: &str) -> Option<Vec<Passed>> {
    let mut came: BTreeMap<&str, Option<(&str, Passed)>> = BTreeMap::from([(from, None)]);
    let mut next = VecDeque::from([from]);
    while let Some(at) = next.pop_front() {
        for (joint, written) in document.joints.values().enumerate() {
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
        let joined = document.joints.values().map(ordered);
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

/// A wheel: its axis, a point of it and its angle, from those of its carrier.
pub(super) struct Wheel<S> {
    /// n, ground axes as placed.
    pub axis: Vec3<S>,
    /// o, ground axes as placed \[m\].
    pub point: Vec3<S>,
    /// The axes on the way, with the joint and whether it turns as its motion does.
    passed: Vec<(Passed, Vec3<S>)>,
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
        let turned = way.iter().filter(|passed| turns(joint(passed)));
        let passed: Vec<(Passed, Vec3<S>)> = turned
            .filter_map(|passed| Some((*passed, axis(passed)?)))
            .collect();
        let &(last, axis) = passed.last()?;
        Some(Self {
            axis,
            point: point(document, assembly, last.joint),
            passed,
        })
    }

    /// The largest sine of the angle between its axis and those on the way.
    pub(super) fn skew(&self) -> f64 {
        let sines = self.passed.iter();
        let sines = sines.map(|(_, axis)| axis.cross(&self.axis).map(|x| x.re()).norm());
        sines.fold(0.0, f64::max)
    }

    /// The motions whose sum with their factors is `factor` times its angle.
    fn motions(&self, factor: S) -> impl Iterator<Item = CoupledMotion<S>> + '_ {
        self.passed.iter().map(move |(passed, axis)| {
            let same = axis.dot(&self.axis).re().signum();
            CoupledMotion {
                joint: passed.joint,
                dof: DegreeOfFreedom::Rotation,
                factor: factor * (passed.sign * same),
            }
        })
    }

    /// t = n × (P − o).
    pub(super) fn path(&self, at: &Vec3<S>) -> Vec3<S> {
        self.axis.cross(&(at - self.point))
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

/// The pinion of a rack, the rack's joint with its sign, the unit direction of its motion, and the path of the pinion's
/// teeth where they meet.
pub(super) fn rack<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    own: &RackAndPinion,
) -> Option<(Wheel<S>, Passed, Vec3<S>, Vec3<S>)> {
    let carrier = carrier(document, own.carrier.as_ref(), [&own.rack, &own.pinion])?;
    let pinion = Wheel::of(document, assembly, carrier, &own.pinion)?;
    let way = way(document, carrier, &own.rack)?;
    let slide = way
        .into_iter()
        .find(|passed| slides(&document.joints[passed.joint]))?;
    let axis = document.joints[slide.joint].axes()[0]?;
    let along = unit(assembly.axis(axis)) * S::from(slide.sign);
    let path = pinion.path(&place(assembly, &own.at));
    Some((pinion, slide, along, path))
}

/// The motions of a coupling of a checked document, with their factors; none if its bodies are not joined so.
pub(super) fn motions<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    coupling: &Coupling,
) -> Vec<CoupledMotion<S>> {
    let found = match coupling {
        Coupling::Gear(own) => of_wheels(document, assembly, coupling, own.inner),
        Coupling::Belt(own) => of_wheels(document, assembly, coupling, !own.crossed),
        Coupling::Bevel(own) => of_bevel(document, assembly, (coupling, own)),
        Coupling::RackAndPinion(own) => of_rack(document, assembly, own),
        Coupling::Screw(own) => {
            let joint = document.joints.get_index_of(&own.joint);
            joint.map(|joint| {
                let motion = |dof, factor| CoupledMotion { joint, dof, factor };
                let lead = assembly.quantity(&own.lead) / TAU;
                vec![
                    motion(DegreeOfFreedom::Rotation, -lead),
                    motion(DegreeOfFreedom::Translation, S::one()),
                ]
            })
        }
        Coupling::Relation(own) => {
            let motion = |term: &crate::schema::couplings::Term| {
                let (dof, factor) = match (&term.turn, &term.slide) {
                    (Some(turn), _) => (DegreeOfFreedom::Rotation, turn),
                    (None, slide) => (DegreeOfFreedom::Translation, slide.as_ref()?),
                };
                Some(CoupledMotion {
                    joint: document.joints.get_index_of(&term.joint)?,
                    dof,
                    factor: assembly.quantity(factor),
                })
            };
            own.terms.iter().map(motion).collect()
        }
    };
    merged(found.unwrap_or_default())
}

fn of_wheels<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    coupling: &Coupling,
    same_way: bool,
) -> Option<Vec<CoupledMotion<S>>> {
    let wheels = coupling.wheels()?;
    let [first, second] = sizes(assembly, &wheels)?;
    let [a, b] = pair(document, assembly, &wheels)?;
    let parallel = a.axis.dot(&b.axis).re().signum();
    let sense = if same_way { -parallel } else { parallel };
    let all = a.motions(first).chain(b.motions(second * sense));
    Some(all.collect())
}

fn of_bevel<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    (coupling, own): (&Coupling, &Bevel),
) -> Option<Vec<CoupledMotion<S>>> {
    let wheels = coupling.wheels()?;
    let [a, b] = pair(document, assembly, &wheels)?;
    let at = place(assembly, &own.at);
    let (first, second) = (a.path(&at), b.path(&at));
    let along = unit(first);
    let across = second.dot(&along);
    let [first, second] = match sizes(assembly, &wheels) {
        Some([first, second]) => [first, -second * across.re().signum()],
        None => [length(&first), -across],
    };
    Some(a.motions(first).chain(b.motions(second)).collect())
}

fn of_rack<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    own: &RackAndPinion,
) -> Option<Vec<CoupledMotion<S>>> {
    let (pinion, slide, along, path) = rack(document, assembly, own)?;
    let speed = path.dot(&along);
    let speed = match &own.radius {
        Some(radius) => assembly.quantity(radius) * speed.re().signum(),
        None => speed,
    };
    let slides = CoupledMotion {
        joint: slide.joint,
        dof: DegreeOfFreedom::Translation,
        factor: S::from(slide.sign),
    };
    Some(pinion.motions(-speed).chain([slides]).collect())
}

/// The motions with each once, in the order of their last terms.
fn merged<S: Scalar>(motions: Vec<CoupledMotion<S>>) -> Vec<CoupledMotion<S>> {
    let mut all: Vec<CoupledMotion<S>> = Vec::new();
    for mut motion in motions {
        let same = |own: &CoupledMotion<S>| (own.joint, own.dof) == (motion.joint, motion.dof);
        if let Some(at) = all.iter().position(same) {
            motion.factor += all.remove(at).factor;
        }
        all.push(motion);
    }
    all
}

/// A motion of a coupling in a model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Followed<S> {
    pub motion: CoupledMotion<S>,
    /// The joint by which it follows.
    pub joint: usize,
    /// Its axis on the first body of the joint.
    pub axis: Vec3<S>,
}

/// Couples the joints of a model as the bodies are placed, up to a `miss` of each coupling: their motions.
pub(super) fn couple<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    model: &mut Model<S>,
    miss: impl Fn(&Model<S>, &Coupling, &[CoupledMotion<S>]) -> S,
) -> Vec<Vec<Followed<S>>> {
    let one = |(name, coupling): (&String, &Coupling)| {
        let motions = motions(document, assembly, coupling);
        let miss = miss(model, coupling, &motions);
        let joints = model.couple(name, &motions, miss);
        let followed = |(motion, joint): (CoupledMotion<S>, usize)| Followed {
            motion,
            joint,
            axis: model.joints[joint].frame_a.axes[2],
        };
        motions.into_iter().zip(joints).map(followed).collect()
    };
    document.couplings.iter().map(one).collect()
}

/// By how much the placement misses the constant of a relation that has one.
pub(super) fn miss<S: Scalar>(
    builder: &FunctionBuilder<S>,
    model: &Model<S>,
    coupling: &Coupling,
    motions: &[CoupledMotion<S>],
) -> S {
    let Coupling::Relation(relation) = coupling else {
        return S::zero();
    };
    let Some(constant) = &relation.constant else {
        return S::zero();
    };
    let numbering = Numbering::new(model);
    let (q, v) = guess(model);
    let mut bodies = Vec::new();
    BodyMotion::all(&numbering, &q, &v, &mut bodies);
    let place = |motion: &CoupledMotion<S>| match motion.dof {
        DegreeOfFreedom::Rotation => {
            let (name, _) = builder
                .document
                .joints
                .get_index(motion.joint)
                .expect("joints are checked");
            let rotation: Rotation<S> = builder.joint_angle(name);
            let twist = rotation.angle(&numbering, &q);
            twist + rotation.first_turns(twist.re())
        }
        DegreeOfFreedom::Translation => measures::slide(&model.joints[motion.joint], &bodies),
    };
    let placed = motions.iter();
    let placed = placed.fold(S::zero(), |sum, own| sum + own.factor * place(own));
    builder.assembly.quantity(constant) - placed
}

/// The place among the motions of a coupling of the one that a function observes; `None` if it has no such motion.
pub(super) fn observed(
    document: &Document,
    motions: &[(usize, DegreeOfFreedom)],
    of: &OfCoupling,
) -> Option<usize> {
    let joint = match &of.joint {
        Some(name) => Some(document.joints.get_index_of(name)?),
        None => None,
    };
    let dof = of.motion.map(|own| match own {
        Motion::Turn => DegreeOfFreedom::Rotation,
        Motion::Slide => DegreeOfFreedom::Translation,
    });
    motions.iter().position(|own| {
        joint.is_none_or(|joint| own.0 == joint) && dof.is_none_or(|dof| own.1 == dof)
    })
}

/// The joints that a coupling moves, with how, in the order of [`motions`]; none if its bodies are not joined so.
pub(super) fn moved(document: &Document, coupling: &Coupling) -> Vec<(usize, DegreeOfFreedom)> {
    let joint = |name: &String| document.joints.get_index_of(name);
    let on_way = |carrier: Option<&str>, body: &str, fits: fn(&Joint) -> bool, dof| {
        let way = carrier.and_then(|carrier| way(document, carrier, body));
        let all = way.unwrap_or_default().into_iter().map(|own| own.joint);
        let all = all.filter(|&joint| fits(&document.joints[joint]));
        all.map(|joint| (joint, dof)).collect::<Vec<_>>()
    };
    let (turn, slide) = (DegreeOfFreedom::Rotation, DegreeOfFreedom::Translation);
    let found: Vec<(usize, DegreeOfFreedom)> = match coupling {
        Coupling::Gear(_) | Coupling::Bevel(_) | Coupling::Belt(_) => {
            let wheels = coupling.wheels();
            let wheels = wheels.iter().flat_map(|own| {
                let bodies = own.bodies.each_ref().map(String::as_str);
                let carrier = carrier(document, own.carrier, bodies);
                bodies.map(|body| on_way(carrier, body, turns, turn))
            });
            wheels.flatten().collect()
        }
        Coupling::RackAndPinion(own) => {
            let carrier = carrier(document, own.carrier.as_ref(), [&own.rack, &own.pinion]);
            let mut all = on_way(carrier, &own.pinion, turns, turn);
            all.extend(on_way(carrier, &own.rack, slides, slide));
            all
        }
        Coupling::Screw(own) => {
            let joint = joint(&own.joint);
            joint.map_or_else(Vec::new, |joint| vec![(joint, turn), (joint, slide)])
        }
        Coupling::Relation(own) => {
            let terms = own.terms.iter();
            let dof = |turns: bool| if turns { turn } else { slide };
            terms
                .filter_map(|term| Some((joint(&term.joint)?, dof(term.turn.is_some()))))
                .collect()
        }
    };
    let last = |&(at, own): &(usize, &(usize, DegreeOfFreedom))| !found[at + 1..].contains(own);
    found
        .iter()
        .enumerate()
        .filter(last)
        .map(|(_, own)| *own)
        .collect()
}
