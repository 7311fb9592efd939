//! Flexible bodies of finite elements: inertial and elastic forces, and all their derivatives, as sums over
//! elements.

mod damping;
mod each;
mod element;
mod emit;
mod inertia;
mod orientation;
mod parts;
mod products;
mod stiffness;
mod stress;

pub use damping::{add_damping, pull_damping};
pub use each::SIDE_BY_SIDE;
pub use element::{gather, per_area};
pub use emit::{emit_diagonal, emit_jacobian, emit_mass};
pub use inertia::{
    first_moment, inertial, moving, pull_back, pull_first_moment, pull_kinetic, weights,
};
pub use orientation::{inside_out, turned};
pub use parts::{of_axial_strains, part_tangent};
pub use products::{strain_products, without_strains};
pub use stiffness::{add_forces, diagonal, energy, factors, pull_energy, pull_forces, tangent};
pub use stress::{pull_stress_ratios, stress_ratios};
