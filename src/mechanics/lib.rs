//! Mechanics of flexbody: what a machine is, its equations, their integration, and exact gradients
//! of functions of its motion.

pub mod adjoint;
pub mod functions;
pub mod integrate;
pub mod lower;
pub mod model;
pub mod structures;
pub mod system;

use flexbody_mathematics::{linalg, math};
