//! Events that change the machine.

use super::Checker;
use crate::finding::Finding;
use crate::pointer::{advice, join};
use crate::schema::couplings::Coupling;
use crate::schema::events::{Event, When};
use crate::schema::loads::Load;

impl Checker<'_> {
    pub(super) fn events(&mut self) {
        let document = self.document;
        if document.events.is_empty() || self.damage.touches("events") {
            return;
        }
        let whole = |found: &str, expected: &str| Finding::new("/events", found, expected).of_key();
        if self.is_static() || document.is_rest() {
            self.fault(whole(
                "events of a machine at rest",
                "\"analysis\": \"motion\", in which something happens",
            ));
            return;
        }
        for (k, (name, event)) in document.events.iter().enumerate() {
            let pointer = join("/events", name);
            let fits = |c: char| c.is_alphanumeric() || "-_ .".contains(c);
            if name.trim().is_empty() || !name.chars().all(fits) {
                let expected = "a name for a directory, of letters, digits, spaces, dots, - and _";
                self.fault(Finding::new(&pointer, format!("\"{name}\""), expected).of_key());
            }
            self.when(&pointer, k, event);
            for (key, names) in [("off", &event.off), ("on", &event.on)] {
                for (i, own) in names.iter().enumerate() {
                    let pointer = join(&join(&pointer, key), i);
                    self.switched(&pointer, own, (k, event), key == "on");
                }
            }
        }
    }

    fn when(&mut self, pointer: &str, k: usize, event: &Event) {
        let pointer = join(pointer, "when");
        match &event.when {
            When::Reaches(until) => {
                self.instant(&join(&pointer, "measure"), &until.measure);
                self.level(&join(&pointer, "reaches"), &until.measure, &until.reaches);
            }
            When::At(own) => {
                let pointer = join(&pointer, "time");
                let time = own.time.value;
                let mut before = self.document.events.values().take(k).rev();
                let known = before.find_map(|event| match &event.when {
                    When::At(own) => Some(own.time.value),
                    When::Reaches(_) => None,
                });
                if known.is_some_and(|known| known >= time) {
                    let expected = "a time after that of the event before it";
                    self.fault(Finding::new(&pointer, format!("{time} s"), expected));
                }
                let simulation = self.document.simulation.as_ref();
                if let Some(all) = simulation.filter(|_| !self.damage.touches("simulation"))
                    && all.duration.value <= time
                {
                    let expected = format!("a time before the end at {} s", all.duration.value);
                    self.fault(Finding::new(&pointer, format!("{time} s"), expected));
                }
            }
        }
    }

    /// Checks a name of what goes off or on.
    fn switched(&mut self, pointer: &str, name: &str, (k, event): (usize, &Event), on: bool) {
        let document = self.document;
        let joint = document.joints.get(name);
        let load = document.loads.contains_key(name);
        let drive = document.drives.contains_key(name);
        let mut fault = |found: String, expected: &str| {
            self.findings.push(Finding::new(pointer, found, expected));
        };
        let said = format!("\"{name}\"");
        match [joint.is_some(), load, drive]
            .iter()
            .filter(|own| **own)
            .count()
        {
            0 => {
                let sections = ["joints", "loads", "drives"];
                if sections.iter().any(|own| self.damage.holds(own, name)) {
                    return;
                }
                let all = document.joints.keys().chain(document.loads.keys());
                let all = all.chain(document.drives.keys()).map(String::as_str);
                let hint = advice(name, "joints, loads and drives", all);
                let expected = "the name of a joint, load or drive";
                let finding = Finding::new(pointer, said, expected).hint(hint);
                self.findings.push(finding);
                return;
            }
            1 => {}
            _ => {
                let expected = "a name that only one joint, load or drive has";
                fault(format!("{said}, which has several meanings"), expected);
                return;
            }
        }
        let other = if on { &event.off } else { &event.on };
        let again =
            [&event.off, &event.on].map(|all| all.iter().filter(|own| *own == name).count());
        if other.iter().any(|own| own == name) || again.iter().any(|count| *count > 1) {
            fault(format!("{said} twice in one event"), "each name once");
            return;
        }
        if document.is_on(name, k) == on {
            let (found, expected) = match on {
                true => ("is on already", "what is off before this event"),
                false => ("is off already", "what is on before this event"),
            };
            fault(format!("{said}, which {found}"), expected);
        }
        if let Some(own) = document.drives.get(name)
            && on
            && !document.is_on(&own.joint, k + 1)
        {
            let expected = "a drive of a joint that is closed then";
            fault(format!("the drive {said} of an open joint"), expected);
        }
        if let Some(joint) = joint {
            if on && joint.start().is_some() && !document.is_on(name, 0) {
                let expected = "a joint without a start: it is open then";
                fault(format!("the joint {said} with a start"), expected);
            }
            let couples = |coupling: &Coupling| match coupling {
                Coupling::Screw(own) => own.joint == name,
                Coupling::Cam(own) => [&own.cam, &own.follower]
                    .iter()
                    .any(|of| of.joint() == name),
                Coupling::Relation(own) => own.terms.iter().any(|term| term.joint == name),
                // Ways to wheels and racks leave out what events switch.
                _ => false,
            };
            let mut all = document.couplings.iter();
            if let Some((coupling, _)) = all.find(|(_, own)| couples(own)) {
                let found = format!("the joint {said}, which \"{coupling}\" couples");
                fault(found, "a joint through which no coupling goes");
            }
            let turns = |load: &Load| match load {
                Load::Controller(own) => {
                    own.joint.as_deref() == Some(name)
                        && (own.motor.as_ref()).is_some_and(|own| own.rotor_inertia.is_some())
                }
                _ => false,
            };
            let mut all = document.loads.iter();
            if let Some((motor, _)) = all.find(|(_, own)| turns(own)) {
                let found = format!("the joint {said}, which turns the rotor of \"{motor}\"");
                fault(found, "a joint that turns no rotor");
            }
        }
    }
}
