//! The numbers of a body from files at a design.

use crate::math::Scalar;
use crate::quantity::Quantity;
use crate::schema::flexible::Deformation;
use crate::schema::modal::{Modal, ModalDamping};
use crate::structures::damping::RayleighDamping;
use crate::structures::modal::ModalNumbers;
use crate::structures::modal::imported::{Factors, ImportedDamping};

/// The numbers of a body at the design `x`. Its files are read.
pub fn numbers<S: Scalar>(modal: &Modal, x: &[S]) -> ModalNumbers<S> {
    let or = |quantity: Option<Quantity>, other: f64| quantity.map_or(S::from(other), |q| q.get(x));
    let damping = modal.damping.as_ref();
    let of = |key: fn(&ModalDamping) -> Option<Quantity>| or(damping.and_then(key), 0.0);
    let factors = Factors {
        young: or(modal.young_factor, 1.0),
        density: or(modal.density_factor, 1.0),
        length: scale(modal, x),
    };
    let damping = ImportedDamping {
        ratio: of(|damping| damping.ratio),
        rayleigh: RayleighDamping {
            mass: of(|damping| damping.mass),
            stiffness: of(|damping| damping.stiffness),
        },
    };
    modal.body().numbers(&factors, &damping)
}

/// Factor of the lengths of a body.
pub fn scale<S: Scalar>(modal: &Modal, x: &[S]) -> S {
    modal.scale.map_or(S::one(), |scale| scale.get(x))
}

/// Elastic coordinates and their rates at the start.
pub fn start<S: Scalar>(start: Option<&Deformation>, count: usize, x: &[S]) -> [Vec<S>; 2] {
    let row = |given: Option<&Vec<Quantity>>| {
        let mut all: Vec<S> = given.into_iter().flatten().map(|q| q.get(x)).collect();
        all.resize(count, S::zero());
        all
    };
    [
        row(start.and_then(|start| start.coordinates.as_ref())),
        row(start.and_then(|start| start.rates.as_ref())),
    ]
}
