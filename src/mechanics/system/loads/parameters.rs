//! Adds the derivatives of a load's power to the cotangents of its parameters.

use super::pull::Pulled;
use super::{bushing, contact, drag, spring, stop};
use crate::model::{JointFrame, LoadKind, Model};

/// Adds the derivatives in a load's parameters to the cotangent of the model, and that in time to
/// `by_time`. Functions of time are differentiated. `end` is that of the capsule which a contact has, or 0.
pub(super) fn give_to_parameters(
    kind: &LoadKind<f64>,
    pulled: &Pulled<f64>,
    (load, end, now): (usize, f64, f64),
    (model, by_time): (&mut Model<f64>, &mut f64),
) {
    let [s0, s1, s2, s3, ..] = pulled.scalars;
    let own = &mut model.loads[load].kind;
    match (kind, own) {
        (
            LoadKind::Force { magnitude, .. },
            LoadKind::Force {
                point,
                direction,
                magnitude: own,
                ..
            },
        ) => {
            *point += pulled.a.frame.point;
            *direction += pulled.direction;
            *by_time += magnitude.pull_back(now, [s0, 0.0, 0.0], own);
        }
        (
            LoadKind::Torque { magnitude, .. },
            LoadKind::Torque {
                direction,
                magnitude: own,
                ..
            },
        ) => {
            *direction += pulled.direction;
            *by_time += magnitude.pull_back(now, [s0, 0.0, 0.0], own);
        }
        (
            LoadKind::Spring { tables, .. },
            LoadKind::Spring {
                point_a,
                point_b,
                rest_length,
                stiffness,
                cubic,
                damping,
                tables: own,
                ..
            },
        ) => {
            *point_a += pulled.a.frame.point;
            *point_b += pulled.b.frame.point;
            *rest_length += s0;
            *stiffness += s1;
            *cubic += s2;
            *damping += s3;
            spring::give_tables(pulled, tables, own);
        }
        (
            LoadKind::TorsionSpring { joint, tables, .. },
            LoadKind::TorsionSpring {
                rest_angle,
                stiffness,
                cubic,
                damping,
                tables: own,
                ..
            },
        ) => {
            *rest_angle += s0;
            *stiffness += s1;
            *cubic += s2;
            *damping += s3;
            spring::give_tables(pulled, tables, own);
            give_to_joint(model, *joint, pulled);
        }
        (
            LoadKind::Damping { joint, table, .. },
            LoadKind::Damping {
                coefficient,
                table: own,
                ..
            },
        ) => {
            *coefficient += s0;
            if let (Some(table), Some(own)) = (table, own) {
                table.pull_back(pulled.places[1], [pulled.by_tables[1], 0.0], own);
            }
            give_to_joint(model, *joint, pulled);
        }
        (LoadKind::BallDamping { .. }, LoadKind::BallDamping { coefficient, .. }) => {
            *coefficient += s0;
        }
        (
            LoadKind::Bushing {
                joint, of_second, ..
            },
            LoadKind::Bushing {
                stiffness,
                damping,
                friction,
                ..
            },
        ) => {
            if let Some(own) = friction {
                own.coefficient += s0;
                own.radius += s1;
                own.width += s2;
                own.load_width += s3;
            }
            if let Some(six) = &pulled.six {
                bushing::give(six, stiffness, damping);
            }
            let [a, b] = [&pulled.a.frame, &pulled.b.frame];
            give_to_frames(model, *joint, if *of_second { [b, a] } else { [a, b] });
        }
        (LoadKind::Friction { joint, .. }, LoadKind::Friction { size, width, .. }) => {
            *size += s0;
            *width += s1;
            give_to_joint(model, *joint, pulled);
        }
        (LoadKind::JointStop { joint, .. }, LoadKind::JointStop { limits, law, .. }) => {
            stop::give(&pulled.scalars, limits, law);
            give_to_joint(model, *joint, pulled);
        }
        (
            LoadKind::DistanceStop { .. },
            LoadKind::DistanceStop {
                point_a,
                point_b,
                limits,
                law,
                ..
            },
        ) => {
            *point_a += pulled.a.frame.point;
            *point_b += pulled.b.frame.point;
            stop::give(&pulled.scalars, limits, law);
        }
        (
            LoadKind::Drag { .. },
            LoadKind::Drag {
                point,
                coefficient,
                width,
                plate,
                ..
            },
        ) => {
            *point += pulled.a.frame.point;
            *coefficient += pulled.scalars[drag::COEFFICIENT];
            *width += pulled.scalars[drag::WIDTH];
            if let Some(own) = plate {
                own.normal += pulled.direction;
                own.coefficient += pulled.scalars[drag::PLATE];
            }
        }
        (LoadKind::Contact(_), LoadKind::Contact(own)) => contact::give(pulled, end, own),
        (LoadKind::Distributed(_), LoadKind::Distributed(_))
        | (LoadKind::Cable(_), LoadKind::Cable(_))
        | (LoadKind::Controller(_), LoadKind::Controller(_)) => {}
        (
            LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Distributed(_)
            | LoadKind::Controller(_)
            | LoadKind::Cable(_)
            | LoadKind::Spring { .. }
            | LoadKind::TorsionSpring { .. }
            | LoadKind::Damping { .. }
            | LoadKind::BallDamping { .. }
            | LoadKind::Bushing { .. }
            | LoadKind::Friction { .. }
            | LoadKind::Drag { .. }
            | LoadKind::JointStop { .. }
            | LoadKind::DistanceStop { .. }
            | LoadKind::Contact(_),
            _,
        ) => unreachable!("a cotangent has the kind of its load"),
    }
}

pub(super) fn give_to_joint(model: &mut Model<f64>, joint: usize, pulled: &Pulled<f64>) {
    give_to_frames(model, joint, [&pulled.a.frame, &pulled.b.frame]);
}

fn give_to_frames(model: &mut Model<f64>, joint: usize, [a, b]: [&JointFrame<f64>; 2]) {
    let joint = &mut model.joints[joint];
    let add = |own: &mut JointFrame<f64>, by: &JointFrame<f64>| {
        own.point += by.point;
        for k in 0..3 {
            own.axes[k] += by.axes[k];
        }
    };
    add(&mut joint.frame_a, a);
    add(&mut joint.frame_b, b);
}
