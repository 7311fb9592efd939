//! Loads.

use super::Checker;
use crate::finding::Finding;
use crate::loads::named;
use crate::model::JointKind;
use crate::placement::GROUND;
use crate::pointer::{advice, join};
use crate::quantity::Quantity;
use crate::schema::joints::{Ends, Joint};
use crate::schema::loads::{
    Bushing, Cable, CableLength, Drag, ForceTable, Load, Motion, Stop, TimeFunction,
};
use crate::schema::measured::JointReaction;

/// The joint of a load and its motion, or its two bodies and their points.
type ActedOn<'a> = (
    &'a Option<String>,
    Option<Motion>,
    &'a Option<[String; 2]>,
    &'a Option<Ends>,
);

impl Checker<'_> {
    pub(super) fn loads(&mut self) {
        let document = self.document;
        self.names("loads", document.loads.keys());
        for (name, load) in &document.loads {
            let pointer = join(&join("/loads", name), load.key());
            self.load(&pointer, load);
        }
    }

    fn load(&mut self, pointer: &str, load: &Load) {
        use JointKind::{Cylindrical, Planar, Prismatic, Revolute, Spherical, Universal};
        match load {
            Load::Force(force) => {
                self.moving(pointer, &force.body, &force.point);
                self.direction(&join(pointer, "direction"), &force.direction);
                self.course(&join(pointer, "magnitude"), force.magnitude.parts());
                if force.point.is_some() && force.at.is_some() {
                    let finding = Finding::new(
                        join(pointer, "at"),
                        "\"at\" and \"point\"",
                        "one of them, as each says where the force acts",
                    );
                    self.fault(finding.of_key());
                }
            }
            Load::Torque(torque) => {
                self.moving(pointer, &torque.body, &torque.point);
                let body = self.document.bodies.get(&torque.body);
                let turned = body.and_then(|body| {
                    let kinds = [
                        (
                            body.elements.is_some(),
                            "elements",
                            "the named point that it turns",
                        ),
                        (
                            body.modal.is_some(),
                            "body of files",
                            "the interface that it turns",
                        ),
                        (
                            body.beam.is_some(),
                            "beam",
                            "the point whose section it turns",
                        ),
                    ];
                    let own = kinds.into_iter().find(|(own, ..)| *own);
                    own.map(|(_, kind, turned)| (kind, turned))
                });
                match (turned, &torque.point) {
                    (Some((kind, turned)), None) => {
                        let found = format!("a torque on the {kind} \"{}\"", torque.body);
                        let expected = format!("\"point\", {turned}");
                        self.fault(Finding::new(pointer, found, expected).of_key());
                    }
                    (None, Some(_)) => {
                        let found = "the point of a torque on a rigid body";
                        let expected = "none, as it acts on the body as a whole";
                        self.fault(Finding::new(join(pointer, "point"), found, expected).of_key());
                    }
                    (Some(_), Some(_)) | (None, None) => {}
                }
                self.direction(&join(pointer, "direction"), &torque.direction);
                self.course(&join(pointer, "magnitude"), torque.magnitude.parts());
            }
            Load::Spring(spring) => {
                self.between(&join(pointer, "between"), &spring.between);
                if let Ends::Each(pair) = &spring.at {
                    self.pair(&join(pointer, "at"), &spring.between, pair);
                }
                self.strength(pointer, "stiffness", &spring.stiffness, &spring.table);
                self.force_tables(pointer, [&spring.table, &spring.damping_table]);
            }
            Load::TorsionSpring(spring) => {
                self.loaded_joint(pointer, &spring.joint, &[Revolute, Planar, Cylindrical]);
                self.strength(pointer, "stiffness", &spring.stiffness, &spring.table);
                self.force_tables(pointer, [&spring.table, &spring.damping_table]);
            }
            Load::Damping(damping) => {
                let balls = [Spherical, Universal];
                let kinds = [&[Revolute, Prismatic, Cylindrical, Planar], &balls[..]].concat();
                self.loaded_joint(pointer, &damping.joint, &kinds);
                self.joint_motion(pointer, &damping.joint, damping.motion);
                self.strength(pointer, "coefficient", &damping.coefficient, &damping.table);
                if let Some(table) = &damping.table {
                    let table_at = join(pointer, "table");
                    let joint = self.document.joints.get(&damping.joint);
                    if joint.is_some_and(|joint| balls.contains(&joint.kind())) {
                        let found = "a table of a joint with several rates";
                        let expected = "a coefficient, or a joint with one rate";
                        self.fault(Finding::new(&table_at, found, expected).of_key());
                    }
                    self.rising(
                        &table_at,
                        ("places", &table.places),
                        ("forces", &table.forces),
                    );
                    self.resists(&table_at, table);
                }
            }
            Load::Bushing(bushing) => self.bushing(pointer, bushing),
            Load::Friction(friction) => {
                let kinds = [Revolute, Prismatic, Cylindrical, Planar];
                self.loaded_joint(pointer, &friction.joint, &kinds);
                self.joint_motion(pointer, &friction.joint, friction.motion);
            }
            Load::Drag(drag) => self.drag(pointer, drag),
            Load::Stop(stop) => self.stop(pointer, stop),
            Load::Contact(contact) => self.contact(pointer, contact),
            Load::Cable(cable) => self.cable(pointer, cable),
            Load::Pressure(load) => {
                self.loaded_elements(pointer, &load.body, ("faces", &load.faces));
                self.course(&join(pointer, "pressure"), load.pressure.parts());
            }
            Load::Area(load) => {
                self.loaded_elements(pointer, &load.body, ("faces", &load.faces));
                self.direction(&join(pointer, "direction"), &load.direction);
                self.course(&join(pointer, "magnitude"), load.magnitude.parts());
            }
            Load::Edge(load) => {
                self.loaded_elements(pointer, &load.body, ("edges", &load.edges));
                self.direction(&join(pointer, "direction"), &load.direction);
                self.course(&join(pointer, "magnitude"), load.magnitude.parts());
            }
            Load::Controller(own) => self.controller(pointer, own),
            Load::Line(load) => {
                self.loaded_elements(pointer, &load.body, ("beams", &load.beams));
                self.direction(&join(pointer, "direction"), &load.direction);
                self.course(&join(pointer, "magnitude"), load.magnitude.parts());
            }
        }
    }

    /// Checks two bodies, one of which may be ground.
    pub(super) fn between(&mut self, list: &str, between: &[String; 2]) {
        for (k, name) in between.iter().enumerate() {
            if name != GROUND {
                self.body(&join(list, k), name);
            }
        }
        if between[0] == between[1] {
            let found = format!("\"{}\" twice", between[0]);
            self.fault(Finding::new(list, found, "two different bodies"));
        }
    }

    /// Checks that the joint of a load or drive exists and has one of these kinds.
    pub(super) fn loaded_joint(&mut self, pointer: &str, name: &str, kinds: &[JointKind]) {
        self.joint_of_kind(&join(pointer, "joint"), name, kinds);
    }

    /// Checks the name of a joint, which is of one of these kinds.
    pub(super) fn joint_of_kind(&mut self, pointer: &str, name: &str, kinds: &[JointKind]) {
        let wanted = kinds.iter().map(|kind| kind.name()).collect::<Vec<_>>();
        let expected = format!("the name of a joint that is {}", wanted.join(" or "));
        match self.document.joints.get(name) {
            Some(joint) if kinds.contains(&joint.kind()) => {}
            Some(joint) => {
                let found = format!("\"{name}\", which is {}", joint.kind().name());
                self.fault(Finding::new(pointer, found, expected));
            }
            None if self.damage.holds("joints", name) => {}
            None => {
                let suitable = self.document.joints.iter();
                let suitable = suitable.filter(|(_, joint)| kinds.contains(&joint.kind()));
                let hint = advice(name, "such joints", suitable.map(|(name, _)| name.as_str()));
                self.fault(Finding::new(pointer, format!("\"{name}\""), expected).hint(hint));
            }
        }
    }

    /// Checks the joint and the symmetry of a bushing.
    /// Checks a drag: what it acts on, and the normal of a plate.
    fn drag(&mut self, pointer: &str, drag: &Drag) {
        if let Some(faces) = &drag.faces {
            self.loaded_elements(pointer, &drag.body, ("faces", faces));
            for (key, given) in [
                ("point", drag.point.is_some()),
                ("normal", drag.normal.is_some()),
            ] {
                if given {
                    let expected = "none, as shells have their places and normals";
                    let found = format!("a \"{key}\"");
                    self.fault(Finding::new(join(pointer, key), found, expected).of_key());
                }
            }
            return;
        }
        self.moving(pointer, &drag.body, &drag.point);
        let place = join(pointer, "normal");
        match &drag.normal {
            Some(normal) => {
                self.direction(&place, normal);
                let own = &drag.normal_coefficient;
                if own.value == 0.0 && own.variable.is_none() {
                    let expected = "\"normal_coefficient\" too, as a normal alone has no force";
                    self.fault(Finding::new(place, "a normal", expected).of_key());
                }
            }
            None if drag.normal_coefficient.value != 0.0
                || drag.normal_coefficient.variable.is_some() =>
            {
                let found = "a \"normal_coefficient\" without \"normal\"";
                let finding = Finding::new(pointer, found, "the normal of the plate");
                self.fault(finding.of_key());
            }
            None => {}
        }
    }

    fn bushing(&mut self, pointer: &str, bushing: &Bushing) {
        if let Some(friction) = &bushing.friction {
            let place = join(pointer, "friction");
            let joint = self.document.joints.get(&bushing.joint);
            if joint.is_some_and(|joint| !matches!(joint, Joint::Free(_))) {
                let found = "friction in a joint that bears the force across its axis itself";
                let expected = "a \"free\" joint, whose bushing bears it";
                self.fault(Finding::new(&place, found, expected).of_key());
            }
            match (friction.motion, &friction.radius) {
                (Motion::Turn, None) => {
                    let finding = Finding::new(place, "no \"radius\"", "the radius of the bearing");
                    self.fault(finding.of_key());
                }
                (Motion::Slide, Some(_)) => {
                    let expected = "none, as a guide that slides has no radius";
                    let finding = Finding::new(join(&place, "radius"), "a radius", expected);
                    self.fault(finding.of_key());
                }
                _ => {}
            }
        }
        use JointKind::{Cylindrical, Free, Planar, Prismatic, Revolute, Spherical, Universal};
        let kinds = [
            Free,
            Spherical,
            Universal,
            Cylindrical,
            Planar,
            Revolute,
            Prismatic,
        ];
        self.loaded_joint(pointer, &bushing.joint, &kinds);
        let damping = bushing.damping.as_ref().map(|own| own.entries());
        let both = [
            ("stiffness", Some(bushing.stiffness.entries())),
            ("damping", damping),
        ];
        for (key, entries) in both {
            let Some(entries) = entries else { continue };
            let value = |i: usize, k: usize| entries[i][k].map_or(0.0, |own| own.value);
            let pairs = (0..6).flat_map(|i| (0..i).map(move |k| (i, k)));
            let skew = |&(i, k): &(usize, usize)| {
                let (a, b) = (value(i, k), value(k, i));
                (a - b).abs() > 1e-9 * a.abs().max(b.abs())
            };
            for (i, k) in pairs.filter(skew) {
                let place = join(&join(&join(&join(pointer, key), "rows"), i), k);
                let (found, other) = (value(i, k), value(k, i));
                let expected = format!("{other}, as row {k} has it: the matrix is symmetric");
                self.fault(Finding::new(place, format!("{found}"), expected));
            }
        }
    }

    /// Checks the reaction of a joint.
    pub(super) fn reaction(&mut self, pointer: &str, of: &JointReaction) {
        self.direction(&join(pointer, "direction"), &of.direction);
        let Some(joint) = self.document.joints.get(&of.joint) else {
            if !self.damage.holds("joints", &of.joint) {
                let names = self.document.joints.keys().map(String::as_str);
                let hint = advice(&of.joint, "joints", names);
                let found = format!("\"{}\"", of.joint);
                let place = join(pointer, "joint");
                self.fault(Finding::new(place, found, "the name of a joint").hint(hint));
            }
            return;
        };
        if let Some(on) = &of.on
            && !joint.between().contains(on)
        {
            let [a, b] = joint.between();
            let expected = format!("\"{a}\" or \"{b}\", which the joint holds");
            let place = join(pointer, "on");
            self.fault(Finding::new(place, format!("\"{on}\""), expected));
        }
    }

    /// Checks that a load is a spring or cable, or a torsion spring.
    pub(super) fn spring(&mut self, pointer: &str, name: &str, torsion: bool) {
        let fits = |load: &Load| match load {
            Load::Spring(_) | Load::Cable(_) => !torsion,
            Load::TorsionSpring(_) => torsion,
            Load::Force(_)
            | Load::Torque(_)
            | Load::Damping(_)
            | Load::Bushing(_)
            | Load::Friction(_)
            | Load::Drag(_)
            | Load::Stop(_)
            | Load::Contact(_)
            | Load::Pressure(_)
            | Load::Area(_)
            | Load::Edge(_)
            | Load::Controller(_)
            | Load::Line(_) => false,
        };
        let what = ["spring or cable", "torsion spring"][usize::from(torsion)];
        self.load_of(
            pointer,
            name,
            fits,
            &format!("the name of a load that is a {what}"),
        );
    }

    /// Checks a stop: what it stops, and its limits.
    fn stop(&mut self, pointer: &str, stop: &Stop) {
        let of = (&stop.joint, stop.motion, &stop.between, &stop.at);
        self.joint_or_distance(pointer, of, ("stopped", "stops"));
        match (&stop.lower, &stop.upper) {
            (None, None) => {
                let expected = "\"lower\", \"upper\" or both";
                self.fault(Finding::new(pointer, "a stop without a limit", expected).of_key());
            }
            (Some(lower), Some(upper)) if lower.value >= upper.value => {
                let found = format!("{} above {}", lower.value, upper.value);
                let expected = "a lower limit below the upper one";
                self.fault(Finding::new(join(pointer, "lower"), found, expected));
            }
            (Some(_), Some(_)) | (Some(_), None) | (None, Some(_)) => {}
        }
    }

    /// Checks the joint of a load with its motion, or its bodies with their points.
    pub(super) fn joint_or_distance(
        &mut self,
        pointer: &str,
        (joint, motion, between, at): ActedOn,
        (done, does): (&str, &str),
    ) {
        use JointKind::{Cylindrical, Planar, Prismatic, Revolute};
        match (joint, between, at) {
            (Some(joint), None, None) => {
                let kinds = [Revolute, Prismatic, Cylindrical, Planar];
                self.loaded_joint(pointer, joint, &kinds);
                self.joint_motion(pointer, joint, motion);
            }
            (None, Some(between), Some(at)) => {
                self.between(&join(pointer, "between"), between);
                if let Ends::Each(pair) = at {
                    self.pair(&join(pointer, "at"), between, pair);
                }
                if motion.is_some() {
                    let expected = format!("none, as it {does} a distance");
                    let finding = Finding::new(join(pointer, "motion"), "a motion", expected);
                    self.fault(finding.of_key());
                }
            }
            (joint, between, at) => {
                let keys = [
                    (joint.is_some(), "\"joint\""),
                    (between.is_some(), "\"between\""),
                    (at.is_some(), "\"at\""),
                ];
                let given: Vec<&str> = keys.iter().filter(|key| key.0).map(|key| key.1).collect();
                let found = match given.is_empty() {
                    true => format!("nothing that is {done}"),
                    false => given.join(" and "),
                };
                let expected = "\"joint\", or \"between\" and \"at\"";
                self.fault(Finding::new(pointer, found, expected).of_key());
            }
        }
    }

    /// Checks a cable: its points and its length.
    fn cable(&mut self, pointer: &str, cable: &Cable) {
        let list = join(pointer, "points");
        if cable.points.len() < 2 {
            let found = format!("{} of them", cable.points.len());
            self.fault(Finding::new(&list, found, "two points or more"));
        }
        if cable.points.iter().all(|own| own.body == GROUND) {
            let expected = "a point of a body";
            self.fault(Finding::new(&list, "points of ground alone", expected));
        }
        for (k, own) in cable.points.iter().enumerate() {
            let place = join(&list, k);
            if own.body != GROUND {
                self.body(&join(&place, "body"), &own.body);
            }
            match &own.point {
                Some(point) => self.point(&join(&place, "point"), &own.body, point),
                None if own.body == GROUND => {
                    let expected = "\"point\" in ground coordinates";
                    self.fault(Finding::new(place, "a place of ground", expected).of_key());
                }
                None => {}
            }
        }
        if let CableLength::Varying(course) = &cable.length {
            self.motion(&join(pointer, "length"), course.parts());
        }
    }

    /// Checks that a load is a stop or a contact.
    pub(super) fn stop_of(&mut self, pointer: &str, name: &str, friction: bool) {
        let fits = |load: &Load| match load {
            Load::Stop(_) => !friction,
            Load::Contact(_) => true,
            _ => false,
        };
        let expected = match friction {
            true => "the name of a load that is a contact",
            false => "the name of a load that is a stop or contact",
        };
        self.load_of(pointer, name, fits, expected);
    }

    /// Checks that the load of a quantity is one that fits.
    pub(super) fn load_of(
        &mut self,
        pointer: &str,
        name: &str,
        fits: impl Fn(&Load) -> bool,
        expected: &str,
    ) {
        let loads = &self.document.loads;
        if loads.get(name).is_some_and(&fits) || self.damage.holds("loads", name) {
            return;
        }
        let suitable = loads.iter().filter(|(_, load)| fits(load));
        let names: Vec<&str> = suitable.map(|(name, _)| name.as_str()).collect();
        let hint = match names.is_empty() {
            true => Some("there is none".to_owned()),
            false => advice(name, "such loads", names),
        };
        let place = join(pointer, "load");
        self.fault(Finding::new(place, format!("\"{name}\""), expected).hint(hint));
    }

    /// Checks that a joint has the degree of freedom on which a load acts.
    pub(super) fn joint_motion(&mut self, pointer: &str, joint: &str, motion: Option<Motion>) {
        let (Some(joint), Some(motion)) = (self.document.joints.get(joint), motion) else {
            return;
        };
        if !joint.kind().degrees_of_freedom().contains(&named(motion)) {
            let found = format!("{motion:?}").to_lowercase();
            let found = format!("\"{found}\" of a joint that is {}", joint.kind().name());
            let expected = "a motion about or along its axis that the joint allows";
            self.fault(Finding::new(join(pointer, "motion"), found, expected));
        }
    }

    pub(super) fn course(&mut self, pointer: &str, course: TimeFunction) {
        if let TimeFunction::Table(times, values, _) = course {
            self.table(pointer, times, values);
        }
    }

    /// Checks the table of a time function.
    pub(super) fn table(&mut self, pointer: &str, times: &[f64], values: &[Quantity]) {
        self.rising(
            &join(pointer, "table"),
            ("times", times),
            ("values", values),
        );
    }

    /// Checks that a table has two points or more, in ascending order.
    pub(super) fn rising(
        &mut self,
        table: &str,
        (at, places): (&str, &[f64]),
        (of, values): (&str, &[Quantity]),
    ) {
        if places.len() < 2 || places.len() != values.len() {
            let found = format!("{} {at} and {} {of}", places.len(), values.len());
            let expected = format!("as many {of} as {at}, and at least two of each");
            self.fault(Finding::new(table, found, expected));
        }
        if let Some(k) = (1..places.len()).find(|&k| places[k] <= places[k - 1]) {
            let found = format!("{} after {}", places[k], places[k - 1]);
            let place = join(&join(table, at), k);
            self.fault(Finding::new(place, found, format!("{at} that increase")));
        }
    }

    /// Checks that a load has the number of its strength or a table.
    fn strength(
        &mut self,
        pointer: &str,
        key: &str,
        number: &Option<Quantity>,
        table: &Option<ForceTable>,
    ) {
        if number.is_none() && table.is_none() {
            let expected = format!("\"{key}\", \"table\" or both");
            self.fault(Finding::new(pointer, format!("no \"{key}\""), expected).of_key());
        }
    }

    /// Checks the tables of a spring, over its stretch and over its rate.
    fn force_tables(&mut self, pointer: &str, tables: [&Option<ForceTable>; 2]) {
        for (key, table) in ["table", "damping_table"].into_iter().zip(tables) {
            let Some(table) = table else { continue };
            let place = join(pointer, key);
            self.rising(&place, ("places", &table.places), ("forces", &table.forces));
            if key == "damping_table" {
                self.resists(&place, table);
            }
        }
    }

    /// Checks that a damper by a table takes energy and never gives it.
    fn resists(&mut self, pointer: &str, table: &ForceTable) {
        let mut points = table.places.iter().zip(&table.forces).enumerate();
        if let Some((k, (rate, force))) =
            points.find(|(_, (rate, force))| *rate * force.value < 0.0)
        {
            let found = format!("{} at the rate {rate}", force.value);
            let expected = "a force with the sign of its rate, as a damper takes energy";
            let place = join(&join(pointer, "forces"), k);
            self.fault(Finding::new(place, found, expected));
        }
    }
}
