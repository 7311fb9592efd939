//! Windows of time, combined and relative quantities.

use super::Checker;
use crate::finding::Finding;
use crate::model::JointKind;
use crate::placement::GROUND;
use crate::pointer::{advice, join};
use crate::quantity::Quantity;
use crate::schema::combined::PowerOf;
use crate::schema::functions::{Instant, OfMotion};
use crate::schema::mechanics::Point;
use crate::schema::windows::{During, Edge, Over, Reach};

impl Checker<'_> {
    /// Checks a reduction of a quantity, with its window.
    pub(super) fn reduction(&mut self, pointer: &str, function: &OfMotion) {
        let inner = |key: &str| format!("{pointer}/{key}");
        match function {
            OfMotion::Ks(own) => {
                self.within(&inner("ks"), &own.of, own.during.as_ref());
            }
            OfMotion::InducedExponential(own) => {
                self.within(&inner("induced_exponential"), &own.of, own.during.as_ref());
            }
            OfMotion::Integral(over) => self.over(&inner("integral"), over),
            OfMotion::Final(over) => self.over(&inner("final"), over),
            OfMotion::Mean(over) => self.over(&inner("mean"), over),
            OfMotion::MeanSquare(over) => self.over(&inner("mean_square"), over),
            OfMotion::MeanAbsolute(own) => {
                self.within(&inner("mean_absolute"), &own.of, own.during.as_ref());
            }
            OfMotion::FatigueDamage(own) => {
                self.within(&inner("fatigue_damage"), &own.of, own.during.as_ref());
            }
            OfMotion::Value(own) => {
                let pointer = inner("value");
                self.instant(&join(&pointer, "of"), &own.of);
                self.edge(&join(&pointer, "at"), &own.at);
            }
            OfMotion::Misfit(own) => {
                if !own.numbers.is_empty() {
                    let expected = "\"series\" over time, as a motion has";
                    let finding = Finding::new(inner("misfit/numbers"), "numbers", expected);
                    self.fault(finding.of_key());
                }
                let pointer = inner("misfit/series");
                if own.series.is_empty() {
                    let expected = "at least one series of measured values";
                    self.fault(Finding::new(inner("misfit"), "none", expected));
                }
                for (name, series) in &own.series {
                    self.instant(&join(&join(&pointer, name), "of"), &series.of);
                }
            }
            OfMotion::Clearance(_)
            | OfMotion::Duration
            | OfMotion::Mass
            | OfMotion::Frequency(_)
            | OfMotion::LowestFrequency(_)
            | OfMotion::DampingRatio(_)
            | OfMotion::CriticalSpeed(_) => {}
        }
    }

    fn over(&mut self, pointer: &str, over: &Over) {
        match over {
            Over::Whole(instant) => self.instant(pointer, instant),
            Over::Within(own) => self.within(pointer, &own.of, own.during.as_ref()),
        }
    }

    fn within(&mut self, pointer: &str, of: &Instant, during: Option<&During>) {
        self.instant(&join(pointer, "of"), of);
        let Some(during) = during else {
            return;
        };
        let pointer = join(pointer, "during");
        let time = |edge: &Edge| match edge {
            Edge::Time(time) => Some(time.value),
            Edge::When(_) | Edge::Event(_) => None,
        };
        let (from, to) = match during {
            During::Times(ends) => {
                for (k, end) in ends.iter().enumerate() {
                    self.time(&join(&pointer, k), end.value);
                }
                (Some(ends[0].value), Some(ends[1].value))
            }
            During::Between(own) => {
                for (key, edge) in [("from", &own.from), ("to", &own.to)] {
                    if let Some(edge) = edge {
                        self.edge(&join(&pointer, key), edge);
                    }
                }
                if own.from.is_none() && own.to.is_none() {
                    let expected = "\"from\", \"to\" or both";
                    self.fault(Finding::new(&pointer, "no end", expected).of_key());
                }
                let index = |edge: &Option<Edge>| {
                    let event = edge.as_ref()?.event()?;
                    self.document.events.get_index_of(event)
                };
                if let (Some(from), Some(to)) = (index(&own.from), index(&own.to))
                    && from >= to
                {
                    let expected = "an event that comes later than that of \"from\"";
                    let found = "an event that does not";
                    self.fault(Finding::new(join(&pointer, "to"), found, expected));
                }
                let ends = [&own.from, &own.to].map(|edge| edge.as_ref().and_then(time));
                (ends[0], ends[1])
            }
        };
        if let (Some(from), Some(to)) = (from, to)
            && from >= to
        {
            let found = format!("a window from {from} to {to}");
            let expected = "one that ends after it starts";
            let hint = "the value at a time is {\"value\": {\"at\": …, \"of\": …}}";
            self.fault(Finding::new(&pointer, found, expected).hint(Some(hint.into())));
        }
    }

    fn edge(&mut self, pointer: &str, edge: &Edge) {
        match edge {
            Edge::Time(time) => self.time(pointer, time.value),
            Edge::When(reach) => self.reach(pointer, reach),
            Edge::Event(own) => self.event(&join(pointer, "event"), &own.event),
        }
    }

    /// Checks the name of an event.
    pub(super) fn event(&mut self, pointer: &str, name: &str) {
        let events = &self.document.events;
        if !events.contains_key(name) && !self.damage.touches("events") {
            let hint = advice(name, "events", events.keys().map(String::as_str));
            let found = format!("\"{name}\"");
            self.fault(Finding::new(pointer, found, "the name of an event").hint(hint));
        }
    }

    fn reach(&mut self, pointer: &str, reach: &Reach) {
        self.instant(&join(pointer, "when"), &reach.when);
        let found = match &reach.values()[..] {
            [] => "no value to reach",
            [(value, rises)] => {
                let key = match rises {
                    None => "reaches",
                    Some(true) => "rises_to",
                    Some(false) => "falls_to",
                };
                return self.level(&join(pointer, key), &reach.when, value);
            }
            _ => "more than one value to reach",
        };
        let expected = "one of \"reaches\", \"rises_to\" and \"falls_to\"";
        self.fault(Finding::new(pointer, found, expected).of_key());
    }

    /// Checks a value that a quantity reaches. What does not touch has a force of exactly zero, so no instant is the one at which
    /// it becomes zero.
    pub(super) fn level(&mut self, pointer: &str, of: &Instant, value: &Quantity) {
        let of_contact = matches!(
            of,
            Instant::ContactForce(_) | Instant::ContactFriction(_) | Instant::SlipPower(_)
        );
        if of_contact && value.value == 0.0 {
            let found = "0, as long as nothing touches";
            let expected = "a level above 0, such as a hundredth of the largest force";
            self.fault(Finding::new(pointer, found, expected));
        }
    }

    /// Checks a time of the motion.
    fn time(&mut self, pointer: &str, time: f64) {
        if time < 0.0 {
            let expected = "a time of the motion, from 0 on";
            self.fault(Finding::new(pointer, time.to_string(), expected));
        }
        let Some(simulation) = &self.document.simulation else {
            return;
        };
        let duration = simulation.duration.value;
        if simulation.until.is_none() && !self.damage.touches("simulation") && time > duration {
            let expected = format!("a time of the motion, which lasts {duration} s");
            self.fault(Finding::new(pointer, format!("{time} s"), expected));
        }
    }

    /// Checks a combined or relative quantity.
    pub(super) fn combination(&mut self, pointer: &str, instant: &Instant) {
        let inner = |key: &str| join(pointer, key);
        match instant {
            Instant::Sum(all) | Instant::Product(all) => {
                let key = match instant {
                    Instant::Sum(_) => "sum",
                    _ => "product",
                };
                for (k, own) in all.iter().enumerate() {
                    self.instant(&join(&inner(key), k), own);
                }
            }
            Instant::Difference(pair) | Instant::Quotient(pair) => {
                let key = match instant {
                    Instant::Difference(_) => "difference",
                    _ => "quotient",
                };
                for (k, own) in pair.iter().enumerate() {
                    self.instant(&join(&inner(key), k), own);
                }
            }
            Instant::Square(own) => self.instant(&inner("square"), own),
            Instant::Rate(own) => self.instant(&inner("rate"), own),
            Instant::Absolute(own) => self.instant(&format!("{pointer}/absolute/of"), &own.of),
            Instant::Jerk(component) => self.component(&inner("jerk"), component),
            Instant::SensorAcceleration(component) => {
                let pointer = inner("sensor_acceleration");
                self.component(&pointer, component);
                self.rigid(&join(&pointer, "body"), &component.body);
            }
            Instant::RelativePosition(of) | Instant::RelativeVelocity(of) => {
                let pointer = inner(match instant {
                    Instant::RelativePosition(_) => "relative_position",
                    _ => "relative_velocity",
                });
                self.moving(&pointer, &of.body, &of.point);
                self.eye(&pointer, (&of.body, &of.relative_to), &of.from);
                self.rigid(&join(&pointer, "relative_to"), &of.relative_to);
                self.direction(&join(&pointer, "direction"), &of.direction);
            }
            Instant::Distance(of) => {
                let pointer = inner("distance");
                self.moving(&pointer, &of.body, &of.point);
                self.eye(&pointer, (&of.body, &of.relative_to), &of.from);
            }
            Instant::AngleRate(angle) => self.angle(&inner("angle_rate"), &angle.joint),
            Instant::SlideRate(slide) => {
                let kinds = [JointKind::Prismatic, JointKind::Cylindrical];
                self.loaded_joint(&inner("slide_rate"), &slide.joint, &kinds);
            }
            Instant::Power(of) => self.power(&inner("power"), of),
            _ => unreachable!("a quantity of one body is no combination"),
        }
    }

    /// Checks the body and the point from which another is seen.
    fn eye(&mut self, pointer: &str, (body, other): (&str, &str), from: &Option<Point>) {
        let place = join(pointer, "relative_to");
        let known = other == GROUND || self.body(&place, other).is_some();
        if other == body {
            let expected = "another body, or \"ground\"";
            self.fault(Finding::new(place, format!("\"{other}\" itself"), expected));
        } else if let (true, Some(from)) = (known, from) {
            self.point(&join(pointer, "from"), other, from);
        }
    }

    /// Checks that a body whose axes are used is rigid.
    fn rigid(&mut self, pointer: &str, name: &str) {
        let body = self.document.bodies.get(name);
        if body.is_some_and(|body| body.is_flexible()) {
            let expected = "a rigid body, whose axes turn as one";
            self.fault(Finding::new(
                pointer,
                format!("\"{name}\", which is flexible"),
                expected,
            ));
        }
    }

    fn power(&mut self, pointer: &str, of: &PowerOf) {
        let (key, name, names): (_, _, Vec<&str>) = match of {
            PowerOf::Load(name) => {
                let loads = self.document.loads.keys();
                ("load", name, loads.map(String::as_str).collect())
            }
            PowerOf::Drive(name) => {
                let drives = self.document.drives.keys();
                ("drive", name, drives.map(String::as_str).collect())
            }
        };
        let section = format!("{key}s");
        if names.contains(&name.as_str()) || self.damage.holds(&section, name) {
            return;
        }
        let expected = match of {
            PowerOf::Load(_) => "the name of a load",
            PowerOf::Drive(_) => "the name of a drive",
        };
        let hint = match names.is_empty() {
            true => Some("there is none".to_owned()),
            false => advice(name, &format!("such {section}"), names),
        };
        let found = format!("\"{name}\"");
        self.fault(Finding::new(join(pointer, key), found, expected).hint(hint));
    }
}
