//! Flexible bodies of finite elements: inertial and elastic forces, and all their derivatives, as sums over
//! elements.

mod damping;
mod each;
mod element;
mod emit;
mod inertia;
mod orientation;
mod parts;
mod stiffness;
mod stress;

pub(crate) use damping::{add_damping, pull_damping};
pub(crate) use each::SIDE_BY_SIDE;
pub(crate) use element::{gather, per_area};
pub(crate) use emit::{emit_diagonal, emit_jacobian, emit_mass};
pub(crate) use inertia::{
    first_moment, inertial, moving, pull_back, pull_first_moment, pull_kinetic, weights,
};
pub(crate) use orientation::{inside_out, turned};
pub(crate) use parts::{of_axial_strains, part_tangent};
pub(crate) use stiffness::{
    add_forces, diagonal, energy, factors, pull_energy, pull_forces, tangent,
};
pub(crate) use stress::{pull_stress_ratios, stress_ratios};
