//! The functions of a scene from those of a problem file.

use super::controllers::{controlled, is_held};
use super::couplings::{Followed, observed};
use super::flexible::{FlexibleBodies, Sections, station, stations};
use super::loads::stopped;
use super::placement::{Assembly, GROUND};
use super::starting_angles::{starting_angle, starting_turn};
use crate::aggregates::rho_of;
use crate::functions::seen::SeenPart;
use crate::functions::series::Series;
use crate::functions::{
    Bound, EnergyPart, Function, Gate, GateSide, Instant, OfVibration, Operation, Projectile,
    Reduction, Release, Rotation, VibrationPart,
};
use crate::math::rotation::{self, compose, conjugate};
use crate::math::scalar::{lift3, unit};
use crate::math::{Scalar, Vec3};
use crate::model::{Axes, DegreeOfFreedom};
use crate::quantity::{Quantity as Number, vector};
use crate::schema::Document;
use crate::schema::couplings::OfCoupling;
use crate::schema::functions::{self as written, CountedFrom, Function as Written, OfMotion};
use crate::schema::loads::Load;
use crate::schema::measured::{Bound as Side, JointReaction, ReactionAxes};
use crate::schema::mechanics::Point;
use crate::schema::statics::Frequency;
use crate::system::angular_momentum::AngularMomentum;
use crate::system::equilibrium::{DampedVibration, Follow, Vibrations};
use crate::system::loads::measured::{LoadMeasure, LoadPart};
use crate::system::measures::{End, Wrench, WrenchPart};
use std::collections::BTreeMap;

/// Makes the functions of a scene.
pub(super) struct FunctionBuilder<'a, S> {
    pub document: &'a Document,
    pub assembly: &'a Assembly<'a, S>,
    pub gravity: Vec3<S>,
    pub flexible: &'a FlexibleBodies<S>,
    /// Mass of all bodies \[kg\].
    pub mass: S,
    /// The bodies of the joints, first the one that is not ground.
    pub ends: Vec<(usize, Option<usize>)>,
    /// The axes of the joints on the first of them.
    pub frames: Vec<[Vec3<S>; 3]>,
    /// By coupling: its motions.
    pub coupled: Vec<Vec<Followed<S>>>,
    /// By joint: its angle with all turns, which loads count, at rest.
    pub counted: BTreeMap<usize, f64>,
    /// Vibrations about rest.
    pub vibrations: Vibrations<S>,
    /// The modes among them that are followed by their shapes.
    pub followed: Vec<Follow>,
    pub x: &'a [S],
}

impl<S: Scalar> FunctionBuilder<'_, S> {
    /// The function that a file writes so.
    pub(super) fn function(&self, function: &Written) -> Function<S> {
        let Some(function) = function.of_motion() else {
            unreachable!("functions of structures are refused before");
        };
        match function {
            OfMotion::Ks(ks) => {
                let bound = match ks.bound {
                    None | Some(Side::Below) => Bound::Below,
                    Some(Side::Above) => Bound::Above,
                };
                let reduction = Reduction::Ks {
                    rho: rho_of(ks.rho),
                    bound,
                };
                self.reduced(&ks.of, ks.during.as_ref(), reduction)
            }
            OfMotion::InducedExponential(ie) => {
                let reduction = Reduction::InducedExponential {
                    rho: rho_of(ie.rho),
                };
                self.reduced(&ie.of, ie.during.as_ref(), reduction)
            }
            OfMotion::Integral(over) => self.over(over, Reduction::Integral),
            OfMotion::Final(over) => self.over(over, Reduction::Final),
            OfMotion::Mean(over) => self.over(over, Reduction::Mean),
            OfMotion::MeanSquare(over) => self.mean_of(Operation::Square, over.of(), over.during()),
            OfMotion::MeanAbsolute(own) => {
                let operation = Operation::Absolute { width: own.width };
                self.mean_of(operation, &own.of, own.during.as_ref())
            }
            OfMotion::FatigueDamage(own) => {
                let (slope, strength) = (own.slope, own.strength);
                let reduction = Reduction::Damage { slope, strength };
                self.reduced(&own.of, own.during.as_ref(), reduction)
            }
            OfMotion::Value(value) => self.value_at(value),
            OfMotion::Clearance(clearance) => self.clearance(clearance),
            OfMotion::Misfit(misfit) => Function::Misfit {
                series: misfit.series.values().map(|own| self.series(own)).collect(),
            },
            OfMotion::Duration => Function::Duration,
            OfMotion::Mass => Function::OfDesign {
                unit: "kg",
                value: self.mass,
            },
            OfMotion::Frequency(own) => Function::OfDesign {
                unit: "Hz",
                value: self.frequency(own),
            },
            OfMotion::DampingRatio(own) => Function::OfDesign {
                unit: "1",
                value: match own.follow {
                    true => self.of_followed(own.mode, true, DampedVibration::damping_ratio),
                    false => self.of_damped(own.mode, DampedVibration::damping_ratio),
                },
            },
            OfMotion::CriticalSpeed(own) => Function::OfDesign {
                unit: "rad/s",
                value: match self.vibrations.critical.get(own.number - 1) {
                    None => S::from(f64::NAN),
                    Some(own) => single(own.speed, own.divides),
                },
            },
            OfMotion::LowestFrequency(own) => Function::LowestFrequency {
                rho: rho_of(own.rho),
                frequencies: (self.vibrations.undamped.iter())
                    .map(|own| own.frequency)
                    .collect(),
            },
        }
    }

    /// A frequency \[Hz\]: not a number without rest.
    fn frequency(&self, of: &Frequency) -> S {
        if of.follow {
            return self.of_followed(of.mode, of.damped, DampedVibration::frequency);
        }
        if of.damped {
            return self.of_damped(of.mode, DampedVibration::frequency);
        }
        match self.vibrations.undamped.get(of.mode - 1) {
            None => S::from(f64::NAN),
            Some(own) => single(own.frequency, own.repeated),
        }
    }

    /// A number of a vibration that is followed by its shape.
    fn of_followed(&self, mode: usize, damped: bool, of: fn(&DampedVibration<S>) -> S) -> S {
        let number = mode - 1;
        let place = self
            .followed
            .iter()
            .position(|own| *own == Follow { number, damped });
        match place.and_then(|place| self.vibrations.followed.get(place)) {
            None => S::from(f64::NAN),
            Some(own) => single(of(own), own.repeated),
        }
    }

    /// A number of a damped vibration.
    fn of_damped(&self, mode: usize, of: fn(&DampedVibration<S>) -> S) -> S {
        match self.vibrations.damped.get(mode - 1) {
            None => S::from(f64::NAN),
            Some(own) => single(of(own), own.repeated),
        }
    }

    fn series(&self, own: &crate::schema::misfit::Series) -> Series<S> {
        Series {
            of: self.quantity(&own.of),
            data: own.loaded.clone().unwrap_or_default(),
            offset: own.offset.map_or(S::zero(), |offset| offset.get(self.x)),
        }
    }

    fn clearance(&self, clearance: &written::Clearance) -> Function<S> {
        let (range, rho) = released(self.document, &clearance.release)
            .expect("the release is checked when a problem is read");
        let projectile = self.projectile(range);
        Function::Clearance {
            projectile,
            release: match rho {
                None => Release::Final,
                Some(rho) => Release::Best {
                    rho,
                    projectile,
                    gate: range.gate.as_ref().map(|gate| self.gate(gate)),
                },
            },
            distance: clearance.barrier.distance.get(self.x),
            top: clearance.barrier.top.get(self.x),
        }
    }

    /// The quantity of an instant that a file writes so.
    pub(super) fn instant(&self, instant: &written::Instant) -> Instant<S> {
        use written::{Energy, Instant as I};
        let parts = |c: &written::Component| {
            let body = self.body(&c.body);
            (
                body,
                self.point(&c.body, &c.point),
                vector(&c.direction, self.x),
            )
        };
        match instant {
            I::Position(component) => {
                let (body, point, direction) = parts(component);
                Instant::Position {
                    body,
                    point,
                    direction,
                }
            }
            I::Velocity(component) => {
                let (body, point, direction) = parts(component);
                Instant::Velocity {
                    body,
                    point,
                    direction,
                }
            }
            I::Acceleration(component) => {
                let (body, point, direction) = parts(component);
                Instant::Acceleration {
                    body,
                    point,
                    direction,
                }
            }
            I::Speed(moving) => Instant::Speed {
                body: self.body(&moving.body),
                point: self.point(&moving.body, &moving.point),
            },
            I::SpeedSquared(moving) => Instant::SpeedSquared {
                body: self.body(&moving.body),
                point: self.point(&moving.body, &moving.point),
            },
            I::AngularVelocity(spinning) => Instant::AngularVelocity {
                body: self.body(&spinning.body),
                direction: vector(&spinning.direction, self.x),
            },
            I::Momentum(momentum) => Instant::Momentum {
                direction: vector(&momentum.direction, self.x),
            },
            I::AngularMomentum(momentum) => Instant::AngularMomentum(AngularMomentum {
                direction: vector(&momentum.direction, self.x),
                about: (momentum.about).map_or(Vec3::zeros(), |about| vector(&about, self.x)),
            }),
            I::Slide(slide) => Instant::Slide(self.joint(&slide.joint)),
            I::JointForce(of) => self.reaction(of, WrenchPart::Force),
            I::JointMoment(of) => self.reaction(of, WrenchPart::Moment),
            I::CouplingReaction(of) => self.coupling_reaction(of),
            I::SpringLength(of) => self.of_load(&of.load, LoadPart::Length),
            I::SpringForce(of) => self.of_load(&of.load, LoadPart::Tension),
            I::SpringTorque(of) => self.of_load(&of.load, LoadPart::Torque),
            I::ContactForce(of) => match self.stops_angle(&of.load) {
                true => self.of_load(&of.load, LoadPart::NormalTorque),
                false => self.of_load(&of.load, LoadPart::NormalForce),
            },
            I::ContactFriction(of) => self.of_load(&of.load, LoadPart::Friction),
            I::SlipPower(of) => self.of_load(&of.load, LoadPart::SlipPower),
            I::Penetration(of) => match self.stops_angle(&of.load) {
                true => self.of_load(&of.load, LoadPart::PenetrationAngle),
                false => self.of_load(&of.load, LoadPart::Penetration),
            },
            I::Effort(of) => self.effort(&of.load),
            I::TrackingError(of) => match self.controls_angle(&of.load) {
                true => self.of_load(&of.load, LoadPart::ErrorAngle),
                false => self.of_load(&of.load, LoadPart::ErrorLength),
            },
            I::Energy(part) => Instant::Energy(match part {
                Energy::Kinetic => EnergyPart::Kinetic,
                Energy::Potential => EnergyPart::Potential,
                Energy::Total => EnergyPart::Total,
            }),
            I::Rotation(rotation) => {
                let axis = vector(&rotation.axis, self.x);
                let other = rotation.relative_to.as_deref();
                Instant::Rotation(self.counted_rotation(
                    [Some(&rotation.body), other],
                    axis,
                    rotation.from,
                ))
            }
            I::SensorAcceleration(component) => {
                let (body, point, direction) = parts(component);
                Instant::Felt {
                    body,
                    point,
                    direction,
                }
            }
            I::RelativePosition(of) => self.relative(of, SeenPart::Position),
            I::RelativeVelocity(of) => self.relative(of, SeenPart::Velocity),
            I::Distance(of) => self.distance(of),
            I::AngleRate(of) => self.joint_rate(&of.joint, DegreeOfFreedom::Rotation),
            I::SlideRate(of) => self.joint_rate(&of.joint, DegreeOfFreedom::Translation),
            I::Jerk(_)
            | I::Power(_)
            | I::Sum(_)
            | I::Difference(_)
            | I::Product(_)
            | I::Quotient(_)
            | I::Square(_)
            | I::Absolute(_)
            | I::Rate(_) => unreachable!("a combination is none of an instant"),
            I::Angle(angle) => Instant::Rotation(self.joint_angle(&angle.joint)),
            I::Range(range) => Instant::Range {
                projectile: self.projectile(range),
                gate: range.gate.as_ref().map(|gate| self.gate(gate)),
            },
            I::ElasticDisplacement(of) => {
                let point = self.assembly.in_body(&of.body, &of.point);
                let direction = vector(&of.direction, self.x);
                (self.flexible).displacement(self.body(&of.body), point, direction)
            }
            I::Frequency(of) => Instant::Vibration(OfVibration {
                mode: of.mode - 1,
                part: VibrationPart::Frequency,
            }),
            I::DampingRatio(of) => Instant::Vibration(OfVibration {
                mode: of.mode - 1,
                part: VibrationPart::DampingRatio,
            }),
            I::StrainEnergy(of) => Instant::StrainEnergy(self.flexible.index(self.body(&of.body))),
            I::VonMises(of) => {
                let body = self.body(&of.body);
                (self.flexible).shell_stress(body, of.elements.as_ref(), rho_of(of.rho))
            }
            I::SectionForce(of) => {
                let station = station(self.document, self.assembly, &of.body, &of.station);
                let sections = self.sections(&of.body, of.beams.as_ref());
                sections.force(of.component, station)
            }
            I::FibreStress(of) => {
                let station = station(self.document, self.assembly, &of.body, &of.station);
                let sections = self.sections(&of.body, of.beams.as_ref());
                sections.stress(station, of.fibre)
            }
            I::LargestSectionForce(of) => {
                let stations = stations(self.document, self.assembly, &of.body, &of.stations);
                let sections = self.sections(&of.body, of.beams.as_ref());
                sections.largest_force(of, &stations)
            }
            I::LargestFibreStress(of) => {
                let stations = stations(self.document, self.assembly, &of.body, &of.stations);
                let sections = self.sections(&of.body, of.beams.as_ref());
                sections.largest_stress(of, &stations)
            }
        }
    }

    fn sections(&self, body: &str, beams: Option<&String>) -> Sections<'_, S> {
        let of = (body, self.body(body));
        self.flexible.sections(self.document, of, beams, self.x)
    }

    pub(super) fn joint(&self, name: &str) -> usize {
        let index = self.document.joints.get_index_of(name);
        index.expect("a function is of a joint, which is checked")
    }

    pub(super) fn load(&self, name: &str) -> usize {
        let load = self.document.loads.get_index_of(name);
        load.expect("a function is of a load, which is checked")
    }

    fn of_load(&self, name: &str, part: LoadPart) -> Instant<S> {
        Instant::Load(LoadMeasure {
            load: self.load(name),
            part,
        })
    }

    /// Whether a load is the stop of an angle.
    fn stops_angle(&self, name: &str) -> bool {
        let Some(Load::Stop(stop)) = self.document.loads.get(name) else {
            return false;
        };
        stopped(self.document, stop) == Some(DegreeOfFreedom::Rotation)
    }

    /// The effort of a controller; at rest that of the drive by which its integral holds the joint.
    fn effort(&self, name: &str) -> Instant<S> {
        let turns = self.controls_angle(name);
        if let Some(Load::Controller(own)) = self.document.loads.get(name)
            && is_held(self.document, own)
            && let Some(joint) = &own.joint
        {
            let of = JointReaction {
                joint: joint.clone(),
                on: None,
                axes: Some(ReactionAxes::Joint),
                direction: [0.0, 0.0, 1.0].map(Number::fixed),
            };
            let part = match turns {
                true => WrenchPart::Moment,
                false => WrenchPart::Force,
            };
            return self.reaction(&of, part);
        }
        match turns {
            true => self.of_load(name, LoadPart::EffortTorque),
            false => self.of_load(name, LoadPart::EffortForce),
        }
    }

    /// Whether a load is the controller of an angle.
    fn controls_angle(&self, name: &str) -> bool {
        let Some(Load::Controller(own)) = self.document.loads.get(name) else {
            return false;
        };
        controlled(self.document, own) == Some(DegreeOfFreedom::Rotation)
    }

    fn reaction(&self, of: &JointReaction, part: WrenchPart) -> Instant<S> {
        let joint = self.joint(&of.joint);
        let [first, second] = self.document.joints[joint].between();
        let first = if first == GROUND { second } else { first };
        let direction = vector(&of.direction, self.x);
        let (axes, direction) = match of.axes.unwrap_or_default() {
            ReactionAxes::Ground => (Axes::Ground, direction),
            ReactionAxes::Joint => {
                let [e1, e2, e3] = self.frames[joint];
                let along = e1 * direction.x + e2 * direction.y + e3 * direction.z;
                (Axes::Body, along)
            }
        };
        Instant::Reaction(Wrench {
            joint,
            on: match of.on.as_ref().is_none_or(|on| on == first) {
                true => End::A,
                false => End::B,
            },
            part,
            axes,
            direction,
        })
    }

    fn coupling_reaction(&self, of: &OfCoupling) -> Instant<S> {
        let coupling = self.document.couplings.get_full(&of.coupling);
        let (k, _, coupling) = coupling.expect("a function is of a coupling, which is checked");
        let at = observed(coupling, of);
        let own = &self.coupled[k]
            [at.expect("a function is of a motion of a coupling, which is checked")];
        Instant::Reaction(Wrench {
            joint: own.joint,
            on: End::A,
            part: match own.dof {
                DegreeOfFreedom::Rotation => WrenchPart::Moment,
                DegreeOfFreedom::Translation => WrenchPart::Force,
            },
            axes: Axes::Body,
            direction: own.axis,
        })
    }

    pub(super) fn body(&self, name: &str) -> usize {
        self.assembly
            .index(name)
            .expect("a function is of a body, not of ground")
    }

    /// A point from the centre of mass \[m\]. The default is the centre of mass.
    pub(super) fn point(&self, body: &str, point: &Option<Point>) -> Vec3<S> {
        point.as_ref().map_or(Vec3::zeros(), |point| {
            self.assembly.in_body(body, point) - self.assembly.pose(body).centre
        })
    }

    /// The projectile of a range. Its direction is made orthogonal to gravity, so that it stays
    /// horizontal if the design turns gravity.
    fn projectile(&self, range: &written::Range) -> Projectile<S> {
        let along = range.direction.map_or(Vec3::x(), |d| vector(&d, self.x));
        let g = self.gravity;
        Projectile {
            body: self.body(&range.body),
            point: self.point(&range.body, &range.point),
            direction: unit(along - g * (along.dot(&g) / g.dot(&g))),
            ground: range.ground.map_or(S::zero(), |ground| ground.get(self.x)),
        }
    }

    /// The rotation of the first body relative to the second or to ground, about an axis in ground
    /// axes as placed. It counts the turns of starts and drives of the joints between them.
    fn counted_rotation(
        &self,
        bodies: [Option<&str>; 2],
        axis: Vec3<S>,
        from: Option<CountedFrom>,
    ) -> Rotation<S> {
        let [other, body] = [bodies[1], bodies[0]].map(|body| body.unwrap_or(GROUND));
        let turn = starting_turn(self.document, self.assembly, [other, body], &axis);
        self.rotation(bodies, axis, from, turn)
    }

    /// That rotation, where the start turns the bodies by `turn` from their placement, if that is known.
    fn rotation(
        &self,
        [body, other]: [Option<&str>; 2],
        axis: Vec3<S>,
        from: Option<CountedFrom>,
        turn: Option<f64>,
    ) -> Rotation<S> {
        let body = body.expect("a rotation is that of a body");
        let (own, seen_from) = (
            self.assembly.pose(body),
            self.assembly.pose(other.unwrap_or(GROUND)),
        );
        let placed = compose(&conjugate(&seen_from.orientation), &own.orientation);
        let seen = seen_from.rotation.tr_mul(&unit(axis));
        let from = from.unwrap_or_default();
        let before = match from {
            CountedFrom::Axes => rotation::twist(&placed, &seen).re(),
            CountedFrom::Placement => 0.0,
        };
        Rotation {
            body: self.body(body),
            relative_to: other.and_then(|other| self.assembly.index(other)),
            axis: seen,
            placed: match from {
                CountedFrom::Axes => None,
                CountedFrom::Placement => Some(conjugate(&placed)),
            },
            first: turn.map(|turn| turn + before),
            joint: None,
        }
    }

    /// The angle of a joint, as in drives and torsion springs.
    pub(super) fn joint_angle(&self, name: &str) -> Rotation<S> {
        let joint = &self.document.joints[name];
        let [first, second] = joint.between().each_ref().map(|body| Some(body.as_str()));
        let bodies = match first {
            Some(GROUND) => [second, first],
            _ => [first, second],
        };
        let axis = joint.axes()[0].expect("a joint with an angle has an axis");
        let axis = self.assembly.axis(axis);
        let index = self.document.joints.get_index_of(name);
        let counted = index.and_then(|index| self.counted.get(&index).copied());
        let turn = counted.or_else(|| starting_angle(self.document, self.assembly, name));
        let mut rotation = self.rotation(bodies, axis, Some(CountedFrom::Placement), turn);
        // On beams it is that of the sections that the joint holds.
        let (own, other) = self.ends[index.expect("joints are checked")];
        rotation.body = own;
        rotation.relative_to = other;
        rotation.joint = index;
        rotation
    }

    fn gate(&self, gate: &written::Gate) -> Gate<S> {
        let (limit, open) = match (gate.above, gate.below) {
            (Some(limit), _) => (limit, GateSide::Above),
            (None, limit) => (
                limit.expect("a gate has a limit, which is checked when a problem is read"),
                GateSide::Below,
            ),
        };
        let rotation = match (&gate.joint, gate.axis) {
            (Some(joint), _) => self.joint_angle(joint),
            (None, axis) => {
                let axis =
                    axis.expect("a gate has an axis, which is checked when a problem is read");
                let bodies = [gate.body.as_deref(), gate.relative_to.as_deref()];
                self.counted_rotation(bodies, lift3(&Vec3::from(axis)), gate.from)
            }
        };
        Gate {
            rotation,
            limit,
            width: gate.width,
            open,
        }
    }
}

/// A number of one mode: its derivative is not a number where another one has the same.
fn single<S: Scalar>(value: S, repeated: bool) -> S {
    match repeated {
        true => value + S::of_infinitesimal(f64::NAN),
        false => value,
    }
}

/// The range function of this name, and the parameter ρ of its aggregation (`None` for its final
/// value). `None` if there is no such function or it releases no projectile.
pub fn released<'a>(
    document: &'a Document,
    name: &str,
) -> Option<(&'a written::Range, Option<f64>)> {
    let (instant, during, rho) = match document.functions.get(name)?.of_motion()? {
        OfMotion::Ks(ks) => (&ks.of, ks.during.as_ref(), Some(rho_of(ks.rho))),
        OfMotion::InducedExponential(own) => (&own.of, own.during.as_ref(), Some(rho_of(own.rho))),
        OfMotion::Final(over) => (over.of(), over.during(), None),
        OfMotion::Integral(_)
        | OfMotion::Mean(_)
        | OfMotion::MeanSquare(_)
        | OfMotion::MeanAbsolute(_)
        | OfMotion::FatigueDamage(_)
        | OfMotion::Value(_)
        | OfMotion::Misfit(_)
        | OfMotion::Clearance(_)
        | OfMotion::Duration
        | OfMotion::Mass
        | OfMotion::Frequency(_)
        | OfMotion::LowestFrequency(_)
        | OfMotion::DampingRatio(_)
        | OfMotion::CriticalSpeed(_) => return None,
    };
    // A release is one of the whole run.
    if during.is_some() {
        return None;
    }
    match instant {
        written::Instant::Range(range) => Some((range, rho)),
        _ => None,
    }
}
