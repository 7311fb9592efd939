//! Interfaces of a free body: their motions, and the motions that remain when the frame is held.

use super::free_body::{COMPONENTS, FreeBody};
use crate::math::Vec3;
use nalgebra::SymmetricEigen;

/// A motion of several nodes below this part of its size does not exist.
const NOTHING: f64 = 1e-9;

/// A part of the body that moves as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// Its name.
    pub name: String,
    /// Its nodes.
    pub nodes: Vec<usize>,
}

/// What holds the frame of the body, by the indices of interfaces.
#[derive(Clone, Debug, PartialEq)]
pub enum Holding {
    /// The frame moves and turns with this interface.
    Clamped(usize),
    /// The frame's origin is at the first; its chord runs through the second; it turns about the chord with the
    /// third, or with the first.
    Chord(usize, usize, Option<usize>),
}

/// Why a body cannot be reduced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoReduction {
    #[error("{0}")]
    Interior(String),
    #[error("the interface \"{interface}\" has no {component}")]
    Without {
        /// Name of the interface.
        interface: String,
        /// Name of a component.
        component: &'static str,
    },
    #[error(
        "nodes of the interface \"{interface}\" that do not hold a rotation about the line through them"
    )]
    OnALine {
        /// Name of the interface.
        interface: String,
    },
    #[error("interfaces at one place or in one line hold no frame")]
    Collinear,
    #[error(
        "numbers of so few digits that by rounding alone a stiffness of the reduced body is uncertain by \
         {part:.0e} of itself"
    )]
    Digits {
        /// Standard deviation of the stiffness of a coordinate, relative to it.
        part: f64,
    },
    #[error("what holds the frame leaves a rigid motion of the body")]
    Loose,
    #[error("the search for fixed-interface modes did not converge: {found} of {asked} were found")]
    NoConvergence {
        /// Requested number.
        asked: usize,
        /// Number found.
        found: usize,
    },
    #[error("no static or fixed-interface mode, so no elastic coordinate")]
    Nothing,
}

/// A motion of an interface.
pub(super) struct Column {
    pub interface: usize,
    pub displacement: Vec3<f64>,
    pub rotation: Vec3<f64>,
    pub name: String,
}

/// The motions of an interface.
pub(super) struct Abilities {
    pub centre: Vec3<f64>,
    pub displacements: [bool; 3],
    pub rotations: [bool; 3],
}

pub(super) fn abilities(free: &FreeBody, interface: &Interface) -> Result<Abilities, NoReduction> {
    let mut there = vec![[false; 6]; interface.nodes.len()];
    for unknown in &free.unknowns {
        if let Some(at) = interface
            .nodes
            .iter()
            .position(|&node| node == unknown.node)
        {
            there[at][unknown.component] = true;
        }
    }
    let places = || interface.nodes.iter().map(|&node| free.nodes[node]);
    let centre = places().sum::<Vec3<f64>>() / interface.nodes.len() as f64;
    if let [only] = there[..] {
        return Ok(Abilities {
            centre,
            displacements: [only[0], only[1], only[2]],
            rotations: [only[3], only[4], only[5]],
        });
    }
    if let Some(k) = (0..3).find(|&k| there.iter().any(|node| !node[k])) {
        return Err(NoReduction::Without {
            interface: interface.name.clone(),
            component: COMPONENTS[k],
        });
    }
    // A rotation exists if it moves or turns a node, whatever its axis.
    let turns = there
        .iter()
        .any(|node| node[3..].iter().all(|there| *there));
    let spread = places().fold(nalgebra::Matrix3::zeros(), |sum, place| {
        let arm = (place - centre).cross_matrix();
        sum + arm.transpose() * arm
    });
    let values = SymmetricEigen::new(spread).eigenvalues;
    if !turns && values.min() <= NOTHING * values.max() {
        return Err(NoReduction::OnALine {
            interface: interface.name.clone(),
        });
    }
    Ok(Abilities {
        centre,
        displacements: [true; 3],
        rotations: [true; 3],
    })
}

/// The boundary modes that remain when the frame is held.
pub(super) fn columns(
    interfaces: &[Interface],
    abilities: &[Abilities],
    holding: &Holding,
) -> Result<Vec<Column>, NoReduction> {
    let needs = |k: usize, rotations: bool| {
        let can = &abilities[k];
        let all = can.displacements.iter().chain(&can.rotations);
        let wanted = if rotations { 6 } else { 3 };
        match all.take(wanted).position(|there| !*there) {
            Some(component) => Err(NoReduction::Without {
                interface: interfaces[k].name.clone(),
                component: COMPONENTS[component],
            }),
            None => Ok(()),
        }
    };
    let unit = |k: usize| Vec3::ith(k, 1.0);
    let mut all = Vec::new();
    let mut add = |interface: usize, turn: bool, axis: Vec3<f64>, name: String| {
        let (displacement, rotation) = match turn {
            true => (Vec3::zeros(), axis),
            false => (axis, Vec3::zeros()),
        };
        all.push(Column {
            interface,
            displacement,
            rotation,
            name,
        });
    };
    // Axes of the chord: along it, and two across; the last is normal to the plane of three interfaces.
    let axes = match *holding {
        Holding::Clamped(_) => [unit(0), unit(1), unit(2)],
        Holding::Chord(o, b, c) => {
            let line = abilities[b].centre - abilities[o].centre;
            let along = line.try_normalize(0.0).ok_or(NoReduction::Collinear)?;
            let other = match c {
                Some(c) => abilities[c].centre - abilities[o].centre,
                None => unit(along.iamin()),
            };
            let across = other - along * along.dot(&other);
            if across.norm() <= NOTHING * line.norm().max(other.norm()) {
                return Err(NoReduction::Collinear);
            }
            let across = across.normalize();
            [along, across, along.cross(&across)]
        }
    };
    const OF_CHORD: [&str; 3] = ["along the chord", "across the chord", "out of the plane"];
    for (k, can) in abilities.iter().enumerate() {
        // Which of the displacements and of the rotation about the chord the frame has.
        let (held, turn) = match *holding {
            Holding::Clamped(held) if held == k => {
                needs(k, true)?;
                continue;
            }
            Holding::Chord(o, _, c) if o == k => ([true; 3], c.is_none()),
            Holding::Chord(_, b, _) if b == k => ([false, true, true], false),
            Holding::Chord(_, _, Some(c)) if c == k => ([false, false, true], false),
            Holding::Clamped(_) | Holding::Chord(..) => ([false; 3], false),
        };
        if held.contains(&true) {
            needs(k, turn)?;
        }
        for i in 0..3 {
            if held.contains(&true) {
                if !held[i] {
                    add(k, false, axes[i], format!("displacement {}", OF_CHORD[i]));
                }
            } else if can.displacements[i] {
                add(k, false, unit(i), COMPONENTS[i].to_owned());
            }
        }
        for i in 0..3 {
            if turn {
                if i > 0 {
                    let names = [
                        "",
                        "rotation about the first normal of the chord",
                        "rotation about its second normal",
                    ];
                    add(k, true, axes[i], names[i].to_owned());
                }
            } else if can.rotations[i] {
                add(k, true, unit(i), COMPONENTS[3 + i].to_owned());
            }
        }
    }
    Ok(all)
}
