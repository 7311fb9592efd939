//! The angles with which joints and bodies start, whole turns included.

use super::cams::{dof, written_profile};
use super::joints::drives;
use super::placement::{Assembly, GROUND};
use crate::math::{Scalar, Vec3};
use crate::model::DegreeOfFreedom;
use crate::schema::Document;
use crate::schema::couplings::{Coupling, Term};
use crate::schema::joints::Joint;
use std::collections::{BTreeMap, VecDeque};

/// The angle with which a joint starts, by the file, a drive or a coupling \[rad\].
pub(super) fn starting_angle<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    name: &str,
) -> Option<f64> {
    let of = (name, DegreeOfFreedom::Rotation);
    let angle = given(document, assembly, of).or_else(|| led(document, assembly, of));
    angle.map(|angle| angle.re())
}

/// A motion of a joint.
type Of<'a> = (&'a str, DegreeOfFreedom);

/// Where a joint starts by the file or a drive.
fn given<S: Scalar>(document: &Document, assembly: &Assembly<S>, (name, dof): Of) -> Option<S> {
    let start = document.joints[name].start();
    let [given, _] = start.and_then(|start| start.of(dof)).unwrap_or_default();
    let given = given.map(|place| assembly.quantity(&place));
    let driven = || {
        let mut drives = drives(document, assembly, name).into_iter();
        let drive = drives.find(|drive| drive.dof == dof)?;
        Some(drive.course.value(S::zero()))
    };
    given.or_else(driven)
}

/// Where a coupling of others lets a joint start, if it has no start of its own: the follower of a cam, and the one term of a
/// relation with a constant that has none.
pub(super) fn led<S: Scalar>(document: &Document, assembly: &Assembly<S>, of: Of) -> Option<S> {
    let mut all = document.couplings.len();
    led_within(document, assembly, of, &mut all)
}

/// The same through at most `most` couplings.
fn led_within<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    of: Of,
    most: &mut usize,
) -> Option<S> {
    *most = most.checked_sub(1)?;
    let mut place = |of: Of| {
        let own = given(document, assembly, of);
        own.or_else(|| led_within(document, assembly, of, most))
    };
    document
        .couplings
        .values()
        .find_map(|coupling| match coupling {
            Coupling::Cam(own) => {
                let follows = own.follower.joint() == of.0 && dof(&own.follower) == of.1;
                let cam = follows.then(|| place((own.cam.joint(), dof(&own.cam))))?;
                Some(written_profile(assembly, own).value(cam.unwrap_or(S::zero())))
            }
            Coupling::Relation(own) => {
                let constant = assembly.quantity(own.constant.as_ref()?);
                let is_own = |term: &&Term| term.joint == of.0 && term_dof(term) == of.1;
                let factor = |term: &Term| {
                    let factor = term.turn.as_ref().or(term.slide.as_ref());
                    factor.map_or(S::zero(), |factor| assembly.quantity(factor))
                };
                let term = own.terms.iter().find(is_own)?;
                let others = own.terms.iter().filter(|other| !is_own(other));
                let mut sum = others.map(|other| {
                    let place = place((&other.joint, term_dof(other)))?;
                    Some(factor(other) * place)
                });
                let sum = sum.try_fold(S::zero(), |sum, next| Some(sum + next?))?;
                let factor = factor(term);
                (factor.re() != 0.0).then(|| (constant - sum) / factor)
            }
            _ => None,
        })
}

fn term_dof(term: &Term) -> DegreeOfFreedom {
    match term.turn {
        Some(_) => DegreeOfFreedom::Rotation,
        None => DegreeOfFreedom::Translation,
    }
}

/// Sine of the angle between axes that are parallel.
const PARALLEL: f64 = 1e-6;

/// The angle by which the starts and drives of joints turn a body from its placement about `axis`, against another:
/// the sum over the joints from the one to the other \[rad\]. `None` if there are none, or one may turn otherwise.
pub(super) fn starting_turn<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    [other, body]: [&str; 2],
    axis: &Vec3<S>,
) -> Option<f64> {
    let axis = axis.map(|x| x.re()).normalize();
    // By body: the turn of the joints that lead there.
    let mut turned = BTreeMap::from([(other, 0.0)]);
    let mut next = VecDeque::from([other]);
    while let Some(at) = next.pop_front() {
        if at == body {
            break;
        }
        for (name, joint) in &document.joints {
            // Ground counts as the second body.
            let [a, b] = match joint.between().each_ref().map(String::as_str) {
                [GROUND, b] => [b, GROUND],
                both => both,
            };
            let (to, sign) = match at {
                _ if at == b => (a, 1.0),
                _ if at == a => (b, -1.0),
                _ => continue,
            };
            if turned.contains_key(to) {
                continue;
            }
            let turn = match joint {
                Joint::Weld(_) | Joint::Prismatic(_) => 0.0,
                Joint::Revolute(_) | Joint::Planar(_) | Joint::Cylindrical(_) => {
                    let own = assembly.axis(joint.axes()[0]?).map(|x| x.re()).normalize();
                    if own.cross(&axis).norm() > PARALLEL {
                        continue;
                    }
                    let angle = starting_angle(document, assembly, name).unwrap_or(0.0);
                    sign * own.dot(&axis).signum() * angle
                }
                Joint::Spherical(_) | Joint::Universal(_) | Joint::Rod(_) | Joint::Free(_) => {
                    continue;
                }
            };
            turned.insert(to, turned[at] + turn);
            next.push_back(to);
        }
    }
    turned.get(body).copied()
}
