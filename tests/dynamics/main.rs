//! Equations of motion, their integration and their derivatives.

#[path = "../reference/numbers.rs"]
mod numbers;
#[path = "../reference/mod.rs"]
mod reference;

mod checkpoints;
mod conserves;
mod constraint_derivatives;
mod drive_gradients;
mod elimination;
mod energy_is_kept;
mod error_estimate;
mod events;
mod gradients_converge_to_references;
mod gradients_match_complex_step;
mod initial_conditions;
mod joint_starts;
mod joint_starts_in_loops;
mod joints_and_drives;
mod limits_of_rounding;
mod load_derivatives;
mod loads;
mod lowering;
mod methods_match_references;
mod planar_joints;
mod reactions_carry_weight;
mod redundant_joints;
mod side_by_side;
mod singular_positions;
mod steps_in_use;
mod work_of_gradients;
