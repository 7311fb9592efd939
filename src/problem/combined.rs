//! Combined and relative quantities, powers and rates, from a file.

use super::placement::GROUND;
use super::quantities::FunctionBuilder;
use crate::functions::seen::{Seen, SeenPart};
use crate::functions::{Instant, Operation, Quantity};
use crate::math::{Scalar, Vec3};
use crate::model::{Axes, DegreeOfFreedom};
use crate::quantity::vector;
use crate::schema::combined::{Distance, PowerOf, Relative};
use crate::schema::functions::Instant as Written;
use crate::schema::mechanics::Point;
use crate::system::measures::{End, Wrench, WrenchPart};

impl<S: Scalar> FunctionBuilder<'_, S> {
    /// The quantity that a file writes so.
    pub(super) fn quantity(&self, of: &Written) -> Quantity<S> {
        let of_two = |operation, pair: &[Box<Written>; 2]| Quantity::Combined {
            operation,
            of: pair.iter().map(|own| self.quantity(own)).collect(),
        };
        let of_all = |operation, all: &[Written]| Quantity::Combined {
            operation,
            of: all.iter().map(|own| self.quantity(own)).collect(),
        };
        match of {
            Written::Sum(all) => of_all(Operation::Sum, all),
            Written::Product(all) => of_all(Operation::Product, all),
            Written::Difference(pair) => of_two(Operation::Difference, pair),
            Written::Quotient(pair) => of_two(Operation::Quotient, pair),
            Written::Square(own) => combined(Operation::Square, self.quantity(own)),
            Written::Absolute(own) => {
                let width = own.width;
                combined(Operation::Absolute { width }, self.quantity(&own.of))
            }
            Written::Rate(own) => combined(Operation::Rate, self.quantity(own)),
            Written::Jerk(component) => {
                let acceleration = Written::Acceleration(component.clone());
                combined(Operation::Rate, self.quantity(&acceleration))
            }
            Written::Power(PowerOf::Load(name)) => {
                Quantity::Of(Instant::Power(Some(self.load(name))))
            }
            Written::Power(PowerOf::Drive(name)) => self.power_of_drive(name),
            other => Quantity::Of(self.instant(other)),
        }
    }

    /// Moment times rate about the axis, plus force times rate along it. Nothing else bears them there while the drive is
    /// on; while it is off, it has none.
    fn power_of_drive(&self, name: &str) -> Quantity<S> {
        let drive = &self.document.drives[name];
        let joint = self.joint(&drive.joint);
        let is_off = |phase| !self.document.is_on(name, phase);
        let of_joint = |phase| !self.document.is_on(&drive.joint, phase);
        if (self.document.phase).is_some_and(|phase| is_off(phase) || of_joint(phase)) {
            return Quantity::Of(Instant::Power(None));
        }
        let along = self.frames[joint][2];
        let part = |part, dof| {
            let reaction = Instant::Reaction(Wrench {
                joint,
                on: End::A,
                part,
                axes: Axes::Body,
                direction: along,
            });
            let rate = Instant::JointRate { joint, dof };
            Quantity::Combined {
                operation: Operation::Product,
                of: vec![Quantity::Of(reaction), Quantity::Of(rate)],
            }
        };
        let turn =
            (drive.turn.is_some()).then(|| part(WrenchPart::Moment, DegreeOfFreedom::Rotation));
        let slide =
            (drive.slide.is_some()).then(|| part(WrenchPart::Force, DegreeOfFreedom::Translation));
        let mut all: Vec<Quantity<S>> = turn.into_iter().chain(slide).collect();
        match all.len() {
            1 => all.remove(0),
            _ => Quantity::Combined {
                operation: Operation::Sum,
                of: all,
            },
        }
    }

    pub(super) fn joint_rate(&self, joint: &str, dof: DegreeOfFreedom) -> Instant<S> {
        let joint = self.joint(joint);
        Instant::JointRate { joint, dof }
    }

    pub(super) fn relative(&self, of: &Relative, part: SeenPart) -> Instant<S> {
        let direction = vector(&of.direction, self.x);
        let (seen, from) = ((&of.body, &of.point), (&of.relative_to, &of.from));
        self.seen(part, seen, from, direction)
    }

    pub(super) fn distance(&self, of: &Distance) -> Instant<S> {
        let (seen, from) = ((&of.body, &of.point), (&of.relative_to, &of.from));
        self.seen(SeenPart::Distance, seen, from, Vec3::zeros())
    }

    fn seen(
        &self,
        part: SeenPart,
        (body, point): (&String, &Option<Point>),
        (from, eye): (&String, &Option<Point>),
        direction: Vec3<S>,
    ) -> Instant<S> {
        let on_ground = from == GROUND;
        Instant::Seen(Seen {
            part,
            body: self.body(body),
            point: self.point(body, point),
            from: (!on_ground).then(|| self.body(from)),
            eye: match (on_ground, eye) {
                (false, _) => self.point(from, eye),
                (true, Some(eye)) => self.assembly.in_body(GROUND, eye),
                (true, None) => Vec3::zeros(),
            },
            direction,
        })
    }
}

fn combined<S>(operation: Operation, own: Quantity<S>) -> Quantity<S> {
    Quantity::Combined {
        operation,
        of: vec![own],
    }
}
