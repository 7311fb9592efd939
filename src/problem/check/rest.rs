//! Machines at rest: what has no meaning without time.

use super::Checker;
use crate::finding::Finding;
use crate::pointer::join;
use crate::schema::Analysis;
use crate::schema::flexible::Start;
use crate::schema::functions::OfMotion;
use crate::schema::windows::Over;

impl Checker<'_> {
    /// Checks that the analysis fits the scene.
    pub(super) fn analysis(&mut self) {
        let document = self.document;
        if document.analysis == Some(Analysis::Motion) && !document.structures.is_empty() {
            let found = "a motion of structures, which do not move";
            let expected = "\"rest\", or \"bodies\" with \"elements\"";
            self.fault(Finding::new("/analysis", found, expected));
        }
        self.modes();
        if !document.is_rest() {
            return;
        }
        let rest = "beside \"analysis\": \"rest\"";
        let still = "none, as nothing moves";
        let given = document.simulation.as_ref();
        if given.is_some_and(|own| !own.is_of_rest()) && !self.damage.touches("simulation") {
            let found = format!("\"simulation\" {rest}");
            let hint =
                "\"analysis\": \"motion\" simulates; leave \"simulation\" out to look at the rest";
            let finding = Finding::new("/simulation", found, "one of them");
            self.fault(finding.of_key().hint(Some(hint.to_owned())));
        }
        if document.start != Start::Given {
            let found = format!("\"start\" {rest}");
            self.fault(Finding::new("/start", found, "one of them").of_key());
        }
        if document.initial_velocity.is_some() {
            let found = format!("\"initial_velocity\" {rest}");
            self.fault(Finding::new("/initial_velocity", found, still).of_key());
        }
        let moving = document
            .bodies
            .iter()
            .filter(|(_, body)| body.velocity.is_some());
        for (name, _) in moving {
            let pointer = join(&join("/bodies", name), "velocity");
            let found = format!("a velocity {rest}");
            self.fault(Finding::new(pointer, found, still).of_key());
        }
        for (name, joint) in &document.joints {
            let rate = joint.start().is_some_and(|start| {
                let turn = start.turn.as_ref().and_then(|turn| turn.rate());
                let slide = start.slide.as_ref().and_then(|slide| slide.rate);
                turn.is_some() || slide.is_some()
            });
            if rate {
                let pointer = join(&join(&join("/joints", name), joint.kind().name()), "start");
                let found = format!("a rate {rest}");
                self.fault(Finding::new(pointer, found, still).of_key());
            }
        }
    }

    /// Checks the modes that are told, and steady rotation.
    fn modes(&mut self) {
        let document = self.document;
        let told = document.told_modes().is_some();
        if document.analysis == Some(Analysis::Modes) && !document.structures.is_empty() {
            let expected =
                "\"rest\" or none: \"frequency\" among \"functions\" asks for modes of structures";
            let finding = Finding::new("/analysis", "\"modes\" of structures", expected);
            self.fault(finding);
        } else if !told && !self.damage.touches("analysis") {
            let given = [
                ("modes", document.modes.is_some()),
                ("turning", document.turning.is_some()),
            ];
            for (key, _) in given.into_iter().filter(|(_, given)| *given) {
                let found = format!("\"{key}\" without \"analysis\": \"modes\"");
                let finding = Finding::new(join("", key), found, "both");
                self.fault(finding.of_key());
            }
        }
        let speeds = document.modes.iter().flat_map(|own| &own.speeds);
        for (k, &speed) in speeds.enumerate() {
            if speed < 0.0 {
                let expected = "a speed of rotation, not below 0: the axis says its sense";
                let pointer = join("/modes/speeds", k);
                self.fault(Finding::new(pointer, speed.to_string(), expected));
            }
        }
        let Some(turning) = &document.turning else {
            let speeds = document
                .modes
                .as_ref()
                .is_some_and(|own| !own.speeds.is_empty());
            if speeds && !self.damage.touches("turning") {
                let expected = "\"turning\", the axis of the rotation";
                let found = "speeds of a machine that does not turn";
                self.fault(Finding::new("/modes/speeds", found, expected).of_key());
            }
            return;
        };
        self.nonzero("/turning/axis", turning.axis);
    }

    /// Checks the place of a vibration about the state at an instant.
    pub(super) fn vibration(&mut self, pointer: &str) {
        if self.document.is_rest() {
            let found = "a vibration at an instant, of a machine at rest";
            let expected = "the function \"frequency\" or \"damping_ratio\" itself, without \"final\" or \"ks\"";
            self.fault(Finding::new(pointer, found, expected).of_key());
        } else if pointer.starts_with("/simulation/until") {
            let found = "a vibration as an event";
            let expected = "a quantity of the motion";
            self.fault(Finding::new(pointer, found, expected).of_key());
        }
    }

    /// Checks that a function needs no time.
    pub(super) fn at_rest(&mut self, pointer: &str, function: &OfMotion) {
        let windowed = |over: &Over| match over {
            Over::Whole(_) => false,
            Over::Within(own) => own.during.is_some(),
        };
        let (of_time, of_state) = match function {
            OfMotion::Ks(own) => (own.during.is_some(), true),
            OfMotion::InducedExponential(own) => (own.during.is_some(), true),
            OfMotion::Final(over) => (windowed(over), true),
            OfMotion::Clearance(_) => (false, true),
            OfMotion::Mass
            | OfMotion::Frequency(_)
            | OfMotion::LowestFrequency(_)
            | OfMotion::DampingRatio(_)
            | OfMotion::CriticalSpeed(_) => (false, false),
            OfMotion::Integral(_)
            | OfMotion::Mean(_)
            | OfMotion::MeanSquare(_)
            | OfMotion::MeanAbsolute(_)
            | OfMotion::FatigueDamage(_)
            | OfMotion::Value(_)
            | OfMotion::Misfit(_)
            | OfMotion::Duration => (true, false),
        };
        if of_state && self.document.turning.is_some() {
            let found = "a function of a state, of a machine that turns";
            let expected =
                "frequencies, damping ratios, critical speeds, \"mass\" or expressions of them";
            let hint = "a motion with \"start\": \"equilibrium\" has the state of steady rotation";
            let finding = Finding::new(pointer, found, expected).of_key();
            self.fault(finding.hint(Some(hint.to_owned())));
        }
        if of_time {
            let found = "a function of time, of a machine at rest";
            let expected = "\"final\", the value at rest; \"ks\" over points; \"mass\"; \"frequency\"; or expressions of them";
            self.fault(Finding::new(pointer, found, expected).of_key());
        }
    }
}
