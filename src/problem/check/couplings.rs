//! Couplings.

use super::Checker;
use crate::cams::dof as motion_dof;
use crate::couplings::{carrier, moved, observed, ordered, turns, way};
use crate::finding::Finding;
use crate::model::{DegreeOfFreedom, JointKind};
use crate::placement::GROUND;
use crate::pointer::{advice, join};
use crate::quantity::Quantity;
use crate::schema::couplings::{Cam, Coupling, JointMotion, OfCoupling, Relation, Wheels};
use crate::schema::joints::Joint;
use crate::schema::mechanics::Location;

/// Joints on the way from a carrier to a wheel, for messages.
const WHEEL: &str = "a body that revolute or cylindrical joints hold on its carrier";
/// The same of a rack.
const RACK: &str = "a body that a prismatic or cylindrical joint holds on its carrier";

impl Checker<'_> {
    pub(super) fn couplings(&mut self) {
        let document = self.document;
        self.names("couplings", document.couplings.keys());
        for (name, coupling) in &document.couplings {
            let pointer = join(&join("/couplings", name), coupling.key());
            self.coupling(&pointer, coupling);
        }
    }

    fn coupling(&mut self, pointer: &str, coupling: &Coupling) {
        if let Some(wheels) = coupling.wheels() {
            self.wheels(pointer, &wheels, !matches!(coupling, Coupling::Bevel(_)));
        }
        match coupling {
            Coupling::Gear(_) | Coupling::Belt(_) => {}
            Coupling::Bevel(own) => self.meeting(&join(pointer, "at"), &own.at),
            Coupling::RackAndPinion(own) => {
                self.meeting(&join(pointer, "at"), &own.at);
                if let Some(radius) = &own.radius {
                    self.positive(&join(pointer, "radius"), radius);
                }
                let ends = [("rack", &own.rack), ("pinion", &own.pinion)];
                let known = ends.map(|(key, body)| self.moving_body(&join(pointer, key), body));
                if !known.contains(&false)
                    && let Some(carrier) =
                        self.carrier(pointer, own.carrier.as_ref(), ends.map(|own| own.1))
                {
                    self.held_on(&join(pointer, "pinion"), (&carrier, &own.pinion), false);
                    self.held_on(&join(pointer, "rack"), (&carrier, &own.rack), true);
                }
            }
            Coupling::Screw(own) => {
                self.loaded_joint(pointer, &own.joint, &[JointKind::Cylindrical]);
            }
            Coupling::Relation(own) => self.relation(pointer, own),
            Coupling::Cam(own) => self.cam(pointer, own),
        }
    }

    fn cam(&mut self, pointer: &str, own: &Cam) {
        for (key, of) in [("cam", &own.cam), ("follower", &own.follower)] {
            let place = join(pointer, key);
            match of {
                JointMotion::Turn(joint) => {
                    self.moving_joint(&join(&place, "turn"), joint, DegreeOfFreedom::Rotation)
                }
                JointMotion::Slide(joint) => {
                    self.moving_joint(&join(&place, "slide"), joint, DegreeOfFreedom::Translation)
                }
            }
        }
        let (name, dof) = (own.follower.joint(), motion_dof(&own.follower));
        let start = self
            .document
            .joints
            .get(name)
            .and_then(|joint| joint.start());
        let driven = self.document.drives.values().any(|drive| {
            let moves = match dof {
                DegreeOfFreedom::Rotation => drive.turn.is_some(),
                DegreeOfFreedom::Translation => drive.slide.is_some(),
            };
            drive.joint == *name && moves
        });
        let found = match start.and_then(|start| start.of(dof)) {
            Some(_) => Some("a follower with a start of its own"),
            None if driven => Some("a follower that a drive moves"),
            None => None,
        };
        if let Some(found) = found {
            let expected = "a start or drive of the cam: it tells where the follower is, and not the other way round";
            self.fault(Finding::new(join(pointer, "follower"), found, expected));
        }
        if own.cam == own.follower {
            let found = "the motion on which the profile depends";
            self.fault(Finding::new(join(pointer, "follower"), found, "another motion").of_key());
        }
        self.rising(
            &join(pointer, "profile"),
            ("at", &own.profile.at),
            ("values", &own.profile.values),
        );
    }

    fn meeting(&mut self, pointer: &str, at: &Location) {
        if let Location::Named(text) = at {
            self.location(pointer, text);
        }
    }

    fn positive(&mut self, pointer: &str, own: &Quantity) {
        if own.value.is_nan() || own.value <= 0.0 {
            let found = format!("{}", own.value);
            self.fault(Finding::new(pointer, found, "a number above 0"));
        }
    }

    /// Whether a name is that of a body that is not ground.
    fn moving_body(&mut self, pointer: &str, name: &str) -> bool {
        if name == GROUND {
            let found = "\"ground\", which does not move";
            self.fault(Finding::new(pointer, found, "the name of a body"));
            return false;
        }
        self.body(pointer, name).is_some()
    }

    /// Checks the bodies and the sizes of wheels.
    fn wheels(&mut self, pointer: &str, wheels: &Wheels, needs_size: bool) {
        let sizes = [
            ("teeth", wheels.teeth.is_some()),
            ("radii", wheels.radii.is_some()),
            ("ratio", wheels.ratio.is_some()),
        ];
        let mut given = sizes.iter().filter(|(_, given)| *given);
        match (given.next(), given.next()) {
            (Some((first, _)), Some((second, _))) => {
                let found = format!("\"{second}\" beside \"{first}\"");
                let place = join(pointer, second);
                self.fault(Finding::new(place, found, "one of them").of_key());
            }
            (None, None) if needs_size => {
                let expected = "\"teeth\", \"radii\" or \"ratio\"";
                self.fault(Finding::new(pointer, "wheels without a size", expected).of_key());
            }
            _ => {}
        }
        for (key, both) in [("teeth", &wheels.teeth), ("radii", &wheels.radii)] {
            for (k, own) in both.iter().flatten().enumerate() {
                self.positive(&join(&join(pointer, key), k), own);
            }
        }
        if let Some(ratio) = &wheels.ratio {
            self.positive(&join(pointer, "ratio"), ratio);
        }
        let bodies = join(pointer, wheels.key);
        let places = [0, 1].map(|k| join(&bodies, k));
        let [a, b] = wheels.bodies;
        let known =
            [(&places[0], a), (&places[1], b)].map(|(place, body)| self.moving_body(place, body));
        if known.contains(&false) {
            return;
        }
        if a == b {
            let found = format!("\"{b}\" twice");
            self.fault(Finding::new(&places[1], found, "another body"));
            return;
        }
        if let Some(carrier) = self.carrier(pointer, wheels.carrier, [a, b]) {
            for (place, body) in places.iter().zip([a, b]) {
                self.held_on(place, (&carrier, body), false);
            }
        }
    }

    /// The carrier of two bodies; a fault if it is not known.
    fn carrier(
        &mut self,
        pointer: &str,
        given: Option<&String>,
        [a, b]: [&String; 2],
    ) -> Option<String> {
        if let Some(name) = given.filter(|name| *name != GROUND) {
            self.body(&join(pointer, "carrier"), name)?;
        }
        if self.damage.touches("joints") {
            return None;
        }
        let found = carrier(self.document, given, [a, b]);
        if found.is_none() {
            let found = format!("no \"carrier\" of \"{a}\" and \"{b}\"");
            let expected = "the body that holds both, as not just one is joined to each";
            self.fault(Finding::new(pointer, found, expected).of_key());
        }
        found.map(str::to_owned)
    }

    /// Checks that joints hold a wheel or a rack on its carrier.
    fn held_on(&mut self, pointer: &str, (carrier, body): (&str, &str), is_rack: bool) {
        let expected = if is_rack { RACK } else { WHEEL };
        let joints = &self.document.joints;
        let way = way(self.document, carrier, body).unwrap_or_default();
        let passed = || way.iter().map(|passed| &joints[passed.joint]);
        let moves = |joint: &Joint| match is_rack {
            true => matches!(joint, Joint::Prismatic(_) | Joint::Cylindrical(_)),
            false => turns(joint),
        };
        let bars = |joint: &&Joint| !moves(joint) && !matches!(joint, Joint::Weld(_));
        let moving = passed().filter(|joint| moves(joint)).count();
        let found = match passed().find(bars) {
            _ if way.is_empty() => {
                let kept = match self.document.events.is_empty() {
                    true => "",
                    false => " in all phases of the motion",
                };
                format!("\"{body}\", which no joints join to \"{carrier}\"{kept}")
            }
            Some(joint) => {
                let [a, b] = ordered(joint);
                let kind = joint.kind().name();
                format!("\"{body}\", which is held by a {kind} joint of \"{a}\" and \"{b}\"")
            }
            None if moving == 0 => format!("\"{body}\", which is welded to \"{carrier}\""),
            None if is_rack && moving > 1 => {
                format!("\"{body}\", which {moving} joints move on \"{carrier}\"")
            }
            None => return,
        };
        self.fault(Finding::new(pointer, found, expected));
    }

    fn relation(&mut self, pointer: &str, relation: &Relation) {
        let terms = join(pointer, "terms");
        for (k, term) in relation.terms.iter().enumerate() {
            let place = join(&terms, k);
            let (dof, factor, key) = match (&term.turn, &term.slide) {
                (Some(turn), None) => (DegreeOfFreedom::Rotation, turn, "turn"),
                (None, Some(slide)) => (DegreeOfFreedom::Translation, slide, "slide"),
                (None, None) => {
                    let expected = "\"turn\" or \"slide\"";
                    self.fault(Finding::new(place, "a term without factor", expected).of_key());
                    continue;
                }
                (Some(_), Some(_)) => {
                    let found = "\"slide\" beside \"turn\"";
                    let expected = "one of them; a joint may have two terms";
                    self.fault(Finding::new(join(&place, "slide"), found, expected).of_key());
                    continue;
                }
            };
            self.driven(&place, &term.joint, dof);
            let earlier = relation.terms[..k].iter().any(|other| {
                let both = |a: &Option<Quantity>, b: &Option<Quantity>| a.is_some() == b.is_some();
                other.joint == term.joint && both(&other.turn, &term.turn)
            });
            if earlier {
                let found = format!("\"{}\" with \"{key}\" a second time", term.joint);
                let expected = "each motion once";
                self.fault(Finding::new(join(&place, "joint"), found, expected));
            }
            if factor.value == 0.0 && k + 1 == relation.terms.len() {
                let expected = "a factor of the last term that is not zero in any design";
                let hint = "write a term last whose factor is not zero";
                let finding = Finding::new(join(&place, key), "0", expected);
                self.fault(finding.hint(Some(hint.to_owned())));
            }
        }
    }

    /// Checks that a function observes a motion of a coupling.
    pub(super) fn coupling_reaction(&mut self, pointer: &str, of: &OfCoupling) {
        let couplings = &self.document.couplings;
        let Some(coupling) = couplings.get(&of.coupling) else {
            if !self.damage.holds("couplings", &of.coupling) {
                let hint = advice(
                    &of.coupling,
                    "couplings",
                    couplings.keys().map(String::as_str),
                );
                let found = format!("\"{}\"", of.coupling);
                let place = join(pointer, "coupling");
                self.fault(Finding::new(place, found, "the name of a coupling").hint(hint));
            }
            return;
        };
        if observed(coupling, of).is_none() {
            let named = |own: &String| moved(coupling).iter().any(|(name, _)| *name == own);
            let mut names: Vec<&str> = moved(coupling).iter().map(|own| own.0.as_str()).collect();
            names.dedup();
            let names = names.join(", ");
            let (key, found) = match &of.on {
                Some(on) if !named(on) => ("on", format!("\"{on}\"")),
                _ => ("motion", "a motion that is not coupled".to_owned()),
            };
            let expected = format!("a motion of the coupling, which is on {names}");
            self.fault(Finding::new(join(pointer, key), found, expected));
        }
    }
}
