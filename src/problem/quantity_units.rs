//! Units that only the scene of the first design shows: of sums, and of values that a quantity reaches.

use super::Problem;
use super::finding::Finding;
use super::pointer::{join, keys};
use super::variables::Variable;
use crate::functions::{Edge, Function, Scene};
use crate::model::controller::Coordinate;
use crate::model::{DegreeOfFreedom, LoadKind};

/// The unit of a value of a quantity in the schema.
const OF_QUANTITY: &str = "that of the quantity";

/// Between the units of a number of a slide and of a turn, in the schema.
const OR: &str = " or ";

/// Gives numbers of loads in joints the unit of the joint's motion.
pub(super) fn name_units_of_joints(variables: &mut [Variable], scene: &Scene<f64>) {
    for variable in variables.iter_mut() {
        let Some((slide, turn)) = variable.unit.split_once(OR) else {
            continue;
        };
        let slides = variable.paths.iter().find_map(|path| {
            let keys = keys(path);
            let name = keys.get(1).filter(|_| keys[0] == "loads")?;
            let load = scene.model.loads.iter().find(|load| load.name == *name)?;
            match load.kind {
                LoadKind::Controller(ref own) => {
                    let other = (keys.get(3).filter(|key| *key == "feedback"))
                        .and_then(|_| keys.get(4)?.parse::<usize>().ok());
                    let of = own.feedback.get(other.map_or(0, |other| 1 + other))?;
                    Some(match of.coordinate {
                        Coordinate::Joint { dof, .. } => dof == DegreeOfFreedom::Translation,
                        Coordinate::Distance { .. } => true,
                    })
                }
                LoadKind::Spring { .. } | LoadKind::DistanceStop { .. } => Some(true),
                LoadKind::Damping { dof, .. }
                | LoadKind::Friction { dof, .. }
                | LoadKind::JointStop { dof, .. } => Some(dof == DegreeOfFreedom::Translation),
                LoadKind::TorsionSpring { .. } | LoadKind::BallDamping { .. } => Some(false),
                _ => None,
            }
        });
        if let Some(slides) = slides {
            variable.unit = if slides { slide } else { turn }.to_owned();
        }
    }
    for variable in variables {
        let exponent = variable.paths.iter().find_map(|path| exponent(path, scene));
        if let Some(exponent) = exponent.filter(|n| *n != 1.0) {
            variable.unit = format!("{}^{exponent}", variable.unit);
        }
    }
}

/// The exponent of the normal law whose stiffness is at a path.
fn exponent(path: &str, scene: &Scene<f64>) -> Option<f64> {
    let keys = keys(path);
    let [section, name, _, key] = &keys[..] else {
        return None;
    };
    let load = scene.model.loads.iter().find(|load| load.name == *name)?;
    if section != "loads" || key != "stiffness" {
        return None;
    }
    match &load.kind {
        LoadKind::JointStop { law, .. } | LoadKind::DistanceStop { law, .. } => Some(law.exponent),
        LoadKind::Contact(contact) => Some(contact.law.exponent),
        _ => None,
    }
}

/// Gives variables that are values of a quantity the unit of that quantity, also where a parameter gives the number.
pub(super) fn name_units(variables: &mut [Variable], names: &[String], scene: &Scene<f64>) {
    let values = variables.iter_mut();
    for variable in values.filter(|variable| variable.unit == OF_QUANTITY) {
        let of_function = variable.paths.iter().find_map(|path| {
            let keys = keys(path);
            let [section, name, .., end, _] = &keys[..] else {
                return None;
            };
            let f = names.iter().position(|own| own == name)?;
            let function = scene.functions.get(f).filter(|_| section == "functions")?;
            reached(function, end)
        });
        let until = scene.until.as_ref().map(|until| until.measure.unit());
        if let Some(unit) = of_function.or(until) {
            variable.unit = unit;
        }
    }
}

/// The unit of the quantity whose value is an end of the function's window.
fn reached(function: &Function<f64>, end: &str) -> Option<String> {
    let Function::Reduced {
        during: Some(window),
        ..
    } = function
    else {
        return None;
    };
    let edge = match end {
        "from" => &window.from,
        _ => &window.to,
    };
    edge.quantity().map(|quantity| quantity.unit())
}

/// The fault of a sum or difference of quantities of different units.
pub(super) fn mismatched(problem: &Problem) -> Option<Finding> {
    let scene = problem.unlowered_scene::<f64>(&problem.start());
    let named = problem.function_names.iter().zip(&scene.functions);
    let of_functions = named.filter_map(|(name, function)| {
        let Function::Reduced { of, during, .. } = function else {
            return None;
        };
        let edges = during.iter().flat_map(|own| [&own.from, &own.to]);
        let mut all = std::iter::once(of).chain(edges.filter_map(Edge::quantity));
        Some((
            join("/functions", name),
            all.find_map(|own| own.mismatch())?,
        ))
    });
    let until = scene.until.iter().filter_map(|until| {
        let units = until.measure.quantity()?.mismatch()?;
        Some(("/simulation/until/measure".to_owned(), units))
    });
    let (pointer, [first, second]) = of_functions.chain(until).next()?;
    let found = format!("a sum or difference of a quantity in {first} and one in {second}");
    Some(Finding::new(pointer, found, "quantities of one unit"))
}
