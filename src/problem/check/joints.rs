//! Joints and drives.

use super::Checker;
use crate::finding::Finding;
use crate::joints::holds_points;
use crate::model::{DegreeOfFreedom, JointKind};
use crate::pointer::join;
use crate::schema::drives::TimeFunction;
use crate::schema::joints::{Axis, Ends, Joint, JointPlace, JointStart, PointPair};
use crate::schema::mechanics::{Body, Shape};

impl Checker<'_> {
    pub(super) fn joints(&mut self) {
        let document = self.document;
        self.names("joints", document.joints.keys());
        for (name, joint) in &document.joints {
            let pointer = join(&join("/joints", name), joint.kind().name());
            self.joint(&pointer, name, joint);
        }
    }

    fn joint(&mut self, pointer: &str, name: &str, joint: &Joint) {
        let document = self.document;
        let between = joint.between();
        self.between(&join(pointer, "between"), between);
        self.point_masses(pointer, joint);
        let at = join(pointer, "at");
        match (joint, joint.place()) {
            (_, Some(JointPlace::Named(text))) => self.location(&at, text),
            (_, Some(JointPlace::Each(pair))) => {
                self.pair(&at, between, pair);
                self.held(&at, between, pair);
            }
            (Joint::Rod(rod), _) => {
                if let Ends::Each(pair) = &rod.at {
                    self.pair(&at, between, pair);
                }
            }
            (_, Some(JointPlace::Coordinates(_)) | None) => {}
        }
        for (key, axis) in ["axis", "cross"].into_iter().zip(joint.axes()) {
            let pointer = join(pointer, key);
            match axis {
                Some(Axis::Ground(axis)) => self.direction(&pointer, axis),
                Some(Axis::OfBody(of)) => {
                    self.body(&join(&pointer, "body"), &of.body);
                    self.direction(&join(&pointer, "axis"), &of.axis);
                }
                None => {}
            }
        }
        if let Some(start) = joint.start() {
            let pointer = join(pointer, "start");
            let bent = |body: &Body| {
                let beam = body.beam.as_ref().is_some_and(|beam| beam.start.is_some());
                let modal = body.modal.as_ref();
                beam || modal.is_some_and(|modal| modal.start.is_some())
            };
            if let Some((body, _)) = document.bodies.iter().find(|(_, body)| bent(body)) {
                let found =
                    format!("a start of a joint beside that of the coordinates of \"{body}\"");
                let expected = "one of them: joints are started with undeformed bodies";
                self.fault(Finding::new(&pointer, found, expected).of_key());
            }
            self.start(&pointer, (name, joint), start);
        }
    }

    /// Checks that a start gives values, for motions that the joint allows and no drive prescribes.
    fn start(&mut self, pointer: &str, (name, joint): (&str, &Joint), start: &JointStart) {
        if start.turn.is_none() && start.slide.is_none() {
            let expected = "\"turn\" or \"slide\"";
            self.fault(Finding::new(pointer, "a start without motion", expected).of_key());
        }
        if let Some(turn) = &start.turn {
            let turned = join(pointer, "turn");
            let twice = [
                (
                    "degrees",
                    "angle",
                    turn.degrees.is_some() && turn.angle.is_some(),
                ),
                (
                    "degrees_per_second",
                    "rate",
                    turn.degrees_per_second.is_some() && turn.rate.is_some(),
                ),
            ];
            for (key, other, _) in twice.into_iter().filter(|(.., both)| *both) {
                let found = format!("\"{key}\" beside \"{other}\"");
                self.fault(Finding::new(join(&turned, key), found, "one of them").of_key());
            }
        }
        let motions = [
            (DegreeOfFreedom::Rotation, "turn", "\"angle\" or \"rate\""),
            (
                DegreeOfFreedom::Translation,
                "slide",
                "\"displacement\" or \"rate\"",
            ),
        ];
        for (dof, key, wanted) in motions {
            let Some(given) = start.of(dof) else {
                continue;
            };
            let pointer = join(pointer, key);
            let drive = self.document.drives.iter().find(|(drive_name, drive)| {
                let driven = match dof {
                    DegreeOfFreedom::Rotation => drive.turn.is_some(),
                    DegreeOfFreedom::Translation => drive.slide.is_some(),
                };
                drive.joint == name && driven && self.document.is_on(drive_name, 0)
            });
            if !joint.kind().degrees_of_freedom().contains(&dof) {
                let found = format!("\"{key}\" of a joint that is {}", joint.kind().name());
                let expected = "a motion about or along its axis that the joint allows";
                self.fault(Finding::new(pointer, found, expected).of_key());
            } else if let Some((drive, _)) = drive {
                let found = format!("\"{key}\", which the drive \"{drive}\" prescribes");
                let expected = "a motion that no drive prescribes";
                self.fault(Finding::new(pointer, found, expected).of_key());
            } else if given.iter().all(Option::is_none) {
                let found = format!("a \"{key}\" without start");
                self.fault(Finding::new(pointer, found, wanted).of_key());
            }
        }
    }

    /// Checks a pair of points, one on each body.
    pub(super) fn pair(&mut self, at: &str, between: &[String; 2], pair: &PointPair) {
        self.point(&join(at, "a"), &between[0], &pair.a);
        self.point(&join(at, "b"), &between[1], &pair.b);
    }

    /// Checks that a joint of a point mass needs neither extent nor rotation.
    fn point_masses(&mut self, pointer: &str, joint: &Joint) {
        for (k, name) in joint.between().iter().enumerate() {
            let body = self.document.bodies.get(name);
            let is_point = body.is_some_and(|body| matches!(body.shape, Some(Shape::Point)));
            if is_point && !holds_points(joint.kind()) {
                let found = format!("\"{name}\", which is a point mass");
                let expected = "a body with extent, or a joint that is spherical or rod";
                let place = join(&join(pointer, "between"), k);
                self.fault(Finding::new(place, found, expected));
            }
        }
    }

    pub(super) fn drives(&mut self) {
        let document = self.document;
        self.names("drives", document.drives.keys());
        for (name, drive) in &document.drives {
            let pointer = join("/drives", name);
            if drive.turn.is_none() && drive.slide.is_none() {
                let expected = "\"turn\" or \"slide\"";
                self.fault(Finding::new(&pointer, "a drive without motion", expected).of_key());
            }
            if let Some(turn) = &drive.turn {
                self.driven(&pointer, &drive.joint, DegreeOfFreedom::Rotation);
                self.motion(&join(&pointer, "turn"), turn.parts());
            }
            if let Some(slide) = &drive.slide {
                self.driven(&pointer, &drive.joint, DegreeOfFreedom::Translation);
                self.motion(&join(&pointer, "slide"), slide.parts());
            }
            let earlier = document
                .drives
                .iter()
                .take_while(|(other, _)| *other != name);
            let twice = earlier.into_iter().find(|(earlier, other)| {
                let both = |a: bool, b: bool| a && b;
                let mut phases = 0..=document.events.len();
                let together =
                    |phase| document.is_on(earlier, phase) && document.is_on(name, phase);
                other.joint == drive.joint
                    && phases.any(together)
                    && (both(other.turn.is_some(), drive.turn.is_some())
                        || both(other.slide.is_some(), drive.slide.is_some()))
            });
            if let Some((other, _)) = twice {
                let found = format!("\"{}\", which \"{other}\" drives", drive.joint);
                let expected = "a joint that no other drive moves";
                self.fault(Finding::new(join(&pointer, "joint"), found, expected));
            }
        }
    }

    /// Checks that the joint of a drive or a coupling has the degree of freedom that it moves.
    pub(super) fn driven(&mut self, pointer: &str, joint: &str, dof: DegreeOfFreedom) {
        self.moving_joint(&join(pointer, "joint"), joint, dof);
    }

    /// Checks the name of a joint that has this degree of freedom.
    pub(super) fn moving_joint(&mut self, pointer: &str, joint: &str, dof: DegreeOfFreedom) {
        let kinds = [
            JointKind::Revolute,
            JointKind::Planar,
            JointKind::Prismatic,
            JointKind::Cylindrical,
        ];
        let kinds: Vec<JointKind> = kinds
            .into_iter()
            .filter(|kind| kind.degrees_of_freedom().contains(&dof))
            .collect();
        self.joint_of_kind(pointer, joint, &kinds);
    }

    /// Checks a motion in time.
    pub(super) fn motion(&mut self, pointer: &str, course: TimeFunction) {
        match course {
            TimeFunction::Polynomial([]) => {
                let finding = Finding::new(
                    join(pointer, "polynomial"),
                    "no coefficient",
                    "at least one, that of 1",
                );
                self.fault(finding);
            }
            TimeFunction::Table(times, values, _) => self.table(pointer, times, values),
            TimeFunction::SCurve([from, to, ..]) if from.value == to.value => {
                let found = format!("a way from {} to {0}", to.value);
                let place = join(&join(pointer, "s_curve"), "to");
                let expected = "another value than that before the way";
                self.fault(Finding::new(place, found, expected));
            }
            TimeFunction::Rate(_)
            | TimeFunction::Polynomial(_)
            | TimeFunction::Harmonic(_)
            | TimeFunction::SCurve(_) => {}
        }
    }
}
