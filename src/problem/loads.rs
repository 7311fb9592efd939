//! Makes the loads of a model from those of a file.

use super::bushings::bushing;
use super::contacts::contact as contact_of;
use super::controllers::controller;
use super::courses::course as motion;
use super::elements::prepared;
pub use super::load_ends::named;
use super::load_ends::{course, dof, ends, joint};
use super::placement::Assembly;
use super::spread_loads::dead_shares;
use crate::math::scalar::unit;
use crate::math::{Scalar, Vec3};
use crate::model::load::Plate;
use crate::model::{
    Air, Axes, Cable, CablePoint, DegreeOfFreedom, DistributedLoad, ForceTable, Load, LoadKind,
    NormalLaw, Spread, TimeFunction,
};
use crate::prepared::Prepared;
use crate::quantity::{Quantity, Vector};
use crate::schema::Document;
use crate::schema::loads::{
    Axes as WrittenAxes, Cable as WrittenCable, CableLength, CablePoint as WrittenPoint,
    ForceTable as WrittenTable, Interpolation, Load as WrittenLoad, Stop, TimeFunction as Written,
};
use std::sync::Arc;

/// The loads of a checked document, in its order.
pub fn loads<S: Scalar>(document: &Document, assembly: &Assembly<S>) -> Vec<Load<S>> {
    let one = |(name, written): (&String, &WrittenLoad)| Load {
        name: name.clone(),
        kind: kind(document, assembly, written),
    };
    document.loads.iter().map(one).collect()
}

fn kind<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    written: &WrittenLoad,
) -> LoadKind<S> {
    let get = |quantity: &Quantity| assembly.quantity(quantity);
    let optional = |own: &Option<Quantity>| own.as_ref().map_or(S::zero(), get);
    let table = |own: &Option<WrittenTable>| own.as_ref().map(|own| force_table(assembly, own));
    let body = |name: &str| {
        assembly
            .index(name)
            .expect("a load acts on a body, not on ground")
    };
    let distributed = |name: &str, spread: Spread<S>, magnitude: Written| {
        LoadKind::Distributed(DistributedLoad {
            body: body(name),
            spread,
            magnitude: course(assembly, magnitude),
        })
    };
    let dead = |name: &str, (direction, own): (&Vector, WrittenAxes), magnitude: Written| {
        let shares = dead_shares(&elements(document, name), written);
        let shares = shares.expect("sets of loads are checked when a problem is read");
        let spread = Spread::Dead {
            shares: shares.into_iter().collect(),
            direction: unit(assembly.ground(direction)),
            axes: axes(own),
        };
        distributed(name, spread, magnitude)
    };
    match written {
        WrittenLoad::Force(force) => {
            let pose = assembly.pose(&force.body);
            let from_centre = |point: Vec3<S>| point - pose.centre;
            let point = match (&force.point, &force.at) {
                (Some(point), _) => from_centre(assembly.in_body(&force.body, point)),
                (None, Some(at)) => from_centre(assembly.at_ground(&force.body, at)),
                (None, None) => Vec3::zeros(),
            };
            LoadKind::Force {
                body: body(&force.body),
                point,
                direction: unit(assembly.ground(&force.direction)),
                axes: axes(force.axes),
                magnitude: course(assembly, force.magnitude.parts()),
            }
        }
        WrittenLoad::Torque(torque) => LoadKind::Torque {
            body: body(&torque.body),
            direction: unit(assembly.ground(&torque.direction)),
            axes: axes(torque.axes),
            magnitude: course(assembly, torque.magnitude.parts()),
        },
        WrittenLoad::Spring(spring) => {
            let ends = ends(assembly, &spring.between, &spring.at);
            LoadKind::Spring {
                body_a: ends.body_a,
                body_b: ends.body_b,
                point_a: ends.point_a,
                point_b: ends.point_b,
                rest_length: get(&spring.rest_length),
                stiffness: optional(&spring.stiffness),
                cubic: get(&spring.cubic),
                damping: get(&spring.damping),
                tables: [&spring.table, &spring.damping_table].map(table),
            }
        }
        WrittenLoad::TorsionSpring(spring) => LoadKind::TorsionSpring {
            joint: joint(document, &spring.joint).0,
            counter: None,
            rest_angle: get(&spring.rest_angle),
            stiffness: optional(&spring.stiffness),
            cubic: get(&spring.cubic),
            damping: get(&spring.damping),
            tables: [&spring.table, &spring.damping_table].map(table),
        },
        WrittenLoad::Damping(damping) => {
            let (joint, written) = joint(document, &damping.joint);
            let coefficient = optional(&damping.coefficient);
            match dof(written, damping.motion) {
                Some(dof) => LoadKind::Damping {
                    joint,
                    dof,
                    coefficient,
                    table: table(&damping.table),
                },
                None => LoadKind::BallDamping { joint, coefficient },
            }
        }
        WrittenLoad::Bushing(own) => bushing(document, assembly, own),
        WrittenLoad::Friction(friction) => {
            let (joint, written) = joint(document, &friction.joint);
            LoadKind::Friction {
                joint,
                dof: dof(written, friction.motion)
                    .expect("joints with friction are checked when a problem is read"),
                size: get(&friction.size),
                width: get(&friction.width),
            }
        }
        WrittenLoad::Drag(drag) if drag.faces.is_some() => {
            let sets = &elements(document, &drag.body).sets.face_sets;
            let shells = drag.faces.as_ref().and_then(|faces| sets.get(faces));
            LoadKind::Distributed(DistributedLoad {
                body: body(&drag.body),
                spread: Spread::Air {
                    shells: shells.into_iter().flatten().copied().collect(),
                    air: Air {
                        coefficient: get(&drag.coefficient),
                        normal_coefficient: get(&drag.normal_coefficient),
                        width: get(&drag.width),
                    },
                },
                magnitude: TimeFunction::constant(S::one()),
            })
        }
        WrittenLoad::Drag(drag) => LoadKind::Drag {
            body: body(&drag.body),
            point: drag.point.as_ref().map_or(Vec3::zeros(), |point| {
                assembly.in_body(&drag.body, point) - assembly.pose(&drag.body).centre
            }),
            coefficient: get(&drag.coefficient),
            width: get(&drag.width),
            plate: drag.normal.as_ref().map(|normal| Plate {
                normal: {
                    let turn = assembly.pose(&drag.body).rotation;
                    unit(turn.tr_mul(&assembly.ground(normal)))
                },
                coefficient: get(&drag.normal_coefficient),
            }),
        },
        WrittenLoad::Stop(stop) => stop_of(document, assembly, stop),
        WrittenLoad::Contact(contact) => LoadKind::Contact(contact_of(assembly, contact)),
        WrittenLoad::Cable(own) => LoadKind::Cable(cable_of(document, assembly, own)),
        WrittenLoad::Pressure(load) => {
            let own = elements(document, &load.body);
            let shells = own.sets.face_sets[&load.faces].as_slice().into();
            let spread = Spread::Pressure { shells };
            distributed(&load.body, spread, load.pressure.parts())
        }
        WrittenLoad::Area(load) => {
            let along = (&load.direction, load.axes);
            dead(&load.body, along, load.magnitude.parts())
        }
        WrittenLoad::Edge(load) => {
            let along = (&load.direction, load.axes);
            dead(&load.body, along, load.magnitude.parts())
        }
        WrittenLoad::Controller(own) => LoadKind::Controller(controller(document, assembly, own)),
        WrittenLoad::Line(load) => {
            let along = (&load.direction, load.axes);
            dead(&load.body, along, load.magnitude.parts())
        }
    }
}

fn force_table<S: Scalar>(assembly: &Assembly<S>, table: &WrittenTable) -> ForceTable<S> {
    let forces = table.forces.iter();
    ForceTable {
        interpolation: Interpolation::of(table.interpolation),
        places: table.places.iter().map(|&x| x.into()).collect(),
        forces: forces.map(|force| assembly.quantity(force)).collect(),
    }
}

fn stop_of<S: Scalar>(document: &Document, assembly: &Assembly<S>, stop: &Stop) -> LoadKind<S> {
    let limit = |limit: &Option<Quantity>| limit.as_ref().map(|limit| assembly.quantity(limit));
    let limits = [limit(&stop.lower), limit(&stop.upper)];
    let law = NormalLaw {
        exponent: stop.exponent,
        stiffness: assembly.quantity(&stop.stiffness),
        dissipation: assembly.quantity(&stop.dissipation),
        width: assembly.quantity(&stop.width),
    };
    match (&stop.joint, &stop.between, &stop.at) {
        (Some(name), ..) => LoadKind::JointStop {
            joint: joint(document, name).0,
            dof: stopped(document, stop)
                .expect("joints with stops are checked when a problem is read"),
            counter: None,
            limits,
            law,
        },
        (None, Some(between), Some(at)) => {
            let ends = ends(assembly, between, at);
            LoadKind::DistanceStop {
                body_a: ends.body_a,
                body_b: ends.body_b,
                point_a: ends.point_a,
                point_b: ends.point_b,
                limits,
                law,
            }
        }
        (None, ..) => unreachable!("what a stop stops is checked when a problem is read"),
    }
}

fn cable_of<S: Scalar>(
    document: &Document,
    assembly: &Assembly<S>,
    cable: &WrittenCable,
) -> Cable<S> {
    let point = |own: &WrittenPoint| CablePoint {
        body: assembly.index(&own.body),
        point: own.point.as_ref().map_or(Vec3::zeros(), |point| {
            assembly.in_body(&own.body, point) - assembly.pose(&own.body).centre
        }),
    };
    let length = match &cable.length {
        CableLength::Constant(value) => TimeFunction::constant(assembly.quantity(value)),
        CableLength::Varying(own) => motion(assembly, own.parts()),
    };
    Cable {
        points: cable.points.iter().map(point).collect(),
        // A machine at rest holds a winch as it is at the start.
        length: match document.is_rest() {
            true => TimeFunction::constant(length.value(S::zero())),
            false => length,
        },
        law: NormalLaw {
            exponent: 1.0,
            stiffness: assembly.quantity(&cable.stiffness),
            dissipation: assembly.quantity(&cable.dissipation),
            width: assembly.quantity(&cable.width),
        },
    }
}

/// The degree of freedom of a joint that a stop stops; `None` if it stops a distance.
pub fn stopped(document: &Document, stop: &Stop) -> Option<DegreeOfFreedom> {
    let joint = document.joints.get(stop.joint.as_ref()?)?;
    dof(joint, stop.motion)
}

/// The elements of a body that has some.
fn elements(document: &Document, body: &str) -> Arc<Prepared> {
    let own = document.bodies[body].elements.as_ref();
    let own = own.expect("bodies of distributed loads are checked when a problem is read");
    prepared(document, own)
}

fn axes(written: WrittenAxes) -> Axes {
    match written {
        WrittenAxes::Ground => Axes::Ground,
        WrittenAxes::Body => Axes::Body,
    }
}
