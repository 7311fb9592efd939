//! Functions of the structures of a file.

use super::mesh::of_file;
use crate::aggregates::rho_of;
use crate::math::Vec3;
use crate::schema::Document;
use crate::schema::functions::Function as Written;
use crate::schema::misfit::{MeasuredNumber, Misfit, Variance};
use crate::schema::statics::StressAggregate;
use crate::structures::functions::{Aggregate, Function};

/// A function of structures.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// Of the structure and its static solutions.
    OfSolutions(Function),
    /// Natural frequency \[Hz\].
    Frequency {
        /// Its number from 0.
        mode: usize,
        /// Whether its mode is followed by the shape that it has at the start.
        follow: bool,
    },
    /// Smooth lower bound of all frequencies with this ρ \[Hz\].
    LowestFrequency(f64),
    /// Mean square of the distances of other functions from measured values, in standard deviations.
    Misfit {
        /// The functions and their values.
        numbers: Vec<MeasuredFunction>,
        /// Whether the standard deviations are those of the data, and not only in proportion to them.
        given: bool,
    },
    /// Σ ((x − x0)/scale)² of the design.
    DistanceFromStart,
}

/// A measured value of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredFunction {
    /// The function, by index.
    pub function: usize,
    /// The value, in the unit of the function.
    pub value: f64,
    /// One by its standard deviation.
    pub weight: f64,
}

impl Asked {
    /// SI unit of its values.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::OfSolutions(function) => match function {
                Function::Mass => "kg",
                Function::Centre(_) | Function::Displacement { .. } => "m",
                Function::SecondMoment(..) | Function::Inertia(..) => "kg m²",
                Function::Reaction { .. } => "N",
                Function::ReactionMoment { .. } => "N m",
                Function::StrainEnergy { .. } | Function::Compliance { .. } => "J",
                Function::Stress { .. } => "1",
            },
            Self::Frequency { .. } | Self::LowestFrequency(_) => "Hz",
            Self::Misfit { .. } | Self::DistanceFromStart => "1",
        }
    }
}

/// The functions of a checked document.
pub(super) fn asked(document: &Document, cuts: usize) -> Vec<Asked> {
    let functions = document.functions.values();
    functions
        .map(|function| of(document, function, cuts))
        .collect()
}

fn of(document: &Document, function: &Written, cuts: usize) -> Asked {
    let case = |name: &str| {
        let index = document.load_cases.get_index_of(name);
        index.expect("names are checked before")
    };
    let v = |direction: &[f64; 3]| Vec3::from(*direction);
    Asked::OfSolutions(match function {
        Written::Mass => Function::Mass,
        Written::CentreOfMass(centre) => Function::Centre(v(&centre.direction)),
        Written::MomentOfInertia(inertia) => {
            let other = inertia.other.as_ref().unwrap_or(&inertia.axis);
            Function::Inertia(v(&inertia.axis), v(other))
        }
        Written::StrainEnergy(of) => Function::StrainEnergy {
            case: case(&of.case),
        },
        Written::Compliance(of) => Function::Compliance {
            case: case(&of.case),
        },
        Written::Displacement(of) => Function::Displacement {
            case: case(&of.case),
            nodes: of_file(&of.nodes, cuts),
            direction: v(&of.direction),
        },
        Written::Reaction(of) => Function::Reaction {
            case: case(&of.case),
            nodes: of.nodes.clone(),
            direction: v(&of.direction),
        },
        Written::ReactionMoment(of) => Function::ReactionMoment {
            case: case(&of.case),
            nodes: of.nodes.clone(),
            axis: v(&of.axis),
            about: of.about.as_ref().map_or(Vec3::zeros(), v),
        },
        Written::VonMises(stress) => {
            let cases = match &stress.cases {
                Some(names) => names.iter().map(|name| case(name)).collect(),
                None => (0..document.load_cases.len()).collect(),
            };
            let aggregate = match stress.aggregate {
                StressAggregate::Ks => Aggregate::Ks,
                StressAggregate::InducedExponential => Aggregate::InducedExponential,
            };
            Function::Stress {
                cases,
                faces: stress.elements.clone().unwrap_or_else(|| "all".into()),
                rho: rho_of(stress.rho),
                aggregate,
            }
        }
        Written::Frequency(own) => {
            return Asked::Frequency {
                mode: own.mode - 1,
                follow: own.follow,
            };
        }
        Written::Misfit(misfit) => return of_numbers(document, misfit),
        Written::LowestFrequency(lowest) => return Asked::LowestFrequency(rho_of(lowest.rho)),
        Written::Ks(_)
        | Written::InducedExponential(_)
        | Written::Integral(_)
        | Written::Final(_)
        | Written::Mean(_)
        | Written::MeanSquare(_)
        | Written::MeanAbsolute(_)
        | Written::FatigueDamage(_)
        | Written::Value(_)
        | Written::Clearance(_)
        | Written::Duration
        | Written::EventTime(_)
        | Written::OverCases(_)
        | Written::DampingRatio(_)
        | Written::CriticalSpeed(_)
        | Written::Expression(_) => {
            unreachable!(
                "functions of a motion are refused before, and expressions are no functions of structures"
            )
        }
    })
}

fn of_numbers(document: &Document, misfit: &Misfit) -> Asked {
    let measured = |own: &MeasuredNumber| MeasuredFunction {
        function: (document.functions.get_index_of(&own.function))
            .expect("names are checked before"),
        value: own.value,
        weight: own.standard_deviation.map_or(1.0, |sd| 1.0 / sd),
    };
    Asked::Misfit {
        numbers: misfit.numbers.iter().map(measured).collect(),
        given: misfit.variance() == Variance::Given,
    }
}
