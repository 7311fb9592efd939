//! Controllers.

use super::Checker;
use crate::finding::Finding;
use crate::model::JointKind;
use crate::pointer::join;
use crate::schema::controllers::{Controller, Reference};
use crate::schema::functions::{Function, OfMotion};
use crate::schema::loads::Load;

impl Checker<'_> {
    /// Checks a controller: what it controls, follows and balances.
    pub(super) fn controller(&mut self, pointer: &str, own: &Controller) {
        use JointKind::{Cylindrical, Planar, Prismatic, Revolute};
        let of = (&own.joint, own.motion, &own.between, &own.at);
        self.joint_or_distance(pointer, of, ("controlled", "controls"));
        self.reference(pointer, &own.reference);
        if let Some(effort) = &own.feed_forward {
            self.course(&join(pointer, "feed_forward"), effort.parts());
        }
        for (k, other) in own.feedback.iter().enumerate() {
            let pointer = join(&join(pointer, "feedback"), k);
            let kinds = [Revolute, Prismatic, Cylindrical, Planar];
            self.loaded_joint(&pointer, &other.joint, &kinds);
            self.joint_motion(&pointer, &other.joint, other.motion);
            self.reference(&pointer, &other.reference);
        }
        for (k, balanced) in own.gravity_compensation.iter().enumerate() {
            let pointer = join(&join(pointer, "gravity_compensation"), k);
            self.moving(&pointer, &balanced.body, &balanced.point);
        }
        if own.between.is_some() && !own.gravity_compensation.is_empty() {
            let found = "masses that are balanced, of a distance";
            let place = join(pointer, "gravity_compensation");
            let expected = "none: weights are balanced about or along the axis of a joint";
            self.fault(Finding::new(place, found, expected).of_key());
        }
        self.controller_at_rest(pointer, own);
        let motor = own.motor.as_ref();
        if own.between.is_some() && motor.is_some_and(|motor| motor.rotor_inertia.is_some()) {
            let found = "the rotor of a motor that moves a distance";
            let expected = "none: a rotor turns with a joint";
            let place = join(&join(pointer, "motor"), "rotor_inertia");
            self.fault(Finding::new(place, found, expected).of_key());
        }
        let limited = motor.is_some_and(|motor| {
            motor.torque.is_some() || motor.curve.is_some() || motor.power.is_some()
        });
        if own.anti_windup.is_some() && (own.integral.is_none() || !limited) {
            let found = match own.integral {
                None => "\"anti_windup\" without \"integral\"",
                Some(_) => "\"anti_windup\" of a motor without limits",
            };
            let expected = "an integral that the limits of a \"motor\" wind up";
            let place = join(pointer, "anti_windup");
            self.fault(Finding::new(place, found, expected).of_key());
        }
    }

    /// Checks a controller of a machine at rest, whose integral holds a joint as a drive does.
    fn controller_at_rest(&mut self, pointer: &str, own: &Controller) {
        let document = self.document;
        if !document.is_rest() {
            return;
        }
        if own.integral.is_some() {
            let place = join(pointer, "integral");
            if own.between.is_some() {
                let found = "the integral of a distance, of a machine at rest";
                let expected =
                    "the integral of a joint; a joint of the kind \"rod\" holds a distance";
                self.fault(Finding::new(&place, found, expected).of_key());
            }
            let driven =
                (document.drives.values()).find(|drive| Some(&drive.joint) == own.joint.as_ref());
            if driven.is_some() {
                let found = "an integral of a joint that is driven, of a machine at rest";
                let expected = "one of them, as each holds the joint";
                self.fault(Finding::new(&place, found, expected).of_key());
            }
        }
        let lag = own.motor.as_ref().is_some_and(|motor| motor.lag.is_some());
        let vibrates = |function: &Function| {
            matches!(
                function.of_motion(),
                Some(
                    OfMotion::Frequency(_)
                        | OfMotion::LowestFrequency(_)
                        | OfMotion::DampingRatio(_)
                        | OfMotion::CriticalSpeed(_)
                )
            )
        };
        let modes = document.told_modes().is_some() || document.functions.values().any(vibrates);
        if modes && document.turning.is_some() && (lag || own.integral.is_some()) {
            let found = "a state of a controller, beside modes of a machine that turns";
            let expected = "a controller without \"integral\" and \"lag\"";
            self.fault(Finding::new(pointer, found, expected).of_key());
        }
    }

    fn reference(&mut self, pointer: &str, reference: &Option<Reference>) {
        let Some(Reference::Varying(course)) = reference else {
            return;
        };
        self.motion(&join(pointer, "reference"), course.parts());
    }

    /// Checks that a load is a controller.
    pub(super) fn controller_of(&mut self, pointer: &str, name: &str) {
        let fits = |load: &Load| matches!(load, Load::Controller(_));
        let expected = "the name of a load that is a controller";
        self.load_of(pointer, name, fits, expected);
    }
}
