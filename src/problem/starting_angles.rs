//! The angles with which joints and bodies start, whole turns included.

use super::joints::drives;
use super::placement::{Assembly, GROUND};
use crate::math::{Scalar, Vec3};
use crate::model::DegreeOfFreedom;
use crate::schema::Document;
use crate::schema::joints::Joint;
use std::collections::{BTreeMap, VecDeque};

/// The angle with which a joint starts, by the file or a drive \[rad\].
pub(super) fn starting_angle<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    name: &str,
) -> Option<f64> {
    let turns = DegreeOfFreedom::Rotation;
    let start = document.joints[name].start();
    let [given, _] = start.and_then(|start| start.of(turns)).unwrap_or_default();
    let given = given.map(|angle| assembly.quantity(&angle));
    let driven = || {
        let mut drives = drives(document, assembly, name).into_iter();
        let drive = drives.find(|drive| drive.dof == turns)?;
        Some(drive.course.value(S::zero()))
    };
    given.or_else(driven).map(|angle| angle.re())
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
