//! Functions, objective, constraints, and settings of solution and plot.

use super::Checker;
use crate::composing::references;
use crate::elements::has_all_nodes;
use crate::finding::Finding;
use crate::math::Vec3;
use crate::model::JointKind;
use crate::placement::GROUND;
use crate::pointer::{advice, join};
use crate::quantities::released;
use crate::quantity::values;
use crate::scene::GRAVITY;
use crate::schema::functions::{
    Clearance, Component, Function, Gate, Instant, OfMotion, Range, WhichFunction,
};
use crate::schema::mechanics::Point;
use crate::schema::{LinearSolver, Method};

/// A direction is horizontal up to this cosine with gravity.
const HORIZONTAL: f64 = 1e-9;

impl Checker<'_> {
    pub(super) fn study(&mut self) {
        let document = self.document;
        self.names("functions", document.functions.keys());
        self.names("variables", document.variables.keys());
        self.names("constraints", document.constraints.keys());
        self.problem_name();
        // With cases, values in these have names too, and all are checked with them.
        let checked = document.cases.is_empty();
        for (name, function) in &document.functions {
            if matches!(function, Function::OverCases(_))
                && checked
                && !self.damage.touches("cases")
            {
                let pointer = join(&join("/functions", name), "over_cases");
                let finding =
                    Finding::new(pointer, "a function over cases", "\"cases\" in the file");
                self.fault(finding.of_key());
            }
            match self.is_static() {
                true => self.static_function(&join("/functions", name), function),
                false => self.function(&join("/functions", name), function),
            }
        }
        for (pointer, of) in references(document).into_iter().filter(|_| checked) {
            if let WhichFunction::Named(name) = of {
                self.function_name(&pointer, name);
            }
        }
        for (name, constraint) in &document.constraints {
            let pointer = join("/constraints", name);
            match (constraint.lower, constraint.upper) {
                (None, None) => {
                    let expected = "\"lower\", \"upper\" or both";
                    self.fault(Finding::new(&pointer, "no bound", expected).of_key());
                }
                (Some(lower), Some(upper)) if lower > upper => {
                    let found = format!("the bounds {lower} and {upper}");
                    let expected = "a lower bound that is not above the upper one";
                    self.fault(Finding::new(join(&pointer, "upper"), found, expected));
                }
                _ => {}
            }
        }
        self.simulation();
        let optimiser = document.optimiser.as_ref();
        if let Some(floor) = optimiser.and_then(|optimiser| optimiser.unbounded_below)
            && floor >= 0.0
        {
            let expected = "a number below zero, far below any objective that makes sense";
            let pointer = "/optimiser/unbounded_below";
            self.fault(Finding::new(pointer, floor.to_string(), expected));
        }
        for (k, text) in document.plot.trace.iter().enumerate() {
            self.location(&join("/plot/trace", k), text);
        }
    }

    /// Checks steps, tolerance and method.
    fn simulation(&mut self) {
        let Some(simulation) = &self.document.simulation else {
            return;
        };
        // A faulty one has been replaced.
        if self.damage.touches("simulation") {
            return;
        }
        if simulation.is_of_rest() {
            return;
        }
        if let Some(until) = &simulation.until {
            self.instant("/simulation/until/measure", &until.measure);
            let pointer = "/simulation/until/reaches";
            self.level(pointer, &until.measure, &until.reaches);
        }
        if let (Some(_), Some(tolerance)) = (simulation.steps, simulation.tolerance) {
            let expected = "either \"steps\" or \"tolerance\"";
            let found = format!("the tolerance {tolerance} and a number of steps");
            self.fault(Finding::new("/simulation/tolerance", found, expected).of_key());
        }
        let (name, equal) = match &simulation.method {
            Some(Method::Bdf { .. }) => ("bdf", true),
            Some(Method::GeneralisedAlpha { .. }) => ("generalised_alpha", true),
            Some(Method::Dop853 | Method::Radau { .. }) | None => ("", false),
        };
        if equal && simulation.steps.is_none() {
            let found = format!("the method {name} without a number of steps");
            let expected = "\"steps\": this method has steps of equal size";
            let hint = "dop853 and radau choose their steps by a tolerance";
            self.fault(Finding::new("/simulation/method", found, expected).hint(Some(hint.into())));
        }
        let explicit = matches!(simulation.method, Some(Method::Dop853) | None);
        let shells = has_all_nodes(self.document);
        if explicit && shells {
            let (place, found) = match &simulation.method {
                Some(_) => (
                    "/simulation/method",
                    "the explicit method with finite elements",
                ),
                None => ("/simulation", "finite elements without a method"),
            };
            let expected =
                "\"method\" radau, bdf or generalised_alpha, as finite elements are stiff";
            self.fault(Finding::new(place, found, expected).of_key());
        }
        if let Some(LinearSolver::Krylov) = simulation.linear_solver {
            let fault = match (equal, shells) {
                (true, true) => None,
                (false, _) => Some((
                    "the Krylov solver without bdf or generalised_alpha",
                    "the method bdf or generalised_alpha",
                    "dop853 has no linear systems of steps, and the coupled stages of radau are solved directly",
                )),
                (true, false) => Some((
                    "the Krylov solver without a body of finite elements with all its nodes",
                    "a body with \"elements\" and no \"basis\"",
                    "the matrices of other bodies are small, and their factors cheap",
                )),
            };
            if let Some((found, expected, hint)) = fault {
                let finding = Finding::new("/simulation/linear_solver", found, expected);
                self.fault(finding.hint(Some(hint.into())));
            }
        }
        if let (true, Some(samples)) = (equal, simulation.samples) {
            let found = format!("{samples} samples with the method {name}");
            let expected = "none: this method is sampled at the ends of its steps";
            self.fault(Finding::new("/simulation/samples", found, expected).of_key());
        }
    }

    /// Checks the problem's name, which becomes the name of a directory.
    fn problem_name(&mut self) {
        let name = &self.document.name;
        let fits = |c: char| c.is_alphanumeric() || "-_ .".contains(c);
        if name.trim().is_empty() || name.starts_with('.') || !name.chars().all(fits) {
            let expected = "a name for a directory, of letters, digits, spaces, dots, - and _";
            self.fault(Finding::new("/name", format!("\"{name}\""), expected));
        }
    }

    pub(super) fn function_name(&mut self, pointer: &str, name: &str) {
        let functions = &self.document.functions;
        if !functions.contains_key(name) && !self.damage.holds("functions", name) {
            let hint = advice(name, "functions", functions.keys().map(String::as_str));
            let found = format!("\"{name}\"");
            self.fault(Finding::new(pointer, found, "the name of a function").hint(hint));
        }
    }

    fn function(&mut self, pointer: &str, function: &Function) {
        // Their names are checked where they are read.
        if let Function::Expression(_) | Function::OverCases(_) = function {
            return;
        }
        if let Function::EventTime(event) = function {
            self.event(&join(pointer, "event_time"), event);
        }
        let Some(function) = function.of_motion() else {
            let expected = "a function of a motion, or \"structures\" without a \"simulation\"";
            self.fault(Finding::new(pointer, "a function of structures", expected));
            return;
        };
        if self.document.is_rest() {
            self.at_rest(pointer, &function);
        }
        match function {
            OfMotion::Frequency(_) | OfMotion::LowestFrequency(_) | OfMotion::DampingRatio(_) => {
                if !self.document.is_rest() && !self.damage.touches("analysis") {
                    let found = "a natural frequency of a machine in motion";
                    let expected = "\"analysis\": \"rest\", about which the machine vibrates";
                    let hint = "\"final\" or \"value\" of \"frequency\" or \"damping_ratio\" is that at an instant of the motion";
                    let finding = Finding::new(pointer, found, expected).of_key();
                    self.fault(finding.hint(Some(hint.to_owned())));
                }
            }
            OfMotion::CriticalSpeed(_) => {
                if self.document.turning.is_none() && !self.damage.touches("turning") {
                    let found = "a critical speed of a machine that does not turn";
                    let expected = "\"turning\", with \"analysis\": \"modes\"";
                    self.fault(Finding::new(pointer, found, expected).of_key());
                }
            }
            OfMotion::Clearance(clearance) => {
                self.clearance(&format!("{pointer}/clearance"), clearance);
            }
            function => self.reduction(pointer, &function),
        }
    }

    fn clearance(&mut self, pointer: &str, clearance: &Clearance) {
        let (pointer, name) = (join(pointer, "release"), &clearance.release);
        let document = self.document;
        if released(document, name).is_some() || self.damage.holds("functions", name) {
            return;
        }
        let names = document.functions.keys().map(String::as_str);
        let mut ranges = names
            .filter(|name| released(document, name).is_some())
            .peekable();
        let hint = match ranges.peek() {
            None => Some("there is none".to_owned()),
            Some(_) => advice(name, "such functions", ranges),
        };
        let expected = "the name of a \"final\", \"ks\" or \"induced_exponential\" range function";
        self.fault(Finding::new(pointer, format!("\"{name}\""), expected).hint(hint));
    }

    pub(super) fn instant(&mut self, pointer: &str, instant: &Instant) {
        match instant {
            Instant::Position(component) => self.component(&join(pointer, "position"), component),
            Instant::Velocity(component) => self.component(&join(pointer, "velocity"), component),
            Instant::Acceleration(component) => {
                self.component(&join(pointer, "acceleration"), component);
            }
            Instant::Speed(moving) => {
                self.moving(&join(pointer, "speed"), &moving.body, &moving.point);
            }
            Instant::SpeedSquared(moving) => {
                let pointer = join(pointer, "speed_squared");
                self.moving(&pointer, &moving.body, &moving.point);
            }
            Instant::AngularVelocity(spinning) => {
                let pointer = join(pointer, "angular_velocity");
                self.moving(&pointer, &spinning.body, &None);
                self.direction(&join(&pointer, "direction"), &spinning.direction);
            }
            Instant::Momentum(momentum) => {
                let pointer = join(pointer, "momentum/direction");
                self.direction(&pointer, &momentum.direction);
            }
            Instant::AngularMomentum(momentum) => {
                let pointer = join(pointer, "angular_momentum/direction");
                self.direction(&pointer, &momentum.direction);
            }
            Instant::Energy(_) => {}
            Instant::Slide(slide) => {
                let kinds = [JointKind::Prismatic, JointKind::Cylindrical];
                self.loaded_joint(&join(pointer, "slide"), &slide.joint, &kinds);
            }
            Instant::JointForce(of) => self.reaction(&join(pointer, "joint_force"), of),
            Instant::JointMoment(of) => self.reaction(&join(pointer, "joint_moment"), of),
            Instant::CouplingReaction(of) => {
                self.coupling_reaction(&join(pointer, "coupling_reaction"), of);
            }
            Instant::SpringLength(of) => {
                self.spring(&join(pointer, "spring_length"), &of.load, false);
            }
            Instant::SpringForce(of) => {
                self.spring(&join(pointer, "spring_force"), &of.load, false);
            }
            Instant::SpringTorque(of) => {
                self.spring(&join(pointer, "spring_torque"), &of.load, true);
            }
            Instant::ContactForce(of) => {
                self.stop_of(&join(pointer, "contact_force"), &of.load, false);
            }
            Instant::ContactFriction(of) => {
                self.stop_of(&join(pointer, "contact_friction"), &of.load, true);
            }
            Instant::SlipPower(of) => {
                self.stop_of(&join(pointer, "slip_power"), &of.load, true);
            }
            Instant::Penetration(of) => {
                self.stop_of(&join(pointer, "penetration"), &of.load, false);
            }
            Instant::Effort(of) => self.controller_of(&join(pointer, "effort"), &of.load),
            Instant::TrackingError(of) => {
                self.controller_of(&join(pointer, "tracking_error"), &of.load);
            }
            Instant::Rotation(rotation) => {
                let pointer = join(pointer, "rotation");
                self.moving(&pointer, &rotation.body, &None);
                self.seen_from(&pointer, &rotation.body, rotation.relative_to.as_deref());
                self.direction(&join(&pointer, "axis"), &rotation.axis);
            }
            Instant::Angle(angle) => self.angle(&join(pointer, "angle"), &angle.joint),
            Instant::Range(range) => self.range(&join(pointer, "range"), range),
            Instant::ElasticDisplacement(of) => {
                let pointer = join(pointer, "elastic_displacement");
                if self.measured_flexible(&pointer, &of.body) {
                    self.point(&join(&pointer, "point"), &of.body, &of.point);
                }
                self.direction(&join(&pointer, "direction"), &of.direction);
            }
            Instant::Frequency(_) => self.vibration(&join(pointer, "frequency")),
            Instant::DampingRatio(_) => self.vibration(&join(pointer, "damping_ratio")),
            Instant::StrainEnergy(of) => {
                self.measured_flexible(&join(pointer, "strain_energy"), &of.body);
            }
            Instant::VonMises(of) => self.shell_stress(&join(pointer, "von_mises"), of),
            Instant::SectionForce(of) => {
                let pointer = join(pointer, "section_force");
                self.station(&pointer, (&of.body, of.beams.as_ref()), &of.station);
            }
            Instant::FibreStress(of) => {
                let pointer = join(pointer, "fibre_stress");
                self.station(&pointer, (&of.body, of.beams.as_ref()), &of.station);
                self.has_stress(&pointer, &of.body);
                self.fibre(&join(&pointer, "fibre"), of.fibre);
            }
            Instant::LargestSectionForce(of) => {
                let pointer = join(pointer, "largest_section_force");
                self.stations(&pointer, (&of.body, of.beams.as_ref()), &of.stations);
            }
            Instant::LargestFibreStress(of) => {
                let pointer = join(pointer, "largest_fibre_stress");
                self.stations(&pointer, (&of.body, of.beams.as_ref()), &of.stations);
                self.has_stress(&pointer, &of.body);
                self.fibres(&join(&pointer, "fibres"), of.fibres.as_deref());
            }
            Instant::Jerk(_)
            | Instant::SensorAcceleration(_)
            | Instant::RelativePosition(_)
            | Instant::RelativeVelocity(_)
            | Instant::Distance(_)
            | Instant::Power(_)
            | Instant::AngleRate(_)
            | Instant::SlideRate(_)
            | Instant::Sum(_)
            | Instant::Difference(_)
            | Instant::Product(_)
            | Instant::Quotient(_)
            | Instant::Square(_)
            | Instant::Absolute(_)
            | Instant::Rate(_) => self.combination(pointer, instant),
        }
    }

    /// Checks the joint at `pointer` whose angle is measured.
    pub(super) fn angle(&mut self, pointer: &str, joint: &str) {
        use JointKind::{Cylindrical, Planar, Revolute};
        self.loaded_joint(pointer, joint, &[Revolute, Planar, Cylindrical]);
    }

    /// Checks the body that a rotation is relative to.
    fn seen_from(&mut self, pointer: &str, body: &str, other: Option<&str>) {
        let Some(other) = other.filter(|other| *other != GROUND) else {
            return;
        };
        let place = join(pointer, "relative_to");
        if other == body {
            let expected = "another body, or \"ground\"";
            self.fault(Finding::new(place, format!("\"{other}\" itself"), expected));
        } else {
            self.body(&place, other);
        }
    }

    pub(super) fn component(&mut self, pointer: &str, component: &Component) {
        self.moving(pointer, &component.body, &component.point);
        self.direction(&join(pointer, "direction"), &component.direction);
    }

    /// Checks a moving body and a point of it.
    pub(super) fn moving(&mut self, pointer: &str, body: &str, point: &Option<Point>) {
        let place = join(pointer, "body");
        if body == GROUND {
            let expected = "the name of a body, as ground does not move";
            self.fault(Finding::new(place, "\"ground\"", expected));
        } else if self.body(&place, body).is_some()
            && let Some(point) = point
        {
            self.point(&join(pointer, "point"), body, point);
        }
    }

    fn range(&mut self, pointer: &str, range: &Range) {
        self.moving(pointer, &range.body, &range.point);
        if let Some(gate) = &range.gate {
            self.gate(&join(pointer, "gate"), gate);
        }
        if self.damage.holds("gravity", "") {
            return;
        }
        let gravity = self
            .document
            .gravity
            .as_ref()
            .map_or(Vec3::from(GRAVITY), values);
        if gravity.norm() == 0.0 {
            let expected = "a gravity that is not zero, as a range is measured under it";
            self.fault(Finding::new(pointer, "a range without gravity", expected));
            return;
        }
        let Some(direction) = &range.direction else {
            let tilt = gravity.x / gravity.norm();
            if tilt.abs() > HORIZONTAL {
                let found = "a range along [1, 0, 0], which is not horizontal";
                let expected = "a \"direction\" that is perpendicular to gravity";
                self.fault(Finding::new(pointer, found, expected));
            }
            return;
        };
        let place = join(pointer, "direction");
        self.direction(&place, direction);
        let along = values(direction);
        if along.dot(&gravity).abs() > HORIZONTAL * along.norm() * gravity.norm() {
            let found = format!("the direction [{}, {}, {}]", along.x, along.y, along.z);
            let expected = "a horizontal one, perpendicular to gravity";
            self.fault(Finding::new(place, found, expected));
        }
    }

    fn gate(&mut self, pointer: &str, gate: &Gate) {
        let whole = gate.body.is_some() && gate.axis.is_some();
        let part = gate.body.is_some()
            || gate.axis.is_some()
            || gate.relative_to.is_some()
            || gate.from.is_some();
        match &gate.joint {
            Some(_) if part => {
                let found = "\"joint\" and the rotation of a body";
                let expected = "\"joint\", or \"body\" and \"axis\"";
                self.fault(Finding::new(join(pointer, "joint"), found, expected).of_key());
            }
            Some(joint) => self.angle(pointer, joint),
            None if !whole => {
                let found = match (&gate.body, &gate.axis) {
                    (Some(_), _) => "no \"axis\"",
                    (None, _) => "no \"body\"",
                };
                let expected = "\"body\" and \"axis\", or \"joint\"";
                self.fault(Finding::new(pointer, found, expected).of_key());
            }
            None => {}
        }
        if let Some(body) = &gate.body {
            self.moving(pointer, body, &None);
            self.seen_from(pointer, body, gate.relative_to.as_deref());
        }
        if let Some(axis) = gate.axis {
            self.nonzero(&join(pointer, "axis"), axis);
        }
        let found = match (gate.above, gate.below) {
            (Some(_), Some(_)) => "both \"above\" and \"below\"",
            (None, None) => "neither \"above\" nor \"below\"",
            _ => return,
        };
        self.fault(Finding::new(pointer, found, "one of them").of_key());
    }
}
