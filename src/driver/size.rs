//! The sizes of functions of a motion, of which their last digits are a part.

use super::evaluate::Evaluated;
use crate::functions::seen::SeenPart;
use crate::functions::series::Series;
use crate::functions::snapshot::Snapshot;
use crate::functions::{Function, Instant, Operation, Quantity, Reduction, VibrationPart};
use crate::model::flexible::Quadratic;
use crate::model::{DegreeOfFreedom, ForceTable, LoadKind};
use crate::system::loads::measured::LoadPart;
use crate::system::measures::WrenchPart;
use crate::system::placement::length_scale;

/// The size of function f that determines its round-off: its value, or the size of its kind in a
/// scene of this length L and duration T, as a value may be a difference.
pub(super) fn function_size(at: &Evaluated, f: usize) -> f64 {
    if at.composition.gives(f) {
        let terms = at.partials(f).by_function.into_iter();
        let terms = terms.filter(|(_, by)| *by != 0.0);
        let sizes = terms.map(|(g, by)| by.abs() * function_size(at, g));
        return sizes.sum::<f64>().max(at.value(f).abs());
    }
    let (length, time) = (length_scale(&at.scene.model), at.run.duration);
    let (of, reduction) = match &at.scene.functions[f] {
        Function::Reduced { of, reduction, .. } => (of, *reduction),
        Function::Clearance { .. } => return length.max(at.function(f).value.abs()),
        // Its terms are squares of distances in standard deviations, whose last digits are those of the values.
        Function::Misfit { series } => {
            let value = at.function(f).value.abs();
            return value.max(largest_datum(series) * value.sqrt());
        }
        Function::Duration => return time,
        Function::LowestFrequency { .. } => return at.function(f).value.abs(),
        Function::OfDesign { value, .. } => return value.abs().max(1.0),
    };
    let size = match reduction {
        Reduction::Integral => size_of(at, of) * time,
        // A sum of terms of one sign.
        Reduction::Damage { .. } => 0.0,
        Reduction::Final
        | Reduction::Mean
        | Reduction::Ks { .. }
        | Reduction::InducedExponential { .. } => size_of(at, of),
    };
    size.max(at.function(f).value.abs())
}

/// The largest of measured values, in standard deviations.
pub(super) fn largest_datum(series: &[Series<f64>]) -> f64 {
    let largest = |own: &Series<f64>| {
        let data = own.data.values.iter().zip(&own.data.weights);
        data.map(|(d, weight)| (d * weight).abs())
            .fold(0.0, f64::max)
    };
    series.iter().map(largest).fold(0.0, f64::max)
}

/// The size of a quantity in a scene.
fn size_of(at: &Evaluated, of: &Quantity<f64>) -> f64 {
    match of {
        Quantity::Of(instant) => size_of_instant(at, instant),
        Quantity::Combined { operation, of } => {
            let all: Vec<f64> = of.iter().map(|own| size_of(at, own)).collect();
            match operation {
                Operation::Sum | Operation::Difference => all.iter().fold(0.0, |a, &b| a.max(b)),
                Operation::Product => all.iter().product(),
                Operation::Quotient => all[0] / all[1],
                Operation::Square => all[0] * all[0],
                Operation::Absolute { .. } => all[0],
                Operation::Rate => all[0] / at.run.duration,
            }
        }
    }
}

fn size_of_instant(at: &Evaluated, instant: &Instant<f64>) -> f64 {
    let model = &at.scene.model;
    let (length, time) = (length_scale(model), at.run.duration);
    match instant {
        Instant::Position { .. } | Instant::Range { .. } => length,
        Instant::Velocity { .. } | Instant::Speed { .. } => length / time,
        Instant::Acceleration { .. } => length / (time * time),
        Instant::SpeedSquared { .. } => length * length / (time * time),
        Instant::Rotation(_) => 1.0,
        Instant::AngularVelocity { .. } => 1.0 / time,
        Instant::Momentum { .. } => {
            let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
            mass * length / time
        }
        Instant::ShellStress { .. } => 1.0,
        Instant::Vibration(of) => match of.part {
            VibrationPart::Frequency => 1.0 / time,
            VibrationPart::DampingRatio => 1.0,
        },
        Instant::AngularMomentum(_) => {
            let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
            mass * length * length / time
        }
        Instant::Deformation {
            flexible,
            unknowns,
            form,
            ..
        } => form_size(form, &largest_of(at, *flexible, unknowns.as_deref())),
        Instant::LargestDeformation {
            flexible,
            unknowns,
            largest,
            ..
        } => {
            let most = largest_of(at, *flexible, unknowns.as_deref());
            let sizes = largest.forms.iter().map(|form| form_size(form, &most));
            sizes.fold(0.0, f64::max)
        }
        Instant::Slide(_) => length,
        Instant::Felt { .. } => length / (time * time),
        Instant::Seen(seen) => match seen.part {
            SeenPart::Position | SeenPart::Distance => length,
            SeenPart::Velocity => length / time,
        },
        Instant::JointRate { dof, .. } => match dof {
            DegreeOfFreedom::Rotation => 1.0 / time,
            DegreeOfFreedom::Translation => length / time,
        },
        Instant::Power(_) => {
            let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
            mass * (model.gravity.norm() + length / (time * time)) * length / time
        }
        Instant::Reaction(_) | Instant::Energy(_) | Instant::StrainEnergy(_) => {
            let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
            let force = mass * (model.gravity.norm() + length / (time * time));
            match instant {
                Instant::Reaction(wrench) if wrench.part == WrenchPart::Force => force,
                _ => force * length,
            }
        }
        Instant::Load(measure) => match (measure.part, &model.loads[measure.load].kind) {
            (
                LoadPart::Tension,
                LoadKind::Spring {
                    stiffness, tables, ..
                },
            ) => (stiffness + steepest(tables)) * length,
            (
                LoadPart::Torque,
                LoadKind::TorsionSpring {
                    stiffness, tables, ..
                },
            ) => stiffness + steepest(tables),
            (LoadPart::PenetrationAngle | LoadPart::ErrorAngle, _) => 1.0,
            (LoadPart::EffortForce | LoadPart::EffortTorque, _) => {
                let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
                let force = mass * (model.gravity.norm() + length / (time * time));
                match measure.part {
                    LoadPart::EffortForce => force,
                    _ => force * length,
                }
            }
            (LoadPart::Tension, LoadKind::Cable(own)) => own.law.stiffness * length,
            (LoadPart::NormalForce, LoadKind::JointStop { law, .. })
            | (LoadPart::NormalForce, LoadKind::DistanceStop { law, .. }) => law.stiffness * length,
            (LoadPart::NormalForce, LoadKind::Contact(own)) => own.law.stiffness * length,
            (LoadPart::Friction, LoadKind::Contact(own)) => {
                own.friction.coefficient * own.law.stiffness * length
            }
            (LoadPart::SlipPower, LoadKind::Contact(own)) => {
                own.friction.coefficient * own.law.stiffness * length * length / time
            }
            (LoadPart::NormalTorque, LoadKind::JointStop { law, .. }) => law.stiffness,
            _ => length,
        },
    }
}

/// The largest slope of the table of a spring.
fn steepest(tables: &[Option<ForceTable<f64>>; 2]) -> f64 {
    tables[0].as_ref().map_or(0.0, ForceTable::steepest)
}

/// The largest of each elastic coordinate in the motion, or of each of these unknowns of nodes.
fn largest_of(at: &Evaluated, flexible: usize, unknowns: Option<&[usize]>) -> Vec<f64> {
    let mut most: Vec<f64> = Vec::new();
    for k in 0..=at.run.last() {
        let now = Snapshot::of(&at.scene.model, &at.run, k).unknowns(flexible, unknowns);
        most.resize(now.len(), 0.0);
        for (most, x) in most.iter_mut().zip(now) {
            *most = most.max(x.abs());
        }
    }
    most
}

/// The size of a form by the largest of each coordinate.
fn form_size(form: &Quadratic<f64>, most: &[f64]) -> f64 {
    let terms = form.linear.iter().zip(most).map(|(b, most)| b.abs() * most);
    terms.fold(0.0, f64::max)
}
